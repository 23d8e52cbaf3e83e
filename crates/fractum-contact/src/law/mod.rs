//! What a touching pair feels.

mod hertz;
mod linear;
mod restitution;
mod rolling;
mod surface;

pub use hertz::{ElasticMaterial, Hertz, HertzMemory, MaterialPair};
pub use linear::{ContactForce, ContactMemory, Linear, PairMotion};
pub use restitution::{damping_of_restitution, restitution_of_damping};
pub use rolling::{Rolling, RollingMemory};
pub use surface::Surface;

/// A law of contact between two bodies at one point.
pub trait ContactLaw: Copy + Send + Sync {
    /// What a contact remembers from step to step; its default is that of a new contact.
    type Memory: Copy + Default + std::fmt::Debug + Send + Sync;

    /// Force of a pair; its memory advances with the call, which must be one per step.
    fn force(&self, motion: &PairMotion, memory: &mut Self::Memory) -> ContactForce;

    /// Makes some more of the overlap give no force [m]; what gives none shrinks for good as the pair parts.
    ///
    /// So a pair that is found deep within each other bears nothing as it stands, and brings no energy.
    fn add_slack(memory: &mut Self::Memory, by: f64);

    /// Normal and tangential stiffness at an overlap [m], in N/m.
    fn stiffness(&self, overlap: f64) -> (f64, f64);
}

impl ContactLaw for Linear {
    type Memory = ContactMemory;

    fn force(&self, motion: &PairMotion, memory: &mut ContactMemory) -> ContactForce {
        Linear::force(self, motion, memory)
    }

    fn add_slack(memory: &mut ContactMemory, by: f64) {
        memory.slack += by;
    }

    fn stiffness(&self, _overlap: f64) -> (f64, f64) {
        (self.normal_stiffness, self.tangential_stiffness)
    }
}
