//! What one of several ranks does at the seam of its solid.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use fractum_math::{HalfSteps, Vec3};
use fractum_parallel::{gather, gather_named};

use super::body_subdomain::BodySubdomain;
use super::events::Happened;
use super::subdomain::{Nodes, Subdomain, gather_vectors};
use crate::cells::block::Slot;
use crate::damage::edge::EdgeField;
use crate::damage::phase::ActiveEdge;
use crate::divided::EdgeValue;
use crate::element::InvertedElement;
use crate::motion::inverted::inverted_of;
use crate::solid::evaluate::Block;
use crate::solid::neighbours::{Evaluate, Neighbours};
use crate::solid::{BodyModel, Solid};

impl Subdomain {
    fn body(&self, body: usize) -> Option<&BodySubdomain> {
        self.bodies.get(body)
    }

    fn is_remote(&self, body: usize) -> bool {
        self.body(body).is_some_and(|body| body.remote.is_some())
    }
}

impl Neighbours for Subdomain {
    fn cloned(&self) -> Box<dyn Neighbours> {
        Box::new(self.clone())
    }

    fn own_blocks(&self, _blocks: usize) -> Range<usize> {
        self.own()
    }

    fn halo_blocks(&self) -> Vec<usize> {
        self.halo.sums.received().map(Slot::block).collect()
    }

    fn owner(&self, block: usize) -> u32 {
        self.rank_of(block)
    }

    fn owns(&self, body: usize, element: u32) -> bool {
        let is_owned = self.body(body).and_then(|body| body.is_owned.get(element as usize));
        is_owned.is_none_or(|is_owned| *is_owned)
    }

    fn number(&self, body: usize, element: u32) -> u32 {
        let divided = self.body(body).and_then(|body| body.divided.as_ref());
        divided.map_or(element, |divided| divided.numbers[element as usize])
    }

    fn element_count(&self, body: usize, here: usize) -> usize {
        self.body(body).and_then(|body| body.divided.as_ref()).map_or(here, |divided| divided.count)
    }

    fn received_edge(&self, body: usize, edge: u32) -> Option<(usize, usize)> {
        self.body(body)?.remote.as_ref()?.find(edge)
    }

    fn received_value(&self, body: usize, place: u32) -> EdgeValue {
        let divided = self.body(body).and_then(|body| body.divided.as_ref());
        divided.and_then(|divided| divided.values.values.get(place as usize)).copied().unwrap_or_default()
    }

    fn pushed(&self, chunk: usize) -> Option<&[Range<usize>]> {
        Some(&self.halo.runs[chunk])
    }

    fn moved(&self, chunk: usize) -> Option<&[Range<usize>]> {
        self.moved_runs(chunk)
    }

    /// What others wait for comes first; the rest is done while messages travel.
    fn evaluate(&mut self, blocks: &mut [Block], evaluate: &Evaluate) {
        let Subdomain { exchange, halo, .. } = self;
        let (sums, is_outer) = (&mut halo.sums, &halo.is_outer);
        evaluate(blocks, &|block| is_outer[block]);
        let force = |slot: Slot| {
            let [x, y, z, ..] = blocks[slot.block()].forces()[slot.local()].0;
            [x, y, z]
        };
        sums.fill(force);
        sums.swap(&**exchange, &mut || evaluate(blocks, &|block| !is_outer[block]));
        sums.read(|slot, from: [f64; 3]| {
            let scratch = blocks[slot.block()].scratch.as_mut();
            let force = &mut scratch.expect("kept, since this rank has nodes of the block").force;
            force[slot.local()].0[..3].copy_from_slice(&from);
        });
    }

    fn exchange_cells(&mut self, solid: &mut Solid, measure: bool) {
        let own = self.own();
        let Happened { inverted, broken } = self.events.exchange(&*self.exchange, own.clone(), &mut solid.blocks);
        let next = std::mem::replace(&mut self.needs.next, Nodes::Own);
        let asked = if measure { Nodes::Summed } else { Nodes::Own };
        self.needs.now = if inverted { Nodes::All } else { self.needs.always.max(next).max(asked) };
        match self.needs.now {
            Nodes::Own => {}
            Nodes::Summed => self.fetch_summed(&mut solid.displacement, &mut solid.velocity),
            Nodes::All => self.gather_motion(&mut solid.displacement, &mut solid.velocity),
        }
        if measure {
            self.exchange_energies(&mut solid.blocks);
        }
        if broken {
            self.exchange_broken(&mut solid.blocks);
        }
        self.events.inverted = None;
        if inverted {
            let found = inverted_of(solid, &solid.blocks[own]);
            let found = found.map(|own| InvertedElement { element: self.number(own.body, own.element), ..own });
            self.events.inverted = gather(&*self.exchange, &found).into_iter().flatten().next();
        }
    }

    fn exchange_forces(&mut self, force: &mut [Vec3]) {
        let gathered = if self.needs.now == Nodes::All { &mut self.all.gathered } else { &mut self.everywhere };
        gather_vectors(gathered, &*self.exchange, force);
        if self.needs.now == Nodes::Summed {
            self.sums.fetch(&*self.exchange, force);
        }
    }

    fn gather_values(&mut self, values: &mut [Vec3]) {
        self.gather_nodes(values);
    }

    fn end_step(&mut self, work: &mut [HalfSteps]) {
        if self.needs.now == Nodes::Summed {
            let mut all: Vec<[f64; 4]> = work.iter().map(HalfSteps::of_motion).collect();
            self.sums.exchange(&*self.exchange, &mut all);
            work.iter_mut().zip(all).for_each(|(work, numbers)| work.set_motion(numbers));
        }
        self.needs.present = self.needs.now;
        self.steps = [self.steps[0] + u64::from(self.needs.now == Nodes::All), self.steps[1] + 1];
    }

    fn exchange_phase(&mut self, active: &mut [ActiveEdge]) {
        self.phase.gather(&*self.exchange, active);
    }

    fn gather_names(&self, own: Vec<u32>) -> Vec<u32> {
        gather_named(&*self.exchange, &own)
    }

    fn gather_blocks(&self, own: Vec<f64>) -> Vec<f64> {
        gather(&*self.exchange, &own).concat()
    }

    fn gather_cells(&self, body: usize, own: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
        if self.is_remote(body) { gather(&*self.exchange, &own).concat() } else { own }
    }

    fn largest(&self, own: f64) -> f64 {
        if !self.is_divided() {
            return own;
        }
        gather(&*self.exchange, &own).into_iter().fold(own, f64::max)
    }

    fn worst(&self, own: (f64, (usize, u32)), trace: f64) -> (f64, (usize, u32)) {
        if !self.is_divided() {
            return own;
        }
        let (frequency, (body, element)) = own;
        let divided = self.body(body).and_then(|body| body.divided.as_ref());
        let number =
            divided.map_or(element, |divided| divided.numbers.get(element as usize).copied().unwrap_or(u32::MAX));
        let all = gather(&*self.exchange, &(frequency, trace, body, number));
        let order = |a: &(f64, f64, usize, u32), b: &(f64, f64, usize, u32)| {
            b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)).then(b.1.total_cmp(&a.1)).then(a.3.cmp(&b.3))
        };
        let (frequency, _, body, number) = all.into_iter().min_by(order).expect("one of this rank at least");
        (frequency, (body, number))
    }

    fn expect_events(&mut self) {
        self.events.expect();
    }

    /// The damage of a cell is known where it is evaluated.
    fn inverted(&self, _find: &dyn Fn() -> Option<InvertedElement>) -> Option<InvertedElement> {
        self.events.inverted
    }

    /// This rank keeps the blocks of the cells from now on; of a body of which it has its own cells alone no more than the nodes.
    fn bring_cells(&mut self, solid: &mut Solid, body: usize, elements: &[u32], cells: &[(u32, u32)]) {
        let Solid { blocks, bodies, reference, slots, displacement, velocity, .. } = solid;
        if self.is_remote(body) {
            let nodes = nodes_around(&bodies[body], elements);
            return self.follow(slots, &nodes, [displacement, velocity]);
        }
        self.exchange_edges(blocks, cells);
        for &(block, _) in cells {
            let block = &mut blocks[block as usize];
            if block.cells.len() == 0 {
                block.cells = bodies[block.body].cells(reference, &block.items);
                block.edge_field_mut().into_iter().for_each(EdgeField::keep_histories);
            }
        }
        let nodes = |&(block, cell): &(u32, u32)| blocks[block as usize].cells.global_nodes(cell as usize);
        let nodes: Vec<u32> = cells.iter().flat_map(nodes).map(|node| node as u32).collect();
        self.follow(slots, &nodes, [displacement, velocity]);
    }

    fn exchange_settled(&mut self, solid: &mut Solid, body: usize, cells: &[(u32, u32)]) {
        if self.is_remote(body) {
            self.exchange_edges(&mut solid.blocks, cells);
        }
    }

    fn forget_received(&mut self, blocks: &mut [Block]) {
        let own = self.own();
        self.bodies.iter_mut().filter_map(|body| body.remote.as_mut()).for_each(|remote| remote.clear());
        let of_others =
            blocks.iter_mut().enumerate().filter(|(index, block)| !own.contains(index) && self.is_remote(block.body));
        for field in of_others.filter_map(|(_, block)| block.edge_field_mut()) {
            *field = EdgeField::of_none(Arc::clone(&field.softens));
        }
    }

    fn exchange_restored(&mut self, solid: &mut Solid) {
        let remote: BTreeSet<usize> = (0..self.bodies.len()).filter(|&body| self.is_remote(body)).collect();
        if remote.is_empty() {
            return;
        }
        let own = self.own();
        self.exchange_changed(&mut solid.blocks);
        let blocks = solid.blocks.iter_mut().enumerate();
        let of_others = blocks.filter(|(index, block)| !own.contains(index) && remote.contains(&block.body));
        of_others.filter_map(|(_, block)| block.edge_field_mut()).for_each(EdgeField::renew_fresh);
    }
}

/// Nodes of all elements of a body, alive or not, around the edges of some elements, ascending.
fn nodes_around(model: &BodyModel, elements: &[u32]) -> Vec<u32> {
    let edges = model.edges.iter().flat_map(|edges| {
        let of = elements.iter().flat_map(|&element| edges.of_element(element));
        of.flat_map(|edge| edges.around(edge).into_owned())
    });
    let mut nodes: Vec<u32> = edges.flat_map(|element| model.body.elements[element as usize]).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
