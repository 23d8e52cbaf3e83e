//! Interfaces in rock under in-situ stress: their sides are together at the start, and bear what the rock bears there.

use fractum_fem::Solid;
use fractum_kernels::interface::{InterfaceLaw, SpringInterface};
use fractum_math::Vec3;

use super::inside::pressure_in;
use super::{InterfaceKind, Interfaces, Point};

/// How much stiffer than an element the springs are that keep the sides together until the state of the start is known.
const FIRM: f64 = 1e4;
/// What tractions may exceed the strength by, over the largest traction: the state of the start is not known better.
const ROUNDING: f64 = 1e-6;

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
    /// - `springs`: of [`Interfaces::firm_springs`], whose forces are in balance with all others
    pub(crate) fn begin_under(&mut self, solid: &Solid, springs: &[([u32; 2], f64)]) -> Result<(), Overloaded> {
        self.turn(solid);
        let Interfaces { kinds, pressures, clusters, .. } = self;
        let points = || clusters.iter().flat_map(|cluster| &cluster.points).filter(|point| point.area > 0.0);
        let jump = |point: &Point| {
            let [a, b] = point.pair.map(|node| solid.displacement[node as usize]);
            b - a
        };
        let tractions: Vec<Vec3> = points()
            .zip(springs)
            .map(|(point, (_, stiffness))| {
                let thrust = pressure_in(pressures, point.kind)
                    .map_or_else(Vec3::zeros, |pressure| pressure.thrust(point, point.state.residual, 0.0));
                point.frame * (jump(point) * *stiffness + thrust) / point.area
            })
            .collect();
        let largest = tractions.iter().map(|traction| traction.norm()).fold(0.0, f64::max);
        for (point, traction) in points().zip(&tractions) {
            let InterfaceKind { name, law, .. } = &kinds[point.kind as usize];
            if !bears(law, traction, ROUNDING * largest) {
                let traction = [traction.x, traction.yz().norm()];
                return Err(Overloaded { name: name.clone(), place: point.place, traction });
            }
        }
        let points = clusters.iter_mut().flat_map(|cluster| &mut cluster.points).filter(|point| point.area > 0.0);
        for (point, traction) in points.zip(&tractions) {
            let InterfaceKind { law, stiffness, .. } = &kinds[point.kind as usize];
            point.jump = jump(point);
            let given_way = stiffness.map_or_else(Vec3::zeros, |[normal, across]| {
                Vec3::new(traction.x / normal, traction.y / across, traction.z / across)
            });
            point.offset = point.frame * point.jump - given_way;
            point.pull = point.frame.tr_mul(traction) * point.area;
            if let Some(stiffness) = *stiffness {
                point.force = SpringInterface { law: *law, stiffness }.load(given_way, &mut point.state);
            }
            if let Some(pressure) = pressure_in(pressures, point.kind) {
                point.thrust = pressure.thrust(point, point.state.residual, 0.0);
            }
        }
        Ok(())
    }
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
