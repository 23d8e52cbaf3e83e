//! Steps of two sizes: what a scene with them cannot have, and its supports.

use fractum_fem::{Formulation, Solid, motion};
use fractum_scene::Support;

use super::Context;
use crate::model::{BodyKind, Case};

impl Context<'_> {
    /// Refuses what fine elements with short steps by themselves do not know.
    pub(super) fn check_subcycling(&mut self) {
        let Some(place) = self.case.solver.subcycling.clone() else { return };
        for what in not_subcycled(self.case) {
            let found = format!("= true with {what}");
            self.error(
                &place,
                found,
                "elastic solids, or smoothed ones with damage edge by edge; leave the key out otherwise",
            );
        }
    }
}

/// What of a case keeps its cells from taking steps of two sizes, in words.
fn not_subcycled(case: &Case) -> Vec<&'static str> {
    let damage = case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Solid(solid) if solid.damage => {
            let damage = case.materials[solid.material].damage.as_ref()?;
            match solid.formulation {
                _ if damage.value.regularisation.is_some() => Some("damage by a phase field"),
                Formulation::Standard => Some("damage in the standard formulation"),
                Formulation::Smoothed => None,
            }
        }
        _ => None,
    });
    let damping = &case.damping;
    let others = [
        (!case.bodies.iter().any(|body| matches!(body.kind, BodyKind::Solid(_))), "no solid"),
        (damping.stiffness + damping.bulk_linear + damping.bulk_quadratic > 0.0, "viscosity"),
        (!case.ties.is_empty(), "ties"),
        (case.supports.iter().any(|support| support.surface.is_some()), "supports on surfaces"),
        (case.in_situ.is_some(), "in-situ stress"),
        (case.flows.gas.is_some(), "gas"),
        (case.flows.heat.is_some(), "heat"),
        (case.solver.domain.is_some(), "a domain that pieces leave"),
        (!case.later.is_empty() || !case.source.stage.is_empty(), "stages"),
    ];
    let mut found: Vec<&str> = damage.take(1).collect();
    found.extend(others.into_iter().filter(|(has, _)| *has).map(|(_, what)| what));
    found
}

/// Supports of the nodes with long steps and their copies, and of those with short steps, where there are both.
pub(super) fn by_step(supports: Vec<Support>, solid: &Solid) -> Vec<Support> {
    if !solid.is_subcycled() {
        return supports;
    }
    let of = |support: Support| {
        let points = motion::with_copies(solid, support.points);
        let (fine, coarse): (Vec<u32>, Vec<u32>) = points.into_iter().partition(|&point| solid.is_fine(point as usize));
        [(true, fine), (false, coarse)].map(|(is_fine, points)| {
            let mut part = Support::new(&support.name, points, support.axis, support.motion.clone());
            part.is_fine = is_fine;
            part
        })
    };
    supports.into_iter().flat_map(of).filter(|support| !support.points.is_empty()).collect()
}
