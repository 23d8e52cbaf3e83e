//! Heat in the bodies of a scene.

use std::collections::HashSet;

use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_scene::{Heat, HeatCondition, HeatSettings, Scene, ThermalMaterial};

use super::bodies::{Numbering, Part};
use super::conditions::{LoadedPoints, Surface};
use super::{Context, function, heat_doubts};
use crate::Diagnostic;
use crate::model::{self, BodyKind, HeatKind, HeatScheme, SolverKind};

/// Least number of steps of conduction in a run that gives none.
const STEPS: f64 = 1000.0;

/// The scene with the heat of the case, if it has any.
pub(super) fn with_heat(
    context: &mut Context<'_>,
    mut scene: Scene,
    parts: &[Part],
    numbering: &Numbering,
    surface: &Surface,
    warnings: &mut Vec<Diagnostic>,
) -> Option<Scene> {
    let case = context.case;
    let Some(heat) = &case.flows.heat else { return Some(scene) };
    let (solids, bonded) = thermal_materials(context, heat)?;
    let mut conditions = Vec::new();
    let mut held = HashSet::new();
    for condition in &heat.conditions {
        let condition_of_points = heat_condition(context, condition, &scene, parts, numbering, surface)?;
        if let HeatCondition::Temperature { points, .. } = &condition_of_points
            && !points.iter().all(|&point| held.insert(point))
        {
            let place = condition.on.place().cloned().unwrap_or_else(|| heat.place.clone());
            let found = format!("= \"{}\": shares points with another prescribed temperature", condition.on.label());
            context.error(&place, found, "one temperature per point");
        }
        conditions.push(condition_of_points);
    }
    let expands = solids.iter().chain(&bonded).any(|material| material.expansion != 0.0);
    let alone = case.solver.kind == SolverKind::Heat;
    let uneven = heat.initial.value.depends_on_position();
    if expands && !alone && uneven && heat.stress_free.is_none() {
        let expected = "heat.stress_free_temperature: bodies expand from an uneven temperature";
        context.error(&heat.initial.place, "depends on the position", expected);
    }
    context.without_mistakes()?;
    if context.division.is_none() {
        let made = conditions.iter().enumerate();
        warnings.extend(made.filter_map(|(index, made)| heat_doubts::front(case, heat, index, made, &scene)));
        warnings.extend(heat_doubts::long_steps(case, heat, &scene));
    }
    let initial = heat.initial.value.clone();
    let settings = HeatSettings {
        solids,
        bonded,
        interfaces: case.interfaces.iter().map(|own| own.heat_transfer.as_ref().map(|own| own.value)).collect(),
        packing: heat.packing,
        stress_free: heat.stress_free.unwrap_or_else(|| initial.at(Default::default())),
        initial: std::sync::Arc::new(move |_, place: &Vec3| initial.at(*place)),
        conditions,
        implicit: heat.scheme == HeatScheme::Implicit,
        step: heat.step.as_ref().map(|step| step.value),
        safety: case.solver.safety,
        longest: case.solver.end / STEPS,
        alone,
        at_rest: case.solver.kind == SolverKind::Static,
        unstressed: case.solver.kind == SolverKind::Static && case.in_situ.is_none(),
    };
    let interfaces = scene.interfaces().clone();
    match Heat::new(&mut scene.solid, &mut scene.bonded, &interfaces, settings) {
        Ok(made) => {
            check_heat_step(context, heat, &made);
            Some(scene.with_heat(made, alone))
        }
        Err(error) => {
            context.error(&heat.place, format!(": {error}"), "");
            None
        }
    }
}

/// What the solids and the bonded bodies are to heat; an error for a body that is nothing to it.
fn thermal_materials(
    context: &mut Context<'_>,
    heat: &model::Heat,
) -> Option<(Vec<ThermalMaterial>, Vec<ThermalMaterial>)> {
    let case = context.case;
    if let Some(tie) = case.ties.first() {
        let found = ": heat does not pass through ties";
        context.error(&tie.solid.place, found, "bodies without ties where there is [heat]");
    }
    let (mut solids, mut bonded) = (Vec::new(), Vec::new());
    for body in &case.bodies {
        let (material, list) = match &body.kind {
            BodyKind::Solid(own) => (own.material, &mut solids),
            BodyKind::Bonded(own) => (own.material, &mut bonded),
            BodyKind::Rigid(_) => continue,
            BodyKind::Particles(_) => {
                let found = format!("= \"{}\": loose particles conduct no heat", body.name.value);
                context.error(&body.name.place, found, "solids, bonded and rigid bodies where there is [heat]");
                continue;
            }
        };
        let material = &case.materials[material];
        let Some(own) = &material.thermal else {
            let found = format!("= \"{}\": its material {} has no thermal table", body.name.value, material.name.value);
            let expected = format!("[materials.{}.thermal] with conductivity and heat_capacity", material.name.value);
            context.error(&body.name.place, found, expected);
            continue;
        };
        let model::Thermal { conductivity, heat_capacity, expansion } = own.value;
        list.push(ThermalMaterial { conductivity, capacity: heat_capacity, expansion });
    }
    if solids.is_empty() && bonded.is_empty() {
        context.error(&heat.place, ": there is nothing to conduct it", "a solid or bonded body");
    }
    context.without_mistakes()?;
    Some((solids, bonded))
}

/// A condition on nodes or particles; particles come after all nodes. A source is one of elements, which share their volume
/// among their nodes: those beside them that only have nodes of theirs are not heated.
fn heat_condition(
    context: &mut Context<'_>,
    condition: &model::HeatCondition,
    scene: &Scene,
    parts: &[Part],
    numbering: &Numbering,
    surface: &Surface,
) -> Option<HeatCondition> {
    let model::HeatCondition { on, area, kind } = condition;
    let of_particles = context.names_particles(on);
    let first = if of_particles { scene.solid.reference.len() as u32 } else { 0 };
    let points = match of_particles {
        true => LoadedPoints::Particles(&scene.bonded),
        false => LoadedPoints::Nodes(numbering, surface),
    };
    let value = function(&kind.function().value);
    let weighted = match kind {
        HeatKind::Temperature(_) => {
            let points = match &on.group {
                Some(group) if of_particles => context.selected_particles(on, group, &scene.bonded),
                _ => context.selected_nodes(on, numbering),
            };
            return Some(HeatCondition::Temperature { points: points.iter().map(|i| i + first).collect(), value });
        }
        HeatKind::Power(_) => context.shares(on, &points),
        HeatKind::Source(_) => match &on.group {
            Some(group) if of_particles => {
                let volumes = volumes_of_particles(scene);
                let own = context.selected_particles(on, group, &scene.bonded);
                own.into_iter().map(|i| (i, volumes[i as usize])).collect()
            }
            _ => {
                let elements = context.selected_elements(on, parts, &scene.solid).into_iter();
                let volume = |(body, element)| (body, element, scene.solid.element_volume(body, element));
                let volumes = scene.solid.lumped(elements.map(volume));
                (0..).zip(volumes).filter(|(_, volume)| *volume > 0.0).collect()
            }
        },
        HeatKind::Flux(_) | HeatKind::Convection { .. } => match (area, of_particles) {
            (Some(area), true) => context.shares(on, &points).into_iter().map(|(i, s)| (i, s * area.value)).collect(),
            (None, false) => surface.areas(&context.selected_facets(on, numbering, surface)),
            (Some(area), false) => {
                context.error(&area.place, ": facets have their own area", "no area where a mesh group is named");
                return None;
            }
            (None, true) => {
                let place = on.place().cloned().unwrap_or_else(|| context.whole_case());
                let found = format!("= \"{}\": particles have no surface of their own", on.label());
                context.error(&place, found, "area, that of the surface that they stand for");
                return None;
            }
        },
    };
    let points = weighted.into_iter().map(|(i, weight)| (i + first, weight)).collect();
    Some(match kind {
        HeatKind::Convection { coefficient, .. } => {
            HeatCondition::Convection { points, coefficient: *coefficient, ambient: value }
        }
        _ => HeatCondition::Supply { points, value },
    })
}

/// An explicit step that was asked for must be stable.
fn check_heat_step(context: &mut Context<'_>, heat: &model::Heat, made: &Heat) {
    let Some(step) = &heat.step else { return };
    if heat.scheme == HeatScheme::Explicit && step.value > made.stable_step() {
        let stable = quantity(made.stable_step(), "s");
        let found = format!("= {} is above the stable step {stable}", quantity(step.value, "s"));
        context.error(&step.place, found, "a lower one, none, or scheme = \"implicit\"");
    }
}

/// Volume of the continuum that belongs to every particle [m³].
fn volumes_of_particles(scene: &Scene) -> Vec<f64> {
    let mut volumes = scene.bonded.particles.mass.clone();
    for body in scene.bonded.bodies() {
        volumes[body.range.clone()].iter_mut().for_each(|volume| *volume /= body.density);
    }
    volumes
}
