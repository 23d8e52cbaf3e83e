//! `[materials.NAME.bedding]`: rock whose elasticity differs along the normal of its beds.

use std::f64::consts::FRAC_PI_2;

use fractum_fem::{Bedding, Elastic};
use fractum_math::Vec3;
use fractum_math::elementary::{cos, sin};
use fractum_output::number::significant;

use crate::model::Beds;
use crate::reader::Table;
use crate::reader::vectors::direction;
use crate::usual::YOUNG_MODULUS;

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
    table.finish("here");
    let law = Bedding {
        normal: normal?,
        young_modulus: young_modulus?,
        poisson_ratio: poisson_ratio?,
        shear_modulus: shear_modulus?,
    };
    within.map(|_| Beds { law, by_dip, is_estimated })
}

/// The normal of beds by their dip and its direction; x is east, y north, z up.
fn dipping(table: &Table<'_>) -> Option<Vec3> {
    let expected = "from 0 to 90 deg (a number without a unit is in radians)";
    let dip = table.quantity("dip").check(|dip| (0.0..=FRAC_PI_2).contains(dip), expected).required();
    let (dip, towards) = (dip, table.quantity("dip_direction").required());
    let (dip, towards) = (dip?, towards?);
    Some(Vec3::new(sin(dip) * sin(towards), sin(dip) * cos(towards), cos(dip)).normalize())
}
