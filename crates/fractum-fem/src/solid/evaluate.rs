//! Blocks of cells with the law they follow.

use fractum_math::{Lane, Vec3};

use crate::body::Kinematics;
use crate::body::elasticity::{Elasticity, Linear};
use crate::cells::block::{BLOCK_NODES, Cells, Scratch};
use crate::cells::cell::Bundle;
use crate::cells::kernel::{self, Viscous};
use crate::cells::law::{BornCells, CellLaw, ElasticCells, ExpandingCells};
use crate::cells::viscosity::ViscousCells;
use crate::damage::edge::EdgeField;
use crate::damage::edges_in_step::{Advance, BeddedEdges, EdgesInStep, FourEdgesInStep, RubbingEdges};
use crate::damage::standard::{self, StandardCells};
use crate::solid::body_model::BodyModel;

/// How the cells of a block answer to strain.
#[derive(Clone, Debug)]
pub(crate) enum BlockLaw {
    Elastic,
    /// Cells that are edges; of a block that is evaluated elsewhere those alone that are known here.
    Edges(EdgeField),
    Standard(StandardCells),
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
    /// Elastic energy of the last step, where it was asked for [J].
    pub(crate) energy: Option<f64>,
    /// Energy dissipated by damage so far [J].
    pub(crate) dissipated: f64,
    /// Energy taken by the friction of closed cracks so far [J].
    pub(crate) rubbed: f64,
    /// Its part of the step; none where it is not evaluated here, nor its forces needed.
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
            energy: None,
            dissipated: 0.0,
            rubbed: 0.0,
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
        let Block { cells, scratch: Some(scratch), law, viscous, .. } = self else { return };
        if let BlockLaw::Standard(law) = law
            && is_plain
            && !measure
        {
            self.energy = None;
            standard::forces(cells, &mut scratch.force, law);
            return;
        }
        scratch.load(&cells.nodes, displacement);
        if model.viscosity.is_some() {
            scratch.load_velocity(&cells.nodes, velocity);
            viscous.begin_step();
        }
        let start = measure.then_some(0.0);
        (self.viscous_power, self.inverted, self.expansion_work) = match law {
            BlockLaw::Elastic => {
                let Elasticity { hooke, bedded } = &model.elasticity;
                let (outcome, energy) = match bedded {
                    None => run_elastic(model, cells, scratch, *hooke, viscous, start),
                    Some(stiffness) => run_elastic(model, cells, scratch, &**stiffness, viscous, start),
                };
                self.energy = energy;
                outcome
            }
            BlockLaw::Edges(field) => {
                field.rate.iter_mut().for_each(|rate| rate.pass(dt));
                let step = Advance { displacement, velocity, dt, kinematics: model.body.kinematics };
                let by_fours = field.softens.is_unilateral() || field.is_mostly_damaged();
                let rubs = field.softens.friction.is_some();
                let has_beds = field.softens.beds.is_some();
                let [dissipated, rubbed] = [self.dissipated, self.rubbed];
                let mut law = EdgesInStep { field, cells, step, energy: start, dissipated, rubbed };
                let outcome = if rubs {
                    let mut rubbing = RubbingEdges(law);
                    let outcome = run(model, cells, scratch, &mut rubbing, viscous);
                    law = rubbing.0;
                    outcome
                } else if has_beds {
                    let mut bedded = BeddedEdges(law);
                    let outcome = run(model, cells, scratch, &mut bedded, viscous);
                    law = bedded.0;
                    outcome
                } else if by_fours {
                    let mut fours = FourEdgesInStep(law);
                    let outcome = run(model, cells, scratch, &mut fours, viscous);
                    law = fours.0;
                    outcome
                } else {
                    run(model, cells, scratch, &mut law, viscous)
                };
                (self.energy, self.dissipated, self.rubbed) = (law.energy, law.dissipated, law.rubbed);
                outcome
            }
            BlockLaw::Standard(law) => {
                law.energy = start;
                let outcome = run(model, cells, scratch, law, viscous);
                self.energy = law.energy;
                outcome
            }
        };
    }

    /// Elastic forces of all cells whatever their damage, for the stable step.
    pub(crate) fn evaluate_elastic(&mut self, model: &BodyModel, displacement: &[Vec3]) {
        let Some(scratch) = &mut self.scratch else { return };
        scratch.load(&self.cells.nodes, displacement);
        let Elasticity { hooke, bedded } = &model.elasticity;
        match bedded {
            None => kernel::forces(&self.cells, scratch, &mut ElasticCells { elasticity: *hooke, energy: None }),
            Some(own) => kernel::forces(&self.cells, scratch, &mut ElasticCells { elasticity: &**own, energy: None }),
        };
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

    /// Whether its cells neither turn nor expand, were there from the start, and are not viscous: strains that were found once serve the forces too.
    fn is_plain(&self, model: &BodyModel) -> bool {
        let Cells { thermal, born, .. } = &self.cells;
        let is_at_rest = model.body.kinematics != Kinematics::Corotational && model.viscosity.is_none();
        is_at_rest && thermal.is_none() && born.is_none()
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
        let Block { cells, items, law: BlockLaw::Standard(law), dissipated, .. } = self else { return };
        let mut take = |law: &mut StandardCells, cell: usize| {
            *dissipated += law.take(cell, of_edges(items[cell])) * cells.volume[cell];
        };
        // A phase field has its own list of what grows.
        if law.softens.regularised {
            (0..items.len()).for_each(|cell| take(law, cell));
            return;
        }
        let mut word = 0;
        while let Some(cell) = law.next_stale(&mut word) {
            take(law, cell);
        }
    }

    /// Damage of the edges that its cells are.
    pub(crate) fn edge_field(&self) -> Option<&EdgeField> {
        if let BlockLaw::Edges(field) = &self.law { Some(field) } else { None }
    }

    pub(crate) fn edge_field_mut(&mut self) -> Option<&mut EdgeField> {
        if let BlockLaw::Edges(field) = &mut self.law { Some(field) } else { None }
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

    pub(crate) fn damage_of(&self, cell: usize) -> f64 {
        match &self.law {
            BlockLaw::Elastic => 0.0,
            BlockLaw::Edges(field) => field.history(cell).damage,
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

/// Runs elastic cells as [`run`] does; returns its outcome, and the energy that they store where it is asked for [J].
fn run_elastic<L: Linear>(
    model: &BodyModel,
    cells: &Cells,
    scratch: &mut Scratch,
    elasticity: L,
    viscous: &mut ViscousCells,
    energy: Option<f64>,
) -> ((f64, Option<usize>, f64), Option<f64>) {
    let mut law = ElasticCells { elasticity, energy };
    let outcome = run(model, cells, scratch, &mut law, viscous);
    (outcome, law.energy)
}

/// Runs the cells with the law, beyond their thermal strains and those at which they are free of stress where they have some; see [`run_law`]. Returns the
/// work of the present change of temperatures too [J].
fn run<L: CellLaw>(
    model: &BodyModel,
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
    viscous: &mut ViscousCells,
) -> (f64, Option<usize>, f64) {
    match &cells.born {
        None => run_expanding(model, cells, scratch, law, viscous),
        Some(born) => run_expanding(model, cells, scratch, &mut BornCells { law, born }, viscous),
    }
}

/// The same, beyond their thermal strains where they have some.
fn run_expanding<L: CellLaw>(
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
fn run_law<L: CellLaw>(
    model: &BodyModel,
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
    viscous: &mut ViscousCells,
) -> (f64, Option<usize>) {
    let corotational = model.body.kinematics == Kinematics::Corotational;
    match &model.viscosity {
        Some(viscosity) => {
            let viscous = Viscous { corotational, viscosity, elasticity: &model.elasticity, of_cells: viscous };
            kernel::viscous_forces(cells, scratch, law, viscous)
        }
        None if corotational => (0.0, kernel::corotational_forces(cells, scratch, law)),
        None => (0.0, kernel::forces(cells, scratch, law)),
    }
}
