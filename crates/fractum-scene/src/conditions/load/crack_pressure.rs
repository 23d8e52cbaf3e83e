use std::fmt;

use fractum_fem::CrackNetwork;
use fractum_math::Vec3;

use super::pressure::push_facet;
use crate::conditions::Points;
use crate::time_function::TimeFunction;

/// Pressure on facets and in the cracks that are open to them, along present normals [Pa]; positive pushes into the body.
///
/// A facet whose element has been removed carries nothing; the walls of what was behind it do.
#[derive(Clone)]
pub struct CrackPressure {
    /// Points of outward facets; an edge in the plane repeats its second one.
    pub facets: Vec<[u32; 3]>,
    /// Pressure over time and the reference centre of the facet.
    pub value: TimeFunction,
    /// How fast it advances into the cracks [m/s]; at once if absent.
    pub front_speed: Option<f64>,
    /// Which mouth of the network its facets are; found by [`CrackPressure::mouths`].
    pub(super) mouth: usize,
}

impl CrackPressure {
    /// Pressure that is in all of the cracks at once, or advances into them.
    pub fn new(facets: Vec<[u32; 3]>, value: TimeFunction, front_speed: Option<f64>) -> Self {
        CrackPressure { facets, value, front_speed, mouth: 0 }
    }

    /// The mouths of all such loads; loads on the same facets share one.
    pub(super) fn mouths<'a>(loads: impl Iterator<Item = &'a mut CrackPressure>) -> Vec<Vec<[u32; 3]>> {
        let mut mouths: Vec<Vec<[u32; 3]>> = Vec::new();
        for load in loads {
            let known = mouths.iter().position(|facets| *facets == load.facets);
            load.mouth = known.unwrap_or(mouths.len());
            if known.is_none() {
                mouths.push(load.facets.clone());
            }
        }
        mouths
    }

    pub(super) fn apply(&self, points: &impl Points, cracks: &CrackNetwork, time: f64, forces: &mut Vec<(u32, Vec3)>) {
        let mouth = &cracks.mouths()[self.mouth];
        for (facet, _) in mouth.facets.iter().zip(&mouth.live).filter(|(_, live)| **live) {
            push_facet(points, facet, |centre| (self.value)(time, centre), forces);
        }
        for cell in cracks.cells_of(self.mouth) {
            for facet in cell.walls() {
                let value = |centre: &Vec3| {
                    // The front has come once the pressure at the mouth had begun when it left there.
                    let left = self.front_speed.map(|speed| time - cell.path / speed);
                    let is_ahead = left.is_some_and(|left| (self.value)(left, centre) == 0.0);
                    if is_ahead { 0.0 } else { (self.value)(time, centre) }
                };
                push_facet(points, facet, value, forces);
            }
        }
    }
}

impl fmt::Debug for CrackPressure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "CrackPressure({} facets and their cracks)", self.facets.len())
    }
}
