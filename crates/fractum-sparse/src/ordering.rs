//! Nested dissection: halves by coordinate, separated by the smallest vertex cover of the edges between them.

use crate::block::Pattern;

/// Parts of this size are not divided further.
const LEAF: usize = 20;

/// Nodes in the order of elimination, `order[new] = old`.
///
/// - `places`: positions of the nodes; only their order along the axes matters
pub fn nested_dissection(pattern: &Pattern, places: &[[f64; 3]]) -> Vec<u32> {
    let nodes: Vec<u32> = (0..pattern.nodes() as u32).collect();
    let mut work = Dissection { pattern, places, side: vec![OUT; nodes.len()], order: Vec::with_capacity(nodes.len()) };
    // Filled from the last eliminated to the first.
    work.divide(nodes);
    work.order.reverse();
    work.order
}

const OUT: u8 = 0;
const LEFT: u8 = 1;
const RIGHT: u8 = 2;

struct Dissection<'a> {
    pattern: &'a Pattern,
    places: &'a [[f64; 3]],
    side: Vec<u8>,
    order: Vec<u32>,
}

impl Dissection<'_> {
    fn divide(&mut self, nodes: Vec<u32>) {
        if nodes.len() <= LEAF {
            self.order.extend(nodes);
            return;
        }
        let mut best: Option<(Vec<u32>, Vec<u32>, usize)> = None;
        for axis in 0..3 {
            let Some((sorted, separator)) = self.cut(&nodes, axis) else { continue };
            let middle = sorted.len() / 2;
            if best.as_ref().is_none_or(|(_, other, _)| separator.len() < other.len()) {
                best = Some((sorted, separator, middle));
            }
        }
        let Some((sorted, separator, middle)) = best else {
            self.order.extend(nodes);
            return;
        };
        self.order.extend(&separator);
        let (left, right) = sorted.split_at(middle);
        let without = |half: &[u32]| -> Vec<u32> {
            half.iter().copied().filter(|n| separator.binary_search(n).is_err()).collect()
        };
        let (left, right) = (without(left), without(right));
        self.divide(left);
        self.divide(right);
    }

    /// Nodes sorted along an axis, and the separator of their halves (ascending); none if the axis does not spread them.
    fn cut(&mut self, nodes: &[u32], axis: usize) -> Option<(Vec<u32>, Vec<u32>)> {
        let at = |n: u32| self.places[n as usize][axis];
        let mut sorted = nodes.to_vec();
        sorted.sort_unstable_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        if at(sorted[0]) >= at(sorted[sorted.len() - 1]) {
            return None;
        }
        let middle = sorted.len() / 2;
        for (index, &node) in sorted.iter().enumerate() {
            self.side[node as usize] = if index < middle { LEFT } else { RIGHT };
        }
        let edges = self.edges_between(&sorted[..middle]);
        for &node in &sorted {
            self.side[node as usize] = OUT;
        }
        let mut separator = vertex_cover(&edges);
        separator.sort_unstable();
        Some((sorted, separator))
    }

    /// Left nodes with neighbours on the right, and these.
    fn edges_between(&self, left: &[u32]) -> Vec<(u32, Vec<u32>)> {
        let right_of = |&node: &u32| {
            let row = self.pattern.row(node as usize).iter();
            let across: Vec<u32> = row.copied().filter(|&n| self.side[n as usize] == RIGHT).collect();
            (!across.is_empty()).then_some((node, across))
        };
        left.iter().filter_map(right_of).collect()
    }
}

/// Smallest set of nodes that touches every edge of a bipartite graph (Kőnig), by augmenting paths.
fn vertex_cover(edges: &[(u32, Vec<u32>)]) -> Vec<u32> {
    let mut rights: Vec<u32> = edges.iter().flat_map(|(_, row)| row).copied().collect();
    rights.sort_unstable();
    rights.dedup();
    let local = |n: u32| rights.binary_search(&n).expect("every right node is listed");
    let rows: Vec<Vec<usize>> = edges.iter().map(|(_, row)| row.iter().map(|&n| local(n)).collect()).collect();
    const FREE: usize = usize::MAX;
    let mut mate_of_right = vec![FREE; rights.len()];
    let mut mate_of_left = vec![FREE; rows.len()];
    let mut seen = vec![usize::MAX; rights.len()];
    for start in 0..rows.len() {
        // Depth-first search with an explicit stack: (left node, next entry of its row).
        let mut stack = vec![(start, 0usize)];
        while let Some((left, next)) = stack.pop() {
            let Some(&right) = rows[left].get(next) else { continue };
            stack.push((left, next + 1));
            if seen[right] == start {
                continue;
            }
            seen[right] = start;
            if mate_of_right[right] == FREE {
                // Turn the path round: every left node on the stack takes the right node it looked at last.
                for &(left, next) in stack.iter().rev() {
                    let taken = rows[left][next - 1];
                    mate_of_right[taken] = left;
                    mate_of_left[left] = taken;
                }
                break;
            }
            stack.push((mate_of_right[right], 0));
        }
    }
    // Nodes that alternating paths reach from free left nodes.
    let mut left_reached = vec![false; rows.len()];
    let mut right_reached = vec![false; rights.len()];
    let mut queue: Vec<usize> = (0..rows.len()).filter(|&l| mate_of_left[l] == FREE).collect();
    queue.iter().for_each(|&l| left_reached[l] = true);
    while let Some(left) = queue.pop() {
        for &right in &rows[left] {
            if !std::mem::replace(&mut right_reached[right], true) {
                let mate = mate_of_right[right];
                if mate != FREE && !std::mem::replace(&mut left_reached[mate], true) {
                    queue.push(mate);
                }
            }
        }
    }
    let left = (0..rows.len()).filter(|&l| !left_reached[l]).map(|l| edges[l].0);
    left.chain((0..rights.len()).filter(|&r| right_reached[r]).map(|r| rights[r])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::Ragged;
    use proptest::prelude::*;

    #[test]
    fn order_holds_every_node_once_and_separators_come_last() {
        let n = 30u32;
        let at = |i: u32, j: u32| i + n * j;
        let mut cliques = Vec::new();
        let mut places = vec![[0.0; 3]; (n * n) as usize];
        for j in 0..n {
            for i in 0..n {
                places[at(i, j) as usize] = [f64::from(i), f64::from(j), 0.0];
                if i + 1 < n && j + 1 < n {
                    cliques.push([at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
                }
            }
        }
        let pattern = Pattern::from_cliques(places.len(), &Ragged::from_rows(&cliques));
        let order = nested_dissection(&pattern, &places);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..n * n));
        // The last n nodes are the first separator, a line that splits the square.
        let last = &order[order.len() - n as usize..];
        let line = |axis: usize| last.iter().all(|&l| places[l as usize][axis] == places[last[0] as usize][axis]);
        assert!(line(0) || line(1));
    }

    proptest! {
        #[test]
        fn cover_touches_every_edge_and_is_smallest(rows in prop::collection::vec(prop::collection::vec(0u32..6, 1..4), 1..7)) {
            let edges: Vec<(u32, Vec<u32>)> = (100..).zip(rows.clone()).collect();
            let cover = vertex_cover(&edges);
            for (left, row) in &edges {
                prop_assert!(row.iter().all(|right| cover.contains(left) || cover.contains(right)));
            }
            // Any cover picks left nodes and then every right node that the others need.
            let smallest = (0u32..1 << rows.len()).map(|picked| {
                let mut needed: Vec<u32> = rows.iter().enumerate().filter(|(l, _)| picked >> l & 1 == 0).flat_map(|(_, r)| r).copied().collect();
                needed.sort_unstable();
                needed.dedup();
                picked.count_ones() as usize + needed.len()
            }).min().unwrap();
            prop_assert_eq!(cover.len(), smallest);
        }
    }
}
