//! Pieces of bonded bodies as fragments of a scene.

use fractum_dem::{Piece, pieces};

use super::Bonded;
use crate::fragment::Fragment;

impl Bonded {
    /// Pieces connected by live bonds that have not left the run, in the order of their first particles.
    pub fn fragments(&self) -> Vec<Fragment> {
        let mut found = pieces(&self.particles, self.live_pairs(), |i| self.own_mass(i));
        found.retain(|piece| !self.particles.has_left(piece.particles[0] as usize));
        let fragment = |piece: Piece| {
            let Piece { particles, bonds, mass, content, centroid, velocity, bounds } = piece;
            let first = particles[0] as usize;
            let density = self.bodies.iter().find(|b| b.range.contains(&first)).map_or(1.0, |b| b.density);
            Fragment {
                nodes: particles,
                elements: 0,
                bonds,
                mass,
                volume: content / density,
                centroid,
                velocity,
                bounds,
            }
        };
        found.into_iter().map(fragment).collect()
    }
}
