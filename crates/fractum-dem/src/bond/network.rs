use std::ops::Add;

use fractum_contact::PeriodicCell;
use fractum_kernels::bond::{BondEnergy, BondForces, BondLaw, BondStiffness, BondedPair, Separation};
use fractum_kernels::lanes::WIDTH;
use fractum_math::{Sym3, Vec3};
use fractum_parallel::gather_named;
use nalgebra::Matrix6;
use rayon::prelude::*;

use super::block::{BOUNDS, Block, Made, NOTHING, VIRIALS, sum_energies};
use super::graph::{BondGraph, check_pairs, check_shares};
use super::images::{BlockThroughBox, ThroughBox};
use super::mean_strain::{MeanStrain, Separating};
use super::subdomain::BondSubdomain;
use crate::DemError;
use crate::particles::{Particles, SHARED};

/// Particles whose bonds form one block of parallel work.
pub(super) const BLOCK: usize = SHARED;

/// The bonds of a body under one law, ready for many time steps.
///
/// Bonds are grouped in blocks by their first particle. A block sums into a local array over its own particles and
/// their foreign partners; the partners' sums are then added by the blocks that own them, in a fixed order. Every bond
/// is computed once, and the result has the same bits for any number of threads.
#[derive(Clone, Debug)]
pub struct BondNetwork<L: BondLaw> {
    pub(super) law: L,
    pub(super) pairs: Vec<[u32; 2]>,
    axis: Vec<Vec3>,
    pub(super) length: Vec<f64>,
    pub(super) own: Vec<L::Parameters>,
    live: Vec<bool>,
    pub(super) blocks: Vec<Block<L>>,
    /// Block, group in the block and lane of each bond.
    pub(super) index: Vec<[u32; 3]>,
    /// Mean strains of the particles, where the law knows them.
    pub(super) mean: Option<MeanStrain>,
    /// What separates under them.
    pub(super) separating: Separating,
    /// The blocks of this process, where several share the bonds.
    pub(super) part: Option<Box<BondSubdomain>>,
    /// The images that bonds join, in a box that repeats.
    pub(super) through: Option<Box<ThroughBox>>,
}

impl<L: BondLaw> BondNetwork<L> {
    /// Bonds particles at their present distances; their orientations count from now on.
    ///
    /// - `pairs`: the particles of each bond
    ///
    /// # Errors
    /// Numbers of the law that make no bond; a bond that joins nothing.
    pub fn new(particles: &Particles, pairs: &[[u32; 2]], law: L) -> Result<Self, DemError> {
        Self::with_shares(particles, pairs, &[], law)
    }

    /// [`BondNetwork::new`] with a factor on the area of each bond, or on the stiffness of its section.
    ///
    /// - `shares`: factors in the order of `pairs`; 1 where there are none
    ///
    /// # Errors
    /// As [`BondNetwork::new`]; another number of factors than of bonds.
    pub fn with_shares(particles: &Particles, pairs: &[[u32; 2]], shares: &[f64], law: L) -> Result<Self, DemError> {
        Self::within(particles, pairs, shares, law, None)
    }

    /// [`BondNetwork::with_shares`] in a box that repeats: bonds join the nearest images.
    ///
    /// - `cell`: the box; its sides are apart by more than twice the longest bond
    ///
    /// # Errors
    /// As [`BondNetwork::with_shares`].
    pub fn within(
        particles: &Particles,
        pairs: &[[u32; 2]],
        shares: &[f64],
        law: L,
        cell: Option<&PeriodicCell>,
    ) -> Result<Self, DemError> {
        law.check()?;
        let (pairs, shares) = sorted(particles, pairs, shares)?;
        let position = &particles.position;
        let count = position.len();
        let between = |p: &[u32; 2]| position[p[1] as usize] - position[p[0] as usize];
        let image = |cell: &PeriodicCell| pairs.iter().map(|pair| cell.nearest_image(&between(pair))).collect();
        let through = cell.map(|cell| ThroughBox { cell: *cell, start: *cell, images: image(cell) });
        let gaps: Vec<Vec3> = match &through {
            None => pairs.iter().map(between).collect(),
            Some(ThroughBox { cell, images, .. }) => {
                pairs.iter().zip(images).map(|(pair, image)| between(pair) + cell.offset(image)).collect()
            }
        };
        let length: Vec<f64> = gaps.iter().map(|gap| gap.norm()).collect();
        let axis: Vec<Vec3> = gaps.iter().zip(&length).map(|(gap, l)| gap / *l).collect();
        let own: Vec<L::Parameters> = pairs
            .iter()
            .zip(length.iter().zip(&shares))
            .map(|(pair, (l, share))| law.parameters(*l, pair.map(|i| particles.radius[i as usize]), *share))
            .collect();
        let made = Made::<L> { pairs: &pairs, axis: &axis, length: &length, own: &own };
        let mut blocks = Vec::new();
        let mut index = Vec::with_capacity(pairs.len());
        let mut bond = 0;
        for start in (0..count).step_by(BLOCK) {
            let end = (start + BLOCK).min(count);
            let first = bond;
            while bond < pairs.len() && (pairs[bond][0] as usize) < end {
                bond += 1;
            }
            let block = Block::new(start, end - start, first..bond, &made);
            let position = |k: usize| [blocks.len(), k / WIDTH, k % WIDTH].map(|i| i as u32);
            index.extend((0..bond - first).map(position));
            blocks.push(block);
        }
        let mut incoming = vec![Vec::new(); blocks.len()];
        for (from, block) in blocks.iter().enumerate() {
            for (slot, &partner) in block.partners.iter().enumerate() {
                let owner = partner as usize / BLOCK;
                incoming[owner].push((from as u32, (block.count + slot) as u32, partner - (owner * BLOCK) as u32));
            }
        }
        blocks.iter_mut().zip(incoming).for_each(|(block, list)| block.incoming = list);
        let live = vec![true; pairs.len()];
        let mean = match law.mean_elasticity() {
            Some(elasticity) => Some(MeanStrain::new(particles, &pairs, elasticity)?),
            None => None,
        };
        let separating = Separating::default();
        let through = through.map(Box::new);
        if let Some(through) = &through {
            for block in &mut blocks {
                let (first, count) = (block.first_bond as usize, block.bonds);
                block.through = Some(Box::new(BlockThroughBox::new(through, block.groups.len(), first, count)));
            }
        }
        Ok(BondNetwork { law, pairs, axis, length, own, live, blocks, index, mean, separating, part: None, through })
    }

    /// Number of bonds, broken ones included.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Whether there are no bonds.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The particles of each bond, first < second, ascending.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Whether a bond still holds.
    pub fn is_live(&self, bond: usize) -> bool {
        self.live[bond]
    }

    /// The law of all bonds.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// See [`BondLaw::share`].
    pub fn share(&self, bond: usize) -> f64 {
        L::share(&self.own[bond])
    }

    /// Breaks a bond for ever.
    pub fn break_bond(&mut self, bond: usize) {
        self.live[bond] = false;
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        self.blocks[block].groups[group].live[lane] = 0.0;
    }

    /// Gives a bond another length without load [m], as a change of temperature does.
    pub fn set_length(&mut self, bond: usize, length: f64) {
        self.length[bond] = length;
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        self.blocks[block].groups[group].inverse[lane] = 1.0 / length;
    }

    /// What a bond remembers.
    pub fn memory_of(&self, bond: usize) -> L::Memory {
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        let block = &self.blocks[block];
        L::recall(&block.groups[group].recent, &block.memory[group], lane)
    }

    /// What a bond remembers apart from what is recent.
    pub(super) fn lasting_memory(&self, bond: usize) -> &L::Memory {
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        &self.blocks[block].memory[group][lane]
    }

    /// What all bonds remember, for a checkpoint; nothing where the law has no memory.
    pub fn memory(&self) -> Vec<L::Memory> {
        if size_of::<L::Memory>() == 0 {
            return Vec::new();
        }
        (0..self.len()).map(|bond| self.memory_of(bond)).collect()
    }

    /// Puts a saved memory back into bonds made from the same case.
    pub fn restore_memory(&mut self, saved: &[L::Memory]) {
        for (bond, memory) in saved.iter().enumerate().take(self.len()) {
            self.put_memory(bond, *memory);
            if L::separation(memory).is_some() {
                self.release_about(bond);
            }
        }
    }

    pub(super) fn put_memory(&mut self, bond: usize, memory: L::Memory) {
        let [block, group, lane] = self.index[bond].map(|i| i as usize);
        let Block { groups, memory: own, .. } = &mut self.blocks[block];
        L::remember(memory, lane, &mut groups[group].recent, &mut own[group]);
    }

    /// Energy that all bonds have dissipated so far, broken ones included [J]. All ranks must call it where several share the bonds.
    pub fn dissipated(&self) -> f64 {
        if size_of::<L::Memory>() == 0 {
            return 0.0;
        }
        let of = |block: &Block<L>| {
            let bonds = block.first_bond as usize..self.len();
            let memories = bonds.zip(block.memory.as_flattened()).take(block.bonds);
            memories
                .fold(0.0, |sum, (bond, memory)| sum + self.law.dissipated(self.length[bond], &self.own[bond], memory))
        };
        self.of_all_blocks(&|block| [of(block)]).iter().flatten().sum()
    }

    /// Bonds that have separated by the law since the last call, ascending, with the way they did. All ranks must call it where several
    /// share the bonds.
    pub fn take_separated(&mut self, out: &mut Vec<(u32, Separation)>) {
        out.clear();
        let own = self.own_blocks();
        for block in &mut self.blocks[own] {
            for bond in block.separated.drain(..) {
                let (group, lane) = (bond as usize / WIDTH, bond as usize % WIDTH);
                if let Some(how) = L::separation(&block.memory[group][lane]) {
                    out.push((block.first_bond + bond, how));
                }
            }
        }
        if let Some(part) = &self.part {
            *out = gather_named(part.exchange(), out);
        }
    }

    /// Largest viscous resistance over stiffness of a bond [s]; 0 where there is no resistance.
    pub fn viscous_time(&self, particles: &Particles) -> f64 {
        let time = |bond: usize| {
            let (length, own) = (self.length[bond], &self.own[bond]);
            let viscosity = self.law.viscosity(length, own, self.reduced_mass(bond, particles));
            viscosity / self.law.stiffness(length, own).axial
        };
        (0..self.len()).map(time).fold(0.0, f64::max)
    }

    fn reduced_mass(&self, bond: usize, particles: &Particles) -> f64 {
        let [first, second] = self.pairs[bond].map(|i| particles.mass[i as usize]);
        first * second / (first + second)
    }

    /// Adds the viscous forces of all bonds that act to those of their particles [N].
    pub fn add_viscous_forces(&self, particles: &Particles, graph: &BondGraph, out: &mut [Vec3]) {
        let Particles { position, velocity, .. } = particles;
        out.par_iter_mut().enumerate().for_each(|(i, out)| {
            for half in graph.every(i) {
                let (bond, j) = (half.bond as usize, half.other as usize);
                let gap = position[j] - position[i];
                let length = gap.norm();
                let strain = length / self.length[bond] - 1.0;
                if !self.live[bond] || !self.law.touches(strain, self.lasting_memory(bond)) {
                    continue;
                }
                let mass = self.reduced_mass(bond, particles);
                let viscosity = self.law.viscosity(self.length[bond], &self.own[bond], mass);
                let normal = gap / length;
                *out += normal * (viscosity * (velocity[j] - velocity[i]).dot(&normal));
            }
        });
    }

    /// Adds the forces and moments of all live bonds to the particles'.
    pub fn add_forces(&mut self, particles: &mut Particles) {
        self.add_forces_of::<NOTHING>(particles);
    }

    /// [`BondNetwork::add_forces`], which also keeps what [`BondNetwork::virials`] tells of these forces.
    pub fn add_forces_and_virials(&mut self, particles: &mut Particles) {
        self.add_forces_of::<VIRIALS>(particles);
    }

    /// [`BondNetwork::add_forces`], which also keeps what [`BondNetwork::virial_bounds`] tells of these forces: a third of the work
    /// that virials are.
    pub fn add_forces_and_virial_bounds(&mut self, particles: &mut Particles) {
        self.add_forces_of::<BOUNDS>(particles);
    }

    /// Finds the virials at the present positions, and leaves forces as they are.
    pub fn find_virials(&mut self, particles: &Particles) {
        self.sum_own::<false, VIRIALS>(particles);
    }

    /// Bounds of the principal values of the virials [N m], as at the last [`BondNetwork::add_forces_and_virial_bounds`]: the sums of
    /// the largest ones of each bond, and of the smallest ones with their sign changed. ½ sym(r ⊗ f) has the principal
    /// values ¼ (r·f ± |r| |f|) and 0, and the largest one of a sum is at most the sum of the largest ones.
    pub fn virial_bounds(&self, out: &mut [[f64; 2]]) {
        let (blocks, (out, own)) = (&self.blocks, self.own_of(out));
        out.par_chunks_mut(BLOCK).zip(own).for_each(|(out, block)| {
            out.fill([0.0; 2]);
            out.iter_mut().zip(&block.virial_bounds).for_each(|(out, sum)| *out = *sum);
            for &(from, slot, own) in &block.incoming {
                if let Some(sum) = blocks[from as usize].virial_bounds.get(slot as usize) {
                    (0..2).for_each(|k| out[own as usize][k] += sum[k]);
                }
            }
        });
    }

    /// Half the sums of sym(r_ij ⊗ f_ij) over the bonds of each particle [N m], as at the last
    /// [`BondNetwork::add_forces_and_virials`] or [`BondNetwork::find_virials`]; zero before it.
    pub fn virials(&self, out: &mut [Sym3]) {
        let (blocks, (out, own)) = (&self.blocks, self.own_of(out));
        out.par_chunks_mut(BLOCK).zip(own).for_each(|(out, block)| {
            out.fill(Sym3::ZERO);
            // Components of Voigt order xx yy zz xy yz zx; the sums hold them so.
            out.iter_mut().zip(&block.virials).for_each(|(out, sum)| *out = Sym3(*sum));
            for &(from, slot, own) in &block.incoming {
                if let Some(sum) = blocks[from as usize].virials.get(slot as usize) {
                    out[own as usize] += Sym3(*sum);
                }
            }
        });
    }

    pub(super) fn add_forces_of<const DETAIL: u8>(&mut self, particles: &mut Particles) {
        if self.mean.is_some() {
            return self.add_deviating_forces(particles);
        }
        self.sum_own::<true, DETAIL>(particles);
        self.add_sums(&mut particles.force, &mut particles.moment);
    }

    /// Adds the sums of the blocks to the forces and moments of their particles.
    pub(super) fn add_sums(&self, force: &mut [Vec3], moment: &mut [Vec3]) {
        let (blocks, (force, own), (moment, _)) = (&self.blocks, self.own_of(force), self.own_of(moment));
        let owned = force.par_chunks_mut(BLOCK).zip(moment.par_chunks_mut(BLOCK));
        owned.zip(own).for_each(|((force, moment), block)| {
            let mut add = |i: usize, s: &[f64; 6]| {
                force[i] += Vec3::new(s[0], s[1], s[2]);
                moment[i] += Vec3::new(s[3], s[4], s[5]);
            };
            for (i, sum) in block.sums[..block.count].iter().enumerate() {
                add(i, sum);
            }
            for &(from, slot, own) in &block.incoming {
                add(own as usize, &blocks[from as usize].sums[slot as usize]);
            }
        });
    }

    /// A bond with its particles' present state.
    #[inline]
    pub(super) fn pair(&self, bond: usize, particles: &Particles) -> BondedPair {
        let ends = self.pairs[bond].map(|i| i as usize);
        let mut position = ends.map(|i| particles.position[i]);
        if let Some(through) = &self.through {
            position[1] += through.offset(bond);
        }
        let rotation = ends.map(|i| particles.orientation[i]);
        BondedPair { position, rotation, axis: self.axis[bond], length: self.length[bond] }
    }

    /// Distance of the particles of a bond without load [m].
    pub fn length(&self, bond: usize) -> f64 {
        self.length[bond]
    }

    /// Force of a live bond on its second particle and the moments on both.
    pub fn forces_of(&self, bond: usize, particles: &Particles) -> BondForces {
        if let Some(forces) = self.traction_of(bond, particles) {
            return forces;
        }
        self.law.force(&self.pair(bond, particles), &self.own[bond], &mut self.memory_of(bond))
    }

    /// Energy that a bond, live or not, would give back, by parts [J].
    pub fn energy_of(&self, bond: usize, particles: &Particles) -> BondEnergy {
        let (pair, own, memory) = (self.pair(bond, particles), &self.own[bond], self.lasting_memory(bond));
        match &self.mean {
            None => self.law.energy(&pair, own, memory),
            Some(mean) => self.law.deviating_energy(&pair, mean.between(self.pairs[bond]), own, memory),
        }
    }

    /// Energy that all live bonds would give back, by parts [J]. All ranks must call it where several share the bonds.
    pub fn energy(&self, particles: &Particles) -> BondEnergy {
        let Particles { position, orientation, .. } = particles;
        let of = |block: &Block<L>| {
            let sum = if self.mean.is_some() { sum_energies::<L, true> } else { sum_energies::<L, false> };
            let BondEnergy { tension, bending, torsion } =
                sum(block, position, orientation, &self.law, self.mean.as_ref());
            [tension, bending, torsion]
        };
        let parts = self.of_all_blocks(&of).into_iter();
        let parts = parts.map(|[tension, bending, torsion]| BondEnergy { tension, bending, torsion });
        let bonds = parts.fold(BondEnergy::default(), BondEnergy::add);
        match &self.mean {
            None => bonds,
            Some(mean) => BondEnergy { tension: bonds.tension + mean.energy(), ..bonds },
        }
    }

    /// A time step that is certainly stable, 2/ω with a bound on ω from the assembled stiffness, times `safety`
    /// (0.7 is usual).
    ///
    /// A bond's stiffness is at most twice its diagonal blocks, so that ω² is at most twice the largest eigenvalue of a
    /// particle's own assembled 6 × 6 stiffness over its mass and inertia. With mean strains ω is the larger of this bound and of
    /// the highest frequency measured on the whole body with a margin of 2 %, which proves nothing for a partly broken one.
    pub fn stable_step(&self, particles: &Particles, safety: f64) -> f64 {
        let mut own = vec![Matrix6::<f64>::zeros(); particles.len()];
        for bond in (0..self.len()).filter(|&b| self.live[b]) {
            let [i, j] = self.pairs[bond].map(|i| i as usize);
            let [first, second] = self.pair(bond, particles).position;
            let n = (second - first).normalize();
            let (length, stiffness) = (self.length[bond], self.law.stiffness(self.length[bond], &self.own[bond]));
            add_stiffness(&mut own[i], &n, length, &stiffness);
            add_stiffness(&mut own[j], &-n, length, &stiffness);
        }
        let omega2: Vec<f64> = own
            .par_iter()
            .enumerate()
            .map(|(i, k)| {
                let (m, r) = (particles.mass[i].sqrt(), particles.inertia[i].sqrt());
                let weight = |a: usize| if a < 3 { m } else { r };
                let scaled = Matrix6::from_fn(|a, b| k[(a, b)] / (weight(a) * weight(b)));
                2.0 * scaled.symmetric_eigenvalues().max()
            })
            .collect();
        let mut largest = omega2.into_iter().fold(0.0, f64::max);
        if self.mean.is_some() {
            largest = largest.max(self.measured_frequency(particles).powi(2));
        }
        if largest > 0.0 { safety * 2.0 / largest.sqrt() } else { f64::INFINITY }
    }
}

/// The pairs with the smaller particle first, ascending, and the factors on their areas.
fn sorted(particles: &Particles, pairs: &[[u32; 2]], shares: &[f64]) -> Result<(Vec<[u32; 2]>, Vec<f64>), DemError> {
    check_shares(pairs, shares)?;
    check_pairs(&particles.position, pairs)?;
    let share = |bond: usize| shares.get(bond).copied().unwrap_or(1.0);
    let ascending =
        |(bond, &[first, second]): (usize, &[u32; 2])| ([first.min(second), first.max(second)], share(bond));
    let mut both: Vec<([u32; 2], f64)> = pairs.iter().enumerate().map(ascending).collect();
    both.sort_by_key(|(pair, _)| *pair);
    Ok(both.into_iter().unzip())
}

/// Adds the stiffness of a bond at one end, with `n` from that end to the other.
fn add_stiffness(k: &mut Matrix6<f64>, n: &Vec3, l: f64, bond: &BondStiffness) {
    let along = n * n.transpose();
    let across = fractum_math::Mat3::identity() - along;
    let translation = along * bond.axial + across * bond.shear(l);
    let rotation = along * bond.twist + across * bond.bending;
    // Force from rotation θ: coupling θ × n.
    let mixed = -n.cross_matrix() * bond.coupling(l);
    for a in 0..3 {
        for b in 0..3 {
            k[(a, b)] += translation[(a, b)];
            k[(a + 3, b + 3)] += rotation[(a, b)];
            k[(a, b + 3)] += mixed[(a, b)];
            k[(b + 3, a)] += mixed[(a, b)];
        }
    }
}

#[cfg(test)]
mod tests;
