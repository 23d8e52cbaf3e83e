//! Natural vibrations of solids, K φ = ω² M φ with the lumped masses of the nodes, and of bonded bodies.
//!
//! Rigid motions of pieces that supports leave free are found from the supports, taken out and counted. What else has no
//! stiffness is a mechanism: it is found with the vibrations, taken out as well, and counted.

use fractum_fem::Solid;
use fractum_math::{Vec3, rotation_by};
use fractum_sparse::{Search, SparseError};

use super::LinearSolver;
use super::bonded_modes;
use super::linear_system::LinearSystem;
use super::support_check::rigid_motions;
use crate::modes::{Mode, Modes};
use crate::scene::Scene;

/// How natural vibrations are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModesSettings {
    /// Number of vibrations, the slowest ones.
    pub count: usize,
    /// How linear systems are solved.
    pub linear: LinearSolver,
}

/// Residuals at which a vibration is accepted: with a factorisation, and with an iterative solver.
pub(super) const TOLERANCES: [f64; 2] = [1e-6, 1e-5];
/// Shift of a singular stiffness over the square of the time that a wave takes across the bodies: far below the slowest
/// vibration of any but the most slender body, and far above the rounding of the largest one.
const SHIFT: f64 = 1e-6;
/// Eigenvalue over the same square below which a motion counts as one without stiffness.
const NO_STIFFNESS: f64 = 1e-10;
/// Extensions of the basis after which the search ends.
const MOST_EXTENSIONS: usize = 400;
/// Systems with one matrix, for the choice of the solver.
const REUSE: usize = 2;

/// Eigenpairs with the motion of every node or particle.
pub(super) struct Found<Shape> {
    pub(super) values: Vec<f64>,
    pub(super) shapes: Vec<Shape>,
    pub(super) residuals: Vec<f64>,
    pub(super) extensions: usize,
    pub(super) converged: bool,
}

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
        rigid_motions,
        mechanisms,
        free_mass: along(&|node, _| solid.mass[node]),
        work: (found.extensions, system.factor_entries()),
        converged: found.converged,
    })
}

/// Vibrations in a second.
pub(super) fn frequency(square: f64) -> f64 {
    square.max(0.0).sqrt() / (2.0 * std::f64::consts::PI)
}

/// The slowest vibrations beside motions without stiffness, and how many of these there are beside the rigid ones.
///
/// - `rigid`: rigid motions
/// - `rate`: square of the speed of a wave over the size of the bodies [1/s²]
/// - `wanted`: number of vibrations, tolerance, and whether to give up
/// - `lowest`: the slowest ones beside known motions, with a shift [1/s²]
pub(super) fn find_with_stiffness<Shape>(
    mut rigid: Vec<Shape>,
    rate: f64,
    (count, tolerance, stop): (usize, f64, fn() -> bool),
    mut lowest: impl FnMut(&[Shape], f64, Search) -> Result<Found<Shape>, SparseError>,
) -> Result<(Found<Shape>, usize), SparseError> {
    let known = rigid.len();
    let search = Search { count, tolerance, small: SHIFT * rate, most: MOST_EXTENSIONS, stop };
    loop {
        let shift = if rigid.is_empty() { 0.0 } else { SHIFT * rate };
        let found = match lowest(&rigid, shift, search) {
            Err(SparseError::Indefinite { .. }) if shift == 0.0 => lowest(&rigid, SHIFT * rate, search)?,
            found => found?,
        };
        let loose = found.values.iter().take_while(|value| **value < NO_STIFFNESS * rate).count();
        if loose == 0 || !found.converged {
            return Ok((found, rigid.len() - known));
        }
        rigid.extend(found.shapes.into_iter().take(loose));
    }
}

/// Square of the speed of the slowest wave over the size of the solids [1/s²].
fn transit_rate(solid: &Solid) -> f64 {
    let speed = |body| solid.body(body).elastic.p_wave_speed();
    let slowest = (0..solid.body_count()).map(speed).fold(f64::INFINITY, f64::min);
    (slowest / size(&solid.reference)).powi(2)
}

/// Diagonal of the box around points [m].
pub(super) fn size(points: &[Vec3]) -> f64 {
    let low = points.iter().fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = points.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    (high - low).norm()
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
