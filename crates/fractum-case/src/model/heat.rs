//! Heat in solids and bonded bodies.

use fractum_scene::PackingConduction;

use super::{GroupUse, Selection};
use crate::choice::choice;
use crate::{Field, Place, Spanned, TimeFunction};

/// What flows in a case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Flows {
    /// Gas in holes and in the cracks that open to them.
    pub gas: Option<super::Gas>,
    /// Heat in solids and bonded bodies.
    pub heat: Option<Heat>,
    /// Liquid in interfaces.
    pub liquid: Option<super::Liquid>,
}

/// Heat of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// Where it is written.
    pub place: Place,
    /// Temperature at t = 0 [K].
    pub initial: Spanned<Field>,
    /// Temperature at which nothing is stressed [K]; that of the start if absent.
    pub stress_free: Option<f64>,
    /// How steps are done.
    pub scheme: HeatScheme,
    /// Step of conduction [s], > 0; from the stable one if absent.
    pub step: Option<Spanned<f64>>,
    /// How particles conduct.
    pub packing: PackingConduction,
    /// What heats and cools, in the order of the file.
    pub conditions: Vec<HeatCondition>,
}

/// How steps of conduction are done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeatScheme {
    /// Forward Euler, below the stable step.
    Explicit,
    /// Backward Euler, with any step.
    Implicit,
}

choice!(HeatScheme { "explicit" => Explicit, "implicit" => Implicit });

choice!(PackingConduction { "measured" => Measured, "table" => Table });

/// What heats or cools a set of points.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatCondition {
    /// Its nodes, elements, facets or particles.
    pub on: Selection,
    /// Area of the surface that particles stand for [m²], > 0.
    pub area: Option<Spanned<f64>>,
    /// What happens there.
    pub kind: HeatKind,
}

/// Kinds of heating and cooling.
#[derive(Debug, Clone, PartialEq)]
pub enum HeatKind {
    /// Prescribed temperature [K].
    Temperature(Spanned<TimeFunction>),
    /// Heat per area that flows in [W/m²].
    Flux(Spanned<TimeFunction>),
    /// Heat that flows in, shared as a force [W].
    Power(Spanned<TimeFunction>),
    /// Heat per volume [W/m³].
    Source(Spanned<TimeFunction>),
    /// Newton's law of cooling.
    Convection {
        /// Coefficient of heat transfer [W/(m² K)], > 0.
        coefficient: f64,
        /// Temperature of what flows by [K].
        ambient: Spanned<TimeFunction>,
    },
}

impl HeatKind {
    /// As what it uses a group of the mesh.
    pub fn group_use(&self) -> GroupUse {
        match self {
            HeatKind::Flux(_) | HeatKind::Convection { .. } => GroupUse::Facets,
            HeatKind::Source(_) => GroupUse::ProbeElements,
            HeatKind::Temperature(_) | HeatKind::Power(_) => GroupUse::Support,
        }
    }

    /// The function of time that it is made of.
    pub fn function(&self) -> &Spanned<TimeFunction> {
        match self {
            HeatKind::Temperature(function)
            | HeatKind::Flux(function)
            | HeatKind::Power(function)
            | HeatKind::Source(function)
            | HeatKind::Convection { ambient: function, .. } => function,
        }
    }
}

/// What a material is to heat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thermal {
    /// Conductivity [W/(m K)], > 0.
    pub conductivity: f64,
    /// Heat capacity per mass [J/(kg K)], > 0.
    pub heat_capacity: f64,
    /// Coefficient of linear expansion [1/K].
    pub expansion: f64,
}
