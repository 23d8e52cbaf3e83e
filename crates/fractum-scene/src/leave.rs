//! Free pieces that are wholly outside the domain of a run leave it.

use fractum_math::Vec3;

use crate::conditions::Population;
use crate::conduct::heat_loses_elements;
use crate::domain::{Domain, Left};
use crate::fragment::parts;
use crate::ranks::{gather_contacts, gather_nodes};
use crate::scene::Scene;
use crate::stable_step::update_wall_frequency;
use fractum_fem::removal;

/// Steps between two looks for pieces that have left the domain.
const STEPS_BETWEEN_FAREWELLS: u64 = 100;

impl Scene {
    /// The same scene, in which free pieces outside a box leave the run.
    pub fn with_domain(mut self, domain: Domain) -> Self {
        self.removals.domain = Some(domain);
        self
    }

    /// The box outside of which free pieces leave the run.
    pub fn domain(&self) -> Option<Domain> {
        self.removals.domain
    }

    /// What has left the run.
    pub fn left(&self) -> &Left {
        &self.removals.left
    }
}

/// Whether a point of a population is out of the run: it has left, or has not come in yet.
pub(crate) fn is_out(scene: &Scene, population: Population) -> impl Fn(u32) -> bool {
    let of_nodes = matches!(population, Population::Nodes);
    let mut left: Vec<u32> = Vec::new();
    if of_nodes {
        left.extend(scene.left().nodes(scene.solid.reference.len()));
        left.sort_unstable();
    }
    move |point| {
        if of_nodes { left.binary_search(&point).is_ok() } else { scene.bonded.particles.is_out(point as usize) }
    }
}

/// Has nothing push what has left, which rests where it was then.
pub(crate) fn hold_departed_particles(scene: &mut Scene) {
    let Scene { removals, solid, .. } = scene;
    for node in removals.left.nodes(solid.reference.len()) {
        solid.force[node as usize] = Vec3::zeros();
    }
}

/// Lets pieces of bonded bodies and loose particles leave, between the forces of tⁿ and the kick.
///
/// - `dt`: the step that led to tⁿ [s]
pub(crate) fn remove_departed_particles(scene: &mut Scene, dt: f64) {
    let Some(domain) = domain_to_look_at(scene) else { return };
    scene.bonded.gather_motion();
    if !scene.bonded.has_outside(&domain) {
        return;
    }
    scene.bonded.gather();
    scene.bonded.gather_forces();
    gather_contacts(scene);
    let mut touching: Vec<u32> = Vec::new();
    scene.contacts.each_touching_particle(|i| touching.push(i));
    let (energy, gone) = scene.bonded.let_leave(&domain, &touching, dt, &mut scene.removals.left);
    scene.books.left += energy;
    if !gone.is_empty() {
        gone.iter().for_each(|&i| scene.removals.left.push(scene.solid.reference.len() as u32 + i));
        scene.contacts.look_again(&scene.bonded.particles.radius);
    }
}

/// Lets every piece of the solids leave that is wholly outside the domain, that no support holds, and that touches nothing.
///
/// The energy that goes is that of the half step, ½ m v² of the nodes and ½ σ¹ : ε⁰ of the elements, which central differences
/// conserve: the balance of free elastic pieces closes to rounding.
///
/// - `dt`: time since the forces were last computed [s]
pub(crate) fn remove_departed_fragments(scene: &mut Scene, dt: f64) {
    let Some(domain) = domain_to_look_at(scene) else { return };
    gather_nodes(scene);
    let (solid, planar) = (&scene.solid, scene.solid.is_plane());
    let mut gone = vec![false; solid.reference.len()];
    scene.removals.left.nodes(gone.len()).for_each(|node| gone[node as usize] = true);
    let outside: Vec<bool> = (0..gone.len()).map(|node| domain.is_outside(&solid.position(node), planar)).collect();
    if !outside.iter().zip(&gone).any(|(outside, gone)| *outside && !gone) {
        return;
    }
    let joined: Vec<[u32; 2]> = scene.interfaces().links(scene.settings.joined_below).collect();
    let piece = parts(solid, &joined);
    let mut stays = vec![false; gone.len()];
    outside.iter().zip(&piece).filter(|(outside, _)| !**outside).for_each(|(_, &p)| stays[p as usize] = true);
    each_bound_node(scene, |node| stays[piece[node as usize] as usize] = true);
    let leaves: Vec<bool> = (0..gone.len()).map(|node| !gone[node] && !stays[piece[node] as usize]).collect();
    if leaves.contains(&true) {
        take_leave(scene, &leaves, &piece, dt);
    }
}

/// The box, where it is time to look for what is outside of it.
fn domain_to_look_at(scene: &Scene) -> Option<Domain> {
    scene.removals.domain.filter(|_| scene.clock.step.is_multiple_of(STEPS_BETWEEN_FAREWELLS))
}

/// Visits every node that a support holds or that touches something.
fn each_bound_node(scene: &Scene, mut visit: impl FnMut(u32)) {
    let held = (0..).zip(scene.supports.held()).filter(|(_, held)| **held != 0).map(|(node, _)| node);
    held.for_each(&mut visit);
    scene.optional.surface_supports.nodes().for_each(&mut visit);
    scene.debris.bound_nodes().for_each(&mut visit);
    scene.ties.nodes().for_each(&mut visit);
    scene.contacts.each_touching_node(&scene.debris, &scene.bonded.particles, &mut visit);
    for candidate in scene.shape_contacts.iter().flat_map(|ground| &ground.candidates) {
        if candidate.is_loaded() {
            visit(candidate.node);
        }
    }
}

fn take_leave(scene: &mut Scene, leaves: &[bool], piece: &[u32], dt: f64) {
    let mut elements: Vec<(usize, u32)> = Vec::new();
    for body in 0..scene.solid.body_count() {
        let of_body = (0..).zip(&*scene.solid.body(body).elements).zip(scene.solid.alive(body));
        let leaving = of_body.filter(|((_, nodes), alive)| **alive && leaves[nodes[0] as usize]);
        elements.extend(leaving.map(|((element, _), _)| (body, element)));
    }
    let mut energy =
        scene.debris.spin_energy(&scene.solid, leaves) + removal::take_out(&mut scene.solid, dt, &elements);
    let Scene { solid, removals, .. } = scene;
    for node in (0..leaves.len()).filter(|&node| leaves[node]) {
        let (mass, velocity) = (solid.mass[node], std::mem::take(&mut solid.velocity[node]));
        energy += 0.5 * mass * velocity.norm_squared();
        removals.left.mass += mass;
        removals.left.momentum += velocity * mass;
        removals.left.pieces += usize::from(piece[node] as usize == node);
        removals.left.push(node as u32);
    }
    interfaces_lose_elements(scene, &elements);
    scene.removals.left.elements += elements.len();
    scene.books.left += energy;
    let_go(scene, leaves, &elements);
    if !elements.is_empty() && !scene.settings.time_step.element_bound {
        scene.frequencies.stable = scene.solid.stable_step();
    }
}

/// Gives up the interfaces beside elements that have left; their energy leaves with them.
pub(crate) fn interfaces_lose_elements(scene: &mut Scene, elements: &[(usize, u32)]) {
    let Scene { solid, optional, books, .. } = scene;
    let lost = optional.interfaces.lose(solid, elements);
    books.interfaces -= lost;
    books.left += lost;
}

/// Has heat and contact do without nodes and elements that have left.
pub(crate) fn let_go(scene: &mut Scene, leaves: &[bool], elements: &[(usize, u32)]) {
    if !elements.is_empty() {
        heat_loses_elements(scene);
    }
    let born = scene.debris.state().nodes.clone();
    scene.debris.let_leave(&scene.solid, leaves);
    let Scene { solid, debris, contacts, bonded, removals, .. } = scene;
    let gone: Vec<u32> = removals.left.nodes(leaves.len()).collect();
    contacts.let_nodes_leave(solid, debris, bonded.particles.len(), &born, &gone, elements);
    for ground in &mut scene.shape_contacts {
        ground.candidates.retain(|candidate| !leaves[candidate.node as usize]);
    }
    update_wall_frequency(scene);
}
