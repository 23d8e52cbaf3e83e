//! Shortest ways along the edges of a mesh.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The ends of edges and what they cost, from each node.
pub(super) struct Roads(Vec<Vec<(u32, f64)>>);

/// A node that is reached, the cheapest first; of equal cost the lower node.
struct Reached(f64, u32);

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl Roads {
    /// - `edges`: two nodes and a cost above 0
    pub(super) fn new(nodes: usize, edges: impl Iterator<Item = ([u32; 2], f64)>) -> Self {
        let mut roads = vec![Vec::new(); nodes];
        for ([a, b], cost) in edges {
            roads[a as usize].push((b, cost));
            roads[b as usize].push((a, cost));
        }
        Roads(roads)
    }

    /// What it costs to come to each node, and the node before it; infinity where no way leads.
    pub(super) fn from(&self, start: u32) -> (Vec<f64>, Vec<u32>) {
        let mut cost = vec![f64::INFINITY; self.0.len()];
        let mut before = vec![start; self.0.len()];
        cost[start as usize] = 0.0;
        let mut open = BinaryHeap::from([Reached(0.0, start)]);
        while let Some(Reached(so_far, node)) = open.pop() {
            if so_far > cost[node as usize] {
                continue;
            }
            for &(next, step) in &self.0[node as usize] {
                let sum = so_far + step;
                if sum < cost[next as usize] {
                    (cost[next as usize], before[next as usize]) = (sum, node);
                    open.push(Reached(sum, next));
                }
            }
        }
        (cost, before)
    }

    /// The nodes of the cheapest way; none where there is no way.
    pub(super) fn way(&self, start: u32, end: u32) -> Option<Vec<u32>> {
        let (cost, before) = self.from(start);
        if cost[end as usize] == f64::INFINITY {
            return None;
        }
        let mut way = vec![end];
        while way[way.len() - 1] != start {
            way.push(before[way[way.len() - 1] as usize]);
        }
        way.reverse();
        Some(way)
    }
}
