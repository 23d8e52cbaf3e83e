//! Triangles around joints, made anew.

use std::collections::{BTreeMap, HashMap};

use super::pattern::Pattern;
use super::sheet::{OUTSIDE, Sheet, cross, distance};
use crate::generate::delaunay::{Triangle, around, recover, triangulate};
use crate::generate::outline::{APART, CLEAR};
use crate::generate::squares::Squares;
use crate::generate::unit_interval;
use crate::topology::NO_ELEMENT;

/// How far from joints triangles are made anew, over the size of elements.
const REACH: f64 = 2.5;
/// Rounds in which free nodes move to the middle of their neighbours.
const ROUNDS: usize = 6;
/// Trials of new nodes for each edge of a joint.
const TRIALS: u64 = 24;

/// Triangles with their labels.
type Labelled = Vec<([u32; 3], u32)>;

/// A line between two local nodes that the triangles must have.
struct Kept {
    ends: [u32; 2],
    /// Labels on its left and right, where they are known.
    labels: Option<[u32; 2]>,
}

/// The mesh with its joints.
pub(super) struct Refilled {
    /// Places of all nodes: those of the mesh first, some of which are used no more.
    pub(super) at: Vec<[f64; 2]>,
    /// Triangles with their labels.
    pub(super) triangles: Labelled,
    /// Lines of joints.
    pub(super) joints: Vec<([u32; 2], u32)>,
    /// Parts of the lines of the mesh that are divided.
    pub(super) parts: Vec<([u32; 2], u32)>,
}

/// Fills the mesh around the joints of a pattern.
///
/// # Errors
/// A place that cannot be filled with triangles.
pub(super) fn refill(pattern: &Pattern<'_>, seed: u64) -> Result<Refilled, [f64; 2]> {
    let sheet = pattern.sheet;
    let mut local = Local::default();
    let mut parts = Vec::new();
    let mut joints = Vec::new();
    // Vertices that are in use, and the pieces of joints.
    let vertex = |local: &mut Local, vertex: u32| local.vertex(vertex, pattern);
    for segment in pattern.segments.iter().filter(|segment| segment.joint.is_some() && segment.fixed.is_none()) {
        let [a, b] = segment.ends.map(|end| vertex(&mut local, end));
        let [p, q] = [a, b].map(|end| local.at[end as usize]);
        let shares = division(sheet, [p, q]);
        let count = shares.len();
        let mut from = a;
        for (step, share) in (1..).zip(shares) {
            let to = if step == count {
                b
            } else {
                local.node([0, 1].map(|axis| p[axis] + share * (q[axis] - p[axis])), None)
            };
            local.kept.push(Kept { ends: [from, to], labels: None });
            joints.push(([from, to], segment.joint.unwrap_or(0)));
            from = to;
        }
    }
    let middles: Vec<[f64; 2]> = local.kept.iter().map(|kept| local.middle(kept.ends)).collect();
    let finest = middles.iter().map(|&at| sheet.size_at(at)).fold(f64::INFINITY, f64::min);
    let near_joints = Squares::new(&middles, 2.0 * finest);
    let is_near: Vec<bool> = (0..sheet.at.len())
        .map(|node| sheet.size[node] > 0.0 && near_joints.has_within(sheet.at[node], REACH * sheet.size[node]))
        .collect();
    let mut inside: Vec<bool> = sheet.triangles.iter().map(|t| t.iter().any(|&n| is_near[n as usize])).collect();
    joints.iter().flat_map(|(ends, _)| *ends).for_each(|node| {
        if let Some(triangle) = sheet.triangle_at(local.at[node as usize]) {
            inside[triangle as usize] = true;
        }
    });
    let in_region = |triangle: u32| inside.get(triangle as usize).copied().unwrap_or(false);
    for segment in &pattern.segments {
        let Some(fixed) = segment.fixed else { continue };
        let side = &sheet.fixed[fixed as usize];
        if !side.triangles.iter().any(|&triangle| in_region(triangle)) {
            if let Some(joint) = segment.joint {
                joints.push((segment.ends.map(|end| vertex(&mut local, end)), joint));
            }
            continue;
        }
        let ends = segment.ends.map(|end| vertex(&mut local, end));
        let labels = [0, 1].map(|at| if in_region(side.triangles[at]) { side.labels[at] } else { OUTSIDE });
        local.kept.push(Kept { ends, labels: Some(labels) });
        side.lines.iter().for_each(|&line| parts.push((ends, line)));
        if let Some(joint) = segment.joint {
            joints.push((ends, joint));
        }
    }
    // Where the region ends within a body.
    let is_fixed: HashMap<[u32; 2], ()> = sheet
        .fixed
        .iter()
        .map(|side| ([side.nodes[0].min(side.nodes[1]), side.nodes[0].max(side.nodes[1])], ()))
        .collect();
    for &(nodes, beside) in &sheet.sides {
        let [one, two] = beside.map(in_region);
        if one == two || beside[1] == NO_ELEMENT || is_fixed.contains_key(&nodes) {
            continue;
        }
        let own = if one { beside[0] } else { beside[1] };
        let t = sheet.triangles[own as usize];
        let forward = (0..3).any(|k| t[k] == nodes[0] && t[(k + 1) % 3] == nodes[1]);
        let nodes = if forward { nodes } else { [nodes[1], nodes[0]] };
        let ends = nodes.map(|node| local.of_mesh(node, sheet.at[node as usize]));
        local.kept.push(Kept { ends, labels: Some([sheet.label[own as usize], OUTSIDE]) });
    }
    let fixed_count = add_free(&mut local, pattern, &inside, seed);
    fill(local, pattern, (fixed_count, &inside), seed)
        .map(|(local, triangles)| assemble(pattern, &local, &inside, (triangles, joints, parts)))
}

/// Shares of a line at which it is divided, the last of which is 1: as much of the size of elements lies between each two.
fn division(sheet: &Sheet, [p, q]: [[f64; 2]; 2]) -> Vec<f64> {
    let length = distance(p, q);
    let at = |share: f64| [0, 1].map(|axis| p[axis] + share * (q[axis] - p[axis]));
    // Steps of a quarter of an element at the beginning of each.
    let (mut shares, mut sums) = (vec![0.0f64], vec![0.0f64]);
    while shares[shares.len() - 1] < 1.0 {
        let (from, sum) = (shares[shares.len() - 1], sums[sums.len() - 1]);
        let to = (from + 0.25 * sheet.size_at(at(from)) / length).min(1.0);
        let size = sheet.size_at(at(f64::midpoint(from, to)));
        shares.push(to);
        sums.push(sum + (to - from) * length / size);
    }
    let all = sums[sums.len() - 1];
    let count = all.round().max(1.0) as usize;
    let share = |part: usize| {
        let wanted = all * part as f64 / count as f64;
        let after = sums.partition_point(|&sum| sum < wanted).clamp(1, sums.len() - 1);
        let within = (wanted - sums[after - 1]) / (sums[after] - sums[after - 1]);
        shares[after - 1] + within * (shares[after] - shares[after - 1])
    };
    (1..=count).map(|part| if part == count { 1.0 } else { share(part) }).collect()
}

/// Nodes of the region.
#[derive(Default)]
struct Local {
    at: Vec<[f64; 2]>,
    /// The node of the mesh that each is.
    mesh: Vec<Option<u32>>,
    of_vertex: HashMap<u32, u32>,
    of_mesh: HashMap<u32, u32>,
    kept: Vec<Kept>,
    /// Those that must not move though no line keeps them.
    held: Vec<u32>,
}

impl Local {
    fn node(&mut self, at: [f64; 2], mesh: Option<u32>) -> u32 {
        self.at.push(at);
        self.mesh.push(mesh);
        self.at.len() as u32 - 1
    }

    fn of_mesh(&mut self, node: u32, at: [f64; 2]) -> u32 {
        if let Some(&known) = self.of_mesh.get(&node) {
            return known;
        }
        let new = self.node(at, Some(node));
        self.of_mesh.insert(node, new);
        new
    }

    fn vertex(&mut self, vertex: u32, pattern: &Pattern<'_>) -> u32 {
        if let Some(&known) = self.of_vertex.get(&vertex) {
            return known;
        }
        let at = pattern.at[vertex as usize];
        let new = match pattern.node[vertex as usize] {
            Some(node) => self.of_mesh(node, at),
            None => self.node(at, None),
        };
        self.of_vertex.insert(vertex, new);
        new
    }

    fn middle(&self, ends: [u32; 2]) -> [f64; 2] {
        let [p, q] = ends.map(|end| self.at[end as usize]);
        [0, 1].map(|axis| f64::midpoint(p[axis], q[axis]))
    }
}

/// Adds the free nodes of the region: those of the mesh that are in no line's way, and new ones where there is room; gives how many come before them.
fn add_free(local: &mut Local, pattern: &Pattern<'_>, inside: &[bool], seed: u64) -> usize {
    let sheet = pattern.sheet;
    let mut nodes: Vec<u32> =
        sheet.triangles.iter().zip(inside).filter(|(_, inside)| **inside).flat_map(|(t, _)| *t).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let (held, free): (Vec<u32>, Vec<u32>) =
        nodes.into_iter().filter(|node| !local.of_mesh.contains_key(node)).partition(|&node| sheet.held[node as usize]);
    for node in held {
        let held = local.of_mesh(node, sheet.at[node as usize]);
        local.held.push(held);
    }
    let count = local.at.len();
    let joints: Vec<[u32; 2]> = local.kept.iter().filter(|kept| kept.labels.is_none()).map(|kept| kept.ends).collect();
    let sizes = joints.iter().map(|&ends| sheet.size_at(local.middle(ends)));
    let side = 2.0 * sizes.fold(f64::INFINITY, f64::min);
    let lines: Vec<[f64; 2]> = local.kept.iter().map(|kept| local.middle(kept.ends)).collect();
    let lines = Squares::new(&lines, side);
    let mut taken = Squares::new(&local.at, side);
    let mut room = |local: &mut Local, at: [f64; 2], node: Option<u32>| {
        let size = sheet.size_at(at);
        if !taken.has_within(at, APART * size) && !lines.has_within(at, CLEAR * size) {
            taken.add(at);
            match node {
                Some(node) => local.of_mesh(node, at),
                None => local.node(at, None),
            };
        }
    };
    let of_joints: Vec<[f64; 2]> = joints.iter().flat_map(|ends| ends.map(|end| local.at[end as usize])).collect();
    let beside = Squares::new(&of_joints, side);
    for node in free {
        let (at, size) = (sheet.at[node as usize], sheet.size[node as usize]);
        if beside.has_within(at, 1.5 * size) {
            room(local, at, Some(node));
        } else {
            local.of_mesh(node, at);
        }
    }
    for (number, ends) in (0u64..).zip(joints) {
        let (middle, size) = (local.middle(ends), sheet.size_at(local.middle(ends)));
        for trial in 0..TRIALS {
            let random = |axis: u64| unit_interval(seed, 2 * (TRIALS * number + trial) + axis) - 0.5;
            let at = [middle[0] + 4.0 * size * random(0), middle[1] + 4.0 * size * random(1)];
            if sheet.triangle_at(at).is_some_and(|triangle| inside[triangle as usize]) {
                room(local, at, None);
            }
        }
    }
    count
}

/// Triangles of the region with their labels, after its free nodes have moved to good places.
fn fill(
    mut local: Local,
    pattern: &Pattern<'_>,
    (fixed, inside): (usize, &[bool]),
    seed: u64,
) -> Result<(Local, Labelled), [f64; 2]> {
    let sheet = pattern.sheet;
    let sizes: Vec<f64> = local.at.iter().map(|&at| sheet.size_at(at)).collect();
    let finest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let lines: Vec<[f64; 2]> = local.kept.iter().map(|kept| local.middle(kept.ends)).collect();
    let lines = Squares::new(&lines, 2.0 * finest);
    for _ in 0..ROUNDS {
        let triangles = triangles(&local, &sizes, finest, seed)?;
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); local.at.len()];
        for (t, _) in &triangles {
            for k in 0..3 {
                around[t[k] as usize].push(t[(k + 1) % 3]);
            }
        }
        for node in fixed..local.at.len() {
            let count = around[node].len() as f64;
            if count == 0.0 {
                continue;
            }
            let to = [0, 1].map(|axis| around[node].iter().map(|&n| local.at[n as usize][axis]).sum::<f64>() / count);
            if !lines.has_within(to, CLEAR * sizes[node]) {
                local.at[node] = to;
            }
        }
    }
    let triangles = triangles(&local, &sizes, finest, seed)?;
    let area = |corners: [[f64; 2]; 3]| cross(corners[0], corners[1], corners[2]);
    let of_mesh = sheet.triangles.iter().zip(inside).filter(|(_, inside)| **inside);
    let before: f64 = of_mesh.map(|(t, _)| area(t.map(|n| sheet.at[n as usize]))).sum();
    let after: f64 = triangles.iter().map(|(t, _)| area(t.map(|n| local.at[n as usize]))).sum();
    let flat = triangles.iter().find(|(t, _)| area(t.map(|n| local.at[n as usize])) <= 0.0);
    if let Some((t, _)) = flat {
        return Err(local.at[t[0] as usize]);
    }
    if (after - before).abs() > 1e-9 * before {
        return Err(local.at[0]);
    }
    Ok((local, triangles))
}

/// The triangles of the nodes as they are, with their labels.
fn triangles(local: &Local, sizes: &[f64], finest: f64, seed: u64) -> Result<Labelled, [f64; 2]> {
    // Points of straight lines are in special position; what joins them is found a little beside.
    let beside = |(index, &at): (usize, &[f64; 2])| {
        let shift = |axis: u64| 1e-5 * (unit_interval(seed, 2 * index as u64 + axis) - 0.5);
        [at[0] + shift(0) * sizes[index], at[1] + shift(1) * sizes[index]]
    };
    let shifted: Vec<[f64; 2]> = local.at.iter().enumerate().map(beside).collect();
    let row = |at: [f64; 2]| (at[1] / (8.0 * finest)).floor();
    let mut order: Vec<u32> = (0..local.at.len() as u32).collect();
    order.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|node| shifted[node as usize]);
        let along = if row(a) % 2.0 == 0.0 { a[0].total_cmp(&b[0]) } else { b[0].total_cmp(&a[0]) };
        row(a).total_cmp(&row(b)).then(along)
    });
    let sorted: Vec<[f64; 2]> = order.iter().map(|&node| shifted[node as usize]).collect();
    let mut new = vec![0u32; order.len()];
    (0u32..).zip(&order).for_each(|(number, &node)| new[node as usize] = number);
    let mut found = triangulate(&sorted);
    let mut labels: BTreeMap<[u32; 2], Option<[u32; 2]>> = BTreeMap::new();
    for kept in &local.kept {
        let [a, b] = kept.ends.map(|end| new[end as usize]);
        let turned = kept.labels.map(|[left, right]| if a < b { [left, right] } else { [right, left] });
        labels.insert([a.min(b), a.max(b)], turned);
    }
    let mut edges: std::collections::HashSet<[u32; 2]> = std::collections::HashSet::new();
    for t in &found {
        (0..3).for_each(|k| {
            let [a, b] = [t.nodes[k], t.nodes[(k + 1) % 3]];
            edges.insert([a.min(b), a.max(b)]);
        });
    }
    let missing: Vec<[u32; 2]> = labels.keys().filter(|edge| !edges.contains(*edge)).copied().collect();
    let keeps = |edge: [u32; 2]| labels.contains_key(&[edge[0].min(edge[1]), edge[0].max(edge[1])]);
    let all = [sorted.as_slice(), &around(&sorted)].concat();
    for edge in missing {
        if !recover(&mut found, &all, edge, &keeps) {
            return Err(sorted[edge[0] as usize]);
        }
    }
    let label = flood(&found, &labels);
    let inner = found.iter().zip(label).filter(|(_, label)| *label != OUTSIDE);
    Ok(inner.map(|(t, label)| (t.nodes.map(|node| order[node as usize]), label)).collect())
}

/// The label of each triangle: it is known beside lines of the mesh, and goes on through all others.
fn flood(triangles: &[Triangle], labels: &BTreeMap<[u32; 2], Option<[u32; 2]>>) -> Vec<u32> {
    let mut label = vec![None; triangles.len()];
    let mut open = Vec::new();
    let edge = |t: usize, side: usize| {
        let [a, b] = [1, 2].map(|step| triangles[t].nodes[(side + step) % 3]);
        labels.get(&[a.min(b), a.max(b)]).map(|labels| labels.map(|[left, right]| if a < b { left } else { right }))
    };
    for t in 0..triangles.len() {
        if let Some(known) = (0..3).find_map(|side| edge(t, side).flatten()) {
            label[t] = Some(known);
            open.push(t);
        }
    }
    while let Some(t) = open.pop() {
        for side in 0..3 {
            let next = triangles[t].next[side] as usize;
            if next < triangles.len() && label[next].is_none() && !matches!(edge(t, side), Some(Some(_))) {
                label[next] = label[t];
                open.push(next);
            }
        }
    }
    label.into_iter().map(|label| label.unwrap_or(OUTSIDE)).collect()
}

/// Triangles with labels, lines of joints, parts of lines.
type Pieces = (Labelled, Vec<([u32; 2], u32)>, Vec<([u32; 2], u32)>);

/// The whole mesh: what lies outside of the region as it was.
fn assemble(pattern: &Pattern<'_>, local: &Local, inside: &[bool], (triangles, joints, parts): Pieces) -> Refilled {
    let sheet = pattern.sheet;
    let mut at = sheet.at.clone();
    let number: Vec<u32> = local
        .at
        .iter()
        .zip(&local.mesh)
        .map(|(&place, mesh)| match mesh {
            Some(node) => {
                at[*node as usize] = place;
                *node
            }
            None => {
                at.push(place);
                at.len() as u32 - 1
            }
        })
        .collect();
    let named = |node: u32| number[node as usize];
    let old = sheet.triangles.iter().zip(&sheet.label).zip(inside).filter(|(_, inside)| !**inside);
    let old = old.map(|((t, label), _)| (*t, *label));
    Refilled {
        at,
        triangles: old.chain(triangles.into_iter().map(|(t, label)| (t.map(named), label))).collect(),
        joints: joints.into_iter().map(|(ends, joint)| (ends.map(named), joint)).collect(),
        parts: parts.into_iter().map(|(ends, line)| (ends.map(named), line)).collect(),
    }
}
