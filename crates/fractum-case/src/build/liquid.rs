//! Liquid in interfaces: what it cannot go with, and its place in the scene.

use fractum_scene::{Injection, InjectionDrive, Liquid, LiquidSettings, Scene};

use super::bodies::Numbering;
use super::{Context, function};
use crate::model::{self, BodyKind, Control, SolverKind};
use crate::{Diagnostic, nearest};

/// What does not go together with liquid.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    let Some(liquid) = &case.flows.liquid else { return };
    let place = &liquid.place;
    if case.interfaces.is_empty() {
        context.error(place, "in a case without interfaces", "[[interfaces]] that it flows in");
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
pub(super) fn with_liquid(context: &mut Context<'_>, scene: Scene, numbering: &Numbering) -> Scene {
    let Some(liquid) = &context.case.flows.liquid else { return scene };
    if scene.solid.has_damage() {
        let remedy = "elastic materials: cracks run along interfaces";
        context.error(&liquid.place, "in solids that may be damaged", remedy);
        return scene;
    }
    let kinds = (0u32..).zip(&context.case.interfaces);
    let kinds = kinds.filter(|(_, own)| liquid.flows_in(&own.name)).map(|(kind, _)| kind);
    let kinds: Vec<u32> = kinds.collect();
    let injections = liquid.injections.iter().map(|injection| {
        let value = function(&injection.value.value);
        let drive = if injection.by_pressure { InjectionDrive::Pressure(value) } else { InjectionDrive::Rate(value) };
        Injection { nodes: context.selected_nodes(&injection.on, numbering), drive }
    });
    let settings = LiquidSettings {
        interfaces: kinds,
        law: liquid.law,
        aperture: liquid.aperture,
        compressibility: liquid.compressibility,
        leak_off: liquid.leak_off,
        injections: injections.collect(),
    };
    let built = Liquid::new(&scene.solid, scene.interfaces(), settings);
    for (index, injection) in liquid.injections.iter().enumerate() {
        if built.cells_of_injection(index) == 0 {
            let found =
                format!("= \"{}\": none of its nodes is on an interface that liquid flows in", injection.on.label());
            let place = injection.on.place().unwrap_or(&liquid.place).clone();
            context.error(&place, found, "nodes inside of such an interface; its tips have no room");
        }
    }
    fractum_scene::with_liquid(scene, built)
}
