//! `[[stages]]`: a tree per stage, with its solver and with the supports and loads that act in it.

use super::super::tree::{Entry, Node, Value};
use super::excavation;
use super::output::{FRAMES, ROWS};
use crate::model::{Body, BodyKind, Case, SolverKind};
use crate::reader::{Reader, Table};
use crate::{Diagnostic, Spanned};

/// The trees of the stages in order, each with its name; the whole tree where the case has none.
pub(super) fn split(reader: &Reader, mut root: Node) -> Vec<(String, Node)> {
    let names = names(&Table::new(reader, &root, ""));
    if names.is_empty() {
        return vec![(String::new(), root)];
    }
    if let Some(solver) = take(&mut root, "solver") {
        let note = Diagnostic::error(&solver.place, "has no effect beside stages");
        reader.note(note.remedy("every stage has a solver of its own"));
    }
    let stages = take(&mut root, "stages").map_or(Vec::new(), items);
    let last = stages.len().saturating_sub(1);
    let mut trees = Vec::new();
    for (index, (mut stage, name)) in stages.into_iter().zip(&names).enumerate() {
        let mut tree = root.clone();
        for list in ["supports", "loads"] {
            keep_acting(reader, &mut tree, list, &name.value, &names);
        }
        if index < last {
            // What is written belongs to the whole run, which ends with the last stage.
            take(&mut tree, "output");
        }
        if let (Some(solver), Value::Table(entries)) = (take(&mut stage, "solver"), &mut tree.value) {
            // What the stage itself says stays in its list, which has no other.
            let own = Node { value: Value::Array(vec![stage.clone()]), ..stage.clone() };
            entries.push(Entry { name: "stages".to_owned(), key_place: stage.place.clone(), node: own });
            entries.push(Entry { name: "solver".to_owned(), key_place: solver.place.clone(), node: solver });
        }
        trees.push((name.value.clone(), tree));
    }
    trees
}

/// Names of the stages, unique.
fn names(root: &Table<'_>) -> Vec<Spanned<String>> {
    if !root.has("stages") {
        return Vec::new();
    }
    let mut names: Vec<Spanned<String>> = Vec::new();
    for table in root.tables("stages") {
        let place = table.place.clone();
        let name = table.text("name").spanned().required().unwrap_or(Spanned::new(String::new(), place));
        if !table.has("solver") {
            let note = Diagnostic::error(&table.place_of("solver"), "is missing");
            table.reader.note(note.expected("a table with the keys of [solver]"));
        }
        if let Some(other) = names.iter().find(|other| other.value == name.value && !name.value.is_empty()) {
            let note =
                Diagnostic::error(&name.place, format!("= \"{}\" is taken at line {}", name.value, other.place.line));
            table.reader.note(note.remedy("names are unique"));
        }
        names.push(name);
    }
    names
}

/// Drops what does not act in a stage, and the keys that say so.
fn keep_acting(reader: &Reader, tree: &mut Node, list: &str, stage: &str, names: &[Spanned<String>]) {
    let Value::Table(entries) = &mut tree.value else { return };
    let Some(Value::Array(tables)) = entries.iter_mut().find(|e| e.name == list).map(|e| &mut e.node.value) else {
        return;
    };
    tables.retain_mut(|table| {
        let Some(acting) = take(table, "stages") else { return true };
        let place = acting.place.clone();
        let acting: Option<Vec<String>> = match acting.value {
            Value::Array(items) => items
                .into_iter()
                .map(|item| match item.value {
                    Value::Text(text) if names.iter().any(|name| name.value == text) => Some(text),
                    _ => None,
                })
                .collect(),
            _ => None,
        };
        let Some(acting) = acting.filter(|acting| !acting.is_empty()) else {
            let there: Vec<String> = names.iter().map(|name| format!("\"{}\"", name.value)).collect();
            let note = Diagnostic::error(&place, "is no list of stages of this case");
            reader.note(note.expected(format!("some of {}", there.join(", "))));
            return true;
        };
        acting.iter().any(|name| name == stage)
    });
}

/// Takes a key out of a table.
fn take(node: &mut Node, name: &str) -> Option<Node> {
    let Value::Table(entries) = &mut node.value else { return None };
    let index = entries.iter().position(|entry| entry.name == name)?;
    Some(entries.remove(index).node)
}

fn items(node: Node) -> Vec<Node> {
    if let Value::Array(items) = node.value { items } else { Vec::new() }
}

/// One case with those of its later stages.
pub(super) fn joined(reader: &Reader, cases: Vec<Option<Case>>) -> Option<Case> {
    let mut cases: Vec<Case> = cases.into_iter().collect::<Option<_>>()?;
    for pair in cases.windows(2) {
        let [before, case] = [&pair[0].solver, &pair[1].solver];
        if case.kind == SolverKind::Static && before.kind != SolverKind::Static {
            let note = Diagnostic::error(&case.place, "cannot follow a stage in motion");
            reader.note(note.expected("stages at rest first, then stages in motion"));
        }
        if case.end <= before.end {
            let found = format!(
                ": stage \"{}\" ends at {} s, the one before at {} s",
                pair[1].source.stage, case.end, before.end
            );
            reader.note(Diagnostic::error(&case.place, found).remedy("one clock runs through all stages"));
        }
    }
    for stage in 1..cases.len() {
        cases[stage].solver.begin = cases[stage - 1].solver.end;
    }
    excavation::join(reader, &mut cases);
    if cases.len() > 1 {
        let particles = |body: &&Body| matches!(body.kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
        for body in cases[0].bodies.iter().filter(particles) {
            let note = Diagnostic::error(&body.name.place, ": its particles know no stages");
            reader.note(note.expected("solids and rigid bodies in a case with several stages"));
        }
        for case in cases.iter().filter(|case| case.solver.kind == SolverKind::Auto) {
            let note = Diagnostic::error(&case.solver.place, "= \"auto\" in one of several stages");
            reader.note(note.expected("\"static\" or \"explicit\""));
        }
        for case in cases.iter().filter(|case| case.solver.kind == SolverKind::Modes) {
            let note = Diagnostic::error(&case.solver.place, "= \"modes\" in one of several stages");
            reader.note(note.expected("one [solver] without stages"));
        }
    }
    let mut output = cases.last()?.output.clone();
    let moving = cases.iter().filter(|case| case.solver.kind == SolverKind::Explicit);
    let in_motion: f64 = moving.map(|case| case.solver.end - case.solver.begin).sum();
    let has_stages = cases.len() > 1;
    if has_stages && !output.gives_history && in_motion > 0.0 {
        // Every state at rest is a row anyway.
        output.history_every = in_motion / ROWS;
    }
    let counts_frames = has_stages && !output.gives_fields;
    if counts_frames && in_motion > 0.0 {
        output.fields_every = in_motion / FRAMES;
    }
    for case in &mut cases {
        case.output = output.clone();
        if counts_frames {
            case.output.fields_every_at_rest = (case.solver.end - case.solver.begin) / FRAMES;
        }
    }
    let later = cases.split_off(1);
    Some(Case { later, ..cases.pop()? })
}
