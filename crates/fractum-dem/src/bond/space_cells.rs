//! Delaunay cells of the centres of bonded particles, without those that join what bonds do not.

use fractum_math::{Vec3, numbered_parts};
use rayon::prelude::*;

use super::graph::BondGraph;
use crate::DemError;
use crate::cells::{Tessellation, corner_areas};

/// Tessellations whose mean a regular arrangement takes: where more than four spheres meet in a point each is one of many.
const TESSELLATIONS: u32 = 12;

/// Cells of one or more tessellations of particles.
pub(super) struct SpaceCells {
    /// Row, column and area [m²] of particles in the mean gradients of each other; no area for those that only bonds join to the others of a row.
    pub(super) entries: Vec<(u32, u32, Vec3)>,
    /// A quarter of the volumes of the cells of each particle [m³].
    pub(super) volume: Vec<f64>,
    /// Particles on faces that belong to one cell only.
    border: Vec<bool>,
}

impl SpaceCells {
    /// Cells of particles at `centre` [m] with `radius` [m], all of which have bonds in `joined`.
    pub(super) fn new(centre: &[Vec3], radius: &[f64], joined: &BondGraph) -> Self {
        let make = |salt: u32| Tessellation::new(centre, radius, salt).tetrahedra;
        let first = make(0);
        let second = make(1);
        let mut all = match first == second {
            true => vec![first],
            false => [first, second].into_iter().chain((2..TESSELLATIONS).map(make)).collect(),
        };
        let helpers = drop_bridges(&mut all, joined);
        let share = 1.0 / all.len() as f64;
        let count = centre.len();
        let mut cells = SpaceCells { entries: Vec::new(), volume: vec![0.0; count], border: vec![false; count] };
        for tetrahedra in &all {
            cells.add(centre, tetrahedra, share);
        }
        cells.entries.extend(helpers.into_iter().map(|[i, other]| (i, other, Vec3::zeros())));
        cells
    }

    fn add(&mut self, centre: &[Vec3], tetrahedra: &[[u32; 4]], share: f64) {
        let mut faces: Vec<[u32; 3]> = Vec::with_capacity(4 * tetrahedra.len());
        for corners in tetrahedra {
            let (areas, volume) = corner_areas(corners.map(|i| centre[i as usize]));
            for (k, &i) in corners.iter().enumerate() {
                self.volume[i as usize] += 0.25 * share * volume;
                self.entries.extend(corners.iter().zip(areas).map(|(&j, area)| (i, j, area * (0.25 * share))));
                let mut face = [1, 2, 3].map(|step| corners[(k + step) % 4]);
                face.sort_unstable();
                faces.push(face);
            }
        }
        faces.sort_unstable();
        for same in faces.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
            same[0].iter().for_each(|&i| self.border[i as usize] = true);
        }
    }

    /// Volumes of particles [m³]: those of their cells inside; the rest of the body in proportion to `share` at its border and one bond further in.
    ///
    /// - `share` [m³]: of each particle in the volume of the body
    ///
    /// # Errors
    /// [`DemError::NoCells`] if no cell has a volume; [`DemError::NoVolume`] if nothing is left for the border.
    pub(super) fn volumes(&self, share: &[f64], joined: &BondGraph) -> Result<Vec<f64>, DemError> {
        if !share.is_empty() && self.volume.iter().all(|volume| *volume <= 0.0) {
            return Err(DemError::NoCells { particles: share.len() });
        }
        let mut outer = self.border.clone();
        for &[i, j] in joined.pairs() {
            outer[i as usize] |= self.border[j as usize];
            outer[j as usize] |= self.border[i as usize];
        }
        let (mut inside, mut of_outer) = (0.0, 0.0);
        for (k, &outer) in outer.iter().enumerate() {
            inside += if outer { 0.0 } else { self.volume[k] };
            of_outer += if outer { share[k] } else { 0.0 };
        }
        let body: f64 = share.iter().sum();
        if inside >= body && of_outer > 0.0 {
            return Err(DemError::NoVolume { inside, body });
        }
        let scale = if of_outer > 0.0 { (body - inside) / of_outer } else { 0.0 };
        Ok((0..share.len()).map(|k| if outer[k] { share[k] * scale } else { self.volume[k] }).collect())
    }
}

/// Leaves out cells until bonds join the particles of the cells of any particle. Returns pairs of particles and of further ones which such
/// bonds need.
fn drop_bridges(all: &mut [Vec<[u32; 4]>], joined: &BondGraph) -> Vec<[u32; 2]> {
    loop {
        let mut around = vec![Vec::new(); joined.particles()];
        for corners in all.iter().flatten() {
            corners.iter().for_each(|&i| add_new(&mut around[i as usize], corners));
        }
        let patch = |(i, around): (usize, Vec<u32>)| Patch::new(i as u32, around, joined);
        let found: Vec<Patch> = around.into_par_iter().enumerate().map(patch).collect();
        if found.iter().all(|patch| patch.apart.is_empty()) {
            let of = |(i, patch): (u32, Patch)| patch.helpers.into_iter().map(move |other| [i, other]);
            return (0..).zip(found).flat_map(of).collect();
        }
        let bridges = |corners: &[u32; 4]| {
            let apart = |i: &u32| corners.iter().any(|j| found[*i as usize].apart.binary_search(j).is_ok());
            corners.iter().any(apart)
        };
        all.iter_mut().for_each(|tetrahedra| tetrahedra.retain(|corners| !bridges(corners)));
    }
}

/// Adds the corners of a cell that a list does not have: several tessellations have most of them in common.
fn add_new(list: &mut Vec<u32>, corners: &[u32; 4]) {
    for corner in corners {
        if !list.contains(corner) {
            list.push(*corner);
        }
    }
}

/// How bonds join the particles of the cells of one.
struct Patch {
    /// Further particles through which they do, each bonded to two of the patch.
    helpers: Vec<u32>,
    /// Particles that they do not join to it, ascending.
    apart: Vec<u32>,
}

impl Patch {
    fn new(own: u32, mut list: Vec<u32>, joined: &BondGraph) -> Self {
        list.sort_unstable();
        let (mut helpers, mut known) = (Vec::new(), list.clone());
        loop {
            let links = |k: &u32| joined.every(*k as usize).map(|half| half.other);
            let number = |i: u32| known.binary_search(&i).ok().map(|k| k as u32);
            let pairs = (0..).zip(&known).flat_map(|(k, i)| links(i).filter_map(number).map(move |other| [k, other]));
            let (part, count) = numbered_parts(known.len(), pairs);
            if count <= 1 {
                return Patch { helpers, apart: Vec::new() };
            }
            let part_of = |i: u32| number(i).map(|k| part[k as usize]);
            let mut outside: Vec<u32> = known.iter().flat_map(links).filter(|i| number(*i).is_none()).collect();
            outside.sort_unstable();
            outside.dedup();
            outside.retain(|i| {
                let mut parts = links(i).filter_map(part_of);
                parts.next().is_some_and(|first| parts.any(|other| other != first))
            });
            if outside.is_empty() {
                list.retain(|i| part_of(*i) != part_of(own));
                return Patch { helpers, apart: list };
            }
            helpers.extend(&outside);
            known.extend(outside);
            known.sort_unstable();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic lattice and its nearest bonds.
    fn lattice(side: usize) -> (Vec<Vec3>, Vec<[u32; 2]>) {
        let site = |i: usize| Vec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64);
        let centre: Vec<Vec3> = (0..side.pow(3)).map(site).collect();
        let near = |[i, j]: &[usize; 2]| (centre[*i] - centre[*j]).norm() < 1.1;
        let all = (0..centre.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let pairs = all.filter(near).map(|pair| pair.map(|i| i as u32)).collect();
        (centre, pairs)
    }

    #[test]
    fn volumes_sum_up_to_the_body_and_one_that_the_inner_cells_fill_is_refused() {
        let (centre, pairs) = lattice(6);
        let joined = BondGraph::new(centre.len(), &pairs);
        let cells = SpaceCells::new(&centre, &vec![0.5; centre.len()], &joined);
        let own = cells.volumes(&vec![1.0; centre.len()], &joined).unwrap();
        assert!((own.iter().sum::<f64>() - 216.0).abs() < 1e-9);
        // The two innermost of six layers have cells of their own.
        let small = cells.volumes(&vec![4.0 / 216.0; centre.len()], &joined);
        let Err(DemError::NoVolume { inside, body }) = small else { panic!("{small:?}") };
        assert!((inside / 8.0 - 1.0).abs() < 0.1 && (body - 4.0).abs() < 1e-9, "{inside} {body}");
    }

    #[test]
    fn a_layer_of_particles_has_no_cells_and_is_refused() {
        let (centre, pairs) = lattice(4);
        let flat: Vec<Vec3> = centre[..16].to_vec();
        let pairs: Vec<[u32; 2]> = pairs.into_iter().filter(|pair| pair.iter().all(|i| *i < 16)).collect();
        let joined = BondGraph::new(flat.len(), &pairs);
        let cells = SpaceCells::new(&flat, &[0.5; 16], &joined);
        let own = cells.volumes(&[1.0; 16], &joined);
        assert!(matches!(own, Err(DemError::NoCells { particles: 16 })), "{own:?}");
    }

    #[test]
    fn no_cell_of_a_whole_lattice_is_left_out() {
        let (centre, pairs) = lattice(5);
        let joined = BondGraph::new(centre.len(), &pairs);
        let cells = SpaceCells::new(&centre, &vec![0.5; centre.len()], &joined);
        let filled: f64 = cells.volume.iter().sum();
        assert!((filled - 64.0).abs() < 1e-9, "{filled}");
    }
}
