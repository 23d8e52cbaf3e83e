//! What is beside the solids: other bodies, which may be made of tetrahedra too, and may touch them.

use fractum_fem::all_elements;
use fractum_math::connected;
use fractum_mesh::Mesh;
use fractum_parallel::Exchange;

use crate::model::{Body, BodyKind, BondedShape, Case, PackingSource, RigidShape};

/// Groups of tetrahedra that bodies are made of which are no solids.
pub(super) fn groups_of_others(case: &Case, mesh: &Mesh) -> Vec<usize> {
    let whole = mesh.whole.as_ref().expect("the caller knows what others have");
    let names: Vec<&str> = case.bodies.iter().filter_map(group_of_other).collect();
    let is_meant = |group: &usize| whole.groups[*group].0 > 0 && names.contains(&mesh.groups[*group].name.as_str());
    (0..mesh.groups.len()).filter(is_meant).collect()
}

/// Group of the mesh that a body is made of which is no solid.
fn group_of_other(body: &Body) -> Option<&str> {
    let group = match &body.kind {
        BodyKind::Rigid(rigid) => match &rigid.shape {
            RigidShape::Group { group, .. } => group,
            _ => return None,
        },
        BodyKind::Bonded(bonded) => match &bonded.packing {
            PackingSource::Shape { shape, .. } => match &shape.value {
                BondedShape::Group(group) => group,
                _ => return None,
            },
            PackingSource::Particles { .. } | PackingSource::File(_) => return None,
        },
        BodyKind::Particles(loose) => loose.group()?,
        BodyKind::Solid(_) => return None,
    };
    Some(&group.value)
}

/// The elements of a group that all processes have read, in their order, with their tags.
pub(super) fn elements_of(mesh: &Mesh, group: usize, exchange: &dyn Exchange) -> (Vec<[u32; 4]>, Vec<u64>) {
    let of = |&e: &u32| (mesh.tetrahedra[e as usize], mesh.tetrahedron_tags[e as usize]);
    let (own, tags): (Vec<[u32; 4]>, Vec<u64>) = mesh.groups[group].tetrahedra.iter().map(of).unzip();
    all_elements(exchange, &own, &tags)
}

/// Whether something may touch the solids: other bodies, or one solid another that it shares no node with.
///
/// - `nodes`: those of each solid; `count`: how many the mesh has
pub(super) fn may_touch<'a>(case: &Case, nodes: impl Iterator<Item = &'a Vec<u32>>, count: usize) -> bool {
    if case.bodies.iter().any(|body| !matches!(body.kind, BodyKind::Solid(_))) {
        return true;
    }
    let mut first = vec![u32::MAX; count];
    let (mut links, mut bodies) = (Vec::new(), 0);
    for (body, nodes) in (0..).zip(nodes) {
        bodies = body as usize + 1;
        for &node in nodes {
            let first = &mut first[node as usize];
            *first = body.min(*first);
            links.extend((*first != body).then_some([*first, body]));
        }
    }
    connected(bodies, links).into_iter().any(|piece| piece != 0)
}
