use std::sync::Arc;

use fractum_math::{CHUNK, Ragged, Sym3, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::block::{Cells, NodeSlots, Scratch};
use crate::body::{Body, BodyEdges, DamageZone, Formulation, Kinematics, Plane, Region, Shape};
use crate::cell::Geometry;
use crate::damage::{EdgeCells, EdgeDamage, Softens};
use crate::element::regular_edge;
use crate::error::SolidError;
use crate::kernel::{self, ElasticCells, Hooke};
use crate::lane::Lane;
use crate::nodes::StepWork;
use crate::standard::{StandardCells, StandardDamage};

/// Viscous stress: β D ε̇, and a bulk viscosity for shocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Viscosity {
    /// Stiffness-proportional time β [s].
    pub stiffness_time: f64,
    /// Coefficient of the linear bulk viscosity, about 0.06.
    pub bulk_linear: f64,
    /// Coefficient of the quadratic bulk viscosity, about 1.2.
    pub bulk_quadratic: f64,
}

impl Viscosity {
    /// Whether there is nothing to do.
    pub fn is_off(&self) -> bool {
        self.stiffness_time == 0.0 && self.bulk_linear == 0.0 && self.bulk_quadratic == 0.0
    }
}

/// [`Viscosity`] with the density and wave speed of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyViscosity {
    constants: Viscosity,
    density: f64,
    wave_speed: f64,
}

impl BodyViscosity {
    /// Viscous stress of a cell for its strain rate [Pa].
    pub(crate) fn stress(&self, hooke: &Hooke, rate: Sym3, integrity: f64, volume: f64) -> Sym3 {
        let Viscosity { stiffness_time, bulk_linear, bulk_quadratic } = self.constants;
        let mut stress = hooke.stress(rate) * (stiffness_time * integrity);
        let volumetric = rate.trace();
        if volumetric < 0.0 {
            let length = regular_edge(Shape::T4, volume);
            let quadratic = bulk_quadratic * bulk_quadratic * length * volumetric * volumetric;
            let pressure = self.density * length * (bulk_linear * self.wave_speed * -volumetric + quadratic);
            stress += Sym3::isotropic(-pressure);
        }
        stress
    }
}

/// How the cells of a block answer to strain.
#[derive(Clone, Debug)]
pub(crate) enum BlockLaw {
    Elastic { energy: Option<f64> },
    Edges(EdgeCells),
    Standard(StandardCells),
}

/// A block of cells of one body.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) body: usize,
    pub(crate) cells: Cells,
    /// The element or edge of the body that each cell stands for.
    pub(crate) items: Vec<u32>,
    pub(crate) law: BlockLaw,
    pub(crate) scratch: Scratch,
    /// Power of the viscous stress in the last step [W].
    pub(crate) viscous_power: f64,
    /// Viscous stress times volume of each cell at the last step; empty without viscosity.
    pub(crate) viscous: Vec<Sym3>,
}

/// A body as it runs.
#[derive(Clone, Debug)]
pub(crate) struct BodyModel {
    pub(crate) body: Body,
    pub(crate) hooke: Hooke,
    pub(crate) viscosity: Option<BodyViscosity>,
    pub(crate) alive: Vec<bool>,
    /// Edges, with damage or in the smoothed formulation.
    pub(crate) edges: Option<BodyEdges>,
    pub(crate) elements_of_edge: Ragged,
    /// Block and cell of each cell of the body (element, or edge if smoothed).
    pub(crate) location: Vec<(u32, u32)>,
    pub(crate) standard: Option<StandardDamage>,
    /// Edges whose strength was lowered to fit their length.
    pub(crate) reduced_edges: usize,
    /// Largest ratio of a characteristic length to the largest one that softening allows.
    pub(crate) largest_length_ratio: f64,
}

/// Finite elements of all solid bodies, with their nodes.
///
/// Arrays over nodes are public: boundary conditions and contact read and add to them.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Positions without load [m].
    pub reference: Vec<Vec3>,
    /// Displacement at tⁿ [m].
    pub displacement: Vec<Vec3>,
    /// Velocity at the half step before tⁿ [m/s].
    pub velocity: Vec<Vec3>,
    /// Force at tⁿ [N]: internal after [`Solid::update_internal_forces`], then whatever is added.
    pub force: Vec<Vec3>,
    /// Lumped mass [kg]; never changes, also not when elements are removed.
    pub mass: Vec<f64>,
    pub(crate) inverse_mass: Vec<f64>,
    pub(crate) bodies: Vec<BodyModel>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) slots: NodeSlots,
    pub(crate) chunk_work: Vec<StepWork>,
    pub(crate) viscous_dissipation: f64,
}

/// What changes in a body during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyState {
    /// Elements that are still there.
    pub alive: Vec<bool>,
    /// Edge histories; empty without damage.
    pub edges: Vec<EdgeDamage>,
    /// Damage and last effective stress of elements (standard formulation with damage).
    pub elements: Vec<(f64, Sym3)>,
}

/// What changes in a solid during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidState {
    /// Displacement [m].
    pub displacement: Vec<Vec3>,
    /// Velocity at the half step [m/s].
    pub velocity: Vec<Vec3>,
    /// Bodies in order.
    pub bodies: Vec<BodyState>,
    /// Energy dissipated by damage, block by block [J].
    pub dissipated: Vec<f64>,
    /// Energy dissipated by viscosity [J].
    pub viscous_dissipation: f64,
    /// Viscous stress times volume of the cells, block by block; empty without viscosity.
    pub viscous: Vec<Vec<Sym3>>,
}

/// How far the damage of a solid has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fracture {
    /// Edges with damage.
    pub damaged_edges: usize,
    /// Edges whose residual stress ratio has reached its limit.
    pub broken_edges: usize,
    /// Elements removed.
    pub removed_elements: usize,
}

impl Solid {
    /// Builds the cells of all bodies over shared nodes.
    ///
    /// - `nodes`: reference positions [m]
    ///
    /// # Errors
    /// [`SolidError`] for elements without volume or too large for their fracture energy, and for massless nodes.
    pub fn new(nodes: Vec<Vec3>, bodies: Vec<Body>) -> Result<Self, SolidError> {
        let mut mass = vec![0.0; nodes.len()];
        let mut blocks = Vec::new();
        let mut models = Vec::new();
        for (index, body) in bodies.into_iter().enumerate() {
            let geometry = Geometry { body: &body, nodes: &nodes };
            let volumes = geometry.volumes()?;
            let corners = body.shape.node_count();
            for (element, &volume) in body.elements.iter().zip(&volumes) {
                for &node in &element[..corners] {
                    mass[node as usize] += body.elastic.density * volume / corners as f64;
                }
            }
            let (model, mut own) = BodyModel::new(body, index, &nodes, &volumes, blocks.len())?;
            blocks.append(&mut own);
            models.push(model);
        }
        if let Some(node) = mass.iter().position(|&m| m <= 0.0) {
            return Err(SolidError::MasslessNode { node });
        }
        let slots = NodeSlots::new(nodes.len(), blocks.iter().map(|b: &Block| b.cells.nodes.as_slice()));
        let zero = vec![Vec3::zeros(); nodes.len()];
        Ok(Solid {
            displacement: zero.clone(),
            velocity: zero.clone(),
            force: zero,
            inverse_mass: mass.iter().map(|m| 1.0 / m).collect(),
            chunk_work: vec![StepWork::default(); nodes.len().div_ceil(CHUNK)],
            reference: nodes,
            mass,
            bodies: models,
            blocks,
            slots,
            viscous_dissipation: 0.0,
        })
    }

    /// Adds viscous stress to every body.
    pub fn set_viscosity(&mut self, viscosity: Viscosity) {
        for model in &mut self.bodies {
            let elastic = &model.body.elastic;
            model.viscosity = (!viscosity.is_off()).then(|| BodyViscosity {
                constants: viscosity,
                density: elastic.density,
                wave_speed: elastic.p_wave_speed(),
            });
        }
        for block in self.blocks.iter_mut().filter(|_| !viscosity.is_off()) {
            block.viscous = vec![Sym3::ZERO; block.cells.len()];
        }
    }

    /// Position of a node at tⁿ [m].
    #[inline]
    pub fn position(&self, node: usize) -> Vec3 {
        self.reference[node] + self.displacement[node]
    }

    /// Replaces `force` by the internal forces of the present displacements, and advances damage.
    ///
    /// - `dt`: time since the last call [s] (for rate-dependent laws)
    /// - `measure`: whether to sum the elastic energy, see [`Solid::elastic_energy`]
    pub fn update_internal_forces(&mut self, dt: f64, measure: bool) {
        self.update_standard_damage(dt);
        let Solid { displacement, velocity, blocks, bodies, .. } = self;
        blocks
            .par_iter_mut()
            .for_each(|block| block.evaluate(&bodies[block.body], displacement, velocity, dt, measure));
        let power: f64 = blocks.iter().map(|b| b.viscous_power).sum();
        self.viscous_dissipation += power * dt;
        self.gather_forces();
    }

    /// Sums the forces of the blocks on each node.
    pub(crate) fn gather_forces(&mut self) {
        let Solid { force, blocks, slots, .. } = self;
        force
            .par_iter_mut()
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(node, f)| *f = slots.gather(node, |block| blocks[block].forces()));
    }

    /// First passes of bodies with damage in the standard formulation: element stress, edge damage, element damage.
    fn update_standard_damage(&mut self, dt: f64) {
        if self.bodies.iter().all(|b| b.standard.is_none()) {
            return;
        }
        let Solid { displacement, blocks, bodies, .. } = self;
        blocks.par_iter_mut().for_each(|block| block.effective_stress(&bodies[block.body], displacement));
        for (index, model) in bodies.iter_mut().enumerate() {
            let BodyModel { standard: Some(standard), alive, location, edges, .. } = model else { continue };
            let fresh = standard.update_edges(dt, |element| {
                let (block, cell) = location[element as usize];
                match &blocks[block as usize].law {
                    BlockLaw::Standard(law) if alive[element as usize] => Some(law.stress[cell as usize]),
                    _ => None,
                }
            });
            standard.fresh |= fresh;
            let edges = edges.as_ref().expect("a body with damage has edges");
            let standard = &*standard;
            blocks.par_iter_mut().filter(|b| b.body == index).for_each(|block| {
                block.take_element_damage(|element| standard.element_damage(&edges.of_element[element as usize]));
            });
        }
    }

    /// Elastic energy at the last measured step [J].
    pub fn elastic_energy(&self) -> f64 {
        let of = |block: &Block| match &block.law {
            BlockLaw::Elastic { energy } => energy.unwrap_or(0.0),
            BlockLaw::Edges(law) => law.energy.unwrap_or(0.0),
            BlockLaw::Standard(law) => law.energy.unwrap_or(0.0),
        };
        self.blocks.iter().map(of).sum()
    }

    /// Energy dissipated by damage so far [J].
    pub fn dissipated_energy(&self) -> f64 {
        self.blocks.iter().map(Block::dissipated).sum()
    }

    /// Energy dissipated by viscosity so far [J].
    pub fn viscous_dissipation(&self) -> f64 {
        self.viscous_dissipation
    }

    /// Counts damaged and broken edges and removed elements.
    pub fn fracture(&self) -> Fracture {
        let mut count = Fracture::default();
        let mut add = |edge: &EdgeDamage| {
            count.damaged_edges += usize::from(edge.damage > 0.0);
            count.broken_edges += usize::from(edge.broken);
        };
        for block in &self.blocks {
            if let BlockLaw::Edges(law) = &block.law {
                law.edges.iter().for_each(&mut add);
            }
        }
        for model in &self.bodies {
            if let Some(standard) = &model.standard {
                standard.edges.iter().for_each(&mut add);
            }
        }
        count.removed_elements = self.bodies.iter().map(|b| b.alive.iter().filter(|a| !**a).count()).sum();
        count
    }

    /// Area of crack, Σ d V/l over the edges with the volumes V of the reference mesh and the characteristic lengths l
    /// [m²]: a crack through all of a bar counts as its cross-section.
    pub fn crack_area(&self) -> f64 {
        let mut area = 0.0;
        for (index, model) in self.bodies.iter().enumerate() {
            let share = 1.0 / model.body.shape.edge_count() as f64;
            for (edge, damage) in self.edge_damage(index).iter().enumerate().filter(|(_, e)| e.damage > 0.0) {
                let elements = model.elements_of_edge.row(edge);
                let volume: f64 = elements.iter().map(|&e| share * self.element_volume(index, e)).sum();
                area += damage.damage * volume / self.characteristic_length(index, edge);
            }
        }
        area
    }

    /// Characteristic length of an edge that may be damaged [m].
    fn characteristic_length(&self, body: usize, edge: usize) -> f64 {
        let model = &self.bodies[body];
        if let Some(standard) = &model.standard {
            return standard.length[edge];
        }
        let (block, cell) = model.location[edge];
        match &self.blocks[block as usize].law {
            BlockLaw::Edges(law) => law.length[cell as usize],
            _ => f64::INFINITY,
        }
    }

    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> SolidState {
        SolidState {
            displacement: self.displacement.clone(),
            velocity: self.velocity.clone(),
            bodies: (0..self.bodies.len()).map(|b| self.body_state(b)).collect(),
            dissipated: self.blocks.iter().map(Block::dissipated).collect(),
            viscous_dissipation: self.viscous_dissipation,
            viscous: self.blocks.iter().map(|b| b.viscous.clone()).collect(),
        }
    }

    /// Edge histories of a body in the order of its edges; empty without damage.
    pub fn edge_damage(&self, body: usize) -> Vec<EdgeDamage> {
        let model = &self.bodies[body];
        if let Some(standard) = &model.standard {
            return standard.edges.clone();
        }
        if model.body.damage.is_none() || model.body.formulation == Formulation::Standard {
            return Vec::new();
        }
        let of = |&(block, cell): &(u32, u32)| match &self.blocks[block as usize].law {
            BlockLaw::Edges(law) => law.edges[cell as usize],
            _ => EdgeDamage::intact(f64::INFINITY),
        };
        model.location.iter().map(of).collect()
    }

    fn body_state(&self, body: usize) -> BodyState {
        let model = &self.bodies[body];
        let of = |&(block, cell): &(u32, u32)| match &self.blocks[block as usize].law {
            BlockLaw::Standard(law) => (law.damage[cell as usize], law.stress[cell as usize]),
            _ => (0.0, Sym3::ZERO),
        };
        let elements = if model.standard.is_some() { model.location.iter().map(of).collect() } else { Vec::new() };
        BodyState { alive: model.alive.clone(), edges: self.edge_damage(body), elements }
    }

    /// Puts a saved state back. The solid must have been built from the same bodies.
    ///
    /// # Panics
    /// If the sizes of the state are those of another solid.
    pub fn restore(&mut self, state: SolidState) {
        assert_eq!(state.displacement.len(), self.reference.len(), "state of another solid");
        self.displacement = state.displacement;
        self.velocity = state.velocity;
        self.viscous_dissipation = state.viscous_dissipation;
        for (index, body) in state.bodies.into_iter().enumerate() {
            let Solid { bodies, blocks, .. } = self;
            let model = &mut bodies[index];
            for (place, &(block, cell)) in model.location.iter().enumerate() {
                match &mut blocks[block as usize].law {
                    BlockLaw::Edges(law) => {
                        law.edges[cell as usize] = body.edges[place];
                        law.threshold[cell as usize] = body.edges[place].threshold();
                    }
                    BlockLaw::Standard(law) => {
                        (law.damage[cell as usize], law.stress[cell as usize]) = body.elements[place];
                    }
                    BlockLaw::Elastic { .. } => {}
                }
            }
            if let Some(standard) = &mut model.standard {
                standard.edges = body.edges;
                standard.fresh = true;
            }
            model.alive = body.alive;
            let removed: Vec<u32> = (0..).zip(&model.alive).filter(|(_, alive)| !**alive).map(|(e, _)| e).collect();
            self.rebuild_cells_around(index, &removed);
        }
        for (block, viscous) in self.blocks.iter_mut().zip(state.viscous) {
            block.viscous = viscous;
        }
        for (block, dissipated) in self.blocks.iter_mut().zip(state.dissipated) {
            match &mut block.law {
                BlockLaw::Edges(law) => {
                    law.dissipated = dissipated;
                    // Edges that broke when others left are looked at in the next step; a second look finds nothing new.
                    law.fresh = true;
                }
                BlockLaw::Standard(law) => law.dissipated = dissipated,
                BlockLaw::Elastic { .. } => {}
            }
        }
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// A body as it was given.
    pub fn body(&self, index: usize) -> &Body {
        &self.bodies[index].body
    }

    /// Edges of a body, if its formulation or its damage uses them.
    pub fn body_edges(&self, index: usize) -> Option<&BodyEdges> {
        self.bodies[index].edges.as_ref()
    }

    /// Which elements of a body are still there.
    pub fn alive(&self, index: usize) -> &[bool] {
        &self.bodies[index].alive
    }

    /// Edges of a body whose strength was lowered to fit their length, and the largest ratio of a characteristic
    /// length to the one at which softening snaps back.
    pub fn length_report(&self, index: usize) -> (usize, f64) {
        (self.bodies[index].reduced_edges, self.bodies[index].largest_length_ratio)
    }

    /// Nominal stress [Pa] and damage of every element of a body: means over its edges where it is smoothed.
    pub fn element_fields(&self, index: usize) -> Vec<(Sym3, f64)> {
        let model = &self.bodies[index];
        let corotational = model.body.kinematics == Kinematics::Corotational;
        let cell_field = |&(block, cell): &(u32, u32)| {
            let (block, cell) = (&self.blocks[block as usize], cell as usize);
            let h = block.cells.gradient(cell, &self.displacement);
            let strain = if corotational { kernel::corotational_strain(&h).0 } else { Sym3::symmetric_part(&h) };
            let damage = block.damage_of(cell);
            (model.hooke.stress(strain) * (1.0 - damage), damage)
        };
        let cells: Vec<(Sym3, f64)> = model.location.par_iter().map(cell_field).collect();
        let Some(edges) = model.edges.as_ref().filter(|_| model.body.formulation == Formulation::Smoothed) else {
            return cells;
        };
        let count = model.body.shape.edge_count();
        let mean = |of: &[u32; 6]| {
            let mut sum = (Sym3::ZERO, 0.0);
            for &edge in &of[..count] {
                let (stress, damage) = cells[edge as usize];
                sum = (sum.0 + stress, sum.1 + damage);
            }
            (sum.0 * (1.0 / count as f64), sum.1 / count as f64)
        };
        edges.of_element.par_iter().map(mean).collect()
    }
}

impl BodyModel {
    /// The body with its blocks; `first_block` is the index that its first block will have.
    fn new(
        body: Body,
        index: usize,
        nodes: &[Vec3],
        volumes: &[f64],
        first_block: usize,
    ) -> Result<(Self, Vec<Block>), SolidError> {
        let elastic = body.elastic;
        let (lambda, mu) = (elastic.lame_lambda(), elastic.shear_modulus());
        let plane_stress = body.shape == Shape::T3 && body.plane == Plane::Stress;
        let hooke = if plane_stress {
            Hooke { lambda: 2.0 * lambda * mu / (lambda + 2.0 * mu), mu, zz: 0.0 }
        } else {
            Hooke { lambda, mu, zz: 1.0 }
        };
        let smoothed = body.formulation == Formulation::Smoothed;
        let geometry = Geometry { body: &body, nodes };
        let edges = (smoothed || body.damage.is_some()).then(|| body.edges());
        let edge_count = edges.as_ref().map_or(0, |e| e.nodes.len());
        let per_element = body.shape.edge_count();
        let elements_of_edge = edges.as_ref().map_or_else(Ragged::default, |edges| {
            Ragged::inverse(edge_count, edges.of_element.iter().map(|of| &of[..per_element]))
        });
        let threshold = match (&body.damage, &edges) {
            (Some(zone), Some(edges)) => Some(Threshold::new(&body, zone, edges, &elements_of_edge, nodes, volumes)?),
            _ => None,
        };
        let softens = body
            .damage
            .as_ref()
            .map(|zone| Arc::new(Softens { law: zone.law.clone(), hooke, young_modulus: elastic.young_modulus }));
        let cells = match &edges {
            Some(edges) if smoothed => geometry.edge_blocks(edges, &elements_of_edge, |edge| {
                threshold.as_ref().is_some_and(|t| t.strength[edge as usize].is_finite())
            }),
            _ => geometry.element_blocks(),
        };
        let mut location = vec![(0, 0); if smoothed { edge_count } else { body.elements.len() }];
        let mut blocks = Vec::with_capacity(cells.len());
        for (cells, items) in cells {
            for (cell, &item) in items.iter().enumerate() {
                location[item as usize] = ((first_block + blocks.len()) as u32, cell as u32);
            }
            let law = match (&softens, &threshold) {
                (Some(softens), Some(t)) if smoothed && t.strength[items[0] as usize].is_finite() => {
                    let strength: Vec<f64> = items.iter().map(|&e| t.strength[e as usize]).collect();
                    BlockLaw::Edges(EdgeCells {
                        softens: softens.clone(),
                        edges: strength.iter().map(|&s| EdgeDamage::intact(s)).collect(),
                        length: items.iter().map(|&e| t.length[e as usize]).collect(),
                        threshold: strength.clone(),
                        strength,
                        dissipated: 0.0,
                        fresh: false,
                        dt: 0.0,
                        energy: None,
                    })
                }
                (Some(softens), Some(_)) if !smoothed => BlockLaw::Standard(StandardCells {
                    softens: softens.clone(),
                    stress: vec![Sym3::ZERO; items.len()],
                    damage: vec![0.0; items.len()],
                    mixed_energy: vec![0.0; items.len()],
                    dissipated: 0.0,
                    energy: None,
                }),
                _ => BlockLaw::Elastic { energy: None },
            };
            let scratch = Scratch::new();
            blocks.push(Block { body: index, cells, items, law, scratch, viscous_power: 0.0, viscous: Vec::new() });
        }
        let (reduced_edges, largest_length_ratio) =
            threshold.as_ref().map_or((0, 0.0), |t| (t.reduced_edges, t.largest_length_ratio));
        let standard = match (softens, threshold) {
            (Some(softens), Some(t)) if !smoothed => Some(StandardDamage {
                softens,
                shape: body.shape,
                edges: t.strength.iter().map(|&s| EdgeDamage::intact(s)).collect(),
                strength: t.strength,
                length: t.length,
                elements_of_edge: elements_of_edge.clone(),
                fresh: false,
            }),
            _ => None,
        };
        let alive = vec![true; body.elements.len()];
        let model = BodyModel {
            body,
            hooke,
            viscosity: None,
            alive,
            edges,
            elements_of_edge,
            location,
            standard,
            reduced_edges,
            largest_length_ratio,
        };
        Ok((model, blocks))
    }
}

/// Strength and characteristic length of the edges of a body.
struct Threshold {
    strength: Vec<f64>,
    length: Vec<f64>,
    reduced_edges: usize,
    largest_length_ratio: f64,
}

impl Threshold {
    /// Characteristic lengths c · mean (regular edge of the sharing elements), and the guard against snap-back.
    fn new(
        body: &Body,
        zone: &DamageZone,
        edges: &BodyEdges,
        elements_of_edge: &Ragged,
        nodes: &[Vec3],
        volumes: &[f64],
    ) -> Result<Self, SolidError> {
        // Measured on the tension bars of the gallery (aligned, jittered and Delaunay meshes of two sizes), never on other
        // cases: the middle of the range in which all of them dissipate G_f times the area within 6 %.
        let factor = match (body.formulation, body.shape) {
            (Formulation::Smoothed, Shape::T4) => 1.09,
            (Formulation::Smoothed, Shape::T3) => 1.124,
            (Formulation::Standard, Shape::T4) => 1.11,
            (Formulation::Standard, Shape::T3) => 1.28,
        };
        let thickness = if body.shape == Shape::T3 { body.thickness } else { 1.0 };
        let length = |edge: usize| {
            let elements = elements_of_edge.row(edge);
            let sum: f64 = elements.iter().map(|&e| regular_edge(body.shape, volumes[e as usize] / thickness)).sum();
            factor * sum / elements.len() as f64
        };
        let count = edges.nodes.len();
        let length: Vec<f64> = (0..count).into_par_iter().map(length).collect();
        let mut threshold =
            Threshold { strength: vec![f64::INFINITY; count], length, reduced_edges: 0, largest_length_ratio: 0.0 };
        let mut worst: Option<(usize, f64, f64)> = None;
        for edge in 0..count {
            if matches!(&zone.region, Region::Edges(marked) if !marked[edge]) {
                continue;
            }
            let mut strength = zone.law.tensile_strength * zone.strength_factor.get(edge).copied().unwrap_or(1.0);
            let limit_at = |strength| {
                zone.law.softening.largest_length(body.elastic.young_modulus, strength, zone.law.fracture_energy)
            };
            let ratio = threshold.length[edge] / limit_at(strength);
            if ratio >= 1.0 {
                threshold.reduced_edges += 1;
                if worst.is_none_or(|(_, r, _)| ratio > r) {
                    worst = Some((edge, ratio, limit_at(strength)));
                }
                // The limit goes with 1/f_t²: this leaves a tenth of the length in reserve.
                strength *= (0.9 / ratio).sqrt();
            }
            threshold.largest_length_ratio = threshold.largest_length_ratio.max(ratio);
            threshold.strength[edge] = strength;
        }
        if let (Some((edge, _, limit)), false) = (worst, zone.reduce_strength_to_fit) {
            let [i, j] = edges.nodes[edge];
            let middle = (nodes[i as usize] + nodes[j as usize]) * 0.5;
            return Err(SolidError::ElementTooLarge {
                body: body.name.clone(),
                x: middle.x,
                y: middle.y,
                z: middle.z,
                length: threshold.length[edge],
                limit,
                count: threshold.reduced_edges,
            });
        }
        Ok(threshold)
    }
}

impl Block {
    /// Forces of all cells of the block into its scratch.
    fn evaluate(&mut self, model: &BodyModel, displacement: &[Vec3], velocity: &[Vec3], dt: f64, measure: bool) {
        let Block { cells, scratch, law, viscous_power, viscous, .. } = self;
        scratch.load(&cells.nodes, displacement);
        if model.viscosity.is_some() {
            scratch.load_velocity(&cells.nodes, velocity);
        }
        let start = measure.then_some(0.0);
        *viscous_power = match law {
            BlockLaw::Elastic { energy } => {
                let mut law = ElasticCells { hooke: model.hooke, energy: start };
                let power = run(model, cells, scratch, &mut law, viscous);
                *energy = law.energy;
                power
            }
            BlockLaw::Edges(law) => {
                (law.dt, law.energy) = (dt, start);
                run(model, cells, scratch, law, viscous)
            }
            BlockLaw::Standard(law) => {
                law.energy = start;
                run(model, cells, scratch, law, viscous)
            }
        };
    }

    /// Elastic forces of all cells whatever their damage, for the stable step.
    pub(crate) fn evaluate_elastic(&mut self, model: &BodyModel, displacement: &[Vec3]) {
        self.scratch.load(&self.cells.nodes, displacement);
        kernel::forces(&self.cells, &mut self.scratch, &mut ElasticCells { hooke: model.hooke, energy: None });
    }

    /// Effective stress of the elements of a standard body with damage.
    fn effective_stress(&mut self, model: &BodyModel, displacement: &[Vec3]) {
        let Block { cells, law: BlockLaw::Standard(law), .. } = self else { return };
        for cell in 0..cells.len() {
            let h = cells.gradient(cell, displacement);
            let strain = match model.body.kinematics {
                Kinematics::Small => Sym3::symmetric_part(&h),
                Kinematics::Corotational => kernel::corotational_strain(&h).0,
            };
            law.mixed_energy[cell] = 0.5 * law.stress[cell].dot(strain);
            law.stress[cell] = model.hooke.stress(strain);
        }
    }

    /// Takes over the damage of the elements of a standard body, and books what it dissipates.
    fn take_element_damage(&mut self, damage_of: impl Fn(u32) -> f64) {
        let Block { cells, items, law: BlockLaw::Standard(law), .. } = self else { return };
        for (cell, &element) in items.iter().enumerate() {
            let damage = damage_of(element).max(law.damage[cell]);
            law.dissipated += (damage - law.damage[cell]) * law.mixed_energy[cell] * cells.volume[cell];
            law.damage[cell] = damage;
        }
    }

    pub(crate) fn dissipated(&self) -> f64 {
        match &self.law {
            BlockLaw::Elastic { .. } => 0.0,
            BlockLaw::Edges(law) => law.dissipated,
            BlockLaw::Standard(law) => law.dissipated,
        }
    }

    pub(crate) fn damage_of(&self, cell: usize) -> f64 {
        match &self.law {
            BlockLaw::Elastic { .. } => 0.0,
            BlockLaw::Edges(law) => law.edges[cell].damage,
            BlockLaw::Standard(law) => law.damage[cell],
        }
    }

    /// Force sums of the block, one per local node.
    pub(crate) fn forces(&self) -> &[Lane] {
        self.scratch.force.as_slice()
    }
}

/// Runs the cheapest kernel that the body allows; returns the viscous power [W].
fn run<L: kernel::CellLaw>(
    model: &BodyModel,
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
    viscous: &mut [Sym3],
) -> f64 {
    let corotational = model.body.kinematics == Kinematics::Corotational;
    if corotational || model.viscosity.is_some() {
        return kernel::general_forces(
            cells,
            scratch,
            law,
            corotational,
            model.viscosity.as_ref(),
            &model.hooke,
            viscous,
        );
    }
    kernel::forces(cells, scratch, law);
    0.0
}
