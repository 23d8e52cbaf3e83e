//! From what a file defines to a raw mesh whose groups are its sets.

use std::collections::BTreeSet;

use fractum_math::Ragged;

use super::element::{self, Face};
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
    builder.raw.node_tags = std::mem::take(&mut deck.node_tags);
    builder.raw.nodes = std::mem::take(&mut deck.nodes);
    builder.raw.node_blocks = std::mem::take(&mut deck.node_blocks);
    let elements = labels(deck.elements.iter().map(|element| element.tag));
    let nodes = labels(builder.raw.node_tags.iter().copied());
    let element_sets = deck.element_sets.resolve(&elements)?;
    let node_sets = deck.node_sets.resolve(&nodes)?;
    builder.raw.notices.extend(deck.element_sets.unknown(&elements, "element"));
    builder.raw.notices.extend(deck.node_sets.unknown(&nodes, "node"));
    builder.raw.notices.extend(deck.surfaces.iter().filter_map(|surface| surface.unknown(&elements)));

    let groups = builder.groups(&deck.element_sets, "");
    builder.add_elements(&deck, &element_sets, &groups);
    for surface in &deck.surfaces {
        builder.add_surface(surface, &deck, &elements, &element_sets)?;
    }
    let groups = builder.groups(&deck.node_sets, "-nodes");
    builder.add_points(&deck.node_sets, &node_sets, &groups);
    builder.finish(bytes)
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
    if left_out.is_empty() { Vec::new() } else { vec![format!("elements left out: {}", list(&left_out))] }
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
    /// Tags of the groups of sets; none of internal ones.
    ///
    /// - `ending`: what a name gets where another kind of set has it
    fn groups(&mut self, sets: &Sets, ending: &str) -> Vec<Option<i32>> {
        sets.list.iter().map(|set| (!set.internal).then(|| self.group(&set.name, set.at, ending))).collect()
    }

    fn add_elements(&mut self, deck: &Deck, sets: &[Vec<u32>], groups: &[Option<i32>]) {
        let of_elements = Ragged::inverse(deck.elements.len(), sets.iter().map(Vec::as_slice));
        for (element, sets) in deck.elements.iter().zip(of_elements.rows()) {
            let groups = sets.iter().filter_map(|&set| groups[set as usize]).collect();
            self.push(element.kind, groups, element.at, element.tag, element.corners(&deck.corners));
        }
    }

    fn add_surface(
        &mut self,
        surface: &Surface,
        deck: &Deck,
        labels: &[(u64, u32)],
        sets: &[Vec<u32>],
    ) -> Result<(), Fault> {
        if surface.internal {
            return Ok(());
        }
        let group = self.group(&surface.name, surface.at, "-surface");
        let mut known: BTreeSet<Vec<u64>> = BTreeSet::new();
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
                let Some(found) = element::face(element.shape(), face) else {
                    let message = format!(
                        "surface \"{}\" takes face `{face}` of element {}, a {}, which has none of that name; \
                         expected S1 to S4 of tetrahedra, S1 to S3, SPOS or SNEG of triangles",
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
                let shape = match (corners.len(), element.shape()) {
                    (2, _) => Shape::Line,
                    (3, _) => Shape::Triangle,
                    _ => Shape::Quad,
                };
                if known.insert(corners.clone()) {
                    let kind = ElementType { shape, nodes: corners.len() };
                    self.push(kind, vec![group], surface.at, self.next_tag(), &corners);
                }
            }
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
