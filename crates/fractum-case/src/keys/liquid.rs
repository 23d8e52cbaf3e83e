//! `[liquid]`.

use super::key;
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::unit::Dimension as D;

#[rustfmt::skip] // one key per line reads as a table
pub(super) static KEYS: &[KeyDoc] = &[
    key("liquid", K::Table, "", "Liquid that is put into interfaces and drives them open, or into holes, in static runs"),
    key("liquid.interfaces", K::Names, "all of them", "Names of the interfaces that it flows in"),
    key("liquid.viscosity", K::Quantity(D::VISCOSITY), "required", "Dynamic viscosity, > 0"),
    key("liquid.wall_roughness", K::Quantity(D::LENGTH), "\"0 m\"", "Height of the asperities of the walls, ≥ 0; 0 is the cubic law"),
    key("liquid.aperture", K::Quantity(D::LENGTH), "\"0 m\"", "Aperture of the interfaces under the in-situ stress and the loads at t = 0, ≥ 0. Above 0 liquid flows along interfaces that have not begun to break, too"),
    key("liquid.compressibility", K::Quantity(D::COMPRESSIBILITY), "\"0 1/Pa\"", "Change of volume over volume and pressure, ≥ 0"),
    key("liquid.leak_off", K::Quantity(D::LEAK_OFF), "\"0 m/s^0.5\"", "Carter's coefficient C of one wall, ≥ 0: it takes the volume 2 C √t per area in the time t since liquid came"),
    key("liquid.symmetry", K::Table, "", "Planes of symmetry at which the model ends: holes may end there, and their liquid is the share on this side; supports hold the solid there"),
    key("liquid.symmetry.x", K::Quantity(D::LENGTH), "", "Position of the plane across x"),
    key("liquid.symmetry.y", K::Quantity(D::LENGTH), "", "Position of the plane across y"),
    key("liquid.symmetry.z", K::Quantity(D::LENGTH), "", "Position of the plane across z"),
    key("liquid.holes[]", K::Tables, "", "Holes that hold it, full at the start, each fed by one of rate, pressure, or by interfaces alone"),
    key("liquid.holes[].group", K::Text, "", "Mesh group of the facets around the hole: a closed surface, in 2D a closed line. Interfaces that meet it leave it closed. Required without `where`"),
    key("liquid.holes[].where", K::Condition, "", "Which facets, by all of their nodes at the start"),
    key("liquid.holes[].stemmed", K::Flag, "false", "3D only: true closes flat open ends of the hole by packers that do not move"),
    key("liquid.holes[].sealed", K::Flag, "false", "true: interfaces take no liquid from it, as behind a sleeve or a jacket; it presses on its wall alone"),
    key("liquid.holes[].storage", K::Quantity(D::STORAGE), "\"0 m^3/Pa\"", "Volume that lines and pump beside the hole take per pressure, ≥ 0. In 2D it is that of the whole thickness, at planes of symmetry that on this side"),
    key("liquid.holes[].rate", K::TimeFunction(D::VOLUME_RATE), "", "Volume per time that is put in, shared likewise"),
    key("liquid.holes[].pressure", K::TimeFunction(D::PRESSURE), "", "Pressure in it"),
    key("liquid.injections[]", K::Tables, "", "Places in interfaces at which it is put in, each by one of rate, pressure. One at least without holes[].rate and holes[].pressure"),
    key("liquid.injections[].group", K::Text, "", "Mesh group whose nodes on the interfaces are the place. Required without `where`"),
    key("liquid.injections[].where", K::Condition, "", "Which nodes, by their position at the start"),
    key("liquid.injections[].rate", K::TimeFunction(D::VOLUME_RATE), "", "Volume per time. In 2D it is that of the whole thickness, at planes of symmetry that on this side"),
    key("liquid.injections[].pressure", K::TimeFunction(D::PRESSURE), "", "Pressure there"),
];
