//! What bonds bear, kept from the pass over their forces for criteria that look at every one.

use rayon::prelude::*;

use super::block::{LOADS, WIDTH};
use super::lanes::{Lanes, Vector, dot, scale, sub};
use super::law::{BondLaw, ForceLanes};
use super::network::BondNetwork;
use crate::particles::Particles;

/// Sizes of what a bond bears.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadSizes {
    /// Axial force [N], positive in tension.
    pub normal: f64,
    /// Bending moment at the middle, ½ |M₁ − M₂| of the moments on the two ends [N m].
    pub mean_bending: f64,
    /// The larger bending moment of both ends [N m].
    pub largest_bending: f64,
    /// Torsional moment [N m].
    pub torsion: f64,
    /// Radius of its section [m].
    pub radius: f64,
}

/// [`LoadSizes`] of bonds side by side, in the order of its first four fields.
pub type LoadLanes = [[f64; WIDTH]; 4];

#[inline(always)]
pub(super) fn load_sizes(gap: Vector<WIDTH>, forces: &ForceLanes<WIDTH>) -> LoadLanes {
    let n = scale(gap, dot(gap, gap).sqrt().recip());
    let across = |m: Vector<WIDTH>| sub(m, scale(n, dot(m, n)));
    let [first, second] = forces.moment.map(across);
    let difference = sub(first, second);
    let mean = dot(difference, difference).sqrt() * Lanes::splat(0.5);
    let (a, b) = (dot(first, first), dot(second, second));
    let largest = Lanes::<WIDTH>::of(|k| a.0[k].max(b.0[k])).sqrt();
    [(-dot(forces.force, n)).0, mean.0, largest.0, dot(forces.moment[0], n).0]
}

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
