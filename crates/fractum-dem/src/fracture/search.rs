//! The search for bonds that must break, in a state at rest or in motion.

use fractum_math::{Sym3, Vec3, sphere_volume};
use fractum_parallel::gather_named;

use super::criterion::{
    AtWalls, BondLoad, BreakMode, FailureSite, FractureCriterion, Level, MOST, Neighbourhoods, Release, Rule,
    SeenBonds, weakness_of,
};
use super::subdomain::SearchSubdomain;
use crate::DemError;
use crate::bond::{BondGraph, Bonds, LoadLanes, LoadSizes};
use crate::particles::ParticleSubdomain;

/// What a criterion needs to know of a bonded body.
pub trait LoadedBonds: Sync {
    /// Half the sums of sym(r_ij ⊗ f_ij) over the bonds of each particle [N m]; see [`crate::stress`].
    fn virials(&self, out: &mut [Sym3]);

    /// What a live bond bears.
    fn load(&self, bond: u32) -> BondLoad;

    /// [`LoadedBonds::load`] to rounding and without directions, where it is known already.
    fn sizes(&self, _bond: u32) -> Option<LoadSizes> {
        None
    }

    /// Unit vector along a bond, in either sense.
    fn axis(&self, bond: u32) -> Vec3;
}

/// The same where what bonds bear was kept side by side when their forces were found.
pub trait ListedBonds: LoadedBonds {
    /// Lists bonds side by side where what they bear, and the radius of their sections [m], meet a condition, ascending; all where nothing was kept.
    fn list_by_loads(&self, meet: &(dyn Fn(&LoadLanes, f64) -> bool + Sync), list: &mut Vec<u32>);
}

/// A bond that breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Break {
    /// The bond.
    pub bond: u32,
    /// How.
    pub mode: BreakMode,
}

/// A criterion with the volumes of its neighbourhoods, which follow the bonds that break.
#[derive(Clone, Debug)]
pub struct FailureSearch {
    criterion: FractureCriterion,
    /// Volume of each particle [m³].
    volume: Vec<f64>,
    /// 1/Ω of each neighbourhood [1/m³].
    inverse: Vec<f64>,
    /// Interior volume fraction; one where the criterion takes the spheres' own volume.
    fraction: f64,
    /// What multiplies the ratio of each site, one over the factor on its strength; empty where all have the same.
    weakness: Vec<f64>,
    /// The largest of them.
    weakest: f64,
    /// What takes the stress of particles at walls to these; none where nothing does.
    at_walls: Option<AtWalls>,
    /// Members of each neighbourhood, for level 2 only.
    members: Vec<Vec<u32>>,
    virials: Vec<Sym3>,
    virial_bounds: Vec<[f64; 2]>,
    stress: Vec<Sym3>,
    /// Particles whose own stress may reach the limit.
    reaching: Vec<bool>,
    /// Bonds side by side of which one may reach it.
    listed: Vec<u32>,
    /// Sites over the limit at the last search, by index.
    overloaded: Vec<FailureSite>,
    worst: Option<FailureSite>,
    /// Sites of this process, where several share them.
    part: Option<Box<SearchSubdomain>>,
}

impl FailureSearch {
    /// Watches a body.
    ///
    /// - `radius`: of the particles [m]
    /// - `fraction`: volume fraction f_v of the interior of the packing
    ///
    /// # Errors
    /// Strengths that are none; a volume fraction outside 0 to 1; array lengths.
    pub fn new(
        criterion: FractureCriterion,
        graph: &BondGraph,
        radius: &[f64],
        fraction: f64,
    ) -> Result<Self, DemError> {
        criterion.check()?;
        let n = graph.particles();
        if radius.len() != n {
            return Err(DemError::Length { what: "radius", found: radius.len(), expected: n });
        }
        if !(fraction > 0.0 && fraction <= 1.0) {
            let expected = "above 0 and at most 1";
            return Err(DemError::BadCriterion { what: "volume fraction", value: fraction, expected });
        }
        let fraction = match criterion.rule() {
            Rule::Stress(c) if c.without_voids() => 1.0,
            _ => fraction,
        };
        let volume = radius.iter().map(|r| sphere_volume(*r)).collect();
        let (stressed, listed) = match criterion.level() {
            None => (0, 0),
            Some(Level::Second) => (n, n),
            Some(_) => (n, 0),
        };
        let mut search = FailureSearch {
            criterion,
            volume,
            inverse: vec![0.0; stressed],
            fraction,
            weakness: Vec::new(),
            weakest: 1.0,
            at_walls: None,
            members: vec![Vec::new(); listed],
            virials: vec![Sym3::ZERO; stressed],
            virial_bounds: vec![[0.0; 2]; stressed],
            stress: vec![Sym3::ZERO; stressed],
            reaching: vec![false; stressed],
            listed: Vec::new(),
            overloaded: Vec::new(),
            worst: None,
            part: None,
        };
        search.gather_all(graph);
        Ok(search)
    }

    /// Gives particles strengths of their own; a bond has that of the weaker of its two.
    ///
    /// - `factors`: on the strength of each particle, > 0; none where all have the same
    pub(crate) fn set_strength_factors(&mut self, factors: &[f64], graph: &BondGraph) {
        let of_particles = factors.iter().map(|factor| factor.recip());
        let of_bond = |pair: &[u32; 2]| pair.map(|i| factors[i as usize].recip()).into_iter().fold(0.0, f64::max);
        self.weakness = match self.criterion.level() {
            None if !factors.is_empty() => graph.pairs().iter().map(of_bond).collect(),
            _ => of_particles.collect(),
        };
        self.weakest = self.weakness.iter().copied().reduce(f64::max).unwrap_or(1.0);
    }

    /// Takes the stress of particles at walls at these, by its gradient over what is up to two bonds away; without
    /// effect on a criterion of single bonds.
    ///
    /// - `position`: centres without load [m]
    /// - `to_wall`: from each of them to the wall that it touches, zero off the walls; empty to leave all as it is [m]
    pub fn read_at_walls(&mut self, position: &[Vec3], to_wall: &[Vec3], graph: &BondGraph) {
        if !to_wall.is_empty() && self.criterion.level().is_some() {
            self.at_walls = Some(AtWalls::new(position, to_wall));
            self.gather_all(graph);
        }
    }

    /// Members and volumes of all neighbourhoods anew.
    pub(crate) fn gather_all(&mut self, graph: &BondGraph) {
        (0..self.inverse.len()).for_each(|i| self.gather(i, graph));
    }

    /// The criterion.
    pub fn criterion(&self) -> &FractureCriterion {
        &self.criterion
    }

    /// The site nearest to failure at the last [`FailureSearch::search`]; none where nothing bears anything, or was looked for.
    pub fn worst(&self) -> Option<FailureSite> {
        self.worst
    }

    /// Sites whose ratio was at least the limit at the last search, by index.
    pub fn overloaded(&self) -> &[FailureSite] {
        &self.overloaded
    }

    /// Stress of each neighbourhood when it was last looked at [Pa]; empty for a criterion of beams.
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
        if let (Some(at_walls), Some(level)) = (&mut self.at_walls, self.criterion.level()) {
            at_walls.gather(i, graph, &self.volume, self.fraction, level);
        }
    }

    /// Leaves the sites to ranks: particles to those that move them, bonds to those that compute them.
    pub(super) fn distribute(&mut self, part: &ParticleSubdomain, bonds: &Bonds, graph: &BondGraph) {
        let rings = match self.criterion.level() {
            Some(_) if self.at_walls.is_some() => 2,
            None | Some(Level::Own) => 0,
            Some(Level::Neighbours) => 1,
            Some(Level::Second) => 2,
        };
        self.part = Some(Box::new(SearchSubdomain::new(part, bonds, graph, rings)));
    }

    /// The bonds that break on any rank, and their energies [J], by those of this one.
    pub(super) fn gather_breaks(&self, own: &mut Vec<Break>, energies: &mut Vec<f64>) {
        if let Some(part) = &self.part {
            let with_energy = own.iter().zip(&*energies).map(|(Break { bond, mode }, energy)| (*bond, *mode, *energy));
            let mine: Vec<(u32, BreakMode, f64)> = with_energy.collect();
            own.clear();
            energies.clear();
            for (bond, mode, energy) in gather_named(part.exchange(), &mine) {
                own.push(Break { bond, mode });
                energies.push(energy);
            }
        }
    }

    /// Takes note that a bond of the graph has broken: only the neighbourhoods that it led through change.
    pub fn bond_broken(&mut self, bond: u32, graph: &BondGraph) {
        let ends = graph.pairs()[bond as usize].map(|i| i as usize);
        match self.criterion.level() {
            Some(Level::Neighbours) if self.at_walls.is_none() => ends.into_iter().for_each(|i| self.gather(i, graph)),
            Some(level) if level == Level::Second || self.at_walls.is_some() => {
                let mut near: Vec<usize> = ends.to_vec();
                ends.iter().for_each(|&i| near.extend(graph.neighbours(i).map(|h| h.other as usize)));
                near.sort_unstable();
                near.dedup();
                near.into_iter().for_each(|i| self.gather(i, graph));
            }
            _ => {}
        }
    }

    /// Finds the sites with a ratio of at least `limit`, and no other: cheap where few are near it. The stress of a
    /// neighbourhood is a mean of its members' own, and bounds are convex, so that no neighbourhood exceeds the largest
    /// bound of one of its particles alone.
    pub fn search_overloaded(&mut self, body: &impl ListedBonds, graph: &BondGraph, limit: f64) {
        let FailureSearch {
            criterion,
            volume,
            inverse,
            fraction,
            members,
            virials,
            stress,
            reaching,
            listed,
            part,
            weakness,
            weakest,
            at_walls,
            ..
        } = self;
        // Before the strength of each site is looked at, and where it is.
        let any_limit = limit / (*weakest * most(at_walls));
        self.overloaded.clear();
        self.worst = None;
        match criterion.rule() {
            Rule::Load(criterion) => {
                body.list_by_loads(&|loads, radius| criterion.loads_reach(loads, radius, any_limit), listed);
                let site = |&bond: &u32| {
                    let ratio = criterion.ratio_of_bond(&body.load(bond)) * weakness_of(weakness, bond as usize);
                    FailureSite { index: bond, ratio }
                };
                let live = listed.iter().filter(|&&bond| graph.is_live(bond));
                self.overloaded.extend(live.map(site).filter(|site| site.ratio >= limit));
            }
            Rule::Stress(criterion) => {
                body.virials(virials);
                let own = part.as_ref().map_or(0..virials.len(), |part| part.particles());
                let (virial, volume) = (&virials[own.clone()], &volume[own.clone()]);
                let mut any = criterion.virials_reach(virial, volume, *fraction, any_limit, &mut reaching[own.clone()]);
                if let Some(part) = part {
                    any |= part.exchange_virials(virials, reaching);
                }
                if any {
                    let around = Neighbourhoods {
                        graph,
                        members,
                        inverse,
                        virials,
                        weakness,
                        at_walls: at_walls.as_ref(),
                        first: own.start,
                    };
                    let found = criterion.search_among(&around, reaching, &mut stress[own], limit);
                    found.iter().for_each(|block| self.overloaded.extend_from_slice(&block.overloaded));
                }
            }
        }
    }

    /// Whether [`Bonds::virial_bounds`] allow a site a ratio of at least `limit`: cheaper still, without a tensor, and a coarser bound.
    pub fn virial_bounds_may_fail(&mut self, bonds: &Bonds, limit: f64) -> bool {
        let Rule::Stress(criterion) = self.criterion.rule() else { return true };
        let limit = limit / (self.weakest * most(&self.at_walls));
        bonds.virial_bounds(&mut self.virial_bounds);
        let own = self.part.as_ref().map_or(0..self.volume.len(), |part| part.particles());
        let own_reach =
            criterion.bounds_reach(&self.virial_bounds[own.clone()], &self.volume[own], self.fraction, limit);
        self.part.as_ref().map_or(own_reach, |part| part.any(own_reach))
    }

    /// Searches all sites: finds the one nearest to failure, and those with a ratio of at least `limit`; only those of this
    /// process where several share them.
    pub fn search(&mut self, body: &impl LoadedBonds, graph: &BondGraph, limit: f64) {
        let criterion = self.criterion;
        let found = match criterion.rule() {
            Rule::Load(criterion) => {
                let weakness = &self.weakness[..];
                let seen = SeenBonds { load: &|bond| body.load(bond), sizes: &|bond| body.sizes(bond), weakness };
                let own = self.part.as_ref().map_or(0..graph.pairs().len(), |part| part.bonds());
                criterion.search(&seen, graph, own, limit)
            }
            Rule::Stress(criterion) => {
                body.virials(&mut self.virials);
                let FailureSearch { members, inverse, virials, weakness, stress, part, reaching, at_walls, .. } = self;
                let own = part.as_ref().map_or(0..virials.len(), |part| part.particles());
                part.iter_mut().for_each(|part| _ = part.exchange_virials(virials, reaching));
                let around = Neighbourhoods {
                    graph,
                    members,
                    inverse,
                    virials,
                    weakness,
                    at_walls: at_walls.as_ref(),
                    first: own.start,
                };
                criterion.search(&around, &mut stress[own], limit)
            }
        };
        self.overloaded.clear();
        self.worst = None;
        // Blocks in their order.
        for block in found {
            self.overloaded.extend_from_slice(&block.overloaded);
            if let Some(site) = block.worst
                && self.worst.is_none_or(|worst| site.ratio > worst.ratio)
            {
                self.worst = Some(site);
            }
        }
        if let Some(part) = &self.part {
            self.worst = part.worst(self.worst);
        }
    }

    /// The bonds that break when a site fails.
    pub fn breaks(&self, site: &FailureSite, body: &impl LoadedBonds, graph: &BondGraph, out: &mut Vec<Break>) {
        let i = site.index as usize;
        let release = match self.criterion.rule() {
            Rule::Load(criterion) => {
                let mode = criterion.mode(&body.load(site.index));
                return out.push(Break { bond: site.index, mode });
            }
            Rule::Stress(criterion) => criterion.release(&self.stress[i]),
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

/// The most that a site's ratio may be over that of its neighbourhood.
fn most(at_walls: &Option<AtWalls>) -> f64 {
    if at_walls.is_some() { MOST } else { 1.0 }
}
