//! Nodes of solids - points of a surface, and discrete elements - on facets that are not their own.

use fractum_contact::law::{ContactLaw, ContactMemory, Linear, Rolling};
use fractum_contact::{Spheres, Surface, SurfaceContacts, Touch};
use fractum_fem::Solid;
use fractum_math::{Vec3, Work};

use crate::coupling::Debris;

/// Skin of the search, and how deep a node within a body is still pushed out, over the mean radius of the nodes.
const SKIN: f64 = 0.25;
const DEPTH: f64 = 1.0;
/// How much faster than it is a contact counts in the stable step, as on rigid shapes.
const RESOLUTION: f64 = 4.0;
/// How much faster a turning sphere answers to the tangential spring: 1 + m r²/I.
const TURNING: f64 = 3.5;

/// Nodes that may touch one ground, with their contacts.
///
/// A node on the surface of its solid is a point; a discrete element has its radius. Where a node becomes one while it
/// touches, the contact keeps its force, and what its radius adds gives none until both have parted.
#[derive(Clone, Debug)]
pub(crate) struct NodesOnSurface {
    /// Those on the surface at the start, ascending, then discrete elements in the order of their birth.
    nodes: Vec<u32>,
    at_start: usize,
    /// Whether the nodes of each solid body touch this ground.
    bodies: Vec<bool>,
    position: Vec<Vec3>,
    velocity: Vec<Vec3>,
    spin: Vec<Vec3>,
    radius: Vec<f64>,
    contacts: SurfaceContacts<Linear>,
    /// Nodes before and after each of those of the start, counter-clockwise around its plane body, where there is one; empty in space.
    beside: Vec<Option<[u32; 2]>>,
}

impl NodesOnSurface {
    /// - `surface`: nodes on the surfaces of all solids, ascending; `bodies`: whose nodes touch this ground
    pub(crate) fn new(surface: &[u32], bodies: Vec<bool>, debris: &Debris) -> Self {
        let nodes: Vec<u32> = surface.iter().copied().filter(|&n| bodies[debris.body(n)]).collect();
        let mean = nodes.iter().map(|&n| debris.radius(n)).sum::<f64>() / nodes.len().max(1) as f64;
        NodesOnSurface {
            at_start: nodes.len(),
            bodies,
            position: vec![Vec3::zeros(); nodes.len()],
            velocity: vec![Vec3::zeros(); nodes.len()],
            spin: vec![Vec3::zeros(); nodes.len()],
            radius: vec![0.0; nodes.len()],
            nodes,
            contacts: SurfaceContacts::new(SKIN * mean).on_solid_ground(DEPTH * mean),
            beside: Vec::new(),
        }
    }

    /// The same in the plane.
    ///
    /// - `beside`: nodes before and after a node, counter-clockwise around its body
    pub(crate) fn on_lines(mut self, beside: impl Fn(u32) -> Option<[u32; 2]>) -> Self {
        self.beside = self.nodes.iter().map(|&node| beside(node)).collect();
        self
    }

    pub(crate) fn contacts(&self) -> &SurfaceContacts<Linear> {
        &self.contacts
    }

    /// Whether nodes of a solid body may touch this ground.
    pub(crate) fn meets(&self, body: usize) -> bool {
        self.bodies[body]
    }

    /// The nodes that may touch.
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Has the next search look up everything, since facets have gone.
    pub(crate) fn look_again(&mut self) {
        self.contacts.look_again();
    }

    fn place_of(&self, node: u32) -> Option<usize> {
        let (start, born) = self.nodes.split_at(self.at_start);
        let later = || born.iter().position(|&n| n == node).map(|k| k + self.at_start);
        start.binary_search(&node).ok().or_else(later)
    }

    fn locate(&mut self, solid: &Solid) {
        for (k, &node) in self.nodes.iter().enumerate() {
            self.position[k] = solid.position(node as usize);
            self.velocity[k] = solid.velocity[node as usize];
        }
    }

    /// Finds where all nodes are, and looks up what is near them if the skin is used up.
    fn search(&mut self, ground: &Surface, solid: &Solid) {
        self.locate(solid);
        let NodesOnSurface { nodes, position, velocity, spin, radius, contacts, beside, .. } = self;
        contacts.search(ground, &Spheres { position, velocity, spin, radius });
        if beside.is_empty() {
            return;
        }
        contacts.set_corners(nodes.len(), |k| {
            let [before, after] = (*beside.get(k as usize)?)?.map(|node| solid.position(node as usize));
            let at = position[k as usize];
            Some([at - before, after - at].map(|way| Vec3::new(way.y, -way.x, 0.0).normalize()))
        });
    }

    /// Nodes that may touch the ground before it has moved far.
    pub(crate) fn near(&mut self, ground: &Surface, solid: &Solid) -> impl Iterator<Item = u32> {
        self.search(ground, solid);
        self.contacts.near().map(|k| self.nodes[k as usize])
    }

    /// Nodes of plane bodies that were close to the ground at the last step, or within it.
    pub(crate) fn close(&self) -> impl Iterator<Item = u32> {
        self.contacts.close_corners().map(|k| self.nodes[k as usize])
    }

    /// Adds nodes of new discrete elements, or makes them grow to their size.
    pub(crate) fn admit(&mut self, born: &[u32], ground: &Surface, solid: &Solid, debris: &Debris) {
        let mut grown: Vec<(u32, f64)> = Vec::new();
        for &node in born.iter().filter(|&&n| self.bodies[debris.body(n)]) {
            let radius = debris.radius(node);
            let place = match self.place_of(node).filter(|&k| k < self.at_start) {
                Some(k) => k,
                None => {
                    self.nodes.push(node);
                    self.position.push(Vec3::zeros());
                    self.velocity.push(Vec3::zeros());
                    self.spin.push(Vec3::zeros());
                    self.radius.push(0.0);
                    self.nodes.len() - 1
                }
            };
            self.radius[place] = radius;
            grown.push((place as u32, radius));
        }
        if grown.is_empty() {
            return;
        }
        grown.sort_unstable_by_key(|g| g.0);
        self.contacts.look_again();
        self.search(ground, solid);
        let NodesOnSurface { position, velocity, spin, radius, contacts, .. } = self;
        let spheres = Spheres { position, velocity, spin, radius };
        let growth = |k: u32| grown.binary_search_by_key(&k, |g| g.0).ok().map(|place| grown[place].1);
        contacts.accept_initial_overlap(ground, &spheres, growth);
    }

    /// Takes all contacts as they stand.
    pub(crate) fn accept_initial_overlap(&mut self, ground: &Surface, solid: &Solid) {
        self.search(ground, solid);
        let NodesOnSurface { position, velocity, spin, radius, contacts, .. } = self;
        let spheres = Spheres { position, velocity, spin, radius };
        contacts.accept_initial_overlap(ground, &spheres, |_| Some(0.0));
    }

    /// Takes a saved state: the discrete elements that there were, and the contacts.
    pub(crate) fn restore(&mut self, debris: &Debris, touches: Vec<Touch<ContactMemory>>) {
        self.nodes.truncate(self.at_start);
        let start = self.at_start;
        for &node in debris.state().nodes.iter().filter(|&&n| self.bodies[debris.body(n)]) {
            if self.nodes[..start].binary_search(&node).is_err() {
                self.nodes.push(node);
            }
        }
        let count = self.nodes.len();
        self.position.resize(count, Vec3::zeros());
        self.velocity.resize(count, Vec3::zeros());
        self.spin.resize(count, Vec3::zeros());
        self.radius = self.nodes.iter().map(|&n| debris.radius_if_particle(n)).collect();
        self.contacts.restore(touches);
    }

    /// Takes nodes out that have left, which touched nothing.
    ///
    /// - `gone`: all that have left so far; `debris`: without them
    pub(crate) fn let_leave(&mut self, gone: &[u32], debris: &Debris) {
        let (before, mut touches) = (self.nodes.clone(), self.contacts.state());
        self.restore(debris, Vec::new());
        for touch in &mut touches {
            touch.sphere = self.place_of(before[touch.sphere as usize]).map_or(touch.sphere, |place| place as u32);
        }
        self.contacts.restore(touches);
        self.leave_out(gone);
    }

    /// Leaves out nodes that have left, discrete elements aside, which are no longer listed.
    pub(crate) fn leave_out(&mut self, gone: &[u32]) {
        for &node in gone {
            if let Ok(place) = self.nodes[..self.at_start].binary_search(&node) {
                self.radius[place] = -1.0;
            }
        }
        self.contacts.look_again();
    }

    /// Finds the contacts of the moment and adds their forces to the nodes; the ground has not got them yet.
    ///
    /// - `law`: of a node on this ground; `on_ground`: takes each contact, its place and its stiffness [N/m]
    pub(crate) fn add_forces(
        &mut self,
        ground: &Surface,
        solid: &mut Solid,
        debris: &mut Debris,
        law: impl Fn(&Solid, &Debris, u32) -> Linear + Sync,
        dt: f64,
    ) -> Work {
        self.search(ground, solid);
        let NodesOnSurface { nodes, position, velocity, spin, radius, contacts, .. } = self;
        for k in contacts.near() {
            spin[k as usize] = debris.turning_at(solid, nodes[k as usize]);
        }
        let spheres = Spheres { position, velocity, spin, radius };
        let work = {
            let (solid, debris, nodes, radius) = (&*solid, &*debris, &*nodes, &*radius);
            let law = |k: u32, _| {
                let own = law(solid, debris, nodes[k as usize]);
                // Points do not roll.
                if radius[k as usize] > 0.0 { own } else { Linear { rolling: Rolling::default(), ..own } }
            };
            contacts.update(ground, &spheres, law, dt)
        };
        for touch in contacts.touches() {
            let node = nodes[touch.sphere as usize];
            solid.force[node as usize] += touch.force;
            debris.add_torque_at(solid, node, touch.moment);
        }
        work
    }

    /// Contacts of the last step with their places in space and their nodes.
    pub(crate) fn touches(&self) -> impl Iterator<Item = (&Touch<ContactMemory>, Vec3, u32)> {
        let place = |t: &Touch<ContactMemory>| self.position[t.sphere as usize] + t.offset;
        self.contacts.touches().map(move |t| (t, place(t), self.nodes[t.sphere as usize]))
    }
}

/// Squared frequency that a contact asks of the step [1/s²].
///
/// - `mobility`: sum of the squared shares over the masses of all nodes that it moves [1/kg]
pub(super) fn frequency_square(law: &Linear, mobility: f64) -> f64 {
    let (normal, tangential) = law.stiffness(0.0);
    RESOLUTION * RESOLUTION * normal.max(TURNING * tangential) * mobility
}
