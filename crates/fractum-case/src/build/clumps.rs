//! Clumps of loose particles: what they cannot be part of.

use super::Context;
use crate::model::{BodyKind, SolverKind};

/// Refuses clumps beside what knows single spheres only.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    for body in &case.bodies {
        let BodyKind::Particles(loose) = &body.kind else { continue };
        let Some(clump) = &loose.clump else { continue };
        let mut refuse = |is_there: bool, found: &str, expected: &str| {
            if is_there {
                context.error(&clump.place, format!(": {found}"), expected);
            }
        };
        let is_explicit = case.solver.kind == SolverKind::Explicit;
        refuse(!is_explicit, "clumps only move", "solver.kind = \"explicit\" beside clumps");
        refuse(case.periodic.is_some(), "clumps know no periodic box", "single spheres in [periodic]");
        refuse(case.flows.heat.is_some(), "clumps know no heat", "single spheres beside [heat]");
        let schemes = case.damping.tchamwa_wielgosz.is_some_and(|phi| phi > 1.0);
        refuse(
            schemes,
            "damping.tchamwa_wielgosz does not act on clumps",
            "damping.local or damping.mass beside clumps",
        );
        for support in &case.supports {
            let Some(group) = &support.on.group else { continue };
            if case.particle_group(&group.value).is_some_and(|(own, _)| case.bodies[own].name.value == body.name.value)
            {
                let found =
                    format!("= \"{}\": its particles are spheres of clumps, which no support holds", group.value);
                context.error(&group.place, found, "forces ([[loads]]), or a rigid body that holds them by contact");
            }
        }
    }
}
