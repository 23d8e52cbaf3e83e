//! Discs in meshes of tetrahedra: nodes near the plane of a disc move onto it, and edges that still cross it are divided there.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::elementary::{acos, sin};

use super::pattern::Fate;
use super::sheet::{allowed, labels};
use crate::quality::{signed_volume, tetrahedron};
use crate::topology::{NO_ELEMENT, TETRAHEDRON_EDGES, TETRAHEDRON_FACETS, facets_of_tetrahedra};
use crate::{Mesh, Vec3};

/// Over the size of elements: nodes that are nearer to a plane move onto it.
const SNAP: f64 = 0.3;
/// Over the size of elements: discs that are nearer to each other at a small angle are in each other's way.
const NEAR: f64 = 0.4;
/// How far a node moves along its own faces to be on a plane, over its distance from that.
const LONGEST_WAY: f64 = 2.0;
/// Least radius ratio that the elements at a moved node keep, or their own.
const LEAST_RATIO: f64 = 0.15;
/// Rounds in which free nodes near joints move where elements get better.
const ROUNDS: usize = 4;

/// A joint in space: a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its middle.
    pub centre: Vec3,
    /// Its normal.
    pub normal: Vec3,
    /// Its radius.
    pub radius: f64,
    /// The group of its triangles, by its number.
    pub group: u32,
}

/// A triangle that must stay a face of elements.
#[derive(Clone, Debug)]
pub(super) struct Skin {
    pub(super) nodes: [u32; 3],
    /// The triangle of the mesh that it is a part of.
    pub(super) triangle: Option<u32>,
    /// The joint that it is a part of.
    pub(super) joint: Option<u32>,
}

/// Tetrahedra that are being cut.
pub(super) struct Block {
    pub(super) at: Vec<Vec3>,
    pub(super) elements: Vec<[u32; 4]>,
    pub(super) label: Vec<u32>,
    /// Groups of elements by their label.
    pub(super) labels: Vec<Vec<u32>>,
    pub(super) skin: Vec<Skin>,
    /// Parts of the lines of the mesh.
    pub(super) lines: Vec<([u32; 2], u32)>,
    held: Vec<bool>,
    allowed: Vec<Vec<bool>>,
    of_node: Vec<Vec<u32>>,
    skin_of_node: Vec<Vec<u32>>,
    /// Largest distance by which a node is off its plane.
    pub(super) shift: f64,
}

impl Block {
    /// - `elements`: for each group of joints whether they may lie in each element; in all where it is empty
    ///
    /// None where more than two elements share a face.
    pub(super) fn new(mesh: &Mesh, elements: &[&[bool]]) -> Option<Self> {
        let (labels, label) = labels(mesh, mesh.tetrahedra.len(), |group| &group.tetrahedra);
        let facets = facets_of_tetrahedra(&mesh.tetrahedra).ok()?;
        let sorted = |mut nodes: [u32; 3]| {
            nodes.sort_unstable();
            nodes
        };
        let mut skin: Vec<Skin> = Vec::new();
        let mut known = BTreeSet::new();
        for (triangle, &nodes) in (0..).zip(&mesh.triangles) {
            known.insert(sorted(nodes));
            skin.push(Skin { nodes, triangle: Some(triangle), joint: None });
        }
        for (&nodes, &[a, b]) in facets.nodes.iter().zip(&facets.elements) {
            let is_inner = b != NO_ELEMENT && label[a as usize] == label[b as usize];
            if !is_inner && known.insert(nodes) {
                skin.push(Skin { nodes, triangle: None, joint: None });
            }
        }
        let mut held = vec![false; mesh.nodes.len()];
        mesh.points.iter().for_each(|point| held[point[0] as usize] = true);
        mesh.lines.iter().flatten().for_each(|&node| held[node as usize] = true);
        let allowed = elements.iter().map(|own| allowed(own, mesh.tetrahedra.len())).collect();
        let mut of_node = vec![Vec::new(); mesh.nodes.len()];
        for (number, element) in (0u32..).zip(&mesh.tetrahedra) {
            element.iter().for_each(|&node| of_node[node as usize].push(number));
        }
        let mut skin_of_node = vec![Vec::new(); mesh.nodes.len()];
        for (number, facet) in (0u32..).zip(&skin) {
            facet.nodes.iter().for_each(|&node| skin_of_node[node as usize].push(number));
        }
        Some(Block {
            at: mesh.nodes.clone(),
            elements: mesh.tetrahedra.clone(),
            label,
            labels,
            skin,
            lines: mesh.lines.iter().copied().zip(0..).collect(),
            held,
            allowed,
            of_node,
            skin_of_node,
            shift: 0.0,
        })
    }

    /// Whether joints of a group may be in an element.
    pub(super) fn is_allowed(&self, group: u32, element: u32) -> bool {
        self.allowed[group as usize][element as usize]
    }

    fn place(&self, node: u32) -> Vec3 {
        self.at[node as usize]
    }

    fn corners(&self, element: u32) -> [Vec3; 4] {
        self.elements[element as usize].map(|node| self.place(node))
    }

    /// Mean length of the edges at a node.
    fn size(&self, node: u32) -> f64 {
        let around = &self.of_node[node as usize];
        let others = around.iter().flat_map(|&e| self.elements[e as usize]).filter(|&n| n != node);
        let (sum, count) = others.fold((0.0, 0usize), |(sum, count), other| {
            (sum + (self.place(other) - self.place(node)).norm(), count + 1)
        });
        sum / count.max(1) as f64
    }

    /// Cuts a disc, unless it meets others at less than an angle [rad].
    pub(super) fn add(&mut self, joint: u32, disc: &Disc, before: &[Disc], fates: &[Fate], least: f64) -> Fate {
        let near = self.near(disc);
        if near.is_empty() {
            return Fate::Outside;
        }
        let size = near.iter().map(|&node| self.size(node)).sum::<f64>() / near.len() as f64;
        if 2.0 * disc.radius < size {
            return Fate::Short { length: 2.0 * disc.radius, edge: size };
        }
        let cut = before.iter().zip(fates).enumerate().filter(|(_, (_, fate))| matches!(fate, Fate::Cut(_)));
        for (number, (other, _)) in cut {
            if let Some(angle) = sharp(disc, other, NEAR * size, least) {
                let at = [disc.centre.x, disc.centre.y];
                return Fate::Sharp { other: Some(number as u32), angle, at };
            }
        }
        let mut side: BTreeMap<u32, i8> = BTreeMap::new();
        for &node in &near {
            let on = self.snap(node, disc);
            let above = (self.place(node) - disc.centre).dot(&disc.normal) > 0.0;
            side.insert(node, if on { 0 } else { 2 * i8::from(above) - 1 });
        }
        self.divide(disc, &mut side, size);
        self.mark(joint, disc, &side)
    }

    /// Nodes of elements that a disc is near to.
    fn near(&self, disc: &Disc) -> Vec<u32> {
        let touches = |nodes: &&[u32; 4]| {
            let corners = nodes.map(|node| self.place(node));
            let reach = corners.iter().map(|corner| (corner - corners[0]).norm()).fold(0.0, f64::max);
            let heights = corners.map(|corner| (corner - disc.centre).dot(&disc.normal));
            let (low, high) =
                heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
            let middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0 - disc.centre;
            let across = (middle - disc.normal * middle.dot(&disc.normal)).norm();
            low < 0.5 * reach && high > -0.5 * reach && across < disc.radius + 1.5 * reach
        };
        let found = self.elements.iter().filter(touches).flatten().copied();
        found.collect::<BTreeSet<u32>>().into_iter().collect()
    }

    /// Moves a node onto the plane of a disc where it is near; whether it counts as on the plane.
    fn snap(&mut self, node: u32, disc: &Disc) -> bool {
        let (from, size) = (self.place(node), self.size(node));
        let height = (from - disc.centre).dot(&disc.normal);
        if height.abs() >= SNAP * size {
            return false;
        }
        if height.abs() < 1e-9 * size {
            return true;
        }
        if let Some(to) = self.onto_plane(node, height, &disc.normal) {
            let before = self.worst(node);
            self.at[node as usize] = to;
            if self.worst(node) >= before.min(LEAST_RATIO) {
                return true;
            }
            self.at[node as usize] = from;
        }
        // What cannot move is taken as it is where it is close, rather than to leave a flat element.
        let is_close = height.abs() < 0.1 * size;
        if is_close {
            self.shift = self.shift.max(height.abs());
        }
        is_close
    }

    /// Where a node meets a plane if it moves along the faces that it must stay on.
    fn onto_plane(&self, node: u32, height: f64, normal: &Vec3) -> Option<Vec3> {
        if self.held[node as usize] {
            return None;
        }
        let mut axes: Vec<Vec3> = Vec::new();
        for &facet in &self.skin_of_node[node as usize] {
            let [a, b, c] = self.skin[facet as usize].nodes.map(|n| self.place(n));
            let own = (b - a).cross(&(c - a)).normalize();
            let rest = axes.iter().fold(own, |rest, axis| rest - axis * rest.dot(axis));
            if rest.norm() > 1e-4 {
                axes.push(rest.normalize());
            }
        }
        let free = axes.iter().fold(*normal, |rest, axis| rest - axis * rest.dot(axis));
        let share = free.norm_squared();
        (axes.len() < 3 && share * LONGEST_WAY * LONGEST_WAY > 1.0).then(|| self.place(node) - free * (height / share))
    }

    /// Least radius ratio of the elements at a node; negative where one is inverted.
    fn worst(&self, node: u32) -> f64 {
        let ratio = |&element: &u32| {
            let corners = self.corners(element);
            if signed_volume(corners) > 0.0 { tetrahedron(corners).radius_ratio } else { -1.0 }
        };
        self.of_node[node as usize].iter().map(ratio).fold(1.0, f64::min)
    }

    /// Divides the edges that cross a disc.
    fn divide(&mut self, disc: &Disc, side: &mut BTreeMap<u32, i8>, size: f64) {
        let mut edges: BTreeSet<[u32; 2]> = BTreeSet::new();
        for &node in side.keys() {
            for &element in &self.of_node[node as usize] {
                for [i, j] in TETRAHEDRON_EDGES {
                    let [a, b] = [i, j].map(|k| self.elements[element as usize][k]);
                    if let (Some(one), Some(two)) = (side.get(&a), side.get(&b))
                        && one * two < 0
                    {
                        edges.insert([a.min(b), a.max(b)]);
                    }
                }
            }
        }
        let mut crossing: Vec<(f64, [u32; 2], Vec3)> = Vec::new();
        for edge in edges {
            let [p, q] = edge.map(|node| self.place(node));
            let [low, high] = [p, q].map(|at| (at - disc.centre).dot(&disc.normal));
            let at = p + (q - p) * (low / (low - high));
            if (at - disc.centre).norm() < disc.radius + size {
                crossing.push(((q - p).norm(), edge, at));
            }
        }
        crossing.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, edge, at) in crossing {
            side.insert(self.split(edge, at), 0);
        }
    }

    /// Divides an edge; gives the node there.
    fn split(&mut self, [a, b]: [u32; 2], at: Vec3) -> u32 {
        let middle = self.at.len() as u32;
        self.at.push(at);
        self.held.push(false);
        self.of_node.push(Vec::new());
        self.skin_of_node.push(Vec::new());
        let shared = |of: &[Vec<u32>]| -> Vec<u32> {
            of[a as usize].iter().copied().filter(|other| of[b as usize].contains(other)).collect()
        };
        for element in shared(&self.of_node) {
            let old = self.elements[element as usize];
            let new = self.elements.len() as u32;
            self.elements[element as usize] = old.map(|node| if node == b { middle } else { node });
            let far = old.map(|node| if node == a { middle } else { node });
            self.elements.push(far);
            self.label.push(self.label[element as usize]);
            for allowed in &mut self.allowed {
                allowed.push(allowed[element as usize]);
            }
            self.of_node[b as usize].retain(|&other| other != element);
            self.of_node[middle as usize].push(element);
            far.iter().for_each(|&node| self.of_node[node as usize].push(new));
        }
        for facet in shared(&self.skin_of_node) {
            let old = self.skin[facet as usize].clone();
            let new = self.skin.len() as u32;
            self.skin[facet as usize].nodes = old.nodes.map(|node| if node == b { middle } else { node });
            let far = old.nodes.map(|node| if node == a { middle } else { node });
            self.skin.push(Skin { nodes: far, ..old });
            self.skin_of_node[b as usize].retain(|&other| other != facet);
            self.skin_of_node[middle as usize].push(facet);
            far.iter().for_each(|&node| self.skin_of_node[node as usize].push(new));
        }
        let whole = self.lines.iter().position(|(ends, _)| ends.contains(&a) && ends.contains(&b));
        if let Some(line) = whole {
            let (ends, of) = self.lines[line];
            self.lines[line].0 = [ends[0], middle];
            self.lines.push(([middle, ends[1]], of));
            self.held[middle as usize] = true;
        }
        middle
    }

    /// Makes the faces on a disc faces of its joint.
    fn mark(&mut self, joint: u32, disc: &Disc, side: &BTreeMap<u32, i8>) -> Fate {
        let on = |node: &u32| side.get(node) == Some(&0);
        let mut faces: BTreeMap<[u32; 3], Vec<(u32, bool)>> = BTreeMap::new();
        for (&node, _) in side.iter().filter(|(_, side)| **side == 0) {
            for &element in &self.of_node[node as usize] {
                let own = self.elements[element as usize];
                for (opposite, facet) in TETRAHEDRON_FACETS.iter().enumerate() {
                    let mut nodes = facet.map(|corner| own[corner]);
                    if !nodes.iter().all(on) {
                        continue;
                    }
                    nodes.sort_unstable();
                    let above = (self.place(own[opposite]) - disc.centre).dot(&disc.normal) > 0.0;
                    let known = faces.entry(nodes).or_default();
                    if !known.contains(&(element, above)) {
                        known.push((element, above));
                    }
                }
            }
        }
        let mut area = 0.0;
        for (nodes, beside) in faces {
            let [a, b, c] = nodes.map(|node| self.place(node));
            let is_allowed = |(element, _): &(u32, bool)| self.is_allowed(disc.group, *element);
            let within = ((a + b + c) / 3.0 - disc.centre).norm() < disc.radius;
            if beside.len() != 2 || beside[0].1 == beside[1].1 || !within || !beside.iter().all(is_allowed) {
                continue;
            }
            let sorted = |mut nodes: [u32; 3]| {
                nodes.sort_unstable();
                nodes
            };
            let there = self.skin_of_node[nodes[0] as usize].iter();
            if there.clone().any(|&facet| {
                let facet = &self.skin[facet as usize];
                sorted(facet.nodes) == nodes && facet.joint.is_some()
            }) {
                continue;
            }
            area += 0.5 * (b - a).cross(&(c - a)).norm();
            let number = self.skin.len() as u32;
            nodes.iter().for_each(|&node| self.skin_of_node[node as usize].push(number));
            self.skin.push(Skin { nodes, triangle: None, joint: Some(joint) });
        }
        if area > 0.0 { Fate::Cut(area) } else { Fate::Outside }
    }

    /// Moves free nodes near joints to the middle of their neighbours where the worst element at them gets better.
    pub(super) fn improve(&mut self) {
        let of_joints = self.skin.iter().filter(|facet| facet.joint.is_some()).flat_map(|facet| facet.nodes);
        let near: BTreeSet<u32> = of_joints
            .flat_map(|node| self.of_node[node as usize].iter().flat_map(|&e| self.elements[e as usize]))
            .collect();
        for _ in 0..ROUNDS {
            for &node in near.iter().filter(|&&n| self.skin_of_node[n as usize].is_empty() && !self.held[n as usize]) {
                let around = &self.of_node[node as usize];
                let others: BTreeSet<u32> =
                    around.iter().flat_map(|&e| self.elements[e as usize]).filter(|&n| n != node).collect();
                let to = others.iter().map(|&n| self.place(n)).sum::<Vec3>() / others.len() as f64;
                let (from, before) = (self.place(node), self.worst(node));
                self.at[node as usize] = from + 0.5 * (to - from);
                if self.worst(node) <= before {
                    self.at[node as usize] = from;
                }
            }
        }
    }
}

/// The angle of two discs, where it is too small and they are near each other.
fn sharp(one: &Disc, two: &Disc, near: f64, least: f64) -> Option<f64> {
    let between = two.centre - one.centre;
    let angle = acos(one.normal.dot(&two.normal).abs().min(1.0));
    let height = |normal: &Vec3, radius: f64| between.dot(normal).abs() < radius * sin(angle) + near;
    let meet = height(&one.normal, two.radius) && height(&two.normal, one.radius);
    (angle < least && meet && between.norm() < one.radius + two.radius).then_some(angle)
}
