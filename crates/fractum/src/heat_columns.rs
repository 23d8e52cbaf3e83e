//! Heat as columns of the history.

use fractum_scene::{Heat, HeatMeasure};

/// Names and units.
pub(crate) const COLUMNS: [(&str, &str); 3] = [("heat_stored", "J"), ("heat_brought", "J"), ("heat_residual", "J")];

/// Their values.
pub(crate) fn values(heat: &Heat) -> [f64; 3] {
    let brought = [HeatMeasure::Held, HeatMeasure::Supplied, HeatMeasure::Convection];
    let brought = brought.map(|measure| heat.measure(measure)).iter().sum();
    [heat.measure(HeatMeasure::Stored), brought, heat.measure(HeatMeasure::Residual)]
}
