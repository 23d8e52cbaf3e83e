//! What a probe is: a number that a scene yields at every instant.

use std::cell::OnceCell;
use std::fmt;

use fractum_fem::{CrackEdge, Fracture, Separation, cracks, fields};
use fractum_math::{Sym3, Vec3};

use crate::contacts::ContactProbe;
use crate::fragment::Fragment;
use crate::measure::counts::{CountKind, Counts};
use crate::scene::Scene;

/// A number that a scene yields at every instant.
pub trait Probe: fmt::Debug + Send + Sync {
    /// Value at the last step that was measured.
    fn value(&self, probed: &ProbedScene<'_>) -> f64;

    /// What the value is found from, for ranks that advance a scene together; by default what all of them have.
    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::default()
    }

    /// Whether the value follows from which elements and bonds are gone, and from nothing else that changes.
    fn is_of_separation(&self) -> bool {
        false
    }

    /// The force of contact that it is, which the scene must [watch](crate::Contacts::watch).
    fn contact(&self) -> Option<ContactProbe> {
        None
    }
}

/// What of a scene a probe looks at, for ranks that advance it together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProbeNeeds {
    /// Nodes whose motion it looks at.
    pub nodes: NeededPoints,
    /// Particles whose motion it looks at.
    pub particles: NeededPoints,
    /// Whether it looks at what supports do at these points, which is known where they are moved alone.
    pub of_supports: bool,
    /// Whether it looks at the damage of edges.
    pub damage: bool,
    /// Whether it looks at contacts among particles.
    pub contacts: bool,
    /// Bonds (body, bond) whose memory it looks at.
    pub bonds: Vec<(u32, u32)>,
}

impl ProbeNeeds {
    /// All points, and the damage of edges as well where it says so.
    pub fn of_all(damage: bool) -> Self {
        ProbeNeeds { nodes: NeededPoints::Any, particles: NeededPoints::Any, damage, ..ProbeNeeds::default() }
    }

    /// The damage of edges.
    pub fn of_damage() -> Self {
        ProbeNeeds { damage: true, ..ProbeNeeds::default() }
    }
}

/// Points that a probe looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NeededPoints {
    /// These.
    Some(Vec<u32>),
    /// Any of them.
    Any,
}

impl Default for NeededPoints {
    fn default() -> Self {
        NeededPoints::Some(Vec::new())
    }
}

/// A scene at one instant, with what several probes need of it.
pub struct ProbedScene<'a> {
    /// The scene.
    pub scene: &'a Scene,
    fragments: OnceCell<Vec<Fragment>>,
    separation: OnceCell<Separation>,
    crack_edges: OnceCell<Vec<CrackEdge>>,
    counts: Counts,
    fracture: OnceCell<Fracture>,
    /// Displacement of the nodes at the instant of the last step, to which damage and reactions belong [m].
    earlier: OnceCell<Vec<Vec3>>,
    /// Stress of all elements, body by body.
    stresses: Vec<OnceCell<Vec<Sym3>>>,
}

impl<'a> ProbedScene<'a> {
    /// Before the first probe.
    pub fn new(scene: &'a Scene) -> Self {
        Self::with_counts(scene, scene.counts())
    }

    /// The same where [`Scene::counts`] are known.
    pub fn with_counts(scene: &'a Scene, counts: Counts) -> Self {
        ProbedScene {
            scene,
            fragments: OnceCell::new(),
            separation: OnceCell::new(),
            crack_edges: OnceCell::new(),
            counts,
            fracture: OnceCell::new(),
            earlier: OnceCell::new(),
            stresses: vec![OnceCell::new(); scene.solid.body_count()],
        }
    }

    /// [`Scene::fragments`], found once.
    pub fn fragments(&self) -> &[Fragment] {
        self.fragments.get_or_init(|| self.scene.fragments())
    }

    /// [`fractum_fem::Solid::fracture`], found once.
    pub fn fracture(&self) -> &Fracture {
        self.fracture.get_or_init(|| cracks::fracture(&self.scene.solid))
    }

    /// Stress of an element at the instant of the last step [Pa]; of all elements of its body at once where a probe has many of them.
    pub fn stress(&self, body: usize, element: u32, has_many: bool) -> Sym3 {
        let solid = &self.scene.solid;
        let earlier = self.earlier.get_or_init(|| fields::displacements_before(solid, self.scene.clock.dt_before));
        if !has_many {
            return fields::element_field(solid, body, element, Some(earlier)).0;
        }
        let all = || fields::element_fields(solid, body, Some(earlier)).into_iter().map(|(stress, _)| stress).collect();
        self.stresses[body].get_or_init(all)[element as usize]
    }

    /// [`fractum_fem::Solid::crack_edges`], found once.
    pub fn crack_edges(&self) -> &[CrackEdge] {
        self.crack_edges.get_or_init(|| cracks::crack_edges(&self.scene.solid))
    }

    /// What has separated, found once.
    pub fn separation(&self) -> &Separation {
        self.separation.get_or_init(|| Separation::of(&self.scene.solid))
    }

    /// A count.
    pub fn count(&self, kind: CountKind) -> usize {
        match kind {
            CountKind::Fragments => self.fragments().len(),
            CountKind::BrokenEdges => self.fracture().broken_edges,
            CountKind::DamagedEdges => self.fracture().damaged_edges,
            kind => self.counts.of(kind),
        }
    }
}
