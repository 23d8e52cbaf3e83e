//! Which discrete elements may touch, kept up to date as they are born and move.
//!
//! Each particle is in the grid, with a slack around it, at the place where it was put last. It is put there anew when it has used up its
//! slack, and when it is born; only then are its partners looked for. So all pairs that touch are in the list at any time, the cost
//! of a birth does not grow with the number of particles, and no result depends on when pairs came into the list.

use fractum_contact::SphereGrid;
use fractum_contact::law::ContactMemory;
use fractum_fem::{Solid, removal};
use fractum_math::Vec3;
use rayon::prelude::*;

use super::rows::{Entry, Rows};
use super::{Debris, NONE, Pair};

/// Way over its radius after which a particle looks for partners anew.
const SLACK: f64 = 0.3;
/// Nodes handled as one piece of parallel work.
const CHUNK: usize = 2048;
/// What squares of distances are compared with more than exactly, so that rounding misses no contact.
const ROUNDING: f64 = 1e-12;

/// Pairs of nodes that never touch as particles, since something else stands between them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Apart(Vec<[u32; 2]>);

impl Apart {
    /// - `pairs`: the lower node first
    pub(crate) fn new(pairs: impl Iterator<Item = [u32; 2]>) -> Self {
        let mut pairs: Vec<[u32; 2]> = pairs.collect();
        pairs.sort_unstable();
        Apart(pairs)
    }

    fn has(&self, nodes: [u32; 2]) -> bool {
        !self.0.is_empty() && self.0.binary_search(&nodes).is_ok()
    }
}

/// Particles near each other, by the numbers of their nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    grid: SphereGrid,
    pub(super) rows: Rows,
    /// Where each particle was put into the grid [m].
    listed_at: Vec<Vec3>,
    /// Where it is [m].
    place: Vec<Vec3>,
    /// Particles that are in the grid: the first ones.
    listed: usize,
    /// What each chunk of nodes has found: a node, and an index in its row.
    found: Vec<Vec<(u32, u32)>>,
    moved: Vec<u32>,
    around: Vec<u32>,
    parted: Vec<[u32; 2]>,
    contacts: Vec<Pair>,
}

impl Near {
    /// - `radius`: at all nodes [m]
    pub(super) fn new(radius: &[f64], planar: bool) -> Self {
        let smallest = radius.iter().copied().filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min);
        Near {
            grid: SphereGrid::new(radius.len(), (1.0 + SLACK) * smallest, planar),
            rows: Rows::new(radius.len()),
            listed_at: vec![Vec3::zeros(); radius.len()],
            place: vec![Vec3::zeros(); radius.len()],
            found: vec![Vec::new(); radius.len().div_ceil(CHUNK)],
            ..Near::default()
        }
    }

    /// Whether nothing has been set up yet.
    pub(super) fn is_empty(&self) -> bool {
        self.rows.len() == 0
    }

    /// Finds where all particles are, and the nodes of those that are not in the grid or have used up their slack, ascending.
    fn find_moved(&mut self, particle_of: &[u32], radius: &[f64], place: impl Fn(usize) -> Vec3 + Sync) {
        let Near { listed_at, place: present, listed, found, moved, .. } = self;
        let (listed_at, listed) = (&*listed_at, *listed);
        present.par_chunks_mut(CHUNK).zip(found.par_iter_mut()).enumerate().for_each(|(chunk, (present, found))| {
            found.clear();
            for (k, present) in present.iter_mut().enumerate() {
                let node = chunk * CHUNK + k;
                if particle_of[node] == NONE {
                    continue;
                }
                *present = place(node);
                let slack = SLACK * radius[node];
                if (*present - listed_at[node]).norm_squared() > slack * slack || particle_of[node] as usize >= listed {
                    found.push((node as u32, 0));
                }
            }
        });
        moved.clear();
        moved.extend(found.iter().flatten().map(|&(node, _)| node));
    }
}

impl Debris {
    /// Takes births and the motion of the step into account: finds the pairs that touch now.
    pub(crate) fn search(&mut self, solid: &Solid) {
        if self.is_empty() {
            return;
        }
        self.list_pairs(solid, |node| solid.position(node));
        self.find_contacts(solid);
    }

    /// Brings the list of near pairs up to date.
    ///
    /// - `place`: of each node [m]
    pub(super) fn list_pairs(&mut self, solid: &Solid, place: impl Fn(usize) -> Vec3 + Sync) {
        let mut near = std::mem::take(&mut self.near);
        near.find_moved(&self.particle_of, &self.radius, place);
        let reach = |node: u32| (1.0 + SLACK) * self.radius[node as usize];
        for &node in &near.moved {
            near.listed_at[node as usize] = near.place[node as usize];
            near.grid.put(node, &near.place[node as usize], reach(node));
        }
        for index in 0..near.moved.len() {
            let node = near.moved[index];
            let Near { grid, listed_at, around, .. } = &mut near;
            around.clear();
            let centre = listed_at[node as usize];
            grid.around(&centre, reach(node), |other| {
                let touching = reach(node) + reach(other);
                if other != node && (listed_at[other as usize] - centre).norm_squared() < touching * touching {
                    around.push(other);
                }
            });
            for k in 0..near.around.len() {
                let nodes = [node.min(near.around[k]), node.max(near.around[k])];
                // Neighbours that an element still joins are held by it.
                if near.rows.find(nodes).is_none()
                    && !self.apart.has(nodes)
                    && !(self.both_held(nodes) && removal::is_live_edge(solid, nodes))
                {
                    let newborn = nodes.iter().any(|&n| self.particle_of[n as usize] as usize >= near.listed);
                    near.rows.add(nodes[0], self.new_entry(solid, nodes, false, newborn));
                }
            }
        }
        near.listed = self.len();
        self.near = near;
    }

    /// Whether elements hold both particles of a pair.
    pub(super) fn both_held(&self, nodes: [u32; 2]) -> bool {
        nodes.iter().all(|&node| self.state.attached[self.particle_of[node as usize] as usize])
    }

    /// Lets pairs of nodes, whose edges have lost their last element, touch at their undeformed distance.
    pub(super) fn open_edges(&mut self, solid: &Solid, edges: Vec<[u32; 2]>) {
        for nodes in edges {
            if self.near.rows.find(nodes).is_none() {
                let entry = self.new_entry(solid, nodes, true, true);
                self.near.rows.add(nodes[0], entry);
            }
        }
    }

    /// The list's entry of a pair; one of newborn particles touches no nearer than now, so that it brings no energy.
    fn new_entry(&self, solid: &Solid, nodes: [u32; 2], neighbours: bool, newborn: bool) -> Entry {
        let [i, j] = nodes.map(|n| n as usize);
        let rest =
            if neighbours { (solid.reference[j] - solid.reference[i]).norm() } else { self.radius[i] + self.radius[j] };
        let now = (solid.position(j) - solid.position(i)).norm();
        let closing = if newborn { rest.min(now) } else { rest };
        let mut entry = Entry { closing, parting: 0.0, partner: nodes[1], neighbours, touches: false };
        entry.parting = self.parting(solid, nodes[0], &entry);
        entry
    }

    /// Distance at which something about a pair changes next [m].
    pub(super) fn parting(&self, solid: &Solid, node: u32, entry: &Entry) -> f64 {
        let [i, j] = [node, entry.partner].map(|n| n as usize);
        let sum = self.radius[i] + self.radius[j];
        let distance = if entry.neighbours {
            let rest = (solid.reference[j] - solid.reference[i]).norm();
            if entry.closing < rest { rest } else { 2.0 * rest }
        } else if entry.closing < sum {
            sum
        } else {
            return (1.0 + 2.0 * SLACK) * sum * (1.0 + ROUNDING);
        };
        distance * (1.0 - ROUNDING)
    }

    /// Finds the pairs that touch, in the order of their nodes; those of the last step stay as long as they remember something.
    fn find_contacts(&mut self, solid: &Solid) {
        let mut near = std::mem::take(&mut self.near);
        let Near { rows, place, found, .. } = &mut near;
        let (rows, place) = (&*rows, &*place);
        found.par_iter_mut().enumerate().for_each(|(chunk, found)| {
            found.clear();
            for node in chunk * CHUNK..place.len().min((chunk + 1) * CHUNK) {
                for (index, entry) in (0..).zip(rows.row(node as u32)) {
                    let square = (place[entry.partner as usize] - place[node]).norm_squared();
                    let touches = square <= entry.closing * entry.closing * (1.0 + ROUNDING);
                    if touches || square >= entry.parting * entry.parting || entry.touches {
                        found.push((node as u32, index));
                    }
                }
            }
        });
        let before = std::mem::replace(&mut self.state.contacts, std::mem::take(&mut near.contacts));
        self.state.contacts.clear();
        near.parted.clear();
        let mut last = before.iter();
        for chunk in 0..near.found.len() {
            for k in 0..near.found[chunk].len() {
                let (node, index) = near.found[chunk][k];
                let mut entry = near.rows.row(node)[index as usize];
                let known = if entry.touches { last.next() } else { None };
                let place = |n: u32| near.place[n as usize];
                let distance = (place(entry.partner) - place(node)).norm();
                let near_still = distance < entry.parting || self.part(solid, node, &mut entry, distance);
                if !near_still {
                    near.parted.push([node, entry.partner]);
                }
                entry.touches = distance < entry.closing || known.is_some_and(|pair| !pair.has_parted());
                if entry.touches {
                    let pair = known.copied().unwrap_or_else(|| self.new_pair(solid, [node, entry.partner]));
                    self.state.contacts.push(Pair { closing: entry.closing, ..pair });
                }
                near.rows.row_mut(node)[index as usize] = entry;
            }
        }
        near.parted.retain(|&nodes| near.rows.find(nodes).is_some_and(|k| !near.rows.row(nodes[0])[k].touches));
        near.parted.iter().for_each(|&nodes| near.rows.remove(nodes));
        near.contacts = before;
        self.near = near;
    }

    /// Lets the closing distance grow back to that of free spheres once the pair has parted; whether it is near still.
    pub(super) fn part(&self, solid: &Solid, node: u32, entry: &mut Entry, distance: f64) -> bool {
        let [i, j] = [node, entry.partner].map(|n| n as usize);
        let sum = self.radius[i] + self.radius[j];
        if entry.neighbours {
            let rest = (solid.reference[j] - solid.reference[i]).norm();
            if distance > 2.0 * rest {
                (entry.neighbours, entry.closing) = (false, sum);
            } else if distance >= rest {
                entry.closing = rest;
            }
        } else if distance >= sum {
            entry.closing = sum;
        }
        entry.parting = self.parting(solid, node, entry);
        entry.neighbours || entry.closing < sum || distance < entry.parting
    }

    /// Puts all particles into an empty list, with the pairs that touch at another distance than free spheres and those that
    /// touched at the last step.
    pub(super) fn list_anew(&mut self, solid: &Solid) {
        self.near = Near::new(&self.radius, self.planar);
        for special in std::mem::take(&mut self.state.special) {
            let mut entry = self.new_entry(solid, special.nodes, special.neighbours, false);
            entry.closing = special.closing;
            entry.parting = self.parting(solid, special.nodes[0], &entry);
            self.near.rows.add(special.nodes[0], entry);
        }
        // Particles that have been there count as listed, so that no pair is taken for one of newborn ones.
        self.near.listed = self.len();
        self.near.listed_at.fill(Vec3::repeat(f64::INFINITY));
        self.list_pairs(solid, |node| solid.position(node));
        for pair in &self.state.contacts {
            if let Some(index) = self.near.rows.find(pair.nodes) {
                self.near.rows.row_mut(pair.nodes[0])[index].touches = true;
            }
        }
    }

    /// Pairs that may touch, in the order of their nodes.
    pub(super) fn near_pairs(&self) -> impl Iterator<Item = (u32, &Entry)> {
        let rows = &self.near.rows;
        (0..rows.len() as u32).flat_map(|node| rows.row(node).iter().map(move |entry| (node, entry)))
    }
}

impl Pair {
    /// Whether the pair did not touch when its force was last found, so that nothing is left to remember.
    fn has_parted(&self) -> bool {
        self.memory == ContactMemory::default()
    }
}
