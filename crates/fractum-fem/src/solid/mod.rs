pub(crate) mod body_blocks;
pub(crate) mod body_model;
pub(crate) mod depths;
pub(crate) mod evaluate;
pub(crate) mod neighbours;
pub(crate) mod subcycling;

use std::ops::Range;

use fractum_kernels::material::{Wave, rayleigh_wave_speed};
use fractum_math::{CHUNK, HalfSteps, Sym3, Vec3};
use rayon::prelude::*;

use crate::body::edges::BodyEdges;
use crate::body::{Body, ElementKind, Formulation, Region};
use crate::cells::block::{Cells, NodeSlots, Scratch};
use crate::cells::cell::Geometry;
use crate::damage::edge::EdgeField;
use crate::damage::threshold::{LengthReport, characteristic_length};
use crate::error::SolidError;
pub(crate) use crate::solid::body_model::BodyModel;
use crate::solid::body_model::Chosen;
use crate::solid::depths::Depths;
use crate::solid::evaluate::Block;
use crate::solid::neighbours::{Alone, Neighbours};
use crate::solid::subcycling::Subcycling;

/// Finite elements of all solid bodies, with their nodes.
///
/// Arrays over nodes are public: boundary conditions and contact read and add to them.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Positions without load [m].
    pub reference: Vec<Vec3>,
    /// Displacement at tⁿ [m].
    pub displacement: Vec<Vec3>,
    /// Displacement at the start under in-situ stress, from which results count [m]; empty where that is zero.
    pub initial_displacement: Vec<Vec3>,
    /// Velocity at the half step before tⁿ [m/s].
    pub velocity: Vec<Vec3>,
    /// Force at tⁿ [N]: internal after [`Solid::update_internal_forces`], then whatever is added.
    pub force: Vec<Vec3>,
    /// Lumped mass [kg]; it stays when elements are cut through and goes with a body that is taken out.
    pub mass: Vec<f64>,
    pub(crate) inverse_mass: Vec<f64>,
    pub(crate) bodies: Vec<BodyModel>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) slots: NodeSlots,
    pub(crate) chunk_work: Vec<HalfSteps>,
    pub(crate) viscous_dissipation: f64,
    /// Who has the rest of it.
    pub(crate) neighbours: Box<dyn Neighbours>,
    /// Nodes of the mesh that stand twice, ascending; their copies are the nodes beyond those of the mesh. Arrays that change in a run
    /// and masses have the copies too.
    pub(crate) copies: Vec<u32>,
    /// What cells with steps of two sizes need; none where all take the same.
    pub(crate) subcycling: Option<Box<Subcycling>>,
    pub(crate) depths: Depths,
}

impl Solid {
    /// Builds the cells of all bodies over shared nodes.
    ///
    /// - `nodes`: reference positions [m]
    ///
    /// # Errors
    /// [`SolidError`] for elements without volume or too large for their fracture energy, for massless nodes, and beyond some 7 billion smoothed tetrahedra.
    pub fn new(nodes: Vec<Vec3>, bodies: Vec<Body>) -> Result<Self, SolidError> {
        Solid::with_fine(nodes, bodies, &[], |_, _| Box::new(Alone))
    }

    /// - `fine`: elements of each body whose cells have blocks of their own; empty where there are none
    /// - `neighbours`: who has the rest, by the blocks of all and their nodes
    pub(crate) fn with_fine(
        nodes: Vec<Vec3>,
        bodies: Vec<Body>,
        fine: &[Vec<bool>],
        neighbours: impl FnOnce(&[Block], &NodeSlots) -> Box<dyn Neighbours>,
    ) -> Result<Self, SolidError> {
        let mut mass = vec![0.0; nodes.len()];
        let mut blocks = Vec::new();
        let mut models = Vec::new();
        for (index, body) in bodies.into_iter().enumerate() {
            let fine = fine.get(index).map_or(&[][..], Vec::as_slice);
            let geometry = Geometry { body: &body, nodes: &nodes };
            let volumes = geometry.volumes()?;
            let corners = body.shape.node_count();
            for (element, &volume) in body.elements.iter().zip(&volumes) {
                for &node in &element[..corners] {
                    mass[node as usize] += body.elastic.density * volume / corners as f64;
                }
            }
            let chosen = Chosen { fine, ..Chosen::default() };
            let (model, mut own) = BodyModel::new(body, index, &nodes, &volumes, chosen, blocks.len())?;
            blocks.append(&mut own);
            models.push(model);
        }
        if let Some(node) = mass.iter().position(|&m| m <= 0.0) {
            return Err(SolidError::MasslessNode { node });
        }
        let slots = NodeSlots::new(nodes.len(), blocks.iter().map(|b: &Block| b.cells.nodes.as_slice()))?;
        let neighbours = neighbours(&blocks, &slots);
        Ok(Solid::of_blocks(nodes, mass, models, blocks, slots, neighbours))
    }

    /// The solid of blocks whose cells have no geometry yet.
    pub(crate) fn of_blocks(
        nodes: Vec<Vec3>,
        mass: Vec<f64>,
        bodies: Vec<BodyModel>,
        blocks: Vec<Block>,
        slots: NodeSlots,
        neighbours: Box<dyn Neighbours>,
    ) -> Self {
        let zero = vec![Vec3::zeros(); nodes.len()];
        let mut solid = Solid {
            displacement: zero.clone(),
            initial_displacement: Vec::new(),
            velocity: zero.clone(),
            force: zero,
            inverse_mass: mass.iter().map(|m| 1.0 / m).collect(),
            chunk_work: vec![HalfSteps::default(); nodes.len().div_ceil(CHUNK)],
            reference: nodes,
            mass,
            depths: Depths::of(&bodies),
            bodies,
            blocks,
            slots,
            viscous_dissipation: 0.0,
            neighbours,
            copies: Vec::new(),
            subcycling: None,
        };
        solid.make_cells();
        solid
    }

    /// Gives the cells that this process needs a geometry.
    fn make_cells(&mut self) {
        let own = self.own_blocks();
        let Solid { blocks, bodies, reference, neighbours, .. } = self;
        let is_needed = |index: usize, block: &Block| own.contains(&index) || bodies[block.body].needs_all_cells();
        let needed = blocks.par_iter_mut().enumerate().filter(|(index, block)| is_needed(*index, block));
        needed.for_each(|(_, block)| {
            block.cells = bodies[block.body].cells(reference, &block.items);
            block.scratch = Some(Scratch::new());
            block.edge_field_mut().into_iter().for_each(EdgeField::keep_histories);
        });
        let halo = neighbours.halo_blocks();
        halo.into_iter().for_each(|block| _ = blocks[block].scratch.get_or_insert_with(Scratch::new));
    }

    /// Blocks whose cells this process evaluates.
    pub(crate) fn own_blocks(&self) -> Range<usize> {
        self.neighbours.own_blocks(self.blocks.len())
    }

    /// Whether this process speaks for an element of a body: of several that have it one does.
    pub fn owns(&self, body: usize, element: u32) -> bool {
        self.neighbours.owns(body, element)
    }

    /// Has something done together with the neighbours, which the solid is without meanwhile.
    pub(crate) fn with_neighbours<T>(&mut self, work: impl FnOnce(&mut dyn Neighbours, &mut Solid) -> T) -> T {
        let mut neighbours = std::mem::replace(&mut self.neighbours, Box::new(Alone));
        let outcome = work(&mut *neighbours, self);
        self.neighbours = neighbours;
        outcome
    }

    /// Gives a node mass beside that of its elements [kg], for ever.
    pub fn add_mass(&mut self, node: usize, mass: f64) {
        self.mass[node] += mass;
        self.inverse_mass[node] = 1.0 / self.mass[node];
    }

    /// Position of a node at tⁿ [m].
    #[inline]
    pub fn position(&self, node: usize) -> Vec3 {
        self.reference[node] + self.displacement[node]
    }

    /// Displacement of a node since the start, which in-situ stress may have loaded [m].
    #[inline]
    pub fn displacement_from_start(&self, node: usize) -> Vec3 {
        self.displacement[node] - self.initial_displacement.get(node).copied().unwrap_or_default()
    }

    /// Has `evaluate(bodies, index, block)` done to the blocks of this process, and gets the sums of others at its nodes.
    pub(crate) fn evaluate_own(&mut self, evaluate: impl Fn(&[BodyModel], usize, &mut Block) + Sync) {
        let own = self.own_blocks();
        let Solid { blocks, bodies, neighbours, .. } = self;
        neighbours.evaluate(blocks, &|blocks, is_meant| {
            let blocks = blocks[own.clone()].par_iter_mut().zip(own.clone());
            blocks.filter(|(_, index)| is_meant(*index)).for_each(|(block, index)| evaluate(bodies, index, block));
        });
    }

    /// Sums the forces of the blocks on each node.
    pub(crate) fn gather_forces(&mut self) {
        let mut force = std::mem::take(&mut self.force);
        self.sum_blocks(&mut force);
        self.neighbours.exchange_forces(&mut force);
        self.force = force;
    }

    /// The same into `force`, of the nodes of own blocks.
    pub(crate) fn sum_blocks(&self, force: &mut [Vec3]) {
        let Solid { blocks, slots, neighbours, .. } = self;
        force.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, force)| {
            let all = 0..force.len();
            for run in neighbours.pushed(chunk).unwrap_or(std::slice::from_ref(&all)) {
                let first = chunk * CHUNK + run.start;
                let nodes = (first..).zip(&mut force[run.clone()]);
                nodes.for_each(|(node, f)| *f = slots.gather(node, |block| blocks[block].forces()));
            }
        });
    }

    /// Elastic energy at the last measured step [J].
    pub fn elastic_energy(&self) -> f64 {
        if let Some([elastic, ..]) = self.subcycling.as_ref().and_then(|own| own.energies()) {
            return elastic;
        }
        self.blocks.iter().map(|block| block.energy.unwrap_or(0.0)).sum()
    }

    /// Energy dissipated by damage so far [J].
    pub fn dissipated_energy(&self) -> f64 {
        if let Some([_, dissipated, _]) = self.subcycling.as_ref().and_then(|own| own.energies()) {
            return dissipated;
        }
        self.blocks.iter().map(|block| block.dissipated).sum()
    }

    /// Energy dissipated by viscosity so far [J].
    pub fn viscous_dissipation(&self) -> f64 {
        self.viscous_dissipation
    }

    /// Damage of the edges of all bodies: blocks of smoothed cells first, then standard bodies.
    pub(crate) fn edge_fields(&self) -> impl Iterator<Item = (usize, &EdgeField)> {
        cell_fields(self).chain(standard_fields(self))
    }

    /// Those that may hold damaged edges: standard bodies do not count theirs.
    pub(crate) fn damaged_fields(&self) -> impl Iterator<Item = (usize, &EdgeField)> {
        cell_fields(self).filter(|(_, field)| field.is_damaged()).chain(standard_fields(self))
    }

    /// Where the damage of an edge of a body is kept; none where it may not be damaged.
    pub(crate) fn edge(&self, body: usize, edge: u32) -> Option<(&EdgeField, usize)> {
        let model = &self.bodies[body];
        if let Some(standard) = &model.standard {
            return Some((&standard.field, edge as usize));
        }
        if let Some((block, cell)) = model.location.kept(edge) {
            return Some((self.blocks[block as usize].edge_field()?, cell as usize));
        }
        let (block, place) = self.neighbours.received_edge(body, edge)?;
        Some((self.blocks[block].edge_field()?, place))
    }

    /// Characteristic length of an edge that may be damaged [m]; none of any other.
    pub(crate) fn length_of_edge(&self, body: usize, edge: u32) -> Option<f64> {
        let model = &self.bodies[body];
        let (Some(edges), false) = (&model.edges, model.location.keeps_all()) else {
            return self.edge(body, edge).map(|(field, index)| field.length[index]);
        };
        let may_break = match model.body.damage.as_ref().map(|zone| &zone.region) {
            Some(Region::Edges(marked)) => marked[edge as usize],
            _ => true,
        };
        may_break.then(|| {
            let geometry = Geometry { body: &model.body, nodes: &self.reference };
            characteristic_length(&geometry, &edges.around(edge), |element| self.element_volume(body, element))
        })
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// A body as it was given.
    pub fn body(&self, index: usize) -> &Body {
        &self.bodies[index].body
    }

    /// Speed of a compression wave in a body, √((λ + 2μ)/ρ): in plane stress that of a plate, through beds that in the fastest direction [m/s].
    pub fn p_wave_speed(&self, index: usize) -> f64 {
        let BodyModel { elasticity, body, .. } = &self.bodies[index];
        (elasticity.wave_modulus(body) / body.elastic.density).sqrt()
    }

    /// Speed of a wave in a body without beds; in plane stress that in a plate [m/s].
    pub fn wave_speed(&self, index: usize, wave: Wave) -> f64 {
        let (p, s) = (self.p_wave_speed(index), self.bodies[index].body.elastic.s_wave_speed());
        match wave {
            Wave::Compression => p,
            Wave::Shear => s,
            Wave::Rayleigh => rayleigh_wave_speed(p, s),
        }
    }

    /// Edges of a body, if its formulation or its damage uses them.
    pub fn body_edges(&self, index: usize) -> Option<&BodyEdges> {
        self.bodies[index].edges.as_ref()
    }

    /// Which elements of a body are still there.
    pub fn alive(&self, index: usize) -> &[bool] {
        &self.bodies[index].alive
    }

    /// How the elements of a body suit its softening; zeros where nothing softens.
    pub fn length_report(&self, index: usize) -> LengthReport {
        self.bodies[index].lengths
    }

    /// Centre of an element without load [m].
    pub fn element_middle(&self, index: usize, element: u32) -> Vec3 {
        let body = &self.bodies[index].body;
        let corners = &body.elements[element as usize][..body.shape.node_count()];
        corners.iter().map(|&n| self.reference[n as usize]).sum::<Vec3>() / corners.len() as f64
    }

    /// Shares what elements of bodies have equally among their corners; what every node has of it then.
    pub fn lumped(&self, elements: impl Iterator<Item = (usize, u32, f64)>) -> Vec<f64> {
        let mut nodes = vec![0.0; self.reference.len()];
        for (body, element, value) in elements {
            let own = &self.bodies[body].body;
            let corners = own.shape.node_count();
            let share = value / corners as f64;
            own.elements[element as usize][..corners].iter().for_each(|&node| nodes[node as usize] += share);
        }
        nodes
    }

    /// Volumes of the elements of a body without load [m³], found once.
    pub fn element_volumes(&self, body: usize) -> &[f64] {
        let volumes = || (0..self.bodies[body].alive.len() as u32).map(|e| self.element_volume(body, e)).collect();
        self.bodies[body].volumes.get_or_init(volumes)
    }

    /// Volume of an element without load [m³].
    pub fn element_volume(&self, body: usize, element: u32) -> f64 {
        Geometry { body: &self.bodies[body].body, nodes: &self.reference }.element(element as usize).0
    }

    /// Whether the solid is plane, which it is around an axis too.
    pub fn is_plane(&self) -> bool {
        self.bodies.iter().any(|model| model.body.shape == ElementKind::T3)
    }
}

fn cell_fields(solid: &Solid) -> impl Iterator<Item = (usize, &EdgeField)> {
    solid.blocks.iter().filter_map(|block| Some((block.body, block.edge_field()?)))
}

fn standard_fields(solid: &Solid) -> impl Iterator<Item = (usize, &EdgeField)> {
    (0..).zip(&solid.bodies).filter_map(|(body, model)| Some((body, &model.standard.as_ref()?.field)))
}

impl BodyModel {
    /// Edges that hold the strain of the body; none where its elements do.
    pub(crate) fn smoothed_edges(&self) -> Option<&BodyEdges> {
        self.edges.as_ref().filter(|_| self.body.formulation == Formulation::Smoothed)
    }

    /// Whether all its cells are needed by whoever needs one: edges of the standard formulation gather stresses of elements.
    pub(crate) fn needs_all_cells(&self) -> bool {
        self.standard.is_some()
    }

    /// Cells of some items of the body (elements, or edges if smoothed), of the elements that are there.
    pub(crate) fn cells(&self, nodes: &[Vec3], items: &[u32]) -> Cells {
        Geometry { body: &self.body, nodes }.cells(items, self.smoothed_edges(), |element| self.alive[element as usize])
    }

    /// Mean of stress and damage over the edges of an element.
    pub(crate) fn mean_of_edges(&self, of: &[u32; 6], field: impl Fn(u32) -> (Sym3, f64)) -> (Sym3, f64) {
        let count = self.body.shape.edge_count();
        let mut sum = (Sym3::ZERO, 0.0);
        for &edge in &of[..count] {
            let (stress, damage) = field(edge);
            sum = (sum.0 + stress, sum.1 + damage);
        }
        (sum.0 * (1.0 / count as f64), sum.1 / count as f64)
    }
}
