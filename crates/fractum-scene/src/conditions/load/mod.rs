//! Forces from outside, a file per kind. A new kind is its file, a variant of [`Load`] and an arm in each of its methods.

mod body_force;
mod crack_pressure;
mod nodal;
mod pressure;

use fractum_fem::{CrackNetwork, CrackNetworkState, Solid};
use fractum_math::{CHUNK, Vec3};

pub use body_force::Gravity;
pub use crack_pressure::CrackPressure;
pub use nodal::NodalForce;
pub use pressure::Pressure;

use super::{DrivenPoints, Points};

/// A force from outside.
#[derive(Clone, Debug)]
pub enum Load {
    /// Forces on points with weights.
    Nodal(NodalForce),
    /// Pressure on facets.
    Pressure(Pressure),
    /// Pressure on facets and in the cracks that are open to them.
    CrackPressure(CrackPressure),
    /// An acceleration of every point.
    Gravity(Gravity),
}

/// Forces of one instant.
#[derive(Clone, Debug, Default)]
struct Applied {
    /// Forces on single points [N].
    forces: Vec<(u32, Vec3)>,
    /// Acceleration of all points [m/s²].
    gravity: Vec3,
}

impl Load {
    /// Number of forces on single points.
    fn count(&self) -> usize {
        match self {
            Load::Nodal(load) => load.points.len(),
            Load::Pressure(load) => 3 * load.facets.len(),
            Load::CrackPressure(load) => 3 * load.facets.len(),
            Load::Gravity(_) => 0,
        }
    }

    /// Adds the forces of `time`.
    ///
    /// - `cracks`: those that pressure enters; none before [`Loads::open_cracks`]
    fn apply(&self, points: &impl Points, cracks: Option<&CrackNetwork>, time: f64, applied: &mut Applied) {
        match self {
            Load::Nodal(load) => load.apply(points, time, &mut applied.forces),
            Load::Pressure(load) => load.apply(points, time, &mut applied.forces),
            Load::CrackPressure(load) => {
                cracks.into_iter().for_each(|cracks| load.apply(points, cracks, time, &mut applied.forces));
            }
            Load::Gravity(load) => load.apply(time, &mut applied.gravity),
        }
    }
}

/// All loads of one population: the nodes of solids, or the particles.
#[derive(Clone, Debug, Default)]
pub struct Loads {
    loads: Vec<Load>,
    /// Forces of the last step.
    applied: Applied,
    partial: Vec<Vec3>,
    /// Cracks that pressure enters.
    cracks: Option<CrackNetwork>,
}

impl Loads {
    /// Collects loads for a population of `count` points.
    pub fn new(loads: Vec<Load>, count: usize) -> Self {
        let weighs = loads.iter().any(|load| matches!(load, Load::Gravity(_)));
        let forces = Vec::with_capacity(loads.iter().map(Load::count).sum());
        Loads {
            applied: Applied { forces, gravity: Vec3::zeros() },
            partial: vec![Vec3::zeros(); if weighs { count.div_ceil(CHUNK) } else { 0 }],
            loads,
            cracks: None,
        }
    }

    /// Finds the cracks of a solid that are open to pressure, if any load enters them.
    pub(crate) fn open_cracks(&mut self, solid: &Solid) {
        let mouths = CrackPressure::mouths(self.loads.iter_mut().filter_map(|load| match load {
            Load::CrackPressure(load) => Some(load),
            _ => None,
        }));
        if mouths.is_empty() {
            return;
        }
        let mut cracks = CrackNetwork::new(solid, mouths);
        cracks.extend_by_all(solid);
        self.cracks = Some(cracks);
    }

    /// Lets pressure enter what the removal of elements has opened.
    pub(crate) fn extend_cracks(&mut self, solid: &Solid, removed: &[(usize, u32)]) {
        if let Some(cracks) = &mut self.cracks {
            cracks.extend(solid, removed.iter().copied());
        }
    }

    /// The cracks that pressure has entered, for a checkpoint.
    pub(crate) fn crack_state(&self) -> Option<CrackNetworkState> {
        self.cracks.as_ref().map(CrackNetwork::state)
    }

    /// Puts saved cracks back, once the solid has lost its elements again.
    pub(crate) fn restore_cracks(&mut self, solid: &Solid, state: &CrackNetworkState) {
        if let Some(cracks) = &mut self.cracks {
            cracks.restore(solid, state);
        }
    }

    /// Whether nothing pushes.
    pub fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Adds the forces of `time` to the points; returns their work in the half step before [J].
    pub(crate) fn add_forces(&mut self, points: &mut impl DrivenPoints, time: f64, dt_before: f64) -> f64 {
        if self.loads.is_empty() {
            return 0.0;
        }
        self.applied.forces.clear();
        self.applied.gravity = Vec3::zeros();
        self.loads.iter().for_each(|load| load.apply(points, self.cracks.as_ref(), time, &mut self.applied));
        let forces = points.forces();
        self.applied.forces.iter().for_each(|&(point, force)| forces[point as usize] += force);
        if self.applied.gravity != Vec3::zeros() {
            points.add_weight(&self.applied.gravity);
        }
        0.5 * dt_before * self.power(points)
    }

    /// Power of the last forces at the present velocities [W].
    pub(crate) fn power(&mut self, points: &impl DrivenPoints) -> f64 {
        let Applied { forces, gravity } = &self.applied;
        let mut power: f64 = forces.iter().map(|(point, force)| force.dot(points.velocity(*point as usize))).sum();
        if *gravity != Vec3::zeros() {
            power += gravity.dot(&points.momentum(&mut self.partial));
        }
        power
    }
}
