use std::fmt;

use fractum_fem::{Depth, facet_area};
use fractum_math::Vec3;

use crate::conditions::Points;
use crate::facet::share_of_torn;
use crate::time_function::TimeFunction;

/// Pressure on facets, along their present normals [Pa]; positive pushes into the body.
#[derive(Clone)]
pub struct Pressure {
    /// Points of outward facets; an edge in the plane repeats its second one.
    pub facets: Vec<[u32; 3]>,
    /// Pressure over time and the reference centre of the facet.
    pub value: TimeFunction,
}

impl Pressure {
    pub(super) fn apply(&self, points: &impl Points, time: f64, forces: &mut Vec<(u32, Vec3)>) {
        for facet in &self.facets {
            push_facet(points, facet, |centre| (self.value)(time, centre), forces);
        }
    }
}

/// A third of p times the area vector of a facet on each of its corners, half on each end of a plane edge, around an axis their shares of the area;
/// this is at most twice that without load.
///
/// - `pressure`: at the reference centre of the facet [Pa]
pub(super) fn push_facet(
    points: &impl Points,
    facet: &[u32; 3],
    pressure: impl Fn(&Vec3) -> f64,
    forces: &mut Vec<(u32, Vec3)>,
) {
    let depth = points.depth(facet);
    let place = facet.map(|n| points.position(n as usize));
    let [a, b, c] = facet.map(|n| points.reference(n as usize));
    let (centre, corners) = if depth.is_some() { ((a + b) * 0.5, 2) } else { ((a + b + c) / 3.0, 3) };
    let area = facet_area(place, depth);
    let share = share_of_torn(&area, &facet_area([*a, *b, *c], depth));
    if depth == Some(Depth::Turn) {
        let whole = area * (-pressure(&centre) * share);
        let shares = Depth::Turn.shares([&place[0], &place[1]]);
        forces.extend(facet.iter().zip(shares).map(|(&n, share)| (n, whole * share)));
        return;
    }
    let force = area * (-pressure(&centre) / corners as f64 * share);
    forces.extend(facet[..corners].iter().map(|&n| (n, force)));
}

impl fmt::Debug for Pressure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Pressure({} facets)", self.facets.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three nodes of a triangle in the xy-plane that has been stretched from the origin.
    struct Stretched(f64, [Vec3; 3], Option<Depth>);

    impl Points for Stretched {
        fn reference(&self, point: usize) -> &Vec3 {
            &self.1[point]
        }

        fn position(&self, point: usize) -> Vec3 {
            self.1[point] * self.0
        }

        fn displacement(&self, point: usize) -> Vec3 {
            self.1[point] * (self.0 - 1.0)
        }

        fn displacement_before(&self, point: usize, _: f64) -> Vec3 {
            self.displacement(point)
        }

        fn velocity(&self, _: usize) -> &Vec3 {
            &self.1[0]
        }

        fn depth(&self, _: &[u32; 3]) -> Option<Depth> {
            self.2
        }
    }

    #[test]
    fn the_force_grows_with_the_facet_until_it_is_torn_open() {
        let push = |stretch: f64, facet, depth| {
            let nodes = [Vec3::zeros(), Vec3::x() * 2.0, Vec3::y()];
            let mut forces = Vec::new();
            push_facet(&Stretched(stretch, nodes, depth), &facet, |_| 6.0, &mut forces);
            forces.iter().map(|(_, force)| force).sum::<Vec3>()
        };
        let in_space = [1.0, 1.2, 10.0].map(|stretch| push(stretch, [0, 1, 2], None));
        assert!((in_space[0] - Vec3::z() * -6.0).norm() < 1e-12);
        assert!((in_space[1] - Vec3::z() * -6.0 * 1.44).norm() < 1e-12);
        assert!((in_space[2] - Vec3::z() * -12.0).norm() < 1e-12);
        let in_plane = [1.5, 30.0].map(|stretch| push(stretch, [0, 1, 1], Some(Depth::Thickness(0.1))));
        assert!((in_plane[0] - Vec3::y() * 1.2 * 1.5).norm() < 1e-12);
        assert!((in_plane[1] - Vec3::y() * 2.4).norm() < 1e-12);
        // A disc of 2 m in radius, on the side of its y axis.
        let disc = push(1.0, [0, 1, 1], Some(Depth::Turn));
        assert!((disc - Vec3::y() * 6.0 * 4.0 * std::f64::consts::PI).norm() < 1e-12);
    }
}
