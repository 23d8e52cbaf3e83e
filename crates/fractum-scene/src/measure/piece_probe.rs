//! Facets of a group as they are at present, and fragments: area, enclosed volume, the piece that holds some nodes, sizes.

use fractum_fem::{Solid, cracks, is_axisymmetric, thickness_at};
use fractum_math::Vec3;
use fractum_math::elementary::cbrt;

use crate::fragment::Fragment;
use crate::gas::{HoleEnds, enclosed_volume};
use crate::measure::probe::{NeededPoints, Probe, ProbeNeeds, ProbedScene};
use crate::scene::Scene;

/// What a probe measures of facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceMeasure {
    /// Their area [m²].
    Area,
    /// Volume of the cavity that they enclose [m³]; they have to be closed.
    Volume,
}

/// What a probe measures of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FragmentMeasure {
    /// Mass [kg].
    Mass,
    /// Volume [m³].
    Volume,
    /// Diameter of the sphere of the same volume; in the plane, of the circle of the same area [m].
    Size,
    /// Velocity of its centre of mass along a direction [m/s].
    Velocity,
}

/// Something about facets as they are at present.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceProbe {
    /// Outward facets; an edge in the plane repeats its second node.
    pub facets: Vec<[u32; 3]>,
    /// What about them.
    pub measure: SurfaceMeasure,
}

impl Probe for SurfaceProbe {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let solid = &probed.scene.solid;
        let at = |node: u32| solid.position(node as usize);
        match self.measure {
            SurfaceMeasure::Area => self.facets.iter().map(|facet| cracks::area_at(solid, facet, at).norm()).sum(),
            SurfaceMeasure::Volume => enclosed_volume(solid, &self.facets, &HoleEnds::default(), at),
        }
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { nodes: NeededPoints::Some(self.facets.concat()), ..ProbeNeeds::default() }
    }
}

/// Something about the fragment that holds the first of these nodes; the single node counts as one where nothing joins it.
#[derive(Clone, Debug, PartialEq)]
pub struct FragmentProbe {
    /// The nodes, of which the first counts.
    pub nodes: Vec<u32>,
    /// What about it.
    pub measure: FragmentMeasure,
    /// Direction of a velocity.
    pub along: Vec3,
}

impl Probe for FragmentProbe {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let (solid, fragments) = (&probed.scene.solid, probed.fragments());
        let Some(&node) = self.nodes.first() else { return f64::NAN };
        let Some(own) = fragments.iter().find(|fragment| fragment.nodes.contains(&node)) else {
            let mass = solid.mass[node as usize];
            return match self.measure {
                FragmentMeasure::Mass => mass,
                FragmentMeasure::Volume | FragmentMeasure::Size => 0.0,
                FragmentMeasure::Velocity => solid.velocity[node as usize].dot(&self.along),
            };
        };
        match self.measure {
            FragmentMeasure::Mass => own.mass,
            FragmentMeasure::Volume => own.volume,
            FragmentMeasure::Size => fragment_size(solid, own),
            FragmentMeasure::Velocity => own.velocity.dot(&self.along),
        }
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_all(true)
    }
}

/// Size below which a share of the mass of all fragments lies, but of those that a boundary holds: P20, P50, P80 for 0.2, 0.5, 0.8
/// [m]; not a number where there are none.
pub fn passing_size(solid: &Solid, fragments: &[Fragment], share: f64) -> f64 {
    let free = fragments.iter().filter(|fragment| !fragment.stays);
    let mut pieces: Vec<(f64, f64)> = free.map(|f| (fragment_size(solid, f), f.mass)).collect();
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = pieces.iter().map(|piece| piece.1).sum();
    let mut passed = 0.0;
    for (size, mass) in pieces {
        passed += mass;
        if passed >= share * total {
            return size;
        }
    }
    f64::NAN
}

/// Diameter of the sphere of a fragment's volume; where solids are plane, of the circle of its area [m].
pub fn fragment_size(solid: &Solid, fragment: &Fragment) -> f64 {
    let plane = fragment.nodes.first().filter(|_| solid.is_plane() && !is_axisymmetric(solid));
    equivalent_diameter(fragment.volume, plane.map(|&node| thickness_at(solid, &[node])))
}

/// Diameter of the sphere of a volume; of the circle of its area where there is a thickness [m].
pub fn equivalent_diameter(volume: f64, thickness: Option<f64>) -> f64 {
    match thickness {
        Some(thickness) => (4.0 * volume / (std::f64::consts::PI * thickness)).sqrt(),
        None => cbrt(6.0 * volume / std::f64::consts::PI),
    }
}
