//! `[materials.NAME.fracture]`: when bonds break.

use fractum_dem::FractureCriterion;
use fractum_dem::criterion::{
    BondCriterionKind, CriterionNumbers, CriterionParameter, EndMoments, Level, MohrCoulomb, NamedCriterion, Principal,
};
use fractum_math::elementary::sin;

use crate::Diagnostic;
use crate::model::{BondFailure, BondStrength};
use crate::reader::Table;
use crate::usual::STRENGTH;

/// Reads the table: the strength, and what the criterion says that it takes.
pub(super) fn fracture(table: Table<'_>) -> Option<BondFailure> {
    let kinds: Vec<(&'static str, &BondCriterionKind)> =
        FractureCriterion::KINDS.iter().map(|kind| (kind.name, kind)).collect();
    // Of the criteria, the one that can have both strengths of the material.
    let usual = if table.has("compressive_strength") { MohrCoulomb::NAME } else { Principal::NAME };
    let usual = kinds.iter().find(|(name, _)| *name == usual).map(|(_, kind)| *kind);
    let kind = table.one_of("criterion", &kinds).map(Some).or_if_absent(usual).flatten();
    let own = table.has("criterion_strength");
    let strength = if own {
        table.refuse("tensile_strength", "beside criterion_strength, which is the criterion's own");
        table.quantity("criterion_strength").positive().required()
    } else {
        table.quantity("tensile_strength").positive().usual(&STRENGTH).required()
    };
    let Some(kind) = kind else {
        table.pass_over(&["compressive_strength", "friction_angle", "level", "moments", "at_walls", "scatter"]);
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
    let of_beams = kind.takes(CriterionParameter::Moments);
    if of_beams {
        table.refuse("at_walls", "on single beams: choose a criterion of the stress of particles");
    }
    let at_walls = !of_beams && table.flag("at_walls").or(false);
    check_slip(&table, kind, &numbers);
    let scatter = table.table("scatter").map(super::scatter::of_particles);
    table.finish("here");
    let tensile_strength = strength?;
    Some(BondFailure {
        strength: BondStrength {
            criterion: (kind.make)(&numbers),
            tensile_strength: (!own).then_some(tensile_strength),
            compressive_strength: numbers.compressive_strength,
            at_walls,
        },
        scatter: scatter.map_or(Some(None), |scatter| scatter.map(Some))?,
    })
}

/// A body that slips in tension has no tensile strength of its own.
fn check_slip(table: &Table<'_>, kind: &BondCriterionKind, numbers: &CriterionNumbers) {
    let sine = sin(numbers.friction_angle);
    let least = numbers.tensile_strength * (1.0 + sine) / (1.0 - sine);
    let Some(strength) = numbers.compressive_strength.filter(|strength| kind.slips && *strength < least) else {
        return;
    };
    let place = table.peek("compressive_strength").map_or_else(|| table.place.clone(), |node| node.place.clone());
    let found = format!("is {strength} Pa as compressive strength, too low for its friction angle");
    let note = Diagnostic::error(&place, found).expected(format!("at least {least} Pa"));
    table.reader.note(note.remedy("raise compressive_strength or lower friction_angle"));
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
