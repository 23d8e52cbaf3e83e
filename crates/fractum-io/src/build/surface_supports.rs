//! Absorbing and elastic supports on facets of the solids.

use std::collections::HashMap;

use fractum_fem::{Elastic, ElementKind, Plane, Solid};
use fractum_scene::{SupportedFacet, SurfaceSupports};

use super::Context;
use super::bodies::{Numbering, Part};
use super::conditions::{Surface, sorted};
use crate::case::model::{self, SolverKind, SurfaceSupport};

impl Context<'_> {
    /// Supports on facets, and all facets that they are on.
    pub(super) fn surface_supports(
        &mut self,
        parts: &[Part],
        numbering: &Numbering,
        surface: &Surface,
        solid: &Solid,
    ) -> (SurfaceSupports, Vec<[u32; 3]>) {
        let case = self.case;
        let (mut absorbing, mut elastic, mut all) = (Vec::new(), Vec::new(), Vec::new());
        if case.supports.iter().all(|support| support.surface.is_none()) {
            return (SurfaceSupports::default(), all);
        }
        let materials = materials_behind(parts, solid, surface);
        let outer = outer_facets(surface);
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
                match kind.value {
                    SurfaceSupport::Absorbing => {
                        let along_and_across = impedance(materials[&sorted(*facet)]);
                        absorbing.push(SupportedFacet { nodes: *facet, normal, area, along_and_across });
                    }
                    SurfaceSupport::Elastic { normal: along, tangential: across } => {
                        let along_and_across = [along, across];
                        elastic.push(SupportedFacet { nodes: *facet, normal, area, along_and_across });
                    }
                }
            }
            all.extend(facets);
        }
        all.sort_unstable();
        all.dedup();
        (SurfaceSupports::new(&absorbing, &elastic, &solid.mass), all)
    }

    /// Both answer to motion.
    fn check_solver(&mut self, kind: &SurfaceSupport, place: &crate::case::Place) {
        let at_rest = self.case.solver.kind != SolverKind::Explicit;
        let only_stage = self.case.source.stage.is_empty();
        if at_rest && (only_stage || matches!(kind, SurfaceSupport::Elastic { .. })) {
            self.error(
                place,
                ": it acts in motion only",
                "kind = \"explicit\", or stages = [...] without those at rest",
            );
        }
    }

    /// Waves leave through the outer boundary: a cavity is where they come from.
    fn check_outer(&mut self, support: &model::Support, facets: &[[u32; 3]], outer: &HashMap<u32, bool>) {
        if facets.iter().any(|facet| !outer[&facet[0]]) {
            let place = support.on.place().cloned().unwrap_or_else(|| self.whole_case());
            let found = format!("= \"{}\" has facets of a cavity, an inner boundary", support.on.label());
            self.error(&place, found, "facets on the outer boundary, through which waves leave");
        }
    }
}

/// ρ c_P and ρ c_S [Pa s/m].
fn impedance((elastic, plane): (Elastic, Plane)) -> [f64; 2] {
    let Elastic { density, young_modulus, poisson_ratio } = elastic;
    let along = match plane {
        Plane::Strain => elastic.p_wave_speed(),
        // The plate wave.
        Plane::Stress => (young_modulus / (density * (1.0 - poisson_ratio * poisson_ratio))).sqrt(),
    };
    [density * along, density * elastic.s_wave_speed()]
}

/// The material behind every facet of the surface.
fn materials_behind(parts: &[Part], solid: &Solid, surface: &Surface) -> HashMap<[u32; 3], (Elastic, Plane)> {
    let mut found = HashMap::new();
    for (index, part) in parts.iter().enumerate() {
        let body = solid.body(index);
        let plane = if part.shape == ElementKind::T3 { body.plane } else { Plane::Strain };
        for &[a, b, c, d] in &body.elements {
            let sides = match part.shape {
                ElementKind::T3 => [[a, b, b], [b, c, c], [c, a, a], [a, b, b]],
                ElementKind::T4 => [[a, b, c], [a, b, d], [a, c, d], [b, c, d]],
            };
            for side in sides.map(sorted) {
                if surface.outward(side).is_some() {
                    found.insert(side, (body.elastic, plane));
                }
            }
        }
    }
    found
}

/// For every node of the surface, whether the closed part of it that the node is on encloses material, not a cavity.
fn outer_facets(surface: &Surface) -> HashMap<u32, bool> {
    let mut parent: HashMap<u32, u32> = surface.facets.iter().flatten().map(|&node| (node, node)).collect();
    fn root(parent: &mut HashMap<u32, u32>, mut node: u32) -> u32 {
        while parent[&node] != node {
            let above = parent[&parent[&node]];
            parent.insert(node, above);
            node = above;
        }
        node
    }
    for facet in surface.facets {
        for &other in &facet[1..] {
            let (a, b) = (root(&mut parent, facet[0]), root(&mut parent, other));
            parent.insert(a.max(b), a.min(b));
        }
    }
    let mut volume: HashMap<u32, f64> = HashMap::new();
    for facet in surface.facets {
        let own = root(&mut parent, facet[0]);
        *volume.entry(own).or_default() += surface.area_vector(facet).dot(&surface.middle(facet));
    }
    let nodes: Vec<u32> = parent.keys().copied().collect();
    nodes.into_iter().map(|node| (node, volume[&root(&mut parent, node)] > 0.0)).collect()
}
