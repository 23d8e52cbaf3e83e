//! Supports, loads, time functions.

use super::key;
use crate::case::key_kind::{KeyDoc, KeyKind as K};
use crate::case::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("supports[]", K::Tables, "", "Prescribed motion of groups; one of fix, velocity, displacement per axis"),
    key("supports[].name", K::Text, "", "Name, unique among supports"),
    key("supports[].group", K::Text, "", "Mesh group of the nodes, or set of particles; required without `where`"),
    key("supports[].stages", K::Names, "all", "Stages in which it acts"),
    key("supports[].where", K::Condition, "", "Which of them, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("supports[].fix", K::Text, "", "Axes held at rest: any of x, y, z, such as \"xy\""),
    key("supports[].fix_rotation", K::Text, "", "Sets of particles only: axes about which they do not turn, such as \"xyz\""),
    key("supports[].velocity", K::Table, "", "Velocity, by components"),
    key("supports[].velocity.x", K::TimeFunction(D::VELOCITY), "", "Along x; absent leaves it free"),
    key("supports[].velocity.y", K::TimeFunction(D::VELOCITY), "", "Along y; absent leaves it free"),
    key("supports[].velocity.z", K::TimeFunction(D::VELOCITY), "", "Along z; absent leaves it free"),
    key("supports[].displacement", K::Table, "", "Displacement from the initial position, by components"),
    key("supports[].displacement.x", K::TimeFunction(D::LENGTH), "", "Along x; absent leaves it free"),
    key("supports[].displacement.y", K::TimeFunction(D::LENGTH), "", "Along y; absent leaves it free"),
    key("supports[].displacement.z", K::TimeFunction(D::LENGTH), "", "Along z; absent leaves it free"),
    key("loads[]", K::Tables, "", "Loads; one of force, traction, pressure, gravity each"),
    key("loads[].name", K::Text, "", "Name, unique among loads"),
    key("loads[].stages", K::Names, "all", "Stages in which it acts"),
    key("loads[].group", K::Text, "", "Mesh group or set of particles; required without `where`, but for gravity, which acts on the whole scene"),
    key("loads[].where", K::Condition, "", "Which nodes or particles, by their positions at the start, and which facets, by all of their nodes; without `group`: which of all solid bodies"),
    key("loads[].force", K::Table, "", "Total force over the group, by components; particles share it by their cross-sections"),
    key("loads[].force.x", K::TimeFunction(D::FORCE), "0", "Component along x"),
    key("loads[].force.y", K::TimeFunction(D::FORCE), "0", "Component along y"),
    key("loads[].force.z", K::TimeFunction(D::FORCE), "0", "Component along z"),
    key("loads[].traction", K::Table, "", "Force per area over the group's facets, by components"),
    key("loads[].traction.x", K::TimeFunction(D::PRESSURE), "0", "Component along x"),
    key("loads[].traction.y", K::TimeFunction(D::PRESSURE), "0", "Component along y"),
    key("loads[].traction.z", K::TimeFunction(D::PRESSURE), "0", "Component along z"),
    key("loads[].pressure", K::TimeFunction(D::PRESSURE), "", "Pressure that follows the group's facets; positive pushes into the solid"),
    key("loads[].in_cracks", K::Flag, "false", "Pressure only: whether it acts in the cracks that are open to these facets too: removed elements that share facets with them or with one another"),
    key("loads[].front_speed", K::Quantity(D::VELOCITY), "", "With in_cracks: speed at which the pressure advances into the cracks, > 0; a crack carries the pressure of the facets once the front has come; absent means at once"),
    key("loads[].gravity", K::Table, "", "Acceleration of the whole scene, by components"),
    key("loads[].gravity.x", K::TimeFunction(D::ACCELERATION), "0", "Component along x"),
    key("loads[].gravity.y", K::TimeFunction(D::ACCELERATION), "0", "Component along y"),
    key("loads[].gravity.z", K::TimeFunction(D::ACCELERATION), "0", "Component along z"),
    key("TIME_FUNCTION", K::Table, "", "Table form of any time function: one of ramp, smooth_ramp, table, pulse"),
    key("TIME_FUNCTION.ramp", K::Points, "", "Pairs of time and value joined by straight lines, constant outside"),
    key("TIME_FUNCTION.smooth_ramp", K::Points, "", "Pairs of time and value joined by quintic steps, smooth to the second derivative"),
    key("TIME_FUNCTION.table", K::Text, "", "CSV file of two columns, time and value, relative to the case file; joined by straight lines"),
    key("TIME_FUNCTION.time_unit", K::Unit(Some(D::TIME)), "\"s\"", "Table only: unit of the first column"),
    key("TIME_FUNCTION.value_unit", K::Unit(None), "SI", "Table only: unit of the second column"),
    key("TIME_FUNCTION.pulse", K::Choice(pulses), "", "A pulse by name"),
    key("TIME_FUNCTION.peak", K::AnyQuantity, "", "Pulse, required there: largest value"),
    key("TIME_FUNCTION.start", K::Quantity(D::TIME), "\"0 s\"", "Pulse: its begin; zero before"),
    key("TIME_FUNCTION.duration", K::Quantity(D::TIME), "", "Triangle and half-sine, required there: time from begin to end, > 0"),
    key("TIME_FUNCTION.rise", K::Quantity(D::TIME), "half the duration", "Triangle only: time from begin to peak, 0 to duration"),
    key("TIME_FUNCTION.rise_time", K::Quantity(D::TIME), "", "Double-exponential, required there: time from begin to peak, > 0"),
    key("TIME_FUNCTION.decay_time", K::Quantity(D::TIME), "", "Double-exponential, required there: time from the peak to 1/e of it, above 2.1462 rise_time"),
];

fn pulses() -> Vec<&'static str> {
    vec!["triangle", "half-sine", "double-exponential"]
}
