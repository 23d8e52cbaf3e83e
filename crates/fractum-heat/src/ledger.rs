use serde::{Deserialize, Serialize};

/// Where the heat of a run came from and where it is [J].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeatLedger {
    /// Heat stored in the points beyond that of the start.
    pub stored: f64,
    /// Brought through points of prescribed temperature.
    pub held: f64,
    /// Brought by flows and sources.
    pub supplied: f64,
    /// Brought by convection.
    pub convection: f64,
}

impl HeatLedger {
    /// What is missing [J].
    pub fn residual(&self) -> f64 {
        self.held + self.supplied + self.convection - self.stored
    }
}
