//! What needs no particles is checked before they are made: packing a body may take minutes.

use std::collections::HashMap;

use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_scene::{Domain, Scene};

use super::{Context, clumps, inlets, interfaces, liquid, periodic, rate};
use crate::measure::ContactForce;
use crate::model::{
    Body, BodyKind, BondLawKind, BondedShape, GroupUse, LoadKind, Motion, PackingSource, ProbeKind, RigidShape,
    Selection, SolverKind, WHOLE_MESH,
};
use crate::{Choice, Diagnostic, Field, Spanned, TimeFunction, nearest};

/// Steps that a run can count without losing time to rounding.
const MOST_STEPS: f64 = 1e15;

/// Checks what case and mesh tell by themselves.
pub(super) fn check_before_particles(context: &mut Context<'_>) {
    check_groups(context);
    check_names(context);
    check_particle_sets(context);
    check_time_functions(context);
    check_fields(context);
    check_bonded_statics(context);
    check_contact_probes(context);
    check_heat_probes(context);
    context.check_subcycling();
    clumps::check(context);
    inlets::check(context);
    interfaces::check(context);
    liquid::check(context);
    periodic::check(context);
    rate::check(context);
}

/// Probes of heat need heat.
fn check_heat_probes(context: &mut Context<'_>) {
    let case = context.case;
    let of_heat = |kind: &ProbeKind| matches!(kind, ProbeKind::Temperature(_) | ProbeKind::HeatOfAll(_));
    for probe in case.probes.iter().filter(|probe| of_heat(&probe.kind) && case.flows.heat.is_none()) {
        let found = format!("= \"{}\": the case has no heat", probe.name.value);
        context.error(&probe.name.place, found, "a table [heat]");
    }
}

/// Probes of contact name two bodies of which one at least is not rigid.
fn check_contact_probes(context: &mut Context<'_>) {
    let case = context.case;
    let names: Vec<&str> = case.bodies.iter().map(|body| body.name.value.as_str()).collect();
    for probe in &case.probes {
        let ProbeKind::ContactForce(ContactForce { on, from, .. }) = &probe.kind else { continue };
        let unknown = [on, from].map(|name| !names.contains(&name.value.as_str()));
        for (name, _) in [on, from].into_iter().zip(unknown).filter(|(_, unknown)| *unknown) {
            let mut diagnostic = Diagnostic::error(&name.place, format!("= \"{}\"", name.value));
            diagnostic = diagnostic.expected(format!("the name of a body: {}", names.join(", ")));
            if let Some(near) = nearest(&name.value, names.iter().copied()) {
                diagnostic = diagnostic.remedy(format!("did you mean \"{near}\"?"));
            }
            context.diagnostics.push(diagnostic);
        }
        if unknown == [false; 2] && on.value == from.value {
            context.error(&from.place, format!("= \"{}\", as `on`", from.value), "another body");
        } else if case.tool(&on.value).is_some() && case.tool(&from.value).is_some() {
            let found = format!("= \"{}\": rigid bodies do not touch each other", from.value);
            context.error(&from.place, found, "a solid or a body of particles as one of both");
        }
    }
}

/// Every group that the case names must be in the mesh, with elements.
fn check_groups(context: &mut Context<'_>) {
    let names = context.mesh.group_names();
    let mut empty: HashMap<&str, bool> = HashMap::new();
    for (group, _) in context.case.groups_used() {
        if group.value == WHOLE_MESH && has_several_bodies(context) {
            let list = names.iter().filter(|name| **name != WHOLE_MESH).copied().collect::<Vec<_>>().join(", ");
            context.error(&group.place, "is missing", format!("one of the physical groups of the mesh: {list}"));
            continue;
        }
        if names.contains(&group.value.as_str()) {
            let nodes = || context.mesh.group_nodes(&group.value);
            if *empty.entry(&group.value).or_insert_with(|| nodes().is_empty()) {
                let found = format!("= \"{}\": the group has no elements in the mesh", group.value);
                context.error(&group.place, found, "a group of some; Gmsh writes them with Mesh.SaveAll = 0");
            }
            continue;
        }
        let list = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let mut diagnostic =
            Diagnostic::error(&group.place, format!("= \"{}\"", group.value)).expected(match &context.case.mesh {
                Some(mesh) => format!("a physical group of {}; groups there: {list}", mesh.file.value.display()),
                None => "a set of particles of a bonded body, BODY or BODY.SET; the case has no mesh".to_owned(),
            });
        if let Some(near) = nearest(&group.value, names.iter().copied()) {
            diagnostic = diagnostic.remedy(format!("did you mean \"{near}\"?"));
        } else if names.is_empty() && context.case.mesh.is_some() {
            diagnostic = diagnostic.remedy(
                "leave group out for a body that is the whole mesh, and choose places by where; or save physical groups",
            );
        }
        context.diagnostics.push(diagnostic);
    }
}

/// A rigid body or one of particles must not have the name of a mesh group of something else, where supports, loads or probes name it.
fn check_names(context: &mut Context<'_>) {
    let (case, mesh) = (context.case, context.mesh);
    let groups = mesh.group_names();
    // A body that is made of the group may have its name.
    let made_of = |kind: &BodyKind, name: &str| match kind {
        BodyKind::Solid(_) => true,
        BodyKind::Rigid(rigid) => matches!(&rigid.shape, RigidShape::Group { group, .. } if group.value == name),
        BodyKind::Bonded(bonded) => match &bonded.packing {
            PackingSource::Shape { shape, .. } => {
                matches!(&shape.value, BondedShape::Group(group) if group.value == name)
            }
            PackingSource::Particles { .. } | PackingSource::File(_) => false,
        },
        BodyKind::Particles(loose) => loose.group().is_some_and(|group| group.value == name),
    };
    let is_taken = |body: &Body| {
        let name = body.name.value.as_str();
        groups.contains(&name) && !made_of(&body.kind, name)
    };
    let taken: Vec<&str> =
        case.bodies.iter().filter(|body| is_taken(body)).map(|body| body.name.value.as_str()).collect();
    if taken.is_empty() {
        return;
    }
    let mut named: Vec<&Selection> = case.supports.iter().map(|support| &support.on).collect();
    named.extend(case.loads.iter().filter_map(|load| Some(load.kind.on()?.0)));
    named.extend(case.probes.iter().filter_map(|probe| probe.kind.may_be_particles()));
    named.extend(case.flows.heat.iter().flat_map(|heat| &heat.conditions).map(|condition| &condition.on));
    for group in named.into_iter().filter_map(|on| on.group.as_ref()) {
        if taken.contains(&group.value.as_str()) {
            let found = format!("= \"{}\": a body and a group of the mesh have this name", group.value);
            let diagnostic = Diagnostic::error(&group.place, found).expected("a name that means one of both");
            context.diagnostics.push(diagnostic.remedy("give the body another name"));
        }
    }
}

/// Whether the mesh names several groups that a body may be made of.
fn has_several_bodies(context: &Context<'_>) -> bool {
    let solid = context.mesh.tetrahedron_count() > 0;
    let dimension = if solid { 3 } else { 2 };
    let groups = context.mesh.groups.iter();
    groups.filter(|group| group.dimension == dimension && group.name != WHOLE_MESH).count() > 1
}

/// Sets of particles must be walls of their bodies or named there; a packing made before tells its walls only when
/// it is read.
fn check_particle_sets(context: &mut Context<'_>) {
    let case = context.case;
    let mut named: Vec<&Selection> = case.supports.iter().map(|support| &support.on).collect();
    for load in &case.loads {
        match load.kind.on() {
            Some((on, GroupUse::Facets)) if context.names_particles(on) => {
                let Some(group) = &on.group else { continue };
                let body = case.particle_group(&group.value).map(|(body, _)| &case.bodies[body].kind);
                let found = format!("= \"{}\"", group.value);
                if matches!(body, Some(BodyKind::Particles(_))) {
                    let diagnostic = Diagnostic::error(&group.place, found);
                    let expected =
                        "a mesh group of facets, or particles of a bonded body; loose particles show no area";
                    let diagnostic = diagnostic.expected(expected);
                    context.diagnostics.push(diagnostic.remedy("use force, or a rigid body with servo"));
                    continue;
                }
                if let LoadKind::Pressure { in_cracks, detonation, .. } = &load.kind
                    && (in_cracks.is_some() || detonation.is_some())
                {
                    let what = if in_cracks.is_some() { "in_cracks" } else { "detonation" };
                    context.error(&group.place, format!("{found} with {what}"), "a mesh group of facets");
                }
                named.push(on);
            }
            Some((on, _)) => named.push(on),
            None => {}
        }
    }
    named.extend(case.probes.iter().filter_map(|probe| probe.kind.may_be_particles()));
    named.extend(case.output.gauges.iter().map(|gauges| &gauges.on));
    named.extend(case.flows.heat.iter().flat_map(|heat| &heat.conditions).map(|condition| &condition.on));
    let groups = named.into_iter().filter_map(|on| on.group.as_ref());
    let groups = groups.chain(case.ties.iter().map(|tie| &tie.bonded));
    for group in groups {
        let Some((body, Some(set))) = case.particle_group(&group.value) else { continue };
        let (walls, groups) = match &case.bodies[body].kind {
            BodyKind::Bonded(own) => (own.wall_names(), &own.groups),
            BodyKind::Particles(own) => (Some(&[][..]), &own.groups),
            _ => continue,
        };
        let Some(walls) = walls else { continue };
        let known: Vec<&str> =
            walls.iter().copied().chain(groups.iter().map(|(name, _)| name.value.as_str())).collect();
        if !known.contains(&set) {
            unknown_set(context, group, &case.bodies[body].name.value, set, &known);
        }
    }
}

/// Notes a set that a body of particles does not have.
pub(super) fn unknown_set(context: &mut Context<'_>, group: &Spanned<String>, body: &str, set: &str, known: &[&str]) {
    let list: String = known.iter().map(|set| format!(", {body}.{set}")).collect();
    let mut diagnostic = Diagnostic::error(&group.place, format!("= \"{}\"", group.value))
        .expected(format!("a set of particles of \"{body}\": {body}{list}"));
    if context.case.periodic.is_some() && fractum_pack::Domain::BOX_WALLS.contains(&set) {
        diagnostic = diagnostic.remedy("without walls in its periodic box, a body has the sets of bodies[].groups");
    } else if let Some(near) = nearest(set, known.iter().copied()) {
        diagnostic = diagnostic.remedy(format!("did you mean \"{body}.{near}\"?"));
    }
    context.diagnostics.push(diagnostic);
}

/// Loads and motions must be finite numbers during the whole run, on the nodes that they act on.
fn check_time_functions(context: &mut Context<'_>) {
    let case = context.case;
    let mut functions: Vec<(&Spanned<TimeFunction>, Option<&Selection>)> = Vec::new();
    for load in &case.loads {
        let on = load.kind.on().map(|(on, _)| on);
        functions.extend(load.kind.functions().into_iter().map(|function| (function, on)));
        // What acts on everything acts everywhere alike.
        for function in load.kind.functions().iter().filter(|f| on.is_none() && f.value.depends_on_position()) {
            context.error(&function.place, "depends on the position", "a function of time only");
        }
    }
    for body in &case.bodies {
        if let BodyKind::Rigid(rigid) = &body.kind {
            functions.extend(rigid.functions().map(|f| (f, None)));
            if let Some(servo) = &rigid.servo {
                let (function, end) = (servo.function(), case.solver.end);
                if let Some((time, value)) = function.value.negative(end) {
                    let found = format!("is {value:.4e} at t = {}", quantity(time, "s"));
                    context.error(&function.place, found, "0 or more: contacts cannot pull; turn servo.along instead");
                }
            }
        }
    }
    for condition in case.flows.heat.iter().flat_map(|heat| &heat.conditions) {
        functions.push((condition.kind.function(), Some(&condition.on)));
    }
    for (function, _) in case.interfaces.iter().filter_map(|interface| interface.pressure.as_ref()) {
        if let Some((time, value)) = function.value.negative(case.solver.end) {
            let found = format!("is {} at t = {}", quantity(value, "Pa"), quantity(time, "s"));
            context.error(&function.place, found, "0 or more: what is between the sides pushes them apart");
        }
    }
    let pressures = case.interfaces.iter().filter_map(|interface| interface.pressure.as_ref());
    functions.extend(pressures.map(|(function, _)| (function, None)));
    let drives = case.flows.liquid.iter().flat_map(|liquid| liquid.drives());
    functions.extend(drives.map(|(own, on)| (&own.value, Some(on))));
    functions.extend(case.periodic.iter().flat_map(|own| own.functions()).map(|function| (function, None)));
    for (function, on) in functions {
        check_function(context, &function.value, function, on);
    }
    for support in &case.supports {
        for motion in support.motion.iter().flatten() {
            if let Motion::Velocity(function) | Motion::Displacement(function) = &motion.value {
                check_function(context, function, motion, Some(&support.on));
            }
        }
    }
}

fn check_function<T>(context: &mut Context<'_>, function: &TimeFunction, written: &Spanned<T>, on: Option<&Selection>) {
    let mut positions: Vec<Vec3> = Vec::new();
    if let Some(on) = on.filter(|_| function.depends_on_position()) {
        let all = || (0..context.mesh.nodes.len() as u32).collect();
        let nodes = on.group.as_ref().map_or_else(all, |group| context.mesh.group_nodes(&group.value));
        positions.extend(nodes.into_iter().map(|n| context.mesh.nodes[n as usize]));
        positions.retain(|x| on.within.as_ref().is_none_or(|within| within.value.holds_at(*x)));
    }
    let Some((time, x, value)) = function.not_finite(context.case.solver.end, &positions) else { return };
    let at = if function.depends_on_position() {
        format!(", ({:.4e}, {:.4e}, {:.4e}) m", x.x, x.y, x.z)
    } else {
        String::new()
    };
    let found = format!("is {value} at t = {}{at}", quantity(time, "s"));
    context.error(&written.place, found, "a finite number during the whole run");
}

/// What solids start with must be finite numbers at their nodes.
fn check_fields(context: &mut Context<'_>) {
    let (case, mesh) = (context.case, context.mesh);
    let heat = case.flows.heat.as_ref().map(|heat| &heat.initial);
    for body in &case.bodies {
        let BodyKind::Solid(solid) = &body.kind else { continue };
        let nodes = mesh.group_nodes(&solid.group.value);
        for field in solid.initial_velocity.iter().flatten().chain(heat) {
            check_field(context, field, nodes.iter().map(|&node| mesh.nodes[node as usize]));
        }
    }
}

/// A field must be a finite number at all places where it is taken; the first one where it is not is told.
pub(super) fn check_field(context: &mut Context<'_>, field: &Spanned<Field>, places: impl Iterator<Item = Vec3>) {
    let mut values = places.map(|x| (x, field.value.at(x)));
    let Some((x, value)) = values.find(|(_, value)| !value.is_finite()) else { return };
    let found = format!("is {value} at ({:.4e}, {:.4e}, {:.4e}) m", x.x, x.y, x.z);
    context.error(&field.place, found, "a finite number wherever it is taken");
}

/// What a bonded body at rest cannot have.
fn check_bonded_statics(context: &mut Context<'_>) {
    let solver = &context.case.solver;
    let Some(options) = solver.statics.as_ref().filter(|_| solver.kind == SolverKind::Static) else { return };
    let [Body { kind: BodyKind::Bonded(body), .. }] = context.case.bodies.as_slice() else { return };
    let place = solver.place.clone();
    let found = |what: &str| format!("= \"static\" with a bonded body and {what}");
    if options.control.is_some() || solver.step.is_some() {
        let expected = "no control and no step: the load goes straight from break to break";
        context.error(&place, found("solver.control or solver.step"), expected);
    }
    if body.initial_velocity.iter().any(Option::is_some) {
        context.error(&place, found("initial_velocity"), "a body at rest; or kind = \"explicit\"");
    }
    if body.law != BondLawKind::CohesiveBeam {
        let what = format!("bond = \"{}\"", body.law.name());
        context.error(&place, found(&what), "bond = \"cohesive-beam\" on the body; or kind = \"explicit\"");
    }
}

/// The time step of a scene in motion must be stable, and reach the end of the run.
pub(super) fn check_time_step(context: &mut Context<'_>, scene: &Scene, warnings: &mut Vec<Diagnostic>) {
    let (solver, stable, dt) = (&context.case.solver, scene.stable_dt(), scene.clock.dt_after);
    if !stable.is_normal() {
        let place = context.case.bodies[0].name.place.clone();
        let found = format!("= \"{}\": the stable time step is {stable} s", context.case.bodies[0].name.value);
        return context.error(&place, found, "materials, sizes and masses of a real body");
    }
    if let Some(step) = solver.step.as_ref().filter(|step| step.value > stable) {
        let stable = quantity(stable, "s");
        let found = format!("= {} is above the stable step {stable}", quantity(step.value, "s"));
        let remedy = "lower it, or leave it out: solver.safety times the stable step is taken then";
        if step.value > 2.0 * scene.stable_dt() {
            context.diagnostics.push(Diagnostic::error(&step.place, found).remedy(remedy));
            return;
        }
        warnings.push(Diagnostic::warning(Code::TimeStep, &step.place, found).remedy(remedy));
    }
    let steps = solver.end / dt;
    if steps.is_nan() || steps > MOST_STEPS {
        let found = format!("= {} needs {steps:.1e} steps of {}", quantity(solver.end, "s"), quantity(dt, "s"));
        context.error(&solver.end_place.clone(), found, format!("an end within {MOST_STEPS:e} steps"));
    }
}

/// The scene with the domain of its run, which must hold all of its nodes and particles at the start.
pub(super) fn with_domain(context: &mut Context<'_>, scene: Scene, domain: &Spanned<Domain>) -> Option<Scene> {
    let planar = scene.solid.is_plane();
    let nodes = scene.solid.reference.iter().map(|p| (p, "node"));
    let points = nodes.chain(scene.bonded.reference().iter().map(|p| (p, "particle")));
    if let Some((p, what)) = points.clone().find(|(p, _)| domain.value.is_outside(p, planar)) {
        let place = format!("({}, {}, {})", quantity(p.x, "m"), quantity(p.y, "m"), quantity(p.z, "m"));
        let found = format!("leaves a {what} at {place} outside at the start");
        context.error(&domain.place, found, "a box around all bodies but rigid ones, with room for pieces to fly");
        return None;
    }
    Some(scene.with_domain(domain.value))
}
