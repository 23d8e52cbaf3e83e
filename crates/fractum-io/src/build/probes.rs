//! Probes on the groups of the mesh.

use fractum_dem::crack_shape::Axis;
use fractum_fem::Solid;
use fractum_scene::{
    Along, Bonded, BondedBody, ContactBody, ContactProbe, InsideCracks, PointProbe, Population, Probe, Supports,
    SurfaceMeasure,
};

use super::Context;
use super::bodies::{Numbering, Part};
use super::conditions::Surface;
use super::gas::open_end;
use super::use_in_words;
use crate::case::model::{GroupUse, ProbeKind, Selection};
use crate::case::{Field, Spanned};

impl Context<'_> {
    /// The measured probes of the case; none for expressions.
    pub(super) fn probes(
        &mut self,
        parts: &[Part],
        numbering: &Numbering,
        surface: &Surface,
        solid: &Solid,
        supports: &Supports,
        bonded: &Bonded,
    ) -> Vec<Option<Probe>> {
        let case = self.case;
        let mut measured = |kind| match self.particle_probe(kind, bonded).or_else(|| self.rigid_body_probe(kind)) {
            Some(probe) => Some(probe),
            None => self.probe(kind, parts, numbering, surface, solid, supports, bonded),
        };
        case.probes.iter().map(|probe| measured(&probe.kind)).collect()
    }

    fn probe(
        &mut self,
        kind: &ProbeKind,
        parts: &[Part],
        numbering: &Numbering,
        surface: &Surface,
        solid: &Solid,
        supports: &Supports,
        bonded: &Bonded,
    ) -> Option<Probe> {
        Some(match kind {
            ProbeKind::Reaction { on, along } => {
                let places = supports.places(&self.selected_nodes(on, numbering));
                // Another stage may hold it.
                let along_held = !self.case.source.stage.is_empty() || is_held(&places, along);
                if let (false, Some(place)) = (along_held, on.place()) {
                    let found = format!("= \"{}\": nothing holds it along the direction of the probe", on.label());
                    self.error(&place.clone(), found, "nodes that a support prescribes");
                }
                on_nodes(PointProbe::Reaction { places, along: *along })
            }
            ProbeKind::Displacement { on, along } => {
                on_nodes(PointProbe::Displacement { points: self.selected_nodes(on, numbering), along: *along })
            }
            ProbeKind::Velocity { on, along } => {
                on_nodes(PointProbe::Velocity { points: self.selected_nodes(on, numbering), along: *along })
            }
            ProbeKind::Rotation { on, .. } => {
                let place = on.place().cloned().unwrap_or_else(|| self.whole_case());
                self.error(&place, format!("= \"{}\"", on.label()), "a set of particles of a bonded body");
                return None;
            }
            ProbeKind::Stress { group, between } => {
                let elements = self.elements_of(group, parts);
                Probe::Stress { elements, between: *between }
            }
            ProbeKind::ContactForce { on, from, along } => {
                let body = |name: &str| self.contact_body(name, solid, bonded);
                Probe::ContactForce(ContactProbe { on: body(&on.value)?, from: body(&from.value)?, along: *along })
            }
            ProbeKind::Load { on, along } => Probe::Load { points: self.selected_nodes(on, numbering), along: *along },
            ProbeKind::Surface { on, measure } => {
                Probe::Surface { facets: self.measured_facets(on, *measure, numbering, surface), measure: *measure }
            }
            ProbeKind::Fragment { on, measure, along } => {
                Probe::Fragment { points: self.selected_nodes(on, numbering), measure: *measure, along: *along }
            }
            ProbeKind::FragmentSize(share) => Probe::FragmentSize(*share),
            ProbeKind::Energy(kind) => Probe::Energy(*kind),
            ProbeKind::Count(kind) => Probe::Count(*kind),
            ProbeKind::Momentum { along } => Probe::Momentum(*along),
            ProbeKind::AngularMomentum { along } => Probe::AngularMomentum(*along),
            ProbeKind::Gas { measure, group } => Probe::Gas { measure: *measure, hole: self.hole(group.as_ref()) },
            ProbeKind::CrackArea => Probe::CrackArea,
            ProbeKind::Crack { measure, along, point, within } => {
                let inside = within.as_ref().map(|within| InsideCracks {
                    edges: edges_within(solid, &within.value),
                    bonds: bonds_within(bonded, &within.value),
                });
                if let (Some(within), Some(InsideCracks { edges, bonds })) = (within, &inside)
                    && edges.iter().chain(bonds).flatten().all(|inside| !inside)
                {
                    let found =
                        ": no edge of a body that may be damaged and no bond that may break fulfils the condition";
                    self.error(&within.place, found, "a condition that holds where a crack is expected");
                }
                Probe::Crack { measure: *measure, axis: Axis { point: *point, direction: *along }, inside }
            }
            ProbeKind::Expression(_) => return None,
        })
    }

    /// Bodies and elements of a group; an error if it has none.
    fn elements_of(&mut self, group: &Spanned<String>, parts: &[Part]) -> Vec<(usize, u32)> {
        let wanted: Vec<&fractum_mesh::Group> = self.mesh.group(&group.value);
        let mut elements = Vec::new();
        for (body, part) in parts.iter().enumerate() {
            for (index, &element) in (0..).zip(&part.elements) {
                let inside = wanted.iter().any(|g| {
                    let list = if part.shape == fractum_fem::ElementKind::T4 { &g.tetrahedra } else { &g.triangles };
                    list.binary_search(&element).is_ok()
                });
                if inside {
                    elements.push((body, index));
                }
            }
        }
        if elements.is_empty() {
            let expected = use_in_words(GroupUse::ProbeElements);
            self.error(&group.place, format!("= \"{}\"", group.value), expected);
        }
        elements
    }

    /// Facets of which something is measured; an error if a volume is asked for and they do not close around one.
    fn measured_facets(
        &mut self,
        on: &Selection,
        measure: SurfaceMeasure,
        numbering: &Numbering,
        surface: &Surface,
    ) -> Vec<[u32; 3]> {
        let facets = self.selected_facets(on, numbering, surface);
        if measure == SurfaceMeasure::Volume && (facets.is_empty() || open_end(&facets).is_some()) {
            let place = on.place().cloned().unwrap_or_else(|| self.whole_case());
            self.error(&place, format!("= \"{}\" encloses no volume", on.label()), "facets that close around a cavity");
        }
        facets
    }

    /// The body of this name as contact knows it.
    fn contact_body(&self, name: &str, solid: &Solid, bonded: &Bonded) -> Option<ContactBody> {
        let rigid = self.case.tool(name).map(ContactBody::Rigid);
        let particles = || bonded.bodies().iter().position(|body| body.name == name).map(ContactBody::Particles);
        let solids = || (0..solid.body_count()).find(|&body| solid.body(body).name == name).map(ContactBody::Solid);
        rigid.or_else(particles).or_else(solids)
    }
}

impl Context<'_> {
    /// The hole of this group; an error if it is none.
    fn hole(&mut self, group: Option<&Spanned<String>>) -> Option<usize> {
        let (group, case) = (group?, self.case);
        let holes = case.gas.as_ref().map_or(&[][..], |gas| &gas.holes);
        let hole = holes.iter().position(|hole| hole.on.group_name() == group.value);
        if hole.is_none() {
            self.error(&group.place, format!("= \"{}\"", group.value), "the group of one of gas.holes");
        }
        hole
    }
}

/// Whether a support holds one of these degrees of freedom along a component.
pub(super) fn is_held(places: &[(u32, u32, u32)], along: &Along) -> bool {
    places.iter().any(|&(_, _, axis)| match along {
        Along::Direction(direction) => direction[axis as usize] != 0.0,
        Along::Radial(_) | Along::Tangential(_) => true,
    })
}

fn on_nodes(probe: PointProbe) -> Probe {
    Probe::Points { population: Population::Nodes, probe }
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

/// Which bonds of bodies that may break fulfil a condition at their middles, body by body.
fn bonds_within(bonded: &Bonded, condition: &Field) -> Vec<Vec<bool>> {
    let place = bonded.reference();
    let holds = |&[i, j]: &[u32; 2]| condition.holds_at((place[i as usize] + place[j as usize]) * 0.5);
    let body = |body: &BondedBody| {
        if body.can_break() { body.bonds.pairs().iter().map(holds).collect() } else { Vec::new() }
    };
    bonded.bodies().iter().map(body).collect()
}
