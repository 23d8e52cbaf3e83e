//! Which elements of a mesh take shorter steps than the rest.

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::body::elasticity::Elasticity;
use crate::body::{Body, Formulation};
use crate::cells::cell::Geometry;
use crate::motion::time_step::element_frequency;

/// Most short steps in a long one.
const MOST_PARTS: u32 = 16;

/// Cost over that of steps of one size from which two sizes are not worth it.
const WORTH_IT: f64 = 0.8;

/// The elements that shall take shorter steps than the others, body by body, where that pays; none where it does not.
///
/// Of all ratios of the two steps the one is taken that costs least for a time simulated: with the share f of the cells that
/// must take the short step, (1 + (m - 1) f)/m.
pub(crate) fn fine_elements(nodes: &[Vec3], bodies: &[Body]) -> Option<Vec<Vec<bool>>> {
    let of_body = |body: &Body| -> Vec<f64> {
        let (geometry, elasticity) = (Geometry { body, nodes }, Elasticity::new(body));
        let frequency = |element| element_frequency(&geometry, &elasticity, element);
        (0..body.elements.len()).into_par_iter().map(frequency).collect()
    };
    let frequencies: Vec<Vec<f64>> = bodies.iter().map(of_body).collect();
    let highest = frequencies.iter().flatten().copied().fold(0.0, f64::max);
    let above = |limit: f64| -> Vec<Vec<bool>> {
        frequencies.iter().map(|of| of.iter().map(|&frequency| frequency > limit).collect()).collect()
    };
    let cost = |parts: u32| {
        let parts = f64::from(parts);
        (1.0 + (parts - 1.0) * share_of_cells(nodes.len(), bodies, &above(highest / parts))) / parts
    };
    let costs = (2..=MOST_PARTS).map(|parts| (parts, cost(parts)));
    let (parts, _) = costs.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, cost)| *cost < WORTH_IT)?;
    Some(above(highest / f64::from(parts)))
}

/// Share of all cells that are fine: those of fine elements, and in smoothed bodies all edges of these. An edge that a fine
/// element does not have but joins two of its nodes is counted too, which is rare.
fn share_of_cells(node_count: usize, bodies: &[Body], fine: &[Vec<bool>]) -> f64 {
    let mut touched = vec![false; node_count];
    for (body, fine) in bodies.iter().zip(fine) {
        let corners = body.shape.node_count();
        let own = body.elements.iter().zip(fine).filter(|(_, fine)| **fine);
        own.flat_map(|(nodes, _)| &nodes[..corners]).for_each(|&node| touched[node as usize] = true);
    }
    let (mut sum, mut count) = (0.0, 0.0);
    for (body, fine) in bodies.iter().zip(fine) {
        let corners = body.shape.node_count();
        let pairs = |n: usize| (n * n.saturating_sub(1)) as f64;
        let of = |(nodes, fine): (&[u32; 4], &bool)| match body.formulation {
            Formulation::Smoothed => {
                let touched = nodes[..corners].iter().filter(|&&node| touched[node as usize]).count();
                pairs(touched) / pairs(corners)
            }
            Formulation::Standard => f64::from(u8::from(*fine)),
        };
        sum += body.elements.iter().zip(fine).map(of).sum::<f64>();
        count += body.elements.len() as f64;
    }
    if count > 0.0 { sum / count } else { 1.0 }
}
