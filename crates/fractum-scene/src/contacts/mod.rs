//! Contacts of particles that have nodes of their own - loose and bonded ones - with each other, with rigid bodies and
//! with the facets of solids; and of the nodes of solids with all of these.

mod between;
mod debris_among;
mod distributed;
mod edge_contacts;
mod flat_faces;
mod held_nodes;
mod leave;
mod node_contacts;
mod nodes_on_shape;
mod nodes_on_surface;
mod pairs;
mod rigid_body;
mod servo;
mod solid_surface;

use fractum_contact::law::{ContactParameters, ElasticMaterial, Hertz, HertzMemory, MaterialPair};
use fractum_contact::{PeriodicCell, SphereContacts, Spheres, Surface, SurfaceContacts, Touch};
use fractum_dem::{NO_CLUMP, ParticleSubdomain, Particles};
use fractum_fem::Solid;
use fractum_math::{HalfSteps, Mat3, Vec3, Work};
use serde::{Deserialize, Serialize};

pub(crate) use between::Touching;
pub use between::{ContactProbe, ParticleContact};
pub use flat_faces::FlatFaces;
use flat_faces::{FlatBodies, Poses};
pub(crate) use held_nodes::{HoldStep, hold_nodes};
pub use node_contacts::pieces;
pub(crate) use nodes_on_shape::Candidate;
pub use nodes_on_shape::NodesOnShape;
pub use rigid_body::{Drive, Form, Inertia, RigidBody};
pub use servo::{Servo, ServoArea};
pub use solid_surface::SolidSurface;

use crate::bonded::Bonded;
use crate::clock::Clock;
use crate::contact_pairs::{ContactBody, ContactPairs};
use crate::coupling::Debris;
use crate::time_function::TimeFunction;
use crate::watch::Site;
use node_contacts::{NodeContacts, NodeContactsState};
use rigid_body::RigidBodyState;
use solid_surface::SolidSurfaceState;

/// Skin of the searches over the smallest radius.
const SKIN: f64 = 0.2;
/// Part of Rayleigh's time, in which a surface wave crosses a sphere, that is a stable step of bonded particles.
const RAYLEIGH_SHARE: f64 = 0.25;
/// The same of loose ones, whose impacts last 1.5 to 6 such times (Hertz; at a tenth to a ten-thousandth of the speed of waves) and want some fifty
/// steps for the energy balance: its error falls with the square of the step.
const LOOSE_SHARE: f64 = 0.0625;

/// How the particles of a body touch others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMaterial {
    /// Elastic constants.
    pub elastic: ElasticMaterial,
    /// Density of a particle [kg/m³].
    pub density: f64,
    /// Friction and damping.
    pub surface: ContactParameters,
    /// Work of adhesion between two such bodies [J/m²].
    pub work_of_adhesion: f64,
}

/// Contacts of all particles with nodes of their own, by Hertz' law, and the rigid bodies among them.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Material of each body of particles.
    materials: Vec<ContactMaterial>,
    /// Whether the particles of each body are bonded; those do not touch each other.
    bonded: Vec<bool>,
    /// Body of each particle.
    body: Vec<u16>,
    /// Clump of each particle, where there are clumps.
    clump: Vec<u32>,
    /// Pairs of materials, body by body.
    pairs: Vec<MaterialPair>,
    among: Option<SphereContacts<Hertz>>,
    rigid_bodies: Vec<RigidBody>,
    /// Contacts with each rigid body, and its material with that of each body.
    on_tools: Vec<(SurfaceContacts<Hertz>, Vec<MaterialPair>)>,
    solids: Vec<SolidSurface>,
    nodes: NodeContacts,
    /// Accelerations of everything, by axis.
    gravity: Vec<(usize, TimeFunctionOf)>,
    rayleigh_frequency: f64,
    /// Faces of bonded bodies that rigid bodies feel as flat.
    flat: FlatBodies,
    /// Largest radius of a particle [m].
    largest_radius: f64,
    /// Skin of the searches [m].
    skin: f64,
    /// Forces between bodies that probes ask for [N].
    watched: Vec<(ContactProbe, f64)>,
}

/// Work of adhesion of two materials by those of each with itself [J/m²] (Berthelot).
fn adhesion(first: f64, second: f64) -> f64 {
    (first * second).sqrt()
}

/// A function of time that can be shown.
#[derive(Clone)]
struct TimeFunctionOf(TimeFunction);

impl std::fmt::Debug for TimeFunctionOf {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("f(t)")
    }
}

/// What changes in the contacts during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ContactsState {
    among: Vec<([u32; 2], HertzMemory)>,
    rigid_bodies: Vec<(RigidBodyState, Vec<Touch<HertzMemory>>)>,
    solids: Vec<SolidSurfaceState>,
    nodes: NodeContactsState,
}

/// Two things that overlap before anything has moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// A particle of the scene.
    pub particle: u32,
    /// What it is in.
    pub other: OverlapWith,
    /// How deep [m].
    pub depth: f64,
}

/// What a particle overlaps with.
#[derive(Clone, Debug, PartialEq)]
pub enum OverlapWith {
    /// Another particle of the scene.
    Particle(u32),
    /// A rigid body, by name.
    RigidBody(String),
    /// A solid body, by name.
    Solid(String),
}

impl Contacts {
    /// Contacts of the particles of `bonded`.
    ///
    /// - `materials`: of each of its bodies; `solids`: surfaces that particles may touch
    /// - `gravity`: accelerations [m/s²] of everything, with their axes
    pub fn new(
        bonded: &Bonded,
        materials: Vec<ContactMaterial>,
        rigid_bodies: Vec<RigidBody>,
        solids: Vec<SolidSurface>,
        gravity: Vec<(usize, TimeFunction)>,
    ) -> Self {
        let mut body = vec![0u16; bonded.particles.len()];
        for (index, part) in (0..).zip(bonded.bodies()) {
            body[part.range.clone()].fill(index);
        }
        let thickness = bonded.particles.thickness;
        let pair = |a: &ContactMaterial, b: &ContactMaterial| {
            let pair = MaterialPair::new([a.elastic, b.elastic], a.surface.against(b.surface)).of_thickness(thickness);
            pair.sticking(adhesion(a.work_of_adhesion, b.work_of_adhesion))
        };
        // Particles that are to come in have negative radii.
        let radii = || bonded.particles.radius.iter().map(|radius| radius.abs());
        let smallest = radii().fold(f64::INFINITY, f64::min);
        let skin = SKIN * smallest;
        let on_tool = |rigid_body: &RigidBody| {
            let with = |m: &ContactMaterial| {
                let pair = MaterialPair::new([m.elastic, rigid_body.elastic], m.surface.against(rigid_body.surface));
                pair.of_thickness(thickness).sticking(adhesion(m.work_of_adhesion, rigid_body.work_of_adhesion))
            };
            (SurfaceContacts::new(skin), materials.iter().map(with).collect())
        };
        let is_bonded: Vec<bool> = bonded.bodies().iter().map(|body| !body.bonds.is_empty()).collect();
        let rayleigh = |i: usize| {
            let share = if is_bonded[body[i] as usize] { RAYLEIGH_SHARE } else { LOOSE_SHARE };
            let ContactMaterial { elastic, density, .. } = materials[body[i] as usize];
            let nu = elastic.poisson_ratio;
            let shear = elastic.young_modulus / (2.0 * (1.0 + nu));
            let time = std::f64::consts::PI * bonded.particles.radius[i].abs() * (density / shear).sqrt();
            2.0 / (share * time / (0.1631 * nu + 0.8766))
        };
        let clumps = bonded.clumps();
        let clump = clumps.of_particles(body.len());
        let alone = |i: usize| rayleigh(i).powi(2);
        let of_clump = |own: usize| {
            let density = materials[body[clumps.particles_of(own).start] as usize].density;
            clumps.frequency_square(own, &bonded.particles, alone, density).sqrt()
        };
        let frequencies = (0..body.len()).filter(|&i| clump.get(i).is_none_or(|own| *own == NO_CLUMP)).map(rayleigh);
        let highest = frequencies.chain((0..clumps.len()).map(of_clump)).fold(0.0, f64::max);
        let meets =
            is_bonded.iter().any(|b| !b) || !rigid_bodies.is_empty() || !solids.is_empty() || is_bonded.len() > 1;
        let rayleigh_frequency = if meets { highest } else { 0.0 };
        let alone = is_bonded.len() == 1 && is_bonded[0];
        let contacts = Contacts {
            pairs: materials.iter().flat_map(|a| materials.iter().map(move |b| pair(a, b))).collect(),
            on_tools: rigid_bodies.iter().map(on_tool).collect(),
            among: (!alone && !body.is_empty()).then(|| SphereContacts::new(skin)),
            solids: solids.into_iter().map(|solid| solid.prepared(skin, &materials, thickness)).collect(),
            nodes: NodeContacts::none(rigid_bodies.len()),
            gravity: gravity.into_iter().map(|(axis, value)| (axis, TimeFunctionOf(value))).collect(),
            bonded: is_bonded,
            materials,
            body,
            clump,
            rigid_bodies,
            rayleigh_frequency,
            flat: FlatBodies::default(),
            largest_radius: radii().fold(0.0, f64::max),
            skin,
            watched: Vec::new(),
        };
        contacts.reaching()
    }

    /// The same with searches across the gaps in which its pairs stick.
    fn reaching(mut self) -> Self {
        let of_particles = self.reach_of(&self.pairs);
        self.among = self.among.map(|among| among.with_reach(of_particles));
        let on_tools = std::mem::take(&mut self.on_tools);
        let on_tool = |(contacts, pairs): (SurfaceContacts<Hertz>, Vec<MaterialPair>)| {
            (contacts.with_reach(self.reach_of(&pairs)), pairs)
        };
        self.on_tools = on_tools.into_iter().map(on_tool).collect();
        self
    }

    /// Gap across which these pairs of materials stick at most [m].
    fn reach_of(&self, pairs: &[MaterialPair]) -> f64 {
        // The reach grows with the cube root of the radius; a hollow may be felt as a larger one.
        let largest = 8.0 * self.largest_radius;
        pairs.iter().map(|pair| Hertz::new(pair, largest, 1.0).reach).fold(0.0, f64::max)
    }

    /// Gap across which anything sticks at most [m].
    pub(crate) fn reach(&self) -> f64 {
        let on_tools = self.on_tools.iter().map(|(_, pairs)| self.reach_of(pairs));
        on_tools.fold(self.reach_of(&self.pairs), f64::max)
    }

    /// Distance from everything at which a particle that comes in asks for no search before the next one: what moves uses up two skins
    /// at most until then [m].
    pub(crate) fn clearance(&self) -> f64 {
        2.0 * self.skin
    }

    /// The same in a box that repeats, before the first step.
    pub fn within(mut self, cell: PeriodicCell) -> Self {
        self.among = self.among.map(|among| among.within(cell));
        self
    }

    pub(crate) fn set_cell(&mut self, cell: &PeriodicCell) {
        self.among.iter_mut().for_each(|among| among.set_cell(cell));
    }

    /// Least distance of opposite sides of a box that repeats at which its particles touch once only [m].
    pub fn narrowest_box(&self) -> f64 {
        2.0 * (2.0 * self.largest_radius + self.skin + self.reach_of(&self.pairs))
    }

    /// See [`SphereContacts::sums_through_box`].
    pub(crate) fn sums_through_box(&self, particles: &Particles) -> Option<[Mat3; 2]> {
        let Particles { position, velocity, spin, radius, .. } = particles;
        self.among.as_ref()?.sums_through_box(&Spheres { position, velocity, spin, radius })
    }

    /// Contacts of particles with each other at the last step.
    pub(crate) fn touching_among(&self) -> usize {
        self.among.as_ref().map_or(0, |among| among.touching().count())
    }

    /// Takes a particle that was not there at a place with [clearance](Contacts::clearance).
    pub(crate) fn admit_particle(&mut self, particle: u32, place: &Vec3, radius: f64) {
        self.among.iter_mut().for_each(|among| among.admit(particle, place));
        self.nodes.debris.iter_mut().for_each(|among| among.admit_particle(particle, place));
        for (rigid_body, (contacts, _)) in self.rigid_bodies.iter().zip(&mut self.on_tools) {
            contacts.admit(&rigid_body.ground(), particle, place);
        }
        self.solids.iter_mut().for_each(|ground| ground.admit_particle(particle, place, radius));
    }

    /// Rigid bodies and the surfaces of solids, where they were when forces were last found.
    pub(crate) fn grounds(&self) -> impl Iterator<Item = Surface<'_>> {
        self.rigid_bodies.iter().map(RigidBody::ground).chain(self.solids.iter().map(SolidSurface::ground))
    }

    /// Whether nothing can touch: no particles but those of one bonded body, and nothing else that they could meet.
    pub fn is_empty(&self) -> bool {
        self.among.is_none() && self.rigid_bodies.is_empty() && self.solids.is_empty()
    }

    /// Rigid bodies.
    pub fn rigid_bodies(&self) -> &[RigidBody] {
        &self.rigid_bodies
    }

    pub(crate) fn rigid_bodies_mut(&mut self) -> &mut [RigidBody] {
        &mut self.rigid_bodies
    }

    /// Squared frequency that contacts ask of the step [1/s²].
    pub(crate) fn frequency_square(&self) -> f64 {
        self.rayleigh_frequency * self.rayleigh_frequency + self.flat.frequency_square + self.nodes.frequency_square
    }

    /// Energy of the mean particle at the speed of the fastest place of the rigid bodies [J]: what the first touch is about.
    pub(crate) fn touch_energy(&self, particles: &Particles) -> f64 {
        let fastest = self.rigid_bodies.iter().map(RigidBody::speed).fold(0.0, f64::max);
        if fastest == 0.0 || particles.is_empty() {
            return 0.0;
        }
        0.5 * fastest * fastest * particles.mass.iter().sum::<f64>() / particles.len() as f64
    }

    /// Contacts at the last step.
    pub(crate) fn touching(&self) -> usize {
        let ground = |contacts: &SurfaceContacts<Hertz>| contacts.touches().filter(|t| t.is_contact()).count();
        self.touching_among()
            + self.on_tools.iter().map(|(contacts, _)| ground(contacts)).sum::<usize>()
            + self.solids.iter().map(|solid| ground(solid.contacts())).sum::<usize>()
            + self.node_contacts()
    }

    /// Adds the forces of the moment to particles, rigid bodies and the nodes of solids.
    ///
    /// - `part`: that of this process, where several share the particles and have done the [searches](Contacts::search) that were due
    /// - `dt` [s]: the step that led here
    pub(crate) fn add_forces(
        &mut self,
        part: Option<&ParticleSubdomain>,
        solid: &mut Solid,
        particles: &mut Particles,
        dt: f64,
    ) -> Work {
        let mut work = Work::default();
        let searches = part.is_none();
        if let Some(part) = part {
            work += self.add_forces_among(part, particles, dt);
            let near: Vec<u32> = self.near().collect();
            self.flat.locate(&Poses::of(particles), near.iter().map(|&i| i as usize));
        } else {
            self.flat.locate(&Poses::of(particles), 0..particles.len());
        }
        let Particles { position, velocity, spin, orientation, radius, mass, force, moment, .. } = particles;
        let spheres = Spheres { position, velocity, spin, radius };
        let poses = Poses { position, velocity, spin, orientation, radius };
        if let Some(mut among) = self.among.take_if(|_| searches) {
            among.search(&spheres, |i, j| self.law_among(radius, mass, i, j));
            work += among.add_forces(&spheres, force, moment, dt);
            self.among = Some(among);
        }
        let Contacts { body, rigid_bodies, on_tools, solids, flat, nodes, .. } = self;
        let body = &*body;
        for (rigid_body, (contacts, pairs)) in rigid_bodies.iter_mut().zip(on_tools) {
            flat.locate_for(&poses, rigid_body);
            let (flat, felt) = (&*flat, flat.felt(spheres));
            let heavy = rigid_body.mass();
            let law = |i: u32, curvature: f64| {
                let i = i as usize;
                let moved = if heavy.is_finite() { mass[i] * heavy / (mass[i] + heavy) } else { mass[i] };
                let pair = &pairs[body[i] as usize];
                match flat.of(body[i]) {
                    Some(faces) => faces.law(radius[i], pair.surface, moved),
                    None => Hertz::new(pair, pair.radius_on(radius[i], curvature), moved),
                }
            };
            let ground = rigid_body.ground();
            if searches {
                contacts.search(&ground, &felt);
            }
            work += contacts.update(&ground, &felt, law, dt);
            contacts.add_to(force, moment);
            flat.add_moments(contacts.touches(), moment);
            rigid_body.clear_forces();
            for touch in contacts.touches() {
                let place = felt.position[touch.sphere as usize] + touch.offset;
                rigid_body.push(&-touch.force, &-touch.couple, &place, mass[touch.sphere as usize]);
            }
        }
        for ground in solids {
            let law = |pair: &MaterialPair, i: u32| Hertz::new(pair, radius[i as usize], mass[i as usize]);
            work += ground.add_forces(solid, &spheres, body, law, searches, dt);
            ground.contacts().add_to(force, moment);
            nodes.frequency_square = nodes.frequency_square.max(ground.frequency_square());
        }
        work
    }

    /// The law of two particles; none where bonds or a clump hold them.
    fn law_among(&self, radius: &[f64], mass: &[f64], i: u32, j: u32) -> Option<Hertz> {
        let (i, j) = (i as usize, j as usize);
        let (a, b) = (self.body[i] as usize, self.body[j] as usize);
        let reduced = |of: &[f64]| of[i] * of[j] / (of[i] + of[j]);
        let pair = &self.pairs[a * self.materials.len() + b];
        let is_one = self.clump.get(i).is_some_and(|clump| *clump != NO_CLUMP && *clump == self.clump[j]);
        (!is_one && (a != b || !self.bonded[a])).then(|| Hertz::new(pair, reduced(radius), reduced(mass)))
    }

    /// Accelerations at a time [m/s²].
    fn gravity(&self, time: f64) -> Vec3 {
        let mut sum = Vec3::zeros();
        for (axis, value) in &self.gravity {
            sum[*axis] += (value.0)(time, &Vec3::zeros());
        }
        sum
    }

    /// Kinetic energy of the rigid bodies that move freely [J].
    pub(crate) fn kinetic_energy(&self) -> f64 {
        self.rigid_bodies.iter().map(RigidBody::kinetic_energy).sum()
    }

    pub(crate) fn start_half_a_step_early(&mut self, dt: f64) {
        let gravity = self.gravity(0.0);
        self.rigid_bodies.iter_mut().for_each(|rigid_body| rigid_body.start_half_a_step_early(dt, &gravity));
    }

    /// Advances the rigid bodies with the forces of tⁿ.
    pub(crate) fn move_bodies(&mut self, clock: &Clock) -> HalfSteps {
        let mut work = HalfSteps::default();
        let gravity = if self.rigid_bodies.is_empty() { Vec3::zeros() } else { self.gravity(clock.time) };
        RigidBody::find_servo_areas(&mut self.rigid_bodies);
        for rigid_body in &mut self.rigid_bodies {
            work += rigid_body.advance(clock, &gravity);
        }
        work
    }

    /// What overlaps as it stands, deepest first.
    pub fn overlaps(&mut self, solid: &mut Solid, particles: &mut Particles) -> Vec<Overlap> {
        let mut still = self.clone();
        let kept = (particles.force.clone(), particles.moment.clone(), solid.force.clone());
        still.add_forces(None, solid, particles, 0.0);
        (particles.force, particles.moment, solid.force) = kept;
        let mut found = Vec::new();
        let Particles { position, velocity, spin, radius, .. } = &*particles;
        let spheres = Spheres { position, velocity, spin, radius };
        if let Some(among) = &still.among {
            let pairs = among.overlaps(&spheres);
            found.extend(pairs.map(|([i, j], depth)| Overlap { particle: i, other: OverlapWith::Particle(j), depth }));
        }
        let deepest = |contacts: &SurfaceContacts<Hertz>, other: OverlapWith| -> Vec<Overlap> {
            // What was taken up as it stands bears nothing.
            let loaded = |t: &&Touch<HertzMemory>| t.is_contact() && t.overlap > 0.0 && t.force != Vec3::zeros();
            let of = |t: &Touch<HertzMemory>| Overlap { particle: t.sphere, other: other.clone(), depth: t.overlap };
            contacts.touches().filter(loaded).map(of).collect()
        };
        for (rigid_body, (contacts, _)) in still.rigid_bodies.iter().zip(&still.on_tools) {
            found.extend(deepest(contacts, OverlapWith::RigidBody(rigid_body.name.clone())));
        }
        for ground in &still.solids {
            let name = solid.body(ground.body()).name.clone();
            found.extend(deepest(ground.contacts(), OverlapWith::Solid(name)));
        }
        found.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(a.particle.cmp(&b.particle)));
        found
    }

    /// The particles that are pressed together, or on a body, most deeply: the overlap over the smaller radius [-].
    pub(crate) fn deepest(&self, particles: &Particles) -> Option<(Site, f64)> {
        let Particles { position, velocity, spin, radius, .. } = particles;
        let spheres = Spheres { position, velocity, spin, radius };
        let among = self.among.iter().flat_map(|among| among.pressed(&spheres));
        let share = |[i, j]: [u32; 2], depth: f64| depth / radius[i as usize].min(radius[j as usize]);
        let among = among.map(|(pair, depth)| (Site::Particles(pair), share(pair, depth)));
        let grounds = self.on_tools.iter().map(|(contacts, _)| contacts);
        let grounds = grounds.chain(self.solids.iter().map(SolidSurface::contacts));
        let on_ground = grounds.flat_map(|contacts| contacts.pressed());
        let on_ground =
            on_ground.map(|(particle, depth)| (Site::Particle(particle), depth / radius[particle as usize]));
        among.chain(on_ground).reduce(|a, b| if b.1 > a.1 { b } else { a })
    }

    /// Everything that changes, for a checkpoint.
    pub(crate) fn state(&self) -> ContactsState {
        ContactsState {
            among: self.among.as_ref().map_or_else(Vec::new, SphereContacts::state),
            rigid_bodies: self
                .rigid_bodies
                .iter()
                .zip(&self.on_tools)
                .map(|(t, (contacts, _))| (t.state(), contacts.state()))
                .collect(),
            solids: self.solids.iter().map(SolidSurface::state).collect(),
            nodes: self.nodes.state(),
        }
    }

    /// Puts a saved state back.
    pub(crate) fn restore(&mut self, solid: &Solid, debris: &Debris, state: ContactsState) {
        if let Some(among) = &mut self.among {
            among.restore(state.among);
        }
        for ((rigid_body, (contacts, _)), (own, touches)) in
            self.rigid_bodies.iter_mut().zip(&mut self.on_tools).zip(state.rigid_bodies)
        {
            rigid_body.restore(own);
            contacts.restore(touches);
        }
        for (ground, touches) in self.solids.iter_mut().zip(state.solids) {
            ground.restore(solid, debris, touches);
        }
        self.nodes.restore(debris, &self.solids, state.nodes);
    }
}
