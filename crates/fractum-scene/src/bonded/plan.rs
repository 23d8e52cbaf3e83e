//! How a bonded body breaks.

use std::ops::Range;

use fractum_dem::{CrackFaces, FractureCriterion};
use fractum_math::Vec3;

/// When the bonds of a body break, and what happens then.
#[derive(Clone, Debug)]
pub struct BondFracture {
    /// The criterion, with its own strengths; none where bonds separate by their law.
    pub criterion: Option<FractureCriterion>,
    /// What crack faces do.
    pub faces: CrackFaces,
    /// Volume of the body [m³].
    pub volume: f64,
    /// Factors on the strength of its particles, > 0; none where all have the same.
    pub strength_factors: Vec<f64>,
    /// From its particles to the walls at which their stress is taken; empty where stress is not taken at walls [m].
    pub to_wall: Vec<Vec3>,
}

impl BondFracture {
    /// Gives what a body knows of its particles the places of its particles among those of all bodies, at which a criterion looks.
    pub(super) fn take_place(&mut self, own: Range<usize>, count: usize) {
        if !self.strength_factors.is_empty() {
            let mut factors = vec![1.0; count];
            factors[own.clone()].copy_from_slice(&self.strength_factors);
            self.strength_factors = factors;
        }
        if !self.to_wall.is_empty() {
            let mut to_wall = vec![Vec3::zeros(); count];
            to_wall[own].copy_from_slice(&self.to_wall);
            self.to_wall = to_wall;
        }
    }
}
