use std::sync::{Mutex, PoisonError};

use fractum::Simulation;
use fractum_math::Vec3;
use fractum_scene::{Population, Scene};
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;

use crate::errors::raise;

/// A load that a function gives, and the arrays that it shares with Python: nothing is allocated in a step.
pub(crate) struct GivenLoad {
    pub(crate) population: Population,
    /// Points that it pushes, in the numbering of the scene.
    points: Vec<u32>,
    /// Called with the time [s] before a step.
    pub(crate) function: Py<PyAny>,
    position: PyBuffer<f64>,
    velocity: PyBuffer<f64>,
    force: PyBuffer<f64>,
    /// An array on its way to or from Python.
    passing: Mutex<Vec<f64>>,
}

impl GivenLoad {
    /// - `arrays`: positions, velocities and forces; none unless each has three numbers for every point and may be written to
    pub(crate) fn new(
        population: Population,
        points: Vec<u32>,
        function: Py<PyAny>,
        arrays: [PyBuffer<f64>; 3],
    ) -> Option<Self> {
        let count = 3 * points.len();
        let all_fit = arrays.iter().all(|array| array.item_count() == count && !array.readonly());
        let [position, velocity, force] = arrays;
        let passing = Mutex::new(vec![0.0; count]);
        all_fit.then_some(GivenLoad { population, points, function, position, velocity, force, passing })
    }

    /// Writes positions [m] and velocities [m/s] of the points into their arrays.
    pub(crate) fn show(&self, py: Python<'_>, scene: &Scene) -> PyResult<()> {
        let (solid, particles) = (&scene.solid, &scene.bonded.particles);
        match self.population {
            Population::Nodes => {
                self.fill(py, &self.position, |node| solid.position(node))?;
                self.fill(py, &self.velocity, |node| solid.velocity[node])
            }
            Population::Particles => {
                self.fill(py, &self.position, |particle| particles.position[particle])?;
                self.fill(py, &self.velocity, |particle| particles.velocity[particle])
            }
        }
    }

    fn fill(&self, py: Python<'_>, array: &PyBuffer<f64>, of: impl Fn(usize) -> Vec3) -> PyResult<()> {
        let mut passing = self.passing.lock().unwrap_or_else(PoisonError::into_inner);
        for (values, &point) in passing.as_chunks_mut().0.iter_mut().zip(&self.points) {
            *values = of(point as usize).into();
        }
        array.copy_from_slice(py, &passing)
    }

    /// Adds the forces in their array to those of the next step.
    pub(crate) fn push(&self, py: Python<'_>, run: &mut Simulation) -> PyResult<()> {
        let mut passing = self.passing.lock().unwrap_or_else(PoisonError::into_inner);
        self.force.copy_to_slice(py, &mut passing)?;
        let forces = passing.as_chunks().0.iter().map(|force: &[f64; 3]| Vec3::from(*force));
        let added = run.add_forces(self.population, self.points.iter().copied().zip(forces));
        added.map_err(|failure| raise(py, &failure))
    }
}
