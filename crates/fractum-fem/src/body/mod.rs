pub(crate) mod depth;
pub(crate) mod edges;
pub(crate) mod elasticity;
pub(crate) mod rate;

use std::sync::Arc;

use fractum_kernels::damage::{Beds, Restraint, Softens};
use fractum_kernels::material::{Bedding, CriterionKind, DamageLaw, Elastic, Hooke, Plane};
use fractum_math::{Mat3, Sym3, Vec3};
use serde::{Deserialize, Serialize};

pub use self::depth::{Depth, facet_area};
use self::rate::RateCurves;

/// Kind of all elements of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ElementKind {
    /// Four-node tetrahedra.
    T4,
    /// Three-node triangles in the xy-plane (the fourth entry of an element repeats the third).
    T3,
}

impl ElementKind {
    /// Nodes of an element.
    pub fn node_count(self) -> usize {
        match self {
            ElementKind::T4 => 4,
            ElementKind::T3 => 3,
        }
    }

    /// Edges of an element.
    pub fn edge_count(self) -> usize {
        match self {
            ElementKind::T4 => 6,
            ElementKind::T3 => 3,
        }
    }
}

/// Where strain, stress and damage live.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Formulation {
    /// On the elements: the plain constant-strain element.
    Standard,
    /// On the edges: the strain of an edge is the volume-weighted mean over the elements that share it.
    Smoothed,
}

/// Measure of strain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kinematics {
    /// Linear strain, for rotations well below 0.1 rad.
    Small,
    /// Stretch U - 1 after the polar decomposition F = R U of each cell: any rotation, small stretch.
    Corotational,
    /// Small until a part of the body turns in motion, corotational from then on; see [`crate::Solid::let_turn`].
    Auto,
}

/// Which edges of a body may be damaged.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// All of them.
    Everywhere,
    /// Those marked, by edge in the order of [`Body::edge_midpoints`].
    Edges(Vec<bool>),
}

/// Damage regularised by a cohesive phase field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regularisation {
    /// Length b [m]: a crack is a band of width π b; none is twice the size of the elements where cracks are expected.
    pub length: Option<f64>,
}

/// Damage of a body: the law, and what varies over the body.
#[derive(Clone, Debug, PartialEq)]
pub struct DamageZone {
    /// The law.
    pub law: DamageLaw,
    /// Where damage may occur.
    pub region: Region,
    /// Factor on the tensile strength of each edge, in the order of [`Body::edge_midpoints`]; empty means 1.
    pub strength_factor: Vec<f64>,
    /// A further factor that each edge has by chance; empty means 1. What it adds is cut where the edge is too long for it.
    pub strength_by_chance: Vec<f64>,
    /// Lower the strength of edges too long for their fracture energy, instead of refusing the body.
    pub reduce_strength_to_fit: bool,
    /// Damage as a phase field instead of edge by edge.
    pub regularisation: Option<Regularisation>,
    /// How strength and fracture energy grow with the rate of strain.
    pub rate: Option<Arc<RateCurves>>,
}

/// A group of elements with one material and one formulation; the input of [`crate::Solid::new`].
#[derive(Clone, Debug)]
pub struct Body {
    /// The user's name for it.
    pub name: String,
    /// Shape of its elements.
    pub shape: ElementKind,
    /// Node indices of its elements, positively oriented.
    pub elements: Arc<Vec<[u32; 4]>>,
    /// Elasticity; of bedded rock within the beds.
    pub elastic: Elastic,
    /// Beds.
    pub bedding: Option<Bedding>,
    /// Where strain and stress live.
    pub formulation: Formulation,
    /// Measure of strain.
    pub kinematics: Kinematics,
    /// State across the thickness, or whether it is turned about the y axis (T3 only).
    pub plane: Plane,
    /// Thickness [m] (T3 only, not of an axisymmetric body).
    pub thickness: f64,
    /// Damage, or none for an elastic body.
    pub damage: Option<DamageZone>,
}

impl Body {
    /// An elastic body of plain elements with small strains.
    pub fn new(name: &str, shape: ElementKind, elements: Vec<[u32; 4]>, elastic: Elastic) -> Self {
        Body {
            name: name.to_owned(),
            shape,
            elements: Arc::new(elements),
            elastic,
            bedding: None,
            formulation: Formulation::Standard,
            kinematics: Kinematics::Small,
            plane: Plane::Strain,
            thickness: 1.0,
            damage: None,
        }
    }

    /// The same body in the smoothed formulation.
    pub fn smoothed(self) -> Self {
        Body { formulation: Formulation::Smoothed, ..self }
    }

    /// The same body with damage everywhere by `law`.
    pub fn with_damage(self, law: DamageLaw) -> Self {
        let zone = DamageZone {
            law,
            region: Region::Everywhere,
            strength_factor: Vec::new(),
            strength_by_chance: Vec::new(),
            reduce_strength_to_fit: false,
            regularisation: None,
            rate: None,
        };
        Body { damage: Some(zone), ..self }
    }

    /// What it assumes across its thickness; nothing in space and around an axis.
    fn across(&self) -> Option<Plane> {
        (self.shape == ElementKind::T3 && self.plane != Plane::Axisymmetric).then_some(self.plane)
    }

    /// Whether it is turned about the y axis.
    pub fn is_axisymmetric(&self) -> bool {
        self.depth() == Some(Depth::Turn)
    }

    /// Its elastic law without beds.
    pub(crate) fn hooke(&self) -> Hooke {
        Hooke::new(&self.elastic, self.across())
    }

    /// What neighbours that hold a crack sideways add to the stress that it sees.
    pub(crate) fn restraint(&self) -> Restraint {
        let is_spread = self.damage.as_ref().is_some_and(|zone| zone.regularisation.is_some());
        Restraint::new(&self.elastic, self.across(), is_spread)
    }

    /// Modulus that turns the effective stress of an edge into the opening of its crack, E' [Pa].
    pub(crate) fn opening_modulus(&self) -> f64 {
        self.restraint().modulus
    }

    /// What its edges share, where it may be damaged.
    pub(crate) fn softens(&self) -> Option<Softens> {
        let zone = self.damage.as_ref()?;
        let softens = Softens::new(&zone.law, self.hooke(), self.restraint());
        let Some(bedding) = &self.bedding else { return Some(softens) };
        let beds = Beds::new(&self.elastic, bedding, self.across(), &zone.law, softens.restraint.modulus);
        Some(softens.bedded(beds))
    }

    /// What a body with beds that may be damaged must not have, and what would do.
    pub(crate) fn against_beds(&self) -> Option<[&'static str; 2]> {
        let zone = self.damage.as_ref().filter(|_| self.bedding.is_some())?;
        let law = &zone.law;
        let against = [
            (self.formulation == Formulation::Standard, ["the standard formulation", "the smoothed formulation"]),
            (zone.regularisation.is_some(), ["a phase field", "local damage"]),
            (law.criterion.kind() == CriterionKind::Mazars, ["Mazars' criterion", "another criterion"]),
            (law.unilateral, ["cracks that close", "unilateral = false"]),
            (law.friction.is_some(), ["friction of cracks", "no friction"]),
            (law.rate_time > 0.0, ["rate_time", "no rate_time"]),
            (zone.rate.is_some(), ["strength by the rate of strain", "no rate"]),
        ];
        against.into_iter().find_map(|(has, words)| has.then_some(words))
    }

    /// Smallest extent along its principal axes, of a plane body in its plane [m].
    ///
    /// - `nodes`: places of all nodes [m]
    pub fn smallest_extent(&self, nodes: &[Vec3]) -> f64 {
        let corners = || self.elements.iter().flat_map(|e| &e[..self.shape.node_count()]).map(|&n| nodes[n as usize]);
        let count = corners().count() as f64;
        let centre = corners().sum::<Vec3>() / count;
        let spread: Mat3 = corners().map(|p| (p - centre) * (p - centre).transpose()).sum();
        let (_, axes) = Sym3::symmetric_part(&spread).eigen();
        let extent = |axis: usize| {
            let along = corners().map(|p| p.dot(&axes.column(axis)));
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            high - low
        };
        let mut extents = [0, 1, 2].map(extent);
        extents.sort_by(f64::total_cmp);
        if self.shape == ElementKind::T3 { extents[1] } else { extents[0] }
    }

    /// How far it extends across its plane; nothing in space.
    pub fn depth(&self) -> Option<Depth> {
        let of_plane = if self.plane == Plane::Axisymmetric { Depth::Turn } else { Depth::Thickness(self.thickness) };
        (self.shape == ElementKind::T3).then_some(of_plane)
    }

    /// What makes a volume of the measure of an element with these corners: its depth [m], 1 for tetrahedra.
    pub(crate) fn depth_of(&self, corners: &[Vec3; 4]) -> f64 {
        let middle = || (corners[0] + corners[1] + corners[2]) / 3.0;
        self.depth().map_or(1.0, |depth| depth.at(&middle()))
    }
}
