//! Elements turned inside out.

use fractum_math::Vec3;

use crate::body::Formulation;
use crate::element::measure_and_gradients;
use crate::solid::Solid;

/// An element that motion has turned inside out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvertedElement {
    /// Body it belongs to.
    pub body: usize,
    /// Its number there.
    pub element: u32,
    /// Its present centre [m].
    pub centre: Vec3,
    /// Its present volume over that without load; negative inside out.
    pub volume_ratio: f64,
}

impl Solid {
    /// An element of a corotational body that the last forces found turned inside out while it still carried load.
    ///
    /// Its strain is beyond -1, where the law of small stretches says nothing. Where strains are those of an edge, it is the worst element
    /// around one whose mean deformation is turned inside out.
    pub fn inverted_element(&self) -> Option<InvertedElement> {
        let (block, cell) = self.blocks.iter().find_map(|block| Some((block, block.inverted?)))?;
        let (body, model, item) = (block.body, &self.bodies[block.body], block.items[cell]);
        let one = [item];
        let elements = match model.body.formulation {
            Formulation::Standard => &one[..],
            Formulation::Smoothed => model.elements_of_edge.row(item as usize),
        };
        let corners = model.body.shape.node_count();
        let of = |&element: &u32| {
            let nodes = model.body.elements[element as usize].map(|node| node as usize);
            let measure = |place: &dyn Fn(usize) -> Vec3| measure_and_gradients(model.body.shape, &nodes.map(place)).0;
            let volume_ratio = measure(&|node| self.position(node)) / measure(&|node| self.reference[node]);
            let centre = nodes[..corners].iter().map(|&n| self.position(n)).sum::<Vec3>() / corners as f64;
            InvertedElement { body, element, centre, volume_ratio }
        };
        let alive = elements.iter().filter(|&&element| model.alive[element as usize]);
        alive.map(of).min_by(|a, b| a.volume_ratio.total_cmp(&b.volume_ratio))
    }
}
