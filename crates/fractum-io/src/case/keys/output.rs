//! Results and references.

use super::{key, names};
use crate::case::key_kind::{KeyDoc, KeyKind as K};
use crate::case::model::Scaling;
use crate::case::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("output", K::Table, "", "What is written, and how often"),
    key("output.fields", K::Table, "", "Fields for ParaView"),
    key("output.fields.every", K::Quantity(D::TIME), "1/50 of the run", "Time between fields, > 0; on a path of equilibria the way of the load factor, forth and back, and there are further ones as damage grows"),
    key("output.fields.principal", K::Flag, "false", "Write the three principal stresses of elements, each with its direction"),
    key("output.fields.strain", K::Flag, "false", "Write the strain of elements"),
    key("output.fields.reaction", K::Flag, "false", "Write the forces of supports on nodes"),
    key("output.fields.fragment", K::Flag, "false", "Write the number of the fragment that each node belongs to, as in fragments.csv; 0 for single nodes"),
    key("output.history", K::Table, "", "Rows of history.csv"),
    key("output.history.every", K::Quantity(D::TIME), "1/1000 of the run", "Time between rows, > 0"),
    key("output.checkpoint", K::Table, "", "Checkpoints to resume from"),
    key("output.checkpoint.every", K::Quantity(D::TIME), "\"10 min\"", "Wall time between checkpoints, > 0"),
    key("output.fragments", K::Table, "", "What counts as a fragment"),
    key("output.fragments.joined_below", K::Quantity(D::NONE), "0.95", "Edges join a fragment while the share of their strength that they have lost is below this, within 0 and 1"),
    key("output.ppv[]", K::Tables, "", "Peak particle velocity of solids against scaled distance from a hole: ppv.csv, summary.json, a figure with its power law in the report"),
    key("output.ppv[].name", K::Text, "required", "Name of the stations in tables and figures"),
    key("output.ppv[].hole", K::Text, "required", "Mesh group of the wall of the hole"),
    key("output.ppv[].centre", K::Point(D::LENGTH), "", "Centre of the hole, or a point of its axis; absent means the mean place of the group's nodes, which is right where all of the wall is in the mesh"),
    key("output.ppv[].axis", K::Direction, "", "Axis of the hole, from which distances count; absent means z in the plane, and in space distances from the centre"),
    key("output.ppv[].charge", K::Quantity(D::MASS), "", "Mass of the charge Q, > 0; absent means that distances are in radii of the hole"),
    key("output.ppv[].scaling", K::Choice(names::<Scaling>), "\"square-root\"", "With charge: distance over the square root of Q, for long charges, or over the cube root"),
    key("output.ppv[].line", K::Table, "", "Stations evenly apart on a straight line: the nodes of solids that are nearest to them"),
    key("output.ppv[].line.from", K::Point(D::LENGTH), "required", "The first"),
    key("output.ppv[].line.to", K::Point(D::LENGTH), "required", "The last"),
    key("output.ppv[].line.stations", K::Integer, "required", "Their number, 1 to 10000"),
    key("output.ppv[].groups", K::Names, "[]", "Mesh groups, each of which is a station: the mean over its nodes"),
    key("expect[]", K::Tables, "", "Reference values for `fractum verify`: value and tolerance, or above and below"),
    key("expect[].quantity", K::Text, "required", "A probe, or a path into summary.json such as energy.residual_max_relative"),
    key("expect[].value", K::AnyQuantity, "", "Reference value"),
    key("expect[].tolerance", K::AnyQuantity, "", "Required with value: \"5 %\" of it, or a difference in its unit"),
    key("expect[].above", K::AnyQuantity, "", "Lower limit, instead of value"),
    key("expect[].below", K::AnyQuantity, "", "Upper limit, instead of value"),
    key("expect[].source", K::Text, "required", "Where the reference comes from"),
    key("expect[].note", K::Text, "", "Remark"),
    key("verify", K::Table, "", "How `fractum verify` takes this case"),
    key("verify.quick", K::Flag, "false", "Run with --quick too"),
];
