use serde::{Deserialize, Serialize};

use super::ContactParameters;
use super::motion::{ContactForce, PairMotion};
use super::rolling::{Rolling, RollingMemory};
use super::slip::slip_to_cone;
use crate::Vec3;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Linear springs along and across the normal with viscous damping, Coulomb friction, and friction against [`Rolling`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Linear {
    /// Normal stiffness k_n [N/m].
    pub normal_stiffness: f64,
    /// Tangential stiffness k_t [N/m].
    pub tangential_stiffness: f64,
    /// Normal damping c_n [N s/m].
    pub normal_damping: f64,
    /// Coulomb's coefficient μ ≥ 0.
    pub friction: f64,
    /// Friction against rolling.
    pub rolling: Rolling,
}

/// What a contact remembers from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactMemory {
    /// Stretch of the tangential spring [m].
    pub slip: Vec3,
    rolling: RollingMemory,
    /// Normal at the last step; zero out of contact.
    normal: Vec3,
    /// Force of the normal damper on j at the last step [N].
    damper: Vec3,
    /// Part of the overlap that gives no force [m], see [`ContactLaw::add_overlap_offset`](super::ContactLaw::add_overlap_offset).
    pub(super) overlap_offset: f64,
}

impl Linear {
    /// The law of two elastic spheres: k_n = E π min(r)²/(r_i + r_j), k_t = k_n/(2(1 + ν)), c_n = 2 ξ √(m k_n) with
    /// the reduced mass m.
    ///
    /// - `young_modulus` [Pa], `poisson_ratio`, `radii` [m], `masses` [kg]
    #[inline]
    pub fn between_spheres(
        young_modulus: f64,
        poisson_ratio: f64,
        radii: [f64; 2],
        masses: [f64; 2],
        surface: ContactParameters,
    ) -> Self {
        let smaller = radii[0].min(radii[1]);
        let stiffness = young_modulus * core::f64::consts::PI * smaller * smaller / (radii[0] + radii[1]);
        let reduced = |[a, b]: [f64; 2]| a * b / (a + b);
        Linear::new(stiffness, poisson_ratio, reduced(radii), reduced(masses), surface)
    }

    /// The law of two elastic discs in the plane: k_n = E 2 min(r) t/(r_i + r_j), the rest as between spheres.
    ///
    /// - `thickness` t [m], the smaller one of the two
    #[inline]
    pub fn between_discs(
        young_modulus: f64,
        poisson_ratio: f64,
        radii: [f64; 2],
        thickness: f64,
        masses: [f64; 2],
        surface: ContactParameters,
    ) -> Self {
        let stiffness = young_modulus * 2.0 * radii[0].min(radii[1]) * thickness / (radii[0] + radii[1]);
        let reduced = |[a, b]: [f64; 2]| a * b / (a + b);
        Linear::new(stiffness, poisson_ratio, reduced(radii), reduced(masses), surface)
    }

    /// The law of a disc on a rigid wall, that of a disc on its mirror image: k_n = E t.
    #[inline]
    pub fn disc_on_wall(
        young_modulus: f64,
        poisson_ratio: f64,
        radius: f64,
        thickness: f64,
        mass: f64,
        surface: ContactParameters,
    ) -> Self {
        Linear::new(young_modulus * thickness, poisson_ratio, radius, mass, surface)
    }

    /// The law of a sphere on a rigid wall, that of a sphere on its mirror image: k_n = E π r/2.
    #[inline]
    pub fn on_wall(young_modulus: f64, poisson_ratio: f64, radius: f64, mass: f64, surface: ContactParameters) -> Self {
        let stiffness = 0.5 * young_modulus * core::f64::consts::PI * radius;
        Linear::new(stiffness, poisson_ratio, radius, mass, surface)
    }

    #[inline]
    fn new(stiffness: f64, poisson_ratio: f64, radius: f64, mass: f64, surface: ContactParameters) -> Self {
        let tangential_stiffness = stiffness / (2.0 * (1.0 + poisson_ratio));
        Linear {
            normal_stiffness: stiffness,
            tangential_stiffness,
            normal_damping: 2.0 * surface.damping_ratio * (mass * stiffness).sqrt(),
            friction: surface.friction,
            rolling: Rolling::new(surface.rolling_friction, radius, mass),
        }
    }

    /// The same with another normal stiffness [N/m], with the tangential one and the damper that go with it.
    #[inline]
    pub fn with_stiffness(self, normal_stiffness: f64) -> Self {
        let ratio = normal_stiffness / self.normal_stiffness;
        Linear {
            normal_stiffness,
            tangential_stiffness: self.tangential_stiffness * ratio,
            normal_damping: self.normal_damping * ratio.sqrt(),
            ..self
        }
    }

    /// Force of a pair; its memory advances with the call.
    ///
    /// A contact that begins or ends in a step beside the moment acts for a part of that step only, see
    /// `partial_spring`. Out of contact the slip is forgotten. The damper never pulls: the normal force stays ≥ 0. Energies are those of
    /// the step that led here, with the mean of the forces at its ends, as central differences book them.
    #[inline]
    pub fn force(&self, motion: &PairMotion, memory: &mut ContactMemory) -> ContactForce {
        let n = motion.normal;
        let approach = -motion.velocity.dot(&n);
        let last = core::mem::take(&mut memory.damper);
        memory.overlap_offset = memory.overlap_offset.min(motion.overlap.max(0.0));
        let overlap = motion.overlap - memory.overlap_offset;
        if overlap <= 0.0 {
            // What the springs held is lost: they slip with nothing to press them.
            let across = motion.velocity + n * approach;
            let (_, slid) = self.slide(memory.slip, memory.slip + across * motion.dt, 0.0);
            let rolled = memory.rolling.stored();
            let damping = memory.rolling.last_damping(motion) - 0.5 * last.dot(&motion.velocity) * motion.dt;
            (memory.slip, memory.normal, memory.rolling) = (Vec3::zeros(), Vec3::zeros(), RollingMemory::default());
            return ContactForce { friction: slid + rolled, damping, ..ContactForce::default() };
        }
        let (elastic, compressed) = partial_spring(self.normal_stiffness, overlap, approach * motion.dt);
        let damper = (self.normal_damping * approach).max(-elastic);
        let normal_force = elastic + damper;
        memory.damper = n * damper;

        // The spring is stretched in the tangent plane of the middle of the step: seen from there the forces at both ends
        // of the step do the work that the stretch takes.
        let before = turned_to(memory.slip, &n);
        let last_normal = core::mem::replace(&mut memory.normal, n);
        let middle = if last_normal.dot(&n) > 0.0 { (n + last_normal).normalize() } else { n };
        let way = motion.velocity * motion.dt;
        let trial = turned_to(turned_to(memory.slip, &middle) + way - middle * way.dot(&middle), &n);
        let (slip, slid) = self.slide(before, trial, self.friction * normal_force);
        memory.slip = slip;

        let mut force = ContactForce {
            on_second: n * normal_force - slip * self.tangential_stiffness,
            couple_on_second: Vec3::zeros(),
            stored: compressed + 0.5 * self.tangential_stiffness * slip.norm_squared(),
            friction: slid,
            damping: -0.5 * (last + memory.damper).dot(&motion.velocity) * motion.dt,
        };
        if self.rolling.arm > 0.0 {
            let rolled = self.rolling.couple(motion, normal_force, self.normal_stiffness, &mut memory.rolling);
            force.couple_on_second = rolled.on_second;
            force.stored += rolled.stored;
            force.friction += rolled.friction;
            force.damping += rolled.damping;
        }
        force
    }

    /// Stretch of the tangential spring that a largest force [N] leaves of `trial`, and the energy that slipping took since the
    /// stretch was `before` [J].
    #[inline]
    fn slide(&self, before: Vec3, trial: Vec3, limit: f64) -> (Vec3, f64) {
        let after = slip_to_cone(trial, self.tangential_stiffness * trial.norm(), limit);
        let mean_force = (before + after) * (0.5 * self.tangential_stiffness);
        (after, mean_force.dot(&(trial - after)).max(0.0))
    }
}

/// Force [N] and energy [J] of a normal spring of stiffness k [N/m] at an overlap δ > 0 that changes by `way` w in a step [m].
///
/// Central differences let the force of a moment act over the halves of the steps beside it. Where the pair was δ - |w| < 0 a step
/// ago, or will be after the next, it is in contact for the share δ/|w| of that step, and so is the force:
/// k δ (1 + δ/|w|)/2. The energy is what it has done in the step to here, or will do in the next one: F |w|/2. At a constant
/// rate the spring then closes and opens without gain or loss; with the full force each time costs or brings
/// k δ (|w| - δ)/2, which does not vanish in the sum where contacts last for few steps.
#[inline]
fn partial_spring(stiffness: f64, overlap: f64, way: f64) -> (f64, f64) {
    let (full, way) = (stiffness * overlap, way.abs());
    if way <= overlap {
        return (full, 0.5 * full * overlap);
    }
    let force = 0.5 * full * (1.0 + overlap / way);
    (force, 0.5 * force * way)
}

/// A stretch turned into the plane across a normal, where it keeps its length.
#[inline]
fn turned_to(stretch: Vec3, normal: &Vec3) -> Vec3 {
    let flat = stretch - normal * stretch.dot(normal);
    let length = flat.norm();
    if length > 0.0 { flat * (stretch.norm() / length) } else { Vec3::zeros() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn law() -> Linear {
        Linear {
            normal_stiffness: 1e5,
            tangential_stiffness: 4e4,
            normal_damping: 3.0,
            friction: 0.4,
            rolling: Rolling { arm: 1e-3, inertia: 1e-6 },
        }
    }

    proptest! {
        #[test]
        fn friction_stays_in_the_cone_and_nothing_pulls(
            normal in prop::array::uniform3(-1f64..1.0),
            velocity in prop::array::uniform3(-5f64..5.0),
            slip in prop::array::uniform3(-1e-3f64..1e-3),
            spin in prop::array::uniform3(-50f64..50.0),
            overlap in -1e-3f64..1e-3,
        ) {
            let normal = Vec3::from(normal);
            prop_assume!(normal.norm() > 0.1);
            let motion = PairMotion { normal: normal.normalize(), overlap, velocity: velocity.into(), spin: spin.into(), dt: 1e-5 };
            let mut memory = ContactMemory { slip: Vec3::from(slip), ..ContactMemory::default() };
            let force = law().force(&motion, &mut memory);
            let along = force.on_second.dot(&motion.normal);
            let across = (force.on_second - motion.normal * along).norm();
            prop_assert!(along >= 0.0);
            prop_assert!(across <= law().friction * along * (1.0 + 1e-9) + 1e-9);
            prop_assert!(force.couple_on_second.norm() <= law().rolling.arm * along * (1.0 + 1e-9) + 1e-12);
            // Friction against rolling is what is missing of the spring's energy: zero but for round-off while it holds.
            prop_assert!(force.friction > -1e-18 && force.stored >= 0.0 && force.damping >= 0.0);
            if overlap <= 0.0 {
                prop_assert_eq!(force, ContactForce { friction: force.friction, ..ContactForce::default() });
            }
        }
    }

    #[test]
    fn what_springs_hold_when_a_contact_opens_is_booked_as_friction() {
        let motion = |overlap: f64, spin: Vec3| PairMotion {
            normal: Vec3::x(),
            overlap,
            velocity: Vec3::zeros(),
            spin,
            dt: 1e-5,
        };
        let mut memory = ContactMemory { slip: Vec3::new(0.0, 1e-6, 0.0), ..ContactMemory::default() };
        let held = law().force(&motion(1e-4, Vec3::y() * 30.0), &mut memory).stored - 0.5 * 1e5 * 1e-8;
        let slid = 0.5 * 4e4 * 1e-12;
        assert!(held > 1.01 * slid, "both springs hold something: {held:e}");
        let opened = law().force(&motion(-1e-6, Vec3::zeros()), &mut memory);
        assert!((opened.friction / held - 1.0).abs() < 1e-6, "{:e} of {held:e}", opened.friction);
        assert_eq!(law().force(&motion(-1e-6, Vec3::zeros()), &mut memory).friction, 0.0);
    }

    #[test]
    fn bounce_gives_back_what_damping_leaves() {
        // A mass on the normal spring: restitution exp(-π ξ/√(1 - ξ²)) of the linear oscillator, up to the clipped end.
        let (mass, xi): (f64, f64) = (0.2, 0.05);
        let law = Linear::new(
            1e5,
            0.2,
            0.1,
            mass,
            ContactParameters { friction: 0.0, rolling_friction: 0.0, damping_ratio: xi },
        );
        let (mut x, mut v, dt) = (0.0, -1.0, 1e-7);
        let mut memory = ContactMemory::default();
        loop {
            let motion =
                PairMotion { normal: Vec3::x(), overlap: -x, velocity: Vec3::x() * v, spin: Vec3::zeros(), dt };
            v += law.force(&motion, &mut memory).on_second.x / mass * dt;
            x += v * dt;
            if x > 0.0 {
                break;
            }
        }
        let expected = (-std::f64::consts::PI * xi / (1.0 - xi * xi).sqrt()).exp();
        assert!((v - expected).abs() < 0.01, "{v} against {expected}");
    }

    #[test]
    fn rolling_friction_stops_a_rolling_sphere_after_the_distance_of_theory() {
        // Rolling without sliding under the couple μ_r R m g: deceleration (5/7) μ_r g, path v²/(2 a).
        let (mass, radius, g, mu_r): (f64, f64, f64, f64) = (0.1, 0.02, 9.81, 0.05);
        let surface = ContactParameters { friction: 0.8, rolling_friction: mu_r, damping_ratio: 0.0 };
        let law = Linear::on_wall(1e6, 0.2, radius, mass, surface);
        let overlap = mass * g / law.normal_stiffness;
        let arm = -Vec3::z() * (radius - overlap);
        let (mut x, mut v, mut spin, dt) = (0.0, 0.3, Vec3::y() * (0.3 / arm.norm()), 1e-6);
        let (mut memory, mut friction, start) = (ContactMemory::default(), 0.0, 0.5 * 1.4 * mass * 0.3 * 0.3);
        for _ in 0..1_800_000 {
            let velocity = Vec3::x() * v + spin.cross(&arm);
            let force = law.force(&PairMotion { normal: Vec3::z(), overlap, velocity, spin, dt }, &mut memory);
            v += force.on_second.x / mass * dt;
            spin += (arm.cross(&force.on_second) + force.couple_on_second) / (0.4 * mass * radius * radius) * dt;
            x += v * dt;
            friction += force.friction;
        }
        let expected = 0.3 * 0.3 / (2.0 * mu_r * g * 5.0 / 7.0);
        assert!((x / expected - 1.0).abs() < 0.01, "{x} against {expected}");
        // The spring that holds it would have it rock for ever at this speed.
        let rocking = (g * overlap / (2.25 * 1.4)).sqrt();
        assert!(v.abs() < 1e-9 * rocking, "still rolls at {v}, would rock at {rocking}");
        assert!((friction / start - 1.0).abs() < 0.01, "{friction} J of {start}");
    }
}
