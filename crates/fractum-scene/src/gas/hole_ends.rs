use std::collections::{BTreeMap, BTreeSet};

use fractum_fem::Solid;
use fractum_math::Vec3;

/// Distance of the rim of a flat end from its plane, over the root of its area, at most.
const FLAT: f64 = 0.02;
/// Distance of a node from a plane of symmetry that it lies on, over the length of its facet, at most.
const ON_PLANE: f64 = 1e-6;

/// Planes of symmetry at which the model ends: the place of that across each axis [m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SymmetryPlanes(pub [Option<f64>; 3]);

impl SymmetryPlanes {
    /// Whether one of them holds all of these nodes in the model without load.
    ///
    /// - `size`: length of their facet [m]
    pub fn hold(&self, solid: &Solid, nodes: &[u32], size: f64) -> bool {
        let on = |axis: usize, plane: f64| {
            nodes.iter().all(|&node| (solid.reference[node as usize][axis] - plane).abs() <= ON_PLANE * size)
        };
        (0..3).any(|axis| self.0[axis].is_some_and(|plane| on(axis, plane)))
    }

    /// The plane across an axis alone.
    pub fn only(&self, axis: usize) -> Self {
        SymmetryPlanes(std::array::from_fn(|a| self.0[a].filter(|_| a == axis)))
    }

    /// A place moved onto all of the planes.
    fn project(&self, place: Vec3) -> Vec3 {
        Vec3::from_fn(|axis, _| self.0[axis].unwrap_or(place[axis]))
    }
}

/// The ends of a hole: at planes of symmetry, which need no cover, and flat ones that are closed by stemming.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HoleEnds {
    planes: SymmetryPlanes,
    stemmed: Vec<Rim>,
}

/// Nodes around a flat end, along which they run against the facets.
#[derive(Clone, Debug, PartialEq)]
struct Rim {
    nodes: Vec<u32>,
    /// Whether it begins and ends at planes of symmetry; it closes over their common line then.
    is_open: bool,
    /// These planes.
    planes: SymmetryPlanes,
}

impl HoleEnds {
    /// The ends of a hole; a node of an end that nothing closes: that lies on no plane of symmetry, and is not stemmed or not flat.
    ///
    /// - `stemmed`: whether flat ends are closed
    ///
    /// # Errors
    /// That node.
    pub fn find(solid: &Solid, facets: &[[u32; 3]], planes: SymmetryPlanes, stemmed: bool) -> Result<Self, u32> {
        let size = facets.iter().map(|&[a, b, _]| distance(solid, a, b)).fold(0.0, f64::max);
        let mut ends = HoleEnds { planes, stemmed: Vec::new() };
        let is_open = |nodes: &[u32]| !planes.hold(solid, nodes, size);
        if facets.iter().all(|facet| facet[1] == facet[2]) {
            return open_nodes(facets).find(|&node| is_open(&[node])).map_or(Ok(ends), Err);
        }
        let mut next: BTreeMap<u32, u32> = BTreeMap::new();
        for (i, j) in open_edges(facets).into_iter().filter(|&(i, j)| is_open(&[i, j])) {
            if !stemmed || next.insert(j, i).is_some() {
                return Err(j);
            }
        }
        let followers: BTreeSet<u32> = next.values().copied().collect();
        while let Some(first) = first_of(&next, &followers) {
            let mut nodes = vec![first];
            let mut last = first;
            while let Some(following) = next.remove(&last) {
                last = following;
                nodes.push(following);
            }
            let closed = last == first;
            if closed {
                nodes.pop();
            } else if is_open(&[first]) || is_open(&[last]) {
                return Err(last);
            }
            let holds = |axis: usize| [first, last].iter().any(|&node| planes.only(axis).hold(solid, &[node], size));
            let held = SymmetryPlanes(std::array::from_fn(|axis| planes.0[axis].filter(|_| holds(axis))));
            ends.stemmed.push(Rim { nodes, is_open: !closed, planes: held });
        }
        match ends.stemmed.iter().find(|rim| !ends.is_flat(solid, rim)) {
            Some(rim) => Err(rim.nodes[0]),
            None => Ok(ends),
        }
    }

    /// A place whose moment of the facets leaves out what the planes of symmetry would add.
    pub(crate) fn base(&self, place: Vec3) -> Vec3 {
        self.planes.project(place)
    }

    /// Area vectors and centres of the triangles that close the stemmed ends, with the nodes at these places.
    pub(super) fn triangles<'a>(&'a self, at: impl Fn(u32) -> Vec3 + Copy + 'a) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.stemmed.iter().flat_map(move |rim| self.cap(rim, at))
    }

    fn is_flat(&self, solid: &Solid, rim: &Rim) -> bool {
        let at = |node: u32| solid.reference[node as usize];
        let area: Vec3 = self.cap(rim, at).map(|triangle| triangle.0).sum();
        let (normal, centre) = (area.try_normalize(0.0).unwrap_or_default(), self.centre(rim, at));
        (0..rim.corners())
            .all(|index| (self.corner(rim, index, at) - centre).dot(&normal).abs() < FLAT * area.norm().sqrt())
    }

    /// A corner of an end: a node of its rim, or behind them the place where the planes of symmetry meet.
    fn corner(&self, rim: &Rim, index: usize, at: impl Fn(u32) -> Vec3) -> Vec3 {
        rim.nodes.get(index).map_or_else(|| rim.planes.project(at(rim.nodes[0])), |&node| at(node))
    }

    fn centre(&self, rim: &Rim, at: impl Fn(u32) -> Vec3 + Copy) -> Vec3 {
        (0..rim.corners()).map(|index| self.corner(rim, index, at)).sum::<Vec3>() / rim.corners() as f64
    }

    fn cap<'a>(
        &'a self,
        rim: &'a Rim,
        at: impl Fn(u32) -> Vec3 + Copy + 'a,
    ) -> impl Iterator<Item = (Vec3, Vec3)> + 'a {
        let middle = self.centre(rim, at);
        let triangle = move |index: usize| {
            let [a, b] = [index, (index + 1) % rim.corners()].map(|index| self.corner(rim, index, at));
            ((b - a).cross(&(middle - a)) * 0.5, (a + b + middle) / 3.0)
        };
        (0..rim.corners()).map(triangle)
    }
}

impl Rim {
    fn corners(&self) -> usize {
        self.nodes.len() + usize::from(self.is_open)
    }
}

fn distance(solid: &Solid, a: u32, b: u32) -> f64 {
    (solid.reference[a as usize] - solid.reference[b as usize]).norm()
}

/// Where a rim begins that does not close; else anywhere on one that does.
fn first_of(next: &BTreeMap<u32, u32>, followers: &BTreeSet<u32>) -> Option<u32> {
    next.keys().copied().find(|node| !followers.contains(node)).or_else(|| next.keys().next().copied())
}

/// Nodes at which lines of the plane end.
fn open_nodes(facets: &[[u32; 3]]) -> impl Iterator<Item = u32> + use<> {
    let mut balance: BTreeMap<u32, i32> = BTreeMap::new();
    for &[a, b, _] in facets {
        *balance.entry(a).or_default() += 1;
        *balance.entry(b).or_default() -= 1;
    }
    balance.into_iter().filter(|(_, count)| *count != 0).map(|(node, _)| node)
}

/// Edges of facets along which no other facet runs back.
fn open_edges(facets: &[[u32; 3]]) -> BTreeSet<(u32, u32)> {
    let mut open = BTreeSet::new();
    for &[a, b, c] in facets {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            if !open.remove(&(j, i)) {
                open.insert((i, j));
            }
        }
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_surfaces_are_closed_or_end_somewhere() {
        let square = [[0, 1, 1], [1, 2, 2], [2, 3, 3], [3, 0, 0]];
        assert_eq!((open_nodes(&square).next(), open_nodes(&square[..3]).next()), (None, Some(0)));
        let tetrahedron = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        assert!(open_edges(&tetrahedron).is_empty());
        assert_eq!(open_edges(&tetrahedron[1..]).into_iter().next(), Some((1, 3)));
    }
}
