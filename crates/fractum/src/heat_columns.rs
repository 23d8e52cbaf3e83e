//! Heat as columns of the history.

use fractum_scene::{Heat, HeatMeasure};

/// Values of the columns, in their order.
pub(crate) fn values(heat: &Heat) -> [f64; 3] {
    let brought = [HeatMeasure::Held, HeatMeasure::Supplied, HeatMeasure::Convection];
    let brought = brought.map(|measure| heat.measure(measure)).iter().sum();
    [heat.measure(HeatMeasure::Stored), brought, heat.measure(HeatMeasure::Residual)]
}
