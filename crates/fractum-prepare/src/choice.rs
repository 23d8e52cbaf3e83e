//! Motion or equilibrium: what each would cost, for the plan of `fractum check`.

use std::time::Instant;

use fractum_io::build::{BuiltScene, may_rest};
use fractum_io::case::TimeFunction;
use fractum_io::case::model::{Body, BodyKind, Case, Motion, SolverKind};
use fractum_io::number::quantity;
use fractum_scene::Scene;
use fractum_scene::statics::Stiffness;

/// First periods over which loading by motion is quasi-static: 20 keep the kinetic energy far below the elastic one. Where
/// something breaks as many follow the peak.
const PERIODS: f64 = 20.0;
/// Iterations to equilibrium along the path of one crack through a specimen: 390 to 980 in the gallery.
const ITERATIONS: f64 = 600.0;
/// Time that is spent twice for a better estimate [s].
const SOON: f64 = 0.5;
/// Nodes up to which the first period is looked for: a few seconds.
const MOST_NODES: usize = 300_000;

/// What the solvers would do with a case, line by line; empty where only motion can be meant.
///
/// - `step_seconds`: estimated time of one explicit step [s]
pub fn compare(case: &Case, built: &mut BuiltScene, step_seconds: f64) -> Vec<(&'static str, String)> {
    let scene = &mut built.scene;
    if scene.solid.body_count() == 0 {
        return Vec::new();
    }
    if case.solver.kind == SolverKind::Auto {
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
    let rest = times * (1.3 * prepared + evaluation(scene));
    let lasting = case.solver.end / period;
    let equilibrium = built.statics.is_some();
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

/// Seconds of an iteration to equilibrium on a common machine, per entry of the factor and per entry of a matrix that is solved
/// iteratively.
const DIRECT: f64 = 4e-8;
const ITERATIVE: f64 = 3e-7;
/// Seconds per element beside the linear system, of an iteration in which something may break.
const EVALUATION: f64 = 2e-6;
/// Nanoseconds of a step of motion per element.
const STEP: f64 = 45.0;

/// Settles a kind of solver that the case leaves open, and says why; nothing where it does not.
///
/// The answer depends on case and mesh alone, so that another machine does the same.
pub fn choose(case: &Case, built: &mut BuiltScene) -> Option<String> {
    if case.solver.kind != SolverKind::Auto {
        return None;
    }
    let (chosen, why) = if built.statics.is_none() {
        let why = motion_only(case, &built.scene).unwrap_or("no solid bodies by themselves");
        ("explicit", why.to_owned())
    } else {
        decide(case, built)
    };
    if chosen == "explicit" {
        built.statics = None;
    }
    Some(format!("kind = \"{chosen}\": {why}"))
}

fn decide(case: &Case, built: &mut BuiltScene) -> (&'static str, String) {
    let (scene, end) = (&mut built.scene, case.solver.end);
    if let Some(why) = inertia_counts(case) {
        return ("explicit", why.to_owned());
    }
    let Ok(mut stiffness) = Stiffness::new(scene) else {
        return ("explicit", "the linear system is too large".to_owned());
    };
    let period = stiffness.prepare(scene).and_then(|()| stiffness.first_period(scene, end));
    let Ok(period) = period else { return ("explicit", "the stiffness is singular".to_owned()) };
    let first = quantity(period, "s");
    let change = scene.fastest_change(period, end);
    if change > 2.0 / PERIODS {
        let part = 100.0 * change;
        return (
            "explicit",
            format!("loads change by {part:.0} % within the first period of {first}, so that inertia counts"),
        );
    }
    let elements = scene.counts().elements;
    let steps = end / (case.solver.safety * 2.0 / scene.solid.stable_step().frequency);
    let motion = 1e-9 * STEP * elements as f64 * steps;
    let (entries, direct) = stiffness.entries();
    let times = if scene.solid.has_damage() { ITERATIONS } else { 1.0 };
    let rest = times * (entries as f64 * if direct { DIRECT } else { ITERATIVE } + evaluation(scene));
    let costs = format!(
        "loads are slow against the first period of {first}; equilibrium takes about {}, {steps:.0} steps of motion about {}",
        quantity(rest, "s"),
        quantity(motion, "s")
    );
    (if rest < motion { "static" } else { "explicit" }, costs)
}

/// Time of an iteration beside the linear system [s].
fn evaluation(scene: &Scene) -> f64 {
    if scene.solid.has_damage() { EVALUATION * scene.counts().elements as f64 } else { 0.0 }
}

/// Why motion is meant, as far as the case file alone tells.
fn inertia_counts(case: &Case) -> Option<&'static str> {
    let pulse = |function: &TimeFunction| {
        let kinds = matches!(function, TimeFunction::Triangle { .. } | TimeFunction::HalfSine { .. });
        kinds || matches!(function, TimeFunction::DoubleExponential { .. })
    };
    let loads = case.loads.iter().any(|load| load.kind.functions().iter().any(|function| pulse(&function.value)));
    let supports = case
        .supports
        .iter()
        .flat_map(|support| support.motion.iter().flatten())
        .any(|motion| matches!(&motion.value, Motion::Velocity(of) | Motion::Displacement(of) if pulse(of)));
    let moves = |body: &Body| matches!(&body.kind, BodyKind::Solid(solid) if solid.initial_velocity.iter().any(Option::is_some));
    if loads || supports {
        Some("a load is a pulse")
    } else if case.bodies.iter().any(moves) {
        Some("a body has an initial velocity")
    } else {
        None
    }
}

/// Why equilibrium is out of the question.
fn motion_only(case: &Case, scene: &Scene) -> Option<&'static str> {
    let solid = &scene.solid;
    if !case.bodies.iter().all(may_rest) {
        Some("solids beside particles, or beside rigid bodies that contact moves, are for motion only")
    } else if solid.not_secant().is_some() {
        Some("equilibrium is for small strains, open cracks and damage without delay")
    } else if scene.check_supports().is_err() {
        Some("a body is free to move")
    } else {
        None
    }
}
