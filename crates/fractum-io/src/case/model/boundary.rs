//! Supports and loads.

use crate::case::{Spanned, TimeFunction};

/// Prescribed motion of the nodes of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name, where given.
    pub name: Option<Spanned<String>>,
    /// Mesh group of its nodes, or set of particles.
    pub group: Spanned<String>,
    /// Bit a is set where the particles of a bonded body do not turn about axis a.
    pub fix_rotation: Option<Spanned<u8>>,
    /// Motion along x, y, z; `None` leaves the axis free. At least one is prescribed, or a rotation.
    pub motion: [Option<Spanned<Motion>>; 3],
}

/// Motion along one axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// At rest.
    Fixed,
    /// Velocity [m/s].
    Velocity(TimeFunction),
    /// Displacement from the initial position [m].
    Displacement(TimeFunction),
}

/// A force on the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Name, where given.
    pub name: Option<Spanned<String>>,
    /// What acts.
    pub kind: LoadKind,
}

/// Components along x, y, z; `None` = zero.
pub type Components = [Option<Spanned<TimeFunction>>; 3];

/// Kinds of loads.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadKind {
    /// Total force over the group [N].
    Force {
        /// Mesh group it is shared over.
        group: Spanned<String>,
        /// Components [N].
        force: Components,
    },
    /// Force per area of fixed direction over the facets of the group [Pa].
    Traction {
        /// Mesh group of facets.
        group: Spanned<String>,
        /// Components [Pa].
        traction: Components,
    },
    /// Pressure that follows the facets of the group [Pa]; positive pushes into the solid.
    Pressure {
        /// Mesh group of facets.
        group: Spanned<String>,
        /// Pressure [Pa].
        pressure: Spanned<TimeFunction>,
    },
    /// Acceleration of the whole scene [m/s²].
    Gravity {
        /// Components [m/s²].
        acceleration: Components,
    },
}
