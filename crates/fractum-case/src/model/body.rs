//! Bodies: meshed solids, bonded and loose particles, rigid bodies.

use fractum_fem::{Formulation, Kinematics, Plane};
use fractum_scene::ContactParameters;

#[cfg(doc)]
use super::Case;
use super::{BondedBody, LooseBody, Material, RigidBody};
use crate::choice::choice;
use crate::{Field, Spanned};

/// A body of the case.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name, unique among bodies.
    pub name: Spanned<String>,
    /// What it is made of.
    pub kind: BodyKind,
}

/// Kinds of bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyKind {
    /// Finite elements of a mesh group.
    Solid(SolidBody),
    /// Particles joined by beams.
    Bonded(BondedBody),
    /// Loose particles.
    Particles(LooseBody),
    /// A rigid body.
    Rigid(Box<RigidBody>),
}

impl BodyKind {
    /// Index into `Case::materials`; none of a rigid body that has no material.
    pub fn material(&self) -> Option<usize> {
        match self {
            BodyKind::Solid(own) => Some(own.material),
            BodyKind::Bonded(own) => Some(own.material),
            BodyKind::Particles(own) => Some(own.material),
            BodyKind::Rigid(own) => own.material,
        }
    }

    /// Friction and damping of its surface. Every contact of a case takes them from here, or from a
    /// [pair](Case::contact_between): of solids and the discrete elements that they leave, of particles, of the faces of cracks, and of rigid bodies.
    pub fn surface(&self, materials: &[Material]) -> ContactParameters {
        match self {
            BodyKind::Solid(own) => own.surface(materials),
            BodyKind::Bonded(own) => materials[own.material].contact,
            BodyKind::Particles(own) => materials[own.material].contact,
            BodyKind::Rigid(own) => own.contact,
        }
    }
}

/// Finite elements with one material.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidBody {
    /// Mesh group of its elements.
    pub group: Spanned<String>,
    /// Index into `Case::materials`.
    pub material: usize,
    /// Element formulation; `smoothed` where damage is on and nothing was said, else `standard`.
    pub formulation: Formulation,
    /// Small or large rotations.
    pub kinematics: Kinematics,
    /// Plane state or axial symmetry, for two-dimensional meshes only (`None` there = plane strain); the place is there to refuse it in
    /// 3D.
    pub plane: Option<Spanned<Plane>>,
    /// Thickness [m], > 0, for two-dimensional meshes only (`None` there = 1 m); the place is there to refuse it in 3D.
    pub thickness: Option<Spanned<f64>>,
    /// The thickness, or what stands for it where none is given [m].
    pub depth: f64,
    /// Initial velocity [m/s] along x, y, z; `None` = at rest.
    pub initial_velocity: [Option<Spanned<Field>>; 3],
    /// Whether damage may occur at all: the material has it, and the body does not switch it off.
    pub damage: bool,
    /// Where damage may occur (a condition on the position); `None` = everywhere.
    pub damage_where: Option<Spanned<Field>>,
    /// Factor on the tensile strength [-]; must be checked to be > 0 where it is used. `None` = 1.
    pub strength_factor: Option<Spanned<Field>>,
}

impl SolidBody {
    /// As [`BodyKind::surface`].
    pub fn surface(&self, materials: &[Material]) -> ContactParameters {
        materials[self.material].contact
    }

    /// Whether it is turned about the y axis.
    pub fn is_axisymmetric(&self) -> bool {
        self.plane.as_ref().is_some_and(|plane| plane.value == Plane::Axisymmetric)
    }

    /// Whether each of several processes needs the cells of all: edges of plain elements gather stresses around them.
    pub fn needs_all_cells(&self) -> bool {
        self.damage && self.formulation == Formulation::Standard
    }

    /// Whether strain and stress live on edges.
    pub fn is_smoothed(&self) -> bool {
        self.formulation == Formulation::Smoothed
    }
}

choice!(Formulation { "smoothed" => Smoothed, "standard" => Standard });
choice!(Kinematics { "auto" => Auto, "small" => Small, "corotational" => Corotational });
choice!(Plane { "strain" => Strain, "stress" => Stress, "axisymmetric" => Axisymmetric });
