//! Motion or equilibrium: what each would cost, for the plan of `fractum check`.

use std::time::Instant;

use fractum_io::assemble::Assembly;
use fractum_io::case::model::Case;
use fractum_io::number::quantity;
use fractum_scene::Scene;
use fractum_scene::statics::{Stiffness, check_supports};

/// First periods over which loading by motion is quasi-static: 20 keep the kinetic energy far below the elastic one. Where
/// something breaks as many follow the peak.
const PERIODS: f64 = 20.0;
/// Iterations to equilibrium along the path of one crack through a specimen: 350 to 1,100 in the gallery.
const ITERATIONS: f64 = 600.0;
/// Time that is spent twice for a better estimate [s].
const SOON: f64 = 0.5;
/// Nodes up to which the first period is looked for: a few seconds.
const MOST_NODES: usize = 300_000;

/// What the solvers would do with a case, line by line; empty where only motion can be meant.
///
/// - `step_seconds`: estimated time of one explicit step [s]
pub(crate) fn compare(case: &Case, assembly: &mut Assembly, step_seconds: f64) -> Vec<(&'static str, String)> {
    let scene = &mut assembly.scene;
    if scene.solid.body_count() == 0 {
        return Vec::new();
    }
    if let Some(why) = motion_only(case, scene) {
        return vec![("choice", format!("kind = \"explicit\": {why}"))];
    }
    if scene.solid.reference.len() > MOST_NODES {
        let text = format!("not estimated for more than {MOST_NODES} nodes; slender bodies are for kind = \"static\"");
        return vec![("choice", text)];
    }
    let Ok(mut stiffness) = Stiffness::new(scene) else { return Vec::new() };
    // The first assembly is slower than those of a run: where that costs little, the second counts.
    let mut prepared = f64::INFINITY;
    for _ in 0..2 {
        let begin = Instant::now();
        if stiffness.prepare(scene).is_err() {
            return Vec::new();
        }
        prepared = begin.elapsed().as_secs_f64().min(prepared);
        if prepared > SOON {
            break;
        }
    }
    let Ok(period) = stiffness.first_period(scene, case.solver.end) else { return Vec::new() };
    let dt = case.solver.safety * 2.0 / scene.solid.stable_step().frequency;
    let periods = if scene.solid.has_damage() { 2.0 * PERIODS } else { PERIODS };
    let steps = periods * period / dt;
    let motion = steps * step_seconds;
    let (times, what) = if scene.solid.has_damage() {
        (ITERATIONS, format!("about {ITERATIONS} iterations along the path of a crack"))
    } else {
        (1.0, "one solution".to_owned())
    };
    // Two solutions go with each factorisation, and take less.
    let rest = times * 1.3 * prepared;
    let lasting = case.solver.end / period;
    let equilibrium = assembly.statics.is_some();
    let advice = if !equilibrium && lasting < PERIODS {
        format!("this run lasts {lasting:.2} first periods, so that inertia counts: kind = \"explicit\"")
    } else {
        let better = if rest < motion { "static" } else { "explicit" };
        format!("for slow loading take kind = \"{better}\"")
    };
    let moved = format!("{periods} periods of motion are {steps:.0} steps, {}", quantity(motion, "s"));
    vec![
        (
            "period",
            format!(
                "{} of the slowest vibration that the load excites, {:.0} time steps",
                quantity(period, "s"),
                period / dt
            ),
        ),
        ("choice", format!("{moved}; equilibrium is {what}, {}: {advice}", quantity(rest, "s"))),
    ]
}

/// Why equilibrium is out of the question.
fn motion_only(case: &Case, scene: &Scene) -> Option<&'static str> {
    let solid = &scene.solid;
    if solid.body_count() < case.bodies.len() {
        Some("solids beside other bodies are for motion only")
    } else if solid.not_secant().is_some() {
        Some("equilibrium is for small strains, open cracks and damage without delay")
    } else if check_supports(solid, scene.supports().held()).is_err() {
        Some("a body is free to move")
    } else {
        None
    }
}
