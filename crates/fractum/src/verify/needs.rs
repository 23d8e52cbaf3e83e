//! The parts of a run that the physics of a case needs.

use std::collections::BTreeSet;

use fractum_case::model::{BodyKind, Case, SolverKind};
use fractum_scene::statics::NoEquilibrium;

use crate::phases::Part;

/// Names of the parts that a case may need, read from its file alone; what its mesh would rule out is among them.
pub(crate) fn needs(case: &Case) -> BTreeSet<String> {
    let mut parts = BTreeSet::from([Part::Output]);
    for stage in std::iter::once(case).chain(&case.later) {
        add_those_of_stage(stage, &mut parts);
    }
    parts.into_iter().map(|part| part.name().to_owned()).collect()
}

/// Whether a scene at rest moves where it finds no equilibrium.
fn rest_may_end(case: &Case) -> bool {
    case.solver.statics.as_ref().is_some_and(|options| options.no_equilibrium == NoEquilibrium::Motion)
}

fn add_those_of_stage(case: &Case, parts: &mut BTreeSet<Part>) {
    if case.flows.heat.is_some() {
        parts.insert(Part::Heat);
    }
    if case.solver.kind == SolverKind::Heat {
        return;
    }
    let moves = !matches!(case.solver.kind, SolverKind::Static | SolverKind::Modes) || rest_may_end(case);
    if moves {
        parts.insert(Part::Motion);
    }
    if case.flows.gas.is_some() {
        parts.insert(Part::Gas);
    }
    if !case.ties.is_empty() {
        parts.insert(Part::Ties);
    }
    if moves && case.bodies.len() > 1 {
        parts.insert(Part::Contact);
    }
    for body in &case.bodies {
        match &body.kind {
            BodyKind::Solid(solid) => {
                parts.insert(Part::Solid);
                if solid.damage && moves {
                    parts.extend([Part::Transition, Part::Contact]);
                }
            }
            BodyKind::Bonded(bonded) => {
                parts.insert(Part::Bonds);
                let material = &case.materials[bonded.material];
                if moves && (material.fracture.is_some() || material.interfaces.is_some()) {
                    parts.insert(Part::Fracture);
                }
                if bonded.replaces.is_some() {
                    parts.insert(Part::Ties);
                }
            }
            BodyKind::Particles(_) => {
                parts.insert(Part::Contact);
            }
            BodyKind::Rigid(_) => {}
        }
    }
}
