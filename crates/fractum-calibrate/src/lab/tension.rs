use fractum_dem::{Equilibrium, LatticeSupports, Tolerance};
use fractum_math::Vec3;
use fractum_math::elementary::hypot;
use fractum_pack::Domain;
use serde::Serialize;

use super::{Gauge, STRAIN, translation};
use crate::{CalibrateError, Sample};

/// Result of a tension test.
#[derive(Clone, Debug, Serialize)]
pub struct Tension {
    /// Young's modulus: force over the measured section, over the strain between the measured lengths [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio from the mean displacement of the lateral walls.
    pub poisson_ratio: f64,
    /// Poisson's ratio of the two lateral directions of a box (equal on a cylinder).
    pub poisson_lateral: [f64; 2],
    /// Young's modulus of the middle half of the length [Pa].
    pub gauge_young_modulus: Option<f64>,
    /// Poisson's ratio of the middle half of the length.
    pub gauge_poisson_ratio: Option<f64>,
    /// Iterations of the solve.
    pub iterations: usize,
}

/// Pulls a box along an axis, or a cylinder along x: the end sets move apart by a prescribed displacement and are free
/// otherwise (Nguyen et al. 2019, 2.4; Jebahi et al. 2015, eqs. 2.20–2.23).
///
/// - `axis`: 0, 1, 2 for x, y, z
/// - `guess`: a state to start from; the affine field of ν = 0.25 when absent
///
/// # Errors
/// A shape without end faces along the axis; a solve that does not converge.
pub fn tension(
    sample: &Sample,
    axis: usize,
    guess: Option<&Equilibrium>,
    tolerance: Tolerance,
) -> Result<(Tension, Equilibrium), CalibrateError> {
    let shape = || CalibrateError::Shape { test: "tension", shape: "a box, or a cylinder along x" };
    let (low, high) = [("x-", "x+"), ("y-", "y+"), ("z-", "z+")][axis.min(2)];
    let (Some(first), Some(last)) = (sample.packing.wall(low), sample.packing.wall(high)) else { return Err(shape()) };
    let position = &sample.packing.position;
    let (length, section) = match (sample.box_extents(), sample.cylinder_extents()) {
        (Some(extents), _) => (extents[axis], extents.product() / extents[axis]),
        (_, Some((length, radius))) => (length, std::f64::consts::PI * radius * radius),
        _ => return Err(shape()),
    };
    // Opposite displacements that strain the measured length by STRAIN.
    let half = 0.5 * STRAIN * length;
    let mut supports = LatticeSupports::none(position.len());
    first.iter().for_each(|&i| supports.set(i, axis, -half));
    last.iter().for_each(|&i| supports.set(i, axis, half));
    let rest = match guess {
        Some(state) => sample.lattice.solve(&supports, None, &state.state, tolerance)?,
        None => {
            let centre: Vec3 = position.iter().sum::<Vec3>() / position.len() as f64;
            let affine = |x: &Vec3| {
                let mut u = (x - centre) * (-0.25 * STRAIN);
                u[axis] = (x - centre)[axis] * STRAIN;
                translation(u)
            };
            let guess: Vec<_> = position.iter().map(affine).collect();
            sample.lattice.solve(&supports, None, &guess, tolerance)?
        }
    };
    // Work of the supports F δ = 2 U: its error is of second order in the residual.
    let force = 2.0 * rest.energy / (2.0 * half);
    let young_modulus = force / section / STRAIN;
    let poisson_lateral = lateral(sample, &rest, axis).map(|strain| -strain / STRAIN);
    let (lower, upper) = sample.packing.domain.bounds();
    let (quarter, three) = (0.75 * lower[axis] + 0.25 * upper[axis], 0.25 * lower[axis] + 0.75 * upper[axis]);
    let depth = 4.0 * sample.mean_radius;
    let gauge =
        Gauge::of(sample, &rest, |x| (quarter..three).contains(&x[axis]) && sample.packing.domain.depth(x) > depth);
    let (gauge_young_modulus, gauge_poisson_ratio) = gauge.map(|g| g.uniaxial(axis)).unzip();
    let poisson_ratio = 0.5 * (poisson_lateral[0] + poisson_lateral[1]);
    let iterations = rest.iterations;
    let result =
        Tension { young_modulus, poisson_ratio, poisson_lateral, gauge_young_modulus, gauge_poisson_ratio, iterations };
    Ok((result, rest))
}

/// Lateral strains between the measured extents.
fn lateral(sample: &Sample, rest: &Equilibrium, axis: usize) -> [f64; 2] {
    let mean = |wall: &str, along: usize| {
        let set = sample.packing.wall(wall).unwrap_or_default();
        set.iter().map(|&i| rest.state[i as usize][along]).sum::<f64>() / set.len() as f64
    };
    if let Some(extents) = sample.box_extents() {
        return [1, 2].map(|step| {
            let side = (axis + step) % 3;
            let (low, high) = [("x-", "x+"), ("y-", "y+"), ("z-", "z+")][side];
            (mean(high, side) - mean(low, side)) / extents[side]
        });
    }
    // Mean radial displacement; a rigid shift of the ring cancels in the mean over the full circle only roughly, so the
    // mean lateral displacement of the set is taken off first.
    let Domain::Cylinder { start, .. } = sample.packing.domain else { return [f64::NAN; 2] };
    let set = sample.packing.wall("radius").unwrap_or_default();
    let (uy, uz) = (mean("radius", 1), mean("radius", 2));
    let radial = |&i: &u32| {
        let i = i as usize;
        let (y, z) = (sample.packing.position[i].y - start.y, sample.packing.position[i].z - start.z);
        (y * (rest.state[i][1] - uy) + z * (rest.state[i][2] - uz)) / hypot(y, z)
    };
    let radius = sample.cylinder_extents().map_or(f64::NAN, |(_, r)| r);
    [set.iter().map(radial).sum::<f64>() / set.len() as f64 / radius; 2]
}
