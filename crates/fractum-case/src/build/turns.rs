//! Instants at which what drives a run turns, or goes on at another rate: a step of equilibrium ends there.

use fractum_math::Vec3;

use super::Context;
use crate::TimeFunction;
use crate::model::{BodyKind, Motion};

/// Positions at which loads and motions are looked at.
const POSITIONS: usize = 20;
/// Intervals of the run at whose ends functions without a table are looked at.
const LOOKS: usize = 1000;
/// Halvings of such an interval.
const HALVINGS: usize = 60;
/// Intervals where the size of a change counts alone.
const FEW_LOOKS: usize = 50;

/// What drives a run.
enum Drive<'a> {
    /// A function of time.
    Value(&'a TimeFunction),
    /// One that is the rate of what drives.
    Rate(&'a TimeFunction),
}

/// Instants within the run at which a load, motion or flow turns or has a kink, ascending [s]; its begin too where liquid comes into interfaces, whose pressure is highest there.
pub(super) fn turns(context: &Context<'_>) -> Vec<f64> {
    let [begin, end] = times(context);
    let positions = positions(context);
    let flows = &context.case.flows;
    let heat = flows.heat.iter().flat_map(|heat| &heat.conditions).map(|condition| &condition.kind.function().value);
    let liquid = flows.liquid.iter().flat_map(|liquid| liquid.drives()).map(|(drive, _)| &drive.value.value);
    let mut found = Vec::new();
    for drive in drives(context).into_iter().chain(heat.chain(liquid).map(Drive::Value)) {
        let (Drive::Value(function) | Drive::Rate(function)) = drive;
        kinks(function, &mut found);
        if !function.depends_on_time() {
            continue;
        }
        let position = widest(function, [begin, end], &positions);
        match drive {
            Drive::Rate(_) => signs(|t| function.value(t, position), [begin, end], &mut found),
            Drive::Value(_) if has_table(function) => {}
            Drive::Value(_) => extremes(|t| function.value(t, position), [begin, end], &mut found),
        }
    }
    let same = 1e-9 * (end - begin);
    found.retain(|time| *time > begin + same && *time < end - same);
    found.extend(flows.liquid.iter().filter(|_| !context.case.interfaces.is_empty()).map(|_| begin));
    found.sort_by(f64::total_cmp);
    found.dedup_by(|next, before| *next - *before <= same);
    found
}

/// The position at which a function changes most: a load that travels turns everywhere at another instant.
fn widest(function: &TimeFunction, [begin, end]: [f64; 2], positions: &[Vec3]) -> Vec3 {
    let range = |position: &Vec3| {
        let at = |look: usize| function.value(begin + (end - begin) * (look as f64 / FEW_LOOKS as f64), *position);
        let [low, high] = (0..=FEW_LOOKS)
            .map(at)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        high - low
    };
    let all = positions.iter().filter(|_| function.depends_on_position());
    all.max_by(|a, b| range(a).total_cmp(&range(b))).copied().unwrap_or_default()
}

/// Whether a load or a motion goes back before the end, so that the state there is not the farthest one.
pub(super) fn turns_back(context: &Context<'_>) -> bool {
    let positions = positions(context);
    drives(context).iter().any(|drive| match drive {
        Drive::Value(function) => function.turns(times(context), &positions),
        Drive::Rate(function) => function.changes_sign(times(context), &positions),
    })
}

fn times(context: &Context<'_>) -> [f64; 2] {
    [context.case.solver.begin, context.case.solver.end]
}

fn positions(context: &Context<'_>) -> Vec<Vec3> {
    let nodes = &context.mesh.nodes;
    nodes.iter().step_by(nodes.len().div_ceil(POSITIONS).max(1)).copied().collect()
}

/// Motions, loads, pressures in interfaces and velocities of rigid bodies.
fn drives<'a>(context: &Context<'a>) -> Vec<Drive<'a>> {
    let case = context.case;
    let motions = case.supports.iter().flat_map(|support| support.motion.iter().flatten());
    let motions = motions.filter_map(|motion| match &motion.value {
        Motion::Displacement(function) => Some(Drive::Value(function)),
        Motion::Velocity(function) => Some(Drive::Rate(function)),
        Motion::Fixed => None,
    });
    let loads = case.loads.iter().flat_map(|load| load.kind.functions()).map(|function| Drive::Value(&function.value));
    let pressures = case.interfaces.iter().filter_map(|interface| interface.pressure.as_ref());
    let rigid = case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Rigid(rigid) => Some(rigid.functions().map(|function| Drive::Rate(&function.value))),
        _ => None,
    });
    motions
        .chain(loads)
        .chain(pressures.map(|(function, _)| Drive::Value(&function.value)))
        .chain(rigid.flatten())
        .collect()
}

/// Instants at which the function of a table or a pulse has no smooth course [s].
fn kinks(function: &TimeFunction, found: &mut Vec<f64>) {
    match function {
        TimeFunction::Constant(_) | TimeFunction::Expression(_) => {}
        TimeFunction::Ramp(points) => {
            let slope = |[from, to]: [(f64, f64); 2]| (to.1 - from.1) / (to.0 - from.0);
            let slopes = |i: usize| match (i.checked_sub(1), points.get(i + 1)) {
                (Some(before), Some(next)) => [slope([points[before], points[i]]), slope([points[i], *next])],
                (None, Some(next)) => [0.0, slope([points[i], *next])],
                (Some(before), None) => [slope([points[before], points[i]]), 0.0],
                (None, None) => [0.0; 2],
            };
            let bends = |[before, after]: [f64; 2]| (after - before).abs() > 1e-9 * before.abs().max(after.abs());
            found.extend((0..points.len()).filter(|&i| bends(slopes(i))).map(|i| points[i].0));
        }
        TimeFunction::SmoothRamp(points) => found.extend(points.iter().map(|(time, _)| *time)),
        TimeFunction::Triangle { start, duration, rise, .. } => found.extend([*start, start + rise, start + duration]),
        TimeFunction::HalfSine { start, duration, .. } => {
            found.extend([*start, start + 0.5 * duration, start + duration]);
        }
        TimeFunction::DoubleExponential { .. } | TimeFunction::LinearExponential { .. } => {
            found.extend(function.rise().into_iter().flatten());
        }
        TimeFunction::Delayed(delay, function) => {
            let begin = found.len();
            kinks(function, found);
            found[begin..].iter_mut().for_each(|time| *time += delay);
        }
    }
}

/// Whether [`kinks`] finds every instant at which a function turns.
fn has_table(function: &TimeFunction) -> bool {
    match function {
        TimeFunction::Expression(_) => false,
        TimeFunction::Delayed(_, function) => has_table(function),
        _ => true,
    }
}

/// Instants at which a value is largest or smallest [s].
fn extremes(value: impl Fn(f64) -> f64, [begin, end]: [f64; 2], found: &mut Vec<f64>) {
    let at = |look: usize| begin + (end - begin) * (look as f64 / LOOKS as f64);
    for look in 1..LOOKS {
        let (mut low, mut high) = (at(look - 1), at(look + 1));
        let [before, here, after] = [low, at(look), high].map(&value);
        let sign = if here > before { 1.0 } else { -1.0 };
        if sign * (here - before) <= 0.0 || sign * (here - after) < 0.0 {
            continue;
        }
        for _ in 0..HALVINGS {
            let third = (high - low) / 3.0;
            if sign * (value(high - third) - value(low + third)) > 0.0 { low += third } else { high -= third }
        }
        found.push(0.5 * (low + high));
    }
}

/// Instants at which a rate has another sign than before [s].
fn signs(rate: impl Fn(f64) -> f64, [begin, end]: [f64; 2], found: &mut Vec<f64>) {
    let at = |look: usize| begin + (end - begin) * (look as f64 / LOOKS as f64);
    for look in 0..LOOKS {
        let (mut low, mut high) = (at(look), at(look + 1));
        let sign = rate(low);
        if (sign == 0.0) == (rate(high) == 0.0) && sign * rate(high) >= 0.0 {
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if rate(middle) * sign > 0.0 || (sign == 0.0 && rate(middle) == 0.0) { low = middle } else { high = middle }
        }
        found.push(high);
    }
}
