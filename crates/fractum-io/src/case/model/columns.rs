//! Columns of the history that are no probes.

use fractum_scene::{EnergyKind, EnergyRole};

/// What a run has: it decides which columns its history has before those of probes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HistoryColumns {
    /// Particles, bonded or loose.
    pub particles: bool,
    /// A domain that pieces may leave.
    pub domain: bool,
    /// Heat.
    pub heat: bool,
    /// A load factor that may run back, so that rows are ordered by steps.
    pub turns_back: bool,
    /// Both rest and motion.
    pub in_motion: bool,
}

/// Name and unit of a column.
type Named = (&'static str, &'static str);

/// What has left the domain.
const LEFT: [Named; 5] = [
    ("left_pieces", "1"),
    ("left_mass", "kg"),
    ("left_momentum_x", "N s"),
    ("left_momentum_y", "N s"),
    ("left_momentum_z", "N s"),
];

const HEAT: [Named; 3] = [("heat_stored", "J"), ("heat_brought", "J"), ("heat_residual", "J")];

/// Orders rows and frames where the load factor may run back.
const STEP: Named = ("step", "1");

/// 1 while the scene moves.
const IN_MOTION: Named = ("in_motion", "1");

impl HistoryColumns {
    /// All that any run may have.
    pub const ALL: Self = Self { particles: true, domain: true, heat: true, turns_back: true, in_motion: true };

    /// Names and SI units of the columns, in their order.
    pub fn list(self) -> Vec<(&'static str, &'static str)> {
        self.groups().concat()
    }

    fn groups(self) -> [Vec<Named>; 6] {
        let mut ledger = vec![("time", "s"), ("dt", "s")];
        ledger.extend(EnergyKind::ALL.into_iter().filter(|kind| kind.sign() != 0).map(|kind| (kind.name(), "J")));
        ledger.extend([("residual", "J"), ("removed_elements", "1"), ("particles", "1")]);
        let of_bonds = EnergyKind::ALL.into_iter().filter(|kind| kind.role() == EnergyRole::PartOfBonds);
        let bonds = of_bonds.map(|kind| (kind.name(), "J")).chain([("broken_bonds", "1")]).collect();
        let groups = [
            (true, ledger),
            (self.particles, bonds),
            (self.domain, LEFT.to_vec()),
            (self.heat, HEAT.to_vec()),
            (self.turns_back, vec![STEP]),
            (self.in_motion, vec![IN_MOTION]),
        ];
        groups.map(|(there, group)| if there { group } else { Vec::new() })
    }

    /// How many columns of a history, which these names begin, are no probes.
    pub fn count(names: &[&str]) -> usize {
        if let [first, others @ ..] = names
            && *first == STEP.0
        {
            // Put first, as the column that orders the rows.
            return 1 + Self::count(others);
        }
        Self::ALL.groups().iter().fold(0, |count, group| {
            let begins = names.get(count) == group.first().map(|(name, _)| name);
            count + if begins { group.len().min(names.len() - count) } else { 0 }
        })
    }

    /// Index of the column that orders the rows by steps, among those that are no probes.
    pub fn step(names: &[&str]) -> Option<usize> {
        names[..Self::count(names)].iter().position(|name| *name == STEP.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_before_probes_are_counted_whatever_a_run_has() {
        let of = |bits: u8| HistoryColumns {
            particles: bits & 1 > 0,
            domain: bits & 2 > 0,
            heat: bits & 4 > 0,
            turns_back: bits & 8 > 0,
            in_motion: bits & 16 > 0,
        };
        for columns in (0..32).map(of) {
            let list = columns.list();
            let names: Vec<&str> = list.iter().map(|(name, _)| *name).chain(["load"]).collect();
            assert_eq!(HistoryColumns::count(&names), list.len(), "{columns:?}");
            assert_eq!(HistoryColumns::step(&names).is_some(), columns.turns_back);
        }
        let all = HistoryColumns::ALL.list();
        assert!(EnergyKind::ALL.into_iter().all(|kind| all.contains(&(kind.name(), "J"))), "{all:?}");
        assert_eq!(HistoryColumns::count(&[]), 0);
    }
}
