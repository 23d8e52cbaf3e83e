//! Plane bodies with holes, filled with triangles of a given size that lie in no rows.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::Vec3;
use fractum_math::elementary::sin_cos;

use super::delaunay::triangulate;
use super::squares::Squares;
use super::unit_interval;
use crate::{Group, Mesh};

/// A closed line around a body, counter-clockwise, or around a hole in it, clockwise.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Where it begins and ends.
    pub start: [f64; 2],
    /// Its pieces in turn.
    pub pieces: Vec<Piece>,
}

/// A piece of an outline. Empty names are of no group.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Where it leads.
    pub curve: Curve,
    /// Group of its lines.
    pub lines: &'static str,
    /// Group of the point at its end.
    pub end: &'static str,
}

/// The way of a piece.
#[derive(Clone, Copy, Debug)]
pub enum Curve {
    /// Straight to a point.
    Line([f64; 2]),
    /// Around a centre by an angle [rad], counter-clockwise if that is positive.
    Arc {
        /// The centre.
        centre: [f64; 2],
        /// The angle.
        angle: f64,
    },
}

impl Piece {
    /// A straight piece to a point, of a group of lines.
    pub fn line(to: [f64; 2], lines: &'static str) -> Self {
        Self { curve: Curve::Line(to), lines, end: "" }
    }

    /// An arc around a centre by an angle [rad], of a group of lines.
    pub fn arc(centre: [f64; 2], angle: f64, lines: &'static str) -> Self {
        Self { curve: Curve::Arc { centre, angle }, lines, end: "" }
    }

    /// The place at a share of its way.
    fn at(&self, from: [f64; 2], share: f64) -> [f64; 2] {
        match self.curve {
            Curve::Line(to) if share == 1.0 => to,
            Curve::Line(to) => [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])),
            Curve::Arc { centre, angle } => {
                let [x, y] = [from[0] - centre[0], from[1] - centre[1]];
                let (sin, cos) = sin_cos(share * angle);
                [centre[0] + x * cos - y * sin, centre[1] + x * sin + y * cos]
            }
        }
    }
}

/// Samples of a piece, from which its division is found.
const SAMPLES: usize = 256;
/// Rounds in which inner nodes move to the middle of their neighbours.
const ROUNDS: usize = 6;
/// Least distance of two nodes over the size of elements before they move; edges end at 1 in the mean.
pub(crate) const APART: f64 = 0.72;
/// Least distance of an inner node from the middle of a line of the outline, over the size of elements.
pub(crate) const CLEAR: f64 = 0.6;

/// Triangles of a body within an outline and without its holes.
///
/// - `outlines`: the body, then its holes, which must not touch
/// - `group`: of all triangles
/// - `size`: length of edges at a place; it should change by less than 0.3 of the distance
/// - `seed`: another one gives another mesh
///
/// # Panics
/// If outlines cross, or if holes are closer to each other than a few elements.
pub fn fill(outlines: &[Outline], group: &str, size: &dyn Fn([f64; 2]) -> f64, seed: u64) -> Mesh {
    let rim = Rim::new(outlines, size);
    let fixed = rim.nodes.len();
    let mut nodes = rim.nodes.clone();
    nodes.extend(scattered(&rim, size, seed));
    for _ in 0..ROUNDS {
        let triangles = rim.inner_triangles(&nodes, size, seed);
        let mut around: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); nodes.len()];
        for t in &triangles {
            t.iter().for_each(|&a| around[a as usize].extend(t.iter().filter(|&&b| b != a)));
        }
        let obstacles = Squares::new(&rim.middles, rim.finest);
        for node in (fixed..nodes.len()).filter(|&node| !around[node].is_empty()) {
            let count = around[node].len() as f64;
            let sum = |axis: usize| around[node].iter().map(|&other| nodes[other as usize][axis]).sum::<f64>();
            let to = [sum(0) / count, sum(1) / count];
            if !obstacles.has_within(to, CLEAR * size(to)) {
                nodes[node] = to;
            }
        }
    }
    let triangles = rim.inner_triangles(&nodes, size, seed);
    rim.mesh(&nodes, triangles, group)
}

/// The outlines in pieces of the size of elements.
struct Rim {
    nodes: Vec<[f64; 2]>,
    /// Nodes at both ends, and the group.
    lines: Vec<([u32; 2], &'static str)>,
    middles: Vec<[f64; 2]>,
    points: Vec<(u32, &'static str)>,
    /// The smallest size of elements on it.
    finest: f64,
}

impl Rim {
    fn new(outlines: &[Outline], size: &dyn Fn([f64; 2]) -> f64) -> Self {
        let mut rim = Rim {
            nodes: Vec::new(),
            lines: Vec::new(),
            middles: Vec::new(),
            points: Vec::new(),
            finest: f64::INFINITY,
        };
        for outline in outlines {
            let (first, mut from) = (rim.nodes.len() as u32, outline.start);
            for (index, piece) in outline.pieces.iter().enumerate() {
                let shares = division(piece, from, size);
                for pair in shares.windows(2) {
                    rim.lines.push(([rim.nodes.len() as u32, rim.nodes.len() as u32 + 1], piece.lines));
                    let [a, b] = [piece.at(from, pair[0]), piece.at(from, pair[1])];
                    rim.middles.push([0, 1].map(|axis| f64::midpoint(a[axis], b[axis])));
                    rim.finest = rim.finest.min(size(a));
                    rim.nodes.push(a);
                }
                from = piece.at(from, 1.0);
                let closes = index + 1 == outline.pieces.len();
                if !piece.end.is_empty() {
                    rim.points.push((if closes { first } else { rim.nodes.len() as u32 }, piece.end));
                }
            }
            if let Some((line, _)) = rim.lines.last_mut() {
                line[1] = first;
            }
        }
        rim
    }

    /// Whether a place is in the body: a ray from it crosses the rim an odd number of times.
    fn is_inside(&self, [x, y]: [f64; 2]) -> bool {
        let crossed = self.lines.iter().filter(|([a, b], _)| {
            let [a, b] = [self.nodes[*a as usize], self.nodes[*b as usize]];
            (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        });
        crossed.count() % 2 == 1
    }

    /// The triangles of the body.
    fn inner_triangles(&self, nodes: &[[f64; 2]], size: &dyn Fn([f64; 2]) -> f64, seed: u64) -> Vec<[u32; 3]> {
        // Points of straight lines and circles are in special position; what joins them is found a little beside.
        let beside = |(index, &at): (usize, &[f64; 2])| {
            let shift = |axis: u64| 1e-5 * (unit_interval(seed, 2 * index as u64 + axis) - 0.5);
            [at[0] + shift(0) * size(at), at[1] + shift(1) * size(at)]
        };
        let shifted: Vec<[f64; 2]> = nodes.iter().enumerate().map(beside).collect();
        // Neighbours follow each other: rows of the rim's finest size, to and fro.
        let row = |at: [f64; 2]| (at[1] / (8.0 * self.finest)).floor();
        let mut order: Vec<usize> = (0..nodes.len()).collect();
        order.sort_by(|&a, &b| {
            let [a, b] = [shifted[a], shifted[b]];
            let along = if row(a) % 2.0 == 0.0 { a[0].total_cmp(&b[0]) } else { b[0].total_cmp(&a[0]) };
            row(a).total_cmp(&row(b)).then(along)
        });
        let sorted: Vec<[f64; 2]> = order.iter().map(|&node| shifted[node]).collect();
        let triangles = triangulate(&sorted);
        let edges: BTreeSet<[u32; 2]> = self.lines.iter().map(|&([a, b], _)| [a.min(b), a.max(b)]).collect();
        let name = |node: u32| order.get(node as usize).map_or(u32::MAX, |&node| node as u32);
        // From outside, every line of the rim leads in or out.
        let outside = triangles.iter().position(|t| t.nodes.iter().any(|&node| name(node) == u32::MAX));
        let mut inside: Vec<Option<bool>> = vec![None; triangles.len()];
        let (mut open, mut crossed) = (Vec::from_iter(outside), BTreeSet::new());
        open.iter().for_each(|&t| inside[t] = Some(false));
        while let Some(t) = open.pop() {
            for side in 0..3 {
                let [a, b] = [1, 2].map(|step| name(triangles[t].nodes[(side + step) % 3]));
                let edge = [a.min(b), a.max(b)];
                let crosses = edges.contains(&edge);
                if crosses {
                    crossed.insert(edge);
                }
                let next = triangles[t].next[side] as usize;
                if next < triangles.len() && inside[next].is_none() {
                    inside[next] = Some((inside[t] == Some(true)) != crosses);
                    open.push(next);
                }
            }
        }
        assert_eq!(crossed.len(), edges.len(), "outlines cross, or are closer to each other than an element");
        let inner = triangles.iter().zip(&inside).filter(|(_, inside)| **inside == Some(true));
        inner.map(|(t, _)| t.nodes.map(name)).collect()
    }

    fn mesh(&self, nodes: &[[f64; 2]], triangles: Vec<[u32; 3]>, group: &str) -> Mesh {
        let mut mesh = Mesh { nodes: nodes.iter().map(|at| Vec3::new(at[0], at[1], 0.0)).collect(), ..Mesh::default() };
        let mut groups: BTreeMap<(u8, &str), Group> = BTreeMap::new();
        let mut of = |dimension: u8, name: &'static str, add: &dyn Fn(&mut Group)| {
            let new = || Group { name: name.to_owned(), dimension, ..Group::default() };
            add(groups.entry((dimension, name)).or_insert_with(new));
        };
        for &(node, name) in &self.points {
            of(0, name, &|group| group.points.push(mesh.points.len() as u32));
            mesh.points.push([node]);
        }
        for &(line, name) in self.lines.iter().filter(|(_, name)| !name.is_empty()) {
            of(1, name, &|group| group.lines.push(mesh.lines.len() as u32));
            mesh.lines.push(line);
        }
        mesh.groups = groups.into_values().collect();
        let all = (0..triangles.len() as u32).collect();
        mesh.groups.push(Group { name: group.to_owned(), dimension: 2, triangles: all, ..Group::default() });
        mesh.groups.iter_mut().zip(1..).for_each(|(group, tag)| group.tag = tag);
        mesh.triangles = triangles;
        mesh.number();
        mesh
    }
}

/// Shares of the way of a piece at which it is divided, from 0 to 1: as much of the size of elements lies between each two.
fn division(piece: &Piece, from: [f64; 2], size: &dyn Fn([f64; 2]) -> f64) -> Vec<f64> {
    let mut sum = vec![0.0];
    let mut last = from;
    for sample in 1..=SAMPLES {
        let at = piece.at(from, sample as f64 / SAMPLES as f64);
        let [x, y] = [at[0] - last[0], at[1] - last[1]];
        let middle = [0, 1].map(|axis| f64::midpoint(at[axis], last[axis]));
        sum.push(sum[sample - 1] + (x * x + y * y).sqrt() / size(middle));
        last = at;
    }
    let count = sum[SAMPLES].round().max(1.0) as usize;
    let share = |part: usize| {
        let wanted = sum[SAMPLES] * part as f64 / count as f64;
        let after = sum.partition_point(|&value| value < wanted).clamp(1, SAMPLES);
        let within = (wanted - sum[after - 1]) / (sum[after] - sum[after - 1]);
        ((after - 1) as f64 + within) / SAMPLES as f64
    };
    (0..=count).map(|part| if part == count { 1.0 } else { share(part) }).collect()
}

/// Inner nodes at random, none nearer to another than [`APART`] sizes, and hardly room for one more.
fn scattered(rim: &Rim, size: &dyn Fn([f64; 2]) -> f64, seed: u64) -> Vec<[f64; 2]> {
    let [low, high] =
        [f64::min, f64::max].map(|f| [0, 1].map(|axis| rim.nodes.iter().map(|p| p[axis]).fold(f64::NAN, f)));
    let pitch = 0.4 * rim.finest;
    let [columns, rows] = [0, 1].map(|axis| ((high[axis] - low[axis]) / pitch).ceil() as u64);
    let mut taken = Squares::new(&rim.nodes, rim.finest);
    let middles = Squares::new(&rim.middles, rim.finest);
    let mut cells: Vec<(u64, u64)> =
        (0..columns * rows).map(|cell| ((unit_interval(seed, cell) * 2f64.powi(52)) as u64, cell)).collect();
    cells.sort_unstable();
    let mut nodes = Vec::new();
    for (_, cell) in cells {
        let random = |number: u64| unit_interval(seed.wrapping_add(1), 3 * cell + number);
        let at = [
            low[0] + pitch * ((cell % columns) as f64 + random(0)),
            low[1] + pitch * ((cell / columns) as f64 + random(1)),
        ];
        let here = size(at);
        // Large elements need few trials.
        let share = 2.0 * rim.finest / here;
        if random(2) < share * share
            && !taken.has_within(at, APART * here)
            && !middles.has_within(at, CLEAR * here)
            && rim.is_inside(at)
        {
            taken.add(at);
            nodes.push(at);
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::quality::{area_vector, triangle};

    fn plate(seed: u64) -> Mesh {
        let round = |to, lines| Piece::line(to, lines);
        let plate = Outline {
            start: [0.0, 0.0],
            pieces: vec![
                Piece { end: "corner", ..round([2.0, 0.0], "") },
                round([2.0, 1.0], "right"),
                round([0.0, 1.0], ""),
                round([0.0, 0.0], "left"),
            ],
        };
        let hole = Outline { start: [0.7, 0.5], pieces: vec![Piece::arc([0.5, 0.5], -2.0 * PI, "hole")] };
        fill(&[plate, hole], "plate", &|[x, y]| 0.03 + 0.1 * ((x - 0.5).powi(2) + (y - 0.5).powi(2)).sqrt(), seed)
    }

    #[test]
    fn a_plate_with_a_hole_is_filled_with_good_triangles_of_the_size_asked_for() {
        for seed in 1..6 {
            let mesh = plate(seed);
            let corners = |t: &[u32; 3]| t.map(|node| mesh.nodes[node as usize]);
            let area: f64 = mesh.triangles.iter().map(|t| area_vector(corners(t)).z).sum();
            // The circle is a polygon.
            assert!((area / (2.0 - 0.04 * PI) - 1.0).abs() < 2e-3, "{area}");
            let worst = mesh.triangles.iter().map(|t| triangle(corners(t)).radius_ratio).fold(1.0, f64::min);
            assert!(worst > 0.5, "radius ratio {worst}");
            let share = |t: &[u32; 3]| {
                let [a, b, c] = corners(t);
                let middle = (a + b + c) / 3.0;
                let wanted = 0.03 + 0.1 * ((middle.x - 0.5).powi(2) + (middle.y - 0.5).powi(2)).sqrt();
                ((a - b).norm() + (b - c).norm() + (c - a).norm()) / (3.0 * wanted)
            };
            let mean = mesh.triangles.iter().map(share).sum::<f64>() / mesh.triangles.len() as f64;
            assert!((0.93..1.07).contains(&mean), "edges of {mean} of the size asked for");
            assert_eq!(mesh.group_nodes("corner").len(), 1);
            assert!(mesh.group_nodes("right").iter().all(|&node| mesh.nodes[node as usize].x == 2.0));
            assert!(mesh.group_nodes("hole").len() > 20 && mesh.group_nodes("plate").len() == mesh.nodes.len());
        }
        assert_eq!(plate(1), plate(1));
        assert_ne!(plate(1).nodes, plate(2).nodes);
    }
}
