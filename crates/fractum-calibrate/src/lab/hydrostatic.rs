use fractum_dem::{Dof6, Equilibrium, LatticeSupports, Tolerance};
use fractum_math::sphere_volume;
use fractum_pack::Domain;
use serde::Serialize;

use super::{Gauge, STRAIN, translation};
use crate::{CalibrateError, Sample};

/// Result of a hydrostatic compression.
#[derive(Clone, Debug, Serialize)]
pub struct Hydrostatic {
    /// Bulk modulus: pressure over the relative change of the measured volume [Pa].
    pub bulk_modulus: f64,
    /// Bulk modulus of the inner part [Pa].
    pub gauge_bulk_modulus: Option<f64>,
    /// Iterations of the solve.
    pub iterations: usize,
}

/// Compresses a sphere or a box: the wall particles move inward by a uniform normal displacement, and the pressure
/// follows from the work of their normal forces, p ΔV (Nguyen et al. 2019, eqs. 23–24). On a box they are free to slide
/// along their wall.
///
/// # Errors
/// Another shape; a solve that does not converge.
pub fn hydrostatic(sample: &Sample, tolerance: Tolerance) -> Result<(Hydrostatic, Equilibrium), CalibrateError> {
    let position = &sample.packing.position;
    let (lower, upper) = sample.packing.domain.bounds();
    let centre = (lower + upper) * 0.5;
    let affine: Vec<Dof6> = position.iter().map(|x| translation((centre - x) * STRAIN)).collect();
    let (pressure, rest) = match &sample.packing.domain {
        Domain::Box { .. } => {
            let extents = sample.box_extents().unwrap_or(upper - lower);
            let mut supports = LatticeSupports::none(position.len());
            for (axis, (low, high)) in [("x-", "x+"), ("y-", "y+"), ("z-", "z+")].into_iter().enumerate() {
                for (wall, sign) in [(low, 1.0), (high, -1.0)] {
                    let set = sample.packing.wall(wall).unwrap_or_default();
                    set.iter().for_each(|&i| supports.set(i, axis, sign * 0.5 * STRAIN * extents[axis]));
                }
            }
            let rest = sample.lattice.solve(&supports, None, &affine, tolerance)?;
            // Work of the pressure p ΔV = 2 U with ΔV = 3 STRAIN V.
            (2.0 * rest.energy / (3.0 * STRAIN * extents.product()), rest)
        }
        Domain::Sphere { .. } => {
            let radius = sample.sphere_radius().unwrap_or(0.5 * (upper.x - lower.x));
            let mut supports = LatticeSupports::none(position.len());
            for &i in sample.packing.wall("radius").unwrap_or_default() {
                let inward = (centre - position[i as usize]).normalize() * (STRAIN * radius);
                (0..3).for_each(|axis| supports.set(i, axis, inward[axis]));
            }
            let rest = sample.lattice.solve(&supports, None, &affine, tolerance)?;
            let volume = sphere_volume(radius);
            (2.0 * rest.energy / (3.0 * STRAIN * volume), rest)
        }
        _ => return Err(CalibrateError::Shape { test: "hydrostatic compression", shape: "a box or a sphere" }),
    };
    let depth = 6.0 * sample.mean_radius;
    let gauge = Gauge::of(sample, &rest, |x| sample.packing.domain.depth(x) > depth);
    let gauge_bulk_modulus = gauge.map(|g| {
        let (p, e) = (g.stress[..3].iter().sum::<f64>() / 3.0, g.strain[..3].iter().sum::<f64>());
        p / e
    });
    let iterations = rest.iterations;
    Ok((Hydrostatic { bulk_modulus: pressure / (3.0 * STRAIN), gauge_bulk_modulus, iterations }, rest))
}
