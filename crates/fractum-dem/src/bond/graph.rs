//! Which particles are joined by bonds that still hold.

use fractum_math::{Vec3, numbered_parts};

use crate::DemError;

/// Refuses another number of factors than of bonds, unless there are none.
///
/// # Errors
/// [`DemError::Length`].
pub(crate) fn check_shares(pairs: &[[u32; 2]], shares: &[f64]) -> Result<(), DemError> {
    if !shares.is_empty() && shares.len() != pairs.len() {
        return Err(DemError::Length { what: "areas of bonds", found: shares.len(), expected: pairs.len() });
    }
    Ok(())
}

/// Refuses bonds that join nothing.
///
/// # Errors
/// [`DemError::BadBond`], the first one.
pub(crate) fn check_pairs(position: &[Vec3], pairs: &[[u32; 2]]) -> Result<(), DemError> {
    let count = position.len();
    for (bond, &[first, second]) in pairs.iter().enumerate() {
        let bad = |reason| Err(DemError::BadBond { bond, first, second, count, reason });
        if first as usize >= count || second as usize >= count {
            return bad("no such particle");
        }
        if first == second || position[first as usize] == position[second as usize] {
            return bad("a bond needs two different places");
        }
    }
    Ok(())
}

/// Particles and bonds as a graph; bonds go and never come back.
#[derive(Clone, Debug)]
pub struct BondGraph {
    pairs: Vec<[u32; 2]>,
    live: Vec<bool>,
    offsets: Vec<u32>,
    half: Vec<HalfEdge>,
    broken: usize,
}

/// A bond as one of its particles sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfEdge {
    /// The particle at the other end.
    pub other: u32,
    /// The bond.
    pub bond: u32,
}

/// The parts into which broken bonds have divided a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Part of each particle; parts are numbered in the order of their first particles.
    pub of: Vec<u32>,
    /// Number of parts.
    pub count: usize,
}

impl BondGraph {
    /// A graph in which all bonds hold.
    ///
    /// - `count`: particles
    /// - `pairs`: the particles of each bond, below `count`
    pub fn new(count: usize, pairs: &[[u32; 2]]) -> Self {
        let mut offsets = vec![0u32; count + 1];
        pairs.iter().flatten().for_each(|&i| offsets[i as usize + 1] += 1);
        for i in 0..count {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut half = vec![HalfEdge { other: 0, bond: 0 }; 2 * pairs.len()];
        for (bond, &[i, j]) in pairs.iter().enumerate() {
            for (own, other) in [(i, j), (j, i)] {
                half[next[own as usize] as usize] = HalfEdge { other, bond: bond as u32 };
                next[own as usize] += 1;
            }
        }
        BondGraph { pairs: pairs.to_vec(), live: vec![true; pairs.len()], offsets, half, broken: 0 }
    }

    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The particles of each bond, broken ones included.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// The particles of each bond that holds.
    pub fn live_pairs(&self) -> impl Iterator<Item = [u32; 2]> + Clone {
        self.pairs.iter().zip(&self.live).filter(|(_, live)| **live).map(|(pair, _)| *pair)
    }

    /// Number of broken bonds.
    pub fn broken(&self) -> usize {
        self.broken
    }

    /// Whether a bond holds.
    #[inline]
    pub fn is_live(&self, bond: u32) -> bool {
        self.live[bond as usize]
    }

    /// Breaks a bond; false when it was broken already.
    pub fn break_bond(&mut self, bond: u32) -> bool {
        let was = std::mem::replace(&mut self.live[bond as usize], false);
        self.broken += usize::from(was);
        was
    }

    /// Whether a bond joins these particles or did before it broke.
    pub fn were_bonded(&self, pair: [u32; 2]) -> bool {
        self.bond_between(pair).is_some()
    }

    /// The bond that joins these particles or did before it broke.
    pub fn bond_between(&self, [i, j]: [u32; 2]) -> Option<u32> {
        let row = self.offsets[i as usize] as usize..self.offsets[i as usize + 1] as usize;
        self.half[row].iter().find(|half| half.other == j).map(|half| half.bond)
    }

    /// The bonds of a particle that hold, in the order of their numbers.
    #[inline]
    pub fn neighbours(&self, particle: usize) -> impl Iterator<Item = HalfEdge> {
        self.every(particle).filter(|h| self.live[h.bond as usize])
    }

    /// The bonds of a particle, broken ones included, in the order of their numbers.
    #[inline]
    pub fn every(&self, particle: usize) -> impl Iterator<Item = HalfEdge> {
        let row = self.offsets[particle] as usize..self.offsets[particle + 1] as usize;
        self.half[row].iter().copied()
    }

    /// Parts of the body by the bonds that hold, among the particles of `inside` only; the others are parts of their
    /// own.
    pub fn parts_among(&self, inside: impl Fn(usize) -> bool) -> Parts {
        let inside: Vec<bool> = (0..self.particles()).map(inside).collect();
        let links = self.live_pairs().filter(|pair| pair.iter().all(|&i| inside[i as usize]));
        let (of, count) = numbered_parts(self.particles(), links);
        Parts { of, count: count as usize }
    }

    /// Parts of the whole body.
    pub fn parts(&self) -> Parts {
        self.parts_among(|_| true)
    }
}

impl Parts {
    /// Whether no part holds particles of both sets.
    pub fn separate(&self, first: &[u32], second: &[u32]) -> bool {
        let mut seen = vec![false; self.count];
        first.iter().for_each(|&i| seen[self.of[i as usize] as usize] = true);
        second.iter().all(|&i| !seen[self.of[i as usize] as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_falls_into_the_parts_between_its_broken_bonds() {
        let pairs: Vec<[u32; 2]> = (0..5).map(|i| [i, i + 1]).collect();
        let mut graph = BondGraph::new(6, &pairs);
        assert_eq!(graph.parts().count, 1);
        assert!(graph.break_bond(1) && graph.break_bond(3) && !graph.break_bond(1));
        let parts = graph.parts();
        assert_eq!((parts.count, graph.broken()), (3, 2));
        assert_eq!(parts.of, [0, 0, 1, 1, 2, 2]);
        assert!(parts.separate(&[0, 1], &[2, 5]) && !parts.separate(&[0, 2], &[3]));
        assert_eq!(graph.neighbours(2).map(|h| h.other).collect::<Vec<_>>(), [3]);
        // Cut out of the middle, the ends are apart though bonds lead around.
        assert!(BondGraph::new(3, &[[0, 1], [1, 2]]).parts_among(|i| i != 1).separate(&[0], &[2]));
    }
}
