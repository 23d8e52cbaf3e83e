//! `[gas]`.

use super::{key, names};
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::model::{GasLaw, Preset};
use crate::unit::Dimension as D;

#[rustfmt::skip] // one key per line reads as a table
pub(super) static KEYS: &[KeyDoc] = &[
    key("gas", K::Table, "", "Gas in holes of the solids, which enters the cracks that open to them"),
    key("gas.law", K::Choice(names::<GasLaw>), "\"perfect-gas\"", "Equation of state: perfect gas, dense gas with a covolume, or products of detonation"),
    key("gas.heat_ratio", K::Quantity(D::NONE), "", "Ratio of heat capacities γ, > 1; required but for jwl"),
    key("gas.gas_constant", K::Quantity(D::HEAT_CAPACITY), "", "Gas constant per mass, > 0: 8.314 J/(mol K) over the molar mass; required but for jwl"),
    key("gas.covolume", K::Quantity(D::SPECIFIC_VOLUME), "", "noble-abel only, required there: volume that the molecules of a mass take, > 0"),
    key("gas.explosive", K::Choice(names::<Preset>), "", "An explosive by name, of the list below: law = \"jwl\" with its constants, energy and velocity of detonation"),
    key("gas.jwl", K::Table, "", "jwl only, required there without explosive: constants of the law"),
    key("gas.jwl.a", K::Quantity(D::PRESSURE), "required", "A"),
    key("gas.jwl.b", K::Quantity(D::PRESSURE), "required", "B"),
    key("gas.jwl.r1", K::Quantity(D::NONE), "required", "R₁, > 0"),
    key("gas.jwl.r2", K::Quantity(D::NONE), "required", "R₂, > 0"),
    key("gas.jwl.omega", K::Quantity(D::NONE), "required", "ω, > 0"),
    key("gas.jwl.density", K::Quantity(D::DENSITY), "required", "Density of the explosive before it reacts"),
    key("gas.jwl.heat_capacity", K::Quantity(D::HEAT_CAPACITY), "\"1500 J/(kg K)\"", "Heat capacity at constant volume, for the temperature only"),
    key("gas.viscosity", K::Quantity(D::VISCOSITY), "\"5e-5 Pa s\"", "Dynamic viscosity, > 0"),
    key("gas.wall_roughness", K::Quantity(D::LENGTH), "\"0 m\"", "Height of the asperities of crack walls, ≥ 0; 0 leaves laminar friction and choking"),
    key("gas.least_opening", K::Quantity(D::LENGTH), "\"10 um\"", "Opening of a crack whose walls have not moved since the start, > 0. It closes to less only under compression"),
    key("gas.in_cracks", K::Flag, "true", "true: the gas enters the cracks and interfaces that open to the holes. false: it pushes on the walls of the holes alone"),
    key("gas.outside_pressure", K::Quantity(D::PRESSURE), "\"101325 Pa\"", "Pressure where cracks reach the surface, ≥ 0: gas leaks there, and nothing flows in"),
    key("gas.symmetry", K::Table, "", "Planes of symmetry at which the model ends: holes may end there, nothing leaks, and the gas is the share on this side; supports hold the solid there"),
    key("gas.symmetry.x", K::Quantity(D::LENGTH), "", "Position of the plane across x"),
    key("gas.symmetry.y", K::Quantity(D::LENGTH), "", "Position of the plane across y"),
    key("gas.symmetry.z", K::Quantity(D::LENGTH), "", "Position of the plane across z"),
    key("gas.holes[]", K::Tables, "", "Holes that gas is put in; at least one"),
    key("gas.holes[].group", K::Text, "", "Mesh group of the facets around the hole: a closed surface, in 2D a closed line. Its ends may be open. Required without `where`"),
    key("gas.holes[].where", K::Condition, "", "Which facets, by all of their nodes at the start"),
    key("gas.holes[].stemmed", K::Flag, "false", "3D only: true closes flat open ends of the hole, for instance of a borehole through a specimen, by stemming that does not move"),
    key("gas.holes[].pressure", K::Quantity(D::PRESSURE), "", "Pressure at the start, ≥ 0, with temperature; not with jwl"),
    key("gas.holes[].temperature", K::Quantity(D::TEMPERATURE), "", "Temperature at the start, > 0; required with pressure"),
    key("gas.holes[].mass", K::Quantity(D::MASS), "", "Mass at the start, ≥ 0, instead of pressure. In 2D it is that of the whole thickness, at planes of symmetry that on this side"),
    key("gas.holes[].energy", K::Quantity(D::ENERGY), "", "Internal energy at the start, ≥ 0; required with mass, but for an explosive, whose mass has its energy"),
    key("gas.holes[].detonation", K::Table, "", "The mass burns along the hole behind a front, instead of being there at the start"),
    key("gas.holes[].detonation.length", K::Quantity(D::LENGTH), "required", "Length of the charge, > 0: it burns for this over the velocity"),
    key("gas.holes[].detonation.velocity", K::Quantity(D::VELOCITY), "that of the explosive", "Velocity of detonation, > 0; required without explosive"),
    key("gas.holes[].detonation.delay", K::Quantity(D::TIME), "\"0 s\"", "When it begins, ≥ 0"),
    key("gas.holes[].stemming", K::Table, "", "Stemming that is ejected: from then on gas flows out through its length of the hole"),
    key("gas.holes[].stemming.diameter", K::Quantity(D::LENGTH), "required", "Diameter of the hole there, > 0"),
    key("gas.holes[].stemming.length", K::Quantity(D::LENGTH), "required", "Length of the stemming, > 0"),
    key("gas.holes[].stemming.ejected_at", K::Quantity(D::TIME), "required", "When it has left the hole, ≥ 0"),
    key("gas.holes[].mass_rate", K::TimeFunction(D::MASS_RATE), "", "Mass that comes in over time; without pressure and mass the hole is empty at the start"),
    key("gas.holes[].energy_rate", K::TimeFunction(D::POWER), "", "Energy that comes in with it, that of its pressure included; required with mass_rate"),
];
