//! Units and dimensions.
//!
//! A unit is ten^n × factor of the SI unit of its dimension. Keeping the power of ten apart makes `"0.2 ms"` the very
//! same number as `0.0002`.

use std::fmt;

use fractum_math::elementary::pow;

use super::nearest;

/// Exponents of kilogram, metre, second and kelvin, in halves so that roots such as Pa·m^0.5 exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    halves: [i8; 4],
}

const fn dimension(kg: i8, m: i8, s: i8) -> Dimension {
    Dimension { halves: [2 * kg, 2 * m, 2 * s, 0] }
}

impl Dimension {
    /// Pure number.
    pub const NONE: Self = dimension(0, 0, 0);
    /// Length [m].
    pub const LENGTH: Self = dimension(0, 1, 0);
    /// Area [m²].
    pub const AREA: Self = dimension(0, 2, 0);
    /// Mass [kg].
    pub const MASS: Self = dimension(1, 0, 0);
    /// Time [s].
    pub const TIME: Self = dimension(0, 0, 1);
    /// Temperature [K].
    pub const TEMPERATURE: Self = Dimension { halves: [0, 0, 0, 2] };
    /// Velocity [m/s].
    pub const VELOCITY: Self = dimension(0, 1, -1);
    /// Acceleration [m/s²].
    pub const ACCELERATION: Self = dimension(0, 1, -2);
    /// Rate [1/s].
    pub const RATE: Self = dimension(0, 0, -1);
    /// Force [N].
    pub const FORCE: Self = dimension(1, 1, -2);
    /// Pressure, stress, modulus [Pa].
    pub const PRESSURE: Self = dimension(1, -1, -2);
    /// Stiffness per area [Pa/m].
    pub const STIFFNESS_PER_AREA: Self = dimension(1, -2, -2);
    /// Energy [J].
    pub const ENERGY: Self = dimension(1, 2, -2);
    /// Power [W].
    pub const POWER: Self = dimension(1, 2, -3);
    /// Volume [m³].
    pub const VOLUME: Self = dimension(0, 3, 0);
    /// Mass density [kg/m³].
    pub const DENSITY: Self = dimension(1, -3, 0);
    /// Energy per area [J/m²].
    pub const FRACTURE_ENERGY: Self = dimension(1, 0, -2);
    /// Heat capacity per mass [J/(kg K)].
    pub const HEAT_CAPACITY: Self = Dimension { halves: [0, 4, -4, -2] };
    /// Thermal conductivity [W/(m K)].
    pub const CONDUCTIVITY: Self = Dimension { halves: [2, 2, -6, -2] };
    /// Heat flow per area [W/m²].
    pub const HEAT_FLUX: Self = dimension(1, 0, -3);
    /// Heat flow per volume [W/m³].
    pub const HEAT_SOURCE: Self = dimension(1, -1, -3);
    /// Coefficient of heat transfer [W/(m² K)].
    pub const HEAT_TRANSFER: Self = Dimension { halves: [2, 0, -6, -2] };
    /// Coefficient of thermal expansion [1/K].
    pub const EXPANSION: Self = Dimension { halves: [0, 0, 0, -2] };
    /// Volume per mass [m³/kg].
    pub const SPECIFIC_VOLUME: Self = dimension(-1, 3, 0);
    /// Dynamic viscosity [Pa s].
    pub const VISCOSITY: Self = dimension(1, -1, -1);
    /// Compressibility [1/Pa].
    pub const COMPRESSIBILITY: Self = dimension(-1, 1, 2);
    /// Volume per pressure [m³/Pa].
    pub const STORAGE: Self = dimension(-1, 4, 2);
    /// Volume per time [m³/s].
    pub const VOLUME_RATE: Self = dimension(0, 3, -1);
    /// Length per root of time [m/√s].
    pub const LEAK_OFF: Self = Dimension { halves: [0, 2, -1, 0] };
    /// Mass flow [kg/s].
    pub const MASS_RATE: Self = dimension(1, 0, -1);
    /// Linear momentum [kg m/s].
    pub const MOMENTUM: Self = dimension(1, 1, -1);
    /// Angular momentum [kg m²/s].
    pub const ANGULAR_MOMENTUM: Self = dimension(1, 2, -1);

    /// Dimension of a product; `None` where an exponent grows out of range.
    pub fn times(self, other: Self) -> Option<Self> {
        self.combine(other, i8::checked_add)
    }

    /// Dimension of a quotient; `None` where an exponent grows out of range.
    pub fn over(self, other: Self) -> Option<Self> {
        self.combine(other, i8::checked_sub)
    }

    /// Dimension of a power; `None` unless all exponents are multiples of one half and in range.
    pub fn power(self, exponent: f64) -> Option<Self> {
        let mut halves = [0; 4];
        for (result, half) in halves.iter_mut().zip(self.halves) {
            let power = f64::from(half) * exponent;
            if power != power.round() || power.abs() > 100.0 {
                return None;
            }
            *result = power as i8;
        }
        Some(Self { halves })
    }

    /// Twice the power with which such a quantity grows with a body whose lengths and times grow alike, while stresses and densities stay.
    pub(super) fn halves_of_length(self) -> i32 {
        let [kg, m, s, _] = self.halves.map(i32::from);
        3 * kg + m + s
    }

    fn combine(self, other: Self, f: fn(i8, i8) -> Option<i8>) -> Option<Self> {
        let mut halves = [0; 4];
        for (i, result) in halves.iter_mut().enumerate() {
            *result = f(self.halves[i], other.halves[i])?;
        }
        Some(Self { halves })
    }

    /// SI unit as printed: `Pa`, `m/s`, `kg m^-1`; `1` for a pure number.
    pub fn symbol(self) -> String {
        if let Some(known) = self.known() {
            return known.symbol.to_string();
        }
        let factors = ["kg", "m", "s", "K"].iter().zip(self.halves).filter(|(_, half)| *half != 0);
        let factors = factors.map(|(unit, half)| match half {
            2 => unit.to_string(),
            _ if half % 2 == 0 => format!("{unit}^{}", half / 2),
            _ => format!("{unit}^{}", f64::from(half) / 2.0),
        });
        factors.collect::<Vec<_>>().join(" ")
    }

    /// What such a quantity is called, with its article: `a pressure`, `a quantity in kg m^-1`.
    pub fn phrase(self) -> String {
        self.known().map_or_else(|| format!("a quantity in {}", self.symbol()), |known| known.phrase.to_string())
    }

    /// The phrase with an example: `a pressure such as "21 GPa"`.
    pub fn expected(self) -> String {
        match self.known() {
            Some(known) if self == Self::NONE => format!("{} such as {}", known.phrase, known.example),
            Some(known) => format!("{} such as \"{}\"", known.phrase, known.example),
            None => self.phrase(),
        }
    }

    fn known(self) -> Option<&'static Known> {
        KNOWN.iter().find(|known| known.dimension == self)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.symbol())
    }
}

struct Known {
    dimension: Dimension,
    symbol: &'static str,
    phrase: &'static str,
    example: &'static str,
}

const fn known(dimension: Dimension, symbol: &'static str, phrase: &'static str, example: &'static str) -> Known {
    Known { dimension, symbol, phrase, example }
}

static KNOWN: &[Known] = &[
    known(Dimension::NONE, "1", "a number", "0.5"),
    known(Dimension::LENGTH, "m", "a length", "12 mm"),
    known(Dimension::AREA, "m^2", "an area", "4 cm^2"),
    known(Dimension::VOLUME, "m^3", "a volume", "1 L"),
    known(Dimension::STIFFNESS_PER_AREA, "Pa/m", "a stiffness per area", "1 GPa/m"),
    known(Dimension::MASS, "kg", "a mass", "2 kg"),
    known(Dimension::TIME, "s", "a time", "0.2 ms"),
    known(Dimension::TEMPERATURE, "K", "a temperature", "293 K"),
    known(Dimension::VELOCITY, "m/s", "a velocity", "5 mm/s"),
    known(Dimension::ACCELERATION, "m/s^2", "an acceleration", "9.81 m/s^2"),
    known(Dimension::RATE, "1/s", "a rate", "50 1/s"),
    known(Dimension::FORCE, "N", "a force", "5 kN"),
    known(Dimension::PRESSURE, "Pa", "a pressure", "21 GPa"),
    known(Dimension::ENERGY, "J", "an energy", "3 J"),
    known(Dimension::POWER, "W", "a power", "100 W"),
    known(Dimension::DENSITY, "kg/m^3", "a density", "2400 kg/m^3"),
    known(Dimension::HEAT_CAPACITY, "J/(kg K)", "a heat capacity per mass", "300 J/(kg K)"),
    known(Dimension::CONDUCTIVITY, "W/(m K)", "a thermal conductivity", "134 W/(m K)"),
    known(Dimension::HEAT_FLUX, "W/m^2", "a heat flow per area", "5 kW/m^2"),
    known(Dimension::HEAT_SOURCE, "W/m^3", "a heat flow per volume", "10 MW/m^3"),
    known(Dimension::HEAT_TRANSFER, "W/(m^2 K)", "a coefficient of heat transfer", "50 W/(m^2 K)"),
    known(Dimension::EXPANSION, "1/K", "a coefficient of thermal expansion", "1e-5 1/K"),
    known(Dimension::SPECIFIC_VOLUME, "m^3/kg", "a volume per mass", "1 L/kg"),
    known(Dimension::COMPRESSIBILITY, "1/Pa", "a compressibility", "4.5e-10 1/Pa"),
    known(Dimension::STORAGE, "m^3/Pa", "a volume per pressure", "0.2 mL/MPa"),
    known(Dimension::VOLUME_RATE, "m^3/s", "a volume per time", "10 L/s"),
    known(Dimension::LEAK_OFF, "m/s^0.5", "a leak-off", "1e-5 m/s^0.5"),
    known(Dimension::VISCOSITY, "Pa s", "a viscosity", "5e-5 Pa s"),
    known(Dimension::MASS_RATE, "kg/s", "a mass flow", "0.1 kg/s"),
    known(Dimension::FRACTURE_ENERGY, "J/m^2", "an energy per area", "100 J/m^2"),
    known(Dimension::MOMENTUM, "kg m/s", "a momentum", "1 kg m/s"),
    known(Dimension::ANGULAR_MOMENTUM, "kg m^2/s", "an angular momentum", "1 kg m^2/s"),
];

/// A unit: ten^`ten` × `factor` in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub(super) ten: i32,
    pub(super) factor: f64,
    pub(super) dimension: Dimension,
}

impl Unit {
    /// The pure number 1.
    pub(super) const ONE: Self = unit(0, 1.0, Dimension::NONE);

    /// The unit of this symbol; `None` where there is none.
    pub(super) fn find(symbol: &str) -> Option<Self> {
        if let Some((_, unit, _)) = SYMBOLS.iter().find(|(name, ..)| *name == symbol) {
            return Some(*unit);
        }
        PREFIXES.iter().find_map(|(prefix, ten)| {
            let base = symbol.strip_prefix(prefix)?;
            let (_, unit, _) = SYMBOLS.iter().find(|(name, _, prefixed)| *prefixed && *name == base)?;
            Some(Unit { ten: unit.ten + ten, ..*unit })
        })
    }

    /// The unit that was probably meant by this symbol: `m^3` for `m3`, else one that resembles it.
    pub(super) fn nearest(symbol: &str) -> Option<String> {
        let base = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
        if base != symbol && Unit::find(base).is_some() {
            return Some(format!("{base}^{}", &symbol[base.len()..]));
        }
        let prefixed = SYMBOLS.iter().filter(|(.., prefixed)| *prefixed);
        let with_prefix =
            prefixed.flat_map(|(name, ..)| PREFIXES.iter().map(move |(prefix, _)| format!("{prefix}{name}")));
        // A slip in upper and lower case is the likeliest of all.
        let mut all: Vec<String> = SYMBOLS.iter().map(|(name, ..)| name.to_string()).chain(with_prefix).collect();
        all.sort_by_key(|name| !name.eq_ignore_ascii_case(symbol));
        nearest(symbol, all.iter().map(String::as_str)).map(str::to_string)
    }

    /// Product with another unit raised to a power; `None` where exponents grow out of range.
    pub(super) fn times(self, other: Self, exponent: f64) -> Option<Self> {
        let dimension = self.dimension.times(other.dimension.power(exponent)?)?;
        let ten = f64::from(other.ten) * exponent;
        let (whole, rest) = if ten == ten.round() { (ten, 1.0) } else { (0.0, pow(10.0, ten)) };
        let factor = self.factor * rest * pow(other.factor, exponent);
        let ten = self.ten.checked_add(whole as i32)?;
        (factor.is_finite() && factor > 0.0 && ten.abs() < 1000).then_some(Self { ten, factor, dimension })
    }

    /// Size in SI.
    pub(super) fn size(self) -> f64 {
        self.of("1").unwrap_or(f64::NAN)
    }

    /// `number`, as written in digits, of this unit in SI; `None` where `number` is malformed.
    pub(super) fn of(self, number: &str) -> Option<f64> {
        let (mantissa, exponent) = match number.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (number, 0),
        };
        let shifted = format!("{mantissa}e{}", exponent.checked_add(self.ten)?);
        Some(shifted.parse::<f64>().ok()? * self.factor)
    }
}

const fn unit(ten: i32, factor: f64, dimension: Dimension) -> Unit {
    Unit { ten, factor, dimension }
}

/// Symbol, unit, and whether it takes prefixes.
static SYMBOLS: &[(&str, Unit, bool)] = &[
    ("m", unit(0, 1.0, Dimension::LENGTH), true),
    ("g", unit(-3, 1.0, Dimension::MASS), true),
    ("s", unit(0, 1.0, Dimension::TIME), true),
    ("K", unit(0, 1.0, Dimension::TEMPERATURE), true),
    ("N", unit(0, 1.0, Dimension::FORCE), true),
    ("Pa", unit(0, 1.0, Dimension::PRESSURE), true),
    ("J", unit(0, 1.0, Dimension::ENERGY), true),
    ("W", unit(0, 1.0, Dimension::POWER), true),
    ("Hz", unit(0, 1.0, Dimension::RATE), true),
    ("L", unit(-3, 1.0, dimension(0, 3, 0)), true),
    ("bar", unit(5, 1.0, Dimension::PRESSURE), true),
    ("rad", unit(0, 1.0, Dimension::NONE), true),
    ("t", unit(3, 1.0, Dimension::MASS), false),
    ("min", unit(0, 60.0, Dimension::TIME), false),
    ("h", unit(0, 3600.0, Dimension::TIME), false),
    ("deg", unit(0, std::f64::consts::PI / 180.0, Dimension::NONE), false),
    ("°", unit(0, std::f64::consts::PI / 180.0, Dimension::NONE), false),
    ("%", unit(-2, 1.0, Dimension::NONE), false),
    ("in", unit(0, 0.0254, Dimension::LENGTH), false),
    ("ft", unit(0, 0.3048, Dimension::LENGTH), false),
    ("psi", unit(0, 6_894.757_293_168_361, Dimension::PRESSURE), false),
];

static PREFIXES: &[(&str, i32)] = &[
    ("da", 1), // before "d"
    ("Q", 30),
    ("R", 27),
    ("Y", 24),
    ("Z", 21),
    ("E", 18),
    ("P", 15),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
    ("f", -15),
    ("a", -18),
    ("z", -21),
    ("y", -24),
    ("r", -27),
    ("q", -30),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_shift_the_decimal_point_exactly() {
        for (symbol, number, si) in
            [("ms", "0.2", 0.0002), ("GPa", "21", 21e9), ("kg", "7.3", 7.3), ("um", "0.1", 1e-7)]
        {
            assert_eq!(Unit::find(symbol).unwrap().of(number), Some(si), "{number} {symbol}");
        }
    }

    #[test]
    fn whole_symbols_win_over_prefixes() {
        assert_eq!(Unit::find("min").unwrap().size(), 60.0, "minute, not milli-inch");
        assert_eq!(Unit::find("ft").unwrap().size(), 0.3048, "foot, not femto-tonne");
        assert_eq!(Unit::find("Pa").unwrap().dimension, Dimension::PRESSURE);
        assert_eq!(Unit::find("dam").unwrap().size(), 10.0);
        assert_eq!(Unit::find("dm").unwrap().size(), 0.1);
        assert_eq!(Unit::find("kin"), None, "no kilo-inch");
        assert_eq!(Unit::find(""), None);
    }

    #[test]
    fn derived_units_agree_with_their_definition() {
        let newton = Unit::ONE.times(Unit::find("kg").unwrap(), 1.0).unwrap();
        let newton =
            newton.times(Unit::find("m").unwrap(), 1.0).unwrap().times(Unit::find("s").unwrap(), -2.0).unwrap();
        assert_eq!(newton, Unit::find("N").unwrap());
        let pascal = newton.times(Unit::find("m").unwrap(), -2.0).unwrap();
        assert_eq!(pascal, Unit::find("Pa").unwrap());
        let psi = 4.448_221_615_260_5 / (0.0254 * 0.0254); // pound-force per square inch, both exact by definition
        assert!((Unit::find("psi").unwrap().size() / psi - 1.0).abs() < 1e-15);
    }

    #[test]
    fn symbols_and_phrases() {
        assert_eq!(Dimension::PRESSURE.expected(), "a pressure such as \"21 GPa\"");
        assert_eq!(
            Dimension::PRESSURE.times(Dimension::LENGTH.power(0.5).unwrap()).unwrap().symbol(),
            "kg m^-0.5 s^-2"
        );
        assert_eq!(Dimension::LENGTH.power(0.3), None);
        assert_eq!(Dimension::LENGTH.power(1e300), None);
        assert_eq!(Unit::nearest("Gpa").as_deref(), Some("GPa"));
        assert_eq!(Unit::nearest("m3").as_deref(), Some("m^3"));
    }
}
