//! Balls that press on few nodes of a solid: what an element gives way there counts for more than the contact does.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use fractum_contact::Shape;
use fractum_fem::{Body, ElementKind, Formulation};
use fractum_math::Vec3;
use fractum_math::elementary::{atan2, pow};

use crate::contacts::NodesOnShape;
use crate::scene::Scene;

/// Nodes in a contact, from which on its force at a given depth is within a tenth of Hertz': of smoothed elements and of plain ones. With nine
/// it is off by 15 and by 35 %, with one up to 2.3 and 3.6 times too large.
const NODES: [usize; 2] = [16, 40];
/// Share of the way of the nodes that is indentation, below which the bending of a body says how large a force is.
const INDENTS: f64 = 0.3;
/// Elements over the radius of a contact by which it has about as many nodes.
const SIZES: [f64; 2] = [2.5, 4.0];

/// A rigid ball on few nodes of a solid body in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Indentation {
    /// Number of the rigid body.
    pub rigid_body: usize,
    /// Number of the solid body.
    pub body: usize,
    /// Nodes that it presses on.
    pub nodes: usize,
    /// Nodes that it should press on.
    pub wanted: usize,
    /// Radius of the contact by Hertz under its force [m].
    pub radius: f64,
    /// Size of the elements that give it as many nodes [m].
    pub size: f64,
}

/// The first ball that presses on too few nodes now, so that its force at this depth, or its depth under this force, is that of the mesh.
pub fn coarsest_indentation(scene: &Scene) -> Option<Indentation> {
    scene.shape_contacts.iter().find_map(|ground| coarse(scene, ground))
}

fn coarse(scene: &Scene, ground: &NodesOnShape) -> Option<Indentation> {
    let (Shape::Ball { radius }, Some(rigid_body)) = (ground.shape, ground.rigid_body) else { return None };
    let (solid, debris) = (&scene.solid, &scene.debris);
    let touching = || ground.candidates.iter().filter(|c| c.force != Vec3::zeros());
    let body = debris.body(touching().next()?.node);
    let of_body = solid.body(body);
    if of_body.shape != ElementKind::T4 {
        return None;
    }
    let nodes = touching().count();
    let kind = usize::from(of_body.formulation == Formulation::Standard);
    if nodes >= NODES[kind] {
        return None;
    }
    let force: Vec3 = touching().map(|c| c.force).sum();
    let along = force.normalize();
    let ways = touching().map(|c| (c.node, solid.displacement[c.node as usize].dot(&along)));
    let (pole, way) = ways.max_by(|a, b| a.1.total_cmp(&b.1))?;
    // A half or a quarter of a body, cut along its planes of symmetry, has a part of the nodes and of the force.
    let angles = solid_angles(of_body, &solid.reference, touching().map(|c| c.node));
    let share = angles[&pole] / TAU;
    let whole = angles.values().sum::<f64>() / angles[&pole];
    if whole >= NODES[kind] as f64 - 0.5 {
        return None;
    }
    let modulus = of_body.elastic.young_modulus / (1.0 - of_body.elastic.poisson_ratio.powi(2));
    let depth = pow(0.75 * force.norm() / (share * modulus * radius.sqrt()), 2.0 / 3.0);
    if depth < INDENTS * way || way <= 0.0 {
        return None;
    }
    let contact = (radius * depth).sqrt();
    let wanted = (NODES[kind] as f64 * nodes as f64 / whole).ceil() as usize;
    Some(Indentation { rigid_body, body, nodes, wanted, radius: contact, size: contact / SIZES[kind] })
}

/// Solid angles that the elements of a body fill around nodes [sr]: 2π in a flat surface, π where that ends at a plane of symmetry.
fn solid_angles(body: &Body, places: &[Vec3], nodes: impl Iterator<Item = u32>) -> BTreeMap<u32, f64> {
    let mut found: BTreeMap<u32, f64> = nodes.map(|node| (node, 0.0)).collect();
    for element in body.elements.iter() {
        for corner in 0..4 {
            let Some(angle) = found.get_mut(&element[corner]) else { continue };
            let apex = places[element[corner] as usize];
            let [a, b, c] = [1, 2, 3].map(|k| (places[element[(corner + k) % 4] as usize] - apex).normalize());
            // Van Oosterom & Strackee 1983.
            let volume = a.dot(&b.cross(&c)).abs();
            *angle += 2.0 * atan2(volume, 1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a));
        }
    }
    found
}
