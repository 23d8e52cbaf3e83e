//! Bonded bodies on rigid bodies: their faces are flat, and stiff beside the body.

use fractum_contact::law::{ContactParameters, Hertz, HertzMemory};
use fractum_contact::{Shape, Spheres, Touch};
use fractum_dem::Particles;
use fractum_math::{Rotation, Vec3};

use super::{Contacts, Form, Overlap, OverlapWith, RigidBody};

/// Normal stiffness of a particle on a rigid body over its radius and Young's modulus of the body that it belongs to.
///
/// A particle at a face stands for about 5.4 R² of it (60 particles on the face of a cylinder of 2,000). Two faces then take
/// 2·5.4/30 R/L of the strain of a body of length L: 0.9 % with twenty particles along it, 0.5 % with 34.
const STIFFNESS: f64 = 30.0;
/// Half width of the part of a face that a particle stands for over its radius: that of a square of 5.4 R².
const HALF_WIDTH: f64 = 1.16;
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
    /// The way out of the body at each particle of a flat face alone, in its own axes; zero for the others.
    pub out: Vec<Vec3>,
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
    /// - `beside`: how far beside the centre it may be felt, over the radius
    fn frequency_square(&self, radius: f64, shift: f64, beside: f64, mass: f64, damping_ratio: f64) -> f64 {
        let [normal, tangential] = self.of(radius);
        let arm = 1.0 + shift / radius;
        let turning = |arm_square: f64| 1.0 + 2.5 * arm_square;
        let stiffest = (turning(beside * beside) * normal).max(turning(arm * arm + beside * beside) * tangential);
        stiffest / mass * ((1.0 + damping_ratio * damping_ratio).sqrt() + damping_ratio).powi(2)
    }
}

/// Places, velocities and orientations of particles, one for each.
pub(super) struct Poses<'a> {
    pub(super) position: &'a [Vec3],
    pub(super) velocity: &'a [Vec3],
    pub(super) spin: &'a [Vec3],
    pub(super) orientation: &'a [Rotation],
    pub(super) radius: &'a [f64],
}

impl<'a> Poses<'a> {
    /// Those of all particles.
    pub(super) fn of(particles: &'a Particles) -> Self {
        let Particles { position, velocity, spin, orientation, radius, .. } = particles;
        Poses { position, velocity, spin, orientation, radius }
    }
}

/// The axis of a cylinder.
#[derive(Clone, Copy)]
struct Line {
    through: Vec3,
    along: Vec3,
}

impl Line {
    /// That of a cylinder that is touched from outside; none of other rigid bodies.
    fn of(tool: &RigidBody) -> Option<Line> {
        let is_round = matches!(tool.form, Form::Shape { shape: Shape::Cylinder { .. }, hollow: false });
        is_round.then(|| Line { through: tool.frame.origin, along: tool.frame.rotation * Vec3::z() })
    }

    /// The way from a place on a flat face, across the axis, to the place of the face that is nearest to it [m]; less where the
    /// axis is askew to the face, and none where it stands on it.
    ///
    /// - `out`: normal of the face
    /// - `most`: longest way [m]
    fn beside(&self, place: &Vec3, out: &Vec3, most: f64) -> Vec3 {
        let across = out.cross(&self.along);
        let square = across.norm_squared();
        if square == 0.0 {
            return Vec3::zeros();
        }
        let way = across.dot(&(self.through - place)) / square.sqrt();
        let most = most * square;
        across / square.sqrt() * way.clamp(-most, most)
    }
}

/// The bodies of particles that have flat faces.
#[derive(Clone, Debug, Default)]
pub(super) struct FlatBodies {
    /// Faces of each body of particles; empty where no body has any.
    faces: Vec<Option<FaceStiffness>>,
    /// From each particle to where rigid bodies feel it, in its own axes [m]; this and what follows is empty where nothing is flat.
    shift: Vec<Vec3>,
    /// The way out of the body at each particle of a flat face alone, in its own axes; empty where no round body is.
    out: Vec<Vec3>,
    /// Those particles.
    parts: Vec<u32>,
    /// Whether they are felt now where they are nearest to a round body.
    leaning: bool,
    /// From each particle to where it is felt, in the axes of space [m].
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

    /// Finds where flat rigid bodies feel some of the particles: faces turn with their particles.
    pub(super) fn locate(&mut self, particles: &Poses<'_>, which: impl IntoIterator<Item = usize>) {
        if self.shift.is_empty() {
            return;
        }
        for i in which {
            self.set(particles, i, None);
        }
        self.leaning = false;
    }

    /// Finds where a rigid body feels the particles, which have been located: a cylinder feels those of a flat face where the
    /// parts of the face that they stand for are nearest to its axis.
    pub(super) fn locate_for(&mut self, particles: &Poses<'_>, tool: &RigidBody) {
        let line = Line::of(tool);
        if self.parts.is_empty() || (line.is_none() && !self.leaning) {
            return;
        }
        for part in 0..self.parts.len() {
            self.set(particles, self.parts[part] as usize, line);
        }
        self.leaning = line.is_some();
    }

    fn set(&mut self, particles: &Poses<'_>, i: usize, line: Option<Line>) {
        let arm = self.arm_of(particles, i, line);
        (self.place[i], self.velocity[i]) = (particles.position[i], particles.velocity[i]);
        if let Some(arm) = arm {
            self.arm[i] = arm;
            self.place[i] += arm;
            self.velocity[i] += particles.spin[i].cross(&arm);
        }
    }

    /// From a particle to where it is felt [m]; none where that is its centre.
    fn arm_of(&self, particles: &Poses<'_>, i: usize, line: Option<Line>) -> Option<Vec3> {
        let out = line.and_then(|line| Some((line, *self.out.get(i)?))).filter(|(_, out)| *out != Vec3::zeros());
        let shift = self.shift[i];
        if out.is_none() && shift == Vec3::zeros() {
            return None;
        }
        let turn = particles.orientation[i];
        let arm = turn * shift;
        Some(out.map_or(arm, |(line, out)| {
            let place = particles.position[i] + arm;
            arm + line.beside(&place, &(turn * out), HALF_WIDTH * particles.radius[i])
        }))
    }

    /// Particles as rigid bodies feel them.
    pub(super) fn felt<'a>(&'a self, spheres: Spheres<'a>) -> Spheres<'a> {
        if self.shift.is_empty() {
            spheres
        } else {
            Spheres { position: &self.place, velocity: &self.velocity, ..spheres }
        }
    }

    /// Where a rigid body feels a particle as it stands [m].
    pub(super) fn place(&self, particles: &Particles, i: usize, tool: &RigidBody) -> Vec3 {
        let particles = &Poses::of(particles);
        let arm = if self.shift.is_empty() { None } else { self.arm_of(particles, i, Line::of(tool)) };
        particles.position[i] + arm.unwrap_or_default()
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
        let (mut shift, mut out) = (Vec::with_capacity(particles.len()), Vec::with_capacity(particles.len()));
        let mut frequency_square = 0.0f64;
        let round = self.rigid_bodies.iter().any(|tool| Line::of(tool).is_some());
        let beside = if round { HALF_WIDTH } else { 0.0 };
        let mut stiffness = Vec::with_capacity(faces.len());
        for (body, faces) in faces.into_iter().enumerate() {
            let own = shift.len()..shift.len() + self.body.iter().filter(|&&of| usize::from(of) == body).count();
            let Some(FlatFaces { young_modulus, poisson_ratio, shift: of_body, out: of_faces }) = faces else {
                shift.resize(own.end, Vec3::zeros());
                out.resize(own.end, Vec3::zeros());
                stiffness.push(None);
                continue;
            };
            shift.extend(of_body);
            shift.resize(own.end, Vec3::zeros());
            out.extend(of_faces);
            out.resize(own.end, Vec3::zeros());
            let faces = FaceStiffness { young_modulus, poisson_ratio };
            let ratios = self.on_tools.iter().map(|(_, pairs)| pairs[body].surface.damping_ratio);
            let ratio = ratios.fold(0.0, f64::max);
            let (radius, mass) = (&particles.radius, &particles.mass);
            let squares = own.map(|i| faces.frequency_square(radius[i], shift[i].norm(), beside, mass[i], ratio));
            frequency_square = squares.fold(frequency_square, f64::max);
            stiffness.push(Some(faces));
        }
        if alone {
            self.rayleigh_frequency = 0.0;
        }
        let parts = (0..out.len() as u32).filter(|&i| round && out[i as usize] != Vec3::zeros()).collect();
        self.flat = FlatBodies {
            faces: stiffness,
            out: if round { out } else { Vec::new() },
            parts,
            leaning: false,
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
        let poses = Poses::of(particles);
        self.flat.locate(&poses, 0..particles.len());
        let Contacts { body, rigid_bodies, on_tools, flat: bodies, .. } = self;
        let Particles { position, velocity, spin, radius, .. } = particles;
        let mut deep = Vec::new();
        for (rigid_body, (contacts, _)) in rigid_bodies.iter().zip(on_tools) {
            bodies.locate_for(&poses, rigid_body);
            let spheres = bodies.felt(Spheres { position, velocity, spin, radius });
            let is_flat = |i: u32| bodies.of(body[i as usize]).is_some();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_face_is_felt_where_it_is_nearest_to_the_axis() {
        let line = |along: Vec3| Line { through: Vec3::new(0.3, 5.0, 2.0), along: along.normalize() };
        let (place, out) = (Vec3::new(0.0, 0.0, 0.0), Vec3::y());
        // Across the axis as far as the axis is away, and no farther than the part is wide.
        let along_z = line(Vec3::z());
        assert!((along_z.beside(&place, &out, 1.0) - Vec3::new(0.3, 0.0, 0.0)).norm() < 1e-15);
        assert!((along_z.beside(&place, &out, 0.1) - Vec3::new(0.1, 0.0, 0.0)).norm() < 1e-15);
        // The other sense of the axis or of the normal changes nothing.
        assert_eq!(along_z.beside(&place, &out, 0.1), line(-Vec3::z()).beside(&place, &out, 0.1));
        assert_eq!(along_z.beside(&place, &-out, 0.1), along_z.beside(&place, &out, 0.1));
        // A cylinder that stands on the face feels spheres.
        assert_eq!(line(Vec3::y()).beside(&place, &out, 1.0), Vec3::zeros());
        // Nearer than any other place of the part, for an axis across the face.
        let slanting = line(Vec3::new(1.0, 0.0, 1.0));
        let distance = |place: Vec3| (place - slanting.through).cross(&slanting.along).norm();
        let best = distance(slanting.beside(&place, &out, 0.5));
        for step in -10..=10 {
            let way = out.cross(&slanting.along) * 0.05 * f64::from(step);
            assert!(best <= distance(place + way) + 1e-12, "{step}");
        }
    }
}
