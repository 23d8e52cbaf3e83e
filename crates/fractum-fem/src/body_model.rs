use std::sync::OnceLock;

use fractum_math::Ragged;

use crate::body::{Body, BodyEdges};
use crate::hooke::Hooke;
use crate::phase::PhaseField;
use crate::standard::StandardDamage;
use crate::viscosity::BodyViscosity;

/// A body as it runs.
#[derive(Clone, Debug)]
pub(crate) struct BodyModel {
    pub(crate) body: Body,
    pub(crate) hooke: Hooke,
    pub(crate) viscosity: Option<BodyViscosity>,
    pub(crate) alive: Vec<bool>,
    /// Volumes of the elements without load [m³], once something asks for them.
    pub(crate) volumes: OnceLock<Vec<f64>>,
    /// Edges, with damage or in the smoothed formulation.
    pub(crate) edges: Option<BodyEdges>,
    pub(crate) elements_of_edge: Ragged,
    /// Block and cell of each cell of the body (element, or edge if smoothed).
    pub(crate) location: Vec<(u32, u32)>,
    pub(crate) standard: Option<StandardDamage>,
    pub(crate) phase: Option<Box<PhaseField>>,
    /// Edges whose strength was lowered to fit their length.
    pub(crate) reduced_edges: usize,
    /// Largest ratio of a characteristic length to the largest one that softening allows.
    pub(crate) largest_length_ratio: f64,
}
