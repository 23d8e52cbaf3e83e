//! Results and references.

use super::{key, names};
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::model::{PlotScale, Scaling};
use crate::unit::Dimension as D;

/// Before the keys of the fields.
#[rustfmt::skip] // a table reads best with one row per line
pub(super) static FIRST: &[KeyDoc] = &[
    key("output", K::Table, "", "Results: what is written, and how often"),
    key("output.fields", K::Table, "", "Fields for ParaView"),
    key("output.fields.every", K::Quantity(D::TIME), "1/50 of the run", "Time between frames, > 0. With several stages the default is 1/50 of those in motion, and of each at rest. A static run writes a frame each time the load factor has changed by it, up or down, and further ones as damage grows"),
];

/// After them.
#[rustfmt::skip]
pub(super) static LAST: &[KeyDoc] = &[
    key("output.fields.pieces", K::Quantity(D::NONE), "1", "Files that solids and particles of a frame are cut into, 1 to 4096. Beyond 1 a .pvtu or .pvtp lists them, and several processes share the work of writing them"),
    key("output.movie", K::Flag, "false", "Write an animated picture of all frames as the run ends, as `fractum movie` does: movie.png, which the report shows too"),
    key("output.history", K::Table, "", "Rows of history.csv"),
    key("output.history.every", K::Quantity(D::TIME), "1/1000 of the run", "Time between rows, > 0. With several stages the default is 1/1000 of those in motion; every state at rest is a row"),
    key("output.checkpoint", K::Table, "", "Checkpoints to resume from"),
    key("output.checkpoint.every", K::Quantity(D::TIME), "\"10 min\"", "Wall-clock time between checkpoints, > 0"),
    key("output.checkpoint.steps", K::Integer, "", "Steps after each of which a checkpoint is saved as well, >= 1: places that do not depend on the clock"),
    key("output.fragments", K::Table, "", "Definition of a fragment"),
    key("output.fragments.joined_below", K::Quantity(D::NONE), "0.95", "Edges join a fragment while the share of their strength that they have lost is below this, within 0 and 1"),
    key("output.ppv[]", K::Tables, "", "Peak particle velocity of solids against scaled distance from a hole: ppv.csv, summary.json, a figure with its power law in the report"),
    key("output.ppv[].name", K::Text, "required", "Name of the stations in tables and figures"),
    key("output.ppv[].hole", K::Text, "required", "Mesh group of the wall of the hole"),
    key("output.ppv[].centre", K::Point(D::LENGTH), "", "Centre of the hole, or a point of its axis. Absent means the mean position of the group's nodes, which is right if the whole wall is in the mesh"),
    key("output.ppv[].axis", K::Direction, "", "Axis of the hole, from which distances count. Absent means z in 2D, and in 3D distances from the centre"),
    key("output.ppv[].charge", K::Quantity(D::MASS), "", "Mass of the charge Q, > 0; absent means that distances are in radii of the hole"),
    key("output.ppv[].scaling", K::Choice(names::<Scaling>), "\"square-root\"", "With charge: distance over the square root of Q, for long charges, or over the cube root"),
    key("output.ppv[].line", K::Table, "", "Stations evenly apart on a straight line: the nodes of solids that are nearest to them"),
    key("output.ppv[].line.from", K::Point(D::LENGTH), "required", "The first"),
    key("output.ppv[].line.to", K::Point(D::LENGTH), "required", "The last"),
    key("output.ppv[].line.stations", K::Integer, "required", "Their number, 1 to 10000"),
    key("output.ppv[].groups", K::Names, "[]", "Mesh groups, each of which is a station: the node that moves fastest, at its own place"),
    key("output.gauges[]", K::Tables, "", "Displacement and strain on a grid of points, as image correlation finds them: a file gauges/NAME-NNNNN.csv per frame"),
    key("output.gauges[].name", K::Text, "required", "Name of its files: letters, digits, underscores and hyphens"),
    key("output.gauges[].group", K::Text, "", "Mesh group or set of particles; required without `where`"),
    key("output.gauges[].where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("output.gauges[].from", K::Point(D::LENGTH), "required", "A corner of the grid, whose sides lie along the axes"),
    key("output.gauges[].to", K::Point(D::LENGTH), "required", "The opposite corner; with the same x, y or z for a surface or a line"),
    key("output.gauges[].spacing", K::Quantity(D::LENGTH), "required", "Largest distance of its points along a side, > 0. They divide it evenly, and are at most 10000"),
    key("output.gauges[].length", K::Quantity(D::LENGTH), "required", "Gauge length, > 0: diameter of the sphere around a point to whose nodes or particles the field is fitted. Points whose nodes or particles span no plane are left out"),
    key("plots[]", K::Tables, "", "Charts of your own in the report"),
    key("plots[].title", K::Text, "from the names", "Title of the chart"),
    key("plots[].x", K::Text, "required", "Horizontal axis: a probe, or a column of history.csv such as time"),
    key("plots[].y", K::Names, "required", "Vertical axis: probes and columns of history.csv, of one dimension; a probe that is one number is a dashed line"),
    key("plots[].x_label", K::Text, "from the name", "Label of the horizontal axis; its unit is added"),
    key("plots[].y_label", K::Text, "from the names", "Label of the vertical axis; its unit is added"),
    key("plots[].scale", K::Choice(names::<PlotScale>), "\"linear\"", "Which axes are logarithmic; a logarithmic axis leaves out values that are not above zero"),
    key("plots[].reference", K::Table, "", "Points to compare with, such as a measurement, from a CSV file"),
    key("plots[].reference.file", K::Text, "required", "CSV file, relative to the case file: rows of columns. A first row of words and comments after # are skipped"),
    key("plots[].reference.x", K::Integer, "0", "Its column for the horizontal axis, counted from 0"),
    key("plots[].reference.y", K::Integer, "1", "Its column for the vertical axis, counted from 0"),
    key("plots[].reference.x_unit", K::Unit(None), "SI", "Unit of the first, such as \"mm\""),
    key("plots[].reference.y_unit", K::Unit(None), "SI", "Unit of the second, such as \"kN\""),
    key("plots[].reference.name", K::Text, "\"reference\"", "Name in the legend"),
    key("expect[]", K::Tables, "", "Reference values for `fractum verify`: value and tolerance, or above and below"),
    key("expect[].quantity", K::Text, "required", "A probe, or a path into summary.json such as energy.residual_max_relative"),
    key("expect[].value", K::AnyQuantity, "", "Reference value"),
    key("expect[].tolerance", K::AnyQuantity, "", "Required with value: \"5 %\" of it, or a difference in its unit"),
    key("expect[].above", K::AnyQuantity, "", "Lower limit, instead of value"),
    key("expect[].below", K::AnyQuantity, "", "Upper limit, instead of value"),
    key("expect[].source", K::Text, "required", "Where the reference comes from"),
    key("expect[].note", K::Text, "", "Remark"),
    key("expect[].holds_for", K::Names, "verify.holds_for", "Neighbours of the case for which the reference holds too: names or kinds, as in verify.holds_for"),
    key("expect[].excepted", K::Names, "verify.excepted", "Neighbours for which it does not hold, each with the reason: \"seed: one packing of 200 particles\""),
    key("verify", K::Table, "", "Treatment of this case by `fractum verify`"),
    key("verify.quick", K::Flag, "false", "Run with --quick too"),
    key("verify.holds_for", K::Names, "", "Neighbours for which all references hold: seed, poisson_ratio, safety, mesh, half, coordination, size, the same with a value (\"poisson_ratio 0.3\"), or names of verify.neighbours"),
    key("verify.excepted", K::Names, "[]", "Neighbours for which no reference holds, each with the reason"),
    key("verify.neighbours[]", K::Tables, "", "Neighbours of your own"),
    key("verify.neighbours[].name", K::Text, "required", "Name of the neighbour"),
    key("verify.neighbours[].set", K::Names, "required", "Differences from the case, as --set takes them: \"mesh.file=fine.msh\""),
    key("verify.scale", K::Quantity(D::NONE), "1", "The whole case larger by this factor, > 0: lengths and times by it, forces by its square, masses and energies by its cube. Stresses, velocities and densities stay, and so must all ratios"),
];
