use serde::{Deserialize, Serialize};

/// Where the energy of a run is, all in joule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Energy at the start, kinetic and elastic.
    pub initial: f64,
    /// Work of supports and loads.
    pub external: f64,
    /// Kinetic energy, rotation of particles included.
    pub kinetic: f64,
    /// Energy stored in elements and bonds.
    pub elastic: f64,
    /// Part of `elastic` that tension and compression of bonds hold.
    pub bond_tension: f64,
    /// Part of `elastic` that bending of bonds holds.
    pub bond_bending: f64,
    /// Part of `elastic` that torsion of bonds holds.
    pub bond_torsion: f64,
    /// Energy dissipated by damage.
    pub damage: f64,
    /// Energy that went with removed elements and broken bonds.
    pub removed: f64,
    /// Energy taken by damping of every kind.
    pub damping: f64,
    /// Energy stored in contact springs.
    pub contact: f64,
    /// Energy taken by friction.
    pub friction: f64,
    /// Energy that left through absorbing boundaries.
    pub absorbed: f64,
    /// Largest |residual| over [`Ledger::scale`] so far.
    pub residual_max_relative: f64,
    /// Largest amount of energy that was in play so far.
    pub scale: f64,
}

/// What is booked step by step between two balances [J].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Books {
    pub(crate) external: f64,
    pub(crate) removed: f64,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
}

/// A column of the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the names are those of the ledger's fields
pub enum EnergyKind {
    External,
    Kinetic,
    Elastic,
    BondTension,
    BondBending,
    BondTorsion,
    Damage,
    Removed,
    Damping,
    Contact,
    Friction,
    Absorbed,
    Residual,
}

impl Ledger {
    /// What is missing: initial + external work - everything accounted for [J].
    pub fn residual(&self) -> f64 {
        self.initial + self.external
            - (self.kinetic
                + self.elastic
                + self.damage
                + self.removed
                + self.damping
                + self.contact
                + self.friction
                + self.absorbed)
    }

    /// One column.
    pub fn value(&self, kind: EnergyKind) -> f64 {
        match kind {
            EnergyKind::External => self.external,
            EnergyKind::Kinetic => self.kinetic,
            EnergyKind::Elastic => self.elastic,
            EnergyKind::BondTension => self.bond_tension,
            EnergyKind::BondBending => self.bond_bending,
            EnergyKind::BondTorsion => self.bond_torsion,
            EnergyKind::Damage => self.damage,
            EnergyKind::Removed => self.removed,
            EnergyKind::Damping => self.damping,
            EnergyKind::Contact => self.contact,
            EnergyKind::Friction => self.friction,
            EnergyKind::Absorbed => self.absorbed,
            EnergyKind::Residual => self.residual(),
        }
    }

    /// Residual over the largest energy that was in play: the work done on the solid, or what it started with.
    pub fn relative_residual(&self) -> f64 {
        if self.scale > 0.0 { self.residual().abs() / self.scale } else { 0.0 }
    }

    /// Takes the present values into the running maxima.
    pub(crate) fn update_maxima(&mut self) {
        self.scale = self.scale.max(self.initial).max(self.external.abs());
        self.residual_max_relative = self.residual_max_relative.max(self.relative_residual());
    }
}
