//! The seam of a solid: what is elsewhere, and what comes from there. A single process has nothing elsewhere.

use std::any::Any;
use std::fmt::Debug;
use std::ops::Range;

use fractum_math::{HalfSteps, Vec3};

use crate::damage::phase::ActiveEdge;
use crate::divided::EdgeValue;
use crate::element::InvertedElement;
use crate::solid::Solid;
use crate::solid::evaluate::Block;

/// Evaluates those of the blocks of which it is told that they are meant.
pub(crate) type Evaluate<'a> = dyn Fn(&mut [Block], &(dyn Fn(usize) -> bool + Sync)) + 'a;

/// Who has the rest of a solid: where the forces of halos are exchanged, nodes that are looked at move, and sums are taken.
///
/// The methods do nothing where this process has everything.
pub(crate) trait Neighbours: Any + Debug + Send + Sync {
    fn cloned(&self) -> Box<dyn Neighbours>;

    /// Blocks whose cells are evaluated here, of so many.
    fn own_blocks(&self, blocks: usize) -> Range<usize> {
        0..blocks
    }

    /// Blocks of others whose forces are received.
    fn halo_blocks(&self) -> Vec<usize> {
        Vec::new()
    }

    /// The rank whose block this is.
    fn owner(&self, _block: usize) -> u32 {
        0
    }

    /// Whether this process speaks for an element of a body: one does.
    fn owns(&self, _body: usize, _element: u32) -> bool {
        true
    }

    /// Number of an element of this process in the whole body.
    fn number(&self, _body: usize, element: u32) -> u32 {
        element
    }

    /// Elements of the whole body, of which so many are here.
    fn element_count(&self, _body: usize, here: usize) -> usize {
        here
    }

    /// Where the history of an edge is kept that others evaluate, once received: block, and place in its field.
    fn received_edge(&self, _body: usize, _edge: u32) -> Option<(usize, usize)> {
        None
    }

    /// What was received of an edge of a body, by its place.
    fn received_value(&self, _body: usize, _place: u32) -> EdgeValue {
        EdgeValue::default()
    }

    /// Runs of nodes of a chunk that own blocks push, counted from the first of the chunk; none where these are all.
    fn pushed(&self, _chunk: usize) -> Option<&[Range<usize>]> {
        None
    }

    /// Runs of nodes of a chunk that move here in this step; none where these are all.
    fn moved(&self, _chunk: usize) -> Option<&[Range<usize>]> {
        None
    }

    /// Has own blocks evaluated, and exchanges the forces of the halo.
    fn evaluate(&mut self, blocks: &mut [Block], evaluate: &Evaluate) {
        evaluate(blocks, &|_| true);
    }

    /// Once the own cells are evaluated: what happened in those of others, their energies if `measure`, and what nodes this step needs.
    fn exchange_cells(&mut self, _solid: &mut Solid, _measure: bool) {}

    /// Receives the forces on nodes that move here and that no own block pushes.
    fn exchange_forces(&mut self, _force: &mut [Vec3]) {}

    /// Receives the values of all nodes that others have.
    fn gather_values(&mut self, _values: &mut [Vec3]) {}

    /// After the nodes have moved: receives what others have summed over theirs, chunk by chunk.
    fn end_step(&mut self, _work: &mut [HalfSteps]) {}

    /// Exchanges the phase field of active edges after a sweep.
    fn exchange_phase(&mut self, _active: &mut [ActiveEdge]) {}

    /// What all name, in the order of their blocks.
    fn gather_names(&self, own: Vec<u32>) -> Vec<u32> {
        own
    }

    /// A value of each block, in the order of the blocks.
    fn gather_blocks(&self, own: Vec<f64>) -> Vec<f64> {
        own
    }

    /// Values of some cells of a body, each with its place among them.
    fn gather_cells(&self, _body: usize, own: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
        own
    }

    /// The largest value of all.
    fn largest(&self, own: f64) -> f64 {
        own
    }

    /// The highest frequency of all with the body and element that has it.
    ///
    /// - `trace`: of the stiffness of this element, which decides between equal ones
    fn worst(&self, own: (f64, (usize, u32)), _trace: f64) -> (f64, (usize, u32)) {
        own
    }

    /// From now on something can happen in a block that all must know.
    fn expect_events(&mut self) {}

    /// An element turned inside out that the last forces found, here by `find`.
    fn inverted(&self, find: &dyn Fn() -> Option<InvertedElement>) -> Option<InvertedElement> {
        find()
    }

    /// Before elements of a body leave: has their cells (block, cell), the histories and the nodes of these here.
    fn bring_cells(&mut self, _solid: &mut Solid, _body: usize, _elements: &[u32], _cells: &[(u32, u32)]) {}

    /// After they have left: exchanges the histories of cells that this has changed.
    fn exchange_settled(&mut self, _solid: &mut Solid, _body: usize, _cells: &[(u32, u32)]) {}

    /// Before a state is restored: forgets what was received of edges.
    fn forget_received(&mut self, _blocks: &mut [Block]) {}

    /// Once it is restored: receives the histories of edges of others.
    fn exchange_restored(&mut self, _solid: &mut Solid) {}
}

/// A process that has everything.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alone;

impl Neighbours for Alone {
    fn cloned(&self) -> Box<dyn Neighbours> {
        Box::new(Alone)
    }
}

impl Clone for Box<dyn Neighbours> {
    fn clone(&self) -> Self {
        (**self).cloned()
    }
}
