//! Solids of a mesh that several processes share: each has read some of its tetrahedra, and gets those around its cells.

use std::collections::{BTreeMap, BTreeSet};

use fractum_fem::{BodyShare, DividedBoundary, Formulation, KnownAround, ReadBody, deal, divided_boundary};
use fractum_math::{Vec3, connected};
use fractum_mesh::{Group, Mesh};
use fractum_parallel::{Exchange, gather};

use super::bodies::Numbering;
use crate::case::model::{
    Body, BodyKind, BondedShape, Case, PackingSource, ProbeKind, RigidShape, Selection, SolidBody,
};

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
    let all_break = || solids(case).all(|(_, solid)| may_break(case, solid)).then(|| "damage of every body".to_owned());
    let no_solid = solids(case).next().is_none().then(|| "bodies of which none is a solid".to_owned());
    body.map(|body| format!("body \"{}\", which replaces a part of a solid", body.name.value))
        .or(no_solid)
        .or_else(|| stages().find_map(of_stage).map(str::to_owned))
        .or_else(|| case.in_situ.as_ref().map(|_| "stress in situ".to_owned()))
        .or_else(all_break)
}

/// Solid bodies of a case, with their names.
fn solids(case: &Case) -> impl Iterator<Item = (&str, &SolidBody)> {
    case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Solid(solid) => Some((body.name.value.as_str(), solid)),
        _ => None,
    })
}

/// Whether a body may break: every process needs all of it then.
fn may_break(case: &Case, body: &SolidBody) -> bool {
    body.damage && case.materials[body.material].damage.is_some()
}

/// The bodies of a case that every process has whole.
pub fn whole_bodies(case: &Case) -> Vec<&str> {
    solids(case).filter(|(_, solid)| may_break(case, solid)).map(|(name, _)| name).collect()
}

/// Elements whose stress probes measure.
fn measured(case: &Case) -> impl Iterator<Item = &Selection> {
    case.probes.iter().filter_map(|probe| match &probe.kind {
        ProbeKind::Stress { on, .. } if case.particle_group(on.group_name()).is_none() => Some(on),
        _ => None,
    })
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
    let read = bodies.iter().zip(&in_scene).zip(&tags);
    let read: Vec<ReadBody> = read
        .map(|((body, elements), tags)| {
            let is_whole = may_break(case, body);
            ReadBody { formulation: formulation(body), elements, tags, is_whole }
        })
        .collect();
    let nodes_in_scene = |nodes: &mut dyn Iterator<Item = u32>| {
        let mut nodes: Vec<u32> = nodes.map(|node| numbering.scene_node[node as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    };
    // Where two bodies meet too: facets of each by itself are looked for.
    let touched = if may_touch(case, groups.iter().map(nodes_of)) { &boundary.of_bodies[..] } else { &[] };
    let touched = nodes_in_scene(&mut touched.iter().flatten().flatten().copied());
    let own = nodes_in_scene(&mut groups.iter().flat_map(|&group| measured_nodes(case, &mesh, group)));
    let measured: BTreeSet<u32> = gather(exchange, &own).into_iter().flatten().collect();
    let measured: Vec<u32> = measured.into_iter().collect();
    let named = NamedElements::of(case, &mesh, &groups, exchange);
    let beside: Vec<_> = beside.into_iter().map(|group| (group, all_elements(&mesh, group, exchange))).collect();
    let mut local = Mesh { tetrahedra: Vec::new(), tetrahedron_tags: Vec::new(), ..mesh };
    local.groups.iter_mut().for_each(|group| group.tetrahedra = Vec::new());
    let around = KnownAround { touched: &touched, measured: &measured };
    let mut shares = deal(exchange, &numbering.positions, &read, around);
    drop((in_scene, tags));
    for (&group, share) in groups.iter().zip(&mut shares) {
        let in_mesh = |element: [u32; 4]| element.map(|node| order[node as usize]);
        let elements = std::mem::take(&mut share.elements).into_iter().map(in_mesh);
        add_elements(&mut local, group, elements.zip(std::mem::take(&mut share.tags)));
    }
    for (group, elements) in beside {
        add_elements(&mut local, group, elements.into_iter());
    }
    named.put(&mut local, &groups, &shares);
    Ok((local, SolidDivision { bodies: shares, boundary, numbering }))
}

/// Nodes of the elements of a group, that of a body, that this process has read and whose stress probes measure.
fn measured_nodes(case: &Case, mesh: &Mesh, group: usize) -> Vec<u32> {
    let is_measured = |element: u32, on: &Selection| {
        let is_named = on.group.as_ref().is_none_or(|name| {
            mesh.group(&name.value).iter().any(|group| group.tetrahedra.binary_search(&element).is_ok())
        });
        let nodes = mesh.tetrahedra[element as usize];
        let middle = || nodes.iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / 4.0;
        is_named && on.within.as_ref().is_none_or(|within| within.value.holds_at(middle()))
    };
    let elements = mesh.groups[group].tetrahedra.iter().copied();
    let measured = elements.filter(|&element| measured(case).any(|on| is_measured(element, on)));
    measured.flat_map(|element| mesh.tetrahedra[element as usize]).collect()
}

/// Elements of groups that probes name and that are not those of bodies.
struct NamedElements {
    /// Group, body and number in that of each.
    elements: Vec<(usize, usize, u32)>,
}

impl NamedElements {
    /// All processes must call it.
    ///
    /// - `bodies`: groups of the bodies, of which the whole has the elements of process 0 first, and so on
    fn of(case: &Case, mesh: &Mesh, bodies: &[usize], exchange: &dyn Exchange) -> Self {
        let damaged = case.probes.iter().filter_map(|probe| match &probe.kind {
            ProbeKind::Damaged { group, .. } => group.as_ref(),
            _ => None,
        });
        let names: BTreeSet<&str> =
            measured(case).filter_map(|on| on.group.as_ref()).chain(damaged).map(|name| name.value.as_str()).collect();
        let counts: Vec<usize> = bodies.iter().map(|&body| mesh.groups[body].tetrahedra.len()).collect();
        let before: Vec<Vec<usize>> = gather(exchange, &counts).into_iter().take(exchange.rank()).collect();
        let mut own = Vec::new();
        for (group, known) in mesh.groups.iter().enumerate().filter(|(_, group)| names.contains(group.name.as_str())) {
            for (body, &members) in bodies.iter().enumerate().filter(|(_, members)| **members != group) {
                let first = before.iter().map(|counts| counts[body]).sum::<usize>();
                let members = (first as u32..).zip(&mesh.groups[members].tetrahedra);
                let named = members.filter(|(_, element)| known.tetrahedra.binary_search(element).is_ok());
                own.extend(named.map(|(number, _)| (group, body, number)));
            }
        }
        NamedElements { elements: gather(exchange, &own).concat() }
    }

    /// Names those that this process has.
    fn put(&self, mesh: &mut Mesh, bodies: &[usize], shares: &[BodyShare]) {
        for &(group, body, number) in &self.elements {
            if let Ok(place) = shares[body].numbers.binary_search(&number) {
                let element = mesh.groups[bodies[body]].tetrahedra[place];
                mesh.groups[group].tetrahedra.push(element);
            }
        }
        mesh.groups.iter_mut().for_each(|group| group.tetrahedra.sort_unstable());
    }
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

/// Groups of tetrahedra that bodies are made of which are no solids.
fn groups_of_others(case: &Case, mesh: &Mesh) -> Vec<usize> {
    let whole = mesh.whole.as_ref().expect("the caller knows what others have");
    let name = |body: &Body| match &body.kind {
        BodyKind::Rigid(rigid) => match &rigid.shape {
            RigidShape::Group { group, .. } => Some(group.value.clone()),
            _ => None,
        },
        BodyKind::Bonded(bonded) => match &bonded.packing {
            PackingSource::Shape { shape, .. } => match &shape.value {
                BondedShape::Group(group) => Some(group.value.clone()),
                _ => None,
            },
            PackingSource::File(_) => None,
        },
        _ => None,
    };
    let names: Vec<String> = case.bodies.iter().filter_map(name).collect();
    let is_meant = |group: &usize| whole.groups[*group].0 > 0 && names.contains(&mesh.groups[*group].name);
    (0..mesh.groups.len()).filter(is_meant).collect()
}

/// The elements of a group that all processes have read, in their order, with their tags.
fn all_elements(mesh: &Mesh, group: usize, exchange: &dyn Exchange) -> Vec<([u32; 4], u64)> {
    let of = |&e: &u32| (mesh.tetrahedra[e as usize], mesh.tetrahedron_tags[e as usize]);
    let own: Vec<([u32; 4], u64)> = mesh.groups[group].tetrahedra.iter().map(of).collect();
    gather(exchange, &own).concat()
}

/// Whether something may touch the solids: other bodies, or one solid another that it shares no node with.
///
/// - `nodes`: those of each solid
fn may_touch<'a>(case: &Case, nodes: impl Iterator<Item = &'a Vec<u32>>) -> bool {
    if case.bodies.iter().any(|body| !matches!(body.kind, BodyKind::Solid(_))) {
        return true;
    }
    let mut first = BTreeMap::<u32, u32>::new();
    let mut links = Vec::new();
    let mut count = 0;
    for (body, nodes) in (0..).zip(nodes) {
        count = body + 1;
        links.extend(nodes.iter().map(|&node| [*first.entry(node).or_insert(body), body]));
    }
    connected(count as usize, links).into_iter().any(|piece| piece != 0)
}
