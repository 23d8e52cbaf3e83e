use std::sync::{Arc, OnceLock};

use fractum_kernels::damage::Softens;
use fractum_parallel::Exchange;

use crate::body::Body;
use crate::body::edges::BodyEdges;
use crate::body::elasticity::Elasticity;
use crate::cells::viscosity::BodyViscosity;
use crate::damage::phase::PhaseField;
use crate::damage::standard::StandardDamage;
use crate::damage::threshold::LengthReport;
use crate::divided::BodyShare;
use crate::divided::places::Places;

/// A body as it runs.
#[derive(Clone, Debug)]
pub(crate) struct BodyModel {
    pub(crate) body: Body,
    pub(crate) elasticity: Elasticity,
    /// What its edges share, where it may be damaged.
    pub(crate) softens: Option<Arc<Softens>>,
    pub(crate) viscosity: Option<BodyViscosity>,
    pub(crate) alive: Vec<bool>,
    /// Volumes of the elements without load [m³], once something asks for them.
    pub(crate) volumes: OnceLock<Vec<f64>>,
    /// Edges, with damage or in the smoothed formulation.
    pub(crate) edges: Option<BodyEdges>,
    /// Where its cells are.
    pub(crate) location: Places,
    pub(crate) standard: Option<StandardDamage>,
    pub(crate) phase: Option<Box<PhaseField>>,
    pub(crate) lengths: LengthReport,
}

/// Which cells of a body are made.
#[derive(Clone, Copy, Default)]
pub(crate) struct Chosen<'a> {
    /// Elements that take shorter steps; empty where all take the same.
    pub(crate) fine: &'a [bool],
    /// The cells of this rank; none where all are made.
    pub(crate) share: Option<&'a BodyShare>,
    /// The exchange of the ranks that have the others.
    pub(crate) exchange: Option<&'a dyn Exchange>,
}
