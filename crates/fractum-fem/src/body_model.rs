use std::sync::OnceLock;

use fractum_math::Ragged;

use crate::body::{Body, BodyEdges};
use crate::divided::{BodyShare, DividedBody};
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
    /// Which elements this rank tells of, where bodies are divided among ranks; else empty.
    pub(crate) is_told: Vec<bool>,
    /// Volumes of the elements without load [m³], once something asks for them.
    pub(crate) volumes: OnceLock<Vec<f64>>,
    /// Edges, with damage or in the smoothed formulation.
    pub(crate) edges: Option<BodyEdges>,
    pub(crate) elements_of_edge: Ragged,
    /// Block and cell of each cell of the body (element, or edge if smoothed); for what this rank does not have
    /// [`crate::divided::ELSEWHERE`] and a place among the values of others, or [`crate::divided::ALONE`] and its own number.
    pub(crate) location: Vec<(u32, u32)>,
    pub(crate) standard: Option<StandardDamage>,
    pub(crate) phase: Option<Box<PhaseField>>,
    /// Edges whose strength was lowered to fit their length.
    pub(crate) reduced_edges: usize,
    /// Largest ratio of a characteristic length to the largest one that softening allows.
    pub(crate) largest_length_ratio: f64,
    /// What this rank knows of the whole body, where it does not have all of it.
    pub(crate) divided: Option<Box<DividedBody>>,
}

/// Which cells of a body are made.
#[derive(Clone, Copy)]
pub(crate) struct Chosen<'a> {
    /// Elements that take shorter steps; empty where all take the same.
    pub(crate) fine: &'a [bool],
    /// The cells of this rank; none where all are made.
    pub(crate) share: Option<&'a BodyShare>,
}
