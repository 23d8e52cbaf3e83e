//! Force of contact between two named bodies, summed up for the probes that ask for it.

use fractum_contact::law::{ContactLaw, Hertz, HertzMemory};
use fractum_contact::{Spheres, Touch};
use fractum_dem::Particles;
use fractum_fem::Solid;
use fractum_math::Vec3;

use super::debris_among::DebrisAmong;
use super::nodes_on_shape::NodesOnShape;
use super::{ContactBody, Contacts};
use crate::conditions::Along;
use crate::coupling::Debris;

/// Which force of contact is wanted: on one body, from another, along a direction at each place of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactProbe {
    /// The body that feels the force.
    pub on: ContactBody,
    /// The body that it comes from.
    pub from: ContactBody,
    /// Which component.
    pub along: Along,
}

/// A contact of a particle with another one, a rigid body or a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleContact {
    /// The particle.
    pub particle: u32,
    /// The other particle; none on a rigid body or solid.
    pub other: Option<u32>,
    /// Their bodies.
    pub bodies: [ContactBody; 2],
    /// Place of the contact [m]; between two particles the middle of their centres.
    pub place: Vec3,
    /// Unit vector from the particle into what it touches.
    pub normal: Vec3,
    /// Force on the particle [N].
    pub force: Vec3,
    /// Overlap [m]; negative across a gap.
    pub overlap: f64,
}

impl ParticleContact {
    /// Force along the normal [N]: positive where it presses, negative where it pulls.
    pub fn normal_force(&self) -> f64 {
        -self.force.dot(&self.normal)
    }
}

/// Everything that touches.
pub(crate) struct Touching<'a> {
    pub(crate) solid: &'a Solid,
    pub(crate) debris: &'a Debris,
    pub(crate) particles: &'a Particles,
    pub(crate) shapes: &'a [NodesOnShape],
}

impl Contacts {
    /// Has the force between two bodies summed up at every instant that is measured.
    pub fn watch(&mut self, probe: ContactProbe) {
        if self.watched.iter().all(|(known, _)| *known != probe) {
            self.watched.push((probe, 0.0));
        }
        self.among.iter_mut().for_each(|among| among.keep_loads());
        self.nodes.debris.iter_mut().for_each(DebrisAmong::keep_loads);
    }

    /// Visits every contact of the last step of particles with each other, with rigid bodies and with solids. Several contacts of one particle with one
    /// surface may share their force: on a concave edge some of it is taken off again.
    pub fn of_particles(&self, particles: &Particles, mut visit: impl FnMut(ParticleContact)) {
        let body = |i: u32| ContactBody::Particles(self.body[i as usize] as usize);
        let Particles { position, velocity, spin, radius, .. } = particles;
        let spheres = Spheres { position, velocity, spin, radius };
        for ([i, j], memory, apart) in self.among.iter().flat_map(|among| among.memories_touching(&spheres)) {
            let Some(law) = self.law_among(&particles.radius, &particles.mass, i, j) else { continue };
            let place = position[i as usize] + apart * 0.5;
            let distance = apart.norm();
            let normal = if distance > 0.0 { apart / distance } else { Vec3::x() };
            let overlap = particles.radius[i as usize] + particles.radius[j as usize] - distance;
            let force = -law.last_force(memory, &normal, overlap - Hertz::overlap_offset(memory));
            visit(ParticleContact {
                particle: i,
                other: Some(j),
                bodies: [body(i), body(j)],
                place,
                normal,
                force,
                overlap,
            });
        }
        self.on_grounds(particles, visit);
    }

    /// Visits every contact of the last step of particles with rigid bodies and with solids.
    fn on_grounds(&self, particles: &Particles, mut visit: impl FnMut(ParticleContact)) {
        let mut touched = |touch: &Touch<HertzMemory>, place: Vec3, second: ContactBody| {
            let Touch { sphere: particle, normal, force, overlap, .. } = *touch;
            let bodies = [ContactBody::Particles(self.body[particle as usize] as usize), second];
            visit(ParticleContact { particle, other: None, bodies, place, normal, force, overlap });
        };
        for (index, (contacts, _)) in self.on_tools.iter().enumerate() {
            for touch in contacts.touches() {
                touched(
                    touch,
                    self.flat.place(particles, touch.sphere as usize, &self.rigid_bodies[index]) + touch.offset,
                    ContactBody::Rigid(index),
                );
            }
        }
        for ground in &self.solids {
            for touch in ground.contacts().touches() {
                let place = particles.position[touch.sphere as usize] + touch.offset;
                touched(touch, place, ContactBody::Solid(ground.body()));
            }
        }
    }

    /// The force at the last instant that was measured [N]; none of bodies that are not watched.
    pub fn force_between(&self, probe: &ContactProbe) -> Option<f64> {
        self.watched.iter().find(|(known, _)| known == probe).map(|(_, force)| *force)
    }

    /// Sums up the forces of the contacts as they were just found; costs nothing without probes.
    pub(crate) fn sum_watched(&mut self, touching: &Touching) {
        if self.watched.is_empty() {
            return;
        }
        let mut watched = std::mem::take(&mut self.watched);
        watched.iter_mut().for_each(|(_, force)| *force = 0.0);
        self.each_contact(touching, |place, [first, second], on_first| {
            for (ContactProbe { on, from, along }, sum) in &mut watched {
                if (*on, *from) == (first, second) {
                    *sum += along.at(&place).dot(&on_first);
                } else if (*on, *from) == (second, first) {
                    *sum -= along.at(&place).dot(&on_first);
                }
            }
        });
        self.watched = watched;
    }

    /// Visits every contact between two bodies: its place, the bodies, and the force on the first [N].
    fn each_contact(&self, touching: &Touching, mut visit: impl FnMut(Vec3, [ContactBody; 2], Vec3)) {
        let Touching { solid, debris, particles, shapes } = touching;
        let place = |i: u32| particles.position[i as usize];
        let particle = |i: u32| ContactBody::Particles(self.body[i as usize] as usize);
        let node = |n: u32| ContactBody::Solid(debris.body(n));
        for ([i, j], force) in self.among.iter().flat_map(|among| among.loads()) {
            visit((place(i) + place(j)) * 0.5, [particle(i), particle(j)], -force);
        }
        self.on_grounds(particles, |contact| visit(contact.place, contact.bodies, contact.force));
        for (index, nodes) in self.nodes.on_tools.iter().enumerate() {
            for (touch, at, own) in nodes.iter().flat_map(|nodes| nodes.touches()) {
                visit(at, [node(own), ContactBody::Rigid(index)], touch.force);
            }
        }
        for ground in &self.solids {
            let own = ContactBody::Solid(ground.body());
            for (touch, at, other) in ground.visitors().into_iter().flat_map(|nodes| nodes.touches()) {
                visit(at, [node(other), own], touch.force);
            }
        }
        for touch in self.nodes.edges.iter().flat_map(|edges| edges.touches()) {
            visit(touch.place, touch.bodies.map(ContactBody::Solid), -touch.force);
        }
        let count = particles.len();
        for ([i, j], force) in self.nodes.debris.iter().flat_map(DebrisAmong::loads) {
            // Only pairs of a particle and a discrete element touch here.
            let own = debris.state().nodes[j as usize - count];
            visit((place(i) + solid.position(own as usize)) * 0.5, [particle(i), node(own)], -force);
        }
        for shape in *shapes {
            let Some(index) = shape.rigid_body() else { continue };
            for c in &shape.candidates {
                visit(solid.position(c.node as usize) + c.arm, [node(c.node), ContactBody::Rigid(index)], c.force);
            }
        }
        for (nodes, force) in debris.loads() {
            let at = nodes.map(|n| solid.position(n as usize));
            visit((at[0] + at[1]) * 0.5, nodes.map(node), -force);
        }
    }
}
