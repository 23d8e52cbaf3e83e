//! Elements turned inside out.

use std::borrow::Cow;

use fractum_math::Vec3;

use crate::body::Formulation;
use crate::element::{InvertedElement, measure_and_gradients};
use crate::solid::Solid;
use crate::solid::evaluate::Block;

impl Solid {
    /// An element of a corotational body that the last forces found turned inside out while it still carried load.
    ///
    /// Its strain is beyond -1, where the law of small stretches says nothing. Where strains are those of an edge, it is the worst element
    /// around one whose mean deformation is turned inside out.
    pub fn inverted_element(&self) -> Option<InvertedElement> {
        match self.part.as_ref().filter(|part| part.is_divided()) {
            Some(part) => part.records.inverted,
            None => self.inverted_of(&self.blocks),
        }
    }

    /// That of the first of some blocks that has one.
    pub(crate) fn inverted_of(&self, blocks: &[Block]) -> Option<InvertedElement> {
        let (block, cell) = blocks.iter().find_map(|block| Some((block, block.inverted?)))?;
        let (body, model, item) = (block.body, &self.bodies[block.body], block.items[cell]);
        let one = [item];
        let of_edge = model.smoothed_edges().map_or(Cow::Borrowed(&[][..]), |edges| edges.around(item));
        let elements = match model.body.formulation {
            Formulation::Standard => &one[..],
            Formulation::Smoothed => &of_edge,
        };
        let corners = model.body.shape.node_count();
        let of = |&element: &u32| {
            let nodes = model.body.elements[element as usize].map(|node| node as usize);
            let measure = |place: &dyn Fn(usize) -> Vec3| measure_and_gradients(model.body.shape, &nodes.map(place)).0;
            let volume_ratio = measure(&|node| self.position(node)) / measure(&|node| self.reference[node]);
            let centre = nodes[..corners].iter().map(|&n| self.position(n)).sum::<Vec3>() / corners as f64;
            let element = model.divided.as_ref().map_or(element, |divided| divided.numbers[element as usize]);
            InvertedElement { body, element, centre, volume_ratio }
        };
        let alive = elements.iter().filter(|&&element| model.alive[element as usize]);
        alive.map(of).min_by(|a, b| a.volume_ratio.total_cmp(&b.volume_ratio))
    }
}
