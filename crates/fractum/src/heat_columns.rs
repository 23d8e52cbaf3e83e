//! Heat as columns of the history.

use fractum_scene::Heat;

/// Values of the columns, in their order.
pub(crate) fn values(heat: &Heat) -> [f64; 3] {
    let ledger = heat.ledger();
    [ledger.stored, ledger.held + ledger.supplied + ledger.convection, ledger.residual()]
}
