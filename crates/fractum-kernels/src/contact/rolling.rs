use serde::{Deserialize, Serialize};

use super::motion::PairMotion;
use super::slip::slip_to_cone;
use crate::Vec3;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Friction against rolling: an elastic-plastic spring between the rotations of both bodies.
///
/// The couple on j is -k_r θ, with the relative rolling angle θ since the spring was last at rest and
/// k_r = 9/4 k_n (μ_r R*)², limited to μ_r R* F_n; beyond that it rolls on at constant moment. Beside the spring stands a
/// damper c_r = 2 √(I k_r), critical for a sphere that rolls on a wall without slip, within what the limit leaves; it brings what rolls to
/// rest, and rests while the limit is reached. Twisting about the
/// normal is not resisted. (Ai et al. 2011, model C; stiffness of Iwashita and Oda 1998.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rolling {
    /// μ_r R* [m]: largest distance of the normal force from the centre of the contact.
    pub arm: f64,
    /// I = 7/5 m* R*² [kg m²]: moment of inertia of a sphere about the contact; of a disc 3/2 m* R*².
    pub inertia: f64,
}

/// Couple of a contact and its energies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RollingCouple {
    /// Couple on j; i feels the opposite [N m].
    pub(super) on_second: Vec3,
    /// Energy in the spring [J].
    pub(super) stored: f64,
    /// Energy taken in this step beyond the limit [J].
    pub(super) friction: f64,
    /// Energy taken in this step by the damper [J].
    pub(super) damping: f64,
}

/// What the rolling spring remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RollingMemory {
    /// Moment on i at the last step [N m].
    moment: Vec3,
    /// Moment of the damper on i at the last step [N m].
    drag: Vec3,
    /// Stiffness at the last step [N m].
    stiffness: f64,
}

impl RollingMemory {
    /// Energy in the spring [J].
    #[inline]
    pub(super) fn stored(&self) -> f64 {
        if self.stiffness > 0.0 { 0.5 * self.moment.norm_squared() / self.stiffness } else { 0.0 }
    }

    /// Energy that the damper of the last step takes in a step that ends out of contact [J].
    #[inline]
    pub(super) fn last_damping(&self, motion: &PairMotion) -> f64 {
        0.5 * self.drag.dot(&motion.spin) * motion.dt
    }
}

impl Rolling {
    /// Friction of a coefficient μ_r ≥ 0 for an effective radius R* [m] and an effective mass m* [kg].
    #[inline]
    pub fn new(coefficient: f64, radius: f64, mass: f64) -> Self {
        Rolling { arm: coefficient * radius, inertia: 1.4 * mass * radius * radius }
    }

    /// The same between discs.
    #[inline]
    pub(super) fn of_disc(coefficient: f64, radius: f64, mass: f64) -> Self {
        Rolling { inertia: 1.5 * mass * radius * radius, ..Rolling::new(coefficient, radius, mass) }
    }

    /// Squared frequency that a sphere of `radius` [m] which turns freely has for an explicit step, over k_n/m: k_r m/I (√(1 + ζ²) + ζ)² with
    /// the damping ratio ζ = √(7/2) that 2 √(7/5 m r² k_r) is for I = 2/5 m r².
    #[inline]
    pub fn frequency_factor(&self, radius: f64) -> f64 {
        2.25 * 2.5 * (self.arm / radius).powi(2) * (4.5f64.sqrt() + 3.5f64.sqrt()).powi(2)
    }

    /// Couple of a contact with the given normal force [N] and stiffness [N/m], both above 0; its memory advances with
    /// the call.
    #[inline]
    pub(super) fn couple(
        &self,
        motion: &PairMotion,
        normal_force: f64,
        normal_stiffness: f64,
        memory: &mut RollingMemory,
    ) -> RollingCouple {
        let PairMotion { normal, spin, dt, .. } = motion;
        let old = *memory;
        let stiffness = 2.25 * normal_stiffness * self.arm * self.arm;
        let rolling = spin - normal * spin.dot(normal);
        let flat = old.moment - normal * old.moment.dot(normal);
        // A spring that stiffens keeps its moment, one that softens loses it in proportion: neither gains energy.
        let kept = if stiffness < old.stiffness { flat * (stiffness / old.stiffness) } else { flat };
        let trial = kept + rolling * (stiffness * dt);
        let (size, limit) = (trial.norm(), self.arm * normal_force);
        let (moment, drag) = if size > limit {
            (slip_to_cone(trial, size, limit), Vec3::zeros())
        } else {
            let whole = trial + rolling * (2.0 * (self.inertia * stiffness).sqrt());
            (trial, slip_to_cone(whole, whole.norm(), limit) - trial)
        };
        *memory = RollingMemory { moment, drag, stiffness };
        let stored = memory.stored();
        let work = 0.5 * (flat + moment).dot(&rolling) * *dt;
        RollingCouple {
            on_second: -moment - drag,
            stored,
            friction: work + old.stored() - stored,
            damping: 0.5 * (old.drag + drag).dot(&rolling) * *dt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(spin: Vec3, dt: f64) -> PairMotion {
        PairMotion { normal: Vec3::z(), overlap: 1e-6, velocity: Vec3::zeros(), spin, dt }
    }

    #[test]
    fn a_rolling_sphere_stops_after_the_distance_that_its_friction_takes() {
        // A sphere rolls without slip on a floor: the moment μ_r R W takes its energy 7/10 m v² over some
        // 7 v²/(10 μ_r g), and then its damper brings it to rest.
        let (mass, radius, coefficient, gravity, speed) = (0.3, 0.01, 0.02, 9.81, 0.2);
        let law = Rolling::new(coefficient, radius, mass);
        let inertia = 1.4 * mass * radius * radius;
        let (mut angle, mut spin, dt) = (0.0, speed / radius, 2e-6);
        let (mut memory, mut taken, mut stored) = (RollingMemory::default(), 0.0, 0.0);
        let mut farthest: f64 = 0.0;
        for _ in 0..1_000_000 {
            let weight = mass * gravity;
            let moment = law.couple(&turning(Vec3::y() * spin, dt), weight, 1e6, &mut memory);
            spin += moment.on_second.y / inertia * dt;
            angle += spin * dt;
            farthest = farthest.max(angle);
            taken += moment.friction + moment.damping;
            stored = moment.stored;
        }
        assert!(spin.abs() < 1e-9 * speed / radius, "still turns at {spin}");
        // While the moment grows to its limit, over the angle W/(9/4 k_n μ_r R), it takes half as much.
        let growing = mass * gravity / (2.25 * 1e6 * coefficient * radius);
        let expected = 0.7 * speed * speed / (coefficient * gravity) + 0.5 * growing * radius;
        assert!((farthest * radius / expected - 1.0).abs() < 1e-3, "{} against {expected}", farthest * radius);
        let energy = 0.5 * inertia * (speed / radius).powi(2);
        let left = stored + 0.5 * inertia * spin * spin;
        assert!(((taken + left) / energy - 1.0).abs() < 1e-4, "energy {}", (taken + left) / energy);
        assert!(left < 1e-3 * energy, "left {}", left / energy);
    }

    #[test]
    fn twist_about_the_normal_is_free() {
        let law = Rolling { arm: 1e-3, inertia: 1e-6 };
        let couple = law.couple(&turning(Vec3::z(), 1e-3), 1.0, 1e4, &mut RollingMemory::default());
        assert_eq!(couple, RollingCouple::default());
    }
}
