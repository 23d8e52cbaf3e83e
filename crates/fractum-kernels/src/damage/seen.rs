//! What an edge sees, and what bedded rock keeps of it.

use crate::Vec3;

/// What an edge of bedded rock keeps of the onset of its damage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Equivalent stress over the largest principal one; zero where damage began by sliding or crushing.
    pub pull: f64,
    /// Factor on the characteristic length, by which modulus and fracture energy of the opening enter the softening.
    pub longer: f64,
    /// Direction of the pull that began it.
    pub direction: Vec3,
    /// Part of a growing pull that a band across that direction owes to its neighbours, which hold it sideways.
    pub held: f64,
}

impl Band {
    /// That of an edge without beds.
    pub const PLAIN: Band = Band { pull: 0.0, longer: 1.0, direction: Vec3::new(0.0, 0.0, 0.0), held: 0.0 };
}

/// What an edge sees in a step.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Equivalent stress of its opening, as far as that counts [Pa]; the largest so far drives damage.
    pub stress: f64,
    /// Part of the largest effective principal stress that belongs to the opening, at most 1.
    pub share: f64,
    /// Sum of the lateral principal stresses at the onset of damage, if that is now [Pa].
    pub lateral: f64,
    /// What bedded rock keeps of the onset of damage, if that is now.
    pub band: Band,
}

impl Seen {
    /// An edge that sees nothing new.
    pub const NOTHING: Seen = Seen { stress: 0.0, share: 1.0, lateral: f64::INFINITY, band: Band::PLAIN };
}
