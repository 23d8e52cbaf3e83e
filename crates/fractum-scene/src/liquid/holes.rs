//! Holes that hold liquid: wells, boreholes, notches. A hole is one more cell, with the volume that its wall encloses as its room and no interface of its own.

use fractum_fem::{Solid, cracks};
use fractum_math::Vec3;

use super::network::Network;
use crate::gas::{HoleEnds, enclosed_volume};
use crate::interfaces::Interfaces;

/// What a hole is.
#[derive(Clone, Debug)]
pub struct LiquidHole {
    /// Facets of the solids around it.
    pub facets: Vec<[u32; 3]>,
    /// Its ends, of which those that are closed do not move.
    pub ends: HoleEnds,
    /// Volume that lines and pumps beside it take per pressure [m³/Pa].
    pub storage: f64,
    /// Whether no interface takes liquid from it.
    pub is_sealed: bool,
}

/// A hole with its place in the network.
#[derive(Clone, Debug)]
pub(crate) struct Hole {
    /// Its cell.
    pub(crate) cell: u32,
    /// Nodes of its wall, ascending, with their force per pressure, away from the hole [m²].
    pub(crate) wall: Vec<(u32, Vec3)>,
    /// Area of its wall [m²].
    pub(crate) area: f64,
    /// Volume without load [m³].
    pub(crate) volume: f64,
    /// Volume that lines and pumps take per pressure [m³/Pa].
    pub(crate) storage: f64,
    /// Cells of interfaces on its wall, ascending: they have its pressure once liquid enters them.
    pub(crate) cells: Vec<u32>,
}

impl Hole {
    /// - `cell`: its number among all cells
    pub(super) fn new(
        solid: &Solid,
        interfaces: &Interfaces,
        network: &Network,
        cell: u32,
        settings: &LiquidHole,
    ) -> Self {
        let at = |node: u32| solid.reference[node as usize];
        let mut shares: Vec<(u32, Vec3)> = Vec::new();
        let mut area = 0.0;
        for facet in &settings.facets {
            let outward = cracks::area_at(solid, facet, at);
            area += outward.norm();
            let corners = if facet[1] == facet[2] { 2 } else { 3 };
            shares.extend(facet[..corners].iter().map(|&node| (node, -outward / corners as f64)));
        }
        shares.sort_by_key(|(node, _)| *node);
        let mut wall: Vec<(u32, Vec3)> = Vec::new();
        for (node, share) in shares {
            match wall.last_mut().filter(|(last, _)| *last == node) {
                Some((_, sum)) => *sum += share,
                None => wall.push((node, share)),
            }
        }
        let nodes: Vec<u32> = wall.iter().map(|(node, _)| *node).collect();
        let cells = if settings.is_sealed { Vec::new() } else { network.cells_at(interfaces, &nodes) };
        let volume = enclosed_volume(solid, &settings.facets, &settings.ends, at);
        Hole { cell, wall, area, volume, storage: settings.storage, cells }
    }

    /// Its middle without load, on all planes of symmetry at which it ends [m].
    pub(super) fn middle(&self, solid: &Solid, ends: &HoleEnds) -> Vec3 {
        let sum: Vec3 = self.wall.iter().map(|(node, push)| solid.reference[*node as usize] * push.norm()).sum();
        ends.base(sum / self.wall.iter().map(|(_, push)| push.norm()).sum::<f64>())
    }

    /// Its volume in a displacement field [m³]: linear, so that a pressure works on the wall as on the volume.
    pub(crate) fn volume_in(&self, field: &[Vec3]) -> f64 {
        self.volume + self.gain(field)
    }

    /// What a displacement field adds to its volume [m³].
    pub(crate) fn gain(&self, field: &[Vec3]) -> f64 {
        self.wall.iter().map(|(node, push)| push.dot(&field[*node as usize])).sum()
    }

    /// Adds the forces of a pressure on its wall.
    pub(crate) fn push(&self, pressure: f64, forces: &mut [Vec3]) {
        self.wall.iter().for_each(|(node, push)| forces[*node as usize] += push * pressure);
    }
}
