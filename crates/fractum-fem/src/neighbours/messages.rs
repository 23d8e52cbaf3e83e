//! What ranks send each other of cells and nodes.

use fractum_math::Vec3;
use fractum_parallel::gather;

use super::block_state::BlockState;
use super::remote_cells::SentEdge;
use super::subdomain::{Nodes, Subdomain, gather_vectors};
use crate::damage::edge::EdgeField;
use crate::solid::evaluate::Block;

impl Subdomain {
    /// Gives all ranks the edges that have just broken.
    pub(super) fn exchange_broken(&mut self, blocks: &mut [Block]) {
        let own = self.own();
        let of_block = |index: usize| {
            let fresh = blocks[index].edge_field().map_or(&[][..], |field| &field.fresh);
            fresh.iter().map(move |&edge| (index as u32, edge))
        };
        let edges: Vec<(u32, u32)> = own.clone().flat_map(of_block).collect();
        let sent = self.exchange_edges(blocks, &edges);
        for (block, edge) in sent.iter().filter(|(block, _)| !own.contains(&(*block as usize))) {
            let other = &mut blocks[*block as usize];
            let remote = self.bodies.get(other.body).and_then(|body| body.remote.as_ref());
            let place = remote.map_or(Some(edge.cell as usize), |remote| remote.place(*block, edge.cell));
            let place = place.expect("it was received") as u32;
            other.edge_field_mut().into_iter().for_each(|field| field.fresh.push(place));
        }
    }

    /// Gives all ranks the histories of some edges (block, cell), which they may name or not; those that any rank of them has.
    pub(super) fn exchange_edges(&mut self, blocks: &mut [Block], edges: &[(u32, u32)]) -> Vec<(u32, SentEdge)> {
        let own = self.own();
        let mine = edges.iter().filter(|(block, _)| own.contains(&(*block as usize)));
        let sent =
            |&(block, cell): &(u32, u32)| Some((block, blocks[block as usize].edge_field()?.sent(cell as usize)));
        let mine: Vec<(u32, SentEdge)> = mine.filter_map(sent).collect();
        let all = gather(&*self.exchange, &mine).concat();
        for (index, edge) in all.iter().filter(|(block, _)| !own.contains(&(*block as usize))) {
            let block = &mut blocks[*index as usize];
            let remote = self.bodies.get_mut(block.body).and_then(|body| body.remote.as_mut());
            match (block.edge_field_mut(), remote) {
                (Some(field), Some(remote)) => remote.put(*index, field, edge),
                (Some(field), None) => edge.put_in(field),
                (None, _) => {}
            }
        }
        all
    }

    /// Gives all ranks displacements and velocities of all nodes.
    pub(super) fn gather_motion(&mut self, displacement: &mut [Vec3], velocity: &mut [Vec3]) {
        if self.needs.present < Nodes::All {
            self.gather_nodes(displacement);
            self.gather_nodes(velocity);
            self.needs.present = Nodes::All;
        }
    }

    /// Gives all ranks a value of every node, once each has those of its own blocks.
    pub(super) fn gather_nodes(&mut self, values: &mut [Vec3]) {
        gather_vectors(&mut self.all.gathered, &*self.exchange, values);
        if self.is_divided() {
            // Where memory is short this is more than a share of it.
            self.all.gathered.release();
        }
    }

    /// Gets displacements and velocities of the nodes whose sums this rank takes.
    pub(super) fn fetch_summed(&mut self, displacement: &mut [Vec3], velocity: &mut [Vec3]) {
        if self.needs.present < Nodes::Summed {
            self.sums.fetch(&*self.exchange, displacement);
            self.sums.fetch(&*self.exchange, velocity);
        }
    }

    /// Gives all ranks the energies of all blocks, which have been summed.
    pub(super) fn exchange_energies(&mut self, blocks: &mut [Block]) {
        let own = self.own();
        let energies = |block: &Block| [block.energy.unwrap_or(0.0), block.dissipated, block.rubbed];
        let mine: Vec<f64> = blocks[own.clone()].iter().flat_map(energies).collect();
        let counts: Vec<usize> = self.order.first.windows(2).map(|first| 3 * (first[1] - first[0])).collect();
        let mut all = vec![0.0; 3 * blocks.len()];
        self.exchange.gather(&mine, &counts, &mut all);
        let of_others = blocks.iter_mut().zip(all.as_chunks().0).enumerate().filter(|(index, _)| !own.contains(index));
        for (_, (block, &[energy, dissipated, rubbed])) in of_others {
            (block.energy, block.dissipated, block.rubbed) = (Some(energy), dissipated, rubbed);
        }
    }

    /// Gives all ranks energies and histories of all cells; of blocks of which others have no more than their number energies, and
    /// what [`Subdomain::exchange_changed`] sends.
    ///
    /// - `viscous`: viscous stresses too
    pub(super) fn gather_cells(&mut self, blocks: &mut [Block], viscous: bool) {
        let (own, whole) = (self.own(), || self.order.whole.iter().cloned().flatten());
        let mine = whole().filter(|index| own.contains(index));
        let mine: Vec<BlockState> = mine.map(|index| BlockState::of(&blocks[index], viscous)).collect();
        let states = gather(&*self.exchange, &mine).into_iter().flatten();
        for (index, state) in whole().zip(states).filter(|(index, _)| !own.contains(index)) {
            state.put(&mut blocks[index], viscous);
        }
        if self.is_divided() {
            self.exchange_energies(blocks);
            self.exchange_changed(blocks);
        }
    }

    /// Gives all ranks the histories that are no longer those of the start, of blocks of which others have no more than their number.
    pub(super) fn exchange_changed(&mut self, blocks: &mut [Block]) {
        let is_whole = |index: &usize| self.order.whole.iter().any(|whole| whole.contains(index));
        let changed = self.own().filter(|index| !is_whole(index)).flat_map(|index| {
            let changed = blocks[index].edge_field().into_iter().flat_map(EdgeField::changed);
            changed.map(move |cell| (index as u32, cell as u32))
        });
        let changed: Vec<(u32, u32)> = changed.collect();
        self.exchange_edges(blocks, &changed);
    }
}
