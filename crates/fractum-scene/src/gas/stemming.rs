use std::collections::{BTreeMap, BTreeSet};

use fractum_fem::Solid;
use fractum_math::Vec3;

/// Distance of the rim of a flat end from its plane, over the root of its area, at most.
const FLAT: f64 = 0.02;

/// Flat ends of a hole in space that are closed by stemming: their rims, along which the nodes run against the facets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stemming {
    rims: Vec<Vec<u32>>,
}

impl Stemming {
    /// The ends of a hole; a node of the rim that is not flat, or that several rims share.
    ///
    /// # Errors
    /// That node.
    pub fn find(solid: &Solid, facets: &[[u32; 3]]) -> Result<Self, u32> {
        let mut open: BTreeSet<(u32, u32)> = BTreeSet::new();
        for &[a, b, c] in facets {
            for (i, j) in [(a, b), (b, c), (c, a)] {
                // Facets that share an edge run along it in opposite senses.
                if !open.remove(&(j, i)) {
                    open.insert((i, j));
                }
            }
        }
        let mut next: BTreeMap<u32, u32> = BTreeMap::new();
        for &(i, j) in &open {
            if next.insert(j, i).is_some() {
                return Err(j);
            }
        }
        let mut stemming = Stemming::default();
        while let Some((&first, _)) = next.first_key_value() {
            let mut rim = Vec::new();
            let mut node = first;
            while let Some(following) = next.remove(&node) {
                rim.push(node);
                node = following;
            }
            if node != first {
                return Err(node);
            }
            stemming.rims.push(rim);
        }
        let at = |node: u32| solid.reference[node as usize];
        let flat = |rim: &&Vec<u32>| {
            let (centre, area) = (centre(rim, at), cap(rim, at).map(|triangle| triangle.0).sum::<Vec3>());
            let normal = area.try_normalize(0.0).unwrap_or_default();
            rim.iter().all(|&node| (at(node) - centre).dot(&normal).abs() < FLAT * area.norm().sqrt())
        };
        match stemming.rims.iter().find(|rim| !flat(rim)) {
            Some(rim) => Err(rim[0]),
            None => Ok(stemming),
        }
    }

    /// Area vectors and centres of the triangles that close the ends, with the nodes at these places.
    pub(super) fn triangles<'a>(&'a self, at: impl Fn(u32) -> Vec3 + Copy + 'a) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.rims.iter().flat_map(move |rim| cap(rim, at))
    }
}

fn centre(rim: &[u32], at: impl Fn(u32) -> Vec3) -> Vec3 {
    rim.iter().map(|&node| at(node)).sum::<Vec3>() / rim.len() as f64
}

fn cap<'a>(rim: &'a [u32], at: impl Fn(u32) -> Vec3 + Copy + 'a) -> impl Iterator<Item = (Vec3, Vec3)> {
    let middle = centre(rim, at);
    let triangle = move |index: usize| {
        let (a, b) = (at(rim[index]), at(rim[(index + 1) % rim.len()]));
        ((b - a).cross(&(middle - a)) * 0.5, (a + b + middle) / 3.0)
    };
    (0..rim.len()).map(triangle)
}
