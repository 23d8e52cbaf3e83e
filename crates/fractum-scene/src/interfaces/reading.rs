//! What is seen of interfaces: state for checkpoints, faces for frames and probes, energies.

use fractum_fem::Solid;
use fractum_kernels::interface::{InterfaceForce, InterfaceState};
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use super::{InterfaceFace, InterfaceKind, Interfaces, Point};

/// Share of the strength that is left where an interface counts as broken.
const BROKEN: f64 = 0.02;
/// Shares of sliding at which the energy of a law is looked at.
const SHARES: u32 = 20;
/// Opening over the length of a face up to which sides that nothing joins touch.
const TOUCHING: f64 = 1e-6;

/// Everything about interfaces that changes in a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfacesState {
    areas: Vec<f64>,
    points: Vec<PointState>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct PointState {
    area: f64,
    turned: u16,
    offset: Vec3,
    state: InterfaceState,
    jump: Vec3,
    pull: Vec3,
    thrust: Vec3,
    cohesive: Vec3,
    friction: Vec3,
    contact: f64,
    stored: f64,
}

/// A face of an interface as it is: means over its corners, 0 at tips.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceReading {
    /// Area [m²]; 0 once an element beside it has left.
    pub area: f64,
    /// Opening along the normal [m].
    pub opening: f64,
    /// Slip of the second side against the first [m].
    pub slip: Vec3,
    /// Traction of the first side on the second along the normal, tension positive, without the pressure inside [Pa].
    pub normal_traction: f64,
    /// Size of the traction across it [Pa].
    pub shear_traction: f64,
    /// Share of the strength that is left, 1 where it is whole.
    pub residual: f64,
    /// Part of its corners that are broken.
    pub broken: f64,
}

impl Interfaces {
    /// The interfaces.
    pub fn kinds(&self) -> &[InterfaceKind] {
        &self.kinds
    }

    /// Their faces.
    pub fn faces(&self) -> &[InterfaceFace] {
        &self.faces
    }

    /// Number of faces and area of an interface [m²].
    pub fn extent(&self, kind: u32) -> (usize, f64) {
        let own = self.faces.iter().zip(&self.areas).filter(|(face, _)| face.kind == kind);
        own.fold((0, 0.0), |(count, sum), (_, area)| (count + 1, sum + area))
    }

    /// A face as it is.
    pub fn reading(&self, face: usize) -> FaceReading {
        let corners = self.faces[face].corners();
        let mut mean = FaceReading { area: self.areas[face], ..FaceReading::default() };
        let share = 1.0 / corners as f64;
        for corner in &self.points_of[face][..corners] {
            let Some((cluster, point)) = corner else {
                mean.residual += share;
                continue;
            };
            let point = &self.clusters[*cluster as usize].points[*point as usize];
            let own = point.faces.iter().find(|own| own.0 as usize == face).map_or(1.0, |own| own.1.signum());
            let local = point.local(point.jump);
            let traction = point.force.traction();
            mean.opening += share * local.x;
            mean.slip += point.frame.tr_mul(&Vec3::new(0.0, local.y, local.z)) * (share * own);
            mean.normal_traction += share * traction.x;
            mean.shear_traction += share * traction.yz().norm();
            mean.residual += share * point.state.residual;
            mean.broken += if is_broken(point) { share } else { 0.0 };
        }
        mean
    }

    /// Whether gas comes between the sides of a face: they were never joined, have begun to break, or one of them has left.
    pub(crate) fn lets_in(&self, face: usize) -> bool {
        let begun = |&(cluster, point): &(u32, u32)| {
            self.clusters[cluster as usize].points[point as usize].state.residual < 1.0
        };
        self.areas[face] == 0.0
            || !self.kinds[self.faces[face].kind as usize].law.is_bonded()
            || self.points_of[face].iter().flatten().any(begun)
    }

    /// Whether the sides of a face touch at a corner: they are joined, or nothing is between them.
    pub(crate) fn touches(&self, solid: &Solid, face: usize, corner: usize) -> bool {
        let Some((cluster, point)) = self.points_of[face][corner] else { return false };
        let point = &self.clusters[cluster as usize].points[point as usize];
        let own = &self.faces[face];
        let joined = self.kinds[own.kind as usize].law.is_bonded() && !is_broken(point);
        joined || point.local(point.jump).x <= TOUCHING * own.length(solid)
    }

    /// The element beside the face whose sides have slid farthest, and how far over the length of its first edge.
    pub(crate) fn farthest_slip(&self, solid: &Solid) -> Option<((u32, u32), f64)> {
        let slid = |(index, face): (usize, &InterfaceFace)| {
            (face.elements[0], self.reading(index).slip.norm() / face.length(solid))
        };
        self.faces.iter().enumerate().map(slid).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Faces of bonded interfaces with the part of them that is broken: face, part, area [m²].
    pub fn broken(&self) -> impl Iterator<Item = (&InterfaceFace, f64, f64)> {
        let bonded = |face: &InterfaceFace| self.kinds[face.kind as usize].law.is_bonded();
        let readings = self.faces.iter().enumerate().filter(move |(_, face)| bonded(face));
        readings
            .map(|(index, face)| (face, self.reading(index)))
            .filter(|(_, is)| is.broken > 0.0)
            .map(|(face, is)| (face, is.broken, is.area))
    }

    /// Pairs of nodes that an interface still joins.
    pub(crate) fn links(&self, joined_below: f64) -> impl Iterator<Item = [u32; 2]> {
        let holds = move |point: &&Point| point.area > 0.0 && point.state.residual > 1.0 - joined_below;
        self.clusters.iter().flat_map(|cluster| &cluster.points).filter(holds).map(|point| point.pair)
    }

    /// The most that their fracture can take by now: the largest energy of each law over the area that has begun to break [J].
    pub fn largest_fracture(&self) -> f64 {
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points);
        let largest = |kind: &InterfaceKind| {
            let of = |share: u32| kind.law.energy(f64::from(share) / f64::from(SHARES));
            if kind.law.is_bonded() { (0..=SHARES).map(of).fold(0.0, f64::max) } else { 0.0 }
        };
        let largest: Vec<f64> = self.kinds.iter().map(largest).collect();
        points.filter(|point| point.state.residual < 1.0).map(|point| point.area * largest[point.kind as usize]).sum()
    }

    /// Energy stored in them [J].
    pub(crate) fn stored(&self) -> f64 {
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points);
        points.map(|point| point.area * point.force.stored).sum::<f64>() + 0.0
    }

    /// Everything that changes.
    pub(crate) fn state(&self) -> InterfacesState {
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points);
        let of = |point: &Point| {
            let Point { area, turned, offset, state, jump, pull, thrust, force, .. } = point;
            let InterfaceForce { cohesive, friction, contact, stored } = *force;
            let (area, turned, offset, state) = (*area, *turned, *offset, *state);
            let (jump, pull, thrust) = (*jump, *pull, *thrust);
            PointState { area, turned, offset, state, jump, pull, thrust, cohesive, friction, contact, stored }
        };
        InterfacesState { areas: self.areas.clone(), points: points.map(of).collect() }
    }

    /// Puts a saved state back.
    pub(crate) fn restore(&mut self, solid: &Solid, saved: InterfacesState) {
        let InterfacesState { areas, points } = saved;
        let gone: Vec<bool> = areas.iter().map(|area| *area == 0.0).collect();
        self.areas = areas;
        for (face, of) in self.points_of.iter_mut().enumerate().filter(|(face, _)| gone[*face]) {
            for (cluster, point) in of.iter().flatten() {
                let point = &mut self.clusters[*cluster as usize].points[*point as usize];
                if point.faces.len() > 1 {
                    point.faces.retain(|own| own.0 as usize != face);
                }
            }
            *of = [None; 3];
        }
        let own = self.clusters.iter_mut().flat_map(|cluster| &mut cluster.points);
        for (point, saved) in own.zip(points) {
            let PointState { area, turned, offset, state, jump, pull, thrust, cohesive, friction, contact, stored } =
                saved;
            (point.area, point.turned, point.offset) = (area, turned, offset);
            (point.state, point.tried, point.jump) = (state, state, jump);
            (point.pull, point.thrust) = (pull, thrust);
            point.force = InterfaceForce { cohesive, friction, contact, stored };
        }
        self.turn(solid);
        self.frequency_square = self.added_frequency_square(solid);
    }
}

pub(super) fn is_broken(point: &Point) -> bool {
    point.state.residual <= BROKEN
}
