use fractum_math::elementary::tan;
use std::f64::consts::PI;

use fractum_dem::{Dof6, LatticeSupports};
use fractum_math::Vec3;
use fractum_pack::Domain;

use super::Failure;
use super::brazilian::HALF_ARC;
use crate::lab::{STRAIN, translation};
use crate::{CalibrateError, Sample};

/// Poisson's ratio of first guesses.
const GUESS: f64 = 0.25;

/// A test to failure: what is held, what is measured, and when the sample is in two.
pub(super) struct Setup {
    pub(super) supports: LatticeSupports,
    pub(super) guess: Vec<Dof6>,
    /// What the load does work on, at load factor one.
    pub(super) displacement: f64,
    pub(super) stress_per_load: f64,
    pub(super) strain_per_displacement: f64,
    /// Sets that the broken sample no longer joins.
    pub(super) ends: [Vec<u32>; 2],
    /// Particles through which they must not be joined; all when absent.
    pub(super) middle: Option<Vec<bool>>,
}

impl Setup {
    pub(super) fn of(sample: &Sample, test: Failure) -> Result<Self, CalibrateError> {
        match test {
            Failure::Tension => axial(sample, 1.0),
            Failure::Compression => axial(sample, -1.0),
            Failure::Bending => bending(sample),
            Failure::Torsion => torsion(sample),
            Failure::Brazilian => brazilian(sample),
        }
    }
}

/// The particles of the faces `x-` and `x+`.
fn ends(sample: &Sample, error: CalibrateError) -> Result<[Vec<u32>; 2], CalibrateError> {
    let face = |name| sample.packing.wall(name).filter(|set| !set.is_empty()).map(<[u32]>::to_vec);
    face("x-").zip(face("x+")).map(|(a, b)| [a, b]).ok_or(error)
}

fn middle(sample: &Sample) -> Vec3 {
    let (lower, upper) = sample.packing.domain.bounds();
    (lower + upper) * 0.5
}

fn axial(sample: &Sample, sign: f64) -> Result<Setup, CalibrateError> {
    let test = if sign > 0.0 { "tension" } else { "compression" };
    let shape = || CalibrateError::Shape { test, shape: "a box, or a cylinder along x" };
    let (length, section) = match (sample.box_extents(), sample.cylinder_extents()) {
        (Some(e), _) => (e.x, e.y * e.z),
        (_, Some((length, radius))) => (length, PI * radius * radius),
        _ => return Err(shape()),
    };
    let ends = ends(sample, shape())?;
    let displacement = STRAIN * length;
    let mut supports = LatticeSupports::none(sample.packing.len());
    ends[0].iter().for_each(|&i| supports.set(i, 0, -0.5 * sign * displacement));
    ends[1].iter().for_each(|&i| supports.set(i, 0, 0.5 * sign * displacement));
    let centre = middle(sample);
    let affine = |x: &Vec3| {
        let d = (x - centre) * (sign * STRAIN);
        translation(Vec3::new(d.x, -GUESS * d.y, -GUESS * d.z))
    };
    Ok(Setup {
        supports,
        guess: sample.packing.position.iter().map(affine).collect(),
        displacement,
        stress_per_load: 1.0 / section,
        strain_per_displacement: 1.0 / length,
        ends,
        middle: None,
    })
}

fn bending(sample: &Sample) -> Result<Setup, CalibrateError> {
    let shape = || CalibrateError::Shape { test: "bending to failure", shape: "a box, long in x" };
    let size = sample.box_extents().ok_or_else(shape)?;
    let ends = ends(sample, shape())?;
    let centre = middle(sample);
    // Rotation of each end for a strain STRAIN at the surfaces.
    let curvature = 2.0 * STRAIN / size.y;
    let rotation = 0.5 * curvature * size.x;
    let mut supports = LatticeSupports::none(sample.packing.len());
    for (end, sign) in ends.iter().zip([1.0, -1.0]) {
        for &i in end {
            supports.set(i, 0, sign * rotation * (sample.packing.position[i as usize].y - centre.y));
        }
    }
    let field = |x: &Vec3| {
        let d = x - centre;
        let u =
            Vec3::new(-d.x * d.y, 0.5 * (d.x * d.x + GUESS * (d.y * d.y - d.z * d.z)), GUESS * d.y * d.z) * curvature;
        [u.x, u.y, u.z, -GUESS * curvature * -d.z, 0.0, curvature * d.x]
    };
    Ok(Setup {
        supports,
        guess: sample.packing.position.iter().map(field).collect(),
        displacement: 2.0 * rotation,
        stress_per_load: 6.0 / (size.z * size.y * size.y),
        strain_per_displacement: 0.5 * size.y / size.x,
        ends,
        middle: None,
    })
}

fn torsion(sample: &Sample) -> Result<Setup, CalibrateError> {
    let shape = || CalibrateError::Shape { test: "torsion to failure", shape: "a cylinder" };
    let (length, radius) = sample.cylinder_extents().ok_or_else(shape)?;
    let ends = ends(sample, shape())?;
    let centre = middle(sample);
    let twist = STRAIN / radius;
    let turn = |x: &Vec3, angle: f64| [0.0, -angle * (x.z - centre.z), angle * (x.y - centre.y), angle, 0.0, 0.0];
    let mut supports = LatticeSupports::none(sample.packing.len());
    for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
        for &i in end {
            let u = turn(&sample.packing.position[i as usize], sign * 0.5 * twist * length);
            (1..3).for_each(|d| supports.set(i, d, u[d]));
        }
    }
    Ok(Setup {
        supports,
        guess: sample.packing.position.iter().map(|x| turn(x, twist * (x.x - centre.x))).collect(),
        displacement: twist * length,
        stress_per_load: 2.0 / (PI * radius.powi(3)),
        strain_per_displacement: radius / length,
        ends,
        middle: None,
    })
}

/// Opposite displacements along y of the particles of the rim within 12° of the y axis, which are free otherwise.
fn brazilian(sample: &Sample) -> Result<Setup, CalibrateError> {
    let shape = || CalibrateError::Shape { test: "the Brazilian test", shape: "a cylinder (the disc's axis along x)" };
    let Domain::Cylinder { .. } = sample.packing.domain else { return Err(shape()) };
    let (thickness, radius) = sample.cylinder_extents().ok_or_else(shape)?;
    let rim = sample.packing.wall("radius").ok_or_else(shape)?;
    let centre = middle(sample);
    let half = STRAIN * radius;
    let mut supports = LatticeSupports::none(sample.packing.len());
    let mut held = [0; 2];
    for &i in rim {
        let d = sample.packing.position[i as usize] - centre;
        if d.z.abs() <= d.y.abs() * tan(HALF_ARC) {
            supports.set(i, 1, -half * d.y.signum());
            held[usize::from(d.y > 0.0)] += 1;
        }
    }
    if held.contains(&0) {
        return Err(CalibrateError::Shape { test: "the Brazilian test", shape: "a disc with particles on both arcs" });
    }
    let guess = |x: &Vec3| {
        let d = x - centre;
        translation(Vec3::new(0.0, -STRAIN * d.y, GUESS * STRAIN * d.z))
    };
    // In two when no bonds lead from side to side but under the arcs.
    let within = |x: &Vec3| (x.y - centre.y).abs() < 0.7 * radius;
    let side = |sign: f64| {
        let out = |&i: &usize| {
            let x = &sample.packing.position[i];
            within(x) && sign * (x.z - centre.z) > 0.5 * radius
        };
        (0..sample.packing.len()).filter(out).map(|i| i as u32).collect()
    };
    Ok(Setup {
        supports,
        guess: sample.packing.position.iter().map(guess).collect(),
        displacement: 2.0 * half,
        stress_per_load: 1.0 / (PI * thickness * radius),
        strain_per_displacement: 0.5 / radius,
        ends: [side(-1.0), side(1.0)],
        middle: Some(sample.packing.position.iter().map(within).collect()),
    })
}
