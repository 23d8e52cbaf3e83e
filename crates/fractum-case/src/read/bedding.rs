//! `[materials.NAME.bedding]`: rock whose elasticity differs along the normal of its beds.

use std::f64::consts::FRAC_PI_2;

use fractum_fem::{BedStrength, Bedding, CriterionKind, Elastic};
use fractum_math::Vec3;
use fractum_math::elementary::{cos, sin};
use fractum_output::number::{quantity, significant};

use super::fracture::read_friction_angle;
use crate::model::{Beds, Damage};
use crate::reader::Table;
use crate::reader::vectors::direction;
use crate::usual::{FRACTURE_ENERGY, STRENGTH, YOUNG_MODULUS};
use crate::{Diagnostic, Spanned};

/// Reads the table; nothing where it, or the elasticity of the material, is wrong.
///
/// - `material`: density [kg/m³] and Young's modulus [Pa], Poisson's ratio
pub(super) fn bedding(table: Table<'_>, material: Option<((f64, f64), f64)>) -> Option<Beds> {
    let by_dip = table.has("dip");
    let normal = if by_dip {
        table.refuse("normal", "beside dip, from which it follows");
        dipping(&table)
    } else {
        table.refuse("dip_direction", "without dip");
        direction(&table, "normal").required()
    };
    let young_modulus = table.quantity("young_modulus_normal").physical().usual(&YOUNG_MODULUS).required();
    let within =
        material.map(|((density, young_modulus), poisson_ratio)| Elastic { density, young_modulus, poisson_ratio });
    let limit =
        within.zip(young_modulus).map_or(f64::INFINITY, |(within, young)| Bedding::poisson_limit(&within, young));
    let expected = format!(
        "between -{0} and {0}, which is sqrt((1 - nu) E'/(2 E)) of the moduli: beyond it some strain stores no energy",
        significant(limit, 4)
    );
    let poisson_ratio = table.quantity("poisson_ratio_normal").check(|ratio| ratio.abs() < limit, &expected).required();
    let estimate = within.zip(young_modulus).zip(poisson_ratio);
    let estimate = estimate.map(|((within, young), ratio)| Bedding::estimated_shear_modulus(&within, young, ratio));
    let is_estimated = !table.has("shear_modulus_normal");
    let given = table.quantity("shear_modulus_normal").physical().usual(&YOUNG_MODULUS);
    let shear_modulus = match estimate {
        // Beyond -1/2 of Poisson's ratio there may be no estimate.
        Some(estimate) if estimate > 0.0 => given.or_if_absent(estimate),
        Some(_) => given.required(),
        None => given.given(),
    };
    let strength = strength(&table);
    table.finish("here");
    let law = Bedding {
        normal: normal?,
        young_modulus: young_modulus?,
        poisson_ratio: poisson_ratio?,
        shear_modulus: shear_modulus?,
    };
    within.zip(strength).map(|(_, strength)| Beds { law, strength, by_dip, is_estimated })
}

/// Keys of the strength of the planes of beds, which go together.
const OF_STRENGTH: [&str; 4] = ["tensile_strength", "cohesion", "friction_angle", "fracture_energy"];

/// The strength of the planes of beds; `Some(None)` where nothing is said.
fn strength(table: &Table<'_>) -> Option<Option<BedStrength>> {
    if !OF_STRENGTH.iter().any(|key| table.has(key)) {
        return Some(None);
    }
    let tensile_strength = table.quantity("tensile_strength").physical().usual(&STRENGTH).required();
    let friction_angle = read_friction_angle(table);
    let slope = sin(friction_angle) / cos(friction_angle);
    let least = tensile_strength.map_or(0.0, |strength| strength * slope);
    let expected = format!(
        "at least {}, tensile_strength times the tangent of friction_angle: with less, planes would part by sliding before they bear it",
        quantity(least, "Pa")
    );
    let cohesion = table.quantity("cohesion").physical().usual(&STRENGTH);
    let cohesion = cohesion.check(|cohesion| *cohesion >= least * (1.0 - 1e-12), &expected).required();
    let fracture_energy = table.quantity("fracture_energy").physical().usual(&FRACTURE_ENERGY).required();
    Some(Some(BedStrength {
        tensile_strength: tensile_strength?,
        cohesion: cohesion?,
        friction_angle,
        fracture_energy: fracture_energy?,
    }))
}

/// Gives damage the strength of the planes of beds, and notes what it does not know of beds.
///
/// - `material`: its table
pub(super) fn settle(material: &Table<'_>, beds: &Spanned<Beds>, damage: Option<&mut Spanned<Damage>>) {
    let strength = beds.value.strength;
    let Some(damage) = damage else {
        if let Some(key) = OF_STRENGTH.iter().find(|_| strength.is_some()) {
            let place = material.place_below(&format!("bedding.{key}"));
            let note =
                Diagnostic::error(&place, "has no effect without damage").expected("a table damage beside bedding");
            material
                .reader
                .note(note.remedy("give the strength of the rock in damage, or remove the strength of its beds"));
        }
        return;
    };
    let law = &mut damage.value.law;
    let unknown = [
        ("criterion", law.criterion.kind() == CriterionKind::Mazars, "another criterion"),
        ("regularisation", damage.value.regularisation.is_some(), "local damage"),
        ("unilateral", damage.value.unilateral == Some(true), "false"),
        ("friction", law.friction.is_some(), "no friction of cracks"),
        ("rate_time", law.rate_time > 0.0, "none"),
        ("rate", damage.value.rate.is_some(), "none"),
    ];
    for (key, is_there, expected) in unknown {
        if is_there {
            let place = material.place_below(&format!("damage.{key}"));
            let note = Diagnostic::error(&place, "beside bedding, with which it has not been tried").expected(expected);
            material.reader.note(note.remedy("remove it, or the table bedding"));
        }
    }
    let Some(strength) = strength else { return };
    for (key, of_beds, of_rock, unit) in [
        ("tensile_strength", strength.tensile_strength, law.tensile_strength, "Pa"),
        ("fracture_energy", strength.fracture_energy, law.fracture_energy, "J/m^2"),
    ] {
        if of_beds > of_rock {
            let found = format!("is {}, more than that of the rock", quantity(of_beds, unit));
            let note = Diagnostic::error(&material.place_below(&format!("bedding.{key}")), found);
            let note = note.expected(format!("at most damage.{key}, {}", quantity(of_rock, unit)));
            material.reader.note(note.remedy("lower it, or raise that of the rock"));
        }
    }
    law.beds = Some(strength);
}

/// The normal of beds by their dip and its direction; x is east, y north, z up.
fn dipping(table: &Table<'_>) -> Option<Vec3> {
    let expected = "from 0 to 90 deg (a number without a unit is in radians)";
    let dip = table.quantity("dip").check(|dip| (0.0..=FRAC_PI_2).contains(dip), expected).required();
    let (dip, towards) = (dip, table.quantity("dip_direction").required());
    let (dip, towards) = (dip?, towards?);
    Some(Vec3::new(sin(dip) * sin(towards), sin(dip) * cos(towards), cos(dip)).normalize())
}
