//! Bodies whose elements several ranks share: none has all of them.
//!
//! Each rank reads some elements. The cells of all are put in the order that one process gives them, along a curve through each body, and cut
//! into the same blocks; a rank gets a run of blocks with the elements around their cells. So every sum over blocks has the bits of one process.
//! Every rank has all nodes. Blocks of others are there with their number and the nodes that this rank has too.
//!
//! Of bodies that break every rank has all elements, since all take out the same ones; of most of them no more cells than its own, and what it
//! receives of the edges of others ([`Replication`]). Elements of other bodies that have a node of them, or one that something else may touch, are on
//! every rank too: what lies around such nodes is known to all.

mod block_order;
mod boundary;
mod deal;
mod edge_values;
mod nodes;
mod order;
mod pieces;
pub(crate) mod places;

use std::collections::BTreeMap;

use fractum_math::Sym3;

pub(crate) use block_order::{BlockOrder, Classes};
pub use boundary::{DividedBoundary, divided_boundary};
pub use deal::{all_elements, deal};
pub(crate) use edge_values::EdgeValues;
pub use nodes::SharedNodes;
pub(crate) use nodes::{GivenToNodes, RanksOfNodes, nodal_sums};
pub(crate) use pieces::connected_pieces;

use crate::body::Formulation;

/// Elements of a body that this rank has read.
#[derive(Clone, Copy, Debug)]
pub struct ReadBody<'a> {
    /// Whether edges or elements are the cells.
    pub formulation: Formulation,
    /// Nodes of the tetrahedra, positively oriented.
    pub elements: &'a [[u32; 4]],
    /// What the file calls each of them.
    pub tags: &'a [u64],
    /// How much of it every rank has.
    pub replication: Replication,
    /// Which edges of each of them cannot be damaged, in the order of [`fractum_mesh::topology::TETRAHEDRON_EDGES`]; empty where all can, or none.
    pub sound: &'a [[bool; 6]],
}

/// How much of a body every rank has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Replication {
    /// The elements around its cells.
    #[default]
    Part,
    /// All elements, with its cells of them: those of a body that may break, of smoothed tetrahedra with local damage.
    Elements,
    /// All elements and all cells.
    Whole,
}

/// What a rank keeps of a body of tetrahedra.
#[derive(Clone, Debug, Default)]
pub struct BodyShare {
    /// Nodes of its elements, positively oriented.
    pub elements: Vec<[u32; 4]>,
    /// What the file calls each of them.
    pub tags: Vec<u64>,
    /// Number of each in the whole body, ascending; empty where it has all of them.
    pub numbers: Vec<u32>,
    /// Elements of the whole body.
    pub count: usize,
    /// How much of it every rank has.
    pub replication: Replication,
    /// Which of them this rank owns: every element has one rank that does.
    pub is_owned: Vec<bool>,
    /// Ranks whose cells the edges of each element are, in the order of [`fractum_mesh::topology::TETRAHEDRON_EDGES`]; the rank of the
    /// element where elements are the cells.
    pub owners: Vec<[u32; 6]>,
    /// Cells of this rank, in runs that make a block each, or several where they touch many nodes: edges by their nodes, lower first, or
    /// elements by their number, twice. Of a whole body the blocks are those of one process.
    pub runs: Vec<Vec<[u32; 2]>>,
    /// Cells of every rank.
    pub cells: Vec<usize>,
    /// Elements that this rank can measure by itself with all cells of theirs, ascending: it has all elements around their nodes.
    pub measured: Vec<u32>,
}

impl BodyShare {
    /// Whether every rank has all cells.
    pub(crate) fn is_whole(&self) -> bool {
        self.replication == Replication::Whole
    }

    /// Number of an element of this rank in the whole body.
    pub(crate) fn number(&self, element: usize) -> u32 {
        self.numbers.get(element).copied().unwrap_or(element as u32)
    }

    /// Place of an element of the whole body among those of this rank; none where it does not have that.
    pub fn place(&self, number: u32) -> Option<usize> {
        match self.replication {
            Replication::Part => self.numbers.binary_search(&number).ok(),
            Replication::Elements | Replication::Whole => Some(number as usize),
        }
    }

    /// Cells of this rank, ascending.
    pub(crate) fn own_cells(&self) -> Vec<[u32; 2]> {
        let mut own = self.runs.concat();
        own.sort_unstable();
        own
    }
}

/// What a rank knows of a body that it does not have whole.
#[derive(Clone, Debug)]
pub(crate) struct DividedBody {
    /// Number of each element in the whole body.
    pub(crate) numbers: Vec<u32>,
    /// Elements of the whole body.
    pub(crate) count: usize,
    /// Volume of the whole body [m³].
    pub(crate) volume: f64,
    /// How its elements hang together.
    pub(crate) pieces: ConnectedPieces,
    /// Values of edges that others evaluate, at the last frame; empty where elements are the cells.
    pub(crate) values: EdgeValues,
    /// Facets that are seen from outside, with the number of their element on this rank: of the elements that it owns.
    pub(crate) skin: Vec<([u32; 3], u32)>,
}

/// How the elements of a body hang together that no rank has whole. None of them ever leaves.
#[derive(Clone, Debug, Default)]
pub struct ConnectedPieces {
    /// Pairs of nodes that link all nodes of a piece.
    pub links: Vec<[u32; 2]>,
    /// Lowest node of each piece with the number of its elements, ascending.
    pub pieces: Vec<(u32, usize)>,
    /// What every node has of the volume of the body [m³]: an equal part of each element around it.
    pub volumes: Vec<f64>,
}

/// Block of cells that another rank evaluates, of which this one has no more than its number.
pub(crate) const ELSEWHERE: u32 = u32::MAX;

/// Cell that another rank evaluates too, and of which this one finds values by itself, by its number in the body.
pub(crate) const ALONE: u32 = u32::MAX - 1;

/// Nodes around which every rank needs all elements, beside those of whole bodies; the same on every rank.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnownAround<'a> {
    /// What something may touch.
    pub touched: &'a [u32],
    /// Nodes of elements that are measured.
    pub measured: &'a [u32],
}

/// Slots of the blocks of others at nodes of this rank: nodes of each block.
pub(crate) type NodesOfOthers = BTreeMap<usize, Vec<u32>>;

/// What frames show of an edge.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EdgeValue {
    /// Stress [Pa].
    pub(crate) stress: Sym3,
    /// That at the instant of the last step [Pa].
    pub(crate) earlier_stress: Sym3,
    pub(crate) damage: f64,
    /// Strain, that of thermal expansion included.
    pub(crate) strain: Sym3,
}
