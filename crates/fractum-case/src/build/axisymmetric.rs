//! Solids turned about the y axis: what they need, and what has no meaning around an axis.

use fractum_fem::Plane;
use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_scene::{Motion, Support};

use super::Context;
use super::bodies::{Numbering, Part};
use super::conditions::motion_of;
use crate::model::{Body, BodyKind, LoadKind, ProbeKind, RigidBody, RigidShape, SolverKind};
use crate::{Place, Spanned};

/// Distance from the axis over the size of the solids up to which a node lies on it: what is left of a mesh file.
const ON_AXIS: f64 = 1e-9;
/// Times over the run at which a motion on the axis is looked at.
const LOOKS: u32 = 8;

/// Where the case says that its solids are axisymmetric.
fn told<'a>(parts: &[Part<'a>]) -> Option<&'a Spanned<Plane>> {
    parts.iter().find_map(|part| part.body.plane.as_ref().filter(|plane| plane.value == Plane::Axisymmetric))
}

/// Refuses what has no meaning around an axis, and meshes on its other side.
pub(super) fn check(context: &mut Context<'_>, parts: &[Part<'_>]) {
    let Some(told) = told(parts) else { return };
    check_sections(context, parts, told);
    check_tables(context);
    check_materials(context, parts);
    check_loads(context);
    check_probes(context);
    for body in &context.case.bodies {
        match &body.kind {
            BodyKind::Solid(_) => {}
            BodyKind::Rigid(rigid) => check_rigid(context, body, rigid),
            BodyKind::Bonded(_) | BodyKind::Particles(_) => context.error(
                &body.name.place,
                format!("= \"{}\": particles beside an axisymmetric solid", body.name.value),
                "solids and rigid bodies; particles need a case in space",
            ),
        }
    }
}

fn check_sections(context: &mut Context<'_>, parts: &[Part<'_>], told: &Spanned<Plane>) {
    let size = size(context.mesh.bounding_box());
    for part in parts {
        if !part.body.is_axisymmetric() {
            let place = part.body.plane.as_ref().map_or(&part.place, |plane| &plane.place);
            let found = format!(": \"{}\" is plane beside an axisymmetric body", part.name);
            context.error(place, found, "plane = \"axisymmetric\" for all solids, or for none");
        }
        if let Some(thickness) = &part.body.thickness {
            context.error(
                &thickness.place,
                ": the body is axisymmetric",
                "no thickness around the axis; remove the key",
            );
        }
        let nodes = part.elements.iter().flat_map(|&t| context.mesh.triangles[t as usize]);
        let innermost = nodes.map(|n| context.mesh.nodes[n as usize]).min_by(|a, b| a.x.total_cmp(&b.x));
        if let Some(beyond) = innermost.filter(|place| place.x < -ON_AXIS * size) {
            let [x, y] = [beyond.x, beyond.y].map(|x| quantity(x, "m"));
            let found = format!("= \"axisymmetric\": \"{}\" has a node at ({x}, {y})", part.name);
            context.error(
                &told.place,
                found,
                "a mesh of one half of the section, x >= 0: the body is turned about the y axis, and x is the radius",
            );
        }
    }
}

/// Tables of the case that are for plane solids or for solids in space.
fn check_tables(context: &mut Context<'_>) {
    let case = context.case;
    let flows = &case.flows;
    let network = case.mesh.as_ref().map(|mesh| &mesh.network);
    let tables: [(&str, Option<Place>); 9] = [
        ("gas", flows.gas.as_ref().map(|gas| gas.place.clone())),
        ("heat", flows.heat.as_ref().map(|heat| heat.place.clone())),
        ("liquid", flows.liquid.as_ref().map(|liquid| liquid.place.clone())),
        ("in-situ stress", case.in_situ.as_ref().map(|stress| stress.place.clone())),
        ("bodies that leave or come in", case.excavation.as_ref().map(|own| own.place.clone())),
        ("interfaces", case.interfaces.first().map(|interface| interface.place.clone())),
        ("joints", network.and_then(|network| network.joints.first()).map(|joints| joints.place.clone())),
        ("steps of two sizes", case.solver.subcycling.clone()),
        ("an error bar", case.solver.accuracy.as_ref().map(|accuracy| accuracy.share.place.clone())),
    ];
    for (what, place) in tables {
        let Some(place) = place else { continue };
        context.error(&place, format!(": {what} beside axisymmetric solids"), "a case in the plane or in space for it");
    }
    if case.solver.kind == SolverKind::Modes {
        let found =
            ".kind = \"modes\": vibrations that bend or twist an axisymmetric solid are not seen in its section";
        context.error(&case.solver.place, found, "a case in space");
    }
    for ppv in &case.output.ppv {
        let found = format!("= \"{}\": distances from a hole of an axisymmetric solid", ppv.name.value);
        context.error(&ppv.name.place, found, "probes of velocity");
    }
}

fn check_materials(context: &mut Context<'_>, parts: &[Part<'_>]) {
    let mut seen: Vec<usize> = parts.iter().map(|part| part.body.material).collect();
    seen.sort_unstable();
    seen.dedup();
    for material in seen.into_iter().map(|index| &context.case.materials[index]) {
        if let Some(beds) = &material.bedding {
            context.error(&beds.place, ": beds of an axisymmetric solid", "a material without bedding");
        }
        let Some(damage) = &material.damage else { continue };
        if damage.value.law.friction.is_some() {
            context.error(&damage.place, ".friction: closed cracks of an axisymmetric solid", "no friction");
        }
        if damage.value.scatter.as_ref().and_then(|scatter| scatter.weibull()).is_some() {
            let expected = "distribution = \"weibull-per-edge\" or \"uniform-per-edge\", or no scatter";
            context.error(&damage.place, ".scatter: flaws in the volume of an axisymmetric solid", expected);
        }
    }
}

/// Gravity is along the axis; what is along z is refused of all 2D solids.
fn check_loads(context: &mut Context<'_>) {
    let case = context.case;
    for load in &case.loads {
        if let LoadKind::Gravity { acceleration } = &load.kind
            && let Some(value) = &acceleration[0]
        {
            context.error(&value.place, ": it is not along the axis", "gravity along y");
        }
    }
}

/// Around an axis nothing has a resultant across it.
fn check_probes(context: &mut Context<'_>) {
    for probe in &context.case.probes {
        let (found, expected) = match &probe.kind {
            ProbeKind::Momentum(momentum) if momentum.along.x != 0.0 || momentum.along.z != 0.0 => {
                ("momentum across the axis, which is zero", "along = \"y\"")
            }
            ProbeKind::AngularMomentum(_) => {
                ("angular momentum, which is zero around the axis", "momentum along \"y\"")
            }
            ProbeKind::Moment(_) => ("a moment, which is zero around the axis", "a reaction"),
            ProbeKind::RadialCracksAbout(_) => {
                ("radial cracks, which are no lines of an axisymmetric section", "damaged")
            }
            _ => continue,
        };
        context.error(&probe.name.place, format!("= \"{}\": {found}", probe.name.value), expected);
    }
}

/// A rigid body is its section turned about the axis, and moves along it.
fn check_rigid(context: &mut Context<'_>, body: &Body, rigid: &RigidBody) {
    let level = context.mesh.nodes.first().map_or(0.0, |node| node.z);
    let near = ON_AXIS * size(context.mesh.bounding_box());
    let is_on_axis = |point: &Vec3| point.x.abs() <= near && (point.z - level).abs() <= near;
    let (is_round, expected) = match &rigid.shape {
        RigidShape::Plane { normal, .. } => (normal.z == 0.0, "a normal within the section, [x, y, 0]"),
        RigidShape::Sphere { point, .. } => (is_on_axis(point), "its centre on the y axis"),
        RigidShape::Cylinder { point, axis, open: false, .. } => {
            (is_on_axis(point) && axis.x == 0.0 && axis.z == 0.0, "axis = \"y\" and its point on the y axis")
        }
        RigidShape::Box { .. } | RigidShape::Cylinder { .. } | RigidShape::Group { .. } | RigidShape::Stl { .. } => {
            (false, "a plane, which is turned to a cone where it is not level, a cylinder or a sphere")
        }
    };
    let name = &body.name;
    if !is_round {
        context.error(&name.place, format!("= \"{}\": it is not round about the y axis", name.value), expected);
    }
    let slides = !matches!(rigid.shape, RigidShape::Plane { .. }) && rigid.velocity[0].is_some();
    let turns = rigid.free_rotation || rigid.spin.iter().any(Option::is_some);
    if slides || turns || rigid.velocity[2].is_some() || rigid.free[0] || rigid.free[2] {
        let found = format!("= \"{}\": it moves out of the axis of the solids", name.value);
        context.error(
            &name.place,
            found,
            "motion along y alone; a plane may move along x too, as a wall that closes in",
        );
    }
}

impl Context<'_> {
    /// The support that keeps the nodes on the axis there.
    ///
    /// - `supports`: all others; what they hold along the radius is left to them, and must rest
    pub(super) fn on_axis(
        &mut self,
        parts: &[Part<'_>],
        numbering: &Numbering,
        supports: &[Support],
    ) -> Option<Support> {
        told(parts)?;
        let positions = &numbering.positions;
        let near = ON_AXIS * size(self.mesh.bounding_box());
        let mut nodes: Vec<u32> = (0..positions.len() as u32).filter(|&n| positions[n as usize].x <= near).collect();
        for own in &self.case.supports {
            let Some(motion) = &own.motion[0] else { continue };
            let moves = motion_of(&motion.value);
            let of: Vec<u32> = self.selected_nodes(&own.on, numbering);
            let speed = |node: u32| {
                let (at, end) = (&positions[node as usize], self.case.solver.end);
                let times = (1..=LOOKS).map(|look| f64::from(look) / f64::from(LOOKS) * end);
                let value = |time: f64| match &moves {
                    Motion::Fixed => 0.0,
                    Motion::Velocity(value) | Motion::Displacement(value) => value(time, at).abs(),
                };
                times.map(value).fold(0.0, f64::max)
            };
            let moved = |node: &&u32| nodes.binary_search(node).is_ok() && speed(**node) > 0.0;
            if let Some(&node) = of.iter().find(moved) {
                let y = quantity(positions[node as usize].y, "m");
                let found = format!(": it moves the node at y = {y} on the axis away from it");
                self.error(&motion.place, found, "no radial motion where x = 0");
            }
        }
        for own in parts {
            let Some(field) = &own.body.initial_velocity[0] else { continue };
            if nodes.iter().any(|&node| field.value.at(positions[node as usize]) != 0.0) {
                let found = format!("= \"{}\": its initial velocity has a radial component on the axis", own.name);
                self.error(&own.place.clone(), found, "initial_velocity.x that is zero where x = 0");
            }
        }
        let held: Vec<u32> = supports.iter().filter(|s| s.axis == 0).flat_map(|s| s.points.iter().copied()).collect();
        nodes.retain(|node| !held.contains(node));
        (!nodes.is_empty()).then(|| Support::new("axis", nodes, 0, Motion::Fixed))
    }
}

fn size((low, high): (Vec3, Vec3)) -> f64 {
    (high - low).norm()
}
