//! Bonded bodies of particles that the user has: the shape that they fill, and their bonds.

use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_pack::{Convention, Domain, Packing, pairs_within};

use super::Maker;
use crate::asked::{At, Fault, ParticleFile, Shape};
use crate::particle_file;

/// Share of the box around them that particles fill at least, if they fill a box at all: that of a loose bed is 0.55, and walls take from it.
const FILLS_A_BOX: f64 = 0.45;
/// Particles from which on beams are calibrated.
const FEWEST: usize = 20;
/// Length of a bond over the sum of the radii above which it passes over particles.
const LONGEST: f64 = 2.0;

/// What there is of particles of a file beside their packing.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnParticles {
    /// Bonds that are given.
    pub(super) pairs: Option<Vec<[u32; 2]>>,
    /// What was read, for the plan.
    pub(super) read: Option<String>,
}

impl Maker<'_> {
    /// Reads particles as a packing of the shape that they fill.
    pub(super) fn own_particles(
        &self,
        file: &ParticleFile<'_>,
        shape: Option<&Shape<'_>>,
        bond_gap: Option<f64>,
    ) -> Result<(Packing, OwnParticles), Fault> {
        let found = particle_file::read(file)?;
        let mut told = found.told();
        let domain = match shape {
            Some(shape) => self.domain(shape)?,
            None => {
                let (lower, upper) = around(&found.position, &found.radius);
                Domain::Box { lower, upper }
            }
        };
        let packing = Packing::of_spheres(domain, found.position, found.radius);
        let filled = packing.sphere_volume() / packing.domain.volume();
        if shape.is_none() {
            let Domain::Box { lower, upper } = &packing.domain else { return Err(Fault::new(At::Body, "no box")) };
            let size = (upper - lower).iter().map(|edge| quantity(*edge, "m")).collect::<Vec<_>>().join(" x ");
            if filled < FILLS_A_BOX {
                let found = format!("its particles fill {:.0} % of the box around them, {size}", 100.0 * filled);
                return Err(Fault::new(At::File, found)
                    .remedy("give the shape that they fill: shape = \"cylinder\", with its sizes"));
            }
            told += &format!("; taken as the box around them, {size}, of which they fill {:.0} %", 100.0 * filled);
        } else {
            if let Some(outside) = (0..packing.len()).find(|&i| packing.domain.depth(&packing.position[i]) < 0.0) {
                let place = packing.position[outside];
                let at = place.iter().map(|x| quantity(*x, "m")).collect::<Vec<_>>().join(", ");
                let found = format!("a particle at ({at}) has its centre outside of the shape");
                return Err(Fault::new(At::File, found).remedy("check the shape and the unit of the file"));
            }
            told += &format!("; they fill {:.0} % of the shape", 100.0 * filled);
        }
        let pairs = match (bond_gap, found.bonds.len()) {
            (Some(gap), count) => {
                if count > 0 {
                    told += &format!("; without the {count} bonds of the file");
                }
                let pairs = pairs_within(&packing, gap);
                told += &format!("; {} bonds across gaps below {}", pairs.len(), quantity(gap, "m"));
                Some(pairs)
            }
            (None, 0) => None,
            (None, count) => {
                told += &format!("; with the {count} bonds of the file");
                Some(found.bonds)
            }
        };
        if let Some(pairs) = &pairs {
            check_bonds(&packing, pairs)?;
        }
        Ok((packing, OwnParticles { pairs, read: Some(told) }))
    }

    /// Refuses to calibrate beams on particles that are too few, or all at walls.
    pub(super) fn may_be_calibrated(&self, packing: &Packing) -> Result<(), Fault> {
        let remedy = "give the beams: a table bonds of its material, with radius_ratio and young_modulus";
        if packing.len() < FEWEST {
            let found = format!("its {} particles are too few to find beams by tension tests", packing.len());
            return Err(Fault::new(At::Body, found).remedy(remedy));
        }
        let counts_interior = self.asked.convention == Convention::Interior;
        if counts_interior && packing.on_wall().into_iter().all(|on_wall| on_wall) {
            let found = "all of its particles are at its walls, and the coordination counts those within";
            return Err(Fault::new(At::Body, found)
                .remedy("convention = \"all\", or give the beams by a table bonds of its material"));
        }
        Ok(())
    }
}

/// Box around spheres.
fn around(position: &[Vec3], radius: &[f64]) -> (Vec3, Vec3) {
    let infinite = Vec3::repeat(f64::INFINITY);
    position
        .iter()
        .zip(radius)
        .fold((infinite, -infinite), |(low, high), (x, r)| (low.inf(&x.add_scalar(-r)), high.sup(&x.add_scalar(*r))))
}

/// Refuses bonds that pass over other particles, such as those to periodic images.
fn check_bonds(packing: &Packing, pairs: &[[u32; 2]]) -> Result<(), Fault> {
    if pairs.is_empty() {
        return Err(Fault::new(At::File, "no two particles are joined").remedy("a larger bond_gap"));
    }
    for &[i, j] in pairs {
        let [a, b] = [i, j].map(|i| i as usize);
        let (length, sum) = (packing.apart([a, b]).norm(), packing.radius[a] + packing.radius[b]);
        if length > LONGEST * sum {
            let length = quantity(length, "m");
            let found = format!(
                "the bond of particles {i} and {j}, counted from 0, is {length} long, beyond twice their radii"
            );
            return Err(Fault::new(At::File, found).remedy("leave out bonds to periodic images, and check the unit"));
        }
    }
    Ok(())
}
