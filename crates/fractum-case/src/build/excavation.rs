//! What a stage takes out and puts in, on the mesh: what is left of nodes and surface, and who is left without both.

use fractum_output::warning::Code;
use fractum_scene::Scene;

use super::Context;
use super::bodies::{self, Numbering, Part, element_nodes};
use crate::model::{Case, Excavation, SolverKind};
use crate::{Diagnostic, Spanned};

/// The nodes with those marked that have left, and the surface of what is left; none where nothing has.
pub(super) fn what_is_left(
    context: &Context<'_>,
    parts: &[Part],
    numbering: &Numbering,
) -> Option<(Numbering, Vec<[u32; 3]>)> {
    let gone = bodies::gone(context.case, parts);
    if gone.is_empty() {
        return None;
    }
    let nodes = |leaves: bool| nodes_of(context, parts, numbering, |index, _| gone.contains(&index) == leaves);
    let (mut left, there) = (nodes(true), nodes(false));
    left.retain(|node| there.binary_search(node).is_err());
    let boundary = bodies::boundary(context, parts, numbering, &gone);
    Some((Numbering { gone: left, ..numbering.clone() }, boundary))
}

/// Nodes of the scene that some parts have, ascending.
fn nodes_of(
    context: &Context<'_>,
    parts: &[Part],
    numbering: &Numbering,
    is_meant: impl Fn(usize, &Part) -> bool,
) -> Vec<u32> {
    let meant = parts.iter().enumerate().filter(|(index, part)| is_meant(*index, part));
    let nodes: Vec<u32> = meant.flat_map(|(_, part)| element_nodes(context, part)).flatten().collect();
    numbering.ascending(&nodes)
}

/// The scene as the one of a stage that may take something out or put something in.
pub(super) fn with_excavation(case: &Case, scene: Scene, parts: &[Part]) -> Scene {
    let Some(excavation) = &case.excavation else { return scene };
    let leaving = fractum_scene::Excavation {
        bodies: bodies::numbers(parts, excavation.bodies.iter().map(|name| name.value.as_str())),
        installed: bodies::numbers(parts, excavation.installed.iter().map(|name| name.value.as_str())),
        over: excavation.release.as_ref().map(|release| release.value),
        share: excavation.share,
        is_smooth: case.solver.kind == SolverKind::Explicit,
    };
    fractum_scene::with_excavation(scene, leaving, &bodies::gone(case, parts))
}

/// Warns of what measures places that leave.
pub(super) fn doubts(context: &Context<'_>, parts: &[Part], numbering: &Numbering) -> Vec<Diagnostic> {
    let case = context.case;
    let acts = |own: &&Excavation| !own.bodies.is_empty() || !own.installed.is_empty();
    let Some(excavation) = case.excavation.as_ref().filter(acts) else { return Vec::new() };
    // Until they are there they have no value, as the plan tells.
    let come = nodes_of(context, parts, numbering, |_, part| excavation.to_come.iter().any(|name| name == part.name));
    let probes = case.probes.iter().filter_map(|probe| Some((&probe.name, &probe.kind.group()?.0.value)));
    let gauges = case.output.gauges.iter();
    let gauges = gauges.filter_map(|gauges| Some((gauges.on.group.as_ref()?, &gauges.on.group.as_ref()?.value)));
    let warning = |(name, group): (&Spanned<String>, &String)| {
        let nodes = context.mesh.group_nodes(group);
        let nodes: Vec<u32> = nodes.iter().map(|&node| numbering.scene_node[node as usize]).collect();
        let is_lost = |node: &&u32| numbering.has_left(**node) && come.binary_search(node).is_err();
        let left = nodes.iter().filter(is_lost).count();
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
    let mut found: Vec<Diagnostic> = match excavation.bodies.is_empty() {
        true => Vec::new(),
        false => probes.chain(gauges).filter_map(warning).collect(),
    };
    let touches = case.bodies.iter().any(|body| matches!(body.kind, crate::model::BodyKind::Rigid(_)));
    if touches {
        let note = Diagnostic::warning(Code::Excavated, &excavation.place, "beside rigid bodies");
        found.push(
            note.expected("bodies that reach neither the wall that is bared nor what comes in: nothing touches them"),
        );
    }
    found
}
