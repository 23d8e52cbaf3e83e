//! Bodies that have a stress from the start, without a displacement that made it.

use fractum_math::{Sym3, Vec3};

use crate::body::Formulation;
use crate::cells::cell::Geometry;
use crate::solid::Solid;
use crate::solid::evaluate::Block;

/// Lets a body begin with elastic strains, at the displacements that it has.
///
/// Cells of elements have that of their centroid, those of edges that of their midpoint. The mean over the edges of an element is that of its centroid too, so
/// that the forces of a stress that is linear in the place are those of ∫ Bᵀσ dV in both formulations.
///
/// - `strain`: elastic strain at a place without load, linear in it
pub fn begin_strained(solid: &mut Solid, body: usize, strain: impl Fn(Vec3) -> Sym3) {
    let Solid { blocks, bodies, reference, .. } = solid;
    // The cell of an edge begins with its two ends.
    let count = match bodies[body].body.formulation {
        Formulation::Smoothed => 2,
        Formulation::Standard => bodies[body].body.shape.node_count(),
    };
    for Block { cells, .. } in blocks.iter_mut().filter(|block| block.body == body) {
        let place =
            |cell| cells.global_nodes(cell).take(count).map(|node| reference[node]).sum::<Vec3>() / count as f64;
        cells.born = Some((0..cells.len()).map(|cell| strain(place(cell)) * -1.0).collect());
    }
}

/// Areas over which the stress of the elements around a node acts on it, Σ V |∇N| [m²]; a uniform stress has no resultant there.
pub fn stressed_areas(solid: &Solid) -> Vec<f64> {
    let mut areas = vec![0.0; solid.reference.len()];
    for model in &solid.bodies {
        let (geometry, corners) =
            (Geometry { body: &model.body, nodes: &solid.reference }, model.body.shape.node_count());
        for (element, nodes) in model.body.elements.iter().enumerate().filter(|(element, _)| model.alive[*element]) {
            let (volume, gradients) = geometry.element(element);
            let shares = nodes[..corners].iter().zip(gradients);
            shares.for_each(|(&node, gradient)| areas[node as usize] += volume * gradient.norm());
        }
    }
    areas
}
