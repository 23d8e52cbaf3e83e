//! Interfaces between elements.

use fractum_scene::InterfaceLaw;

use crate::{Place, Spanned, TimeFunction};

/// Inner faces of solids with a strength of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// Name, unique among interfaces.
    pub name: String,
    /// Where it stands in the case.
    pub place: Place,
    /// Which faces.
    pub along: InterfaceFaces,
    /// What it bears.
    pub law: InterfaceLaw,
    /// Stiffness across and along the face [Pa/m]; none where it is stiff until its strength is met.
    pub stiffness: Option<[f64; 2]>,
    /// Pressure of what is between its sides [Pa], and whether it acts where the strength is lost alone.
    pub pressure: Option<(Spanned<TimeFunction>, bool)>,
    /// Coefficient of heat transfer where its sides touch [W/(m² K)]; none where it resists nothing to speak of.
    pub heat_transfer: Option<Spanned<f64>>,
}

/// The faces of an interface.
#[derive(Debug, Clone, PartialEq)]
pub enum InterfaceFaces {
    /// Those of a mesh group.
    Group(Spanned<String>),
    /// Those that any two of these groups of elements have in common.
    Between(Spanned<Vec<Spanned<String>>>),
}

impl InterfaceFaces {
    /// The groups that it names.
    pub fn groups(&self) -> &[Spanned<String>] {
        match self {
            InterfaceFaces::Group(group) => std::slice::from_ref(group),
            InterfaceFaces::Between(groups) => &groups.value,
        }
    }
}
