//! Gas in the holes of the mesh.

use fractum_fem::Solid;
use fractum_scene::{Gas, GasHole, GasSettings, GasSource, Load, Support};

use super::conditions::LoadedPoints;
use super::holes::Holes;
use super::{Context, function};
use crate::model::SolverKind;

/// The gas of the case on the groups of the mesh; none in a stage at rest.
pub(super) fn gas(
    context: &mut Context<'_>,
    solid: &Solid,
    points: &LoadedPoints,
    supports: &[Support],
    loads: &[Load],
) -> Option<Gas> {
    let case = context.case;
    let gas = case.flows.gas.as_ref().filter(|_| case.solver.kind == SolverKind::Explicit)?;
    if loads.iter().any(|load| matches!(load, Load::CrackPressure(_))) {
        context.error(&gas.place, ": a load enters cracks too", "either gas or loads with in_cracks");
    }
    let LoadedPoints::Nodes(numbering, surface) = points else { return None };
    let held = |node: u32, axis: usize| supports.iter().any(|s| s.axis == axis && s.points.contains(&node));
    let of_mesh = Holes::new(context, numbering, "gas", &gas.symmetry, solid, &held);
    let mut holes: Vec<GasHole> = Vec::new();
    for hole in &gas.holes {
        let facets = context.selected_facets(&hole.on, numbering, surface);
        let others: Vec<&[[u32; 3]]> = holes.iter().map(|other| &other.facets[..]).collect();
        let ends = of_mesh.ends(context, (&hole.on, hole.stemmed), &facets, &others);
        let source = hole.source.as_ref();
        let source =
            source.map(|[mass, energy]| GasSource { mass: function(&mass.value), energy: function(&energy.value) });
        holes.push(GasHole {
            facets,
            ends: ends.unwrap_or_default(),
            charge: hole.charge,
            source,
            stemming: hole.stemming,
        });
    }
    if !context.diagnostics.is_empty() {
        return None;
    }
    let settings = GasSettings {
        law: gas.law,
        slits: gas.slits,
        least_opening: gas.least_opening,
        in_cracks: gas.in_cracks,
        outside_pressure: gas.outside_pressure,
        symmetry: of_mesh.symmetry(),
        holes,
    };
    Some(Gas::new(solid, settings))
}
