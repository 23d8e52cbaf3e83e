//! Interfaces at equilibrium: those with a stiffness are springs between two nodes, linear about the last iterate by their tangent or secant.

use fractum_fem::Solid;
use fractum_kernels::interface::{InterfaceForce, InterfaceState, SpringInterface};
use fractum_math::{Mat3, Vec3};

use super::inside::pressure_in;
use super::joints::PointPlace;
use super::motion::{Closing, Rubbed};
use super::{InterfaceKind, Interfaces, Taken};

/// Part of a stiffness that what it lacks may be, by differences, where nothing is missing.
const SYMMETRIC: f64 = 1e-6;

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
    /// What its own stiffness has beside that, which is symmetric [N/m]; none where nothing is missing.
    pub(crate) rest: Option<Mat3>,
    /// How it rises with time, by the pressure inside [N/s].
    pub(crate) rate: Vec3,
}

impl Interfaces {
    /// Springs under a displacement field, with the histories of the last equilibrium.
    ///
    /// - `time`: of that field; `ahead`: duration from which the rate of pressures is taken [s]
    /// - `share`: part of the secant in their stiffness, the rest of which is their tangent
    /// - `led`: the point whose softening is given, and how far it goes in this step
    pub(crate) fn springs(
        &self,
        field: &[Vec3],
        [time, ahead]: [f64; 2],
        share: f64,
        led: Option<(PointPlace, f64)>,
    ) -> impl Iterator<Item = InterfaceSpring> {
        let led = led.and_then(|(at, growth)| self.led(at, field, growth));
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points).filter(|point| point.area > 0.0);
        points.filter_map(move |point| {
            let InterfaceKind { law, stiffness, .. } = &self.kinds[point.kind as usize];
            let interface = SpringInterface { law: *law, stiffness: (*stiffness)? };
            let [a, b] = point.pair.map(|node| field[node as usize]);
            let jump = point.local(b - a);
            let mut state = point.state;
            let force = interface.load(jump, &mut state);
            let mut traction = force.traction();
            let secant @ [along, across] = interface.secant(&jump, &force, &state);
            let mut stiffness = Mat3::from_diagonal(&Vec3::new(along, across, across));
            let mut rest = None;
            if share < 1.0 {
                let tangent = interface.tangent(&jump, &point.state, secant);
                stiffness = stiffness * share + tangent * (1.0 - share);
                // What is not bonded keeps that share of its secant: it may be all that holds a side. So does what softens beside a point that leads:
                // it would go its own way. Beside the load it would only be held back.
                let held = if point.state.secant > 0.0 && led.is_none() { stiffness } else { tangent };
                let missing = interface.jacobian(&jump, &point.state) - held;
                let moves = jump != Vec3::zeros() && missing.norm() > SYMMETRIC * stiffness.norm();
                rest = moves.then_some(missing);
            }
            if let Some(led) = led.as_ref().and_then(|led| led.of(point, &interface)) {
                stiffness = led.stiffness;
                rest = None;
                traction = led.traction + stiffness * (jump - led.jump);
            }
            let thrust = |time: f64| {
                let pressure = pressure_in(&self.pressures, point.kind);
                pressure.map_or_else(Vec3::zeros, |pressure| pressure.thrust(point, state.residual, time))
            };
            let pushed = thrust(time);
            Some(InterfaceSpring {
                pair: point.pair,
                normal: point.frame.row(0).transpose(),
                force: pushed - point.frame.tr_mul(&traction) * point.area,
                stiffness: point.frame.transpose() * stiffness * point.frame * point.area,
                rest: rest.map(|rest| point.frame.transpose() * rest * point.frame * point.area),
                rate: (thrust(time + ahead) - pushed) / ahead,
            })
        })
    }

    /// Takes over the histories of a state of equilibrium; what friction took, all other work that they took, that of pressure
    /// inside, and what of the second one is none of their law: it is there as far as one step lets sides part under a pressure that only comes in it [J].
    ///
    /// - `is_wet`: whether liquid may part them, else the last is 0
    pub(crate) fn accept_at_rest(&mut self, solid: &Solid, time: f64, is_wet: bool) -> [f64; 4] {
        let Interfaces { kinds, pressures, clusters, .. } = self;
        let (mut taken, mut surplus) = (Taken::default(), 0.0);
        for point in clusters.iter_mut().flat_map(|cluster| &mut cluster.points).filter(|point| point.area > 0.0) {
            let InterfaceKind { law, stiffness: Some(stiffness), .. } = &kinds[point.kind as usize] else { continue };
            let interface = SpringInterface { law: *law, stiffness: *stiffness };
            let [a, b] = point.pair.map(|node| solid.displacement[node as usize]);
            let before = (taken.work - taken.friction, point.area * point.force.stored);
            taken.half(point, b - a, Closing::Stored);
            let rubbed = Rubbed::of(point);
            let (was, state, friction) = (point.local(point.jump), point.state, point.force.friction);
            point.force = interface.load(point.local(b - a), &mut point.state);
            point.pull = point.frame.tr_mul(&point.force.traction()) * point.area;
            taken.half(point, b - a, Closing::Stored);
            taken.rub(point, &rubbed);
            let took = taken.work - taken.friction - before.0;
            if is_wet && !law.is_bonded() {
                surplus += took - (point.area * point.force.stored - before.1);
            } else if is_wet && point.state.residual < 1.0 && [friction, point.force.friction] == [Vec3::zeros(); 2] {
                // A whole bond is a spring, whose mean is exact.
                surplus += took - point.area * work_by_law(&interface, state, [was, point.local(b - a)]);
            }
            if let Some(pressure) = pressure_in(pressures, point.kind) {
                let thrust = pressure.thrust(point, point.state.residual, time);
                taken.external += 0.5 * (point.thrust + thrust).dot(&(b - a - point.jump));
                point.thrust = thrust;
            }
            point.jump = b - a;
        }
        [taken.friction, taken.work - taken.friction, taken.external, surplus]
    }

    /// Adds their forces at a state of equilibrium.
    pub(crate) fn add_forces_at_rest(&self, solid: &mut Solid) {
        for point in self.clusters.iter().flat_map(|cluster| &cluster.points) {
            let [a, b] = point.pair.map(|node| node as usize);
            let pull = point.pull - point.thrust;
            solid.force[a] += pull;
            solid.force[b] -= pull;
        }
    }
}

/// Parts of a way over which the work of a law is summed; they grow from its begin on, where a closed interface opens and softens.
const PARTS: u32 = 200;

/// Work per area of pressure and cohesion over a way from one jump to another, both in the frame of the face [J/m²].
fn work_by_law(interface: &SpringInterface, mut state: InterfaceState, [from, to]: [Vec3; 2]) -> f64 {
    let pulls = |force: InterfaceForce| force.traction() - force.friction;
    let at = |part: u32| from + (to - from) * (f64::from(part) / f64::from(PARTS)).powi(3);
    let mut pull = pulls(interface.load(from, &mut state));
    let mut work = 0.0;
    for part in 1..=PARTS {
        let next = pulls(interface.load(at(part), &mut state));
        work += 0.5 * (pull + next).dot(&(at(part) - at(part - 1)));
        pull = next;
    }
    work
}
