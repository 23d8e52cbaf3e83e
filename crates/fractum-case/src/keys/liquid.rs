//! `[liquid]`.

use super::key;
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::unit::Dimension as D;

#[rustfmt::skip] // one key per line reads as a table
pub(super) static KEYS: &[KeyDoc] = &[
    key("liquid", K::Table, "", "Liquid that is put into interfaces and drives them open, in static runs"),
    key("liquid.interfaces", K::Names, "all of them", "Names of the interfaces that it flows in"),
    key("liquid.viscosity", K::Quantity(D::VISCOSITY), "required", "Dynamic viscosity, > 0"),
    key("liquid.wall_roughness", K::Quantity(D::LENGTH), "\"0 m\"", "Height of the asperities of the walls, ≥ 0; 0 is the cubic law"),
    key("liquid.aperture", K::Quantity(D::LENGTH), "\"0 m\"", "Aperture of the interfaces under the in-situ stress and the loads at t = 0, ≥ 0. Above 0 liquid flows along interfaces that have not begun to break, too"),
    key("liquid.compressibility", K::Quantity(D::COMPRESSIBILITY), "\"0 1/Pa\"", "Change of volume over volume and pressure, ≥ 0"),
    key("liquid.leak_off", K::Quantity(D::LEAK_OFF), "\"0 m/s^0.5\"", "Carter's coefficient C of one wall, ≥ 0: it takes the volume 2 C √t per area in the time t since liquid came"),
    key("liquid.injections[]", K::Tables, "", "Places at which it is put in, each by one of rate, pressure; at least one"),
    key("liquid.injections[].group", K::Text, "", "Mesh group whose nodes on the interfaces are the place. Required without `where`"),
    key("liquid.injections[].where", K::Condition, "", "Which nodes, by their position at the start"),
    key("liquid.injections[].rate", K::TimeFunction(D::VOLUME_RATE), "", "Volume per time. In 2D it is that of the whole thickness, at planes of symmetry that on this side"),
    key("liquid.injections[].pressure", K::TimeFunction(D::PRESSURE), "", "Pressure there"),
];
