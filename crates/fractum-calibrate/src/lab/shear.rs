use fractum_dem::{Dof6, Equilibrium, LatticeSupports, Tolerance};
use fractum_math::Vec3;
use fractum_pack::Domain;
use serde::Serialize;

use super::{Gauge, STRAIN, translation};
use crate::{CalibrateError, Sample};

/// Result of a shear test.
#[derive(Clone, Debug, Serialize)]
pub struct Shear {
    /// Shear modulus from the elastic energy 2 U/(γ² V) [Pa].
    pub shear_modulus: f64,
    /// Shear modulus of the inner part [Pa].
    pub gauge_shear_modulus: Option<f64>,
    /// Iterations of the solve.
    pub iterations: usize,
}

/// Pure shear of a box in the xy-plane: particles on the four walls x and y follow the affine field u = γ/2 (y, x, 0),
/// the walls z are free. As in tension, the walls are displaced as far as the faces of the measured box would be, half a
/// particle outside their centres.
///
/// # Errors
/// Another shape; a solve that does not converge.
pub fn shear(sample: &Sample, tolerance: Tolerance) -> Result<(Shear, Equilibrium), CalibrateError> {
    let (Domain::Box { .. }, Some(extents)) = (&sample.packing.domain, sample.box_extents()) else {
        return Err(CalibrateError::Shape { test: "shear", shape: "a box" });
    };
    let position = &sample.packing.position;
    let (lower, upper) = sample.packing.domain.bounds();
    let centre = (lower + upper) * 0.5;
    let outside = |axis: usize| extents[axis] / (extents[axis] - 2.0 * sample.mean_radius);
    let (fx, fy) = (outside(0), outside(1));
    let field = |x: &Vec3| Vec3::new((x.y - centre.y) * fy, (x.x - centre.x) * fx, 0.0) * (0.5 * STRAIN);
    let affine: Vec<Dof6> = position.iter().map(|x| translation(field(x))).collect();
    let mut supports = LatticeSupports::none(position.len());
    for wall in ["x-", "x+", "y-", "y+"] {
        for &i in sample.packing.wall(wall).unwrap_or_default() {
            let u = field(&position[i as usize]);
            supports.set(i, 0, u.x);
            supports.set(i, 1, u.y);
        }
    }
    let rest = sample.lattice.solve(&supports, None, &affine, tolerance)?;
    let shear_modulus = 2.0 * rest.energy / (STRAIN * STRAIN * extents.product());
    let depth = 6.0 * sample.mean_radius;
    let gauge = Gauge::of(sample, &rest, |x| sample.packing.domain.depth(x) > depth);
    let gauge_shear_modulus = gauge.map(|g| g.stress[3] / (2.0 * g.strain[3]));
    Ok((Shear { shear_modulus, gauge_shear_modulus, iterations: rest.iterations }, rest))
}
