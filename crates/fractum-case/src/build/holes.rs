//! Holes of the mesh that hold gas or liquid: their ends, and what holds them there.

use fractum_fem::Solid;
use fractum_math::{Vec3, connected};
use fractum_output::number::quantity;
use fractum_scene::{Gas, HoleEnds, SymmetryPlanes};

use super::Context;
use super::bodies::Numbering;
use crate::Spanned;
use crate::selection::Selection;

/// Planes of symmetry as a case has them.
pub(super) type Planes = [Option<Spanned<f64>>; 3];

/// Holes of a case.
pub(super) struct Holes<'a> {
    /// Name of the table that they are in.
    pub(super) table: &'static str,
    pub(super) planes: &'a Planes,
    pub(super) solid: &'a Solid,
    /// Whether a support holds an axis of a node.
    pub(super) held: &'a dyn Fn(u32, usize) -> bool,
    /// The smallest node at the place of each: interfaces have cut the mesh there.
    at: Vec<u32>,
}

impl<'a> Holes<'a> {
    pub(super) fn new(
        context: &Context<'_>,
        numbering: &Numbering,
        table: &'static str,
        planes: &'a Planes,
        solid: &'a Solid,
        held: &'a dyn Fn(u32, usize) -> bool,
    ) -> Self {
        let node = |n: u32| numbering.scene_node[n as usize];
        let pairs = context.mesh.cuts.iter().flat_map(|face| [0, 1, 2].map(|k| face.sides.map(|side| node(side[k]))));
        Holes { table, planes, solid, held, at: connected(solid.reference.len(), pairs) }
    }

    /// Planes at which they may end.
    pub(super) fn symmetry(&self) -> SymmetryPlanes {
        SymmetryPlanes(self.planes.each_ref().map(|plane| plane.as_ref().map(|plane| plane.value)))
    }

    /// The ends of a hole; none where its facets do not close around a volume with them, or have been taken by a hole before it.
    pub(super) fn ends(
        &self,
        context: &mut Context<'_>,
        (on, stemmed): (&Selection, bool),
        facets: &[[u32; 3]],
        others: &[&[[u32; 3]]],
    ) -> Option<HoleEnds> {
        let ends = self.found_ends(context, (on, stemmed), facets);
        self.check_symmetry(context, facets);
        let known = others.iter().flat_map(|other| *other).any(|facet| facets.contains(facet));
        if let (true, Some(place)) = (known, on.place()) {
            let found = format!("= \"{}\": shares facets with the hole before it", on.label());
            context.error(&place.clone(), found, "holes without common facets");
        }
        ends
    }

    fn found_ends(
        &self,
        context: &mut Context<'_>,
        (on, stemmed): (&Selection, bool),
        facets: &[[u32; 3]],
    ) -> Option<HoleEnds> {
        let (solid, name) = (self.solid, on.label());
        let place = on.place().cloned().unwrap_or_else(|| context.whole_case());
        if stemmed && solid.is_plane() {
            context.error(&place, ": stemmed in the plane, where a hole is a closed line", "stemmed = false");
            return None;
        }
        let joined: Vec<[u32; 3]> = facets.iter().map(|facet| facet.map(|node| self.at[node as usize])).collect();
        match HoleEnds::find(solid, &joined, self.symmetry(), stemmed) {
            Ok(ends) if facets.is_empty() || Gas::hole_volume(solid, facets, &ends) > 0.0 => Some(ends),
            Ok(_) => {
                let found = format!("= \"{name}\": encloses the solid, and no hole in it");
                context.error(&place, found, "facets around a hole");
                None
            }
            Err(node) => {
                let p: Vec3 = solid.reference[node as usize];
                let at = format!("({:.4e}, {:.4e}, {:.4e}) m", p.x, p.y, p.z);
                let table = self.table;
                if stemmed {
                    let expected =
                        format!("a hole whose ends are flat rings of edges, or lie on planes of {table}.symmetry");
                    context.error(&place, format!(": its end at {at} is not flat"), expected);
                } else {
                    let expected = format!(
                        "all facets around the hole: a closed surface, in the plane a closed line; or {table}.symmetry, \
                         planes at which it ends"
                    );
                    context.error(&place, format!("= \"{name}\": is not closed, it ends at {at}"), expected);
                }
                None
            }
        }
    }

    /// Walls that end at a plane of symmetry are held there, or the hole would open towards its mirror image.
    fn check_symmetry(&self, context: &mut Context<'_>, facets: &[[u32; 3]]) {
        let Holes { planes, solid, held, .. } = self;
        for (axis, plane) in planes.iter().enumerate() {
            let Some(plane) = plane else { continue };
            let only = self.symmetry().only(axis);
            let size =
                |facet: &[u32; 3]| (solid.reference[facet[0] as usize] - solid.reference[facet[1] as usize]).norm();
            let mut ends = facets.iter().flat_map(|facet| facet.map(|node| (node, size(facet))));
            let free = ends.find(|&(node, size)| only.hold(solid, &[node], size) && !held(node, axis));
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
}
