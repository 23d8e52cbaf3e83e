//! Viscosity of all bodies, and its share in the stable step.

use rayon::prelude::*;

use crate::cells::cell::Geometry;
use crate::cells::viscosity::{BodyViscosity, Viscosity, ViscousCells};
use crate::solid::Solid;
use crate::solid::body_model::BodyModel;

/// Least b₂² l |ε̇_v|/c that the time step counts with.
const SMALLEST_SHOCK: f64 = 0.01;

/// Adds viscous stress to every body.
pub fn set_viscosity(solid: &mut Solid, viscosity: Viscosity) {
    if viscosity.is_off() {
        return;
    }
    for index in 0..solid.bodies.len() {
        let (shape_factor, wave_speed) = (shape_factor(solid, index), solid.p_wave_speed(index));
        let model = &mut solid.bodies[index];
        let density = model.body.elastic.density;
        model.viscosity = Some(BodyViscosity { constants: viscosity, density, wave_speed, shape_factor });
    }
    for block in &mut solid.blocks {
        block.viscous = ViscousCells::new(&solid.bodies[block.body].body, &block.cells);
    }
}

/// Share of critical damping that bulk viscosity has at most in the highest mode of an element, by the rates of the last
/// forces; rises in steps of √2, since a change of the time step costs a little of the energy balance.
pub fn bulk_damping_ratio(solid: &Solid) -> f64 {
    let of = |(index, model): (usize, &BodyModel)| {
        let viscosity = model.viscosity.as_ref().filter(|own| own.constants.has_bulk())?;
        let own = solid.blocks.iter().filter(|block| block.body == index);
        let shock = own.map(|block| block.viscous.shock).fold(0.0, f64::max);
        let mut coefficient = SMALLEST_SHOCK;
        while coefficient < shock {
            coefficient *= std::f64::consts::SQRT_2;
        }
        let coefficient = if viscosity.constants.bulk_quadratic > 0.0 { coefficient } else { 0.0 };
        Some(0.5 * viscosity.shape_factor * (viscosity.constants.bulk_linear + coefficient))
    };
    solid.bodies.iter().enumerate().filter_map(of).fold(0.0, f64::max)
}

/// Largest ω l/c of the elements of a body, by the trace of each stiffness.
fn shape_factor(solid: &Solid, index: usize) -> f64 {
    let body = &solid.bodies[index].body;
    let geometry = Geometry { body, nodes: &solid.reference };
    let (corners, wave_speed) = (body.shape.node_count(), solid.p_wave_speed(index));
    let stiffness = solid.bodies[index].elasticity.largest_trace();
    let of = |element: usize| {
        let (volume, gradients) = geometry.element(element);
        let square: f64 = gradients[..corners].iter().map(|g| g.norm_squared()).sum();
        let square = square + geometry.hoop(element).powi(2) / corners as f64;
        let frequency = (square * stiffness * corners as f64 / body.elastic.density).sqrt();
        frequency * geometry.size(element as u32, volume) / wave_speed
    };
    solid.neighbours.largest((0..body.elements.len()).into_par_iter().map(of).reduce(|| 0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{Elastic, Plane};
    use fractum_mesh::generate::{structured_box, structured_rectangle};

    use super::*;
    use crate::body::{Body, ElementKind};
    use fractum_math::Vec3;

    fn solid(kind: ElementKind, plane: Plane, thickness: f64, scale: f64) -> Solid {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let (nodes, elements) = match kind {
            ElementKind::T3 => {
                let mesh = structured_rectangle([4, 4], [scale; 2], None);
                (mesh.nodes, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect())
            }
            ElementKind::T4 => {
                let mesh = structured_box([3; 3], Vec3::repeat(scale), None);
                (mesh.nodes, mesh.tetrahedra)
            }
        };
        let body = Body { plane, thickness, ..Body::new("block", kind, elements, elastic) };
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        set_viscosity(&mut solid, Viscosity { stiffness_time: 0.0, bulk_linear: 0.06, bulk_quadratic: 1.2 });
        solid
    }

    /// A share of critical damping has no dimension: neither size nor thickness changes it, and rates only raise it.
    #[test]
    fn bulk_damping_depends_on_shapes_and_rates_alone() {
        for (kind, plane) in
            [(ElementKind::T3, Plane::Strain), (ElementKind::T3, Plane::Stress), (ElementKind::T4, Plane::Strain)]
        {
            let at = |thickness, scale| bulk_damping_ratio(&solid(kind, plane, thickness, scale));
            let one = at(1.0, 1.0);
            assert!(one > 0.06 && one < 0.3, "{one}");
            for (thickness, scale) in [(0.01, 1.0), (30.0, 1.0), (1.0, 1e-3)] {
                assert!((at(thickness, scale) / one - 1.0).abs() < 1e-12, "{kind:?}");
            }
            let mut shocked = solid(kind, plane, 1.0, 1.0);
            let speed = shocked.p_wave_speed(0);
            for (v, p) in shocked.velocity.iter_mut().zip(&shocked.reference) {
                v.x = -0.5 * speed * p.x;
            }
            shocked.update_internal_forces(0.0, false);
            assert!(bulk_damping_ratio(&shocked) > 2.0 * one, "{kind:?}");
        }
    }
}
