//! Probes on the groups of the mesh.

use fractum_dem::StrainMeasure;
use fractum_dem::crack_shape::Axis;
use fractum_fem::Solid;
use fractum_math::Vec3;
use fractum_scene::{
    Along, Bonded, BondedBody, ContactBody, ContactProbe, CrackMeasure, DamagedMeasure, DamagedPart, HoleEnds,
    InsideCracks, PointProbe, Population, Probe, RadialCracks, RegionStrain, Supports, SurfaceMeasure, SymmetryPlanes,
};

use super::Context;
use super::bodies::{Numbering, Part};
use super::conditions::Surface;
use super::use_in_words;
use crate::case::model::{self, GroupUse, ProbeKind, Selection};
use crate::case::{Choice, Field, Spanned};

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
        case.probes.iter().filter(|_| !solid.is_plane()).for_each(|probe| self.refuse_in_space(probe));
        let mut measured = |kind| match self.special_probe(kind, numbering, bonded, solid) {
            Some(probe) => Some(probe),
            None => self.probe(kind, parts, numbering, surface, solid, supports, bonded),
        };
        case.probes.iter().map(|probe| measured(&probe.kind)).collect()
    }

    /// A probe of particles, rigid bodies or heat; none for others.
    fn special_probe(
        &mut self,
        kind: &ProbeKind,
        numbering: &Numbering,
        bonded: &Bonded,
        solid: &Solid,
    ) -> Option<Probe> {
        let found = self.particle_probe(kind, bonded, solid).or_else(|| self.rigid_body_probe(kind));
        found.or_else(|| self.heat_probe(kind, numbering))
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
                let nodes = solid.with_copies(self.selected_nodes(on, numbering));
                let places = self.held_places(on, &nodes, supports, Some(along));
                on_nodes(PointProbe::Reaction { places, along: *along })
            }
            ProbeKind::Moment { on, about } => {
                self.refuse_out_of_plane(on, &about.direction, solid);
                let nodes = solid.with_copies(self.selected_nodes(on, numbering));
                let places = self.held_places(on, &nodes, supports, None);
                on_nodes(PointProbe::Moment { places, about: *about })
            }
            ProbeKind::Displacement { on, along } => {
                on_nodes(PointProbe::Displacement { points: self.selected_nodes(on, numbering), along: *along })
            }
            ProbeKind::Velocity { on, along } => {
                on_nodes(PointProbe::Velocity { points: self.selected_nodes(on, numbering), along: *along })
            }
            ProbeKind::Rotation { on, along } => {
                self.refuse_out_of_plane(on, along, solid);
                on_nodes(PointProbe::Rotation { points: self.selected_nodes(on, numbering), axis: *along })
            }
            ProbeKind::Stress { on, between } => {
                Probe::Stress { elements: self.selected_elements(on, parts, solid), between: *between }
            }
            ProbeKind::Strain { on, .. } | ProbeKind::Extensometer { on, .. } => {
                let nodes = self.selected_nodes(on, numbering);
                self.strain_probe(kind, (bonded, solid), Population::Nodes, &nodes)?
            }
            ProbeKind::ContactForce { on, from, along } => {
                let body = |name: &str| self.contact_body(name, solid, bonded);
                Probe::ContactForce(ContactProbe { on: body(&on.value)?, from: body(&from.value)?, along: *along })
            }
            ProbeKind::Load { on, along } => Probe::Load { points: self.selected_nodes(on, numbering), along: *along },
            ProbeKind::Surface { on, measure } => Probe::Surface {
                facets: self.measured_facets(on, *measure, numbering, surface, solid),
                measure: *measure,
            },
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
                let inside = self.inside_cracks(within.as_ref(), solid, bonded);
                Probe::Crack { measure: *measure, axis: Axis { point: *point, direction: *along }, inside }
            }
            ProbeKind::RadialCracks { measure, about, radius, within } => {
                let inside = self.inside_cracks(within.as_ref(), solid, bonded);
                Probe::RadialCracks(RadialCracks::new(solid, *measure, *about, *radius, inside))
            }
            ProbeKind::Damaged { measure, threshold, group, within } => {
                let elements = self.elements_that_may_be_damaged(group.as_ref(), within.as_ref(), parts, solid);
                Probe::Damaged(DamagedPart::new(solid, *measure, *threshold, &elements))
            }
            ProbeKind::WaveSpeed { body, wave } => {
                let index = (0..solid.body_count()).find(|&index| solid.body(index).name == body.value);
                if index.is_none() {
                    self.error(&body.place, format!("= \"{}\"", body.value), "the name of a solid body");
                }
                Probe::WaveSpeed { body: index?, wave: *wave }
            }
            ProbeKind::Temperature { .. } | ProbeKind::Heat(_) | ProbeKind::Expression(_) => return None,
        })
    }

    /// Where supports hold these nodes; an error where they do not, or not along the direction. Another stage may hold
    /// them, and a selection without any node has its own error.
    fn held_places(
        &mut self,
        on: &Selection,
        nodes: &[u32],
        supports: &Supports,
        along: Option<&Along>,
    ) -> Vec<(u32, u32, u32)> {
        let places = supports.places(nodes);
        let (is_held, how) = match along {
            Some(along) => (is_held(&places, along), " along the direction of the probe"),
            None => (!places.is_empty(), ""),
        };
        let is_fine = is_held || nodes.is_empty() || !self.case.source.stage.is_empty();
        if let (false, Some(place)) = (is_fine, on.place()) {
            let found = format!("= \"{}\": nothing holds it{how}", on.label());
            self.error(&place.clone(), found, "nodes that a support prescribes");
        }
        places
    }

    /// An error for an axis about which nothing turns in the plane.
    fn refuse_out_of_plane(&mut self, on: &Selection, axis: &Vec3, solid: &Solid) {
        if let (true, Some(place)) = (solid.is_plane() && axis.z == 0.0, on.place()) {
            let found = format!("= \"{}\": plane bodies turn about z alone", on.label());
            self.error(&place.clone(), found, "an axis along \"z\"");
        }
    }

    /// An error for what only plane solids have.
    fn refuse_in_space(&mut self, probe: &model::Probe) {
        let remedy = match probe.kind {
            ProbeKind::Crack { measure: CrackMeasure::Length, .. } => {
                "measure = \"area\": cracks in space have no length"
            }
            ProbeKind::Damaged { measure: DamagedMeasure::Area, .. } => {
                "measure = \"volume\": bodies in space have no area"
            }
            _ => return,
        };
        self.error(&probe.name.place, format!("= \"{}\"", probe.name.value), remedy);
    }

    /// What counts of cracks where a condition holds; an error if nothing does.
    fn inside_cracks(
        &mut self,
        within: Option<&Spanned<Field>>,
        solid: &Solid,
        bonded: &Bonded,
    ) -> Option<InsideCracks> {
        let within = within?;
        let inside = InsideCracks {
            edges: edges_within(solid, &within.value),
            bonds: bonds_within(bonded, &within.value),
            elements: elements_within(solid, &within.value),
        };
        if inside.edges.iter().chain(&inside.bonds).flatten().all(|inside| !inside) {
            let found = ": no edge of a body that may be damaged and no bond that may break fulfils the condition";
            self.error(&within.place, found, "a condition that holds where a crack is expected");
        }
        Some(inside)
    }

    /// Elements of a group, or of all bodies, that a selection means; an error if there are none.
    pub(super) fn selected_elements(&mut self, on: &Selection, parts: &[Part], solid: &Solid) -> Vec<(usize, u32)> {
        let mut elements = self.elements_of_or_all(on.group.as_ref(), parts, solid);
        let Some(within) = &on.within else { return elements };
        let named = elements.len();
        elements.retain(|&(body, element)| within.value.holds_at(solid.element_middle(body, element)));
        if elements.is_empty() && (named > 0 || on.group.is_none()) {
            self.error(&within.place, "holds for no element", "a condition that the middle of one fulfils");
        }
        elements
    }

    fn elements_of_or_all(
        &mut self,
        group: Option<&Spanned<String>>,
        parts: &[Part],
        solid: &Solid,
    ) -> Vec<(usize, u32)> {
        let all = || {
            let of = |body: usize| (0..solid.body(body).elements.len() as u32).map(move |element| (body, element));
            (0..solid.body_count()).flat_map(of).collect()
        };
        group.map_or_else(all, |group| self.elements_of(group, parts))
    }

    /// A probe of the strain of nodes or particles, or of the elongation between two of them; none of other kinds.
    pub(super) fn strain_probe(
        &mut self,
        kind: &ProbeKind,
        scene: (&Bonded, &Solid),
        population: Population,
        points: &[u32],
    ) -> Option<Probe> {
        match kind {
            ProbeKind::Strain { on, measure, between } => {
                self.strain(scene, population, points, on, *measure, *between)
            }
            ProbeKind::Extensometer { on, ends, foot } => {
                self.extensometer(scene, (population, points), on, (*ends, *foot))
            }
            _ => None,
        }
    }

    /// The strain of nodes or particles; an error if they do not span what is measured.
    fn strain(
        &mut self,
        scene: (&Bonded, &Solid),
        population: Population,
        points: &[u32],
        on: &Selection,
        measure: StrainMeasure,
        between: [Along; 2],
    ) -> Option<Probe> {
        if population == Population::Nodes && measure != StrainMeasure::Cundall {
            let place = on.place().cloned().unwrap_or_else(|| self.whole_case());
            let found = format!("= \"{}\", which are nodes, with measure = \"{}\"", on.label(), measure.name());
            self.error(&place, found, "particles of a bonded body; or measure = \"cundall\"");
            return None;
        }
        let probe = RegionStrain::new(scene, population, points, measure, between);
        if probe.is_none() && !points.is_empty() {
            let place = on.place().cloned().unwrap_or_else(|| self.whole_case());
            let found = format!("= \"{}\": its {} points do not span the strain", on.label(), points.len());
            self.error(
                &place,
                found,
                "points that span a volume, or a plane with both directions of the component in it",
            );
        }
        probe.map(Probe::Strain)
    }

    /// Bodies and elements of a group, or all, that may be damaged and fulfil a condition; an error if there are none.
    fn elements_that_may_be_damaged(
        &mut self,
        group: Option<&Spanned<String>>,
        within: Option<&Spanned<Field>>,
        parts: &[Part],
        solid: &Solid,
    ) -> Vec<(usize, u32)> {
        let mut elements = self.elements_of_or_all(group, parts, solid);
        let named = elements.len();
        elements.retain(|&(body, element)| {
            let inside = within.is_none_or(|within| within.value.holds_at(solid.element_middle(body, element)));
            inside && solid.body(body).damage.is_some()
        });
        if elements.is_empty() && (named > 0 || group.is_none()) {
            let place = within.map(|within| &within.place).or(group.map(|group| &group.place));
            let place = place.cloned().unwrap_or_else(|| self.whole_case());
            self.error(&place, ": nothing there may be damaged", "elements of a body whose material has damage");
        }
        elements
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
        solid: &Solid,
    ) -> Vec<[u32; 3]> {
        let facets = self.selected_facets(on, numbering, surface);
        let closed = || HoleEnds::find(solid, &facets, SymmetryPlanes::default(), false).is_ok();
        if measure == SurfaceMeasure::Volume && (facets.is_empty() || !closed()) {
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
        let holes = case.flows.gas.as_ref().map_or(&[][..], |gas| &gas.holes);
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

/// Which elements of bodies that may be damaged fulfil a condition at their middles, body by body.
fn elements_within(solid: &Solid, condition: &Field) -> Vec<Vec<bool>> {
    let body = |index: usize| {
        let elements = 0..if solid.body(index).damage.is_some() { solid.body(index).elements.len() as u32 } else { 0 };
        elements.map(|element| condition.holds_at(solid.element_middle(index, element))).collect()
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
