//! Rigid bodies that press with a given force: their speed follows what is missing of it.

use fractum_math::Vec3;

use crate::time_function::TimeFunction;

/// Mass that the motion of a servo has, over that of what it touches: contacts with a wall of finite mass are faster than with one that
/// does not give way, by √(1 + 1/4) here, which the margin of the stable step covers.
const INERTIA: f64 = 4.0;

/// How a rigid body presses along an axis of space: with a given force, no faster than a given speed.
///
/// Its velocity w in the direction in which it presses follows M dw/dt = F_t − F − c w, between ± the largest speed V, with the force F_t asked for, the
/// force F on what it touches, the damper c = r F_t/V and four times the mass M that it touches. So it approaches at V, slows down as the last
/// part r of the force is missing, and holds still under the force asked for. M keeps stiff contacts from a force that swings from step to step.
#[derive(Clone)]
pub struct Servo {
    /// Direction in which it presses: 1 or -1 along the axis.
    pub sign: f64,
    /// Force [N] over time; with an area a pressure [Pa].
    pub target: TimeFunction,
    /// What a pressure acts on.
    pub area: Option<ServoArea>,
    /// Largest speed V [m/s].
    pub speed: f64,
    /// Share r of the force that is missing where it begins to slow down.
    pub reach: f64,
}

/// The area that the pressure of a servo acts on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ServoArea {
    /// This one [m²].
    Given(f64),
    /// That between two pairs of planes, which move.
    Between {
        /// Rigid bodies, each plane before the one opposite to it.
        planes: [usize; 4],
        /// Product of both distances at tⁿ [m²].
        now: f64,
    },
}

/// What a servo goes by in a step.
pub(super) struct ServoStep {
    pub(super) time: f64,
    /// Step of the kick [s].
    pub(super) dt: f64,
    /// Velocity along the axis before [m/s].
    pub(super) velocity: f64,
    /// Force of the contacts on the body along the axis [N].
    pub(super) force: f64,
    /// Mass of what it touches [kg].
    pub(super) touched: f64,
}

impl Servo {
    /// Force that is asked for [N].
    ///
    /// - `start`: where the body began
    pub(super) fn wanted(&self, time: f64, start: &Vec3) -> f64 {
        let area = match self.area {
            Some(ServoArea::Given(area) | ServoArea::Between { now: area, .. }) => area,
            None => 1.0,
        };
        area * (self.target)(time, start)
    }

    /// Velocity along the axis in the step that follows [m/s].
    ///
    /// - `start`: where the body began
    pub(super) fn velocity(&self, step: &ServoStep, start: &Vec3) -> f64 {
        let target = self.wanted(step.time, start);
        let missing = target + self.sign * step.force;
        let mass = INERTIA * step.touched;
        let resistance = mass + step.dt * self.reach * target.abs() / self.speed;
        let pushed = self.sign * step.velocity * mass + step.dt * missing;
        if resistance == 0.0 {
            // Nothing is asked for, and nothing touches.
            return 0.0;
        }
        self.sign * (pushed / resistance).clamp(-self.speed, self.speed)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn servo() -> Servo {
        Servo { sign: -1.0, target: Arc::new(|_, _| 100.0), area: Some(ServoArea::Given(0.5)), speed: 0.2, reach: 0.1 }
    }

    fn speed_at(force: f64, touched: f64, velocity: f64) -> f64 {
        servo().velocity(&ServoStep { time: 0.0, dt: 1e-3, velocity, force, touched }, &Vec3::zeros())
    }

    #[test]
    fn it_approaches_at_full_speed_and_stops_at_the_force_that_is_asked_for() {
        // It presses along -z: contacts push it along z.
        assert_eq!(speed_at(0.0, 0.0, 0.0), -0.2);
        assert_eq!(speed_at(40.0, 0.0, 0.0), -0.2);
        assert!((speed_at(47.5, 0.0, 0.0) + 0.1).abs() < 1e-12);
        assert_eq!(speed_at(50.0, 0.0, 0.0), 0.0);
        assert_eq!(speed_at(80.0, 0.0, 0.0), 0.2);
    }

    #[test]
    fn what_it_touches_slows_its_changes() {
        let step = speed_at(80.0, 1.0, 0.0);
        assert!(step > 0.0 && step < 0.01, "{step}");
        assert!((speed_at(50.0, 1.0, -0.1) + 0.1).abs() < 1e-3);
    }

    #[test]
    fn no_force_and_no_contact_is_no_motion() {
        let still = Servo { target: Arc::new(|_, _| 0.0), ..servo() };
        let step = ServoStep { time: 0.0, dt: 1e-3, velocity: 0.1, force: 0.0, touched: 0.0 };
        assert_eq!(still.velocity(&step, &Vec3::zeros()), 0.0);
    }
}
