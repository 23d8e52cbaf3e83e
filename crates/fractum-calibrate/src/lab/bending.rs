use std::f64::consts::PI;

use fractum_dem::{Dof6, Equilibrium, Supports, Tolerance};
use fractum_math::Vec3;
use fractum_pack::Domain;
use serde::Serialize;

use crate::{CalibrateError, Sample};

/// Result of a cantilever bending test on a cylinder.
#[derive(Clone, Debug, Serialize)]
pub struct Bending {
    /// Young's modulus that gives the measured deflection by F L³/(3 E I) [Pa].
    pub young_modulus: f64,
    /// Deflection of the loaded face per unit force [m/N].
    pub compliance: f64,
    /// Iterations of the solve.
    pub iterations: usize,
}

/// Result of a torsion test on a cylinder.
#[derive(Clone, Debug, Serialize)]
pub struct Torsion {
    /// Shear modulus that gives the measured rotation by M L/(G J) [Pa].
    pub shear_modulus: f64,
    /// Rotation of the loaded face per unit moment [1/(N m)].
    pub compliance: f64,
    /// Iterations of the solve.
    pub iterations: usize,
}

/// The free face of a cantilever, and its supports: the set `x-` held fast.
struct Cantilever<'a> {
    face: &'a [u32],
    supports: Supports,
    axis: Vec3,
    length: f64,
    radius: f64,
}

fn cantilever<'a>(sample: &'a Sample, test: &'static str) -> Result<Cantilever<'a>, CalibrateError> {
    let shape = CalibrateError::Shape { test, shape: "a cylinder" };
    let Domain::Cylinder { start, .. } = sample.packing.domain else { return Err(shape) };
    let (Some((length, radius)), Some(face), Some(held)) =
        (sample.cylinder_extents(), sample.packing.wall("x+"), sample.packing.wall("x-"))
    else {
        return Err(shape);
    };
    let mut supports = Supports::none(sample.packing.len());
    held.iter().for_each(|&i| (0..6).for_each(|d| supports.set(i, d, 0.0)));
    Ok(Cantilever { face, supports, axis: start, length, radius })
}

/// Bends a cylinder held at `x-` by a transverse force spread over the particles of `x+`, and compares the mean
/// deflection of that face with Euler–Bernoulli theory for the measured length and radius (Jebahi et al. 2015, 2.4.2.5).
///
/// # Errors
/// Another shape; a solve that does not converge.
pub fn bending(sample: &Sample, tolerance: Tolerance) -> Result<(Bending, Equilibrium), CalibrateError> {
    let Cantilever { face, supports, length, radius, .. } = cantilever(sample, "bending")?;
    let mut loads = vec![[0.0; 6]; sample.packing.len()];
    let force = sample.lattice.section().young_modulus * radius * radius * 1e-6;
    face.iter().for_each(|&i| loads[i as usize][1] = force / face.len() as f64);
    let guess = vec![[0.0; 6]; sample.packing.len()];
    let rest = sample.lattice.solve(&supports, Some(&loads), &guess, tolerance)?;
    let deflection = face.iter().map(|&i| rest.state[i as usize][1]).sum::<f64>() / face.len() as f64;
    let inertia = PI * radius.powi(4) / 4.0;
    let young_modulus = force * length.powi(3) / (3.0 * inertia * deflection);
    Ok((Bending { young_modulus, compliance: deflection / force, iterations: rest.iterations }, rest))
}

/// Twists a cylinder held at `x-` by tangential forces on the particles of `x+` proportional to their distance from
/// the axis, and compares the rotation of that face with theory for the measured length and radius.
///
/// # Errors
/// Another shape; a solve that does not converge.
pub fn torsion(sample: &Sample, tolerance: Tolerance) -> Result<(Torsion, Equilibrium), CalibrateError> {
    let Cantilever { face, supports, axis, length, radius } = cantilever(sample, "torsion")?;
    let arm = |i: u32| {
        let x = sample.packing.position[i as usize];
        (x.y - axis.y, x.z - axis.z)
    };
    let unit = sample.lattice.section().young_modulus * radius * 1e-6 / face.len() as f64;
    let mut loads: Vec<Dof6> = vec![[0.0; 6]; sample.packing.len()];
    let mut moment = 0.0;
    for &i in face {
        let (y, z) = arm(i);
        (loads[i as usize][1], loads[i as usize][2]) = (-unit * z, unit * y);
        moment += unit * (y * y + z * z);
    }
    let guess = vec![[0.0; 6]; sample.packing.len()];
    let rest = sample.lattice.solve(&supports, Some(&loads), &guess, tolerance)?;
    let moved = |&i: &u32| {
        let (y, z) = arm(i);
        let s = rest.state[i as usize];
        y * s[2] - z * s[1]
    };
    let square = |&i: &u32| {
        let (y, z) = arm(i);
        y * y + z * z
    };
    // Best-fit rotation of the face about the axis.
    let rotation = face.iter().map(moved).sum::<f64>() / face.iter().map(square).sum::<f64>();
    let polar = PI * radius.powi(4) / 2.0;
    let shear_modulus = moment * length / (polar * rotation);
    Ok((Torsion { shear_modulus, compliance: rotation / moment, iterations: rest.iterations }, rest))
}
