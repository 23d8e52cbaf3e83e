//! Cells in blocks: the unit of parallel work.
//!
//! A block holds a few thousand neighbouring cells with the nodes that they touch, numbered locally, so that its
//! displacements and forces stay in the cache of one core. Forces are first summed inside a block, in the order of its
//! cells, and then per node over the blocks, in the order of the blocks: the same bits for any number of threads.

use fractum_math::{Lane, Mat3, Ragged, Sym3, Vec3};

use crate::cells::thermal_strain::ThermalStrain;
use crate::error::SolidError;

/// Geometry of the cells of a block.
///
/// A cell is a base node, n more nodes and n gradients: grad u = Σ (u_k - u_base) ⊗ g_k. Around an axis it has a hoop strain beside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cells {
    /// Global index of each local node.
    pub(crate) nodes: Vec<u32>,
    /// Cell p owns the gradients `starts[p]..starts[p + 1]`, and the local nodes `starts[p] + p ..= starts[p + 1] + p`.
    pub(crate) starts: Vec<u32>,
    /// Local node numbers, the base node of each cell first.
    pub(crate) local: Vec<u16>,
    /// Gradients [1/m].
    pub(crate) gradients: Vec<[f64; 3]>,
    /// Volume of each cell [m³].
    pub(crate) volume: Vec<f64>,
    /// Of cells around an axis the sum of what their nodes weigh in the hoop strain ∫ u_r/r dV/V = Σ w_k u_r [1/m]; the third component of each
    /// gradient is then w_k.
    pub(crate) hoop: Option<Box<[f64]>>,
    /// Runs of cells with as many gradients each, for loops of a length known to the compiler.
    pub(crate) runs: Vec<Run>,
    /// Thermal strains, where the body expands.
    pub(crate) thermal: Option<Box<ThermalStrain>>,
    /// Strains at which the cells are free of stress, where the body came in during the run or has a stress of its own from the start.
    pub(crate) born: Option<Box<[Sym3]>>,
}

/// Cells `begin..end` of a block, each with `gradients` gradients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub(crate) begin: usize,
    pub(crate) end: usize,
    pub(crate) gradients: usize,
}

/// Most nodes that the cells of a block may touch.
///
/// A power of two known to the compiler: a masked local number then needs no bounds check.
pub(crate) const BLOCK_NODES: usize = 1024;

/// One value per local node.
pub(crate) type LocalLanes = Box<[Lane; BLOCK_NODES]>;

/// Local copies of nodal values, and the sums of forces.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    pub(crate) displacement: LocalLanes,
    /// Only of viscous bodies.
    pub(crate) velocity: Option<LocalLanes>,
    pub(crate) force: LocalLanes,
}

fn local_lanes() -> LocalLanes {
    let lanes = vec![Lane::ZERO; BLOCK_NODES].into_boxed_slice();
    lanes.try_into().expect("the length is BLOCK_NODES")
}

impl Cells {
    /// Strain of a cell that stress belongs to: beyond the thermal one, and beyond that at which it is free of stress.
    #[inline(always)]
    pub(crate) fn elastic_strain(&self, cell: usize, strain: Sym3) -> Sym3 {
        let strain = self.since_birth(cell, strain);
        self.thermal.as_ref().map_or(strain, |thermal| thermal.elastic(cell, strain))
    }

    /// The same at the step before.
    #[inline]
    pub(crate) fn elastic_strain_before(&self, cell: usize, strain: Sym3) -> Sym3 {
        let strain = self.since_birth(cell, strain);
        self.thermal.as_ref().map_or(strain, |thermal| thermal.elastic_before(cell, strain))
    }

    #[inline(always)]
    fn since_birth(&self, cell: usize, strain: Sym3) -> Sym3 {
        self.born.as_ref().map_or(strain, |born| strain - born[cell])
    }

    /// Strains of a cell that stress belongs to where a straight way of small displacements begins and where it ends.
    pub(crate) fn elastic_ends(&self, cell: usize, [before, after]: [&[Vec3]; 2]) -> [Sym3; 2] {
        let strain = |field: &[Vec3]| Sym3::symmetric_part(&self.gradient(cell, |node| field[node]));
        [self.elastic_strain_before(cell, strain(before)), self.elastic_strain(cell, strain(after))]
    }

    pub(crate) fn len(&self) -> usize {
        self.volume.len()
    }

    /// The range of gradients of a cell.
    #[inline(always)]
    pub(crate) fn range(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// Local node numbers of a cell, the base first.
    #[inline(always)]
    pub(crate) fn local_nodes(&self, cell: usize) -> &[u16] {
        &self.local[self.starts[cell] as usize + cell..=self.starts[cell + 1] as usize + cell]
    }

    /// Global nodes of a cell, the base first.
    pub(crate) fn global_nodes(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        self.local_nodes(cell).iter().map(|&l| self.nodes[l as usize] as usize)
    }

    /// Displacement gradient of a cell from the displacements of global nodes.
    #[inline(always)]
    pub(crate) fn gradient(&self, cell: usize, displacement: impl Fn(usize) -> Vec3) -> Mat3 {
        let global = |local: u16| displacement(self.nodes[usize::from(local)] as usize);
        let local = self.local_nodes(cell);
        let base = global(local[0]);
        let (mut x, mut y, mut z) = (Lane::ZERO, Lane::ZERO, Lane::ZERO);
        for (&node, g) in local[1..].iter().zip(&self.gradients[self.range(cell)]) {
            let d = Lane::from_vec(&(global(node) - base));
            x = x + d * Lane::splat(g[0]);
            y = y + d * Lane::splat(g[1]);
            z = z + d * Lane::splat(g[2]);
        }
        let z = self.hoop(cell).map_or(z, |hoop| hoop_column(z, Lane::from_vec(&base), hoop));
        columns_to_matrix(x, y, z)
    }

    /// What the nodes of a cell around an axis weigh together in its hoop strain [1/m].
    #[inline(always)]
    pub(crate) fn hoop(&self, cell: usize) -> Option<f64> {
        self.hoop.as_ref().map(|hoop| hoop[cell])
    }
}

/// Third column of the displacement gradient of a cell around an axis, the hoop strain, from the sum that other cells have there.
///
/// - `base`: displacement of the base node
#[inline(always)]
pub(crate) fn hoop_column(sum: Lane, base: Lane, hoop: f64) -> Lane {
    Lane([0.0, 0.0, sum.0[0] + hoop * base.0[0], 0.0])
}

/// Columns of a displacement gradient from lanes.
#[inline(always)]
pub(crate) fn columns_to_matrix(x: Lane, y: Lane, z: Lane) -> Mat3 {
    let (x, y, z) = (x.0, y.0, z.0);
    Mat3::new(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])
}

impl Scratch {
    pub(crate) fn new() -> Self {
        Scratch { displacement: local_lanes(), velocity: None, force: local_lanes() }
    }

    /// Copies the values of the block's nodes and clears the forces.
    #[inline]
    pub(crate) fn load(&mut self, nodes: &[u32], displacement: &[Vec3]) {
        for ((local, force), &node) in self.displacement.iter_mut().zip(self.force.iter_mut()).zip(nodes) {
            *local = Lane::from_vec(&displacement[node as usize]);
            *force = Lane::ZERO;
        }
    }

    /// Copies the velocities of the block's nodes.
    pub(crate) fn load_velocity(&mut self, nodes: &[u32], velocity: &[Vec3]) {
        let lanes = self.velocity.get_or_insert_with(local_lanes);
        for (local, &node) in lanes.iter_mut().zip(nodes) {
            *local = Lane::from_vec(&velocity[node as usize]);
        }
    }
}

/// Blocks that a slot has numbers for.
const MOST_BLOCKS: usize = 1 << (u32::BITS - LOCAL_BITS);
/// Bits of a local number.
const LOCAL_BITS: u32 = BLOCK_NODES.ilog2();

/// Place of a node in a block: the number of the block and the local one of the node, in 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot(u32);

impl Slot {
    fn new(block: usize, local: usize) -> Self {
        debug_assert!(block < MOST_BLOCKS && local < BLOCK_NODES);
        Slot((block << LOCAL_BITS | local) as u32)
    }

    #[inline(always)]
    pub(crate) fn block(self) -> usize {
        (self.0 >> LOCAL_BITS) as usize
    }

    #[inline(always)]
    pub(crate) fn local(self) -> usize {
        self.0 as usize % BLOCK_NODES
    }
}

/// Where the forces on each node lie in the blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeSlots {
    slots: Ragged,
}

impl NodeSlots {
    /// # Errors
    /// [`SolidError::TooManyBlocks`] beyond 4,194,304 blocks.
    pub(crate) fn new<'a>(
        node_count: usize,
        block_nodes: impl Iterator<Item = &'a [u32]> + Clone,
    ) -> Result<Self, SolidError> {
        let blocks = block_nodes.clone().count();
        if blocks > MOST_BLOCKS {
            return Err(SolidError::TooManyBlocks { blocks, most: MOST_BLOCKS });
        }
        let mut rows = vec![Vec::new(); node_count];
        for (block, nodes) in block_nodes.enumerate() {
            for (local, &node) in nodes.iter().enumerate() {
                rows[node as usize].push(Slot::new(block, local).0);
            }
        }
        Ok(NodeSlots { slots: Ragged::from_rows(&rows) })
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.slots.len()
    }

    /// Blocks that a node belongs to in ascending order, each with the local number of the node there.
    pub(crate) fn of(&self, node: usize) -> impl Iterator<Item = Slot> + '_ {
        self.slots.row(node).iter().map(|&slot| Slot(slot))
    }

    /// Sums the forces on one node over the blocks.
    #[inline(always)]
    pub(crate) fn gather<'a>(&self, node: usize, force: impl Fn(usize) -> &'a [Lane; BLOCK_NODES]) -> Vec3 {
        self.of(node).fold(Lane::ZERO, |sum, slot| sum + force(slot.block())[slot.local()]).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_blocks_than_numbers_are_an_error() {
        let slots = |blocks: usize| NodeSlots::new(1, std::iter::repeat_n(&[0][..], blocks));
        assert_eq!(slots(MOST_BLOCKS).unwrap().of(0).count(), MOST_BLOCKS);
        let error = slots(MOST_BLOCKS + 1).unwrap_err();
        assert!(error.to_string().contains("4194305 blocks"), "{error}");
    }
}
