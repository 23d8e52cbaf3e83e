//! What a quasi-static run needs, and what it cannot do.

use fractum_fem::{LocalDamping, NotSecant, Solid};
use fractum_scene::statics::{self, ModesSettings, NoEquilibrium, StaticSettings};
use fractum_scene::{Bonded, BondedStaticSettings, Scene};

use super::Context;
use super::bodies::Numbering;
use super::turns::{turns, turns_back};
use crate::Place;
use crate::model::{Body, BodyKind, BondLawKind, Control, Damping, SolverKind};

/// Relative residual of iterative linear solutions.
const LINEAR_TOLERANCE: f64 = 1e-8;
/// Steps of the load parameter where the way to the end counts.
const STEPS: f64 = 50.0;

/// Settings of the static solver; none for other solvers, or with errors noted.
pub(super) fn statics(context: &mut Context<'_>, solid: &Solid, numbering: &Numbering) -> Option<StaticSettings> {
    let solver = &context.case.solver;
    solver.statics.as_ref()?;
    let place = place_of_solver(context);
    if solver.kind == SolverKind::Auto {
        // What is not for equilibrium is for motion; whether the supports hold is seen on the whole scene.
        let case = context.case;
        let possible = solid.not_secant().is_none() && case.bodies.iter().all(may_rest) && case.interfaces.is_empty();
        return possible.then(|| static_settings(context, solid, numbering)).flatten();
    }
    if let Some((body, why)) = solid.not_secant() {
        let found = match why {
            NotSecant::Corotational => "kinematics = \"corotational\"",
            NotSecant::Unilateral => "damage.unilateral = true",
            NotSecant::Friction => "damage.friction",
            NotSecant::Rate => "damage.rate_time",
            NotSecant::StrainRate => "damage.rate",
        };
        let found = format!("= \"static\" with {found} in body \"{}\"", solid.body(body).name);
        context.error(&place, found, "small strains, open cracks and damage without delay; or kind = \"explicit\"");
    }
    if matches!(context.case.bodies.as_slice(), [Body { kind: BodyKind::Bonded(_), .. }]) {
        return None;
    }
    if let Some(body) = context.case.bodies.iter().find(|body| !may_rest(body)) {
        let found = format!("= \"static\" with body \"{}\"", body.name.value);
        let expected = if has_walls(body) {
            "rigid planes, boxes, cylinders and spheres, which solids touch from outside: facets and containers touch in motion alone"
        } else {
            "solid bodies with rigid ones that are driven by velocity or stand still, or one bonded body"
        };
        context.error(&place, found, format!("{expected}; or kind = \"explicit\""));
        return None;
    }
    static_settings(context, solid, numbering)
}

/// Whether what the static solver gets is held; an error where the case asks for that solver.
pub(super) fn is_held(context: &mut Context<'_>, scene: &Scene) -> bool {
    let Err(error) = scene.check_supports() else { return true };
    if context.case.solver.kind == SolverKind::Static {
        let place = place_of_solver(context);
        let remedy = if scene.supports().count() == 0 { "at least one [[supports]]" } else { "" };
        context.error(&place, format!("= \"static\": {error}"), remedy);
    }
    false
}

fn static_settings(context: &mut Context<'_>, solid: &Solid, numbering: &Numbering) -> Option<StaticSettings> {
    let solver = &context.case.solver;
    let options = solver.statics.as_ref()?;
    let Damping { local, mass, stiffness, bulk_linear, bulk_quadratic, .. } = context.case.damping;
    let given = [local, mass, stiffness, bulk_linear, bulk_quadratic].iter().any(|&value| value > 0.0);
    let damage = solid.has_damage();
    let heats = context.case.flows.heat.is_some();
    let bonded = context.case.interfaces.iter().any(|interface| interface.law.is_bonded());
    let flows = context.case.flows.liquid.is_some() || heats;
    let opens = bonded && !flows && options.no_equilibrium == NoEquilibrium::Stop;
    let way_counts = damage || heats || !context.case.interfaces.is_empty() || turns_back(context);
    let whole = if way_counts { (solver.end - solver.begin) / STEPS } else { solver.end };
    let opening = options.opening.as_ref().map(|opening| statics::Opening {
        nodes: context.group_nodes(&opening.group, numbering),
        against: context.group_nodes(&opening.against, numbering),
        direction: opening.along,
        step: opening.step,
        end: opening.end,
    });
    Some(StaticSettings {
        control: match options.control {
            _ if opening.is_some() => opening.map(statics::Control::Opening)?,
            Some(Control::Time) => statics::Control::Time,
            Some(Control::Path | Control::Opening) => statics::Control::Path,
            // Heat does not flow back along a path.
            None if damage && !heats => statics::Control::Path,
            // Liquid and heat flow in time, and a scene that may move does so instead.
            None if opens => statics::Control::TimeThenPath,
            None => statics::Control::Time,
        },
        step: solver.step.as_ref().map_or(whole, |step| step.value.min(solver.end)),
        turns: turns(context),
        end: solver.end,
        most_steps: options.most_steps,
        tolerance: options.tolerance,
        linear_tolerance: LINEAR_TOLERANCE,
        linear: options.linear_solver,
        damping: given.then_some(LocalDamping { local, mass_rate: mass }),
        no_equilibrium: options.no_equilibrium,
    })
}

/// Settings of the solver that brings a bonded body from break to break; none for other bodies and solvers, or with
/// errors noted.
pub(super) fn bonded_statics(context: &mut Context<'_>, bonded: &Bonded) -> Option<BondedStaticSettings> {
    let solver = &context.case.solver;
    let options = solver.statics.as_ref().filter(|_| solver.kind == SolverKind::Static)?;
    let [Body { kind: BodyKind::Bonded(_), .. }] = context.case.bodies.as_slice() else { return None };
    let place = place_of_solver(context);
    if let Some(heat) = &context.case.flows.heat {
        let place = heat.place.clone();
        context.error(&place, "beside a bonded body at rest", "solids, or solver.kind = \"explicit\"");
    }
    if bonded.held_count() == 0 {
        context.error(&place, "= \"static\" with a bonded body and no support", "at least one [[supports]]");
    }
    if let Err(error) = bonded.check_proportional(solver.end) {
        context.error(&place, format!("= \"static\": {error}"), "");
    }
    Some(BondedStaticSettings {
        end: solver.end,
        tolerance: options.tolerance,
        batch: options.batch,
        most_steps: options.most_steps,
    })
}

/// Settings of the search for natural vibrations; none for other solvers, or with errors noted.
pub(super) fn modes(context: &mut Context<'_>) -> Option<ModesSettings> {
    let options = context.case.solver.modes?;
    let vibrates = |body: &Body| match &body.kind {
        BodyKind::Solid(_) => true,
        BodyKind::Bonded(bonded) => bonded.law == BondLawKind::CohesiveBeam,
        BodyKind::Rigid(_) | BodyKind::Particles(_) => false,
    };
    let bodies = &context.case.bodies;
    let is_bonded = |body: &&Body| matches!(body.kind, BodyKind::Bonded(_));
    let place = place_of_solver(context);
    if let Some(body) = bodies.iter().find(|body| !vibrates(body)) {
        let found = format!("= \"modes\" with body \"{}\"", body.name.value);
        let expected = "solid bodies, and bonded bodies of cohesive beams, by themselves: contact has no part in natural vibrations";
        context.error(&place, found, expected);
        return None;
    }
    if let Some(body) = bodies.iter().find(is_bonded).filter(|_| context.case.in_situ.is_some()) {
        let found = format!("= \"modes\" with [in_situ] and the bonded body \"{}\"", body.name.value);
        context.error(&place, found, "solid bodies alone, or no [in_situ]");
        return None;
    }
    Some(ModesSettings { count: options.count, linear: options.linear_solver })
}

fn place_of_solver(context: &Context<'_>) -> Place {
    context.case.solver.place.clone()
}

/// Whether a body has a place in equilibrium: solids, and rigid shapes that contact does not move.
pub fn may_rest(body: &Body) -> bool {
    match &body.kind {
        BodyKind::Solid(_) => true,
        BodyKind::Rigid(rigid) => {
            rigid.mass.is_none() && rigid.servo.is_none() && rigid.spin.iter().all(Option::is_none) && !has_walls(body)
        }
        BodyKind::Bonded(_) | BodyKind::Particles(_) => false,
    }
}

/// Whether a body is rigid facets, a container or an open cylinder.
fn has_walls(body: &Body) -> bool {
    let BodyKind::Rigid(rigid) = &body.kind else { return false };
    rigid.has_walls()
}
