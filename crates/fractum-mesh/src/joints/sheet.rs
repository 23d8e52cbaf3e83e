//! A plane mesh as joints find it: which lines must stay, how large elements are, and which body a place is in.

use std::collections::HashMap;

use crate::Mesh;
use crate::topology::{NO_ELEMENT, sides_of_triangles};

/// Outside of all bodies.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// By how much the size of elements changes at most, over the distance.
const GRADING: f64 = 0.35;
/// How often the sizes at the ends of all edges are made to fit each other.
const SMOOTHED: usize = 8;

/// A side of elements that must stay: of the surface, between groups, or with lines of its own.
#[derive(Clone, Debug)]
pub(super) struct FixedSide {
    /// Its nodes; the first triangle is on its left.
    pub(super) nodes: [u32; 2],
    /// Labels on its left and right.
    pub(super) labels: [u32; 2],
    /// Triangles on its left and right.
    pub(super) triangles: [u32; 2],
    /// Lines of the mesh on it.
    pub(super) lines: Vec<u32>,
}

/// A plane mesh with what joints must leave alone.
pub(super) struct Sheet {
    /// Places of the nodes.
    pub(super) at: Vec<[f64; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Groups of elements by their label.
    pub(super) labels: Vec<Vec<u32>>,
    /// Label of each triangle.
    pub(super) label: Vec<u32>,
    pub(super) fixed: Vec<FixedSide>,
    /// Sides of all triangles, and the triangles beside each.
    pub(super) sides: Vec<([u32; 2], [u32; 2])>,
    /// Nodes that other elements have too.
    pub(super) held: Vec<bool>,
    /// Mean length of the edges at a node.
    pub(super) size: Vec<f64>,
    /// For each group of joints whether they may lie in each triangle.
    allowed: Vec<Vec<bool>>,
    nodes: Buckets,
    middles: Buckets,
}

impl Sheet {
    /// - `elements`: for each group of joints whether they may lie in each triangle; in all where it is empty
    ///
    /// None where more than two triangles share a side.
    pub(super) fn new(mesh: &Mesh, elements: &[&[bool]]) -> Option<Self> {
        let at: Vec<[f64; 2]> = mesh.nodes.iter().map(|node| [node.x, node.y]).collect();
        let triangles = mesh.triangles.clone();
        let (labels, label) = labels(mesh, triangles.len(), |group| &group.triangles);
        let found = sides_of_triangles(&triangles).ok()?;
        let mut lines: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
        for (line, &[a, b]) in (0..).zip(&mesh.lines) {
            lines.entry([a.min(b), a.max(b)]).or_default().push(line);
        }
        let sides: Vec<([u32; 2], [u32; 2])> =
            found.nodes.iter().copied().zip(found.elements.iter().copied()).collect();
        let mut fixed = Vec::new();
        for &(nodes, beside) in &sides {
            let of = |triangle: u32| label.get(triangle as usize).copied().unwrap_or(OUTSIDE);
            let [first, second] = beside.map(of);
            let own = lines.get(&nodes);
            if beside[1] != NO_ELEMENT && first == second && own.is_none() {
                continue;
            }
            let [a, b] = nodes;
            let t = triangles[beside[0] as usize];
            let forward = (0..3).any(|k| t[k] == a && t[(k + 1) % 3] == b);
            let nodes = if forward { [a, b] } else { [b, a] };
            let lines = own.cloned().unwrap_or_default();
            fixed.push(FixedSide { nodes, labels: [first, second], triangles: beside, lines });
        }
        let mut held = vec![false; at.len()];
        mesh.points.iter().for_each(|point| held[point[0] as usize] = true);
        let (mut sum, mut count) = (vec![0.0; at.len()], vec![0usize; at.len()]);
        for &([a, b], _) in &sides {
            let length = distance(at[a as usize], at[b as usize]);
            for node in [a, b] {
                sum[node as usize] += length;
                count[node as usize] += 1;
            }
        }
        let mut size: Vec<f64> = sum.iter().zip(&count).map(|(sum, &count)| sum / count.max(1) as f64).collect();
        for _ in 0..SMOOTHED {
            for &([a, b], _) in &sides {
                let [a, b] = [a as usize, b as usize];
                let more = GRADING * distance(at[a], at[b]);
                (size[a], size[b]) = (size[a].min(size[b] + more), size[b].min(size[a] + more));
            }
        }
        let allowed = elements.iter().map(|own| allowed(own, triangles.len())).collect();
        let used = (0..at.len()).filter(|&node| count[node] > 0).map(|node| (at[node], node as u32));
        let mean = sum.iter().sum::<f64>() / count.iter().sum::<usize>().max(1) as f64;
        let nodes = Buckets::new(used, 2.0 * mean);
        let middle = |t: &[u32; 3]| [0, 1].map(|axis| t.iter().map(|&n| at[n as usize][axis]).sum::<f64>() / 3.0);
        let middles = Buckets::new(triangles.iter().zip(0..).map(|(t, number)| (middle(t), number)), 2.0 * mean);
        Some(Sheet { at, triangles, labels, label, fixed, sides, held, size, allowed, nodes, middles })
    }

    /// Length of edges at a place.
    pub(super) fn size_at(&self, at: [f64; 2]) -> f64 {
        self.nodes.nearest(at).map_or(f64::INFINITY, |node| self.size[node as usize])
    }

    /// The triangle that a place is in.
    pub(super) fn triangle_at(&self, at: [f64; 2]) -> Option<u32> {
        let holds = |&triangle: &u32| {
            let corners = self.triangles[triangle as usize].map(|n| self.at[n as usize]);
            (0..3).all(|k| cross(corners[k], corners[(k + 1) % 3], at) >= 0.0)
        };
        // Where elements are of one size the nearest middles decide; larger ones are looked for farther away.
        let near = self.size_at(at);
        self.middles.within(at, 1.5 * near).into_iter().find(holds).or_else(|| {
            let all = self.middles.within(at, 6.0 * near);
            all.into_iter().find(holds)
        })
    }

    /// Whether joints of a group may be at a place.
    pub(super) fn is_allowed(&self, group: u32, at: [f64; 2]) -> bool {
        let allowed = &self.allowed[group as usize];
        self.triangle_at(at).is_some_and(|triangle| allowed[triangle as usize])
    }

    /// Lowest and highest coordinates of where joints may be.
    pub(super) fn extent(&self) -> [[f64; 2]; 2] {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (number, t) in self.triangles.iter().enumerate() {
            if !self.allowed.iter().any(|allowed| allowed[number]) {
                continue;
            }
            let corners = t.map(|n| self.at[n as usize]);
            for corner in corners {
                for axis in 0..2 {
                    low[axis] = low[axis].min(corner[axis]);
                    high[axis] = high[axis].max(corner[axis]);
                }
            }
        }
        [low, high]
    }
}

/// Whether each element may have joints, in full.
pub(super) fn allowed(elements: &[bool], count: usize) -> Vec<bool> {
    if elements.is_empty() { vec![true; count] } else { elements.to_vec() }
}

/// Sets of groups that elements belong to, and which of them each has.
pub(super) fn labels(
    mesh: &Mesh,
    count: usize,
    members: impl Fn(&crate::Group) -> &Vec<u32>,
) -> (Vec<Vec<u32>>, Vec<u32>) {
    let mut of: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (number, group) in (0..).zip(&mesh.groups) {
        members(group).iter().for_each(|&element| of[element as usize].push(number));
    }
    let (mut known, mut labels): (HashMap<Vec<u32>, u32>, Vec<Vec<u32>>) = (HashMap::new(), Vec::new());
    let label = of.into_iter().map(|groups| {
        *known.entry(groups).or_insert_with_key(|groups| {
            labels.push(groups.clone());
            labels.len() as u32 - 1
        })
    });
    let label = label.collect();
    (labels, label)
}

/// Distance of two places.
pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

/// Twice the area of three places, positive counter-clockwise.
pub(super) fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Numbered places by squares.
struct Buckets {
    side: f64,
    squares: HashMap<[i64; 2], Vec<([f64; 2], u32)>>,
    /// More squares than that lie between no two places.
    span: i64,
}

impl Buckets {
    fn new(places: impl Iterator<Item = ([f64; 2], u32)>, side: f64) -> Self {
        let (mut squares, mut low, mut high) = (HashMap::new(), [i64::MAX; 2], [i64::MIN; 2]);
        for (at, number) in places {
            let square = at.map(|x| (x / side).floor() as i64);
            for axis in 0..2 {
                low[axis] = low[axis].min(square[axis]);
                high[axis] = high[axis].max(square[axis]);
            }
            squares.entry(square).or_insert_with(Vec::new).push((at, number));
        }
        let span = (0..2).map(|axis| high[axis].saturating_sub(low[axis])).max().unwrap_or(0);
        Buckets { side, squares, span }
    }

    fn within(&self, at: [f64; 2], reach: f64) -> Vec<u32> {
        let [low, high] = [-reach, reach].map(|by| at.map(|x| ((x + by) / self.side).floor() as i64));
        let mut found = Vec::new();
        for row in low[1]..=high[1] {
            for column in low[0]..=high[0] {
                let square = self.squares.get(&[column, row]);
                found.extend(square.into_iter().flatten().filter(|(p, _)| distance(*p, at) <= reach).map(|(_, n)| *n));
            }
        }
        found
    }

    fn nearest(&self, at: [f64; 2]) -> Option<u32> {
        let square = at.map(|x| (x / self.side).floor() as i64);
        let mut best: Option<(f64, u32)> = None;
        for ring in 0..=2 * self.span + 2 {
            if best.is_some_and(|(nearest, _)| nearest <= (ring - 1) as f64 * self.side) {
                break;
            }
            for row in -ring..=ring {
                let step = if row.abs() == ring { 1 } else { 2 * ring };
                let mut column = -ring;
                while column <= ring {
                    let places = self.squares.get(&[square[0] + column, square[1] + row]);
                    for &(p, number) in places.into_iter().flatten() {
                        let far = distance(p, at);
                        if best.is_none_or(|best| (far, number) < best) {
                            best = Some((far, number));
                        }
                    }
                    column += step.max(1);
                }
            }
        }
        best.map(|(_, number)| number)
    }
}
