//! Elements that hold attached particles against turning.

use std::collections::BTreeSet;

use fractum_fem::{Solid, neighbours};
use fractum_math::{Mat3, Ragged, Vec3};

/// The element that turns with each attached particle.
///
/// A node has no rotation of its own, but contact off its centre asks for one. An attached particle turns with a live element
/// of its node, ω = J⁻¹ Σ r × v over the nodes of the element with J = Σ (r² I - r rᵀ) about their mean, and passes torques on by
/// the transpose: forces (J⁻¹ M) × r on the same nodes, whose sum is zero and whose moment is M. So contact conserves angular
/// momentum, and its power on the nodes is the power that the contact law sees.
#[derive(Clone, Debug, Default)]
pub(crate) struct Holders {
    /// Elements of each node: those of the first body, then the next; empty before the first particle.
    elements_of_node: Ragged,
    /// First element of each body there, and of all.
    first: Vec<u32>,
    /// The same if all elements of all bodies are counted, those that this rank does not have too.
    first_number: Vec<u32>,
}

/// Nodes of an element and the geometry of its rotation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Holder {
    /// Its number among the elements of all bodies, of those of all ranks.
    pub(crate) number: u32,
    nodes: [u32; 4],
    corners: usize,
    middle: Vec3,
    inverse_inertia: Mat3,
}

impl Holders {
    /// Finds the elements around all nodes.
    pub(crate) fn new(solid: &Solid) -> Self {
        let (mut first, mut first_number) = (vec![0], vec![0]);
        for body in 0..solid.body_count() {
            first.push(first[body] + solid.body(body).elements.len() as u32);
            first_number.push(first_number[body] + neighbours::element_count(solid, body) as u32);
        }
        let rows = (0..solid.body_count()).flat_map(|body| {
            let corners = solid.body(body).shape.node_count();
            solid.body(body).elements.iter().map(move |e| &e[..corners])
        });
        Holders { elements_of_node: Ragged::inverse(solid.reference.len(), rows), first, first_number }
    }

    /// Whether nothing has been looked up yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Whether a live element holds the node.
    pub(crate) fn is_held(&self, solid: &Solid, node: u32) -> bool {
        self.elements_of_node.row(node as usize).iter().any(|&e| is_alive(solid, self.place(e)))
    }

    /// The first live element of a node that has not collapsed, see [`Holders::element`].
    ///
    /// - `radius`: of the particle [m]
    pub(crate) fn of(&self, solid: &Solid, node: u32, radius: f64) -> Option<Holder> {
        let elements = self.elements_of_node.row(node as usize).iter();
        let place = |&element: &u32| self.place(element);
        elements.map(place).filter(|at| is_alive(solid, *at)).find_map(|at| self.at(solid, at, radius))
    }

    /// An element by its number, alive or not; none if its J is below the square of the radius about some axis: a
    /// tangential force at the surface of the particle would then turn it faster than the stable step takes into account.
    pub(crate) fn element(&self, solid: &Solid, number: u32, radius: f64) -> Option<Holder> {
        let body = self.first_number.partition_point(|&first| first <= number) - 1;
        // Every rank has the elements around particles.
        let element = neighbours::element_of_number(solid, body, number - self.first_number[body])?;
        self.at(solid, (body, element as usize), radius)
    }

    /// The same by body and element.
    fn at(&self, solid: &Solid, (body, element): (usize, usize), radius: f64) -> Option<Holder> {
        let number = self.first_number[body] + neighbours::element_number(solid, body, element as u32);
        let corners = solid.body(body).shape.node_count();
        let nodes = solid.body(body).elements[element];
        let live = &nodes[..corners];
        let middle = live.iter().map(|&n| solid.position(n as usize)).sum::<Vec3>() / corners as f64;
        let arms = live.iter().map(|&n| solid.position(n as usize) - middle);
        let (inverse_inertia, size, limit) = if corners == 3 {
            // Nothing turns but about z.
            let inverse = 1.0 / arms.map(|r| r.norm_squared() - r.z * r.z).sum::<f64>();
            (Mat3::from_diagonal(&Vec3::new(0.0, 0.0, inverse)), inverse, 1.0)
        } else {
            let inertia = arms.map(|r| Mat3::identity() * r.norm_squared() - r * r.transpose()).sum::<Mat3>();
            let inverse = inertia.try_inverse()?;
            (inverse, inverse.norm(), 3f64.sqrt())
        };
        let turns = radius * radius * size <= limit;
        turns.then_some(Holder { number, nodes, corners, middle, inverse_inertia })
    }

    /// Nodes of all elements, alive or not, that have one of some nodes, ascending.
    pub(crate) fn nodes_near(&self, solid: &Solid, nodes: impl Iterator<Item = u32>) -> Vec<u32> {
        let around: BTreeSet<u32> = nodes.flat_map(|node| self.elements_of_node.row(node as usize)).copied().collect();
        let nodes_of = |element: u32| {
            let (body, element) = self.place(element);
            let corners = solid.body(body).shape.node_count();
            solid.body(body).elements[element].into_iter().take(corners)
        };
        let near: BTreeSet<u32> = around.into_iter().flat_map(nodes_of).collect();
        near.into_iter().collect()
    }

    /// Body and element of one in the rows of nodes.
    fn place(&self, element: u32) -> (usize, usize) {
        let body = self.first.partition_point(|&f| f <= element) - 1;
        (body, (element - self.first[body]) as usize)
    }
}

fn is_alive(solid: &Solid, (body, element): (usize, usize)) -> bool {
    solid.alive(body)[element]
}

impl Holder {
    /// Angular velocity of the element [rad/s].
    pub(crate) fn spin(&self, solid: &Solid) -> Vec3 {
        let momentum = |&n: &u32| (solid.position(n as usize) - self.middle).cross(&solid.velocity[n as usize]);
        self.inverse_inertia * self.nodes[..self.corners].iter().map(momentum).sum::<Vec3>()
    }

    /// Adds forces of no sum and of moment `torque` [N m] to the nodes.
    pub(crate) fn add_torque(&self, solid: &mut Solid, torque: Vec3) {
        let turn = self.inverse_inertia * torque;
        for &n in &self.nodes[..self.corners] {
            let arm = solid.position(n as usize) - self.middle;
            solid.force[n as usize] += turn.cross(&arm);
        }
    }
}
