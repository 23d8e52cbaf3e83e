//! `fractum material`: numbers for a material that nobody has measured yet, with ranges, sources, and what they ask of a mesh.

mod known;

use clap::{Args, ValueEnum};
use fractum::{ExitCode, Failure, say};
use fractum_case::{Dimension, PROCESS_ZONES, nearest, parse_quantity, unusual};
use fractum_math::elementary::{ln, pow};
use fractum_output::number::{percent, quantity};

use self::known::{KNOWN, Kind, Known, Measured, Rock, Specimen};

/// Arguments of `fractum material`.
#[derive(Args)]
pub(crate) struct MaterialArguments {
    /// Material, such as granite; without one, the list. `own` is one of which all is given.
    name: Option<String>,
    /// Compressive strength, such as "40 MPa"; of concrete the characteristic one. Concrete and rocks follow from it.
    #[arg(long)]
    compressive_strength: Option<String>,
    /// Young's modulus.
    #[arg(long)]
    young_modulus: Option<String>,
    /// Poisson's ratio.
    #[arg(long)]
    poisson_ratio: Option<String>,
    /// Density.
    #[arg(long)]
    density: Option<String>,
    /// Tensile strength. The toughness of a rock follows from it.
    #[arg(long)]
    tensile_strength: Option<String>,
    /// Fracture toughness K_Ic, such as "1.5e6 Pa*m^0.5": the fracture energy is K_Ic² (1 - nu²)/E.
    #[arg(long, conflicts_with = "fracture_energy")]
    toughness: Option<String>,
    /// Fracture energy.
    #[arg(long)]
    fracture_energy: Option<String>,
    /// Length of a phase field of another program: the strength is what that field bears.
    #[arg(long, conflicts_with = "tensile_strength")]
    length: Option<String>,
    /// Which phase field that is.
    #[arg(long, value_enum, default_value = "at2", requires = "length")]
    model: PhaseField,
}

/// The usual phase fields without a strength of their own.
#[derive(Clone, Copy, ValueEnum)]
enum PhaseField {
    /// Linear local term.
    At1,
    /// Quadratic local term.
    At2,
}

impl PhaseField {
    /// What a bar bears: sqrt(3 E G/(8 l)) and 9/16 sqrt(E G/(3 l)) (Tanné et al., *J. Mech. Phys. Solids* 110 (2018)).
    fn strength(self, young: f64, energy: f64, length: f64) -> f64 {
        match self {
            Self::At1 => (3.0 * young * energy / (8.0 * length)).sqrt(),
            Self::At2 => 9.0 / 16.0 * (young * energy / (3.0 * length)).sqrt(),
        }
    }
}

const COMPRESSIVE: &str = "--compressive-strength";
const TENSILE: &str = "--tensile-strength";

/// A number with its range and where it comes from, in SI.
#[derive(Clone)]
struct Row {
    value: f64,
    range: Option<[f64; 2]>,
    source: String,
}

impl Row {
    fn of(value: f64, source: impl Into<String>) -> Self {
        Self { value, range: None, source: source.into() }
    }

    fn between(value: f64, range: [f64; 2], source: impl Into<String>) -> Self {
        Self { value, range: Some(range), source: source.into() }
    }
}

impl From<&Measured> for Row {
    fn from(measured: &Measured) -> Self {
        Self { value: measured.value, range: measured.range, source: measured.source.to_owned() }
    }
}

/// What a case file asks for, and what goes with it.
#[derive(Default)]
struct Proposal {
    density: Option<Row>,
    young: Option<Row>,
    poisson: Option<Row>,
    compression: Option<Row>,
    tension: Option<Row>,
    toughness: Option<Row>,
    energy: Option<Row>,
    weibull: Option<f64>,
    /// Whether they follow from the compressive strength.
    follows: bool,
}

/// Lists the materials, or proposes the numbers of one.
///
/// # Errors
/// An unknown name, quantities that are none or out of range, and numbers that are missing.
pub(crate) fn run(arguments: &MaterialArguments) -> Result<ExitCode, Failure> {
    let Some(name) = &arguments.name else {
        KNOWN.iter().for_each(|known| say!("{:<20} {}", known.name, known.what));
        say!("{:<20} all of it given by options", "own");
        say!("\nfractum material NAME proposes its numbers with their sources, and says what they ask of a mesh");
        return Ok(ExitCode::Done);
    };
    let mut proposal = if name == "own" { Proposal::default() } else { of_name(name, arguments)? };
    proposal.take_given(arguments)?;
    proposal.derive(arguments)?;
    proposal.show(name)?;
    Ok(ExitCode::Done)
}

/// Materials that may be meant by a name: concrete by its class, those that share a word with it, or the nearest one.
fn meant(name: &str) -> Option<String> {
    let words = |text: &str| -> Vec<String> {
        let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| word.len() > 2);
        words.map(str::to_lowercase).collect()
    };
    let class = name.strip_prefix(['C', 'c']).and_then(|rest| rest.split('/').next()?.parse::<u32>().ok());
    if let Some(strength) = class {
        return Some(format!("concrete --compressive-strength \"{strength} MPa\""));
    }
    let own = words(name);
    let shares =
        |known: &&Known| own.iter().any(|word| words(known.name).contains(word) || words(known.what).contains(word));
    let near: Vec<&str> = KNOWN.iter().filter(shares).map(|known| known.name).collect();
    if near.is_empty() {
        nearest(name, KNOWN.iter().map(|known| known.name)).map(str::to_owned)
    } else {
        Some(near.join(" or "))
    }
}

fn of_name(name: &str, arguments: &MaterialArguments) -> Result<Proposal, Failure> {
    let plain = name.to_lowercase().replace([' ', '_'], "-");
    let Some(known) = KNOWN.iter().find(|known| known.name == plain) else {
        let names: Vec<&str> = KNOWN.iter().map(|known| known.name).collect();
        let hint = meant(name).map_or(";".to_owned(), |meant| format!("; did you mean {meant}?"));
        let own = "own takes the numbers of any other";
        return Err(Failure::input(format!("no material \"{name}\"{hint} known: {}, own; {own}", names.join(", "))));
    };
    match &known.kind {
        Kind::Concrete => concrete(pressure(&arguments.compressive_strength, COMPRESSIVE)?),
        Kind::Rock(rock) => {
            let tension = pressure(&arguments.tensile_strength, TENSILE)?;
            of_rock(rock, pressure(&arguments.compressive_strength, COMPRESSIVE)?, tension)
        }
        Kind::Specimen(specimen) => Ok(of_specimen(specimen)),
    }
}

/// Concrete by the fib Model Code 2010, sections 5.1.5 to 5.1.7.
fn concrete(strength: Option<f64>) -> Result<Proposal, Failure> {
    let (characteristic, whose) =
        strength.map_or((30.0, "C30, --compressive-strength changes it"), |given| (1e-6 * given, "given"));
    if !(12.0..=120.0).contains(&characteristic) {
        return Err(Failure::input(format!(
            "--compressive-strength {}: the Model Code holds from 12 to 120 MPa",
            quantity(1e6 * characteristic, "Pa")
        )));
    }
    let mean = characteristic + 8.0;
    let tension =
        if characteristic <= 50.0 { 0.3 * pow(characteristic, 2.0 / 3.0) } else { 2.12 * ln(1.0 + 0.1 * mean) };
    let young = 21.5e9 * pow(0.1 * mean, 1.0 / 3.0);
    let energy = 73.0 * pow(mean, 0.18);
    Ok(Proposal {
        density: Some(Row::of(2400.0, "usual")),
        young: Some(Row::between(
            young,
            [0.7 * young, 1.2 * young],
            "fib Model Code 2010, 5.1.7: quartzite; sandstone to basalt",
        )),
        poisson: Some(Row::between(0.2, [0.14, 0.26], "fib Model Code 2010, 5.1.7")),
        compression: Some(Row::of(
            1e6 * mean,
            format!("mean of cylinders, 8 MPa above the characteristic {characteristic} MPa ({whose})"),
        )),
        tension: Some(Row::between(
            1e6 * tension,
            [0.7e6 * tension, 1.3e6 * tension],
            "fib Model Code 2010, 5.1.5: mean; fractiles of 5 and 95 %",
        )),
        energy: Some(Row::between(
            energy,
            [0.7 * energy, 1.3 * energy],
            "fib Model Code 2010, 5.1.5; scatter of 30 % (Bažant & Becq-Giraudon 2002)",
        )),
        follows: true,
        ..Proposal::default()
    })
}

/// A rock by its compressive strength, and by that in direct tension if it is known.
fn of_rock(rock: &Rock, strength: Option<f64>, tension: Option<f64>) -> Result<Proposal, Failure> {
    let middle = |[low, high]: [f64; 2]| (low * high).sqrt();
    let [low, high] = rock.compression;
    let usual = middle(rock.compression);
    let compression = strength.unwrap_or(usual);
    if compression < 0.5 * low || compression > 2.0 * high {
        return Err(Failure::input(format!(
            "--compressive-strength {}: rocks of this kind have {} to {}",
            quantity(compression, "Pa"),
            quantity(low, "Pa"),
            quantity(high, "Pa")
        )));
    }
    let [soft, stiff] = rock.modulus_ratio;
    let splitting =
        tension.map_or(middle(rock.splitting) * (compression / usual).sqrt(), |tension| tension / rock.direct);
    let toughness = |splitting: f64| splitting * 1e6 / 6.88e6;
    Ok(Proposal {
        density: Some(Row::of(rock.density, "usual")),
        young: Some(Row::between(
            0.5 * (soft + stiff) * compression,
            [soft * compression, stiff * compression],
            format!("{soft} to {stiff} times the compressive strength (Hoek & Diederichs 2006)"),
        )),
        poisson: Some(Row::between(0.5 * (rock.poisson[0] + rock.poisson[1]), rock.poisson, "Gercek (2007)")),
        compression: Some(match strength {
            Some(given) => Row::between(given, rock.compression, "given; range of Attewell & Farmer (1976)"),
            None => Row::between(
                compression,
                rock.compression,
                "Attewell & Farmer (1976); --compressive-strength changes it",
            ),
        }),
        tension: Some(Row::between(
            rock.direct * splitting,
            rock.splitting.map(|strength| rock.direct * strength),
            format!(
                "{} of the Brazilian strength (Perras & Diederichs 2014); its range by Attewell & Farmer (1976), the middle of it with the root of the compressive strength",
                rock.direct
            ),
        )),
        toughness: Some(Row::between(
            toughness(splitting),
            rock.splitting.map(toughness),
            "Brazilian strength over 6.88 (Zhang 2002)",
        )),
        follows: true,
        ..Proposal::default()
    })
}

fn of_specimen(specimen: &Specimen) -> Proposal {
    Proposal {
        density: Some((&specimen.density).into()),
        young: Some((&specimen.young).into()),
        poisson: Some((&specimen.poisson).into()),
        compression: specimen.compression.as_ref().map(Row::from),
        tension: Some((&specimen.tension).into()),
        toughness: Some((&specimen.toughness).into()),
        energy: None,
        weibull: specimen.weibull,
        follows: false,
    }
}

impl Proposal {
    /// Numbers of the user take the place of others.
    fn take_given(&mut self, arguments: &MaterialArguments) -> Result<(), Failure> {
        let toughness =
            Dimension::LENGTH.power(0.5).and_then(|root| Dimension::PRESSURE.times(root)).unwrap_or(Dimension::NONE);
        // That of concrete and rock is what the others are made of.
        if let Some(value) = pressure(&arguments.compressive_strength, COMPRESSIVE)?.filter(|_| !self.follows) {
            self.compression = Some(Row::of(value, "given"));
        }
        let rows: [(&mut Option<Row>, &Option<String>, &str, Dimension); 6] = [
            (&mut self.density, &arguments.density, "--density", Dimension::DENSITY),
            (&mut self.young, &arguments.young_modulus, "--young-modulus", Dimension::PRESSURE),
            (&mut self.poisson, &arguments.poisson_ratio, "--poisson-ratio", Dimension::NONE),
            (&mut self.tension, &arguments.tensile_strength, TENSILE, Dimension::PRESSURE),
            (&mut self.toughness, &arguments.toughness, "--toughness", toughness),
            (&mut self.energy, &arguments.fracture_energy, "--fracture-energy", Dimension::FRACTURE_ENERGY),
        ];
        for (row, text, option, dimension) in rows {
            if let Some(value) = given(text.as_deref(), option, dimension)? {
                *row = Some(Row::of(value, "given"));
            }
        }
        if arguments.toughness.is_some() {
            self.energy = None;
        } else if arguments.fracture_energy.is_some() {
            self.toughness = None;
        }
        if let Some(row) = self.poisson.as_ref().filter(|row| row.value >= 0.5) {
            return Err(Failure::input(format!("--poisson-ratio {}: must be below 0.5", row.value)));
        }
        Ok(())
    }

    /// Fracture energy from toughness or the other way round, and the strength of another program's phase field.
    fn derive(&mut self, arguments: &MaterialArguments) -> Result<(), Failure> {
        let (Some(young), Some(poisson)) = (&self.young, &self.poisson) else {
            return Err(Failure::input("a material of your own needs --young-modulus and --poisson-ratio"));
        };
        let (young, plane) = (young.value, 1.0 - poisson.value * poisson.value);
        match (&self.energy, &self.toughness) {
            (None, Some(toughness)) => {
                let energy = |toughness: f64| toughness * toughness * plane / young;
                let range = toughness.range.map(|range| range.map(energy));
                self.energy =
                    Some(Row { value: energy(toughness.value), range, source: "K_Ic² (1 - nu²)/E".to_owned() });
            }
            (Some(energy), None) => {
                let toughness = |energy: f64| (energy * young / plane).sqrt();
                let range = energy.range.map(|range| range.map(toughness));
                self.toughness = Some(Row {
                    value: toughness(energy.value),
                    range,
                    source: "from the fracture energy, elastic".to_owned(),
                });
            }
            (Some(_), Some(_)) => {}
            (None, None) => {
                return Err(Failure::input("a material of your own needs --toughness or --fracture-energy"));
            }
        }
        if let Some(length) = given(arguments.length.as_deref(), "--length", Dimension::LENGTH)? {
            let energy = self.energy.as_ref().map_or(f64::NAN, |row| row.value);
            let source = match arguments.model {
                PhaseField::At1 => "sqrt(3 E G/(8 l)) of that phase field (Tanné et al. 2018)",
                PhaseField::At2 => "9/16 sqrt(E G/(3 l)) of that phase field (Tanné et al. 2018)",
            };
            self.tension = Some(Row::of(arguments.model.strength(young, energy, length), source));
        }
        if self.tension.is_none() {
            return Err(Failure::input(
                "a material of your own needs --tensile-strength, or --length of a phase field",
            ));
        }
        self.check_zone(young)
    }

    /// A number without its unit makes a process zone that no solid has.
    fn check_zone(&self, young: f64) -> Result<(), Failure> {
        let (Some(tension), Some(energy)) = (&self.tension, &self.energy) else { return Ok(()) };
        let zone = young * energy.value / (tension.value * tension.value);
        if PROCESS_ZONES.contains(&zone) {
            return Ok(());
        }
        let [shortest, longest] = [PROCESS_ZONES.start(), PROCESS_ZONES.end()].map(|zone| quantity(*zone, "m"));
        Err(Failure::input(format!(
            "fracture energy {} and tensile strength {} make a process zone E Gf/ft² of {}; solids have {shortest} to {longest}: give each number with its unit",
            told(energy.value, "J/m^2"),
            told(tension.value, "Pa"),
            quantity(zone, "m")
        )))
    }

    fn show(&self, name: &str) -> Result<(), Failure> {
        let rows = [
            ("density", &self.density, "kg/m^3"),
            ("Young's modulus E", &self.young, "Pa"),
            ("Poisson's ratio nu", &self.poisson, ""),
            ("compressive strength", &self.compression, "Pa"),
            ("tensile strength ft", &self.tension, "Pa"),
            ("fracture toughness K_Ic", &self.toughness, "Pa m^0.5"),
            ("fracture energy Gf", &self.energy, "J/m^2"),
        ];
        say!("{:<24} {:<16} {:<34} source", "", "value", "range");
        for (what, row, unit) in rows {
            let Some(row) = row else { continue };
            let range =
                row.range.map_or(String::new(), |[low, high]| format!("{} to {}", told(low, unit), told(high, unit)));
            say!("{what:<24} {:<16} {range:<34} {}", told(row.value, unit), row.source);
        }
        let (Some(young), Some(poisson), Some(tension), Some(energy)) =
            (&self.young, &self.poisson, &self.tension, &self.energy)
        else {
            return Ok(());
        };
        let zone = young.value * energy.value / (tension.value * tension.value);
        say!("\nprocess zone E Gf/ft²    {}", quantity(zone, "m"));
        say!(
            "elements where cracks go {} or less: loads of cracks come out some {} late; {} for 2 %",
            quantity(0.1 * zone, "m"),
            percent(0.066),
            quantity(0.03 * zone, "m")
        );
        say!(
            "                         a body smaller than its process zone wants elements of a tenth of its own size; solver.accuracy finds the size itself"
        );
        if let Some(modulus) = self.weibull {
            say!(
                "strength of bars scatters with a Weibull modulus of {modulus}: large parts are weaker (materials.NAME.damage.scatter, reference_volume)"
            );
        }
        say!("These are numbers to begin with. Measure what the answer depends on.\n");
        let key = name.replace('-', "_");
        say!("[materials.{key}]");
        let density = self.density.as_ref().map_or_else(
            || "density = \"... kg/m^3\"   # not given".to_owned(),
            |row| format!("density = \"{}\"", told(row.value, "kg/m^3")),
        );
        say!("{density}");
        say!("young_modulus = \"{}\"", told(young.value, "Pa"));
        say!("poisson_ratio = {}", told(poisson.value, ""));
        say!("[materials.{key}.damage]");
        say!("tensile_strength = \"{}\"", told(tension.value, "Pa"));
        say!("fracture_energy = \"{}\"", told(energy.value, "J/m^2"));
        if let Some(compression) = &self.compression {
            say!(
                "# where rock or concrete is crushed: criterion = \"mohr-coulomb\", compressive_strength = \"{}\"",
                told(compression.value, "Pa")
            );
        }
        Ok(())
    }
}

fn pressure(text: &Option<String>, option: &str) -> Result<Option<f64>, Failure> {
    given(text.as_deref(), option, Dimension::PRESSURE)
}

/// A number of the user, above 0.
fn given(text: Option<&str>, option: &str, dimension: Dimension) -> Result<Option<f64>, Failure> {
    let Some(text) = text else { return Ok(None) };
    let value = parse_quantity(text, dimension).map_err(|error| Failure::input(format!("{option}: {error}")))?;
    if let Some(doubt) = unusual(&option.trim_start_matches('-').replace('-', "_"), text, value).filter(|_| value > 0.0)
    {
        return Err(Failure::input(format!("{option} {doubt}")));
    }
    if value > 0.0 || (dimension == Dimension::NONE && value == 0.0) {
        return Ok(Some(value));
    }
    Err(Failure::input(format!("{option} \"{text}\": must be above 0")))
}

/// A quantity with three digits, as a case file reads it.
fn told(value: f64, unit: &str) -> String {
    let digits = |value: f64| if value == 0.0 { 0.0 } else { format!("{value:.2e}").parse().unwrap_or(value) };
    match unit {
        "Pa m^0.5" => format!("{} MPa*m^0.5", digits(1e-6 * value)),
        "kg/m^3" => format!("{} kg/m^3", value.round()),
        "J/m^2" => format!("{} J/m^2", digits(value)),
        _ => quantity(digits(value), unit),
    }
}
