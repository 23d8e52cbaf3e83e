//! Gas in the holes of the mesh.

use std::collections::BTreeMap;

use fractum_fem::Solid;
use fractum_math::Vec3;
use fractum_scene::{Gas, GasHole, GasSettings, GasSource, Load, Stemming};

use super::conditions::LoadedPoints;
use super::{Context, function};
use crate::case::model::{self, Selection, SolverKind};

impl Context<'_> {
    /// The gas of the case on the groups of the mesh; none in a stage at rest.
    pub(super) fn gas(&mut self, solid: &Solid, points: &LoadedPoints, loads: &[Load]) -> Option<Gas> {
        let case = self.case;
        let gas = case.gas.as_ref().filter(|_| case.solver.kind == SolverKind::Explicit)?;
        if loads.iter().any(|load| matches!(load, Load::CrackPressure(_))) {
            self.error(&gas.place, ": a load enters cracks too", "either gas or loads with in_cracks");
        }
        let LoadedPoints::Nodes(numbering, surface) = points else { return None };
        let mut holes: Vec<GasHole> = Vec::new();
        for hole in &gas.holes {
            let facets = self.selected_facets(&hole.on, numbering, surface);
            let stemming = self.stemming(hole, solid, &facets);
            self.check_hole(&hole.on, solid, &facets, stemming.as_ref());
            let known = holes.iter().flat_map(|other| &other.facets).any(|facet| facets.contains(facet));
            if let (true, Some(place)) = (known, hole.on.place()) {
                let found = format!("= \"{}\": shares facets with the hole before it", hole.on.label());
                self.error(&place.clone(), found, "holes without common facets");
            }
            let source = hole.source.as_ref();
            let source =
                source.map(|[mass, energy]| GasSource { mass: function(&mass.value), energy: function(&energy.value) });
            holes.push(GasHole { facets, stemming: stemming.unwrap_or_default(), charge: hole.charge, source });
        }
        if !self.diagnostics.is_empty() {
            return None;
        }
        let settings = GasSettings {
            law: gas.law,
            slits: gas.slits,
            least_opening: gas.least_opening,
            in_cracks: gas.in_cracks,
            outside_pressure: gas.outside_pressure,
            holes,
        };
        Some(Gas::new(solid, settings))
    }

    /// The stemmed ends of a hole that has any.
    fn stemming(&mut self, hole: &model::GasHole, solid: &Solid, facets: &[[u32; 3]]) -> Option<Stemming> {
        if !hole.stemmed {
            return None;
        }
        let place = hole.on.place().cloned().unwrap_or_else(|| self.whole_case());
        if solid.is_plane() {
            self.error(&place, ": stemmed in the plane, where a hole is a closed line", "stemmed = false");
            return None;
        }
        match Stemming::find(solid, facets) {
            Ok(stemming) => Some(stemming),
            Err(node) => {
                let p: Vec3 = solid.reference[node as usize];
                let found = format!(": its end at ({:.4e}, {:.4e}, {:.4e}) m is not flat", p.x, p.y, p.z);
                self.error(&place, found, "a hole whose ends are flat rings of edges");
                None
            }
        }
    }

    /// The facets of a hole close around a volume.
    fn check_hole(&mut self, on: &Selection, solid: &Solid, facets: &[[u32; 3]], stemming: Option<&Stemming>) {
        let Some(place) = on.place().cloned().filter(|_| !facets.is_empty()) else { return };
        let name = on.label();
        let open = if stemming.is_none() { open_end(facets) } else { None };
        if let Some(open) = open {
            let p: Vec3 = solid.reference[open as usize];
            let found = format!("= \"{name}\": is not closed, it ends at ({:.4e}, {:.4e}, {:.4e}) m", p.x, p.y, p.z);
            self.error(&place, found, "all facets around the hole: a closed surface, in the plane a closed line");
        } else if Gas::hole_volume(solid, facets, stemming.unwrap_or(&Stemming::default())) <= 0.0 {
            let found = format!("= \"{name}\": encloses the solid, and no hole in it");
            self.error(&place, found, "facets around a hole");
        }
    }
}

/// A node at which facets with outward normals end: of an edge that no other facet runs back along, in the plane of a line.
pub(super) fn open_end(facets: &[[u32; 3]]) -> Option<u32> {
    let mut balance: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for &[a, b, c] in facets {
        if b == c {
            *balance.entry((a, a)).or_default() += 1;
            *balance.entry((b, b)).or_default() -= 1;
        } else {
            for (i, j) in [(a, b), (b, c), (c, a)] {
                *balance.entry((i.min(j), i.max(j))).or_default() += if i < j { 1 } else { -1 };
            }
        }
    }
    balance.into_iter().find(|(_, count)| *count != 0).map(|((node, _), _)| node)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_surfaces_are_closed_or_end_somewhere() {
        let square = [[0, 1, 1], [1, 2, 2], [2, 3, 3], [3, 0, 0]];
        assert_eq!((open_end(&square), open_end(&square[..3])), (None, Some(0)));
        let tetrahedron = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        assert_eq!((open_end(&tetrahedron), open_end(&tetrahedron[1..])), (None, Some(1)));
    }
}
