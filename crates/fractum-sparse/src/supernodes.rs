//! Structure of a Cholesky factor: elimination tree, supernodes, and the rows of their panels.

use std::ops::Range;

use fractum_math::Ragged;

use crate::block::Pattern;

/// Unknowns of a panel at most; wider supernodes are cut.
const PANEL: usize = 128;
const NONE: u32 = u32::MAX;

/// Nodes in the order of elimination, in panels of columns with the same rows below.
pub(crate) struct Supernodes {
    /// `order[new] = old`, and its inverse.
    pub(crate) order: Vec<u32>,
    pub(crate) position: Vec<u32>,
    /// First node of every panel, and their number.
    first: Vec<u32>,
    /// Nodes of the rows of every panel, ascending: its own first.
    rows: Ragged,
    /// Panel of a node.
    owner: Vec<u32>,
}

impl Supernodes {
    /// - `order`: nodes in an order of elimination; subtrees are moved so that each is one run
    /// - `block`: unknowns per node
    pub(crate) fn new(pattern: &Pattern, order: Vec<u32>, block: usize) -> Self {
        let tree = elimination_tree(pattern, &order);
        let post = postorder(&tree);
        let order: Vec<u32> = post.iter().map(|&p| order[p as usize]).collect();
        let position = inverse(&order);
        let parent = elimination_tree(pattern, &order);
        let counts = column_counts(pattern, &order, &position, &parent);
        let supernodes = merge(&parent, &counts, block);
        let (mut first, mut rows, mut owner) = (Vec::new(), Vec::new(), vec![0; order.len()]);
        for (range, whole) in supernodes.iter().zip(rows_of(pattern, &order, &position, &supernodes)) {
            let panels = (range.len() * block).div_ceil(PANEL);
            let width = range.len().div_ceil(panels);
            for start in (0..range.len()).step_by(width) {
                let end = (start + width).min(range.len());
                owner[range.start + start..range.start + end].fill(first.len() as u32);
                first.push((range.start + start) as u32);
                rows.push(whole[start..].to_vec());
            }
        }
        first.push(order.len() as u32);
        Supernodes { order, position, first, rows: Ragged::from_rows(rows), owner }
    }

    /// Number of panels.
    pub(crate) fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// Own nodes of a panel.
    pub(crate) fn nodes(&self, panel: usize) -> Range<usize> {
        self.first[panel] as usize..self.first[panel + 1] as usize
    }

    /// Nodes of the rows of a panel.
    pub(crate) fn rows(&self, panel: usize) -> &[u32] {
        self.rows.row(panel)
    }

    /// Panel of a node.
    pub(crate) fn owner(&self, node: u32) -> usize {
        self.owner[node as usize] as usize
    }
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut position = vec![0; order.len()];
    (0..).zip(order).for_each(|(new, &old)| position[old as usize] = new);
    position
}

/// Neighbours of a node that are eliminated before it.
fn earlier<'a>(pattern: &'a Pattern, order: &[u32], position: &'a [u32], node: u32) -> impl Iterator<Item = u32> + 'a {
    let row = pattern.row(order[node as usize] as usize);
    row.iter().map(|&old| position[old as usize]).filter(move |&k| k < node)
}

/// Parent of every node, by path compression (Liu, ACM Trans. Math. Softw. 12, 1986).
fn elimination_tree(pattern: &Pattern, order: &[u32]) -> Vec<u32> {
    let position = inverse(order);
    let mut parent = vec![NONE; order.len()];
    let mut ancestor = parent.clone();
    for j in 0..order.len() as u32 {
        for mut k in earlier(pattern, order, &position, j) {
            while k != j {
                let next = std::mem::replace(&mut ancestor[k as usize], j);
                if next == NONE {
                    parent[k as usize] = j;
                    break;
                }
                k = next;
            }
        }
    }
    parent
}

/// Nodes in an order in which every subtree is one run, children before parents.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let mut children = vec![Vec::new(); parent.len()];
    let mut stack = Vec::new();
    for (node, &parent) in (0..).zip(parent) {
        if parent == NONE { stack.push(node) } else { children[parent as usize].push(node) }
    }
    let mut order = Vec::with_capacity(parent.len());
    // Parents first, the last child next: the reverse of what is wanted.
    while let Some(node) = stack.pop() {
        order.push(node);
        stack.extend(&children[node as usize]);
    }
    order.reverse();
    order
}

/// Nodes in every column of the factor, the diagonal among them.
fn column_counts(pattern: &Pattern, order: &[u32], position: &[u32], parent: &[u32]) -> Vec<usize> {
    let mut counts = vec![1; order.len()];
    let mut seen = vec![NONE; order.len()];
    for i in 0..order.len() as u32 {
        seen[i as usize] = i;
        for mut k in earlier(pattern, order, position, i) {
            while seen[k as usize] != i {
                seen[k as usize] = i;
                counts[k as usize] += 1;
                k = parent[k as usize];
            }
        }
    }
    counts
}

struct Run {
    nodes: Range<usize>,
    /// Nodes of the rows.
    height: usize,
    /// Entries of the panel that are zero, in blocks.
    zeros: usize,
}

/// Runs of columns with the same rows below, merged with what follows them where few zeros come in.
fn merge(parent: &[u32], counts: &[usize], block: usize) -> Vec<Range<usize>> {
    let mut runs: Vec<Run> = Vec::new();
    let mut start = 0;
    for node in 0..parent.len() {
        let same = node + 1 < parent.len() && parent[node] as usize == node + 1 && counts[node] == counts[node + 1] + 1;
        if same {
            continue;
        }
        let mut run = Run { nodes: start..node + 1, height: counts[start], zeros: 0 };
        start = node + 1;
        while let Some(last) = runs.last().filter(|last| run.nodes.contains(&(parent[last.nodes.end - 1] as usize))) {
            let width = last.nodes.len();
            let height = width + run.height;
            let zeros = last.zeros + run.zeros + width * (height - last.height);
            let columns = width + run.nodes.len();
            let share = zeros as f64 / (height * columns) as f64;
            let allowed = match columns * block {
                ..=12 => 0.8,
                13..=48 => 0.2,
                _ => 0.05,
            };
            if share > allowed {
                break;
            }
            run = Run { nodes: last.nodes.start..run.nodes.end, height, zeros };
            runs.pop();
        }
        runs.push(run);
    }
    runs.into_iter().map(|run| run.nodes).collect()
}

/// Rows of every supernode: its own nodes, then those below, ascending.
fn rows_of(pattern: &Pattern, order: &[u32], position: &[u32], supernodes: &[Range<usize>]) -> Vec<Vec<u32>> {
    let mut owner = vec![0u32; order.len()];
    (0..).zip(supernodes).for_each(|(s, range)| owner[range.clone()].fill(s));
    let mut children = vec![Vec::new(); supernodes.len()];
    let mut seen = vec![NONE; order.len()];
    let mut rows: Vec<Vec<u32>> = Vec::with_capacity(supernodes.len());
    for (s, range) in supernodes.iter().enumerate() {
        let mut below = Vec::new();
        let end = range.end as u32;
        let mut add = |k: u32| {
            if k >= end && seen[k as usize] != s as u32 {
                seen[k as usize] = s as u32;
                below.push(k);
            }
        };
        for node in range.clone() {
            pattern.row(order[node] as usize).iter().for_each(|&old| add(position[old as usize]));
        }
        for &child in &children[s] {
            let child: &Vec<u32> = &rows[child];
            child.iter().for_each(|&k| add(k));
        }
        below.sort_unstable();
        if let Some(&next) = below.first() {
            children[owner[next as usize] as usize].push(s);
        }
        rows.push((range.start as u32..end).chain(below).collect());
    }
    rows
}
