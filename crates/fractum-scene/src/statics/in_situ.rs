//! Equilibrium before motion: the state of rock under in-situ stress, from which a run begins.

use fractum_fem::{Solid, motion};
use fractum_math::{Mat3, Vec3, connected};

use super::contact::Spring;
use super::linear_system::LinearSystem;
use super::settings::LinearSolver;
use super::support_check::pins;
use crate::balance::IN_SITU_ROUND_OFF;
use crate::error::SceneError;
use crate::interfaces::in_situ::Overloaded;
use crate::ledger::EnergyKind;
use crate::scene::Scene;

/// Relative residual of linear solutions, and unbalanced force over all forces at which the state is at rest.
const TOLERANCES: [f64; 2] = [1e-12, 1e-10];
/// Solutions with the stiffness of the unloaded state: one where strains are small, a few where elements turn.
const MOST_SOLUTIONS: usize = 30;
/// Force that stress as it is written may leave on a node, over what the largest stress does on the areas around it.
const UNEVEN: f64 = 1e-6;
/// Force on what only keeps the solids from moving as rigid bodies, over all forces, above which loads do not balance.
const UNBALANCED: f64 = 1e-6;
/// The same over the displacement across the solids.
const MOVED: f64 = 4.0;

impl Scene {
    /// Brings the solids to rest under the loads of t = 0, before the first step, and counts displacements from there.
    ///
    /// Rigid motions that no support prevents are left out: loads in balance need nothing to hold them. What supports hold stays at the
    /// displacement that it has: that of the far field, where they could not follow it.
    ///
    /// - `as_written`: largest component of the stress that bodies have without a displacement [Pa], where that must be in equilibrium; else the
    ///   solids move to it
    ///
    /// # Errors
    /// [`SceneError::InSituUnbalanced`], [`SceneError::InSituUneven`], [`SceneError::InSituBreaks`] and [`SceneError::InSituUnsolved`].
    pub fn start_at_rest(&mut self, as_written: Option<f64>) -> Result<(), SceneError> {
        let unsolved = |reason: String| SceneError::InSituUnsolved { reason };
        let firm = self.interfaces().firm_springs(&self.solid);
        let joined: Vec<[u32; 2]> = firm.iter().map(|(pair, _)| *pair).collect();
        let held = pins(&self.solid, self.supports.held(), &joined);
        let mut system = LinearSystem::new(&self.solid, &held, LinearSolver::Auto, 2, TOLERANCES[0], &joined)
            .map_err(|error| unsolved(error.to_string()))?;
        let spring = |&(pair, stiffness): &([u32; 2], f64)| Spring::between(pair, Mat3::identity() * stiffness);
        let springs: Vec<Spring> = firm.iter().map(spring).collect();
        system.prepare(self, &self.solid.cell_damage(), &springs).map_err(|error| unsolved(error.to_string()))?;
        let mut change = vec![Vec3::zeros(); self.solid.reference.len()];
        // Before the forces, in which edges over their strength would be damaged.
        check_strength(self)?;
        if let Some(largest) = as_written {
            forces_at_start(self, &held, &firm);
            check_evenness(&self.solid, self.supports.held(), &joined, largest)?;
        }
        let mut at_first = 0.0;
        for _ in 0..MOST_SOLUTIONS {
            let (missing, scale) = forces_at_start(self, &held, &firm);
            // Stress that has nothing to carry it goes: no force is left.
            at_first = f64::max(at_first, missing);
            let scale = scale.max(at_first);
            if missing <= TOLERANCES[1] * scale {
                check_strength(self)?;
                check_pins(self, &held, scale)?;
                self.solid.initial_displacement = self.solid.displacement.clone();
                let held = self.supports.held();
                self.optional.interfaces.begin_under(&self.solid, held, &firm).map_err(overloaded)?;
                book_in_situ(self);
                return Ok(());
            }
            system.solve(&self.solid.force, &mut change).map_err(|error| unsolved(error.to_string()))?;
            self.solid.displacement.iter_mut().zip(&change).for_each(|(u, change)| *u += change);
            check_strength(self)?;
        }
        Err(unsolved(format!("forces did not balance after {MOST_SOLUTIONS} solutions")))
    }
}

/// Enters the energy that the stress has stored, from which a run at rest begins; one in motion finds it in its first step.
fn book_in_situ(scene: &mut Scene) {
    let Scene { solid, ledger, books, optional, .. } = scene;
    solid.update_internal_forces(0.0, true);
    books.interfaces = optional.interfaces.stored();
    ledger[EnergyKind::Elastic] = solid.elastic_energy();
    ledger[EnergyKind::Interfaces] = books.interfaces;
    let stored = ledger[EnergyKind::Elastic] + ledger[EnergyKind::Interfaces];
    (ledger.initial, ledger.in_situ, ledger.scale) = (stored, stored, IN_SITU_ROUND_OFF * stored);
}

/// Why an interface does not bear the state of the start.
fn overloaded(Overloaded { name, place, traction: [normal, shear] }: Overloaded) -> SceneError {
    let [x, y, z] = place.into();
    SceneError::InSituParts { name, x, y, z, normal, shear }
}

/// Leaves all forces of t = 0 in `solid.force`; those that are missing on free unknowns, and all that act [N].
///
/// - `firm`: springs that keep the sides of interfaces together
fn forces_at_start(scene: &mut Scene, held: &[u8], firm: &[([u32; 2], f64)]) -> (f64, f64) {
    scene.solid.update_internal_forces(0.0, false);
    let inner = scene.solid.force.clone();
    for &(pair, stiffness) in firm {
        let [a, b] = pair.map(|node| node as usize);
        let pull = (scene.solid.displacement[b] - scene.solid.displacement[a]) * stiffness;
        scene.solid.force[a] += pull;
        scene.solid.force[b] -= pull;
    }
    scene.loads.add_forces(&mut scene.solid, 0.0, 0.0);
    let (mut missing, mut loads, mut reactions) = (0.0, 0.0, 0.0);
    for ((force, inner), bits) in scene.solid.force.iter().zip(&inner).zip(held) {
        loads += (force - inner).norm_squared();
        for axis in 0..3 {
            let is_held = bits & (1 << axis) != 0;
            *(if is_held { &mut reactions } else { &mut missing }) += force[axis] * force[axis];
        }
    }
    // Supports alone may bear the stress.
    (f64::sqrt(missing), f64::sqrt(f64::max(loads, reactions)))
}

/// Forces of stress as it is written, and of all else that acts at t = 0, must be none wherever no support holds.
///
/// - `joined`: pairs of nodes on both sides of interfaces, whose forces are taken together
fn check_evenness(solid: &Solid, held: &[u8], joined: &[[u32; 2]], largest: f64) -> Result<(), SceneError> {
    let first = connected(solid.reference.len(), joined.iter().copied());
    let (mut forces, mut bits) = (vec![Vec3::zeros(); first.len()], vec![0u8; first.len()]);
    let mut areas = vec![0.0; first.len()];
    for (node, (&first, area)) in first.iter().zip(motion::stressed_areas(solid)).enumerate() {
        let first = first as usize;
        forces[first] += solid.force[node];
        areas[first] += area;
        bits[first] |= held.get(node).copied().unwrap_or(0);
    }
    let share = |node: usize| {
        let free = Vec3::from_fn(|axis, _| if bits[node] & (1 << axis) == 0 { forces[node][axis] } else { 0.0 });
        let force = free.norm();
        (force, if force > 0.0 { force / (largest * areas[node]) } else { 0.0 })
    };
    let all = (0..first.len()).map(|node| (node, share(node)));
    let Some((node, (force, share))) = all.max_by(|a, b| a.1.1.total_cmp(&b.1.1)) else { return Ok(()) };
    if share <= UNEVEN {
        return Ok(());
    }
    let has = |body: &usize| {
        let alive = solid.body(*body).elements.iter().zip(solid.alive(*body)).filter(|(_, alive)| **alive);
        alive.into_iter().flat_map(|(nodes, _)| nodes).any(|&other| first[other as usize] as usize == node)
    };
    let bodies: Vec<String> =
        (0..solid.body_count()).filter(has).map(|body| format!("\"{}\"", solid.body(body).name)).collect();
    let [x, y, z] = solid.reference[node].into();
    Err(SceneError::InSituUneven { x, y, z, bodies: bodies.join(" and "), force, share })
}

/// What only keeps the solids in place must carry nothing, but for the moment that forces on elements that turn get as
/// their places move.
fn check_pins(scene: &Scene, held: &[u8], scale: f64) -> Result<(), SceneError> {
    let largest = |vectors: &[Vec3]| vectors.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let moved = largest(&scene.solid.displacement) / largest(&scene.solid.reference).max(f64::MIN_POSITIVE);
    let allowed = UNBALANCED.max(MOVED * moved);
    let (mut all_carried, mut most) = (Vec3::zeros(), 0.0f64);
    for (node, (&all, force)) in held.iter().zip(&scene.solid.force).enumerate() {
        let own = all & !scene.supports.held().get(node).copied().unwrap_or(0);
        let carried = Vec3::from_fn(|axis, _| if own & (1 << axis) == 0 { 0.0 } else { force[axis] });
        (all_carried, most) = (all_carried + carried, most.max(carried.norm()));
    }
    if most <= allowed * scale {
        return Ok(());
    }
    let turns = all_carried.norm() <= allowed * scale;
    let [x, y, z] = all_carried.into();
    Err(if turns { SceneError::InSituTurns } else { SceneError::InSituUnbalanced { x, y, z } })
}

/// No edge may be over its strength.
fn check_strength(scene: &Scene) -> Result<(), SceneError> {
    match scene.solid.most_strained_edge() {
        Some((body, at, ratio)) if ratio > 1.0 => {
            let [x, y, z] = at.into();
            Err(SceneError::InSituBreaks { body: scene.solid.body(body).name.clone(), x, y, z, ratio })
        }
        _ => Ok(()),
    }
}
