//! Quasi-static breaking, event by event.

mod constant;
mod state;

use fractum_math::Vec3;
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
    /// See [`FailureSearch::read_at_walls`]; empty where stress is not taken at walls [m].
    pub to_wall: &'a [Vec3],
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
        search.read_at_walls(lattice.position(), what.to_wall, &graph);
        let length = |pair: &[u32; 2]| {
            let [first, second] = pair.map(|i| lattice.position()[i as usize]);
            (second - first).norm()
        };
        let area = facet_area(what.volume, what.pairs.iter().map(length));
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
                let ends = pair.map(|i| body.lattice().position()[i as usize]);
                progress.cracks.push(Crack::new(bond, pair, ends, *area, mode, energy, occasion));
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
mod tests;
