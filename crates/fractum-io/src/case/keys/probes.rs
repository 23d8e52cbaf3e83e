//! Probes.

use fractum_scene::{CountKind, CrackMeasure, EnergyProbe};

use super::{key, names};
use crate::case::key_kind::{KeyDoc, KeyKind as K};
use crate::case::model::StressComponent;
use crate::case::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("probes[]", K::Tables, "", "Numbers to record; one quantity each"),
    key("probes[].name", K::Text, "required", "Name, unique among probes: letters, digits, underscores"),
    key("probes[].reaction", K::Table, "", "Sum of the support reactions on a group, or force of a rigid body on particles, in N"),
    key("probes[].reaction.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
    key("probes[].reaction.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("probes[].reaction.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
    key("probes[].reaction.about", K::Table, "", "radial and tangential only: the axis"),
    key("probes[].reaction.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].reaction.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].displacement", K::Table, "", "Mean displacement of a group's nodes or particles, in m"),
    key("probes[].displacement.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
    key("probes[].displacement.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("probes[].displacement.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
    key("probes[].displacement.about", K::Table, "", "radial and tangential only: the axis"),
    key("probes[].displacement.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].displacement.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].velocity", K::Table, "", "Mean velocity of a group's nodes or particles, in m/s"),
    key("probes[].velocity.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
    key("probes[].velocity.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
    key("probes[].velocity.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
    key("probes[].velocity.about", K::Table, "", "radial and tangential only: the axis"),
    key("probes[].velocity.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].velocity.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].rotation", K::Table, "", "Rotation of a set of particles as a whole about an axis through its centre, for small angles, in rad"),
    key("probes[].rotation.group", K::Text, "", "Set of particles; required"),
    key("probes[].rotation.where", K::Condition, "", "Which of its particles, by their positions at the start"),
    key("probes[].rotation.along", K::Direction, "required", "Direction of the axis"),
    key("probes[].stress", K::Table, "", "Volume mean of a stress component, in Pa"),
    key("probes[].stress.group", K::Text, "required", "Mesh group of elements"),
    key("probes[].stress.component", K::Choice(names::<StressComponent>), "required", "Component; tension is positive"),
    key("probes[].stress.about", K::Table, "", "radial, tangential and radial_tangential only: the axis"),
    key("probes[].stress.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
    key("probes[].stress.about.axis", K::Direction, "\"z\"", "Its direction"),
    key("probes[].energy", K::Choice(names::<EnergyProbe>), "", "An entry of the energy ledger, in J"),
    key("probes[].count", K::Choice(names::<CountKind>), "", "A count"),
    key("probes[].momentum", K::Table, "", "Linear momentum of the scene, in kg m/s"),
    key("probes[].momentum.along", K::Direction, "required", "Direction"),
    key("probes[].angular_momentum", K::Table, "", "Angular momentum of the scene about the origin, in kg m^2/s"),
    key("probes[].angular_momentum.along", K::Direction, "required", "Direction"),
    key("probes[].crack_area", K::Flag, "", "true records the area of the cracks, in m^2"),
    key("probes[].crack", K::Table, "", "How a crack lies: its edges that have lost half of their strength, and its broken bonds; not a number before there are any"),
    key("probes[].crack.measure", K::Choice(names::<CrackMeasure>), "required", "Angle between the direction and the plane of the crack (its line in 2D), in rad; or position of its centre or its foremost edge or bond along the direction, in m; or the angle of the helix to its axis, or of the cone's flank to the plane across its axis, in rad; or the part of the crack that lies on that cone"),
    key("probes[].crack.along", K::Direction, "required", "Direction"),
    key("probes[].crack.point", K::Point(D::LENGTH), "[0, 0, 0]", "helix, cone and cone_share only: a point of the axis; for a cone the one in the surface, with the direction out of it"),
    key("probes[].crack.where", K::Condition, "", "Which edges and bonds count, by their middles; absent means all"),
    key("probes[].expression", K::ProbeExpression, "", "Expression of t and probes above it; max, min, absmax, mean, final, time_of_max, front_speed (of a probe) and at(probe, time) make it one number at the end of the run"),
    key("probes[].unit", K::Unit(None), "from the expression", "Expression only: its SI unit; required where a factor without unit leaves it open"),
];
