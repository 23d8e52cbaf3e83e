//! Probes of a case in the scene that is made of it.

use fractum_fem::Solid;
use fractum_scene::{Bonded, ContactBody, Probe, Supports};

use super::Context;
use super::bodies::{Numbering, Part};
use super::conditions::Surface;
use super::use_in_words;
use crate::measure::{Names, Scenery};
use crate::model::{Flows, GroupUse, Selection};
use crate::{Place, Spanned};

/// What names of the case stand for while probes are made.
struct NamesOfScene<'a, 'c> {
    context: &'a mut Context<'c>,
    parts: &'a [Part<'a>],
    numbering: &'a Numbering,
    surface: &'a Surface<'a>,
    solid: &'a Solid,
    bonded: &'a Bonded,
}

impl Names for NamesOfScene<'_, '_> {
    fn nodes(&mut self, on: &Selection) -> Vec<u32> {
        self.context.selected_nodes(on, self.numbering)
    }

    fn particles(&mut self, on: &Selection) -> Option<Vec<u32>> {
        let group = on.group.as_ref().filter(|_| self.context.names_particles(on))?;
        Some(self.context.selected_particles(on, group, self.bonded))
    }

    fn elements(&mut self, on: &Selection) -> Vec<(usize, u32)> {
        self.context.selected_elements(on, self.parts, self.solid)
    }

    fn elements_of(&mut self, group: Option<&Spanned<String>>) -> Vec<(usize, u32)> {
        self.context.elements_of_or_all(group, self.parts, self.solid)
    }

    fn facets(&mut self, on: &Selection) -> Vec<[u32; 3]> {
        self.context.selected_facets(on, self.numbering, self.surface)
    }

    fn rigid_body(&self, name: &str) -> Option<usize> {
        self.context.case.tool(name)
    }

    fn contact_body(&self, name: &str) -> Option<ContactBody> {
        let rigid = self.rigid_body(name).map(ContactBody::Rigid);
        let (bonded, solid) = (self.bonded, self.solid);
        let particles = || bonded.bodies().iter().position(|body| body.name == name).map(ContactBody::Particles);
        let solids = || (0..solid.body_count()).find(|&body| solid.body(body).name == name).map(ContactBody::Solid);
        rigid.or_else(particles).or_else(solids)
    }

    fn hole(&self, group: &str) -> Option<usize> {
        // Gas and liquid do not act together.
        let Flows { gas, liquid, .. } = &self.context.case.flows;
        let of_liquid = liquid.iter().flat_map(|liquid| &liquid.holes).map(|hole| &hole.on);
        let mut holes = gas.iter().flat_map(|gas| &gas.holes).map(|hole| &hole.on).chain(of_liquid);
        holes.position(|on| on.group_name() == group)
    }

    fn vibrations(&self) -> usize {
        self.context.case.solver.modes.map_or(0, |modes| modes.count)
    }

    fn is_stage(&self) -> bool {
        !self.context.case.source.stage.is_empty()
    }

    fn has_interfaces(&self) -> bool {
        !self.context.case.interfaces.is_empty()
    }

    fn whole_case(&self) -> Place {
        self.context.whole_case()
    }

    fn error(&mut self, place: &Place, found: String, expected: &str) {
        self.context.error(place, found, expected);
    }
}

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
    ) -> Vec<Option<Box<dyn Probe>>> {
        let probes = &self.case.probes;
        for probe in probes.iter().filter(|_| !solid.is_plane()) {
            if let Some(remedy) = probe.kind.instead_in_space() {
                self.error(&probe.name.place, format!("= \"{}\"", probe.name.value), remedy);
            }
        }
        let mut names = NamesOfScene { context: self, parts, numbering, surface, solid, bonded };
        let mut scene = Scenery { solid, bonded, supports, names: &mut names };
        probes.iter().map(|probe| probe.kind.resolve(&mut scene)).collect()
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
}
