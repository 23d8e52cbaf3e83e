//! States of equilibrium: what is prescribed at them, whether forces balance, and their place in the ledger.

use fractum_fem::CellDamage;
use fractum_math::Vec3;
use fractum_sparse::SparseError;
use serde::{Deserialize, Serialize};

use super::contact::accept_contacts;
use crate::balance::book_equilibrium;
use crate::conduct::{finish_settled_expansion, settle_heat};
use crate::error::StepError;
use crate::scene::Scene;
use crate::step::{StepReport, release_cut_elements};

/// Displacement over the size of the solid beyond which a piece has come loose.
const FAR: f64 = 10.0;

/// Forces at the state that the next step starts from, for its work; empty before the first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct AppliedForces {
    reaction: Vec<Vec3>,
    load: Vec<Vec3>,
    /// What the removal of elements took from the internal forces since; empty where none left.
    lost: Vec<Vec3>,
    /// What is out of balance in a state that motion has left; empty after an equilibrium.
    unbalanced: Vec<Vec3>,
}

/// Displacements and forces prescribed at one value of the load parameter.
pub(super) struct Boundary {
    pub(super) displacement: Vec<Vec3>,
    pub(super) force: Vec<Vec3>,
}

/// Forces from outside and prescribed displacements at `time`, the free displacements as they are at `present`.
pub(super) fn boundary_at(scene: &mut Scene, present: f64, time: f64) -> Boundary {
    let Scene { solid, supports, loads, .. } = scene;
    let mut displacement = solid.displacement.clone();
    supports.prescribe(&mut displacement, &solid.reference, &solid.initial_displacement, [present, time]);
    solid.force.fill(Vec3::zeros());
    loads.add_forces(solid, time, 0.0);
    Boundary { displacement, force: solid.force.clone() }
}

/// Unbalanced force on the free unknowns, and all forces that it is held against [N].
///
/// - `force`: gets what is out of balance at each node, 0 where it is held
pub(super) fn unbalance(
    scene: &Scene,
    damage: &CellDamage,
    field: &[Vec3],
    load: &[Vec3],
    force: &mut [Vec3],
) -> [f64; 2] {
    scene.solid.secant_force(damage, field, force);
    let held = scene.supports.held();
    let (mut missing, mut scale) = (0.0, 0.0);
    for (i, (force, outer)) in force.iter_mut().zip(load).enumerate() {
        let bits = held.get(i).copied().unwrap_or(0);
        let inner = *force;
        for axis in 0..3 {
            scale += inner[axis] * inner[axis] + outer[axis] * outer[axis];
            force[axis] = if bits & (1 << axis) == 0 { outer[axis] - inner[axis] } else { 0.0 };
            missing += force[axis].powi(2);
        }
    }
    [missing.sqrt(), scale.sqrt()]
}

/// Takes over displacements in equilibrium at `time`: history, reactions, ledger, removal.
pub(super) fn accept_equilibrium(
    scene: &mut Scene,
    displacement: &[Vec3],
    time: f64,
    outer: &mut AppliedForces,
) -> Result<StepReport, StepError> {
    let before = std::mem::replace(&mut scene.solid.displacement, displacement.to_vec());
    let mut external = settle_heat(scene, time)?;
    scene.solid.update_internal_forces(0.0, true);
    external += finish_settled_expansion(scene);
    let inner = scene.solid.force.clone();
    scene.loads.add_forces(&mut scene.solid, time, 0.0);
    let load: Vec<Vec3> = scene.solid.force.iter().zip(&inner).map(|(f, i)| f - i).collect();
    accept_contacts(scene, &before, scene.clock.time, time);
    add_contact_forces_at_rest(scene);
    let reaction = scene.supports.take_reactions(&scene.solid.force);
    for i in 0..displacement.len() {
        let moved = displacement[i] - before[i];
        let mean = |now: &[Vec3], then: &[Vec3]| (now[i] + then.get(i).copied().unwrap_or_default()) * 0.5;
        external += moved.dot(&(mean(&reaction, &outer.reaction) + mean(&load, &outer.load)));
        // The way to the next equilibrium began without the forces of the elements that had left.
        scene.books.removed += 0.5 * moved.dot(&outer.lost.get(i).copied().unwrap_or_default());
        scene.books.damping += 0.5 * moved.dot(&outer.unbalanced.get(i).copied().unwrap_or_default());
    }
    *outer = AppliedForces { reaction, load, ..AppliedForces::default() };
    scene.books.external += external;
    scene.clock.dt_before = time - scene.clock.time;
    scene.clock.dt_after = scene.clock.dt_before;
    scene.clock.time = time;
    scene.clock.step += 1;
    book_equilibrium(scene)?;
    let report = release_cut_elements(scene, 0.0);
    if report.removed > 0 {
        // `inner` is the negative of the forces that held the displacements.
        let mut held = vec![Vec3::zeros(); displacement.len()];
        scene.solid.secant_force(&scene.solid.cell_damage(), displacement, &mut held);
        outer.lost = inner.iter().zip(&held).map(|(inner, held)| -inner - held).collect();
    }
    scene.debris.search(&scene.solid);
    Ok(report)
}

/// The error of a step without equilibrium.
///
/// - `follows`: whether the run follows its path already
pub(super) fn no_equilibrium(scene: &Scene, follows: bool) -> StepError {
    let softer = softer(scene);
    // Temperatures belong to times.
    let path = if follows || scene.heat().is_some() { "" } else { "follow it with control = \"path\", " };
    StepError::NoEquilibrium { step: scene.clock.step, time: scene.clock.time, softer, path }
}

/// What stiff faces that rub may need, with what parts it from the rest of a message; else empty.
fn softer(scene: &Scene) -> &'static str {
    if scene.interfaces().rub() {
        "interfaces that were never joined may slide by turns where they are very stiff: give them a normal_stiffness of a tenth of that in the plan or less; or "
    } else {
        ""
    }
}

/// Fails where anchors alone hold what is loaded.
///
/// - `factor`: what displacements are multiplied with
pub(super) fn check_loose(scene: &Scene, field: &[Vec3], factor: f64) -> Result<(), StepError> {
    let size = scene.solid.reference.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let far = |u: &Vec3| u.norm() * factor.abs() > FAR * size;
    let found = if scene.debris.is_empty() { None } else { field.iter().position(far) };
    let error = |node| come_apart(scene, SparseError::Indefinite { node, component: 0 });
    found.map_or(Ok(()), |node| Err(error(node)))
}

/// The error of a system without solution.
pub(super) fn come_apart(scene: &Scene, error: SparseError) -> StepError {
    let (step, time) = (scene.clock.step, scene.clock.time);
    match error {
        SparseError::Indefinite { node, .. } => {
            let p = scene.solid.reference[node];
            StepError::ComeApart { step, time, x: p.x, y: p.y, z: p.z, softer: softer(scene) }
        }
        SparseError::Stalled { .. } | SparseError::TooLarge { .. } => {
            StepError::NoSolution { step, time, reason: error.to_string() }
        }
    }
}

fn add_contact_forces_at_rest(scene: &mut Scene) {
    for candidate in scene.shape_contacts.iter().flat_map(|ground| &ground.candidates) {
        scene.solid.force[candidate.node as usize] += candidate.force;
    }
    scene.debris.add_forces_at_rest(&mut scene.solid);
    scene.optional.interfaces.add_forces_at_rest(&mut scene.solid);
    if let Some(liquid) = &scene.optional.liquid {
        liquid.push_walls(&mut scene.solid.force);
    }
}

/// The forces of a state at rest that is no exact equilibrium.
pub(super) fn forces_at_rest(scene: &mut Scene) -> AppliedForces {
    scene.solid.update_internal_forces(0.0, true);
    let inner = scene.solid.force.clone();
    let time = scene.clock.time;
    scene.loads.add_forces(&mut scene.solid, time, 0.0);
    let load = scene.solid.force.iter().zip(&inner).map(|(f, i)| f - i).collect();
    let (displacement, books) = (scene.solid.displacement.clone(), scene.books);
    let stored = scene.debris.stored();
    accept_contacts(scene, &displacement, time, time);
    scene.books = books;
    // Tangential springs between discrete elements let go.
    scene.books.friction += stored - scene.debris.stored();
    add_contact_forces_at_rest(scene);
    let force = &scene.solid.force;
    let reaction = scene.supports.take_reactions(force);
    let unbalanced = force.iter().zip(&reaction).map(|(f, r)| f + r).collect();
    AppliedForces { reaction, load, lost: Vec::new(), unbalanced }
}
