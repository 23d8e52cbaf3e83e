//! What the bonds of a network bore when their forces were found.

use rayon::prelude::*;

use super::block::LOADS;
use super::law::BondLaw;
use super::loads::{LoadLanes, LoadSizes};
use super::network::BondNetwork;
use crate::particles::Particles;

impl<L: BondLaw> BondNetwork<L> {
    /// [`BondNetwork::add_forces`], which also keeps what [`BondNetwork::load_sizes`] tells of these forces.
    pub fn add_forces_and_loads(&mut self, particles: &mut Particles) {
        self.add_forces_of::<LOADS>(particles);
    }

    /// Whether what some bonds side by side bear, and the radius of their sections [m], meet a condition; true where no loads are kept.
    pub fn any_loads(&self, meet: &(dyn Fn(&LoadLanes, f64) -> bool + Sync)) -> bool {
        let radius = self.law.section_radius();
        let any = |loads: &[LoadLanes]| loads.iter().any(|lanes| meet(lanes, radius));
        self.blocks.par_iter().any(|block| block.loads.len() != block.groups.len() || any(&block.loads))
    }

    /// What a bond bore at the last [`BondNetwork::add_forces_and_loads`], to rounding; none where that keeps nothing.
    pub fn load_sizes(&self, bond: usize) -> Option<LoadSizes> {
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        let lanes = self.blocks[block].loads.get(group)?;
        let [normal, mean_bending, largest_bending, torsion] = lanes.map(|of| of[lane]);
        Some(LoadSizes { normal, mean_bending, largest_bending, torsion, radius: self.law.section_radius() })
    }
}
