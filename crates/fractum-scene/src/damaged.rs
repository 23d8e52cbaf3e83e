//! How much of a solid is damaged.

use fractum_fem::Solid;

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
    /// What about them.
    pub measure: DamagedMeasure,
    /// Mean damage over the edges of an element from which on it counts, above 0 up to 1.
    pub threshold: f64,
    /// Bodies and their elements that are looked at.
    pub elements: Vec<(usize, u32)>,
}

impl DamagedPart {
    /// The number, at present.
    pub(crate) fn value(&self, solid: &Solid) -> f64 {
        let (mut damaged, mut all) = (0.0, 0.0);
        for &(body, element) in &self.elements {
            let depth = if self.measure == DamagedMeasure::Area { solid.body(body).thickness } else { 1.0 };
            let size = solid.element_volume(body, element) / depth;
            all += size;
            damaged += if solid.element_damage(body, element) >= self.threshold { size } else { 0.0 };
        }
        if self.measure == DamagedMeasure::Share { damaged / all } else { damaged }
    }
}
