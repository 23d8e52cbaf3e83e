//! How the cracks of solids and of bonded bodies lie.

use fractum_dem::crack_shape::{Axis, cone, helix_angle};
use fractum_fem::{CrackEdge, CrackPlane};
use fractum_math::Vec3;

use crate::scene::Scene;

/// What a probe measures of a crack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrackMeasure {
    /// Angle between the direction and the plane of the crack (its line in the plane) [rad], 0 to π/2.
    Angle,
    /// Position of its centre along the direction [m].
    Centre,
    /// Position of its foremost edge or bond along the direction [m].
    Front,
    /// Angle between the axis and the helix on the surface about it, which goes through the farthest edge or bond [rad].
    Helix,
    /// Angle between the flank of the cone about the axis and the plane across the axis [rad].
    Cone,
    /// Part of the crack's area that lies on that cone [-].
    ConeShare,
    /// Area of what has separated [m²].
    Area,
    /// Its length in the plane [m].
    Length,
    /// Number of separate cracks.
    Count,
    /// Position of the foremost place that has separated along the direction [m].
    Tip,
}

impl CrackMeasure {
    /// Whether it is about what has separated, rather than about what has lost half of its strength.
    pub fn is_of_separation(self) -> bool {
        matches!(self, Self::Area | Self::Length | Self::Count | Self::Tip)
    }

    /// Whether it is measured along a direction.
    pub fn has_direction(self) -> bool {
        !matches!(self, Self::Area | Self::Length | Self::Count)
    }
}

/// Which places of a crack count, body by body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InsideCracks {
    /// Edges of solids.
    pub edges: Vec<Vec<bool>>,
    /// Bonds of bonded bodies.
    pub bonds: Vec<Vec<bool>>,
    /// Elements of solids.
    pub elements: Vec<Vec<bool>>,
}

/// Part of the strength that an edge of a crack has lost at least.
const SOFTENED: f64 = 0.5;

/// Places and areas of the crack: of its damaged edges, then broken bonds in the order of their breaking.
fn points(scene: &Scene, edges: &[CrackEdge], inside: Option<&InsideCracks>) -> Vec<(Vec3, f64)> {
    let counts = |of: fn(&InsideCracks) -> &Vec<Vec<bool>>, body: usize, index: u32| {
        inside.is_none_or(|inside| of(inside).get(body).is_some_and(|body| body.get(index as usize) == Some(&true)))
    };
    let edge = |edge: &&CrackEdge| edge.softened >= SOFTENED && counts(|i| &i.edges, edge.body, edge.edge);
    let edges = edges.iter().filter(edge);
    let bodies = scene.bonded.bodies().iter().enumerate();
    let bonds = bodies.flat_map(|(index, body)| body.cracks().iter().map(move |crack| (index, crack)));
    let bonds = bonds.filter(|(body, crack)| counts(|i| &i.bonds, *body, crack.bond));
    let edges = edges.map(|edge| (edge.middle, edge.area * edge.softened));
    edges.chain(bonds.map(|(_, crack)| (crack.position, crack.area))).collect()
}

/// A number about the crack as it is; not a number where there is none, or too little of it.
pub(crate) fn measure_crack(
    scene: &Scene,
    edges: &[CrackEdge],
    measure: CrackMeasure,
    axis: &Axis,
    inside: Option<&InsideCracks>,
) -> f64 {
    let points = points(scene, edges, inside);
    let Axis { point, direction } = axis;
    match measure {
        CrackMeasure::Angle => {
            CrackPlane::through(&points, scene.solid.is_plane()).map_or(f64::NAN, |plane| plane.angle_to(direction))
        }
        CrackMeasure::Centre => {
            let weight: f64 = points.iter().map(|p| p.1).sum();
            points.iter().map(|(p, w)| p.dot(direction) * w).sum::<f64>() / weight
        }
        CrackMeasure::Front => points.iter().map(|(p, _)| p.dot(direction)).fold(f64::NAN, f64::max),
        CrackMeasure::Helix => {
            let surface = points.iter().map(|(p, _)| (p - point).cross(direction).norm()).fold(0.0, f64::max);
            helix_angle(&points, axis, surface).unwrap_or(f64::NAN)
        }
        CrackMeasure::Cone => cone(&points, axis).map_or(f64::NAN, |cone| cone.angle),
        CrackMeasure::ConeShare => cone(&points, axis).map_or(f64::NAN, |cone| cone.share),
        // Of what has separated: no points.
        CrackMeasure::Area | CrackMeasure::Length | CrackMeasure::Count | CrackMeasure::Tip => f64::NAN,
    }
}
