//! Liquid in interfaces and holes: what it cannot go with, and its place in the scene.

use fractum_output::warning::Code;
use fractum_scene::{Injection, InjectionDrive, InjectionPlace, Liquid, LiquidHole, LiquidSettings, Scene};

use super::bodies::Numbering;
use super::conditions::Surface;
use super::holes::Holes;
use super::{Context, function};
use crate::model::{self, BodyKind, Control, LiquidDrive, SolverKind};
use crate::{Diagnostic, nearest};

/// What does not go together with liquid.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    let Some(liquid) = &case.flows.liquid else { return };
    let place = &liquid.place;
    if case.interfaces.is_empty() && liquid.holes.is_empty() {
        let expected = "[[interfaces]] that it flows in, or [[liquid.holes]] that hold it";
        context.error(place, "in a case without interfaces", expected);
        return;
    }
    if case.solver.kind != SolverKind::Static {
        let note = Diagnostic::error(place, "flows between states of equilibrium alone");
        let remedy = "set solver.kind = \"static\"; in motion interfaces[].pressure pushes their sides apart";
        context.diagnostics.push(note.expected("solver.kind = \"static\"").remedy(remedy));
    }
    if !case.later.is_empty() || !case.source.stage.is_empty() {
        context.error(place, "beside [[stages]]", "one stage: the loads at t = 0 act before anything is injected");
    }
    let control = case.solver.statics.as_ref().and_then(|statics| statics.control);
    if control.is_some_and(|control| control != Control::Time) {
        context.error(&case.solver.place, ".control with [liquid]", "\"time\": liquid flows in time");
    }
    if let Some(body) = case.bodies.iter().find(|body| !matches!(body.kind, BodyKind::Solid(_))) {
        context.error(
            &body.name.place,
            "= a body beside [liquid]",
            "solid bodies alone: nothing touches beside interfaces",
        );
    }
    check_names(context, liquid);
}

fn check_names(context: &mut Context<'_>, liquid: &model::Liquid) {
    let known: Vec<&str> = context.case.interfaces.iter().map(|interface| interface.name.as_str()).collect();
    for name in liquid.interfaces.iter().filter(|name| !known.contains(&name.value.as_str())) {
        let note = Diagnostic::error(&name.place, format!("= \"{}\"", name.value));
        let note = note.expected(format!("the name of one of [[interfaces]]: {}", known.join(", ")));
        context.diagnostics.push(match nearest(&name.value, known.iter().copied()) {
            Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
            None => note,
        });
    }
    for interface in &context.case.interfaces {
        let Some((pressure, in_broken)) = &interface.pressure else { continue };
        if liquid.flows_in(&interface.name) {
            context.diagnostics.push(
                Diagnostic::error(&pressure.place, "in an interface that [liquid] flows in")
                    .expected("one of both")
                    .remedy("leave pressure out, or the interface out of liquid.interfaces"),
            );
        } else if *in_broken {
            context.error(
                &pressure.place,
                "with pressure_in = \"broken\", beside [liquid]",
                "pressure_in = \"everywhere\"",
            );
        }
    }
}

/// The scene with the liquid of its case.
pub(super) fn with_liquid(
    context: &mut Context<'_>,
    scene: Scene,
    (numbering, surface): (&Numbering, &Surface<'_>),
    warnings: &mut Vec<Diagnostic>,
) -> Scene {
    let Some(liquid) = &context.case.flows.liquid else { return scene };
    if scene.solid.has_damage() {
        let remedy = "elastic materials: cracks run along interfaces";
        context.error(&liquid.place, "in solids that may be damaged", remedy);
        return scene;
    }
    let kinds = (0u32..).zip(&context.case.interfaces);
    let kinds = kinds.filter(|(_, own)| liquid.flows_in(&own.name)).map(|(kind, _)| kind);
    let kinds: Vec<u32> = kinds.collect();
    let Some(holes) = holes(context, &scene, liquid, (numbering, surface)) else { return scene };
    let injection = |place: InjectionPlace, drive: &LiquidDrive| {
        let value = function(&drive.value.value);
        let drive = if drive.by_pressure { InjectionDrive::Pressure(value) } else { InjectionDrive::Rate(value) };
        Injection { place, drive }
    };
    let into_interfaces = liquid
        .injections
        .iter()
        .map(|own| injection(InjectionPlace::Nodes(context.selected_nodes(&own.on, numbering)), &own.drive));
    let mut injections: Vec<Injection> = into_interfaces.collect();
    let driven = liquid.holes.iter().enumerate().filter_map(|(hole, own)| Some((hole, own.drive.as_ref()?)));
    injections.extend(driven.map(|(hole, drive)| injection(InjectionPlace::Hole(hole), drive)));
    let settings = LiquidSettings {
        interfaces: kinds,
        law: liquid.law,
        aperture: liquid.aperture,
        compressibility: liquid.compressibility,
        leak_off: liquid.leak_off,
        holes,
        injections,
    };
    let built = Liquid::new(&scene.solid, scene.interfaces(), settings);
    for (index, injection) in liquid.injections.iter().enumerate() {
        let place = injection.on.place().unwrap_or(&liquid.place).clone();
        let label = injection.on.label();
        if built.cells_of_injection(index) == 0 {
            let found = format!("= \"{label}\": none of its nodes is on an interface that liquid flows in");
            context.error(&place, found, "nodes inside of such an interface; its tips have no room");
        } else if built.hole_at_injection(index).is_some() {
            let found = format!("= \"{label}\": has nodes on the wall of a hole, whose pressure they share");
            context.error(&place, found, "the rate or pressure of liquid.holes[], or nodes away from it");
        }
    }
    for (index, hole) in liquid.holes.iter().enumerate() {
        let (_, beside) = built.hole(index);
        if beside == 0 && !hole.is_sealed && !context.case.interfaces.is_empty() {
            let place = hole.on.place().unwrap_or(&liquid.place);
            let found = format!("= \"{}\": no interface that liquid flows in meets the hole", hole.on.label());
            let note = Diagnostic::warning(Code::LiquidHoleAlone, place, found);
            warnings.push(note.remedy("let one end on its wall, or set sealed = true"));
        }
    }
    fractum_scene::with_liquid(scene, built)
}

/// Holes on the groups of the mesh; none where one is wrong.
fn holes(
    context: &mut Context<'_>,
    scene: &Scene,
    liquid: &model::Liquid,
    (numbering, surface): (&Numbering, &Surface<'_>),
) -> Option<Vec<LiquidHole>> {
    let bits = scene.supports().held();
    let held = |node: u32, axis: usize| bits.get(node as usize).is_some_and(|own| own >> axis & 1 == 1);
    let of_mesh = Holes::new(context, numbering, "liquid", &liquid.symmetry, &scene.solid, &held);
    let mut holes: Vec<LiquidHole> = Vec::new();
    for hole in &liquid.holes {
        let facets = context.selected_facets(&hole.on, numbering, surface);
        let others: Vec<&[[u32; 3]]> = holes.iter().map(|other| &other.facets[..]).collect();
        let ends = of_mesh.ends(context, (&hole.on, hole.stemmed), &facets, &others);
        let axes = if scene.solid.is_plane() { 2 } else { 3 };
        let is_held = facets.iter().flatten().all(|&node| (0..axes).all(|axis| held(node, axis)));
        if is_held && !facets.is_empty() && hole.storage == 0.0 && liquid.compressibility == 0.0 {
            let place = hole.on.place().unwrap_or(&liquid.place).clone();
            let found = format!("= \"{}\": its wall is held all around, and nothing in it gives way", hole.on.label());
            context.error(&place, found, "liquid.compressibility or storage above 0, or a wall that may move");
        }
        let (storage, is_sealed) = (hole.storage, hole.is_sealed);
        holes.push(LiquidHole { facets, ends: ends.unwrap_or_default(), storage, is_sealed });
    }
    context.diagnostics.is_empty().then_some(holes)
}
