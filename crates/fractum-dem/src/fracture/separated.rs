//! Bonds that separate by their own law.

use super::crack::{Crack, Occasion, facet_area};
use super::criterion::BreakMode;
use super::faces::CrackFaces;
use super::moving::Fracture;
use crate::bond::{BondGraph, Bonds, Separation};
use crate::particles::Particles;

impl Fracture {
    /// Keeps the list of the bonds of a network that separate by their law, and lets particles touch that were never bonded.
    ///
    /// - `faces`: what particles do that were never bonded
    /// - `volume`: of the body [m³]
    pub fn of_law(bonds: &Bonds, particles: &Particles, faces: CrackFaces, volume: f64) -> Self {
        let graph = BondGraph::new(particles.len(), bonds.pairs());
        let area = facet_area(volume, (0..bonds.len()).map(|bond| bonds.length(bond)));
        Fracture::with_search(graph, None, (bonds, particles), faces, area)
    }

    /// Whether bonds separate by their law, and stay as contacts.
    pub fn is_by_law(&self) -> bool {
        self.search.is_none()
    }

    /// Lists what has separated since the last call; the bonds go on as contacts. Returns their number.
    pub(super) fn list_separated(&mut self, bonds: &mut Bonds, occasion: Occasion) -> usize {
        let mut separated = std::mem::take(&mut self.separated);
        bonds.take_separated(&mut separated);
        for &(bond, how) in &separated {
            if !self.graph.break_bond(bond) {
                continue;
            }
            let pair = bonds.pairs()[bond as usize];
            let mode = match how {
                Separation::Tension => BreakMode::Tension,
                Separation::Shear => BreakMode::Shear,
            };
            // What the bond held is part of what its law has dissipated.
            self.cracks.push(Crack::new(bond, pair, self.ends(bond, &self.reference), self.area, mode, 0.0, occasion));
        }
        let count = separated.len();
        self.separated = separated;
        count
    }
}
