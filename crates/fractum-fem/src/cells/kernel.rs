//! The force kernel: strain of each cell, stress by its law, forces on its nodes.

use fractum_math::{FOUR, Lane, Mat3, Sym3, Vec3, widest};

use crate::body::Kinematics;
use crate::body::elasticity::Elasticity;
use crate::cells::block::{BLOCK_NODES, Cells, Run, Scratch, columns_to_matrix, hoop_column};
use crate::cells::law::CellLaw;
use crate::cells::viscosity::{BodyViscosity, ViscousCells};
use crate::element::four_turns::FourGradients;
use crate::element::polar::{conjugate, corotational_strain, product, strain_and_turn};

/// Stiffness over the undamaged one above which a cell carries: what is turned inside out below it changes no energy to
/// speak of.
const CARRIES: f64 = 0.02;

/// Whether a cell with this displacement gradient is turned inside out or flat.
#[inline(always)]
fn is_inverted(h: &Mat3) -> bool {
    (Mat3::identity() + h).determinant() <= 0.0
}

/// Strain of a displacement gradient.
#[inline(always)]
pub(crate) fn strain(h: &Mat3, kinematics: Kinematics) -> Sym3 {
    match kinematics {
        Kinematics::Small | Kinematics::Auto => Sym3::symmetric_part(h),
        Kinematics::Corotational => corotational_strain(h).0,
    }
}

/// Strain of a cell by displacements of all nodes [m], whether stress or temperature makes it.
#[inline(always)]
pub(crate) fn total_strain(cells: &Cells, cell: usize, displacement: &[Vec3], kinematics: Kinematics) -> Sym3 {
    strain(&cells.gradient(cell, |node| displacement[node]), kinematics)
}

/// The same beyond the thermal strain.
#[inline(always)]
pub(crate) fn elastic_strain(cells: &Cells, cell: usize, displacement: &[Vec3], kinematics: Kinematics) -> Sym3 {
    cells.elastic_strain(cell, total_strain(cells, cell, displacement, kinematics))
}

/// A local number as an index that the compiler knows to be in range.
#[inline(always)]
fn slot(local: u16) -> usize {
    usize::from(local) & (BLOCK_NODES - 1)
}

/// Displacement gradient of a cell by columns.
///
/// - `hoop`: of a cell around an axis, see [`Cells::hoop`]
#[inline(always)]
pub(crate) fn gradient_columns(
    values: &[Lane; BLOCK_NODES],
    local: &[u16],
    gradients: &[[f64; 3]],
    hoop: Option<f64>,
) -> [Lane; 3] {
    let base = values[slot(local[0])];
    let (mut x, mut y, mut z) = (Lane::ZERO, Lane::ZERO, Lane::ZERO);
    for (&node, g) in local[1..].iter().zip(gradients) {
        let d = values[slot(node)] - base;
        x = x.plus(d, g[0]);
        y = y.plus(d, g[1]);
        z = z.plus(d, g[2]);
    }
    [x, y, hoop.map_or(z, |hoop| hoop_column(z, base, hoop))]
}

#[inline(always)]
pub(crate) fn add_cell_forces(
    force: &mut [Lane; BLOCK_NODES],
    local: &[u16],
    gradients: &[[f64; 3]],
    mut stress: [Lane; 3],
    hoop: Option<f64>,
) {
    if hoop.is_some() {
        // The hoop stress pulls along the radius.
        stress[2] = Lane([stress[2].0[2], 0.0, 0.0, 0.0]);
    }
    let mut sum = Lane::ZERO;
    for (&node, g) in local[1..].iter().zip(gradients) {
        let f = Lane::ZERO.plus(stress[0], g[0]).plus(stress[1], g[1]).plus(stress[2], g[2]);
        force[slot(node)] = force[slot(node)] - f;
        sum = sum + f;
    }
    let base = slot(local[0]);
    force[base] = force[base] + sum;
    if let Some(hoop) = hoop {
        force[base] = force[base] - stress[2] * Lane::splat(hoop);
    }
}

#[inline(always)]
pub(crate) fn small_strain(x: Lane, y: Lane, z: Lane) -> Sym3 {
    let (x, y, z) = (x.0, y.0, z.0);
    Sym3([x[0], y[1], z[2], 0.5 * (x[1] + y[0]), 0.5 * (y[2] + z[1]), 0.5 * (x[2] + z[0])])
}

#[inline(always)]
pub(crate) fn symmetric_columns(s: Sym3) -> [Lane; 3] {
    let [xx, yy, zz, xy, yz, zx] = s.0;
    [Lane([xx, xy, zx, 0.0]), Lane([xy, yy, yz, 0.0]), Lane([zx, yz, zz, 0.0])]
}

#[inline(always)]
fn matrix_columns(m: &Mat3) -> [Lane; 3] {
    [0, 1, 2].map(|c| Lane([m[(0, c)], m[(1, c)], m[(2, c)], 0.0]))
}

/// M s by columns.
#[inline(always)]
fn turned_columns(m: &Mat3, s: Sym3) -> [Lane; 3] {
    let [x, y, z] = matrix_columns(m);
    let [xx, yy, zz, xy, yz, zx] = s.0;
    let column = |a: f64, b: f64, c: f64| Lane::ZERO.plus(x, a).plus(y, b).plus(z, c);
    [column(xx, xy, zx), column(xy, yy, yz), column(zx, yz, zz)]
}

/// Forces of the cells of a block without viscosity: -∫ Bᵀσ dV added to `scratch.force`.
///
/// Cells of a block lie sorted by their number of nodes (`cell.rs`), so that nearly all of them pass through loops of a
/// length that the compiler knows. Returns the first corotational cell that is turned inside out while it still carries.
#[inline(always)]
fn forces_by_runs<const COROTATIONAL: bool, L: CellLaw>(
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
) -> Option<usize> {
    if L::IS_RARE {
        return forces_by_cells::<COROTATIONAL, L>(cells, scratch, law);
    }
    let mut sweep = Sweep::<COROTATIONAL, L> { scratch, law, inverted: None };
    for &run in &cells.runs {
        // Cells that turn take more arithmetic than memory.
        if COROTATIONAL && L::IS_COAXIAL {
            let mut begin = run.begin;
            while begin < run.end {
                let alone = sweep.turning_run(cells, Run { begin, ..run });
                sweep.long_run(cells, alone);
                begin = alone.end;
            }
            continue;
        }
        match run.gradients {
            _ if cells.hoop.is_some() => sweep.long_run(cells, run),
            2 => sweep.run::<2>(cells, run),
            3 => sweep.run::<3>(cells, run),
            4 => sweep.run::<4>(cells, run),
            5 => sweep.run::<5>(cells, run),
            6 => sweep.run::<6>(cells, run),
            7 => sweep.run::<7>(cells, run),
            8 => sweep.run::<8>(cells, run),
            _ => sweep.long_run(cells, run),
        }
    }
    sweep.inverted
}

/// The same forces by one loop for cells of any number of nodes: an eighth of the instructions.
#[inline(always)]
fn forces_by_cells<const COROTATIONAL: bool, L: CellLaw>(
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
) -> Option<usize> {
    let mut sweep = Sweep::<COROTATIONAL, L> { scratch, law, inverted: None };
    sweep.long_run(cells, Run { begin: 0, end: cells.len(), gradients: 0 });
    sweep.inverted
}

struct Sweep<'a, const COROTATIONAL: bool, L> {
    scratch: &'a mut Scratch,
    law: &'a mut L,
    inverted: Option<usize>,
}

impl<const COROTATIONAL: bool, L: CellLaw> Sweep<'_, COROTATIONAL, L> {
    /// A run of cells of `N` gradients each.
    #[inline(always)]
    fn run<const N: usize>(&mut self, cells: &Cells, run: Run) {
        let Run { mut begin, end, .. } = run;
        if L::BY_FOURS && !COROTATIONAL {
            let start = cells.starts[begin] as usize;
            let gradients = cells.gradients[start..].chunks_exact(FOUR * N);
            let local = cells.local[start + begin..].chunks_exact(FOUR * (N + 1));
            let volumes = cells.volume[begin..end].as_chunks::<FOUR>().0;
            for ((gradients, local), volumes) in gradients.zip(local).zip(volumes) {
                self.four_cells::<N>(begin, local, gradients, volumes);
                begin += FOUR;
            }
        }
        let start = cells.starts[begin] as usize;
        let gradients = cells.gradients[start..].chunks_exact(N);
        let local = cells.local[start + begin..].chunks_exact(N + 1);
        let volume = &cells.volume[begin..end];
        for (((cell, gradients), local), &volume) in (begin..end).zip(gradients).zip(local).zip(volume) {
            self.cell(cell, local, gradients, volume, None);
        }
    }

    /// Cells that turn, four at a time, where only what touches nodes is written out for each number of gradients. Returns the next ones that must
    /// be done alone: those of many nodes or around an axis, four of which one is stretched far, or the last of the run.
    #[inline(always)]
    fn turning_run(&mut self, cells: &Cells, run: Run) -> Run {
        let Run { mut begin, end, gradients: count } = run;
        if !(2..=8).contains(&count) || cells.hoop.is_some() {
            return run;
        }
        while begin + FOUR <= end {
            let start = cells.starts[begin] as usize;
            let gradients = &cells.gradients[start..start + FOUR * count];
            let local = &cells.local[start + begin..start + begin + FOUR * (count + 1)];
            let volumes = std::array::from_fn(|k| cells.volume[begin + k]);
            if volumes != [0.0; FOUR] {
                let mut columns = [[Lane::ZERO; 3]; FOUR];
                match count {
                    2 => self.gather::<2>(local, gradients, &mut columns),
                    3 => self.gather::<3>(local, gradients, &mut columns),
                    4 => self.gather::<4>(local, gradients, &mut columns),
                    5 => self.gather::<5>(local, gradients, &mut columns),
                    6 => self.gather::<6>(local, gradients, &mut columns),
                    7 => self.gather::<7>(local, gradients, &mut columns),
                    _ => self.gather::<8>(local, gradients, &mut columns),
                }
                if !self.turned_stresses(begin, &volumes, &mut columns) {
                    return Run { begin, end: begin + FOUR, gradients: count };
                }
                match count {
                    2 => self.scatter::<2>(local, gradients, &columns),
                    3 => self.scatter::<3>(local, gradients, &columns),
                    4 => self.scatter::<4>(local, gradients, &columns),
                    5 => self.scatter::<5>(local, gradients, &columns),
                    6 => self.scatter::<6>(local, gradients, &columns),
                    7 => self.scatter::<7>(local, gradients, &columns),
                    _ => self.scatter::<8>(local, gradients, &columns),
                }
            }
            begin += FOUR;
        }
        Run { begin, end, gradients: count }
    }

    /// Displacement gradients of four cells of `N` gradients each.
    #[inline(always)]
    fn gather<const N: usize>(&self, local: &[u16], gradients: &[[f64; 3]], columns: &mut [[Lane; 3]; FOUR]) {
        // Loops instead of closures: those might be compiled apart, for any processor.
        for k in 0..FOUR {
            let (local, gradients) = (&local[k * (N + 1)..(k + 1) * (N + 1)], &gradients[k * N..(k + 1) * N]);
            columns[k] = gradient_columns(&self.scratch.displacement, local, gradients, None);
        }
    }

    /// Adds the forces of four cells of `N` gradients each.
    #[inline(always)]
    fn scatter<const N: usize>(&mut self, local: &[u16], gradients: &[[f64; 3]], columns: &[[Lane; 3]; FOUR]) {
        for k in 0..FOUR {
            let (local, gradients) = (&local[k * (N + 1)..(k + 1) * (N + 1)], &gradients[k * N..(k + 1) * N]);
            add_cell_forces(&mut self.scratch.force, local, gradients, columns[k], None);
        }
    }

    /// A run of cells with many nodes: at the axes of structured meshes, and around the long edges of others; or of cells around an axis.
    #[inline(always)]
    fn long_run(&mut self, cells: &Cells, run: Run) {
        for cell in run.begin..run.end {
            let (local, gradients) = (cells.local_nodes(cell), &cells.gradients[cells.range(cell)]);
            self.cell(cell, local, gradients, cells.volume[cell], cells.hoop(cell));
        }
    }

    #[inline(always)]
    fn cell(&mut self, cell: usize, local: &[u16], gradients: &[[f64; 3]], volume: f64, hoop: Option<f64>) {
        // All elements of the cell have been removed.
        if volume == 0.0 {
            return;
        }
        let columns = gradient_columns(&self.scratch.displacement, local, gradients, hoop);
        let (strain, turn) = self.strain(cell, columns, volume);
        let stress = self.law.scaled_stress(cell, strain, volume);
        add_cell_forces(&mut self.scratch.force, local, gradients, Self::stress_columns(stress, strain, &turn), hoop);
    }

    /// Four cells of `N` gradients each that do not turn.
    #[inline(always)]
    fn four_cells<const N: usize>(
        &mut self,
        first: usize,
        local: &[u16],
        gradients: &[[f64; 3]],
        volumes: &[f64; FOUR],
    ) {
        if *volumes == [0.0; FOUR] {
            return;
        }
        let mut columns = [[Lane::ZERO; 3]; FOUR];
        self.gather::<N>(local, gradients, &mut columns);
        let mut strains = [Sym3::ZERO; FOUR];
        for k in 0..FOUR {
            let [x, y, z] = columns[k];
            strains[k] = small_strain(x, y, z);
        }
        let stresses = self.law.scaled_stresses(first, &strains, volumes);
        for k in 0..FOUR {
            columns[k] = symmetric_columns(stresses[k]);
        }
        self.scatter::<N>(local, gradients, &columns);
    }

    /// Replaces displacement gradients of four cells by their stresses times volumes on the nodes; not where one of them is stretched by more than
    /// little.
    #[inline(always)]
    fn turned_stresses(&mut self, first: usize, volumes: &[f64; FOUR], columns: &mut [[Lane; 3]; FOUR]) -> bool {
        let gradients = FourGradients::new(columns);
        let Some((strains, turns)) = gradients.strains_and_turns() else { return false };
        let stresses = self.law.scaled_stresses(first, &strains, volumes);
        *columns = turns.stress_columns(&stresses);
        true
    }

    /// Notes the first cell that is turned inside out while it carries.
    fn note_inverted(&mut self, cell: usize, volume: f64) {
        if self.inverted.is_none() && volume > 0.0 && self.law.integrity(cell) > CARRIES {
            self.inverted = Some(cell);
        }
    }

    /// Strain of a cell, and how it turns.
    #[inline(always)]
    fn strain(&mut self, cell: usize, [x, y, z]: [Lane; 3], volume: f64) -> (Sym3, Turn) {
        if !COROTATIONAL {
            return (small_strain(x, y, z), Turn::default());
        }
        let h = columns_to_matrix(x, y, z);
        if is_inverted(&h) {
            self.note_inverted(cell, volume);
        }
        if !L::IS_COAXIAL {
            let (strain, m) = corotational_strain(&h);
            return (strain, Turn { m, n: Sym3::ZERO });
        }
        let (strain, m, n) = strain_and_turn(&h);
        (strain, Turn { m, n })
    }

    /// Stress on the nodes by columns: R σ = M (1 + n) σ where stress is coaxial with strain.
    #[inline(always)]
    fn stress_columns(stress: Sym3, strain: Sym3, turn: &Turn) -> [Lane; 3] {
        if COROTATIONAL && !L::IS_COAXIAL {
            matrix_columns(&(turn.m * conjugate(strain, stress)))
        } else if COROTATIONAL {
            turned_columns(&turn.m, stress + Sym3(product(turn.n.0, stress.0)))
        } else {
            symmetric_columns(stress)
        }
    }
}

/// M and n of a cell that turns, see [`strain_and_turn`].
#[derive(Clone, Copy, Default)]
struct Turn {
    m: Mat3,
    n: Sym3,
}

widest! {
    /// The small-strain kernel in the widest instruction set of the machine.
    pub(crate) fn forces<L: CellLaw>(cells: &Cells, scratch: &mut Scratch, law: &mut L) -> Option<usize>
        = forces_by_runs::<false, L>, otherwise forces_by_cells::<false, L>;
}

widest! {
    /// The kernel of cells that turn; returns the first that is turned inside out while it still carries.
    pub(crate) fn corotational_forces<L: CellLaw>(cells: &Cells, scratch: &mut Scratch, law: &mut L) -> Option<usize>
        = forces_by_runs::<true, L>, otherwise forces_by_cells::<true, L>;
}

/// What viscous cells do beside elastic ones.
pub(crate) struct Viscous<'a> {
    pub(crate) corotational: bool,
    pub(crate) viscosity: &'a BodyViscosity,
    pub(crate) elasticity: &'a Elasticity,
    /// Viscous stress of the last step; replaced by that of this one.
    pub(crate) of_cells: &'a mut ViscousCells,
}

widest! {
    /// Forces with viscous stress.
    ///
    /// Returns the mean power of the viscous stress over the step [W], and the first corotational cell that is turned inside
    /// out while it still carries.
    pub(crate) fn viscous_forces<L: CellLaw>(
        cells: &Cells,
        scratch: &mut Scratch,
        law: &mut L,
        viscous: Viscous<'_>,
    ) -> (f64, Option<usize>) = viscous_forces_by_cell;
}

#[inline(always)]
fn viscous_forces_by_cell<L: CellLaw>(
    cells: &Cells,
    scratch: &mut Scratch,
    law: &mut L,
    Viscous { corotational, viscosity, elasticity, of_cells }: Viscous<'_>,
) -> (f64, Option<usize>) {
    let Scratch { displacement, velocity, force } = scratch;
    let (mut dissipated_power, mut inverted) = (0.0, None);
    for cell in 0..cells.len() {
        let (local, gradients) = (cells.local_nodes(cell), &cells.gradients[cells.range(cell)]);
        let (volume, hoop) = (cells.volume[cell], cells.hoop(cell));
        let [x, y, z] = gradient_columns(displacement, local, gradients, hoop);
        let (strain, rotation) = if corotational {
            let h = columns_to_matrix(x, y, z);
            if inverted.is_none() && is_inverted(&h) && volume > 0.0 && law.integrity(cell) > CARRIES {
                inverted = Some(cell);
            }
            corotational_strain(&h)
        } else {
            (small_strain(x, y, z), Mat3::identity())
        };
        let elastic = law.scaled_stress(cell, strain, volume);
        let (mut stress, mut viscous) = (elastic, Mat3::zeros());
        if let Some(velocity) = velocity.as_deref() {
            let [x, y, z] = gradient_columns(velocity, local, gradients, hoop);
            let rate = Sym3::symmetric_part(&(rotation.transpose() * columns_to_matrix(x, y, z)));
            // The mean of the stress at both ends of the step, at the rate between them.
            let [now, mean] = of_cells.update(viscosity, elasticity, cell, rate, [law.integrity(cell), volume]);
            dissipated_power += mean.dot(rate);
            stress += now;
            if !L::IS_COAXIAL {
                viscous = now.to_matrix();
            }
        }
        let columns = match corotational {
            true if !L::IS_COAXIAL => matrix_columns(&(rotation * (conjugate(strain, elastic) + viscous))),
            true => turned_columns(&rotation, stress),
            false => symmetric_columns(stress),
        };
        add_cell_forces(force, local, gradients, columns, hoop);
    }
    (dissipated_power, inverted)
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::Elastic;
    use fractum_math::Vec3;
    use fractum_mesh::generate::{Jitter, structured_box};

    use super::*;
    use crate::body::{Body, ElementKind};
    use crate::cells::law::ElasticCells;
    use crate::cells::viscosity::Viscosity;
    use crate::solid::Solid;

    /// A strained and moving box with cells of many sizes.
    fn moving_box() -> Solid {
        let mesh = structured_box([4; 3], Vec3::repeat(0.3), Some(Jitter { fraction: 0.15, seed: 3 }));
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("box", ElementKind::T4, mesh.tetrahedra, elastic).smoothed();
        let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
        crate::motion::viscous_solid::set_viscosity(
            &mut solid,
            Viscosity { stiffness_time: 1e-6, bulk_linear: 0.06, bulk_quadratic: 1.2 },
        );
        for (i, (u, v)) in solid.displacement.iter_mut().zip(&mut solid.velocity).enumerate() {
            *u = Vec3::new(0.7 * i as f64, 1.1 * i as f64, 1.7 * i as f64).map(|x| 0.01 * x.sin());
            *v = Vec3::new(1.3 * i as f64, 0.3 * i as f64, 0.9 * i as f64).map(|x| 2.0 * x.cos());
        }
        solid
    }

    /// The kernels compiled for any processor, where a fused product is a call of the C library, beside the fastest ones.
    #[test]
    fn the_kernels_of_any_processor_give_the_same_bits() {
        let mut solid = moving_box();
        let Solid { blocks, bodies, displacement, velocity, .. } = &mut solid;
        for block in blocks {
            let (cells, model) = (&block.cells, &bodies[block.body]);
            let mut forces_of = |fastest: bool, corotational: bool, viscous: bool| {
                let scratch = block.scratch.as_mut().unwrap();
                scratch.load(&cells.nodes, displacement);
                scratch.load_velocity(&cells.nodes, velocity);
                let mut law = ElasticCells { elasticity: model.elasticity.hooke, energy: Some(0.0) };
                let mut of_cells = ViscousCells::new(&model.body, cells);
                let mut power = 0.0;
                match viscous {
                    false => {
                        let run = match (fastest, corotational) {
                            (true, false) => forces,
                            (true, true) => corotational_forces,
                            (false, false) => forces_by_cells::<false, _>,
                            (false, true) => forces_by_cells::<true, _>,
                        };
                        run(cells, scratch, &mut law);
                    }
                    true => {
                        let (viscosity, elasticity) = (model.viscosity.as_ref().unwrap(), &model.elasticity);
                        let viscous = Viscous { corotational, viscosity, elasticity, of_cells: &mut of_cells };
                        let run = if fastest { viscous_forces } else { viscous_forces_by_cell };
                        power = run(cells, scratch, &mut law, viscous).0;
                    }
                }
                let sums = [law.energy.unwrap(), power];
                let forces = scratch.force.iter().flat_map(|lane| lane.0);
                forces.chain(sums).chain(of_cells.stress.into_iter().flat_map(|s| s.0)).map(f64::to_bits).collect()
            };
            for [corotational, viscous] in [[false; 2], [true, false], [false, true], [true; 2]] {
                let fastest: Vec<u64> = forces_of(true, corotational, viscous);
                assert!(fastest == forces_of(false, corotational, viscous), "{corotational} {viscous}");
            }
        }
    }
}
