//! Joints and grains that are cut into the mesh.

use super::key;
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("mesh.joints[]", K::Tables, "", "Joints that are cut into the mesh after reading: a table of them, or a set; by one of table, angle, dip"),
    key("mesh.joints[].name", K::Text, "\"joints\"", "Mesh group of their lines (2D) or triangles (3D), for interfaces[].group; several may have the same"),
    key("mesh.joints[].within", K::Names, "all", "Mesh groups of elements in which they lie"),
    key("mesh.joints[].where", K::Condition, "", "Condition on x, y, z: where they lie"),
    key("mesh.joints[].table", K::JointRows, "", "Joints, a row each, as a list or as a CSV file, which is in the unit of the mesh and degrees: x, y, x, y of both ends of a trace (2D), or x, y, z of the centre, dip, dip direction, diameter of a disc (3D)"),
    key("mesh.joints[].angle", K::Angle, "", "2D: mean angle of the traces of a set from the x-axis, counter-clockwise"),
    key("mesh.joints[].dip", K::Angle, "", "3D: mean dip of a set, 0 to 90 deg, with z up"),
    key("mesh.joints[].dip_direction", K::Angle, "required", "3D: mean direction to which it dips, from y (north) over x (east)"),
    key("mesh.joints[].scatter", K::Angle, "\"0 deg\"", "Standard deviation of the angle of traces; of discs that of both angles of Fisher's distribution, whose kappa is 1/scatter² in radians; 0 to 45 deg"),
    key("mesh.joints[].spacing", K::Quantity(D::LENGTH), "required", "Mean distance of the lines or planes of a set across them, > 0"),
    key("mesh.joints[].spacing_scatter", K::Quantity(D::NONE), "0", "Standard deviation of the spacing over its mean, log-normal, 0 to 2"),
    key("mesh.joints[].length", K::Quantity(D::LENGTH), "required", "With persistence: mean length of traces, or diameter of discs, > 0"),
    key("mesh.joints[].length_scatter", K::Quantity(D::NONE), "0", "With persistence: standard deviation of the length over its mean, log-normal, 0 to 2"),
    key("mesh.joints[].persistence", K::Quantity(D::NONE), "through the body", "Open share of each line of a set, above 0 and below 1, or of each plane, at most 0.4; bridges of rock are between the joints"),
    key("mesh.joints[].seed", K::Integer, "1", "Seed of the random numbers of a set, ≥ 0"),
    key("mesh.grains", K::Table, "", "Grains that the mesh is divided into after reading: Voronoi cells around random seeds"),
    key("mesh.grains.size", K::Quantity(D::LENGTH), "required", "Diameter of a circle (2D) or ball (3D) as large as a mean grain, with the matrix around it, > 0"),
    key("mesh.grains.seed", K::Integer, "1", "Seed of the random numbers, ≥ 0"),
    key("mesh.grains.regularity", K::Integer, "2", "Rounds in which every seed moves to the middle of its cell, 0 to 20: the more, the more alike the grains"),
    key("mesh.grains.share", K::Quantity(D::NONE), "1", "Share of the body that the grains fill, from 0.1 to 1; the rest is a matrix around them"),
    key("mesh.grains.phases", K::NamedTables, "", "Mesh groups of grains and the share of all grains that belongs to each; without it, and with share below 1, all are the group grains"),
    key("mesh.grains.phases.NAME", K::Quantity(D::NONE), "", "Part of the grains over the sum of all parts, > 0"),
    key("mesh.grains.matrix", K::Text, "\"matrix\"", "Mesh group of the matrix"),
    key("mesh.grains.boundaries", K::Text, "\"grain-boundaries\"", "Mesh group of the boundaries of all grains, for interfaces[].group"),
    key("mesh.grains.within", K::Names, "all", "Mesh groups of elements that are divided"),
];
