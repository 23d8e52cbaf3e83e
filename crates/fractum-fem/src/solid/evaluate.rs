//! Blocks of cells with the law they follow.

use fractum_math::{Lane, Vec3};

use crate::body::Kinematics;
use crate::cells::block::{BLOCK_NODES, Cells, Scratch};
use crate::cells::cell::Bundle;
use crate::cells::kernel::{self, ElasticCells, ExpandingCells, Viscous};
use crate::cells::viscosity::ViscousCells;
use crate::damage::edge::EdgeField;
use crate::damage::edges_in_step::{Advance, EdgeCells, EdgesInStep, FourEdgesInStep};
use crate::damage::standard::{self, StandardCells};
use crate::divided::told_edges::{ToldEdge, ToldEdges};
use crate::solid::body_model::BodyModel;

/// How the cells of a block answer to strain.
#[derive(Clone, Debug)]
pub(crate) enum BlockLaw {
    Elastic {
        energy: Option<f64>,
    },
    Edges(EdgeCells),
    Standard(StandardCells),
    /// What was told of the edges of another rank, which evaluates them.
    Told(ToldEdges),
}

/// A block of cells of one body.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) body: usize,
    pub(crate) cells: Cells,
    /// The element or edge of the body that each cell stands for.
    pub(crate) items: Vec<u32>,
    /// Gradients of all its cells: what its evaluation costs.
    pub(crate) gradients: usize,
    pub(crate) law: BlockLaw,
    /// Its part of the step; none where this process neither evaluates it nor needs its forces.
    pub(crate) scratch: Option<Scratch>,
    /// Power of the viscous stress in the last step [W].
    pub(crate) viscous_power: f64,
    /// Viscous stress of the cells; empty without viscosity.
    pub(crate) viscous: ViscousCells,
    /// Work that the whole of the present change of temperatures does at the stresses of the last step [J].
    pub(crate) expansion_work: f64,
    /// A corotational cell that is turned inside out and still carries.
    pub(crate) inverted: Option<usize>,
    /// Whether its cells take shorter steps than others, see [`crate::solid::subcycling`].
    pub(crate) is_fine: bool,
}

impl Block {
    /// A block whose cells have no geometry yet.
    pub(crate) fn new(bundle: Bundle, body: usize, law: BlockLaw, is_fine: bool) -> Self {
        let Bundle { items, nodes, gradients } = bundle;
        let (cells, viscous) = (Cells { nodes, ..Cells::default() }, ViscousCells::default());
        Block {
            body,
            cells,
            items,
            gradients,
            law,
            scratch: None,
            viscous_power: 0.0,
            viscous,
            expansion_work: 0.0,
            inverted: None,
            is_fine,
        }
    }

    /// A block that another rank evaluates, of which this one has no more than nodes that are its own too.
    pub(crate) fn elsewhere(body: usize, gradients: usize, nodes: Vec<u32>, law: BlockLaw) -> Self {
        let bundle = Bundle { items: Vec::new(), nodes, gradients };
        Block::new(bundle, body, law, false)
    }

    /// Forces of all cells of the block into its scratch.
    pub(crate) fn evaluate(
        &mut self,
        model: &BodyModel,
        displacement: &[Vec3],
        velocity: &[Vec3],
        dt: f64,
        measure: bool,
    ) {
        let is_plain = self.is_plain(model);
        let Block { cells, scratch: Some(scratch), law, viscous_power, viscous, expansion_work, inverted, .. } = self
        else {
            return;
        };
        if let BlockLaw::Standard(law) = law
            && is_plain
            && !measure
        {
            law.energy = None;
            standard::forces(cells, &mut scratch.force, law);
            return;
        }
        scratch.load(&cells.nodes, displacement);
        if model.viscosity.is_some() {
            scratch.load_velocity(&cells.nodes, velocity);
            viscous.begin_step();
        }
        let start = measure.then_some(0.0);
        (*viscous_power, *inverted, *expansion_work) = match law {
            BlockLaw::Elastic { energy } => {
                let mut law = ElasticCells { hooke: model.hooke, energy: start };
                let outcome = run(model, cells, scratch, &mut law, viscous);
                *energy = law.energy;
                outcome
            }
            BlockLaw::Edges(law) => {
                law.energy = start;
                let step = Advance { displacement, velocity, dt, kinematics: model.body.kinematics };
                let by_fours = law.field.softens.is_unilateral() || law.field.is_mostly_damaged();
                let mut edges = EdgesInStep { edges: law, cells, step };
                if by_fours {
                    run(model, cells, scratch, &mut FourEdgesInStep(edges), viscous)
                } else {
                    run(model, cells, scratch, &mut edges, viscous)
                }
            }
            BlockLaw::Standard(law) => {
                law.energy = start;
                run(model, cells, scratch, law, viscous)
            }
            BlockLaw::Told(_) => return,
        };
    }

    /// Elastic forces of all cells whatever their damage, for the stable step.
    pub(crate) fn evaluate_elastic(&mut self, model: &BodyModel, displacement: &[Vec3]) {
        let Some(scratch) = &mut self.scratch else { return };
        scratch.load(&self.cells.nodes, displacement);
        kernel::forces(&self.cells, scratch, &mut ElasticCells { hooke: model.hooke, energy: None });
    }

    /// Effective stress of the elements of a standard body with damage.
    pub(crate) fn effective_stress(&mut self, model: &BodyModel, displacement: &[Vec3]) {
        let is_plain = self.is_plain(model);
        let Block { cells, scratch: Some(scratch), law: BlockLaw::Standard(law), .. } = self else { return };
        if is_plain {
            scratch.load(&cells.nodes, displacement);
            standard::stresses(cells, &scratch.displacement, law);
            return;
        }
        for cell in 0..cells.len() {
            law.see(cell, kernel::elastic_strain(cells, cell, displacement, model.body.kinematics));
        }
    }

    /// Whether its cells neither turn nor expand, and are not viscous: strains that were found once serve the forces too.
    fn is_plain(&self, model: &BodyModel) -> bool {
        model.body.kinematics != Kinematics::Corotational && model.viscosity.is_none() && self.cells.thermal.is_none()
    }

    /// Has the elements of a standard body take over the damage of their edges once more, whatever happened to these.
    pub(crate) fn expect_any_damage(&mut self) {
        if let BlockLaw::Standard(law) = &mut self.law {
            law.expect_any_damage();
        }
    }

    /// Takes over the damage of the elements of a standard body, and books what it dissipates.
    ///
    /// - `of_edges`: damage of an element by its edges, and the least stress that one of them has seen [Pa]
    pub(crate) fn take_element_damage(&mut self, of_edges: impl Fn(u32) -> (f64, f64)) {
        let Block { cells, items, law: BlockLaw::Standard(law), .. } = self else { return };
        // A phase field has its own list of what grows.
        if law.softens.regularised {
            items.iter().enumerate().for_each(|(cell, &item)| law.take(cell, cells.volume[cell], of_edges(item)));
            return;
        }
        let mut word = 0;
        while let Some(cell) = law.next_stale(&mut word) {
            law.take(cell, cells.volume[cell], of_edges(items[cell]));
        }
    }

    /// Damage of the edges that its cells are.
    pub(crate) fn edge_field(&self) -> Option<&EdgeField> {
        match &self.law {
            BlockLaw::Edges(law) => Some(&law.field),
            BlockLaw::Told(told) => Some(&told.field),
            _ => None,
        }
    }

    pub(crate) fn edge_field_mut(&mut self) -> Option<&mut EdgeField> {
        match &mut self.law {
            BlockLaw::Edges(law) => Some(&mut law.field),
            BlockLaw::Told(told) => Some(&mut told.field),
            _ => None,
        }
    }

    /// What was told of its edges, where another rank evaluates them.
    pub(crate) fn told_edges(&self) -> Option<&ToldEdges> {
        if let BlockLaw::Told(told) = &self.law { Some(told) } else { None }
    }

    /// Forgets what was told of its edges, where another rank evaluates them.
    pub(crate) fn forget_told(&mut self) {
        if let BlockLaw::Told(told) = &mut self.law {
            told.forget();
        }
    }

    /// Place of a cell in [`Block::edge_field`].
    pub(crate) fn place_of(&self, cell: u32) -> Option<usize> {
        self.told_edges().map_or(Some(cell as usize), |told| told.place(cell))
    }

    /// Takes over what another rank has told of an edge.
    pub(crate) fn put_edge(&mut self, told: &ToldEdge) {
        match &mut self.law {
            BlockLaw::Edges(law) => law.field.put(told.cell as usize, told.history),
            BlockLaw::Told(own) => own.put(told),
            _ => {}
        }
    }

    /// The cells of a block of a standard body with damage.
    pub(crate) fn standard_cells(&self) -> &StandardCells {
        if let BlockLaw::Standard(law) = &self.law { law } else { unreachable!("a block of another kind of body") }
    }

    /// Whether something happened in the last step that others must know: an edge woke or broke, a cell was turned inside out.
    pub(crate) fn has_event(&self) -> bool {
        // Without a phase field no edge waits for its damage.
        let of_edges = |field: &EdgeField| field.woken && field.softens.regularised || !field.fresh.is_empty();
        self.inverted.is_some() || self.edge_field().is_some_and(of_edges)
    }

    /// Elastic energy, where it was summed [J].
    pub(crate) fn elastic(&self) -> f64 {
        match &self.law {
            BlockLaw::Elastic { energy } => energy.unwrap_or(0.0),
            BlockLaw::Edges(law) => law.energy.unwrap_or(0.0),
            BlockLaw::Standard(law) => law.energy.unwrap_or(0.0),
            BlockLaw::Told(law) => law.energy.unwrap_or(0.0),
        }
    }

    /// Takes over elastic and dissipated energy that another rank has found [J].
    pub(crate) fn put_energies(&mut self, [elastic, taken]: [f64; 2]) {
        match &mut self.law {
            BlockLaw::Elastic { energy } => *energy = Some(elastic),
            BlockLaw::Edges(law) => (law.energy, law.dissipated) = (Some(elastic), taken),
            BlockLaw::Standard(law) => (law.energy, law.dissipated) = (Some(elastic), taken),
            BlockLaw::Told(law) => (law.energy, law.dissipated) = (Some(elastic), taken),
        }
    }

    pub(crate) fn dissipated(&self) -> f64 {
        match &self.law {
            BlockLaw::Elastic { .. } => 0.0,
            BlockLaw::Edges(law) => law.dissipated,
            BlockLaw::Standard(law) => law.dissipated,
            BlockLaw::Told(law) => law.dissipated,
        }
    }

    pub(crate) fn damage_of(&self, cell: usize) -> f64 {
        match &self.law {
            BlockLaw::Elastic { .. } | BlockLaw::Told(_) => 0.0,
            BlockLaw::Edges(law) => law.field.history(cell).damage,
            BlockLaw::Standard(law) => law.damage[cell],
        }
    }

    /// Bytes of its cells, their forces and viscous stresses.
    pub(crate) fn memory(&self) -> usize {
        let Cells { starts, local, gradients, volume, .. } = &self.cells;
        let cells = size_of_val(&starts[..]) + size_of_val(&local[..]) + size_of_val(&gradients[..]);
        let scratch = self
            .scratch
            .as_ref()
            .map_or(0, |scratch| size_of_val(&*scratch.displacement) * (2 + usize::from(scratch.velocity.is_some())));
        cells + size_of_val(&volume[..]) + size_of_val(&self.viscous.stress[..]) + scratch
    }

    /// Force sums of the block, one per local node.
    pub(crate) fn forces(&self) -> &[Lane; BLOCK_NODES] {
        &self.scratch.as_ref().expect("who needs the forces of a block has them").force
    }
}

/// Runs the cells with the law, beyond their thermal strains where they have some; see [`run_law`]. Returns the work of the
/// present change of temperatures too [J].
fn run<L: kernel::CellLaw>(
    model: &BodyModel,
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
    viscous: &mut ViscousCells,
) -> (f64, Option<usize>, f64) {
    let Some(thermal) = &cells.thermal else {
        let (power, inverted) = run_law(model, cells, scratch, law, viscous);
        return (power, inverted, 0.0);
    };
    let mut expanding = ExpandingCells { law, thermal, work: 0.0 };
    let (power, inverted) = run_law(model, cells, scratch, &mut expanding, viscous);
    (power, inverted, expanding.work)
}

/// Runs the cheapest kernel that the body allows; returns the viscous power [W] and a cell that is turned inside out.
fn run_law<L: kernel::CellLaw>(
    model: &BodyModel,
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
    viscous: &mut ViscousCells,
) -> (f64, Option<usize>) {
    let corotational = model.body.kinematics == Kinematics::Corotational;
    match &model.viscosity {
        Some(viscosity) => {
            let viscous = Viscous { corotational, viscosity, hooke: model.hooke, of_cells: viscous };
            kernel::viscous_forces(cells, scratch, law, viscous)
        }
        None if corotational => (0.0, kernel::corotational_forces(cells, scratch, law)),
        None => (0.0, kernel::forces(cells, scratch, law)),
    }
}
