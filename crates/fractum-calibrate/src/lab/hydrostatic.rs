use fractum_dem::{Dof6, Equilibrium, Supports, Tolerance};
use fractum_math::Vec3;
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

/// Compresses a sphere or a box: the wall particles move inward by a uniform normal displacement and are free to slide;
/// the pressure is the sum of their normal forces over the area (Nguyen et al. 2019, eqs. 23–24).
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
            let mut supports = Supports::none(position.len());
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
            let set = sample.packing.wall("radius").unwrap_or_default();
            // Equal radial forces on the surface particles; the pressure is their sum over 4πR².
            let inward = |i: u32| (centre - position[i as usize]).normalize();
            let mut loads = vec![[0.0; 6]; position.len()];
            let unit = sample.lattice.section().young_modulus * radius * radius * STRAIN / set.len().max(1) as f64;
            let mut total = Vec3::zeros();
            for &i in set {
                total += inward(i) * unit;
            }
            for &i in set {
                // The small resultant of a random set is taken off, so that the loads are in balance.
                let f = inward(i) * unit - total / set.len() as f64;
                loads[i as usize] = translation(f);
            }
            let supports = Supports::none(position.len());
            let rest = sample.lattice.solve(&supports, Some(&loads), &affine, tolerance)?;
            let sum: f64 = set
                .iter()
                .map(|&i| Vec3::new(loads[i as usize][0], loads[i as usize][1], loads[i as usize][2]).dot(&inward(i)))
                .sum();
            let pressure = sum / (4.0 * std::f64::consts::PI * radius * radius);
            let shrink = |&i: &u32| {
                let u = rest.state[i as usize];
                Vec3::new(u[0], u[1], u[2]).dot(&inward(i))
            };
            let change = set.iter().map(shrink).sum::<f64>() / set.len() as f64;
            // ΔV/V = 3 ΔR/R; scaled to STRAIN so that both shapes read alike.
            (pressure * STRAIN / (change / radius), rest)
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
