use std::f64::consts::PI;

use fractum_dem::{Dof6, Equilibrium, LatticeSupports, Tolerance};
use fractum_math::Vec3;
use fractum_pack::Domain;
use serde::Serialize;

use super::STRAIN;
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
    supports: LatticeSupports,
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
    let mut supports = LatticeSupports::none(sample.packing.len());
    held.iter().for_each(|&i| (0..6).for_each(|d| supports.set(i, d, 0.0)));
    Ok(Cantilever { face, supports, axis: start, length, radius })
}

/// Bends a cylinder held at `x-` by a uniform transverse displacement of the particles of `x+`, which may turn freely,
/// and compares the force with Euler–Bernoulli theory for the measured length and radius (Jebahi et al. 2015, 2.4.2.5).
///
/// # Errors
/// Another shape; a solve that does not converge.
pub fn bending(sample: &Sample, tolerance: Tolerance) -> Result<(Bending, Equilibrium), CalibrateError> {
    let Cantilever { face, mut supports, axis, length, radius } = cantilever(sample, "bending")?;
    let deflection = STRAIN * length;
    face.iter().for_each(|&i| supports.set(i, 1, deflection));
    // The cubic of a cantilever is a far better start than zero.
    let guess: Vec<Dof6> = sample
        .packing
        .position
        .iter()
        .map(|x| {
            let s = ((x.x - axis.x) / length).clamp(0.0, 1.0);
            let slope = 1.5 * deflection * (2.0 * s - s * s) / length;
            let u = 0.5 * deflection * s * s * (3.0 - s);
            [-slope * (x.y - axis.y), u, 0.0, 0.0, 0.0, slope]
        })
        .collect();
    let rest = sample.lattice.solve(&supports, None, &guess, tolerance)?;
    let force = 2.0 * rest.energy / deflection;
    let inertia = PI * radius.powi(4) / 4.0;
    let young_modulus = force * length.powi(3) / (3.0 * inertia * deflection);
    Ok((Bending { young_modulus, compliance: deflection / force, iterations: rest.iterations }, rest))
}

/// Twists a cylinder held at `x-` by a rotation of the particles of `x+` about the axis, and compares the moment with
/// theory for the measured length and radius.
///
/// # Errors
/// Another shape; a solve that does not converge.
pub fn torsion(sample: &Sample, tolerance: Tolerance) -> Result<(Torsion, Equilibrium), CalibrateError> {
    let Cantilever { face, mut supports, axis, length, radius } = cantilever(sample, "torsion")?;
    let rotation = STRAIN * length / radius;
    let turn = |x: &Vec3, angle: f64| [0.0, -angle * (x.z - axis.z), angle * (x.y - axis.y), angle, 0.0, 0.0];
    for &i in face {
        let u = turn(&sample.packing.position[i as usize], rotation);
        (1..3).for_each(|d| supports.set(i, d, u[d]));
    }
    let guess: Vec<Dof6> =
        sample.packing.position.iter().map(|x| turn(x, rotation * (x.x - axis.x) / length)).collect();
    let rest = sample.lattice.solve(&supports, None, &guess, tolerance)?;
    let moment = 2.0 * rest.energy / rotation;
    let polar = PI * radius.powi(4) / 2.0;
    let shear_modulus = moment * length / (polar * rotation);
    Ok((Torsion { shear_modulus, compliance: rotation / moment, iterations: rest.iterations }, rest))
}
