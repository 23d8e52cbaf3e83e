//! Looks for bonds that must break, in a state at rest or in motion.

use fractum_math::{Sym3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use crate::criterion::{BondLoad, Criterion, Level, Mode, Release, StressCriterion};
use crate::graph::BondGraph;
use crate::{BeamNetwork, BeamSection, DemError};

/// Particles or bonds handled as one block by the parallel loops.
const BLOCK: usize = 1024;

/// What a criterion needs to know of a bonded body.
pub trait Bonded: Sync {
    /// Half the sums of sym(r_ij ⊗ f_ij) over the bonds of each particle [N m]; see [`crate::stress`].
    fn dyads(&self, out: &mut [Sym3]);

    /// What a live bond bears.
    fn load(&self, bond: u32) -> BondLoad;

    /// Unit vector along a bond, in either sense.
    fn axis(&self, bond: u32) -> Vec3;

    /// The section of its bonds.
    fn section(&self) -> BeamSection;
}

/// A place that a criterion looks at: a particle, or a bond for a criterion of beams.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Site {
    /// Particle or bond.
    pub index: u32,
    /// What it bears over what it can bear.
    pub ratio: f64,
}

/// A bond that breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Break {
    /// The bond.
    pub bond: u32,
    /// How.
    pub mode: Mode,
}

/// A criterion with the volumes of its neighbourhoods, which follow the bonds that break.
#[derive(Clone, Debug)]
pub struct Watch {
    criterion: Criterion,
    /// Volume of each particle [m³].
    volume: Vec<f64>,
    /// 1/Ω of each neighbourhood [1/m³].
    inverse: Vec<f64>,
    /// Interior volume fraction; one where the criterion takes the spheres' own volume.
    fraction: f64,
    /// Members of each neighbourhood, for level 2 only.
    members: Vec<Vec<u32>>,
    dyads: Vec<Sym3>,
    pulls: Vec<[f64; 2]>,
    stress: Vec<Sym3>,
    /// Sites over the limit at the last look, by index.
    over: Vec<Site>,
    worst: Option<Site>,
}

impl Watch {
    /// Watches a body.
    ///
    /// - `radius`: of the particles [m]
    /// - `fraction`: volume fraction f_v of the interior of the packing
    ///
    /// # Errors
    /// Strengths that are none; a volume fraction outside 0 to 1; array lengths.
    pub fn new(criterion: Criterion, graph: &BondGraph, radius: &[f64], fraction: f64) -> Result<Self, DemError> {
        criterion.check()?;
        let n = graph.particles();
        if radius.len() != n {
            return Err(DemError::Length { what: "radius", found: radius.len(), expected: n });
        }
        if !(fraction > 0.0 && fraction <= 1.0) {
            let expected = "above 0 and at most 1";
            return Err(DemError::BadCriterion { what: "volume fraction", value: fraction, expected });
        }
        let fraction = if matches!(criterion, Criterion::Hydrostatic(_)) { 1.0 } else { fraction };
        let volume = radius.iter().map(|r| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)).collect();
        let (stressed, listed) = match criterion.level() {
            None => (0, 0),
            Some(Level::Second) => (n, n),
            Some(_) => (n, 0),
        };
        let mut watch = Watch {
            criterion,
            volume,
            inverse: vec![0.0; stressed],
            fraction,
            members: vec![Vec::new(); listed],
            dyads: vec![Sym3::ZERO; stressed],
            pulls: vec![[0.0; 2]; stressed],
            stress: vec![Sym3::ZERO; stressed],
            over: Vec::new(),
            worst: None,
        };
        watch.gather_all(graph);
        Ok(watch)
    }

    /// Members and volumes of all neighbourhoods anew.
    pub(crate) fn gather_all(&mut self, graph: &BondGraph) {
        (0..self.inverse.len()).for_each(|i| self.gather(i, graph));
    }

    /// The criterion.
    pub fn criterion(&self) -> &Criterion {
        &self.criterion
    }

    /// The site nearest to failure at the last look; none where nothing bears anything.
    pub fn worst(&self) -> Option<Site> {
        self.worst
    }

    /// Sites whose ratio was at least the limit at the last look, by index.
    pub fn over(&self) -> &[Site] {
        &self.over
    }

    /// Stress of each neighbourhood at the last look [Pa]; empty for a criterion of beams.
    pub fn stress(&self) -> &[Sym3] {
        &self.stress
    }

    /// Members and volume of a neighbourhood from the bonds that hold.
    fn gather(&mut self, i: usize, graph: &BondGraph) {
        let mut space = self.volume[i];
        match self.criterion.level() {
            Some(Level::Neighbours) => space += graph.neighbours(i).map(|h| self.volume[h.other as usize]).sum::<f64>(),
            Some(Level::Second) => {
                let list = &mut self.members[i];
                list.clear();
                for near in graph.neighbours(i) {
                    list.push(near.other);
                    list.extend(graph.neighbours(near.other as usize).map(|far| far.other));
                }
                list.sort_unstable();
                list.dedup();
                list.retain(|&j| j as usize != i);
                space += list.iter().map(|&j| self.volume[j as usize]).sum::<f64>();
            }
            _ => {}
        }
        self.inverse[i] = self.fraction / space;
    }

    /// Takes note that a bond of the graph has broken: only the neighbourhoods that it led through change.
    pub fn bond_broken(&mut self, bond: u32, graph: &BondGraph) {
        let ends = graph.pairs()[bond as usize].map(|i| i as usize);
        match self.criterion.level() {
            Some(Level::Neighbours) => ends.into_iter().for_each(|i| self.gather(i, graph)),
            Some(Level::Second) => {
                let mut near: Vec<usize> = ends.to_vec();
                ends.iter().for_each(|&i| near.extend(graph.neighbours(i).map(|h| h.other as usize)));
                near.sort_unstable();
                near.dedup();
                near.into_iter().for_each(|i| self.gather(i, graph));
            }
            _ => {}
        }
    }

    /// Whether any site can have a ratio of at least `limit`: a cheap answer for bodies far from failure. The stress of a
    /// neighbourhood is a mean of its members' own, and bounds are convex, so that no neighbourhood exceeds the largest
    /// bound of a particle alone.
    pub fn may_fail(&mut self, body: &impl Bonded, limit: f64) -> bool {
        match self.criterion {
            Criterion::BeamRankine(_) => true,
            Criterion::Hydrostatic(c) => self.own_bound_reaches(&c, body, limit),
            Criterion::Principal(c) => self.own_bound_reaches(&c, body, limit),
            Criterion::MohrCoulomb(c) => self.own_bound_reaches(&c, body, limit),
            Criterion::DruckerPrager(c) => self.own_bound_reaches(&c, body, limit),
        }
    }

    /// The same from [`BeamNetwork::pulls`], without a tensor: still cheaper, and farther from what is there.
    pub fn pulls_may_fail(&mut self, bonds: &BeamNetwork, limit: f64) -> bool {
        match self.criterion {
            Criterion::BeamRankine(_) => true,
            Criterion::Hydrostatic(c) => self.pulls_reach(&c, bonds, limit),
            Criterion::Principal(c) => self.pulls_reach(&c, bonds, limit),
            Criterion::MohrCoulomb(c) => self.pulls_reach(&c, bonds, limit),
            Criterion::DruckerPrager(c) => self.pulls_reach(&c, bonds, limit),
        }
    }

    fn pulls_reach(&mut self, criterion: &impl StressCriterion, bonds: &BeamNetwork, limit: f64) -> bool {
        bonds.pulls(&mut self.pulls);
        let fraction = self.fraction;
        let reaches = |(pulls, volume): (&[[f64; 2]], &[f64])| {
            let over = |(&[pulled, pressed], volume): (&[f64; 2], &f64)| {
                criterion.bound_between(pulled, pressed) * fraction >= limit * volume
            };
            pulls.iter().zip(volume).any(over)
        };
        self.pulls.par_chunks(BLOCK).zip(self.volume.par_chunks(BLOCK)).any(reaches)
    }

    fn own_bound_reaches(&mut self, criterion: &impl StressCriterion, body: &impl Bonded, limit: f64) -> bool {
        body.dyads(&mut self.dyads);
        let fraction = self.fraction;
        let reaches = |(dyads, volume): (&[Sym3], &[f64])| {
            dyads.iter().zip(volume).any(|(dyad, volume)| criterion.bound(&(*dyad * (fraction / volume))) >= limit)
        };
        self.dyads.par_chunks(BLOCK).zip(self.volume.par_chunks(BLOCK)).any(reaches)
    }

    /// Looks at every site: finds the one nearest to failure, and those with a ratio of at least `limit`.
    pub fn look(&mut self, body: &impl Bonded, graph: &BondGraph, limit: f64) {
        if let Criterion::BeamRankine(beam) = self.criterion {
            let section = body.section();
            let ratio = |bond: usize| {
                let live = graph.is_live(bond as u32);
                if live { beam.ratio(&body.load(bond as u32), &section) } else { 0.0 }
            };
            let looks = (0..graph.pairs().len().div_ceil(BLOCK)).into_par_iter().map(|block| {
                let mut look = Look::default();
                for bond in block * BLOCK..((block + 1) * BLOCK).min(graph.pairs().len()) {
                    look.take(bond, ratio(bond), limit);
                }
                look
            });
            let looks: Vec<Look> = looks.collect();
            self.merge(looks);
            return;
        }
        body.dyads(&mut self.dyads);
        let looks = match self.criterion {
            Criterion::Hydrostatic(c) => self.scan(&c, graph, limit),
            Criterion::Principal(c) => self.scan(&c, graph, limit),
            Criterion::MohrCoulomb(c) => self.scan(&c, graph, limit),
            Criterion::DruckerPrager(c) => self.scan(&c, graph, limit),
            Criterion::BeamRankine(_) => Vec::new(),
        };
        self.merge(looks);
    }

    /// Stresses of all neighbourhoods, and what the criterion says of them.
    fn scan(&mut self, criterion: &impl StressCriterion, graph: &BondGraph, limit: f64) -> Vec<Look> {
        let Watch { dyads, members, inverse, stress, .. } = self;
        let (dyads, members, inverse): (&[Sym3], &[Vec<u32>], &[f64]) = (dyads, members, inverse);
        let level = self.criterion.level();
        let block = |(block, stress): (usize, &mut [Sym3])| {
            let mut look = Look::default();
            for (slot, stress) in stress.iter_mut().enumerate() {
                let i = block * BLOCK + slot;
                let mut sum = dyads[i];
                match level {
                    Some(Level::Neighbours) => graph.neighbours(i).for_each(|h| sum += dyads[h.other as usize]),
                    Some(Level::Second) => members[i].iter().for_each(|&j| sum += dyads[j as usize]),
                    _ => {}
                }
                *stress = sum * inverse[i];
                // Eigenvalues only where they could matter.
                if criterion.bound(stress) >= limit.min(look.best()) {
                    look.take(i, criterion.ratio(stress), limit);
                }
            }
            look
        };
        stress.par_chunks_mut(BLOCK).enumerate().map(block).collect()
    }

    /// Joins what blocks found, in their order.
    fn merge(&mut self, looks: Vec<Look>) {
        self.over.clear();
        self.worst = None;
        for look in looks {
            self.over.extend_from_slice(&look.over);
            if let Some(site) = look.worst
                && self.worst.is_none_or(|w| site.ratio > w.ratio)
            {
                self.worst = Some(site);
            }
        }
    }

    /// The bonds that break when a site fails.
    pub fn breaks(&self, site: &Site, body: &impl Bonded, graph: &BondGraph, out: &mut Vec<Break>) {
        let i = site.index as usize;
        let release = match self.criterion {
            Criterion::BeamRankine(beam) => {
                let mode = beam.mode(&body.load(site.index), &body.section());
                return out.push(Break { bond: site.index, mode });
            }
            Criterion::Hydrostatic(c) => c.release(&self.stress[i]),
            Criterion::Principal(c) => c.release(&self.stress[i]),
            Criterion::MohrCoulomb(c) => c.release(&self.stress[i]),
            Criterion::DruckerPrager(c) => c.release(&self.stress[i]),
        };
        match release {
            Release::All(mode) => out.extend(graph.neighbours(i).map(|h| Break { bond: h.bond, mode })),
            Release::Nearest(directions, mode) => {
                let mut best: Option<(f64, u32)> = None;
                for edge in graph.neighbours(i) {
                    let axis = body.axis(edge.bond);
                    let cosine = directions.iter().fold(0.0f64, |c, d| c.max(axis.dot(d).abs()));
                    if best.is_none_or(|(c, _)| cosine > c) {
                        best = Some((cosine, edge.bond));
                    }
                }
                out.extend(best.map(|(_, bond)| Break { bond, mode }));
            }
        }
    }
}

/// What a block of sites shows.
#[derive(Default)]
struct Look {
    worst: Option<Site>,
    over: Vec<Site>,
}

impl Look {
    fn best(&self) -> f64 {
        self.worst.map_or(0.0, |w| w.ratio)
    }

    #[inline]
    fn take(&mut self, index: usize, ratio: f64, limit: f64) {
        let site = Site { index: index as u32, ratio };
        if ratio > self.best() {
            self.worst = Some(site);
        }
        if ratio >= limit {
            self.over.push(site);
        }
    }
}
