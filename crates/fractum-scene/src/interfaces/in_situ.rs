//! Interfaces in rock under in-situ stress: their sides are together at the start, and bear what the rock bears there.

use fractum_fem::Solid;
use fractum_kernels::interface::{InterfaceLaw, SpringInterface};
use fractum_math::Vec3;

use super::inside::pressure_in;
use super::{Cluster, InterfaceKind, Interfaces, Point};

/// How much stiffer than an element the springs are that keep the sides together until the state of the start is known.
const FIRM: f64 = 1e4;
/// What tractions may exceed the strength by, over the largest traction: the state of the start is not known better.
const ROUNDING: f64 = 1e-5;

/// An interface that cannot bear the state of the start.
pub(crate) struct Overloaded {
    /// Name of the interface.
    pub(crate) name: String,
    /// Where [m].
    pub(crate) place: Vec3,
    /// Traction on its second side along the normal, tension positive, and across it [Pa].
    pub(crate) traction: [f64; 2],
}

impl Interfaces {
    /// Springs between the sides of all points, with the same stiffness in all directions: nodes and stiffness [N/m].
    pub(crate) fn firm_springs(&self, solid: &Solid) -> Vec<([u32; 2], f64)> {
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points).filter(|point| point.area > 0.0);
        let spring = |point: &Point| {
            let face = &self.faces[point.faces[0].0 as usize];
            let [a, b] = [0, 1].map(|corner| solid.reference[face.sides[0][corner] as usize]);
            let modulus = face.elements.map(|(body, _)| solid.body(body as usize).elastic.young_modulus);
            (point.pair, FIRM * modulus[0].max(modulus[1]) * point.area / (b - a).norm())
        };
        points.map(spring).collect()
    }

    /// Begins with the tractions of such springs: jumps count from here, and a stiffness has given way to them already.
    ///
    /// - `held`: bit a of a node is set where a support holds its axis a; empty without supports
    /// - `springs`: of [`Interfaces::firm_springs`], whose forces are in balance with all others
    pub(crate) fn begin_under(
        &mut self,
        solid: &Solid,
        held: &[u8],
        springs: &[([u32; 2], f64)],
    ) -> Result<(), Overloaded> {
        self.turn(solid);
        let Interfaces { pressures, clusters, .. } = self;
        for (point, (_, stiffness)) in present(clusters).zip(springs) {
            let [a, b] = point.pair.map(|node| solid.displacement[node as usize]);
            let pressure = pressure_in(pressures, point.kind);
            point.thrust =
                pressure.map_or_else(Vec3::zeros, |pressure| pressure.thrust(point, point.state.residual, 0.0));
            (point.jump, point.pull) = (b - a, (b - a) * *stiffness + point.thrust);
        }
        self.fill_in_at_supports(held);
        let Interfaces { kinds, clusters, .. } = self;
        let largest = present(clusters).map(|point| point.pull.norm() / point.area).fold(0.0, f64::max);
        for point in present(clusters) {
            let InterfaceKind { name, law, stiffness } = &kinds[point.kind as usize];
            let traction = point.frame * point.pull / point.area;
            if !bears(law, &traction, ROUNDING * largest) {
                let traction = [traction.x, traction.yz().norm()];
                return Err(Overloaded { name: name.clone(), place: point.place, traction });
            }
            let given_way = stiffness.map_or_else(Vec3::zeros, |[normal, across]| {
                Vec3::new(traction.x / normal, traction.y / across, traction.z / across)
            });
            point.offset = point.frame * point.jump - given_way;
            if let Some(stiffness) = *stiffness {
                point.force = SpringInterface { law: *law, stiffness }.load(given_way, &mut point.state);
            }
        }
        Ok(())
    }

    /// Where a support holds both sides along an axis it bears their forces, and springs tell nothing of the traction: it is that of the other
    /// corners of the same faces.
    fn fill_in_at_supports(&mut self, held: &[u8]) {
        let of_node = |node: u32| held.get(node as usize).copied().unwrap_or(0);
        let is_held = |point: &Point, axis: usize| point.pair.into_iter().all(|node| of_node(node) >> axis & 1 == 1);
        let sign = |point: &Point, face: u32| {
            point.faces.iter().find(|own| own.0 == face).map_or(1.0, |(_, share)| share.signum())
        };
        let beside = |point: &Point, axis: usize| {
            let corners = point.faces.iter().flat_map(|&(face, share)| {
                let others = self.points_of[face as usize].iter().flatten();
                others.map(move |&(cluster, index)| (face, share.signum(), cluster, index))
            });
            let (mut sum, mut count) = (0.0, 0.0);
            for (face, own, cluster, index) in corners {
                let other = &self.clusters[cluster as usize].points[index as usize];
                if other.area > 0.0 && !is_held(other, axis) {
                    sum += own * sign(other, face) * other.pull[axis] / other.area;
                    count += 1.0;
                }
            }
            (count > 0.0).then(|| point.area * sum / count)
        };
        let mut found: Vec<(usize, usize, usize, f64)> = Vec::new();
        for (cluster, own) in self.clusters.iter().enumerate() {
            for (index, point) in own.points.iter().enumerate().filter(|(_, point)| point.area > 0.0) {
                let axes = (0..3).filter(|&axis| is_held(point, axis));
                found.extend(axes.filter_map(|axis| Some((cluster, index, axis, beside(point, axis)?))));
            }
        }
        for (cluster, index, axis, pull) in found {
            self.clusters[cluster].points[index].pull[axis] = pull;
        }
    }
}

/// Points with an area.
fn present(clusters: &mut [Cluster]) -> impl Iterator<Item = &mut Point> {
    clusters.iter_mut().flat_map(|cluster| &mut cluster.points).filter(|point| point.area > 0.0)
}

/// Whether an interface that nothing has loaded yet bears a traction.
///
/// - `rounding`: of the traction [Pa]
fn bears(law: &InterfaceLaw, traction: &Vec3, rounding: f64) -> bool {
    let pressure = (-traction.x).max(0.0);
    let rubs = law.friction_at(if law.is_bonded() { 1.0 } else { 0.0 }, pressure, 0.0) * pressure;
    let opens = (traction.x - rounding).max(0.0);
    let slides = (traction.yz().norm() - rounding).max(0.0);
    if !law.is_bonded() {
        return opens == 0.0 && slides <= rubs;
    }
    let [opens, slides] = [opens / law.tensile_strength, slides / (law.cohesion + rubs)];
    opens * opens + slides * slides <= 1.0
}
