//! `[[interfaces]]`: inner faces of solids with a strength of their own.

use fractum_scene::{InterfaceLaw, InterfaceSoftening, MixedMode, Roughness, SpringInterface};

use super::names;
use super::time_functions::time_function;
use crate::model::{Interface, InterfaceFaces};
use crate::reader::Table;
use crate::usual::{FRACTURE_ENERGY, STRENGTH};
use crate::{Diagnostic, Spanned, TimeFunction};

/// Energy over that stored up to the strength below which softening would snap back.
pub(crate) const LEAST_DUCTILITY: f64 = 1.05;

/// Least angle of friction of worn sides beside roughness [degrees]: below it strength falls as the pressure grows.
const LEAST_BESIDE_ROUGHNESS: f64 = 10.0;

/// Reads all interfaces; nothing where one of them is wrong.
pub(super) fn read(root: &Table<'_>) -> Option<Vec<Interface>> {
    let tables = root.tables("interfaces");
    let read: Vec<Option<Interface>> = (1..).zip(tables).map(|(number, table)| interface(table, number)).collect();
    let interfaces: Vec<Interface> = read.into_iter().collect::<Option<_>>()?;
    for (index, interface) in interfaces.iter().enumerate() {
        if interfaces[..index].iter().any(|other| other.name == interface.name) {
            let note = Diagnostic::error(&interface.place, format!(".name = \"{}\"", interface.name));
            root.reader.note(note.expected("a name that no other interface has"));
            return None;
        }
    }
    Some(interfaces)
}

fn interface(table: Table<'_>, number: usize) -> Option<Interface> {
    let name = table.text("name").or(format!("interface-{number}"));
    let along = along(&table);
    let law = law(&table);
    let normal = table.quantity("normal_stiffness").physical().map(Some).or_if_absent(None);
    let shear = match normal {
        Some(Some(normal)) => table.quantity("shear_stiffness").physical().or_if_absent(normal).map(Some),
        _ => {
            table.refuse("shear_stiffness", "without normal_stiffness");
            Some(None)
        }
    };
    let stiffness = normal.zip(shear).map(|(normal, shear)| Some([normal?, shear?]));
    let is_firm = law.zip(stiffness).map(|(law, stiffness)| stiffness.is_none_or(|own| is_firm(&table, law, own)));
    let pressure = pressure(&table);
    let heat_transfer = table.quantity("heat_transfer").physical().spanned().map(Some).or_if_absent(None);
    let place = table.place.clone();
    table.finish("here");
    let law = law.filter(|_| is_firm == Some(true));
    let (along, law, stiffness, pressure) = (along?, law?, stiffness?, pressure?);
    Some(Interface { name, place, along, law, stiffness, pressure, heat_transfer: heat_transfer? })
}

/// Pressure inside, and whether it acts where the strength is lost alone.
fn pressure(table: &Table<'_>) -> Option<Option<(Spanned<TimeFunction>, bool)>> {
    if !table.has("pressure") {
        table.refuse("pressure_in", "without pressure");
        return Some(None);
    }
    let in_broken = table.one_of("pressure_in", &[("everywhere", false), ("broken", true)]).or(false);
    let value = time_function(table, "pressure").spanned().required()?;
    Some(Some((value, in_broken)))
}

fn along(table: &Table<'_>) -> Option<InterfaceFaces> {
    if !table.has("between") {
        return table.text("group").spanned().required().map(InterfaceFaces::Group);
    }
    table.refuse("group", "beside between, which says where the interface is");
    let groups = names::read(table, "between", "groups of elements")?;
    let place = table.place_below("between");
    let twice = groups.iter().enumerate().any(|(at, name)| groups[..at].iter().any(|other| other.value == name.value));
    if groups.len() < 2 || twice {
        let note = Diagnostic::error(&place, format!("names {} group(s)", groups.len()));
        table.reader.note(note.expected("two different groups of elements at least"));
        return None;
    }
    Some(InterfaceFaces::Between(Spanned::new(groups, place)))
}

fn law(table: &Table<'_>) -> Option<InterfaceLaw> {
    let residual_friction = tangent(table, "residual_friction_angle", 0.0);
    let dilation = tangent(table, "dilation_angle", 0.0);
    let dilation_slip = match dilation {
        Some(dilation) if dilation > 0.0 => table.quantity("dilation_slip").positive().or_if_absent(f64::INFINITY),
        _ => {
            table.refuse("dilation_slip", "without dilation_angle");
            Some(f64::INFINITY)
        }
    };
    let bonded = table.flag("bonded").or(true);
    const OF_BONDS: [&str; 8] = [
        "tensile_strength",
        "cohesion",
        "fracture_energy",
        "shear_fracture_energy",
        "mixed_mode",
        "mixed_mode_exponent",
        "softening",
        "friction_angle",
    ];
    let (residual, raised) = (residual_friction?, dilation?);
    if raised > residual {
        let note =
            Diagnostic::error(&table.place_below("dilation_angle"), "is larger than the residual friction angle");
        let remedy = "lower it, or raise residual_friction_angle: sides that slide would gain energy";
        table.reader.note(note.expected("at most the residual friction angle").remedy(remedy));
        return None;
    }
    let unbonded = InterfaceLaw {
        tensile_strength: 0.0,
        cohesion: 0.0,
        opening_energy: 1.0,
        sliding_energy: 1.0,
        friction: residual,
        residual_friction: residual,
        dilation: raised,
        dilation_slip: dilation_slip?,
        mixed_mode: MixedMode::Power(1.0),
        softening: InterfaceSoftening::Linear,
        roughness: roughness(table, residual)?,
    };
    if !bonded {
        for name in OF_BONDS {
            let of_friction = "with bonded = false, where residual_friction_angle is that of its sides";
            table.refuse(name, if name == "friction_angle" { of_friction } else { "with bonded = false" });
        }
        return Some(unbonded);
    }
    let friction = match table.has("friction_angle") {
        true => tangent(table, "friction_angle", 0.0)?,
        false => residual,
    };
    if friction < residual {
        let note =
            Diagnostic::error(&table.place_below("friction_angle"), "is smaller than the residual friction angle");
        table.reader.note(note.expected("at least the residual friction angle"));
        return None;
    }
    let strength = table.quantity("tensile_strength").physical().usual(&STRENGTH).required();
    let cohesion = table.quantity("cohesion").physical().usual(&STRENGTH).or_if_absent(strength.unwrap_or(1.0));
    let energy = table.quantity("fracture_energy").physical().usual(&FRACTURE_ENERGY).required();
    let shear = table.quantity("shear_fracture_energy").physical().usual(&FRACTURE_ENERGY);
    let shear = shear.or_if_absent(energy.unwrap_or(1.0));
    let exponent = table.quantity("mixed_mode_exponent");
    let exponent = exponent.check(|exponent| (1.0..=4.0).contains(exponent), "from 1 to 4").or(1.0);
    let mode = table.one_of("mixed_mode", &[("power", false), ("benzeggagh-kenane", true)]).or(false);
    let curves = [("linear", InterfaceSoftening::Linear), ("exponential", InterfaceSoftening::Exponential)];
    let softening = table.one_of("softening", &curves).or(InterfaceSoftening::Linear);
    Some(InterfaceLaw {
        tensile_strength: strength?,
        cohesion: cohesion?,
        opening_energy: energy?,
        sliding_energy: shear?,
        friction,
        mixed_mode: if mode { MixedMode::BenzeggaghKenane(exponent) } else { MixedMode::Power(exponent) },
        softening,
        ..unbonded
    })
}

/// Asperities, where a coefficient is given.
///
/// - `smooth`: coefficient of residual friction
fn roughness(table: &Table<'_>, smooth: f64) -> Option<Option<Roughness>> {
    if !table.has("joint_roughness") {
        for name in ["joint_wall_strength", "peak_slip"] {
            table.refuse(name, "without joint_roughness");
        }
        return Some(None);
    }
    let coefficient = table.quantity("joint_roughness");
    let coefficient = coefficient.check(|own| *own > 0.0 && *own <= 20.0, "above 0, at most 20").required();
    let wall_strength = table.quantity("joint_wall_strength").physical().usual(&STRENGTH).required();
    let peak_slip = table.quantity("peak_slip").positive().or_if_absent(f64::INFINITY);
    if smooth < fractum_math::elementary::tan(LEAST_BESIDE_ROUGHNESS.to_radians()) {
        let note = Diagnostic::error(&table.place_below("joint_roughness"), "beside less friction of worn sides");
        let expected = format!("residual_friction_angle of {LEAST_BESIDE_ROUGHNESS} deg at least");
        table.reader.note(note.expected(&expected).remedy("set it: rock joints have 20 to 40 deg"));
        return None;
    }
    Some(Some(Roughness { coefficient: coefficient?, wall_strength: wall_strength?, peak_slip: peak_slip? }))
}

/// Tangent of an angle.
fn tangent(table: &Table<'_>, name: &'static str, default: f64) -> Option<f64> {
    let angle =
        table.quantity(name).check(|angle| (0.0..89.9f64.to_radians()).contains(angle), "from 0 to below 90 deg");
    angle.map(fractum_math::elementary::tan).or_if_absent(default)
}

/// Whether an interface may spend more than it stores up to its strength: softening would snap back otherwise.
fn is_firm(table: &Table<'_>, law: InterfaceLaw, stiffness: [f64; 2]) -> bool {
    let ratio = SpringInterface { law, stiffness }.least_ductility();
    if ratio >= LEAST_DUCTILITY {
        return true;
    }
    let least = LEAST_DUCTILITY / ratio;
    let found = format!("is so soft that it stores {:.2} of its fracture energy up to its strength", 1.0 / ratio);
    let note = Diagnostic::error(&table.place_below("normal_stiffness"), found);
    let remedy = format!("raise normal_stiffness and shear_stiffness {least:.3} times, or the fracture energies");
    table.reader.note(note.expected("less than 0.95 in every mode").remedy(remedy));
    false
}
