//! 2D solids and discs lie in the xy-plane: what would push them along z, or pass them by in front, is refused.

use std::ops::RangeFrom;

use fractum_fem::ElementKind;
use fractum_output::number::quantity;

use super::bodies::Part;
use super::{Context, discs};
use crate::Place;
use crate::model::{Body, BodyKind, LoadKind, Motion, RigidBody, RigidShape, Selection};

const Z: usize = 2;
/// Components yz and zx of an in-situ stress.
const SHEARS: RangeFrom<usize> = 4..;
/// Component of a unit vector, or distance over a size, that counts as none.
const NEARLY: f64 = 1e-6;

/// Refuses loads, motions and initial velocities of 2D solids and discs along z, and rigid shapes that do not meet their plane at right angles.
pub(super) fn check(context: &mut Context<'_>, parts: &[Part]) {
    let mesh = context.mesh;
    let part = parts.iter().find(|part| part.shape == ElementKind::T3);
    let node = part.and_then(|part| part.elements.first()).map(|&triangle| mesh.triangles[triangle as usize][0]);
    let plane = node.map_or(0.0, |node| mesh.nodes[node as usize].z);
    let has_discs = discs::check(context, parts, plane);
    let who = match part {
        Some(_) => "2D solids",
        None if has_discs => "discs",
        None => return,
    };
    for place in along_z(context, has_discs) {
        context.error(
            &place,
            format!(": {who} lie in the xy-plane and cannot move along z"),
            "a component along x or y",
        );
    }
    let stresses = context.case.in_situ.iter().flat_map(|in_situ| in_situ.fields());
    let shear = stresses.flat_map(|stress| stress.components[SHEARS].iter().flatten());
    for field in shear.filter(|field| field.value.constant_value() != Some(0.0)) {
        context.error(
            &field.place,
            ": 2D solids bear no shear across their plane",
            "a stress in the plane, or a case in space",
        );
    }
    for part in parts.iter().filter(|part| part.shape == ElementKind::T3) {
        if part.body.initial_velocity[Z].as_ref().is_some_and(|field| field.value.constant_value() != Some(0.0)) {
            let found = format!(
                "= \"{}\" begins with a velocity along z: 2D solids lie in the xy-plane",
                part.body.group.value
            );
            context.error(&part.place, found, "an initial velocity along x or y");
        }
    }
    let particles = |body: &Body| matches!(body.kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
    let in_space = !has_discs && context.case.bodies.iter().any(particles);
    if in_space || part.is_some_and(|part| part.body.is_axisymmetric()) {
        return; // particles are what rigid bodies are for; around an axis these must be round
    }
    for body in &context.case.bodies {
        let BodyKind::Rigid(rigid) = &body.kind else { continue };
        if let Some((found, expected)) = beside_plane(&rigid.shape, plane, who) {
            context.error(&body.name.place, format!("= \"{}\": {found}", body.name.value), expected);
        }
        for place in out_of_plane(rigid) {
            let Body { name, .. } = body;
            let found = format!(": {who} lie in the xy-plane, and \"{}\" would leave it", name.value);
            context.error(&place, found, "motion along x and y, and spin about z");
        }
    }
}

/// Places of loads and motions of nodes, and with `has_discs` of particles, along z.
fn along_z(context: &Context<'_>, has_discs: bool) -> Vec<Place> {
    let mut across = Vec::new();
    let of_space = |on: &Selection| !has_discs && context.names_particles(on);
    for support in context.case.supports.iter().filter(|support| !of_space(&support.on)) {
        if let Some(motion) = &support.motion[Z]
            && let Motion::Velocity(function) | Motion::Displacement(function) = &motion.value
            && !function.is_zero()
        {
            across.push(motion.place.clone());
        }
    }
    for load in &context.case.loads {
        let of_particles = load.kind.on().is_some_and(|(on, _)| of_space(on));
        let along_z = match &load.kind {
            LoadKind::Force { force: components, .. }
            | LoadKind::Traction { traction: components, .. }
            | LoadKind::Gravity { acceleration: components } => components[Z].as_ref(),
            // Pressures stay in the plane.
            _ => None,
        };
        across.extend(along_z.filter(|z| !of_particles && !z.value.is_zero()).map(|z| z.place.clone()));
    }
    across
}

/// Prescribed velocities along z and spins about x and y.
fn out_of_plane(rigid: &RigidBody) -> impl Iterator<Item = Place> {
    let [about_x, about_y, _] = &rigid.spin;
    let moves = [&rigid.velocity[Z], about_x, about_y].into_iter().flatten();
    moves.filter(|function| !function.value.is_zero()).map(|function| function.place.clone())
}

/// Why a rigid shape does not meet the plane of 2D solids, or discs, as a line in it, and what would; none where it does.
///
/// - `plane`: their z [m]; `who`: what lies in it
fn beside_plane(shape: &RigidShape, plane: f64, who: &str) -> Option<(String, String)> {
    let at = || format!("the plane of the {who}, z = {}", quantity(plane, "m"));
    let spans = |low: f64, high: f64| {
        let within = NEARLY * (high - low);
        let is_beside = plane <= low + within || plane >= high - within;
        let found = || {
            format!("it reaches from z = {} to {}, and not through {}", quantity(low, "m"), quantity(high, "m"), at())
        };
        is_beside.then(|| (found(), "a shape that begins before that plane and ends behind it".to_owned()))
    };
    let centred = |z: f64, size: f64| {
        let found = || format!("its centre is at z = {}, beside {}", quantity(z, "m"), at());
        ((z - plane).abs() > NEARLY * size).then(|| (found(), "a centre in that plane".to_owned()))
    };
    match shape {
        RigidShape::Plane { normal, .. } => (normal.z.abs() > NEARLY).then(|| {
            (format!("its normal points out of the xy-plane, in which {who} lie"), "a normal along x and y".to_owned())
        }),
        RigidShape::Box { point, size } => spans(point.z, point.z + size.z),
        RigidShape::Cylinder { open: true, .. } => None,
        RigidShape::Cylinder { point, axis, length, .. } if axis.z.abs() > 1.0 - NEARLY => {
            let end = point.z + axis.z * length;
            spans(point.z.min(end), point.z.max(end))
        }
        RigidShape::Cylinder { axis, .. } if axis.z.abs() > NEARLY => Some((
            format!("its axis is askew to the xy-plane, in which {who} lie"),
            "axis = \"z\", or an axis along x and y".to_owned(),
        )),
        RigidShape::Cylinder { point, radius, .. } | RigidShape::Sphere { point, radius } => centred(point.z, *radius),
        // Walls touch no 2D solids.
        RigidShape::Group { .. } | RigidShape::Stl { .. } => None,
    }
}
