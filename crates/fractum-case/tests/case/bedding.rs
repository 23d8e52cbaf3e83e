//! `[materials.NAME.bedding]`: what is read, and what is said about mistakes.

use fractum_case::Severity;
use fractum_fem::{Bedding, Elastic};
use fractum_math::Vec3;

use crate::{SMALL, every_key, folder, good, parse};

const BEDS: &str = "bedding = { normal = [0, 0, 2], young_modulus_normal = 100e9, poisson_ratio_normal = 0.2 }";

fn bedded(table: &str) -> String {
    SMALL.replace("poisson_ratio = 0.3", &format!("poisson_ratio = 0.3\n{table}"))
}

#[test]
fn beds_are_read_by_normal_or_dip() {
    let case = good(&every_key(), &[]);
    let beds = |name: &str| {
        let material = case.materials.iter().find(|material| material.name.value == name).unwrap();
        material.bedding.as_ref().unwrap().value.clone()
    };
    let (shale, slate) = (beds("shale"), beds("slate"));
    let expected =
        Bedding { normal: Vec3::new(0.0, 0.6, 0.8), young_modulus: 15e9, poisson_ratio: 0.2, shear_modulus: 8e9 };
    assert!((shale.law.normal - expected.normal).norm() < 1e-15);
    assert_eq!(shale.law, Bedding { normal: shale.law.normal, ..expected });
    assert!(!shale.by_dip && !shale.is_estimated && slate.by_dip && slate.is_estimated);
    // Down towards x: the normal leans that way.
    let (sine, cosine) = 30f64.to_radians().sin_cos();
    assert!((slate.law.normal - Vec3::new(sine, 0.0, cosine)).norm() < 1e-15);
    assert!((slate.law.shear_modulus - 1.0 / (1.0 / 60e9 + 1.3 / 30e9)).abs() < 1e-3);
}

#[test]
fn each_mistake_about_beds_has_one_clear_message() {
    let elastic = Elastic { density: 7800.0, young_modulus: 210e9, poisson_ratio: 0.3 };
    assert!((Bedding::poisson_limit(&elastic, 100e9) - 0.4082).abs() < 5e-5);
    let cases: &[(&str, &str, &str)] = &[
        (
            "normal = [0, 0, 2], ",
            "",
            "8:11: materials.steel.bedding.normal is missing; expected an axis such as \"x\" or \"-y\", or three numbers",
        ),
        (
            "[0, 0, 2]",
            "[0, 0, 0]",
            "8:22: materials.steel.bedding.normal = [0, 0, 0]; expected an axis such as \"x\" or \"-y\", or three numbers that are not all zero",
        ),
        (
            "poisson_ratio_normal = 0.2",
            "poisson_ratio_normal = 0.41",
            "8:86: materials.steel.bedding.poisson_ratio_normal = 0.41; expected between -0.4082 and 0.4082, which is sqrt((1 - nu) E'/(2 E)) of the \
             moduli: beyond it some strain stores no energy",
        ),
        (
            "young_modulus_normal = 100e9",
            "young_modulus_normal = -1",
            "8:56: materials.steel.bedding.young_modulus_normal = -1; expected more than 0",
        ),
        (
            "poisson_ratio_normal = 0.2",
            "poisson_ratio_normal = 0.2, shear_modulus_normal = 0",
            "8:114: materials.steel.bedding.shear_modulus_normal = 0; expected more than 0",
        ),
        (
            "normal = [0, 0, 2]",
            "normal = \"x\", dip = 0.1, dip_direction = 0",
            "8:13: materials.steel.bedding.normal has no effect beside dip, from which it follows; remove it",
        ),
        (
            "normal = [0, 0, 2]",
            "normal = \"x\", dip_direction = 0",
            "8:27: materials.steel.bedding.dip_direction has no effect without dip; remove it",
        ),
        (
            "normal = [0, 0, 2]",
            "dip = \"30 deg\"",
            "8:11: materials.steel.bedding.dip_direction is missing; expected an angle such as \"35 deg\"",
        ),
        (
            "normal = [0, 0, 2]",
            "dip = 30, dip_direction = 0",
            "8:19: materials.steel.bedding.dip = 30; expected an angle such as \"35 deg\"; without a unit it is in radians: write \"30 deg\"",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2, tensile_strength = 1e6, cohesion = 2e6, fracture_energy = 1e3 }",
            "8:110: materials.steel.bedding.tensile_strength has no effect without damage; expected a table damage beside bedding; give the strength of the \
             rock in damage, or remove the strength of its beds",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2, cohesion = 2e6 }\ndamage = { tensile_strength = 1e7, fracture_energy = 1e4 }",
            "8:11: materials.steel.bedding.tensile_strength is missing; expected a pressure such as \"21 GPa\"",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2, tensile_strength = 2e7, cohesion = 2e7, fracture_energy = 1e5 }\ndamage = { tensile_strength = 1e7, fracture_energy = 1e4 }",
            "8:110: materials.steel.bedding.tensile_strength is 20 MPa, more than that of the rock; expected at most damage.tensile_strength, 10 MPa; lower it, \
             or raise that of the rock",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2, tensile_strength = 2e6, cohesion = 2e7, fracture_energy = 1e5 }\ndamage = { tensile_strength = 1e7, fracture_energy = 1e4 }",
            "8:149: materials.steel.bedding.fracture_energy is 100 kJ/m², more than that of the rock; expected at most damage.fracture_energy, 10 kJ/m²; \
             lower it, or raise that of the rock",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2, tensile_strength = 2e6, friction_angle = \"45 deg\", cohesion = 1e6, fracture_energy = 1e3 }\n\
             damage = { tensile_strength = 1e7, fracture_energy = 1e4 }",
            "8:153: materials.steel.bedding.cohesion = 1e6; expected at least 2 MPa, tensile_strength times the tangent of friction_angle: with less, planes \
             would part by sliding before they bear it",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2 }\ndamage = { tensile_strength = 1e7, fracture_energy = 1e4, unilateral = true }",
            "9:72: materials.steel.damage.unilateral beside bedding, with which it has not been tried; expected false; remove it, or the table bedding",
        ),
        (
            "_normal = 0.2 }",
            "_normal = 0.2 }\ndamage = { tensile_strength = 1e7, fracture_energy = 1e4, criterion = \"mazars\" }",
            "9:71: materials.steel.damage.criterion beside bedding, with which it has not been tried; expected another criterion; remove it, or the table \
             bedding",
        ),
        (
            "kind = \"solid\"\ngroup = \"bar\"",
            "kind = \"bonded\"\nshape = \"box\"\nsize = [3, 1, 1]",
            "14:12: bodies[0].material = \"steel\", whose bedding has no effect on bonded bodies; expected a material without bedding; take a solid body, \
             or a material without the table",
        ),
    ];
    for (from, to, message) in cases {
        let text = bedded(BEDS);
        assert!(text.contains(from), "{from}");
        let text = text.replace(from, to);
        let errors = parse(&text, &[]).expect_err(&text);
        let file = format!("{}:", folder().join("case.toml").display());
        let said = errors.0.iter().filter(|found| found.severity == Severity::Error);
        let said: Vec<String> = said.map(|error| error.to_string().replacen(&file, "", 1)).collect();
        assert!(said.iter().any(|said| said == message), "{to}\nsaid {said:#?}\nnot  {message}");
    }
}
