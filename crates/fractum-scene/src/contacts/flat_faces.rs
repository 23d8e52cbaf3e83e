//! Bonded bodies on rigid bodies: their faces are flat, and stiff beside the body.

use fractum_contact::Spheres;
use fractum_contact::law::{ContactParameters, Hertz};
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
    /// How far each particle is from touching exactly the walls that it was packed against [m].
    pub shift: Vec<Vec3>,
}

impl FlatFaces {
    /// Normal and tangential stiffness of a particle of a radius [m], in N/m.
    fn stiffness(&self, radius: f64) -> [f64; 2] {
        let normal = STIFFNESS * self.young_modulus * radius;
        [normal, normal / (2.0 * (1.0 + self.poisson_ratio))]
    }

    /// The contact of a particle of a radius [m] with a rigid body; both together move a mass [kg].
    pub(super) fn law(&self, radius: f64, surface: ContactParameters, mass: f64) -> Hertz {
        Hertz::flat(self.stiffness(radius), surface, radius, mass)
    }

    /// Squared frequency that contact with one face asks of the step [1/s²]: of the normal motion, or of rolling on the
    /// tangential spring, (1/m + R²/I) k_t with I = 2/5 m R²; dampers make it harder to follow.
    fn frequency_square(&self, radius: f64, mass: f64, damping_ratio: f64) -> f64 {
        let [normal, tangential] = self.stiffness(radius);
        let stiffest = normal.max(3.5 * tangential);
        stiffest / mass * ((1.0 + damping_ratio * damping_ratio).sqrt() + damping_ratio).powi(2)
    }
}

/// The bodies of particles that have flat faces.
#[derive(Clone, Debug, Default)]
pub(super) struct FlatBodies {
    /// Faces of each body of particles; empty where no body has any.
    faces: Vec<Option<FlatFaces>>,
    /// How far each particle is from where rigid bodies feel it, and where that is [m]; empty where nothing is flat.
    shift: Vec<Vec3>,
    shifted: Vec<Vec3>,
    /// Squared frequency that flat faces ask of the step [1/s²].
    pub(super) frequency_square: f64,
}

impl FlatBodies {
    /// Faces of a body; none where its particles touch as spheres.
    pub(super) fn of(&self, body: u16) -> Option<&FlatFaces> {
        self.faces.get(usize::from(body)).and_then(Option::as_ref)
    }

    /// Puts particles where rigid bodies feel them, where that is not at their centres.
    pub(super) fn shift_particles(&mut self, position: &[Vec3]) {
        for ((place, x), shift) in self.shifted.iter_mut().zip(position).zip(&self.shift) {
            *place = x + shift;
        }
    }

    /// Where rigid bodies feel particles [m].
    pub(super) fn places<'a>(&'a self, position: &'a [Vec3]) -> &'a [Vec3] {
        if self.shifted.is_empty() { position } else { &self.shifted }
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
        let damping = self.rigid_bodies.iter().map(|rigid_body| rigid_body.surface.damping_ratio).fold(0.0, f64::max);
        let (mut shift, mut frequency_square) = (Vec::with_capacity(particles.len()), 0.0f64);
        for (body, faces) in faces.iter().enumerate() {
            let own = shift.len()..shift.len() + self.body.iter().filter(|&&of| usize::from(of) == body).count();
            let Some(faces) = faces else {
                shift.resize(own.end, Vec3::zeros());
                continue;
            };
            shift.extend_from_slice(&faces.shift);
            shift.resize(own.end, Vec3::zeros());
            let ratio = 0.5 * (damping + self.materials[body].surface.damping_ratio);
            let squares = own.map(|i| faces.frequency_square(particles.radius[i], particles.mass[i], ratio));
            frequency_square = squares.fold(frequency_square, f64::max);
        }
        if alone {
            self.rayleigh_frequency = 0.0;
        }
        self.flat = FlatBodies { faces, shift, shifted: particles.position.clone(), frequency_square };
        self.accept_on_rigid_bodies(particles, true)
    }

    /// Takes the contacts of particles with rigid bodies as they stand; returns the overlaps of flat faces that are deep.
    ///
    /// - `flat`: only those of flat faces
    pub(super) fn accept_on_rigid_bodies(&mut self, particles: &Particles, flat: bool) -> Vec<Overlap> {
        self.flat.shift_particles(&particles.position);
        let Contacts { body, rigid_bodies, on_tools, flat: bodies, .. } = self;
        let Particles { position, velocity, spin, radius, .. } = particles;
        let spheres = Spheres { position: bodies.places(position), velocity, spin, radius };
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
