use core::ops::{Add, AddAssign};

/// Energies that a step moves, or that are in motion and in springs at its instant [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Kinetic energy at the instant.
    pub kinetic: f64,
    /// Energy in springs at the instant.
    pub stored: f64,
    /// Done from outside, by supports, loads and drives.
    pub external: f64,
    /// Taken by damping.
    pub damping: f64,
    /// Taken by friction.
    pub friction: f64,
    /// Taken by the link between cells with steps of two sizes.
    pub linked: f64,
}

impl Work {
    /// Energies of a contact: in its springs, taken by friction, taken by its dampers [J].
    #[inline]
    pub fn contact(stored: f64, friction: f64, damping: f64) -> Self {
        Self { stored, friction, damping, ..Self::default() }
    }

    /// Work done from outside [J].
    #[inline]
    pub fn external(external: f64) -> Self {
        Self { external, ..Self::default() }
    }
}

impl AddAssign for Work {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.kinetic += other.kinetic;
        self.stored += other.stored;
        self.external += other.external;
        self.damping += other.damping;
        self.friction += other.friction;
        self.linked += other.linked;
    }
}

/// Work of a step around tⁿ, in two halves: central differences have velocities at half steps, so that the forces of tⁿ
/// work in both, with the velocity of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HalfSteps {
    /// In the half step before tⁿ, and the energies at tⁿ.
    pub before: Work,
    /// In the half step after tⁿ.
    pub after: Work,
}

impl HalfSteps {
    /// What motion and damping make of both halves: kinetic energy and what damping takes, before and after tⁿ.
    #[inline]
    pub fn of_motion(&self) -> [f64; 4] {
        let HalfSteps { before, after } = self;
        [before.kinetic, before.damping, after.kinetic, after.damping]
    }

    /// Sets what [`HalfSteps::of_motion`] tells.
    #[inline]
    pub fn set_motion(&mut self, numbers: [f64; 4]) {
        [self.before.kinetic, self.before.damping, self.after.kinetic, self.after.damping] = numbers;
    }
}

impl AddAssign for HalfSteps {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.before += other.before;
        self.after += other.after;
    }
}

impl Add for HalfSteps {
    type Output = Self;

    #[inline]
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_energy_is_added() {
        let one = Work { kinetic: 1.0, stored: 2.0, external: 4.0, damping: 8.0, friction: 16.0, linked: 64.0 };
        let sum = HalfSteps { before: one, after: Work::external(1.0) } + HalfSteps { before: one, after: one };
        let twice = Work { kinetic: 2.0, stored: 4.0, external: 8.0, damping: 16.0, friction: 32.0, linked: 128.0 };
        assert_eq!(sum.before, twice);
        assert_eq!(sum.after, Work { external: 5.0, ..one });
    }
}
