//! `[[probes]]`.

use std::collections::HashMap;

use super::parameters::check_name;
use crate::expression::{Named, Names, Op, Type, parse_unit};
use crate::measure;
use crate::model::{Probe, ProbeExpression, ProbeInput, ProbeKind, Take};
use crate::reader::presence::exactly_one;
use crate::reader::{ParameterNames, Table};
use crate::tree::{Node, Value};
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned};

/// A probe as far as it could be read.
pub(super) struct ReadProbe {
    pub(super) name: String,
    /// Dimension of its values; unknown where the probe is wrong.
    pub(super) dimension: Option<Dimension>,
    pub(super) scalar: bool,
    pub(super) probe: Option<Probe>,
}

/// All probes of a case.
pub(super) struct ReadProbes {
    /// In the order of the file.
    pub(super) list: Vec<ReadProbe>,
    /// Index of the first probe of each name.
    by_name: HashMap<String, usize>,
}

impl ReadProbes {
    /// The probe of this name.
    pub(super) fn find(&self, name: &str) -> Option<&ReadProbe> {
        self.list.get(*self.by_name.get(name)?)
    }
}

/// Functions that reduce the history of a probe to a number.
const REDUCTIONS: [(&str, Take); 7] = [
    ("max", Take::Max),
    ("min", Take::Min),
    ("absmax", Take::AbsMax),
    ("mean", Take::Mean),
    ("final", Take::Final),
    ("time_of_max", Take::TimeOfMax),
    ("front_speed", Take::Speed),
];

/// Functions of a probe and a time.
const OF_A_TIME: [&str; 2] = ["at", "slope"];

/// Reads all probes in order.
pub(super) fn read(root: &Table<'_>) -> ReadProbes {
    let tables = root.tables("probes");
    let name = |table: &Table<'_>| match table.peek("name").map(|node| &node.value) {
        Some(Value::Text(name)) => name.clone(),
        _ => String::new(),
    };
    let names: Vec<String> = tables.iter().map(name).collect();
    let mut by_name = HashMap::new();
    for (index, name) in names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
        by_name.entry(name.clone()).or_insert(index);
    }
    let mut list = Vec::new();
    for (table, own_name) in tables.into_iter().zip(names) {
        let probe = probe(table, own_name, &list, &by_name);
        list.push(probe);
    }
    ReadProbes { list, by_name }
}

fn probe(table: Table<'_>, own_name: String, earlier: &[ReadProbe], by_name: &HashMap<String, usize>) -> ReadProbe {
    let is_first = by_name.get(&own_name).is_none_or(|first| *first == earlier.len());
    let name = table.text("name").spanned().required().filter(|name| good_name(&table, name, is_first));
    let mut read = ReadProbe { name: own_name, dimension: None, scalar: false, probe: None };
    let kinds: Vec<&str> = measure::NAMES.iter().copied().chain(["expression"]).collect();
    let Some(key) = exactly_one(&table, &kinds) else { return read };
    let mut unit = None;
    let measured = match key {
        "expression" => expression(&table, earlier, by_name).map(|expression| {
            unit = expression.unit;
            read.scalar = expression.probe.scalar;
            (ProbeKind::Expression(expression.probe), expression.dimension)
        }),
        _ => measure::read(&table, key).map(|(kind, dimension, own)| {
            unit = own.map(str::to_owned);
            (kind, dimension)
        }),
    };
    let every = if key == "expression" { None } else { table.quantity("every").positive().given() };
    table.finish(&format!("with {key}"));
    if let Some((kind, dimension)) = measured {
        read.dimension = Some(dimension);
        let unit = unit.unwrap_or_else(|| dimension.symbol());
        read.probe = name.map(|name| Probe { name, unit, kind, every });
    }
    read
}

/// Whether expressions can use the name, and no other probe or parameter has it.
fn good_name(table: &Table<'_>, name: &Spanned<String>, is_first: bool) -> bool {
    let reader = table.reader;
    check_name(reader, &name.value, &name.place);
    let taken = if !is_first {
        "is the name of an earlier probe"
    } else if reader.parameters.borrow().contains_key(&name.value) {
        "is the name of a parameter"
    } else if OF_A_TIME.contains(&name.value.as_str()) || REDUCTIONS.iter().any(|(known, _)| *known == name.value) {
        "is the name of a function"
    } else {
        return true;
    };
    reader.note(Diagnostic::error(&name.place, format!("= \"{}\" {taken}", name.value)).remedy("rename it"));
    false
}

struct ReadExpression {
    probe: ProbeExpression,
    dimension: Dimension,
    /// As written.
    unit: Option<String>,
}

fn expression(table: &Table<'_>, earlier: &[ReadProbe], by_name: &HashMap<String, usize>) -> Option<ReadExpression> {
    let reader = table.reader;
    let unit = table.has("unit").then(|| si_unit(table));
    let node = table.node("expression")?;
    let Value::Text(text) = &node.value else {
        reader.note(Diagnostic::error(&node.place, node.found()).expected("an expression in quotes"));
        return None;
    };
    let parameters = reader.names(&[]);
    let mut names = ProbeNames { parameters, earlier, by_name, inputs: Vec::new(), scalar: false, broken: false };
    let compiled = reader.compile(node, text, &mut names, true)?;
    let Type::Number { dimension, bare, loose } = compiled.kind else {
        let note = Diagnostic::error(&node.place, format!("{}, which is a condition", node.found()));
        reader.note(note.expected("a number").remedy("write if(condition, 1, 0)"));
        return None;
    };
    let (unit, dimension) = match unit {
        Some(unit) => {
            let (unit, meant) = unit?;
            if !compiled.kind.fits(meant, true) && !names.broken {
                let found = format!("{}, which is {}", node.found(), compiled.kind.phrase());
                let note = Diagnostic::error(&node.place, found);
                reader.note(note.expected(format!("{}, by its unit \"{unit}\"", meant.phrase())));
                return None;
            }
            (Some(unit), meant)
        }
        None if names.broken => return None,
        None if loose && !(bare && names.inputs.is_empty()) => {
            let note = Diagnostic::error(&table.place_of("unit"), "is missing");
            let note = note.expected("the SI unit of the expression, such as \"Pa\"");
            reader.note(note.remedy("a factor without a unit leaves it open"));
            return None;
        }
        None => (None, dimension),
    };
    let probe = ProbeExpression { inputs: names.inputs, scalar: names.scalar, program: compiled.program };
    Some(ReadExpression { probe, dimension, unit })
}

/// The unit of an expression, as written and as dimension; it must be SI, as all results are.
fn si_unit(table: &Table<'_>) -> Option<(String, Dimension)> {
    let read = |node: &Node| {
        let Value::Text(text) = &node.value else {
            table.reader.note(Diagnostic::error(&node.place, node.found()).expected("a unit in quotes"));
            return None;
        };
        let unit = parse_unit(text).map_err(|error| table.reader.note_expression(node, error)).ok()?;
        if unit.size() != 1.0 {
            let note = Diagnostic::error(&node.place, node.found());
            table.reader.note(note.expected(format!("the SI unit \"{}\", as in all results", unit.dimension)));
            return None;
        }
        Some((text.trim().to_string(), unit.dimension))
    };
    table.read("unit", read).given()
}

/// Names of a probe expression: t, parameters, earlier probes and reductions of them.
struct ProbeNames<'a> {
    parameters: ParameterNames<'a>,
    earlier: &'a [ReadProbe],
    /// Index of the first probe of each name, later ones among them.
    by_name: &'a HashMap<String, usize>,
    inputs: Vec<ProbeInput>,
    scalar: bool,
    /// Whether it reads a probe that is wrong itself.
    broken: bool,
}

impl ProbeNames<'_> {
    fn input(&mut self, input: ProbeInput, kind: Type) -> Result<Named, String> {
        let known = self.inputs.iter().position(|other| *other == input);
        let index = known.unwrap_or_else(|| {
            self.inputs.push(input);
            self.inputs.len() - 1
        });
        let index = u16::try_from(index).map_err(|_| "too many probes in one expression".to_string())?;
        Ok(Named { op: Op::Input(index), kind })
    }

    /// Index of an earlier probe with the type of its values.
    fn probe(&mut self, name: &str) -> Result<(usize, Type), String> {
        let index = self.by_name.get(name).copied().filter(|index| *index < self.earlier.len());
        let index = index.ok_or_else(|| format!("probe \"{name}\" must be declared above this one"))?;
        self.broken |= self.earlier[index].dimension.is_none();
        Ok((index, self.earlier[index].dimension.map_or(Type::BARE, Type::number)))
    }

    fn take(&mut self, probe: usize, take: Take, kind: Type) -> Result<Named, String> {
        self.input(ProbeInput::Probe { probe, take }, kind)
    }
}

impl Names for ProbeNames<'_> {
    fn contains(&self, name: &str) -> bool {
        name == "t" || self.by_name.contains_key(name) || self.parameters.contains(name)
    }

    fn is_variable(&self, name: &str) -> bool {
        name == "t"
    }

    fn find(&mut self, name: &str) -> Option<Result<Named, String>> {
        if name == "t" {
            return Some(self.input(ProbeInput::Time, Type::number(Dimension::TIME)));
        }
        if !self.by_name.contains_key(name) {
            return self.parameters.find(name);
        }
        Some(self.probe(name).and_then(|(index, kind)| {
            self.scalar |= self.earlier[index].scalar;
            self.take(index, Take::Current, kind)
        }))
    }

    fn scale_of(&self, dimension: Dimension) -> f64 {
        self.parameters.scale_of(dimension)
    }

    fn all(&self) -> Vec<String> {
        if self.parameters.reader.has_many_mistakes() {
            return Vec::new();
        }
        let mut probes: Vec<(&usize, &String)> = self.by_name.iter().map(|(name, index)| (index, name)).collect();
        probes.sort_unstable();
        let probes = probes.into_iter().map(|(_, name)| name.clone());
        probes.chain(["t".to_string()]).chain(self.parameters.all()).collect()
    }

    fn reduces(&self, function: &str) -> bool {
        OF_A_TIME.contains(&function) || REDUCTIONS.iter().any(|(name, _)| *name == function)
    }

    fn needs_time(&self, function: &str) -> bool {
        OF_A_TIME.contains(&function)
    }

    fn reduce(&mut self, function: &str, name: &str, at: Option<f64>) -> Result<Named, String> {
        if !self.by_name.contains_key(name) {
            return Err(format!("{function}() needs a probe; \"{name}\" is none"));
        }
        let (probe, kind) = self.probe(name)?;
        if self.earlier[probe].scalar {
            return Err(format!("\"{name}\" is one number already and has no history for {function}()"));
        }
        // A slope is one more history.
        self.scalar |= function != "slope";
        let take = match at {
            Some(time) if function == "slope" => Take::Slope(time),
            Some(time) => Take::At(time),
            None => {
                let found = REDUCTIONS.iter().find(|(name, _)| *name == function);
                found.map(|(_, take)| *take).ok_or_else(|| format!("unknown function \"{function}\""))?
            }
        };
        let kind = match (take, kind) {
            (Take::TimeOfMax, _) => Type::number(Dimension::TIME),
            (Take::Speed | Take::Slope(_), Type::Number { dimension, .. }) => {
                let out_of_range = || format!("{function}({name}) has a dimension out of range");
                Type::number(dimension.over(Dimension::TIME).ok_or_else(out_of_range)?)
            }
            _ => kind,
        };
        self.take(probe, take, kind)
    }
}
