//! Sets of labels, some of which are ranges or other sets.

use std::collections::BTreeMap;

use super::deck;
use super::instance::{Instances, Scope};
use crate::tagged::error::Fault;

/// Members per labelled thing, on average over all sets, beyond which a file is refused: ranges and sets of sets could
/// ask for memory far beyond the size of the file.
const MOST_PER_LABEL: usize = 64;

/// Sets of one kind, in the order of the file.
#[derive(Default)]
pub(super) struct Sets {
    pub(super) list: Vec<Set>,
    by_name: BTreeMap<(Scope, String), usize>,
}

/// A set as the file tells it.
pub(super) struct Set {
    /// Name, as it was first written.
    pub(super) name: String,
    pub(super) at: usize,
    /// Whether the program that wrote the file made it for itself.
    pub(super) internal: bool,
    pub(super) scope: Scope,
    items: Vec<Item>,
}

enum Item {
    Range {
        first: u64,
        last: u64,
        step: u64,
    },
    /// Another set, by its number.
    Set(usize),
    /// The nodes of a set of elements.
    NodesOf(usize),
}

impl Sets {
    /// Number of the set of that name, made where there is none.
    pub(super) fn open(&mut self, name: &str, at: usize, internal: bool, scope: Scope) -> usize {
        self.open_as(name.to_uppercase(), name, at, internal, scope)
    }

    /// The same of a surface of nodes, which may have the name of a set.
    pub(super) fn open_surface(&mut self, name: &str, at: usize, internal: bool, scope: Scope) -> usize {
        self.open_as(format!("{}, SURFACE", name.to_uppercase()), name, at, internal, scope)
    }

    fn open_as(&mut self, key: String, name: &str, at: usize, internal: bool, scope: Scope) -> usize {
        let next = self.list.len();
        let number = *self.by_name.entry((scope, key)).or_insert(next);
        if number == next {
            self.list.push(Set { name: name.to_owned(), at, internal, scope, items: Vec::new() });
        }
        number
    }

    /// Number of the set of that name, which may begin with that of an instance and a point: one of the instance, or else of the assembly.
    pub(super) fn find(&self, name: &str, scope: Scope, instances: &Instances) -> Option<usize> {
        let known = |scope: Scope, name: &str| self.by_name.get(&(scope, name.to_uppercase())).copied();
        let qualified = || {
            let (instance, name) = name.split_once('.')?;
            known(instances.find(deck::unquoted(instance)), deck::unquoted(name))
        };
        let alone = || (0..instances.list.len()).find_map(|instance| known(Some(instance), name));
        known(scope, name).or_else(|| known(None, name)).or_else(qualified).or_else(alone)
    }

    /// Adds the nodes of a set of elements.
    pub(super) fn add_nodes_of(&mut self, set: usize, elements: usize) {
        self.list[set].items.push(Item::NodesOf(elements));
    }

    /// Adds one label.
    pub(super) fn add(&mut self, set: usize, label: u64) {
        self.add_range(set, [label, label, 1]);
    }

    /// Adds first to last by steps.
    pub(super) fn add_range(&mut self, set: usize, [first, last, step]: [u64; 3]) {
        self.list[set].items.push(Item::Range { first, last, step });
    }

    /// Adds what a field of a data line says: a label, or the name of a set above.
    ///
    /// - `scope`: instance whose labels and sets these are
    pub(super) fn add_field(
        &mut self,
        set: usize,
        at: usize,
        field: &str,
        scope: Scope,
        instances: &Instances,
    ) -> Result<(), Fault> {
        if let Some(label) = instances.label(field, scope) {
            self.add(set, label);
            return Ok(());
        }
        match self.find(deck::unquoted(field), scope, instances) {
            Some(other) if other != set => self.list[set].items.push(Item::Set(other)),
            _ => {
                let expected = "a label, or the name of a set that is defined above";
                return Err(Fault::unexpected(at, format!("`{field}` in set \"{}\"", self.list[set].name), expected));
            }
        }
        Ok(())
    }

    /// A line per set that lists labels which nothing bears. Ranges may pass over such labels: programs write them so.
    ///
    /// - `labels`: label and index, ascending
    /// - `what`: "element" or "node"
    pub(super) fn unknown(&self, labels: &[(u64, u32)], what: &str) -> Vec<String> {
        let of = |set: &Set| {
            let listed = set.items.iter().filter_map(|item| match item {
                Item::Range { first, last, .. } if first == last => Some(*first),
                _ => None,
            });
            unknown_labels(&format!("set \"{}\"", set.name), listed, labels, what)
        };
        self.list.iter().filter(|set| !set.internal).filter_map(of).collect()
    }

    /// Members of all sets as ascending indices of labelled things.
    ///
    /// - `labels`: label and index, ascending
    /// - `nodes_of`: those of a set of elements
    pub(super) fn resolve(
        &self,
        labels: &[(u64, u32)],
        nodes_of: impl Fn(usize) -> Vec<u32>,
    ) -> Result<Vec<Vec<u32>>, Fault> {
        let most = MOST_PER_LABEL.saturating_mul(labels.len());
        let mut looked_at = 0usize;
        let mut resolved: Vec<Vec<u32>> = Vec::with_capacity(self.list.len());
        for (number, set) in self.list.iter().enumerate() {
            let mut members: Vec<u32> = Vec::new();
            for item in &set.items {
                match item {
                    Item::Range { first, last, step } => {
                        let from = labels.partition_point(|(label, _)| label < first);
                        let to = labels.partition_point(|(label, _)| label <= last);
                        looked_at += to.saturating_sub(from);
                        let hit = |(label, _): &&(u64, u32)| (label - first).is_multiple_of((*step).max(1));
                        members.extend(labels[from..to.max(from)].iter().filter(hit).map(|(_, index)| index));
                    }
                    Item::NodesOf(elements) => {
                        let nodes = nodes_of(*elements);
                        looked_at += nodes.len();
                        members.extend(nodes);
                    }
                    Item::Set(other) if *other < number => {
                        looked_at += resolved[*other].len();
                        members.extend_from_slice(&resolved[*other]);
                    }
                    Item::Set(other) => {
                        let name = &self.list[*other].name;
                        let message = format!("set \"{}\" takes set \"{name}\", which begins below it", set.name);
                        return Err(Fault::inconsistent(set.at, message));
                    }
                }
                if looked_at > most {
                    let message = format!("sets up to \"{}\" have more than {most} members in all", set.name);
                    return Err(Fault::unsupported(set.at, message));
                }
            }
            members.sort_unstable();
            members.dedup();
            resolved.push(members);
        }
        Ok(resolved)
    }
}

/// What to tell of labels in a list that nothing bears; none where there are none.
pub(super) fn unknown_labels(
    of: &str,
    listed: impl Iterator<Item = u64>,
    labels: &[(u64, u32)],
    what: &str,
) -> Option<String> {
    let mut unknown = listed.filter(|label| labels.binary_search_by_key(label, |(known, _)| *known).is_err());
    let first = unknown.next()?;
    let more = unknown.count();
    let others = if more > 0 { format!(" and {more} more") } else { String::new() };
    Some(format!("{of} lists {what} {first}{others}, which the mesh does not have"))
}
