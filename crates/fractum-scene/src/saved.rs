//! State of a scene, for checkpoints.

use fractum_fem::{BodyState, SolidState, StableStep};
use serde::{Deserialize, Serialize};

use crate::bonded::BondedState;
use crate::clock::Clock;
use crate::conditions::ConditionsState;
use crate::contacts::{Candidate, ContactsState, NodesOnShape};
use crate::coupling::DebrisState;
use crate::domain::Left;
use crate::enter::restore_inlets;
use crate::inlet::{Entered, InletState};
use crate::interfaces::InterfacesState;
use crate::ledger::{Books, Ledger};
use crate::liquid::{Liquid, LiquidState};
use crate::scene::{RemovalTally, Scene};
use crate::stable_step::update_wall_frequency;
use crate::watch::Watch;

/// Everything that changes during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneState {
    /// Time and steps.
    pub clock: Clock,
    solid: SolidState,
    debris: DebrisState,
    bonded: Option<BondedState>,
    contacts: Option<ContactsState>,
    shape_contacts: Vec<Vec<Candidate>>,
    ledger: Ledger,
    books: Books,
    frequency: f64,
    governing: (usize, u32),
    removals: RemovalTally,
    contact_frequency_square: f64,
    contact_frequency_peak: f64,
    left: Left,
    conditions: ConditionsState,
    interfaces: Option<InterfacesState>,
    liquid: Option<LiquidState>,
    inlets: Vec<InletState>,
    entered: Entered,
}

impl SceneState {
    /// What stands in front of the bodies of the solids where a state is written down field by field.
    pub fn before_bodies(&self) -> impl Serialize + '_ {
        (self.clock, &self.solid.displacement, &self.solid.velocity)
    }

    /// Bodies of the solids, in order.
    pub fn bodies(&self) -> &[BodyState] {
        &self.solid.bodies
    }

    /// What stands between the bodies of the solids and the viscous stress in their blocks.
    pub fn between_bodies_and_stress(&self) -> impl Serialize + '_ {
        (&self.solid.dissipated, self.solid.viscous_dissipation)
    }

    /// What stands behind the viscous stress of the solids.
    pub fn behind_solids(&self) -> impl Serialize + '_ {
        let touching = (&self.debris, &self.bonded, &self.contacts, &self.shape_contacts);
        let frequencies = (self.frequency, self.governing, self.removals);
        let of_contacts = (self.contact_frequency_square, self.contact_frequency_peak);
        let rest = (&self.left, &self.conditions, &self.interfaces, &self.liquid, &self.inlets, &self.entered);
        (&self.solid.born, touching, (&self.ledger, &self.books), frequencies, of_contacts, rest)
    }

    /// The same with another state of the solids; none where there is none.
    pub(crate) fn with_solid(self, solid: impl FnOnce(SolidState) -> Option<SolidState>) -> Option<Self> {
        Some(SceneState { solid: solid(self.solid)?, ..self })
    }
}

impl Scene {
    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> SceneState {
        state_with(self, self.solid.state())
    }

    /// Puts a saved state back into a scene built from the same case.
    pub fn restore(&mut self, state: SceneState) {
        self.clock = state.clock;
        self.solid.restore(state.solid);
        self.debris.restore(&self.solid, state.debris);
        if let Some(bonded) = state.bonded {
            self.bonded.restore(bonded);
            restore_inlets(self, state.inlets, state.entered);
            let left: Vec<u32> = state.left.particles(self.solid.reference.len()).collect();
            self.bonded.take_out(&left);
        }
        self.ties.restore(&self.solid, &self.bonded.particles);
        if let Some(contacts) = state.contacts {
            self.contacts.restore(&self.solid, &self.debris, contacts);
            self.contacts.look_again(&self.bonded.particles.radius);
            self.contacts.leave_out(state.left.nodes(self.solid.reference.len()));
        }
        for (ground, candidates) in self.shape_contacts.iter_mut().zip(state.shape_contacts) {
            ground.restore(candidates);
        }
        if let Some(interfaces) = state.interfaces {
            self.optional.interfaces.restore(&self.solid, interfaces);
        }
        if let (Some(liquid), Some(saved)) = (&mut self.optional.liquid, state.liquid) {
            liquid.restore(saved);
        }
        self.ledger = state.ledger;
        self.books = state.books;
        self.frequencies.stable = StableStep { frequency: state.frequency, governing: state.governing };
        self.removals.tally = state.removals;
        self.removals.left = state.left;
        self.frequencies.contact_square = state.contact_frequency_square;
        self.frequencies.contact_peak = state.contact_frequency_peak;
        update_wall_frequency(self);
        state.conditions.put_back(&self.solid, &mut self.loads, &mut self.optional.surface_supports);
    }
}

/// What a scene has noticed so far, for a checkpoint: some of it may not have been told yet.
pub fn watch_of(scene: &Scene) -> Watch {
    scene.optional.watch
}

/// Puts back what a scene built from the same case had noticed.
pub fn restore_watch(scene: &mut Scene, watch: Watch) {
    scene.optional.watch = watch;
}

pub(crate) fn state_with(scene: &Scene, solid: SolidState) -> SceneState {
    SceneState {
        clock: scene.clock,
        solid,
        debris: scene.debris.saved(),
        bonded: (!scene.bonded.is_empty()).then(|| scene.bonded.state()),
        contacts: (!scene.contacts.is_empty()).then(|| scene.contacts.state()),
        shape_contacts: scene.shape_contacts.iter().map(NodesOnShape::state).collect(),
        ledger: scene.ledger,
        books: scene.books,
        frequency: scene.frequencies.stable.frequency,
        governing: scene.frequencies.stable.governing,
        removals: scene.removals.tally,
        contact_frequency_square: scene.frequencies.contact_square,
        contact_frequency_peak: scene.frequencies.contact_peak,
        left: scene.removals.left.clone(),
        conditions: ConditionsState::of(&scene.loads, &scene.optional.surface_supports),
        interfaces: (!scene.interfaces().is_empty()).then(|| scene.interfaces().state()),
        liquid: scene.optional.liquid.as_deref().map(Liquid::state),
        inlets: scene.optional.inlets.iter().map(|inlet| inlet.state.clone()).collect(),
        entered: scene.optional.entered,
    }
}
