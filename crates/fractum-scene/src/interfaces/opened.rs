//! Cracks that a pressure holds open within solids, and what the size of their faces takes away.

use std::collections::BTreeMap;

use fractum_fem::{Formulation, Solid};
use fractum_math::{Vec3, connected};

use super::reading::is_broken;
use super::{Interfaces, Point};

/// Part of its volume by which a crack opens too little, times the faces from its middle to its edge: plain elements, smoothed triangles and smoothed
/// tetrahedra. Measured on slits, strips and discs under pressure with 2 to 40 faces (`verification inside_pressure`).
const MISSING: [f64; 3] = [0.7, 0.4, 0.3];

/// Faces that have opened under a pressure inside, whose edge lies within the solids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenedCrack {
    /// Number of their interface.
    pub kind: u32,
    /// Their area [m²].
    pub area: f64,
    /// Their area over the length of their edge: the half length of a slit, half of the radius of a disc [m].
    pub reach: f64,
    /// Mean length of the edges of the faces along it [m].
    pub size: f64,
    /// Part of its volume by which such a crack opens too little, as its elements are: plain, or smoothed.
    pub missing: [f64; 2],
    /// Whether the elements on both sides are smoothed.
    pub is_smoothed: bool,
}

impl OpenedCrack {
    /// The part that is missing as its elements are.
    pub fn is_missing(&self) -> f64 {
        self.missing[usize::from(self.is_smoothed)]
    }
}

impl Interfaces {
    /// The crack under pressure that opens too little by the largest part.
    pub fn coarsest_crack(&self, solid: &Solid) -> Option<OpenedCrack> {
        let opened: Vec<usize> = (0..self.faces.len()).filter(|&face| self.is_opened(face)).collect();
        let mut first = BTreeMap::new();
        let mut joined = Vec::new();
        for (place, &face) in (0u32..).zip(&opened) {
            for at in self.open_corners(face) {
                joined.push([*first.entry(at).or_insert(place), place]);
            }
        }
        let root = connected(opened.len(), joined);
        let mut cracks: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (root, face) in root.into_iter().zip(opened) {
            cracks.entry(root).or_default().push(face);
        }
        let found = cracks.into_values().filter_map(|faces| self.crack(solid, &faces));
        found.max_by(|a, b| a.is_missing().total_cmp(&b.is_missing()))
    }

    /// What faces make together; none where no pressure acts in them, or no edge of them lies within the solids.
    fn crack(&self, solid: &Solid, faces: &[usize]) -> Option<OpenedCrack> {
        let mut points = faces.iter().flat_map(|&face| self.points_of[face].iter().flatten());
        if points.all(|at| self.point(*at).thrust == Vec3::zeros()) {
            return None;
        }
        // Ends of its faces, as the first nodes of their corners, with how many faces have them.
        let mut ends: BTreeMap<[u32; 2], (usize, usize)> = BTreeMap::new();
        for &face in faces {
            let corners = self.faces[face].corners();
            for k in 0..corners {
                let next = if corners == 2 { k } else { (k + 1) % corners };
                if self.is_joined(face, k) && self.is_joined(face, next) {
                    let [a, b] = [k, next].map(|corner| self.node(face, corner));
                    ends.entry([a.min(b), a.max(b)]).or_insert((0, face)).0 += 1;
                }
            }
        }
        let edge: Vec<([u32; 2], usize)> =
            ends.into_iter().filter(|(_, (count, _))| *count == 1).map(|(end, (_, face))| (end, face)).collect();
        let own = &self.faces[*faces.first()?];
        let is_plane = own.corners() == 2;
        let place = |node: u32| solid.reference[node as usize];
        let length = |[a, b]: [u32; 2]| (place(a) - place(b)).norm();
        let thickness =
            own.elements.map(|(body, _)| solid.body(body as usize).thickness).into_iter().fold(f64::INFINITY, f64::min);
        let front: f64 = edge.iter().map(|(end, _)| if is_plane { thickness } else { length(*end) }).sum();
        if front == 0.0 {
            return None;
        }
        let size = |face: usize| {
            let area = self.areas[face];
            if is_plane { area / thickness } else { (4.0 * area / 3f64.sqrt()).sqrt() }
        };
        let size = edge.iter().map(|(_, face)| size(*face)).sum::<f64>() / edge.len() as f64;
        let area: f64 = faces.iter().map(|&face| self.areas[face]).sum();
        let reach = area / front;
        let [plain, triangles, tetrahedra] = MISSING.map(|part| part * size / reach);
        let smoothed = |body: u32| solid.body(body as usize).formulation == Formulation::Smoothed;
        let is_smoothed = faces.iter().all(|&face| self.faces[face].elements.iter().all(|&(body, _)| smoothed(body)));
        let missing = [plain, if is_plane { triangles } else { tetrahedra }];
        Some(OpenedCrack { kind: own.kind, area, reach, size, missing, is_smoothed })
    }

    fn is_opened(&self, face: usize) -> bool {
        self.areas[face] > 0.0 && self.open_corners(face).next().is_some()
    }

    /// Clusters of nodes at the open corners of a face.
    fn open_corners(&self, face: usize) -> impl Iterator<Item = u32> {
        let points = self.points_of[face].iter().flatten();
        let is_apart = |at: &&(u32, u32)| {
            let point = self.point(**at);
            !self.is_held(at.0) && point.local(point.jump).x > 0.0
        };
        points.filter(is_apart).map(|(cluster, _)| *cluster)
    }

    /// Whether a corner is a tip, or its sides are bonded. Sides that press on each other end no crack.
    fn is_joined(&self, face: usize, corner: usize) -> bool {
        self.points_of[face][corner].is_none_or(|(cluster, _)| self.is_held(cluster))
    }

    /// Whether an interface joins nodes in one place.
    fn is_held(&self, cluster: u32) -> bool {
        let bonded = |point: &Point| self.kinds[point.kind as usize].law.is_bonded();
        let points = &self.clusters[cluster as usize].points;
        points.iter().any(|point| point.area > 0.0 && bonded(point) && !is_broken(point))
    }

    /// A node that stands for a place of a face: that of both sides, or the first of all that interfaces join there.
    fn node(&self, face: usize, corner: usize) -> u32 {
        match self.points_of[face][corner] {
            Some((cluster, _)) => self.clusters[cluster as usize].nodes[0],
            None => self.faces[face].sides[0][corner],
        }
    }

    fn point(&self, (cluster, point): (u32, u32)) -> &Point {
        &self.clusters[cluster as usize].points[point as usize]
    }
}
