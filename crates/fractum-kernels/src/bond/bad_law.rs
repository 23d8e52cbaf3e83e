use thiserror::Error;

/// Numbers that make no bond.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum BadLaw {
    /// Numbers that make no beam.
    #[error(
        "a beam of Young's modulus {young_modulus} Pa, Poisson's ratio {poisson_ratio} and radius {radius} m; expected positive modulus and radius, and Poisson's ratio between -1 and 0.5"
    )]
    Section {
        /// Young's modulus [Pa].
        young_modulus: f64,
        /// Poisson's ratio.
        poisson_ratio: f64,
        /// Radius [m].
        radius: f64,
    },
    /// A number out of its range.
    #[error("{what} {value}; expected {expected}")]
    Number {
        /// Which number.
        what: &'static str,
        /// The value.
        value: f64,
        /// The valid range.
        expected: &'static str,
    },
}
