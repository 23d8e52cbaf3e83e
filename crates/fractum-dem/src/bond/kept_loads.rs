//! What the bonds of a network bore when their forces were found.

use fractum_kernels::bond::BondLaw;
use fractum_kernels::lanes::WIDTH;
use rayon::prelude::*;

use super::block::{Block, LOADS};
use super::loads::{LoadLanes, LoadSizes};
use super::network::BondNetwork;
use crate::particles::Particles;

impl<L: BondLaw> BondNetwork<L> {
    /// [`BondNetwork::add_forces`], which also keeps what [`BondNetwork::load_sizes`] tells of these forces.
    pub fn add_forces_and_loads(&mut self, particles: &mut Particles) {
        self.add_forces_of::<LOADS>(particles);
    }

    /// Lists bonds that stand side by side where what they bear, and the radius of their sections [m], meet a condition, ascending; all where no
    /// loads are kept.
    pub fn list_by_loads(&self, meet: &(dyn Fn(&LoadLanes, f64) -> bool + Sync), list: &mut Vec<u32>) {
        let radius = self.law.section_radius();
        let listed = |block: &'_ Block<L>| {
            let is_kept = block.loads.len() == block.groups.len();
            let (first, bonds) = (block.first_bond, block.bonds as u32);
            let groups = (0..block.groups.len()).filter(move |&group| !is_kept || meet(&block.loads[group], radius));
            let of_group = move |group: usize| {
                let begin = (group * WIDTH) as u32;
                (begin..bonds.min(begin + WIDTH as u32)).map(move |bond| first + bond)
            };
            groups.flat_map(of_group).collect::<Vec<u32>>()
        };
        list.clear();
        list.par_extend(self.blocks[self.own_blocks()].par_iter().flat_map_iter(listed));
    }

    /// What a bond bore at the last [`BondNetwork::add_forces_and_loads`], to rounding; none where that keeps nothing.
    pub fn load_sizes(&self, bond: usize) -> Option<LoadSizes> {
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        let lanes = self.blocks[block].loads.get(group)?;
        let [normal, mean_bending, largest_bending, torsion] = lanes.map(|of| of[lane]);
        Some(LoadSizes { normal, mean_bending, largest_bending, torsion, radius: self.law.section_radius() })
    }
}
