//! What ranks bring up to date before someone looks at it.

use std::sync::Arc;

use fractum_math::Vec3;

use super::subdomain::Nodes;
use super::{subdomain, subdomain_mut};
use crate::divided::EdgeValue;
use crate::fields::element_fields::{cell_field, cell_strain, displacements_before};
use crate::solid::Solid;

/// Has every rank move all nodes in the next step, where something needs all of them.
pub fn move_all_nodes_next(solid: &mut Solid, needed: bool) {
    if let Some(own) = subdomain_mut(&mut solid.neighbours).filter(|_| needed) {
        own.needs.next = Nodes::All;
    }
}

/// Brings displacements and velocities of nodes up to date on every rank, which all move them from now on. All ranks must name
/// the same nodes.
pub fn follow_nodes(solid: &mut Solid, nodes: &[u32]) {
    let Solid { neighbours, slots, displacement, velocity, .. } = solid;
    if let Some(own) = subdomain_mut(neighbours) {
        own.follow(slots, nodes, [displacement, velocity]);
    }
}

/// Gives every rank the sums over chunks of nodes, once each has those of its own; nothing where every rank has all.
pub fn exchange_sums(solid: &Solid, sums: &mut [Vec3]) {
    let Some(own) = subdomain(solid).filter(|own| own.needs.now == Nodes::Summed) else { return };
    let mut numbers: Vec<[f64; 3]> = sums.iter().map(|&sum| sum.into()).collect();
    own.sums.exchange(&*own.exchange, &mut numbers);
    sums.iter_mut().zip(numbers).for_each(|(sum, numbers)| *sum = numbers.into());
}

/// Brings displacements and velocities of all nodes up to date on every rank.
pub fn gather_nodes(solid: &mut Solid) {
    let Solid { neighbours, displacement, velocity, .. } = solid;
    if let Some(own) = subdomain_mut(neighbours) {
        own.gather_motion(displacement, velocity);
    }
}

/// Brings what this rank has of the damage of others up to date, after a step that was measured.
pub fn gather_damage(solid: &mut Solid) {
    if let Some(own) = subdomain_mut(&mut solid.neighbours) {
        own.gather_cells(&mut solid.blocks, false);
    }
}

/// Brings what this rank has of the nodes and cells of others up to date.
///
/// - `dt`: time since the instant of the last step [s]
pub fn gather_all(solid: &mut Solid, dt: f64) {
    gather_nodes(solid);
    if let Some(own) = subdomain_mut(&mut solid.neighbours) {
        own.gather_cells(&mut solid.blocks, true);
    }
    gather_edge_values(solid, dt);
}

/// Brings stress, damage and strain of edges up to date that this rank needs of others for the means over the edges of its elements; of no effect where each
/// has all elements.
///
/// - `dt`: time since the instant of the last step [s]
fn gather_edge_values(solid: &mut Solid, dt: f64) {
    if subdomain(solid).is_none() {
        return;
    }
    let earlier = displacements_before(solid, dt);
    for body in 0..solid.bodies.len() {
        let Some(own) = subdomain_mut(&mut solid.neighbours) else { return };
        let exchange = Arc::clone(&own.exchange);
        let Some(mut divided) = own.bodies.get_mut(body).and_then(|body| body.divided.take()) else { continue };
        divided.values.swap(&*exchange, |edge| {
            let at = solid.bodies[body].location.of(edge);
            let (stress, damage) = cell_field(solid, body, at, None);
            let (earlier_stress, _) = cell_field(solid, body, at, Some(&earlier));
            EdgeValue { stress, earlier_stress, damage, strain: cell_strain(solid, body, at) }
        });
        if let Some(own) = subdomain_mut(&mut solid.neighbours) {
            own.bodies[body].divided = Some(divided);
        }
    }
}
