use fractum_fem::{BodyState, LocalDamping, Solid, SolidState, StableStep, motion};
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::bonded::{Bonded, BondedState};
use crate::clock::{Clock, Frequencies, TimeStepSettings};
use crate::conditions::{ConditionsState, Loads, Population, Supports, SurfaceSupports};
use crate::contacts::{Candidate, Contacts, ContactsState, NodesOnShape, OverlapWith};
use crate::coupling::{Attachment, Debris, DebrisState, Ties};
use crate::domain::{Domain, Left};
use crate::fragment::{Fragment, joined, marked_pieces, single_share, solid_pieces};
use crate::gas::Gas;
use crate::heat::Heat;
use crate::ledger::{Books, Ledger};
use crate::watch::Watch;

/// One simulation: bodies, boundary conditions, clock and ledger.
#[derive(Clone)]
pub struct Scene {
    /// Finite elements.
    pub solid: Solid,
    /// Discrete elements that came from them, with their contacts.
    pub debris: Debris,
    /// Bonded bodies, with particles of their own.
    pub bonded: Bonded,
    /// What ties bonded bodies to solids.
    pub ties: Ties,
    /// Contacts of particles with nodes of their own, and the rigid bodies that they meet.
    pub contacts: Contacts,
    /// Rigid shapes that nodes of solids and debris touch.
    pub shape_contacts: Vec<NodesOnShape>,
    /// Time and step.
    pub clock: Clock,
    pub(crate) supports: Supports,
    pub(crate) loads: Loads,
    pub(crate) optional: Optional,
    pub(crate) settings: SceneSettings,
    pub(crate) ledger: Ledger,
    pub(crate) books: Books,
    pub(crate) frequencies: Frequencies,
    pub(crate) removals: Removals,
}

/// What only some scenes have.
#[derive(Clone, Debug, Default)]
pub(crate) struct Optional {
    /// Dashpots and springs on facets.
    pub(crate) surface_supports: SurfaceSupports,
    /// Heat in solids and bonded bodies.
    pub(crate) heat: Option<Box<Heat>>,
    /// What was noticed beyond the models of the scene.
    pub(crate) watch: Watch,
}

/// How many elements have left the solids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct RemovalTally {
    /// Since the start, after they were turned inside out.
    pub(crate) crushed: usize,
    /// Since the stable step was looked at.
    pub(crate) since_check: usize,
}

/// Elements that have left the solids.
#[derive(Clone, Debug, Default)]
pub(crate) struct Removals {
    /// Bodies and elements of the last step.
    pub(crate) last: Vec<(usize, u32)>,
    pub(crate) tally: RemovalTally,
    /// Free pieces outside it leave the run.
    pub(crate) domain: Option<Domain>,
    pub(crate) left: Left,
}

/// What stays the same through a run, beside bodies and boundary conditions.
#[derive(Clone, Copy, Debug)]
pub struct SceneSettings {
    /// How the step is chosen.
    pub time_step: TimeStepSettings,
    /// Damping on the nodes.
    pub damping: LocalDamping,
    /// Stiffness-proportional damping time β [s], for its share in the stable step.
    pub stiffness_time: f64,
    /// Relative residual of the energy balance that stops the run.
    pub balance_stop: f64,
    /// Share of its strength that an edge may have lost and still join a fragment, 0 to 1.
    pub joined_below: f64,
}

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
        (touching, (&self.ledger, &self.books), frequencies, of_contacts, (&self.left, &self.conditions))
    }

    /// The same with another state of the solids; none where there is none.
    pub(crate) fn with_solid(self, solid: impl FnOnce(SolidState) -> Option<SolidState>) -> Option<Self> {
        Some(SceneState { solid: solid(self.solid)?, ..self })
    }
}

impl Scene {
    /// Sets up a scene at t = 0 and finds its time step.
    ///
    /// - `surface`: nodes on the surface of the solids, which rigid bodies feel
    pub fn new(
        mut solid: Solid,
        supports: Supports,
        mut loads: Loads,
        mut debris: Debris,
        mut shape_contacts: Vec<NodesOnShape>,
        surface: &[u32],
        settings: SceneSettings,
    ) -> Self {
        let bound = settings.time_step.element_bound || solid.reference.is_empty();
        let frequencies = Frequencies::of_solid(&mut solid, bound);
        motion::set_copies_off(&mut solid);
        if !shape_contacts.is_empty() {
            debris.prepare(&solid);
            shape_contacts.iter_mut().for_each(|ground| ground.watch(surface, &solid, &debris));
        }
        loads.open_cracks(&solid);
        let mut scene = Scene {
            solid,
            debris,
            bonded: Bonded::default(),
            ties: Ties::default(),
            contacts: Contacts::default(),
            shape_contacts,
            clock: Clock::new(0.0),
            supports,
            loads,
            optional: Optional::default(),
            settings,
            ledger: Ledger::default(),
            books: Books::default(),
            frequencies,
            removals: Removals::default(),
        };
        scene.prepare_shapes();
        scene
    }

    /// The same scene with bonded bodies, before its first step.
    pub fn with_bonded(mut self, bonded: Bonded) -> Self {
        self.bonded = bonded;
        self.clock = Clock::new(self.next_dt(0.0));
        self
    }

    /// The same scene with particles of its bonded bodies tied to its solids, before its first step.
    pub fn with_ties(mut self, attachments: &[Attachment]) -> Self {
        self.ties = Ties::new(&mut self.solid, &mut self.bonded, attachments);
        self.update_wall_frequency(); // nodes have taken the mass of particles
        self.clock = Clock::new(self.next_dt(0.0));
        self
    }

    /// The same scene with contacts of its particles, before its first step.
    ///
    /// - `surface`: nodes on the surface of the solids, ascending
    pub fn with_contacts(mut self, mut contacts: Contacts, surface: &[u32]) -> Self {
        contacts.set_node_contacts(&self.solid, &mut self.debris, &self.bonded.particles, surface);
        self.contacts = contacts;
        self.prepare_shapes();
        self
    }

    /// The same scene with supports on facets of its solids, before its first step.
    pub fn with_surface_supports(mut self, supports: SurfaceSupports) -> Self {
        self.optional.surface_supports = supports;
        self.clock = Clock::new(self.next_dt(0.0));
        self
    }

    /// Goes on with the supports, loads and settings of another scene of the same solids.
    pub fn begin_stage(&mut self, next: Scene) {
        (self.supports, self.settings) = (next.supports, next.settings);
        let before = std::mem::replace(&mut self.loads, next.loads);
        self.loads.follow(before, &self.solid);
        self.optional.surface_supports.gather(&self.solid);
        self.books.absorbed += self.optional.surface_supports.absorbed();
        self.optional.surface_supports = next.optional.surface_supports;
        self.removals.domain = next.removals.domain;
    }

    /// Takes everything that overlaps as it stands, before the first step: it gives no force, and touches no nearer than now until
    /// it has parted.
    pub fn accept_initial_overlaps(&mut self) {
        self.contacts.accept_particle_overlaps(&self.solid, &self.bonded.particles);
        self.accept_node_overlaps();
        self.find_first_step();
    }

    /// Nodes of solids that are in something before the first step: node, depth [m] and what it is in, deepest first.
    pub fn node_overlaps(&self) -> Vec<(u32, f64, OverlapWith)> {
        let mut found = self.clone().accept_node_overlaps();
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        found
    }

    fn accept_node_overlaps(&mut self) -> Vec<(u32, f64, OverlapWith)> {
        let mut found = self.contacts.accept_node_overlaps(&self.solid);
        for ground in &mut self.shape_contacts {
            let inside = ground.accept_initial_overlap(self.contacts.rigid_bodies(), &self.solid);
            let name = ground
                .rigid_body()
                .and_then(|index| self.contacts.rigid_bodies().get(index))
                .map(|rigid_body| rigid_body.name.clone());
            let other = OverlapWith::RigidBody(name.unwrap_or_default());
            found.extend(inside.into_iter().map(|(node, depth)| (node, depth, other.clone())));
        }
        found
    }

    /// Forces on nodes of solids, or on particles of bonded bodies and loose ones, that who drives the scene sets before a
    /// step [N]. They act in every step until they are taken away, those of a point that is named twice are added, and their
    /// work is booked as that of loads. The stable step knows nothing of them.
    pub fn given_forces(&mut self, population: Population) -> &mut Vec<(u32, Vec3)> {
        match population {
            Population::Nodes => self.loads.given(),
            Population::Particles => self.bonded.loads.given(),
        }
    }

    /// Whether the end of the run has been reached.
    pub fn is_finished(&self) -> bool {
        self.clock.time >= self.settings.time_step.end * (1.0 - 1e-12)
    }

    /// Supports, with the reactions of the last step.
    pub fn supports(&self) -> &Supports {
        &self.supports
    }

    /// Forces of the supports on the nodes of the mesh at the last step [N].
    pub fn node_reactions(&self) -> Vec<Vec3> {
        let (solid, count) = (&self.solid, self.solid.reference.len());
        let mut reactions = self.supports.reactions(solid.mass.len());
        let of_copies = reactions.split_off(count);
        (count..).zip(of_copies).for_each(|(copy, reaction)| reactions[solid.original(copy)] += reaction);
        reactions
    }

    /// Gas in holes and cracks.
    pub fn gas(&self) -> Option<&Gas> {
        self.loads.gas()
    }

    /// Energies at the last step that was measured.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Settings of the scene.
    pub fn settings(&self) -> &SceneSettings {
        &self.settings
    }

    /// Whether some element that is still there holds each node.
    pub fn attached_nodes(&self) -> Vec<bool> {
        let mut attached = vec![true; self.solid.reference.len()];
        let debris = self.debris.state();
        for (&node, &held) in debris.nodes.iter().zip(&debris.attached) {
            attached[node as usize] = held;
        }
        attached
    }

    /// Fragments of solids and bonded bodies, heaviest first: pieces of at least two nodes or particles, joined by edges
    /// that keep some of their strength, by bonds and by ties.
    pub fn fragments(&self) -> Vec<Fragment> {
        let mut found = marked_pieces(&self.solid, self.settings.joined_below, &self.optional.surface_supports);
        if !self.bonded.is_empty() {
            found = joined(found, self.bonded.fragments(), self.ties.links());
            found.sort_by(|a, b| b.mass.total_cmp(&a.mass));
        }
        found.retain(|piece| piece.nodes.len() > 1);
        found
    }

    /// Number of the fragment of every node of the solids, in the order of [`Scene::fragments`] without bonded bodies, from 1;
    /// 0 for single nodes.
    pub fn fragment_of_nodes(&self) -> Vec<i32> {
        let mut fragment = vec![0; self.solid.reference.len()];
        let pieces = solid_pieces(&self.solid, self.settings.joined_below);
        for (number, piece) in (1..).zip(pieces.iter().filter(|piece| piece.nodes.len() > 1)) {
            piece.nodes.iter().for_each(|&node| fragment[node as usize] = number);
        }
        fragment
    }

    /// Share of the mass of every solid body that has come apart into single nodes.
    pub fn single_share(&self) -> Vec<f64> {
        single_share(&self.solid, self.settings.joined_below)
    }

    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> SceneState {
        self.state_with(self.solid.state())
    }

    pub(crate) fn state_with(&self, solid: SolidState) -> SceneState {
        SceneState {
            clock: self.clock,
            solid,
            debris: self.debris.saved(),
            bonded: (!self.bonded.is_empty()).then(|| self.bonded.state()),
            contacts: (!self.contacts.is_empty()).then(|| self.contacts.state()),
            shape_contacts: self.shape_contacts.iter().map(NodesOnShape::state).collect(),
            ledger: self.ledger,
            books: self.books,
            frequency: self.frequencies.stable.frequency,
            governing: self.frequencies.stable.governing,
            removals: self.removals.tally,
            contact_frequency_square: self.frequencies.contact_square,
            contact_frequency_peak: self.frequencies.contact_peak,
            left: self.removals.left.clone(),
            conditions: ConditionsState::of(&self.loads, &self.optional.surface_supports),
        }
    }

    /// Puts a saved state back into a scene built from the same case.
    pub fn restore(&mut self, state: SceneState) {
        self.clock = state.clock;
        self.solid.restore(state.solid);
        self.debris.restore(&self.solid, state.debris);
        if let Some(bonded) = state.bonded {
            self.bonded.restore(bonded);
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
        self.ledger = state.ledger;
        self.books = state.books;
        self.frequencies.stable = StableStep { frequency: state.frequency, governing: state.governing };
        self.removals.tally = state.removals;
        self.removals.left = state.left;
        self.frequencies.contact_square = state.contact_frequency_square;
        self.frequencies.contact_peak = state.contact_frequency_peak;
        self.update_wall_frequency();
        state.conditions.put_back(&self.solid, &mut self.loads, &mut self.optional.surface_supports);
    }
}
