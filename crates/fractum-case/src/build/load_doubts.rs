//! Doubts about loads in time: too fast for a test, too short for the mesh, never there during the run.

use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_output::number::{percent, quantity, significant};
use fractum_output::warning::Code;

use super::body_doubts::{Own, extent, named, nodes_of, passage, wave_speed};
use crate::measure::Reaction;
use crate::model::{BodyKind, Case, LoadKind, Motion, Probe, ProbeKind, Selection, SolverKind, Support};
use crate::{Diagnostic, Place, Spanned, TimeFunction};

/// Stress of the wave of a motion over the strength, above which a specimen breaks within few passages of a wave.
const FAST: f64 = 0.5;
/// Passages of a wave that a test lasts at least, if inertia is not to show in its reactions.
const PASSAGES: f64 = 10.0;
/// Elements that the front of a pulse passes over at least.
const FRONT: f64 = 3.0;
/// Share of the largest value of a table that is missed if the run ends before it.
const MISSED: f64 = 0.01;
/// Instants at which a motion is looked at.
const LOOKS: u32 = 1000;

/// Doubts about the loads and motions of a stage that begins at an instant [s], after another one.
pub(super) fn doubts_of_loads(
    case: &Case,
    before: Option<&Case>,
    begin: f64,
    mesh: &Mesh,
    bodies: &[Own],
) -> Vec<Diagnostic> {
    let mut doubts: Vec<Diagnostic> = functions(case).into_iter().filter_map(|of| idle(case, of)).collect();
    let acted = before.map_or(Vec::new(), functions);
    let new = functions(case).into_iter().filter(|(place, _)| acted.iter().all(|(other, _)| other != place));
    doubts.extend(new.filter_map(|of| begun(begin, of)));
    // Meshes that a command makes may not be there yet.
    let there = !bodies.is_empty() && bodies.iter().all(|body| !body.nodes.is_empty());
    if case.solver.kind == SolverKind::Explicit && mesh.whole.is_none() && there {
        doubts.extend(hurried(case, begin, mesh, bodies));
        doubts.extend(case.loads.iter().filter_map(|load| short(case, mesh, bodies, &load.kind)));
        doubts.extend(reflected(case, mesh, bodies));
    }
    doubts
}

/// Reactions that are not those of one support: of a whole body, whose supports balance each other, or of a group most of which is free.
pub(super) fn odd_reactions(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    let by_place = case.supports.iter().any(|support| support.on.within.is_some());
    let odd = |group: &Spanned<String>| {
        let nodes = mesh.group_nodes(&group.value);
        // Nodes in common with another body are doubled along interfaces.
        let is_beside = |own: &String| {
            own != &group.value
                && !case.interfaces.is_empty()
                && bodies.iter().any(|body| &body.solid.group.value == own)
        };
        let of_support = |support: &Support| {
            if support.on.group.as_ref().is_some_and(|own| is_beside(&own.value)) {
                return Vec::new();
            }
            let own = support.on.group.as_ref().map(|group| mesh.group_nodes(&group.value)).unwrap_or_default();
            own.into_iter().filter(|node| nodes.binary_search(node).is_ok()).collect::<Vec<u32>>()
        };
        let held: Vec<(&str, Vec<u32>)> =
            case.supports.iter().map(|support| (support.on.label(), of_support(support))).collect();
        let (first, _) = held.iter().find(|(_, nodes)| !nodes.is_empty())?;
        let other = held.iter().find(|(label, nodes)| label != first && !nodes.is_empty());
        let is_body = bodies.iter().any(|body| body.solid.group.value == group.value);
        if let Some((other, _)) = other.filter(|_| is_body) {
            return Some((
                format!("it is the sum of those at \"{first}\" and \"{other}\", which balance each other"),
                "name the group of one support",
            ));
        }
        let mut count: Vec<u32> = held.into_iter().flat_map(|(_, nodes)| nodes).collect();
        count.sort_unstable();
        count.dedup();
        (2 * count.len() < nodes.len()).then(|| {
            let found = format!("{} of its {} nodes are held, and it is theirs alone", count.len(), nodes.len());
            (found, "name the group of the support")
        })
    };
    let doubt = |probe: &Probe| {
        let ProbeKind::Reaction(Reaction { on, .. }) = &probe.kind else { return None };
        let group = on.group.as_ref().filter(|_| on.within.is_none() && !by_place)?;
        let (found, remedy) = odd(group)?;
        let found = format!("= \"{}\" is no support: {found}", group.value);
        Some(Diagnostic::warning(Code::Reaction, &group.place, found).remedy(remedy))
    };
    case.probes.iter().filter_map(doubt).collect()
}

/// Functions of time of loads and motions, where they stand.
fn functions(case: &Case) -> Vec<(&Place, &TimeFunction)> {
    let loads = case.loads.iter().flat_map(|load| load.kind.functions());
    let rigid = case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Rigid(rigid) => Some(rigid.functions()),
        _ => None,
    });
    let heat = case.flows.heat.iter().flat_map(|heat| &heat.conditions).map(|condition| condition.kind.function());
    let spanned = loads.chain(rigid.flatten()).chain(heat).map(|function| (&function.place, &function.value));
    let motions = case.supports.iter().flat_map(|support| support.motion.iter().flatten());
    let motions = motions.filter_map(|motion| match &motion.value {
        Motion::Velocity(function) | Motion::Displacement(function) => Some((&motion.place, function)),
        Motion::Fixed => None,
    });
    spanned.chain(motions).collect()
}

/// A pulse or a table that the run does not see to its end.
fn idle(case: &Case, (place, function): (&Place, &TimeFunction)) -> Option<Diagnostic> {
    let end = case.solver.end;
    if let Some([start, peak]) = function.rise() {
        let instant = quantity(peak, "s");
        let (code, found) = match (start >= end, peak >= end) {
            (true, _) => (Code::NoEffect, format!("begins at t = {}, after the run has ended", quantity(start, "s"))),
            (_, true) => (Code::EndsEarly, format!("is largest at t = {instant}, after the run has ended")),
            _ => return None,
        };
        let note =
            Diagnostic::warning(code, place, found).expected(format!("before solver.end = {}", quantity(end, "s")));
        return Some(note.remedy("choose a later end, or correct the time"));
    }
    let (last, way) = function.rest_of_table(end)?;
    if last <= end * (1.0 + 1e-9) || way <= MISSED {
        return None;
    }
    let [last, end] = [last, end].map(|time| quantity(time, "s"));
    let found = format!("goes on to t = {last}, and the run ends at {end}: {} of its range is missed", percent(way));
    Some(Diagnostic::warning(Code::EndsEarly, place, found).remedy("choose a later end, or a shorter table"))
}

/// A pulse that begins before the stage in which it first acts.
fn begun(begin: f64, (place, function): (&Place, &TimeFunction)) -> Option<Diagnostic> {
    let [start, peak] = function.rise().filter(|[start, _]| *start < begin)?;
    let [now, most] = [begin, peak].map(|time| function.value(time, Vec3::zeros()).abs());
    let (code, found) = match now > 0.0 {
        true => (Code::Jump, format!("where it leaps to {} of its peak", percent(now / most))),
        false => (Code::NoEffect, "and is over by then".to_owned()),
    };
    let [start, begin] = [start, begin].map(|time| quantity(time, "s"));
    let found = format!("begins at t = {start}, before it may act, from {begin} on, {found}");
    Some(Diagnostic::warning(code, place, found).remedy("let it begin there or later: all stages have one clock"))
}

/// The test of a specimen whose reaction is measured, and that is loaded within few passages of a wave.
fn hurried(case: &Case, begin: f64, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let measured = |probe: &Probe| matches!(probe.kind, ProbeKind::Reaction(_));
    let pulses = case.loads.iter().any(|load| load.kind.functions().iter().any(|function| function.value.is_pulse()));
    let thrown = bodies.iter().any(|body| body.solid.initial_velocity.iter().any(Option::is_some));
    let alone = case.bodies.iter().all(|body| matches!(body.kind, BodyKind::Solid(_)));
    if !alone || pulses || thrown || case.flows.gas.is_some() || !case.probes.iter().any(measured) {
        return None;
    }
    let passage = passage(case, mesh, bodies);
    let lasts = (case.solver.end - begin) / passage;
    let mut loads = case.loads.iter().flat_map(|load| load.kind.functions());
    if let Some(load) = loads.find(|function| !function.value.is_zero()).filter(|_| lasts < PASSAGES) {
        let found =
            format!("acts during {} passages of a wave ({} each)", significant(lasts, 2), quantity(passage, "s"));
        let note = Diagnostic::warning(Code::FastLoading, &load.place, found);
        return Some(note.remedy("reactions are those of a blow: let it act longer, or choose kind = \"static\""));
    }
    for motion in case.supports.iter().flat_map(|support| support.motion.iter().flatten()) {
        let Some(speed) = largest_speed(&motion.value, [begin, case.solver.end]).filter(|speed| *speed > 0.0) else {
            continue;
        };
        let remedy = "reactions are those of a blow: load more slowly and longer, or choose kind = \"static\"";
        if lasts < PASSAGES {
            let found =
                format!("moves during {} passages of a wave ({} each)", significant(lasts, 2), quantity(passage, "s"));
            return Some(Diagnostic::warning(Code::FastLoading, &motion.place, found).remedy(remedy));
        }
        // As if the specimen were pulled evenly; where cracks begin it is faster.
        let (low, high) = extent(mesh, bodies);
        let rate = speed / (high - low).norm();
        let share = |body: &Own| {
            let material = &case.materials[body.solid.material];
            let damage = material.damage.as_ref().filter(|_| body.solid.damage)?;
            let stress = speed * material.density * wave_speed(case, body);
            let by_rate = damage.value.rate.as_ref().map_or(1.0, |curves| curves.value.strength_at(rate));
            Some(stress / (by_rate * damage.value.law.tensile_strength))
        };
        let share = bodies.iter().filter_map(share).fold(0.0, f64::max);
        if share > FAST {
            let speed = quantity(speed, "m/s");
            let found = format!("moves at {speed}: the wave of it has {} of the tensile strength", percent(share));
            return Some(Diagnostic::warning(Code::FastLoading, &motion.place, found).remedy(remedy));
        }
    }
    None
}

/// Largest speed of a prescribed motion that is the same everywhere [m/s].
fn largest_speed(motion: &Motion, [begin, end]: [f64; 2]) -> Option<f64> {
    let at = |look: u32| begin + (end - begin) * f64::from(look) / f64::from(LOOKS);
    match motion {
        Motion::Velocity(function) if !function.depends_on_position() => {
            let speed = |look| function.value(at(look), Vec3::zeros()).abs();
            Some((0..=LOOKS).map(speed).fold(0.0, f64::max))
        }
        Motion::Displacement(function) if !function.depends_on_position() => {
            let value = |look| function.value(at(look), Vec3::zeros());
            let step = (end - begin) / f64::from(LOOKS);
            Some((0..LOOKS).map(|look| (value(look + 1) - value(look)).abs() / step).fold(0.0, f64::max))
        }
        _ => None,
    }
}

/// A pulse on facets whose front is shorter than some elements.
fn short(case: &Case, mesh: &Mesh, bodies: &[Own], kind: &LoadKind) -> Option<Diagnostic> {
    let (on, _) = kind.on()?;
    let function = kind.functions().into_iter().find(|function| function.value.is_pulse())?;
    let [start, peak] = function.value.rise()?;
    let loaded = mesh.group_nodes(&on.group.as_ref()?.value);
    let body = bodies.iter().find(|body| loaded.iter().any(|node| body.nodes.binary_search(node).is_ok()))?;
    let size = mean_edge(mesh, on)?;
    let front = (peak - start) * wave_speed(case, body);
    if front >= FRONT * size {
        return None;
    }
    let found = format!(
        "rises within {}, in which a wave travels {}: the elements there have {}",
        quantity(peak - start, "s"),
        quantity(front, "m"),
        quantity(size, "m")
    );
    let note = Diagnostic::warning(Code::ShortPulse, &function.place, found);
    Some(
        note.expected(format!("a front of {FRONT} elements at least")).remedy("refine the mesh, or let it rise longer"),
    )
}

/// Mean length of the edges of the facets of a group [m].
fn mean_edge(mesh: &Mesh, on: &Selection) -> Option<f64> {
    let groups = mesh.group(&on.group.as_ref()?.value);
    let at = |node: u32| mesh.nodes[node as usize];
    let triangles = groups.iter().flat_map(|group| &group.triangles).map(|&facet| mesh.triangles[facet as usize]);
    let edges = triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let edges = edges.chain(groups.iter().flat_map(|group| &group.lines).map(|&line| mesh.lines[line as usize]));
    let (mut sum, mut count) = (0.0, 0usize);
    for [a, b] in edges {
        sum += (at(a) - at(b)).norm();
        count += 1;
    }
    (count > 0).then(|| sum / count as f64)
}

/// A pulse in a body whose outer side is held: its wave comes back.
fn reflected(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    if case.supports.iter().any(|support| support.surface.is_some()) {
        return None;
    }
    let pulse = case.loads.iter().find_map(|load| {
        let pulse = load.kind.functions().into_iter().find(|function| function.value.is_pulse())?;
        Some((load.kind.on()?.0, pulse.value.rise()?[0]))
    });
    let (on, start) = pulse?;
    let loaded = nodes_of(mesh, on)?;
    let axes = if bodies.iter().all(|body| body.plane) { 0..2 } else { 0..3 };
    let held = case.supports.iter().find(|support| {
        let fixed =
            |axis: usize| matches!(&support.motion[axis], Some(motion) if matches!(motion.value, Motion::Fixed));
        axes.clone().all(fixed)
    })?;
    let (name, place, held) = (named(&held.on), held.on.place()?, nodes_of(mesh, &held.on)?);
    let middle = loaded.iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / loaded.len().max(1) as f64;
    let away = held.iter().map(|&node| (mesh.nodes[node as usize] - middle).norm()).fold(f64::INFINITY, f64::min);
    let fastest = bodies.iter().map(|body| wave_speed(case, body)).fold(0.0, f64::max);
    let back = start + 2.0 * away / fastest;
    if back >= case.solver.end || held.len() < 3 {
        return None;
    }
    let found = format!("{name}: it is held, and sends back the wave of the pulse from t = {}", quantity(back, "s"));
    let note = Diagnostic::warning(Code::Reflections, place, found);
    Some(note.remedy("let waves leave there by absorbing = true, unless the body ends there"))
}
