//! From what a file defines to a raw mesh whose groups are its sets.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::Ragged;

use super::element::{self, Face};
use super::instance::{Instances, Scope};
use super::read::{Deck, Faced, Surface};
use super::sets::{Sets, unknown_labels};
use crate::mesh::list;
use crate::tagged::builder::Builder;
use crate::tagged::element_type::{ElementType, Shape};
use crate::tagged::error::Fault;
use crate::tagged::raw::Raw;

/// The raw mesh, checked as far as only this format needs it.
pub(super) fn raw(mut deck: Deck, bytes: &[u8]) -> Result<Raw, Fault> {
    check_nodes(&deck)?;
    let mut builder = Builder::default();
    builder.raw.notices = notices(&deck);
    builder.raw.notices.extend(cut(&deck, bytes));
    builder.raw.node_tags = std::mem::take(&mut deck.node_tags);
    builder.raw.nodes = std::mem::take(&mut deck.nodes);
    builder.raw.node_blocks = std::mem::take(&mut deck.node_blocks);
    builder.keep_last_places();
    let elements = labels(deck.elements.iter().map(|element| element.tag));
    let nodes = labels(builder.raw.node_tags.iter().copied());
    let element_sets = deck.element_sets.resolve(&elements, |_| Vec::new())?;
    let node_sets = deck.node_sets.resolve(&nodes, |set| nodes_of(&deck, &element_sets[set], &nodes))?;
    builder.raw.notices.extend(deck.element_sets.unknown(&elements, "element"));
    builder.raw.notices.extend(deck.node_sets.unknown(&nodes, "node"));
    builder.raw.notices.extend(deck.surfaces.iter().filter_map(|surface| surface.unknown(&elements)));

    let groups = builder.groups(&deck.element_sets, &deck.instances, "");
    builder.add_elements(&deck, &element_sets, &groups);
    let surfaces: Vec<&Surface> = deck.surfaces.iter().filter(|surface| !surface.internal).collect();
    let shown: Vec<(&str, Scope)> = surfaces.iter().map(|surface| (surface.name.as_str(), surface.scope)).collect();
    for (surface, name) in surfaces.iter().zip(names(&shown, &deck.instances)) {
        builder.add_surface(surface, &name, &deck, &elements, &element_sets)?;
    }
    builder.leave_out(std::mem::take(&mut deck.mid_nodes));
    let groups = builder.groups(&deck.node_sets, &deck.instances, "-nodes");
    builder.add_points(&deck.node_sets, &node_sets, &groups);
    builder.finish(bytes)
}

/// Indices of the corners of elements.
fn nodes_of(deck: &Deck, elements: &[u32], nodes: &[(u64, u32)]) -> Vec<u32> {
    let corners = elements.iter().flat_map(|&element| deck.elements[element as usize].corners(&deck.corners));
    let index = |label: &u64| nodes.binary_search_by_key(label, |(known, _)| *known).ok().map(|at| nodes[at].1);
    corners.filter_map(index).collect()
}

/// The names of what instances define: with that of the instance where another one, or the assembly, has the same name.
fn names(all: &[(&str, Scope)], instances: &Instances) -> Vec<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    all.iter().for_each(|(name, _)| *counts.entry(name.to_uppercase()).or_default() += 1);
    let own = |&(name, scope): &(&str, Scope)| match scope {
        Some(instance) if counts[&name.to_uppercase()] > 1 => format!("{}.{name}", instances.list[instance].name),
        _ => name.to_owned(),
    };
    all.iter().map(own).collect()
}

/// Labels with the index of what bears each, ascending.
fn labels(all: impl Iterator<Item = u64>) -> Vec<(u64, u32)> {
    let mut labels: Vec<(u64, u32)> = all.zip(0..).collect();
    labels.sort_unstable();
    labels
}

/// Refuses elements that name nodes that are not there.
fn check_nodes(deck: &Deck) -> Result<(), Fault> {
    let known: BTreeSet<u64> = deck.node_tags.iter().copied().collect();
    for element in &deck.elements {
        if let Some(node) = element.corners(&deck.corners).iter().find(|node| !known.contains(node)) {
            let message = format!("element {} names node {node}, which the file does not define", element.tag);
            return Err(Fault::inconsistent(element.at, message));
        }
    }
    Ok(())
}

fn notices(deck: &Deck) -> Vec<String> {
    let left_out: Vec<String> = deck.left_out.iter().map(|(name, count)| format!("{count} of type {name}")).collect();
    let mut notices = Vec::new();
    if !left_out.is_empty() {
        notices.push(format!("elements left out: {}", list(&left_out)));
    }
    if !deck.axisymmetric.is_empty() {
        let types: Vec<String> = deck.axisymmetric.iter().cloned().collect();
        notices.push(format!(
            "axisymmetric elements ({}) are read as a plane mesh, which fractum computes as a plate",
            list(&types)
        ));
    }
    notices
}

/// What to tell of a file that looks as if its end were missing: what it has not ended, elements that end before all nodes have some, or
/// a last number that may be the beginning of one.
fn cut(deck: &Deck, bytes: &[u8]) -> Option<String> {
    let lacks = |name: &String| format!("*{name} has no *END {name}");
    let why = match deck.ends_within {
        _ if !deck.unended.is_empty() => list(&deck.unended.iter().map(lacks).collect::<Vec<_>>()),
        Some("ELEMENT") if unused(deck) > 0 => format!("it ends with elements, and {} node(s) have none", unused(deck)),
        Some(name) if bytes.last().is_some_and(|last| !b"\r\n".contains(last)) => {
            format!("it ends with a line of *{name} without a line break")
        }
        _ => return None,
    };
    Some(format!("the file may have been cut at its end, so that elements are missing or wrong: {why}"))
}

/// Number of nodes that no element names; none where elements were left out, which may have named them.
fn unused(deck: &Deck) -> usize {
    if !deck.left_out.is_empty() {
        return 0;
    }
    let mut used: Vec<u64> = deck.corners.iter().chain(&deck.mid_nodes).copied().collect();
    used.sort_unstable();
    deck.node_tags.iter().filter(|tag| used.binary_search(tag).is_err()).count()
}

impl Surface {
    /// What to tell of elements that it lists and the mesh does not have.
    fn unknown(&self, elements: &[(u64, u32)]) -> Option<String> {
        let listed = self.faces.iter().filter_map(|(faced, _)| match faced {
            Faced::Label(label) => Some(*label),
            Faced::Set(_) => None,
        });
        unknown_labels(&format!("surface \"{}\"", self.name), listed, elements, "element")
    }
}

impl Builder {
    /// Of nodes that are defined again the last place counts.
    fn keep_last_places(&mut self) {
        let all = labels(self.raw.node_tags.iter().copied());
        let mut again: Vec<u32> = Vec::new();
        for run in all.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
            let (first, last) = (run[0].1 as usize, run[run.len() - 1].1 as usize);
            self.raw.nodes[first] = self.raw.nodes[last];
            again.extend(run[1..].iter().map(|&(_, index)| index));
        }
        if again.is_empty() {
            return;
        }
        again.sort_unstable();
        let is_again = |index: usize| again.binary_search(&(index as u32)).is_ok();
        let mut index = 0..;
        self.raw.nodes.retain(|_| !is_again(index.next().unwrap_or(0)));
        let mut index = 0..;
        self.raw.node_tags.retain(|_| !is_again(index.next().unwrap_or(0)));
        self.raw.node_blocks.retain(|&(first, _)| !is_again(first));
        for (first, _) in &mut self.raw.node_blocks {
            *first -= again.partition_point(|&gone| (gone as usize) < *first);
        }
        self.raw.notices.push(format!("{} node(s) are defined again: the last place counts", again.len()));
    }

    /// Tags of the groups of sets; none of internal ones.
    ///
    /// - `ending`: what a name gets where another kind of set has it
    fn groups(&mut self, sets: &Sets, instances: &Instances, ending: &str) -> Vec<Option<i32>> {
        let shown: Vec<(&str, Scope)> =
            sets.list.iter().filter(|set| !set.internal).map(|set| (set.name.as_str(), set.scope)).collect();
        let mut names = names(&shown, instances).into_iter();
        let mut tag = |at: usize| names.next().map(|name| self.group(&name, at, ending));
        sets.list.iter().map(|set| if set.internal { None } else { tag(set.at) }).collect()
    }

    fn add_elements(&mut self, deck: &Deck, sets: &[Vec<u32>], groups: &[Option<i32>]) {
        let of_elements = Ragged::inverse(deck.elements.len(), sets.iter().map(Vec::as_slice));
        let instances: Vec<i32> = match deck.instances.list.as_slice() {
            [] | [_] => Vec::new(),
            several => several.iter().map(|instance| self.group(&instance.name, 0, "-instance")).collect(),
        };
        for (element, sets) in deck.elements.iter().zip(of_elements.rows()) {
            let of_sets = sets.iter().filter_map(|&set| groups[set as usize]);
            let groups = of_sets.chain(element.scope.and_then(|instance| instances.get(instance)).copied()).collect();
            self.push(element.kind, groups, element.at, element.tag, element.corners(&deck.corners));
        }
    }

    fn add_surface(
        &mut self,
        surface: &Surface,
        name: &str,
        deck: &Deck,
        labels: &[(u64, u32)],
        sets: &[Vec<u32>],
    ) -> Result<(), Fault> {
        let group = self.group(name, surface.at, "-surface");
        let mut known: BTreeSet<Vec<u64>> = BTreeSet::new();
        let mut beams = 0;
        for (faced, face) in &surface.faces {
            let one: Vec<u32>;
            let members: &[u32] = match faced {
                Faced::Set(set) => &sets[*set],
                Faced::Label(label) => {
                    one = labels.binary_search_by_key(label, |(known, _)| *known).map_or(vec![], |i| vec![labels[i].1]);
                    &one
                }
            };
            for &member in members {
                let element = &deck.elements[member as usize];
                let corners = element.corners(&deck.corners);
                if element.shape() == Shape::Line {
                    beams += 1;
                    continue;
                }
                let Some(found) = element::face(element.shape(), element.shell, face) else {
                    let message = format!(
                        "surface \"{}\" takes face `{face}` of element {}, a {}, which has none of that name; \
                         expected S1 to S4 of tetrahedra, S1 to S6 of hexahedra, S1 to S3 of triangles, SPOS, SNEG, S3 to S6 of shells",
                        surface.name,
                        element.tag,
                        element.shape().singular()
                    );
                    return Err(Fault::unsupported(surface.at, message));
                };
                let corners: Vec<u64> = match found {
                    Face::Whole => corners.to_vec(),
                    Face::Side(side) => side.iter().map(|&corner| corners[corner]).collect(),
                };
                let shape = match corners.len() {
                    1 => Shape::Point,
                    2 => Shape::Line,
                    3 => Shape::Triangle,
                    _ => Shape::Quad,
                };
                // A face of an element with corners in one node may be a line or a point.
                if corners.iter().collect::<BTreeSet<_>>().len() < corners.len().min(3) {
                    continue;
                }
                if known.insert(corners.clone()) {
                    let kind = ElementType { shape, nodes: corners.len() };
                    self.push(kind, vec![group], surface.at, self.next_tag(), &corners);
                }
            }
        }
        if beams > 0 {
            self.raw.notices.push(format!("surface \"{name}\": faces of {beams} line(s) left out"));
        }
        Ok(())
    }

    fn add_points(&mut self, sets: &Sets, members: &[Vec<u32>], groups: &[Option<i32>]) {
        let count = self.raw.node_tags.len();
        let of_nodes = Ragged::inverse(count, members.iter().map(Vec::as_slice));
        let kind = ElementType { shape: Shape::Point, nodes: 1 };
        for (node, own) in of_nodes.rows().enumerate() {
            let own: Vec<u32> = own.iter().copied().filter(|&set| groups[set as usize].is_some()).collect();
            let Some(first) = own.first() else { continue };
            let at = sets.list[*first as usize].at;
            let groups = own.iter().filter_map(|&set| groups[set as usize]).collect();
            self.push(kind, groups, at, self.next_tag(), &[self.raw.node_tags[node]]);
        }
    }
}
