//! Strength by the rate of strain: what it cannot go with.

use super::Context;
use crate::model::BodyKind;

/// Refuses what strength by rate has no part in.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    let of_body = |kind: &BodyKind| match kind {
        BodyKind::Solid(solid) if solid.damage => {
            let damage = case.materials[solid.material].damage.as_ref()?;
            Some(damage.value.rate.as_ref()?.place.clone())
        }
        _ => None,
    };
    let Some(place) = case.bodies.iter().find_map(|body| of_body(&body.kind)) else { return };
    if case.solver.subcycling.is_some() {
        context.error(&place, "with solver.subcycling", "one step for all elements; remove subcycling");
    }
    if context.exchange.is_some() || context.division.is_some() {
        context.error(&place, "in a run of several processes", "one process; threads are not limited");
    }
}
