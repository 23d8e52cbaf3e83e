//! Discrete elements of solids among particles that have nodes of their own.

use std::ops::Range;

use fractum_contact::law::{ContactLaw, ContactMemory, Linear};
use fractum_contact::{SphereContacts, Spheres};
use fractum_dem::Particles;
use fractum_fem::Solid;
use fractum_math::{Vec3, Work};

use super::{ContactBody, ContactMaterial};
use crate::coupling::Debris;

/// How much faster a turning sphere answers to the tangential spring: 1 + m r²/I.
const TURNING: f64 = 3.5;

/// Contacts of discrete elements with loose and bonded particles, by the linear law of discrete elements among each other.
///
/// One population: the particles, then the discrete elements in the order of their birth.
#[derive(Clone, Debug)]
pub(crate) struct DebrisAmong {
    contacts: SphereContacts<Linear>,
    position: Vec<Vec3>,
    velocity: Vec<Vec3>,
    spin: Vec<Vec3>,
    radius: Vec<f64>,
    force: Vec<Vec3>,
    moment: Vec<Vec3>,
    /// Sums of stiffness over mass.
    rows: Vec<f64>,
}

/// What the particles are made of.
#[derive(Clone, Copy)]
pub(super) struct Made<'a> {
    pub(super) body: &'a [u16],
    pub(super) materials: &'a [ContactMaterial],
}

impl DebrisAmong {
    pub(super) fn new(skin: f64) -> Self {
        DebrisAmong {
            contacts: SphereContacts::new(skin),
            position: Vec::new(),
            velocity: Vec::new(),
            spin: Vec::new(),
            radius: Vec::new(),
            force: Vec::new(),
            moment: Vec::new(),
            rows: Vec::new(),
        }
    }

    fn locate(&mut self, solid: &Solid, debris: &Debris, particles: &Particles) {
        let born = &debris.state().nodes;
        let fill = |all: &mut Vec<Vec3>, own: &[Vec3], of: &dyn Fn(u32) -> Vec3| {
            all.clear();
            all.extend_from_slice(own);
            all.extend(born.iter().map(|&n| of(n)));
        };
        fill(&mut self.position, &particles.position, &|n| solid.position(n as usize));
        fill(&mut self.velocity, &particles.velocity, &|n| solid.velocity[n as usize]);
        fill(&mut self.spin, &particles.spin, &|n| debris.spin(solid, n));
        self.radius.clear();
        self.radius.extend_from_slice(&particles.radius);
        self.radius.extend(born.iter().map(|&n| debris.radius(n)));
    }

    /// Whether a search is due by the way of some of the particles, and of all discrete elements.
    pub(super) fn is_used_up(
        &mut self,
        solid: &Solid,
        debris: &Debris,
        particles: &Particles,
        range: Range<usize>,
    ) -> bool {
        self.locate(solid, debris, particles);
        let DebrisAmong { contacts, position, velocity, spin, radius, .. } = self;
        let spheres = Spheres { position, velocity, spin, radius };
        contacts.is_used_up(&spheres, range) || contacts.is_used_up(&spheres, particles.len()..spheres.position.len())
    }

    /// Particles that may touch discrete elements before the next search.
    pub(super) fn near(&self) -> impl Iterator<Item = u32> {
        self.contacts.pairs().iter().map(|[particle, _]| *particle)
    }

    fn search(&mut self, solid: &Solid, debris: &Debris, particles: &Particles, made: Made) {
        let DebrisAmong { contacts, position, velocity, spin, radius, .. } = &*self;
        if contacts.is_used_up(&Spheres { position, velocity, spin, radius }, 0..position.len()) {
            self.renew(solid, debris, particles, made);
        }
    }

    /// Renews the list of near pairs, once everything has been located.
    pub(super) fn renew(&mut self, solid: &Solid, debris: &Debris, particles: &Particles, made: Made) {
        let DebrisAmong { contacts, position, velocity, spin, radius, .. } = self;
        let count = particles.len();
        let law = |i: u32, j: u32| {
            let (particle, born) = (i as usize, (j as usize).checked_sub(count)?);
            let body = *made.body.get(particle)? as usize;
            let material = &made.materials[body];
            let node = debris.state().nodes[born];
            let radii = [radius[particle], radius[j as usize]];
            let masses = [particles.mass[particle], solid.mass[node as usize]];
            let (e, nu) = debris.mean_elasticity(node, &material.elastic);
            let surface = debris.surface_with(node, ContactBody::Particles(body), material.surface);
            Some(match particles.thickness {
                Some(thickness) => Linear::between_discs(e, nu, radii, thickness, masses, surface),
                None => Linear::between_spheres(e, nu, radii, masses, surface),
            })
        };
        contacts.renew(&Spheres { position, velocity, spin, radius }, law);
    }

    /// Takes new discrete elements as they stand.
    ///
    /// - `before`: how many there were
    pub(super) fn admit(&mut self, before: usize, solid: &Solid, debris: &Debris, particles: &Particles, made: Made) {
        self.locate(solid, debris, particles);
        self.search(solid, debris, particles, made);
        let DebrisAmong { contacts, position, velocity, spin, radius, .. } = self;
        let first = particles.len() + before;
        contacts.accept_initial_overlap(&Spheres { position, velocity, spin, radius }, |_, j| j as usize >= first);
    }

    /// Adds the forces of the moment to nodes and particles.
    ///
    /// - `searches`: whether to search where that is due; `dt` [s]: the step that led here
    pub(super) fn add_forces(
        &mut self,
        solid: &mut Solid,
        debris: &mut Debris,
        particles: &mut Particles,
        made: Made,
        searches: bool,
        dt: f64,
    ) -> Work {
        self.locate(solid, debris, particles);
        if searches {
            self.search(solid, debris, particles, made);
        }
        let DebrisAmong { contacts, position, velocity, spin, radius, force, moment, .. } = self;
        for sum in [&mut *force, &mut *moment] {
            sum.clear();
            sum.resize(position.len(), Vec3::zeros());
        }
        let work = contacts.add_forces(&Spheres { position, velocity, spin, radius }, force, moment, dt);
        let count = particles.len();
        for (own, sum) in particles.force.iter_mut().zip(&*force) {
            *own += sum;
        }
        for (own, sum) in particles.moment.iter_mut().zip(&*moment) {
            *own += sum;
        }
        for born in 0..debris.len() {
            let node = debris.state().nodes[born];
            solid.force[node as usize] += force[count + born];
            debris.add_torque(node, moment[count + born]);
        }
        work
    }

    /// Largest squared frequency that the contacts of the last step add, by Gershgorin's rows [1/s²].
    pub(super) fn frequency_square(&mut self, solid: &Solid, debris: &Debris, particles: &Particles) -> f64 {
        let DebrisAmong { contacts, radius, rows, .. } = self;
        rows.clear();
        rows.resize(radius.len(), 0.0);
        let count = particles.len();
        let mass = |k: u32| match (k as usize).checked_sub(count) {
            None => particles.mass[k as usize],
            Some(born) => solid.mass[debris.state().nodes[born] as usize],
        };
        for (pair, law) in contacts.laws_touching() {
            let (normal, tangential) = law.stiffness(0.0);
            let [i, j] = pair;
            let rolling = law.rolling.frequency_factor(radius[i as usize].min(radius[j as usize]));
            let stiffness = normal.max(TURNING * tangential + rolling * normal);
            let coupling = stiffness / (mass(i) * mass(j)).sqrt();
            rows[i as usize] += stiffness / mass(i) + coupling;
            rows[j as usize] += stiffness / mass(j) + coupling;
        }
        rows.iter().copied().fold(0.0, f64::max)
    }

    /// Has the forces of the pairs kept from step to step.
    pub(super) fn keep_loads(&mut self) {
        self.contacts.keep_loads();
    }

    /// Pairs of a particle and a discrete element, with the force on the second [N].
    pub(super) fn loads(&self) -> impl Iterator<Item = ([u32; 2], Vec3)> {
        self.contacts.loads()
    }

    /// Has the next search renew the list of pairs.
    pub(super) fn admit_particle(&mut self, particle: u32, place: &Vec3) {
        self.contacts.admit(particle, place);
    }

    pub(super) fn look_again(&mut self) {
        self.contacts.look_again();
    }

    /// Pairs that touched at the last step, as one population.
    pub(super) fn pairs_touching(&self) -> impl Iterator<Item = [u32; 2]> {
        self.contacts.touching()
    }

    /// Numbers the discrete elements anew, since some have left, which touched nothing.
    ///
    /// - `particles`: number of particles; `before`, `now`: nodes of the discrete elements, `now` in the same order
    pub(super) fn let_leave(&mut self, particles: usize, before: &[u32], now: &[u32]) {
        let mut staying = now.iter().peekable();
        let mut number: Vec<u32> = (0..particles as u32).collect();
        let mut next = particles as u32;
        for node in before {
            number.push(next);
            next += u32::from(staying.next_if_eq(&node).is_some());
        }
        let mut state = self.contacts.state();
        state.iter_mut().for_each(|(pair, _)| *pair = pair.map(|i| number[i as usize]));
        self.contacts.restore(state);
    }

    /// Number of contacts at the last step.
    pub(super) fn touching(&self) -> usize {
        self.pairs_touching().count()
    }

    pub(super) fn state(&self) -> Vec<([u32; 2], ContactMemory)> {
        self.contacts.state()
    }

    pub(super) fn restore(&mut self, state: Vec<([u32; 2], ContactMemory)>) {
        self.contacts.restore(state);
    }
}
