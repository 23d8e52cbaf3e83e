//! Forces of interfaces in a step.

use fractum_fem::Solid;
use fractum_kernels::interface::{FreeJump, InterfaceLaw, SpringInterface, stiff_traction};
use fractum_math::{Vec3, Work};
use rayon::prelude::*;

use super::inside::pressure_in;
use super::{Cluster, InsidePressure, InterfaceKind, Interfaces, Point, Taken};

/// Sweeps over the stiff points of nodes in one place, and the change of their forces that is rounding.
const SWEEPS: usize = 60;
const ROUNDING: f64 = 1e-11;
/// Clusters that one thread takes at least.
const TOGETHER: usize = 128;

/// A step as interfaces see it.
pub(crate) struct InterfaceStep<'a> {
    /// Time tⁿ [s].
    pub(crate) time: f64,
    /// Step that led here; 0 where nothing has moved before [s].
    pub(crate) elapsed: f64,
    /// Step that follows [s].
    pub(crate) dt_after: f64,
    /// Bit a of a node is set where its axis a is prescribed; empty without supports.
    pub(crate) held: &'a [u8],
}

impl InterfaceStep<'_> {
    /// Duration that the forces of tⁿ change the velocity for [s].
    fn dt_kick(&self) -> f64 {
        0.5 * (self.elapsed + self.dt_after)
    }
}

impl Interfaces {
    /// Adds their forces, once all others but those of rigid shapes are there; what friction and the meeting of stiff sides took, and all other work that
    /// they took [J]. Pressure inside does work from outside.
    pub(crate) fn add_forces(&mut self, solid: &mut Solid, step: &InterfaceStep) -> (Work, f64) {
        self.turn(solid);
        let Interfaces { kinds, pressures, clusters, .. } = self;
        let of_solid = &*solid;
        clusters
            .par_iter_mut()
            .with_min_len(TOGETHER)
            .for_each(|cluster| cluster.load(kinds, pressures, of_solid, step));
        let mut sum = Taken::default();
        for cluster in clusters {
            for (&node, force) in cluster.nodes.iter().zip(&cluster.forces) {
                solid.force[node as usize] += force;
            }
            let Taken { work, external, friction, impact } = cluster.taken;
            let (work, external) = (sum.work + work, sum.external + external);
            sum = Taken { work, external, friction: sum.friction + friction, impact: sum.impact + impact };
        }
        (
            Work { external: sum.external, ..Work::contact(0.0, sum.friction, sum.impact) },
            sum.work - sum.friction - sum.impact,
        )
    }
}

impl Cluster {
    /// Finds its forces at tⁿ and what the step before has taken.
    fn load(
        &mut self,
        kinds: &[InterfaceKind],
        pressures: &[Option<InsidePressure>],
        solid: &Solid,
        step: &InterfaceStep,
    ) {
        let Cluster { nodes, points, forces, taken } = self;
        forces.fill(Vec3::zeros());
        *taken = Taken::default();
        let mut stiff = 0;
        for point in points.iter_mut().filter(|point| point.area > 0.0) {
            let InterfaceKind { law, stiffness, .. } = &kinds[point.kind as usize];
            let jump = jump(point, solid);
            if step.elapsed > 0.0 {
                taken.half(point, jump, closing(law, stiffness));
            }
            let pressure = pressure_in(pressures, point.kind);
            if let Some(pressure) = pressure {
                let thrust = pressure.thrust(point, point.state.residual, step.time);
                let before = std::mem::replace(&mut point.thrust, thrust);
                if step.elapsed > 0.0 {
                    taken.external += 0.5 * (before + point.thrust).dot(&(jump - point.jump));
                }
                push(forces, point, -point.thrust);
            }
            match stiffness {
                Some(stiffness) => {
                    let interface = SpringInterface { law: *law, stiffness: *stiffness };
                    let rubbed = Rubbed::of(point);
                    point.force = interface.load(point.local(jump), &mut point.state);
                    point.pull = point.frame.tr_mul(&point.force.traction()) * point.area;
                    if step.elapsed > 0.0 {
                        taken.half(point, jump, closing(law, &Some(*stiffness)));
                        taken.rub(point, &rubbed);
                    }
                    point.jump = jump;
                }
                None => stiff += 1,
            }
            push(forces, point, point.pull);
        }
        if stiff == 0 {
            return;
        }
        // They begin with the forces of the step before.
        for _ in 0..SWEEPS {
            let (mut change, mut largest) = (0.0f64, 0.0f64);
            for point in points.iter_mut().filter(|point| point.area > 0.0) {
                let InterfaceKind { law, stiffness: None, .. } = &kinds[point.kind as usize] else { continue };
                let free = free_jump(point, nodes, forces, solid, step);
                let mut state = point.state;
                let found = stiff_traction(law, &free, &mut state);
                let pull = point.frame.tr_mul(&found.traction()) * point.area;
                change = change.max((pull - point.pull).norm());
                largest = largest.max(pull.norm());
                push(forces, point, pull - point.pull);
                (point.pull, point.force, point.tried) = (pull, found, state);
            }
            if stiff == 1 || change <= ROUNDING * largest {
                break;
            }
        }
        for point in points.iter_mut().filter(|point| point.area > 0.0) {
            let InterfaceKind { law, stiffness: stiffness @ None, .. } = &kinds[point.kind as usize] else { continue };
            point.state = point.tried;
            let jump = jump(point, solid);
            if step.elapsed > 0.0 {
                taken.half(point, jump, closing(law, stiffness));
            }
            point.jump = jump;
        }
    }
}

/// Where the work of pressure goes as a point moves along its normal.
#[derive(Clone, Copy)]
pub(super) enum Closing {
    /// It is stored, and friction is found by what slides, see [`Taken::rub`].
    Stored,
    /// Sides that meet lose it.
    Lost,
    /// Sliding over asperities gives and takes it.
    Slides,
}

pub(super) fn closing(law: &InterfaceLaw, stiffness: &Option<[f64; 2]>) -> Closing {
    match (stiffness, law.dilation > 0.0) {
        (Some(_), _) => Closing::Stored,
        (None, false) => Closing::Lost,
        (None, true) => Closing::Slides,
    }
}

impl Taken {
    /// Adds the work that the present forces of a point do over half of its way to a jump.
    pub(super) fn half(&mut self, point: &Point, jump: Vec3, closing: Closing) {
        let way = jump - point.jump;
        let local = point.frame * way;
        let closed = -0.5 * point.area * point.force.contact * local.x;
        let rubbed = 0.5 * point.area * point.force.friction.dot(&local);
        self.work += 0.5 * point.pull.dot(&way);
        match closing {
            Closing::Stored => {}
            Closing::Lost => (self.friction, self.impact) = (self.friction + rubbed, self.impact + closed),
            Closing::Slides => self.friction += rubbed + closed,
        }
    }

    /// Adds what friction takes of a point with a stiffness, which gives way before it slides.
    pub(super) fn rub(&mut self, point: &Point, before: &Rubbed) {
        let now = Rubbed::of(point);
        self.friction += 0.5 * point.area * (before.friction + now.friction).dot(&(now.slip - before.slip));
    }
}

/// Friction of a point [Pa] and how far it has slid [m].
pub(super) struct Rubbed {
    friction: Vec3,
    slip: Vec3,
}

impl Rubbed {
    pub(super) fn of(point: &Point) -> Self {
        let [first, second] = point.state.slip;
        Rubbed { friction: point.force.friction, slip: Vec3::new(0.0, first, second) }
    }
}

/// The jump across a point, in space [m].
fn jump(point: &Point, solid: &Solid) -> Vec3 {
    let [a, b] = point.pair.map(|node| solid.displacement[node as usize]);
    b - a
}

/// Adds a force that pulls the sides of a point together.
fn push(forces: &mut [Vec3], point: &Point, pull: Vec3) {
    let [a, b] = point.local.map(usize::from);
    forces[a] += pull;
    forces[b] -= pull;
}

/// The jump of a point under all forces but its own.
fn free_jump(point: &Point, nodes: &[u32], forces: &[Vec3], solid: &Solid, step: &InterfaceStep) -> FreeJump {
    let jump = jump(point, solid);
    let mobility = |side: usize| {
        let node = point.pair[side] as usize;
        solid.mobility(node, step.held.get(node).copied().unwrap_or(0))
    };
    let moves = mobility(0) + mobility(1);
    let velocity = |side: usize| {
        let place = usize::from(point.local[side]);
        let node = nodes[place] as usize;
        let force = solid.force[node] + forces[place];
        solid.velocity[node] + mobility(side).component_mul(&force) * step.dt_kick()
    };
    let own = moves.component_mul(&point.pull) * step.dt_kick();
    let ahead = jump + (velocity(1) - velocity(0) + own) * step.dt_after;
    let unit = step.dt_after * step.dt_kick() * point.area;
    let least = point.pair.iter().map(|&node| 1.0 / solid.mass[node as usize]).sum::<f64>();
    // Where supports hold one axis of the nodes alone, a force along the normal moves them across it, too. Both then share the same motion, and each may
    // take its part of it: by the sum of a row of the mobility no direction takes back more than there is.
    let inertia = Vec3::from_fn(|axis, _| {
        let along =
            |other: usize| -> f64 { (0..3).map(|k| point.frame[(axis, k)] * moves[k] * point.frame[(other, k)]).sum() };
        let (own, all) = (along(axis), (0..3).map(|other| along(other).abs()).sum::<f64>());
        // Supports that prescribe this motion leave nothing to find.
        1.0 / (unit * if own > 1e-9 * least { all } else { least })
    });
    FreeJump { now: point.local(jump), ahead: point.local(ahead), inertia }
}
