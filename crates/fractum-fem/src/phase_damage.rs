//! The phase fields of a solid at work: in motion before the forces of a step, at rest for the trials of a solver.

use fractum_math::{Sym3, Vec3};
use rayon::prelude::*;

use crate::cell::Geometry;
use crate::damage::{Advance, EdgeField};
use crate::evaluate::{Block, BlockLaw};
use crate::phase::{AT_LEAST, ActiveEdge, Drive, Patch, PhaseField};
use crate::solid::{BodyModel, Solid};

impl Solid {
    /// Whether the damage of some body is a phase field.
    pub fn has_phase_fields(&self) -> bool {
        self.bodies.iter().any(|model| model.phase.is_some())
    }

    /// Length of the phase field of a body, where it has one, and mean size of the elements in which it may occur [m].
    pub fn phase_sizes(&self, body: usize) -> Option<[f64; 2]> {
        self.bodies[body].phase.as_ref().map(|field| [field.law.length, field.law.size])
    }

    /// Phase field of every element of a body, 0 to 1: the mean over its edges; none without a phase field.
    pub fn element_phase(&self, body: usize) -> Option<Vec<f64>> {
        let model = &self.bodies[body];
        let (field, edges) = (model.phase.as_ref()?, model.edges.as_ref()?);
        let count = model.body.shape.edge_count();
        let mean = |of: &[u32; 6]| of[..count].iter().map(|&e| field.value[e as usize]).sum::<f64>() / count as f64;
        Some(edges.of_element.iter().map(mean).collect())
    }

    /// Lets every edge take part in the phase field of its body, as a search for equilibrium needs it.
    pub fn wake_phase_fields(&mut self) {
        self.for_each_phase_field(|solid, body, field| {
            let edges = (0..field.value.len() as u32).filter(|&edge| !field.is_active(edge)).collect::<Vec<u32>>();
            solid.activate(body, field, &edges);
        });
    }

    /// Lets the phase fields follow the displacements of a step; nothing has moved where `dt` is zero.
    pub(crate) fn update_phase_fields(&mut self, dt: f64) {
        if dt <= 0.0 {
            return;
        }
        self.for_each_phase_field(|solid, body, field| {
            solid.wake(body, field);
            if field.active.is_empty() {
                return;
            }
            solid.drive(body, field, dt);
            field.sweep();
            let law = field.law;
            field.take_over(|own, d| {
                let (cells, cell, dissipated) = solid.cell_of(own);
                cells.state[cell].kappa = cells.state[cell].kappa.max(own.seen);
                *dissipated += own.work * cells.soften(cell, 1.0 - law.degradation.stiffness(own.drive.a1, d));
            });
            let mut reached = Vec::new();
            field.newly_reached(&mut reached);
            solid.activate(body, field, &reached);
        });
    }

    fn for_each_phase_field(&mut self, mut work: impl FnMut(&mut Solid, usize, &mut PhaseField)) {
        for body in 0..self.bodies.len() {
            let Some(mut field) = self.bodies[body].phase.take() else { continue };
            work(self, body, &mut field);
            self.bodies[body].phase = Some(field);
        }
    }

    /// Activates the edges that have passed their strength in the last forces.
    fn wake(&mut self, body: usize, field: &mut PhaseField) {
        let mut woken = Vec::new();
        for cells in self.blocks.iter_mut().filter(|b| b.body == body).filter_map(Block::edge_field_mut) {
            if std::mem::take(&mut cells.woken) {
                let EdgeField { edges, state, strength, .. } = cells;
                let passed = edges.iter().zip(state).zip(strength).filter(|((_, state), ft)| state.kappa > **ft);
                woken.extend(passed.map(|((&edge, _), _)| edge));
            }
        }
        self.activate(body, field, &woken);
    }

    /// Activates those of these edges that may be damaged and are not active yet.
    fn activate(&self, body: usize, field: &mut PhaseField, edges: &[u32]) {
        let model = &self.bodies[body];
        let Some(patch) = self.patch(model) else { return };
        for &edge in edges {
            let location = model.location[edge as usize];
            match self.blocks[location.0 as usize].edge_field() {
                Some(cells) if !field.is_active(edge) => {
                    let a1 = field.law.a1(cells.strength[location.1 as usize]);
                    field.activate(&patch, edge, location, a1);
                }
                _ => {}
            }
        }
    }

    fn patch<'a>(&'a self, model: &'a BodyModel) -> Option<Patch<'a>> {
        let geometry = Geometry { body: &model.body, nodes: &self.reference };
        let BodyModel { edges, elements_of_edge, alive, .. } = model;
        Some(Patch { geometry, edges: edges.as_ref()?, elements_of_edge, alive })
    }

    /// What drives the active edges at the present displacements.
    fn drive(&self, body: usize, field: &mut PhaseField, dt: f64) {
        let Solid { blocks, bodies, displacement, velocity, .. } = self;
        let model = &bodies[body].body;
        let step = Advance { displacement, velocity, dt, kinematics: model.kinematics };
        let compliance = 0.5 / model.elastic.young_modulus;
        field.active.par_iter_mut().with_min_len(AT_LEAST).for_each(|own| {
            let (block, cell) = (&blocks[own.location.0 as usize], own.location.1 as usize);
            let Some(EdgeField { softens, state, .. }) = block.edge_field() else { return };
            let (state, volume) = (&state[cell], block.cells.volume[cell]);
            let strain = step.strain_now(&block.cells, cell);
            let stress = softens.hooke.stress(strain);
            let below = softens.criterion.surely_below(stress, state.kappa);
            own.seen = if below { 0.0 } else { softens.criterion.equivalent_stress(stress) };
            let kappa = state.kappa.max(own.seen);
            own.drive = Drive { volume, energy: kappa * kappa * compliance, ..own.drive };
            let before = if state.damage == 0.0 { step.strain_before(&block.cells, cell) } else { state.strain };
            own.work = softens.taken(softens.opening_stress(strain), before) * volume;
        });
    }

    /// The history of an active edge, and where its dissipation is booked.
    fn cell_of(&mut self, own: &ActiveEdge) -> (&mut EdgeField, usize, &mut f64) {
        match &mut self.blocks[own.location.0 as usize].law {
            BlockLaw::Edges(law) => (&mut law.field, own.location.1 as usize, &mut law.dissipated),
            _ => unreachable!("only edges that may be damaged become active"),
        }
    }

    /// Replaces the trial damage of regularised bodies by that of their phase fields, once every edge has seen its
    /// equivalent stress `q`.
    ///
    /// - `values`: d of the edges of every body, from which the search starts
    pub(crate) fn trial_phases(&self, q: &[f64], cells: &mut [Vec<f64>], values: &mut [Vec<f64>]) {
        if !self.has_phase_fields() {
            return;
        }
        let mut next = 0;
        let first = |block: &Block| {
            let first = next;
            next += block.edge_field().map_or(0, |field| field.state.len());
            first
        };
        let first: Vec<usize> = self.blocks.iter().map(first).collect();
        for (model, value) in self.bodies.iter().zip(values) {
            let Some(field) = &model.phase else { continue };
            let compliance = 0.5 / model.body.elastic.young_modulus;
            let drive = |own: &ActiveEdge| {
                let (block, cell) = (own.location.0 as usize, own.location.1 as usize);
                let known = self.blocks[block].edge_field().map_or(0.0, |cells| cells.state[cell].kappa);
                let kappa = known.max(q[first[block] + cell]);
                let volume = self.blocks[block].cells.volume[cell];
                Drive { volume, energy: kappa * kappa * compliance, ..own.drive }
            };
            let drives: Vec<Drive> = field.active.iter().map(drive).collect();
            field.settle(&drives, value);
            for own in &field.active {
                let damage = 1.0 - field.law.degradation.stiffness(own.drive.a1, value[own.edge as usize]);
                let trial = &mut cells[own.location.0 as usize][own.location.1 as usize];
                *trial = trial.max(damage);
            }
        }
    }

    /// d of the edges of every body, empty where it has no phase field.
    pub(crate) fn phase_values(&self) -> Vec<Vec<f64>> {
        self.bodies.iter().map(|model| model.phase.as_ref().map_or_else(Vec::new, |f| f.value.clone())).collect()
    }

    /// Lets the phase fields have the values that a trial found, as the solid goes straight from the displacements `before` to
    /// `after`, and books what damage takes on the way.
    pub(crate) fn raise_phases(&mut self, values: &[Vec<f64>], before: &[Vec3], after: &[Vec3]) {
        self.for_each_phase_field(|solid, body, field| {
            let hooke = solid.bodies[body].hooke;
            let law = field.law;
            field.take_rest(&values[body], |own, d| {
                let (block, cell) = (&solid.blocks[own.location.0 as usize], own.location.1 as usize);
                let strain = |field: &[Vec3]| Sym3::symmetric_part(&block.cells.gradient(cell, |node| field[node]));
                let work = 0.5 * hooke.stress(strain(after)).dot(strain(before)) * block.cells.volume[cell];
                let (cells, cell, dissipated) = solid.cell_of(own);
                *dissipated += work * cells.soften(cell, 1.0 - law.degradation.stiffness(own.drive.a1, d));
            });
        });
    }

    /// Takes the share of removed elements out of the phase field of a body.
    ///
    /// - `edges`: those of the elements
    pub(crate) fn refresh_phase(&mut self, body: usize, edges: &[u32]) {
        let Some(mut field) = self.bodies[body].phase.take() else { return };
        if let Some(patch) = self.patch(&self.bodies[body]) {
            field.refresh(&patch, edges);
        }
        self.bodies[body].phase = Some(field);
    }

    /// Puts the saved phase field of a body back, for the elements that are there.
    pub(crate) fn restore_phase(&mut self, body: usize, state: &[(u32, [f64; 2])]) {
        let Some(mut field) = self.bodies[body].phase.take() else { return };
        field.clear();
        for &(edge, values) in state {
            self.activate(body, &mut field, &[edge]);
            field.restore_last(values);
        }
        self.bodies[body].phase = Some(field);
    }
}

#[cfg(test)]
mod tests {
    use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
    use nalgebra::DMatrix;

    use super::*;
    use crate::body::{Body, ElementKind, Plane, Regularisation};
    use crate::material::{DamageLaw, Elastic};

    fn law() -> DamageLaw {
        DamageLaw::rankine(3e6, 100.0)
    }

    /// A regularised block with its long side along x, all of its edges active.
    fn block(kind: ElementKind, cells: [u32; 3], jitter: Option<Jitter>) -> Solid {
        let size = cells.map(|n| 0.01 * f64::from(n));
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let (nodes, elements) = match kind {
            ElementKind::T3 => {
                let mesh = structured_rectangle([cells[0], cells[1]], [size[0], size[1]], jitter);
                (mesh.nodes, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect())
            }
            ElementKind::T4 => {
                let mesh = structured_box(cells, Vec3::from(size), jitter);
                (mesh.nodes, mesh.tetrahedra)
            }
        };
        let mut body = Body::new("block", kind, elements, elastic).smoothed().with_damage(law());
        body.plane = Plane::Stress;
        body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        solid.wake_phase_fields();
        solid
    }

    fn field(solid: &Solid) -> &PhaseField {
        solid.bodies[0].phase.as_ref().unwrap()
    }

    fn dense(field: &PhaseField) -> DMatrix<f64> {
        let count = field.value.len();
        let mut matrix = DMatrix::zeros(count, count);
        let mut unit = vec![0.0; count];
        for column in 0..count {
            unit[column] = 1.0;
            for (edge, value) in field.laplacian(&unit) {
                matrix[(edge as usize, column)] = value;
            }
            unit[column] = 0.0;
        }
        matrix
    }

    const JITTER: Option<Jitter> = Some(Jitter { fraction: 0.15, seed: 5 });

    /// Whatever elements are left: symmetric, nothing negative, and zero for a constant alone beside edges without elements.
    #[test]
    fn laplacian_is_that_of_a_connected_field() {
        for (kind, cells) in [(ElementKind::T3, [4, 3, 1]), (ElementKind::T4, [2, 2, 2])] {
            let mut solid = block(kind, cells, JITTER);
            for removed in [None, Some(12u32)] {
                if let Some(element) = removed {
                    solid.bodies[0].alive[element as usize] = false;
                    solid.rebuild_cells_around(0, &[element]);
                }
                let matrix = dense(field(&solid));
                let scale = matrix.amax();
                assert!((&matrix - matrix.transpose()).amax() < 1e-12 * scale);
                assert!(matrix.row_sum().amax() < 1e-12 * scale);
                let values = matrix.symmetric_eigenvalues();
                assert!(values.min() > -1e-12 * scale);
                let dead = solid.blocks.iter().flat_map(|b| &b.cells.volume).filter(|volume| **volume == 0.0).count();
                let zeros = values.iter().filter(|v| **v < 1e-6 * scale).count();
                assert_eq!(zeros, 1 + dead, "{kind:?} {removed:?}");
            }
        }
    }

    /// The surface energy of a plane crack: d = 1 where edges cross a plane, the rest as it wants to be.
    #[test]
    fn an_imposed_plane_crack_costs_its_area() {
        for (kind, cells, jitter, low, high) in [
            (ElementKind::T3, [32, 8, 1], None, 0.97, 1.03),
            (ElementKind::T3, [32, 8, 1], JITTER, 0.97, 1.03),
            (ElementKind::T4, [32, 3, 3], None, 0.9, 1.0),
            (ElementKind::T4, [32, 3, 3], JITTER, 0.9, 1.0),
        ] {
            let mut solid = block(kind, cells, jitter);
            let place = 0.163;
            let ends = solid.body_edges(0).unwrap().nodes.clone();
            let x = |node: u32| solid.reference[node as usize].x - place;
            let crossed: Vec<bool> = ends.iter().map(|&[i, j]| x(i) * x(j) < 0.0).collect();
            let mut d: Vec<f64> = crossed.iter().map(|&c| f64::from(u8::from(c))).collect();
            solid.bodies[0].phase.as_mut().unwrap().value.clone_from(&d);
            let field = field(&solid);
            let volume = |own: &ActiveEdge| solid.blocks[own.location.0 as usize].cells.volume[own.location.1 as usize];
            let drives: Vec<Drive> =
                field.active.iter().map(|own| Drive { volume: volume(own), energy: 0.0, a1: 20.0 }).collect();
            (0..20).for_each(|_| field.settle(&drives, &mut d));
            let length = field.law.length;
            let local: f64 = field
                .active
                .iter()
                .zip(&drives)
                .map(|(own, drive)| {
                    let d = d[own.edge as usize];
                    drive.volume * d * (2.0 - d) / length
                })
                .sum();
            let gradient: f64 = field.laplacian(&d).map(|(edge, value)| length * d[edge as usize] * value).sum();
            let depth = if kind == ElementKind::T3 { 1.0 } else { 0.03 };
            let area = depth * 0.01 * f64::from(cells[1]);
            let found = (local + gradient) / std::f64::consts::PI / area;
            println!("{kind:?} {}: {found:.4}", jitter.is_some());
            assert!(found > low && found < high, "{kind:?}: {found}");
        }
    }
}
