//! Doubts about sizes: a mesh in millimetres that is read in metres, loads and motions of another unit than meant.

use std::f64::consts::LOG2_10;

use fractum_math::Vec3;
use fractum_math::elementary::log10;
use fractum_mesh::Mesh;

use crate::case::model::{BodyKind, Case, LoadKind, Motion, SolidBody};
use crate::case::{Diagnostic, Spanned, TimeFunction};
use crate::number::{push_shortest, quantity};

/// Largest extent of a body that is loaded as a specimen is [m]: a mesh beyond it is probably in millimetres.
const LARGE: f64 = 15.0;
/// Smallest extent of a body whose mesh names a unit [m]: a mesh below it is probably in metres.
const SMALL: f64 = 5e-4;
/// Length of the process zone over the extent of its body beyond which the body cannot crack.
const ZONES: f64 = 500.0;
/// Process zone that the reading of the case doubts by itself [m].
const LONGEST_ZONE: f64 = 100.0;
/// Strain at which solids crack, where the material does not tell [-].
const STRAIN: f64 = 1e-4;
/// Bits of the coordinates that the displacement at cracking needs: two of its decimal digits at least.
const BITS: f64 = 10.0;
/// Acceleration that no centrifuge reaches [m/s²].
const ACCELERATION: f64 = 5e3;
/// Pressure below which nothing happens to a solid [Pa].
const PRESSURE: f64 = 10.0;
/// Instants at which loads are looked at.
const LOOKS: u32 = 50;

/// Doubts about the sizes of a case and its mesh, coordinates in metres; none of them keeps the case from running.
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
    doubts.extend(case.loads.iter().flat_map(|load| doubts_of_load(&load.kind, case.solver.end)));
    if doubts.is_empty() && size > 0.0 {
        doubts.extend(doubts_of_motion(case, size));
    }
    doubts
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
pub(super) fn doubt_of_unit(case: &Case, size: f64) -> Option<Diagnostic> {
    let source = case.mesh.as_ref()?;
    let found = format!("= \"{}\": its solids are {} large", source.file.value.display(), quantity(size, "m"));
    let note = Diagnostic::warning(&source.file.place, found);
    if source.unit == 1.0 && size > LARGE && !is_of_the_field(case) {
        let note = note.expected("coordinates in metres, the unit where mesh.unit names no other");
        return Some(note.remedy("if they are in millimetres, set mesh.unit = \"mm\""));
    }
    if source.unit < 1.0 && size > 0.0 && size < SMALL {
        let mut unit = String::new();
        push_shortest(&mut unit, source.unit);
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
    case.flows.gas.is_some()
        || case.in_situ.is_some()
        || case.loads.iter().any(|load| heavy(&load.kind))
        || case.supports.iter().any(|support| support.surface.is_some())
}

/// A mesh so far from the origin that its coordinates have few bits left for displacements.
fn doubt_of_origin(case: &Case, mesh: &Mesh, bodies: &[(&SolidBody, f64)]) -> Option<Diagnostic> {
    let source = case.mesh.as_ref()?;
    let strain = |body: &SolidBody| {
        let material = &case.materials[body.material];
        let damage = material.damage.as_ref();
        damage.map_or(STRAIN, |damage| damage.value.law.tensile_strength / material.young_modulus)
    };
    let strain = bodies.iter().map(|(body, _)| strain(body)).fold(f64::INFINITY, f64::min).min(STRAIN);
    let far = mesh.nodes.iter().map(|x| x.amax()).fold(0.0, f64::max);
    let tetrahedra = mesh.tetrahedra.iter().flat_map(|[a, b, c, d]| [[a, b], [b, c], [c, d]]);
    let triangles = mesh.triangles.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let length = |[a, b]: [&u32; 2]| (mesh.nodes[*b as usize] - mesh.nodes[*a as usize]).norm();
    let shortest = tetrahedra.chain(triangles).map(length).filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
    let bits = LOG2_10 * log10(strain * shortest / (far * f64::EPSILON));
    if bodies.is_empty() || !bits.is_finite() || bits >= BITS {
        return None;
    }
    let found = format!(
        "= \"{}\": coordinates reach {}, which leaves {:.0} bits for the displacement at which an edge of {} cracks",
        source.file.value.display(),
        quantity(far, "m"),
        bits.max(0.0),
        quantity(shortest, "m")
    );
    let note = Diagnostic::warning(&source.file.place, found).expected(format!("{BITS} bits at least"));
    Some(note.remedy("move the origin into the body"))
}

/// A body much smaller than the process zone of its material: it yields as a whole and does not crack.
fn doubt_of_zone(case: &Case, body: &SolidBody, size: f64) -> Option<Diagnostic> {
    let material = &case.materials[body.material];
    let damage = material.damage.as_ref()?;
    let law = &damage.value.law;
    let zone = material.young_modulus * law.fracture_energy / law.tensile_strength.powi(2);
    if size == 0.0 || zone <= ZONES * size || zone > LONGEST_ZONE {
        return None;
    }
    let [zone, size] = [zone, size].map(|length| quantity(length, "m"));
    let found = format!("gives a process zone E Gf/ft^2 of {zone} in a body of {size}");
    let note = Diagnostic::warning(&damage.place, found).expected(format!("a body of more than 1/{ZONES} of the zone"));
    Some(note.remedy("check tensile_strength, fracture_energy and mesh.unit; such a body yields without a crack"))
}

/// Largest absolute value of a function of time alone during the run.
fn largest(function: &TimeFunction, end: f64) -> Option<f64> {
    if function.depends_on_position() {
        return None;
    }
    let at = |look: u32| function.value(end * f64::from(look) / f64::from(LOOKS), Vec3::zeros()).abs();
    Some((0..=LOOKS).map(at).fold(0.0, f64::max))
}

fn doubts_of_load(kind: &LoadKind, end: f64) -> Vec<Diagnostic> {
    let doubt = |function: &Spanned<TimeFunction>| {
        let value = largest(&function.value, end)?;
        let (unit, expected, remedy) = match kind {
            LoadKind::Gravity { .. } if value > ACCELERATION => {
                ("m/s^2", "at most 5000 m/s^2 (the Earth has 9.81)", "did you mean mm/s^2?")
            }
            LoadKind::Pressure { .. } | LoadKind::Traction { .. } if value > 0.0 && value < PRESSURE => {
                ("Pa", "10 Pa at least (the air has 100 kPa)", "did you mean MPa?")
            }
            _ => return None,
        };
        let found = format!("is {} at most during the run", quantity(value, unit));
        Some(Diagnostic::warning(&function.place, found).expected(expected).remedy(remedy))
    };
    kind.functions().into_iter().filter_map(doubt).collect()
}

/// Motions of supports that would tear the body to many times its size.
fn doubts_of_motion(case: &Case, size: f64) -> Vec<Diagnostic> {
    let end = case.solver.end;
    let doubt = |motion: &Spanned<Motion>| {
        let (way, unit) = match &motion.value {
            Motion::Displacement(function) => (largest(function, end)?, "mm"),
            Motion::Velocity(function) => (largest(function, end)? * end, "mm/s"),
            Motion::Fixed => return None,
        };
        if way <= 2.0 * size {
            return None;
        }
        let [way, size] = [way, size].map(|length| quantity(length, "m"));
        let found = format!("moves a body of {size} by {way}");
        let note = Diagnostic::warning(&motion.place, found).expected("a motion smaller than the body");
        Some(note.remedy(format!("did you mean {unit}, or another solver.end?")))
    };
    case.supports.iter().flat_map(|support| support.motion.iter().flatten()).filter_map(doubt).collect()
}
