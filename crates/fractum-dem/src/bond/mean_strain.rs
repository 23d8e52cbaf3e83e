//! Mean strain of particles over the space cells about them, and the energy of Hooke's law that goes with it.

use std::cmp::Ordering;

use fractum_math::{Mat3, Sym3, Vec3, sphere_volume};
use rayon::prelude::*;

use super::graph::BondGraph;
use super::law::MeanElasticity;
use super::space_cells::SpaceCells;
use crate::DemError;
use crate::particles::Particles;

/// Weights of particles in the mean displacement gradients of others, row by row.
#[derive(Clone, Debug)]
struct Weights {
    offsets: Vec<u32>,
    /// Particle and weight [1/m].
    entries: Vec<(u32, Vec3)>,
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
        Weights { offsets, entries: merged.into_iter().map(|(_, column, weight)| (column, weight)).collect() }
    }

    fn row(&self, row: usize) -> &[(u32, Vec3)] {
        &self.entries[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }

    fn transposed(&self) -> Self {
        let rows = self.offsets.len() - 1;
        let entries =
            (0..rows).flat_map(|row| self.row(row).iter().map(move |&(column, weight)| (column, row as u32, weight)));
        Weights::new(rows, entries.collect())
    }
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
    gradient: Vec<Mat3>,
    strain: Vec<Sym3>,
    /// Stress of bonds over their volumes, summed [J].
    deviation: Vec<[f64; 6]>,
    /// V times the first Piola–Kirchhoff stress [J].
    stress: Vec<Mat3>,
}

/// Bonds that separate under mean strains, and what they do last.
#[derive(Clone, Debug, Default)]
pub(super) struct Separating {
    /// Those of this instant, while the work of their last half step is not booked.
    pub(super) failed: Vec<u32>,
    /// Forces [N] and moments [N m] on the particles without them, less those that act at this instant.
    pub(super) force: Vec<Vec3>,
    pub(super) moment: Vec<Vec3>,
    /// Scratch: particles that lose their mean strain with a bond, and the bonds whose energy this changes.
    pub(super) particles: Vec<u32>,
    pub(super) bonds: Vec<u32>,
}

impl MeanStrain {
    /// Cells of the particles that bonds join, at their present positions.
    ///
    /// # Errors
    /// [`DemError::NoVolume`] if the cells of the particles inside fill the whole body.
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
            gradient: vec![Mat3::identity(); count],
            strain: vec![Sym3::ZERO; count],
            deviation: vec![[0.0; 6]; count],
            stress: vec![Mat3::zeros(); count],
        })
    }

    /// Strains at these positions [m].
    pub(super) fn find_strains(&mut self, position: &[Vec3]) {
        let MeanStrain { reference, rows, intact, gradient, strain, .. } = self;
        gradient.par_iter_mut().zip(strain.par_iter_mut()).enumerate().with_min_len(256).for_each(
            |(i, (own, strain))| {
                if !intact[i] {
                    return;
                }
                let moved = |j: u32| position[j as usize] - reference[j as usize];
                let sum =
                    rows.row(i).iter().fold(Mat3::zeros(), |sum, &(j, weight)| sum + moved(j) * weight.transpose());
                *own = Mat3::identity() + sum;
                *strain = Sym3::symmetric_part(&(sum + sum.transpose() * sum * 0.5));
            },
        );
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
        0.5 * self.volume[particle] * self.elasticity.stress(strain).dot(strain)
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
                        let own = elasticity.stress(strain[i]) * volume[i] - Sym3(deviation[k]);
                        gradient[i] * own.to_matrix()
                    }
                    false => Mat3::zeros(),
                };
            }
        });
    }

    /// Adds the forces of these stresses [N].
    pub(super) fn add_forces(&self, force: &mut [Vec3]) {
        let MeanStrain { columns, stress, .. } = self;
        force.par_iter_mut().enumerate().with_min_len(256).for_each(|(j, force)| {
            *force = columns.row(j).iter().fold(*force, |sum, &(i, weight)| sum - stress[i as usize] * weight);
        });
    }

    /// The particles that lose their mean strain when the bond of two particles separates, ascending: these, and those whose cells have both.
    pub(super) fn spanning(&self, ends: [u32; 2], out: &mut Vec<u32>) {
        out.clear();
        let [mut first, mut second] = ends.map(|end| self.columns.row(end as usize));
        while let ([a, ..], [b, ..]) = (first, second) {
            match a.0.cmp(&b.0) {
                Ordering::Less => first = &first[1..],
                Ordering::Greater => second = &second[1..],
                Ordering::Equal => {
                    out.push(a.0);
                    (first, second) = (&first[1..], &second[1..]);
                }
            }
        }
        out.extend(ends);
        out.sort_unstable();
        out.dedup();
        out.retain(|&i| self.intact[i as usize]);
    }

    /// Takes the mean strain of particles away for ever.
    pub(super) fn release(&mut self, particles: &[u32]) {
        for i in particles.iter().map(|&i| i as usize) {
            self.intact[i] = false;
            self.gradient[i] = Mat3::identity();
            self.strain[i] = Sym3::ZERO;
        }
    }
}
