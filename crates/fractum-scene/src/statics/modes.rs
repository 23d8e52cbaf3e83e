//! Natural vibrations of solids, K φ = ω² M φ with the lumped masses of the nodes, and of bonded bodies.
//!
//! Rigid motions of pieces that supports leave free are found from the supports, taken out and counted. What else has no
//! stiffness is a mechanism: it is found with the vibrations, taken out as well, and counted.

use fractum_fem::Solid;
use fractum_math::{Vec3, rotation_by};
use fractum_sparse::SparseError;

use super::bonded_modes;
use super::linear_system::LinearSystem;
use super::settings::ModesSettings;
use super::slowest::{TOLERANCES, find_with_stiffness, frequency, size};
use super::support_check::rigid_motions;
use crate::modes::{Mode, Modes};
use crate::scene::Scene;

/// Systems with one matrix, for the choice of the solver.
const REUSE: usize = 2;

/// Finds the slowest natural vibrations of a scene of solids, or of bonded bodies, as they are held; contact neither holds nor
/// couples anything.
///
/// - `stop`: whether to give up
///
/// # Errors
/// [`SparseError`] if the factor does not fit.
pub fn find_modes(scene: &Scene, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, SparseError> {
    if scene.solid.body_count() == 0 {
        return bonded_modes::find(&scene.bonded, settings, stop);
    }
    let solid = &scene.solid;
    let held = scene.supports().held();
    let (pieces, rigid) = rigid_motions(solid, held);
    let rigid_motions = rigid.len();
    let mut system = LinearSystem::new(solid, held, settings.linear, REUSE, 1e-8, &[])?;
    let tolerance = TOLERANCES[usize::from(system.factor_entries().is_none())];
    let (mut found, mechanisms) =
        find_with_stiffness(rigid, transit_rate(solid), (settings.count, tolerance, stop), |rigid, shift, search| {
            system.lowest_pairs(solid, rigid, shift, search)
        })?;
    let axes = if solid.is_plane() { 2 } else { 3 };
    let is_free = |node: usize, axis: usize| held.get(node).is_none_or(|bits| bits >> axis & 1 == 0);
    let along = |of: &dyn Fn(usize, usize) -> f64| {
        Vec3::from_fn(|axis, _| {
            let own = |node: usize| if axis < axes && is_free(node, axis) { of(node, axis) } else { 0.0 };
            (0..solid.mass.len()).map(own).sum()
        })
    };
    let shapes = std::mem::take(&mut found.shapes);
    let modes = found.values.iter().zip(shapes).zip(&found.residuals);
    let modes = modes.map(|((value, shape), residual)| Mode {
        frequency: frequency(*value),
        residual: *residual,
        participation: along(&|node, axis| solid.mass[node] * shape[node][axis]),
        shape,
        turns: Vec::new(),
    });
    Ok(Modes {
        modes: modes.collect(),
        pieces,
        loose: 0,
        rigid_motions,
        mechanisms,
        free_mass: along(&|node, _| solid.mass[node]),
        work: (found.extensions, system.factor_entries()),
        converged: found.converged,
    })
}

/// Square of the speed of the slowest wave over the size of the solids [1/s²].
fn transit_rate(solid: &Solid) -> f64 {
    let speed = |body| solid.body(body).elastic.p_wave_speed();
    let slowest = (0..solid.body_count()).map(speed).fold(f64::INFINITY, f64::min);
    (slowest / size(&solid.reference)).powi(2)
}

/// The vibrations that a scene has found; none before.
pub fn modes_of(scene: &Scene) -> Option<&Modes> {
    scene.optional.modes.as_deref()
}

/// Keeps vibrations with their scene.
pub fn set_modes(scene: &mut Scene, modes: Modes) {
    scene.optional.modes = Some(Box::new(modes));
}

/// Largest displacement of a vibration that is shown, over the size of the bodies.
const SHOWN: f64 = 0.05;

/// Brings the bodies into the shape of a vibration, with its number, from 1, as the time.
pub fn show_mode(scene: &mut Scene, number: usize) {
    let Some(mode) = scene.optional.modes.as_ref().and_then(|modes| modes.modes.get(number - 1)) else { return };
    let largest = mode.shape.iter().map(|u| u.norm()).fold(f64::MIN_POSITIVE, f64::max);
    if mode.turns.is_empty() {
        let solid = &mut scene.solid;
        let scale = SHOWN * size(&solid.reference) / largest;
        let start = &solid.initial_displacement;
        let at = |node: usize| start.get(node).copied().unwrap_or_default() + mode.shape[node] * scale;
        solid.displacement = (0..mode.shape.len()).map(at).collect();
        if !solid.has_damage() {
            // Its stresses; damage would grow by a shape whose size means nothing.
            solid.update_internal_forces(0.0, false);
        }
    } else {
        let bonded = &mut scene.bonded;
        let scale = SHOWN * size(&bonded.reference) / largest;
        for (i, (shape, turn)) in mode.shape.iter().zip(&mode.turns).enumerate() {
            bonded.particles.position[i] = bonded.reference[i] + shape * scale;
            bonded.particles.orientation[i] = rotation_by(turn * scale);
        }
    }
    let clock = &mut scene.clock;
    (clock.time, clock.dt_before, clock.dt_after) = (number as f64, 1.0, 1.0);
    clock.step += 1;
}
