//! Probes: the numbers a run records.

use super::ProbeKind;
use crate::Spanned;

/// A named number recorded in the history, or computed from it at the end of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name, unique among probes.
    pub name: Spanned<String>,
    /// SI unit of its values, as printed; `1` for a pure number.
    pub unit: String,
    /// What it measures.
    pub kind: ProbeKind,
    /// Time from one measurement to the next; rows between repeat the value [s]. Every row measures if absent.
    pub every: Option<f64>,
}

impl Probe {
    /// Whether it is one number at the end of the run, rather than a column of the history.
    pub fn is_scalar(&self) -> bool {
        matches!(&self.kind, ProbeKind::Expression(expression) if expression.scalar)
    }
}

/// Index and unit of the probe that measures the load: the first force with a column of its own, else the first moment.
pub fn load_of(probes: &[Probe]) -> Option<(usize, &'static str)> {
    let first = |unit| {
        let index = probes.iter().position(|probe| probe.unit == unit && !probe.is_scalar());
        index.map(|index| (index, unit))
    };
    ["N", "N m"].into_iter().find_map(first)
}
