//! A scene while its probes are made.

use std::fmt;

use fractum_fem::{ElementKind, Solid};
use fractum_math::Vec3;
use fractum_scene::{
    Along, Bonded, BondedBody, ContactBody, InsideCracks, Population, Probe, ProbedScene, RigidBody, Supports,
};

use crate::selection::Selection;
use crate::{Field, Place, Spanned};

/// What the names of a case stand for in the scene that is made of it. What is wrong is noted.
pub(crate) trait Names {
    /// Nodes that are meant.
    fn nodes(&mut self, on: &Selection) -> Vec<u32>;

    /// Particles that are meant; nothing where no set of particles is named.
    fn particles(&mut self, on: &Selection) -> Option<Vec<u32>>;

    /// Bodies and elements that are meant, by their middles.
    fn elements(&mut self, on: &Selection) -> Vec<(usize, u32)>;

    /// Bodies and elements of a group; of all bodies without one.
    fn elements_of(&mut self, group: Option<&Spanned<String>>) -> Vec<(usize, u32)>;

    /// Facets that are meant.
    fn facets(&mut self, on: &Selection) -> Vec<[u32; 3]>;

    /// Number of a rigid body.
    fn rigid_body(&self, name: &str) -> Option<usize>;

    /// A body as contact knows it.
    fn contact_body(&self, name: &str) -> Option<ContactBody>;

    /// Number of the hole of this group.
    fn hole(&self, group: &str) -> Option<usize>;

    /// Number of natural vibrations that are looked for.
    fn vibrations(&self) -> usize;

    /// Whether the case is one of several stages.
    fn is_stage(&self) -> bool;

    /// Whether the case has interfaces, which part elements that are not damaged.
    fn has_interfaces(&self) -> bool;

    /// The place of what has none of its own.
    fn whole_case(&self) -> Place;

    /// Notes a mistake.
    fn error(&mut self, place: &Place, found: String, expected: &str);
}

/// A scene while its probes are made, and the names of its case.
pub(crate) struct Scenery<'a> {
    pub(crate) solid: &'a Solid,
    pub(crate) bonded: &'a Bonded,
    /// Those of solids.
    pub(crate) supports: &'a Supports,
    pub(crate) names: &'a mut dyn Names,
}

/// Part of a direction in a plane that is rounding.
const ACROSS: f64 = 1e-9;

/// A vector of a rigid body, after a step of this size [s].
pub(super) type OfRigid = fn(&RigidBody, f64) -> Vec3;

/// A number of a rigid body, after a step of this size [s].
struct OfRigidBody<F> {
    rigid_body: usize,
    value: F,
}

impl<F> fmt::Debug for OfRigidBody<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "OfRigidBody({})", self.rigid_body)
    }
}

impl<F: Fn(&RigidBody, f64) -> f64 + Send + Sync> Probe for OfRigidBody<F> {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let rigid_body = &probed.scene.contacts.rigid_bodies()[self.rigid_body];
        (self.value)(rigid_body, probed.scene.clock.dt_before)
    }
}

impl Scenery<'_> {
    /// Notes a mistake at a selection.
    pub(super) fn error_at(&mut self, on: &Selection, found: String, expected: &str) {
        let place = on.place().cloned().unwrap_or_else(|| self.names.whole_case());
        self.names.error(&place, found, expected);
    }

    /// Particles where a set of them is named, else nodes.
    pub(super) fn points(&mut self, on: &Selection) -> (Population, Vec<u32>) {
        match self.names.particles(on) {
            Some(particles) => (Population::Particles, particles),
            None => (Population::Nodes, self.names.nodes(on)),
        }
    }

    /// Notes a direction in which nothing moves: that across the plane of 2D solids.
    pub(super) fn check_direction(&mut self, on: &Selection, population: Population, along: Along) {
        let Along::Direction(direction) = along else { return };
        let mut bodies = (0..self.solid.body_count()).map(|body| self.solid.body(body).shape);
        let plane = population == Population::Nodes && bodies.all(|shape| shape == ElementKind::T3);
        if plane && direction.xy().norm() < ACROSS {
            let found = ": 2D solids lie in the xy-plane and do not move along z".to_owned();
            self.error_at(on, found, "a direction in the plane");
        }
    }

    /// The probe of the rigid body that is named, if one is; notes what it has not.
    ///
    /// - `value`: of the body, whose component along the direction is measured
    pub(super) fn rigid_body(
        &mut self,
        on: &Selection,
        along: Along,
        value: OfRigid,
    ) -> Option<Option<Box<dyn Probe>>> {
        self.names.rigid_body(on.group_name())?;
        let Along::Direction(direction) = along else {
            self.error_at(on, format!("= \"{}\": a rigid body", on.label()), "a direction with it, such as \"x\"");
            return Some(None);
        };
        self.number_of_rigid(on, move |body, dt| value(body, dt).dot(&direction))
    }

    /// The same for a number of it.
    pub(super) fn number_of_rigid(
        &mut self,
        on: &Selection,
        value: impl Fn(&RigidBody, f64) -> f64 + Send + Sync + 'static,
    ) -> Option<Option<Box<dyn Probe>>> {
        let rigid_body = self.names.rigid_body(on.group_name())?;
        if let Some(within) = &on.within {
            let found = "has no effect on a rigid body".to_owned();
            self.names.error(&within.place, found, "nodes or particles; remove the key");
        }
        Some(Some(Box::new(OfRigidBody { rigid_body, value })))
    }

    /// Where supports hold these nodes; an error where they do not, or not along the direction. Another stage may hold
    /// them, and a selection without any node has its own error.
    pub(super) fn held_places(&mut self, on: &Selection, nodes: &[u32], along: Option<&Along>) -> Vec<(u32, u32, u32)> {
        let places = self.supports.places(nodes);
        let (is_held, how) = match along {
            Some(along) => (is_held(&places, along), " along the direction of the probe"),
            None => (!places.is_empty(), ""),
        };
        let is_fine = is_held || nodes.is_empty() || self.names.is_stage();
        if let (false, Some(place)) = (is_fine, on.place()) {
            let found = format!("= \"{}\": nothing holds it{how}", on.label());
            self.names.error(place, found, "nodes that a support prescribes");
        }
        places
    }

    /// An error for an axis about which nothing turns in the plane.
    pub(super) fn refuse_out_of_plane(&mut self, on: &Selection, axis: &Vec3) {
        if let (true, Some(place)) = (self.solid.is_plane() && axis.z == 0.0, on.place()) {
            let found = format!("= \"{}\": plane bodies turn about z alone", on.label());
            self.names.error(place, found, "an axis along \"z\"");
        }
    }

    /// What counts of cracks where a condition holds; an error if nothing does.
    pub(super) fn inside_cracks(&mut self, within: Option<&Spanned<Field>>) -> Option<InsideCracks> {
        let within = within?;
        let inside = InsideCracks {
            edges: edges_within(self.solid, &within.value),
            bonds: bonds_within(self.bonded, &within.value),
            elements: elements_within(self.solid, &within.value, self.names.has_interfaces()),
        };
        let of_interfaces = inside.elements.iter().filter(|_| self.names.has_interfaces());
        if inside.edges.iter().chain(&inside.bonds).chain(of_interfaces).flatten().all(|inside| !inside) {
            let found = ": no edge of a body that may be damaged and no bond that may break fulfils the condition";
            self.names.error(&within.place, found.to_owned(), "a condition that holds where a crack is expected");
        }
        Some(inside)
    }
}

/// Whether a support holds one of these degrees of freedom along a component.
pub(super) fn is_held(places: &[(u32, u32, u32)], along: &Along) -> bool {
    places.iter().any(|&(_, _, axis)| match along {
        Along::Direction(direction) => direction[axis as usize] != 0.0,
        Along::Radial(_) | Along::Tangential(_) => true,
    })
}

/// Which edges of bodies that may be damaged fulfil a condition at their middles, body by body.
fn edges_within(solid: &Solid, condition: &Field) -> Vec<Vec<bool>> {
    let body = |index: usize| {
        let body = solid.body(index);
        let middles = if body.damage.is_some() { body.edge_midpoints(&solid.reference) } else { Vec::new() };
        middles.into_iter().map(|p| condition.holds_at(p)).collect()
    };
    (0..solid.body_count()).map(body).collect()
}

/// Which elements of bodies that may be damaged, or of all, fulfil a condition at their middles, body by body.
fn elements_within(solid: &Solid, condition: &Field, of_all: bool) -> Vec<Vec<bool>> {
    let body = |index: usize| {
        let counts = of_all || solid.body(index).damage.is_some();
        let elements = 0..if counts { solid.body(index).elements.len() as u32 } else { 0 };
        elements.map(|element| condition.holds_at(solid.element_middle(index, element))).collect()
    };
    (0..solid.body_count()).map(body).collect()
}

/// Which bonds of bodies that may break fulfil a condition at their middles, body by body.
fn bonds_within(bonded: &Bonded, condition: &Field) -> Vec<Vec<bool>> {
    let place = bonded.reference();
    let body = |body: &BondedBody| {
        let holds = |bond: usize| {
            let [from, to] = body.bonds.ends(bond, place);
            condition.holds_at((from + to) * 0.5)
        };
        if body.can_break() { (0..body.bonds.len()).map(holds).collect() } else { Vec::new() }
    };
    bonded.bodies().iter().map(body).collect()
}
