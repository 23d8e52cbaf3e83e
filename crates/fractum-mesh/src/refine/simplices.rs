//! Elements of one kind that are cut in two again and again.

use rayon::prelude::*;

/// Elements with `N` corners, and where they are found.
pub(super) struct Simplices<const N: usize> {
    /// Corners of each.
    pub(super) nodes: Vec<[u32; N]>,
    /// The element of the mesh that each is a part of.
    parent: Vec<u32>,
    /// Elements at each place.
    around: Vec<Vec<u32>>,
}

impl<const N: usize> Simplices<N> {
    /// - `places`: the place of each node
    pub(super) fn new(nodes: Vec<[u32; N]>, places: &[u32]) -> Self {
        let mut around = vec![Vec::new(); places.len()];
        for (element, corners) in nodes.iter().enumerate() {
            corners.iter().for_each(|&node| around[places[node as usize] as usize].push(element as u32));
        }
        Simplices { parent: (0..nodes.len() as u32).collect(), nodes, around }
    }

    /// Elements that have an edge between two places, in no order, into `found`.
    pub(super) fn at_edge(&self, [a, b]: [u32; 2], places: &[u32], found: &mut Vec<u32>) {
        found.clear();
        let [a, b] = if self.around[a as usize].len() <= self.around[b as usize].len() { [a, b] } else { [b, a] };
        let has = |&element: &u32| self.nodes[element as usize].iter().any(|&node| places[node as usize] == b);
        found.extend(self.around[a as usize].iter().copied().filter(has));
    }

    /// One more place, without elements.
    pub(super) fn add_place(&mut self) {
        self.around.push(Vec::new());
    }

    /// Cuts an element in two at the middle of an edge between two places: the half with the first of them stays where it was, the other
    /// one becomes the last element. Both keep the sense of the whole.
    ///
    /// - `middle`: the node between two nodes
    pub(super) fn bisect(
        &mut self,
        element: u32,
        [a, b]: [u32; 2],
        places: &mut Vec<u32>,
        mut middle: impl FnMut(u32, u32, &mut Vec<u32>) -> u32,
    ) {
        let whole = self.nodes[element as usize];
        let corner = |place: u32| whole.iter().position(|&node| places[node as usize] == place);
        let (Some(at_a), Some(at_b)) = (corner(a), corner(b)) else { return };
        let new = middle(whole[at_a], whole[at_b], places);
        let other = self.nodes.len() as u32;
        self.nodes[element as usize][at_b] = new;
        let mut half = whole;
        half[at_a] = new;
        self.nodes.push(half);
        self.parent.push(self.parent[element as usize]);
        let place = places[new as usize] as usize;
        self.around[place].extend([element, other]);
        for (at, &node) in whole.iter().enumerate().filter(|(at, _)| *at != at_a) {
            let around = &mut self.around[places[node as usize] as usize];
            if at != at_b {
                around.push(other);
            } else if let Some(known) = around.iter_mut().find(|known| **known == element) {
                *known = other;
            }
        }
    }

    /// The elements, parts of one after each other in the order of the mesh, and where those of each begin.
    pub(super) fn in_order(self, whole: usize) -> (Vec<[u32; N]>, Vec<u32>) {
        let mut order: Vec<u64> =
            self.parent.iter().zip(0u64..).map(|(&parent, element)| u64::from(parent) << 32 | element).collect();
        order.par_sort_unstable();
        let mut begin = vec![0u32; whole + 1];
        self.parent.iter().for_each(|&parent| begin[parent as usize + 1] += 1);
        for parent in 0..whole {
            begin[parent + 1] += begin[parent];
        }
        (order.iter().map(|&key| self.nodes[key as u32 as usize]).collect(), begin)
    }
}

/// The parts of some elements.
///
/// - `begin`: where the parts of each begin
pub(super) fn parts(members: &[u32], begin: &[u32]) -> Vec<u32> {
    members.iter().flat_map(|&member| begin[member as usize]..begin[member as usize + 1]).collect()
}
