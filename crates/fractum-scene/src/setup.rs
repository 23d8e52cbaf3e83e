//! Sets up a scene before its first step.

use fractum_fem::{Solid, motion};

use crate::bonded::Bonded;
use crate::clock::{Clock, Frequencies};
use crate::conditions::{Loads, Supports, SurfaceSupports};
use crate::contacts::{Contacts, NodesOnShape, OverlapWith};
use crate::coupling::{Apart, Attachment, Debris, Ties};
use crate::interfaces::Interfaces;
use crate::ledger::{Books, Ledger};
use crate::scene::{Optional, Removals, Scene, SceneSettings};
use crate::stable_step::{find_first_step, next_dt, prepare_shapes, update_wall_frequency};

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
        prepare_shapes(&mut scene);
        scene
    }

    /// The same scene with bonded bodies, before its first step.
    pub fn with_bonded(mut self, bonded: Bonded) -> Self {
        self.bonded = bonded;
        self.clock = Clock::new(next_dt(&self, 0.0));
        self
    }

    /// The same scene with particles of its bonded bodies tied to its solids, before its first step.
    pub fn with_ties(mut self, attachments: &[Attachment]) -> Self {
        self.ties = Ties::new(&mut self.solid, &mut self.bonded, attachments);
        update_wall_frequency(&mut self); // nodes have taken the mass of particles
        self.clock = Clock::new(next_dt(&self, 0.0));
        self
    }

    /// The same scene with contacts of its particles, before its first step.
    ///
    /// - `surface`: nodes on the surface of the solids, ascending
    pub fn with_contacts(mut self, mut contacts: Contacts, surface: &[u32]) -> Self {
        let joined = self.interfaces().joined_bodies();
        contacts.set_node_contacts(&self.solid, &mut self.debris, &self.bonded.particles, surface, &joined);
        self.contacts = contacts;
        prepare_shapes(&mut self);
        self
    }

    /// The same scene with supports on facets of its solids, before its first step.
    pub fn with_surface_supports(mut self, supports: SurfaceSupports) -> Self {
        self.optional.surface_supports = supports;
        self.clock = Clock::new(next_dt(&self, 0.0));
        self
    }

    /// The same scene with interfaces between its elements, before its first step.
    pub fn with_interfaces(mut self, interfaces: Interfaces) -> Self {
        self.debris.apart = Apart::new(interfaces.doubled());
        self.loads.enter_interfaces(&self.solid, &interfaces);
        self.optional.interfaces = interfaces;
        self.clock = Clock::new(next_dt(&self, 0.0));
        self
    }

    /// Takes everything that overlaps as it stands, before the first step: it gives no force, and touches no nearer than now until
    /// it has parted.
    pub fn accept_initial_overlaps(&mut self) {
        self.contacts.accept_particle_overlaps(&self.solid, &self.bonded.particles);
        accept_node_overlaps(self);
        find_first_step(self);
    }

    /// Nodes of solids that are in something before the first step: node, depth [m] and what it is in, deepest first.
    pub fn node_overlaps(&self) -> Vec<(u32, f64, OverlapWith)> {
        let mut found = accept_node_overlaps(&mut self.clone());
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        found
    }
}

fn accept_node_overlaps(scene: &mut Scene) -> Vec<(u32, f64, OverlapWith)> {
    let mut found = scene.contacts.accept_node_overlaps(&scene.solid);
    for ground in &mut scene.shape_contacts {
        let inside = ground.accept_initial_overlap(scene.contacts.rigid_bodies(), &scene.solid);
        let name = ground
            .rigid_body()
            .and_then(|index| scene.contacts.rigid_bodies().get(index))
            .map(|rigid_body| rigid_body.name.clone());
        let other = OverlapWith::RigidBody(name.unwrap_or_default());
        found.extend(inside.into_iter().map(|(node, depth)| (node, depth, other.clone())));
    }
    found
}
