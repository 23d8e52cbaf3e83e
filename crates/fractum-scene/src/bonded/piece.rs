//! What joins bonded bodies, and their pieces as fragments of a scene.

use fractum_dem::{Piece, pieces};

use super::through_box::whole_pieces;
use super::{Bonded, BondedBody};
use crate::fragment::Fragment;

impl Bonded {
    /// Whether any body has bonds; loose particles have none.
    pub fn has_bonds(&self) -> bool {
        self.bodies.iter().any(|body| !body.bonds.is_empty())
    }

    /// Whether bonds of any body may break.
    pub fn can_break(&self) -> bool {
        self.bodies.iter().any(BondedBody::can_break)
    }

    /// The particles of each bond of some kind.
    ///
    /// - `which`: whether it is a bond of a body
    pub(super) fn pairs_of(
        &self,
        which: impl Fn(&BondedBody, usize) -> bool + Copy,
    ) -> impl Iterator<Item = [u32; 2]> + Clone {
        self.bodies.iter().flat_map(move |body| {
            let own = (0..body.bonds.len()).filter(move |&bond| which(body, bond));
            own.map(|bond| body.bonds.pairs()[bond])
        })
    }

    /// Pieces connected by bonds that hold, which have not left the run, in the order of their first particles.
    pub fn fragments(&self) -> Vec<Fragment> {
        let whole = whole_pieces(self);
        let all = whole.as_ref().unwrap_or(&self.particles);
        let mut found = pieces(all, self.pairs_of(BondedBody::is_joined), |i| self.own_mass(i));
        found.retain(|piece| !self.particles.is_out(piece.particles[0] as usize));
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
                stays: false,
            }
        };
        found.into_iter().map(fragment).collect()
    }
}
