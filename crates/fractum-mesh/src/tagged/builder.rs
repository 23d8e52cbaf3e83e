//! A raw mesh whose groups are named sets, which may have elements in common.

use std::collections::{BTreeMap, BTreeSet};

use super::element_type::{ElementType, Shape};
use super::error::Fault;
use super::raw::{Membership, PhysicalName, Raw, Records};
use crate::mesh::list;

/// Makes a raw mesh, element by element.
#[derive(Default)]
pub(crate) struct Builder {
    pub(crate) raw: Raw,
    /// Groups so far: name, and the place of what defines it.
    groups: Vec<(String, usize)>,
    taken: BTreeSet<String>,
    /// Number of the entity of a dimension that has exactly these groups.
    entities: BTreeMap<(u8, Vec<i32>), i32>,
    /// Dimensions in which a group has elements.
    dimensions: BTreeSet<(u8, i32)>,
    highest_tag: u64,
    /// Nodes between the corners of elements, ascending, and how many points on them were left out.
    mid_nodes: Vec<u64>,
    points_left_out: usize,
}

impl Builder {
    /// Tag of a new group.
    ///
    /// - `at`: place of what defines it
    /// - `ending`: what the name gets where another group has it
    pub(crate) fn group(&mut self, name: &str, at: usize, ending: &str) -> i32 {
        let mut own = name.replace('"', "'");
        while !self.taken.insert(own.to_uppercase()) {
            let other = format!("{own}{}", if ending.is_empty() { "-2" } else { ending });
            self.raw.notices.push(format!("\"{own}\" is the name of several sets: called \"{other}\""));
            own = other;
        }
        self.groups.push((own, at));
        self.groups.len() as i32
    }

    /// The membership of what lies in these groups.
    fn membership(&mut self, dimension: u8, groups: Vec<i32>) -> Membership {
        self.dimensions.extend(groups.iter().map(|&group| (dimension, group)));
        let next = self.entities.len() as i32 + 1;
        Membership::Entity(*self.entities.entry((dimension, groups)).or_insert(next))
    }

    /// Leaves out the points on mid nodes, which no element keeps, from now on.
    pub(crate) fn leave_out(&mut self, mut mid_nodes: Vec<u64>) {
        let mut corners = if mid_nodes.is_empty() { Vec::new() } else { self.raw.corners.clone() };
        corners.sort_unstable();
        mid_nodes.retain(|node| corners.binary_search(node).is_err());
        mid_nodes.sort_unstable();
        self.mid_nodes = mid_nodes;
    }

    /// Adds an element of these groups.
    pub(crate) fn push(&mut self, kind: ElementType, groups: Vec<i32>, at: usize, tag: u64, corners: &[u64]) {
        if kind.shape == Shape::Point && self.mid_nodes.binary_search(&corners[0]).is_ok() {
            self.points_left_out += 1;
            return;
        }
        let membership = self.membership(kind.shape.dimension(), groups);
        self.raw.push_run(kind, membership, 1, Records { at, stride: 0 });
        self.raw.element_tags.push(tag);
        self.raw.corners.extend_from_slice(corners);
        self.highest_tag = self.highest_tag.max(tag);
    }

    /// A tag that no element has yet.
    pub(crate) fn next_tag(&self) -> u64 {
        self.highest_tag.saturating_add(1)
    }

    /// The mesh, with the names of all groups that have elements.
    pub(crate) fn finish(mut self, bytes: &[u8]) -> Result<Raw, Fault> {
        if self.highest_tag == u64::MAX {
            return Err(Fault::unsupported(bytes.len(), format!("element label {} is too large", u64::MAX)));
        }
        if self.points_left_out > 0 {
            let notice = format!("{} mid node(s) left out of sets of nodes", self.points_left_out);
            self.raw.notices.push(notice);
        }
        let name = |&(dimension, tag): &(u8, i32)| {
            let (name, at) = &self.groups[tag as usize - 1];
            PhysicalName { dimension, tag, name: name.clone(), at: *at }
        };
        self.raw.names = self.dimensions.iter().map(name).collect();
        let filled: BTreeSet<i32> = self.dimensions.iter().map(|(_, tag)| *tag).collect();
        let is_empty = |(_, tag): &(&(String, usize), i32)| !filled.contains(tag);
        let empty: Vec<String> =
            self.groups.iter().zip(1..).filter(is_empty).map(|((name, _), _)| format!("\"{name}\"")).collect();
        if !empty.is_empty() {
            self.raw.notices.push(format!("sets without elements or nodes of the mesh: {}", list(&empty)));
        }
        let entities = self.entities.into_iter().map(|((dimension, groups), tag)| ((dimension, tag), groups));
        self.raw.entities = Some(entities.collect());
        Ok(self.raw)
    }
}
