//! Absorbing and elastic supports on facets of the solids.

use std::collections::HashMap;

use fractum_fem::{Elastic, ElementKind, Solid, is_axisymmetric};
use fractum_math::{Mat3, Vec3, connected};
use fractum_scene::{SupportedFacet, SurfaceSupports};

use super::Context;
use super::bodies::{Numbering, Part};
use super::conditions::{Surface, sorted};
use crate::model::{self, SolverKind, SurfaceSupport};

impl Context<'_> {
    /// Supports on facets, and all facets that they are on.
    pub(super) fn surface_supports(
        &mut self,
        parts: &[Part],
        numbering: &Numbering,
        surface: &Surface,
        solid: &Solid,
        boundary_of_parts: &[Vec<[u32; 3]>],
    ) -> (SurfaceSupports, Vec<[u32; 3]>) {
        let case = self.case;
        let (mut absorbing, mut elastic, mut all) = (Vec::new(), Vec::new(), Vec::new());
        if case.supports.iter().all(|support| support.surface.is_none()) {
            return (SurfaceSupports::default(), all);
        }
        let behind = bodies_behind(parts, solid, surface, boundary_of_parts);
        let outer = is_outer(surface, numbering.positions.len());
        for support in &case.supports {
            let Some(kind) = &support.surface else { continue };
            if self.names_particles(&support.on) {
                self.error(&kind.place, ": particles have no facets", "facets on the surface of a solid body");
                continue;
            }
            self.check_solver(&kind.value, &kind.place);
            let facets = self.selected_facets(&support.on, numbering, surface);
            if kind.value == SurfaceSupport::Absorbing {
                self.check_outer(support, &facets, &outer);
            }
            for facet in &facets {
                let vector = surface.area_vector(facet);
                let (normal, area) = (vector.normalize(), vector.norm());
                let (supports, answer) = match kind.value {
                    SurfaceSupport::Absorbing => (&mut absorbing, impedance(solid, behind[&sorted(*facet)], normal)),
                    SurfaceSupport::Elastic { normal: along, tangential } => {
                        (&mut elastic, SupportedFacet::along_and_across(normal, [along, tangential]))
                    }
                };
                if is_axisymmetric(solid) {
                    let of_node = |(node, area)| SupportedFacet { nodes: [node; 3], area, answer };
                    supports.extend(surface.areas(&[*facet]).into_iter().map(of_node));
                    continue;
                }
                supports.push(SupportedFacet { nodes: *facet, area, answer });
            }
            all.extend(facets);
        }
        all.sort_unstable();
        all.dedup();
        (SurfaceSupports::new(&absorbing, &elastic, &solid.mass), all)
    }

    /// Both answer to motion; springs have a part in natural vibrations too.
    fn check_solver(&mut self, kind: &SurfaceSupport, place: &crate::Place) {
        let is_elastic = matches!(kind, SurfaceSupport::Elastic { .. });
        let only_stage = self.case.source.stage.is_empty();
        let (found, expected) = match self.case.solver.kind {
            SolverKind::Explicit => return,
            SolverKind::Modes if is_elastic => return,
            SolverKind::Modes => (": it damps, and natural vibrations go on", "an elastic support, fix, or none"),
            _ if only_stage || is_elastic => {
                (": it acts in motion only", "kind = \"explicit\", or stages = [...] without those at rest")
            }
            _ => return,
        };
        self.error(place, found, expected);
    }

    /// Waves leave through the outer boundary: a cavity is where they come from.
    fn check_outer(&mut self, support: &model::Support, facets: &[[u32; 3]], outer: &[bool]) {
        if facets.iter().any(|facet| !outer[facet[0] as usize]) {
            let place = support.on.place().cloned().unwrap_or_else(|| self.whole_case());
            let found = format!("= \"{}\" has facets of a cavity, an inner boundary", support.on.label());
            self.error(&place, found, "facets on the outer boundary, through which waves leave");
        }
    }
}

/// Traction per velocity of a facet through which the waves of a body leave [Pa s/m]: ρ c_P along its normal and ρ c_S across it, or with beds
/// √(ρ Γ) with Christoffel's tensor of its normal.
fn impedance(solid: &Solid, index: usize, normal: Vec3) -> Mat3 {
    let body = solid.body(index);
    let Elastic { density, .. } = body.elastic;
    let Some(stiffness) = body.stiffness() else {
        let speeds = [solid.p_wave_speed(index), body.elastic.s_wave_speed()];
        return SupportedFacet::along_and_across(normal, speeds.map(|speed| density * speed));
    };
    stiffness.impedance(density, normal)
}

/// The body behind every facet of the surface.
///
/// - `boundary_of_parts`: facets of each body in space
fn bodies_behind(
    parts: &[Part],
    solid: &Solid,
    surface: &Surface,
    boundary_of_parts: &[Vec<[u32; 3]>],
) -> HashMap<[u32; 3], usize> {
    let mut found = HashMap::new();
    for (index, part) in parts.iter().enumerate() {
        let body = solid.body(index);
        let sides: Vec<[u32; 3]> = match part.shape {
            ElementKind::T3 => {
                body.elements.iter().flat_map(|&[a, b, c, _]| [[a, b, b], [b, c, c], [c, a, a]]).collect()
            }
            ElementKind::T4 => boundary_of_parts[index].clone(),
        };
        let outer = sides.into_iter().map(sorted).filter(|side| surface.outward(*side).is_some());
        found.extend(outer.map(|side| (side, index)));
    }
    found
}

/// For every node, whether the closed part of the surface that it is on encloses material; false on cavities.
fn is_outer(surface: &Surface, nodes: usize) -> Vec<bool> {
    let links = surface.facets.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]);
    let part = connected(nodes, links);
    let mut volume = vec![0.0; nodes];
    for facet in surface.facets {
        volume[part[facet[0] as usize] as usize] += surface.area_vector(facet).dot(&surface.middle(facet));
    }
    part.into_iter().map(|part| volume[part as usize] > 0.0).collect()
}
