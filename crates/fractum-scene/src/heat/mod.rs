//! Heat in solids and bonded bodies: one field of temperature over nodes and particles, which expands both.

mod across;
mod expansion;
mod measure;
mod pairs;
mod step;

use fractum_fem::{Solid, motion};
use fractum_heat::{HeatCondition, HeatField, HeatFieldState, HeatLedger, HeatNetwork, ImplicitHeat};
use serde::{Deserialize, Serialize};

use crate::bonded::Bonded;
use crate::error::SceneError;
use crate::interfaces::Interfaces;
use crate::time_function::TimeFunction;
use across::Crossings;
use expansion::Expansion;
pub use measure::{HeatMeasure, TemperatureTake};
use pairs::Pairs;
pub use pairs::{PackingConduction, PackingReport};

/// Part of the stable step of conduction that is taken where temperatures expand bodies in motion: what a step adds is small,
/// so that it excites no waves to speak of.
const SMOOTH: f64 = 0.05;

/// What a body is to heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalMaterial {
    /// Conductivity λ [W/(m K)], > 0.
    pub conductivity: f64,
    /// Heat capacity per mass c [J/(kg K)], > 0.
    pub capacity: f64,
    /// Coefficient of linear expansion α [1/K]; 0 where it does not expand.
    pub expansion: f64,
}

/// What heat needs beside the bodies.
pub struct HeatSettings {
    /// Of the solid bodies, in their order.
    pub solids: Vec<ThermalMaterial>,
    /// Of the bonded bodies, in their order.
    pub bonded: Vec<ThermalMaterial>,
    /// Coefficient of heat transfer of the interfaces of each kind where their sides touch [W/(m² K)]; none where they resist nothing to speak of.
    pub interfaces: Vec<Option<f64>>,
    /// How particles conduct.
    pub packing: PackingConduction,
    /// Temperature at t = 0 [K].
    pub initial: TimeFunction,
    /// Temperature at which nothing is stressed [K].
    pub stress_free: f64,
    /// What heats and cools; particles count after all nodes.
    pub conditions: Vec<HeatCondition>,
    /// Whether steps are implicit.
    pub implicit: bool,
    /// Step of conduction [s]; from the stable one where there is nothing.
    pub step: Option<f64>,
    /// Part of the stable step that is taken.
    pub safety: f64,
    /// Longest step that is taken where none is given, so that what heats is resolved [s].
    pub longest: f64,
    /// Whether nothing moves.
    pub alone: bool,
    /// Whether bodies that expand are at rest, and no wave is excited.
    pub at_rest: bool,
    /// Whether bodies have no stress before the first step, at rest: they get that of their temperature in it.
    pub unstressed: bool,
}

/// Heat in the bodies of a scene.
#[derive(Debug)]
pub struct Heat {
    field: HeatField,
    pairs: Pairs,
    solver: Option<ImplicitHeat>,
    /// Largest step [s].
    step: f64,
    /// Nodes come before particles.
    nodes: usize,
    /// Elements have left since the conductances were found.
    stale: bool,
    expansion: Option<Expansion>,
}

/// What changes in heat, for a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeatState {
    field: HeatFieldState,
    expansion: Option<expansion::ExpansionState>,
}

impl Clone for Heat {
    fn clone(&self) -> Self {
        Heat {
            field: self.field.clone(),
            pairs: self.pairs.clone(),
            // Prepared anew where it is needed.
            solver: self.solver.as_ref().map(|_| ImplicitHeat::default()),
            step: self.step,
            nodes: self.nodes,
            stale: self.stale,
            expansion: self.expansion.clone(),
        }
    }
}

impl Heat {
    /// Heat at t = 0; bodies have the thermal strains of that instant.
    ///
    /// # Errors
    /// [`SceneError::PackingConduction`] where the conductivity of a packing was not found.
    pub fn new(
        solid: &mut Solid,
        bonded: &mut Bonded,
        interfaces: &Interfaces,
        settings: HeatSettings,
    ) -> Result<Self, SceneError> {
        let HeatSettings { solids, bonded: of_bonded, packing, initial, stress_free, conditions, .. } = settings;
        let nodes = solid.reference.len();
        let places = [solid.reference.as_slice(), bonded.reference()].concat();
        let crossings = Crossings::new(solid, interfaces, &solids, &settings.interfaces);
        let pairs = Pairs::new(solid, bonded, crossings, &solids, &of_bonded, packing)?;
        let network = HeatNetwork::new(pairs.capacity(solid, bonded), pairs.pairs(), pairs.conductances());
        let start = places.iter().map(|place| initial(0.0, place)).collect();
        let field = HeatField::new(network, places, start, conditions);
        let coefficient = |of: &[ThermalMaterial]| of.iter().map(|own| own.expansion).collect::<Vec<f64>>();
        let mut expansion = match settings.alone {
            true => None,
            false => Expansion::new(solid, bonded, &coefficient(&solids), &coefficient(&of_bonded), stress_free),
        };
        if let Some(expansion) = &mut expansion {
            expansion.start(0.0, solid, bonded, field.temperature());
            // Equilibria begin without stress; bodies are brought to their temperature on the way to the first one.
            if settings.unstressed {
                motion::start_expanded(solid, &vec![0.0; nodes]);
            }
        }
        let stable =
            settings.safety * field.stable_step() * if expansion.is_some() && !settings.at_rest { SMOOTH } else { 1.0 };
        let solver = settings.implicit.then(ImplicitHeat::default);
        let step = settings.step.unwrap_or(stable.min(settings.longest));
        Ok(Heat { step, field, pairs, solver, nodes, stale: false, expansion })
    }

    /// Temperatures of the nodes [K].
    pub fn of_nodes(&self) -> &[f64] {
        &self.temperature()[..self.nodes]
    }

    /// Temperatures of the particles [K].
    pub fn of_particles(&self) -> &[f64] {
        &self.temperature()[self.nodes..]
    }

    /// Temperatures of all points now [K]: those of the field may be ahead.
    fn temperature(&self) -> &[f64] {
        self.expansion.as_ref().map_or(self.field.temperature(), |expansion| &expansion.now)
    }

    /// Where the heat came from and is.
    pub fn ledger(&self) -> HeatLedger {
        self.field.ledger()
    }

    /// Largest step of conduction [s].
    pub fn step_size(&self) -> f64 {
        self.step
    }

    /// Largest stable explicit step [s].
    pub fn stable_step(&self) -> f64 {
        self.field.stable_step()
    }

    /// Whether steps are implicit.
    pub fn is_implicit(&self) -> bool {
        self.solver.is_some()
    }

    /// Points, and pairs that conduct.
    pub fn counts(&self) -> [usize; 2] {
        [self.field.network().len(), self.field.network().pairs().len()]
    }

    /// How bonded bodies conduct.
    pub fn packings(&self) -> &[PackingReport] {
        self.pairs.packings()
    }

    /// Work that thermal expansion has done [J].
    pub fn expansion_work(&self) -> f64 {
        self.expansion.as_ref().map_or(0.0, |expansion| expansion.work)
    }

    /// Everything that changes.
    pub(crate) fn state(&self) -> HeatState {
        HeatState { field: self.field.state(), expansion: self.expansion.as_ref().map(Expansion::state) }
    }

    /// Puts a saved state back, once the bodies have theirs.
    pub(crate) fn restore(
        &mut self,
        solid: &mut Solid,
        bonded: &mut Bonded,
        interfaces: &Interfaces,
        state: HeatState,
    ) {
        self.field.restore(state.field);
        if let (Some(expansion), Some(state)) = (&mut self.expansion, state.expansion) {
            expansion.restore(solid, bonded, self.field.temperature(), state);
        }
        self.pairs.look(solid, interfaces);
        self.find_conductances(solid, bonded);
    }
}
