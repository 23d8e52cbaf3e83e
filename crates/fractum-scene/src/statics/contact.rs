//! Contact at equilibrium, with rigid shapes and of discrete elements with each other: penalty springs, on where a node overlaps and off where it does not.
//!
//! Along the normal those of rigid shapes are so stiff that they count for little beside the elements. The tangential one remembers its
//! force at the last equilibrium as a stretch, and slips where Coulomb's law lets it. The iteration takes them linear about its last iterate,
//! what slips by its given force. Once forces balance, what sticks is brought back: the way it gave becomes stretch (augmented Lagrangian,
//! Simo & Laursen 1992), until nothing that sticks has moved. No tangential spring stores energy.
//! A spring that presses in the linear solution stays on in the next one, even where the curvature of its shape has left a gap.

use fractum_contact::law::slip_to_cone;
use fractum_contact::{Frame, Outside};
use fractum_math::{Mat3, Vec3};

use crate::conditions::integral;
use crate::contacts::{Candidate, NodesOnShape};
use crate::contacts::{Drive, RigidBody};
use crate::coupling::Push;
use crate::error::SceneError;
use crate::interfaces::joints::PointPlace;
use crate::interfaces::rest::InterfaceSpring;
use crate::ledger::EnergyKind;
use crate::scene::Scene;
use crate::statics::anderson::Anderson;
use crate::statics::check_supports;
use crate::step::sum_watched_contacts;

/// Gap over the size of the solid up to which a node counts as touching: what rounding leaves of a body that lies on a shape.
const TOUCHING: f64 = 1e-9;

/// How much stiffer along its normal than a wall of the material of the solid a rigid shape is: that wall gives way as half an element
/// does. Across it a shape is as stiff as the wall, since what sticks is brought back.
const RIGID: f64 = 100.0;

/// Forces by which what sticks has given way over all tangential forces, below which it is where it stuck.
const STUCK: f64 = 1e-3;

/// A node that a shape or another node pushes: its force, linear about the state it was found at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// Node.
    pub(super) node: u32,
    /// The node that pushes it and feels the opposite.
    pub(super) partner: Option<u32>,
    /// Number of the shape that pushes it, where it is one.
    ground: u32,
    /// Unit normal towards the node.
    normal: Vec3,
    /// Force on the node [N].
    pub(super) force: Vec3,
    /// How it falls with the displacement of the node, against that of its partner [N/m].
    pub(super) stiffness: Mat3,
    /// What its own stiffness has beside that, which is symmetric [N/m].
    pub(super) rest: Option<Mat3>,
    /// How it changes as the shape moves on [N/s].
    pub(super) rate: Vec3,
}

impl Spring {
    /// A spring without force between the nodes of a pair.
    pub(super) fn between([partner, node]: [u32; 2], stiffness: Mat3) -> Self {
        let (normal, force, rate) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
        Spring { node, partner: Some(partner), ground: 0, normal, force, stiffness, rest: None, rate }
    }

    /// All of its stiffness [N/m].
    pub(super) fn whole(&self) -> Mat3 {
        self.rest.map_or(self.stiffness, |rest| self.stiffness + rest)
    }

    /// A displacement field at its node, against that of its partner.
    pub(super) fn of(&self, field: &[Vec3]) -> Vec3 {
        let own = field[self.node as usize];
        self.partner.map_or(own, |partner| own - field[partner as usize])
    }

    /// Itself if it is one of a shape and presses, by the linear solution, after its node and time have gone on.
    ///
    /// - `since`: duration [s]
    pub(super) fn pressed(&self, moved: Vec3, since: f64) -> Option<Pressed> {
        let force = self.force + self.rate * since - self.stiffness * moved;
        let pressed = Pressed { ground: self.ground, node: self.node, pressure: force.dot(&self.normal) };
        (self.partner.is_none() && pressed.pressure > 0.0).then_some(pressed)
    }

    /// Adds a force on its node, and the opposite on its partner.
    pub(super) fn push(&self, force: Vec3, forces: &mut [Vec3]) {
        forces[self.node as usize] += force;
        if let Some(partner) = self.partner {
            forces[partner as usize] -= force;
        }
    }

    /// The two nodes that it couples.
    pub(super) fn pair(&self) -> Option<[u32; 2]> {
        self.partner.map(|partner| [self.node, partner])
    }
}

/// Normal and tangential stiffness of a contact with a shape [N/m].
fn stiffness(c: &Candidate) -> [f64; 2] {
    [RIGID * c.law.normal_stiffness, c.law.tangential_stiffness]
}

/// A tangential spring at one instant.
struct Tangential {
    /// Stretch that bears the friction [m].
    slip: Vec3,
    /// What Coulomb's law took from the stretch [m].
    slid: Vec3,
    /// Motion along the shape [m].
    moved: Vec3,
}

/// A spring of a shape that presses at the end of a linear solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pressed {
    ground: u32,
    node: u32,
    /// Normal force [N].
    pressure: f64,
}

/// How what slips and what softens is held while forces do not balance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    /// Part of the secant of friction by which what slips is held along its way, where its force does not change: all of
    /// it comes to the end by many small steps, little of it may go from sticking to slipping and back for ever, and none leaves what
    /// only friction holds without a stiffness. Likewise the part of the secant of interfaces that soften.
    pub(super) share: f64,
    /// The point of an interface whose softening is given, and how far it goes in this step.
    pub(super) led: Option<(PointPlace, f64)>,
}

impl Hold {
    /// By secants alone.
    pub(super) const SECANT: Self = Hold { share: 1.0, led: None };
}

/// Springs of shapes on nodes that do not touch.
#[derive(Clone, Copy, Debug)]
pub(super) enum Also<'a> {
    /// None.
    Nothing,
    /// On those that just do not touch, with no force.
    Near,
    /// On these, ascending by shape and node: they pull back what has left its shape.
    Kept(&'a [Pressed]),
}

impl Also<'_> {
    /// Normal force of a spring that is kept [N].
    fn kept(&self, ground: u32, node: u32) -> Option<f64> {
        let Also::Kept(kept) = self else { return None };
        let place = kept.binary_search_by_key(&(ground, node), |pressed| (pressed.ground, pressed.node)).ok()?;
        Some(kept[place].pressure)
    }
}

/// Normal out of the shape and overlap of a node at a place.
fn sense(ground: &NodesOnShape, frame: &Frame, c: &Candidate, place: &Vec3) -> (Vec3, f64) {
    let Outside { normal, distance, .. } = ground.shape.outside(&frame.to_body(place));
    (-frame.to_space(&normal), c.radius - distance)
}

/// The tangential spring of a contact with the normal force `pressure` after a relative motion.
fn tangential(c: &Candidate, normal: &Vec3, pressure: f64, moved: Vec3) -> Tangential {
    let ([_, stiff], across) = (stiffness(c), |v: Vec3| v - normal * v.dot(normal));
    let trial = across(c.memory.slip + c.brought_back + moved);
    let slip = slip_to_cone(trial, stiff * trial.norm(), c.law.friction * pressure);
    Tangential { slip, slid: trial - slip, moved: across(moved) }
}

impl RigidBody {
    /// Way that its drive takes it between two times [m].
    fn way(&self, from: f64, to: f64) -> Vec3 {
        Vec3::from_fn(|axis, _| match &self.along[axis] {
            Drive::Velocity(velocity) => integral(|t| velocity(t, &self.frame.origin), from, to),
            _ => 0.0,
        })
    }
}

impl Scene {
    /// Fails if some connected piece of the solids can move as a rigid body against neither supports nor the shapes it lies on.
    ///
    /// # Errors
    /// [`SceneError::FreeBody`] with the body and the motion.
    pub fn check_supports(&self) -> Result<(), SceneError> {
        let springs = springs_at_rest(self);
        let shapes = springs.iter().filter(|spring| spring.partner.is_none());
        let touched: Vec<(u32, Vec3)> = shapes.map(|spring| (spring.node, spring.normal)).collect();
        let links: Vec<[u32; 2]> = springs.iter().filter_map(Spring::pair).collect();
        check_supports(&self.solid, self.supports.held(), &touched, &links)
    }
}

/// Springs of the nodes that touch at the last equilibrium, and of those that just do not.
pub(super) fn springs_at_rest(scene: &Scene) -> Vec<Spring> {
    contact_springs(scene, &scene.solid.displacement, [scene.clock.time; 2], 1.0, Hold::SECANT, Also::Near)
}

/// Springs of the nodes that touch shapes or each other under a displacement field.
///
/// - `times`: load parameters of the last equilibrium and of the field
/// - `ahead`: duration from which the pace of the shapes is taken [s]
/// - `hold`: how what slips and what softens is held
/// - `also`: what does not touch, and has a spring
pub(super) fn contact_springs(
    scene: &Scene,
    field: &[Vec3],
    times: [f64; 2],
    ahead: f64,
    hold: Hold,
    also: Also,
) -> Vec<Spring> {
    let pushed = |push: Push| {
        let stiffness = push.normal * push.normal.transpose() * push.stiffness;
        let force = push.normal * (push.stiffness * push.overlap);
        let [partner, node] = push.nodes;
        let (partner, rate) = (Some(partner), Vec3::zeros());
        Spring { node, partner, ground: 0, normal: push.normal, force, stiffness, rest: None, rate }
    };
    let mut springs: Vec<Spring> = scene.debris.pushes(&scene.solid, field).map(pushed).collect();
    springs.extend(scene.interfaces().springs(field, [times[1], ahead], hold.share, hold.led).map(|spring| {
        let InterfaceSpring { pair: [partner, node], normal, force, stiffness, rest, rate } = spring;
        Spring { node, partner: Some(partner), ground: 0, normal, force, stiffness, rest, rate }
    }));
    if scene.shape_contacts.is_empty() {
        return springs;
    }
    let size = scene.solid.reference.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let gap = if matches!(also, Also::Near) { TOUCHING * size } else { 0.0 };
    for (index, ground) in (0..).zip(&scene.shape_contacts) {
        let (mut frame, way, pace) = motion_of(scene, ground, times, ahead);
        frame.origin += way;
        for c in &ground.candidates {
            let i = c.node as usize;
            let (normal, overlap) = sense(ground, &frame, c, &(scene.solid.reference[i] + field[i]));
            let kept = also.kept(index, c.node);
            if overlap <= -gap && kept.is_none() {
                continue;
            }
            let [stiff, stiff_across] = stiffness(c);
            // What a curved shape has left by the way along it is no loss of pressure.
            // How far a node that has just come went in is not how it will be pressed: it rubs from the next iterate on.
            let is_new = matches!(also, Also::Kept(_)) && kept.is_none();
            let pressure = if is_new { 0.0 } else { kept.unwrap_or(stiff * overlap.max(0.0)) };
            let moved = field[i] - scene.solid.displacement[i] - way;
            let Tangential { slip, slid, .. } = tangential(c, &normal, pressure, moved);
            // What slips has a force that is given, and turns with its way.
            let (held, went) = (slip.norm(), slid.norm());
            let holds = if held > 0.0 {
                stiff_across * held / (held + went)
            } else if went == 0.0 && pressure > 0.0 && c.law.friction > 0.0 {
                stiff_across
            } else {
                0.0
            };
            let along = normal * normal.transpose();
            let mut stiffness = along * stiff + (Mat3::identity() - along) * holds;
            if went > 0.0 && held > 0.0 {
                let way = slip / held;
                stiffness -= way * way.transpose() * ((1.0 - hold.share) * holds);
            }
            let least = if kept.is_some() { f64::NEG_INFINITY } else { 0.0 };
            let force = normal * (stiff * overlap.max(least)) - slip * stiff_across;
            let rate = stiffness * pace;
            springs.push(Spring {
                node: c.node,
                partner: None,
                ground: index,
                normal,
                force,
                stiffness,
                rest: None,
                rate,
            });
        }
    }
    springs
}

/// Where a shape was at the last equilibrium, the way it has gone since, and its pace.
fn motion_of(scene: &Scene, ground: &NodesOnShape, [present, time]: [f64; 2], ahead: f64) -> (Frame, Vec3, Vec3) {
    match ground.rigid_body.and_then(|index| scene.contacts.rigid_bodies().get(index)) {
        Some(rigid_body) => {
            (rigid_body.frame, rigid_body.way(present, time), rigid_body.way(time, time + ahead) / ahead)
        }
        None => (ground.frame, Vec3::zeros(), Vec3::zeros()),
    }
}

/// Starts from the friction of the last equilibrium.
pub(super) fn forget_brought_back(scene: &mut Scene) {
    let candidates = scene.shape_contacts.iter_mut().flat_map(|ground| &mut ground.candidates);
    candidates.for_each(|c| c.brought_back = Vec3::zeros());
}

/// Brings back what sticks but has given way since the last equilibrium; whether that is more than [`STUCK`].
///
/// - `field`: displacements at which forces balance
/// - `times`: load parameters of the last equilibrium and of the field
pub(super) fn bring_back(scene: &mut Scene, field: &[Vec3], times: [f64; 2], mixer: &mut Anderson) -> bool {
    let (mut gave, mut forces) = (0.0, 0.0);
    let (mut stretch, mut image) = (Vec::new(), Vec::new());
    for ground in &scene.shape_contacts {
        let (mut frame, way, _) = motion_of(scene, ground, times, 1.0);
        frame.origin += way;
        for c in ground.candidates.iter().filter(|c| c.law.friction > 0.0) {
            let i = c.node as usize;
            let (normal, overlap) = sense(ground, &frame, c, &(scene.solid.reference[i] + field[i]));
            let [stiff, stiff_across] = stiffness(c);
            let moved = field[i] - scene.solid.displacement[i] - way;
            let found = tangential(c, &normal, stiff * overlap.max(0.0), moved);
            forces += (stiff_across * found.slip).norm_squared();
            // What slips along its own friction has not yet turned round.
            if overlap > 0.0 && (found.slid == Vec3::zeros() || found.moved.dot(&found.slip) < 0.0) {
                gave += (stiff_across * found.moved).norm_squared();
            }
            stretch.extend_from_slice(c.brought_back.as_slice());
            image.extend_from_slice((found.slip - c.memory.slip).as_slice());
        }
    }
    if gave <= STUCK * STUCK * forces {
        return false;
    }
    mixer.next(&mut stretch, &image);
    let candidates = scene.shape_contacts.iter_mut().flat_map(|ground| &mut ground.candidates);
    for (c, stretch) in candidates.filter(|c| c.law.friction > 0.0).zip(stretch.chunks_exact(3)) {
        c.brought_back = Vec3::from_column_slice(stretch);
    }
    true
}

/// Takes over the contacts of a state of equilibrium: memories, forces on the rigid bodies, their places, and the ledger.
///
/// - `before`: displacements at the last equilibrium; those of the scene are the new ones
pub(super) fn accept_contacts(scene: &mut Scene, before: &[Vec3], present: f64, time: f64) {
    if !has_contacts(scene) {
        return;
    }
    let is_wet = scene.optional.liquid.is_some();
    let [friction, taken, external, surplus] = scene.optional.interfaces.accept_at_rest(&scene.solid, time, is_wet);
    scene.books.friction += friction;
    scene.books.interfaces += taken;
    scene.books.external += external;
    if let Some(liquid) = &mut scene.optional.liquid {
        // The liquid that parts them comes at a mean pressure that is too low by as much.
        scene.books.interfaces -= surplus;
        liquid.state.viscous += surplus;
    }
    scene.books.external -= scene.debris.accept_at_rest(&scene.solid, before);
    if !scene.shape_contacts.is_empty() {
        accept_grounds(scene, before, present, time);
    }
    let on_grounds: f64 = scene.shape_contacts.iter().flat_map(|ground| &ground.candidates).map(|c| c.stored).sum();
    scene.ledger[EnergyKind::Contact] = on_grounds + scene.debris.stored();
    sum_watched_contacts(scene);
}

/// Whether anything can touch at equilibrium.
pub(super) fn has_contacts(scene: &Scene) -> bool {
    !(scene.shape_contacts.is_empty() && scene.debris.is_empty() && scene.interfaces().is_empty())
}

fn accept_grounds(scene: &mut Scene, before: &[Vec3], present: f64, time: f64) {
    scene.contacts.rigid_bodies_mut().iter_mut().for_each(RigidBody::clear_forces);
    let (mut friction, mut external) = (0.0, 0.0);
    for index in 0..scene.shape_contacts.len() {
        let (old, way, _) = motion_of(scene, &scene.shape_contacts[index], [present, time], 1.0);
        let new = Frame { origin: old.origin + way, ..old };
        let Scene { shape_contacts, contacts, solid, debris, .. } = scene;
        let mut candidates = std::mem::take(&mut shape_contacts[index].candidates);
        let ground = &shape_contacts[index];
        for c in &mut candidates {
            let i = c.node as usize;
            let place = solid.position(i);
            let (_, was) = sense(ground, &old, c, &(solid.reference[i] + before[i]));
            let (normal, overlap) = sense(ground, &new, c, &place);
            let [stiff, stiff_across] = stiffness(c);
            let pressure = stiff * overlap.max(0.0);
            let full = debris.radius_if_particle(c.node);
            if c.radius == 0.0 && full > 0.0 && -overlap > full {
                c.radius = full;
            }
            let Tangential { slip, moved, .. } =
                tangential(c, &normal, pressure, solid.displacement[i] - before[i] - way);
            friction += 0.5 * stiff_across * (c.memory.slip + slip).dot(&moved);
            let half = 0.5 * stiff;
            // The way to a contact is without force, and so is that from it.
            let idle = half
                * ((overlap.max(0.0) + was.max(0.0)) * (overlap - was)
                    - (overlap.max(0.0).powi(2) - was.max(0.0).powi(2)));
            let force = normal * pressure - slip * stiff_across;
            let work = 0.5 * (c.force + force).dot(&way) - idle;
            external += work;
            (c.memory.slip, c.brought_back) = (slip, Vec3::zeros());
            (c.force, c.couple, c.arm) = (force, Vec3::zeros(), normal * (overlap - c.radius));
            c.stored = half * overlap.max(0.0).powi(2);
            (c.friction, c.damping) = (0.0, 0.0);
            (c.is_held, c.is_pushed) = (false, false);
            if let Some(rigid_body) =
                ground.rigid_body.and_then(|rigid_body| contacts.rigid_bodies_mut().get_mut(rigid_body))
            {
                rigid_body.push(&-force, &Vec3::zeros(), &(place + c.arm), 0.0);
                rigid_body.add_work(work);
            }
        }
        shape_contacts[index].candidates = candidates;
    }
    for rigid_body in scene.contacts.rigid_bodies_mut() {
        rigid_body.frame.origin += rigid_body.way(present, time);
        rigid_body.frame.velocity = Vec3::zeros();
    }
    scene.books.friction += friction;
    scene.books.external += external;
}
