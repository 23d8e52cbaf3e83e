use fractum_fem::{LocalDamping, Solid};
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::bonded::Bonded;
use crate::clock::{Clock, Frequencies, TimeStepSettings};
use crate::conditions::{Loads, Population, Supports, SurfaceSupports};
use crate::contacts::{Contacts, NodesOnShape};
use crate::coupling::{Debris, Ties};
use crate::domain::{Domain, Left};
use crate::excavation::Excavation;
use crate::fragment::{Fragment, joined, linked, marked_pieces, single_share, solid_pieces};
use crate::gas::Gas;
use crate::heat::Heat;
use crate::inlet::{Entered, Inlet};
use crate::interfaces::Interfaces;
use crate::ledger::{Books, Ledger};
use crate::liquid::Liquid;
use crate::modes::Modes;
use crate::periodic::PeriodicBox;
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
    /// Faces along which the nodes of solids are doubled.
    pub(crate) interfaces: Interfaces,
    /// Liquid in them.
    pub(crate) liquid: Option<Box<Liquid>>,
    /// What leaves when this scene is a stage that begins.
    pub(crate) excavation: Option<Box<Excavation>>,
    /// Whether the scene moves from one equilibrium to the next. These know small strains alone, and bodies keep them on the way.
    pub(crate) is_between_equilibria: bool,
    /// Natural vibrations, once they have been looked for.
    pub(crate) modes: Option<Box<Modes>>,
    /// Where particles come into the run.
    pub(crate) inlets: Vec<Inlet>,
    pub(crate) entered: Entered,
    /// The box through whose sides particles meet.
    pub(crate) periodic: Option<Box<PeriodicBox>>,
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

impl Scene {
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

    /// Interfaces between elements.
    pub fn interfaces(&self) -> &Interfaces {
        &self.optional.interfaces
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
        let below = self.settings.joined_below;
        let mut found = marked_pieces(&self.solid, below, &self.optional.surface_supports);
        if !self.interfaces().is_empty() {
            found = linked(found, self.interfaces().links(below));
        }
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
        let mut pieces = solid_pieces(&self.solid, self.settings.joined_below);
        if !self.interfaces().is_empty() {
            pieces = linked(pieces, self.interfaces().links(self.settings.joined_below));
        }
        for (number, piece) in (1..).zip(pieces.iter().filter(|piece| piece.nodes.len() > 1)) {
            piece.nodes.iter().for_each(|&node| fragment[node as usize] = number);
        }
        fragment
    }

    /// Share of the mass of every solid body that has come apart into single nodes.
    pub fn single_share(&self) -> Vec<f64> {
        let mut left: Vec<u32> = self.removals.left.nodes(self.solid.reference.len()).collect();
        left.sort_unstable();
        single_share(&self.solid, self.settings.joined_below, |node| left.binary_search(&node).is_ok())
    }
}
