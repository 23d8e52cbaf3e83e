//! `[[expect]]`.

use fractum_output::expectation::Bound;

use super::probes::{ReadProbe, ReadProbes};
use super::verify;
use crate::model::{Expect, summary_quantities};
use crate::reader::Table;
use crate::tree::Value;
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned, nearest};

/// Reads all reference values; nothing where one of them is wrong.
pub(super) fn read(root: &Table<'_>, probes: &ReadProbes) -> Option<Vec<Expect>> {
    let tables = root.tables("expect");
    let expects: Vec<_> = tables.into_iter().map(|table| expect(table, probes)).collect();
    expects.into_iter().collect()
}

fn expect(table: Table<'_>, probes: &ReadProbes) -> Option<Expect> {
    let quantity = table.text("quantity").spanned().required();
    let found = quantity.as_ref().map(|quantity| find(&table, quantity, probes));
    // Where the quantity is wrong, its values are taken without a look at their dimension.
    let dimension = match found {
        Some(Found::Dimension(dimension)) => Some(dimension),
        _ => None,
    };
    let source = table.text("source").required();
    let note = table.text("note").or(String::new());
    let bound = bound(&table, dimension);
    let promise = verify::promise(&table);
    table.finish("here");
    Some(Expect { quantity: quantity?, unit: dimension?.symbol(), bound: bound?, source: source?, note, promise })
}

enum Found {
    Dimension(Dimension),
    Wrong,
}

/// Dimension of the value a quantity names; notes a name that does not exist.
fn find(table: &Table<'_>, quantity: &Spanned<String>, probes: &ReadProbes) -> Found {
    let of_probe = |probe: &ReadProbe| probe.dimension.map_or(Found::Wrong, Found::Dimension);
    let name = quantity.value.as_str();
    if let Some(probe) = probes.find(name) {
        return of_probe(probe);
    }
    if let Some((_, dimension)) = summary_quantities().find(|(path, _)| path == name) {
        return Found::Dimension(dimension);
    }
    if let Some((probe, field)) = name.strip_prefix("probes.").and_then(|rest| rest.rsplit_once('.'))
        && let Some(probe) = probes.find(probe)
    {
        match field {
            "final" => return of_probe(probe),
            "max" | "min" if !probe.scalar => return of_probe(probe),
            "time_of_max" if !probe.scalar => return Found::Dimension(Dimension::TIME),
            _ => {}
        }
    }
    let note =
        Diagnostic::error(&quantity.place, format!("= \"{name}\" is neither a probe nor a path of summary.json"));
    if table.reader.has_many_mistakes() {
        table.reader.note(note);
        return Found::Wrong;
    }
    let paths = probes.list.iter().filter(|probe| !probe.name.is_empty()).flat_map(|probe| {
        let fields: &[&str] = if probe.scalar { &["final"] } else { &["final", "max", "min", "time_of_max"] };
        let paths = fields.iter().map(|field| format!("probes.{}.{field}", probe.name));
        std::iter::once(probe.name.clone()).chain(paths)
    });
    let known: Vec<String> = paths.chain(summary_quantities().map(|(path, _)| path)).collect();
    table.reader.note(match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
        None => note,
    });
    Found::Wrong
}

fn bound(table: &Table<'_>, dimension: Option<Dimension>) -> Option<Bound> {
    let reader = table.reader;
    let quantity = |name: &'static str| {
        table.read(name, |node| match dimension {
            Some(dimension) => reader.quantity(node, dimension),
            None => reader.constant(node, "a quantity such as \"21 GPa\"").map(|(value, _)| value),
        })
    };
    if !table.has("value") {
        table.refuse("tolerance", "without a value");
        let (above, below) = (quantity("above"), quantity("below"));
        if !table.has("above") && !table.has("below") {
            let note = Diagnostic::error(&table.place, "has neither value nor limits");
            reader.note(note.expected("value and tolerance, or above or below"));
            return None;
        }
        let above = above.given();
        let below = below.check(|below| above.is_none_or(|above| *below > above), "more than above").given();
        let complete = table.has("above") == above.is_some() && table.has("below") == below.is_some();
        return complete.then_some(Bound::Between { above, below });
    }
    table.refuse("above", "beside a value");
    table.refuse("below", "beside a value");
    let value = quantity("value").required();
    let relative = match table.peek("tolerance").map(|node| &node.value) {
        Some(Value::Text(text)) => text.trim_end().ends_with('%'),
        _ => false,
    };
    let tolerance = if relative {
        table.read("tolerance", |node| reader.quantity(node, Dimension::NONE))
    } else {
        quantity("tolerance")
    };
    let tolerance = tolerance.positive();
    let tolerance =
        tolerance.check(|_| !relative || value != Some(0.0), "a difference, since the value is 0").required();
    let (value, tolerance) = (value?, tolerance?);
    Some(if relative {
        Bound::Near { value, tolerance: tolerance * value.abs(), relative: Some(tolerance) }
    } else {
        Bound::Near { value, tolerance, relative: None }
    })
}
