//! What a scene notices of itself where its theory ends: each kind once, with its place and instant.
//!
//! [`Scene::audit`](crate::Scene::audit) looks at the present state now and then; what a step finds by itself is noted with
//! [`Scene::note`](crate::Scene::note). A program turns what was noticed into words.

use serde::{Deserialize, Serialize};

/// The kinds of what a scene notices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Notice {
    /// A temperature below absolute zero [K].
    BelowZero,
    /// Damping of nodes and particles takes a visible share of the work, though the run is in its second half [-].
    Damping,
    /// A body of small strains turns [rad].
    Rotation,
    /// A strain that is not small [-].
    Strain,
    /// A tensile stress above the strength where the case has kept elements from damage: ratio of both [-].
    TensionOutside,
    /// A compressive stress over the tensile strength [-], by a criterion that knows tension alone.
    Compression,
    /// Particles that are pressed deeply into each other, or into a body: overlap over the smaller radius [-].
    Overlap,
    /// Rigid shapes have stopped solids that met them, and taken a visible share of the energy [-].
    Stopped,
    /// An element that had begun to break was turned inside out, and taken out.
    Crushed,
    /// Springs of contact give way beside the solids that they press on, and hold a visible share of the elastic energy [-].
    Springs,
    /// Changes of the time step, or of the strains of a body that begins to turn, have brought or taken a visible share of the energy [-].
    ChangeOfStep,
    /// Friction, damping or the fracture of interfaces have given a visible share of the energy, which they can only take [-].
    Gained,
    /// Sides of an interface have slid by a visible part of a face [-].
    InterfaceSlip,
    /// Liquid is in all places of its interfaces, and goes no further: their area [m²].
    LiquidAtEnd,
    /// More liquid was drawn than there was [m³].
    Overdrawn,
    /// Particles that are due wait, since their inlet has no free place: how many.
    InletBlocked,
}

impl Notice {
    const COUNT: usize = Notice::InletBlocked as usize + 1;
}

/// Where something was noticed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Site {
    /// In the scene as a whole.
    Scene,
    /// In an element of a solid body.
    Element {
        /// Number of the body.
        body: usize,
        /// Number of the element in its body.
        element: u32,
    },
    /// At a node.
    Node(u32),
    /// At a particle.
    Particle(u32),
    /// Between two particles.
    Particles([u32; 2]),
}

/// Something that was noticed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noticed {
    /// What it is.
    pub what: Notice,
    /// Where it is.
    pub site: Site,
    /// When it was noticed first [s].
    pub time: f64,
    /// How large it was then; its kind tells the unit.
    pub value: f64,
}

/// What a scene has noticed so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    pub(crate) first: [Option<Noticed>; Notice::COUNT],
    /// The largest overlap, whether it is worth a word or not.
    pub(crate) deepest: Option<Noticed>,
}
