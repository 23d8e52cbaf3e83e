use rayon::prelude::*;

use crate::neighbours::Neighbours;
use crate::{PackError, Packing};

/// Which particles a coordination number counts. The two conventions give different networks for the same number and
/// are never mixed: calibration laws hold for the convention they were made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Convention {
    /// 2 × bonds / particles, as in the tables of Nguyen et al. (2019). Depends on the share of surface particles.
    All,
    /// Mean degree of the particles that touch no wall (Jebahi et al. 2015, 2.3.1.1).
    Interior,
}

impl std::fmt::Display for Convention {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Convention::All => "all",
            Convention::Interior => "interior",
        })
    }
}

/// Bonds between the particles of a packing.
#[derive(Clone, Debug)]
pub struct BondNetwork {
    /// Particle ids i < j of each bond, in ascending order.
    pub pairs: Vec<[u32; 2]>,
    /// Search factor s: bonds join pairs with distance ≤ s (R_i + R_j).
    pub factor: f64,
    /// 2 × bonds / particles.
    pub coordination_all: f64,
    /// Mean degree of the particles that touch no wall (NaN without such particles).
    pub coordination_interior: f64,
}

/// Largest search factor: beyond it, bonds would pass over particles.
const REACH: f64 = 2.0;

/// Bonds the pairs with distance ≤ s (R_i + R_j), with s found by bisection so that the coordination is the asked one
/// to the nearest bond.
///
/// # Errors
/// [`PackError::Coordination`] with the reachable range.
pub fn bond(packing: &Packing, coordination: f64, convention: Convention) -> Result<BondNetwork, PackError> {
    let interior: Vec<bool> = packing.on_wall().into_iter().map(|w| !w).collect();
    let interior_count = interior.iter().filter(|&&i| i).count();
    // A first search at the factor usual for this coordination; widened when it falls short.
    let mut reach = if coordination <= 10.0 { 1.3 } else { 1.6 };
    let (mut pairs, mut ratios);
    loop {
        (pairs, ratios) = candidates(packing, reach);
        if reach >= REACH || total(&pairs, &ratios, &interior, convention, reach) >= coordination {
            break;
        }
        reach = f64::min(reach + 0.2, REACH);
    }
    let value = |factor: f64| total(&pairs, &ratios, &interior, convention, factor);
    let (lowest, highest) = (value(1.0), value(reach));
    if !(coordination >= lowest && coordination <= highest) {
        return Err(PackError::Coordination { asked: coordination, lowest, highest, reach });
    }
    let (mut low, mut high) = (1.0, reach);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if value(middle) < coordination { low = middle } else { high = middle }
    }
    let kept: Vec<[u32; 2]> = pairs.iter().zip(&ratios).filter(|(_, r)| **r <= high).map(|(p, _)| *p).collect();
    let ends = kept.iter().flatten().filter(|&&i| interior[i as usize]).count();
    let all = 2.0 * kept.len() as f64 / packing.len() as f64;
    let inside = ends as f64 / interior_count as f64;
    Ok(BondNetwork { pairs: kept, factor: high, coordination_all: all, coordination_interior: inside })
}

/// Pairs i < j, ascending, of spheres that are nearer to each other than a gap [m].
pub fn pairs_within(packing: &Packing, gap: f64) -> Vec<[u32; 2]> {
    let found = Neighbours::find(&packing.position, &packing.radius, 1.0, gap, packing.domain.period());
    let after = |i: u32| found.of(i as usize).iter().filter(move |&&j| j > i).map(move |&j| [i, j]);
    (0..packing.len() as u32).flat_map(after).collect()
}

impl BondNetwork {
    /// Bonds that are given.
    ///
    /// - `pairs`: i < j, ascending, each once
    pub fn of_pairs(packing: &Packing, pairs: Vec<[u32; 2]>) -> Self {
        let on_wall = packing.on_wall();
        let inside = on_wall.iter().filter(|on_wall| !**on_wall).count();
        let ends = pairs.iter().flatten().filter(|&&i| !on_wall[i as usize]).count();
        let ratio = |&[i, j]: &[u32; 2]| {
            let (i, j) = (i as usize, j as usize);
            packing.apart([i, j]).norm() / (packing.radius[i] + packing.radius[j])
        };
        BondNetwork {
            factor: pairs.iter().map(ratio).fold(0.0, f64::max),
            coordination_all: 2.0 * pairs.len() as f64 / packing.len() as f64,
            coordination_interior: ends as f64 / inside as f64,
            pairs,
        }
    }

    /// Its coordination as a convention counts it; not a number where no particle is off the walls.
    pub fn coordination(&self, convention: Convention) -> f64 {
        match convention {
            Convention::All => self.coordination_all,
            Convention::Interior => self.coordination_interior,
        }
    }
}

/// Pairs i < j within `factor`, ascending, with their distance over R_i + R_j.
fn candidates(packing: &Packing, factor: f64) -> (Vec<[u32; 2]>, Vec<f64>) {
    let found = Neighbours::find(&packing.position, &packing.radius, factor, 0.0, packing.domain.period());
    let rows: Vec<Vec<([u32; 2], f64)>> = (0..packing.len())
        .into_par_iter()
        .map(|i| {
            let ratio = |j: u32| {
                let distance = packing.apart([i, j as usize]).norm();
                distance / (packing.radius[i] + packing.radius[j as usize])
            };
            found.of(i).iter().filter(|&&j| j as usize > i).map(|&j| ([i as u32, j], ratio(j))).collect()
        })
        .collect();
    rows.into_iter().flatten().unzip()
}

/// Coordination of the network that joins the candidates up to a factor.
fn total(pairs: &[[u32; 2]], ratios: &[f64], interior: &[bool], convention: Convention, factor: f64) -> f64 {
    let kept = pairs.iter().zip(ratios).filter(|(_, r)| **r <= factor).map(|(p, _)| p);
    match convention {
        Convention::All => 2.0 * kept.count() as f64 / interior.len() as f64,
        Convention::Interior => {
            let ends = kept.flatten().filter(|&&i| interior[i as usize]).count();
            ends as f64 / interior.iter().filter(|&&i| i).count() as f64
        }
    }
}
