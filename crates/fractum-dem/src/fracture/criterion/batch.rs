//! Criteria over whole bodies: compiled for each criterion, called once for all particles or bonds.

use std::ops::Range;

use fractum_math::Sym3;
use rayon::prelude::*;
use serde::Serialize;

use super::{AtWalls, BondLoad, BreakMode, Level, LoadCriterion, MOST, StressCriterion};
use crate::bond::{BondGraph, LoadLanes, LoadSizes};

/// Particles or bonds handled as one block by the parallel loops.
const BLOCK: usize = 1024;

/// What fails first under a criterion: a particle, or a bond for a criterion of single bonds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FailureSite {
    /// Particle or bond.
    pub index: u32,
    /// What it bears over what it can bear.
    pub ratio: f64,
}

/// What the search in a block of sites has found.
#[derive(Default)]
pub(in crate::fracture) struct BlockSearch {
    pub(in crate::fracture) worst: Option<FailureSite>,
    pub(in crate::fracture) overloaded: Vec<FailureSite>,
}

impl BlockSearch {
    fn largest(&self) -> f64 {
        self.worst.map_or(0.0, |worst| worst.ratio)
    }

    #[inline]
    fn add(&mut self, index: usize, ratio: f64, limit: f64) {
        let site = FailureSite { index: index as u32, ratio };
        if ratio > self.largest() {
            self.worst = Some(site);
        }
        if ratio >= limit {
            self.overloaded.push(site);
        }
    }
}

/// One over the factor on the strength of a site.
#[inline]
pub(in crate::fracture) fn weakness_of(weakness: &[f64], site: usize) -> f64 {
    weakness.get(site).copied().unwrap_or(1.0)
}

/// The neighbourhoods over which stress is taken, and the virials of their particles.
pub(in crate::fracture) struct Neighbourhoods<'a> {
    pub(in crate::fracture) graph: &'a BondGraph,
    pub(in crate::fracture) members: &'a [Vec<u32>],
    pub(in crate::fracture) inverse: &'a [f64],
    pub(in crate::fracture) virials: &'a [Sym3],
    /// One over the factor on the strength of each; empty where all are 1.
    pub(in crate::fracture) weakness: &'a [f64],
    /// What takes stress to walls.
    pub(in crate::fracture) at_walls: Option<&'a AtWalls>,
    /// First one that is looked at.
    pub(in crate::fracture) first: usize,
}

impl Neighbourhoods<'_> {
    /// Virial stress of neighbourhood `i` [Pa].
    #[inline]
    fn stress(&self, i: usize, level: Level) -> Sym3 {
        let mut sum = self.virials[i];
        match level {
            Level::Own => {}
            Level::Neighbours => self.graph.neighbours(i).for_each(|h| sum += self.virials[h.other as usize]),
            Level::Second => self.members[i].iter().for_each(|&j| sum += self.virials[j as usize]),
        }
        sum * self.inverse[i]
    }

    /// What neighbourhood `i` bears over what it can bear, unless that is below `from`; at a wall that of the wall, which takes the place of
    /// `stress`. The reading there is at most [`MOST`] times that of the neighbourhood, so that what scatters cannot double it.
    #[inline]
    fn ratio(&self, i: usize, criterion: &impl StressCriterion, stress: &mut Sym3, from: f64) -> Option<f64> {
        let weakness = weakness_of(self.weakness, i);
        let at_wall = self.at_walls.filter(|at_walls| at_walls.holds(i));
        let most = at_wall.map_or(1.0, |_| MOST);
        // Eigenvalues only where they could matter.
        if criterion.bound(stress) * weakness * most < from {
            return None;
        }
        let ratio = criterion.ratio(stress);
        let Some(at_walls) = at_wall else { return Some(ratio * weakness) };
        *stress += at_walls.difference(i, self.virials);
        Some(criterion.ratio(stress).min(most * ratio) * weakness)
    }

    /// Whether one of neighbourhood `i` fulfils a condition.
    #[inline]
    fn any_member(&self, i: usize, level: Level, is: impl Fn(usize) -> bool) -> bool {
        is(i)
            || match level {
                Level::Own => false,
                Level::Neighbours => self.graph.neighbours(i).any(|h| is(h.other as usize)),
                Level::Second => self.members[i].iter().any(|&j| is(j as usize)),
            }
    }
}

/// A criterion of stress over all particles.
pub(in crate::fracture) trait StressBatch: StressCriterion {
    /// Whether the bounds of some particle's virial [N m] allow a ratio of at least `limit`.
    fn bounds_reach(&self, bounds: &[[f64; 2]], volume: &[f64], fraction: f64, limit: f64) -> bool;

    /// Notes the particles whose virial alone [N m] allows a ratio of at least `limit`; whether there are any.
    fn virials_reach(&self, virials: &[Sym3], volume: &[f64], fraction: f64, limit: f64, reaching: &mut [bool])
    -> bool;

    /// Stresses of neighbourhoods from the first one on, and what the criterion says of them.
    fn search(&self, around: &Neighbourhoods<'_>, stress: &mut [Sym3], limit: f64) -> Vec<BlockSearch>;

    /// The same for neighbourhoods of `reaching` particles alone.
    fn search_among(
        &self,
        around: &Neighbourhoods<'_>,
        reaching: &[bool],
        stress: &mut [Sym3],
        limit: f64,
    ) -> Vec<BlockSearch>;
}

impl<C: StressCriterion> StressBatch for C {
    fn bounds_reach(&self, bounds: &[[f64; 2]], volume: &[f64], fraction: f64, limit: f64) -> bool {
        let reaches = |bounds: &[[f64; 2]], volume: &[f64]| {
            bounds.iter().zip(volume).any(|(&[tension, compression], volume)| {
                self.bound_between(tension, compression) * fraction >= limit * volume
            })
        };
        any_block(bounds, volume, &reaches)
    }

    fn virials_reach(
        &self,
        virials: &[Sym3],
        volume: &[f64],
        fraction: f64,
        limit: f64,
        reaching: &mut [bool],
    ) -> bool {
        let limit = limit * (1.0 - ROUND_OFF);
        let reach = |reaching: &mut [bool], virials: &[Sym3], volume: &[f64]| {
            let mut any = false;
            for (reaching, (virial, volume)) in reaching.iter_mut().zip(virials.iter().zip(volume)) {
                *reaching = self.bound(&(*virial * (fraction / volume))) >= limit;
                any |= *reaching;
            }
            any
        };
        fill_blocks(reaching, virials, volume, &reach)
    }

    fn search(&self, around: &Neighbourhoods<'_>, stress: &mut [Sym3], limit: f64) -> Vec<BlockSearch> {
        let level = self.level();
        search_blocks(around.first, stress, |i, stress, found| {
            *stress = around.stress(i, level);
            if let Some(ratio) = around.ratio(i, self, stress, limit.min(found.largest())) {
                found.add(i, ratio, limit);
            }
        })
    }

    fn search_among(
        &self,
        around: &Neighbourhoods<'_>,
        reaching: &[bool],
        stress: &mut [Sym3],
        limit: f64,
    ) -> Vec<BlockSearch> {
        let level = self.level();
        search_blocks(around.first, stress, |i, stress, found| {
            if around.any_member(i, level, |member| reaching[member]) {
                *stress = around.stress(i, level);
                if let Some(ratio) = around.ratio(i, self, stress, limit) {
                    found.add(i, ratio, limit);
                }
            }
        })
    }
}

/// Looks at particles from the first one on and their stresses, block by block.
fn search_blocks(
    first: usize,
    stress: &mut [Sym3],
    look: impl Fn(usize, &mut Sym3, &mut BlockSearch) + Sync,
) -> Vec<BlockSearch> {
    let block = |(block, stress): (usize, &mut [Sym3])| {
        let mut found = BlockSearch::default();
        (first + block * BLOCK..).zip(stress).for_each(|(i, stress)| look(i, stress, &mut found));
        found
    };
    blocks_of(stress, &block)
}

// The parallel loops stand apart from the laws, so that they are compiled once and not for each of them.

/// What is found in a block of stresses, by its number.
type Search<'a> = dyn Fn((usize, &mut [Sym3])) -> BlockSearch + Sync + 'a;
/// Whether something holds for a block of bounds and volumes.
type Holds<'a> = dyn Fn(&[[f64; 2]], &[f64]) -> bool + Sync + 'a;
/// Fills a block from virials and volumes, and says whether something was found.
type Fill<'a> = dyn Fn(&mut [bool], &[Sym3], &[f64]) -> bool + Sync + 'a;

/// What is found in each block of stresses.
fn blocks_of(stress: &mut [Sym3], of_block: &Search<'_>) -> Vec<BlockSearch> {
    stress.par_chunks_mut(BLOCK).enumerate().map(of_block).collect()
}

/// Whether something holds for a block of bounds and volumes.
fn any_block(bounds: &[[f64; 2]], volume: &[f64], holds: &Holds<'_>) -> bool {
    bounds.par_chunks(BLOCK).zip(volume.par_chunks(BLOCK)).any(|(bounds, volume)| holds(bounds, volume))
}

/// Fills all blocks, whatever was found in others; whether one of them found something.
fn fill_blocks(reaching: &mut [bool], virials: &[Sym3], volume: &[f64], fill: &Fill<'_>) -> bool {
    let blocks = reaching.par_chunks_mut(BLOCK).zip(virials.par_chunks(BLOCK)).zip(volume.par_chunks(BLOCK));
    blocks
        .map(|((reaching, virials), volume)| fill(reaching, virials, volume))
        .reduce(|| false, |one, other| one || other)
}

/// What is found in each block of so many.
fn numbered_blocks(blocks: usize, of_block: &(dyn Fn(usize) -> BlockSearch + Sync)) -> Vec<BlockSearch> {
    (0..blocks).into_par_iter().map(of_block).collect()
}

/// Rounding by which the sizes of a load that are known already may miss those that are found anew.
const ROUND_OFF: f64 = 1e-9;

/// Bonds as a criterion of loads sees them.
pub(in crate::fracture) struct SeenBonds<'a> {
    /// What a bond bears.
    pub(in crate::fracture) load: &'a (dyn Fn(u32) -> BondLoad + Sync),
    /// The same, to rounding and without directions, where it is known already.
    pub(in crate::fracture) sizes: &'a (dyn Fn(u32) -> Option<LoadSizes> + Sync),
    /// One over the factor on the strength of each; empty where all are 1.
    pub(in crate::fracture) weakness: &'a [f64],
}

/// A criterion of loads over all bonds.
pub(in crate::fracture) trait LoadBatch: Sync {
    /// What the criterion says of those bonds of a range that hold.
    fn search(&self, bonds: &SeenBonds<'_>, graph: &BondGraph, range: Range<usize>, limit: f64) -> Vec<BlockSearch>;

    /// Whether one of some bonds side by side may have a ratio of at least `limit`.
    fn loads_reach(&self, loads: &LoadLanes, radius: f64, limit: f64) -> bool;

    /// What a bond bears over what it can bear.
    fn ratio_of_bond(&self, load: &BondLoad) -> f64;

    /// How a bond breaks under this load.
    fn mode(&self, load: &BondLoad) -> BreakMode;
}

impl<C: LoadCriterion> LoadBatch for C {
    fn search(&self, bonds: &SeenBonds<'_>, graph: &BondGraph, range: Range<usize>, limit: f64) -> Vec<BlockSearch> {
        let block = |block: usize| {
            let mut found = BlockSearch::default();
            let begin = range.start + block * BLOCK;
            for bond in begin..(begin + BLOCK).min(range.end) {
                let weakness = weakness_of(bonds.weakness, bond);
                let reach = |sizes: &LoadSizes| self.ratio_of(sizes) * weakness * (1.0 + ROUND_OFF);
                let near = |sizes: LoadSizes| reach(&sizes) >= limit.min(found.largest());
                if graph.is_live(bond as u32) && (bonds.sizes)(bond as u32).is_none_or(near) {
                    found.add(bond, self.ratio(&(bonds.load)(bond as u32)) * weakness, limit);
                }
            }
            found
        };
        numbered_blocks(range.len().div_ceil(BLOCK), &block)
    }

    fn loads_reach(&self, loads: &LoadLanes, radius: f64, limit: f64) -> bool {
        let [normal, mean_bending, largest_bending, torsion] = loads;
        let mut any = false;
        // All lanes, so that they are looked at side by side.
        for k in 0..normal.len() {
            let [normal, torsion] = [normal[k], torsion[k]];
            let (mean_bending, largest_bending) = (mean_bending[k], largest_bending[k]);
            let sizes = LoadSizes { normal, mean_bending, largest_bending, torsion, radius };
            any |= self.ratio_of(&sizes) * (1.0 + ROUND_OFF) >= limit;
        }
        any
    }

    fn ratio_of_bond(&self, load: &BondLoad) -> f64 {
        self.ratio(load)
    }

    fn mode(&self, load: &BondLoad) -> BreakMode {
        LoadCriterion::mode(self, load)
    }
}
