//! What a run came to, as `summary.json` holds it.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::Duration;

use fractum_case::model::{Case, Expect, ProbeKind};
use fractum_fem::{BodyState, Solid, cracks, neighbours};
use fractum_output::expectation::Expectation;
use fractum_output::summary::{self, Status, Summary};
use fractum_scene::{BondedBody, Clock, CountKind, Fragment, Scene, entered_of, passing_size, periodic_state};
use serde::Serialize;
use xxhash_rust::xxh3::Xxh3;

use crate::output::record::Recorder;
use crate::output::series::index_of_max;
use crate::phases::Phases;

/// What the last state of the scene tells.
pub(crate) fn of_scene(scene: &Scene) -> Summary {
    let (counts, fracture) = (scene.counts(), cracks::fracture(&scene.solid));
    Summary {
        fractum: env!("CARGO_PKG_VERSION").to_owned(),
        threads: rayon::current_num_threads(),
        energy: scene.ledger().into(),
        counts: summary::Counts {
            nodes: counts.nodes as u64,
            elements: counts.elements as u64,
            removed_elements: counts.removed_elements as u64,
            crushed_elements: counts.crushed_elements as u64,
            particles: counts.particles as u64,
            entered_particles: counts.entered_particles as u64,
            waiting_particles: counts.waiting_particles as u64,
            most_waiting_particles: entered_of(scene).most_waiting as u64,
            left_pieces: counts.left_pieces as u64,
            bonds: counts.bonds as u64,
            broken_bonds: counts.broken_bonds as u64,
            broken_edges: fracture.broken_edges as u64,
            damaged_edges: fracture.damaged_edges as u64,
            contacts: counts.contacts as u64,
            fragments: scene.count(CountKind::Fragments) as u64,
        },
        fracture: scene.bonded.bodies().iter().filter(|body| body.can_break()).map(fracture_of).collect(),
        ..Summary::default()
    }
}

/// The probes over the run.
pub(crate) fn probes(case: &Case, recorder: &Recorder) -> BTreeMap<String, summary::Probe> {
    let record = recorder.state();
    let of = |(index, probe): (usize, &fractum_case::model::Probe)| {
        let unit = probe.unit.clone();
        if let ProbeKind::Expression(expression) = &probe.kind
            && expression.scalar
        {
            let value = recorder.scalar(expression);
            return summary::Probe { unit, r#final: value, max: value, min: value, time_of_max: f64::NAN };
        }
        let values = &record.series[index];
        let extreme = |f: fn(f64, f64) -> f64| values.iter().copied().fold(f64::NAN, f);
        summary::Probe {
            unit,
            r#final: values.last().copied().unwrap_or(f64::NAN),
            max: extreme(f64::max),
            min: extreme(f64::min),
            time_of_max: index_of_max(values).map_or(f64::NAN, |i| record.times[i]),
        }
    };
    case.probes.iter().enumerate().map(|probe| (probe.1.name.value.clone(), of(probe))).collect()
}

/// Steps and times, and why they ended.
///
/// - `at_rest`: whether time is a load factor
pub(crate) fn time(clock: &Clock, reason: String, at_rest: bool) -> summary::Time {
    summary::Time { steps: clock.step, dt: clock.dt_before, dt_min: clock.dt_min, end: clock.time, reason, at_rest }
}

/// Sizes of the fragments; none where there are none, or where boundaries hold all of them.
pub(crate) fn fragment_sizes(solid: &Solid, pieces: &[Fragment]) -> Option<summary::FragmentSizes> {
    let [p20, p50, p80] = [0.2, 0.5, 0.8].map(|share| passing_size(solid, pieces, share));
    pieces.iter().any(|piece| !piece.stays).then_some(summary::FragmentSizes { p20, p50, p80 })
}

/// How long it took.
pub(crate) fn wall(total: Duration, phases: &Phases) -> summary::Wall {
    summary::Wall { total: total.as_secs_f64(), phases: phases.seconds().collect() }
}

/// How a run ended, in a word.
pub(crate) fn status_text(status: Status) -> &'static str {
    match status {
        Status::Completed => "completed",
        Status::Stopped => "stopped",
        Status::Interrupted => "interrupted",
    }
}

/// What became of the bonds of a body.
fn fracture_of(body: &BondedBody) -> summary::Fracture {
    let closest = body.closest();
    summary::Fracture {
        body: body.name.clone(),
        broken_bonds: body.broken() as u64,
        first_break: body.cracks().first().map_or(f64::NAN, |crack| crack.time),
        crack_area: body.cracks().iter().map(|crack| crack.area).sum(),
        largest_ratio: closest.map_or(f64::NAN, |c| c.ratio),
        largest_at: closest.map(|c| c.place.into()),
        largest_time: closest.map_or(f64::NAN, |c| c.time),
    }
}

/// Hash of everything that changes in a scene.
pub(crate) fn state_hash(scene: &Scene) -> u128 {
    if neighbours::is_divided(&scene.solid) {
        return hash_of_divided(scene);
    }
    let mut bytes = postcard::to_stdvec(&scene.state()).unwrap_or_default();
    if let Some(heat) = scene.heat_state() {
        bytes.extend(postcard::to_stdvec(&heat).unwrap_or_default());
    }
    if let Some(subcycling) = scene.subcycling_state() {
        bytes.extend(postcard::to_stdvec(&subcycling).unwrap_or_default());
    }
    if let Some(periodic) = periodic_state(scene) {
        bytes.extend(postcard::to_stdvec(&periodic).unwrap_or_default());
    }
    xxhash_rust::xxh3::xxh3_128(&bytes)
}

/// The same where no process has all cells: they take in histories and viscous stress one after the other. All must call it.
fn hash_of_divided(scene: &Scene) -> u128 {
    let (state, hash) = (scene.state(), RefCell::new(Xxh3::new()));
    let bodies = state.bodies();
    // A list is its length, and what it holds.
    add(&hash, &state.before_bodies());
    add(&hash, &bodies.len());
    for (index, BodyState { kinematics, alive, edges: _, elements, phase, rates }) in bodies.iter().enumerate() {
        add(&hash, &(kinematics, alive));
        neighbours::each_history(&scene.solid, index, |count| add(&hash, &count), |history| add(&hash, history));
        add(&hash, &(elements, phase, rates));
    }
    add(&hash, &state.between_bodies_and_stress());
    add(&hash, &neighbours::block_count(&scene.solid));
    neighbours::each_viscous_block(&scene.solid, |stress| add(&hash, &stress));
    add(&hash, &state.behind_solids());
    hash.into_inner().digest128()
}

/// Takes a part of a state into its hash.
fn add(hash: &RefCell<Xxh3>, part: &impl Serialize) {
    hash.borrow_mut().update(&postcard::to_stdvec(part).unwrap_or_default());
}

/// Holds a value of the summary against its reference.
pub(crate) fn expectation(expect: &Expect, summary: &Summary) -> Expectation {
    let name = &expect.quantity.value;
    let estimates = summary.accuracy.as_ref().map(|accuracy| &accuracy.probes);
    let value = match summary.probes.get(name) {
        // A probe that is one number has the estimate of it, where there is one.
        Some(probe) if probe.time_of_max.is_nan() => {
            estimates.and_then(|all| all.get(name)).map_or(probe.r#final, |estimate| estimate.value)
        }
        Some(probe) => probe.r#final,
        None => {
            let of_peak = name.strip_prefix("probes.").and_then(|name| name.strip_suffix(".max"));
            let estimate = of_peak.and_then(|name| estimates?.get(name)).filter(|estimate| estimate.value > 0.0);
            estimate.map_or_else(|| summary.number(name), |estimate| estimate.value)
        }
    };
    Expectation::hold(name, &expect.unit, value, expect.bound, &expect.source)
}
