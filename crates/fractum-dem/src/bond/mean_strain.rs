//! Mean strain of particles over the space cells about them, and the energy of Hooke's law that goes with it.

use std::cmp::Ordering;

use fractum_kernels::bond::MeanElasticity;
use fractum_math::{Lane, Mat3, Sym3, Vec3, sphere_volume, widest};
use rayon::prelude::*;

use super::graph::BondGraph;
use super::space_cells::SpaceCells;
use crate::DemError;
use crate::particles::Particles;

/// Particles of one part of parallel work.
const PART: usize = 256;

/// Weights of particles in the mean displacement gradients of others, row by row.
#[derive(Clone, Debug)]
struct Weights {
    offsets: Vec<u32>,
    columns: Vec<u32>,
    /// A weight [1/m] for each column.
    weights: Vec<Lane>,
}

/// A row of [`Weights`].
#[derive(Clone, Copy)]
struct Row<'a> {
    columns: &'a [u32],
    weights: &'a [Lane],
}

impl Weights {
    /// Rows from entries (row, column, weight), which are summed in their order.
    fn new(count: usize, mut entries: Vec<(u32, u32, Vec3)>) -> Self {
        entries.sort_by_key(|&(row, column, _)| (row, column));
        let mut merged: Vec<(u32, u32, Vec3)> = Vec::new();
        for (row, column, weight) in entries {
            match merged.last_mut() {
                Some(last) if (last.0, last.1) == (row, column) => last.2 += weight,
                _ => merged.push((row, column, weight)),
            }
        }
        let mut offsets = vec![0u32; count + 1];
        merged.iter().for_each(|entry| offsets[entry.0 as usize + 1] += 1);
        (0..count).for_each(|row| offsets[row + 1] += offsets[row]);
        let weights = merged.iter().map(|(_, _, weight)| Lane::from_vec(weight)).collect();
        Weights { offsets, columns: merged.into_iter().map(|(_, column, _)| column).collect(), weights }
    }

    #[inline(always)]
    fn row(&self, row: usize) -> Row<'_> {
        let entries = self.offsets[row] as usize..self.offsets[row + 1] as usize;
        Row { columns: &self.columns[entries.clone()], weights: &self.weights[entries] }
    }

    fn transposed(&self) -> Self {
        let rows = self.offsets.len() - 1;
        let of_row = |row: usize| {
            let Row { columns, weights } = self.row(row);
            columns.iter().zip(weights).map(move |(&column, weight)| (column, row as u32, weight.to_vec()))
        };
        Weights::new(rows, (0..rows).flat_map(of_row).collect())
    }
}

/// Sums of displacements times weights over the rows from `start` on, by components of the displacement.
#[inline(always)]
fn sum_gradients(start: usize, rows: &Weights, shift: &[Lane], out: &mut [[Lane; 3]]) {
    for (k, out) in out.iter_mut().enumerate() {
        let Row { columns, weights } = rows.row(start + k);
        let mut sums = [Lane::ZERO; 3];
        for (&j, &weight) in columns.iter().zip(weights) {
            let shift = shift[j as usize].0;
            for a in 0..3 {
                sums[a] = sums[a] + weight * Lane::splat(shift[a]);
            }
        }
        *out = sums;
    }
}

/// Takes the sums of stresses times weights over the rows from `start` on off forces.
#[inline(always)]
fn take_forces(start: usize, rows: &Weights, stress: &[[Lane; 3]], force: &mut [Vec3]) {
    for (k, force) in force.iter_mut().enumerate() {
        let Row { columns, weights } = rows.row(start + k);
        let mut sum = Lane::from_vec(force);
        for (&i, weight) in columns.iter().zip(weights) {
            let [x, y, z] = stress[i as usize];
            let [a, b, c, _] = weight.0;
            sum = sum - (x * Lane::splat(a) + y * Lane::splat(b) + z * Lane::splat(c));
        }
        *force = sum.to_vec();
    }
}

widest! {
    /// [`sum_gradients`] in the widest instruction set of the machine.
    fn sum_gradients_fast(start: usize, rows: &Weights, shift: &[Lane], out: &mut [[Lane; 3]]) = sum_gradients;
}

widest! {
    /// [`take_forces`] in the widest instruction set of the machine.
    fn take_forces_fast(start: usize, rows: &Weights, stress: &[[Lane; 3]], force: &mut [Vec3]) = take_forces;
}

/// The mean deformation gradient F of every particle, that of the Delaunay cells of the centres that meet there weighted with their
/// volumes (displacements are linear in a cell), the Green strain E = ½(FᵀF − I), and the energy ½ V E : C : E of Hooke's law.
///
/// Uniform strain comes out as it is, and particles inside, whose volume V is a quarter of their cells', are then free of force: the sum of the areas of cells
/// that face a particle inside is zero. Particles at the border and one bond further in have the rest of the volume of the body in proportion to their own.
/// Arrangements with many tessellations have the mean of some.
///
/// A mean strain never joins what bonds do not: cells across a notch or a hole are left out, and a particle has no mean strain any more once it has
/// lost a bond, or two of the particles of its cells have lost the bond between them. Parts that have come apart so exert no force on each other.
///
/// Space cells: Bagi, *Mech. Mater.* 22 (1996) 165–177; means over the cells of a node as in nodal integration (Puso and Solberg, *Int. J. Numer.
/// Methods Eng.* 67 (2006) 841–867).
#[derive(Clone, Debug)]
pub(super) struct MeanStrain {
    elasticity: MeanElasticity,
    reference: Vec<Vec3>,
    rows: Weights,
    columns: Weights,
    /// V of each particle [m³].
    volume: Vec<f64>,
    /// Bonds of each particle, broken ones included.
    pub(super) graph: BondGraph,
    /// Particles that have a mean strain.
    intact: Vec<bool>,
    /// Displacements [m].
    shift: Vec<Lane>,
    /// Rows of F − 1.
    gradient: Vec<[Lane; 3]>,
    strain: Vec<Sym3>,
    /// Stress of bonds over their volumes, summed [J].
    deviation: Vec<[f64; 6]>,
    /// Columns of V times the first Piola–Kirchhoff stress [J].
    stress: Vec<[Lane; 3]>,
}

/// Bonds that separate under mean strains, and what they do last.
#[derive(Clone, Debug, Default)]
pub(super) struct Separating {
    /// Those of this instant, while the work of their last half step is not booked.
    pub(super) failed: Vec<u32>,
    /// Particles that lose their mean strain with them, ascending.
    pub(super) particles: Vec<u32>,
    /// Bonds whose forces this changes, ascending, and by how much.
    pub(super) bonds: Vec<u32>,
    pub(super) changes: Vec<BondChange>,
    /// Particles with other stresses of their mean strains, ascending, and by how much, as [`MeanStrain`] has them.
    pub(super) stressed: Vec<(u32, Mat3)>,
    /// Scratch: particles and bonds about one of those that separate.
    pub(super) about: Vec<u32>,
    pub(super) near: Vec<u32>,
}

/// By how much the forces of a bond on its particles change, and its share of their stresses times volumes [J].
#[derive(Clone, Copy, Debug)]
pub(super) struct BondChange {
    pub(super) force: Vec3,
    pub(super) moment: [Vec3; 2],
    pub(super) share: Sym3,
}

impl MeanStrain {
    /// Cells of the particles that bonds join, at their present positions.
    ///
    /// # Errors
    /// [`DemError::NoCells`] if no cell has a volume; [`DemError::NoVolume`] if the cells of the particles inside fill the whole body.
    pub(super) fn new(particles: &Particles, pairs: &[[u32; 2]], elasticity: MeanElasticity) -> Result<Self, DemError> {
        let count = particles.len();
        let mut bonded: Vec<u32> = pairs.as_flattened().to_vec();
        bonded.sort_unstable();
        bonded.dedup();
        let of = |values: &[Vec3]| bonded.iter().map(|&i| values[i as usize]).collect::<Vec<_>>();
        let radius: Vec<f64> = bonded.iter().map(|&i| particles.radius[i as usize]).collect();
        let number = |i: u32| bonded.binary_search(&i).unwrap_or_default() as u32;
        let joined = BondGraph::new(bonded.len(), &pairs.iter().map(|pair| pair.map(number)).collect::<Vec<_>>());
        let cells = SpaceCells::new(&of(&particles.position), &radius, &joined);
        let share: Vec<f64> = radius.iter().map(|r| sphere_volume(*r) / elasticity.fraction).collect();
        let own = cells.volumes(&share, &joined)?;
        let (mut volume, mut intact) = (vec![0.0; count], vec![false; count]);
        for (k, &i) in bonded.iter().enumerate() {
            volume[i as usize] = own[k];
            intact[i as usize] = cells.volume[k] > 0.0;
        }
        let global = |&(row, column, area): &(u32, u32, Vec3)| {
            (bonded[row as usize], bonded[column as usize], area / cells.volume[row as usize])
        };
        // Flat cells have areas and no volume: a strain by them is none.
        let solid = |&&(row, _, _): &&(u32, u32, Vec3)| cells.volume[row as usize] > 0.0;
        let rows = Weights::new(count, cells.entries.iter().filter(solid).map(global).collect());
        Ok(MeanStrain {
            elasticity,
            reference: particles.position.clone(),
            columns: rows.transposed(),
            rows,
            volume,
            graph: BondGraph::new(count, pairs),
            intact,
            shift: vec![Lane::ZERO; count],
            gradient: vec![[Lane::ZERO; 3]; count],
            strain: vec![Sym3::ZERO; count],
            deviation: vec![[0.0; 6]; count],
            stress: vec![[Lane::ZERO; 3]; count],
        })
    }

    /// Strains at these positions [m].
    pub(super) fn find_strains(&mut self, position: &[Vec3]) {
        let MeanStrain { reference, rows, intact, shift, gradient, strain, .. } = self;
        let moved = position.par_iter().zip(&*reference).with_min_len(PART).map(|(x, x0)| Lane::from_vec(&(x - x0)));
        shift.par_iter_mut().zip(moved).for_each(|(shift, moved)| *shift = moved);
        let parts = gradient.par_chunks_mut(PART).zip(strain.par_chunks_mut(PART));
        parts.enumerate().for_each(|(part, (gradient, strain))| {
            let start = part * PART;
            sum_gradients_fast(start, rows, shift, gradient);
            for (k, strain) in strain.iter_mut().enumerate() {
                if intact[start + k] {
                    let sum = matrix(&gradient[k]).transpose();
                    *strain = Sym3::symmetric_part(&(sum + sum.transpose() * sum * 0.5));
                }
            }
        });
    }

    /// Mean of the strains of two particles.
    #[inline(always)]
    pub(super) fn between(&self, [i, j]: [u32; 2]) -> Sym3 {
        let (a, b) = (self.strain[i as usize].0, self.strain[j as usize].0);
        Sym3(std::array::from_fn(|k| 0.5 * (a[k] + b[k])))
    }

    /// Energy of the mean strain of a particle [J].
    pub(super) fn energy_of(&self, particle: usize) -> f64 {
        let strain = self.strain[particle];
        0.5 * self.volume[particle] * self.elasticity.hooke.stress(strain).dot(strain)
    }

    /// Energy of all mean strains [J].
    pub(super) fn energy(&self) -> f64 {
        fractum_math::sum_chunks(self.strain.len(), |i| self.energy_of(i))
    }

    /// Finds the stresses of the mean strains.
    ///
    /// - `gather`: sums of the stresses of the bonds of particles `start..` over their volumes [J]
    pub(super) fn find_stresses(&mut self, block: usize, gather: impl Fn(usize, &mut [[f64; 6]]) + Sync) {
        let MeanStrain { elasticity, volume, intact, gradient, strain, deviation, stress, .. } = self;
        let parts = deviation.par_chunks_mut(block).zip(stress.par_chunks_mut(block));
        parts.enumerate().for_each(|(number, (deviation, stress))| {
            gather(number, deviation);
            for (k, stress) in stress.iter_mut().enumerate() {
                let i = number * block + k;
                *stress = match intact[i] {
                    true => {
                        let own = elasticity.hooke.stress(strain[i]) * volume[i] - Sym3(deviation[k]);
                        let whole = (Mat3::identity() + matrix(&gradient[i]).transpose()) * own.to_matrix();
                        [0, 1, 2].map(|column| Lane::from_vec(&whole.column(column).into()))
                    }
                    false => [Lane::ZERO; 3],
                };
            }
        });
    }

    /// Adds the forces of these stresses [N].
    pub(super) fn add_forces(&self, force: &mut [Vec3]) {
        let MeanStrain { columns, stress, .. } = self;
        let parts = force.par_chunks_mut(PART).enumerate();
        parts.for_each(|(part, force)| take_forces_fast(part * PART, columns, stress, force));
    }

    /// The particles that lose their mean strain when the bond of two particles separates, ascending: these, and those whose cells have both.
    pub(super) fn spanning(&self, ends: [u32; 2], out: &mut Vec<u32>) {
        out.clear();
        let [mut first, mut second] = ends.map(|end| self.columns.row(end as usize).columns);
        while let ([a, ..], [b, ..]) = (first, second) {
            match a.cmp(b) {
                Ordering::Less => first = &first[1..],
                Ordering::Greater => second = &second[1..],
                Ordering::Equal => {
                    out.push(*a);
                    (first, second) = (&first[1..], &second[1..]);
                }
            }
        }
        out.extend(ends);
        out.sort_unstable();
        out.dedup();
        out.retain(|&i| self.intact[i as usize]);
    }

    /// By how much the stress of a particle changes when it loses its mean strain, or else when bonds add this to it [J].
    pub(super) fn stress_change(&self, particle: u32, added: Sym3) -> Mat3 {
        let i = particle as usize;
        match self.intact[i] {
            true => -((Mat3::identity() + matrix(&self.gradient[i]).transpose()) * added.to_matrix()),
            false => -matrix(&self.stress[i]),
        }
    }

    /// Power of a change of the stress of a particle at these velocities [m/s].
    pub(super) fn power_of(&self, particle: u32, stress: &Mat3, velocity: &[Vec3]) -> f64 {
        let Row { columns, weights } = self.rows.row(particle as usize);
        let entries = columns.iter().zip(weights);
        entries.fold(0.0, |sum, (&j, weight)| sum - velocity[j as usize].dot(&(stress * weight.to_vec())))
    }

    /// Takes the mean strain of particles away for ever.
    pub(super) fn release(&mut self, particles: &[u32]) {
        for i in particles.iter().map(|&i| i as usize) {
            self.intact[i] = false;
            self.strain[i] = Sym3::ZERO;
        }
    }
}

/// The matrix with these columns.
#[inline(always)]
fn matrix(columns: &[Lane; 3]) -> Mat3 {
    Mat3::from_columns(&[columns[0].to_vec(), columns[1].to_vec(), columns[2].to_vec()])
}
