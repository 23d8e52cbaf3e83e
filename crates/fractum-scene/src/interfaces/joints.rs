//! Interfaces with a stiffness by pairs of nodes, for solvers that take their jumps as unknowns.

use fractum_kernels::interface::{InterfaceState, SpringInterface};
use fractum_math::{Mat3, Vec3};

use super::Interfaces;

/// Cluster and number of a point of an interface.
pub(crate) type PointPlace = (u32, u32);

/// A pair of nodes in one place that interfaces join.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    /// Its nodes.
    pub(crate) pair: [u32; 2],
    /// The points between them.
    pub(crate) points: Vec<JointPoint>,
}

/// A point between the nodes of a pair.
#[derive(Clone, Debug)]
pub(crate) struct JointPoint {
    pub(crate) at: PointPlace,
    /// Number of the interface.
    pub(crate) kind: u32,
    /// Rows: normal and two directions across, for the jump from the first node of the pair to the second.
    pub(crate) frame: Mat3,
    /// Jump of the pair at which it bears nothing: that of the state under in-situ stress, less what its springs have given way to [m].
    pub(crate) unloaded: Vec3,
    /// Area [m²].
    pub(crate) area: f64,
    pub(crate) interface: SpringInterface,
}

impl JointPoint {
    /// A jump of the pair along the rows of its frame.
    pub(crate) fn local(&self, jump: &Vec3) -> Vec3 {
        self.frame * (jump - self.unloaded)
    }
}

impl Interfaces {
    /// Their pairs of nodes with a stiffness between them.
    pub(crate) fn joints(&self) -> Vec<Joint> {
        let mut joints: Vec<Joint> = Vec::new();
        for (number, cluster) in (0u32..).zip(&self.clusters) {
            let first = joints.len();
            for (index, point) in (0u32..).zip(&cluster.points).filter(|(_, point)| point.area > 0.0) {
                let kind = &self.kinds[point.kind as usize];
                let Some(stiffness) = kind.stiffness else { continue };
                let [a, b] = point.pair;
                let (pair, sign) = if a < b { ([a, b], 1.0) } else { ([b, a], -1.0) };
                let place = joints[first..].iter().position(|joint| joint.pair == pair).unwrap_or_else(|| {
                    joints.push(Joint { pair, points: Vec::new() });
                    joints.len() - 1 - first
                });
                joints[first + place].points.push(JointPoint {
                    at: (number, index),
                    kind: point.kind,
                    frame: point.frame * sign,
                    unloaded: point.frame.tr_mul(&point.offset) * sign,
                    area: point.area,
                    interface: SpringInterface { law: kind.law, stiffness },
                });
            }
        }
        joints
    }

    /// The history of a point.
    pub(crate) fn state_of(&self, (cluster, point): PointPlace) -> &InterfaceState {
        &self.clusters[cluster as usize].points[point as usize].state
    }

    /// The points at the corners of a face; none at tips.
    pub(crate) fn points_of_face(&self, face: usize) -> [Option<PointPlace>; 3] {
        self.points_of[face]
    }

    /// Place of a point without load [m].
    pub(crate) fn place_of(&self, (cluster, point): PointPlace) -> Vec3 {
        self.clusters[cluster as usize].points[point as usize].place
    }

    /// Nodes of a cluster.
    pub(crate) fn nodes_of(&self, cluster: u32) -> &[u32] {
        &self.clusters[cluster as usize].nodes
    }

    /// Sets the pressure between the sides of a point [Pa], whose work is booked elsewhere.
    pub(crate) fn press(&mut self, (cluster, point): PointPlace, pressure: f64) {
        let point = &mut self.clusters[cluster as usize].points[point as usize];
        point.thrust = point.frame.row(0).transpose() * (pressure * point.area);
    }
}
