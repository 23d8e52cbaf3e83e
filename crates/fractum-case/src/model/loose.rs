//! Loose particles: spheres that nothing joins, or rigid grains of several.

use fractum_math::Vec3;
use fractum_pack::Grading;
use fractum_prepare::{Amount, Clump, Region, Stream};

use super::{FileContent, FileUnit};
use crate::{Field, Place, Spanned};

/// Loose particles of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct LooseBody {
    /// Index into `Case::materials`.
    pub material: usize,
    /// Where they come from.
    pub source: LooseSource,
    /// What each of them is, where it is no single sphere.
    pub clump: Option<Spanned<Clump>>,
    /// Thickness of plane discs [m]; none of spheres.
    pub thickness: Option<Spanned<f64>>,
    /// Sets of its particles by name, each with a condition on the position.
    pub groups: Vec<(Spanned<String>, Field)>,
    /// Initial velocity [m/s] along x, y, z; `None` = at rest.
    pub initial_velocity: [Option<Spanned<Field>>; 3],
}

impl LooseBody {
    /// Mesh group that they fill.
    pub fn group(&self) -> Option<&Spanned<String>> {
        match &self.source {
            LooseSource::Graded { shape: Spanned { value: CloudShape::Group(group), .. }, .. } => Some(group),
            _ => None,
        }
    }
}

/// Shapes that a cloud of given sizes can fill.
#[derive(Debug, Clone, PartialEq)]
pub enum CloudShape {
    /// One that needs no file.
    Region(Region),
    /// A mesh group: tetrahedra, or triangles that enclose a volume.
    Group(Spanned<String>),
    /// The closed surface of an STL file.
    Stl {
        /// The file.
        file: FileContent,
        /// Length of its unit [m].
        unit: f64,
    },
}

/// Where loose particles come from.
#[derive(Debug, Clone, PartialEq)]
pub enum LooseSource {
    /// One particle.
    Single {
        /// Its centre [m], of a clump the centre of mass.
        centre: Vec3,
        /// Its radius [m], > 0.
        radius: f64,
    },
    /// A file of particles.
    File {
        /// The file.
        file: FileContent,
        /// Unit of its lengths.
        unit: FileUnit,
        /// Its unit of velocity [m/s]; `None` = velocities are not taken.
        velocity_unit: Option<f64>,
        /// Its frame, from 0 on; `None` = the last one.
        frame: Option<u64>,
        /// Type of the particles that are taken; `None` = all.
        species: Option<String>,
    },
    /// A cloud that fills a region loosely: no two touch.
    Cloud {
        /// The region, with its place.
        region: Spanned<Region>,
        /// Mean radius [m], > 0.
        radius: f64,
        /// (R_max − R_min)/R_mean of the radii, 0 to 1.
        dispersion: f64,
        /// At most so many; `None` = as many as there is room for.
        count: Option<Spanned<u64>>,
        /// Seed of radii and places.
        seed: u64,
    },
    /// A cloud of given sizes at random places: no two touch.
    Graded {
        /// The shape, with its place.
        shape: Spanned<CloudShape>,
        /// Sizes of its particles.
        grading: Grading,
        /// How many, with the place.
        amount: Spanned<Amount>,
        /// Seed of sizes and places.
        seed: u64,
    },
    /// Particles that come in through a region as time goes on.
    Inlet {
        /// What comes.
        stream: Stream,
        /// Place of the region.
        region: Place,
        /// Place of the rate.
        rate: Place,
    },
}
