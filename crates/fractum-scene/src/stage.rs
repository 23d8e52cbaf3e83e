//! What a stage changes: supports, loads, settings, and bodies that leave and come in.

use fractum_fem::{Solid, removal};
use fractum_math::Vec3;

use crate::conditions::Release;
use crate::excavation::Excavation;
use crate::leave::{interfaces_lose_elements, let_go};
use crate::scene::Scene;

impl Scene {
    /// Goes on with the supports, loads and settings of another scene of the same solids, without the bodies that leave and with those that come in.
    ///
    /// - `moving`: whether the scene moves
    pub fn begin_stage(&mut self, next: Scene, moving: bool) {
        (self.supports, self.settings) = (next.supports, next.settings);
        self.optional.is_between_equilibria = false;
        let before = std::mem::replace(&mut self.loads, next.loads);
        self.loads.follow(before, &self.solid);
        let since = if moving { self.clock.dt_before } else { 0.0 };
        self.optional.interfaces.take_pressures(next.optional.interfaces);
        let excavation = next.optional.excavation;
        let bear = excavation.as_ref().map(|_| forces(self, since));
        let stored = self.optional.surface_supports.stored();
        self.optional.surface_supports.gather(&self.solid);
        self.books.absorbed += self.optional.surface_supports.absorbed();
        self.optional.surface_supports = next.optional.surface_supports;
        self.removals.domain = next.removals.domain;
        if let (Some(excavation), Some(bear)) = (excavation, bear) {
            excavate(self, &excavation, since, &bear);
            install(self, &excavation.installed);
            self.books.left += stored - self.optional.surface_supports.stored();
        }
    }
}

/// The scene of a stage that begins without some bodies, see [`Scene::begin_stage`].
///
/// - `gone`: all that have left by then or have not come in yet
pub fn with_excavation(mut scene: Scene, excavation: Excavation, gone: &[usize]) -> Scene {
    let mut elements: Vec<(usize, u32)> = Vec::new();
    for &body in gone {
        removal::take_out_body(&mut scene.solid, 0.0, body);
        elements.extend((0..scene.solid.alive(body).len() as u32).map(|element| (body, element)));
    }
    let (nodes, mut leaves) = (orphans(&scene.solid, gone), vec![false; scene.solid.reference.len()]);
    scene.supports.hold(&nodes, leaves.len());
    scene.removals.left.elements += elements.len();
    for node in nodes {
        scene.removals.left.push(node);
        leaves[node as usize] = true;
    }
    let_go(&mut scene, &leaves, &elements);
    if !gone.is_empty() && !scene.settings.time_step.element_bound {
        scene.frequencies.stable = scene.solid.stable_step();
    }
    scene.optional.excavation = Some(Box::new(excavation));
    scene
}

/// What the loads of a scene still bear of bodies that have left: nodes, and the force on each [N], see [`Excavation`].
pub fn released_forces(scene: &Scene) -> impl Iterator<Item = (u32, Vec3)> {
    scene.loads.released_forces(scene.clock.time)
}

/// Takes bodies out and lets what they bore fade.
///
/// - `dt`: time since the forces were last computed; 0 at rest [s]
/// - `bear`: forces on all nodes before, see [`forces`]
fn excavate(scene: &mut Scene, excavation: &Excavation, dt: f64, bear: &[Vec3]) {
    let Excavation { bodies, over, share, is_smooth, .. } = excavation;
    let begin = scene.clock.time;
    let end = over.map_or(scene.settings.time_step.end, |over| begin + over);
    let touched = nodes_of(&scene.solid, bodies);
    let before: Vec<f64> = touched.iter().map(|&node| scene.solid.mass[node as usize]).collect();
    let velocity: Vec<Vec3> = touched.iter().map(|&node| scene.solid.velocity[node as usize]).collect();
    let mut elements: Vec<(usize, u32)> = Vec::new();
    for &body in bodies {
        let alive = (0..).zip(scene.solid.alive(body)).filter(|(_, alive)| **alive);
        elements.extend(alive.map(|(element, _)| (body, element)));
        scene.books.left += removal::take_out_body(&mut scene.solid, dt, body);
    }
    let gone = orphans(&scene.solid, bodies);
    let is_gone = |node: &u32| gone.binary_search(node).is_ok();
    let Scene { solid, removals, .. } = scene;
    for ((node, before), velocity) in touched.iter().zip(before).zip(velocity) {
        let lost = if is_gone(node) { before } else { before - solid.mass[*node as usize] };
        removals.left.mass += lost;
        removals.left.momentum += velocity * lost;
    }
    removals.left.pieces += bodies.len();
    removals.left.elements += elements.len();
    gone.iter().for_each(|&node| removals.left.push(node));
    let mut leaves = vec![false; solid.reference.len()];
    gone.iter().for_each(|&node| leaves[node as usize] = true);
    interfaces_lose_elements(scene, &elements);
    let_go(scene, &leaves, &elements);
    let left = forces(scene, dt);
    let missing = |node: &u32| (*node, bear[*node as usize] - left[*node as usize]);
    scene.loads.go_on_releasing([begin, end], *is_smooth, is_gone);
    let missing = touched.iter().filter(|node| !is_gone(node)).map(missing).collect();
    scene.loads.release(Release {
        forces: missing,
        time: [begin, end],
        part: [1.0, 1.0 - share],
        is_smooth: *is_smooth,
    });
}

/// Lets bodies come in.
fn install(scene: &mut Scene, bodies: &[usize]) {
    if bodies.is_empty() {
        return;
    }
    let nodes = all_nodes(&scene.solid, bodies);
    let Scene { solid, removals, books, .. } = &mut *scene;
    removals.left.bring_back(&nodes);
    let before: Vec<f64> = nodes.iter().map(|&node| solid.mass[node as usize]).collect();
    for &body in bodies {
        books.left -= removal::put_in_body(solid, body);
        removals.left.elements -= solid.alive(body).len();
    }
    for (&node, before) in nodes.iter().zip(before) {
        let gained = solid.mass[node as usize] - before;
        removals.left.momentum -= solid.velocity[node as usize] * gained;
    }
}

/// Forces on all nodes as they stand, of stress, loads, springs on facets and interfaces [N].
///
/// - `dt`: as in [`excavate`]
fn forces(scene: &mut Scene, dt: f64) -> Vec<Vec3> {
    // Forces of damaged cells are found together with their history, which is that of the step to come.
    let mut solid = scene.solid.clone();
    solid.update_internal_forces(dt, false);
    scene.loads.add_forces(&mut solid, scene.clock.time, 0.0);
    scene.optional.surface_supports.push(&mut solid);
    scene.optional.interfaces.add_forces_at_rest(&mut solid);
    solid.force
}

/// Nodes of elements of bodies that are there, ascending.
fn nodes_of(solid: &Solid, bodies: &[usize]) -> Vec<u32> {
    let of_body = |&body: &usize| {
        let corners = solid.body(body).shape.node_count();
        let alive = solid.body(body).elements.iter().zip(solid.alive(body)).filter(|(_, alive)| **alive);
        alive.flat_map(move |(nodes, _)| nodes[..corners].iter().copied())
    };
    let mut nodes: Vec<u32> = bodies.iter().flat_map(of_body).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Nodes of bodies that have left which no other body has, ascending.
fn orphans(solid: &Solid, gone: &[usize]) -> Vec<u32> {
    let all: Vec<usize> = (0..solid.body_count()).collect();
    let there = nodes_of(solid, &all);
    let mut nodes = all_nodes(solid, gone);
    nodes.retain(|node| there.binary_search(node).is_err());
    nodes
}

/// Nodes of bodies, whether these are there or not, ascending.
fn all_nodes(solid: &Solid, bodies: &[usize]) -> Vec<u32> {
    let of_body = |&body: &usize| {
        let corners = solid.body(body).shape.node_count();
        solid.body(body).elements.iter().flat_map(move |nodes| nodes[..corners].iter().copied())
    };
    let mut nodes: Vec<u32> = bodies.iter().flat_map(of_body).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
