//! A mesh whose edges follow a line: nodes of the chain of edges that is nearest to it move onto it, and nodes around are smoothed.

use std::collections::BTreeSet;

use super::ways::Roads;
use super::{Place, ahead, cross, dot, length, minus, nearest, unit};
use crate::free::{around_nodes, free_nodes};
use crate::mesh::Group;
use crate::topology::{NO_ELEMENT, boundary_of_triangles, sides_of_triangles};
use crate::{Mesh, Vec3};

/// Rounds in which nodes move.
const ROUNDS: usize = 8;
/// Shape of a triangle, 1 for an equilateral one, that a node of the chain may leave.
const LEAST: f64 = 0.3;
/// The same of a node beside it.
const LEAST_BESIDE: f64 = 0.5;
/// What an edge on the line costs, over one that lies its own length away.
const ON_LINE: f64 = 0.02;

/// The part of an edge by which a node of a side slides along it.
const SLIDE: f64 = 0.6;

/// Why a mesh does not follow a line.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SplitError {
    /// It is not plane, or elements overlap.
    #[error("the mesh is not one of triangles in the xy-plane")]
    Kind,
    /// No edges lead from end to end.
    #[error("no edges lead from one end of the line to the other")]
    NoWay,
    /// A node that could not come to the line.
    #[error("a node at ({:.4e}, {:.4e}) does not come to the line", .0[0], .0[1])]
    Apart([f64; 2]),
}

impl Mesh {
    /// Makes the edges of a plane mesh follow a line through it, and makes them a group of their own. No node is added.
    ///
    /// - `line`: from side to side
    /// - `group`: a name that no group has
    /// - returns the number of the edges
    ///
    /// # Errors
    /// [`SplitError`]; the mesh is then of no more use.
    pub fn follow(&mut self, line: &[[f64; 2]], group: &str) -> Result<usize, SplitError> {
        if !self.is_plane() || line.len() < 2 {
            return Err(SplitError::Kind);
        }
        let sides = sides_of_triangles(&self.triangles).map_err(|_| SplitError::Kind)?;
        let mut is_side = vec![false; self.nodes.len()];
        let mut inner: Vec<[u32; 2]> = Vec::new();
        for (nodes, elements) in sides.nodes.iter().zip(&sides.elements) {
            if elements[1] == NO_ELEMENT {
                nodes.iter().for_each(|&node| is_side[node as usize] = true);
            } else {
                inner.push(*nodes);
            }
        }
        let chain = chain(self, line, &inner, &is_side)?;
        self.bring(line, &chain)?;
        let first = self.lines.len() as u32;
        self.lines.extend(chain.windows(2).map(|pair| [pair[0], pair[1]]));
        let of_lines = |own: &&Group| own.dimension == 1;
        let tag = self.groups.iter().filter(of_lines).map(|own| own.tag).max().unwrap_or(0) + 1;
        let lines = (first..self.lines.len() as u32).collect();
        let place = self.groups.iter().take_while(|own| own.dimension < 2).count();
        self.groups.insert(place, Group { name: group.to_owned(), dimension: 1, tag, lines, ..Group::default() });
        self.number();
        Ok(chain.len() - 1)
    }

    /// Moves the nodes of a chain onto a line.
    fn bring(&mut self, line: &[Place], chain: &[u32]) -> Result<(), SplitError> {
        let around = around_nodes(self);
        let mut free = free_nodes(self, &around);
        let own = &chain[1..chain.len() - 1];
        let on_line = |&node: &u32| free[node as usize].then(|| (node, nearest(line, self.place(node)).0));
        let ends = [(chain[0], line[0]), (chain[chain.len() - 1], line[line.len() - 1])];
        let slid = ends.into_iter().filter_map(|(node, to)| Some((node, self.slid(node, to)?)));
        let goals: Vec<(u32, Place)> = own.iter().filter_map(on_line).chain(slid).collect();
        chain.iter().for_each(|&node| free[node as usize] = false);
        let neighbours = |mesh: &Mesh, node: u32| -> BTreeSet<u32> {
            let own = around.row(node as usize).iter().flat_map(|&element| mesh.triangles[element as usize]);
            own.filter(|&other| other != node).collect()
        };
        // Two rings of nodes beside the chain.
        let ring: BTreeSet<u32> = chain.iter().flat_map(|&node| neighbours(self, node)).collect();
        let beside: BTreeSet<u32> = ring.iter().flat_map(|&node| neighbours(self, node)).chain(ring.clone()).collect();
        let beside: Vec<u32> = beside.into_iter().filter(|&node| free[node as usize]).collect();
        let worst = |mesh: &Mesh, node: u32| {
            let shapes = around.row(node as usize).iter().map(|&element| mesh.shape(element));
            shapes.fold(f64::INFINITY, f64::min)
        };
        for _ in 0..ROUNDS {
            for &(node, goal) in &goals {
                let (from, before) = (self.nodes[node as usize], worst(self, node));
                let fits = [1.0, 0.5, 0.25].into_iter().any(|part| {
                    let to = Vec3::new(goal[0], goal[1], from.z);
                    // A node that arrives lies on the line to the last bit.
                    self.nodes[node as usize] = if part == 1.0 { to } else { from + (to - from) * part };
                    worst(self, node) > LEAST.min(before)
                });
                if !fits {
                    self.nodes[node as usize] = from;
                }
            }
            for &node in &beside {
                let (from, before) = (self.nodes[node as usize], worst(self, node));
                let others = neighbours(self, node);
                let sum = others.iter().fold(Vec3::zeros(), |sum, &other| sum + self.nodes[other as usize]);
                self.nodes[node as usize] = sum / others.len() as f64;
                if worst(self, node) < LEAST_BESIDE.min(before) {
                    self.nodes[node as usize] = from;
                }
            }
        }
        let left = goals.iter().find(|(node, goal)| self.place(*node) != *goal);
        left.map_or(Ok(()), |(node, _)| Err(SplitError::Apart(self.place(*node))))
    }

    /// The place nearest to another one to which a node of a straight side may slide along it; none for corners and ends of groups.
    fn slid(&self, node: u32, to: Place) -> Option<Place> {
        if self.points.iter().any(|point| point[0] == node) {
            return None;
        }
        let at_node = |lines: &[u32]| lines.iter().filter(|&&line| self.lines[line as usize].contains(&node)).count();
        if self.groups.iter().any(|group| at_node(&group.lines) == 1) {
            return None;
        }
        let sides = boundary_of_triangles(&self.triangles);
        let before = sides.iter().find(|side| side.nodes[1] == node)?.nodes[0];
        let after = sides.iter().find(|side| side.nodes[0] == node)?.nodes[1];
        let at = self.place(node);
        let (come, go) = (minus(at, self.place(before)), minus(self.place(after), at));
        let [back, forth] = [length(come), length(go)];
        let is_straight = cross(come, go).abs() < 1e-6 * back * forth && dot(come, go) > 0.0;
        let along = unit(come).filter(|_| is_straight)?;
        Some(ahead(at, along, dot(minus(to, at), along).clamp(-SLIDE * back, SLIDE * forth)))
    }

    fn place(&self, node: u32) -> Place {
        let at = self.nodes[node as usize];
        [at.x, at.y]
    }

    /// 1 for an equilateral triangle, 0 for a flat one, below 0 for one that is turned over.
    fn shape(&self, element: u32) -> f64 {
        let [a, b, c] = self.triangles[element as usize].map(|node| self.place(node));
        let (ab, bc, ca) = (minus(b, a), minus(c, b), minus(a, c));
        let squares = dot(ab, ab) + dot(bc, bc) + dot(ca, ca);
        2.0 * 3.0_f64.sqrt() * cross(ab, minus(c, a)) / squares
    }
}

/// Nodes of the edges that are nearest to a line, from end to end.
fn chain(mesh: &Mesh, line: &[Place], inner: &[[u32; 2]], is_side: &[bool]) -> Result<Vec<u32>, SplitError> {
    let end = |at: Place| {
        let sides = (0..is_side.len() as u32).filter(|&node| is_side[node as usize]);
        let distance = |node: &u32| length(minus(mesh.place(*node), at));
        sides.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let ends = [line[0], line[line.len() - 1]].map(end);
    let [Some(start), Some(end)] = ends else { return Err(SplitError::NoWay) };
    let away: Vec<f64> = (0..mesh.nodes.len() as u32).map(|node| nearest(line, mesh.place(node)).1).collect();
    let cost = |&[a, b]: &[u32; 2]| {
        let (p, q) = (mesh.place(a), mesh.place(b));
        let middle = nearest(line, [f64::midpoint(p[0], q[0]), f64::midpoint(p[1], q[1])]).1;
        let (long, mean) = (length(minus(q, p)), 0.25 * (away[a as usize] + away[b as usize] + 2.0 * middle));
        ([a, b], long * (ON_LINE + (mean / long).powi(2)))
    };
    let roads = Roads::new(mesh.nodes.len(), inner.iter().map(cost));
    let mut chain = roads.way(start, end).ok_or(SplitError::NoWay)?;
    // Two sides of a triangle would become flat with it.
    let is_edge = |a: u32, b: u32| inner.binary_search(&[a.min(b), a.max(b)]).is_ok();
    let mut at = 0;
    while at + 2 < chain.len() {
        if is_edge(chain[at], chain[at + 2]) {
            chain.remove(at + 1);
        } else {
            at += 1;
        }
    }
    if chain.len() < 3 { Err(SplitError::NoWay) } else { Ok(chain) }
}
