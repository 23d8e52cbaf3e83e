//! Spheres, what they touch, and a contact between both.

use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::frame::Frame;
use crate::shape::Shape;
use crate::surface::FacetMesh;

/// A population of spheres; one entry per sphere in every array.
#[derive(Clone, Copy, Debug)]
pub struct Spheres<'a> {
    /// Centres [m].
    pub position: &'a [Vec3],
    /// Velocities [m/s].
    pub velocity: &'a [Vec3],
    /// Angular velocities [rad/s].
    pub spin: &'a [Vec3],
    /// Radii [m]; a sphere with a negative one is not there, and meets nothing.
    pub radius: &'a [f64],
}

/// What spheres touch.
#[derive(Clone, Copy, Debug)]
pub enum Surface<'a> {
    /// Facets of a rigid body; points in the axes of the body [m].
    Rigid {
        /// Facets.
        surface: &'a FacetMesh,
        /// Points in the axes of the body [m].
        points: &'a [Vec3],
        /// Where the body is.
        frame: &'a Frame,
    },
    /// Facets of a body that deforms.
    Deformable {
        /// Facets.
        surface: &'a FacetMesh,
        /// Points [m].
        points: &'a [Vec3],
        /// Velocities of the points [m/s].
        velocity: &'a [Vec3],
    },
    /// A rigid shape, or the container of that shape.
    Shape {
        /// Its shape.
        shape: Shape,
        /// Whether spheres are inside.
        hollow: bool,
        /// Where it is.
        frame: &'a Frame,
    },
}

/// A contact of a sphere with the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch<M> {
    /// Sphere.
    pub sphere: u32,
    /// Feature of the surface.
    pub feature: u32,
    /// Connected part of the surface; the history of a contact belongs to the sphere and this part.
    pub(crate) part: u32,
    /// From the centre of the sphere to the contact [m].
    pub offset: Vec3,
    /// Overlap [m].
    pub overlap: f64,
    /// Unit vector into the ground.
    pub normal: Vec3,
    pub(crate) weight: f64,
    pub(crate) elastic: bool,
    pub(crate) memory: M,
    /// Force on the sphere [N]; the ground feels the opposite at the contact.
    pub force: Vec3,
    /// Moment on the sphere about its centre [N m].
    pub moment: Vec3,
    /// Couple on the sphere, part of `moment`; a rigid ground feels the opposite [N m].
    pub couple: Vec3,
    pub(crate) stored: f64,
    pub(crate) friction: f64,
    pub(crate) damping: f64,
}

impl<M> Touch<M> {
    /// Whether this is a contact, and not what several contacts of a sphere share.
    pub fn is_contact(&self) -> bool {
        self.weight > 0.0 && !self.elastic
    }
}

impl Surface<'_> {
    /// Facets that a ball overlaps, ascending; none of a shape.
    ///
    /// - `centre`, `radius` [m]: of the ball, in space
    pub fn facets_within(&self, centre: &Vec3, radius: f64) -> Vec<u32> {
        match self {
            Surface::Shape { .. } => Vec::new(),
            Surface::Rigid { surface, .. } | Surface::Deformable { surface, .. } => {
                (0..surface.len() as u32).filter(|&facet| self.is_facet_within(facet, centre, radius)).collect()
            }
        }
    }

    /// Whether a ball overlaps the ground: one of these facets, or its shape.
    ///
    /// - `centre`, `radius` [m]: of the ball, in space
    pub fn is_within(&self, facets: &[u32], centre: &Vec3, radius: f64) -> bool {
        match self {
            Surface::Shape { shape, hollow, frame } => {
                let mut feet = Vec::new();
                shape.feet(*hollow, &frame.to_body(centre), radius, &mut feet);
                !feet.is_empty()
            }
            _ => facets.iter().any(|&facet| self.is_facet_within(facet, centre, radius)),
        }
    }

    fn is_facet_within(&self, facet: u32, centre: &Vec3, radius: f64) -> bool {
        let (surface, points, centre) = match self {
            Surface::Rigid { surface, points, frame } => (surface, points, frame.to_body(centre)),
            Surface::Deformable { surface, points, .. } => (surface, points, *centre),
            Surface::Shape { .. } => return false,
        };
        !surface.is_gone(facet) && surface.closest(facet, points, &centre).1.norm_squared() < radius * radius
    }

    pub(crate) fn part(&self, facet: u32) -> u32 {
        match self {
            Surface::Rigid { surface, .. } | Surface::Deformable { surface, .. } => surface.part(facet),
            Surface::Shape { .. } => 0,
        }
    }

    /// Velocity of the ground at a place on a feature [m/s] and its angular velocity [rad/s]; that of a facet that
    /// deforms counts as zero.
    pub(crate) fn motion_at(&self, feature: u32, place: &Vec3) -> (Vec3, Vec3) {
        match self {
            Surface::Rigid { frame, .. } | Surface::Shape { frame, .. } => (frame.velocity_at(place), frame.spin),
            Surface::Deformable { surface, points, velocity } => {
                (surface.interpolate(feature, place, points, velocity), Vec3::zeros())
            }
        }
    }
}
