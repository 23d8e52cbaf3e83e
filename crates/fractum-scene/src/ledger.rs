//! The energies of a run: one list, from which summary, report, charts, history, probes and `expect` paths are made.
//!
//! To add an entry: a variant of [`EnergyKind`] and its row in [`EnergyKind::TABLE`], in the same order, and whoever writes
//! it. Nothing else lists the entries; `docs/case-file.md` gets its row of `probes[].energy` anew.

use std::ops::{AddAssign, Index, IndexMut};

use fractum_math::Work;
use serde::{Deserialize, Serialize};

/// An entry of the energy ledger [J].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyKind {
    /// Work of supports and loads.
    External,
    /// Kinetic energy, rotation of particles included.
    Kinetic,
    /// Energy stored in elements and bonds.
    Elastic,
    /// Part of `Elastic` in tension and compression of bonds.
    BondTension,
    /// Part of `Elastic` in bending of bonds.
    BondBending,
    /// Part of `Elastic` in torsion of bonds.
    BondTorsion,
    /// Energy dissipated by damage.
    Damage,
    /// Energy that went with removed elements and broken bonds.
    Removed,
    /// Energy taken by damping of every kind.
    Damping,
    /// Energy stored in contact springs.
    Contact,
    /// Energy taken by friction.
    Friction,
    /// Energy that left through absorbing boundaries.
    Absorbed,
    /// Energy stored in the springs of elastic supports.
    Foundation,
    /// Energy stored in interfaces between elements.
    Interfaces,
    /// Energy dissipated by the softening of interfaces.
    InterfaceFracture,
    /// What central differences keep less of the energy at a start out of balance and at changes of the time step,
    /// ⅛ (Δt₊² - Δt₋²) Σ F²/m: either sign; and what small strains have found beyond the energy of a body as it begins to turn.
    TimeStep,
    /// Energy of the gas that was put in holes.
    GasSupplied,
    /// Internal energy of the gas in holes and cracks.
    Gas,
    /// Enthalpy of the gas that has leaked to the outside.
    GasLeaked,
    /// Work of the pumps on the liquid that they put in.
    LiquidSupplied,
    /// Energy stored in liquid by its compression.
    Liquid,
    /// Energy taken by the viscous flow of liquid, its entry into the dry part of cracks included.
    LiquidFlow,
    /// Energy of the liquid that walls have taken.
    LiquidLeaked,
    /// Energy of pieces that have left the domain of the run, and of bodies that a stage took out.
    Left,
    /// Energy of motion with which particles have come in through inlets.
    Entered,
    /// Work of a box that repeats on what is in it, by its deformation.
    PeriodicBox,
}

/// What an entry is to the energy balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyRole {
    /// Put in from outside: counts positive.
    Supplied,
    /// Can be given back: counts negative.
    Stored,
    /// Cannot be given back: counts negative.
    Spent,
    /// Part of the elastic energy that only bonds have: does not count again.
    PartOfBonds,
}

/// A row of the list of energies.
struct Entry {
    kind: EnergyKind,
    /// As it is called in case files and results.
    name: &'static str,
    /// As it is called in the report.
    label: &'static str,
    role: EnergyRole,
}

const fn entry(kind: EnergyKind, name: &'static str, label: &'static str, role: EnergyRole) -> Entry {
    Entry { kind, name, label, role }
}

impl EnergyKind {
    /// Number of entries.
    pub const COUNT: usize = Self::TABLE.len();

    /// Every entry, in the order in which the balance sums them.
    pub const ALL: [EnergyKind; Self::COUNT] = {
        let mut all = [EnergyKind::External; Self::COUNT];
        let mut i = 0;
        while i < all.len() {
            all[i] = Self::TABLE[i].kind;
            assert!(all[i] as usize == i, "rows of the table come in the order of the variants");
            i += 1;
        }
        all
    };

    const TABLE: &[Entry] = &[
        entry(EnergyKind::External, "external", "External work", EnergyRole::Supplied),
        entry(EnergyKind::Kinetic, "kinetic", "Kinetic", EnergyRole::Stored),
        entry(EnergyKind::Elastic, "elastic", "Elastic", EnergyRole::Stored),
        entry(EnergyKind::BondTension, "bond_tension", "Elastic: tension of bonds", EnergyRole::PartOfBonds),
        entry(EnergyKind::BondBending, "bond_bending", "Elastic: bending of bonds", EnergyRole::PartOfBonds),
        entry(EnergyKind::BondTorsion, "bond_torsion", "Elastic: torsion of bonds", EnergyRole::PartOfBonds),
        entry(EnergyKind::Damage, "damage", "Damage", EnergyRole::Spent),
        entry(EnergyKind::Removed, "removed", "Removed with elements and bonds", EnergyRole::Spent),
        entry(EnergyKind::Damping, "damping", "Damping", EnergyRole::Spent),
        entry(EnergyKind::Contact, "contact", "Contact", EnergyRole::Stored),
        entry(EnergyKind::Friction, "friction", "Friction", EnergyRole::Spent),
        entry(EnergyKind::Absorbed, "absorbed", "Absorbed by boundaries", EnergyRole::Spent),
        entry(EnergyKind::Foundation, "foundation", "Elastic supports", EnergyRole::Stored),
        entry(EnergyKind::Interfaces, "interfaces", "Interfaces", EnergyRole::Stored),
        entry(EnergyKind::InterfaceFracture, "interface_fracture", "Fracture of interfaces", EnergyRole::Spent),
        entry(
            EnergyKind::TimeStep,
            "time_step",
            "Changes of the time step and of the measure of strain",
            EnergyRole::Spent,
        ),
        entry(EnergyKind::GasSupplied, "gas_supplied", "Gas put in", EnergyRole::Supplied),
        entry(EnergyKind::Gas, "gas", "Gas", EnergyRole::Stored),
        entry(EnergyKind::GasLeaked, "gas_leaked", "Gas leaked", EnergyRole::Spent),
        entry(EnergyKind::LiquidSupplied, "liquid_supplied", "Liquid put in", EnergyRole::Supplied),
        entry(EnergyKind::Liquid, "liquid", "Liquid", EnergyRole::Stored),
        entry(EnergyKind::LiquidFlow, "liquid_flow", "Viscous flow of liquid", EnergyRole::Spent),
        entry(EnergyKind::LiquidLeaked, "liquid_leaked", "Liquid leaked", EnergyRole::Spent),
        entry(EnergyKind::Left, "left", "Left the run", EnergyRole::Spent),
        entry(EnergyKind::Entered, "entered", "Entered the run", EnergyRole::Supplied),
        entry(EnergyKind::PeriodicBox, "periodic_box", "Work of the periodic box", EnergyRole::Supplied),
    ];

    const fn entry(self) -> &'static Entry {
        &Self::TABLE[self as usize]
    }

    /// As it is called in case files and results.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// As it is called in the report.
    pub const fn label(self) -> &'static str {
        self.entry().label
    }

    /// What it is to the balance.
    pub const fn role(self) -> EnergyRole {
        self.entry().role
    }

    /// Sign in the balance: 1 for what is put in, -1 for where it went, 0 for a part of another entry.
    pub const fn sign(self) -> i8 {
        match self.role() {
            EnergyRole::Supplied => 1,
            EnergyRole::Stored | EnergyRole::Spent => -1,
            EnergyRole::PartOfBonds => 0,
        }
    }
}

/// What a probe of energies shows: an entry of the ledger, or what does not add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyProbe {
    /// An entry.
    Entry(EnergyKind),
    /// [`Ledger::residual`].
    Residual,
}

impl EnergyProbe {
    /// Every entry, and the residual, with their names.
    pub const NAMES: [(&'static str, EnergyProbe); 1 + EnergyKind::COUNT] = {
        let mut names = [("residual", EnergyProbe::Residual); 1 + EnergyKind::COUNT];
        let mut i = 0;
        while i < EnergyKind::COUNT {
            let kind = EnergyKind::ALL[i];
            names[i] = (kind.name(), EnergyProbe::Entry(kind));
            i += 1;
        }
        names
    };
}

/// Where the energy of a run is, all in joule; `ledger[EnergyKind::Damage]` is one entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Energy at the start, kinetic and elastic.
    pub initial: f64,
    /// The part of it that in-situ stress has stored: it is there, but not in play.
    pub in_situ: f64,
    #[serde(with = "without_box")]
    entries: [f64; EnergyKind::COUNT],
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
    pub(crate) absorbed: f64,
    pub(crate) time_step: f64,
    pub(crate) left: f64,
    pub(crate) entered: f64,
    /// Work that interfaces have taken, but for friction and the meeting of their sides.
    pub(crate) interfaces: f64,
    /// Part of `damping` that damping of nodes and particles has taken in the second half of the run.
    pub(crate) late_damping: f64,
    /// Part of `damping` that rigid shapes have taken from the nodes of solids that met them.
    pub(crate) stopped: f64,
    /// Energies of the springs of contact and of the solids, summed up over the looks at the state.
    pub(crate) pressed: [f64; 2],
}

impl AddAssign<Work> for Books {
    fn add_assign(&mut self, work: Work) {
        self.external += work.external;
        self.damping += work.damping;
        self.friction += work.friction;
        self.time_step += work.linked;
    }
}

/// The entries as they are saved: without the work of the box that repeats, which the box keeps itself, so that the states of scenes without
/// one know nothing of it.
mod without_box {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::EnergyKind;

    const SAVED: usize = EnergyKind::PeriodicBox as usize;

    pub(super) fn serialize<S: Serializer>(all: &[f64; EnergyKind::COUNT], to: S) -> Result<S::Ok, S::Error> {
        let saved: [f64; SAVED] = std::array::from_fn(|i| all[i]);
        saved.serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; EnergyKind::COUNT], D::Error> {
        let saved = <[f64; SAVED]>::deserialize(from)?;
        Ok(std::array::from_fn(|i| saved.get(i).copied().unwrap_or(0.0)))
    }
}

impl Index<EnergyKind> for Ledger {
    type Output = f64;

    fn index(&self, kind: EnergyKind) -> &f64 {
        &self.entries[kind as usize]
    }
}

impl IndexMut<EnergyKind> for Ledger {
    fn index_mut(&mut self, kind: EnergyKind) -> &mut f64 {
        &mut self.entries[kind as usize]
    }
}

impl Ledger {
    /// What is missing: initial + external work - everything accounted for [J].
    pub fn residual(&self) -> f64 {
        let sum = |sign| EnergyKind::ALL.iter().filter(|kind| kind.sign() == sign).map(|&kind| self[kind]).sum::<f64>();
        self.initial + sum(1) - sum(-1)
    }

    /// What cannot be given back: sum of all entries of [`EnergyRole::Spent`] [J].
    pub fn spent(&self) -> f64 {
        EnergyKind::ALL.iter().filter(|kind| kind.role() == EnergyRole::Spent).map(|&kind| self[kind]).sum()
    }

    /// What a probe shows [J].
    pub fn probe(&self, probe: EnergyProbe) -> f64 {
        match probe {
            EnergyProbe::Entry(kind) => self[kind],
            EnergyProbe::Residual => self.residual(),
        }
    }

    /// Residual over the largest energy that was in play: the work done on the solid, or what it started with.
    pub fn relative_residual(&self) -> f64 {
        if self.scale > 0.0 { self.residual().abs() / self.scale } else { 0.0 }
    }

    /// Takes the present values into the running maxima.
    pub(crate) fn update_maxima(&mut self) {
        self.scale = self.scale.max(self.initial - self.in_situ).max(self[EnergyKind::External].abs());
        self.scale = self.scale.max(self[EnergyKind::PeriodicBox].abs());
        // Adhesion has given what it binds.
        self.scale = self
            .scale
            .max(self[EnergyKind::Entered])
            .max(self[EnergyKind::LiquidSupplied].abs())
            .max(-self[EnergyKind::Contact]);
        self.residual_max_relative = self.residual_max_relative.max(self.relative_residual());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_counts_in_the_balance_as_its_role_says() {
        for kind in EnergyKind::ALL {
            let mut ledger = Ledger { initial: 3.0, ..Ledger::default() };
            ledger[kind] = 2.0;
            assert_eq!(ledger.residual(), 3.0 + 2.0 * f64::from(kind.sign()), "{}", kind.name());
            assert_eq!(ledger.spent(), if kind.role() == EnergyRole::Spent { 2.0 } else { 0.0 }, "{}", kind.name());
        }
    }

    #[test]
    fn names_are_unique_and_probes_offer_every_entry() {
        let names: Vec<&str> = EnergyProbe::NAMES.iter().map(|(name, _)| *name).collect();
        assert!(names.iter().enumerate().all(|(i, name)| !names[..i].contains(name)), "{names:?}");
        assert!(EnergyKind::ALL.iter().all(|kind| names.contains(&kind.name())));
    }
}
