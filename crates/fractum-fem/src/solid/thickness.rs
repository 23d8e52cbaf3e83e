//! Thicknesses of plane bodies, by the nodes of their edges.

use crate::body::{Depth, ElementKind};
use crate::solid::{BodyModel, Solid};

/// Thicknesses of the plane bodies of a solid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Thicknesses {
    /// That of the first plane body [m], 0 in space.
    first: f64,
    /// Nodes with the thickness of each of their bodies [m], ascending; empty where all bodies have the same.
    of_nodes: Vec<(u32, f64)>,
}

impl Thicknesses {
    pub(crate) fn of(bodies: &[BodyModel]) -> Self {
        let plane = || bodies.iter().map(|model| &model.body).filter(|body| body.shape == ElementKind::T3);
        let first = plane().next().map_or(0.0, |body| body.thickness);
        let mut of_nodes = Vec::new();
        if plane().any(|body| body.thickness != first) {
            for body in plane() {
                let nodes = body.elements.iter().flat_map(|element| &element[..3]);
                of_nodes.extend(nodes.map(|&node| (node, body.thickness)));
            }
            of_nodes.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            of_nodes.dedup();
        }
        Thicknesses { first, of_nodes }
    }

    fn at(&self, [a, b]: [u32; 2]) -> f64 {
        let of = |node: u32| {
            let begin = self.of_nodes.partition_point(|&(other, _)| other < node);
            self.of_nodes[begin..].iter().take_while(move |&&(other, _)| other == node).map(|&(_, thickness)| thickness)
        };
        of(a).find(|thickness| of(b).any(|other| other == *thickness)).unwrap_or(self.first)
    }
}

/// Thickness of the plane body that has both nodes of an edge [m]; that of a thinner one where two have them.
pub fn thickness_at(solid: &Solid, edge: [u32; 2]) -> f64 {
    solid.thicknesses.at(edge)
}

/// Whether the solid is turned about the y axis.
pub fn is_axisymmetric(solid: &Solid) -> bool {
    solid.bodies.iter().any(|model| model.body.is_axisymmetric())
}

/// Depth behind an edge of plane bodies: the thickness there, or a whole turn.
pub fn depth_at(solid: &Solid, edge: [u32; 2]) -> Depth {
    if is_axisymmetric(solid) { Depth::Turn } else { Depth::Thickness(thickness_at(solid, edge)) }
}

/// Depth of a facet that is an edge in the plane, which repeats its second node; none of triangles in space.
pub fn facet_depth(solid: &Solid, &[a, b, c]: &[u32; 3]) -> Option<Depth> {
    (b == c).then(|| depth_at(solid, [a, b]))
}
