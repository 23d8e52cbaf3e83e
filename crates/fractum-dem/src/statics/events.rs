//! Quasi-static breaking, event by event.

mod constant;
mod state;

use serde::{Deserialize, Serialize};

use constant::Constant;
use state::Progress;
pub use state::QuasiStaticState;

use super::body::ALL_AXES;
use super::{Dof6, Lattice, LatticeSupports, StaticBody, Tolerance};
use crate::DemError;
use crate::bond::BondGraph;
use crate::fracture::{Break, Crack, FailureSearch, FailureSite, FractureCriterion, Occasion, facet_area};

/// Share of the largest load factor that is looked ahead at first, beside constant loads.
const FIRST_STRIDE: f64 = 1e-3;
/// Share of it within which the next failure is known, and most searches for it.
const ROOT_WIDTH: f64 = 1e-12;
const ROOT_STEPS: usize = 60;

/// Share of the loads that may have been on pieces that came loose: they are handed over. With more the body gives way.
const FEW: f64 = 0.05;

/// How many bonds break between two equilibria.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Batch {
    /// What the site that is most overloaded releases.
    One,
    /// What every overloaded site releases.
    #[default]
    PerSite,
}

/// What is to be broken, and when to stop.
#[derive(Clone, Debug)]
pub struct Breaking<'a> {
    /// When bonds break.
    pub criterion: FractureCriterion,
    /// The bonds, in the order of the lattice.
    pub pairs: &'a [[u32; 2]],
    /// Particle radii [m].
    pub radius: &'a [f64],
    /// Factors on the strength of the particles, > 0; none where all have the same.
    pub strength_factors: &'a [f64],
    /// Volume fraction of the interior of the packing.
    pub fraction: f64,
    /// Volume of the body, that the facets of its bonds share [m³].
    pub volume: f64,
    /// Displacement (or rotation) of the supports that does work against the load, at load factor one.
    pub displacement: f64,
    /// How many bonds break between two equilibria.
    pub batch: Batch,
    /// Largest load factor.
    pub limit: f64,
    /// The body has lost its strength when cracks have come to rest and the load is below this share of its peak.
    pub stop: f64,
    /// When equilibrium is reached.
    pub tolerance: Tolerance,
}

/// The load before bonds break, and what broke since the one before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadPoint {
    /// Displacement (or rotation) of the supports.
    pub displacement: f64,
    /// Force (or moment) that does work on it, of what grows alone.
    pub load: f64,
    /// Elastic energy [J].
    pub elastic: f64,
    /// Work of the supports on their way so far [J].
    pub work: f64,
    /// Bonds broken so far.
    pub broken: usize,
}

/// A point of the load curve that matters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriticalLoad {
    /// Displacement (or rotation) of the supports.
    pub displacement: f64,
    /// Force (or moment).
    pub load: f64,
    /// Bonds broken before.
    pub broken: usize,
}

/// How a body broke.
#[derive(Clone, Debug)]
pub struct BreakingOutcome {
    /// The load when the first bond broke; none when nothing did.
    pub first: Option<CriticalLoad>,
    /// The largest load.
    pub peak: CriticalLoad,
    /// The load curve: a point before every breaking, and the last state.
    pub curve: Vec<LoadPoint>,
    /// What broke, in order.
    pub cracks: Vec<Crack>,
    /// Whether the body came apart or lost its strength; otherwise the largest load factor was reached.
    pub separated: bool,
    /// The site nearest to failure in the last state, with its ratio there.
    pub closest: Option<FailureSite>,
    /// The bonds that are left.
    pub graph: BondGraph,
    /// Displacements [m] and rotations before the first bond broke, at load factor one.
    pub first_state: Vec<Dof6>,
    /// The same at the end, at load factor one.
    pub last_state: Vec<Dof6>,
    /// Equilibria found, and iterations for all of them.
    pub effort: (usize, usize),
    /// The same up to the peak.
    pub effort_to_peak: (usize, usize),
}

/// What the search for the next failure ended with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LoadStage {
    /// A site fails: [`QuasiStatic::break_and_rebalance`] is next.
    Failing,
    /// The body has come apart or lost its strength.
    Separated,
    /// The largest load factor is reached, and the body holds.
    LimitReached,
}

/// A body under supports that move in proportion: they rise to the first failure, bonds break and equilibrium is found
/// again with the supports where they are; when no site fails any more, they move on to the next failure.
/// Constant loads may hold from the start, beside what grows.
///
/// The solution is linear between two breaks, so that the load of the next failure is known and no step can miss it.
#[derive(Clone, Debug)]
pub struct QuasiStatic {
    graph: BondGraph,
    search: FailureSearch,
    body: StaticBody,
    constant: Option<Box<Constant>>,
    area: f64,
    displacement: f64,
    batch: Batch,
    limit: f64,
    stop: f64,
    progress: Progress,
    breaks: Vec<Break>,
    sites: Vec<FailureSite>,
}

impl QuasiStatic {
    /// Brings a body to equilibrium under its supports.
    ///
    /// - `supports`, `guess`: displacements at load factor one
    ///
    /// # Errors
    /// An impossible criterion; [`DemError::NotConverged`].
    pub fn new(
        lattice: Lattice,
        supports: LatticeSupports,
        guess: &[Dof6],
        what: &Breaking<'_>,
    ) -> Result<Self, DemError> {
        QuasiStatic::under_loads(lattice, supports, [&[], &[]], guess, what)
    }

    /// [`QuasiStatic::new`] under forces from outside, that hold from the start and that grow with the supports.
    ///
    /// - `loads`: constant ones, and those at load factor one that grow, on every particle; empty where there are none
    ///
    /// # Errors
    /// As [`QuasiStatic::new`].
    pub fn under_loads(
        lattice: Lattice,
        supports: LatticeSupports,
        [constant, growing]: [&[Dof6]; 2],
        guess: &[Dof6],
        what: &Breaking<'_>,
    ) -> Result<Self, DemError> {
        let graph = BondGraph::new(lattice.len(), what.pairs);
        let mut search = FailureSearch::new(what.criterion, &graph, what.radius, what.fraction)?;
        search.set_strength_factors(what.strength_factors, &graph);
        let area = facet_area(what.volume, lattice.position(), what.pairs);
        let constant = match constant {
            [] => None,
            loads => {
                let at_rest = vec![[0.0; 6]; lattice.len()];
                let body = StaticBody::under_loads(lattice.clone(), supports.held(), loads, &at_rest, what.tolerance)?;
                Some(Box::new(Constant::new(body)))
            }
        };
        Ok(QuasiStatic {
            graph,
            search,
            body: StaticBody::under_loads(lattice, supports, growing, guess, what.tolerance)?,
            constant,
            area,
            displacement: what.displacement,
            batch: what.batch,
            limit: what.limit,
            stop: what.stop,
            progress: Progress::default(),
            breaks: Vec::new(),
            sites: Vec::new(),
        })
    }

    /// The body under what grows, at load factor one.
    pub fn body(&self) -> &StaticBody {
        &self.body
    }

    /// The body under the constant loads alone.
    pub fn constant(&self) -> Option<&StaticBody> {
        self.constant.as_ref().map(|constant| &constant.body)
    }

    /// Displacements [m] and rotations at the present load.
    pub fn displacements(&self) -> Vec<Dof6> {
        let factor = self.progress.factor;
        let mut state = self.body.state();
        state.iter_mut().for_each(|u| *u = u.map(|u| u * factor));
        if let Some(constant) = self.constant() {
            let both = state.iter_mut().zip(constant.state());
            both.for_each(|(u, constant)| (0..6).for_each(|d| u[d] += constant[d]));
        }
        state
    }

    /// Force [N] and moment [N m] that a support exerts on a particle at the present load.
    pub fn reaction(&self, particle: u32) -> Dof6 {
        let growing = self.body.reaction(particle).map(|force| force * self.progress.factor);
        match self.constant().map(|constant| constant.reaction(particle)) {
            Some(constant) => std::array::from_fn(|d| constant[d] + growing[d]),
            None => growing,
        }
    }

    /// Elastic energy at the present load [J].
    pub fn energy(&self) -> f64 {
        let factor = self.progress.factor;
        let growing = factor * factor * self.body.energy();
        self.constant().map_or(growing, |constant| constant.energy() + factor * self.body.work_on(constant) + growing)
    }

    /// Work of the present forces from outside on the present displacements, at their full size all the way [J].
    pub fn work_of_loads(&self) -> f64 {
        let factor = self.progress.factor;
        let growing = factor * factor * self.body.work_of_loads();
        self.constant().map_or(growing, |constant| {
            let cross = constant.work_of_loads_on(&self.body) + self.body.work_of_loads_on(constant);
            constant.work_of_loads() + factor * cross + growing
        })
    }

    /// Equilibria found, and iterations for all of them.
    pub fn effort(&self) -> (usize, usize) {
        let (solves, iterations) = self.body.effort();
        self.constant().map_or((solves, iterations), |constant| {
            let (more, of_constant) = constant.effort();
            (solves + more, iterations + of_constant)
        })
    }

    /// The present load factor.
    pub fn factor(&self) -> f64 {
        self.progress.factor
    }

    /// What broke so far, in order.
    pub fn cracks(&self) -> &[Crack] {
        &self.progress.cracks
    }

    /// The site nearest to failure, with its ratio at the present load.
    pub fn closest(&self) -> Option<FailureSite> {
        let scale = if self.constant.is_some() { 1.0 } else { self.progress.factor };
        self.search.worst().map(|site| FailureSite { ratio: site.ratio * scale, ..site })
    }

    /// Looks at all sites at a load factor, beside constant loads. Returns the largest ratio.
    fn look(&mut self, factor: f64) -> f64 {
        let QuasiStatic { search, constant: Some(constant), body, graph, .. } = self else { return 0.0 };
        search.search(&constant.with(body, factor), graph, 1.0);
        search.worst().map_or(0.0, |site| site.ratio)
    }

    /// The factor from `from` on, where nothing fails, at which the first site fails; the limit where none does, with whether one does.
    ///
    /// - `ratio`: the largest ratio at `from`
    fn next_failure(&mut self, from: f64, ratio: f64) -> (f64, bool) {
        let limit = self.limit;
        let (mut low, mut below) = (from, ratio - 1.0);
        // In strides, since what fails in between may be spared farther on.
        let mut stride = (4.0 * self.progress.stride).clamp(FIRST_STRIDE * limit, limit);
        let (mut high, mut above) = loop {
            let next = (low + stride).min(limit);
            let over = self.look(next) - 1.0;
            if over >= 0.0 {
                break (next, over);
            }
            if next >= limit {
                return (limit, false);
            }
            (low, below) = (next, over);
            stride *= 2.0;
        };
        // Regula falsi with the weights of Illinois.
        for _ in 0..ROOT_STEPS {
            if above == 0.0 || high - low <= ROOT_WIDTH * limit {
                break;
            }
            let middle = (low * above - high * below) / (above - below);
            let over = self.look(middle) - 1.0;
            if over >= 0.0 {
                (high, above, below) = (middle, over, 0.5 * below);
            } else {
                (low, below, above) = (middle, over, 0.5 * above);
            }
        }
        self.look(high);
        self.progress.stride = high - from;
        (high, true)
    }

    /// Moves the supports on to the next failure, unless sites fail where they are.
    ///
    /// - `separated`: whether the body has come apart; asked once something has broken
    pub fn load_to_next_failure(&mut self, separated: impl Fn(&BondGraph) -> bool) -> (LoadPoint, LoadStage) {
        self.progress.event += 1;
        let energy = self.body.energy();
        let before = self.progress.factor;
        let present = match &mut self.constant {
            Some(constant) => {
                constant.update(&self.body);
                self.look(before)
            }
            None => {
                self.progress.overload = if before > 0.0 { 1.0 / before } else { f64::INFINITY };
                self.search.search(&self.body, &self.graph, self.progress.overload);
                0.0
            }
        };
        let whole = self.displacement;
        let load_at = |factor: f64| factor * 2.0 * energy / whole;
        let held = load_at(before);
        // Where nothing is over at this load, the load rises to the next failure.
        let worst = self.search.worst();
        self.progress.cascade = worst.is_some() && !self.search.overloaded().is_empty();
        let weak = !self.progress.cascade && held < self.stop * self.progress.peak.load;
        let apart = !self.progress.cracks.is_empty() && (weak || separated(&self.graph));
        let mut fails = self.progress.cascade || worst.is_some_and(|w| w.ratio * self.limit >= 1.0);
        if !self.progress.cascade && !apart {
            self.progress.factor = if self.constant.is_some() {
                let (factor, failing) = self.next_failure(before, present);
                fails = failing;
                factor
            } else {
                worst.map_or(self.limit, |w| (1.0 / w.ratio).max(before)).min(self.limit)
            };
        }
        let (displacement, load) = (self.progress.factor * self.displacement, load_at(self.progress.factor));
        let mut work = self.progress.last.map_or(0.0, |l| l.work);
        if self.progress.factor > before {
            // Between two breaks the load is proportional; at a break the supports stand still.
            work += 0.5 * (load + held) * (self.progress.factor - before) * self.displacement;
        }
        let (elastic, broken) = (self.energy(), self.graph.broken());
        let point = LoadPoint { displacement, load, elastic, work, broken };
        self.progress.last = Some(point);
        if load > self.progress.peak.load {
            self.progress.peak = CriticalLoad { displacement, load, broken };
            self.progress.effort_to_peak = self.effort();
        }
        let stage = match (apart, fails) {
            (true, _) => LoadStage::Separated,
            (false, false) => LoadStage::LimitReached,
            (false, true) => LoadStage::Failing,
        };
        if stage == LoadStage::Failing {
            self.progress.first.get_or_insert(CriticalLoad { displacement, load, broken: 0 });
        }
        (point, stage)
    }

    /// Hands loads on pieces that supports do not hold along all axes over to what is left, as long as they are few: loose particles of a pressed side, which press
    /// on those behind them.
    fn hand_over_loose(&mut self) {
        let QuasiStatic { graph, body, constant, .. } = self;
        let mut bodies: Vec<&mut StaticBody> = constant.iter_mut().map(|constant| &mut constant.body).collect();
        bodies.push(body);
        if bodies.iter().all(|body| !body.is_loaded()) {
            return;
        }
        let parts = graph.parts();
        let count = parts.of.len();
        let (mut held, mut sizes) = (vec![0u8; parts.count], vec![0usize; parts.count]);
        for (i, &part) in parts.of.iter().enumerate() {
            held[part as usize] |= bodies[0].held_along(i);
            sizes[part as usize] += 1;
        }
        let most = sizes.iter().copied().max().unwrap_or(0);
        // What hangs together with most of the body may be held by the balance of its loads.
        let is_held = |i: usize| {
            let part = parts.of[i] as usize;
            held[part] == ALL_AXES || sizes[part] == most
        };
        let loose: Vec<usize> = (0..count).filter(|&i| !is_held(i)).collect();
        for body in bodies.into_iter().filter(|body| body.is_loaded()) {
            if body.share_of_loads(loose.iter().copied()) <= FEW {
                loose.iter().for_each(|&i| body.hand_over(i, is_held));
            }
        }
    }

    /// Breaks what fails and finds equilibrium again. Returns the work that loads do as the body gives way [J].
    ///
    /// # Errors
    /// [`DemError::NotConverged`].
    pub fn break_and_rebalance(&mut self) -> Result<f64, DemError> {
        let QuasiStatic { graph, search, body, constant, sites, breaks, progress, batch, area, .. } = self;
        sites.clear();
        match (progress.cascade, *batch) {
            (true, Batch::PerSite) => sites.extend_from_slice(search.overloaded()),
            _ => sites.extend(search.worst()),
        }
        breaks.clear();
        match constant {
            Some(constant) => {
                let bonds = constant.with(body, progress.factor);
                sites.iter().for_each(|site| search.breaks(site, &bonds, graph, breaks));
            }
            None => sites.iter().for_each(|site| search.breaks(site, body, graph, breaks)),
        }
        let load = progress.last.map_or(0.0, |l| l.load);
        for &Break { bond, mode } in breaks.iter() {
            let energy = body.bond_energy(bond, progress.factor, constant.as_ref().map(|constant| &constant.body));
            if graph.break_bond(bond) {
                let pair = graph.pairs()[bond as usize];
                let occasion = Occasion { time: progress.factor, event: progress.event, load };
                let reference = body.lattice().position();
                progress.cracks.push(Crack::new(bond, pair, reference, *area, mode, energy, occasion));
                body.break_bond(bond);
                constant.iter_mut().for_each(|constant| constant.body.break_bond(bond));
                search.bond_broken(bond, graph);
            }
        }
        self.hand_over_loose();
        let before = self.work_of_loads();
        self.body.solve()?;
        if let Some(constant) = &mut self.constant {
            constant.body.solve()?;
        }
        Ok(self.work_of_loads() - before)
    }
}

/// Loads a body until it comes apart or the largest load factor is reached; see [`QuasiStatic`].
///
/// - `supports`, `guess`: displacements at load factor one
/// - `separated`: whether the body has come apart; asked after every equilibrium past the first break
///
/// # Errors
/// An impossible criterion; [`DemError::NotConverged`].
pub fn quasi_static(
    lattice: Lattice,
    supports: LatticeSupports,
    guess: &[Dof6],
    what: &Breaking<'_>,
    separated: impl Fn(&BondGraph) -> bool,
) -> Result<BreakingOutcome, DemError> {
    let mut run = QuasiStatic::new(lattice, supports, guess, what)?;
    let first_state = run.body.state();
    let mut curve = Vec::new();
    let stage = loop {
        let (point, stage) = run.load_to_next_failure(&separated);
        curve.push(point);
        if stage != LoadStage::Failing {
            break stage;
        }
        run.break_and_rebalance()?;
    };
    Ok(BreakingOutcome {
        first: run.progress.first,
        peak: run.progress.peak,
        curve,
        separated: stage == LoadStage::Separated,
        closest: run.closest(),
        first_state,
        last_state: run.body.state(),
        effort: run.effort(),
        effort_to_peak: run.progress.effort_to_peak,
        cracks: run.progress.cracks,
        graph: run.graph,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BeamSection;
    use crate::criterion::{BeamRankine, Level, Principal};
    use crate::fracture::LoadedBonds;
    use fractum_math::{Sym3, Vec3};

    /// A jittered cubic bar along x, bonded to nearest neighbours and along one diagonal.
    fn bar(size: [usize; 3]) -> (Vec<Vec3>, Vec<[u32; 2]>) {
        let id = |s: [usize; 3]| ((s[0] * size[1] + s[1]) * size[2] + s[2]) as u32;
        let (mut position, mut pairs) = (Vec::new(), Vec::new());
        for x in 0..size[0] {
            for y in 0..size[1] {
                for z in 0..size[2] {
                    let jitter = |a: usize| 0.08 * ((id([x, y, z]) as usize * 3 + a) as f64 * 12.9898).sin();
                    position.push(Vec3::new(x as f64 + jitter(0), y as f64 + jitter(1), z as f64 + jitter(2)));
                    for step in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1]] {
                        let t = [x + step[0], y + step[1], z + step[2]];
                        if (0..3).all(|a| t[a] < size[a]) {
                            pairs.push([id([x, y, z]), id(t)]);
                        }
                    }
                }
            }
        }
        pairs.sort_unstable();
        (position, pairs)
    }

    fn pull(size: [usize; 3], criterion: FractureCriterion, limit: f64, residual: f64) -> BreakingOutcome {
        pull_scattered(size, criterion, &[], limit, residual)
    }

    /// - `strength_factors`: of the particles
    fn pull_scattered(
        size: [usize; 3],
        criterion: FractureCriterion,
        strength_factors: &[f64],
        limit: f64,
        residual: f64,
    ) -> BreakingOutcome {
        let (position, pairs) = bar(size);
        let n = position.len();
        let face = size[1] * size[2];
        let lattice = Lattice::new(&position, &pairs, BeamSection::new(1e9, 0.3).unwrap(), 0.5).unwrap();
        let mut supports = LatticeSupports::none(n);
        (0..face).for_each(|i| supports.set(i as u32, 0, 0.0));
        (n - face..n).for_each(|i| supports.set(i as u32, 0, 1e-3));
        let last = (size[0] - 1) as f64;
        let guess: Vec<Dof6> = position.iter().map(|x| [1e-3 * x.x / last, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        let radius = vec![0.5; n];
        let tolerance = Tolerance { residual, ..Tolerance::default() };
        let what = Breaking {
            criterion,
            pairs: &pairs,
            radius: &radius,
            strength_factors,
            fraction: 0.52,
            volume: n as f64,
            displacement: 1e-3,
            batch: Batch::PerSite,
            limit,
            stop: 1e-3,
            tolerance,
        };
        let (low, high): (Vec<u32>, Vec<u32>) = ((0..face as u32).collect(), ((n - face) as u32..n as u32).collect());
        quasi_static(lattice, supports, &guess, &what, |graph| graph.parts().separate(&low, &high)).unwrap()
    }

    fn principal(level: Level) -> FractureCriterion {
        FractureCriterion::Principal(Principal { tensile_strength: 1e5, compressive_strength: None, level })
    }

    #[test]
    fn a_chain_breaks_at_the_strength_of_its_beams() {
        let position: Vec<Vec3> = (0..4).map(|i| Vec3::x() * f64::from(i)).collect();
        let pairs = [[0, 1], [1, 2], [2, 3]];
        let section = BeamSection::new(1e9, 0.3).unwrap();
        let lattice = Lattice::new(&position, &pairs, section, 0.5).unwrap();
        let mut supports = LatticeSupports::none(4);
        (0..6).for_each(|d| supports.set(0, d, 0.0));
        supports.set(3, 0, 1e-3);
        let what = Breaking {
            criterion: FractureCriterion::BeamRankine(BeamRankine { strength: 2e5, moments: Default::default() }),
            pairs: &pairs,
            radius: &[0.5; 4],
            strength_factors: &[],
            fraction: 0.5,
            volume: 3.0,
            displacement: 1e-3,
            batch: Batch::PerSite,
            limit: f64::INFINITY,
            stop: 1e-3,
            tolerance: Tolerance { residual: 1e-9, ..Tolerance::default() },
        };
        let outcome = quasi_static(lattice, supports, &[[0.0; 6]; 4], &what, |g| g.parts().count > 1).unwrap();
        let force = 2e5 * std::f64::consts::PI * 0.09;
        assert!((outcome.peak.load / force - 1.0).abs() < 1e-8 && outcome.separated);
        // All three beams bear the same to round-off: whether one or more of them go, the chain is apart at once.
        assert_eq!(outcome.curve.len(), 2);
        let energy: f64 = outcome.cracks[0].energy * 3.0;
        let last = outcome.curve.last().unwrap();
        assert!((last.work / energy - 1.0).abs() < 1e-6 && last.elastic < 1e-9 * energy);
        assert_eq!(outcome.cracks[0].area, 3.0);
    }

    #[test]
    fn a_bar_comes_apart_and_its_load_curve_does_the_work() {
        for level in [Level::Own, Level::Neighbours, Level::Second] {
            let outcome = pull([8, 4, 4], principal(level), f64::INFINITY, 1e-6);
            assert!(outcome.separated && outcome.cracks.len() >= 16, "{level:?}: {}", outcome.cracks.len());
            assert!(outcome.peak.load >= outcome.first.unwrap().load);
            assert!(outcome.curve.windows(2).all(|w| w[1].displacement >= w[0].displacement));
            let last = outcome.curve.last().unwrap();
            let broken: f64 = outcome.cracks.iter().map(|c| c.energy).sum();
            // Sudden equilibria release more than the broken bonds had.
            assert!(last.work > broken && last.work.is_finite());
        }
    }

    #[test]
    fn a_bar_breaks_first_where_its_particles_are_weak() {
        let (position, pairs) = bar([6, 3, 3]);
        let beam = FractureCriterion::BeamRankine(BeamRankine { strength: 2e5, moments: Default::default() });
        for criterion in [principal(Level::Own), principal(Level::Neighbours), beam] {
            let first = |factors: &[f64]| {
                let outcome = pull_scattered([6, 3, 3], criterion, factors, f64::INFINITY, 1e-8);
                (outcome.first.unwrap().load, outcome.peak.load, outcome.cracks[0].bond)
            };
            let (load, peak, _) = first(&[]);
            let half = first(&vec![0.5; position.len()]);
            assert!((half.0 / load - 0.5).abs() < 1e-6 && (half.1 / peak - 0.5).abs() < 1e-6, "{half:?}, {load}");
            let weak = position.len() / 2 + 1;
            let mut factors = vec![1.0; position.len()];
            factors[weak] = 0.4;
            let (one, _, bond) = first(&factors);
            assert!(one < 0.7 * load && one > 0.3 * load, "{one} of {load}");
            let around =
                |i: u32| i as usize == weak || pairs.iter().any(|p| p.contains(&i) && p.contains(&(weak as u32)));
            assert!(pairs[bond as usize].into_iter().any(around), "bond {bond}");
        }
    }

    #[test]
    fn a_bar_that_holds_says_how_close_it_came() {
        let broken = pull([6, 3, 3], principal(Level::Neighbours), f64::INFINITY, 1e-6);
        let first = broken.first.unwrap().displacement / 1e-3;
        let held = pull([6, 3, 3], principal(Level::Neighbours), 0.8 * first, 1e-6);
        assert!(held.first.is_none() && held.cracks.is_empty() && !held.separated);
        assert!((held.closest.unwrap().ratio - 0.8).abs() < 1e-6);
        assert!((held.peak.displacement / 1e-3 - 0.8 * first).abs() < 1e-9 * first);
    }

    #[test]
    fn the_same_bits_on_any_number_of_threads() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let outcome = pool.install(|| pull([14, 10, 10], principal(Level::Neighbours), f64::INFINITY, 1e-3));
            let bits: Vec<u64> = outcome.curve.iter().map(|p| p.load.to_bits()).collect();
            (bits, outcome.cracks.iter().map(|c| c.bond).collect::<Vec<_>>())
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(7));
    }

    #[test]
    fn neighbourhoods_and_equilibria_follow_the_broken_bonds() {
        let (position, pairs) = bar([7, 4, 4]);
        let n = position.len();
        let section = BeamSection::new(1e9, 0.3).unwrap();
        let lattice = Lattice::new(&position, &pairs, section, 0.5).unwrap();
        let mut supports = LatticeSupports::none(n);
        (0..16).for_each(|i| supports.set(i, 0, 0.0));
        (n as u32 - 16..n as u32).for_each(|i| supports.set(i, 0, 1e-3));
        let tolerance = Tolerance { residual: 1e-10, ..Tolerance::default() };
        let guess = vec![[0.0; 6]; n];
        for level in [Level::Own, Level::Neighbours, Level::Second] {
            let radius: Vec<f64> = (0..n).map(|i| 0.4 + 0.1 * (i as f64).sin().abs()).collect();
            let mut graph = BondGraph::new(n, &pairs);
            let mut body = StaticBody::new(lattice.clone(), supports.clone(), &guess, tolerance).unwrap();
            let mut search = FailureSearch::new(principal(level), &graph, &radius, 0.6).unwrap();
            for bond in (0..pairs.len() as u32).filter(|b| b % 5 == 2) {
                graph.break_bond(bond);
                body.break_bond(bond);
                search.bond_broken(bond, &graph);
            }
            body.solve().unwrap();
            search.search(&body, &graph, f64::INFINITY);
            // From scratch, with the bonds that are left.
            let left: Vec<[u32; 2]> = (0..pairs.len()).filter(|b| b % 5 != 2).map(|b| pairs[b]).collect();
            let fresh = Lattice::new(&position, &left, section, 0.5).unwrap();
            let body2 = StaticBody::new(fresh, supports.clone(), &guess, tolerance).unwrap();
            let graph2 = BondGraph::new(n, &left);
            let mut search2 = FailureSearch::new(principal(level), &graph2, &radius, 0.6).unwrap();
            search2.search(&body2, &graph2, f64::INFINITY);
            assert!((body.energy() / body2.energy() - 1.0).abs() < 1e-8);
            let size = search2.stress().iter().map(|s| s.0[0].abs()).fold(0.0, f64::max);
            for (a, b) in search.stress().iter().zip(search2.stress()) {
                assert!((*a - *b).0.iter().all(|d| d.abs() < 1e-6 * size), "{a:?} {b:?}");
            }
            // The virials of a bar under tension add up to its load times its length.
            let mut virials = vec![Sym3::ZERO; n];
            body.virials(&mut virials);
            let virial: f64 = virials.iter().map(|d| d.0[0]).sum();
            let reach = |i: u32| body.reaction(i)[0] * position[i as usize].x;
            let held: f64 = (0..16).chain(n as u32 - 16..n as u32).map(reach).sum();
            assert!((virial / held - 1.0).abs() < 1e-6, "{virial} {held}");
        }
    }

    /// Statically determinate reactions do not feel that the load of a loose particle has gone on to the nearest one.
    #[test]
    fn the_load_of_a_loose_particle_goes_on_with_its_moment() {
        let (position, pairs) = bar([5, 3, 3]);
        let n = position.len();
        let lattice = Lattice::new(&position, &pairs, BeamSection::new(1e9, 0.3).unwrap(), 0.5).unwrap();
        let mut supports = LatticeSupports::none(n);
        (0..9).chain(n - 9..n).for_each(|i| supports.set(i as u32, 0, 0.0));
        // The middle of the bar and the particle beside it along y.
        let (across, beside) = (22u32, 25u32);
        [1, 2].into_iter().for_each(|axis| supports.set(across, axis, 0.0));
        supports.set(beside, 2, 0.0);
        // A corner, which a support holds along x alone.
        let loose = 0;
        let mut loads = vec![[0.0; 6]; n];
        loads[loose] = [0.0, 2e3, 1e3, 0.0, 0.0, 0.0];
        let tolerance = Tolerance { residual: 1e-8, ..Tolerance::default() };
        let mut body = StaticBody::under_loads(lattice, supports, &loads, &vec![[0.0; 6]; n], tolerance).unwrap();
        let reactions =
            |body: &StaticBody| [body.reaction(across)[1], body.reaction(across)[2], body.reaction(beside)[2]];
        let before = reactions(&body);
        assert!((before[0] + 2e3).abs() < 1e-3 && (before[1] + before[2] + 1e3).abs() < 1e-3, "{before:?}");
        let bonds = (0u32..).zip(&pairs).filter(|(_, pair)| pair.contains(&(loose as u32)));
        bonds.for_each(|(bond, _)| body.break_bond(bond));
        assert!(body.clone().solve().is_err());
        body.hand_over(loose, |i| i != loose);
        body.solve().unwrap();
        let after = reactions(&body);
        assert!(before.iter().zip(after).all(|(before, after)| (before - after).abs() < 1.0), "{before:?} {after:?}");
        assert!((body.share_of_loads(std::iter::empty()) - 1.0).abs() < 1e-12);
    }
}
