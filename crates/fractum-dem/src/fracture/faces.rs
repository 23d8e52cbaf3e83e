//! Contact of what bonds held, and of what they never held.

use fractum_contact::law::{ContactMemory, ContactParameters, Linear, PairMotion, Rolling};
use fractum_contact::{Image, PeriodicCell};
use fractum_math::{Vec3, Work};
use serde::{Deserialize, Serialize};

use crate::bond::Bonds;
use crate::particles::Particles;

/// The faces of a crack against one another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CrackFaces {
    /// Coulomb's coefficient μ ≥ 0.
    pub friction: f64,
    /// Damping of the closing motion over the critical one, ξ ≥ 0.
    pub damping_ratio: f64,
}

impl Default for CrackFaces {
    fn default() -> Self {
        CrackFaces { friction: 0.5, damping_ratio: 0.0 }
    }
}

impl From<ContactParameters> for CrackFaces {
    /// Faces as surfaces of a material: friction and damping, without the couple of rolling.
    fn from(surface: ContactParameters) -> Self {
        CrackFaces { friction: surface.friction, damping_ratio: surface.damping_ratio }
    }
}

/// Work of crack faces in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceWork {
    /// In the springs of faces that touch; taken by friction and damping.
    pub contact: Work,
    /// Taken or given by the finite step where faces meet or part within it; of second order in the step [J].
    pub kinks: f64,
}

/// Two particles of a body that touch where no bond joins them: it is broken, or never was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Face {
    pub(crate) pair: [u32; 2],
    /// Image of the second particle that the first touches, in a box that repeats.
    pub(crate) image: Image,
    /// Whether there never was a bond.
    pub(crate) stranger: bool,
    /// Length of the bond without load, or sum of the radii [m].
    rest: f64,
    /// Distance at which they touch [m].
    closing: f64,
    /// Distance at the last step [m].
    last: f64,
    law: Linear,
    memory: ContactMemory,
}

impl Face {
    /// Two particles as they stand: they give no force yet.
    ///
    /// - `pair`: the particles, and the image of the second one
    /// - `rest` [m]: the distance at which they touch, once they have parted as far
    pub(crate) fn new(
        bonds: &Bonds,
        particles: &Particles,
        (pair, image): ([u32; 2], Image),
        rest: f64,
        faces: CrackFaces,
        stranger: bool,
    ) -> Self {
        let [i, j] = pair.map(|i| i as usize);
        let [normal_stiffness, tangential_stiffness] = bonds.face_stiffness(rest);
        let reduced = particles.mass[i] * particles.mass[j] / (particles.mass[i] + particles.mass[j]);
        let law = Linear {
            normal_stiffness,
            tangential_stiffness,
            normal_damping: 2.0 * faces.damping_ratio * (reduced * normal_stiffness).sqrt(),
            friction: faces.friction,
            rolling: Rolling::default(),
        };
        let cell = bonds.through_box().map(|(cell, _)| cell);
        let distance = apart(particles, pair, &image, cell).norm();
        Face {
            pair,
            image,
            stranger,
            rest,
            closing: rest.min(distance),
            last: distance,
            law,
            memory: ContactMemory::default(),
        }
    }

    /// Distance between the surfaces, negative where they overlap [m].
    pub(crate) fn gap(&self, particles: &Particles, cell: Option<&PeriodicCell>) -> f64 {
        self.apart(particles, cell).norm() - self.rest
    }

    /// Whether both touch.
    pub(crate) fn is_loaded(&self, particles: &Particles, cell: Option<&PeriodicCell>) -> bool {
        self.apart(particles, cell).norm() < self.closing
    }

    /// From the first particle to the second, or to its image in the box that repeats [m].
    pub(crate) fn apart(&self, particles: &Particles, cell: Option<&PeriodicCell>) -> Vec3 {
        apart(particles, self.pair, &self.image, cell)
    }

    /// Force of the moment on the second particle [N] and moment on both [N m]; none where they are far apart. `dt` is the step that led
    /// here [s].
    pub(crate) fn force(
        &mut self,
        particles: &Particles,
        cell: Option<&PeriodicCell>,
        dt: f64,
        work: &mut FaceWork,
    ) -> Option<[Vec3; 2]> {
        let Particles { velocity, spin, .. } = particles;
        let [i, j] = self.pair.map(|i| i as usize);
        let apart = self.apart(particles, cell);
        let distance = apart.norm();
        let overlap = self.closing - distance;
        // The trapezoid of the forces over the step against the change of the spring: not the same across the kink.
        let (before, after) = ((self.closing - self.last).max(0.0), overlap.max(0.0));
        if (before > 0.0) != (after > 0.0) {
            let given = 0.5 * (before + after) * (distance - self.last);
            work.kinks += self.law.normal_stiffness * (0.5 * (before * before - after * after) - given);
        }
        self.last = distance;
        self.closing = self.closing.max(distance.min(self.rest));
        // Far apart and long so: nothing to forget either.
        if overlap < -self.rest {
            return None;
        }
        let normal = apart / distance;
        let arm = 0.5 * distance;
        let turning = (spin[i] + spin[j]).cross(&normal) * arm;
        let mut velocity = velocity[j] - velocity[i] - turning;
        if let Some(cell) = cell {
            velocity += cell.velocity_of(&self.image);
        }
        let motion = PairMotion { normal, overlap, velocity, spin: spin[j] - spin[i], dt };
        let found = self.law.force(&motion, &mut self.memory);
        let twist = normal.cross(&found.on_second) * -arm;
        work.contact += found.work();
        Some([found.on_second, twist])
    }
}

fn apart(particles: &Particles, pair: [u32; 2], image: &Image, cell: Option<&PeriodicCell>) -> Vec3 {
    let [i, j] = pair.map(|i| i as usize);
    let apart = particles.position[j] - particles.position[i];
    cell.map_or(apart, |cell| apart + cell.offset(image))
}
