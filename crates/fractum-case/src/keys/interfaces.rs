//! Interfaces between elements.

use super::key;
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("interfaces[]", K::Tables, "", "Inner faces of solids along which nodes are doubled, with a strength of their own; by one of group, between"),
    key("interfaces[].name", K::Text, "interface-N", "Name, unique among interfaces"),
    key("interfaces[].group", K::Text, "", "Mesh group of faces inside of solids: lines of 2D meshes, triangles of 3D meshes"),
    key("interfaces[].between", K::Names, "", "Mesh groups of elements, two at least: the faces that any two of them have in common"),
    key("interfaces[].bonded", K::Flag, "true", "false: its sides were never joined; they bear pressure and friction alone"),
    key("interfaces[].tensile_strength", K::Quantity(D::PRESSURE), "required", "Traction at which it opens, > 0"),
    key("interfaces[].cohesion", K::Quantity(D::PRESSURE), "tensile_strength", "Traction at which it slides without pressure, > 0"),
    key("interfaces[].fracture_energy", K::Quantity(D::FRACTURE_ENERGY), "required", "Energy per area that opens it, G_I, > 0"),
    key("interfaces[].shear_fracture_energy", K::Quantity(D::FRACTURE_ENERGY), "fracture_energy", "Energy per area that breaks it by sliding, without friction, G_II, > 0"),
    key("interfaces[].mixed_mode", K::Choice(mixed_modes), "\"power\"", "How opening and sliding share the energy: power is (G_1/G_I)^a + (G_2/G_II)^a = 1, benzeggagh-kenane is G_I + (G_II - G_I) B^a with the share B of sliding"),
    key("interfaces[].mixed_mode_exponent", K::Quantity(D::NONE), "1", "The exponent a: 1 to 4. An ellipse has 2"),
    key("interfaces[].softening", K::Choice(softenings), "\"linear\"", "Traction over opening and slip"),
    key("interfaces[].normal_stiffness", K::Quantity(D::STIFFNESS_PER_AREA), "stiff", "Stiffness across the face, > 0. Absent: stiff until its strength is met, without a smaller time step"),
    key("interfaces[].shear_stiffness", K::Quantity(D::STIFFNESS_PER_AREA), "normal_stiffness", "Stiffness along the face, > 0"),
    key("interfaces[].friction_angle", K::Angle, "residual_friction_angle", "Angle of friction while it is whole: pressure p raises the strength against sliding by p times its tangent; from 0 to below 90 deg"),
    key("interfaces[].residual_friction_angle", K::Angle, "\"0 deg\"", "Angle of friction once it is broken, from 0 to below 90 deg"),
    key("interfaces[].joint_roughness", K::Quantity(D::NONE), "smooth", "Roughness coefficient JRC of a rock joint, above 0, at most 20: under a pressure p friction has the residual angle + JRC log10(joint_wall_strength/p) degrees, at most 70"),
    key("interfaces[].joint_wall_strength", K::Quantity(D::PRESSURE), "required with joint_roughness", "Compressive strength JCS of the walls, > 0"),
    key("interfaces[].peak_slip", K::Quantity(D::LENGTH), "no wear", "Slip beyond which roughness wears, > 0: JRC falls with (peak_slip/slip)^0.381"),
    key("interfaces[].dilation_angle", K::Angle, "\"0 deg\"", "Angle by which broken sides under pressure rise as they slide, from 0 to the residual friction angle"),
    key("interfaces[].pressure", K::TimeFunction(D::PRESSURE), "", "Pressure of what is between the sides, which pushes them apart; friction and strength feel what is left of the pressure of the sides"),
    key("interfaces[].pressure_in", K::Choice(pressure_in), "\"everywhere\"", "Where that pressure acts: everywhere, or by the share of the strength that is lost (broken)"),
    key("interfaces[].dilation_slip", K::Quantity(D::LENGTH), "no end", "Slip beyond which they rise no further, > 0"),
    key("interfaces[].heat_transfer", K::Quantity(D::HEAT_TRANSFER), "a hundred times that of an element", "With [heat]: coefficient of heat transfer from one side to the other where they are joined or touch, > 0; none passes where they have parted"),
];

fn mixed_modes() -> Vec<&'static str> {
    vec!["power", "benzeggagh-kenane"]
}

fn pressure_in() -> Vec<&'static str> {
    vec!["everywhere", "broken"]
}

fn softenings() -> Vec<&'static str> {
    vec!["linear", "exponential"]
}
