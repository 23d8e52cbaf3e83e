//! The parsed TOML document with the place and the text of every value.

use std::collections::BTreeSet;

use toml::de::{DeTable, DeValue};

use super::place::COMMAND_LINE;
use super::{Diagnostic, Place};

/// A value of the document.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) place: Place,
    /// The value as written, shortened to a line.
    pub(super) raw: String,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Text(String),
    Number(f64),
    Flag(bool),
    /// A date or time, which no key takes.
    Date,
    Array(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key with its value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) key_place: Place,
    pub(super) node: Node,
}

/// Longest value quoted in a message, in characters.
const QUOTED: usize = 60;

impl Node {
    /// What was found, for messages: `= 0.62`, or `is a table`.
    pub(super) fn found(&self) -> String {
        match &self.value {
            Value::Table(_) => "is a table".to_string(),
            _ => format!("= {}", self.raw),
        }
    }

    /// A number without a unit.
    pub(super) fn bare_number(&self) -> Option<f64> {
        match &self.value {
            Value::Number(number) => Some(*number),
            Value::Text(text) => text.trim().parse().ok(),
            _ => None,
        }
    }

    /// The place `offset` bytes into a string value, where its text stands in the file as it is.
    pub(super) fn place_inside(&self, offset: usize) -> Place {
        let mut place = self.place.clone();
        if let Value::Text(text) = &self.value
            && place.line > 0
            && (self.raw == format!("\"{text}\"") || self.raw == format!("'{text}'"))
        {
            let before = text.get(..offset).map_or(0, |before| before.chars().count());
            place.column += 1 + before as u32;
        }
        place
    }
}

/// Parses the text of a file; all syntax errors where it is not TOML.
pub(super) fn parse(text: &str, file: &str) -> Result<Node, Vec<Diagnostic>> {
    let source = Source { text, file, lines: line_starts(text) };
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        let mut lines = BTreeSet::new();
        for error in &errors {
            let place = source.place(error.span().map_or(text.len(), |span| span.start), String::new());
            // what follows the first error of a line is most often its echo
            if lines.insert(place.line) {
                diagnostics.push(Diagnostic::error(&place, format!("not TOML: {}", error.message())));
            }
        }
        return Err(diagnostics);
    }
    let place = Place { file: file.to_string(), line: 0, column: 0, key: String::new() };
    let value = source.table(table.get_ref(), "");
    Ok(Node { value, place, raw: String::new() })
}

/// Reads the value of `--set key=value`: a TOML value, or else a plain string.
pub(super) fn parse_override(key: &str, text: &str) -> Node {
    let place = Place { file: COMMAND_LINE.to_string(), line: 0, column: 0, key: key.to_string() };
    let value = match DeValue::parse(text) {
        Ok(value) => {
            let source = Source { text, file: COMMAND_LINE, lines: Vec::new() };
            source.value(value.get_ref(), key)
        }
        Err(_) => Value::Text(text.to_string()),
    };
    Node { value, place, raw: shortened(text) }
}

/// The place of a byte of a file.
pub(crate) fn place_of(text: &str, file: &str, offset: usize) -> Place {
    Source { text, file, lines: line_starts(text) }.place(offset, String::new())
}

struct Source<'a> {
    text: &'a str,
    file: &'a str,
    /// Offset of every line; empty for text that is not a file.
    lines: Vec<usize>,
}

fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect()
}

impl Source<'_> {
    fn place(&self, offset: usize, key: String) -> Place {
        let line = self.lines.partition_point(|&start| start <= offset);
        let start = line.checked_sub(1).and_then(|line| self.lines.get(line));
        // Columns count characters, bytes on lines too long to count again for every value.
        let count = |line: &str| if line.len() > 10_000 { line.len() } else { line.chars().count() };
        let column = start.map_or(0, |&start| 1 + self.text.get(start..offset).map_or(0, count));
        Place { file: self.file.to_string(), line: line as u32, column: column as u32, key }
    }

    fn node(&self, value: &toml::Spanned<DeValue<'_>>, key: String) -> Node {
        let raw = shortened(self.text.get(value.span()).unwrap_or_default());
        Node { value: self.value(value.get_ref(), &key), raw, place: self.place(value.span().start, key) }
    }

    fn value(&self, value: &DeValue<'_>, key: &str) -> Value {
        match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(integer) => {
                let exact = i64::from_str_radix(integer.as_str(), integer.radix()).map(|value| value as f64);
                Value::Number(exact.unwrap_or_else(|_| integer.as_str().parse().unwrap_or(f64::NAN)))
            }
            DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(flag) => Value::Flag(*flag),
            DeValue::Datetime(_) => Value::Date,
            DeValue::Array(items) => {
                let items = items.iter().enumerate();
                Value::Array(items.map(|(i, item)| self.node(item, format!("{key}[{i}]"))).collect())
            }
            DeValue::Table(table) => self.table(table, key),
        }
    }

    fn table(&self, table: &DeTable<'_>, key: &str) -> Value {
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(name, _)| name.span().start); // as in the file, not as in the alphabet
        let entries = entries.into_iter().map(|(name, value)| {
            let path = join(key, name.get_ref());
            let key_place = self.place(name.span().start, path.clone());
            Entry { name: name.get_ref().to_string(), key_place, node: self.node(value, path) }
        });
        Value::Table(entries.collect())
    }
}

/// Dotted path of a key in a table.
pub(super) fn join(table: &str, name: &str) -> String {
    if table.is_empty() { name.to_string() } else { format!("{table}.{name}") }
}

/// What a message quotes of a text: the beginning of its first line.
pub(super) fn shortened(raw: &str) -> String {
    let line = raw.lines().next().unwrap_or_default();
    if line.len() == raw.len() && line.chars().count() <= QUOTED {
        return line.to_string();
    }
    let start: String = line.chars().take(QUOTED).collect();
    format!("{start}...")
}

/// Puts a value at a dotted path such as `solver.end` or `bodies[0].damage`, making tables on the way; `*` stands for every
/// entry of a table and `[*]` for every item of an array that has the keys that follow.
pub(super) fn set(root: &mut Node, path: &str, value: Node) -> Result<(), Box<Diagnostic>> {
    let place = value.place.clone();
    let fail = |found: &str, remedy: String| Box::new(Diagnostic::error(&place, found).remedy(remedy));
    if path.contains('*') {
        let paths = matching(root, path);
        if paths.is_empty() {
            return Err(fail("cannot be set", "nothing in this case matches it".to_string()));
        }
        return paths.iter().try_for_each(|path| set(root, path, value.clone()));
    }
    let mut at = root;
    let mut so_far = String::new();
    for part in path.split('.') {
        let (name, index) = match part.split_once('[') {
            Some((name, index)) => {
                let index = index.strip_suffix(']').and_then(|index| index.parse::<usize>().ok());
                (name, Some(index.ok_or_else(|| fail("is not a key", String::new()))?))
            }
            None => (part, None),
        };
        if name.is_empty() {
            return Err(fail("is not a key", String::new()));
        }
        so_far = join(&so_far, name);
        let Value::Table(entries) = &mut at.value else {
            return Err(fail("cannot be set", format!("{so_far} does not stand in a table")));
        };
        let found = match entries.iter().position(|entry| entry.name == name) {
            Some(found) => found,
            None => {
                let place = Place { key: so_far.clone(), ..place.clone() };
                let node = Node { value: Value::Table(Vec::new()), place: place.clone(), raw: String::new() };
                entries.push(Entry { name: name.to_string(), key_place: place, node });
                entries.len() - 1
            }
        };
        at = &mut entries[found].node;
        if let Some(index) = index {
            so_far = format!("{so_far}[{index}]");
            let count = if let Value::Array(items) = &at.value { items.len() } else { 0 };
            match &mut at.value {
                Value::Array(items) if index < count => at = &mut items[index],
                _ => return Err(fail("cannot be set", format!("the case has {count} of these"))),
            }
        }
    }
    *at = value;
    Ok(())
}

/// The paths that one with `*` stands for.
fn matching(root: &Node, path: &str) -> Vec<String> {
    let (above, last) = path.rsplit_once('.').unwrap_or(("", path));
    let mut found = vec![(String::new(), root)];
    for part in above.split('.').filter(|part| !part.is_empty()) {
        found = found.iter().flat_map(|(path, node)| below(path, node, part)).collect();
    }
    if last.contains('*') {
        return found.iter().flat_map(|(path, node)| below(path, node, last)).map(|(path, _)| path).collect();
    }
    let tables = found.into_iter().filter(|(_, node)| matches!(node.value, Value::Table(_)));
    tables.map(|(path, _)| join(&path, last)).collect()
}

/// What a part of a path names in the table at `path`.
fn below<'a>(path: &str, node: &'a Node, part: &str) -> Vec<(String, &'a Node)> {
    let Value::Table(entries) = &node.value else { return Vec::new() };
    let (name, index) = part.split_once('[').map_or((part, None), |(name, index)| (name, index.strip_suffix(']')));
    let named = entries.iter().filter(|entry| name == "*" || entry.name == name);
    let mut found = Vec::new();
    for Entry { name, node, .. } in named {
        let path = join(path, name);
        match (&node.value, index) {
            (_, None) => found.push((path, node)),
            (Value::Array(items), Some(index)) => {
                let wanted = items.iter().enumerate().filter(|(i, _)| index == "*" || index.parse() == Ok(*i));
                found.extend(wanted.map(|(i, item)| (format!("{path}[{i}]"), item)));
            }
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find<'a>(node: &'a Node, name: &str) -> &'a Node {
        let Value::Table(entries) = &node.value else { panic!("{name}: not in a table") };
        &entries.iter().find(|entry| entry.name == name).unwrap().node
    }

    #[test]
    fn every_value_knows_its_place() {
        let text = "a = 1\n[m.\"é\"]\n  \"ü\" = \"5 mm\"\n[[b]]\nx = [1, inf]\n[[b]]\nx = { y = true }\n";
        let root = parse(text, "f.toml").unwrap();
        let value = find(find(find(&root, "m"), "é"), "ü");
        assert_eq!((value.place.line, value.place.column), (3, 9), "columns count characters");
        assert_eq!((value.place.key.as_str(), value.raw.as_str()), ("m.é.ü", "\"5 mm\""));
        assert_eq!(value.place_inside(2).column, 12, "the unit");
        let Value::Array(bodies) = &find(&root, "b").value else { panic!() };
        let items = find(&bodies[0], "x");
        let Value::Array(items) = &items.value else { panic!() };
        assert_eq!((items[1].place.key.as_str(), items[1].place.line), ("b[0].x[1]", 5));
        assert_eq!(find(find(&bodies[1], "x"), "y").value, Value::Flag(true));
    }

    #[test]
    fn integers_of_any_base_and_size_are_numbers() {
        let root = parse("a = 0x1F\nb = 99999999999999999999\nc = -1_000\nd = nan", "f").unwrap();
        assert_eq!(find(&root, "a").value, Value::Number(31.0));
        assert_eq!(find(&root, "b").value, Value::Number(1e20));
        assert_eq!(find(&root, "c").value, Value::Number(-1000.0));
        assert!(matches!(find(&root, "d").value, Value::Number(x) if x.is_nan()));
    }

    #[test]
    fn syntax_errors_have_line_and_column() {
        let errors = parse("a = 1\nb = 2 3\n[q\nc = 1", "f.toml").unwrap_err();
        let places: Vec<_> = errors.iter().filter_map(|e| e.place.clone()).map(|p| (p.line, p.column)).collect();
        assert!(places.contains(&(2, 5)), "{places:?}");
        assert!(places.contains(&(3, 3)), "{places:?}");
    }

    #[test]
    fn overrides_replace_and_add_values() {
        let mut root = parse("[[b]]\nx = 1\n[s]\n", "f").unwrap();
        set(&mut root, "b[0].x", parse_override("b[0].x", "1 mm")).unwrap();
        set(&mut root, "s.end", parse_override("s.end", "0.5")).unwrap();
        set(&mut root, "new.deep.key", parse_override("new.deep.key", "[1, 2]")).unwrap();
        let Value::Array(bodies) = &find(&root, "b").value else { panic!() };
        assert_eq!(find(&bodies[0], "x").value, Value::Text("1 mm".to_string()));
        assert_eq!(find(find(&root, "s"), "end").value, Value::Number(0.5));
        assert!(matches!(find(find(find(&root, "new"), "deep"), "key").value, Value::Array(_)));
        let mut many = parse("[m.a.d]\n[m.b]\n[m.c]\nd = { k = 1 }\n[[b]]\n[[b]]\nx = 1\n", "f").unwrap();
        for path in ["m.*.d.k", "b[*].x"] {
            set(&mut many, path, parse_override(path, "7")).unwrap();
        }
        let materials = find(&many, "m");
        for name in ["a", "c"] {
            assert_eq!(find(find(find(materials, name), "d"), "k").value, Value::Number(7.0));
        }
        assert_eq!(
            find(materials, "b").value,
            Value::Table(Vec::new()),
            "nothing is made where the keys are not there"
        );
        let Value::Array(bodies) = &find(&many, "b").value else { panic!() };
        assert!(bodies.iter().all(|body| find(body, "x").value == Value::Number(7.0)));
        assert!(set(&mut many, "m.*.e.k", parse_override("m.*.e.k", "7")).is_err());
        for path in ["b[1].x", "b[x].x", "b.x.y", "", ".", "b[0]x"] {
            assert!(set(&mut root, path, parse_override(path, "1")).is_err(), "{path}");
        }
    }
}
