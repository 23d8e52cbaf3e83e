//! Depths of plane bodies, by the nodes of their edges and elements.

use crate::body::{Body, Depth, ElementKind};
use crate::solid::{BodyModel, Solid};

/// Depths of the plane bodies of a solid.
#[derive(Clone, Debug, Default)]
pub struct Depths {
    /// That of the first plane body [m], 0 in space.
    first: f64,
    /// Nodes with the thickness of each of their bodies [m], ascending; empty where all bodies have the same.
    of_nodes: Vec<(u32, f64)>,
    /// Whether they are turned about the y axis instead.
    around: bool,
}

impl Depths {
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
        Depths { first, of_nodes, around: plane().any(Body::is_axisymmetric) }
    }

    /// Depth of the plane body that has all of some nodes: the thickness there, or a whole turn.
    pub fn at(&self, nodes: &[u32]) -> Depth {
        if self.around { Depth::Turn } else { Depth::Thickness(self.thickness(nodes)) }
    }

    /// Thickness of the plane body that has all of some nodes [m]; that of a thinner one where two have them.
    fn thickness(&self, nodes: &[u32]) -> f64 {
        let of = |node: u32| {
            let begin = self.of_nodes.partition_point(|&(other, _)| other < node);
            self.of_nodes[begin..].iter().take_while(move |&&(other, _)| other == node).map(|&(_, thickness)| thickness)
        };
        let [first, others @ ..] = nodes else { return self.first };
        let of_all = |thickness: &f64| others.iter().all(|&node| of(node).any(|other| other == *thickness));
        of(*first).find(of_all).unwrap_or(self.first)
    }
}

/// As [`Depths::at`], where no body is turned about an axis [m].
pub fn thickness_at(solid: &Solid, nodes: &[u32]) -> f64 {
    solid.depths.thickness(nodes)
}

/// Whether the solid is turned about the y axis.
pub fn is_axisymmetric(solid: &Solid) -> bool {
    solid.depths.around
}

/// Depths of the plane bodies of a solid; none in space.
pub fn depths_of(solid: &Solid) -> Option<&Depths> {
    solid.is_plane().then_some(&solid.depths)
}

/// Depth of a facet that is an edge in the plane, which repeats its second node; none of triangles in space.
pub fn facet_depth(solid: &Solid, &[a, b, c]: &[u32; 3]) -> Option<Depth> {
    (b == c).then(|| solid.depths.at(&[a, b]))
}
