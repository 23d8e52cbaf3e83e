//! Solids of which each rank has a subdomain.

use std::collections::BTreeMap;
use std::sync::Arc;

use fractum_kernels::damage::Softens;
use fractum_math::Vec3;
use fractum_parallel::{Exchange, gather, gather_named};

use super::body_subdomain::BodySubdomain;
use super::subdomain::{Nodes, Subdomain};
use super::subdomain_mut;
use crate::body::{Body, Kinematics};
use crate::cells::block::NodeSlots;
use crate::cells::cell::Geometry;
use crate::damage::edge::EdgeField;
use crate::divided::{BlockOrder, BodyShare, Classes, GivenToNodes, RanksOfNodes, nodal_sums};
use crate::error::SolidError;
use crate::solid::body_model::Chosen;
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::{BodyModel, Solid};

/// As [`Solid::new`], with the cells alone that this rank evaluates, where no other are needed; see [`distribute`].
///
/// # Errors
/// As [`Solid::new`].
pub fn shared_solid(nodes: Vec<Vec3>, bodies: Vec<Body>, exchange: Arc<dyn Exchange>) -> Result<Solid, SolidError> {
    Solid::with_fine(nodes, bodies, &[], |blocks, slots| Box::new(Subdomain::new(exchange, blocks, slots)))
}

/// Builds the cells that this rank evaluates of bodies of which it has a share.
///
/// - `nodes`: reference positions of all nodes [m]
/// - `bodies`: with the elements of this rank, those with damage with all; `shares`: what else it has of each of them
///
/// # Errors
/// As [`Solid::new`], the same on every rank.
pub fn divided_solid(
    nodes: Vec<Vec3>,
    bodies: Vec<Body>,
    shares: &[BodyShare],
    exchange: Arc<dyn Exchange>,
) -> Result<Solid, SolidError> {
    let volumes: Vec<Result<Vec<f64>, SolidError>> =
        bodies.iter().map(|body| Geometry { body, nodes: &nodes }.volumes()).collect();
    let volumes = together(&*exchange, volumes.into_iter().collect::<Result<Vec<_>, _>>())?;
    let mut given = Vec::new();
    for ((body, share), volumes) in bodies.iter().zip(shares).zip(&volumes) {
        let values = volumes.iter().map(|volume| body.elastic.density * volume / 4.0).collect();
        given.push(GivenToNodes { share, elements: &body.elements, values });
    }
    let mass = nodal_sums(&*exchange, nodes.len(), &given);
    drop(given);
    if let Some(node) = mass.iter().position(|&mass| mass <= 0.0) {
        return Err(SolidError::MasslessNode { node });
    }
    let (mut models, mut parts, mut made) = (Vec::new(), Vec::new(), Vec::new());
    let mut done = Ok(());
    for (index, ((body, share), volumes)) in bodies.into_iter().zip(shares).zip(&volumes).enumerate() {
        let chosen =
            Chosen { fine: &[], share: Some(share).filter(|share| !share.is_whole()), exchange: Some(&*exchange) };
        match BodyModel::new(body, index, &nodes, volumes, chosen, 0) {
            Ok((mut model, blocks)) => {
                let part = BodySubdomain::new(&mut model, &*exchange, share, volumes, nodes.len());
                made.push(in_classes(blocks, part.remote.is_some()));
                models.push(model);
                parts.push(part);
            }
            Err(error) => done = Err(error),
        }
    }
    together(&*exchange, done)?;
    let cells = |of: &Vec<Block>| of.iter().map(|block| block.items.len()).collect::<Vec<usize>>();
    let order =
        BlockOrder::new(&*exchange, shares, &made.iter().map(|of| of.each_ref().map(cells)).collect::<Vec<_>>());
    let begin: Vec<[usize; 2]> =
        (0..models.len()).map(|body| order.begin_of(body, exchange.rank(), &shares[body])).collect();
    for ((model, [begin, of_others]), [made, _]) in models.iter_mut().zip(&begin).zip(&made) {
        let first = made.len();
        let number = |block: usize| if block < first { begin + block } else { of_others + block - first };
        model.location.move_blocks(|block| number(block as usize) as u32);
    }
    let own = order.first[exchange.rank()]..order.first[exchange.rank() + 1];
    let numbered = |(blocks, begin): (Classes<Block>, [usize; 2])| {
        blocks.into_iter().zip(begin).flat_map(|(blocks, begin)| (begin..).zip(blocks))
    };
    let made: Vec<(usize, Block)> = made.into_iter().zip(begin).flat_map(numbered).collect();
    let of_own = made.iter().filter(|(index, _)| own.contains(index));
    let mut of_own: Vec<u32> = of_own.flat_map(|(_, block)| &block.cells.nodes).copied().collect();
    of_own.sort_unstable();
    of_own.dedup();
    let ranks = RanksOfNodes::new(&*exchange, nodes.len(), &of_own);
    let blocks = with_others(&*exchange, made, &models, &parts, &ranks);
    let slots = NodeSlots::new(nodes.len(), blocks.iter().map(|block| block.cells.nodes.as_slice()))?;
    let own = Subdomain::divided(exchange, order, parts, ranks, &blocks, &slots);
    Ok(Solid::of_blocks(nodes, mass, models, blocks, slots, Box::new(own)))
}

/// Leaves a subdomain of the solid to each rank of an exchange. Every rank must have the same solid in the same state.
///
/// - `everywhere`: nodes that every rank shall move, whatever it has of them
/// - `sums`: whether every step needs sums over all nodes, as those of damping
pub fn distribute(solid: &mut Solid, exchange: Arc<dyn Exchange>, everywhere: &[u32], sums: bool) {
    let Solid { bodies, blocks, slots, neighbours, .. } = solid;
    if subdomain_mut(neighbours).is_none() {
        *neighbours = Box::new(Subdomain::new(exchange, blocks, slots));
    }
    let Some(own) = subdomain_mut(neighbours) else { return };
    let has_events =
        |model: &BodyModel| model.body.damage.is_some() || model.body.kinematics == Kinematics::Corotational;
    let events = [bodies.iter().any(has_events), bodies.iter().any(|model| model.viscosity.is_some())];
    let always = match sums {
        _ if bodies.iter().any(BodyModel::needs_all_cells) => Nodes::All,
        true => Nodes::Summed,
        false => Nodes::Own,
    };
    own.begin_stage(slots, everywhere, always, events);
    own.keep_own(blocks, |block| bodies[block.body].needs_all_cells());
    for model in bodies.iter_mut().filter(|model| !model.needs_all_cells()) {
        let BodyModel { phase, location, .. } = model;
        let rank_of = |edge: u32| own.rank_of(location.of(edge).0 as usize);
        phase.iter_mut().for_each(|field| field.distribute(own.exchange.rank() as u32, rank_of));
    }
}

/// Blocks of a body that may be damaged, and the others; all as one class unless this rank has its own alone.
fn in_classes(mut blocks: Vec<Block>, has_own_alone: bool) -> Classes<Block> {
    let may_break = blocks.iter().take_while(|block| block.edge_field().is_some()).count();
    let sound = if has_own_alone { blocks.split_off(may_break) } else { Vec::new() };
    [blocks, sound]
}

/// The blocks of all ranks among those that this one has made: its own, and those of whole bodies.
///
/// - `made`: with their numbers
fn with_others(
    exchange: &dyn Exchange,
    made: Vec<(usize, Block)>,
    models: &[BodyModel],
    parts: &[BodySubdomain],
    ranks: &RanksOfNodes,
) -> Vec<Block> {
    let of_divided = || made.iter().filter(|(_, block)| parts[block.body].has_own_cells_alone());
    let mut of_others = ranks.of_others(exchange, of_divided().map(|(at, block)| (*at, block.cells.nodes.as_slice())));
    let known: Vec<(usize, usize, usize)> =
        of_divided().map(|(index, block)| (*index, block.body, block.gradients)).collect();
    let softens = |model: &BodyModel| model.body.softens().map(Arc::new);
    let softens: Vec<Option<Arc<Softens>>> = models.iter().map(softens).collect();
    let mut all: BTreeMap<usize, Block> = made.into_iter().collect();
    for (index, body, gradients) in gather(exchange, &known).into_iter().flatten() {
        let softens = softens[body].as_ref().filter(|_| parts[body].remote.is_some());
        let law = softens.map_or(BlockLaw::Elastic, |softens| BlockLaw::Edges(EdgeField::of_none(Arc::clone(softens))));
        let other = || Block::elsewhere(body, gradients, of_others.remove(&index).unwrap_or_default(), law);
        all.entry(index).or_insert_with(other);
    }
    all.into_values().collect()
}

/// What every rank has done, or the error of the first that has one.
fn together<T>(exchange: &dyn Exchange, done: Result<T, SolidError>) -> Result<T, SolidError> {
    let own = done.as_ref().err().map(|error| vec![error.to_string()]).unwrap_or_default();
    match (gather_named(exchange, &own).into_iter().next(), done) {
        (None, done) => done,
        (Some(first), _) => Err(SolidError::OfRank(first)),
    }
}
