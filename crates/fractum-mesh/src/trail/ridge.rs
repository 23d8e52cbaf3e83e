//! The ridge of damage: a line from the root of a crack, along the middle of damage, and straight ahead to the far side.
//!
//! A way through the nodes of the mesh that costs least where damage is largest gives its course. Stations on the way then move onto lines that are fitted to the
//! damage around them by least squares.

use super::ways::Roads;
use super::{Place, ahead, cross, dot, length, lengths, minus, unit};
use crate::Mesh;
use crate::topology::{BoundaryEdge, boundary_of_triangles, edges_of_triangles};

/// How far damage counts at a node, in sizes of damaged elements.
const REACH: f64 = 2.0;
/// Elements at most this far from each other, in their sizes, are of one crack.
const TOGETHER: f64 = 1.5;
/// Damage of another crack, over that of the largest, from which on there are several.
const ANOTHER: f64 = 0.25;
/// Damage at the end of a crack, over the largest at a node.
const END: f64 = 0.4;
/// What undamaged edges save, over those with the largest damage.
const INTACT: f64 = 0.03;
/// Distance of stations, in sizes.
const STATIONS: f64 = 1.5;
/// To how much of a crack to either side, and to how many sizes at least, a station's line is fitted.
const FITTED: (f64, f64) = (0.2, 3.0);
/// The part of a crack that tells where it goes on, and how many sizes at least.
const TAIL: (f64, f64) = (0.35, 4.0);
/// How far a station moves at most, in sizes.
const MOST_MOVE: f64 = 2.0;
const ROUNDS: usize = 3;

/// An element that is damaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Its centre.
    pub at: [f64; 2],
    /// Edge of a regular triangle of its area.
    pub size: f64,
    /// Its damage, above 0 up to 1.
    pub damage: f64,
}

impl Spot {
    fn weight(&self) -> f64 {
        self.damage * self.size * self.size
    }
}

/// The line of a crack.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// From side to side of the body, its root first.
    pub line: Vec<[f64; 2]>,
    /// Length along which it was damaged; the rest goes straight ahead.
    pub seen: f64,
    /// Size of the damaged elements.
    pub size: f64,
}

/// Why no line is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RidgeError {
    /// A mesh of no triangles in the plane, or without damage.
    #[error("no elements in the plane are damaged")]
    Nothing,
    /// More than one crack.
    #[error("damage lies at {0} places")]
    Several(usize),
    /// No crack begins inside, as far as is known here.
    #[error("damage does not come to a side of the body")]
    Inside,
    /// Damage on a spot.
    #[error("damage is no longer than it is wide")]
    Short,
    /// The line ahead does not leave the body.
    #[error("the line does not come to another side of the body")]
    NoEnd,
}

/// The ridge of damage.
///
/// - `spots`: damaged elements of that mesh
///
/// # Errors
/// [`RidgeError`].
pub fn ridge(mesh: &Mesh, spots: &[Spot]) -> Result<Ridge, RidgeError> {
    if !mesh.is_plane() || spots.is_empty() {
        return Err(RidgeError::Nothing);
    }
    let spots = largest(spots)?;
    let all: f64 = spots.iter().map(Spot::weight).sum();
    let size = spots.iter().map(|spot| spot.weight() * spot.size).sum::<f64>() / all;
    let sides = boundary_of_triangles(&mesh.triangles);
    let damage = Damage::new(mesh, &spots, size);
    let (root, is_notch) = root(mesh, &sides, &damage).ok_or(RidgeError::Inside)?;
    let mut line = course(mesh, root, &damage).ok_or(RidgeError::Short)?;
    for _ in 0..ROUNDS {
        line = fitted(&line, &spots, size, is_notch);
    }
    let seen = lengths(&line)[line.len() - 1];
    if seen < 3.0 * size {
        return Err(RidgeError::Short);
    }
    let side = Sides { mesh, edges: &sides };
    if !is_notch {
        // Straight back to the side, since damage there is wide.
        let back = unit(minus(line[0], line[3.min(line.len() - 1)])).ok_or(RidgeError::Short)?;
        let way = side.beyond(line[1], back).filter(|way| *way < 6.0 * size).ok_or(RidgeError::Inside)?;
        line[0] = ahead(line[1], back, way);
    }
    let direction = tail(&line, size).ok_or(RidgeError::Short)?;
    // A crack that has come to the far side may have its last stations on it.
    let (last, way) = loop {
        let last = line[line.len() - 1];
        match side.beyond(last, direction) {
            Some(way) => break (last, way),
            None if line.len() > 2 => line.pop(),
            None => return Err(RidgeError::NoEnd),
        };
    };
    if way < 0.75 * size {
        line.pop();
    }
    line.push(ahead(last, direction, way));
    Ok(Ridge { line, seen, size })
}

/// The damaged elements of the largest crack.
fn largest(spots: &[Spot]) -> Result<Vec<Spot>, RidgeError> {
    let mut order: Vec<usize> = (0..spots.len()).collect();
    order.sort_by(|&a, &b| spots[a].at[0].total_cmp(&spots[b].at[0]).then(a.cmp(&b)));
    let most = spots.iter().map(|spot| spot.size).fold(0.0, f64::max);
    let mut part: Vec<usize> = (0..spots.len()).collect();
    fn first(part: &mut [usize], mut of: usize) -> usize {
        while part[of] != of {
            part[of] = part[part[of]];
            of = part[of];
        }
        of
    }
    for (rank, &a) in order.iter().enumerate() {
        let near = order[rank + 1..].iter().take_while(|&&b| spots[b].at[0] - spots[a].at[0] <= TOGETHER * most);
        for &b in near {
            if length(minus(spots[a].at, spots[b].at)) <= TOGETHER * spots[a].size.max(spots[b].size) {
                let (one, other) = (first(&mut part, a), first(&mut part, b));
                part[one.max(other)] = one.min(other);
            }
        }
    }
    let own: Vec<usize> = (0..spots.len()).map(|spot| first(&mut part, spot)).collect();
    let mut sums = vec![0.0; spots.len()];
    own.iter().zip(spots).for_each(|(&part, spot)| sums[part] += spot.weight());
    let top = sums.iter().copied().fold(0.0, f64::max);
    let count = sums.iter().filter(|sum| **sum > ANOTHER * top).count();
    if count > 1 {
        return Err(RidgeError::Several(count));
    }
    let is_largest = |part: usize| sums[part] == top;
    Ok(spots.iter().zip(own).filter(|(_, part)| is_largest(*part)).map(|(spot, _)| *spot).collect())
}

/// Damage at nodes.
struct Damage {
    /// Sums of the damage around, by a bell of two sizes.
    of_node: Vec<f64>,
    /// The largest.
    top: f64,
    /// Whether a damaged element is next to it.
    is_near: Vec<bool>,
}

impl Damage {
    fn new(mesh: &Mesh, spots: &[Spot], size: f64) -> Self {
        let reach = REACH * size;
        let side = |x: f64| (x / reach).floor() as i64;
        let mut cells: std::collections::HashMap<[i64; 2], Vec<&Spot>> = std::collections::HashMap::new();
        spots.iter().for_each(|spot| cells.entry(spot.at.map(side)).or_default().push(spot));
        let mut damage = Damage { of_node: Vec::new(), top: 0.0, is_near: Vec::new() };
        for node in &mesh.nodes {
            let at = [node.x, node.y];
            let middle = at.map(side);
            let (mut sum, mut is_near) = (0.0, false);
            for cell in 0..9 {
                let cell = [middle[0] + cell % 3 - 1, middle[1] + cell / 3 - 1];
                for spot in cells.get(&cell).into_iter().flatten() {
                    let square = (length(minus(at, spot.at)) / reach).powi(2);
                    sum += spot.weight() * (1.0 - square).max(0.0).powi(2);
                    is_near |= square * reach * reach < 0.8 * spot.size * spot.size;
                }
            }
            damage.of_node.push(sum);
            damage.is_near.push(is_near);
            damage.top = damage.top.max(sum);
        }
        damage
    }
}

/// Where the crack begins: of the nodes on the sides that damage has come to that with the most, notches before all others; and whether it is one.
fn root(mesh: &Mesh, sides: &[BoundaryEdge], damage: &Damage) -> Option<(u32, bool)> {
    let mut to = vec![None; mesh.nodes.len()];
    sides.iter().for_each(|edge| to[edge.nodes[1] as usize] = Some(edge.nodes[0]));
    let at = |node: u32| [mesh.nodes[node as usize].x, mesh.nodes[node as usize].y];
    let is_notch = |edge: &BoundaryEdge| {
        let [node, next] = edge.nodes;
        let Some(before) = to[node as usize] else { return false };
        let (come, go) = (minus(at(node), at(before)), minus(at(next), at(node)));
        let size = length(come) * length(go);
        // The body lies to the left: by more than 45 degrees to the right.
        cross(come, go) < 1e-9 * size && dot(come, go) < std::f64::consts::FRAC_1_SQRT_2 * size
    };
    let near = sides.iter().filter(|edge| damage.is_near[edge.nodes[0] as usize]);
    let most = |a: &(u32, bool), b: &(u32, bool)| {
        let of = |node: u32| damage.of_node[node as usize];
        a.1.cmp(&b.1).then(of(a.0).total_cmp(&of(b.0))).then(b.0.cmp(&a.0))
    };
    near.map(|edge| (edge.nodes[0], is_notch(edge))).max_by(most)
}

/// The way from the root along the most damage to where it ends.
fn course(mesh: &Mesh, root: u32, damage: &Damage) -> Option<Vec<Place>> {
    let at = |node: u32| [mesh.nodes[node as usize].x, mesh.nodes[node as usize].y];
    let edges = edges_of_triangles(&mesh.triangles).nodes;
    let long = |[a, b]: [u32; 2]| length(minus(at(a), at(b)));
    let of = |node: u32| damage.of_node[node as usize] / damage.top;
    let roads =
        |cost: &dyn Fn([u32; 2]) -> f64| Roads::new(mesh.nodes.len(), edges.iter().map(|&own| (own, cost(own))));
    let (way, _) = roads(&long).from(root);
    let is_damaged = |node: &u32| damage.is_near[*node as usize] && of(*node) > END && way[*node as usize].is_finite();
    let nodes = (0..mesh.nodes.len() as u32).filter(is_damaged);
    let end = nodes.max_by(|&a, &b| way[a as usize].total_cmp(&way[b as usize]).then(b.cmp(&a)))?;
    let cost = |own: [u32; 2]| long(own) / (INTACT + (0.5 * (of(own[0]) + of(own[1]))).powi(2));
    let found = roads(&cost).way(root, end)?;
    (found.len() > 2).then(|| found.into_iter().map(at).collect())
}

/// Stations along a line, each on a line that is fitted to the damage around it.
fn fitted(line: &[Place], spots: &[Spot], size: f64, is_notch: bool) -> Vec<Place> {
    let ways = lengths(line);
    let whole = ways[ways.len() - 1];
    let count = (whole / (STATIONS * size)).round().max(1.0) as usize;
    let stations: Vec<Place> =
        (0..=count).map(|step| at_way(line, &ways, whole * step as f64 / count as f64)).collect();
    let reach = (FITTED.1 * size).max(FITTED.0 * whole);
    let last = stations.len() - 1;
    let station = |index: usize| -> Place {
        let own = stations[index];
        let along = unit(minus(stations[(index + 2).min(last)], stations[index.saturating_sub(2)]));
        let Some(along) = along.filter(|_| index > 0 || !is_notch) else { return own };
        let across = [-along[1], along[0]];
        // Weight, its moments along, and those of the distance across.
        let mut sums = [0.0; 5];
        let add = |sums: &mut [f64; 5], weight: f64, [x, y]: Place| {
            let terms = [1.0, x, x * x, y, x * y];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
        };
        for spot in spots {
            let from = minus(spot.at, own);
            let [x, y] = [dot(from, along), dot(from, across)];
            if x.abs() < reach && y.abs() < 3.0 * size + 0.3 * x.abs() {
                add(&mut sums, spot.weight() * (1.0 - x.abs() / reach), [x, y]);
            }
        }
        if is_notch {
            // It begins at the root, which counts as much as all damage around.
            let from = minus(stations[0], own);
            let [x, y] = [dot(from, along), dot(from, across)];
            let weight = sums[0] * (1.0 - x.abs() / reach).max(0.0);
            add(&mut sums, weight, [x, y]);
        }
        let [all, x, xx, y, xy] = sums;
        let determinant = all * xx - x * x;
        let off = match determinant > 1e-6 * all * xx {
            true => (xx * y - x * xy) / determinant,
            false if all > 0.0 => y / all,
            false => 0.0,
        };
        ahead(own, across, off.clamp(-MOST_MOVE * size, MOST_MOVE * size))
    };
    (0..=last).map(station).collect()
}

/// The place a way along a line.
fn at_way(line: &[Place], ways: &[f64], way: f64) -> Place {
    let after = ways.partition_point(|&own| own < way).clamp(1, ways.len() - 1);
    let step = ways[after] - ways[after - 1];
    let share = if step > 0.0 { (way - ways[after - 1]) / step } else { 0.0 };
    ahead(line[after - 1], minus(line[after], line[after - 1]), share)
}

/// The direction of the last part of a line: that along which its stations scatter most.
fn tail(line: &[Place], size: f64) -> Option<Place> {
    let ways = lengths(line);
    let whole = ways[ways.len() - 1];
    let from = whole - (TAIL.1 * size).max(TAIL.0 * whole);
    let own: Vec<Place> = line.iter().zip(&ways).filter(|(_, way)| **way >= from).map(|(at, _)| *at).collect();
    let mean = [0, 1].map(|axis| own.iter().map(|at| at[axis]).sum::<f64>() / own.len() as f64);
    let sum = |f: fn(Place) -> f64| own.iter().map(|&at| f(minus(at, mean))).sum::<f64>();
    let (xx, yy, xy) = (sum(|at| at[0] * at[0]), sum(|at| at[1] * at[1]), sum(|at| at[0] * at[1]));
    // The eigenvector of the larger eigenvalue.
    let half = 0.5 * (xx - yy);
    let root = (half * half + xy * xy).sqrt();
    let direction = if half > 0.0 { [half + root, xy] } else { [xy, root - half] };
    let forward = minus(line[line.len() - 1], own[0]);
    let direction = unit(direction).or_else(|| unit(forward))?;
    Some(if dot(direction, forward) < 0.0 { direction.map(|x| -x) } else { direction })
}

/// The sides of a body.
struct Sides<'a> {
    mesh: &'a Mesh,
    edges: &'a [BoundaryEdge],
}

impl Sides<'_> {
    /// How far it is from a place along a direction to the first side.
    fn beyond(&self, from: Place, direction: Place) -> Option<f64> {
        let hit = |edge: &BoundaryEdge| {
            let [a, b] = edge.nodes.map(|node| [self.mesh.nodes[node as usize].x, self.mesh.nodes[node as usize].y]);
            let (along, to) = (minus(b, a), minus(a, from));
            let across = cross(direction, along);
            let (way, share) = (cross(to, along) / across, cross(to, direction) / across);
            let is_hit = (-1e-6..1.0 + 1e-6).contains(&share) && way > 1e-9 * length(along);
            is_hit.then_some(way)
        };
        self.edges.iter().filter_map(hit).min_by(f64::total_cmp)
    }
}
