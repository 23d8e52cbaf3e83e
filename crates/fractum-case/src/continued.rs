//! What a resumed run must find as it was: the values of the whole case but the end of its run and the plots of its report.

use std::collections::BTreeSet;

use xxhash_rust::xxh3::Xxh3;

use super::hash::add;
use super::tree::{Entry, Node, Value, join};

/// Hash of all values of a case without the end of its last solver, without parameters that only this end uses, and without
/// plots, which only the report shows. Places, comments and spaces play no part.
pub(super) fn hash(root: &Node) -> u128 {
    let mut content = Content { end: path_of_end(root), ..Content::default() };
    let (parameters, others): (Vec<&Entry>, Vec<&Entry>) =
        entries(root).iter().partition(|entry| entry.name == "parameters");
    for entry in others.into_iter().filter(|entry| entry.name != "plots") {
        content.add(&entry.name, &entry.node);
    }
    // A parameter may use those above it.
    for entry in parameters.iter().flat_map(|entry| entries(&entry.node)).rev() {
        if content.words.contains(&entry.name) {
            content.add(&join("parameters", &entry.name), &entry.node);
        }
    }
    content.hasher.digest128()
}

fn entries(node: &Node) -> &[Entry] {
    if let Value::Table(entries) = &node.value { entries } else { &[] }
}

/// Path of the end of the last stage, or of the only one.
fn path_of_end(root: &Node) -> String {
    match entries(root).iter().find(|entry| entry.name == "stages").map(|entry| &entry.node.value) {
        Some(Value::Array(stages)) if !stages.is_empty() => format!("stages[{}].solver.end", stages.len() - 1),
        _ => "solver.end".to_owned(),
    }
}

/// Whether the text at a path is for readers and uses no parameter. A name alone does not tell: `source` is a book of
/// `[[expect]]`, and a function of time of `[[heat.conditions]]`.
fn is_prose(path: &str) -> bool {
    let of_expectation = path.starts_with("expect[") && (path.ends_with("].source") || path.ends_with("].note"));
    path == "title" || path.ends_with("].name") || of_expectation
}

#[derive(Default)]
struct Content {
    hasher: Xxh3,
    /// Path of what is left out.
    end: String,
    /// Words of all texts: names of parameters are among them.
    words: BTreeSet<String>,
}

impl Content {
    fn add(&mut self, path: &str, node: &Node) {
        if path == self.end {
            return;
        }
        match &node.value {
            Value::Table(entries) => {
                self.part(path, b"table");
                entries.iter().for_each(|entry| self.add(&join(path, &entry.name), &entry.node));
            }
            Value::Array(items) => {
                self.part(path, b"array");
                items.iter().enumerate().for_each(|(index, item)| self.add(&format!("{path}[{index}]"), item));
            }
            Value::Text(text) => {
                self.part(path, text.as_bytes());
                if !is_prose(path) {
                    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
                    self.words.extend(words.map(str::to_owned));
                }
            }
            Value::Number(number) => self.part(path, &number.to_bits().to_le_bytes()),
            Value::Flag(flag) => self.part(path, &[u8::from(*flag)]),
            Value::Date => self.part(path, b"date"),
        }
    }

    /// A path with its value.
    fn part(&mut self, path: &str, value: &[u8]) {
        add(&mut self.hasher, path.as_bytes());
        add(&mut self.hasher, value);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tree::{parse, parse_override, set};
    use super::*;

    const CASE: &str = "[parameters]\nlast = \"1 ms\"\ntwice = \"2*last\"\nload = \"3 N\"\n[solver]\nend = \"twice\"\n\
        [[loads]]\nforce = { x = \"load*t\" }\n[[heat.conditions]]\nsource = \"1 W/m^3\"\n";

    fn with(changes: &[(&str, &str)]) -> u128 {
        let mut root = parse(CASE, "case.toml").unwrap();
        changes.iter().for_each(|(key, value)| set(&mut root, key, parse_override(key, value)).unwrap());
        hash(&root)
    }

    #[test]
    fn only_the_end_may_change() {
        let before = with(&[]);
        for same in [format!("# a remark\n{CASE}"), format!("{CASE}[[plots]]\nx = \"time\"\n")] {
            assert_eq!(before, hash(&parse(&same, "case.toml").unwrap()), "{same}");
        }
        for same in [("solver.end", "5 ms"), ("parameters.last", "7 ms")] {
            assert_eq!(before, with(&[same]), "{same:?}");
        }
        for other in [("solver.safety", "0.5"), ("parameters.load", "4 N"), ("loads[0].force.x", "twice*t")] {
            assert_ne!(before, with(&[other]), "{other:?}");
        }
        let named = ("loads[0].name", "the last");
        assert_eq!(with(&[named]), with(&[named, ("parameters.last", "7 ms")]), "a word of a name");
        // The end is used elsewhere.
        for used in [("loads[0].force.x", "load*t/last"), ("heat.conditions[0].source", "1 W/m^3*t/last")] {
            assert_ne!(with(&[used]), with(&[used, ("parameters.last", "7 ms")]), "{used:?}");
            assert_eq!(with(&[used]), with(&[used, ("solver.end", "7 ms")]), "{used:?}");
        }
        // A parameter may have the name of a key of prose.
        let named = [("parameters.name", "2*last"), ("loads[0].force.x", "name*t")];
        assert_ne!(with(&named), with(&[named[0], named[1], ("parameters.last", "7 ms")]));
    }

    #[test]
    fn of_several_stages_the_last_end_may_change() {
        let case = "[[stages]]\nsolver = { end = \"1 s\" }\n[[stages]]\nsolver = { end = \"2 s\" }\n";
        let with = |key: &str| {
            let mut root = parse(case, "case.toml").unwrap();
            set(&mut root, key, parse_override(key, "9 s")).unwrap();
            hash(&root)
        };
        let before = hash(&parse(case, "case.toml").unwrap());
        assert_eq!(before, with("stages[1].solver.end"));
        assert_ne!(before, with("stages[0].solver.end"));
    }
}
