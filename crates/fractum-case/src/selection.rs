//! Which nodes, elements, facets or particles are meant.

use super::reader::Table;
use super::reader::presence::optional;
use super::reader::vectors::condition;
use super::{Field, Place, Spanned};

/// Which nodes or particles are meant: those of a group, those where a condition holds, or those of the group where it
/// holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Mesh group, body of particles or set of its particles, or rigid body; all nodes of solid bodies if absent.
    pub group: Option<Spanned<String>>,
    /// Condition on the position at the start. At least one of the two is there.
    pub within: Option<Spanned<Field>>,
}

impl Selection {
    /// All of a group.
    pub fn of_group(group: Spanned<String>) -> Self {
        Selection { group: Some(group), within: None }
    }

    /// Name of the group; empty without one.
    pub fn group_name(&self) -> &str {
        self.group.as_ref().map_or("", |group| &group.value)
    }

    /// What stands for it in messages: its group, or the key of its condition.
    pub fn label(&self) -> &str {
        self.group.as_ref().map_or("where", |group| &group.value)
    }

    /// Where it stands in the case.
    pub fn place(&self) -> Option<&Place> {
        let condition = self.within.as_ref().map(|within| &within.place);
        self.group.as_ref().map(|group| &group.place).or(condition)
    }

    /// Its group, for a use.
    pub(super) fn used_as(&self, group_use: GroupUse) -> Option<(&Spanned<String>, GroupUse)> {
        Some((self.group.as_ref()?, group_use))
    }
}

/// What a mesh group is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GroupUse {
    /// Elements of a body.
    Body,
    /// The volume that particles fill.
    Filled,
    /// Facets of a rigid body.
    Tool,
    /// Nodes of a support.
    Support,
    /// Nodes or facets that share a force.
    Force,
    /// Facets under a traction or pressure.
    Facets,
    /// Nodes of a probe.
    ProbeNodes,
    /// Elements of a probe.
    ProbeElements,
}

/// The keys `group` and `where`, of which at least one is there.
pub(super) fn selection(table: &Table<'_>) -> Option<Selection> {
    let within = optional(table, "where", |name| condition(table, name).spanned().given());
    let group = match within {
        Some(None) => table.text("group").spanned().required().map(Some),
        _ => optional(table, "group", |name| table.text(name).spanned().given()),
    };
    Some(Selection { group: group?, within: within? })
}
