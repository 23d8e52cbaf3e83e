//! `[materials.NAME.fracture]`: when bonds break.

use fractum_dem::FractureCriterion;
use fractum_dem::criterion::{
    BondCriterionKind, CriterionNumbers, CriterionParameter, EndMoments, Level, NamedCriterion, Principal,
};

use crate::case::model::BondFailure;
use crate::case::reader::Table;
use crate::case::usual::STRENGTH;

/// Reads the table: the strength, and what the criterion says that it takes.
pub(super) fn fracture(table: Table<'_>) -> Option<BondFailure> {
    let kinds: Vec<(&'static str, &BondCriterionKind)> =
        FractureCriterion::KINDS.iter().map(|kind| (kind.name, kind)).collect();
    let usual = kinds.iter().find(|(name, _)| *name == Principal::NAME).map(|(_, kind)| *kind);
    let kind = table.one_of("criterion", &kinds).map(Some).or_if_absent(usual).flatten();
    let own = table.has("criterion_strength");
    let strength = if own {
        table.refuse("tensile_strength", "beside criterion_strength, which is the criterion's own");
        table.quantity("criterion_strength").positive().required()
    } else {
        table.quantity("tensile_strength").positive().usual(&STRENGTH).required()
    };
    let Some(kind) = kind else {
        table.pass_over(&["compressive_strength", "friction_angle", "level", "moments"]);
        table.finish("here");
        return None;
    };
    let takes = |parameter: CriterionParameter, key: &'static str| {
        if !kind.takes(parameter) {
            table.refuse(key, "with this criterion");
        }
        kind.takes(parameter)
    };
    let mut numbers = CriterionNumbers::new(strength.unwrap_or(0.0));
    if takes(CriterionParameter::CompressiveStrength, "compressive_strength") {
        let given = table.quantity("compressive_strength").positive();
        let given = given.check(|value| *value > numbers.tensile_strength, "more than the tensile strength");
        numbers.compressive_strength = given.given();
    }
    if takes(CriterionParameter::Level, "level") {
        let level = table.integer("level").check(|level| *level <= 2, "0, 1 or 2").or(1);
        numbers.level = Level::from_number(level as u8).unwrap_or_default();
    }
    if takes(CriterionParameter::FrictionAngle, "friction_angle") {
        numbers.friction_angle = read_friction_angle(&table);
    }
    if takes(CriterionParameter::Moments, "moments") {
        numbers.moments = table.choice("moments").or(EndMoments::Mean);
    }
    table.finish("here");
    let tensile_strength = strength?;
    Some(BondFailure { criterion: (kind.make)(&numbers), tensile_strength: (!own).then_some(tensile_strength) })
}

/// The angle of internal friction [rad].
pub(super) fn read_friction_angle(table: &Table<'_>) -> f64 {
    let expected = "from 0 to below 90 deg (a number without a unit is in radians)";
    let right = std::f64::consts::FRAC_PI_2;
    let angle = table.quantity("friction_angle").check(|angle| (0.0..right).contains(angle), expected);
    angle.or(FRICTION_ANGLE.to_radians())
}

/// Friction angle where none is given [deg].
pub(super) const FRICTION_ANGLE: f64 = 35.0;
