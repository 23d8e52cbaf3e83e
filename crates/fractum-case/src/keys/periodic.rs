//! `[periodic]`.

use super::key;
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::unit::Dimension as D;

#[rustfmt::skip] // one key per line reads as a table
pub(super) static KEYS: &[KeyDoc] = &[
    key("periodic", K::Table, "", "A box that repeats in space: loose particles meet through its sides, or one bonded body goes on through them. Explicit runs; beside loose particles also rigid planes across the axes that do not repeat"),
    key("periodic.point", K::Point(D::LENGTH), "[0, 0, 0]", "Corner of the box with the smallest coordinates"),
    key("periodic.size", K::Point(D::LENGTH), "required", "Edges of the box along x, y and z, > 0. Edges along which it repeats must be longer than 2.2 diameters of the largest particle; beside a bonded body than two of its bonds, and than 5 mean diameters where particles are packed"),
    key("periodic.axes", K::Names, "[\"x\", \"y\", \"z\"]", "Axes along which the box repeats, all of them beside a bonded body; along the others it only has the volume that stress and solid fraction are related to"),
    key("periodic.strain_rate", K::Table, "", "Rates at which the box deforms: gradient of velocity of its present shape. xx + yy + zz = 0 keeps its volume; a constant xx changes the length along x by e in 1/xx. Particles start with the mean flow of the box, beside the initial_velocity of their bodies"),
    key("periodic.strain_rate.xx", K::TimeFunction(D::RATE), "", "∂v_x/∂x: stretch along x; negative is compression"),
    key("periodic.strain_rate.yy", K::TimeFunction(D::RATE), "", "∂v_y/∂y: stretch along y"),
    key("periodic.strain_rate.zz", K::TimeFunction(D::RATE), "", "∂v_z/∂z: stretch along z"),
    key("periodic.strain_rate.xy", K::TimeFunction(D::RATE), "", "∂v_x/∂y: simple shear, in which the sides across y move along x"),
    key("periodic.strain_rate.yz", K::TimeFunction(D::RATE), "", "∂v_y/∂z: simple shear, in which the sides across z move along y"),
    key("periodic.strain_rate.xz", K::TimeFunction(D::RATE), "", "∂v_x/∂z: simple shear, in which the sides across z move along x"),
    key("periodic.servo", K::Table, "", "Normal stresses that the box holds: its lengths change so that each stress becomes the one that is asked for"),
    key("periodic.servo.stress", K::Table, "required", "The stresses, tension positive; axes that it does not name keep to strain_rate"),
    key("periodic.servo.stress.xx", K::TimeFunction(D::PRESSURE), "", "Stress along x"),
    key("periodic.servo.stress.yy", K::TimeFunction(D::PRESSURE), "", "Stress along y"),
    key("periodic.servo.stress.zz", K::TimeFunction(D::PRESSURE), "", "Stress along z"),
    key("periodic.servo.rate", K::Quantity(D::RATE), "required", "Largest rate of the lengths, > 0"),
    key("periodic.servo.slows_at", K::Quantity(D::NONE), "0.1", "Share of the stress that is missing where the servo begins to slow down, above 0 and at most 1"),
];
