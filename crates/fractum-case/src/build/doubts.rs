//! Doubts about sizes: a mesh in millimetres that is read in metres, loads and motions of another unit than meant.

use std::collections::HashSet;
use std::f64::consts::LOG2_10;
use std::{iter, mem};

use fractum_math::Vec3;
use fractum_math::elementary::log10;
use fractum_mesh::Mesh;
use fractum_output::number::{push_shortest, quantity};
use fractum_output::warning::Code;

use super::model_doubts::doubts_of_model;
use crate::model::{Body, BodyKind, Case, LoadKind, Motion, SolidBody};
use crate::{Diagnostic, LONGEST_ZONE, Spanned, TimeFunction};

/// Largest extent of a body that is loaded as a specimen is [m]: a mesh beyond it is probably in millimetres.
const LARGE: f64 = 15.0;
/// Smallest extent of a body whose mesh names a unit [m]: a mesh below it is probably in metres.
const SMALL: f64 = 5e-4;
/// Length of the process zone over the extent of its body beyond which the body cannot crack.
pub(super) const ZONES: f64 = 500.0;
/// Strain at which solids crack, where the material does not tell [-].
const STRAIN: f64 = 1e-4;
/// Bits of the coordinates that the displacement at cracking needs: two of its decimal digits at least.
const BITS: f64 = 10.0;
/// Acceleration that no centrifuge reaches [m/s²].
const ACCELERATION: f64 = 5e3;
/// Pressure below which nothing happens to a solid [Pa]; and the same over Young's modulus.
const PRESSURE: f64 = 10.0;
const SQUEEZE: f64 = 1e-9;
/// Peak of a pulse below which nothing happens to a solid [Pa].
const PULSE: f64 = 1e3;
/// Instants at which expressions of time are looked at.
const LOOKS: u32 = 1000;

/// Doubts about the sizes of a case with all of its stages and about its mesh, coordinates in metres; none of them keeps the
/// case from running.
pub fn doubts(case: &Case, mesh: &Mesh) -> Vec<Diagnostic> {
    let bodies: Vec<(&SolidBody, f64)> = case
        .bodies
        .iter()
        .filter_map(|body| match &body.kind {
            BodyKind::Solid(solid) => Some((solid, extent(mesh, &mesh.group_nodes(&solid.group.value)))),
            _ => None,
        })
        .collect();
    let size = bodies.iter().map(|(_, size)| *size).fold(0.0, f64::max);
    let mut doubts: Vec<Diagnostic> = doubt_of_unit(case, size).into_iter().collect();
    doubts.extend(doubt_of_origin(case, mesh, &bodies));
    doubts.extend(bodies.iter().filter_map(|(body, size)| doubt_of_zone(case, body, *size)));
    let of_load = |(stage, during): (&Case, [f64; 2])| {
        let loads = stage.loads.iter();
        let modulus = softest(stage).unwrap_or(0.0);
        loads.flat_map(|load| doubts_of_load(&load.kind, during, modulus)).collect::<Vec<_>>()
    };
    doubts.extend(first_at_each_place(stages(case).flat_map(of_load)));
    if doubts.is_empty() && size > 0.0 {
        doubts.extend(first_at_each_place(
            stages(case).flat_map(|(stage, during)| doubts_of_motion(stage, during, size)),
        ));
    }
    doubts.extend(doubts_of_model(case, mesh));
    doubts
}

/// The stages of a case, each with its begin and its end [s].
fn stages(case: &Case) -> impl Iterator<Item = (&Case, [f64; 2])> {
    let mut begin = 0.0;
    iter::once(case).chain(&case.later).map(move |stage| {
        let end = stage.solver.end;
        (stage, [mem::replace(&mut begin, end), end])
    })
}

/// What acts in several stages is doubted once.
fn first_at_each_place(doubts: impl Iterator<Item = Diagnostic>) -> Vec<Diagnostic> {
    let mut places = HashSet::new();
    doubts.filter(|doubt| places.insert(doubt.place.clone())).collect()
}

/// The largest side of the box around nodes [m].
fn extent(mesh: &Mesh, nodes: &[u32]) -> f64 {
    let at = |node: &u32| mesh.nodes[*node as usize];
    let Some(first) = nodes.first().map(at) else { return 0.0 };
    let (low, high) = nodes.iter().map(at).fold((first, first), |(low, high), x| (low.inf(&x), high.sup(&x)));
    (high - low).max()
}

/// A mesh whose solids are as large, or as small, as if its unit were another one.
///
/// - `size`: largest extent of a solid [m]
fn doubt_of_unit(case: &Case, size: f64) -> Option<Diagnostic> {
    let source = case.mesh.as_ref()?;
    let found = format!("= \"{}\": its solids are {} large", source.file.value.display(), quantity(size, "m"));
    let note = Diagnostic::warning(Code::UnitOfLength, &source.file.place, found);
    if !source.unit.is_named && source.unit.length == 1.0 && size > LARGE && !is_of_the_field(case) {
        let note = note.expected("coordinates in metres, the unit where mesh.unit names no other");
        return Some(note.remedy("if they are in millimetres, set mesh.unit = \"mm\""));
    }
    if source.unit.length < 1.0 && size > 0.0 && size < SMALL {
        let mut unit = String::new();
        push_shortest(&mut unit, source.unit.length);
        let note = note.expected(format!("coordinates in the unit of mesh.unit, which is {unit} m"));
        return Some(note.remedy("if they are in metres, leave mesh.unit out"));
    }
    None
}

/// Whether a case is of rock or of a structure in the open: such bodies may be large.
fn is_of_the_field(case: &Case) -> bool {
    let heavy = |kind: &LoadKind| match kind {
        LoadKind::Gravity { .. } => true,
        LoadKind::Pressure { pressure, .. } => pressure.value.is_pulse() || pressure.value.delay().is_some(),
        _ => false,
    };
    let of_stage = |stage: &Case| {
        let loads = stage.loads.iter().any(|load| heavy(&load.kind));
        loads || stage.supports.iter().any(|support| support.surface.is_some())
    };
    case.flows.gas.is_some()
        || case.flows.liquid.is_some()
        || case.in_situ.is_some()
        || stages(case).any(|(stage, _)| of_stage(stage))
}

/// Solids so far from the origin that their coordinates have few bits left for displacements.
fn doubt_of_origin(case: &Case, mesh: &Mesh, bodies: &[(&SolidBody, f64)]) -> Option<Diagnostic> {
    let source = case.mesh.as_ref()?;
    let strain = |body: &SolidBody| {
        let material = &case.materials[body.material];
        let damage = material.damage.as_ref();
        damage.map_or(STRAIN, |damage| damage.value.law.tensile_strength / material.young_modulus)
    };
    let strain = bodies.iter().map(|(body, _)| strain(body)).fold(f64::INFINITY, f64::min).min(STRAIN);
    let groups = || bodies.iter().flat_map(|(body, _)| mesh.group(&body.group.value));
    let tetrahedra = groups().flat_map(|group| &group.tetrahedra).map(|&element| mesh.tetrahedra[element as usize]);
    let triangles = groups().flat_map(|group| &group.triangles).map(|&element| mesh.triangles[element as usize]);
    let edges = tetrahedra.flat_map(|[a, b, c, d]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]]);
    let edges = edges.chain(triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]));
    let (mut far, mut shortest) = (0.0, f64::INFINITY);
    for [a, b] in edges.map(|edge| edge.map(|node| mesh.nodes[node as usize])) {
        far = a.amax().max(b.amax()).max(far);
        let length = (b - a).norm();
        if length > 0.0 {
            shortest = length.min(shortest);
        }
    }
    let bits = LOG2_10 * log10(strain * shortest / (far * f64::EPSILON));
    if !bits.is_finite() || bits >= BITS {
        return None;
    }
    let found = format!(
        "= \"{}\": coordinates reach {}, which leaves {:.0} bits for the displacement at which an edge of {} cracks",
        source.file.value.display(),
        quantity(far, "m"),
        bits.max(0.0),
        quantity(shortest, "m")
    );
    let note =
        Diagnostic::warning(Code::FarFromOrigin, &source.file.place, found).expected(format!("{BITS} bits at least"));
    Some(note.remedy("move the origin into the body"))
}

/// A body much smaller than the process zone of its material: it yields as a whole and does not crack.
fn doubt_of_zone(case: &Case, body: &SolidBody, size: f64) -> Option<Diagnostic> {
    let material = &case.materials[body.material];
    let damage = material.damage.as_ref()?;
    let zone = material.process_zone()?;
    if size == 0.0 || zone <= ZONES * size || zone > LONGEST_ZONE {
        return None;
    }
    let [zone, size] = [zone, size].map(|length| quantity(length, "m"));
    let found = format!("gives a process zone E Gf/ft^2 of {zone} in a body of {size}");
    let note = Diagnostic::warning(Code::ProcessZone, &damage.place, found)
        .expected(format!("a body of more than 1/{ZONES} of the zone"));
    Some(note.remedy("check tensile_strength, fracture_energy and mesh.unit; such a body yields without a crack"))
}

/// A function of time alone between two instants: times [s] with values, which straight lines join. Nothing of pulses: they
/// may be as short as they like.
fn course(function: &TimeFunction, [begin, end]: [f64; 2]) -> Option<Vec<(f64, f64)>> {
    if function.depends_on_position() || function.is_pulse() || function.delay().is_some() {
        return None;
    }
    let mut times = vec![begin, end];
    match function {
        TimeFunction::Ramp(points) | TimeFunction::SmoothRamp(points) => {
            let during = points.iter().map(|(time, _)| *time).filter(|time| begin < *time && *time < end);
            times.splice(1..1, during);
        }
        TimeFunction::Expression(field) if field.depends_on_time() => {
            let between = (1..LOOKS).map(|look| begin + (end - begin) * f64::from(look) / f64::from(LOOKS));
            times.splice(1..1, between);
        }
        _ => {}
    }
    Some(times.into_iter().map(|time| (time, function.value(time, Vec3::zeros()))).collect())
}

/// Largest absolute value of a course.
fn largest(course: &[(f64, f64)]) -> f64 {
    course.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max)
}

/// Largest distance from the start [m] on a course of velocities [m/s].
fn farthest(course: &[(f64, f64)]) -> f64 {
    let mut way = 0.0;
    let steps = course.windows(2).map(|pair| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1));
    steps.fold(0.0, |farthest, step| {
        way += step;
        f64::max(farthest, way.abs())
    })
}

/// Smallest Young's modulus of the solids [Pa].
fn softest(case: &Case) -> Option<f64> {
    let modulus = |body: &Body| match &body.kind {
        BodyKind::Solid(solid) => Some(case.materials[solid.material].young_modulus),
        _ => None,
    };
    case.bodies.iter().filter_map(modulus).reduce(f64::min)
}

/// - `modulus`: smallest Young's modulus of the solids [Pa]
fn doubts_of_load(kind: &LoadKind, during: [f64; 2], modulus: f64) -> Vec<Diagnostic> {
    let doubt = |function: &Spanned<TimeFunction>| {
        let pulse = function.value.rise().map(|[_, at]| function.value.value(at, Vec3::zeros()).abs());
        let value = pulse.map_or_else(|| course(&function.value, during).map(|own| largest(&own)), Some)?;
        let least = if pulse.is_some() { PULSE } else { PRESSURE.max(SQUEEZE * modulus) };
        // An expression may be larger between the instants at which it is looked at.
        let is_bound = !matches!(&function.value, TimeFunction::Expression(field) if field.depends_on_time());
        let (unit, expected, remedy) = match kind {
            LoadKind::Gravity { .. } if value > ACCELERATION => {
                ("m/s^2", "at most 5000 m/s^2 (the Earth has 9.81)".to_owned(), "did you mean mm/s^2?")
            }
            LoadKind::Pressure { .. } | LoadKind::Traction { .. } if is_bound && value > 0.0 && value < least => (
                "Pa",
                if pulse.is_some() {
                    "1 kPa at least (windows break at some)".to_owned()
                } else {
                    format!("{} at least (the air has 100 kPa)", quantity(least, "Pa"))
                },
                "did you mean MPa?",
            ),
            _ => return None,
        };
        let found = format!("is {} at most during the run", quantity(value, unit));
        Some(Diagnostic::warning(Code::UnitOfLoad, &function.place, found).expected(expected).remedy(remedy))
    };
    kind.functions().into_iter().filter_map(doubt).collect()
}

/// Motions of supports that would tear the body to many times its size.
fn doubts_of_motion(case: &Case, during: [f64; 2], size: f64) -> Vec<Diagnostic> {
    let doubt = |motion: &Spanned<Motion>| {
        let (way, unit) = match &motion.value {
            Motion::Displacement(function) => (largest(&course(function, during)?), "mm"),
            Motion::Velocity(function) => (farthest(&course(function, during)?), "mm/s"),
            Motion::Fixed => return None,
        };
        if way <= 2.0 * size {
            return None;
        }
        let [way, size] = [way, size].map(|length| quantity(length, "m"));
        let found = format!("moves a body of {size} by {way}");
        let note =
            Diagnostic::warning(Code::UnitOfMotion, &motion.place, found).expected("a motion smaller than the body");
        Some(note.remedy(format!("did you mean {unit}, or another solver.end?")))
    };
    case.supports.iter().flat_map(|support| support.motion.iter().flatten()).filter_map(doubt).collect()
}
