//! One scene that several ranks advance together: which nodes all of them must move, and what they cannot share.

use std::sync::Arc;

use fractum_fem::neighbours::{self, SolidPart};
use fractum_fem::{Solid, removal};
use fractum_parallel::Exchange;

use crate::saved::{SceneState, state_with};
use crate::scene::Scene;

/// Nodes of solids and particles that every rank moves, since they are looked at after every step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Watched {
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Particles.
    pub particles: Vec<u32>,
}

/// What ranks cannot share of this scene, in words; none where they can.
pub fn cannot_be_distributed(scene: &Scene) -> Option<&'static str> {
    if scene.optional.heat.is_some() {
        return Some("heat");
    }
    if !scene.optional.inlets.is_empty() {
        return Some("particles that come in through an inlet");
    }
    scene.bonded.cannot_be_distributed().filter(|_| scene.solid.body_count() == 0)
}

/// What has every rank do alike what particles and bonds do, in words; none where they are shared.
pub fn keeps_particles_whole(scene: &Scene) -> Option<&'static str> {
    let few = || (!scene.bonded.has_blocks()).then_some("their number: up to 2048 are not divided");
    scene.bonded.cannot_be_distributed().or_else(few)
}

/// Whether every step needs sums over all nodes: of what damping takes, or of the momentum that gravity works on.
fn needs_sums(scene: &Scene) -> bool {
    let damping = scene.settings.damping;
    damping.local != 0.0 || damping.mass_rate != 0.0 || scene.loads.has_weight()
}

/// Nodes that contacts, discrete elements, ties, and pressure and gas in cracks look at. Every rank does alike what is no cell of a solid.
fn nodes_of_others(scene: &mut Scene) -> Vec<u32> {
    let mut touching = corners(&scene.solid, &removal::removed_elements(&scene.solid));
    scene.contacts.each_node(|node| touching.push(node));
    touching.extend(scene.shape_contacts.iter().flat_map(|ground| &ground.candidates).map(|c| c.node));
    let tied = scene.ties.nodes();
    if touching.is_empty() {
        return tied.collect();
    }
    tied.chain(scene.debris.nodes_near(&scene.solid, touching.into_iter())).collect()
}

/// Has every rank move the nodes that are looked at where elements were just removed.
pub(crate) fn follow_removal(scene: &mut Scene) {
    if neighbours::is_distributed(&scene.solid) {
        let born = corners(&scene.solid, &scene.removals.last);
        let near = scene.debris.nodes_near(&scene.solid, born.into_iter());
        neighbours::follow_nodes(&mut scene.solid, &near);
    }
}

/// Leaves a share of the cells, particles and bonds to each rank of an exchange. Every rank must have the same scene in the same
/// state, and all of them step it together from then on; see [`gather_all`].
///
/// - `watched`: nodes and particles that are looked at after every step, where that is more than those of supports that move and of loads
pub fn distribute(scene: &mut Scene, exchange: Arc<dyn Exchange>, watched: &Watched) {
    if keeps_particles_whole(scene).is_none() {
        let near: Vec<u32> = watched.particles.iter().copied().chain(scene.contacts.near()).collect();
        scene.bonded.distribute(Arc::clone(&exchange), near.into_iter());
        scene.bonded.set_near(scene.contacts.near_pairs());
    }
    if scene.solid.body_count() == 0 {
        return;
    }
    let sums = needs_sums(scene);
    let mut everywhere: Vec<u32> = scene.supports.driven().chain(scene.loads.points()).collect();
    everywhere.extend(&watched.nodes);
    everywhere.extend(nodes_of_others(scene));
    neighbours::distribute(&mut scene.solid, exchange, &everywhere, sums);
}

/// Brings displacements and velocities of all nodes up to date. All ranks must call it.
pub fn gather_nodes(scene: &mut Scene) {
    neighbours::gather_nodes(&mut scene.solid);
}

/// The state in parts: what this rank knows best of the solids, and all the rest. All ranks must call it; none where no solid is
/// shared.
pub fn state_in_parts(scene: &mut Scene) -> Option<(SceneState, SolidPart)> {
    let part = neighbours::state_part(&scene.solid).filter(|_| scene.solid.body_count() > 0)?;
    gather_particles(scene);
    gather_contacts(scene);
    gather_supports(scene);
    Some((state_with(scene, neighbours::state_beside_parts(&scene.solid)), part))
}

/// A state by its parts, before the first step of a scene from the same case; none if they do not belong to it.
pub fn joined(scene: &Scene, beside: SceneState, parts: &[SolidPart]) -> Option<SceneState> {
    beside.with_solid(|solid| neighbours::joined(&scene.solid, solid, parts))
}

/// Brings the motion of all particles up to date. All ranks must call it.
pub fn gather_motion(scene: &mut Scene) {
    scene.bonded.gather_motion();
}

/// Brings the memory of some bonds (body, bond) up to date. All ranks must name the same ones.
pub fn gather_bonds(scene: &mut Scene, bonds: &[(u32, u32)]) {
    scene.bonded.gather_bonds(bonds);
}

/// Brings particles and what their bonds and crack faces remember up to date. All ranks must call it.
pub fn gather_particles(scene: &mut Scene) {
    scene.bonded.gather();
}

/// Brings the memory of contacts among particles up to date. All ranks must call it.
pub fn gather_contacts(scene: &mut Scene) {
    let Scene { bonded, contacts, .. } = scene;
    bonded.with_part(|part, _| part.into_iter().for_each(|part| contacts.gather_memories(part)));
}

/// Brings the energies of supports on facets up to date. All ranks must call it.
fn gather_supports(scene: &mut Scene) {
    let Scene { optional, solid, .. } = scene;
    optional.surface_supports.gather(solid);
}

/// Does the searches for contacts of particles that are due on any rank.
pub(crate) fn search_together(scene: &mut Scene) {
    let Scene { bonded, contacts, solid, debris, .. } = scene;
    let due = bonded.with_part(|part, particles| Some(contacts.due_on_any(part?, solid, debris, particles)));
    if let Some(due) = due.filter(|due| due.contains(&true)) {
        bonded.gather_motion();
        contacts.search(&due, solid, debris, &bonded.particles);
        follow_near(scene);
    }
}

/// Has every rank move the particles that may touch what all ranks look at, and sends the motion of those that may touch each other.
pub(crate) fn follow_near(scene: &mut Scene) {
    let Scene { bonded, contacts, .. } = scene;
    if !bonded.is_distributed() {
        return;
    }
    bonded.follow(&contacts.near().collect::<Vec<_>>());
    bonded.set_near(contacts.near_pairs());
}

/// Brings the forces between particles up to date, where probes ask for them. All ranks must call it.
pub(crate) fn gather_watched(scene: &mut Scene) {
    if scene.contacts.watches_pairs() {
        let Scene { bonded, contacts, .. } = scene;
        bonded.gather_motion();
        bonded.with_part(|part, _| part.into_iter().for_each(|part| contacts.gather_loads(part)));
    }
}

/// Brings what this rank has of the damage of others up to date. All ranks must call it, after a step that was measured.
pub fn gather_damage(scene: &mut Scene) {
    neighbours::gather_damage(&mut scene.solid);
}

/// Brings what this rank has of the nodes and cells of others up to date, before anyone looks at all of them. All ranks must
/// call it. Energies are up to date without it where a step has measured.
pub fn gather_all(scene: &mut Scene) {
    neighbours::gather_all(&mut scene.solid, scene.clock.dt_before);
    gather_particles(scene);
    gather_contacts(scene);
    gather_supports(scene);
}

/// Nodes of elements (body, number).
fn corners(solid: &Solid, elements: &[(usize, u32)]) -> Vec<u32> {
    let of = |&(body, element): &(usize, u32)| {
        let body = solid.body(body);
        body.elements[element as usize].into_iter().take(body.shape.node_count())
    };
    elements.iter().flat_map(of).collect()
}
