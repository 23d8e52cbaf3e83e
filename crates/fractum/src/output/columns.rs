//! Columns of the history.

use fractum_case::build::BuiltScene;
use fractum_case::model::{Body, BodyKind, Case, SolverKind};
use fractum_output::columns::HistoryColumns;
use fractum_output::history::Column;
use fractum_scene::statics::{Control, NoEquilibrium};
use fractum_scene::{Scene, inlets_of};

/// How a run proceeds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Course {
    /// Whether a part of it is a path of equilibria, or natural vibrations, whose frames are numbered one after the other.
    pub(crate) rests: bool,
    /// Whether the load factor may run back: rows and frames are then ordered by steps.
    pub(crate) turns_back: bool,
}

impl Course {
    /// That of the stages of a run.
    pub(crate) fn of<'a>(stages: impl Iterator<Item = &'a BuiltScene>) -> Self {
        stages.fold(Course::default(), |course, stage| Course {
            rests: course.rests || stage.statics.is_some() || stage.bonded_statics.is_some() || stage.modes.is_some(),
            turns_back: course.turns_back
                || stage.bonded_statics.is_some()
                || stage.statics.as_ref().is_some_and(|statics| statics.control != Control::Time),
        })
    }
}

/// Columns of the history of a run.
pub(crate) fn columns(case: &Case, scene: &Scene, course: Course) -> Vec<Column> {
    with_probes(case, no_probes(case, scene, course))
}

/// Columns that the history of a case may have: which solver `kind = "auto"` takes is not known before there are particles.
pub(crate) fn possible_columns(case: &Case) -> Vec<Column> {
    let mut stages = case.later.iter().chain([case]);
    let is_particles = |body: &Body| matches!(body.kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
    let columns = HistoryColumns {
        particles: case.bodies.iter().any(is_particles),
        domain: may_lose(case),
        inlets: case.has_inlets(),
        heat: case.flows.heat.is_some(),
        turns_back: stages.any(|stage| matches!(stage.solver.kind, SolverKind::Static | SolverKind::Auto)),
        in_motion: both_rests_and_moves(case),
    };
    with_probes(case, columns)
}

/// The columns of a history, then those of its probes.
fn with_probes(case: &Case, no_probes: HistoryColumns) -> Vec<Column> {
    let no_probes = no_probes.list();
    let of_probes = case.probes.iter().filter(|probe| !probe.is_scalar());
    let of_probes = of_probes.map(|probe| {
        // A probe may be called like another column: no two columns have one name.
        let taken = no_probes.iter().any(|(name, _)| *name == probe.name.value);
        let name = if taken { format!("probe.{}", probe.name.value) } else { probe.name.value.clone() };
        Column::new(name, probe.unit.clone())
    });
    let of_probes: Vec<Column> = of_probes.collect();
    no_probes.into_iter().map(|(name, unit)| Column::new(name, unit)).chain(of_probes).collect()
}

/// The columns that are no probes.
pub(crate) fn no_probes(case: &Case, scene: &Scene, course: Course) -> HistoryColumns {
    HistoryColumns {
        particles: !scene.bonded.is_empty(),
        domain: may_lose(case),
        inlets: !inlets_of(scene).is_empty(),
        heat: scene.heat().is_some(),
        turns_back: course.turns_back,
        in_motion: both_rests_and_moves(case),
    }
}

/// Whether pieces may leave a domain, or bodies by a stage.
fn may_lose(case: &Case) -> bool {
    let mut stages = case.later.iter().chain([case]);
    case.excavates() || stages.any(|stage| stage.solver.domain.is_some())
}

/// Whether a run may be at rest and in motion.
fn both_rests_and_moves(case: &Case) -> bool {
    let hands_over = case.solver.statics.as_ref().is_some_and(|s| s.no_equilibrium == NoEquilibrium::Motion);
    hands_over || !case.later.is_empty()
}
