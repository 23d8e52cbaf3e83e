//! Probes: what all have, and expressions. What probes measure has its keys in [`crate::measure`].

use super::key;
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::unit::Dimension as D;

/// Before the keys of what is measured.
#[rustfmt::skip] // a table reads best with one row per line
pub(super) static FIRST: &[KeyDoc] = &[
    key("probes[]", K::Tables, "", "Numbers to record; one quantity each"),
    key("probes[].name", K::Text, "required", "Name, unique among probes: letters, digits, underscores"),
    key("probes[].every", K::Quantity(D::TIME), "every row", "Time from one measurement to the next, in static runs as part of the load. The first row of each interval and the last row of the run measure, and rows between repeat the value. Use it for fragments, cracks and damage, which cost more than the rest of a row. Not with expression, which costs nothing"),
];

/// After them.
#[rustfmt::skip]
pub(super) static LAST: &[KeyDoc] = &[
    key("probes[].expression", K::ProbeExpression, "", "Expression of t and probes above it; max, min, absmax, mean, final, time_of_max, front_speed (of a probe) and at(probe, time) make it one number at the end of the run; slope(probe, time) is its slope over the rows of that last time"),
    key("probes[].unit", K::Unit(None), "from the expression", "Expression only: its SI unit; required if a factor without unit leaves it open"),
];
