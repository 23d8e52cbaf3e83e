//! What changes in a solid during a run, for checkpoints.

use fractum_math::{Sym3, Vec3};
use fractum_parallel::gather;
use serde::{Deserialize, Serialize};

use crate::body::Kinematics;
use crate::damage::edge::{EdgeDamage, EdgeField};
use crate::solid::Solid;
use crate::solid::evaluate::{Block, BlockLaw};

/// Edges whose histories ranks tell each other at a time.
const TOLD_AT_ONCE: usize = 1 << 17;

/// What changes in a body during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyState {
    /// Measure of strain, which changes where a body begins to turn.
    pub kinematics: Kinematics,
    /// Elements that are still there.
    pub alive: Vec<bool>,
    /// Edge histories; empty without damage, and where no rank has all of them, see [`Solid::each_history`].
    pub edges: Vec<EdgeDamage>,
    /// Damage and last effective stress of elements (standard formulation with damage).
    pub elements: Vec<(f64, Sym3)>,
    /// Active edges of a phase field, each with d, d of the step before, and whether elements have left it since the last forces; empty
    /// without one.
    pub phase: Vec<(u32, [f64; 2], bool)>,
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

impl Solid {
    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> SolidState {
        SolidState {
            displacement: self.displacement.clone(),
            velocity: self.velocity.clone(),
            bodies: (0..self.bodies.len()).map(|body| self.body_state(body, self.kept_damage(body))).collect(),
            dissipated: self.blocks.iter().map(Block::dissipated).collect(),
            viscous_dissipation: self.viscous_dissipation,
            viscous: self.blocks.iter().map(|b| b.viscous.stress.clone()).collect(),
        }
    }

    fn kept_damage(&self, body: usize) -> Vec<EdgeDamage> {
        if self.bodies[body].known.is_some() { Vec::new() } else { self.edge_damage(body) }
    }

    /// Edge histories of a body in the order of its edges, with their number first, those of all ranks a few at a time. All ranks must
    /// call it.
    pub fn each_history(&self, body: usize, see_count: impl FnOnce(usize), mut see: impl FnMut(&EdgeDamage)) {
        let model = &self.bodies[body];
        let (Some(part), Some(_), Some(edges)) = (&self.part, &model.known, &model.edges) else {
            let all = self.edge_damage(body);
            see_count(all.len());
            return all.iter().for_each(see);
        };
        see_count(edges.len());
        let own = model.location.own();
        for begin in (0..edges.len()).step_by(TOLD_AT_ONCE) {
            let at = |edge: usize| own.partition_point(|(own, _)| (*own as usize) < edge);
            let history = |&(edge, (block, cell)): &(u32, (u32, u32))| {
                let field = self.blocks[block as usize].edge_field();
                let unbroken = EdgeDamage::intact(f64::INFINITY);
                (edge, field.map_or(unbroken, |field| field.history(cell as usize)))
            };
            let mine: Vec<(u32, EdgeDamage)> = own[at(begin)..at(begin + TOLD_AT_ONCE)].iter().map(history).collect();
            let mut all = gather(&*part.exchange(), &mine).concat();
            all.sort_unstable_by_key(|(edge, _)| *edge);
            all.iter().for_each(|(_, history)| see(history));
        }
    }

    /// Edge histories of a body in the order of its edges, those of this rank and what it has been told of others; empty without damage.
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

    pub(crate) fn body_state(&self, body: usize, edges: Vec<EdgeDamage>) -> BodyState {
        let model = &self.bodies[body];
        let of = |&(block, cell): &(u32, u32)| match &self.blocks[block as usize].law {
            BlockLaw::Standard(law) => (law.damage[cell as usize], law.stress[cell as usize]),
            _ => (0.0, Sym3::ZERO),
        };
        let elements =
            if model.standard.is_some() { model.location.all().iter().map(of).collect() } else { Vec::new() };
        let phase = model.phase.as_ref().map_or_else(Vec::new, |field| field.state().collect());
        // Nothing is removed of a body that no rank has whole.
        let alive = model.divided.as_ref().map_or_else(|| model.alive.clone(), |divided| vec![true; divided.count]);
        BodyState { kinematics: model.body.kinematics, alive, edges, elements, phase }
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
        self.forget_ahead();
        self.blocks.iter_mut().for_each(Block::forget_told);
        for (index, body) in state.bodies.into_iter().enumerate() {
            let Solid { bodies, blocks, .. } = self;
            let model = &mut bodies[index];
            model.body.kinematics = body.kinematics;
            let cells = blocks.iter_mut().filter(|block| block.body == index).filter_map(Block::edge_field_mut);
            let standard = model.standard.as_mut().map(|standard| &mut standard.field);
            cells.chain(standard).for_each(|field| field.restore(&body.edges));
            for (&(block, cell), saved) in model.location.all().iter().zip(&body.elements) {
                if let BlockLaw::Standard(law) = &mut blocks[block as usize].law {
                    (law.damage[cell as usize], law.stress[cell as usize]) = *saved;
                }
            }
            blocks.iter_mut().for_each(Block::expect_any_damage);
            if model.divided.is_none() {
                model.alive = body.alive;
            }
            let removed: Vec<u32> = (0..).zip(&model.alive).filter(|(_, alive)| !**alive).map(|(e, _)| e).collect();
            self.rebuild_cells_around(index, &removed);
            self.restore_phase(index, &body.phase);
        }
        self.tell_restored();
        let is_elsewhere = |block: &Block| block.items.is_empty();
        for (block, viscous) in self.blocks.iter_mut().zip(state.viscous).filter(|(block, _)| !is_elsewhere(block)) {
            block.viscous.stress = viscous;
        }
        for (block, dissipated) in self.blocks.iter_mut().zip(state.dissipated) {
            match &mut block.law {
                BlockLaw::Edges(law) => law.dissipated = dissipated,
                BlockLaw::Standard(law) => law.dissipated = dissipated,
                BlockLaw::Told(told) => told.dissipated = dissipated,
                BlockLaw::Elastic { .. } => {}
            }
        }
    }
}
