//! Rigid bodies: shapes, facets, and how they move.

use fractum_math::Vec3;
use fractum_scene::ContactParameters;

use super::{Components, ContactCoefficients, FileContent};
use crate::{Field, Spanned, TimeFunction};

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
    /// Work of adhesion between two such bodies [J/m²].
    pub work_of_adhesion: f64,
    /// What of these the body says itself.
    pub own_contact: ContactCoefficients,
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
    /// How it presses with a given force.
    pub servo: Option<Servo>,
    /// Velocity [m/s] at the start along its free axes; `None` = at rest.
    pub initial_velocity: [Option<Spanned<Field>>; 3],
}

/// How a rigid body presses along an axis with a given force.
#[derive(Debug, Clone, PartialEq)]
pub struct Servo {
    /// The axis.
    pub axis: usize,
    /// Direction along it: 1 or -1.
    pub sign: f64,
    /// Force or pressure.
    pub force: ServoForce,
    /// Largest speed [m/s], > 0.
    pub speed: f64,
    /// Share of the force that is missing where it slows down, above 0 to 1.
    pub slows_at: f64,
}

/// What a servo presses with.
#[derive(Debug, Clone, PartialEq)]
pub enum ServoForce {
    /// A force [N].
    Force(Spanned<TimeFunction>),
    /// A pressure.
    Pressure {
        /// The pressure [Pa].
        pressure: Spanned<TimeFunction>,
        /// What it acts on.
        area: ServoArea,
    },
}

/// Area that the pressure of a servo acts on.
#[derive(Debug, Clone, PartialEq)]
pub enum ServoArea {
    /// This one [m²], > 0.
    Given(f64),
    /// That between two pairs of opposite rigid planes.
    Between(Box<[Spanned<String>; 4]>),
}

impl Servo {
    /// Its force or pressure over time.
    pub fn function(&self) -> &Spanned<TimeFunction> {
        match &self.force {
            ServoForce::Force(function) | ServoForce::Pressure { pressure: function, .. } => function,
        }
    }
}

impl RigidBody {
    /// Whether it has walls, and no inside that solids could meet from outside: facets, a container, or a cylinder without lids.
    pub fn has_walls(&self) -> bool {
        let open = matches!(
            self.shape,
            RigidShape::Group { .. } | RigidShape::Stl { .. } | RigidShape::Cylinder { open: true, .. }
        );
        self.inside || open
    }

    /// Its functions of time.
    pub fn functions(&self) -> impl Iterator<Item = &Spanned<TimeFunction>> {
        let components = self.velocity.iter().chain(&self.spin).chain(&self.force).flatten();
        components.chain(self.servo.iter().map(Servo::function))
    }
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
        /// Whether it is a wall without lids, felt from both sides.
        open: bool,
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
