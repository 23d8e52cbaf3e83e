//! Bonds through the sides of a box that repeats.

use fractum_contact::{Image, PeriodicCell};
use fractum_kernels::bond::{BondLaw, BondedPair};
use fractum_kernels::lanes::{Vector, WIDTH};
use fractum_math::{Mat3, Vec3};

use super::block::Block;
use super::network::BondNetwork;
use crate::particles::Particles;

/// Images in which the bonds of a network join their particles.
#[derive(Clone, Debug)]
pub(super) struct ThroughBox {
    pub(super) cell: PeriodicCell,
    /// The box without load.
    pub(super) start: PeriodicCell,
    /// Image of the second particle of each bond that the first is bonded to.
    pub(super) images: Vec<Image>,
}

/// The bonds of a block in a box that repeats.
#[derive(Clone, Debug)]
pub(super) struct BlockThroughBox {
    /// From the second particles of the bonds of each group to their images [m].
    pub(super) offsets: Vec<[[f64; WIDTH]; 3]>,
    /// Sums over the bonds of force ⊗ offset and force ⊗ gap at the last pass, row by row and lane by lane [N m].
    sums: [[[f64; WIDTH]; 9]; 2],
}

impl BlockThroughBox {
    fn new(groups: usize) -> Self {
        BlockThroughBox { offsets: vec![[[0.0; WIDTH]; 3]; groups], sums: [[[0.0; WIDTH]; 9]; 2] }
    }

    pub(super) fn clear(&mut self) {
        self.sums = [[[0.0; WIDTH]; 9]; 2];
    }

    /// Adds the forces on the second particles of a group.
    #[inline(always)]
    pub(super) fn add(&mut self, group: usize, gap: &Vector<WIDTH>, force: &Vector<WIDTH>) {
        let offset = &self.offsets[group];
        for row in 0..3 {
            for column in 0..3 {
                for k in 0..WIDTH {
                    self.sums[0][3 * row + column][k] += force[row].0[k] * offset[column][k];
                    self.sums[1][3 * row + column][k] += force[row].0[k] * gap[column].0[k];
                }
            }
        }
    }

    fn sums(&self) -> [Mat3; 2] {
        let sum = |of: &[[f64; WIDTH]; 9]| {
            let entry = |row: usize, column: usize| of[3 * row + column].iter().sum();
            Mat3::from_fn(entry)
        };
        [sum(&self.sums[0]), sum(&self.sums[1])]
    }
}

impl<L: BondLaw> BondNetwork<L> {
    /// Puts the bonds into their images.
    pub(super) fn put_through(&mut self, through: ThroughBox) {
        for block in &mut self.blocks {
            block.through = Some(Box::new(BlockThroughBox::new(block.groups.len())));
        }
        self.through = Some(Box::new(through));
        self.place_images();
    }

    fn place_images(&mut self) {
        let Some(through) = &self.through else { return };
        for Block { through: own, first_bond, bonds, .. } in &mut self.blocks {
            let Some(own) = own else { continue };
            for (group, offsets) in own.offsets.iter_mut().enumerate() {
                for lane in 0..WIDTH {
                    // Lanes without a bond repeat the last one.
                    let bond = *first_bond as usize + (group * WIDTH + lane).min(*bonds - 1);
                    let offset = through.cell.offset(&through.images[bond]);
                    (0..3).for_each(|axis| offsets[axis][lane] = offset[axis]);
                }
            }
        }
    }

    /// Takes the box as it is now; without effect on bonds that are in none.
    pub fn set_cell(&mut self, cell: &PeriodicCell) {
        let Some(through) = &mut self.through else { return };
        let moves = through.cell.edges != cell.edges;
        through.cell = *cell;
        if moves {
            self.place_images();
        }
    }

    /// The box in which the bonds repeat, with the images of the second particles that they join the first ones to.
    pub fn through_box(&self) -> Option<(&PeriodicCell, &[Image])> {
        self.through.as_ref().map(|through| (&through.cell, &through.images[..]))
    }

    /// From the first particle of a bond to the second, or to the image that it is bonded to [m].
    pub fn gap(&self, bond: usize, particles: &Particles) -> Vec3 {
        let [first, second] = self.pair(bond, particles).position;
        second - first
    }

    /// The ends of a bond by places in the undeformed body, the second one where the image is that it joins [m].
    pub fn ends(&self, bond: usize, reference: &[Vec3]) -> [Vec3; 2] {
        let [first, mut second] = self.pairs[bond].map(|i| reference[i as usize]);
        if let Some(through) = &self.through {
            second += through.start.offset(&through.images[bond]);
        }
        [first, second]
    }

    /// Sums over the bonds at the last pass, with forces f on the second particles [N]: Σ f ⊗ n with the edges n of the box between a
    /// particle and its image [N], and Σ f ⊗ r with the gaps r [N m]; none without such a box.
    pub fn sums_through_box(&self) -> Option<[Mat3; 2]> {
        let through = self.through.as_ref()?;
        let of_blocks = self.blocks.iter().filter_map(|block| block.through.as_ref());
        let none = [Mat3::zeros(); 2];
        let [by_offsets, virial] = of_blocks.fold(none, |[offsets, gaps], block| {
            let [own_offsets, own_gaps] = block.sums();
            [offsets + own_offsets, gaps + own_gaps]
        });
        Some([through.cell.by_edges(&by_offsets), virial])
    }

    /// A pair as it stands, with the second particle where the image is that it is bonded to.
    pub(super) fn with_image(&self, bond: usize, mut pair: BondedPair) -> BondedPair {
        if let Some(through) = &self.through {
            pair.position[1] += through.cell.offset(&through.images[bond]);
        }
        pair
    }
}
