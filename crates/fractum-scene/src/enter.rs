//! Particles that come into a run as time goes on, each at a free place of its inlet.
//!
//! They are there from the start, out of the run as those that have left are, and come in by their numbers. One whose inlet
//! has no free place waits, and so do those after it, so that the sizes that come in are those of the body.

use fractum_contact::Surface;
use fractum_dem::Particles;
use fractum_math::Vec3;

use crate::clock::ThisStep;
use crate::coupling::Debris;
use crate::inlet::{Arrivals, Entered, Inlet, InletState};
use crate::scene::{Optional, Scene};
use crate::watch::{Notice, Site};

/// Steps between two looks for a free place while particles wait.
const STEPS_BETWEEN_LOOKS: u64 = 10;
/// Places that are tried for a particle at a look before it waits.
const TRIES: u64 = 200;
/// Particles that may wait: the rate is kept within one.
const MAY_WAIT: usize = 1;

/// The same scene, into which the particles of some bodies come through inlets; before it gets its contacts.
pub fn with_inlets(mut scene: Scene, inlets: Vec<Inlet>) -> Scene {
    inlets.iter().flat_map(Inlet::outside).for_each(|i| scene.bonded.particles.take_out(i));
    scene.optional.inlets = inlets;
    scene
}

/// Where particles come into a scene as time goes on.
pub fn inlets_of(scene: &Scene) -> &[Inlet] {
    &scene.optional.inlets
}

/// What has come into a scene.
pub fn entered_of(scene: &Scene) -> &Entered {
    &scene.optional.entered
}

/// Puts saved inlets back; positions and velocities of their particles are those of the bonded bodies.
pub(crate) fn restore_inlets(scene: &mut Scene, states: Vec<InletState>, entered: Entered) {
    let Scene { optional, bonded, .. } = scene;
    optional.entered = entered;
    for (inlet, state) in optional.inlets.iter_mut().zip(states) {
        for (i, place) in (inlet.range.start..).zip(&state.places) {
            let at = bonded.particles.position[i];
            bonded.particles.put_in(i, at);
            bonded.reference[i] = *place;
        }
        inlet.state = state;
    }
}

/// Lets particles come in that are due, between the forces of tⁿ and the kick.
pub(crate) fn let_particles_enter(scene: &mut Scene, step: &ThisStep) {
    if scene.optional.inlets.is_empty() || step.is_first {
        return;
    }
    let mut waiting = 0;
    let mut inlets = std::mem::take(&mut scene.optional.inlets);
    for inlet in &mut inlets {
        let missing = inlet.due_until(step.time) - inlet.state.places.len();
        let looks = !inlet.state.is_full || scene.clock.step.is_multiple_of(STEPS_BETWEEN_LOOKS);
        let found = if missing > 0 && looks { enter(scene, inlet, missing, step.dt_before) } else { 0 };
        let still = missing - found;
        inlet.state.is_full = still > 0;
        if still > MAY_WAIT {
            scene.note(Notice::InletBlocked, Site::Particle(inlet.outside().start as u32), still as f64);
        }
        waiting += still;
    }
    let Scene { optional: Optional { inlets: all, entered, .. }, .. } = scene;
    *all = inlets;
    (entered.waiting, entered.most_waiting) = (waiting, entered.most_waiting.max(waiting));
}

/// Lets at most so many particles in; returns how many had a place.
fn enter(scene: &mut Scene, inlet: &mut Inlet, most: usize, dt: f64) -> usize {
    let Inlet { arrivals: Arrivals { bounds, place, .. }, largest, state, .. } = inlet;
    let clearance = scene.contacts.clearance();
    let mut obstacles = Obstacles::around(scene, bounds, *largest + clearance);
    let first = inlet.range.start + state.places.len();
    let (mut places, mut is_close) = (Vec::new(), false);
    for i in first..first + most {
        let radius = scene.bonded.particles.radius[i].abs();
        let found = (0..TRIES).find_map(|_| {
            state.tried += 1;
            Some(place(radius, state.tried)).filter(|x| obstacles.leave_free(x, radius))
        });
        let Some(found) = found else { break };
        is_close |= !obstacles.leave_free(&found, radius + clearance);
        obstacles.balls.push((found, radius));
        places.push(found);
    }
    let Scene { bonded, contacts, optional: Optional { entered, .. }, books, .. } = scene;
    for (i, place) in (first..).zip(&places) {
        let all = &mut bonded.particles;
        all.put_in(i, *place);
        bonded.reference[i] = *place;
        contacts.admit_particle(i as u32, place, all.radius[i]);
        // The velocities that are asked for are those of tⁿ, and the scene has those of the half step before.
        let [velocity, spin] = (inlet.motion)(place, all.radius[i]);
        let Particles { force, moment, mass, inertia, .. } = &*all;
        let (force, moment, mass, inertia) = (force[i], moment[i], mass[i], inertia[i]);
        let (v, w) = (velocity - force * (0.5 * dt / mass), spin - moment * (0.5 * dt / inertia));
        (all.velocity[i], all.spin[i]) = (v, w);
        bonded.let_past_be_present(i);
        // As energy of motion leaves, so does it come: ½ m v·(v + Δt a).
        books.entered += 0.5 * (mass * v.norm_squared() + inertia * w.norm_squared());
        books.entered += 0.5 * dt * (force.dot(&v) + moment.dot(&w));
        entered.particles += 1;
        entered.mass += mass;
        entered.momentum += velocity * mass;
    }
    if is_close {
        contacts.look_again(&bonded.particles.radius);
    }
    let count = places.len();
    inlet.state.places.append(&mut places);
    count
}

/// What is near an inlet.
struct Obstacles<'a> {
    /// Centres and radii of particles and discrete elements [m].
    balls: Vec<(Vec3, f64)>,
    /// Rigid bodies and solids, with their facets near the inlet.
    grounds: Vec<(Surface<'a>, Vec<u32>)>,
    /// Gap below which laws of contact act [m].
    reach: f64,
}

impl<'a> Obstacles<'a> {
    /// - `largest`: radius of what shall come in, with the clearance that it is asked about [m]
    fn around(scene: &'a Scene, [low, high]: &[Vec3; 2], largest: f64) -> Obstacles<'a> {
        let Scene { bonded, debris, solid, contacts, .. } = scene;
        let reach = contacts.reach();
        let near = |centre: &Vec3, radius: f64| {
            let beyond = centre - centre.zip_zip_map(low, high, |c, a, b| c.clamp(a, b));
            beyond.norm() < radius + largest + reach
        };
        let Particles { position, radius, .. } = &bonded.particles;
        let particles = position.iter().copied().zip(radius.iter().copied()).filter(|(_, radius)| *radius >= 0.0);
        let born = discrete_elements(debris, |node| solid.position(node));
        let balls = particles.chain(born).filter(|(centre, radius)| near(centre, *radius)).collect();
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low).norm());
        let with_facets = |ground: Surface<'a>| {
            let facets = ground.facets_within(&middle, half + largest + reach);
            (ground, facets)
        };
        Obstacles { balls, grounds: contacts.grounds().map(with_facets).collect(), reach }
    }

    /// Whether a ball at a place touches nothing.
    fn leave_free(&self, place: &Vec3, radius: f64) -> bool {
        let radius = radius + self.reach;
        let is_clear = |(centre, own): &(Vec3, f64)| (place - centre).norm_squared() > (radius + own).powi(2);
        self.balls.iter().all(is_clear)
            && self.grounds.iter().all(|(ground, facets)| !ground.is_within(facets, place, radius))
    }
}

/// Centres and radii of discrete elements of solids [m].
fn discrete_elements(debris: &Debris, at: impl Fn(usize) -> Vec3) -> impl Iterator<Item = (Vec3, f64)> {
    debris.state().nodes.iter().map(move |&node| (at(node as usize), debris.radius(node)))
}
