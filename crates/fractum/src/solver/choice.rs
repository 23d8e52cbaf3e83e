//! Motion or equilibrium: what each would cost, for the plan of `fractum check`.

use fractum_case::build::{BuiltScene, may_rest};
use fractum_case::model::{Body, BodyKind, Case, Damping, Motion, SolverKind};
use fractum_output::number::{quantity, significant};
use fractum_scene::Scene;
use fractum_scene::statics::Stiffness;

/// First periods over which loading by motion is quasi-static: 20 keep the kinetic energy far below the elastic one. Where
/// something breaks as many follow the peak.
const PERIODS: f64 = 20.0;
/// Iterations to equilibrium along the path of one crack through a specimen: 390 to 980 in the gallery.
pub(crate) const PATH_ITERATIONS: f64 = 600.0;
/// Nodes up to which the first period is looked for: a few seconds.
const MOST_NODES: usize = 300_000;

/// Which solver suits a case that names one, why, what its damping does, and which end suits it, line by line; nothing where the case leaves it open,
/// since [`choose`] has said it.
pub(crate) fn compare(case: &Case, built: &mut BuiltScene) -> Vec<(&'static str, String)> {
    // What may be at rest only where the case asks for it needs no choice once it has.
    let asks = case.solver.kind == SolverKind::Static && (case.flows.heat.is_some() || !case.interfaces.is_empty());
    if asks
        || built.scene.solid.body_count() == 0
        || matches!(case.solver.kind, SolverKind::Auto | SolverKind::Heat | SolverKind::Modes)
    {
        return Vec::new();
    }
    if let Some(why) = motion_only(case, &built.scene) {
        return vec![("choice", said("explicit", why))];
    }
    if built.scene.solid.reference.len() > MOST_NODES {
        let text = format!("not estimated for more than {MOST_NODES} nodes; slender bodies are for kind = \"static\"");
        return vec![("choice", text)];
    }
    let Decision { kind, why, period, slow } = decide(case, built);
    let mut lines = vec![("choice", said(kind, &why))];
    if built.statics.is_none() {
        let damps = !damping_ratios(&case.damping, 1.0).is_empty();
        let period = period.or_else(|| damps.then(|| quick_period(&mut built.scene, case.solver.end)).flatten());
        lines.extend(period.and_then(|period| Some(("damping", damping(&case.damping, period, slow)?))));
    }
    let slow = |period: f64| periods(&built.scene) * period;
    if let Some(slow) = period.map(slow).filter(|slow| built.statics.is_none() && case.solver.end < *slow) {
        let [slow, end] = [slow, case.solver.end].map(|time| quantity(time, "s"));
        let text = format!("this run ends at {end}; to load slowly in motion, load {slow} long: end = \"{slow}\"");
        lines.push(("end", text));
    }
    lines
}

/// What the damping of a case does to the first vibration, or what would damp it where loads are slow and nothing does.
fn damping(damping: &Damping, period: f64, slow: bool) -> Option<String> {
    let critical = quantity(4.0 * std::f64::consts::PI / period, "1/s");
    let first = quantity(period, "s");
    let ratios = damping_ratios(damping, period);
    if ratios.is_empty() {
        return slow.then(|| {
            format!(
                "none: the first vibration of {first} does not come to rest; mass = \"{critical}\" damps it critically"
            )
        });
    }
    let sum: f64 = ratios.iter().map(|(_, ratio)| ratio).sum();
    let percent = |ratio: f64| format!("{} %", significant(100.0 * ratio, 2));
    let part = |(key, ratio): &(&str, f64)| format!("{} by {key}", percent(*ratio));
    let parts = match ratios.as_slice() {
        [_] => String::new(),
        several => format!(": {}", several.iter().map(part).collect::<Vec<_>>().join(", ")),
    };
    let more = match slow && sum > OVERDAMPED {
        true => format!("; with more than mass = \"{critical}\" the body lags behind slow loads"),
        false => String::new(),
    };
    Some(format!("the first vibration of {first} has {} of its critical damping{parts}{more}", percent(sum)))
}

/// Damping ratio above which a body lags behind a slow load.
const OVERDAMPED: f64 = 2.0;

/// What each kind of damping gives the vibration of a period, over critical damping: α T/4π by mass, π β/T by stiffness, and a/π
/// by local damping, which takes 4 a of the energy in a period.
fn damping_ratios(damping: &Damping, period: f64) -> Vec<(&'static str, f64)> {
    let pi = std::f64::consts::PI;
    let all = [
        ("mass", damping.mass * period / (4.0 * pi)),
        ("stiffness", pi * damping.stiffness / period),
        ("local", damping.local / pi),
    ];
    all.into_iter().filter(|(_, ratio)| *ratio > 0.0).collect()
}

/// Nodes, and seconds of a solution, above which the first period is not looked for only to tell of damping.
const QUICK: (usize, f64) = (50_000, 0.3);

/// The first period, where it takes less than a second.
fn quick_period(scene: &mut Scene, end: f64) -> Option<f64> {
    if scene.solid.reference.len() > QUICK.0 {
        return None;
    }
    let mut stiffness = Stiffness::new(scene).ok()?;
    let (entries, direct) = stiffness.entries();
    if solution_time(entries, direct) > QUICK.1 {
        return None;
    }
    stiffness.prepare(scene).and_then(|()| stiffness.first_period(scene, end)).ok()
}

fn said(kind: &str, why: &str) -> String {
    format!("kind = \"{kind}\": {why}")
}

/// First periods over which motion is slow loading.
fn periods(scene: &Scene) -> f64 {
    if scene.solid.has_damage() { 2.0 * PERIODS } else { PERIODS }
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
pub(crate) fn choose(case: &Case, built: &mut BuiltScene) -> Option<String> {
    if case.solver.kind != SolverKind::Auto {
        return None;
    }
    let decision = if built.statics.is_none() {
        Decision::motion(motion_only(case, &built.scene).unwrap_or("no solid bodies by themselves"))
    } else {
        decide(case, built)
    };
    if decision.kind == "explicit" {
        built.statics = None;
    }
    Some(said(decision.kind, &decision.why))
}

/// A kind of solver, and why.
struct Decision {
    kind: &'static str,
    why: String,
    /// First period that the load excites [s], where it was found.
    period: Option<f64>,
    /// Whether loads are slow against it.
    slow: bool,
}

impl Decision {
    fn motion(why: &str) -> Self {
        Decision { kind: "explicit", why: why.to_owned(), period: None, slow: false }
    }
}

fn decide(case: &Case, built: &mut BuiltScene) -> Decision {
    let (scene, end) = (&mut built.scene, case.solver.end);
    if let Some(why) = inertia_counts(case) {
        return Decision::motion(why);
    }
    let Ok(mut stiffness) = Stiffness::new(scene) else {
        return Decision::motion("the linear system is too large");
    };
    let period = stiffness.prepare(scene).and_then(|()| stiffness.first_period(scene, end));
    let Ok(period) = period else { return Decision::motion("the stiffness is singular") };
    let first = quantity(period, "s");
    let change = scene.fastest_change(period, end);
    if change > 2.0 / PERIODS {
        let part = 100.0 * change;
        let why = format!("loads change by {part:.0} % within the first period of {first}, so that inertia counts");
        return Decision { period: Some(period), ..Decision::motion(&why) };
    }
    let elements = scene.counts().elements;
    let steps = end / (case.solver.safety * 2.0 / scene.solid.stable_step().frequency);
    let motion = 1e-9 * STEP * elements as f64 * steps;
    let (entries, direct) = stiffness.entries();
    let times = if scene.solid.has_damage() { PATH_ITERATIONS } else { 1.0 };
    let rest = times * (solution_time(entries, direct) + evaluation(scene));
    let why = format!(
        "loads are slow against the first period of {first}; on a common machine equilibrium takes about {} s, {steps:.0} steps of motion about {} s",
        significant(rest, 2),
        significant(motion, 2)
    );
    Decision { kind: if rest < motion { "static" } else { "explicit" }, why, period: Some(period), slow: true }
}

/// Time of one solution of the linear system on a common machine [s].
///
/// - `entries`: of the factor, or of the matrix where it is solved iteratively, which `direct` tells
pub(crate) fn solution_time(entries: usize, direct: bool) -> f64 {
    entries as f64 * if direct { DIRECT } else { ITERATIVE }
}

/// Time of an iteration beside the linear system [s].
fn evaluation(scene: &Scene) -> f64 {
    if scene.solid.has_damage() { EVALUATION * scene.counts().elements as f64 } else { 0.0 }
}

/// Why motion is meant, as far as the case file alone tells.
fn inertia_counts(case: &Case) -> Option<&'static str> {
    let loads = case.loads.iter().any(|load| load.kind.functions().iter().any(|function| function.value.is_pulse()));
    let supports = case
        .supports
        .iter()
        .flat_map(|support| support.motion.iter().flatten())
        .any(|motion| matches!(&motion.value, Motion::Velocity(of) | Motion::Displacement(of) if of.is_pulse()));
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
    if case.flows.gas.is_some() {
        Some("gas is for motion only")
    } else if case.flows.heat.is_some() {
        Some("heat goes with motion unless kind = \"static\" asks for equilibrium")
    } else if !case.interfaces.is_empty() {
        // Stiff ones know motion alone, and of the others no time of solution is known.
        Some("interfaces go with motion unless kind = \"static\" asks for equilibrium")
    } else if case.supports.iter().any(|support| support.surface.is_some()) {
        Some("absorbing and elastic supports act in motion only")
    } else if !case.bodies.iter().all(may_rest) {
        Some(
            "solids beside particles, rigid facets, containers, or rigid bodies that contact moves, are for motion only",
        )
    } else if solid.not_secant().is_some() {
        Some("equilibrium is for small strains, open cracks and damage without delay")
    } else if scene.check_supports().is_err() {
        Some("a body is free to move")
    } else {
        None
    }
}
