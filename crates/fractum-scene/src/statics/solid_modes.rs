//! Natural vibrations of solids: the stiffness of their cells, of their stress at the start and of springs, and lumped masses.

use fractum_fem::Solid;
use fractum_math::Vec3;
use fractum_sparse::BlockMatrix;

use super::prestress::{add_stress, is_stressed, without_force};
use super::rigid_motions::rigid_motions;
use super::settings::ModesSettings;
use super::slowest::{Counts, ModesError, Vibrating, size};
use super::system::{add_cells, lay_out, settled};
use crate::modes::Modes;
use crate::scene::Scene;

/// Systems with one matrix, for the choice of the solver.
const REUSE: usize = 2;

/// Finds the slowest vibrations of a scene of solids, in the plane (two unknowns a node) or in space (three).
pub(super) fn find<const B: usize>(
    scene: &Scene,
    settings: ModesSettings,
    stop: fn() -> bool,
) -> Result<Modes, ModesError> {
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
    let speed = |body| solid.body(body).bulk_wave_speed();
    let slowest = (0..solid.body_count()).map(speed).fold(f64::INFINITY, f64::min);
    (slowest / size(solid.reference.iter())).powi(2)
}
