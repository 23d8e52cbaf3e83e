//! Natural vibrations of solids, K φ = ω² M φ with the lumped masses of the nodes, of bonded bodies, and of both together.
//!
//! Rigid motions of pieces that supports leave free are found from the supports, taken out and counted. What else has no
//! stiffness is a mechanism: it is found with the vibrations, taken out as well, and counted.

use fractum_math::rotation_by;

use super::settings::ModesSettings;
use super::slowest::{ModesError, size};
use super::{bonded_modes, coupled_modes, solid_modes};
use crate::modes::Modes;
use crate::scene::Scene;

/// Finds the slowest natural vibrations of solids and bonded bodies of beams, as they are held and tied; contact neither holds
/// nor couples anything.
///
/// - `stop`: whether to give up
///
/// # Errors
/// [`ModesError::Linear`] if the factor does not fit, [`ModesError::Unstable`] if the solids buckle under their stress, and [`ModesError::Held`] if
/// nothing is free.
pub fn find_modes(scene: &Scene, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, ModesError> {
    match (scene.solid.body_count(), scene.bonded.is_empty()) {
        (0, _) => bonded_modes::find(scene, settings, stop),
        (_, false) => coupled_modes::find(scene, settings, stop),
        _ if scene.solid.is_plane() => solid_modes::find::<2>(scene, settings, stop),
        _ => solid_modes::find::<3>(scene, settings, stop),
    }
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
    let (solid, bonded) = (&mut scene.solid, &mut scene.bonded);
    let moved = mode.shape.iter().chain(mode.particles.iter().map(|[shift, _]| shift));
    let largest = moved.map(|u| u.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let scale = SHOWN * size(solid.reference.iter().chain(&bonded.reference)) / largest;
    let start = &solid.initial_displacement;
    let at = |node: usize| start.get(node).copied().unwrap_or_default() + mode.shape[node] * scale;
    solid.displacement = (0..mode.shape.len()).map(at).collect();
    if solid.body_count() > 0 && !solid.has_damage() {
        // Its stresses; damage would grow by a shape whose size means nothing.
        solid.update_internal_forces(0.0, false);
    }
    for (i, [shift, turn]) in mode.particles.iter().enumerate() {
        bonded.particles.position[i] = bonded.reference[i] + shift * scale;
        bonded.particles.orientation[i] = rotation_by(turn * scale);
    }
    let clock = &mut scene.clock;
    (clock.time, clock.dt_before, clock.dt_after) = (number as f64, 1.0, 1.0);
    clock.step += 1;
}
