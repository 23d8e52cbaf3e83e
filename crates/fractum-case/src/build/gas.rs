//! Gas in the holes of the mesh.

use fractum_fem::Solid;
use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_scene::{Gas, GasHole, GasSettings, GasSource, HoleEnds, Load, Support, SymmetryPlanes};

use super::conditions::LoadedPoints;
use super::{Context, function};
use crate::model::{self, SolverKind};

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
    let symmetry = SymmetryPlanes(gas.symmetry.each_ref().map(|plane| plane.as_ref().map(|plane| plane.value)));
    let mut holes: Vec<GasHole> = Vec::new();
    for hole in &gas.holes {
        let facets = context.selected_facets(&hole.on, numbering, surface);
        let ends = hole_ends(context, hole, solid, &facets, symmetry);
        check_symmetry(context, solid, &facets, supports);
        let known = holes.iter().flat_map(|other| &other.facets).any(|facet| facets.contains(facet));
        if let (true, Some(place)) = (known, hole.on.place()) {
            let found = format!("= \"{}\": shares facets with the hole before it", hole.on.label());
            context.error(&place.clone(), found, "holes without common facets");
        }
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
        symmetry,
        holes,
    };
    Some(Gas::new(solid, settings))
}

/// The ends of a hole; none where its facets do not close around a volume with them.
fn hole_ends(
    context: &mut Context<'_>,
    hole: &model::GasHole,
    solid: &Solid,
    facets: &[[u32; 3]],
    symmetry: SymmetryPlanes,
) -> Option<HoleEnds> {
    let place = hole.on.place().cloned().unwrap_or_else(|| context.whole_case());
    if hole.stemmed && solid.is_plane() {
        context.error(&place, ": stemmed in the plane, where a hole is a closed line", "stemmed = false");
        return None;
    }
    let name = hole.on.label();
    match HoleEnds::find(solid, facets, symmetry, hole.stemmed) {
        Ok(ends) if facets.is_empty() || Gas::hole_volume(solid, facets, &ends) > 0.0 => Some(ends),
        Ok(_) => {
            context.error(
                &place,
                format!("= \"{name}\": encloses the solid, and no hole in it"),
                "facets around a hole",
            );
            None
        }
        Err(node) => {
            let p: Vec3 = solid.reference[node as usize];
            let at = format!("({:.4e}, {:.4e}, {:.4e}) m", p.x, p.y, p.z);
            if hole.stemmed {
                let expected = "a hole whose ends are flat rings of edges, or lie on planes of gas.symmetry";
                context.error(&place, format!(": its end at {at} is not flat"), expected);
            } else {
                let expected = "all facets around the hole: a closed surface, in the plane a closed line; or gas.symmetry, \
                                planes at which it ends";
                context.error(&place, format!("= \"{name}\": is not closed, it ends at {at}"), expected);
            }
            None
        }
    }
}

/// Walls that end at a plane of symmetry are held there, or the hole would open towards its mirror image.
fn check_symmetry(context: &mut Context<'_>, solid: &Solid, facets: &[[u32; 3]], supports: &[Support]) {
    let Some(gas) = &context.case.flows.gas else { return };
    for (axis, plane) in gas.symmetry.iter().enumerate() {
        let Some(plane) = plane else { continue };
        let only = SymmetryPlanes(std::array::from_fn(|a| (a == axis).then_some(plane.value)));
        let size = |facet: &[u32; 3]| (solid.reference[facet[0] as usize] - solid.reference[facet[1] as usize]).norm();
        let mut ends = facets.iter().flat_map(|facet| facet.map(|node| (node, size(facet))));
        let held = |node: u32| supports.iter().any(|s| s.axis == axis && s.points.contains(&node));
        let free = ends.find(|&(node, size)| only.hold(solid, &[node], size) && !held(node));
        if let Some((node, _)) = free {
            let (p, name) = (solid.reference[node as usize], ["x", "y", "z"][axis]);
            let found =
                format!(": the wall of a hole at ({:.4e}, {:.4e}, {:.4e}) m may leave the plane", p.x, p.y, p.z);
            let remedy =
                format!("a support with fix = \"{name}\" on the solid at {name} = {}", quantity(plane.value, "m"));
            context.error(&plane.place.clone(), found, remedy);
        }
    }
}
