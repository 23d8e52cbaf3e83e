//! What a stage takes out, on the mesh: what is left of nodes and surface, and who is left without both.

use fractum_output::warning::Code;
use fractum_scene::{Excavation, Scene};

use super::Context;
use super::bodies::{self, Numbering, Part, element_nodes};
use crate::model::{Case, SolverKind};
use crate::{Diagnostic, Spanned};

/// Numbers of the solids that have left before the present stage.
pub(super) fn gone(case: &Case, parts: &[Part]) -> Vec<usize> {
    let Some(excavation) = &case.excavation else { return Vec::new() };
    numbers(parts, excavation.gone.iter().map(String::as_str))
}

fn numbers<'n>(parts: &[Part], names: impl Iterator<Item = &'n str>) -> Vec<usize> {
    names.filter_map(|name| parts.iter().position(|part| part.name == name)).collect()
}

/// The nodes with those marked that have left, and the surface of what is left; none where nothing has.
pub(super) fn what_is_left(
    context: &Context<'_>,
    parts: &[Part],
    numbering: &Numbering,
) -> Option<(Numbering, Vec<[u32; 3]>)> {
    let gone = gone(context.case, parts);
    if gone.is_empty() {
        return None;
    }
    let nodes = |leaves: bool| {
        let meant = parts.iter().enumerate().filter(|(index, _)| gone.contains(index) == leaves);
        let nodes: Vec<u32> = meant.flat_map(|(_, part)| element_nodes(context, part)).flatten().collect();
        numbering.ascending(&nodes)
    };
    let (mut left, there) = (nodes(true), nodes(false));
    left.retain(|node| there.binary_search(node).is_err());
    let boundary = bodies::boundary(context, parts, numbering, &gone);
    Some((Numbering { gone: left, ..numbering.clone() }, boundary))
}

/// The scene as the one of a stage that may take something out.
pub(super) fn with_excavation(case: &Case, scene: Scene, parts: &[Part]) -> Scene {
    let Some(excavation) = &case.excavation else { return scene };
    let leaving = Excavation {
        bodies: numbers(parts, excavation.bodies.iter().map(|name| name.value.as_str())),
        over: excavation.release.as_ref().map(|release| release.value),
        share: excavation.share,
        is_smooth: case.solver.kind == SolverKind::Explicit,
    };
    fractum_scene::with_excavation(scene, leaving, &gone(case, parts))
}

/// Warns of what measures places that leave.
pub(super) fn doubts(context: &Context<'_>, numbering: &Numbering) -> Vec<Diagnostic> {
    let case = context.case;
    let Some(excavation) = case.excavation.as_ref().filter(|own| !own.bodies.is_empty()) else { return Vec::new() };
    let probes = case.probes.iter().filter_map(|probe| Some((&probe.name, &probe.kind.group()?.0.value)));
    let gauges = case.output.gauges.iter();
    let gauges = gauges.filter_map(|gauges| Some((gauges.on.group.as_ref()?, &gauges.on.group.as_ref()?.value)));
    let warning = |(name, group): (&Spanned<String>, &String)| {
        let nodes = context.mesh.group_nodes(group);
        let nodes: Vec<u32> = nodes.iter().map(|&node| numbering.scene_node[node as usize]).collect();
        let left = nodes.iter().filter(|&&node| numbering.has_left(node)).count();
        let known = nodes.iter().filter(|&&node| node != u32::MAX).count();
        (left > 0).then(|| {
            let found = format!(
                "= \"{}\": {left} of the {known} nodes of group \"{group}\" have left once stage \"{}\" begins",
                name.value, case.source.stage
            );
            let note = Diagnostic::warning(Code::Excavated, &name.place, found);
            note.remedy(if left == known {
                "it has no value from then on; take a group of what stays"
            } else {
                "it is that of the others from then on; take a group of what stays"
            })
        })
    };
    let mut found: Vec<Diagnostic> = probes.chain(gauges).filter_map(warning).collect();
    let touches = case.bodies.iter().any(|body| matches!(body.kind, crate::model::BodyKind::Rigid(_)));
    if touches {
        let note = Diagnostic::warning(Code::Excavated, &excavation.place, "beside rigid bodies");
        found.push(note.expected("bodies that do not reach the wall that is bared: nothing touches it"));
    }
    found
}
