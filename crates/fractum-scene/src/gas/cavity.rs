use fractum_fem::{Solid, cracks};
use fractum_math::Vec3;

use super::hole_ends::HoleEnds;

/// Volume of a hole that gas keeps at least, over its volume without load: walls that fly into it leave some room.
const LEAST_HOLE: f64 = 1e-3;

/// The room for gas in a hole or in a removed element, as a smooth function of the volume u that its nodes enclose:
/// V = ½ (e + √(e² + 4 V₀²)) with e = u − u₀, which is e where it is large and little where the walls are closed.
///
/// A removed element keeps its own volume for what it was made of, u₀ = that without load; V₀ = A w₀ with the area A of
/// its crack and the least opening w₀, so that V/A is the opening. The pressure on the walls is that of the gas times
/// dV/du: a crack that closes carries less and less of it, as the area that its asperities leave open.
/// The closure is the hyperbola of Bandis, Lumsden and Barton, *Int. J. Rock Mech. Min. Sci.* 20 (1983) 249-268.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cavity {
    /// u₀ [m³].
    solid_volume: f64,
    /// V₀ [m³].
    least: f64,
    /// Area A of the crack; 0 for a hole [m²].
    pub(super) area: f64,
    /// V [m³].
    pub(super) volume: f64,
    /// dV/du, 0 to 1.
    pub(super) share: f64,
    /// Pressure on the walls at tⁿ, p dV/du [Pa].
    pub(super) push: f64,
}

impl Cavity {
    /// A hole of this volume without load.
    pub(super) fn hole(volume: f64) -> Self {
        Cavity { solid_volume: 0.0, least: LEAST_HOLE * volume, area: 0.0, volume, share: 1.0, push: 0.0 }
    }

    /// The crack in a removed element: its volume without load, its characteristic length, and the least opening.
    pub(super) fn crack(volume: f64, length: f64, least_opening: f64) -> Self {
        Cavity { solid_volume: volume, ..Cavity::face(volume / length, least_opening) }
    }

    /// What is between the sides of a face of an interface: its area, and the least opening.
    pub(super) fn face(area: f64, least_opening: f64) -> Self {
        let least = area * least_opening;
        Cavity { solid_volume: 0.0, least, area, volume: least, share: 0.5, push: 0.0 }
    }

    /// Takes over the volume u that the nodes enclose now.
    pub(super) fn enclose(&mut self, enclosed: f64) {
        let excess = enclosed - self.solid_volume;
        let root = (excess * excess + 4.0 * self.least * self.least).sqrt();
        // ½ (e + √) without cancellation where e is negative.
        self.volume =
            if excess > 0.0 { 0.5 * (excess + root) } else { 2.0 * self.least * self.least / (root - excess) };
        self.share = self.volume / root;
    }

    /// Mean distance of the walls of a crack; unlimited in a hole [m].
    pub(super) fn opening(&self) -> f64 {
        if self.area > 0.0 { self.volume / self.area } else { f64::INFINITY }
    }
}

/// Volume that facets enclose with their ends, all normals pointing into it, with the nodes at these places [m³].
pub(crate) fn enclosed_volume(
    solid: &Solid,
    facets: &[[u32; 3]],
    ends: &HoleEnds,
    at: impl Fn(u32) -> Vec3 + Copy,
) -> f64 {
    let Some(base) = facets.first().map(|facet| ends.base(at(facet[0]))) else { return 0.0 };
    let moment = |facet: &[u32; 3]| {
        let area = cracks::area_at(solid, facet, at);
        let [a, b, c] = facet.map(at);
        if facet[1] == facet[2] {
            area.dot(&((a + b) * 0.5 - base)) / 2.0
        } else {
            area.dot(&((a + b + c) / 3.0 - base)) / 3.0
        }
    };
    let covers = ends.triangles(at).map(|(area, centre)| area.dot(&(centre - base)) / 3.0);
    -(facets.iter().map(moment).sum::<f64>() + covers.sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_the_opening_of_a_wide_crack_and_little_of_a_closed_one() {
        let mut crack = Cavity::crack(1e-9, 1e-3, 1e-5);
        let at = |crack: &mut Cavity, opening: f64| {
            crack.enclose(1e-9 + 1e-6 * opening);
            (crack.opening(), crack.share)
        };
        assert!((at(&mut crack, 0.0).0 / 1e-5 - 1.0).abs() < 1e-9 && (crack.share - 0.5).abs() < 1e-9);
        let (wide, share) = at(&mut crack, 1e-3);
        assert!((wide / 1e-3 - 1.0).abs() < 2e-4 && share > 0.9998);
        let (closed, share) = at(&mut crack, -1e-3);
        assert!((closed / 1e-7 - 1.0).abs() < 1e-3 && share < 1e-3, "{closed}");
        // The share is the derivative.
        for opening in [-3e-5, -1e-6, 2e-6, 4e-5] {
            let slope = (at(&mut crack, opening + 1e-9).0 - at(&mut crack, opening - 1e-9).0) / 2e-9;
            assert!((at(&mut crack, opening).1 / slope - 1.0).abs() < 1e-5);
        }
    }
}
