//! The edges that take part in the phase fields of a solid.

use crate::cells::cell::Geometry;
use crate::damage::phase::{Patch, PhaseField};
use crate::solid::{BodyModel, Solid};

/// Does some work with the phase field of each body, which the solid is without meanwhile.
pub(crate) fn for_each_phase_field(solid: &mut Solid, mut work: impl FnMut(&mut Solid, usize, &mut PhaseField)) {
    for body in 0..solid.bodies.len() {
        let Some(mut field) = solid.bodies[body].phase.take() else { continue };
        work(solid, body, &mut field);
        solid.bodies[body].phase = Some(field);
    }
}

/// Lets every edge take part in the phase field of its body, as a search for equilibrium needs it.
pub fn wake_phase_fields(solid: &mut Solid) {
    for_each_phase_field(solid, |solid, body, field| {
        let edges = (0..field.value.len() as u32).filter(|&edge| !field.is_active(edge)).collect::<Vec<u32>>();
        activate(solid, body, field, &edges);
    });
}

/// Activates the edges that have passed their strength in the last forces.
pub(crate) fn wake(solid: &mut Solid, body: usize, field: &mut PhaseField) {
    let (mut woken, mut any) = (Vec::new(), false);
    let own = solid.own_blocks();
    let Solid { blocks, bodies, neighbours, .. } = solid;
    let blocks = blocks.iter_mut().enumerate().filter(|(_, block)| block.body == body);
    for (cells, is_own) in blocks.filter_map(|(index, block)| Some((block.edge_field_mut()?, own.contains(&index)))) {
        if std::mem::take(&mut cells.woken) {
            any = true;
            woken.extend(is_own.then(|| cells.above_strength()).into_iter().flatten());
        }
    }
    if any {
        woken = neighbours.gather_names(woken);
    }
    // Every process finds the edges of the standard formulation.
    if let Some(standard) = &mut bodies[body].standard
        && std::mem::take(&mut standard.field.woken)
    {
        woken.extend(standard.field.above_strength());
    }
    activate(solid, body, field, &woken);
}

/// Activates those of these edges that may be damaged and are not active yet.
pub(crate) fn activate(solid: &Solid, body: usize, field: &mut PhaseField, edges: &[u32]) {
    let model = &solid.bodies[body];
    let Some(patch) = patch(solid, model) else { return };
    for &edge in edges {
        let strength = solid.edge(body, edge).map_or(f64::INFINITY, |(cells, cell)| cells.strength[cell]);
        if strength.is_finite() && !field.is_active(edge) {
            let block = (!model.needs_all_cells()).then(|| model.location.of(edge).0 as usize);
            let rank = block.map_or(0, |block| solid.neighbours.owner(block));
            field.activate(&patch, (edge, rank), field.law.a1(strength));
            block.into_iter().for_each(|block| field.wake_block(block));
        }
    }
}

fn patch<'a>(solid: &'a Solid, model: &'a BodyModel) -> Option<Patch<'a>> {
    let geometry = Geometry { body: &model.body, nodes: &solid.reference };
    let BodyModel { edges, alive, .. } = model;
    Some(Patch { geometry, edges: edges.as_ref()?, alive })
}

/// Takes the share of removed elements out of the phase field of a body.
///
/// - `edges`: those of the elements
pub(crate) fn refresh_phase(solid: &mut Solid, body: usize, edges: &[u32]) {
    let Some(mut field) = solid.bodies[body].phase.take() else { return };
    if let Some(patch) = patch(solid, &solid.bodies[body]) {
        field.refresh(&patch, edges);
    }
    solid.bodies[body].phase = Some(field);
}

/// Puts the saved phase field of a body back, for the elements that are there.
pub(crate) fn restore_phase(solid: &mut Solid, body: usize, state: &[(u32, [f64; 2], bool)]) {
    let Some(mut field) = solid.bodies[body].phase.take() else { return };
    field.clear();
    for &(edge, values, rebuilt) in state {
        activate(solid, body, &mut field, &[edge]);
        field.restore_last(values, rebuilt);
    }
    solid.bodies[body].phase = Some(field);
}
