//! Bodies as contact knows them, and pairs of them whose contact has coefficients of its own.

use std::collections::BTreeMap;

use fractum_contact::law::ContactParameters;

/// A body as contact knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactBody {
    /// A solid body, with its nodes, facets and discrete elements.
    Solid(usize),
    /// A rigid body.
    Rigid(usize),
    /// A bonded or loose body.
    Particles(usize),
}

/// Coefficients of contact of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// Friction and damping.
    pub surface: ContactParameters,
    /// Work of adhesion W ≥ 0 [J/m²]; none where it follows from those of both bodies.
    pub work_of_adhesion: Option<f64>,
}

/// Pairs of bodies with coefficients of their own. Those of all others follow from both bodies, by [`ContactParameters::against`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactPairs(BTreeMap<[ContactBody; 2], PairContact>);

impl ContactPairs {
    /// Gives two bodies, or a body with itself, coefficients of their own.
    pub fn set(&mut self, bodies: [ContactBody; 2], contact: PairContact) {
        self.0.insert(ascending(bodies), contact);
    }

    /// The coefficients of two bodies, where they have their own.
    pub fn get(&self, bodies: [ContactBody; 2]) -> Option<&PairContact> {
        self.0.get(&ascending(bodies))
    }

    /// Friction and damping of two bodies.
    pub(crate) fn surface(
        &self,
        bodies: [ContactBody; 2],
        [first, second]: [ContactParameters; 2],
    ) -> ContactParameters {
        self.get(bodies).map_or_else(|| first.against(second), |own| own.surface)
    }

    /// Largest damping ratio of a pair; 0 without pairs.
    pub(crate) fn damping_ratio(&self) -> f64 {
        self.0.values().map(|own| own.surface.damping_ratio).fold(0.0, f64::max)
    }
}

fn ascending(mut bodies: [ContactBody; 2]) -> [ContactBody; 2] {
    bodies.sort_unstable();
    bodies
}
