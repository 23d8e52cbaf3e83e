//! Laws of contact: what a touching pair feels.

mod accounted_spring;
mod hertz;
mod linear;
mod motion;
mod parameters;
mod restitution;
mod rolling;
mod slip;

pub use hertz::{ElasticMaterial, Hertz, HertzMemory, MaterialPair};
pub use linear::{ContactMemory, Linear};
pub use motion::{ContactForce, PairMotion};
pub use parameters::ContactParameters;
pub use restitution::{damping_of_restitution, restitution_of_damping};
pub use rolling::{Rolling, RollingMemory};
pub use slip::slip_to_cone;

/// A law of contact between two bodies at one point.
pub trait ContactLaw: Copy + Send + Sync {
    /// What a contact remembers from step to step; its default is that of a new contact.
    type Memory: Copy + Default + core::fmt::Debug + Send + Sync;

    /// Force of a pair; its memory advances with the call, which must be one per step.
    fn force(&self, motion: &PairMotion, memory: &mut Self::Memory) -> ContactForce;

    /// Makes some more of the overlap give no force [m]; what gives none shrinks for good as the pair parts.
    ///
    /// So a pair that is found deep within each other bears nothing as it stands, and brings no energy.
    fn add_overlap_offset(memory: &mut Self::Memory, by: f64);

    /// How much of the overlap gives no force [m].
    fn overlap_offset(memory: &Self::Memory) -> f64;

    /// Gap across which it acts [m]; 0 where only what overlaps feels each other.
    #[inline]
    fn reach(&self) -> f64 {
        0.0
    }

    /// Normal and tangential stiffness at an overlap [m], in N/m.
    fn stiffness(&self, overlap: f64) -> (f64, f64);
}

impl ContactLaw for Linear {
    type Memory = ContactMemory;

    #[inline]
    fn force(&self, motion: &PairMotion, memory: &mut ContactMemory) -> ContactForce {
        Linear::force(self, motion, memory)
    }

    #[inline]
    fn add_overlap_offset(memory: &mut ContactMemory, by: f64) {
        memory.overlap_offset += by;
    }

    #[inline]
    fn overlap_offset(memory: &ContactMemory) -> f64 {
        memory.overlap_offset
    }

    #[inline]
    fn stiffness(&self, _overlap: f64) -> (f64, f64) {
        (self.normal_stiffness, self.tangential_stiffness)
    }
}

#[cfg(test)]
mod tests {
    use crate::Vec3;

    use super::*;

    /// Presses, parts, and presses again a pair that was found 2 µm deep: force only beyond what it was found or parted at.
    fn found_deep<L: ContactLaw>(law: L) {
        let mut memory = L::Memory::default();
        L::add_overlap_offset(&mut memory, 2e-6);
        let mut press = |overlap: f64| {
            let still = Vec3::zeros();
            let motion = PairMotion { normal: Vec3::x(), overlap, velocity: still, spin: still, dt: 1e-6 };
            let force = law.force(&motion, &mut memory);
            (force.on_second.x, force.stored)
        };
        let mut fresh = L::Memory::default();
        let still = Vec3::zeros();
        let motion = PairMotion { normal: Vec3::x(), overlap: 1e-6, velocity: still, spin: still, dt: 1e-6 };
        let whole = law.force(&motion, &mut fresh).on_second.x;
        assert_eq!(press(2e-6), (0.0, 0.0));
        assert!((press(3e-6).0 / whole - 1.0).abs() < 1e-9);
        assert_eq!(press(1e-6), (0.0, 0.0));
        assert!((press(2e-6).0 / whole - 1.0).abs() < 1e-9);
        assert_eq!(press(0.0), (0.0, 0.0));
        assert!((press(1e-6).0 / whole - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_pair_that_is_found_deep_gives_force_only_beyond_that_and_forgets_it_as_it_parts() {
        let steel = ElasticMaterial { young_modulus: 200e9, poisson_ratio: 0.3 };
        let surface = ContactParameters { friction: 0.3, damping_ratio: 0.0, rolling_friction: 0.0 };
        found_deep(Hertz::new(&MaterialPair::new([steel, steel], surface), 5e-3, 1e-3));
        found_deep(Linear::between_spheres(200e9, 0.3, [1e-2, 1e-2], [1e-3, 1e-3], surface));
    }
}
