//! Expressions of other probes.

use crate::expression::Program;

/// An expression of other probes.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeExpression {
    /// What the inputs of the program are.
    pub inputs: Vec<ProbeInput>,
    /// Whether it is one number at the end of the run: it reduces a history, or reads such a number.
    pub scalar: bool,
    pub(crate) program: Program,
}

impl ProbeExpression {
    /// Value for the given `inputs` (SI, in the order of `ProbeExpression::inputs`).
    pub fn value(&self, inputs: &[f64]) -> f64 {
        self.program.evaluate(inputs)
    }
}

/// An input of a probe expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProbeInput {
    /// The current time [s]; at the end of the run, its last.
    Time,
    /// Something about the probe of this index in `Case::probes`.
    Probe {
        /// Index into `Case::probes`.
        probe: usize,
        /// What about it.
        take: Take,
    },
}

/// What an expression takes from a probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Take {
    /// Its current value; at the end of the run, its last (or only) one.
    Current,
    /// Largest value of its history.
    Max,
    /// Smallest value of its history.
    Min,
    /// Largest absolute value of its history.
    AbsMax,
    /// Mean over time of its history.
    Mean,
    /// Last value of its history.
    Final,
    /// Time of the largest value [s].
    TimeOfMax,
    /// Least squares slope over the rows in which the value is another than in the row before.
    Speed,
    /// Value at this time [s], interpolated.
    At(f64),
    /// Least squares slope over the rows of the last time of this length [s].
    Slope(f64),
}
