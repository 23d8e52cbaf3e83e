//! The phase fields of a solid at work: in motion before the forces of a step, at rest for the trials of a solver.

use fractum_kernels::damage::{ABOVE_ALL, Seen, Taken};
use fractum_kernels::material::equivalent_stresses;
use fractum_math::{FOUR, Lane, Sym3, Vec3, widest};
use rayon::prelude::*;

use crate::cells::block::Cells;
use crate::damage::edge::EdgeField;
use crate::damage::edges_in_step::Advance;
use crate::damage::phase::{AT_LEAST, ActiveEdge, Drive, EdgeStep, PhaseField};
use crate::motion::phase_edges::{activate, for_each_phase_field, wake};
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::{BodyModel, Solid};

/// Whether the damage of some body is a phase field.
pub fn has_phase_fields(solid: &Solid) -> bool {
    solid.bodies.iter().any(|model| model.phase.is_some())
}

/// Length of the phase field of a body, where it has one, and mean size of the elements in which it may occur [m].
pub fn phase_sizes(solid: &Solid, body: usize) -> Option<[f64; 2]> {
    solid.bodies[body].phase.as_ref().map(|field| [field.law.length, field.law.size])
}

/// Phase field of every element of a body, 0 to 1: the mean over its edges; none without a phase field.
pub fn element_phase(solid: &Solid, body: usize) -> Option<Vec<f64>> {
    let model = &solid.bodies[body];
    let (field, edges) = (model.phase.as_ref()?, model.edges.as_ref()?);
    let count = model.body.shape.edge_count();
    let mean = |element| {
        let of = edges.of_element(element);
        of[..count].iter().map(|&e| field.value[e as usize]).sum::<f64>() / count as f64
    };
    Some((0..model.alive.len() as u32).map(mean).collect())
}

/// Lets the phase fields follow the displacements of a step; nothing has moved where `dt` is zero.
pub(crate) fn update_phase_fields(solid: &mut Solid, dt: f64) {
    if dt <= 0.0 {
        return;
    }
    for_each_phase_field(solid, |solid, body, field| {
        let before = field.active.len();
        wake(solid, body, field);
        if field.active.is_empty() {
            return;
        }
        drive(solid, body, field, dt);
        // Every process finds the edges of the standard formulation.
        let is_smoothed = solid.bodies[body].standard.is_none();
        field.sweep(|active| {
            if is_smoothed {
                solid.neighbours.exchange_phase(active);
            }
        });
        field.book(|own| taken_at_first(solid, body, own, dt));
        take_over(solid, body, field);
        field.end_step();
        let mut reached = Vec::new();
        field.newly_reached(&mut reached);
        activate(solid, body, field, &reached);
        let model = &solid.bodies[body];
        if model.standard.is_none() {
            field.arrange(before, |edge| model.location.of(edge));
        }
    });
}

/// Lets the histories of edges see what they have seen in a step, and softens those whose d has grown.
fn take_over(solid: &mut Solid, body: usize, field: &PhaseField) {
    let own = solid.own_blocks();
    let Solid { blocks, bodies, .. } = solid;
    if let Some(standard) = &mut bodies[body].standard {
        for edge in field.active.iter().map(|own| own.edge) {
            if let Some((step, true)) = field.change(edge) {
                standard.field.soften(edge as usize, step.stiffness);
            }
        }
        return;
    }
    let blocks = blocks[own.clone()].par_iter_mut().zip(own).filter(|(_, index)| field.has_block(*index));
    blocks.for_each(|(block, _)| {
        let Block { law: BlockLaw::Edges(cells), dissipated, .. } = block else { return };
        for cell in 0..cells.edges.len() {
            let Some((step, grown)) = field.change(cells.edges[cell]) else { continue };
            cells.see(cell, step.seen);
            if !grown {
                continue;
            }
            let growth = cells.soften(cell, step.stiffness);
            if growth > 0.0 {
                *dissipated += step.taken.by(growth);
            }
        }
    });
}

/// What drives the active edges at the present displacements.
fn drive(solid: &Solid, body: usize, field: &mut PhaseField, dt: f64) {
    let model = &solid.bodies[body];
    let compliance = 0.5 / model.body.opening_modulus();
    let PhaseField { active, steps, .. } = field;
    if let Some(standard) = &model.standard {
        active.par_iter_mut().with_min_len(AT_LEAST).for_each(|own| {
            let kappa = standard.field.state[own.edge as usize].kappa;
            let volume = edge_volume(solid, model, own.edge);
            own.drive = Drive { volume, energy: kappa * kappa * compliance, ..own.drive };
        });
        return;
    }
    let fours = active.par_chunks_mut(FOUR).zip(steps.par_chunks_mut(FOUR));
    fours.with_min_len(AT_LEAST / FOUR).for_each(|(active, steps)| drive_four(solid, body, dt, active, steps));
}

/// What the first damage of an active edge takes if it grows [J].
fn taken_at_first(solid: &Solid, body: usize, own: &ActiveEdge, dt: f64) -> Taken {
    let model = &solid.bodies[body];
    let Some((cells, EdgeField { softens, .. }, cell)) = cell_of(solid, model, own.edge) else {
        return Taken::default();
    };
    let step = advance_of(solid, model, dt);
    let (before, strain) = (step.strain_before(cells, cell), step.strain_now(cells, cell));
    let (stress, closed) = (softens.hooke.stress(strain), softens.closed_stress(strain));
    softens.taken(0.0, [before, strain], stress, closed).of(cells.volume[cell])
}

fn advance_of<'a>(solid: &'a Solid, model: &BodyModel, dt: f64) -> Advance<'a> {
    let Solid { displacement, velocity, .. } = solid;
    Advance { displacement, velocity, dt, kinematics: model.body.kinematics }
}

/// The smoothed cell of an edge, with its number, among those of its block that may be damaged.
#[inline(always)]
fn cell_of<'a>(solid: &'a Solid, model: &BodyModel, edge: u32) -> Option<(&'a Cells, &'a EdgeField, usize)> {
    let (block, cell) = model.location.kept(edge)?;
    let block = &solid.blocks[block as usize];
    Some((&block.cells, block.edge_field()?, cell as usize))
}

/// The history of an active edge, and where its dissipation is booked; elements book that of a standard body.
fn history_of(solid: &mut Solid, body: usize, edge: u32) -> (&mut EdgeField, usize, Option<&mut f64>) {
    let Solid { blocks, bodies, .. } = solid;
    let BodyModel { standard, location, .. } = &mut bodies[body];
    if let Some(standard) = standard {
        return (&mut standard.field, edge as usize, None);
    }
    let (block, cell) = location.of(edge);
    match &mut blocks[block as usize] {
        Block { law: BlockLaw::Edges(field), dissipated, .. } => (field, cell as usize, Some(dissipated)),
        _ => unreachable!("only edges that may be damaged become active"),
    }
}

/// Volume of an edge [m³]: its share of the elements around it that are there.
fn edge_volume(solid: &Solid, model: &BodyModel, edge: u32) -> f64 {
    let of = |(block, cell): (u32, u32)| solid.blocks[block as usize].cells.volume[cell as usize];
    if model.standard.is_none() {
        return of(model.location.of(edge));
    }
    let Some(edges) = &model.edges else { return 0.0 };
    let around = edges.around(edge);
    let sum: f64 = around.iter().map(|&element| of(model.location.of(element))).sum();
    sum / model.body.shape.edge_count() as f64
}

/// Finds the phase fields once every edge has seen what it sees, and replaces the trial damage of the cells that are edges.
///
/// - `values`: d of the edges of every body, from which the search starts
pub(crate) fn trial_phases(solid: &Solid, seen: &[Seen], cells: &mut [Vec<f64>], values: &mut [Vec<f64>]) {
    if !has_phase_fields(solid) {
        return;
    }
    let mut next = 0;
    let mut first = |count: usize| {
        next += count;
        next - count
    };
    let first_of_block: Vec<usize> =
        solid.blocks.iter().map(|block| first(block.edge_field().map_or(0, |field| field.state.len()))).collect();
    for (body, (model, value)) in solid.bodies.iter().zip(values).enumerate() {
        let first = first(model.standard.as_ref().map_or(0, |standard| standard.field.state.len()));
        let Some(field) = &model.phase else { continue };
        let compliance = 0.5 / model.body.opening_modulus();
        let seen_by = |edge: u32| match model.standard {
            Some(_) => seen[first + edge as usize],
            None => {
                let (block, cell) = model.location.of(edge);
                seen[first_of_block[block as usize] + cell as usize]
            }
        };
        let drive = |own: &ActiveEdge| {
            let known = solid.edge(body, own.edge).map_or(0.0, |(cells, cell)| cells.state[cell].kappa);
            let (kappa, volume) = (known.max(seen_by(own.edge).stress), edge_volume(solid, model, own.edge));
            Drive { volume, energy: kappa * kappa * compliance, ..own.drive }
        };
        let drives: Vec<Drive> = field.active.iter().map(drive).collect();
        field.settle(&drives, value);
        if model.standard.is_some() {
            continue;
        }
        for own in &field.active {
            let stiffness = field.law.stiffness(own.drive.a1, value[own.edge as usize]);
            let (block, cell) = model.location.of(own.edge);
            let trial = &mut cells[block as usize][cell as usize];
            *trial = trial.max(1.0 - seen_by(own.edge).share * stiffness);
        }
    }
}

/// d of the edges of every body, empty where it has no phase field.
pub(crate) fn phase_values(solid: &Solid) -> Vec<Vec<f64>> {
    solid.bodies.iter().map(|model| model.phase.as_ref().map_or_else(Vec::new, |f| f.value.clone())).collect()
}

/// Lets the phase fields have the values that a trial found, as the solid goes straight from the displacements `before` to
/// `after`, and books what damage takes on the way.
pub(crate) fn raise_phases(solid: &mut Solid, values: &[Vec<f64>], before: &[Vec3], after: &[Vec3]) {
    for_each_phase_field(solid, |solid, body, field| {
        let hooke = solid.bodies[body].elasticity.hooke;
        let law = field.law;
        field.take_rest(&values[body], |own, d| {
            let taken = match &solid.bodies[body] {
                model if model.standard.is_some() => Taken::default(),
                model => {
                    let (block, cell) = model.location.of(own.edge);
                    let (cells, cell) = (&solid.blocks[block as usize].cells, cell as usize);
                    let [before, after] = cells.elastic_ends(cell, [before, after]);
                    Taken::straight(0.5 * hooke.stress(after).dot(before)).of(cells.volume[cell])
                }
            };
            let (cells, cell, dissipated) = history_of(solid, body, own.edge);
            let growth = cells.soften(cell, law.stiffness(own.drive.a1, d));
            if let Some(dissipated) = dissipated {
                *dissipated += taken.by(growth);
            }
        });
    });
}

widest! {
    /// Finds what drives up to four active edges of smoothed cells, and what their damage takes if it grows.
    fn drive_four(solid: &Solid, body: usize, dt: f64, active: &mut [ActiveEdge], steps: &mut [EdgeStep]) = driven_four;
}

#[inline(always)]
fn driven_four(solid: &Solid, body: usize, dt: f64, active: &mut [ActiveEdge], steps: &mut [EdgeStep]) {
    let model = &solid.bodies[body];
    let compliance = 0.5 / model.body.opening_modulus();
    let (step, own_blocks) = (advance_of(solid, model, dt), solid.own_blocks());
    let (mut strains, mut stresses, mut kappa) = ([Sym3::ZERO; FOUR], [Sym3::ZERO; FOUR], Lane::splat(ABOVE_ALL));
    let (mut states, mut softens) = ([None; FOUR], None);
    for (k, own) in active.iter_mut().enumerate() {
        if !own_blocks.contains(&(model.location.of(own.edge).0 as usize)) {
            continue;
        }
        let Some((cells, field, cell)) = cell_of(solid, model, own.edge) else { continue };
        strains[k] = step.strain_now(cells, cell);
        stresses[k] = field.softens.hooke.stress(strains[k]);
        kappa.0[k] = field.state[cell].kappa;
        own.drive.volume = cells.volume[cell];
        states[k] = Some((&field.state[cell], field.strength[cell]));
        softens = Some(&field.softens);
    }
    let Some(softens) = softens else { return };
    let q = equivalent_stresses(&softens.criterion, &stresses, &kappa);
    let closed = softens.closed_stresses(&strains);
    for (k, (own, edge_step)) in active.iter_mut().zip(steps).enumerate() {
        let Some((state, strength)) = states[k] else { continue };
        let seen = softens.see(state, strength, stresses[k], q[k]);
        edge_step.seen = if seen.stress > kappa.0[k] { seen } else { Seen::NOTHING };
        let kappa = kappa.0[k].max(edge_step.seen.stress);
        own.drive.energy = kappa * kappa * compliance;
        edge_step.is_intact = state.damage == 0.0;
        if !edge_step.is_intact {
            let damage = if own.rebuilt { 0.0 } else { state.damage };
            let closed = closed.as_ref().map(|closed| closed[k]);
            edge_step.taken =
                softens.taken(damage, [state.strain, strains[k]], stresses[k], closed).of(own.drive.volume);
        }
    }
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic, Plane};
    use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
    use nalgebra::DMatrix;

    use super::*;
    use crate::body::{Body, ElementKind, Regularisation};

    fn law() -> DamageLaw {
        DamageLaw::rankine(3e6, 100.0)
    }

    /// A regularised block with its long side along x, all of its edges active.
    fn block(kind: ElementKind, cells: [u32; 3], jitter: Option<Jitter>) -> Solid {
        let size = cells.map(|n| 0.01 * f64::from(n));
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
        regularised(kind, nodes, elements)
    }

    fn regularised(kind: ElementKind, nodes: Vec<Vec3>, elements: Vec<[u32; 4]>) -> Solid {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let mut body = Body::new("block", kind, elements, elastic).smoothed().with_damage(law());
        body.plane = Plane::Stress;
        body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        crate::motion::phase_edges::wake_phase_fields(&mut solid);
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
                    crate::removal::rebuild_cells_around(&mut solid, 0, &[element]);
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

    /// A sweep of the field alone multiplies its modes by 1 - λ, which lies within -1 and 1.
    #[test]
    fn a_sweep_of_the_laplacian_never_grows() {
        for (kind, cells) in [(ElementKind::T3, [4, 3, 1]), (ElementKind::T4, [2, 2, 2])] {
            let solid = block(kind, cells, JITTER);
            let field = field(&solid);
            let roots = DMatrix::from_diagonal(&field.bounds().map(|bound| bound.sqrt().recip()));
            let values = (&roots * dense(field) * &roots).symmetric_eigenvalues();
            assert!(values.max() > 1.0 && values.max() <= 2.0, "{kind:?}: {}", values.max());
        }
    }

    /// The surface energy of a plane crack: d = 1 where edges cross a plane, the rest as it wants to be.
    fn imposed_crack(mut solid: Solid, place: f64) -> f64 {
        let mut ends = Vec::new();
        solid.body_edges(0).unwrap().for_each(|_, nodes, _| ends.push(nodes));
        let x = |node: u32| solid.reference[node as usize].x - place;
        let crossed: Vec<bool> = ends.iter().map(|&[i, j]| x(i) * x(j) < 0.0).collect();
        let mut d: Vec<f64> = crossed.iter().map(|&c| f64::from(u8::from(c))).collect();
        solid.bodies[0].phase.as_mut().unwrap().value.clone_from(&d);
        let field = field(&solid);
        let volume = |own: &ActiveEdge| edge_volume(&solid, &solid.bodies[0], own.edge);
        let drives: Vec<Drive> =
            field.active.iter().map(|own| Drive { volume: volume(own), energy: 0.0, a1: 20.0 }).collect();
        (0..20).for_each(|_| field.settle(&drives, &mut d));
        let length = field.law.length;
        let local = |(own, drive): (&ActiveEdge, &Drive)| {
            let d = d[own.edge as usize];
            drive.volume * d * (2.0 - d) / length
        };
        let local: f64 = field.active.iter().zip(&drives).map(local).sum();
        let gradient: f64 = field.laplacian(&d).map(|(edge, value)| length * d[edge as usize] * value).sum();
        (local + gradient) / std::f64::consts::PI
    }

    /// On irregular meshes a crack costs its area; in cubes of six tetrahedra each one that runs between two planes of nodes, which is as thin
    /// as a layer can be, costs less.
    #[test]
    fn an_imposed_plane_crack_costs_its_area() {
        for (kind, cells, jitter, low, high) in [
            (ElementKind::T3, [32, 8, 1], None, 0.97, 1.03),
            (ElementKind::T3, [32, 8, 1], JITTER, 0.97, 1.03),
            (ElementKind::T4, [32, 3, 3], None, 0.9, 1.0),
            (ElementKind::T4, [32, 3, 3], JITTER, 0.9, 1.0),
        ] {
            let depth = if kind == ElementKind::T3 { 1.0 } else { 0.03 };
            let area = depth * 0.01 * f64::from(cells[1]);
            let found = imposed_crack(block(kind, cells, jitter), 0.163) / area;
            println!("{kind:?} {}: {found:.4}", jitter.is_some());
            assert!(found > low && found < high, "{kind:?}: {found}");
        }
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/tension-bar/gmsh-coarse.msh");
        let mesh = fractum_mesh::read_msh(&std::fs::read(file).unwrap()).unwrap();
        for place in [-0.01, -0.005, 0.0, 0.0047, 0.0093] {
            let found =
                imposed_crack(regularised(ElementKind::T4, mesh.nodes.clone(), mesh.tetrahedra.clone()), place) / 4e-4;
            println!("Delaunay's tetrahedra: {found:.4}");
            assert!((found - 1.0).abs() < 0.01, "{found}");
        }
    }
}
