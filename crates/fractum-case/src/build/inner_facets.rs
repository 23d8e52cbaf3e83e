//! Facets of loads that lie within the bodies, where none acts.

use fractum_output::number::grouped;
use fractum_output::warning::Code;

use super::Context;
use super::bodies::Numbering;
use super::conditions::{Surface, sorted};
use crate::Diagnostic;
use crate::model::{GroupUse, HeatKind, Selection};

/// Doubts about groups that have facets on the surface and others within the bodies.
pub(super) fn doubts(context: &Context<'_>, numbering: &Numbering, surface: &Surface) -> Vec<Diagnostic> {
    let case = context.case;
    if context.division.is_some() || case.excavates() {
        return Vec::new();
    }
    let loads = case.loads.iter().filter_map(|load| load.kind.on());
    let loads = loads.filter(|(_, as_what)| *as_what == GroupUse::Facets).map(|(on, _)| on);
    let supports = case.supports.iter().filter(|support| support.surface.is_some()).map(|support| &support.on);
    let heat = case.flows.heat.iter().flat_map(|heat| &heat.conditions);
    let heat = heat.filter(|own| matches!(own.kind, HeatKind::Flux(_) | HeatKind::Convection { .. }));
    let all = loads.chain(supports).chain(heat.map(|own| &own.on)).filter(|on| !context.names_particles(on));
    all.filter_map(|on| doubt(context, on, numbering, surface)).collect()
}

fn doubt(context: &Context<'_>, on: &Selection, numbering: &Numbering, surface: &Surface) -> Option<Diagnostic> {
    let group = on.group.as_ref().filter(|_| on.within.is_none())?;
    let mesh = context.mesh;
    let groups = mesh.group(&group.value);
    let scene = |node: u32| numbering.scene_node[node as usize];
    let mut facets: Vec<[u32; 3]> = if mesh.is_plane() {
        let lines = groups.iter().flat_map(|group| &group.lines).map(|&line| mesh.lines[line as usize].map(scene));
        lines.map(|[a, b]| sorted([a, b, b])).collect()
    } else {
        let triangles = groups.iter().flat_map(|group| &group.triangles);
        triangles.map(|&triangle| sorted(mesh.triangles[triangle as usize].map(scene))).collect()
    };
    // What reaches beyond the bodies has a doubt of its own.
    facets.retain(|facet| !facet.contains(&u32::MAX));
    facets.sort_unstable();
    facets.dedup();
    let inner = facets.iter().filter(|facet| surface.outward(**facet).is_none()).count();
    if inner == 0 || inner == facets.len() {
        return None;
    }
    let [inner, all] = [inner, facets.len()].map(|count| grouped(&count.to_string()));
    let found =
        format!("= \"{}\": {inner} of its {all} facets lie within the bodies, where nothing acts on them", group.value);
    let note = Diagnostic::warning(Code::BeyondBodies, &group.place, found);
    Some(note.remedy("name a group of facets on the surface alone; a force acts on inner nodes too"))
}
