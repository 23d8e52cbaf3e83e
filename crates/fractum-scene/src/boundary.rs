//! Supports and loads: what is prescribed, what pushes, and the work both do.

use std::sync::Arc;

use fractum_fem::Solid;
use fractum_math::{CHUNK, HalfSteps, Vec3};
use rayon::prelude::*;

use crate::error::SceneError;

/// A value over time [s] and reference position [m], in SI units.
pub type TimeFunction = Arc<dyn Fn(f64, &Vec3) -> f64 + Send + Sync>;

/// How a support moves.
#[derive(Clone)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// By a velocity [m/s].
    Velocity(TimeFunction),
    /// By a displacement [m].
    Displacement(TimeFunction),
}

/// One axis of a set of nodes, prescribed.
#[derive(Clone)]
pub struct Support {
    /// The user's name for it.
    pub name: String,
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Axis 0, 1 or 2.
    pub axis: usize,
    /// How it moves.
    pub motion: Motion,
    /// Velocity of each node before the kick [m/s].
    before: Vec<f64>,
    /// Force of the support on each node at tⁿ [N].
    reaction: Vec<f64>,
}

impl Support {
    /// A support of `nodes` along `axis` (0, 1, 2).
    pub fn new(name: &str, nodes: Vec<u32>, axis: usize, motion: Motion) -> Self {
        let zeros = vec![0.0; nodes.len()];
        Support { name: name.to_owned(), nodes, axis, motion, before: zeros.clone(), reaction: zeros }
    }
}

/// All supports of a scene.
#[derive(Clone, Default)]
pub struct Supports {
    sets: Vec<Support>,
    /// Bit a is set where axis a of a node is prescribed; empty without supports.
    held: Vec<u8>,
}

impl Supports {
    /// Collects supports; nodes that two fixed supports share are kept once.
    ///
    /// # Errors
    /// [`SceneError::ContradictorySupports`] if a degree of freedom is prescribed in two ways.
    pub fn new(mut sets: Vec<Support>, reference: &[Vec3]) -> Result<Self, SceneError> {
        let mut owner: Vec<[u32; 3]> = vec![[u32::MAX; 3]; if sets.is_empty() { 0 } else { reference.len() }];
        for index in 0..sets.len() {
            let axis = sets[index].axis;
            let mut kept = Vec::with_capacity(sets[index].nodes.len());
            for &node in &sets[index].nodes {
                let place = &mut owner[node as usize][axis];
                if *place == u32::MAX {
                    *place = index as u32;
                    kept.push(node);
                    continue;
                }
                let first = &sets[*place as usize];
                if !(matches!(first.motion, Motion::Fixed) && matches!(sets[index].motion, Motion::Fixed)) {
                    let p = reference[node as usize];
                    return Err(SceneError::ContradictorySupports {
                        first: first.name.clone(),
                        second: sets[index].name.clone(),
                        axis: ['x', 'y', 'z'][axis],
                        x: p.x,
                        y: p.y,
                        z: p.z,
                    });
                }
            }
            let set = &mut sets[index];
            *set = Support::new(&set.name, kept, axis, set.motion.clone());
        }
        let bits = |axes: &[u32; 3]| (0..3).filter(|&a| axes[a] != u32::MAX).fold(0u8, |bits, a| bits | 1 << a);
        let held = owner.iter().map(bits).collect();
        Ok(Supports { sets, held })
    }

    /// Bit a of a node is set where its axis a is prescribed; empty without supports.
    pub fn held(&self) -> &[u8] {
        &self.held
    }

    /// Degrees of freedom that are prescribed.
    pub fn count(&self) -> usize {
        self.sets.iter().map(|s| s.nodes.len()).sum()
    }

    /// Places (set, entry, axis) of the prescribed degrees of freedom of these nodes.
    pub fn places(&self, nodes: &[u32]) -> Vec<(u32, u32, u32)> {
        let mut places = Vec::new();
        for (set, support) in self.sets.iter().enumerate() {
            for (entry, node) in support.nodes.iter().enumerate() {
                if nodes.binary_search(node).is_ok() {
                    places.push((set as u32, entry as u32, support.axis as u32));
                }
            }
        }
        places
    }

    /// Force of the supports on these places along `direction` at the last step [N].
    pub fn reaction(&self, places: &[(u32, u32, u32)], direction: &Vec3) -> f64 {
        places.iter().map(|&(s, e, a)| self.sets[s as usize].reaction[e as usize] * direction[a as usize]).sum()
    }

    /// Writes the displacements prescribed at `time` into `displacement`; those of supports with a velocity go on from
    /// the present values at `present`.
    pub(crate) fn prescribe(&self, displacement: &mut [Vec3], reference: &[Vec3], present: f64, time: f64) {
        for set in &self.sets {
            for &node in &set.nodes {
                let (value, place) = (&mut displacement[node as usize][set.axis], &reference[node as usize]);
                match &set.motion {
                    Motion::Fixed => *value = 0.0,
                    Motion::Displacement(u) => *value = u(time, place),
                    Motion::Velocity(v) => *value += integral(|t| v(t, place), present, time),
                }
            }
        }
    }

    /// Takes the reactions from the sum of all other forces; a vector per node.
    pub(crate) fn take_reactions(&mut self, force: &[Vec3]) -> Vec<Vec3> {
        let mut reactions = vec![Vec3::zeros(); force.len()];
        for Support { nodes, axis, reaction, .. } in &mut self.sets {
            for (&node, reaction) in nodes.iter().zip(reaction) {
                *reaction = -force[node as usize][*axis];
                reactions[node as usize][*axis] = *reaction;
            }
        }
        reactions
    }

    /// Keeps the velocities before the kick.
    pub(crate) fn remember(&mut self, solid: &Solid) {
        for set in &mut self.sets {
            for (before, &node) in set.before.iter_mut().zip(&set.nodes) {
                *before = solid.velocity[node as usize][set.axis];
            }
        }
    }

    /// Replaces the free motion of the prescribed axes, after the kick and drift, and finds the reactions.
    pub(crate) fn impose(&mut self, solid: &mut Solid, time: f64, dt_before: f64, dt_after: f64) -> HalfSteps {
        let mut work = HalfSteps::default();
        let dt_kick = 0.5 * (dt_before + dt_after);
        for Support { nodes, axis, motion, before, reaction, .. } in &mut self.sets {
            for ((&node, &mut before), reaction) in nodes.iter().zip(before).zip(reaction) {
                let (i, axis) = (node as usize, *axis);
                let free = solid.velocity[i][axis];
                let place = &solid.reference[i];
                let velocity = match motion {
                    Motion::Fixed => 0.0,
                    Motion::Velocity(v) => v(time + 0.5 * dt_after, place),
                    Motion::Displacement(u) => {
                        let present = solid.displacement[i][axis] - free * dt_after;
                        (u(time + dt_after, place) - present) / dt_after
                    }
                };
                let change = velocity - free;
                let mass = solid.mass[i];
                solid.velocity[i][axis] = velocity;
                solid.displacement[i][axis] += change * dt_after;
                *reaction = mass * change / dt_kick;
                work.before.external += 0.5 * *reaction * before * dt_before;
                work.after.external += 0.5 * *reaction * velocity * dt_after;
                work.before.kinetic += 0.5 * *reaction * before * dt_before;
            }
        }
        work
    }
}

/// Integral of a velocity by Gauss' rule of two points on 16 parts [m].
pub(crate) fn integral(velocity: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const PARTS: usize = 16;
    let width = (to - from) / PARTS as f64;
    let offset = 0.5 / 3f64.sqrt();
    let part = |k: usize| {
        let middle = from + (k as f64 + 0.5) * width;
        0.5 * width * (velocity(middle - offset * width) + velocity(middle + offset * width))
    };
    if width == 0.0 { 0.0 } else { (0..PARTS).map(part).sum() }
}

/// Forces from outside.
#[derive(Clone)]
pub enum Load {
    /// Force along an axis on nodes with weights: value times weight [N].
    Nodal {
        /// Nodes and weights: shares of a total force [-], or areas under a traction [m²].
        nodes: Vec<(u32, f64)>,
        /// Axis 0, 1 or 2.
        axis: usize,
        /// Force [N] or traction [Pa].
        value: TimeFunction,
    },
    /// Pressure on facets, along their present normals [Pa]; positive pushes into the solid.
    Pressure {
        /// Nodes of outward facets; an edge in the plane repeats its second node.
        facets: Vec<[u32; 3]>,
        /// Thickness for edges in the plane [m]; 0 for triangles.
        thickness: f64,
        /// Pressure over time and the reference centre of the facet.
        value: TimeFunction,
    },
    /// Acceleration of every node along an axis [m/s²].
    Gravity {
        /// Axis 0, 1 or 2.
        axis: usize,
        /// Acceleration, taken at the origin.
        value: TimeFunction,
    },
}

/// All loads of a scene.
#[derive(Clone, Default)]
pub struct Loads {
    loads: Vec<Load>,
    /// Forces on single nodes of the last step [N].
    applied: Vec<(u32, Vec3)>,
    /// Acceleration of all nodes in the last step [m/s²].
    gravity: Vec3,
    has_gravity: bool,
    chunk_momentum: Vec<Vec3>,
}

impl Loads {
    /// Collects loads for a solid of `node_count` nodes.
    pub fn new(loads: Vec<Load>, node_count: usize) -> Self {
        let has_gravity = loads.iter().any(|l| matches!(l, Load::Gravity { .. }));
        let entries = |load: &Load| match load {
            Load::Nodal { nodes, .. } => nodes.len(),
            Load::Pressure { facets, .. } => 3 * facets.len(),
            Load::Gravity { .. } => 0,
        };
        Loads {
            applied: Vec::with_capacity(loads.iter().map(entries).sum()),
            gravity: Vec3::zeros(),
            chunk_momentum: vec![Vec3::zeros(); if has_gravity { node_count.div_ceil(CHUNK) } else { 0 }],
            has_gravity,
            loads,
        }
    }

    /// Whether nothing pushes.
    pub fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Adds the forces of `time` to the solid; returns their work in the half step before [J].
    pub(crate) fn add_forces(&mut self, solid: &mut Solid, time: f64, dt_before: f64) -> f64 {
        if self.loads.is_empty() {
            return 0.0;
        }
        self.applied.clear();
        self.gravity = Vec3::zeros();
        for load in &self.loads {
            match load {
                Load::Nodal { nodes, axis, value } => {
                    for &(node, weight) in nodes {
                        let mut force = Vec3::zeros();
                        force[*axis] = weight * value(time, &solid.reference[node as usize]);
                        self.applied.push((node, force));
                    }
                }
                Load::Pressure { facets, thickness, value } => {
                    for facet in facets {
                        push_pressure(&mut self.applied, solid, facet, *thickness, time, value);
                    }
                }
                Load::Gravity { axis, value } => self.gravity[*axis] += value(time, &Vec3::zeros()),
            }
        }
        for &(node, force) in &self.applied {
            solid.force[node as usize] += force;
        }
        if self.has_gravity {
            let (gravity, mass) = (self.gravity, &solid.mass);
            solid
                .force
                .par_iter_mut()
                .zip(mass)
                .with_min_len(CHUNK)
                .for_each(|(force, &mass)| *force += gravity * mass);
        }
        0.5 * dt_before * self.power(solid)
    }

    /// Power of the last forces at the present velocities [W].
    pub(crate) fn power(&mut self, solid: &Solid) -> f64 {
        let mut power: f64 = self.applied.iter().map(|(node, force)| force.dot(&solid.velocity[*node as usize])).sum();
        if self.has_gravity {
            let momentum = |v: &[Vec3], m: &[f64]| v.iter().zip(m).map(|(v, m)| v * *m).sum::<Vec3>();
            self.chunk_momentum
                .par_iter_mut()
                .zip(solid.velocity.par_chunks(CHUNK).zip(solid.mass.par_chunks(CHUNK)))
                .for_each(|(sum, (v, m))| *sum = momentum(v, m));
            power += self.gravity.dot(&self.chunk_momentum.iter().sum());
        }
        power
    }
}

/// Pressure on one facet: a third of p times its area vector on each node (half on each end of a plane edge).
fn push_pressure(
    applied: &mut Vec<(u32, Vec3)>,
    solid: &Solid,
    facet: &[u32; 3],
    thickness: f64,
    time: f64,
    value: &TimeFunction,
) {
    let [a, b, c] = facet.map(|n| n as usize);
    let p = [a, b, c].map(|n| solid.position(n));
    if thickness > 0.0 {
        let centre = (solid.reference[a] + solid.reference[b]) * 0.5;
        let along = p[1] - p[0];
        let area = Vec3::new(along.y, -along.x, 0.0) * thickness;
        let force = area * (-0.5 * value(time, &centre));
        applied.extend([(facet[0], force), (facet[1], force)]);
    } else {
        let centre = (solid.reference[a] + solid.reference[b] + solid.reference[c]) / 3.0;
        let area = (p[1] - p[0]).cross(&(p[2] - p[0])) * 0.5;
        let force = area * (-value(time, &centre) / 3.0);
        applied.extend(facet.map(|n| (n, force)));
    }
}
