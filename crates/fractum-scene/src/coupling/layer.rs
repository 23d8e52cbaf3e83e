//! Which particles of a bonded body touch the surface that they are to be tied to.

use fractum_contact::{FacetMesh, nearest_facets};
use fractum_dem::Particles;
use fractum_fem::Solid;
use fractum_math::Vec3;

/// A particle that is to follow a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// Particle of the scene.
    pub particle: u32,
    /// Nodes of the facet, counter-clockwise from outside the solid.
    pub facet: [u32; 3],
    /// Shares of the nodes, which add up to 1.
    pub weights: [f64; 3],
}

/// What was found where particles and a surface were to be tied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Particles within reach, ascending, each at its nearest facet.
    pub attachments: Vec<Attachment>,
    /// Facets that have a particle.
    pub facets: usize,
    /// Least gap between the surface of a particle and a facet [m]; negative where they overlap.
    pub least_gap: f64,
}

impl Layer {
    /// The particles of a set that touch a surface.
    ///
    /// - `facets`: nodes of the solid; `among`: particles of the scene, ascending
    /// - `within` [m]: largest gap between the surface of a particle and the facet, and largest overlap
    ///
    /// # Errors
    /// Facets that are no surface.
    pub fn find(
        solid: &Solid,
        facets: &[[u32; 3]],
        particles: &Particles,
        among: &[u32],
        within: f64,
    ) -> Result<Layer, fractum_contact::SurfaceError> {
        let positions: Vec<Vec3> = (0..solid.reference.len()).map(|n| solid.position(n)).collect();
        let surface = FacetMesh::new(&positions, facets)?;
        let centres: Vec<Vec3> = among.iter().map(|&i| particles.position[i as usize]).collect();
        let radius = |k: usize| particles.radius[among[k] as usize];
        let gap = |k: usize, offset: &Vec3| offset.norm() - radius(k);
        let mut reach = within;
        let mut near = nearest_facets(&surface, &positions, &centres, |k| radius(k) + reach);
        let furthest = |p: &Vec3| p.norm();
        let size = positions.iter().chain(&centres).map(furthest).fold(0.0, f64::max);
        // Nothing there: how far off is it?
        while near.iter().all(Option::is_none) && reach <= 2.0 * size && !among.is_empty() {
            reach = 2.0 * reach.max(1e-3 * size);
            near = nearest_facets(&surface, &positions, &centres, |k| radius(k) + reach);
        }
        let mut layer = Layer { least_gap: f64::INFINITY, ..Layer::default() };
        let mut used = vec![false; facets.len()];
        for (k, nearest) in near.iter().enumerate() {
            let Some(nearest) = nearest else { continue };
            let own = gap(k, &nearest.offset);
            layer.least_gap = layer.least_gap.min(own);
            if own.abs() > within {
                continue;
            }
            used[nearest.facet as usize] = true;
            let nodes = facets[nearest.facet as usize];
            let mut weights = [0.0; 3];
            let place = centres[k] + nearest.offset;
            surface.share(nearest.feature, &place, &positions, |node, weight| {
                if let Some(corner) = nodes.iter().position(|&n| n == node) {
                    weights[corner] += weight;
                }
            });
            // Rounding may leave a share just below zero.
            let sum: f64 = weights.iter().map(|w| w.max(0.0)).sum();
            let weights = weights.map(|w| w.max(0.0) / sum);
            layer.attachments.push(Attachment { particle: among[k], facet: nodes, weights });
        }
        layer.facets = used.iter().filter(|u| **u).count();
        Ok(layer)
    }
}
