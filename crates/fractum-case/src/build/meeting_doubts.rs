//! Doubts about how bodies meet: nodes in the same places, solids within each other, tools that touch nothing, damping without effect.

use std::collections::{BTreeMap, HashSet};

use fractum_math::Vec3;
use fractum_mesh::{Coincident, Mesh, coincident_nodes};
use fractum_output::number::{percent, quantity};
use fractum_output::warning::Code;
use fractum_scene::ContactParameters;

use super::body_doubts::{Own, extent, pieces};
use crate::model::{Body, BodyKind, Case, Motion, RigidBody, RigidShape, SolverKind, Support};
use crate::{Diagnostic, Place};

/// Instants at which the motion of a tool is looked at.
const LOOKS: u32 = 1000;
/// Distance of two bodies over the size of the smaller one up to which they lie beside each other.
const BESIDE: f64 = 0.02;

/// Spheres that could meet plane solids, and solids about an axis that could meet each other: they pass through each other.
pub(super) fn meetings(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    if case.solver.kind != SolverKind::Explicit || !bodies.iter().any(|body| body.plane) {
        return None;
    }
    // Meshes that a command makes may not be there yet.
    if bodies.iter().any(|body| body.nodes.is_empty()) {
        return None;
    }
    let particles = |body: &&Body| matches!(body.kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
    if let Some(Body { name, .. }) = case.bodies.iter().find(particles).filter(|_| !case.has_discs()) {
        let found = format!(
            "= \"{}\": plane solids touch no spheres, and it passes through \"{}\"",
            name.value, bodies[0].name.value
        );
        let note = Diagnostic::warning(Code::NoContact, &name.place, found);
        return Some(note.remedy("set thickness on loose particles, which makes discs of them; or make the solid rigid, or model it in space"));
    }
    if !bodies.iter().any(|body| body.solid.is_axisymmetric()) {
        return None;
    }
    let pieces = pieces(mesh, bodies);
    let other = pieces.iter().position(|piece| *piece != 0)?;
    let [first, second] = [&bodies[0], &bodies[other]].map(|body| &body.name.value);
    let found =
        format!("= \"{second}\": it has no nodes in common with \"{first}\", and solids about an axis do not touch");
    let note = Diagnostic::warning(Code::NoContact, &bodies[other].name.place, found);
    Some(
        note.remedy(
            "they pass through each other where they meet: mesh both with common nodes, or make one of them rigid",
        ),
    )
}

/// Solids at rest that lie beside each other without anything in common: nothing touches there.
///
/// - `is_gone`: those that are not there
pub(super) fn beside_at_rest(
    case: &Case,
    mesh: &Mesh,
    bodies: &[Own],
    is_gone: impl Fn(&Own) -> bool,
) -> Option<Diagnostic> {
    let rests = matches!(case.solver.kind, SolverKind::Static | SolverKind::Auto);
    // Meshes that a command makes may not be there yet.
    if !rests || bodies.iter().any(|body| body.nodes.is_empty()) {
        return None;
    }
    let pieces = pieces(mesh, bodies);
    let boxes: Vec<(Vec3, Vec3)> = bodies.iter().map(|body| extent(mesh, std::slice::from_ref(body))).collect();
    let is_beside = |a: usize, b: usize| {
        let [(low, high), (from, to)] = [boxes[a], boxes[b]];
        let apart = (from - high).sup(&(low - to)).max();
        pieces[a] != pieces[b] && apart <= BESIDE * (high - low).max().min((to - from).max())
    };
    let pairs = (0..bodies.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
    let (first, second) =
        pairs.filter(|(a, b)| ![a, b].iter().any(|own| is_gone(&bodies[**own]))).find(|(a, b)| is_beside(*a, *b))?;
    let found = format!(
        "= \"{}\": it has no nodes in common with \"{}\" beside it, and solids do not touch each other at rest",
        bodies[second].name.value, bodies[first].name.value
    );
    let note = Diagnostic::warning(Code::NoContact, &bodies[second].name.place, found);
    Some(note.remedy(
        "they pass through each other where they meet: mesh both with common nodes, make one of them rigid, or let them move (kind = \"explicit\")",
    ))
}

/// Bodies whose nodes lie in the same places without being the same, where nothing makes them touch.
pub(super) fn coincident(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    if bodies.len() < 2 {
        return Vec::new();
    }
    let touches = case.solver.kind == SolverKind::Explicit && !bodies.iter().any(|body| body.solid.is_axisymmetric());
    // Who says how bodies touch means that they do.
    let says_how = |body: &Own| body.solid.surface(&case.materials) != ContactParameters::default();
    let sets: Vec<&[u32]> = bodies.iter().map(|body| body.nodes.as_slice()).collect();
    let mut pairs = BTreeMap::<[usize; 2], (usize, u32)>::new();
    let cut: HashSet<u32> = mesh.cuts.iter().flat_map(|face| face.sides.concat()).collect();
    for Coincident { bodies, nodes: [node, twin] } in coincident_nodes(mesh, &sets) {
        if cut.contains(&node) && cut.contains(&twin) {
            continue;
        }
        pairs.entry(bodies).or_insert((0, node)).0 += 1;
    }
    let doubt = |(pair, (count, node)): ([usize; 2], (usize, u32))| {
        let [first, second] = pair.map(|index| &bodies[index]);
        let is_pair = case.contact_pairs.iter().any(|pair| pair.is_of(first.solid.material, second.solid.material));
        if touches && (says_how(first) || says_how(second) || is_pair) {
            return None;
        }
        let so = if touches { "they touch there, and are not joined" } else { "nothing joins them" };
        let at = mesh.nodes[node as usize];
        let at = [at.x, at.y, at.z].map(|x| quantity(x, "m")).join(", ");
        let found = format!(
            "= \"{}\": {count} of its nodes lie on nodes of \"{}\", such as that at ({at}): {so}",
            second.name.value, first.name.value
        );
        let note = Diagnostic::warning(Code::CoincidentNodes, &second.name.place, found);
        let is_joined = |body: &Own| {
            let join = case.mesh.as_ref().and_then(|mesh| mesh.join.as_ref());
            join.is_some_and(|join| join.value.iter().any(|solid| solid.body == body.name.value))
        };
        let joined = if is_joined(first) && is_joined(second) {
            "mesh.join leaves them, as no face has all of its nodes in common: mesh both sides alike"
        } else {
            "set mesh.join = true, or mesh both with common nodes"
        };
        let contact = if touches { "; if they only touch, say so by contact in a material" } else { "" };
        Some(note.remedy(format!("{joined}{contact}")))
    };
    pairs.into_iter().filter_map(doubt).collect()
}

/// Solids that lie within each other: their mass and stiffness are counted twice there.
///
/// - `is_gone`: those that are not there
pub(super) fn overlapping(mesh: &Mesh, bodies: &[Own], is_gone: impl Fn(&Own) -> bool) -> Vec<Diagnostic> {
    let boxes: Vec<(Vec3, Vec3)> = bodies.iter().map(|body| extent(mesh, std::slice::from_ref(body))).collect();
    let axes = if bodies.iter().all(|body| body.plane) { 0..2 } else { 0..3 };
    let apart = |a: usize, b: usize| {
        let [(low, high), (from, to)] = [boxes[a], boxes[b]];
        axes.clone().any(|axis| high[axis] <= from[axis] || to[axis] <= low[axis])
    };
    let mut doubts = Vec::new();
    for (index, second) in bodies.iter().enumerate().filter(|(_, own)| !is_gone(own)) {
        let others = bodies[..index].iter().enumerate().filter(|(_, own)| !is_gone(own));
        for (_, first) in others.filter(|(before, _)| !apart(*before, index)) {
            // A body of few large elements may hold none of the middles of the other.
            let shares = [(second, first), (first, second)]
                .map(|(own, other)| own.elements(mesh).share_within(&mesh.nodes, &other.elements(mesh)));
            let Some((share, of)) = shares.into_iter().zip([second, first]).find(|(share, _)| *share > 0.0) else {
                continue;
            };
            let other = if std::ptr::eq(of, second) { first } else { second };
            let found = format!(
                "= \"{}\": {} of its elements lie within \"{}\", and are counted twice",
                of.name.value,
                percent(share),
                other.name.value
            );
            let note = Diagnostic::warning(Code::InitialOverlap, &of.name.place, found);
            doubts.push(note.remedy("cut one of them out of the other (Boolean difference, or fragments, in Gmsh)"));
        }
    }
    doubts
}

/// Tools that are moved, and meet nothing on their way.
pub(super) fn missing(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    let rests = |body: &Own| body.solid.initial_velocity.iter().all(Option::is_none);
    let known = case.bodies.iter().all(|body| matches!(body.kind, BodyKind::Solid(_) | BodyKind::Rigid(_)));
    let moved =
        |support: &Support| support.motion.iter().flatten().any(|motion| !matches!(motion.value, Motion::Fixed));
    // What is loaded or moved itself may come to meet the tool.
    let stays = case.loads.is_empty() && bodies.iter().all(rests) && !case.supports.iter().any(moved);
    // Meshes that a command makes may not be there yet.
    let there = bodies.iter().all(|body| !body.nodes.is_empty());
    if bodies.is_empty() || !there || !stays || !known || !case.later.is_empty() {
        return Vec::new();
    }
    let (mut low, mut high) = extent(mesh, bodies);
    if bodies.iter().all(|body| body.plane) {
        (low.z, high.z) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    let doubt = |body: &Body| {
        let BodyKind::Rigid(rigid) = &body.kind else { return None };
        let way = way(case, rigid)?;
        let apart = way.iter().filter_map(|offset| distance(mesh, rigid, *offset, (low, high))).reduce(f64::min)?;
        if apart <= 0.0 {
            return None;
        }
        let longest = way.iter().map(Vec3::norm).fold(0.0, f64::max);
        let [longest, apart] = [longest, apart].map(|length| quantity(length, "m"));
        let found =
            format!("= \"{}\": it moves by {longest}, and comes no nearer to the bodies than {apart}", body.name.value);
        let note = Diagnostic::warning(Code::Misses, &body.name.place, found);
        Some(note.remedy("check its place, its direction of motion, and the end of the run"))
    };
    case.bodies.iter().filter_map(doubt).collect()
}

/// Damping of contact that counts nowhere: driven shapes hold the nodes of solids, and there is nothing else to touch.
pub(super) fn undamped(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    let moves = std::iter::once(case).chain(&case.later).any(|stage| stage.solver.kind == SolverKind::Explicit);
    let held = |body: &Body| match &body.kind {
        // What is thrown meets springs.
        BodyKind::Solid(solid) => !solid.damage && solid.initial_velocity.iter().all(Option::is_none),
        BodyKind::Rigid(rigid) => {
            !(rigid.has_walls() || rigid.free_rotation || rigid.servo.is_some() || rigid.free.contains(&true))
        }
        _ => false,
    };
    let is_driven = case.bodies.iter().any(|body| matches!(body.kind, BodyKind::Rigid(_)));
    // Meshes that a command makes may not be there yet.
    let there = bodies.iter().all(|body| !body.nodes.is_empty());
    let alone = bodies.iter().all(|body| body.solid.is_axisymmetric())
        || (there && pieces(mesh, bodies).iter().all(|piece| *piece == 0));
    if !moves || !is_driven || !alone || case.solver.subcycling.is_some() || !case.bodies.iter().all(held) {
        return Vec::new();
    }
    let doubt = |(place, whose, ratio): (&Place, String, f64)| {
        let found = format!("{whose}: the damping ratio or restitution of its contact has no effect");
        let remedy = "driven rigid bodies stop the nodes of solids at once; remove it, and damp the solid by damping";
        let usual = ContactParameters::default().damping_ratio;
        (ratio != usual).then(|| Diagnostic::warning(Code::NoEffect, place, found).remedy(remedy))
    };
    damping_ratios(case, |body| matches!(body.kind, BodyKind::Solid(_) | BodyKind::Rigid(_)))
        .filter_map(doubt)
        .collect()
}

/// Damping ratios of contact with their places: of some bodies by name, and of pairs of materials.
fn damping_ratios(case: &Case, which: impl Fn(&&Body) -> bool) -> impl Iterator<Item = (&Place, String, f64)> {
    let own = |body: &Body| body.kind.surface(&case.materials).damping_ratio;
    let bodies = case.bodies.iter().filter(which);
    let bodies = bodies.map(move |body| (&body.name.place, format!("= \"{}\"", body.name.value), own(body)));
    let pairs = case.contact_pairs.iter();
    bodies.chain(pairs.filter_map(|pair| Some((&pair.place, String::new(), pair.coefficients.damping_ratio?))))
}

/// A restitution of solids that meet each other or rigid bodies by springs: it holds for single nodes, and the bodies part faster.
pub(super) fn rebounds(case: &Case) -> Vec<Diagnostic> {
    let meets = |body: &Body| match &body.kind {
        BodyKind::Solid(solid) => !solid.damage,
        BodyKind::Rigid(_) => true,
        BodyKind::Bonded(_) | BodyKind::Particles(_) => false,
    };
    // What is thrown or free; what is driven is told otherwise.
    let flies = |body: &Body| match &body.kind {
        BodyKind::Solid(solid) => solid.initial_velocity.iter().any(Option::is_some),
        BodyKind::Rigid(rigid) => rigid.free_rotation || rigid.free.contains(&true),
        _ => false,
    };
    let moves = case.solver.kind == SolverKind::Explicit;
    if !moves || case.bodies.len() < 2 || !case.bodies.iter().all(meets) || !case.bodies.iter().any(flies) {
        return Vec::new();
    }
    let doubt = |(place, whose, ratio): (&Place, String, f64)| {
        let found = format!(
            "{whose}: the damping ratio or restitution of its contact holds for single nodes: as a whole a solid parts almost as fast as it came"
        );
        let remedy = "damp the solid by damping; restitution holds for particles";
        let usual = ContactParameters::default().damping_ratio;
        (ratio > usual).then(|| Diagnostic::warning(Code::NoEffect, place, found).remedy(remedy))
    };
    damping_ratios(case, |body| matches!(body.kind, BodyKind::Solid(_))).filter_map(doubt).collect()
}

/// A work of adhesion of bodies that do not stick, and of rigid bodies without particles that would stick to them.
pub(super) fn adhesion_in_vain(case: &Case) -> Vec<Diagnostic> {
    let of_material = |index: usize| case.materials[index].work_of_adhesion;
    let sticks = |body: &Body| matches!(&body.kind, BodyKind::Particles(own) if of_material(own.material) > 0.0);
    let any_sticks = case.bodies.iter().any(sticks);
    let doubt = |body: &Body| {
        let (work, why) = match &body.kind {
            BodyKind::Solid(own) => (of_material(own.material), "solids do not stick"),
            BodyKind::Bonded(own) => (of_material(own.material), "bonded bodies do not stick"),
            BodyKind::Rigid(own) if !any_sticks => (own.work_of_adhesion, "no loose particles stick to it"),
            BodyKind::Rigid(_) | BodyKind::Particles(_) => return None,
        };
        let found = format!("= \"{}\": the work_of_adhesion of its contact has no effect: {why}", body.name.value);
        let note = Diagnostic::warning(Code::NoEffect, &body.name.place, found);
        let remedy = "loose particles with a work_of_adhesion stick, to each other and to rigid bodies that have one; remove it here";
        (work > 0.0).then(|| note.remedy(remedy))
    };
    case.bodies.iter().filter_map(doubt).collect()
}

/// Where a rigid body that does not turn is during the run, from where it starts [m]; none where that depends on forces, or it stays.
fn way(case: &Case, rigid: &RigidBody) -> Option<Vec<Vec3>> {
    let pushed = rigid.servo.is_some()
        || rigid.force.iter().any(Option::is_some)
        || rigid.free_rotation
        || rigid.spin.iter().any(Option::is_some);
    if pushed || rigid.inside {
        return None;
    }
    let step = case.solver.end / f64::from(LOOKS);
    let speed = |axis: usize, time: f64| {
        let thrown = rigid.initial_velocity[axis].as_ref().map_or(0.0, |field| field.value.at(Vec3::zeros()));
        rigid.velocity[axis].as_ref().map_or(thrown, |own| own.value.value(time, Vec3::zeros()))
    };
    let mut offset = Vec3::zeros();
    let mut way = vec![offset];
    for look in 0..LOOKS {
        let middle = step * (f64::from(look) + 0.5);
        offset += step * Vec3::new(speed(0, middle), speed(1, middle), speed(2, middle));
        way.push(offset);
    }
    way.iter().any(|offset| *offset != Vec3::zeros()).then_some(way)
}

/// Distance of a rigid body that has moved from a box [m]; at most zero where they may meet.
fn distance(mesh: &Mesh, rigid: &RigidBody, offset: Vec3, (low, high): (Vec3, Vec3)) -> Option<f64> {
    let (from, to) = match &rigid.shape {
        RigidShape::Plane { point, normal } => {
            let nearest = Vec3::from_fn(|axis, _| if normal[axis] > 0.0 { low[axis] } else { high[axis] });
            let along = (0..3).filter(|&axis| normal[axis] != 0.0);
            return Some(along.map(|axis| normal[axis] * (nearest[axis] - point[axis] - offset[axis])).sum());
        }
        RigidShape::Box { point, size } => (*point, point + size),
        RigidShape::Sphere { point, radius } => (point - Vec3::repeat(*radius), point + Vec3::repeat(*radius)),
        RigidShape::Cylinder { point, axis, length, radius, .. } => {
            let (end, around) = (point + axis * *length, Vec3::repeat(*radius));
            (point.inf(&end) - around, point.sup(&end) + around)
        }
        RigidShape::Group { group, .. } => {
            let nodes = mesh.group_nodes(&group.value);
            let first = mesh.nodes[*nodes.first()? as usize];
            let places = nodes.iter().map(|&node| mesh.nodes[node as usize]);
            places.fold((first, first), |(low, high), x| (low.inf(&x), high.sup(&x)))
        }
        RigidShape::Stl { .. } => return None,
    };
    let gap = |axis: usize| f64::max(from[axis] + offset[axis] - high[axis], low[axis] - to[axis] - offset[axis]);
    Some((0..3).map(gap).fold(f64::NEG_INFINITY, f64::max))
}
