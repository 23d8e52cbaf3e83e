//! What changes in a solid during a run, for checkpoints.

use std::ops::Range;

use fractum_kernels::damage::{EdgeDamage, EdgeRate};
use fractum_math::{Sym3, Vec3};
use serde::{Deserialize, Serialize};

use crate::body::Kinematics;
use crate::damage::edge::EdgeField;
use crate::damage::rate::{RateField, RateReport};
use crate::motion::phase_edges::restore_phase;
use crate::removal::rebuild_cells_around;
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::subcycling::forget_ahead;
use crate::solid::{BodyModel, Solid};

/// What changes in a body during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyState {
    /// Measure of strain, which changes where a body begins to turn.
    pub kinematics: Kinematics,
    /// Elements that are still there.
    pub alive: Vec<bool>,
    /// Edge histories; empty without damage, and where no process has all of them, see [`crate::neighbours::each_history`].
    pub edges: Vec<EdgeDamage>,
    /// Damage and last effective stress of elements (standard formulation with damage).
    pub elements: Vec<(f64, Sym3)>,
    /// Active edges of a phase field, each with d, d of the step before, and whether elements have left it since the last forces; empty
    /// without one.
    pub phase: Vec<(u32, [f64; 2], bool)>,
    /// Time and history of the rate of strain, by edge; empty where strength does not grow with it.
    pub rates: Vec<(f64, EdgeRate)>,
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
    /// Energy dissipated by damage, block by block; behind it, where closed cracks rub, that taken by their friction [J].
    pub dissipated: Vec<f64>,
    /// Energy dissipated by viscosity [J].
    pub viscous_dissipation: f64,
    /// Viscous stress times volume of the cells, block by block; empty without viscosity.
    pub viscous: Vec<Vec<Sym3>>,
    /// Strains at which the cells are free of stress, block by block, empty of blocks where it is none; empty where it is none anywhere.
    pub born: Vec<Vec<Sym3>>,
}

impl Solid {
    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> SolidState {
        SolidState {
            displacement: self.displacement.clone(),
            velocity: self.velocity.clone(),
            bodies: (0..self.bodies.len()).map(|body| body_state(self, body, kept_damage(self, body))).collect(),
            dissipated: taken_energies(self, 0..self.blocks.len()).map(|(_, energy)| energy).collect(),
            viscous_dissipation: self.viscous_dissipation,
            viscous: self.blocks.iter().map(|b| b.viscous.stress.clone()).collect(),
            born: born(self),
        }
    }

    /// Edge histories of a body in the order of its edges, those that are known here; empty without damage.
    pub fn edge_damage(&self, body: usize) -> Vec<EdgeDamage> {
        let model = &self.bodies[body];
        let Some(edges) = model.edges.as_ref().filter(|_| model.body.damage.is_some()) else { return Vec::new() };
        let mut all = vec![EdgeDamage::intact(f64::INFINITY); edges.len()];
        for (_, field) in self.edge_fields().filter(|(of, _)| *of == body) {
            (0..).zip(&field.edges).for_each(|(at, &edge)| all[edge as usize] = field.history(at));
        }
        all
    }

    /// Sees the nodes of every edge of a body with damage that has an element and has lost less than this share of its strength, 0 to 1.
    ///
    /// The share is 1 − χ of the softening curve; damage measures the loss of stiffness and comes close to 1 long before.
    pub fn each_joined(&self, body: usize, below: f64, mut see: impl FnMut([u32; 2])) {
        let model = &self.bodies[body];
        let Some(edges) = &model.edges else { return };
        let fields = self.damaged_fields().filter(|(of, _)| *of == body).map(|(_, field)| field);
        let lost = |field: &EdgeField, at: usize| {
            let edge = &field.state[at];
            let left = (1.0 - edge.damage) * edge.kappa / field.strength[at];
            (1.0 - left).clamp(0.0, 1.0)
        };
        let damaged = fields.flat_map(|field| {
            let damaged = (0..field.state.len()).filter(|&at| field.state[at].damage > 0.0);
            damaged.map(move |at| (field.edges[at], lost(field, at)))
        });
        let mut apart: Vec<u32> = damaged.filter(|(_, lost)| *lost >= below).map(|(edge, _)| edge).collect();
        apart.sort_unstable();
        let mut apart = apart.into_iter().peekable();
        edges.for_each(|edge, nodes, around| {
            let is_apart = apart.next_if_eq(&edge).is_some() || below <= 0.0;
            if !is_apart && around.iter().any(|&element| model.alive[element as usize]) {
                see(nodes);
            }
        });
    }

    /// Puts a saved state back. The solid must have been built from the same bodies.
    ///
    /// # Panics
    /// If the sizes of the state are those of another solid.
    pub fn restore(&mut self, state: SolidState) {
        assert_eq!(state.displacement.len(), self.displacement.len(), "state of another solid");
        self.displacement = state.displacement;
        self.velocity = state.velocity;
        self.viscous_dissipation = state.viscous_dissipation;
        forget_ahead(self);
        self.neighbours.forget_received(&mut self.blocks);
        for (index, body) in state.bodies.into_iter().enumerate() {
            let Solid { bodies, blocks, neighbours, .. } = self;
            let model = &mut bodies[index];
            model.body.kinematics = body.kinematics;
            let cells = blocks.iter_mut().filter(|block| block.body == index).filter_map(Block::edge_field_mut);
            let standard = model.standard.as_mut().map(|standard| &mut standard.field);
            cells.chain(standard).for_each(|field| field.restore(&body.edges, &body.rates));
            for (&(block, cell), saved) in model.location.all().iter().zip(&body.elements) {
                if let BlockLaw::Standard(law) = &mut blocks[block as usize].law {
                    (law.damage[cell as usize], law.stress[cell as usize]) = *saved;
                }
            }
            blocks.iter_mut().for_each(Block::expect_any_damage);
            let saved = |element: u32| body.alive[neighbours.number(index, element) as usize];
            (0..).zip(&mut model.alive).for_each(|(element, alive)| *alive = saved(element));
            let removed: Vec<u32> = (0..).zip(&model.alive).filter(|(_, alive)| !**alive).map(|(e, _)| e).collect();
            rebuild_cells_around(self, index, &removed);
            restore_phase(self, index, &body.phase);
        }
        self.with_neighbours(|neighbours, solid| neighbours.exchange_restored(solid));
        let is_elsewhere = |block: &Block| block.items.is_empty();
        for (block, viscous) in self.blocks.iter_mut().zip(state.viscous).filter(|(block, _)| !is_elsewhere(block)) {
            block.viscous.stress = viscous;
        }
        for (block, born) in self.blocks.iter_mut().zip(state.born).filter(|(_, born)| !born.is_empty()) {
            block.cells.born = Some(born.into());
        }
        let (damage, friction) = state.dissipated.split_at(state.dissipated.len().min(self.blocks.len()));
        self.blocks.iter_mut().zip(damage).for_each(|(block, energy)| block.dissipated = *energy);
        self.blocks.iter_mut().zip(friction).for_each(|(block, energy)| block.rubbed = *energy);
    }
}

/// Strains at which the cells are free of stress, block by block; nothing where they are none.
fn born(solid: &Solid) -> Vec<Vec<Sym3>> {
    if solid.blocks.iter().all(|block| block.cells.born.is_none()) {
        return Vec::new();
    }
    solid.blocks.iter().map(|block| block.cells.born.as_deref().unwrap_or_default().to_vec()).collect()
}

/// What damage, and where closed cracks rub their friction, has taken in some blocks, with its place in the state [J].
pub(crate) fn taken_energies(solid: &Solid, of: Range<usize>) -> impl Iterator<Item = (u32, f64)> + '_ {
    let damage = of.clone().map(|index| (index as u32, solid.blocks[index].dissipated));
    let behind = taken_count(solid) - solid.blocks.len();
    let friction = of.map(move |index| ((behind + index) as u32, solid.blocks[index].rubbed));
    damage.chain(friction.filter(move |_| behind > 0))
}

/// Number of them in all blocks.
pub(crate) fn taken_count(solid: &Solid) -> usize {
    let rubs = |model: &BodyModel| model.body.damage.as_ref().is_some_and(|zone| zone.law.friction.is_some());
    solid.blocks.len() * (1 + usize::from(solid.bodies.iter().any(rubs)))
}

fn kept_damage(solid: &Solid, body: usize) -> Vec<EdgeDamage> {
    if solid.bodies[body].location.keeps_all() { solid.edge_damage(body) } else { Vec::new() }
}

/// The rates at which the edges of a body began to break; none where they play no part.
pub fn rate_report(solid: &Solid, body: usize) -> Option<RateReport> {
    let fields = solid.edge_fields().filter(|(of, _)| *of == body).map(|(_, field)| field.rate.as_deref());
    let fields: Option<Vec<&RateField>> = fields.collect();
    fields.filter(|fields| !fields.is_empty()).map(|fields| RateReport::of(fields.iter().flat_map(|f| &f.edges)))
}

/// What is saved of the rates of the edges of a body, in their order; nothing where they play no part.
fn saved_rates(solid: &Solid, body: usize) -> Vec<(f64, EdgeRate)> {
    let model = &solid.bodies[body];
    let has_rates = model.body.damage.as_ref().is_some_and(|zone| zone.rate.is_some());
    let Some(edges) = model.edges.as_ref().filter(|_| has_rates) else { return Vec::new() };
    let mut all = vec![(0.0, EdgeRate::intact(f64::INFINITY)); edges.len()];
    for (_, field) in solid.edge_fields().filter(|(of, _)| *of == body) {
        let Some(rate) = &field.rate else { continue };
        (0..).zip(&field.edges).for_each(|(at, &edge)| all[edge as usize] = rate.saved(at));
    }
    all
}

pub(crate) fn body_state(solid: &Solid, body: usize, edges: Vec<EdgeDamage>) -> BodyState {
    let model = &solid.bodies[body];
    let of = |&(block, cell): &(u32, u32)| match &solid.blocks[block as usize].law {
        BlockLaw::Standard(law) => (law.damage[cell as usize], law.stress[cell as usize]),
        _ => (0.0, Sym3::ZERO),
    };
    let elements = if model.standard.is_some() { model.location.all().iter().map(of).collect() } else { Vec::new() };
    let phase = model.phase.as_ref().map_or_else(Vec::new, |field| field.state().collect());
    // Nothing is removed of a body of which no process has all elements.
    let mut alive = vec![true; solid.neighbours.element_count(body, model.alive.len())];
    let numbers = (0..).map(|element| solid.neighbours.number(body, element) as usize);
    numbers.zip(&model.alive).for_each(|(number, &is_alive)| alive[number] = is_alive);
    BodyState { kinematics: model.body.kinematics, alive, edges, elements, phase, rates: saved_rates(solid, body) }
}
