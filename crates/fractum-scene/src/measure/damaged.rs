//! How much of a solid is damaged.

use fractum_fem::{Solid, fields};

use crate::measure::probe::{Probe, ProbeNeeds, ProbedScene};
use crate::scene::Scene;

/// What a probe measures of the damaged part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DamagedMeasure {
    /// Volume [m³].
    Volume,
    /// Area in the plane [m²].
    Area,
    /// Share of the volume of all elements that count [-].
    Share,
}

/// Elements whose damage has come to a threshold, and those that are gone.
#[derive(Clone, Debug, PartialEq)]
pub struct DamagedPart {
    measure: DamagedMeasure,
    threshold: f64,
    /// Bodies and their elements that are looked at, with their volumes [m³] or areas [m²].
    elements: Vec<(usize, u32, f64)>,
    /// Of all of them.
    size: f64,
}

impl DamagedPart {
    /// - `threshold`: mean damage over the edges of an element from which on it counts, above 0 up to 1
    /// - `elements`: bodies and their elements that are looked at
    pub fn new(solid: &Solid, measure: DamagedMeasure, threshold: f64, elements: &[(usize, u32)]) -> Self {
        let depth = |body: usize, element: u32| match solid.body(body).depth() {
            Some(depth) if measure == DamagedMeasure::Area => depth.at(&solid.element_middle(body, element)),
            _ => 1.0,
        };
        let sized = |&(body, element): &(usize, u32)| {
            (body, element, solid.element_volume(body, element) / depth(body, element))
        };
        let elements: Vec<(usize, u32, f64)> = elements.iter().map(sized).collect();
        let size = elements.iter().fold(0.0, |sum, (_, _, size)| sum + size);
        DamagedPart { measure, threshold, elements, size }
    }
}

impl Probe for DamagedPart {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let solid = &probed.scene.solid;
        let mut damaged = 0.0;
        for of_body in self.elements.chunk_by(|a, b| a.0 == b.0) {
            let damage = fields::element_damages(solid, of_body[0].0);
            let counts = |of: &&(usize, u32, f64)| damage[of.1 as usize] >= self.threshold;
            damaged = of_body.iter().filter(counts).fold(damaged, |sum, (_, _, size)| sum + size);
        }
        if self.measure == DamagedMeasure::Share { damaged / self.size } else { damaged }
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_damage()
    }
}
