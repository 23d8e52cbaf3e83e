//! Rigid bodies: shapes, facets, and how they move.

use fractum_math::Vec3;
use fractum_scene::ContactParameters;

use super::{Components, FileContent};
use crate::{Field, Spanned};

/// A rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Its shape.
    pub shape: RigidShape,
    /// Whether the particles are inside the shape.
    pub inside: bool,
    /// Index into `Case::materials` of its elastic constants in contact; `None` = it does not deform.
    pub material: Option<usize>,
    /// Contact with it.
    pub contact: ContactParameters,
    /// Prescribed velocity [m/s] along x, y, z; `None` = held, or free.
    pub velocity: Components,
    /// Prescribed angular velocity [rad/s] about axes through its reference point; `None` = held.
    pub spin: Components,
    /// Axes along which it moves freely.
    pub free: [bool; 3],
    /// Whether it turns freely.
    pub free_rotation: bool,
    /// Mass [kg], > 0, where it is free.
    pub mass: Option<f64>,
    /// Force on it [N] along its free axes.
    pub force: Components,
    /// Velocity [m/s] at the start along its free axes; `None` = at rest.
    pub initial_velocity: [Option<Field>; 3],
}

/// Shapes of rigid bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum RigidShape {
    /// The half space behind a plane.
    Plane {
        /// A point on the plane [m].
        point: Vec3,
        /// Unit normal out of the body.
        normal: Vec3,
    },
    /// A box with faces normal to the axes.
    Box {
        /// Lower corner [m].
        point: Vec3,
        /// Edges [m], > 0.
        size: Vec3,
    },
    /// A circular cylinder.
    Cylinder {
        /// Centre of the face where it begins [m].
        point: Vec3,
        /// Unit vector along it.
        axis: Vec3,
        /// Length [m], > 0.
        length: f64,
        /// Radius [m], > 0.
        radius: f64,
    },
    /// A sphere.
    Sphere {
        /// Centre [m].
        point: Vec3,
        /// Radius [m], > 0.
        radius: f64,
    },
    /// The triangles of a mesh group, or the surface of its tetrahedra.
    Group {
        /// The group.
        group: Spanned<String>,
        /// Reference point [m].
        point: Vec3,
    },
    /// The triangles of an STL file.
    Stl {
        /// The file.
        file: FileContent,
        /// Length of its unit [m].
        unit: f64,
        /// Reference point [m].
        point: Vec3,
    },
}
