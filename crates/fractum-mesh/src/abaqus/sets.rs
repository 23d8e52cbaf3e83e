//! Sets of labels, some of which are ranges or other sets.

use std::collections::BTreeMap;

use crate::tagged::error::Fault;

/// Members per labelled thing, on average over all sets, beyond which a file is refused: ranges and sets of sets could
/// ask for memory far beyond the size of the file.
const MOST_PER_LABEL: usize = 64;

/// Sets of one kind, in the order of the file.
#[derive(Default)]
pub(super) struct Sets {
    pub(super) list: Vec<Set>,
    by_name: BTreeMap<String, usize>,
}

/// A set as the file tells it.
pub(super) struct Set {
    /// Name, as it was first written.
    pub(super) name: String,
    pub(super) at: usize,
    /// Whether the program that wrote the file made it for itself.
    pub(super) internal: bool,
    /// Whether it is one of the assembly, not of the part.
    of_assembly: bool,
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
}

impl Sets {
    /// Number of the set of that name, made where there is none.
    ///
    /// Sets of the part and of the assembly may have one name and differ; as groups they would be one.
    pub(super) fn open(&mut self, name: &str, at: usize, internal: bool, of_assembly: bool) -> Result<usize, Fault> {
        let next = self.list.len();
        let number = *self.by_name.entry(name.to_uppercase()).or_insert(next);
        let other = self.list.get(number).filter(|set| set.of_assembly != of_assembly);
        // Sets that Abaqus makes for itself are numbered anew in the assembly; what has used those of the part has done so above.
        let is_own = other.is_some_and(|other| internal && other.internal);
        if number == next || is_own {
            self.by_name.insert(name.to_uppercase(), next);
            self.list.push(Set { name: name.to_owned(), at, internal, of_assembly, items: Vec::new() });
            return Ok(next);
        }
        if other.is_some() {
            let message = format!("set \"{name}\" of the assembly has the name of one of the part; rename one of them");
            return Err(Fault::unsupported(at, message));
        }
        Ok(number)
    }

    /// Number of the set of that name; a name may begin with that of its instance and a point.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        let name = name.to_uppercase();
        let of_instance = || self.by_name.get(name.rsplit_once('.')?.1);
        self.by_name.get(&name).or_else(of_instance).copied()
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
    pub(super) fn add_field(&mut self, set: usize, at: usize, field: &str) -> Result<(), Fault> {
        if let Some(label) = label(field) {
            self.add(set, label);
            return Ok(());
        }
        match self.find(super::deck::unquoted(field)) {
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
    pub(super) fn resolve(&self, labels: &[(u64, u32)]) -> Result<Vec<Vec<u32>>, Fault> {
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

/// A label: a whole number, which may follow the name of an instance and a point.
pub(super) fn label(field: &str) -> Option<u64> {
    let plain = field.rsplit_once('.').map_or(field, |(_, label)| label);
    plain.parse().ok()
}
