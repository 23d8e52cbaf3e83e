//! A solid whose bodies are divided among ranks.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use fractum_math::{Sym3, Vec3};
use fractum_mesh::topology::{TETRAHEDRON_FACETS, boundary_of_tetrahedra, edges_of_tetrahedra};
use fractum_parallel::{Exchange, gather, gather_named};

use crate::body::edges::BodyEdges;
use crate::body::{Body, ElementKind, Formulation};
use crate::cells::block::NodeSlots;
use crate::cells::cell::Geometry;
use crate::cells::kernel;
use crate::divided::told_edges::ToldEdges;
use crate::divided::{
    ALONE, BlockOrder, BodyShare, Classes, ConnectedPieces, DividedBody, ELSEWHERE, EdgeValue, EdgeValues,
    GivenToNodes, Held, RanksOfNodes, SharedNodes, connected_pieces, nodal_sums,
};
use crate::error::SolidError;
use crate::motion::time_step::StableStep;
use crate::solid::Solid;
use crate::solid::body_model::{BodyModel, Chosen};
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::part::Part;

impl Solid {
    /// Builds the cells that this rank evaluates of bodies of which it has a share. All ranks must call it.
    ///
    /// - `nodes`: reference positions of all nodes [m]
    /// - `bodies`: with the elements of this rank, those with damage with all; `shares`: what else it has of each of them
    ///
    /// # Errors
    /// As [`Solid::new`], the same on every rank.
    pub fn divided(
        nodes: Vec<Vec3>,
        bodies: Vec<Body>,
        shares: &[BodyShare],
        exchange: Arc<dyn Exchange>,
    ) -> Result<Self, SolidError> {
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
        let (mut models, mut made) = (Vec::new(), Vec::new());
        let mut done = Ok(());
        for (index, ((body, share), volumes)) in bodies.into_iter().zip(shares).zip(&volumes).enumerate() {
            let chosen =
                Chosen { fine: &[], share: Some(share).filter(|share| !share.is_whole()), exchange: Some(&*exchange) };
            match BodyModel::new(body, index, &nodes, volumes, chosen, 0) {
                Ok((mut model, blocks)) => {
                    model.divide(&*exchange, share, volumes, nodes.len());
                    made.push(blocks);
                    models.push(model);
                }
                Err(error) => done = Err(error),
            }
        }
        together(&*exchange, done)?;
        let cells = |of: &Vec<Block>| of.iter().map(|block| block.items.len()).collect::<Vec<usize>>();
        let made: Vec<Classes<Block>> =
            models.iter().zip(made).map(|(model, blocks)| in_classes(blocks, model.known.is_some())).collect();
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
        let blocks = with_others(&*exchange, made, &models, &ranks);
        let slots = NodeSlots::new(nodes.len(), blocks.iter().map(|block| block.cells.nodes.as_slice()))?;
        let part = Part::divided(exchange, order, ranks, &blocks, &slots);
        Ok(Solid::of_blocks(nodes, mass, models, blocks, slots, Some(Box::new(part))))
    }

    /// Whether there are bodies that no rank has whole.
    pub fn is_divided(&self) -> bool {
        self.part.as_ref().is_some_and(|part| part.is_divided())
    }

    /// How the elements of a body hang together that no rank has whole; none where each has all of them.
    pub fn connected_pieces(&self, body: usize) -> Option<&ConnectedPieces> {
        Some(&self.bodies[body].divided.as_ref()?.pieces)
    }

    /// Nodes of a body, some of them more than once.
    pub fn nodes_of(&self, body: usize) -> impl Iterator<Item = u32> + '_ {
        let model = &self.bodies[body];
        let elements = if model.divided.is_some() { &[][..] } else { &model.body.elements };
        let volumes = model.divided.iter().flat_map(|divided| &divided.pieces.volumes);
        let nodes = (0..).zip(volumes).filter(|(_, volume)| **volume > 0.0).map(|(node, _)| node);
        nodes.chain(elements.iter().flatten().copied())
    }

    /// Number of an element of this rank in the whole body.
    pub fn element_number(&self, body: usize, element: u32) -> u32 {
        let divided = self.bodies[body].divided.as_ref();
        divided.map_or(element, |divided| divided.numbers[element as usize])
    }

    /// The element of this rank that has a number in the whole body; none where it does not have that.
    pub fn element_of_number(&self, body: usize, number: u32) -> Option<u32> {
        match &self.bodies[body].divided {
            Some(divided) => divided.numbers.binary_search(&number).ok().map(|element| element as u32),
            None => Some(number),
        }
    }

    /// Number of blocks of cells of all ranks.
    pub fn block_count(&self) -> usize {
        self.blocks.len()
    }

    /// Elements of a body on all ranks.
    pub fn element_count(&self, body: usize) -> usize {
        let model = &self.bodies[body];
        model.divided.as_ref().map_or(model.body.elements.len(), |divided| divided.count)
    }

    /// Volume of a body without load [m³].
    pub fn volume(&self, body: usize) -> f64 {
        let sum = || (0..self.bodies[body].body.elements.len() as u32).map(|e| self.element_volume(body, e)).sum();
        self.bodies[body].divided.as_ref().map_or_else(sum, |divided| divided.volume)
    }

    /// Viscous stress times volume of the cells of all blocks in their order, those of a rank at a time. All ranks must call it.
    pub fn each_viscous_block(&self, mut see: impl FnMut(&[Sym3])) {
        let of = |block: &Block| block.viscous.stress.clone();
        let Some(part) = self.part.as_ref().filter(|part| part.is_divided()) else {
            return self.blocks.iter().for_each(|block| see(&block.viscous.stress));
        };
        let exchange = part.exchange();
        for rank in 0..exchange.size() {
            let own: Vec<Vec<Sym3>> =
                if rank == exchange.rank() { self.blocks[part.own()].iter().map(of).collect() } else { Vec::new() };
            gather(&*exchange, &own).concat().iter().for_each(|stress| see(stress));
        }
    }

    /// Notes which facets of a body are seen from outside, of the elements that this process tells of.
    ///
    /// - `facets`: those of the whole body
    pub fn note_skin(&mut self, body: usize, facets: &[[u32; 3]]) {
        let sorted = |mut facet: [u32; 3]| {
            facet.sort_unstable();
            facet
        };
        let mut outer: Vec<[u32; 3]> = facets.iter().map(|&facet| sorted(facet)).collect();
        outer.sort_unstable();
        let model = &mut self.bodies[body];
        let Some(divided) = &mut model.divided else { return };
        divided.skin.clear();
        for (element, nodes) in model.body.elements.iter().enumerate().filter(|(e, _)| model.is_told[*e]) {
            let sides = TETRAHEDRON_FACETS.map(|side| side.map(|corner| nodes[corner]));
            let seen = sides.into_iter().filter(|&side| outer.binary_search(&sorted(side)).is_ok());
            divided.skin.extend(seen.map(|side| (side, element as u32)));
        }
    }

    /// Facets of a body that are seen from outside, each with its element: of the elements that this process tells of.
    pub fn skin(&self, body: usize) -> Vec<([u32; 3], u32)> {
        let model = &self.bodies[body];
        match &model.divided {
            Some(divided) => divided.skin.clone(),
            None if model.body.shape == ElementKind::T3 => {
                let alive = (0..).zip(&*model.body.elements).zip(&model.alive).filter(|(_, alive)| **alive);
                alive.map(|((element, &[a, b, c, _]), _)| ([a, b, c], element)).collect()
            }
            None => {
                let alive: Vec<u32> = (0..).zip(&model.alive).filter(|(_, alive)| **alive).map(|(e, _)| e).collect();
                let elements: Vec<[u32; 4]> = alive.iter().map(|&e| model.body.elements[e as usize]).collect();
                let facets = boundary_of_tetrahedra(&elements).into_iter();
                let facets = facets.map(|facet| (facet.nodes, alive[facet.element as usize]));
                facets.filter(|(_, element)| self.tells_of(body, *element as usize)).collect()
            }
        }
    }

    /// Whether this process tells of an element of a body: of several ranks that share it one does.
    pub fn tells_of(&self, body: usize, element: usize) -> bool {
        self.bodies[body].is_told.get(element).is_none_or(|is_told| *is_told)
    }

    /// Edges of the elements of a body that this process tells of.
    pub fn told_edges(&self, body: usize) -> Vec<[u32; 2]> {
        let BodyModel { body, edges, is_told, .. } = &self.bodies[body];
        if !is_told.contains(&false) {
            let mut nodes = Vec::new();
            let edges = edges.as_ref().map_or_else(|| Cow::Owned(BodyEdges::tables(body)), Cow::Borrowed);
            edges.for_each(|_, ends, _| nodes.push(ends));
            return nodes;
        }
        let told: Vec<[u32; 4]> =
            body.elements.iter().zip(is_told).filter(|(_, is_told)| **is_told).map(|(nodes, _)| *nodes).collect();
        edges_of_tetrahedra(&told).nodes
    }

    /// The nodes of the elements that ranks tell of; none where each has all elements. All ranks must call it.
    pub fn shared_nodes(&self) -> Option<SharedNodes> {
        let part = self.part.as_ref().filter(|part| part.is_divided())?;
        let told = |model: &BodyModel| {
            let told = model.body.elements.iter().zip(&model.is_told).filter(|(_, is_told)| **is_told);
            told.flat_map(|(nodes, _)| *nodes).collect::<Vec<u32>>()
        };
        let mut own: Vec<u32> = self.bodies.iter().flat_map(told).collect();
        own.sort_unstable();
        own.dedup();
        Some(SharedNodes::new(part.exchange(), self.reference.len(), &own))
    }

    /// Brings stress, damage and strain of edges up to date that this rank needs of others for the means over the edges of its elements. All ranks must
    /// call it; of no effect where each has all elements.
    pub fn gather_edge_values(&mut self) {
        let Some(exchange) = self.part.as_ref().map(|part| part.exchange()) else { return };
        for index in 0..self.bodies.len() {
            let Some(mut divided) = self.bodies[index].divided.take() else { continue };
            divided.values.swap(&*exchange, |edge| {
                let at = self.bodies[index].location.of(edge);
                let (stress, damage) = self.cell_field(index, at);
                EdgeValue { stress, damage, strain: self.cell_strain(&self.bodies[index], at) }
            });
            self.bodies[index].divided = Some(divided);
        }
    }

    /// Strain of a cell of which this rank has no more than the elements around it.
    pub(crate) fn strain_alone(&self, model: &BodyModel, cell: u32) -> Sym3 {
        let cells = model.cells(&self.reference, &[cell]);
        kernel::total_strain(&cells, 0, &self.displacement, model.body.kinematics)
    }

    /// What governs the step of all ranks, by what governs that of each.
    ///
    /// - `trace`: of the stiffness of its element, which decides between equal ones
    pub(crate) fn worst_of_ranks(&self, worst: StableStep, trace: f64) -> StableStep {
        let exchange = self.part.as_ref().filter(|_| self.is_divided()).map(|part| part.exchange());
        let Some(exchange) = exchange else { return worst };
        let StableStep { frequency, governing: (body, element) } = worst;
        let number = |divided: &DividedBody| divided.numbers.get(element as usize).copied().unwrap_or(u32::MAX);
        let number = self.bodies[body].divided.as_deref().map_or(element, number);
        let all = gather(&*exchange, &(frequency, trace, body, number));
        let order = |a: &(f64, f64, usize, u32), b: &(f64, f64, usize, u32)| {
            b.0.total_cmp(&a.0).then(a.2.cmp(&b.2)).then(b.1.total_cmp(&a.1)).then(a.3.cmp(&b.3))
        };
        let (frequency, _, body, number) = all.into_iter().min_by(order).expect("one of this rank at least");
        StableStep { frequency, governing: (body, number) }
    }

    /// The largest value that any rank has.
    pub(crate) fn largest_of_ranks(&self, value: f64) -> f64 {
        let exchange = self.part.as_ref().filter(|_| self.is_divided()).map(|part| part.exchange());
        exchange.map_or(value, |exchange| gather(&*exchange, &value).into_iter().fold(value, f64::max))
    }
}

impl BodyModel {
    /// What another rank has told of an edge; nothing of edges of elements that this rank does not tell of.
    pub(crate) fn value_elsewhere(&self, place: u32) -> EdgeValue {
        let values = self.divided.as_ref().map_or(&[][..], |divided| &divided.values.values);
        values.get(place as usize).copied().unwrap_or_default()
    }

    /// Remembers what this rank has of the whole body, once its cells are made.
    ///
    /// - `nodes`: of all bodies
    fn divide(&mut self, exchange: &dyn Exchange, share: &BodyShare, volumes: &[f64], nodes: usize) {
        self.is_told.clone_from(&share.is_told);
        if share.held != Held::Part {
            if let Some(zone) = self.body.damage.as_mut().filter(|_| share.held == Held::Elements) {
                // Every edge of this rank has its strength.
                zone.strength_factor = Vec::new();
            }
            return;
        }
        let smoothed = self.body.formulation == Formulation::Smoothed;
        let values = match self.edges.as_ref().filter(|_| smoothed) {
            Some(edges) => {
                let (values, places) = EdgeValues::new(exchange, share, &self.body.elements, edges);
                places.into_iter().for_each(|(edge, place)| self.location.put(edge, (ELSEWHERE, place)));
                values
            }
            None => EdgeValues::default(),
        };
        for &element in &share.measured {
            let own = [element];
            let of = self.edges.as_ref().filter(|_| smoothed).map(|edges| edges.of_element(element));
            for &cell in of.as_ref().map_or(&own[..], |of| of) {
                // Others tell values of frames alone.
                if self.location.of(cell).0 == ELSEWHERE {
                    self.location.put(cell, (ALONE, cell));
                }
            }
        }
        let pieces = connected_pieces(exchange, share, &self.body.elements, volumes, nodes);
        let volume = pieces.volumes.iter().sum();
        let (numbers, count) = (share.numbers.clone(), share.count);
        self.divided = Some(Box::new(DividedBody { numbers, count, volume, pieces, values, skin: Vec::new() }));
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
    ranks: &RanksOfNodes,
) -> Vec<Block> {
    let is_divided = |body: usize| models[body].divided.is_some() || models[body].known.is_some();
    let of_divided = || made.iter().filter(|(_, block)| is_divided(block.body));
    let mut of_others = ranks.of_others(exchange, of_divided().map(|(at, block)| (*at, block.cells.nodes.as_slice())));
    let known: Vec<(usize, usize, usize)> =
        of_divided().map(|(index, block)| (*index, block.body, block.gradients)).collect();
    let mut all: BTreeMap<usize, Block> = made.into_iter().collect();
    for (index, body, gradients) in gather(exchange, &known).into_iter().flatten() {
        let known = models[body].known.as_ref();
        let law = known.map_or(BlockLaw::Elastic { energy: None }, |known| {
            BlockLaw::Told(ToldEdges::new(Arc::clone(&known.softens)))
        });
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
