//! `[materials.NAME.fracture]`: when bonds break.

use fractum_dem::FractureCriterion;
use fractum_dem::criterion::{BeamRankine, DruckerPrager, EndMoments, Hydrostatic, Level, MohrCoulomb, Principal};

use super::materials::{STRENGTH_RATIO, read_friction_angle};
use crate::case::model::{BondCriterion, BondFailure};
use crate::case::reader::Table;

/// Reads the table.
pub(super) fn fracture(table: Table<'_>) -> Option<BondFailure> {
    use BondCriterion as C;
    let kind = table.choice("criterion").or(C::Principal);
    let refuse = |key: &'static str| table.refuse(key, "with this criterion");
    let own = table.has("criterion_strength");
    let strength = if own {
        table.refuse("tensile_strength", "beside criterion_strength, which is the criterion's own");
        table.quantity("criterion_strength").positive().required()
    } else {
        table.quantity("tensile_strength").positive().required()
    };
    let above = |limit: f64| move |value: &f64| *value > limit;
    let least = strength.unwrap_or(0.0);
    let given =
        || table.quantity("compressive_strength").positive().check(above(least), "more than the tensile strength");
    let compressive_strength = match kind {
        C::Beam | C::Hydrostatic => {
            refuse("compressive_strength");
            None
        }
        C::Principal => given().given(),
        C::MohrCoulomb | C::DruckerPrager => Some(given().or(STRENGTH_RATIO * least)),
    };
    let level = if matches!(kind, C::Beam | C::Hydrostatic) {
        refuse("level");
        Level::default()
    } else {
        let level = table.integer("level").check(|level| *level <= 2, "0, 1 or 2").or(1);
        Level::from_number(level as u8).unwrap_or_default()
    };
    let friction_angle = if kind == C::MohrCoulomb {
        read_friction_angle(&table)
    } else {
        refuse("friction_angle");
        0.0
    };
    let moments = if kind == C::Beam {
        table.choice("moments").or(EndMoments::Mean)
    } else {
        refuse("moments");
        EndMoments::Mean
    };
    table.finish("here");
    let tensile_strength = strength?;
    let compressed = compressive_strength.unwrap_or(STRENGTH_RATIO * tensile_strength);
    let criterion = match kind {
        C::Principal => FractureCriterion::Principal(Principal { tensile_strength, compressive_strength, level }),
        C::Beam => FractureCriterion::BeamRankine(BeamRankine { strength: tensile_strength, moments }),
        C::Hydrostatic => FractureCriterion::Hydrostatic(Hydrostatic { strength: tensile_strength }),
        C::MohrCoulomb => FractureCriterion::MohrCoulomb(MohrCoulomb {
            tensile_strength,
            compressive_strength: compressed,
            friction_angle,
            level,
        }),
        C::DruckerPrager => FractureCriterion::DruckerPrager(DruckerPrager {
            tensile_strength,
            compressive_strength: compressed,
            level,
        }),
    };
    Some(BondFailure { criterion, tensile_strength: (!own).then_some(tensile_strength) })
}
