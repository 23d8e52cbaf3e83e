//! Bisection of the longest edge (Rivara, *Int. J. Numer. Methods Eng.* 20 (1984); Rivara and Levin, *Commun. Appl. Numer. Methods* 8 (1992)).
//!
//! An element is only ever cut in two at its longest edge. An edge that is too long is cut where it is the longest one of all elements at it;
//! else the longer edge of such an element comes first. What becomes of a mesh does not depend on which edge is looked at first.

use fractum_math::Vec3;
use rayon::prelude::*;

use super::simplices::Simplices;
use super::{RefineError, along};
use crate::Mesh;
use crate::topology::{edges_of_tetrahedra, edges_of_triangles};

/// Excess of an edge over its size that rounding explains.
const EXCESS: f64 = 1.0 + 1e-9;
/// Last bits of a square of a length that do not tell it from another: lengths that are equal but for rounding are equal.
const ROUNDING: u32 = 20;

/// How an edge compares with others: the longest, and of equals that of later places, is the greatest.
type Order = (u64, u32, u32);

pub(super) struct Bisection<'a> {
    /// Positions of nodes.
    pub(super) nodes: Vec<Vec3>,
    /// The first of the nodes in the place of each node.
    places: Vec<u32>,
    pub(super) lines: Simplices<2>,
    pub(super) triangles: Simplices<3>,
    pub(super) tetrahedra: Simplices<4>,
    is_plane: bool,
    size: &'a (dyn Fn(Vec3) -> f64 + Sync),
    /// Edges that may be too long.
    todo: Vec<[u32; 2]>,
    most: usize,
}

/// What is in the way of an edge.
enum Way {
    /// It is no longer there.
    Gone,
    /// A longer edge of an element at it.
    Longer([u32; 2]),
    Free,
}

impl<'a> Bisection<'a> {
    /// - `places`: the first of the nodes in the place of each node
    /// - `size`: how long edges may be
    /// - `most`: elements at most
    ///
    /// # Errors
    /// Sizes that are none, and a zone without elements.
    pub(super) fn new(
        mesh: &Mesh,
        places: Vec<u32>,
        size: &'a (dyn Fn(Vec3) -> f64 + Sync),
        most: usize,
    ) -> Result<Self, RefineError> {
        let is_plane = mesh.tetrahedra.is_empty();
        let mut bisection = Bisection {
            nodes: mesh.nodes.clone(),
            lines: Simplices::new(mesh.lines.clone(), &places),
            triangles: Simplices::new(mesh.triangles.clone(), &places),
            tetrahedra: Simplices::new(mesh.tetrahedra.clone(), &places),
            places,
            is_plane,
            size,
            todo: Vec::new(),
            most,
        };
        bisection.begin()?;
        Ok(bisection)
    }

    /// Looks for edges that are too long.
    fn begin(&mut self) -> Result<(), RefineError> {
        let place = |node: u32| self.places[node as usize];
        let edges = if self.is_plane {
            let elements: Vec<[u32; 3]> = self.triangles.nodes.iter().map(|nodes| nodes.map(place)).collect();
            edges_of_triangles(&elements).nodes
        } else {
            let elements: Vec<[u32; 4]> = self.tetrahedra.nodes.iter().map(|nodes| nodes.map(place)).collect();
            edges_of_tetrahedra(&elements).nodes
        };
        let sizes: Vec<f64> = edges.par_iter().map(|&edge| self.size_along(edge)).collect();
        let middles: Vec<(f64, [u32; 2])> = if self.is_plane {
            self.triangles.nodes.par_iter().map(|nodes| self.size_within(nodes)).collect()
        } else {
            self.tetrahedra.nodes.par_iter().map(|nodes| self.size_within(nodes)).collect()
        };
        let all = || sizes.iter().copied().chain(middles.iter().map(|(size, _)| *size));
        if let Some(size) = all().find(|size| size.is_nan() || *size <= 0.0) {
            return Err(RefineError::Size(size));
        }
        if all().all(f64::is_infinite) {
            return Err(RefineError::Nowhere);
        }
        let is_long = |edge: [u32; 2], size: f64| self.length_squared(edge) > EXCESS * size * size;
        let long = edges.iter().zip(&sizes).filter(|(edge, size)| is_long(**edge, **size)).map(|(edge, _)| *edge);
        let within = middles.iter().filter(|(size, edge)| is_long(*edge, *size)).map(|(_, edge)| *edge);
        self.todo = long.chain(within).collect();
        Ok(())
    }

    /// Whether no edge is too long.
    pub(super) fn is_done(&self) -> bool {
        self.todo.is_empty()
    }

    /// Cuts edges until none is too long.
    ///
    /// # Errors
    /// Too many elements.
    pub(super) fn run(&mut self) -> Result<(), RefineError> {
        let (mut way, mut found) = (Vec::new(), Found::default());
        while let Some(edge) = self.todo.pop() {
            way.push(edge);
            while let Some(&edge) = way.last() {
                match self.way(edge, &mut found) {
                    Way::Longer(longer) => way.push(longer),
                    Way::Gone => _ = way.pop(),
                    Way::Free => {
                        self.bisect(edge, &found)?;
                        way.pop();
                    }
                }
            }
        }
        Ok(())
    }

    fn at(&self, place: u32) -> Vec3 {
        self.nodes[place as usize]
    }

    fn length_squared(&self, [a, b]: [u32; 2]) -> f64 {
        (self.at(b) - self.at(a)).norm_squared()
    }

    fn order(&self, [a, b]: [u32; 2]) -> Order {
        (self.length_squared([a, b]).to_bits() >> ROUNDING, a.max(b), a.min(b))
    }

    /// The least size that is asked for along an edge.
    fn size_along(&self, [a, b]: [u32; 2]) -> f64 {
        let [a, b] = [self.at(a), self.at(b)];
        let sizes = along(a, b).map(self.size);
        // A size that is no number must be seen.
        sizes.fold(f64::INFINITY, |least, size| if size < least || size.is_nan() { size } else { least })
    }

    /// The size that is asked for in the middle of an element, and its longest edge.
    fn size_within<const N: usize>(&self, nodes: &[u32; N]) -> (f64, [u32; 2]) {
        let middle = nodes.iter().map(|&node| self.nodes[node as usize]).sum::<Vec3>() / N as f64;
        ((self.size)(middle), self.longest(nodes).1)
    }

    fn longest<const N: usize>(&self, nodes: &[u32; N]) -> (Order, [u32; 2]) {
        let mut longest = ((0, 0, 0), [nodes[0]; 2]);
        for i in 0..N {
            for j in i + 1..N {
                let edge = [nodes[i], nodes[j]].map(|node| self.places[node as usize]);
                longest = longest.max((self.order(edge), edge));
            }
        }
        longest
    }

    fn way(&self, edge: [u32; 2], found: &mut Found) -> Way {
        self.tetrahedra.at_edge(edge, &self.places, &mut found.tetrahedra);
        self.triangles.at_edge(edge, &self.places, &mut found.triangles);
        let own = self.order(edge);
        let of_tetrahedra =
            found.tetrahedra.iter().map(|&element| self.longest(&self.tetrahedra.nodes[element as usize]));
        let of_triangles = found.triangles.iter().map(|&element| self.longest(&self.triangles.nodes[element as usize]));
        match of_tetrahedra.chain(of_triangles).max() {
            None => Way::Gone,
            Some((longest, edge)) if longest > own => Way::Longer(edge),
            Some(_) => Way::Free,
        }
    }

    /// Cuts all elements at an edge, which is the longest one of each.
    fn bisect(&mut self, edge: [u32; 2], found: &Found) -> Result<(), RefineError> {
        let Bisection { nodes, places, lines, triangles, tetrahedra, .. } = self;
        let first = nodes.len() as u32;
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        // A node for each pair of nodes in these places, all of them in one place.
        let mut middle = |a: u32, b: u32, places: &mut Vec<u32>| {
            let pair = [a.min(b), a.max(b)];
            let known = pairs.iter().position(|known| *known == pair);
            first
                + known.unwrap_or_else(|| {
                    nodes.push(0.5 * (nodes[a as usize] + nodes[b as usize]));
                    places.push(first);
                    pairs.push(pair);
                    pairs.len() - 1
                }) as u32
        };
        lines.add_place();
        triangles.add_place();
        tetrahedra.add_place();
        for &element in &found.tetrahedra {
            tetrahedra.bisect(element, edge, places, &mut middle);
        }
        for &element in &found.triangles {
            triangles.bisect(element, edge, places, &mut middle);
        }
        let mut of_lines = Vec::new();
        lines.at_edge(edge, places, &mut of_lines);
        for element in of_lines {
            lines.bisect(element, edge, places, &mut middle);
        }
        for _ in 1..pairs.len() {
            lines.add_place();
            triangles.add_place();
            tetrahedra.add_place();
        }
        let count = if self.is_plane { self.triangles.nodes.len() } else { self.tetrahedra.nodes.len() };
        if count > self.most {
            return Err(RefineError::TooMany(self.most));
        }
        self.look_around(first, found);
        Ok(())
    }

    /// Notes what is too long of the edges that a new place brought.
    fn look_around(&mut self, new: u32, found: &Found) {
        let (elements, halves) = if self.is_plane {
            (&found.triangles, self.triangles.nodes.len() - found.triangles.len())
        } else {
            (&found.tetrahedra, self.tetrahedra.nodes.len() - found.tetrahedra.len())
        };
        let mut others: Vec<u32> = Vec::new();
        for (index, &element) in elements.iter().enumerate() {
            for element in [element as usize, halves + index] {
                let (size, longest) = if self.is_plane {
                    others.extend(self.triangles.nodes[element]);
                    self.size_within(&self.triangles.nodes[element])
                } else {
                    others.extend(self.tetrahedra.nodes[element]);
                    self.size_within(&self.tetrahedra.nodes[element])
                };
                if self.length_squared(longest) > EXCESS * size * size {
                    self.todo.push(longest);
                }
            }
        }
        others.iter_mut().for_each(|node| *node = self.places[*node as usize]);
        others.sort_unstable();
        others.dedup();
        for &place in others.iter().filter(|&&place| place != new) {
            let edge = [place, new];
            let size = self.size_along(edge);
            if self.length_squared(edge) > EXCESS * size * size {
                self.todo.push(edge);
            }
        }
    }
}

/// Elements at an edge.
#[derive(Default)]
struct Found {
    triangles: Vec<u32>,
    tetrahedra: Vec<u32>,
}
