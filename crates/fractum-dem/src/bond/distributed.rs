//! The bonds that one of several ranks computes: blocks of its own, whose sums at particles of others it sends.

use std::ops::Range;

use fractum_kernels::bond::BondLaw;
use fractum_parallel::gather;
use rayon::prelude::*;

use super::block::{BOUNDS, Block, VIRIALS, sum_bonds};
use super::network::{BLOCK, BondNetwork};
use super::subdomain::BondSubdomain;
use crate::particles::{ParticleSubdomain, Particles};

impl<L: BondLaw> BondNetwork<L> {
    /// Leaves the blocks of bonds to the ranks that have their first particles.
    pub fn distribute(&mut self, part: &ParticleSubdomain) {
        let part = BondSubdomain::new(part, &self.blocks);
        for [block, _] in part.received() {
            self.blocks[block as usize].make_room_for_details();
        }
        self.part = Some(Box::new(part));
    }

    /// Whether several ranks may share the bonds: those beside a mean strain need all bonds around their particles.
    pub fn can_be_shared(&self) -> bool {
        self.mean.is_none()
    }

    /// Whether bonds remember anything.
    pub fn has_memory(&self) -> bool {
        size_of::<L::Memory>() > 0
    }

    /// Blocks whose bonds this process computes.
    pub(super) fn own_blocks(&self) -> Range<usize> {
        self.part.as_ref().map_or(0..self.blocks.len(), |part| part.own())
    }

    /// Entries of the particles of own blocks, and these blocks.
    pub(super) fn own_of<'a, T>(&self, of_particles: &'a mut [T]) -> (&'a mut [T], &[Block<L>]) {
        let own = self.own_blocks();
        let (begin, end) = (own.start * BLOCK, (own.end * BLOCK).min(of_particles.len()));
        (&mut of_particles[begin.min(end)..end], &self.blocks[own])
    }

    /// Bonds of these blocks.
    pub(crate) fn own_bonds(&self) -> Range<usize> {
        let begin = |block: usize| self.blocks.get(block).map_or(self.len(), |block| block.first_bond as usize);
        let Range { start, end } = self.own_blocks();
        begin(start)..begin(end)
    }

    /// Sums what is wanted of the own bonds at the present positions, and gets the sums of others at own particles.
    pub(super) fn sum_own<const FORCES: bool, const DETAIL: u8>(&mut self, particles: &Particles) {
        let Particles { position, orientation, .. } = particles;
        let own = self.own_blocks();
        let BondNetwork { law, blocks, part, .. } = self;
        let sum = |block: &mut Block<L>| sum_bonds::<L, FORCES, DETAIL>(block, position, orientation, law);
        let Some(part) = part else {
            each(blocks, None, &sum);
            return;
        };
        let some = |blocks: &mut [Block<L>], is_outer: &[bool], outer: bool| {
            each(&mut blocks[own.clone()], Some((&is_outer[own.clone()], outer)), &sum);
        };
        some(blocks, part.is_outer(), true);
        let inner = |blocks: &mut [Block<L>], is_outer: &[bool]| some(blocks, is_outer, false);
        match (FORCES, DETAIL) {
            (true, VIRIALS) => part.swap(
                blocks,
                |block, slot| joined(block.sums[slot], block.virials[slot]),
                |block, slot, from: [f64; 12]| (block.sums[slot], block.virials[slot]) = parted(from),
                inner,
            ),
            (true, BOUNDS) => part.swap(
                blocks,
                |block, slot| {
                    let ([x, y, z, a, b, c], [most, least]) = (block.sums[slot], block.virial_bounds[slot]);
                    [x, y, z, a, b, c, most, least]
                },
                |block, slot, [x, y, z, a, b, c, most, least]: [f64; 8]| {
                    (block.sums[slot], block.virial_bounds[slot]) = ([x, y, z, a, b, c], [most, least]);
                },
                inner,
            ),
            (true, _) => part.swap(
                blocks,
                |block, slot| block.sums[slot],
                |block, slot, from: [f64; 6]| block.sums[slot] = from,
                inner,
            ),
            (false, _) => part.swap(
                blocks,
                |block, slot| block.virials[slot],
                |block, slot, from: [f64; 6]| block.virials[slot] = from,
                inner,
            ),
        }
    }

    /// Values of all blocks, by those of own ones.
    pub(super) fn of_all_blocks<const N: usize>(&self, of: &(dyn Fn(&Block<L>) -> [f64; N] + Sync)) -> Vec<[f64; N]> {
        let own = self.own_blocks();
        let mine: Vec<[f64; N]> = self.blocks[own].par_iter().map(of).collect();
        let Some(part) = &self.part else { return mine };
        part.of_all(&mine, self.blocks.len())
    }

    /// Brings the memory of some bonds up to date on every rank. All ranks must name the same ones.
    pub fn gather_memory(&mut self, bonds: impl Iterator<Item = u32>) {
        let own = self.own_bonds();
        if let Some(part) = self.part.as_ref().filter(|_| self.has_memory()) {
            let mine = bonds.filter(|&bond| own.contains(&(bond as usize)));
            let mine: Vec<(u32, L::Memory)> = mine.map(|bond| (bond, self.memory_of(bond as usize))).collect();
            for (bond, memory) in gather(part.exchange(), &mine).into_iter().flatten() {
                self.put_memory(bond as usize, memory);
            }
        }
    }
}

/// Evaluates all blocks, or those of which it is known whether they are outer ones. Apart from what is summed, so that the parallel loop is compiled
/// once for a law.
fn each<L: BondLaw>(
    blocks: &mut [Block<L>],
    meant: Option<(&[bool], bool)>,
    evaluate: &(dyn Fn(&mut Block<L>) + Sync),
) {
    blocks.par_iter_mut().enumerate().for_each(|(number, block)| {
        if meant.is_none_or(|(is_outer, outer)| is_outer[number] == outer) {
            evaluate(block);
        }
    });
}

fn joined(one: [f64; 6], other: [f64; 6]) -> [f64; 12] {
    std::array::from_fn(|k| if k < 6 { one[k] } else { other[k - 6] })
}

fn parted(both: [f64; 12]) -> ([f64; 6], [f64; 6]) {
    (std::array::from_fn(|k| both[k]), std::array::from_fn(|k| both[k + 6]))
}
