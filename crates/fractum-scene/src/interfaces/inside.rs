//! Pressure inside of interfaces: what is between their sides pushes on both.

use std::fmt;

use fractum_math::Vec3;

use super::{Interfaces, Point};
use crate::time_function::TimeFunction;

/// Pressure inside of an interface, on both of its sides. The tractions of the interface are those that are left: effective ones.
#[derive(Clone)]
pub struct InsidePressure {
    /// Pressure over time and place [Pa]; positive pushes the sides apart.
    pub value: TimeFunction,
    /// Whether it acts on the share that has lost its strength alone.
    pub in_broken: bool,
}

impl fmt::Debug for InsidePressure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("InsidePressure").field("in_broken", &self.in_broken).finish_non_exhaustive()
    }
}

impl InsidePressure {
    /// Force on the second node of a point at a time [N].
    ///
    /// - `residual`: strength that is left
    pub(super) fn thrust(&self, point: &Point, residual: f64, time: f64) -> Vec3 {
        let share = if self.in_broken { 1.0 - residual } else { 1.0 };
        point.frame.row(0).transpose() * ((self.value)(time, &point.place) * share * point.area)
    }
}

impl Interfaces {
    /// The same with pressure inside of them, one entry for each.
    pub fn with_pressures(self, pressures: Vec<Option<InsidePressure>>) -> Self {
        Interfaces { pressures, ..self }
    }

    /// Adds the forces of the pressures inside of them at a time, with the strengths of the last state.
    ///
    /// - `forces`: on the nodes [N]
    pub(crate) fn push_apart(&self, time: f64, forces: &mut [Vec3]) {
        for point in self.clusters.iter().flat_map(|cluster| &cluster.points).filter(|point| point.area > 0.0) {
            let Some(pressure) = pressure_in(&self.pressures, point.kind) else { continue };
            let thrust = pressure.thrust(point, point.state.residual, time);
            let [a, b] = point.pair.map(|node| node as usize);
            forces[a] -= thrust;
            forces[b] += thrust;
        }
    }

    /// Takes over the pressures of the same interfaces in a later stage.
    pub(crate) fn take_pressures(&mut self, next: Interfaces) {
        self.pressures = next.pressures;
    }
}

/// The pressure inside of an interface, if there is one.
pub(super) fn pressure_in(pressures: &[Option<InsidePressure>], kind: u32) -> Option<&InsidePressure> {
    pressures.get(kind as usize)?.as_ref()
}
