//! Joints and grains that are cut into the mesh.

use fractum_mesh::{Disc, Grains, JointSet};

use crate::{Field, Place, Spanned};

/// What is cut into a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Network {
    /// Joints, in the order of the file.
    pub joints: Vec<Joints>,
    /// Grains.
    pub grains: Option<GrainsWithin>,
}

impl Network {
    /// Whether nothing is cut.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty() && self.grains.is_none()
    }
}

/// Joints of one table or set.
#[derive(Debug, Clone, PartialEq)]
pub struct Joints {
    /// Their mesh group.
    pub name: String,
    /// Where they stand in the case.
    pub place: Place,
    /// Groups of elements that they lie in; all where it is empty.
    pub within: Vec<Spanned<String>>,
    /// Where they lie; everywhere in those groups where it is absent.
    pub condition: Option<Spanned<Field>>,
    /// Which they are.
    pub source: JointSource,
}

/// Where joints come from.
#[derive(Debug, Clone, PartialEq)]
pub enum JointSource {
    /// A set.
    Set(JointSet),
    /// Traces with the place of each.
    Traces(Vec<([[f64; 2]; 2], Place)>),
    /// Discs with the place of each.
    Discs(Vec<(Disc, Place)>),
}

/// Grains and what they divide.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainsWithin {
    /// Where they stand in the case.
    pub place: Place,
    /// Groups of elements that they divide; all where it is empty.
    pub within: Vec<Spanned<String>>,
    /// The grains.
    pub grains: Grains,
}
