//! Tests to failure: each moves supports until the body comes apart.

mod brazilian;
mod geometry;
mod setup;

pub use brazilian::{Diameter, diameter, hondros};
pub use geometry::{Geometry, geometry};

use fractum_dem::{Batch, Breaking, Criterion, Outcome, Point, Tolerance, quasi_static};
use serde::Serialize;

use crate::{CalibrateError, Sample};
use setup::Setup;

/// How a sample is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Failure {
    /// A box or a cylinder pulled along x by its ends, which are free to contract.
    Tension,
    /// A box or a cylinder pressed along x by its ends, which are free to expand.
    Compression,
    /// A box along x bent by opposite rotations of its ends about z.
    Bending,
    /// A cylinder twisted by opposite rotations of its ends.
    Torsion,
    /// A disc (a short cylinder) pressed across its diameter y by two arcs of 24°.
    Brazilian,
}

/// How to break.
#[derive(Clone, Copy, Debug)]
pub struct FailureOptions {
    /// When bonds break.
    pub criterion: Criterion,
    /// How many bonds break between two equilibria.
    pub batch: Batch,
    /// Largest nominal strain, for samples that shall not break.
    pub limit: f64,
    /// The sample has lost its strength when the load is below this share of its peak.
    pub stop: f64,
    /// When equilibrium is reached.
    pub tolerance: Tolerance,
}

impl FailureOptions {
    /// The usual way for a criterion.
    pub fn new(criterion: Criterion) -> Self {
        let tolerance = Tolerance { residual: 1e-4, ..Tolerance::default() };
        FailureOptions { criterion, batch: Batch::default(), limit: f64::INFINITY, stop: 0.02, tolerance }
    }
}

/// A sample that was broken.
#[derive(Clone, Debug)]
pub struct Broken {
    /// Nominal stress when the first bond broke [Pa].
    pub first_break: Option<f64>,
    /// Largest nominal stress [Pa].
    pub strength: f64,
    /// Nominal stress per unit of load [1/m² or 1/m³].
    pub stress_per_load: f64,
    /// Nominal strain per unit of displacement [1/m or 1].
    pub strain_per_displacement: f64,
    /// All of it.
    pub outcome: Outcome,
}

impl Broken {
    /// Nominal stress [Pa] at a point.
    pub fn stress(&self, point: &Point) -> f64 {
        point.load * self.stress_per_load
    }
}

/// Breaks a sample quasi-statically.
///
/// The nominal stress is that of elementary theory for the measured body, where it is largest: F/A; 6 M/(b h²); 2 M/(π R³);
/// 2 F/(π t D).
///
/// # Errors
/// Another shape; an impossible criterion; a solve that does not converge.
pub fn break_sample(sample: &Sample, test: Failure, options: &FailureOptions) -> Result<Broken, CalibrateError> {
    let Setup { supports, guess, displacement, stress_per_load, strain_per_displacement, ends, middle } =
        Setup::of(sample, test)?;
    let what = Breaking {
        criterion: options.criterion,
        pairs: &sample.network.pairs,
        radius: &sample.packing.radius,
        fraction: sample.fraction,
        volume: sample.measured_volume(),
        displacement,
        batch: options.batch,
        limit: options.limit / (displacement * strain_per_displacement),
        stop: options.stop,
        tolerance: options.tolerance,
    };
    let separated = |graph: &fractum_dem::BondGraph| match &middle {
        None => graph.parts().separate(&ends[0], &ends[1]),
        Some(inside) => graph.parts_among(|i| inside[i]).separate(&ends[0], &ends[1]),
    };
    let outcome = quasi_static(sample.lattice.clone(), supports, &guess, &what, separated)?;
    Ok(Broken {
        first_break: outcome.first.map(|p| p.load * stress_per_load),
        strength: outcome.peak.load * stress_per_load,
        stress_per_load,
        strain_per_displacement,
        outcome,
    })
}
