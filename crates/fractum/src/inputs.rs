//! Materials and settings of a case, as the table of the report.

use fractum_io::case::model::{Case, Material};
use fractum_io::number::{quantity, significant};

/// What and its value, line by line.
pub(crate) fn table(case: &Case) -> Vec<(String, String)> {
    let mut lines: Vec<(String, String)> =
        case.materials.iter().map(|material| (material.name.value.clone(), of_material(material))).collect();
    for (name, value) in &case.source.parameters {
        lines.push((format!("parameter {name}"), format!("{} in SI units", significant(*value, 6))));
    }
    for (name, value) in &case.source.overrides {
        lines.push((format!("--set {name}"), value.clone()));
    }
    lines.push(("end".to_owned(), quantity(case.solver.end, "s")));
    lines
}

fn of_material(material: &Material) -> String {
    let mut parts = vec![
        format!("density {}", quantity(material.density, "kg/m^3")),
        format!("E = {}", quantity(material.young_modulus, "Pa")),
        format!("Poisson's ratio {}", material.poisson_ratio),
    ];
    if let Some(damage) = &material.damage {
        let law = &damage.value.law;
        parts.push(format!("tensile strength {}", quantity(law.tensile_strength, "Pa")));
        parts.push(format!("fracture energy {}", quantity(law.fracture_energy, "J/m^2")));
    }
    if let Some(strength) = material.fracture.as_ref().and_then(|fracture| fracture.value.tensile_strength) {
        parts.push(format!("tensile strength of bonds {}", quantity(strength, "Pa")));
    }
    parts.join(", ")
}
