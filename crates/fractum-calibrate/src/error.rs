use fractum_dem::DemError;
use fractum_pack::PackError;
use thiserror::Error;

/// Why a virtual test or a calibration failed.
#[derive(Debug, Error)]
pub enum CalibrateError {
    /// The packing could not be made or bonded.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The lattice could not be built or solved.
    #[error(transparent)]
    Dem(#[from] DemError),
    /// A test asked of a shape that has no faces for it.
    #[error("{test} needs {shape}")]
    Shape {
        /// The test.
        test: &'static str,
        /// The shapes it works on.
        shape: &'static str,
    },
    /// A material outside isotropic elasticity.
    #[error("{what} = {value}; expected {expected}")]
    Material {
        /// Which property.
        what: &'static str,
        /// The value.
        value: f64,
        /// The valid range.
        expected: &'static str,
    },
    /// A Poisson's ratio that no beam radius gives at this coordination.
    #[error(
        "Poisson's ratio {asked} is out of reach at coordination {coordination} ({convention}): beam radii from {thin} to {thick} \
         mean radii give {highest:.3} down to {lowest:.3}; lower coordinations reach higher ratios, higher ones lower"
    )]
    PoissonRange {
        /// The asked ratio.
        asked: f64,
        /// Coordination of the bond network.
        coordination: f64,
        /// Its convention.
        convention: fractum_pack::Convention,
        /// Thinnest beam radius over the mean radius.
        thin: f64,
        /// Thickest beam radius over the mean radius.
        thick: f64,
        /// Ratio of the thickest beams.
        lowest: f64,
        /// Ratio of the thinnest beams.
        highest: f64,
    },
    /// A coordination outside the table of a law.
    #[error("coordination {asked} is outside the law's range {from} to {to} ({convention}); use direct inversion")]
    LawRange {
        /// The asked coordination.
        asked: f64,
        /// Lowest of the law.
        from: f64,
        /// Highest of the law.
        to: f64,
        /// Convention of the law.
        convention: fractum_pack::Convention,
    },
    /// A stored law that cannot be read.
    #[error("law table, line {line}: {what}")]
    LawTable {
        /// Line number, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
}
