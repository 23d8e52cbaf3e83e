//! Physical groups, from the memberships of the runs.

use std::collections::BTreeMap;

use super::element_type::Shape;
use super::error::Fault;
use super::raw::{Membership, PhysicalName, Raw, Run};
use super::table::Tables;
use crate::Group;
use crate::mesh::empty_groups;
use crate::mesh::list;

/// Groups per element, on average, beyond which a file is refused: entities that list thousands of groups could ask
/// for memory far beyond their own size.
const MOST_GROUPS_PER_ELEMENT: usize = 64;

/// Physical groups beyond which a file is refused.
const MOST_GROUPS: usize = 1 << 16;

/// Refuses files whose groups would hold a multiple of their elements.
pub(super) fn limit_memberships(raw: &Raw, bytes: &[u8]) -> Result<(), Fault> {
    let mut total = 0usize;
    for run in &raw.runs {
        let groups = raw.physical_tags(run).len();
        total = total.saturating_add(run.count.saturating_mul(groups));
        if total / MOST_GROUPS_PER_ELEMENT > raw.element_tags.len() {
            let message = format!(
                "element {} lies in {groups} physical groups; fractum reads up to {MOST_GROUPS_PER_ELEMENT} per \
                 element on average",
                raw.element_tags[run.first]
            );
            return Err(Fault::unsupported(run.locate(bytes, 0), message));
        }
    }
    Ok(())
}

fn made_up_name(tag: i32) -> String {
    format!("physical-{tag}")
}

/// The groups of a file, ascending by dimension and tag, with those that have a name but no elements.
pub(super) fn build(raw: &Raw, tables: &Tables, bytes: &[u8], notices: &mut Vec<String>) -> Result<Vec<Group>, Fault> {
    let mut groups = named_groups(&raw.names)?;
    let mut nameless: Vec<String> = Vec::new();
    let mut positions = [0usize; 5];
    for run in &raw.runs {
        let shape = run.kind.shape;
        let from = positions[shape as usize];
        let range = from..from + run.count;
        positions[shape as usize] += run.count;
        for &tag in raw.physical_tags(run) {
            let dimension = shape.dimension();
            if groups.len() == MOST_GROUPS && !groups.contains_key(&(dimension, tag)) {
                return Err(too_many_groups(run.locate(bytes, 0)));
            }
            let group = groups.entry((dimension, tag)).or_insert_with(|| {
                let name = made_up_name(tag);
                nameless.push(format!("\"{name}\" of dimension {dimension}"));
                Group { name, dimension, tag, ..Group::default() }
            });
            match shape {
                Shape::Point => tables.points.push_members(range.clone(), &mut group.points),
                Shape::Line => tables.lines.push_members(range.clone(), &mut group.lines),
                Shape::Triangle => tables.triangles.push_members(range.clone(), &mut group.triangles),
                _ => tables.tetrahedra.push_members(range.clone(), &mut group.tetrahedra),
            }
        }
    }
    let mut groups: Vec<Group> = groups.into_values().collect();
    for group in &mut groups {
        let Group { points, lines, triangles, tetrahedra, .. } = group;
        for members in [points, lines, triangles, tetrahedra] {
            members.sort_unstable();
            members.dedup();
        }
    }
    if !nameless.is_empty() {
        notices.push(format!("physical group(s) without a name: called {}", list(&nameless)));
    }
    note_empty_groups(raw, &groups, notices);
    note_unlisted_entities(raw, notices);
    Ok(groups)
}

fn named_groups(names: &[PhysicalName]) -> Result<BTreeMap<(u8, i32), Group>, Fault> {
    let mut groups: BTreeMap<(u8, i32), Group> = BTreeMap::new();
    for PhysicalName { dimension, tag, name, at } in names {
        if groups.len() == MOST_GROUPS && !groups.contains_key(&(*dimension, *tag)) {
            return Err(too_many_groups(*at));
        }
        let group = Group { name: name.clone(), dimension: *dimension, tag: *tag, ..Group::default() };
        if let Some(other) = groups.insert((*dimension, *tag), group)
            && other.name != *name
        {
            let message = format!(
                "physical tag {tag} of dimension {dimension} is named \"{}\" and \"{name}\"; expected one name",
                other.name
            );
            return Err(Fault::inconsistent(*at, message));
        }
    }
    Ok(groups)
}

fn too_many_groups(at: usize) -> Fault {
    Fault::unsupported(
        at,
        format!("found more than {MOST_GROUPS} physical groups; give parts that act alike one group"),
    )
}

fn note_empty_groups(raw: &Raw, groups: &[Group], notices: &mut Vec<String>) {
    let Some(notice) = empty_groups(groups.iter().filter(|group| group.element_count() == 0)) else { return };
    let without_tags = |run: &Run| matches!(run.membership, Membership::Physical(0));
    let hint = if raw.runs.iter().all(without_tags) {
        "; MSH 2.2 saved with all elements (Mesh.SaveAll) loses its groups, save without it or as MSH 4.1"
    } else {
        ""
    };
    notices.push(notice + hint);
}

fn note_unlisted_entities(raw: &Raw, notices: &mut Vec<String>) {
    let Some(entities) = &raw.entities else { return };
    let unlisted = |run: &&Run| match run.membership {
        Membership::Physical(_) => false,
        Membership::Entity(tag) => !entities.contains_key(&(run.kind.shape.dimension(), tag)),
    };
    let count: usize = raw.runs.iter().filter(unlisted).map(|run| run.count).sum();
    if count > 0 {
        notices.push(format!("{count} element(s) lie on entities that $Entities does not list: they are in no group"));
    }
}
