//! The first period of a solid, for the choice between motion and equilibrium.

use fractum_math::Vec3;
use fractum_sparse::SparseError;

use super::LinearSolver;
use super::contact::{Spring, springs_at_rest};
use super::equilibrium::boundary_at;
use super::linear_system::LinearSystem;
use crate::scene::Scene;

/// Solutions that one matrix serves.
const ITERATIONS: usize = 12;
/// Iterations from the shape of the load: more would bring up slower vibrations that it excites hardly.
const EXCITED: usize = 2;
/// Relative change of the eigenvalue at which the iteration ends.
const SETTLED: f64 = 0.01;
/// Relative residual of iterative linear solutions: errors enter the eigenvalue squared.
const TOLERANCE: f64 = 1e-3;

/// The undamaged stiffness of a scene, ready to be solved with.
pub struct Stiffness {
    system: LinearSystem,
}

impl Stiffness {
    /// Lays out the system of the free unknowns.
    ///
    /// # Errors
    /// [`SparseError::TooLarge`] if the factor does not fit.
    pub fn new(scene: &Scene) -> Result<Self, SparseError> {
        let held = scene.supports().held();
        let springs = springs_at_rest(scene);
        let touching: Vec<[u32; 2]> = springs.iter().filter_map(Spring::pair).collect();
        let system = LinearSystem::new(&scene.solid, held, LinearSolver::Auto, ITERATIONS, TOLERANCE, &touching)?;
        Ok(Stiffness { system })
    }

    /// Entries of the Cholesky factor, or of the matrix where the solution is iterative.
    pub fn entries(&self) -> (usize, bool) {
        match &self.system {
            LinearSystem::Plane(system) => system.entries(),
            LinearSystem::Space(system) => system.entries(),
        }
    }

    /// Assembles and factorises the stiffness, once of what every iteration to equilibrium does.
    ///
    /// # Errors
    /// [`SparseError`] if the scene can move without resistance.
    pub fn prepare(&mut self, scene: &Scene) -> Result<(), SparseError> {
        let springs = springs_at_rest(scene);
        self.system.prepare(scene, &scene.solid.cell_damage(), &springs)
    }

    /// Period of the slowest vibration that the supports and loads of a time can excite [s], by inverse iteration with the
    /// lumped masses from the shape that they bring about: within a few percent, and never too long; that of the
    /// slowest vibration at all where they bring about nothing. [`Stiffness::prepare`] must have been called.
    ///
    /// # Errors
    /// [`SparseError::Stalled`] if an iterative solution fails.
    pub fn first_period(&mut self, scene: &mut Scene, time: f64) -> Result<f64, SparseError> {
        let there = boundary_at(scene, 0.0, time);
        let solid = &scene.solid;
        let (reference, mass) = (&solid.reference, &solid.mass);
        let size = reference.iter().map(|p| p.norm()).fold(f64::MIN_POSITIVE, f64::max);
        // All rigid motions and more, in no proportion that a symmetry could single out.
        let mut shape: Vec<Vec3> = reference
            .iter()
            .map(|p| {
                let [x, y, z] = (p / size).into();
                Vec3::new(1.0 + 0.7 * y - 0.4 * z, 0.9 + 0.6 * x + 0.5 * z, 0.8 - 0.5 * x + 0.3 * y)
            })
            .collect();
        let mut right = vec![Vec3::zeros(); shape.len()];
        solid.secant_force(&solid.cell_damage(), &there.displacement, &mut right);
        for (right, force) in right.iter_mut().zip(&there.force) {
            *right = force - *right;
        }
        let mut loaded = right.clone();
        self.system.solve(&right, &mut loaded)?;
        let excited = loaded.iter().any(|u| u.norm_squared() > 0.0);
        if excited {
            shape = loaded;
        }
        let mut square = 0.0;
        for _ in 0..if excited { EXCITED } else { ITERATIONS } {
            for ((f, u), m) in right.iter_mut().zip(&shape).zip(mass) {
                *f = u * *m;
            }
            self.system.solve(&right, &mut shape)?;
            let dot = |a: &[Vec3]| a.iter().zip(&shape).map(|(a, u)| a.dot(u)).sum::<f64>();
            let inertia: f64 = shape.iter().zip(mass).map(|(u, m)| m * u.norm_squared()).sum();
            let now = dot(&right) / inertia;
            let scale = 1.0 / inertia.sqrt();
            shape.iter_mut().for_each(|u| *u *= scale);
            let settled = (now - square).abs() < SETTLED * now;
            square = now;
            if settled {
                break;
            }
        }
        Ok(2.0 * std::f64::consts::PI / square.sqrt())
    }
}

/// Looks at supports and loads for their fastest change.
const SAMPLES: f64 = 200.0;

impl Scene {
    /// Largest change of what supports and loads prescribe within a duration, over the largest value of the run up to `end`;
    /// 0 where nothing changes. What is there from the start is no change.
    pub fn fastest_change(&mut self, duration: f64, end: f64) -> f64 {
        let step = duration.max(end / SAMPLES);
        let (mut change, mut largest) = ([0.0f64; 2], [0.0f64; 2]);
        let mut last: Option<super::equilibrium::Boundary> = None;
        for sample in 0..=(end / step).ceil() as usize {
            let now = boundary_at(self, 0.0, (step * sample as f64).min(end));
            let far = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            let size = |a: &[Vec3]| a.iter().map(|a| a.norm()).fold(0.0, f64::max);
            largest[0] = largest[0].max(size(&now.displacement));
            largest[1] = largest[1].max(size(&now.force));
            if let Some(last) = &last {
                change[0] = change[0].max(far(&now.displacement, &last.displacement));
                change[1] = change[1].max(far(&now.force, &last.force));
            }
            last = Some(now);
        }
        let part = |i: usize| if largest[i] > 0.0 { change[i] / largest[i] } else { 0.0 };
        part(0).max(part(1)) * (duration / step)
    }
}
