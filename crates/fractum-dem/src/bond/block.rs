//! The bonds of one block of particles, and what they sum in one pass.

use std::ops::Range;

use fractum_kernels::bond::{BondEnergy, BondLanes, BondLaw, ForceLanes};
use fractum_kernels::lanes::{Lanes, Vector, WIDTH, dot, side_by_side};
use fractum_kernels::prefetch;
use fractum_math::{Rotation, Vec3, widest};

use super::images::BlockThroughBox;
use super::loads::{LoadLanes, load_sizes};
use super::mean_strain::MeanStrain;

/// What a pass over the bonds keeps beside forces: nothing, sums of virials, or of bounds of them, or what every bond bears.
pub(super) const NOTHING: u8 = 0;
pub(super) const VIRIALS: u8 = 1;
pub(super) const BOUNDS: u8 = 2;
pub(super) const LOADS: u8 = 3;

/// Groups of bonds that are on their way into the cache while one is computed.
const AHEAD: usize = 4;

/// Bonds of a block of particles, each with its first particle in it.
#[derive(Clone, Debug)]
pub(super) struct Block<L: BondLaw> {
    /// First particle of the block.
    start: usize,
    /// Number of particles of the block.
    pub(super) count: usize,
    /// First bond of the block.
    pub(super) first_bond: u32,
    /// Number of bonds of the block.
    pub(super) bonds: usize,
    /// Bonds of the block, from its first, that have separated by their law and were not taken.
    pub(super) separated: Vec<u32>,
    /// Bonds that fail under the mean strain of their particles at this instant.
    pub(super) failing: Vec<u32>,
    pub(super) groups: Vec<Group<L>>,
    /// Memory of the bonds of each group, which most steps do not touch.
    pub(super) memory: Vec<[L::Memory; WIDTH]>,
    /// Particles of other blocks that this block's bonds reach, ascending.
    pub(super) partners: Vec<u32>,
    /// Sums of forces and moments: own particles, then partners.
    pub(super) sums: Vec<[f64; 6]>,
    /// Sums of virials, where they are wanted.
    pub(super) virials: Vec<[f64; 6]>,
    /// Sums of bounds of the virials, where they are wanted.
    pub(super) virial_bounds: Vec<[f64; 2]>,
    /// What the bonds of each group bear, where that is wanted.
    pub(super) loads: Vec<LoadLanes>,
    /// Sums of what bonds add to the stresses of mean strains, where there are any [J].
    pub(super) shares: Vec<[f64; 6]>,
    /// Sums that other blocks hold for particles of this one: (block, slot, own particle).
    pub(super) incoming: Vec<(u32, u32, u32)>,
    /// Bonds through the sides of a box that repeats.
    pub(super) through: Option<Box<BlockThroughBox>>,
}

/// `WIDTH` bonds; unused lanes repeat a bond with `live` = 0.
#[derive(Clone, Debug)]
pub(super) struct Group<L: BondLaw> {
    first: [u32; WIDTH],
    second: [u32; WIDTH],
    /// Slots in the block's sums.
    slots: [[u32; WIDTH]; 2],
    axis: [[f64; WIDTH]; 3],
    pub(super) inverse: [f64; WIDTH],
    pub(super) live: [f64; WIDTH],
    own: [L::Parameters; WIDTH],
    pub(super) recent: L::Recent<WIDTH>,
}

/// Bonds as they were made.
pub(super) struct Made<'a, L: BondLaw> {
    pub(super) pairs: &'a [[u32; 2]],
    pub(super) axis: &'a [Vec3],
    pub(super) length: &'a [f64],
    pub(super) own: &'a [L::Parameters],
}

impl<L: BondLaw> Block<L> {
    /// A block of particles `start..start + count`, and the bonds that have their first particle there.
    pub(super) fn new(start: usize, count: usize, bonds: Range<usize>, made: &Made<'_, L>) -> Self {
        let Made { pairs, axis, length, own: parameters } = made;
        let own = |i: u32| (start..start + count).contains(&(i as usize));
        let mut partners: Vec<u32> = pairs[bonds.clone()].iter().map(|p| p[1]).filter(|&j| !own(j)).collect();
        partners.sort_unstable();
        partners.dedup();
        let slot = |i: u32| {
            let slot = if own(i) { i as usize - start } else { count + partners.binary_search(&i).unwrap_or_default() };
            slot as u32
        };
        let groups: Vec<Group<L>> = bonds
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
                    own: std::array::from_fn(|k| parameters[bond(k)]),
                    recent: L::Recent::default(),
                }
            })
            .collect();
        let sums = vec![[0.0; 6]; count + partners.len()];
        let (virials, virial_bounds, shares, incoming) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (first_bond, bonds, separated) = (bonds.start as u32, bonds.len(), Vec::new());
        let memory = vec![[L::Memory::default(); WIDTH]; groups.len()];
        Block {
            start,
            count,
            first_bond,
            bonds,
            separated,
            failing: Vec::new(),
            groups,
            memory,
            partners,
            sums,
            virials,
            virial_bounds,
            loads: Vec::new(),
            shares,
            incoming,
            through: None,
        }
    }

    /// Has room for sums of virials and of their bounds.
    pub(super) fn make_room_for_details(&mut self) {
        make_room(self.sums.len(), &mut self.virials, &mut self.virial_bounds);
    }

    #[inline(always)]
    fn sum_bonds<const FORCES: bool, const DETAIL: u8>(
        &mut self,
        position: &[Vec3],
        orientation: &[Rotation],
        law: &L,
    ) {
        self.sum_wanted(position, orientation, law, FORCES, DETAIL);
    }

    fn sum_bonds_apart<const FORCES: bool, const DETAIL: u8>(
        &mut self,
        position: &[Vec3],
        orientation: &[Rotation],
        law: &L,
    ) {
        self.sum_whatever(position, orientation, law, FORCES, DETAIL);
    }

    /// One body for whatever is wanted.
    #[inline(never)]
    fn sum_whatever(&mut self, position: &[Vec3], orientation: &[Rotation], law: &L, forces: bool, detail: u8) {
        self.sum_wanted(position, orientation, law, forces, detail);
    }

    /// - `forces`: whether forces and moments are wanted
    /// - `detail`: what is wanted beside them, such as [`VIRIALS`]
    #[inline(always)]
    fn sum_wanted(&mut self, position: &[Vec3], orientation: &[Rotation], law: &L, forces: bool, detail: u8) {
        debug_assert!(self.start + self.count <= position.len());
        let Block { groups, memory, separated, sums, virials, virial_bounds, loads, through, .. } = self;
        let mut through = through.as_deref_mut();
        if forces {
            sums.fill([0.0; 6]);
        }
        if detail == LOADS {
            loads.resize(groups.len(), LoadLanes::default());
        }
        if detail == VIRIALS || detail == BOUNDS {
            // Both at once, so that no later step allocates.
            make_room(sums.len(), virials, virial_bounds);
        }
        if detail == VIRIALS {
            virials.fill([0.0; 6]);
        }
        if detail == BOUNDS {
            virial_bounds.fill([0.0; 2]);
        }
        through.iter_mut().for_each(|through| through.clear());
        for index in 0..groups.len() {
            prefetch(groups, index + AHEAD);
            let (group, memory) = (&mut groups[index], &mut memory[index]);
            let images = through.as_ref().map(|through| &through.offsets[index]);
            let bonds = group.lanes(position, orientation, images);
            let before = L::separated(&group.recent);
            let found = law.forces(&bonds, &group.own, &mut group.recent, memory);
            side_by_side(&found);
            let fresh = L::separated(&group.recent) & !before;
            if fresh != 0 {
                let lanes = (0..WIDTH).filter(|lane| fresh >> lane & 1 == 1);
                separated.extend(lanes.map(|lane| (index * WIDTH + lane) as u32));
            }
            if forces {
                add_forces(&group.slots, &found, sums);
            }
            if let Some(through) = &mut through {
                through.add(index, &bonds.gap, &found.force);
            }
            if detail == LOADS {
                loads[index] = load_sizes(bonds.gap, &found);
            }
            if detail == BOUNDS {
                add_bounds(&group.slots, &bonds.gap, &found.force, virial_bounds);
            }
            if detail == VIRIALS {
                add_virials(&group.slots, &bonds.gap, &found.force, virials);
            }
        }
    }
}

fn make_room(sums: usize, virials: &mut Vec<[f64; 6]>, virial_bounds: &mut Vec<[f64; 2]>) {
    virials.resize(sums, [0.0; 6]);
    virial_bounds.resize(sums, [0.0; 2]);
}

widest! {
    /// Sums what is wanted of the bonds of a block.
    pub(super) fn sum_bonds<L: BondLaw, const FORCES: bool, const DETAIL: u8>(
        block: &mut Block<L>,
        position: &[Vec3],
        orientation: &[Rotation],
        law: &L,
    ) = Block::<L>::sum_bonds::<FORCES, DETAIL>, otherwise Block::<L>::sum_bonds_apart::<FORCES, DETAIL>;
}

widest! {
    /// Sums the forces of bonds beside the mean strain of their particles, and what they add to the stresses of these; lists the bonds that fail.
    pub(super) fn sum_deviations<L: BondLaw>(
        block: &mut Block<L>,
        position: &[Vec3],
        orientation: &[Rotation],
        law: &L,
        field: &MeanStrain,
    ) = Block::<L>::sum_deviations;
}

impl<L: BondLaw> Block<L> {
    #[inline(always)]
    fn sum_deviations(&mut self, position: &[Vec3], orientation: &[Rotation], law: &L, field: &MeanStrain) {
        let Block { groups, memory, first_bond, failing, sums, shares, .. } = self;
        failing.clear();
        sums.fill([0.0; 6]);
        shares.clear();
        shares.resize(sums.len(), [0.0; 6]);
        for index in 0..groups.len() {
            prefetch(groups, index + AHEAD);
            let (group, memory) = (&mut groups[index], &mut memory[index]);
            let bonds = group.lanes(position, orientation, None);
            let mean = group.mean_strains(field);
            let found = law.deviating_forces(&bonds, mean, &group.own, &mut group.recent, memory);
            side_by_side(&found.forces);
            if found.failing != 0 {
                let lanes = (0..WIDTH).filter(|lane| found.failing >> lane & 1 == 1);
                failing.extend(lanes.map(|lane| *first_bond + (index * WIDTH + lane) as u32));
            }
            add_forces(&group.slots, &found.forces, sums);
            for k in 0..WIDTH {
                for end in &group.slots {
                    let sum = &mut shares[end[k] as usize];
                    (0..6).for_each(|c| sum[c] += found.share[c].0[k]);
                }
            }
        }
    }
}

impl<L: BondLaw> Block<L> {
    /// - `DEVIATING`: whether there is a field; a loop for each, since one that chooses keeps its lanes in memory, at twice the time
    #[inline(always)]
    fn sum_energies<const DEVIATING: bool>(
        &self,
        position: &[Vec3],
        orientation: &[Rotation],
        law: &L,
        field: Option<&MeanStrain>,
    ) -> BondEnergy {
        let mut sums = [Lanes::<WIDTH>::splat(0.0); 3];
        for (index, (group, memory)) in self.groups.iter().zip(&self.memory).enumerate() {
            prefetch(&self.groups, index + AHEAD);
            let images = self.through.as_ref().map(|through| &through.offsets[index]);
            let bonds = group.lanes(position, orientation, images);
            let energies = match field {
                Some(field) if DEVIATING => {
                    law.deviating_energies(&bonds, group.mean_strains(field), &group.own, &group.recent, memory)
                }
                _ => law.energies(&bonds, &group.own, &group.recent, memory),
            };
            let parts = [energies.tension, energies.bending, energies.torsion];
            side_by_side(&parts);
            for (sum, part) in sums.iter_mut().zip(parts) {
                // What is broken may have any energy.
                *sum = *sum + Lanes::of(|k| if bonds.live.0[k] != 0.0 { part.0[k] } else { 0.0 });
            }
        }
        let [tension, bending, torsion] = sums.map(|sum| sum.0.iter().sum());
        BondEnergy { tension, bending, torsion }
    }
}

widest! {
    /// Energy that the live bonds of a block would give back.
    pub(super) fn sum_energies<L: BondLaw, const DEVIATING: bool>(
        block: &Block<L>,
        position: &[Vec3],
        orientation: &[Rotation],
        law: &L,
        field: Option<&MeanStrain>,
    ) -> BondEnergy = Block::<L>::sum_energies::<DEVIATING>;
}

impl<L: BondLaw> Group<L> {
    /// Means of the strains of both particles.
    #[inline(always)]
    fn mean_strains(&self, field: &MeanStrain) -> [Lanes<WIDTH>; 6] {
        let mut mean = [Lanes::splat(0.0); 6];
        for k in 0..WIDTH {
            let strain = field.between([self.first[k], self.second[k]]).0;
            for c in 0..6 {
                mean[c].0[k] = strain[c];
            }
        }
        mean
    }

    /// The bonds at the present positions and orientations.
    ///
    /// - `images`: from the second particles to the images that the bonds join, in a box that repeats [m]
    #[inline(always)]
    fn lanes(
        &self,
        position: &[Vec3],
        orientation: &[Rotation],
        images: Option<&[[f64; WIDTH]; 3]>,
    ) -> BondLanes<WIDTH> {
        let (mut gap, mut turns) = ([[0.0; WIDTH]; 3], [[[0.0; WIDTH]; 4]; 2]);
        for k in 0..WIDTH {
            let (i, j) = (self.first[k] as usize, self.second[k] as usize);
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
        if let Some(images) = images {
            for a in 0..3 {
                for k in 0..WIDTH {
                    gap[a][k] += images[a][k];
                }
            }
        }
        // nalgebra stores a quaternion as i, j, k, w.
        let turn = |t: [[f64; WIDTH]; 4]| (Lanes(t[3]), [Lanes(t[0]), Lanes(t[1]), Lanes(t[2])]);
        BondLanes {
            gap: gap.map(Lanes),
            turns: turns.map(turn),
            axis: self.axis.map(Lanes),
            inverse: Lanes(self.inverse),
            live: Lanes(self.live),
        }
    }
}

#[inline(always)]
fn add_forces(slots: &[[u32; WIDTH]; 2], forces: &ForceLanes<WIDTH>, sums: &mut [[f64; 6]]) {
    let ForceLanes { force, moment: [first, second] } = forces;
    for k in 0..WIDTH {
        let (i, j) = (slots[0][k] as usize, slots[1][k] as usize);
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
}

/// Largest principal values of the virials ½ sym(r ⊗ f) of bonds, and smallest ones with their sign changed.
#[inline(always)]
fn add_bounds(slots: &[[u32; WIDTH]; 2], arm: &Vector<WIDTH>, force: &Vector<WIDTH>, bounds: &mut [[f64; 2]]) {
    let quarter = Lanes::splat(0.25);
    // The force on the first particle is the opposite of `force`.
    let along = dot(*arm, *force) * quarter;
    let size = (dot(*arm, *arm) * dot(*force, *force)).sqrt() * quarter;
    let (most, least) = (size - along, size + along);
    for k in 0..WIDTH {
        for end in slots {
            let sum = &mut bounds[end[k] as usize];
            sum[0] += most.0[k];
            sum[1] += least.0[k];
        }
    }
}

/// ½ sym(r ⊗ f) of bonds, which is the same at both ends; the force on the first particle is the opposite of `force`.
#[inline(always)]
fn add_virials(slots: &[[u32; WIDTH]; 2], arm: &Vector<WIDTH>, force: &Vector<WIDTH>, virials: &mut [[f64; 6]]) {
    let quarter = Lanes::splat(-0.25);
    let part = |a: usize, b: usize| (arm[a] * force[b] + arm[b] * force[a]) * quarter;
    let virial = [part(0, 0), part(1, 1), part(2, 2), part(0, 1), part(1, 2), part(2, 0)];
    for k in 0..WIDTH {
        for end in slots {
            let sum = &mut virials[end[k] as usize];
            (0..6).for_each(|c| sum[c] += virial[c].0[k]);
        }
    }
}
