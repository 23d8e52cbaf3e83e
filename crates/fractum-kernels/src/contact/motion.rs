use crate::{Vec3, Work};

/// Geometry and motion of a pair at one instant.
#[derive(Clone, Copy, Debug)]
pub struct PairMotion {
    /// Unit normal from i to j.
    pub normal: Vec3,
    /// Overlap δ [m], positive in contact.
    pub overlap: f64,
    /// Velocity of j relative to i at the contact point [m/s].
    pub velocity: Vec3,
    /// Angular velocity of j relative to i [rad/s].
    pub spin: Vec3,
    /// Time step over which the tangential spring is advanced [s].
    pub dt: f64,
}

/// Force of a contact and its energies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactForce {
    /// Force on j; i feels the opposite [N].
    pub on_second: Vec3,
    /// Couple on j beside the moment of the force; i feels the opposite [N m].
    pub couple_on_second: Vec3,
    /// Energy in all springs [J].
    pub stored: f64,
    /// Energy taken by friction in this step [J].
    pub friction: f64,
    /// Energy taken by the normal damper in this step [J].
    pub damping: f64,
}

impl ContactForce {
    /// Its energies.
    #[inline]
    pub fn work(&self) -> Work {
        Work::contact(self.stored, self.friction, self.damping)
    }
}
