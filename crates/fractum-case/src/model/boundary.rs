//! Supports and loads.

use fractum_math::{Sym3, Vec3};

use super::{GroupUse, Selection};
use crate::{Field, Place, Spanned, TimeFunction};

/// Prescribed motion of nodes or particles.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name, where given.
    pub name: Option<Spanned<String>>,
    /// Its nodes or particles.
    pub on: Selection,
    /// Bit a is set where the particles of a bonded body do not turn about axis a.
    pub fix_rotation: Option<Spanned<u8>>,
    /// Motion along x, y, z; `None` leaves the axis free. At least one is prescribed, or a rotation, or there is `surface`.
    pub motion: [Option<Spanned<Motion>>; 3],
    /// What answers to the motion of its facets.
    pub surface: Option<Spanned<SurfaceSupport>>,
}

/// What answers to the motion of facets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceSupport {
    /// Dashpots that let waves leave.
    Absorbing,
    /// Springs.
    Elastic {
        /// Stiffness along the normal [Pa/m], ≥ 0.
        normal: f64,
        /// Stiffness across it [Pa/m], ≥ 0.
        tangential: f64,
    },
}

/// Stress of the rock before the run.
#[derive(Debug, Clone, PartialEq)]
pub struct InSitu {
    /// Where it stands in the case.
    pub place: Place,
    /// That of the far field; with layers that of all bodies in none of them, as it is written.
    pub stress: Option<StressField>,
    /// Bodies that have a stress of their own, as it is written.
    pub layers: Vec<Layer>,
    /// Whether elastic bodies settle from the stress of layers to equilibrium before the run; else it must be in equilibrium.
    pub settles: bool,
    /// Groups of facets on which it acts, besides those of absorbing and elastic supports.
    pub groups: Vec<Spanned<String>>,
}

/// Stress of some bodies before the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Names of the bodies.
    pub bodies: Vec<Spanned<String>>,
    /// Their stress.
    pub stress: StressField,
}

/// A stress by place.
#[derive(Debug, Clone, PartialEq)]
pub struct StressField {
    /// Where it stands in the case.
    pub place: Place,
    /// Components xx, yy, zz, xy, yz, zx [Pa], tension positive; absent ones are zero.
    pub components: [Option<Spanned<Field>>; 6],
}

impl InSitu {
    /// Whether bodies have the stress as it is written, rather than what elastic bodies make of that of the far field.
    pub fn is_as_written(&self) -> bool {
        !self.layers.is_empty()
    }

    /// The stress that is asked for in a body; none where the case gives it none.
    pub fn of(&self, body: &str) -> Option<&StressField> {
        let own = self.layers.iter().find(|layer| layer.bodies.iter().any(|name| name.value == body));
        own.map(|layer| &layer.stress).or(self.stress.as_ref())
    }

    /// Whether a body has one of [`InSitu::fields`].
    pub fn is_of(&self, body: &str, field: &StressField) -> bool {
        self.of(body).is_some_and(|own| std::ptr::eq(own, field))
    }

    /// All stresses of the case.
    pub fn fields(&self) -> impl Iterator<Item = &StressField> {
        self.stress.iter().chain(self.layers.iter().map(|layer| &layer.stress))
    }
}

impl StressField {
    /// The stress at a place [Pa].
    pub fn at(&self, place: Vec3) -> Sym3 {
        let [xx, yy, zz, xy, yz, zx] =
            [0, 1, 2, 3, 4, 5].map(|i: usize| self.components[i].as_ref().map_or(0.0, |field| field.value.at(place)));
        Sym3::new(xx, yy, zz, xy, yz, zx)
    }
}

impl Support {
    /// What stands for it in messages: its name, else its group.
    pub fn label(&self) -> &str {
        self.name.as_ref().map_or_else(|| self.on.label(), |name| &name.value)
    }
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

/// How pressure enters cracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InCracks {
    /// Speed of its front [m/s], > 0; everywhere at once if absent.
    pub front_speed: Option<f64>,
}

/// Components along x, y, z; `None` = zero.
pub type Components = [Option<Spanned<TimeFunction>>; 3];

/// A front of detonation that runs along a hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detonation {
    /// Velocity of detonation [m/s], > 0.
    pub velocity: f64,
    /// Direction in which it runs: from the first node of the facets on, or from the primer both ways. In all directions if absent.
    pub along: Option<Vec3>,
    /// Where it begins [m].
    pub primer: Option<Vec3>,
}

impl Detonation {
    /// When it comes to a place after it has begun [s].
    ///
    /// - `first`: least place along its direction of what it runs through [m]
    pub fn arrival(&self, place: &Vec3, first: f64) -> f64 {
        let distance = match (self.along, self.primer) {
            (Some(along), Some(primer)) => along.dot(&(place - primer)).abs(),
            (Some(along), None) => along.dot(place) - first,
            (None, Some(primer)) => (place - primer).norm(),
            (None, None) => 0.0,
        };
        distance / self.velocity
    }

    /// Least place along its direction among these [m].
    pub fn first(&self, places: impl Iterator<Item = Vec3>) -> f64 {
        let along = self.along.unwrap_or_default();
        places.map(|place| along.dot(&place)).fold(f64::INFINITY, f64::min)
    }
}

/// Kinds of loads.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadKind {
    /// Total force over the group [N].
    Force {
        /// The nodes or particles it is shared over.
        on: Selection,
        /// Components [N].
        force: Components,
    },
    /// Force per area of fixed direction over facets [Pa].
    Traction {
        /// Facets by their group, by their nodes, or both.
        on: Selection,
        /// Components [Pa].
        traction: Components,
    },
    /// Pressure that follows facets [Pa]; positive pushes into the solid.
    Pressure {
        /// Facets by their group, by their nodes, or both.
        on: Selection,
        /// Pressure [Pa].
        pressure: Spanned<TimeFunction>,
        /// How it enters the cracks that are open to the facets; not at all if absent.
        in_cracks: Option<InCracks>,
        /// The front behind which it acts; everywhere at once if absent.
        detonation: Option<Detonation>,
    },
    /// Acceleration of the whole scene [m/s²].
    Gravity {
        /// Components [m/s²].
        acceleration: Components,
    },
}

impl LoadKind {
    /// Its key in the case.
    pub fn name(&self) -> &'static str {
        match self {
            LoadKind::Force { .. } => "force",
            LoadKind::Traction { .. } => "traction",
            LoadKind::Pressure { .. } => "pressure",
            LoadKind::Gravity { .. } => "gravity",
        }
    }

    /// What it acts on, and as what it uses a group of the mesh; none where it acts on everything.
    pub fn on(&self) -> Option<(&Selection, GroupUse)> {
        match self {
            LoadKind::Force { on, .. } => Some((on, GroupUse::Force)),
            LoadKind::Traction { on, .. } | LoadKind::Pressure { on, .. } => Some((on, GroupUse::Facets)),
            LoadKind::Gravity { .. } => None,
        }
    }

    /// The functions of time that it is made of.
    pub fn functions(&self) -> Vec<&Spanned<TimeFunction>> {
        match self {
            LoadKind::Force { force: components, .. }
            | LoadKind::Traction { traction: components, .. }
            | LoadKind::Gravity { acceleration: components } => components.iter().flatten().collect(),
            LoadKind::Pressure { pressure, .. } => vec![pressure],
        }
    }
}
