//! Interfaces at equilibrium: those with a stiffness are springs between two nodes, linear about the last iterate by their tangent or secant.

use fractum_fem::Solid;
use fractum_kernels::interface::SpringInterface;
use fractum_math::{Mat3, Vec3};

use super::motion::Closing;
use super::{InterfaceKind, Interfaces, Taken};

/// A spring of an interface between two nodes.
pub(crate) struct InterfaceSpring {
    /// Nodes on the first and on the second side.
    pub(crate) pair: [u32; 2],
    /// Unit normal towards the second side.
    pub(crate) normal: Vec3,
    /// Force on the second node [N].
    pub(crate) force: Vec3,
    /// How it falls with the displacement of the second node against the first [N/m].
    pub(crate) stiffness: Mat3,
}

impl Interfaces {
    /// Springs under a displacement field, with the histories of the last equilibrium.
    ///
    /// - `share`: part of the secant in their stiffness, the rest of which is their tangent
    pub(crate) fn springs(&self, field: &[Vec3], share: f64) -> impl Iterator<Item = InterfaceSpring> {
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points).filter(|point| point.area > 0.0);
        points.filter_map(move |point| {
            let InterfaceKind { law, stiffness, .. } = &self.kinds[point.kind as usize];
            let interface = SpringInterface { law: *law, stiffness: (*stiffness)? };
            let [a, b] = point.pair.map(|node| field[node as usize]);
            let jump = point.local(b - a);
            let mut state = point.state;
            let force = interface.load(jump, &mut state);
            let traction = force.traction();
            let secant @ [along, across] = interface.secant(&jump, &force, &state);
            let mut stiffness = Mat3::from_diagonal(&Vec3::new(along, across, across));
            if share < 1.0 {
                stiffness =
                    stiffness * share + interface.tangent(&jump, &point.state, &traction, secant) * (1.0 - share);
            }
            Some(InterfaceSpring {
                pair: point.pair,
                normal: point.frame.row(0).transpose(),
                force: -point.frame.tr_mul(&traction) * point.area,
                stiffness: point.frame.transpose() * stiffness * point.frame * point.area,
            })
        })
    }

    /// Takes over the histories of a state of equilibrium; what friction took, and all other work that they took [J].
    pub(crate) fn accept_at_rest(&mut self, solid: &Solid) -> [f64; 2] {
        let Interfaces { kinds, clusters, .. } = self;
        let mut taken = Taken::default();
        for point in clusters.iter_mut().flat_map(|cluster| &mut cluster.points).filter(|point| point.area > 0.0) {
            let InterfaceKind { law, stiffness: Some(stiffness), .. } = &kinds[point.kind as usize] else { continue };
            let interface = SpringInterface { law: *law, stiffness: *stiffness };
            let [a, b] = point.pair.map(|node| solid.displacement[node as usize]);
            taken.half(point, b - a, Closing::Stored);
            point.force = interface.load(point.local(b - a), &mut point.state);
            point.pull = point.frame.tr_mul(&point.force.traction()) * point.area;
            taken.half(point, b - a, Closing::Stored);
            point.jump = b - a;
        }
        [taken.friction, taken.work - taken.friction]
    }

    /// Adds their forces at a state of equilibrium.
    pub(crate) fn add_forces_at_rest(&self, solid: &mut Solid) {
        for point in self.clusters.iter().flat_map(|cluster| &cluster.points) {
            let [a, b] = point.pair.map(|node| node as usize);
            solid.force[a] += point.pull;
            solid.force[b] -= point.pull;
        }
    }
}
