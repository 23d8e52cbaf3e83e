//! Columns of the history that are no probes: name, unit and value.

use fractum_scene::{Counts, EnergyKind, EnergyRole, Entered, Heat, Ledger, Left, Scene, entered_of};

use crate::history::Table;

/// What a run has: it decides which columns its history has before those of probes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HistoryColumns {
    /// Particles, bonded or loose.
    pub particles: bool,
    /// A domain that pieces may leave, or stages that take bodies out.
    pub domain: bool,
    /// Inlets through which particles come in.
    pub inlets: bool,
    /// Heat.
    pub heat: bool,
    /// A load factor that may run back, so that rows are ordered by steps.
    pub turns_back: bool,
    /// Both rest and motion.
    pub in_motion: bool,
}

/// The instant of a row.
#[derive(Clone, Copy)]
pub struct Instant<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its ledger.
    pub ledger: &'a Ledger,
    /// Its counts.
    pub counts: &'a Counts,
    /// Time [s].
    pub time: f64,
    /// Time step [s].
    pub dt: f64,
    /// Whether the scene moves.
    pub moves: bool,
}

impl Instant<'_> {
    fn left(&self) -> &Left {
        self.scene.left()
    }

    fn entered(&self) -> &Entered {
        entered_of(self.scene)
    }

    fn heat(&self, of: fn(&Heat) -> f64) -> f64 {
        self.scene.heat().map_or(f64::NAN, of)
    }
}

/// A column: name, SI unit, and its value in a row.
#[derive(Clone, Copy)]
struct Column {
    name: &'static str,
    unit: &'static str,
    value: Value,
}

#[derive(Clone, Copy)]
enum Value {
    Energy(EnergyKind),
    Of(fn(&Instant<'_>) -> f64),
}

const fn column(name: &'static str, unit: &'static str, value: fn(&Instant<'_>) -> f64) -> Column {
    Column { name, unit, value: Value::Of(value) }
}

/// Columns that every history has before and after the entries of the ledger that count in its balance.
const FIRST: [Column; 2] = [column("time", "s", |row| row.time), column("dt", "s", |row| row.dt)];
const COUNTS: [Column; 3] = [
    column("residual", "J", |row| row.ledger.residual()),
    column("removed_elements", "1", |row| row.counts.removed_elements as f64),
    column("particles", "1", |row| row.counts.particles as f64),
];

/// After the energies of bonds.
const BONDS: [Column; 1] = [column("broken_bonds", "1", |row| row.counts.broken_bonds as f64)];

/// What has left the run.
const LEFT: [Column; 5] = [
    column("left_pieces", "1", |row| row.left().pieces as f64),
    column("left_mass", "kg", |row| row.left().mass),
    column("left_momentum_x", "N s", |row| row.left().momentum.x),
    column("left_momentum_y", "N s", |row| row.left().momentum.y),
    column("left_momentum_z", "N s", |row| row.left().momentum.z),
];

/// What has come in through inlets.
const ENTERED: [Column; 6] = [
    column("entered_particles", "1", |row| row.entered().particles as f64),
    column("entered_mass", "kg", |row| row.entered().mass),
    column("entered_momentum_x", "N s", |row| row.entered().momentum.x),
    column("entered_momentum_y", "N s", |row| row.entered().momentum.y),
    column("entered_momentum_z", "N s", |row| row.entered().momentum.z),
    column("waiting_particles", "1", |row| row.entered().waiting as f64),
];

const HEAT: [Column; 3] = [
    column("heat_stored", "J", |row| row.heat(|heat| heat.ledger().stored)),
    column("heat_brought", "J", |row| {
        row.heat(|heat| {
            let ledger = heat.ledger();
            ledger.held + ledger.supplied + ledger.convection
        })
    }),
    column("heat_residual", "J", |row| row.heat(|heat| heat.ledger().residual())),
];

/// Orders rows and frames where the load factor may run back.
const STEP: Column = column("step", "1", |row| row.scene.clock.step as f64);

/// 1 while the scene moves.
const IN_MOTION: Column = column("in_motion", "1", |row| f64::from(u8::from(row.moves)));

/// Entries of the ledger that fulfil a condition.
fn energies(of: fn(EnergyKind) -> bool) -> impl Iterator<Item = Column> {
    let all = EnergyKind::ALL.into_iter().filter(move |kind| of(*kind));
    all.map(|kind| Column { name: kind.name(), unit: "J", value: Value::Energy(kind) })
}

impl HistoryColumns {
    /// All that any run may have.
    pub const ALL: Self =
        Self { particles: true, domain: true, inlets: true, heat: true, turns_back: true, in_motion: true };

    /// Names and SI units of the columns, in their order.
    pub fn list(self) -> Vec<(&'static str, &'static str)> {
        self.groups().concat().iter().map(|column| (column.name, column.unit)).collect()
    }

    /// Values of the columns at an instant, in their order.
    pub fn values(self, row: &Instant<'_>) -> Vec<f64> {
        let value = |column: &Column| match column.value {
            Value::Energy(kind) => row.ledger[kind],
            Value::Of(value) => value(row),
        };
        self.groups().iter().flatten().map(value).collect()
    }

    fn groups(self) -> [Vec<Column>; 7] {
        let ledger = FIRST.into_iter().chain(energies(|kind| kind.sign() != 0)).chain(COUNTS).collect();
        let bonds = energies(|kind| kind.role() == EnergyRole::PartOfBonds).chain(BONDS).collect();
        let groups = [
            (true, ledger),
            (self.particles, bonds),
            (self.domain, LEFT.to_vec()),
            (self.inlets, ENTERED.to_vec()),
            (self.heat, HEAT.to_vec()),
            (self.turns_back, vec![STEP]),
            (self.in_motion, vec![IN_MOTION]),
        ];
        groups.map(|(there, group)| if there { group } else { Vec::new() })
    }

    /// How many columns of a history, which these names begin, are no probes.
    pub fn count(names: &[&str]) -> usize {
        if let [first, others @ ..] = names
            && *first == STEP.name
        {
            // Put first, as the column that orders the rows.
            return 1 + Self::count(others);
        }
        Self::ALL.groups().iter().fold(0, |count, group| {
            let begins = names.get(count).copied() == group.first().map(|column| column.name);
            count + if begins { group.len().min(names.len() - count) } else { 0 }
        })
    }

    /// Index of the column that orders the rows by steps, among those that are no probes.
    pub fn step(names: &[&str]) -> Option<usize> {
        names[..Self::count(names)].iter().position(|name| *name == STEP.name)
    }
}

/// A history whose first column orders its rows: the step where the load factor may run back, else the time.
pub fn ordered(mut history: Table) -> Table {
    let names: Vec<&str> = history.columns.iter().map(|column| column.name.as_str()).collect();
    if let Some(step) = HistoryColumns::step(&names) {
        history.columns[..=step].rotate_right(1);
        history.values[..=step].rotate_right(1);
    }
    history
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
            inlets: bits & 32 > 0,
        };
        for columns in (0..64).map(of) {
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
