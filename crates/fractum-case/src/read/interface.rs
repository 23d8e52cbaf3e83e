//! `[materials.NAME.interface]`: bonds of the local constitutive law.

use fractum_dem::{Crushing, InterfaceFailure, LocalBond};
use fractum_math::Vec3;

use crate::model::{InterfaceArea, Interfaces};
use crate::reader::Table;
use crate::reader::vectors::point;
use crate::usual::STRENGTH;

/// Reads the table; nothing where it, or the elasticity of the material, is wrong.
///
/// - `elasticity`: Young's modulus [Pa] and Poisson's ratio of the material
pub(super) fn interface(table: Table<'_>, elasticity: Option<(f64, f64)>) -> Option<Interfaces> {
    let area = area(&table);
    let tensile_strength = table.quantity("tensile_strength").not_negative().usual(&STRENGTH).or(f64::INFINITY);
    let shear_strength = table.quantity("shear_strength").not_negative().usual(&STRENGTH).or(f64::INFINITY);
    let internal_friction = table.quantity("internal_friction").not_negative().coefficient().or(0.0);
    let friction = table.quantity("friction").not_negative().coefficient().or(0.5);
    let tension_softening = table.quantity("tension_softening").positive().or(f64::INFINITY);
    let shear_softening = table.quantity("shear_softening").positive().or(f64::INFINITY);
    let failure = table.choice("failure").or(InterfaceFailure::default());
    let crushing = crushing(&table);
    let damping_ratio =
        table.quantity("damping_ratio").check(|ratio| (0.0..=1.0).contains(ratio), "from 0 to 1").or(0.0);
    table.finish("here");
    let (young_modulus, poisson_ratio) = elasticity?;
    let law = LocalBond {
        tensile_strength,
        shear_strength,
        internal_friction,
        friction,
        softening: [tension_softening, shear_softening],
        failure,
        crushing: crushing?,
        damping_ratio,
        ..LocalBond::elastic(young_modulus, poisson_ratio)
    };
    Some(Interfaces { area: area?, law })
}

fn area(table: &Table<'_>) -> Option<InterfaceArea> {
    if table.has("area_factor") {
        table.refuse("areas", "beside area_factor, which is given");
        return table.quantity("area_factor").positive().map(InterfaceArea::Factor).required();
    }
    table.one_of("areas", AREAS).or_if_absent(InterfaceArea::Cells)
}

/// How areas are found, by name.
const AREAS: &[(&str, InterfaceArea)] = &[("cells", InterfaceArea::Cells), ("porosity", InterfaceArea::Porosity)];

/// Plastic compression: both keys, or none.
fn crushing(table: &Table<'_>) -> Option<Crushing> {
    if !table.has("crushing_stress") {
        table.refuse("crushing_ratio", "without crushing_stress");
        return Some(Crushing::NONE);
    }
    let ascending = |v: &Vec3| v.x > 0.0 && v.y >= v.x && v.z >= v.y;
    let stress = point(table, "crushing_stress").check(ascending, "three positive stresses, ascending").required();
    let ratio = point(table, "crushing_ratio").check(|v: &Vec3| v.min() >= 1.0, "three numbers, 1 or more").required();
    Some(Crushing { stress: stress?.into(), ratio: ratio?.into() })
}
