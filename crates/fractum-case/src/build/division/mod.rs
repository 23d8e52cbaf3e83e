//! Solids of a mesh that several processes share: each has read some of its tetrahedra, and gets those around its cells.

mod beside;
mod probed;

pub use fractum_fem::Replication;
use fractum_fem::{BodyShare, DividedBoundary, Formulation, KnownAround, ReadBody, deal, divided_boundary};
use fractum_math::Vec3;
use fractum_mesh::topology::TETRAHEDRON_EDGES;
use fractum_mesh::{Group, Mesh};
use fractum_parallel::Exchange;
use rayon::prelude::*;

use super::bodies::Numbering;
use crate::model::{Body, BodyKind, Case, SolidBody};
use beside::{groups_of_others, may_touch};
use probed::{NamedElements, measured_nodes};

/// What a process has of the solids of a mesh that it shares with others.
pub struct SolidDivision {
    /// Of each solid body, without its elements.
    pub(super) bodies: Vec<BodyShare>,
    /// In nodes of the mesh.
    pub(super) boundary: DividedBoundary,
    /// Of the nodes of all bodies.
    pub(super) numbering: Numbering,
}

/// Why processes cannot share the mesh of a case, in words; none where they can.
pub fn cannot_divide(case: &Case) -> Option<String> {
    let replaces = |body: &&Body| matches!(&body.kind, BodyKind::Bonded(bonded) if bonded.replaces.is_some());
    let body = case.bodies.iter().find(replaces);
    let stages = || std::iter::once(case).chain(&case.later);
    let of_stage = |stage: &Case| match () {
        () if stage.solver.subcycling.is_some() => Some("subcycling"),
        () if stage.solver.domain.is_some() => Some("solver.domain"),
        () if stage.flows.heat.is_some() => Some("heat"),
        () => None,
    };
    let all_whole = || {
        let of = |(name, solid)| Some(format!("{} of body \"{name}\"", whole_for(case, solid)?));
        let reasons: Option<Vec<String>> = solids(case).map(of).collect();
        reasons.map(|reasons| reasons.join(", "))
    };
    let no_solid = solids(case).next().is_none().then(|| "bodies of which none is a solid".to_owned());
    body.map(|body| format!("body \"{}\", which replaces a part of a solid", body.name.value))
        .or(no_solid)
        .or_else(|| stages().find_map(of_stage).map(str::to_owned))
        .or_else(|| case.in_situ.as_ref().map(|_| "stress in situ".to_owned()))
        .or_else(|| case.excavates().then(|| "bodies that leave in a stage".to_owned()))
        .or_else(all_whole)
}

/// Solid bodies of a case, with their names.
fn solids(case: &Case) -> impl Iterator<Item = (&str, &SolidBody)> {
    case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Solid(solid) => Some((body.name.value.as_str(), solid)),
        _ => None,
    })
}

/// What every process has of the bodies that may break, in words.
pub fn replicated_bodies(case: &Case) -> Vec<String> {
    let note = |(name, solid): (&str, &SolidBody)| match (replication(case, solid), whole_for(case, solid)) {
        (Replication::Part, _) => None,
        (_, None) => Some(format!("every process has all elements of body \"{name}\", because of damage")),
        (_, Some(reason)) => Some(format!("every process has all of body \"{name}\", because of {reason}")),
    };
    solids(case).filter_map(note).collect()
}

/// What every process has of a body, where several share a mesh.
pub fn replication(case: &Case, solid: &SolidBody) -> Replication {
    match whole_for(case, solid) {
        Some(_) => Replication::Whole,
        None if solid.damage => Replication::Elements,
        None => Replication::Part,
    }
}

/// Why every process has all cells of a body, in words; none where it has its own alone.
fn whole_for(case: &Case, solid: &SolidBody) -> Option<&'static str> {
    let damage = case.materials[solid.material].damage.as_ref().filter(|_| solid.damage)?;
    match () {
        () if !solid.is_smoothed() => Some("damage in the standard formulation"),
        () if damage.value.regularisation.is_some() => Some("a phase field"),
        () => None,
    }
}

/// Deals the tetrahedra that all processes have read out to those whose cells they are part of. All processes must call it.
///
/// - `mesh`: whole but for its tetrahedra, of which it has those that this process has read; the whole has those of process 0 first, then
///   those of process 1 and so on
///
/// # Errors
/// Why it cannot be done, in words, the same for every process.
pub fn divide(case: &Case, mesh: Mesh, exchange: &dyn Exchange) -> Result<(Mesh, SolidDivision), String> {
    let whole = mesh.whole.as_ref().expect("the caller knows what others have");
    let bodies: Vec<&SolidBody> = solids(case).map(|(_, solid)| solid).collect();
    let groups: Vec<usize> = bodies
        .iter()
        .filter_map(|body| {
            let is_meant = |(group, whole): (&Group, &(usize, Vec<u32>))| group.name == body.group.value && whole.0 > 0;
            mesh.groups.iter().zip(&whole.groups).position(is_meant)
        })
        .collect();
    if groups.len() < bodies.len() {
        return Err("a body without tetrahedra".to_owned());
    }
    let nodes_of = |group: &usize| &whole.groups[*group].1;
    let members = |group: &usize| &mesh.groups[*group].tetrahedra;
    let mut taken = vec![false; mesh.tetrahedra.len()];
    let mut again =
        groups.iter().flat_map(members).map(|&element| std::mem::replace(&mut taken[element as usize], true));
    if exchange.any(u64::from(again.any(|again| again))) != 0 {
        return Err("an element that belongs to two bodies".to_owned());
    }
    let mut used = vec![false; mesh.nodes.len()];
    groups.iter().flat_map(nodes_of).for_each(|&node| used[node as usize] = true);
    let beside = groups_of_others(case, &mesh);
    if let Some(&group) = beside.iter().find(|group| groups.contains(group)) {
        return Err(format!("group \"{}\", which is that of two bodies", mesh.groups[group].name));
    }
    let (numbering, order) = Numbering::of(&mesh.nodes, &used);
    let elements_of =
        |group: &usize| members(group).iter().map(|&e| mesh.tetrahedra[e as usize]).collect::<Vec<[u32; 4]>>();
    let in_mesh: Vec<Vec<[u32; 4]>> = groups.iter().map(elements_of).collect();
    let boundary = divided_boundary(exchange, &in_mesh, mesh.nodes.len());
    let scene = |element: &[u32; 4]| element.map(|node| numbering.scene_node[node as usize]);
    let in_scene: Vec<Vec<[u32; 4]>> = in_mesh.iter().map(|elements| elements.iter().map(scene).collect()).collect();
    drop(in_mesh);
    let tags_of = |group: &usize| members(group).iter().map(|&e| mesh.tetrahedron_tags[e as usize]).collect::<Vec<_>>();
    let tags: Vec<Vec<u64>> = groups.iter().map(tags_of).collect();
    let formulation = |body: &SolidBody| if body.is_smoothed() { Formulation::Smoothed } else { Formulation::Standard };
    let sound: Vec<Vec<[bool; 6]>> = bodies
        .iter()
        .zip(&in_scene)
        .map(|(body, elements)| match replication(case, body) {
            Replication::Elements => sound_edges(body, elements, &numbering.positions),
            Replication::Part | Replication::Whole => Vec::new(),
        })
        .collect();
    let read = bodies.iter().zip(&in_scene).zip(&tags).zip(&sound);
    let read: Vec<ReadBody> = read
        .map(|(((body, elements), tags), sound)| ReadBody {
            formulation: formulation(body),
            elements,
            tags,
            replication: replication(case, body),
            sound,
        })
        .collect();
    // Where two bodies meet too: facets of each by itself are looked for.
    let touched =
        if may_touch(case, groups.iter().map(nodes_of), mesh.nodes.len()) { &boundary.of_bodies[..] } else { &[] };
    let touched = numbering.ascending(touched.iter().flatten().flatten());
    let measured = measured_nodes(case, &mesh, &groups, exchange);
    let measured = numbering.ascending(&measured);
    let named = NamedElements::of(case, &mesh, &groups, exchange);
    let beside: Vec<_> = beside.into_iter().map(|group| (group, beside::elements_of(&mesh, group, exchange))).collect();
    let mut local = Mesh { tetrahedra: Vec::new(), tetrahedron_tags: Vec::new(), ..mesh };
    local.groups.iter_mut().for_each(|group| group.tetrahedra = Vec::new());
    let around = KnownAround { touched: &touched, measured: &measured };
    let mut shares = deal(exchange, &numbering.positions, &read, around);
    drop((in_scene, tags, sound));
    for (&group, share) in groups.iter().zip(&mut shares) {
        let in_mesh = |element: [u32; 4]| element.map(|node| order[node as usize]);
        let elements = std::mem::take(&mut share.elements).into_iter().map(in_mesh);
        add_elements(&mut local, group, elements.zip(std::mem::take(&mut share.tags)));
    }
    for (group, (elements, tags)) in beside {
        add_elements(&mut local, group, elements.into_iter().zip(tags));
    }
    named.put(&mut local, &groups, &shares);
    Ok((local, SolidDivision { bodies: shares, boundary, numbering }))
}

/// Which edges of some elements of a body cannot be damaged where others can; empty where all of them can, or none.
fn sound_edges(body: &SolidBody, elements: &[[u32; 4]], nodes: &[Vec3]) -> Vec<[bool; 6]> {
    let Some(condition) = &body.damage_where else { return Vec::new() };
    let is_sound = |element: &[u32; 4]| {
        TETRAHEDRON_EDGES.map(|ends| {
            let [a, b] = ends.map(|end| nodes[element[end] as usize]);
            !condition.value.holds_at((a + b) * 0.5)
        })
    };
    elements.par_iter().map(is_sound).collect()
}

/// Adds elements of a group to a mesh, with their tags.
fn add_elements(mesh: &mut Mesh, group: usize, elements: impl Iterator<Item = ([u32; 4], u64)>) {
    let first = mesh.tetrahedra.len() as u32;
    for (element, tag) in elements {
        mesh.tetrahedra.push(element);
        mesh.tetrahedron_tags.push(tag);
    }
    mesh.groups[group].tetrahedra = (first..mesh.tetrahedra.len() as u32).collect();
}
