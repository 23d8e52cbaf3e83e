//! Forces from outside, a file per kind. A new kind is its file, a variant of [`Load`] and an arm in each of its methods.

mod body_force;
mod crack_pressure;
mod nodal;
mod pressure;
mod release;

use fractum_fem::{CrackNetwork, CrackNetworkState, Solid};
use fractum_math::{CHUNK, Vec3};
use serde::{Deserialize, Serialize};

pub use body_force::Gravity;
pub use crack_pressure::CrackPressure;
pub use nodal::NodalForce;
pub use pressure::Pressure;
pub(crate) use release::Release;

use super::{DrivenPoints, Points};
use crate::error::SceneError;
use crate::gas::{Gas, GasState};
use crate::interfaces::Interfaces;

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

    /// Points that it pushes or whose places it needs, weight aside, and those of the removed elements that it has entered.
    fn points(&self) -> Vec<u32> {
        match self {
            Load::Nodal(load) => load.points.iter().map(|&(point, _)| point).collect(),
            Load::Pressure(load) => load.facets.concat(),
            Load::CrackPressure(load) => load.facets.concat(),
            Load::Gravity(_) => Vec::new(),
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
    /// Forces that who drives the scene sets from step to step [N].
    given: Vec<(u32, Vec3)>,
    /// Forces of the last step.
    applied: Applied,
    partial: Vec<Vec3>,
    /// Cracks that pressure enters.
    cracks: Option<CrackNetwork>,
    /// Gas in holes of the solids and in their cracks.
    gas: Option<Box<Gas>>,
    /// Forces of bodies that have left, which fade.
    released: Vec<Release>,
}

/// What the loads have come to, for a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LoadsState {
    cracks: Option<CrackNetworkState>,
    gas: Option<GasState>,
    released: Vec<Release>,
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
            given: Vec::new(),
            cracks: None,
            gas: None,
            released: Vec::new(),
        }
    }

    /// The same loads with gas in holes of the solids.
    pub fn with_gas(self, gas: Option<Gas>) -> Self {
        Loads { gas: gas.map(Box::new), ..self }
    }

    /// Gas in holes and cracks.
    pub fn gas(&self) -> Option<&Gas> {
        self.gas.as_deref()
    }

    /// The forces of who drives the scene: points, and what acts on each from the next step on [N].
    pub(crate) fn given(&mut self) -> &mut Vec<(u32, Vec3)> {
        &mut self.given
    }

    /// Finds the cracks of a solid that are open to pressure and gas, if any load enters them.
    pub(crate) fn open_cracks(&mut self, solid: &Solid) {
        if let Some(gas) = &mut self.gas {
            gas.open(solid);
        }
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

    /// Lets gas that enters cracks enter interfaces too, before the first step.
    pub(crate) fn enter_interfaces(&mut self, solid: &Solid, interfaces: &Interfaces) {
        if let Some(gas) = &mut self.gas {
            gas.enter(solid, interfaces);
        }
    }

    /// Goes on after the loads of the stage before: its gas is that of this stage too, and so are the forces of who drives the
    /// scene, which act until they are set anew.
    pub(crate) fn follow(&mut self, before: Loads, solid: &Solid) {
        self.open_cracks(solid);
        self.given = before.given;
        self.gas = before.gas.or(self.gas.take());
        self.released = before.released;
        self.make_room();
    }

    /// Has what is left of the forces of bodies that have left fade in this time, but for nodes that are gone.
    pub(crate) fn go_on_releasing(&mut self, time: [f64; 2], is_smooth: bool, is_gone: impl Fn(&u32) -> bool) {
        for release in &mut self.released {
            release.go_on(time, is_smooth);
            release.forces.retain(|(node, _)| !is_gone(node));
        }
        self.released.retain(|release| release.part[0] > 0.0);
    }

    /// Adds the forces of a body that has left.
    pub(crate) fn release(&mut self, release: Release) {
        self.released.push(release);
        self.make_room();
    }

    /// Forces of bodies that have left as they act at a time [N].
    pub(crate) fn released_forces(&self, time: f64) -> impl Iterator<Item = (u32, Vec3)> {
        let of = move |release: &Release| {
            let part = release.part_at(time);
            release.forces.iter().map(move |&(node, force)| (node, force * part)).collect::<Vec<_>>()
        };
        self.released.iter().flat_map(of)
    }

    /// A step allocates nothing.
    fn make_room(&mut self) {
        let count = self.loads.iter().map(Load::count).sum::<usize>();
        let released = self.released.iter().map(|release| release.forces.len()).sum::<usize>();
        self.applied.forces.clear();
        self.applied.forces.reserve(count + released);
    }

    /// Lets pressure and gas enter what the removal of elements has opened.
    pub(crate) fn extend_cracks(&mut self, solid: &Solid, removed: &[(usize, u32)]) {
        if let Some(cracks) = &mut self.cracks {
            cracks.extend(solid, removed.iter().copied());
        }
        if let Some(gas) = &mut self.gas {
            gas.extend(solid, removed);
        }
    }

    /// Brings the gas to tⁿ and adds its forces, see [`Gas::add_forces`].
    pub(crate) fn add_gas_forces(&mut self, solid: &mut Solid, interfaces: &Interfaces, time: f64, elapsed: f64) {
        if let Some(gas) = &mut self.gas {
            gas.add_forces(solid, interfaces, time, elapsed);
        }
    }

    /// Takes the work of the gas in the half step after tⁿ out of it.
    pub(crate) fn spend_gas_work(&mut self, solid: &Solid, dt_after: f64) {
        if let Some(gas) = &mut self.gas {
            gas.spend_work(solid, dt_after);
        }
    }

    /// Everything that changes.
    pub(crate) fn state(&self) -> LoadsState {
        LoadsState {
            cracks: self.cracks.as_ref().map(CrackNetwork::state),
            gas: self.gas.as_ref().map(|gas| gas.state()),
            released: self.released.clone(),
        }
    }

    /// Puts a saved state back, once the solid has lost its elements again.
    pub(crate) fn restore(&mut self, solid: &Solid, state: LoadsState) {
        if let (Some(cracks), Some(state)) = (&mut self.cracks, &state.cracks) {
            cracks.restore(solid, state);
        }
        if let (Some(gas), Some(state)) = (&mut self.gas, state.gas) {
            gas.restore(solid, state);
        }
        self.released = state.released;
        self.make_room();
    }

    /// Forces on all points [N] that hold from the start, and what comes to them until the time `end`, in proportion to time.
    ///
    /// - `masses`: of all points [kg]
    ///
    /// # Errors
    /// [`SceneError::LoadNotProportional`].
    pub(crate) fn proportional(
        &self,
        points: &impl Points,
        masses: &[f64],
        end: f64,
    ) -> Result<[Vec<Vec3>; 2], SceneError> {
        let at = |share: f64| {
            let mut applied = Applied::default();
            self.loads.iter().for_each(|load| load.apply(points, None, share * end, &mut applied));
            let mut sums: Vec<Vec3> = masses.iter().map(|mass| applied.gravity * *mass).collect();
            applied.forces.iter().for_each(|(point, force)| sums[*point as usize] += force);
            sums
        };
        let (constant, mut growing) = (at(0.0), at(1.0));
        let largest = constant.iter().chain(&growing).map(|force| force.amax()).fold(0.0, f64::max);
        growing.iter_mut().zip(&constant).for_each(|(growing, constant)| *growing -= constant);
        for share in [0.1, 0.25, 0.5, 0.7] {
            let expected = constant.iter().zip(&growing).map(|(constant, growing)| constant + growing * share);
            let off = at(share)
                .iter()
                .zip(expected)
                .map(|(part, expected)| part - expected)
                .find(|off| off.amax() > 1e-9 * largest);
            if let Some(off) = off {
                return Err(SceneError::LoadNotProportional { axis: ['x', 'y', 'z'][off.iamax()] });
            }
        }
        Ok([constant, growing])
    }

    /// Whether points have weight.
    pub(crate) fn has_weight(&self) -> bool {
        !self.partial.is_empty()
    }

    /// Points that they push or whose places they need: all may have weight beside, and pressure and gas enter removed elements.
    pub(crate) fn points(&self) -> Vec<u32> {
        let given = self.given.iter().map(|&(point, _)| point);
        let of_gas = self.gas.iter().flat_map(|gas| gas.hole_nodes());
        let released = self.released.iter().flat_map(|release| release.forces.iter().map(|&(node, _)| node));
        given.chain(self.loads.iter().flat_map(Load::points)).chain(of_gas).chain(released).collect()
    }

    /// Whether nothing pushes.
    pub fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Adds the forces of `time` to the points; returns their work in the half step before [J].
    pub(crate) fn add_forces(&mut self, points: &mut impl DrivenPoints, time: f64, dt_before: f64) -> f64 {
        self.applied.forces.clear();
        if self.loads.is_empty() && self.given.is_empty() && self.released.is_empty() {
            return 0.0;
        }
        self.applied.gravity = Vec3::zeros();
        self.loads.iter().for_each(|load| load.apply(points, self.cracks.as_ref(), time, &mut self.applied));
        self.released.iter().for_each(|release| release.apply(time, &mut self.applied.forces));
        let forces = points.forces();
        self.point_forces().for_each(|&(point, force)| forces[point as usize] += force);
        if self.applied.gravity != Vec3::zeros() {
            points.add_weight(&self.applied.gravity);
        }
        0.5 * dt_before * self.power(points)
    }

    /// The last forces on single points [N], those of who drives the scene first.
    fn point_forces(&self) -> impl Iterator<Item = &(u32, Vec3)> {
        self.given.iter().chain(&self.applied.forces)
    }

    /// Sum of the last forces on these points, which are ascending, each along its direction [N]; weight is none of them.
    pub(crate) fn resultant(&self, points: &[u32], direction: impl Fn(usize) -> Vec3) -> f64 {
        let own = self.point_forces().filter(|(point, _)| points.binary_search(point).is_ok());
        own.map(|(point, force)| force.dot(&direction(*point as usize))).sum()
    }

    /// Power of the last forces at the present velocities [W].
    pub(crate) fn power(&mut self, points: &impl DrivenPoints) -> f64 {
        let mut power: f64 =
            self.point_forces().map(|(point, force)| force.dot(points.velocity(*point as usize))).sum();
        let gravity = self.applied.gravity;
        if gravity != Vec3::zeros() {
            power += gravity.dot(&points.momentum(&mut self.partial));
        }
        power
    }
}

#[cfg(test)]
mod tests {
    use fractum_fem::{Body, Elastic, ElementKind};

    use super::*;

    #[test]
    fn forces_from_outside_act_in_the_stage_that_follows_too() {
        let nodes = vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
        let elastic = Elastic { density: 1.0, young_modulus: 1.0, poisson_ratio: 0.0 };
        let solid = Solid::new(nodes, vec![Body::new("body", ElementKind::T4, vec![[0, 1, 2, 3]], elastic)]).unwrap();
        let given = vec![(2, Vec3::x())];
        let mut before = Loads::new(Vec::new(), 4);
        before.given().clone_from(&given);
        let mut next = Loads::new(Vec::new(), 4);
        next.follow(before, &solid);
        assert_eq!(*next.given(), given);
    }
}
