//! Elements turned inside out.

use std::borrow::Cow;

use fractum_math::Vec3;

use crate::body::Formulation;
use crate::element::{InvertedElement, measure_and_gradients};
use crate::solid::Solid;
use crate::solid::evaluate::Block;

/// An element of a corotational body that the last forces found turned inside out while it still carried load.
///
/// Its strain is beyond -1, where the law of small stretches says nothing. Where strains are those of an edge, it is the worst element
/// around one whose mean deformation is turned inside out.
pub fn inverted_element(solid: &Solid) -> Option<InvertedElement> {
    solid.neighbours.inverted(&|| inverted_of(solid, &solid.blocks))
}

/// Body and number of the inverted element, where it is crushed.
pub fn crushed_element(solid: &Solid) -> Option<(usize, u32)> {
    let crushed = inverted_element(solid).filter(InvertedElement::is_crushed)?;
    Some((crushed.body, crushed.element))
}

/// That of the first of some blocks that has one.
pub(crate) fn inverted_of(solid: &Solid, blocks: &[Block]) -> Option<InvertedElement> {
    let (block, cell) = blocks.iter().find_map(|block| Some((block, block.inverted?)))?;
    let (body, model, item) = (block.body, &solid.bodies[block.body], block.items[cell]);
    let one = [item];
    let of_edge = model.smoothed_edges().map_or(Cow::Borrowed(&[][..]), |edges| edges.around(item));
    let elements = match model.body.formulation {
        Formulation::Standard => &one[..],
        Formulation::Smoothed => &of_edge,
    };
    let (corners, damage) = (model.body.shape.node_count(), block.damage_of(cell));
    let of = |&element: &u32| {
        let nodes = model.body.elements[element as usize].map(|node| node as usize);
        let measure = |place: &dyn Fn(usize) -> Vec3| measure_and_gradients(model.body.shape, &nodes.map(place)).0;
        let volume_ratio = measure(&|node| solid.position(node)) / measure(&|node| solid.reference[node]);
        let centre = nodes[..corners].iter().map(|&n| solid.position(n)).sum::<Vec3>() / corners as f64;
        InvertedElement { body, element, centre, volume_ratio, damage }
    };
    let alive = elements.iter().filter(|&&element| model.alive[element as usize]);
    alive.map(of).min_by(|a, b| a.volume_ratio.total_cmp(&b.volume_ratio))
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};
    use fractum_math::Vec3;
    use fractum_mesh::generate::structured_box;

    use super::*;
    use crate::body::{Body, ElementKind, Kinematics};
    use crate::solid::Solid;

    /// A box that is turned inside out, with this damage everywhere.
    fn inside_out(damage: f64, smoothed: bool) -> Solid {
        let mesh = structured_box([2; 3], Vec3::repeat(0.02), None);
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body =
            Body::new("box", ElementKind::T4, mesh.tetrahedra, elastic).with_damage(DamageLaw::rankine(3e6, 100.0));
        let body = Body { kinematics: Kinematics::Corotational, ..body };
        let mut solid = Solid::new(mesh.nodes, vec![if smoothed { body.smoothed() } else { body }]).unwrap();
        let mut state = solid.state();
        state.bodies[0].edges.iter_mut().for_each(|edge| edge.damage = damage);
        solid.restore(state);
        for node in 0..solid.reference.len() {
            solid.displacement[node].x = -1.5 * solid.reference[node].x;
        }
        solid.update_internal_forces(0.0, true);
        solid
    }

    #[test]
    fn an_element_that_still_carries_is_no_crushed_one() {
        for smoothed in [false, true] {
            let mut solid = inside_out(0.3, smoothed);
            assert!(inverted_element(&solid).is_some() && crushed_element(&solid).is_none());
            let mut removed = Vec::new();
            crate::removal::remove_cut_elements(&mut solid, 0.0, &mut removed);
            assert!(removed.is_empty());
        }
    }

    #[test]
    fn crushed_elements_leave_one_by_one_with_their_energy() {
        for smoothed in [false, true] {
            let mut solid = inside_out(0.7, smoothed);
            let mut removed = Vec::new();
            for _ in 0..5 {
                let (crushed, before) = (crushed_element(&solid).unwrap(), solid.elastic_energy());
                let taken = crate::removal::remove_cut_elements(&mut solid, 0.0, &mut removed);
                assert_eq!(removed.last(), Some(&crushed));
                solid.update_internal_forces(0.0, true);
                let after = solid.elastic_energy();
                assert!(taken > 0.0 && (before - after - taken).abs() <= 1e-9 * before, "{before} {after} {taken} J");
            }
            assert_eq!(removed.len(), 5);
        }
    }
}
