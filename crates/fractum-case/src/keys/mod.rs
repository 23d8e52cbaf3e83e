//! Every key of the case file: kind, default, meaning.
//!
//! The reader takes dimensions from here, so that the documentation, `explain`, the schema and the reading agree.

mod bodies;
mod conditions;
mod gas;
mod heat;
mod interfaces;
mod liquid;
mod network;
mod output;
mod periodic;
mod probes;
mod solver;

use std::collections::HashMap;
use std::sync::LazyLock;

use fractum_output::fields::OutputField;

use super::key_kind::{KeyDoc, KeyKind, key, names};
use super::measure;
use super::reader::Unknown;
use super::tree::{Node, Value, join};
use super::{Diagnostic, nearest};

/// Names of the curves of strength by rate that a standard gives.
pub(super) const RATE_PRESETS: [&str; 2] = ["fib-2010", "fib-2010-first-branch"];

/// Names of the laws of sizes of loose particles.
pub(super) const SIZE_LAWS: [&str; 2] = ["uniform", "log-normal"];

/// Pattern of the table form of a time function, which may stand at many keys.
pub(super) const TIME_FUNCTION: &str = "TIME_FUNCTION";

/// Every key of the case file, parents before children.
pub fn keys() -> &'static [KeyDoc] {
    static KEYS: LazyLock<Vec<KeyDoc>> = LazyLock::new(|| {
        let measures = measure::keys();
        let probes = [probes::FIRST, &measures, probes::LAST].concat();
        let field = |field: &OutputField| key(field.path(), KeyKind::Flag, "false", field.doc());
        let fields: Vec<KeyDoc> = OutputField::ALL.iter().map(field).collect();
        let output = [output::FIRST, &fields, output::LAST].concat();
        let before = [bodies::KEYS, interfaces::KEYS, network::KEYS, conditions::KEYS, gas::KEYS, heat::KEYS].concat();
        let before = [before, liquid::KEYS.to_vec(), periodic::KEYS.to_vec(), solver::KEYS.to_vec()].concat();
        [before, probes, output].concat()
    });
    &KEYS
}

/// The description of a key: a pattern as in [`KeyDoc::path`], or a path of a case such as `supports[0].group`.
///
/// # Errors
/// The nearest known path, if any resembles.
pub fn explain(path: &str) -> Result<&'static KeyDoc, Option<&'static str>> {
    if let Some(key) = fitting(path) {
        return Ok(key);
    }
    let (parent, last) = path.rsplit_once('.').unwrap_or(("", path));
    if matches!(fitting(parent), Some(KeyDoc { kind: KeyKind::TimeFunction(_), .. }))
        && let Some(key) = describe(&join(TIME_FUNCTION, last))
    {
        return Ok(key);
    }
    let paths = || keys().iter().map(|key| key.path);
    let whole = nearest(&without_indices(path), paths());
    Err(whole.or_else(|| paths().find(|path| path.rsplit('.').next() == Some(last))))
}

/// The key whose pattern a path of a case, or itself, fits.
fn fitting(path: &str) -> Option<&'static KeyDoc> {
    let plain = without_indices(path);
    let fits = |key: &&KeyDoc| {
        let pattern = without_indices(key.path);
        let same = |(part, name): (&str, &str)| part == name || (part == "NAME" && !name.is_empty());
        pattern.split('.').count() == plain.split('.').count() && pattern.split('.').zip(plain.split('.')).all(same)
    };
    describe(path).or_else(|| keys().iter().find(fits))
}

/// A path without what stands in square brackets.
fn without_indices(path: &str) -> String {
    path.split('.').map(|part| part.split('[').next().unwrap_or_default()).collect::<Vec<_>>().join(".")
}

/// The description of a key by its pattern.
pub(super) fn describe(pattern: &str) -> Option<&'static KeyDoc> {
    static BY_PATH: LazyLock<HashMap<&str, &KeyDoc>> =
        LazyLock::new(|| keys().iter().map(|key| (key.path, key)).collect());
    BY_PATH.get(pattern).copied()
}

/// Names of the keys directly below a pattern.
pub(super) fn children(pattern: &str) -> impl Iterator<Item = &'static str> {
    let below = keys().iter().filter_map(move |key| match pattern {
        "" => Some(key.path),
        _ => key.path.strip_prefix(pattern)?.strip_prefix('.'),
    });
    below
        .filter(|name| !name.contains('.') && !["NAME", TIME_FUNCTION].contains(name))
        .map(|name| name.trim_end_matches("[]"))
}

/// Keys of earlier versions, and what to write instead.
const RETIRED: [(&str, &str); 1] = [(
    "materials.NAME.damage.crack_plane_gate",
    "the crack-plane gate is gone; remove the key, and where cracks follow rows of the mesh take another one or set regularisation = \"phase-field\"",
)];

/// Reports keys that do not exist, with the nearest that does, and takes them out of the tree.
pub(super) fn remove_unknown(node: &mut Node, pattern: &str, report: &mut dyn FnMut(Unknown)) {
    let Value::Table(entries) = &mut node.value else { return };
    let table = &node.place.key;
    entries.retain_mut(|entry| {
        let exact = join(pattern, &entry.name);
        let named = join(pattern, "NAME");
        let key = describe(&exact).or_else(|| describe(&format!("{exact}[]"))).or_else(|| describe(&named));
        let Some(key) = key.filter(|key| key.path != TIME_FUNCTION) else {
            let known: Vec<_> = children(pattern).collect();
            let diagnostic = Diagnostic::error(&entry.key_place, "is not a key");
            if let Some((_, instead)) = RETIRED.iter().find(|(path, _)| *path == exact) {
                report(Unknown { diagnostic: diagnostic.remedy(*instead), meant: None });
                return false;
            }
            report(match nearest(&entry.name, known.iter().copied()) {
                Some(near) => Unknown {
                    diagnostic: diagnostic.remedy(format!("did you mean {near}?")),
                    meant: Some(join(table, near)),
                },
                None if known.is_empty() => Unknown { diagnostic, meant: None },
                None => {
                    Unknown { diagnostic: diagnostic.remedy(format!("keys here: {}", known.join(", "))), meant: None }
                }
            });
            return false;
        };
        let below = match key.kind {
            KeyKind::TimeFunction(_) => TIME_FUNCTION,
            _ => key.path,
        };
        match &mut entry.node.value {
            Value::Array(items) if matches!(key.kind, KeyKind::Tables) => {
                items.iter_mut().for_each(|item| remove_unknown(item, below, report));
            }
            Value::Table(_) if children(below).next().is_some() || describe(&join(below, "NAME")).is_some() => {
                remove_unknown(&mut entry.node, below, report);
            }
            _ => {}
        }
        true
    });
}
