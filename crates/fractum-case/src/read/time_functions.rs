//! Time functions: constants, expressions, ramps, tables, pulses.

use super::{table_file, unit};
use crate::keys::TIME_FUNCTION;
use crate::reader::presence::exactly_one;
use crate::reader::vectors::expression;
use crate::reader::{Reader, Reading, Table};
use crate::tree::{Node, Value};
use crate::unit::Dimension;
use crate::{Diagnostic, TimeFunction};

/// Takes a time function of the key's dimension.
pub(super) fn time_function<'t, 'a>(table: &'t Table<'a>, name: &'static str) -> Reading<'t, 'a, TimeFunction> {
    let dimension = table.dimension(name);
    table.read(name, |node| time_function_of(table.reader, node, dimension))
}

/// A time function of this dimension.
pub(super) fn time_function_of(reader: &Reader, node: &Node, dimension: Dimension) -> Option<TimeFunction> {
    match &node.value {
        Value::Table(_) => from_table(Table::new(reader, node, TIME_FUNCTION), dimension),
        _ => from_expression(reader, node, dimension),
    }
}

fn from_expression(reader: &Reader, node: &Node, dimension: Dimension) -> Option<TimeFunction> {
    let length = Dimension::LENGTH;
    let variables = [("t", Dimension::TIME), ("x", length), ("y", length), ("z", length)];
    let (field, kind) = expression(reader, node, dimension, &variables)?;
    reader.check_dimension(node, kind, dimension).then(|| match field.constant_value() {
        Some(value) => TimeFunction::Constant(value),
        None => TimeFunction::Expression(field),
    })
}

fn from_table(table: Table<'_>, dimension: Dimension) -> Option<TimeFunction> {
    let kind = exactly_one(&table, &["ramp", "smooth_ramp", "table", "pulse"])?;
    let function = match kind {
        "ramp" => points(&table, "ramp", dimension).map(TimeFunction::Ramp),
        "smooth_ramp" => points(&table, "smooth_ramp", dimension).map(TimeFunction::SmoothRamp),
        "table" => file(&table, dimension).map(TimeFunction::Ramp),
        _ => pulse(&table, dimension),
    };
    table.finish(&format!("with {kind}"));
    function
}

/// Pairs of time and value, times increasing.
fn points(table: &Table<'_>, name: &'static str, dimension: Dimension) -> Option<Vec<(f64, f64)>> {
    let reader = table.reader;
    let node = table.node(name)?;
    let wrong = |node: &Node, expected: &str| {
        reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
    };
    let pairs = match &node.value {
        Value::Array(pairs) if !pairs.is_empty() => pairs,
        _ => {
            wrong(node, "a list of pairs of time and value");
            return None;
        }
    };
    let read = |pair: &Node| match &pair.value {
        Value::Array(items) if items.len() == 2 => {
            let time = reader.quantity(&items[0], Dimension::TIME);
            let value = reader.quantity(&items[1], dimension);
            Some((time?, value?))
        }
        _ => {
            wrong(pair, "a pair [time, value]");
            None
        }
    };
    let points: Vec<Option<(f64, f64)>> = pairs.iter().map(read).collect();
    let mut complete = true;
    for (pair, later) in points.windows(2).zip(&pairs[1..]) {
        if let (Some((before, _)), Some((after, _))) = (pair[0], pair[1])
            && after <= before
        {
            wrong(later, &format!("a time after {before} s, that of the pair before it"));
            complete = false;
        }
    }
    points.into_iter().collect::<Option<_>>().filter(|_| complete)
}

/// A CSV file of time and value.
fn file(table: &Table<'_>, dimension: Dimension) -> Option<Vec<(f64, f64)>> {
    let time_unit = unit(table, "time_unit", Dimension::TIME).unwrap_or(table.reader.scale.of(Dimension::TIME));
    let value_unit = unit(table, "value_unit", dimension).unwrap_or(table.reader.scale.of(dimension));
    let name = table.text("table").spanned().required()?;
    let points = table_file::read(table.reader, &name)?;
    let points: Vec<_> = points.into_iter().map(|(time, value)| (time * time_unit, value * value_unit)).collect();
    if points.iter().any(|(time, value)| !time.is_finite() || !value.is_finite()) {
        let found = format!("= \"{}\" holds numbers too large for their units", name.value);
        table.reader.note(Diagnostic::error(&name.place, found));
        return None;
    }
    Some(points)
}

fn pulse(table: &Table<'_>, dimension: Dimension) -> Option<TimeFunction> {
    #[derive(Clone, Copy)]
    enum Pulse {
        Triangle,
        HalfSine,
        DoubleExponential,
        LinearExponential,
    }
    let known = [
        ("triangle", Pulse::Triangle),
        ("half-sine", Pulse::HalfSine),
        ("double-exponential", Pulse::DoubleExponential),
        ("linear-exponential", Pulse::LinearExponential),
    ];
    let pulse = table.one_of("pulse", &known).given();
    let peak = table.read("peak", |node| table.reader.quantity(node, dimension)).required();
    let start = table.quantity("start").or(0.0);
    let duration = || table.quantity("duration").positive().required();
    match pulse {
        Some(Pulse::Triangle) => {
            let duration = duration();
            let longest = duration.unwrap_or(f64::INFINITY);
            let rise = table.quantity("rise").check(|rise| (0.0..=longest).contains(rise), "from 0 to the duration");
            let rise = rise.given();
            let duration = duration?;
            Some(TimeFunction::Triangle { peak: peak?, start, duration, rise: rise.unwrap_or(0.5 * duration) })
        }
        Some(Pulse::HalfSine) => {
            let duration = duration();
            Some(TimeFunction::HalfSine { peak: peak?, start, duration: duration? })
        }
        Some(Pulse::DoubleExponential) => {
            let rise = table.quantity("rise_time").positive().required();
            let decay = table.quantity("decay_time").positive().spanned().required();
            let (peak, rise, decay) = (peak?, rise?, decay?);
            let function = TimeFunction::double_exponential(peak, rise, decay.value, start);
            if function.is_none() {
                let found = format!("is {} times the rise time", decay.value / rise);
                let note = Diagnostic::error(&decay.place, found);
                table.reader.note(note.expected("between 2.1462 and 1e6 times the rise time"));
            }
            function
        }
        Some(Pulse::LinearExponential) => {
            let rise = table.quantity("rise_time").not_negative().required();
            let decay = table.quantity("decay_time").positive().required();
            Some(TimeFunction::LinearExponential { peak: peak?, start, rise: rise?, decay: decay? })
        }
        None => {
            table.pass_over(&["duration", "rise", "rise_time", "decay_time"]);
            None
        }
    }
}
