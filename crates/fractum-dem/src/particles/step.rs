//! What a step of motion is.

/// Damping that acts on particles, on their motion and their rotation alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParticleDamping {
    /// Fraction a of the unbalanced force that opposes the motion, -a |F| v/|v|; for quasi-static runs.
    pub local: f64,
    /// Mass-proportional rate α [1/s].
    pub mass_rate: f64,
    /// φ − 1 of the scheme of Tchamwa and Wielgosz, see [`PastForces`]; 0 leaves it out.
    pub dissipation: f64,
}

impl ParticleDamping {
    pub(super) fn is_off(&self) -> bool {
        self.local == 0.0 && self.mass_rate == 0.0 && self.dissipation == 0.0
    }
}

/// One step from tⁿ to tⁿ⁺¹.
#[derive(Clone, Copy, Debug)]
pub struct TimeStep {
    /// Step that led to tⁿ [s].
    pub dt_before: f64,
    /// Step that follows [s].
    pub dt_after: f64,
    /// Damping of the free degrees of freedom.
    pub damping: ParticleDamping,
    /// Whether to sum the kinetic energy.
    pub measure: bool,
}
