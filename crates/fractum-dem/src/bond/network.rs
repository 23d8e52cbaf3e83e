use std::ops::Add;

use fractum_math::{Rotation, Sym3, Vec3};
use nalgebra::Matrix6;
use rayon::prelude::*;

use super::lanes::{Lanes, Vector, dot};
use super::law::{BeamEnergy, BeamForces, BeamSection, BondedPair, beam, cohesive_beam, cohesive_beam_energy};
use crate::DemError;
use crate::particles::Particles;

/// Bonds computed side by side.
const WIDTH: usize = 8;
/// Particles whose bonds form one block of parallel work.
const BLOCK: usize = 2048;

/// The cohesive beams of a body, ready for many time steps.
///
/// Bonds are grouped in blocks by their first particle. A block sums into a local array over its own particles and
/// their foreign partners; the partners' sums are then added by the blocks that own them, in a fixed order. Every bond
/// is computed once, and the result has the same bits for any number of threads.
#[derive(Clone, Debug)]
pub struct BeamNetwork {
    section: BeamSection,
    pairs: Vec<[u32; 2]>,
    axis: Vec<Vec3>,
    length: Vec<f64>,
    live: Vec<bool>,
    blocks: Vec<Block>,
    /// Where each bond sits: block, group in the block.
    place: Vec<(u32, u32)>,
}

#[derive(Clone, Debug)]
struct Block {
    /// First particle of the block.
    start: usize,
    /// Number of particles of the block.
    count: usize,
    groups: Vec<Group>,
    /// Particles of other blocks that this block's bonds reach, ascending.
    partners: Vec<u32>,
    /// Sums of forces and moments: own particles, then partners.
    sums: Vec<[f64; 6]>,
    /// Sums of the virials of forces and arms, where they are wanted.
    virials: Vec<[f64; 6]>,
    /// Sums of the bounds of these virials, where they are wanted.
    virial_bounds: Vec<[f64; 2]>,
    /// Sums that other blocks hold for particles of this one: (block, slot, own particle).
    incoming: Vec<(u32, u32, u32)>,
}

/// `WIDTH` bonds; unused places repeat a bond with `live` = 0.
#[derive(Clone, Debug)]
struct Group {
    first: [u32; WIDTH],
    second: [u32; WIDTH],
    /// Slots in the block's sums.
    slots: [[u32; WIDTH]; 2],
    axis: [[f64; WIDTH]; 3],
    inverse: [f64; WIDTH],
    live: [f64; WIDTH],
}

/// What a pass over the bonds sums beside forces.
const NOTHING: u8 = 0;
const VIRIALS: u8 = 1;
const BOUNDS: u8 = 2;

impl BeamNetwork {
    /// Bonds particles at their present distances; their orientations count from now on.
    ///
    /// - `position`: centres [m]
    /// - `pairs`: the particles of each bond
    ///
    /// # Errors
    /// A section that is no beam; a bond that joins nothing.
    pub fn new(position: &[Vec3], pairs: &[[u32; 2]], section: BeamSection) -> Result<Self, DemError> {
        section.check()?;
        let count = position.len();
        let mut pairs: Vec<[u32; 2]> = pairs.to_vec();
        for (bond, pair) in pairs.iter_mut().enumerate() {
            let [first, second] = *pair;
            let bad = |reason| Err(DemError::BadBond { bond, first, second, count, reason });
            if first as usize >= count || second as usize >= count {
                return bad("no such particle");
            }
            if first == second || position[first as usize] == position[second as usize] {
                return bad("a bond needs two different places");
            }
            *pair = [first.min(second), first.max(second)];
        }
        pairs.sort_unstable();
        let gap = |p: &[u32; 2]| position[p[1] as usize] - position[p[0] as usize];
        let length: Vec<f64> = pairs.iter().map(|p| gap(p).norm()).collect();
        let axis: Vec<Vec3> = pairs.iter().zip(&length).map(|(p, l)| gap(p) / *l).collect();
        let mut blocks = Vec::new();
        let mut place = Vec::with_capacity(pairs.len());
        let mut bond = 0;
        for start in (0..count).step_by(BLOCK) {
            let end = (start + BLOCK).min(count);
            let first = bond;
            while bond < pairs.len() && (pairs[bond][0] as usize) < end {
                bond += 1;
            }
            let block = Block::new(start, end - start, first..bond, &pairs, &axis, &length);
            place.extend((0..bond - first).map(|k| (blocks.len() as u32, (k / WIDTH) as u32)));
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
        Ok(BeamNetwork { section, pairs, axis, length, live, blocks, place })
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

    /// The beam of all bonds.
    pub fn section(&self) -> BeamSection {
        self.section
    }

    /// Breaks a bond for ever.
    pub fn break_bond(&mut self, bond: usize) {
        self.live[bond] = false;
        let (block, group) = self.place[bond];
        let first = self.place[..bond].iter().rev().take(WIDTH).take_while(|&&p| p == (block, group)).count();
        self.blocks[block as usize].groups[group as usize].live[first] = 0.0;
    }

    /// Adds the forces and moments of all live bonds to the particles'.
    pub fn add_forces(&mut self, particles: &mut Particles) {
        self.add_forces_of::<NOTHING>(particles);
    }

    /// [`BeamNetwork::add_forces`], which also keeps what [`BeamNetwork::virials`] tells of these forces.
    pub fn add_forces_and_virials(&mut self, particles: &mut Particles) {
        self.add_forces_of::<VIRIALS>(particles);
    }

    /// [`BeamNetwork::add_forces`], which also keeps what [`BeamNetwork::virial_bounds`] tells of these forces: a third of the work
    /// that virials are.
    pub fn add_forces_and_virial_bounds(&mut self, particles: &mut Particles) {
        self.add_forces_of::<BOUNDS>(particles);
    }

    /// Finds the virials at the present positions, and leaves forces as they are.
    pub fn find_virials(&mut self, particles: &Particles) {
        let Particles { position, orientation, .. } = particles;
        let section = self.section;
        self.blocks.par_iter_mut().for_each(|block| block.sum_bonds::<false, VIRIALS>(position, orientation, &section));
    }

    /// Bounds of the principal values of the virials [N m], as at the last [`BeamNetwork::add_forces_and_virial_bounds`]: the sums of
    /// the largest ones of each bond, and of the smallest ones with their sign changed. ½ sym(r ⊗ f) has the principal
    /// values ¼ (r·f ± |r| |f|) and 0, and the largest one of a sum is at most the sum of the largest ones.
    pub fn virial_bounds(&self, out: &mut [[f64; 2]]) {
        let blocks = &self.blocks;
        out.par_chunks_mut(BLOCK).zip(blocks).for_each(|(out, block)| {
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
    /// [`BeamNetwork::add_forces_and_virials`] or [`BeamNetwork::find_virials`]; zero before it.
    pub fn virials(&self, out: &mut [Sym3]) {
        let blocks = &self.blocks;
        out.par_chunks_mut(BLOCK).zip(blocks).for_each(|(out, block)| {
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

    fn add_forces_of<const BESIDE: u8>(&mut self, particles: &mut Particles) {
        let section = self.section;
        let Particles { position, orientation, force, moment, .. } = particles;
        self.blocks.par_iter_mut().for_each(|block| block.sum_bonds::<true, BESIDE>(position, orientation, &section));
        let blocks = &self.blocks;
        let owned = force.par_chunks_mut(BLOCK).zip(moment.par_chunks_mut(BLOCK));
        owned.zip(blocks).for_each(|((force, moment), block)| {
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
    fn pair(&self, bond: usize, particles: &Particles) -> BondedPair {
        let ends = self.pairs[bond].map(|i| i as usize);
        BondedPair {
            position: ends.map(|i| particles.position[i]),
            rotation: ends.map(|i| particles.orientation[i]),
            axis: self.axis[bond],
            length: self.length[bond],
        }
    }

    /// Distance of the particles of a bond when it was made [m].
    pub fn length(&self, bond: usize) -> f64 {
        self.length[bond]
    }

    /// Force of a live bond on its second particle and the moments on both; see [`cohesive_beam`].
    pub fn forces_of(&self, bond: usize, particles: &Particles) -> BeamForces {
        cohesive_beam(&self.pair(bond, particles), &self.section)
    }

    /// Elastic energy of a bond, live or not, by parts [J].
    pub fn energy_of(&self, bond: usize, particles: &Particles) -> BeamEnergy {
        cohesive_beam_energy(&self.pair(bond, particles), &self.section)
    }

    /// Elastic energy of all live bonds, by parts [J].
    pub fn energy(&self, particles: &Particles) -> BeamEnergy {
        let chunk = |bonds: std::ops::Range<usize>| {
            bonds.filter(|&b| self.live[b]).fold(BeamEnergy::default(), |sum, b| sum + self.energy_of(b, particles))
        };
        let parts: Vec<BeamEnergy> = (0..self.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|c| chunk(c * BLOCK..((c + 1) * BLOCK).min(self.len())))
            .collect();
        parts.into_iter().fold(BeamEnergy::default(), BeamEnergy::add)
    }

    /// A time step that is certainly stable, 2/ω with a bound on ω from the assembled stiffness, times `safety`
    /// (0.7 is usual).
    ///
    /// A bond's stiffness is at most twice its diagonal blocks, so that ω² is at most twice the largest eigenvalue of a
    /// particle's own assembled 6 × 6 stiffness over its mass and inertia.
    pub fn stable_step(&self, particles: &Particles, safety: f64) -> f64 {
        let mut own = vec![Matrix6::<f64>::zeros(); particles.len()];
        for bond in (0..self.len()).filter(|&b| self.live[b]) {
            let [i, j] = self.pairs[bond].map(|i| i as usize);
            let n = (particles.position[j] - particles.position[i]).normalize();
            add_stiffness(&mut own[i], &n, self.length[bond], &self.section);
            add_stiffness(&mut own[j], &-n, self.length[bond], &self.section);
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
        let largest = omega2.into_iter().fold(0.0, f64::max);
        if largest > 0.0 { safety * 2.0 / largest.sqrt() } else { f64::INFINITY }
    }
}

/// Adds a beam's stiffness at one end, with `n` from that end to the other.
fn add_stiffness(k: &mut Matrix6<f64>, n: &Vec3, l: f64, section: &BeamSection) {
    let along = n * n.transpose();
    let across = fractum_math::Mat3::identity() - along;
    let (ea, ei, gj) = (section.axial() / l, section.bending() / l, section.torsion() / l);
    let translation = along * ea + across * (12.0 * ei / (l * l));
    let rotation = along * gj + across * (4.0 * ei);
    // Force from rotation: 6 E I/l² θ × n.
    let mixed = -n.cross_matrix() * (6.0 * ei / l);
    for a in 0..3 {
        for b in 0..3 {
            k[(a, b)] += translation[(a, b)];
            k[(a + 3, b + 3)] += rotation[(a, b)];
            k[(a, b + 3)] += mixed[(a, b)];
            k[(b + 3, a)] += mixed[(a, b)];
        }
    }
}

impl Block {
    fn new(
        start: usize,
        count: usize,
        bonds: std::ops::Range<usize>,
        pairs: &[[u32; 2]],
        axis: &[Vec3],
        length: &[f64],
    ) -> Self {
        let own = |i: u32| (start..start + count).contains(&(i as usize));
        let mut partners: Vec<u32> = pairs[bonds.clone()].iter().map(|p| p[1]).filter(|&j| !own(j)).collect();
        partners.sort_unstable();
        partners.dedup();
        let slot = |i: u32| {
            let slot = if own(i) { i as usize - start } else { count + partners.binary_search(&i).unwrap_or_default() };
            slot as u32
        };
        let groups = bonds
            .clone()
            .step_by(WIDTH)
            .map(|begin| {
                let bond = |k: usize| (begin + k).min(bonds.end - 1);
                let lane = |f: &dyn Fn(usize) -> f64| std::array::from_fn(|k| f(bond(k)));
                Group {
                    first: std::array::from_fn(|k| pairs[bond(k)][0]),
                    second: std::array::from_fn(|k| pairs[bond(k)][1]),
                    slots: [0, 1].map(|e| std::array::from_fn(|k| slot(pairs[bond(k)][e]))),
                    axis: [0, 1, 2].map(|a| lane(&|b| axis[b][a])),
                    inverse: lane(&|b| 1.0 / length[b]),
                    live: std::array::from_fn(|k| if begin + k < bonds.end { 1.0 } else { 0.0 }),
                }
            })
            .collect();
        let sums = vec![[0.0; 6]; count + partners.len()];
        Block {
            start,
            count,
            groups,
            partners,
            sums,
            virials: Vec::new(),
            virial_bounds: Vec::new(),
            incoming: Vec::new(),
        }
    }

    /// Sums what is wanted of the bonds.
    fn sum_bonds<const FORCES: bool, const BESIDE: u8>(
        &mut self,
        position: &[Vec3],
        orientation: &[Rotation],
        section: &BeamSection,
    ) {
        debug_assert!(self.start + self.count <= position.len());
        let Block { groups, sums, virials, virial_bounds, .. } = self;
        if FORCES {
            sums.fill([0.0; 6]);
        }
        if BESIDE != NOTHING {
            // Both at once, so that no later step allocates.
            virials.resize(sums.len(), [0.0; 6]);
            virial_bounds.resize(sums.len(), [0.0; 2]);
        }
        if BESIDE == VIRIALS {
            virials.fill([0.0; 6]);
        }
        if BESIDE == BOUNDS {
            virial_bounds.fill([0.0; 2]);
        }
        for group in groups {
            let (mut gap, mut turns) = ([[0.0; WIDTH]; 3], [[[0.0; WIDTH]; 4]; 2]);
            for k in 0..WIDTH {
                let (i, j) = (group.first[k] as usize, group.second[k] as usize);
                let (xi, xj) = (&position[i], &position[j]);
                for a in 0..3 {
                    gap[a][k] = xj[a] - xi[a];
                }
                let (qi, qj) = (&orientation[i].coords, &orientation[j].coords);
                for a in 0..4 {
                    turns[0][a][k] = qi[a];
                    turns[1][a][k] = qj[a];
                }
            }
            // nalgebra stores a quaternion as i, j, k, w.
            let turn = |t: [[f64; WIDTH]; 4]| (Lanes(t[3]), [Lanes(t[0]), Lanes(t[1]), Lanes(t[2])]);
            let axis: Vector<WIDTH> = group.axis.map(Lanes);
            let arm = gap.map(Lanes);
            let (force, first, second) =
                beam(arm, turns.map(turn), axis, Lanes(group.inverse), Lanes(group.live), section);
            for k in 0..if FORCES { WIDTH } else { 0 } {
                let (i, j) = (group.slots[0][k] as usize, group.slots[1][k] as usize);
                let own = &mut sums[i];
                for a in 0..3 {
                    own[a] -= force[a].0[k];
                    own[a + 3] += first[a].0[k];
                }
                let other = &mut sums[j];
                for a in 0..3 {
                    other[a] += force[a].0[k];
                    other[a + 3] += second[a].0[k];
                }
            }
            if BESIDE == BOUNDS {
                let quarter = Lanes::splat(0.25);
                // The force on the first particle is the opposite of `force`.
                let along = dot(arm, force) * quarter;
                let size = (dot(arm, arm) * dot(force, force)).sqrt() * quarter;
                let (most, least) = (size - along, size + along);
                for k in 0..WIDTH {
                    for end in 0..2 {
                        let sum = &mut virial_bounds[group.slots[end][k] as usize];
                        sum[0] += most.0[k];
                        sum[1] += least.0[k];
                    }
                }
            }
            if BESIDE == VIRIALS {
                // ½ sym(r ⊗ f) is the same at both ends; the force on the first particle is the opposite of `force`.
                let quarter = Lanes::splat(-0.25);
                let part = |a: usize, b: usize| (arm[a] * force[b] + arm[b] * force[a]) * quarter;
                let virial = [part(0, 0), part(1, 1), part(2, 2), part(0, 1), part(1, 2), part(2, 0)];
                for k in 0..WIDTH {
                    for end in 0..2 {
                        let sum = &mut virials[group.slots[end][k] as usize];
                        (0..6).for_each(|c| sum[c] += virial[c].0[k]);
                    }
                }
            }
        }
    }
}
