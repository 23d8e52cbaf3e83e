//! Elements that probes look at, which every process must know.

use std::collections::BTreeSet;

use fractum_fem::BodyShare;
use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_parallel::{Exchange, gather};

use crate::measure::{Damaged, Stress};
use crate::model::{Case, ProbeKind, Selection};

/// Elements whose stress probes measure.
fn measured(case: &Case) -> impl Iterator<Item = &Selection> {
    case.probes.iter().filter_map(|probe| match &probe.kind {
        ProbeKind::Stress(Stress { on, .. }) if case.particle_group(on.group_name()).is_none() => Some(on),
        _ => None,
    })
}

/// Nodes of the elements of bodies whose stress probes measure, as the mesh numbers them. All processes must call it.
///
/// - `bodies`: groups of the bodies
pub(super) fn measured_nodes(case: &Case, mesh: &Mesh, bodies: &[usize], exchange: &dyn Exchange) -> Vec<u32> {
    let is_measured = |element: u32, on: &Selection| {
        let is_named = on.group.as_ref().is_none_or(|name| {
            mesh.group(&name.value).iter().any(|group| group.tetrahedra.binary_search(&element).is_ok())
        });
        let nodes = mesh.tetrahedra[element as usize];
        let middle = || nodes.iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / 4.0;
        is_named && on.within.as_ref().is_none_or(|within| within.value.holds_at(middle()))
    };
    let elements = bodies.iter().flat_map(|&body| &mesh.groups[body].tetrahedra);
    let measured = elements.filter(|&&element| measured(case).any(|on| is_measured(element, on)));
    let mut own: Vec<u32> = measured.flat_map(|&element| mesh.tetrahedra[element as usize]).collect();
    own.sort_unstable();
    own.dedup();
    gather(exchange, &own).concat()
}

/// Elements of groups that probes name and that are not those of bodies.
pub(super) struct NamedElements {
    /// Group, body and number in that of each.
    elements: Vec<(usize, usize, u32)>,
}

impl NamedElements {
    /// All processes must call it.
    ///
    /// - `bodies`: groups of the bodies, of which the whole has the elements of process 0 first, and so on
    pub(super) fn of(case: &Case, mesh: &Mesh, bodies: &[usize], exchange: &dyn Exchange) -> Self {
        let damaged = case.probes.iter().filter_map(|probe| match &probe.kind {
            ProbeKind::Damaged(Damaged { group, .. }) => group.as_ref(),
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
    pub(super) fn put(&self, mesh: &mut Mesh, bodies: &[usize], shares: &[BodyShare]) {
        for &(group, body, number) in &self.elements {
            if let Some(place) = shares[body].place(number) {
                let element = mesh.groups[bodies[body]].tetrahedra[place];
                mesh.groups[group].tetrahedra.push(element);
            }
        }
        mesh.groups.iter_mut().for_each(|group| group.tetrahedra.sort_unstable());
    }
}
