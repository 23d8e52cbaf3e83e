//! Particles that come into the run as time goes on: what they cannot be part of, and rates that are too high for their inlet.

use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_output::warning::Code;

use super::Context;
use crate::model::{Body, BodyKind, Case, LoadKind, LooseBody, LooseSource, Rate, Region, SolverKind, Stream};
use crate::{Diagnostic, Place, Spanned};

/// Solid fraction of the stream that leaves an inlet which is asked for more than it can let in: 0.30 to 0.37 were found for boxes from
/// rest to 3 m/s.
const REACH: f64 = 0.3;

/// Bodies whose particles come in through an inlet, with its stream and the place of its rate.
fn streams(case: &Case) -> impl Iterator<Item = (&Body, &LooseBody, &Stream, &Place)> {
    case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Particles(own) => match &own.source {
            LooseSource::Inlet { stream, rate, .. } => Some((body, own, stream, rate)),
            _ => None,
        },
        _ => None,
    })
}

/// Refuses inlets beside what knows no particles that come later.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    for (body, ..) in streams(case) {
        let place = &body.name.place;
        if case.solver.kind != SolverKind::Explicit {
            let found = format!("= \"{}\": its particles come in as time goes on", body.name.value);
            context.error(place, found, "solver.kind = \"explicit\" beside an inlet");
        }
        let supports = case.supports.iter().filter_map(|support| support.on.group.as_ref());
        let loads = case.loads.iter().filter_map(|load| load.kind.on()?.0.group.as_ref());
        let of_body = |group: &&Spanned<String>| {
            case.particle_group(&group.value).is_some_and(|(own, _)| case.bodies[own].name.value == body.name.value)
        };
        for group in supports.chain(loads).filter(of_body) {
            let found = format!("= \"{}\": its particles come in through an inlet, and are free", group.value);
            context.error(&group.place, found, "gravity, or a body whose particles are there from the start");
        }
    }
}

/// Rates that an inlet cannot let in.
pub(super) fn doubts(case: &Case) -> Vec<Diagnostic> {
    let doubt = |(_, body, stream, place): (&Body, &LooseBody, &Stream, &Place)| {
        let density = case.materials[body.material].density;
        let (asked, volume) = (stream.volume_rate(density), stream.region.volume());
        let in_words = |volume_rate: f64| match stream.rate {
            Rate::Mass(_) => quantity(volume_rate * density, "kg/s"),
            Rate::Number(_) => quantity(volume_rate / stream.sizes.mean_volume(), "1/s"),
        };
        let warning = |found: String| Diagnostic::warning(Code::InletRate, place, found);
        let Some(crossing) = crossing_time(case, body, stream) else {
            let all = stream.count(density) * stream.sizes.mean_volume();
            let found = "fills an inlet out of which nothing moves its particles".to_owned();
            let remedy = "give the body an initial_velocity, or the scene gravity ([[loads]])";
            return (all > REACH * volume).then(|| warning(found).remedy(remedy));
        };
        let most = REACH * volume / crossing;
        let found = format!("= {}: the inlet has room for about {}", in_words(asked), in_words(most));
        let remedy =
            "a lower rate, a larger or deeper inlet, or a faster initial_velocity; particles without a place wait";
        (asked > most).then(|| warning(found).remedy(remedy))
    };
    streams(case).filter_map(doubt).collect()
}

/// Time in which particles cross the inlet by their velocity and by gravity [s]; none where neither is there.
fn crossing_time(case: &Case, body: &LooseBody, stream: &Stream) -> Option<f64> {
    let middle = match stream.region {
        Region::Box { point, size } | Region::Rectangle { point, size } => point + 0.5 * size,
        Region::Cylinder { point, axis, length, .. } => point + axis * (0.5 * length),
        Region::Sphere { point, .. } | Region::Circle { point, .. } => point,
    };
    let velocity =
        Vec3::from_fn(|axis, _| body.initial_velocity[axis].as_ref().map_or(0.0, |field| field.value.at(middle)));
    let mut gravity = Vec3::zeros();
    for load in &case.loads {
        if let LoadKind::Gravity { acceleration } = &load.kind {
            for (axis, value) in acceleration.iter().enumerate() {
                gravity[axis] += value.as_ref().map_or(0.0, |value| value.value.value(stream.from, middle));
            }
        }
    }
    let along = velocity.try_normalize(0.0).or_else(|| gravity.try_normalize(0.0))?;
    let (way, speed, pull) = (extent(&stream.region, &along), velocity.dot(&along), gravity.dot(&along));
    let square = speed * speed + 2.0 * pull * way;
    if square > 0.0 {
        // The first root of way = speed t + pull t²/2.
        return Some(2.0 * way / (speed + square.sqrt()));
    }
    // It turns within the inlet, and falls out of it again.
    Some((speed + (speed * speed - 2.0 * pull * way).sqrt()) / -pull)
}

/// Extent of a region along a direction [m].
fn extent(region: &Region, along: &Vec3) -> f64 {
    match region {
        Region::Box { size, .. } | Region::Rectangle { size, .. } => size.dot(&along.abs()),
        Region::Cylinder { axis, length, radius, .. } => {
            let cosine = axis.dot(along).abs().min(1.0);
            length * cosine + 2.0 * radius * (1.0 - cosine * cosine).sqrt()
        }
        Region::Sphere { radius, .. } | Region::Circle { radius, .. } => 2.0 * radius,
    }
}
