//! The crack-plane gate: near a crack, damage may begin only where the plane of the crack goes on.
//!
//! Smeared cracks like to follow the lines of a mesh. Each damaged edge keeps a crack point; from the points and stresses
//! of the damaged edges around it an intact edge knows the plane in which the crack would come its way. It may be
//! damaged only if that plane cuts the elements around it.

use std::collections::BTreeMap;

use fractum_math::{Ragged, Sym3, Vec3};
use serde::{Deserialize, Serialize};

use crate::body::Body;
use crate::element::regular_edge;

/// How far an edge sees, over the size of its elements.
const REACH: f64 = 2.5;

pub(crate) type Key = [i32; 3];

/// Crack points of a body, and the strengths that its gate has changed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GateState {
    /// Damaged edges and their crack points [m].
    pub points: Vec<(u32, Vec3)>,
    /// Edges that soften from another stress than their own strength [Pa]: infinite for intact edges that may not be damaged
    /// at present, the stress at which their gate opened for others.
    pub strength: Vec<(u32, f64)>,
}

/// The gate of a body.
#[derive(Clone, Debug)]
pub(crate) struct Gate {
    /// Middles of the edges [m].
    pub(crate) middle: Vec<Vec3>,
    /// How far each edge sees [m].
    reach: Vec<f64>,
    /// Size of a cell of the grid [m].
    pub(crate) cell: f64,
    /// Edges that may be damaged, by cell.
    pub(crate) grid: BTreeMap<Key, Vec<u32>>,
    pub(crate) point: Vec<Option<Vec3>>,
    /// Strength of each edge without the gate [Pa].
    own: Vec<f64>,
    /// Stress from which each edge softens [Pa]; infinite while the gate is closed.
    pub(crate) strength: Vec<f64>,
}

/// A damaged edge as its neighbours see it.
pub(crate) struct Cracked {
    pub(crate) middle: Vec3,
    pub(crate) point: Vec3,
    /// Volume times opening strain [m³].
    pub(crate) opening: f64,
    pub(crate) nominal: Sym3,
}

impl Gate {
    /// The gate of the edges of a body, with the elements around each.
    ///
    /// - `strength`: of an edge [Pa]; infinite where it may not be damaged
    /// - `volumes`: of the elements [m³]
    pub(crate) fn new(
        body: &Body,
        (edges, elements_of_edge): (&[[u32; 2]], &Ragged),
        nodes: &[Vec3],
        volumes: impl Fn(u32) -> f64,
        strength: impl Fn(usize) -> f64,
    ) -> Gate {
        let middle: Vec<Vec3> = edges.iter().map(|&[i, j]| (nodes[i as usize] + nodes[j as usize]) * 0.5).collect();
        let size = |edge: usize| {
            let elements = elements_of_edge.row(edge);
            let sum: f64 = elements.iter().map(|&e| regular_edge(body.shape, volumes(e) / body.depth())).sum();
            REACH * sum / elements.len() as f64
        };
        let reach: Vec<f64> = (0..edges.len()).map(size).collect();
        let own: Vec<f64> = (0..edges.len()).map(strength).collect();
        let armed = || (0..edges.len()).filter(|&e| own[e].is_finite());
        let cell = armed().map(|e| reach[e]).fold(f64::MIN_POSITIVE, f64::max);
        let mut grid: BTreeMap<Key, Vec<u32>> = BTreeMap::new();
        for edge in armed() {
            grid.entry(key(middle[edge], cell)).or_default().push(edge as u32);
        }
        Gate { middle, reach, cell, grid, point: vec![None; edges.len()], strength: own.clone(), own }
    }

    pub(crate) fn state(&self) -> GateState {
        GateState {
            points: (0..).zip(&self.point).filter_map(|(edge, point)| Some((edge, (*point)?))).collect(),
            strength: (0..)
                .zip(self.strength.iter().zip(&self.own))
                .filter(|(_, (strength, own))| strength != own)
                .map(|(edge, (&strength, _))| (edge, strength))
                .collect(),
        }
    }

    pub(crate) fn restore(&mut self, state: &GateState) {
        self.point.fill(None);
        self.strength.clone_from(&self.own);
        for &(edge, point) in &state.points {
            self.point[edge as usize] = Some(point);
        }
        for &(edge, strength) in &state.strength {
            self.strength[edge as usize] = strength;
        }
    }

    pub(crate) fn close(&mut self, edge: u32) {
        self.strength[edge as usize] = f64::INFINITY;
    }

    /// Whether an edge would soften from more than its own strength.
    pub(crate) fn is_raised(&self, edge: u32) -> bool {
        self.strength[edge as usize] > self.own[edge as usize]
    }

    /// Opens the gate of an intact edge: it softens from its present stress, where that is above its own strength. One that
    /// is open already comes back to its own strength as its stress falls.
    ///
    /// - `present`: equivalent stress [Pa]
    /// - `most`: largest strength with which the edge does not snap back [Pa]
    pub(crate) fn open(&mut self, edge: u32, present: f64, most: f64) {
        let strength = &mut self.strength[edge as usize];
        *strength = strength.min(present).min(most).max(self.own[edge as usize]);
    }

    /// Mean crack point and normal of the crack that comes towards an edge; none where no crack is near.
    pub(crate) fn plane(&self, edge: u32, near: &BTreeMap<Key, Vec<Cracked>>) -> Option<(Vec3, Vec3)> {
        let (place, reach) = (self.middle[edge as usize], self.reach[edge as usize]);
        let (mut weight, mut point, mut stress) = (0.0, Vec3::zeros(), Sym3::ZERO);
        for cracked in around(key(place, self.cell)).filter_map(|key| near.get(&key)).flatten() {
            let ratio = (cracked.middle - place).norm_squared() / (reach * reach);
            if ratio < 1.0 {
                let w = (1.0 - ratio).powi(2) * cracked.opening;
                weight += w;
                point += cracked.point * w;
                stress += cracked.nominal * w;
            }
        }
        if weight <= 0.0 {
            return None;
        }
        let (values, directions) = stress.eigen();
        let first = (0..3).max_by(|&a, &b| values[a].total_cmp(&values[b]))?;
        (values[first] > 0.0).then(|| (point / weight, directions.column(first).into()))
    }
}

pub(crate) fn key(place: Vec3, cell: f64) -> Key {
    [place.x, place.y, place.z].map(|c| (c / cell).floor() as i32)
}

pub(crate) fn around([i, j, k]: Key) -> impl Iterator<Item = Key> {
    (-1..=1).flat_map(move |a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [i + a, j + b, k + c])))
}
