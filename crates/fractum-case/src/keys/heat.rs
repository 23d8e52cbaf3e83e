//! `[heat]`, and what materials are to it.

use fractum_scene::PackingConduction;

use super::{key, names};
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::model::HeatScheme;
use crate::unit::Dimension as D;

#[rustfmt::skip] // one key per line reads as a table
pub(super) static KEYS: &[KeyDoc] = &[
    key("materials.NAME.thermal", K::Table, "", "Thermal properties of the material; required with [heat]"),
    key("materials.NAME.thermal.conductivity", K::Quantity(D::CONDUCTIVITY), "required", "Thermal conductivity, > 0"),
    key("materials.NAME.thermal.heat_capacity", K::Quantity(D::HEAT_CAPACITY), "required", "Heat capacity per mass, > 0"),
    key("materials.NAME.thermal.expansion", K::Quantity(D::EXPANSION), "\"0 1/K\"", "Coefficient of linear thermal expansion"),
    key("heat", K::Table, "", "Conduction of heat in solids and bonded bodies; broken bonds and removed elements conduct nothing"),
    key("heat.initial_temperature", K::Field(D::TEMPERATURE), "required", "Temperature at t = 0"),
    key("heat.stress_free_temperature", K::Quantity(D::TEMPERATURE), "the initial one", "Temperature at which bodies have no thermal strain; required where they expand from an uneven initial temperature"),
    key("heat.scheme", K::Choice(names::<HeatScheme>), "\"explicit\"", "Steps of conduction: forward Euler below the stable step, or backward Euler of any step"),
    key("heat.step", K::Quantity(D::TIME), "solver.safety times the stable step; where bodies expand in motion a twentieth of that; at most a thousandth of the run", "Step of conduction, > 0; required with scheme = \"implicit\""),
    key("heat.packing", K::Choice(names::<PackingConduction>), "\"measured\"", "Conduction of particles. measured: the published table, times a factor that gives the body the conductivity and the heat capacity of its material. table: the table alone"),
    key("heat.conditions[]", K::Tables, "", "Thermal boundary conditions and sources; surfaces without a condition are insulated"),
    key("heat.conditions[].group", K::Text, "", "Mesh group of nodes (temperature, power), elements (source) or facets (flux, convection), or set of particles; required without `where`"),
    key("heat.conditions[].where", K::Condition, "", "Which of them, by their positions at the start; without `group`: which of all solid bodies"),
    key("heat.conditions[].area", K::Quantity(D::AREA), "", "Particles with flux or convection, required there: area of the surface that they stand for, > 0"),
    key("heat.conditions[].temperature", K::TimeFunction(D::TEMPERATURE), "", "Prescribed temperature"),
    key("heat.conditions[].flux", K::TimeFunction(D::HEAT_FLUX), "", "Heat per area that flows in"),
    key("heat.conditions[].power", K::TimeFunction(D::POWER), "", "Heat that flows in, shared as a force"),
    key("heat.conditions[].source", K::TimeFunction(D::HEAT_SOURCE), "", "Heat per volume; an expression of t, x, y, z moves it"),
    key("heat.conditions[].convection", K::Table, "", "Convection h (T∞ - T)"),
    key("heat.conditions[].convection.coefficient", K::Quantity(D::HEAT_TRANSFER), "required", "Coefficient of heat transfer h, > 0"),
    key("heat.conditions[].convection.ambient", K::TimeFunction(D::TEMPERATURE), "required", "Temperature T∞ of the surrounding fluid"),
];
