//! Natural vibrations of solids, K φ = ω² M φ with the lumped masses of the nodes, of bonded bodies, and of both together.
//!
//! Rigid motions of pieces that supports leave free are found from the supports, taken out and counted. What else has no
//! stiffness is a mechanism: it is found with the vibrations, taken out as well, and counted.

use fractum_fem::Solid;
use fractum_math::{Vec3, rotation_by};
use fractum_sparse::BlockMatrix;

use super::prestress::{add_stress, is_stressed, without_force};
use super::rigid_motions::rigid_motions;
use super::settings::ModesSettings;
use super::slowest::{Counts, ModesError, Vibrating, size};
use super::system::{add_cells, lay_out, settled};
use super::{bonded_modes, coupled_modes};
use crate::modes::Modes;
use crate::scene::Scene;

/// Systems with one matrix, for the choice of the solver.
const REUSE: usize = 2;

/// Finds the slowest natural vibrations of solids and bonded bodies of beams, as they are held and tied; contact neither holds
/// nor couples anything.
///
/// - `stop`: whether to give up
///
/// # Errors
/// [`ModesError::Linear`] if the factor does not fit, [`ModesError::Unstable`] if the solids buckle under their stress.
pub fn find_modes(scene: &Scene, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, ModesError> {
    match (scene.solid.body_count(), scene.bonded.is_empty()) {
        (0, _) => bonded_modes::find(scene, settings, stop),
        (_, false) => coupled_modes::find(scene, settings, stop),
        _ if scene.solid.is_plane() => of_solids::<2>(scene, settings, stop),
        _ => of_solids::<3>(scene, settings, stop),
    }
}

fn of_solids<const B: usize>(scene: &Scene, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, ModesError> {
    let solid = &scene.solid;
    let nodes = solid.reference.len();
    let held: Vec<u8> = (0..nodes).map(|node| held_axes(scene, node)).collect();
    let (pattern, pairs) = lay_out::<[u32; 0]>(solid, nodes, &[])?;
    let mut stiffness = BlockMatrix::<B>::zeros(pattern);
    add_solids(&mut stiffness, &pairs, scene);
    let spare = stiffness.largest_diagonal();
    stiffness.hold(&held, spare);
    // A node without elements does not vibrate.
    let stands = |node: usize| stiffness.pattern().row(node).len() > 1;
    let of = |node: usize, a: usize| if held[node] >> a & 1 == 0 { solid.mass[node] } else { 0.0 };
    let mass: Vec<[f64; B]> =
        (0..nodes).map(|node| if stands(node) { std::array::from_fn(|a| of(node, a)) } else { [0.0; B] }).collect();
    let (pieces, mut rigid) = rigid_motions(scene, std::iter::empty());
    if is_stressed(solid) {
        rigid = without_force(solid, rigid);
    }
    let counts = Counts { pieces, loose: 0, rigid_motions: rigid.len() };
    let of_rows = |motion: &[Vec3]| motion.iter().map(|v| std::array::from_fn(|a| v[a])).collect::<Vec<[f64; B]>>();
    let rigid = rigid.iter().map(|motion| of_rows(&motion.nodes)).collect();
    let vibrating = Vibrating {
        stiffness,
        mass,
        places: solid.reference.iter().map(|&p| p.into()).collect(),
        held: Some(&held),
        linear: settled(settings.linear, nodes * B, B == 2, REUSE),
        rate: transit_rate(solid),
        stressed: is_stressed(solid),
    };
    let found = vibrating.slowest(rigid, settings, stop)?;
    let vector = |own: &[f64; B]| Vec3::from_fn(|a, _| if a < B { own[a] } else { 0.0 });
    Ok(vibrating.told(found, counts, |_| true, |rows| (rows.iter().map(vector).collect(), Vec::new())))
}

/// Bit a is set where axis a of a node is prescribed.
pub(super) fn held_axes(scene: &Scene, node: usize) -> u8 {
    scene.supports().held().get(node).copied().unwrap_or(0)
}

/// Adds the stiffness of solids: of their cells, of their stress at the start, and of the springs that hold them.
///
/// - `pairs`: place of the block of every pair of nodes of every cell
pub(super) fn add_solids<const B: usize>(matrix: &mut BlockMatrix<B>, pairs: &[u32], scene: &Scene) {
    let solid = &scene.solid;
    add_cells(matrix, pairs, solid, &solid.cell_damage());
    if is_stressed(solid) {
        add_stress(matrix, pairs, solid);
    }
    for (node, springs) in scene.optional.surface_supports.springs() {
        let node = node as usize;
        matrix.add(node, node, std::array::from_fn(|a| std::array::from_fn(|b| springs[(a, b)])));
    }
}

/// Square of the speed of the slowest wave over the size of the solids [1/s²].
pub(super) fn transit_rate(solid: &Solid) -> f64 {
    let speed = |body| solid.body(body).elastic.p_wave_speed();
    let slowest = (0..solid.body_count()).map(speed).fold(f64::INFINITY, f64::min);
    (slowest / size(solid.reference.iter())).powi(2)
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
