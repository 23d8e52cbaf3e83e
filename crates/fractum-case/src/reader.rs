//! Typed access to the tables of a case: every mistake is noted, none ends the reading.

mod effect;
pub(super) mod presence;
mod reading;
pub(super) mod vectors;

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::f64::consts::TAU;
use std::path::PathBuf;

use super::diagnostic::MOST_LISTED;
use super::expression::{Compiled, ExpressionError, Named, Names, Op, Type, compile};
use super::key_kind::{KeyDoc, KeyKind};
use super::scale::Scale;
use super::tree::{Entry, Node, Value, join};
use super::unit::Dimension;
use super::{Choice, Diagnostic, Place, Severity, nearest};
pub(super) use reading::Reading;
use reading::State;

/// Names that a list of valid ones shows at most.
const MOST_NAMES: usize = 20;

/// What the whole reading shares.
pub(super) struct Reader {
    /// Folder of the case file.
    pub(super) folder: PathBuf,
    /// The list of keys: the row of a pattern.
    describe: fn(&str) -> Option<&'static KeyDoc>,
    /// By how much all lengths are larger than written: `verify.scale`.
    pub(super) scale: Scale,
    /// Whether it is a later stage that is read, which begins from the state of the one before.
    pub(super) is_later_stage: Cell<bool>,
    /// Parameters read so far.
    pub(super) parameters: RefCell<BTreeMap<String, Parameter>>,
    /// Tables read from other files: name as written, contents.
    pub(super) tables: RefCell<Vec<(String, Vec<u8>)>>,
    diagnostics: RefCell<Vec<Diagnostic>>,
    /// How many of them are errors.
    mistakes: Cell<usize>,
    /// Keys of the tables that they lie below.
    wrong_tables: RefCell<HashSet<String>>,
    /// Paths of keys that were probably meant by unknown ones: these are not missing too.
    meant: RefCell<BTreeSet<String>>,
}

/// An unknown key, and the path of the key that was probably meant.
pub(super) struct Unknown {
    pub(super) diagnostic: Diagnostic,
    pub(super) meant: Option<String>,
}

/// A named quantity.
#[derive(Debug, Clone)]
pub(super) struct Parameter {
    pub(super) value: f64,
    pub(super) kind: Type,
    pub(super) place: Place,
    pub(super) used: bool,
}

impl Reader {
    pub(super) fn new(folder: PathBuf, describe: fn(&str) -> Option<&'static KeyDoc>) -> Self {
        Self {
            folder,
            describe,
            scale: Scale(1.0),
            is_later_stage: Cell::default(),
            parameters: RefCell::default(),
            tables: RefCell::default(),
            diagnostics: RefCell::default(),
            wrong_tables: RefCell::default(),
            mistakes: Cell::default(),
            meant: RefCell::default(),
        }
    }

    /// Notes a mistake or a doubt.
    pub(super) fn note(&self, diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Error {
            self.mistakes.set(self.mistakes.get() + 1);
            let key = diagnostic.place.as_ref().map_or("", |place| &place.key);
            let tables = key.match_indices('.').map(|(end, _)| key[..end].to_string());
            self.wrong_tables.borrow_mut().extend(tables);
        }
        self.diagnostics.borrow_mut().push(diagnostic);
    }

    /// Notes a key that does not exist.
    pub(super) fn note_unknown(&self, unknown: Unknown) {
        self.note(unknown.diagnostic);
        self.meant.borrow_mut().extend(unknown.meant);
    }

    /// Notes a key that is not there, unless its name was misspelt.
    pub(super) fn note_missing(&self, place: &Place, expected: impl Into<String>) {
        if !self.meant.borrow().contains(&place.key) {
            self.note(Diagnostic::error(place, "is missing").expected(expected));
        }
    }

    /// Whether something below the key of a table is wrong; the whole case is none.
    fn has_mistake_below(&self, key: &str) -> bool {
        self.wrong_tables.borrow().contains(key)
    }

    /// Whether so much is wrong that suggestions help no more.
    pub(super) fn has_many_mistakes(&self) -> bool {
        self.mistakes.get() > MOST_LISTED
    }

    /// Adds the nearest valid name to a mistake, or what the valid names are: `kind: a, b, c`.
    pub(super) fn suggest<'n>(
        &self,
        note: Diagnostic,
        name: &str,
        valid: impl Iterator<Item = &'n str> + Clone,
        kind: &str,
    ) -> Diagnostic {
        if self.has_many_mistakes() {
            return note;
        }
        if let Some(near) = nearest(name, valid.clone()) {
            return note.remedy(format!("did you mean \"{near}\"?"));
        }
        let shown: Vec<&str> = valid.clone().take(MOST_NAMES).collect();
        let more = if valid.count() > MOST_NAMES { ", ..." } else { "" };
        if shown.is_empty() { note } else { note.remedy(format!("{kind}: {}{more}", shown.join(", "))) }
    }

    /// Everything noted.
    pub(super) fn into_diagnostics(self) -> Vec<Diagnostic> {
        self.diagnostics.into_inner()
    }

    /// Compiles the text of `node`, noting what is wrong.
    pub(super) fn compile(&self, node: &Node, text: &str, names: &mut dyn Names, lenient: bool) -> Option<Compiled> {
        let compiled = compile(text, names, lenient);
        compiled.map_err(|error| self.note_expression(node, error)).ok()
    }

    /// Notes a mistake in an expression or unit, at its very column.
    pub(super) fn note_expression(&self, node: &Node, error: ExpressionError) {
        let place = node.place_inside(error.offset);
        self.note(Diagnostic::error(&place, format!("{}: {}", node.found(), error.message)).remedy(error.remedy));
    }

    /// A constant quantity with its type: a number, or an expression of parameters.
    pub(super) fn constant(&self, node: &Node, expected: &str) -> Option<(f64, Type)> {
        let (value, kind) = match &node.value {
            Value::Number(value) => (*value, Type::BARE),
            Value::Text(text) => {
                let compiled = self.compile(node, text, &mut self.names(&[]), false)?;
                (compiled.program.constant().unwrap_or(f64::NAN), compiled.kind)
            }
            _ => {
                self.note(Diagnostic::error(&node.place, node.found()).expected(expected));
                return None;
            }
        };
        if !value.is_finite() {
            self.note(Diagnostic::error(&node.place, node.found()).expected("a finite number"));
            return None;
        }
        Some((value, kind))
    }

    /// A constant quantity of this dimension.
    pub(super) fn quantity(&self, node: &Node, dimension: Dimension) -> Option<f64> {
        let (value, kind) = self.constant(node, &dimension.expected())?;
        self.check_dimension(node, kind, dimension).then_some(value * self.scale.of_bare(kind, dimension))
    }

    /// Whether a type fits a dimension; notes it where not.
    pub(super) fn check_dimension(&self, node: &Node, kind: Type, dimension: Dimension) -> bool {
        if kind.fits(dimension, false) {
            return true;
        }
        let note = Diagnostic::error(&node.place, format!("{}, which is {}", node.found(), kind.phrase()));
        let note = note.expected(dimension.expected());
        self.note(if kind.fits(dimension, true) {
            note.remedy("in a product a number without a unit is a pure number; give it its unit")
        } else {
            note
        });
        false
    }

    /// Where the parameter stands that is the whole value of a node.
    pub(super) fn place_of_parameter(&self, node: &Node) -> Option<Place> {
        let Value::Text(text) = &node.value else { return None };
        self.parameters.borrow().get(text.trim()).map(|parameter| parameter.place.clone())
    }

    /// Names for an expression of parameters and these variables, which become its inputs in order.
    pub(super) fn names<'a>(&'a self, variables: &'a [(&'a str, Dimension)]) -> ParameterNames<'a> {
        ParameterNames { reader: self, variables }
    }
}

/// Parameters and variables as names of an expression.
pub(super) struct ParameterNames<'a> {
    pub(super) reader: &'a Reader,
    variables: &'a [(&'a str, Dimension)],
}

impl Names for ParameterNames<'_> {
    fn contains(&self, name: &str) -> bool {
        self.is_variable(name) || self.reader.parameters.borrow().contains_key(name)
    }

    fn is_variable(&self, name: &str) -> bool {
        self.variables.iter().any(|(known, _)| *known == name)
    }

    fn find(&mut self, name: &str) -> Option<Result<Named, String>> {
        if let Some(index) = self.variables.iter().position(|(known, _)| *known == name) {
            return Some(Ok(Named { op: Op::Input(index as u16), kind: Type::number(self.variables[index].1) }));
        }
        let mut parameters = self.reader.parameters.borrow_mut();
        let parameter = parameters.get_mut(name)?;
        parameter.used = true;
        Some(Ok(Named { op: Op::Constant(parameter.value), kind: parameter.kind }))
    }

    fn scale_of(&self, dimension: Dimension) -> f64 {
        self.reader.scale.of(dimension)
    }

    fn all(&self) -> Vec<String> {
        if self.reader.has_many_mistakes() {
            return Vec::new();
        }
        let variables = self.variables.iter().map(|(name, _)| name.to_string());
        variables.chain(self.reader.parameters.borrow().keys().cloned()).collect()
    }
}

/// A table of the case while it is read. [`Table::finish`] reports the keys that nobody asked for.
pub(super) struct Table<'a> {
    pub(super) reader: &'a Reader,
    /// Where it stands.
    pub(super) place: Place,
    pattern: String,
    entries: Vec<(&'a Entry, Cell<bool>)>,
}

impl<'a> Table<'a> {
    /// A table of this pattern in the list of keys. A node that is no table is reported and counts as empty.
    pub(super) fn new(reader: &'a Reader, node: &'a Node, pattern: impl Into<String>) -> Self {
        let entries = match &node.value {
            Value::Table(entries) => entries.iter().map(|entry| (entry, Cell::new(false))).collect(),
            _ => {
                reader.note(Diagnostic::error(&node.place, node.found()).expected("a table"));
                Vec::new()
            }
        };
        Self { reader, place: node.place.clone(), pattern: pattern.into(), entries }
    }

    /// The entries of a table with names of the user's, in the order of the file; notes names with control characters.
    pub(super) fn entries(&self) -> impl Iterator<Item = &'a Entry> {
        self.entries.iter().map(|(entry, used)| {
            used.set(true);
            if entry.name.contains(char::is_control) {
                self.reader.note(Diagnostic::error(&entry.key_place, "is a name with control characters"));
            }
            *entry
        })
    }

    /// Whether there is such a key.
    pub(super) fn has(&self, name: &str) -> bool {
        self.entries.iter().any(|(entry, _)| entry.name == name)
    }

    /// Whether the value of a key is a table.
    pub(super) fn holds_table(&self, name: &str) -> bool {
        self.peek(name).is_some_and(|node| matches!(node.value, Value::Table(_)))
    }

    /// Whether the value of a key is an array.
    pub(super) fn holds_array(&self, name: &str) -> bool {
        self.peek(name).is_some_and(|node| matches!(node.value, Value::Array(_)))
    }

    /// Looks at the value of a key without taking it.
    pub(super) fn peek(&self, name: &str) -> Option<&'a Node> {
        self.entries.iter().find(|(entry, _)| entry.name == name).map(|(entry, _)| &entry.node)
    }

    /// Takes the value of a key.
    pub(super) fn node(&self, name: &str) -> Option<&'a Node> {
        let (entry, used) = self.entries.iter().find(|(entry, _)| entry.name == name)?;
        used.set(true);
        Some(&entry.node)
    }

    /// Takes keys without reading them: whether they belong here is not known, since another key is wrong.
    pub(super) fn pass_over(&self, names: &[&str]) {
        for name in names {
            self.node(name);
        }
    }

    /// Takes a table.
    pub(super) fn table(&self, name: &str) -> Option<Table<'a>> {
        Some(Table::new(self.reader, self.node(name)?, join(&self.pattern, name)))
    }

    /// Takes a table, an empty one where there is none.
    pub(super) fn table_or_empty(&self, name: &str) -> Table<'a> {
        let place = Place { key: join(&self.place.key, name), ..self.place.clone() };
        let empty = Table { reader: self.reader, place, pattern: join(&self.pattern, name), entries: Vec::new() };
        self.table(name).unwrap_or(empty)
    }

    /// Takes repeated tables `[[name]]`.
    pub(super) fn tables(&self, name: &str) -> Vec<Table<'a>> {
        let pattern = format!("{}[]", join(&self.pattern, name));
        let Some(node) = self.node(name) else { return Vec::new() };
        let Value::Array(items) = &node.value else {
            let note = Diagnostic::error(&node.place, node.found());
            self.reader.note(note.expected("tables in double brackets").remedy(format!("write [[{name}]]")));
            return Vec::new();
        };
        items.iter().map(|item| Table::new(self.reader, item, pattern.clone())).collect()
    }

    /// Place for a key that is not there.
    pub(super) fn place_of(&self, name: &str) -> Place {
        Place { key: join(&self.place.key, name), ..self.place.clone() }
    }

    /// Place of the value at a dotted path below this table; that of the table where there is none.
    pub(super) fn place_below(&self, path: &str) -> Place {
        self.node_below(path).map_or_else(|| self.place_of(path), |node| node.place.clone())
    }

    /// The value at a dotted path below this table, without taking it.
    pub(super) fn node_below(&self, path: &str) -> Option<&'a Node> {
        let mut parts = path.split('.');
        let first = parts.next().and_then(|name| self.peek(name));
        parts.fold(first, |node, part| match &node?.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.name == part).map(|entry| &entry.node),
            _ => None,
        })
    }

    /// What the list of keys says a key holds.
    pub(super) fn kind(&self, name: &str) -> Option<KeyKind> {
        (self.reader.describe)(&join(&self.pattern, name)).map(|key| key.kind)
    }

    /// Dimension of a key by the list of keys.
    pub(super) fn dimension(&self, name: &str) -> Dimension {
        match self.kind(name) {
            Some(
                KeyKind::Quantity(d)
                | KeyKind::Field(d)
                | KeyKind::Point(d)
                | KeyKind::PointOrPlane(d)
                | KeyKind::TimeFunction(d),
            ) => d,
            Some(KeyKind::Unit(Some(d))) => d,
            _ => Dimension::NONE,
        }
    }

    /// Takes a value, read by `read`, which notes what is wrong and then gives nothing.
    pub(super) fn read<T>(&self, name: &'static str, read: impl FnOnce(&'a Node) -> Option<T>) -> Reading<'_, 'a, T> {
        let node = self.node(name);
        let state = match node.map(read) {
            None => State::Absent,
            Some(None) => State::Wrong,
            Some(Some(value)) => State::Given(value),
        };
        Reading { table: self, name, node, state }
    }

    /// Takes a text.
    pub(super) fn text(&self, name: &'static str) -> Reading<'_, 'a, String> {
        self.read(name, |node| {
            let expected = match &node.value {
                Value::Text(text) if text.contains(char::is_control) => "a text of one line without control characters",
                Value::Text(text) if !text.trim().is_empty() => return Some(text.clone()),
                _ => "a text that is not empty",
            };
            self.reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
            None
        })
    }

    /// Takes a flag.
    pub(super) fn flag(&self, name: &'static str) -> Reading<'_, 'a, bool> {
        self.read(name, |node| match node.value {
            Value::Flag(flag) => Some(flag),
            _ => {
                self.reader.note(Diagnostic::error(&node.place, node.found()).expected("true or false"));
                None
            }
        })
    }

    /// Takes a constant quantity of the key's dimension, in SI.
    pub(super) fn quantity(&self, name: &'static str) -> Reading<'_, 'a, f64> {
        self.read(name, |node| {
            let value = self.reader.quantity(node, self.dimension(name))?;
            if matches!(self.kind(name), Some(KeyKind::Angle)) && value.abs() > TAU {
                let note = Diagnostic::error(&node.place, node.found()).expected(KeyKind::Angle.expected());
                self.reader.note(match node.bare_number() {
                    Some(bare) => note.remedy(format!("without a unit it is in radians: write \"{bare} deg\"")),
                    None => note.remedy("write an angle within one turn"),
                });
                return None;
            }
            Some(value)
        })
    }

    /// Takes a whole number from 0 to 2^53.
    pub(super) fn integer(&self, name: &'static str) -> Reading<'_, 'a, u64> {
        let whole =
            self.quantity(name).check(|v| *v >= 0.0 && *v == v.round() && *v < 9e15, "a whole number, at least 0");
        whole.map(|value| value as u64)
    }

    /// Takes one of a closed list of names.
    pub(super) fn choice<T: Choice>(&self, name: &'static str) -> Reading<'_, 'a, T> {
        self.one_of(name, T::NAMES)
    }

    /// Takes one of these names.
    pub(super) fn one_of<T: Copy>(&self, name: &'static str, known: &[(&'static str, T)]) -> Reading<'_, 'a, T> {
        self.read(name, |node| self.choose(node, known))
    }

    /// Finds the text of a node among these names.
    pub(super) fn choose<T: Copy>(&self, node: &Node, known: &[(&'static str, T)]) -> Option<T> {
        let text = if let Value::Text(text) = &node.value { text.as_str() } else { "" };
        let found = known.iter().find(|(name, _)| *name == text);
        if found.is_none() {
            let all: Vec<_> = known.iter().map(|(name, _)| *name).collect();
            let note = Diagnostic::error(&node.place, node.found()).expected(super::key_kind::one_of(&all));
            let near = nearest(text, all).filter(|_| known.len() > 1);
            self.reader.note(match near {
                Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
                None => note,
            });
        }
        found.map(|(_, value)| *value)
    }
}
