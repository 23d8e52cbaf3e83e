//! Viscosity of all bodies, and its share in the stable step.

use rayon::prelude::*;

use crate::body_model::BodyModel;
use crate::cell::Geometry;
use crate::element::regular_edge;
use crate::solid::Solid;
use crate::viscosity::{BodyViscosity, Viscosity, ViscousCells};

/// Least b₂² l |ε̇_v|/c that the time step counts with.
const SMALLEST_SHOCK: f64 = 0.01;

impl Solid {
    /// Adds viscous stress to every body.
    pub fn set_viscosity(&mut self, viscosity: Viscosity) {
        if viscosity.is_off() {
            return;
        }
        for index in 0..self.bodies.len() {
            let shape_factor = self.shape_factor(index);
            let model = &mut self.bodies[index];
            let (density, wave_speed) = (model.body.elastic.density, model.body.elastic.p_wave_speed());
            model.viscosity = Some(BodyViscosity { constants: viscosity, density, wave_speed, shape_factor });
        }
        for block in &mut self.blocks {
            block.viscous = ViscousCells::new(&self.bodies[block.body].body, &block.cells.volume);
        }
    }

    /// Share of critical damping that bulk viscosity has at most in the highest mode of an element, by the rates of the last
    /// forces; rises in steps of √2, since a change of the time step costs a little of the energy balance.
    pub fn bulk_damping_ratio(&self) -> f64 {
        let of = |(index, model): (usize, &BodyModel)| {
            let viscosity = model.viscosity.as_ref().filter(|own| own.constants.has_bulk())?;
            let own = self.blocks.iter().filter(|block| block.body == index);
            let shock = own.map(|block| block.viscous.shock).fold(0.0, f64::max);
            let mut coefficient = SMALLEST_SHOCK;
            while coefficient < shock {
                coefficient *= std::f64::consts::SQRT_2;
            }
            let coefficient = if viscosity.constants.bulk_quadratic > 0.0 { coefficient } else { 0.0 };
            Some(0.5 * viscosity.shape_factor * (viscosity.constants.bulk_linear + coefficient))
        };
        self.bodies.iter().enumerate().filter_map(of).fold(0.0, f64::max)
    }

    /// Largest ω l/c of the elements of a body, by the trace of each stiffness.
    fn shape_factor(&self, index: usize) -> f64 {
        let body = &self.bodies[index].body;
        let geometry = Geometry { body, nodes: &self.reference };
        let corners = body.shape.node_count();
        let stiffness = self.bodies[index].hooke.lambda + 4.0 * self.bodies[index].hooke.mu;
        let of = |element: usize| {
            let (measure, gradients) = geometry.element(element);
            let square: f64 = gradients[..corners].iter().map(|g| g.norm_squared()).sum();
            let frequency = (square * stiffness * corners as f64 / body.elastic.density).sqrt();
            frequency * regular_edge(body.shape, measure) / body.elastic.p_wave_speed()
        };
        (0..body.elements.len()).into_par_iter().map(of).reduce(|| 0.0, f64::max)
    }
}
