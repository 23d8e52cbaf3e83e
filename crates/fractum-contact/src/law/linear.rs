use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

/// Linear springs along and across the normal with viscous damping and Coulomb friction.
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
}

/// Geometry and motion of a pair at one instant.
#[derive(Clone, Copy, Debug)]
pub struct PairMotion {
    /// Unit normal from i to j.
    pub normal: Vec3,
    /// Overlap δ [m], positive in contact.
    pub overlap: f64,
    /// Velocity of j relative to i at the contact point [m/s].
    pub velocity: Vec3,
    /// Time step over which the tangential spring is advanced [s].
    pub dt: f64,
}

/// Force of a contact and its energies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactForce {
    /// Force on j; i feels the opposite [N].
    pub on_second: Vec3,
    /// Energy in both springs [J].
    pub stored: f64,
    /// Energy taken by friction in this step [J].
    pub friction: f64,
    /// Energy taken by the normal damper in this step [J].
    pub damping: f64,
}

/// What a contact remembers from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactMemory {
    /// Stretch of the tangential spring [m].
    pub slip: Vec3,
    /// Force of the normal damper at the last step [N].
    damper: f64,
}

impl Linear {
    /// The law of two elastic spheres: k_n = E π min(r)²/(r_i + r_j), k_t = k_n/(2(1 + ν)), c_n = 2 ξ √(m k_n) with
    /// the reduced mass m.
    ///
    /// - `young_modulus` [Pa], `poisson_ratio`, `radii` [m], `masses` [kg], `damping_ratio` ξ in 0..1
    pub fn between_spheres(
        young_modulus: f64,
        poisson_ratio: f64,
        radii: [f64; 2],
        masses: [f64; 2],
        friction: f64,
        damping_ratio: f64,
    ) -> Self {
        let smaller = radii[0].min(radii[1]);
        let stiffness = young_modulus * std::f64::consts::PI * smaller * smaller / (radii[0] + radii[1]);
        let mass = masses[0] * masses[1] / (masses[0] + masses[1]);
        Linear::new(stiffness, poisson_ratio, mass, friction, damping_ratio)
    }

    /// The law of a sphere on a rigid wall, that of a sphere on its mirror image: k_n = E π r/2.
    pub fn on_wall(
        young_modulus: f64,
        poisson_ratio: f64,
        radius: f64,
        mass: f64,
        friction: f64,
        damping_ratio: f64,
    ) -> Self {
        let stiffness = 0.5 * young_modulus * std::f64::consts::PI * radius;
        Linear::new(stiffness, poisson_ratio, mass, friction, damping_ratio)
    }

    fn new(stiffness: f64, poisson_ratio: f64, mass: f64, friction: f64, damping_ratio: f64) -> Self {
        Linear {
            normal_stiffness: stiffness,
            tangential_stiffness: stiffness / (2.0 * (1.0 + poisson_ratio)),
            normal_damping: 2.0 * damping_ratio * (mass * stiffness).sqrt(),
            friction,
        }
    }

    /// Force of a pair; its memory advances with the call.
    ///
    /// Out of contact the slip is forgotten. The damper never pulls: the normal force stays ≥ 0. Energies are those of
    /// the step that led here, with the mean of the forces at its ends, as central differences book them.
    pub fn force(&self, motion: &PairMotion, memory: &mut ContactMemory) -> ContactForce {
        let n = motion.normal;
        let approach = -motion.velocity.dot(&n);
        let last = std::mem::take(&mut memory.damper);
        if motion.overlap <= 0.0 {
            memory.slip = Vec3::zeros();
            return ContactForce { damping: 0.5 * last * approach * motion.dt, ..ContactForce::default() };
        }
        let elastic = self.normal_stiffness * motion.overlap;
        let damper = (self.normal_damping * approach).max(-elastic);
        let normal_force = elastic + damper;
        memory.damper = damper;

        // The spring lives in the tangent plane of the moment; turned there it keeps its length.
        let length = memory.slip.norm();
        let flat = memory.slip - n * memory.slip.dot(&n);
        let flat_length = flat.norm();
        let before = if flat_length > 0.0 { flat * (length / flat_length) } else { Vec3::zeros() };
        let trial = before + (motion.velocity + n * approach) * motion.dt;
        let (reach, limit) = (self.tangential_stiffness * trial.norm(), self.friction * normal_force);
        memory.slip = if reach > limit { trial * (limit / reach) } else { trial };
        let mean_force = (before + memory.slip) * (0.5 * self.tangential_stiffness);
        ContactForce {
            on_second: n * normal_force - memory.slip * self.tangential_stiffness,
            stored: 0.5 * self.normal_stiffness * motion.overlap * motion.overlap
                + 0.5 * self.tangential_stiffness * memory.slip.norm_squared(),
            friction: mean_force.dot(&(trial - memory.slip)).max(0.0),
            damping: 0.5 * (last + damper) * approach * motion.dt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn law() -> Linear {
        Linear { normal_stiffness: 1e5, tangential_stiffness: 4e4, normal_damping: 3.0, friction: 0.4 }
    }

    proptest! {
        #[test]
        fn friction_stays_in_the_cone_and_nothing_pulls(
            normal in prop::array::uniform3(-1f64..1.0),
            velocity in prop::array::uniform3(-5f64..5.0),
            slip in prop::array::uniform3(-1e-3f64..1e-3),
            overlap in -1e-3f64..1e-3,
        ) {
            let normal = Vec3::from(normal);
            prop_assume!(normal.norm() > 0.1);
            let motion = PairMotion { normal: normal.normalize(), overlap, velocity: velocity.into(), dt: 1e-5 };
            let mut memory = ContactMemory { slip: Vec3::from(slip), damper: 0.0 };
            let force = law().force(&motion, &mut memory);
            let along = force.on_second.dot(&motion.normal);
            let across = (force.on_second - motion.normal * along).norm();
            prop_assert!(along >= 0.0);
            prop_assert!(across <= law().friction * along * (1.0 + 1e-9) + 1e-9);
            prop_assert!(force.friction >= 0.0 && force.stored >= 0.0 && force.damping >= 0.0);
            if overlap <= 0.0 {
                prop_assert_eq!(force, ContactForce::default());
            }
        }
    }

    #[test]
    fn bounce_gives_back_what_damping_leaves() {
        // A mass on the normal spring: restitution exp(-π ξ/√(1 - ξ²)) of the linear oscillator, up to the clipped end.
        let (mass, xi): (f64, f64) = (0.2, 0.05);
        let law = Linear::new(1e5, 0.2, mass, 0.0, xi);
        let (mut x, mut v, dt) = (0.0, -1.0, 1e-7);
        let mut memory = ContactMemory::default();
        loop {
            let motion = PairMotion { normal: Vec3::x(), overlap: -x, velocity: Vec3::x() * v, dt };
            v += law.force(&motion, &mut memory).on_second.x / mass * dt;
            x += v * dt;
            if x > 0.0 {
                break;
            }
        }
        let expected = (-std::f64::consts::PI * xi / (1.0 - xi * xi).sqrt()).exp();
        assert!((v - expected).abs() < 0.01, "{v} against {expected}");
    }
}
