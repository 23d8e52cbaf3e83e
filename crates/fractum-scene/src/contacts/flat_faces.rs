//! Bonded bodies on rigid bodies: their faces are flat, and stiff beside the body.

use fractum_contact::law::{ContactParameters, Hertz, HertzMemory};
use fractum_contact::{Spheres, Touch};
use fractum_dem::Particles;
use fractum_math::Vec3;

use super::{Contacts, Overlap, OverlapWith};

/// Normal stiffness of a particle on a rigid body over its radius and Young's modulus of the body that it belongs to.
///
/// A particle at a face stands for about 5.4 R² of it (60 particles on the face of a cylinder of 2,000). Two faces then take
/// 2·5.4/30 R/L of the strain of a body of length L: 0.9 % with twenty particles along it, 0.5 % with 34.
const STIFFNESS: f64 = 30.0;
/// Overlap at the start over the radius beyond which it is no matter of the packing.
const DEEP: f64 = 0.1;

/// What the particles of a bonded body are to rigid bodies: parts of its faces instead of spheres by themselves.
#[derive(Clone, Debug)]
pub struct FlatFaces {
    /// Young's modulus of the body [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio of the body.
    pub poisson_ratio: f64,
    /// How far each particle is from touching exactly the walls that it was packed against, in its own axes [m].
    pub shift: Vec<Vec3>,
}

/// How stiff the faces of a body are.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceStiffness {
    /// Young's modulus of the body [Pa].
    young_modulus: f64,
    /// Poisson's ratio of the body.
    poisson_ratio: f64,
}

impl FaceStiffness {
    /// Normal and tangential stiffness of a particle of a radius [m], in N/m.
    fn of(&self, radius: f64) -> [f64; 2] {
        let normal = STIFFNESS * self.young_modulus * radius;
        [normal, normal / (2.0 * (1.0 + self.poisson_ratio))]
    }

    /// The contact of a particle of a radius [m] with a rigid body; both together move a mass [kg].
    pub(super) fn law(&self, radius: f64, surface: ContactParameters, mass: f64) -> Hertz {
        Hertz::flat(self.of(radius), surface, radius, mass)
    }

    /// Squared frequency that contact with one face asks of the step [1/s²]: of the normal motion, or of rolling on the
    /// tangential spring, (1/m + (R + s)²/I) k_t with I = 2/5 m R²; dampers make it harder to follow.
    ///
    /// - `shift`: s, from the centre to where the face is felt [m]
    fn frequency_square(&self, radius: f64, shift: f64, mass: f64, damping_ratio: f64) -> f64 {
        let [normal, tangential] = self.of(radius);
        let arm = 1.0 + shift / radius;
        let stiffest = normal.max((1.0 + 2.5 * arm * arm) * tangential);
        stiffest / mass * ((1.0 + damping_ratio * damping_ratio).sqrt() + damping_ratio).powi(2)
    }
}

/// The bodies of particles that have flat faces.
#[derive(Clone, Debug, Default)]
pub(super) struct FlatBodies {
    /// Faces of each body of particles; empty where no body has any.
    faces: Vec<Option<FaceStiffness>>,
    /// From each particle to where rigid bodies feel it, in its own axes [m]; this and what follows is empty where nothing is flat.
    shift: Vec<Vec3>,
    /// The same in the axes of space [m].
    arm: Vec<Vec3>,
    /// Where rigid bodies feel particles [m], and the velocity there [m/s].
    place: Vec<Vec3>,
    velocity: Vec<Vec3>,
    /// Squared frequency that flat faces ask of the step [1/s²].
    pub(super) frequency_square: f64,
}

impl FlatBodies {
    /// Faces of a body; none where its particles touch as spheres.
    pub(super) fn of(&self, body: u16) -> Option<&FaceStiffness> {
        self.faces.get(usize::from(body)).and_then(Option::as_ref)
    }

    /// Finds where rigid bodies feel some of the particles: faces turn with their particles.
    pub(super) fn locate(&mut self, particles: &Particles, which: impl IntoIterator<Item = usize>) {
        let FlatBodies { shift, arm, place, velocity, .. } = self;
        if shift.is_empty() {
            return;
        }
        for i in which {
            let shift = shift[i];
            (place[i], velocity[i]) = (particles.position[i], particles.velocity[i]);
            if shift != Vec3::zeros() {
                arm[i] = particles.orientation[i] * shift;
                place[i] += arm[i];
                velocity[i] += particles.spin[i].cross(&arm[i]);
            }
        }
    }

    /// Particles as rigid bodies feel them.
    pub(super) fn felt<'a>(&'a self, spheres: Spheres<'a>) -> Spheres<'a> {
        if self.shift.is_empty() {
            spheres
        } else {
            Spheres { position: &self.place, velocity: &self.velocity, ..spheres }
        }
    }

    /// Where rigid bodies feel a particle as it stands [m].
    pub(super) fn place(&self, particles: &Particles, i: usize) -> Vec3 {
        let shift = self.shift.get(i).copied().filter(|shift| *shift != Vec3::zeros());
        shift.map_or(particles.position[i], |shift| particles.position[i] + particles.orientation[i] * shift)
    }

    /// Adds the moments about the centres of forces that act where rigid bodies feel particles.
    pub(super) fn add_moments<'a>(&self, touches: impl Iterator<Item = &'a Touch<HertzMemory>>, moment: &mut [Vec3]) {
        if self.shift.is_empty() {
            return;
        }
        for touch in touches {
            let i = touch.sphere as usize;
            moment[i] += self.arm[i].cross(&touch.force);
        }
    }
}

impl Contacts {
    /// Makes the faces of bonded bodies flat to rigid bodies, and takes as they stand those that touch one; returns overlaps of
    /// more than a tenth of a radius, which no packing makes.
    ///
    /// - `faces`: of each body of particles; none for those that touch as spheres
    pub fn flatten(&mut self, faces: Vec<Option<FlatFaces>>, particles: &Particles) -> Vec<Overlap> {
        if self.rigid_bodies.is_empty() || faces.iter().all(Option::is_none) {
            return Vec::new();
        }
        let alone = self.among.is_none() && self.solids.is_empty();
        let (mut shift, mut frequency_square) = (Vec::with_capacity(particles.len()), 0.0f64);
        let mut stiffness = Vec::with_capacity(faces.len());
        for (body, faces) in faces.into_iter().enumerate() {
            let own = shift.len()..shift.len() + self.body.iter().filter(|&&of| usize::from(of) == body).count();
            let Some(FlatFaces { young_modulus, poisson_ratio, shift: of_body }) = faces else {
                shift.resize(own.end, Vec3::zeros());
                stiffness.push(None);
                continue;
            };
            shift.extend(of_body);
            shift.resize(own.end, Vec3::zeros());
            let faces = FaceStiffness { young_modulus, poisson_ratio };
            let ratios = self.on_tools.iter().map(|(_, pairs)| pairs[body].surface.damping_ratio);
            let ratio = ratios.fold(0.0, f64::max);
            let (radius, mass) = (&particles.radius, &particles.mass);
            let squares = own.map(|i| faces.frequency_square(radius[i], shift[i].norm(), mass[i], ratio));
            frequency_square = squares.fold(frequency_square, f64::max);
            stiffness.push(Some(faces));
        }
        if alone {
            self.rayleigh_frequency = 0.0;
        }
        self.flat = FlatBodies {
            faces: stiffness,
            arm: vec![Vec3::zeros(); shift.len()],
            place: particles.position.clone(),
            velocity: particles.velocity.clone(),
            shift,
            frequency_square,
        };
        self.accept_on_rigid_bodies(particles, true)
    }

    /// Takes the contacts of particles with rigid bodies as they stand; returns the overlaps of flat faces that are deep.
    ///
    /// - `flat`: only those of flat faces
    pub(super) fn accept_on_rigid_bodies(&mut self, particles: &Particles, flat: bool) -> Vec<Overlap> {
        self.flat.locate(particles, 0..particles.len());
        let Contacts { body, rigid_bodies, on_tools, flat: bodies, .. } = self;
        let Particles { position, velocity, spin, radius, .. } = particles;
        let spheres = bodies.felt(Spheres { position, velocity, spin, radius });
        let is_flat = |i: u32| bodies.of(body[i as usize]).is_some();
        let mut deep = Vec::new();
        for (rigid_body, (contacts, _)) in rigid_bodies.iter().zip(on_tools) {
            contacts.search(&rigid_body.ground(), &spheres);
            let which = |i: u32| (!flat || is_flat(i)).then_some(0.0);
            contacts.accept_initial_overlap(&rigid_body.ground(), &spheres, which);
            let worse =
                contacts.touches().filter(|t| is_flat(t.sphere) && t.overlap > DEEP * radius[t.sphere as usize]);
            let other = OverlapWith::RigidBody(rigid_body.name.clone());
            deep.extend(worse.map(|t| Overlap { particle: t.sphere, other: other.clone(), depth: t.overlap }));
        }
        deep
    }
}
