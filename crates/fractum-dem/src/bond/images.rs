//! The images that bonds join in a box that repeats.

use fractum_contact::{Image, PeriodicCell};
use fractum_kernels::lanes::{Vector, WIDTH};
use fractum_math::{Mat3, Vec3};

/// Images in which the bonds of a network join their particles.
#[derive(Clone, Debug)]
pub(super) struct ThroughBox {
    pub(super) cell: PeriodicCell,
    /// The box without load.
    pub(super) start: PeriodicCell,
    /// Image of the second particle of each bond that the first is bonded to.
    pub(super) images: Vec<Image>,
}

impl ThroughBox {
    /// From the second particle of a bond to its image, now [m].
    pub(super) fn offset(&self, bond: usize) -> Vec3 {
        self.cell.offset(&self.images[bond])
    }
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
    /// - `first`, `count`: bonds of the block
    pub(super) fn new(through: &ThroughBox, groups: usize, first: usize, count: usize) -> Self {
        let mut own = BlockThroughBox { offsets: vec![[[0.0; WIDTH]; 3]; groups], sums: [[[0.0; WIDTH]; 9]; 2] };
        own.place(through, first, count);
        own
    }

    /// Takes the images to where the box has them now.
    pub(super) fn place(&mut self, through: &ThroughBox, first: usize, count: usize) {
        for (group, offsets) in self.offsets.iter_mut().enumerate() {
            for lane in 0..WIDTH {
                // Lanes without a bond repeat the last one.
                let offset = through.offset(first + (group * WIDTH + lane).min(count - 1));
                (0..3).for_each(|axis| offsets[axis][lane] = offset[axis]);
            }
        }
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

    pub(super) fn sums(&self) -> [Mat3; 2] {
        let sum = |of: &[[f64; WIDTH]; 9]| Mat3::from_fn(|row, column| of[3 * row + column].iter().sum());
        [sum(&self.sums[0]), sum(&self.sums[1])]
    }
}
