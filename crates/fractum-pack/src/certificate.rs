use fractum_math::Vec3;
use fractum_math::elementary::cbrt;
use rayon::prelude::*;
use serde::Serialize;

use crate::isotropy::Isotropy;
use crate::neighbours::{Grid, Neighbours};
use crate::{PackError, Packing};

/// What a packing is like, measured.
#[derive(Clone, Debug, Serialize)]
pub struct Certificate {
    /// Particles.
    pub particles: usize,
    /// Seed.
    pub seed: u64,
    /// Mean radius [m].
    pub mean_radius: f64,
    /// κ of the radii as drawn: (R_max − R_min)/R_mean.
    pub dispersion: f64,
    /// Sphere volume over domain volume.
    pub fraction_box: f64,
    /// Share of the core (deeper than two mean diameters) inside a sphere; none when the core is too small.
    pub fraction_core: Option<f64>,
    /// Contacts of the particles at the end of compaction.
    #[serde(flatten)]
    pub contacts: ContactFigures,
    /// Overlaps of neighbours.
    #[serde(flatten)]
    pub overlap: OverlapFigures,
    /// Names and sizes of the wall sets.
    pub walls: Vec<(String, usize)>,
    /// Directions of the contacts in the core, deeper than two mean diameters below the walls (in samples with fewer
    /// than 500 such contacts, of those between particles off the walls).
    pub isotropy: Isotropy,
    /// Depth of the deepest centre below the walls [mean diameters]; infinite without walls.
    pub depth: f64,
    /// Young's modulus along x, y, z over their mean, when measured (box domains).
    pub elastic_isotropy: Option<[f64; 3]>,
    /// Relaxation iterations of the cooker.
    pub iterations: usize,
}

/// How many neighbours the particles of a packing touch.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ContactFigures {
    /// Contacts per particle at the end of compaction, over all particles.
    pub coordination_all: f64,
    /// The same over the particles that touch no wall.
    pub coordination_interior: f64,
    /// Share of particles without a rigid cage.
    pub rattlers: f64,
}

/// How far the particles of a packing overlap.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OverlapFigures {
    /// Mean overlap over mean radius at the end of compaction.
    #[serde(rename = "overlap_compacted")]
    pub compacted: f64,
    /// Mean overlap over mean radius after the release of the walls.
    #[serde(rename = "overlap_mean")]
    pub mean: f64,
    /// Largest overlap over mean radius after the release of the walls.
    #[serde(rename = "overlap_max")]
    pub max: f64,
}

/// Depth of the core in mean diameters.
const CORE: f64 = 2.0;
/// Depths in mean diameters between which directions are not judged: walls order the core of such packings a little, as
/// they do in discs and plates of rock, while shallower ones are layers throughout.
const WALLS_REACH: std::ops::Range<f64> = 2.5..5.0;
/// Contacts that make a core worth measuring.
const FEW: usize = 500;
/// Pairs this close count as contacts of the released packing (directions only).
const NEAR: f64 = 1.01;

impl Certificate {
    /// Measures a packing.
    pub fn of(packing: &Packing) -> Self {
        let mean_radius = packing.mean_radius();
        let (least, largest) = packing.radius.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &r| (l.min(r), h.max(r)));
        let neighbours = Neighbours::find(&packing.position, &packing.radius, NEAR, 0.0, packing.domain.period());
        let on_wall = packing.on_wall();
        let depth: Vec<f64> =
            packing.position.par_iter().map(|x| packing.domain.depth(x) / (2.0 * mean_radius)).collect();
        let deep: Vec<bool> = depth.iter().map(|&depth| depth > CORE).collect();
        let (mut sum, mut touching, mut overlap_max) = (0.0, 0usize, 0.0f64);
        let (mut core, mut interior) = (Vec::new(), Vec::new());
        for i in 0..packing.len() {
            for &j in neighbours.of(i).iter().filter(|&&j| j as usize > i) {
                let j = j as usize;
                let d = packing.apart([i, j]);
                let overlap = (packing.radius[i] + packing.radius[j] - d.norm()) / mean_radius;
                if overlap > 0.0 {
                    sum += overlap;
                    touching += 1;
                    overlap_max = overlap_max.max(overlap);
                }
                if deep[i] && deep[j] {
                    core.push(d.normalize());
                }
                if !on_wall[i] && !on_wall[j] {
                    interior.push(d.normalize());
                }
            }
        }
        // Walls order their first layers, which large samples would show; small ones have little else.
        let directions = if core.len() >= FEW { core } else { interior };
        let compaction = packing.compaction;
        Certificate {
            particles: packing.len(),
            seed: packing.seed,
            mean_radius,
            dispersion: (largest - least) / mean_radius,
            fraction_box: packing.sphere_volume() / packing.domain.volume(),
            fraction_core: interior_fraction(packing),
            contacts: ContactFigures {
                coordination_all: 2.0 * compaction.contacts as f64 / packing.len() as f64,
                coordination_interior: compaction.coordination,
                rattlers: compaction.rattlers as f64 / packing.len() as f64,
            },
            overlap: OverlapFigures {
                compacted: compaction.overlap,
                mean: sum / touching.max(1) as f64,
                max: overlap_max,
            },
            walls: packing.walls.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
            isotropy: Isotropy::of(directions.into_iter()),
            depth: depth.iter().copied().fold(0.0, f64::max),
            elastic_isotropy: None,
            iterations: compaction.iterations,
        }
    }

    /// Refuses a packing that is looser, more overlapped or more ordered than a random close packing. Walls order some
    /// five diameters next to them; what has a core, but none deeper than that, is not judged by its directions.
    ///
    /// # Errors
    /// [`PackError::Refused`] with what was reached.
    pub fn check(&self) -> Result<(), PackError> {
        let refuse =
            |target: &str, reached: String, remedy| Err(PackError::Refused { target: target.into(), reached, remedy });
        if let Some(core) = self.fraction_core.filter(|c| !(0.62..=0.66).contains(c)) {
            return refuse(
                "volume fraction of the core between 0.62 and 0.66",
                format!("{core:.4}"),
                "try another seed",
            );
        }
        if self.overlap.mean > 5e-3 {
            let reached = format!("{:.2e}", self.overlap.mean);
            return refuse("mean overlap below 0.5 % of the mean radius", reached, "ask for a lower coordination");
        }
        if self.judges_directions() && self.isotropy.ordered() {
            let reached = format!("{:.3} against {:.3}", self.isotropy.deviation, self.isotropy.shot_noise);
            let remedy = "try another seed, or a dispersion of 0.25 and more (ordered packings form below 0.15)";
            return refuse("contact directions without order", reached, remedy);
        }
        Ok(())
    }

    /// Whether no other seed need be tried.
    pub(crate) fn is_good(&self) -> bool {
        self.check().is_ok() && (!self.judges_directions() || self.isotropy.isotropic())
    }

    fn judges_directions(&self) -> bool {
        !WALLS_REACH.contains(&self.depth)
    }
}

/// Volume fraction of the core, deeper than two mean diameters below the walls, or of all without walls, by a regular lattice of sample points;
/// none when the core holds less than about 40 particles.
pub fn interior_fraction(packing: &Packing) -> Option<f64> {
    let mean_radius = packing.mean_radius();
    let largest = packing.radius.iter().copied().fold(0.0, f64::max);
    let period = packing.domain.period();
    let depth = if period.is_some() { 0.0 } else { CORE * 2.0 * mean_radius };
    let (lower, upper) = packing.domain.bounds();
    let (lower, upper) = (lower.add_scalar(depth), upper.add_scalar(-depth));
    let extent = upper - lower;
    if extent.min() <= 0.0 {
        return None;
    }
    // About 60 sample points per particle: the lattice is incommensurate with a random packing.
    let spacing = cbrt(packing.domain.volume() / packing.len() as f64 / 60.0);
    let size = [0, 1, 2].map(|a| (extent[a] / spacing).ceil() as usize);
    let grid = Grid::new(&packing.position, 2.0 * largest);
    let layers: Vec<(usize, usize)> = (0..size[2])
        .into_par_iter()
        .map(|k| {
            let (mut total, mut inside) = (0, 0);
            for j in 0..size[1] {
                for i in 0..size[0] {
                    let p = lower + Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * spacing;
                    if packing.domain.depth(&p) < depth {
                        continue;
                    }
                    total += 1;
                    let mut covered = false;
                    let mut look = |p: Vec3| {
                        grid.around(&p, largest, |q| {
                            let r = packing.radius[q as usize];
                            covered |= (packing.position[q as usize] - p).norm_squared() < r * r;
                        });
                    };
                    match period {
                        None => look(p),
                        Some(period) => period.images(p, largest).for_each(look),
                    }
                    inside += usize::from(covered);
                }
            }
            (total, inside)
        })
        .collect();
    let (total, inside) = layers.into_iter().fold((0, 0), |(t, i), (a, b)| (t + a, i + b));
    (total > 60 * 40).then(|| inside as f64 / total as f64)
}
