//! Doubts about the conduction of heat: fronts that are thinner than the elements they pass, and steps too long for them.

use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_scene::{HeatCondition, Scene};

use super::body_doubts::named;
use crate::Diagnostic;
use crate::model::{BodyKind, Case, Heat, HeatKind, HeatScheme};

/// Layers of elements that a front passes within the run at least: at 1.5 of them the surface of a half-space under a steady flow is 3 % too
/// cold, at 1 of them 7 %, at 0.5 29 %.
const LAYERS: f64 = 1.5;
/// Implicit steps of a run at least: ten are off by 2 % beside a surface in a flow.
const STEPS: f64 = 10.0;
/// Instants at which a condition is looked at.
const LOOKS: u32 = 20;

/// Doubts about a condition on a surface, at whose facets heat enters or leaves.
pub(super) fn front(case: &Case, heat: &Heat, index: usize, made: &HeatCondition, scene: &Scene) -> Option<Diagnostic> {
    let condition = &heat.conditions[index];
    let end = case.solver.end;
    let from = condition.kind.function().value.rise().map_or(0.0, |[start, _]| start);
    if matches!(condition.kind, HeatKind::Source(_)) || from >= end || !acts(heat, made, scene, end) {
        return None;
    }
    let (depth, layer) = layers(case, made, scene)
        .map(|(diffusivity, layer)| ((diffusivity * (end - from)).sqrt(), layer))
        .min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
    if depth >= LAYERS * layer {
        return None;
    }
    let [goes, thick, wanted] = [depth, layer, depth / LAYERS].map(|length| quantity(length, "m"));
    let found = format!(
        "{}: heat goes {goes} deep within the run, and the elements there are {thick} thick",
        named(&condition.on)
    );
    let place = condition.on.place().unwrap_or(&heat.place);
    Some(Diagnostic::warning(Code::CoarseMesh, place, found).expected(format!("at most {wanted}")).remedy(
        "temperatures there, the heat that passes and thermal stress are off: refine the mesh along the surface, or let the run last longer",
    ))
}

/// Few implicit steps in a run that ends before its heat has spread.
pub(super) fn long_steps(case: &Case, heat: &Heat, scene: &Scene) -> Option<Diagnostic> {
    let step = heat.step.as_ref().filter(|_| heat.scheme == HeatScheme::Implicit)?;
    let count = case.solver.end / step.value;
    if count >= STEPS * (1.0 - 1e-9) {
        return None;
    }
    let size = |range: &[[u32; 4]]| {
        let places = || range.iter().flatten().map(|&node| scene.solid.reference[node as usize]);
        let (low, high) = (places().reduce(|a, b| a.inf(&b))?, places().reduce(|a, b| a.sup(&b))?);
        Some((high - low).norm())
    };
    let spreads = (0..scene.solid.body_count()).filter_map(|body| {
        Some(size(&scene.solid.body(body).elements)?.powi(2) / diffusivities(case, true).nth(body)?)
    });
    // What has come to its end does not tell how it came there.
    let slowest = spreads.fold(0.0, f64::max);
    if slowest < case.solver.end {
        return None;
    }
    let plural = if count > 1.0 { "steps" } else { "step" };
    let found = format!("= {}: {} {plural} in the run", quantity(step.value, "s"), count.ceil());
    let most = quantity(case.solver.end / STEPS, "s");
    let note = Diagnostic::warning(Code::TimeStep, &step.place, found).expected(format!("at most {most}"));
    Some(note.remedy("temperatures lag behind: take a smaller step"))
}

/// Whether a condition changes anything within the run.
fn acts(heat: &Heat, made: &HeatCondition, scene: &Scene, end: f64) -> bool {
    let places = || scene.solid.reference.iter().chain(scene.bonded.reference());
    let (points, value, from_start): (Vec<u32>, _, _) = match made {
        HeatCondition::Temperature { points, value } => (points.clone(), value, true),
        HeatCondition::Supply { points, value } => (points.iter().map(|own| own.0).collect(), value, false),
        HeatCondition::Convection { points, ambient, .. } => (points.iter().map(|own| own.0).collect(), ambient, true),
    };
    points.iter().step_by(points.len().div_ceil(10).max(1)).any(|&point| {
        let Some(&place) = places().nth(point as usize) else { return false };
        let before = if from_start { heat.initial.value.at(place) } else { 0.0 };
        (0..=LOOKS).any(|look| {
            let now = value(end * f64::from(look) / f64::from(LOOKS), &place);
            (now - before).abs() > 1e-6 * before.abs().max(f64::MIN_POSITIVE)
        })
    })
}

/// Diffusivities of the solid or of the bonded bodies [m²/s].
fn diffusivities(case: &Case, solids: bool) -> impl Iterator<Item = f64> {
    let of = move |body: &crate::model::Body| {
        let material = match &body.kind {
            BodyKind::Solid(own) if solids => own.material,
            BodyKind::Bonded(own) if !solids => own.material,
            _ => return None,
        };
        let (material, own) = (&case.materials[material], case.materials[material].thermal.as_ref()?.value);
        Some(own.conductivity / (material.density * own.heat_capacity))
    };
    case.bodies.iter().filter_map(of)
}

/// Diffusivity [m²/s] of each body at whose surface a condition acts, and mean thickness of its elements or particles there [m].
fn layers(case: &Case, made: &HeatCondition, scene: &Scene) -> impl Iterator<Item = (f64, f64)> {
    let solid = &scene.solid;
    let mut is_in = vec![false; solid.reference.len() + scene.bonded.reference().len()];
    match made {
        HeatCondition::Temperature { points, .. } => points.iter().for_each(|&i| is_in[i as usize] = true),
        HeatCondition::Supply { points, .. } | HeatCondition::Convection { points, .. } => {
            points.iter().for_each(|&(i, _)| is_in[i as usize] = true);
        }
    }
    let mean = |layers: Vec<f64>| {
        let count = layers.len();
        (count > 0).then(|| layers.into_iter().sum::<f64>() / count as f64)
    };
    let mut found = Vec::new();
    for (index, diffusivity) in diffusivities(case, true).enumerate().take(solid.body_count()) {
        let body = solid.body(index);
        let corners = body.shape.node_count();
        let layer = |nodes: &[u32; 4]| {
            let (on, off): (Vec<u32>, Vec<u32>) = nodes[..corners].iter().partition(|&&node| is_in[node as usize]);
            let [apex] = off[..] else { return None };
            let place = |node: u32| solid.reference[node as usize];
            Some(altitude(place(apex), &on.into_iter().map(place).collect::<Vec<Vec3>>()))
        };
        // Elements that are heated as a whole are no surface.
        let is_whole = |nodes: &[u32; 4]| nodes[..corners].iter().all(|&node| is_in[node as usize]);
        let whole = body.elements.iter().filter(|nodes| is_whole(nodes)).count();
        let own: Vec<f64> = body.elements.iter().filter_map(layer).collect();
        if whole < own.len() {
            found.extend(mean(own).map(|layer| (diffusivity, layer)));
        }
    }
    for (body, diffusivity) in scene.bonded.bodies().iter().zip(diffusivities(case, false)) {
        let own = body.range.clone().filter(|&i| is_in[solid.reference.len() + i]);
        let own: Vec<f64> = own.map(|i| 2.0 * scene.bonded.particles.radius[i]).collect();
        if own.len() < body.range.len() / 2 {
            found.extend(mean(own).map(|layer| (diffusivity, layer)));
        }
    }
    found.into_iter()
}

/// Height of a corner over the facet across from it, a line or a triangle [m].
fn altitude(apex: Vec3, facet: &[Vec3]) -> f64 {
    match facet {
        [a, b, c] => {
            let normal = (b - a).cross(&(c - a));
            (apex - a).dot(&normal).abs() / normal.norm()
        }
        [a, b] => (apex - a).cross(&(b - a)).norm() / (b - a).norm(),
        _ => 0.0,
    }
}
