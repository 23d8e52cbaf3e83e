//! The particles that one of several ranks moves.
//!
//! A rank has a run of particles, in the order of their numbers, and the bonds whose first particle is one of them. It gets what
//! the bonds of others sum for its particles, moves these, and sends their motion to ranks whose bonds reach them: such a rank
//! keeps *ghosts* of them. What needs a particle beside bonds and contacts among particles (supports, loads, rigid bodies, ties) is done by all
//! ranks alike: they receive the forces on it, and all move it. The rest is gathered before anyone looks at it, and out of date between.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use fractum_math::{HalfSteps, Rotation, Vec3};
use fractum_parallel::{Exchange, Exchanged, Gathered, rank_of, runs_by_weight, runs_of};
use nalgebra::Quaternion;

use super::{BLOCK, Particles, PastForces, SHARED};

/// The share of a rank.
#[derive(Clone, Debug)]
pub struct ParticleSubdomain {
    exchange: Arc<dyn Exchange>,
    /// First particle of each rank, and the end; each begins a block of bonds.
    first: Vec<usize>,
    /// Particles of others that bonds, contacts and strangers of this rank reach, and the other way round.
    near: [Near; 3],
    /// Those whose motion is sent: all of these but what every rank moves.
    ghosts: Exchanged<u32>,
    /// Particles that every rank moves.
    everywhere: Gathered,
    is_everywhere: Vec<bool>,
    /// Runs of those of others among them.
    of_others: Vec<Range<usize>>,
    /// The motion of all particles is the present one.
    is_whole: bool,
    own: Vec<f64>,
    all: Vec<f64>,
}

/// How much a rank has to do and to send in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ParticleSubdomainSize {
    /// Particles of its own.
    pub particles: usize,
    /// Particles of others whose motion it receives.
    pub ghosts: usize,
    /// Particles that every rank moves.
    pub everywhere: usize,
}

/// Particles by the ranks beside: own ones that another rank looks at, and those of it that this one looks at.
type Near = BTreeMap<usize, [BTreeSet<u32>; 2]>;

/// Pairs of particles without a bond that may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NearPairs {
    /// Contacts of loose particles and between bodies.
    Contacts = 1,
    /// Strangers of a broken body, see [`Fracture`](crate::Fracture).
    Strangers = 2,
}

/// Place, orientation, velocity and spin.
const MOTION: usize = 13;
/// Force and moment.
const LOAD: usize = 6;

impl ParticleSubdomain {
    /// Particles that a rank has as a whole.
    pub const BLOCK: usize = SHARED;

    /// The share of a rank. Every rank must have the same particles in the same state.
    ///
    /// - `pairs`: the particles of all bonds
    pub fn new(exchange: Arc<dyn Exchange>, count: usize, pairs: impl Iterator<Item = [u32; 2]> + Clone) -> Self {
        let mut weights: Vec<usize> = (0..count).step_by(SHARED).map(|start| SHARED.min(count - start)).collect();
        pairs.clone().for_each(|[first, _]| weights[first as usize / SHARED] += 1);
        let blocks = runs_by_weight(&weights, exchange.size());
        let first: Vec<usize> = blocks.iter().map(|block| (block * SHARED).min(count)).collect();
        let mut bonded = Near::new();
        add_near(&mut bonded, &first, exchange.rank(), pairs);
        ParticleSubdomain {
            ghosts: swapped([&bonded], |_| true),
            near: [bonded, Near::new(), Near::new()],
            everywhere: Gathered::new(vec![Vec::new(); exchange.size()]),
            is_everywhere: vec![false; count],
            of_others: Vec::new(),
            is_whole: true,
            exchange,
            first,
            own: Vec::new(),
            all: Vec::new(),
        }
    }

    /// What joins the ranks.
    pub fn exchange(&self) -> &Arc<dyn Exchange> {
        &self.exchange
    }

    /// First particle of each rank, and the end.
    pub(crate) fn first(&self) -> &[usize] {
        &self.first
    }

    /// Particles of this rank.
    pub fn own(&self) -> Range<usize> {
        let rank = self.exchange.rank();
        self.first[rank]..self.first[rank + 1]
    }

    /// What this rank does of the work.
    pub fn share(&self) -> ParticleSubdomainSize {
        ParticleSubdomainSize {
            particles: self.own().len(),
            ghosts: self.ghosts.received().count(),
            everywhere: self.is_everywhere.iter().filter(|is| **is).count(),
        }
    }

    /// Tells all ranks motion and forces of particles, and has every rank move them from now on. All ranks must name the same ones.
    pub fn follow(&mut self, new: &[u32], particles: &mut Particles, past: &mut PastForces) {
        let new: BTreeSet<u32> = new.iter().copied().filter(|&i| !self.is_everywhere[i as usize]).collect();
        if new.is_empty() {
            return;
        }
        let mut of_rank = vec![Vec::new(); self.exchange.size()];
        for &i in &new {
            self.is_everywhere[i as usize] = true;
            of_rank[rank_of(&self.first, i as usize)].push(i);
        }
        let mut gathered = Gathered::new(of_rank);
        if !self.is_whole {
            gathered.gather(&*self.exchange, particles, motion, put_motion);
        }
        gathered.gather(&*self.exchange, particles, load, put_load);
        if !past.force.is_empty() {
            gathered.gather(&*self.exchange, past, past_load, put_past_load);
        }
        self.everywhere.append(&gathered);
        let own = self.own();
        let is_others = |(i, is): (usize, &bool)| *is && !own.contains(&i);
        self.of_others = runs_of(&self.is_everywhere.iter().enumerate().map(is_others).collect::<Vec<_>>());
        self.choose_ghosts();
    }

    /// Tells the motion of particles that may touch, too, from now on, in the place of what was named before. All ranks must name the
    /// same pairs, when the motion of all particles is up to date.
    pub fn set_near(&mut self, which: NearPairs, pairs: impl Iterator<Item = [u32; 2]>) {
        let near = &mut self.near[which as usize];
        near.clear();
        add_near(near, &self.first, self.exchange.rank(), pairs);
        self.choose_ghosts();
    }

    fn choose_ghosts(&mut self) {
        self.ghosts = swapped(&self.near, |i| !self.is_everywhere[i as usize]);
    }

    /// Tells all ranks the forces on the particles that every rank moves, once each has those on its own.
    pub fn exchange_forces(&mut self, particles: &mut Particles) {
        self.everywhere.gather(&*self.exchange, particles, load, put_load);
    }

    /// Particles of other ranks that this one moves as well, in runs.
    pub(super) fn of_others(&self) -> &[Range<usize>] {
        &self.of_others
    }

    /// All particles that this rank moves, in runs.
    pub fn moved(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        std::iter::once(self.own()).chain(self.of_others.iter().cloned())
    }

    /// Tells the motion of own particles to the ranks that have ghosts of them.
    pub fn exchange_ghosts(&mut self, particles: &mut Particles) {
        let get = |particles: &Particles, i: u32| motion(particles, i as usize);
        let put = |particles: &mut Particles, i: u32, from| put_motion(particles, i as usize, from);
        self.ghosts.exchange(&*self.exchange, particles, get, put);
        self.forget_others();
    }

    /// Takes note that the motion of particles that this rank does not move is no longer the present one.
    pub fn forget_others(&mut self) {
        self.is_whole = false;
    }

    /// Brings the motion of all particles up to date on every rank, and what it compares forces with. All ranks must call it.
    pub fn gather(&mut self, particles: &mut Particles, past: &mut PastForces) {
        if std::mem::replace(&mut self.is_whole, true) {
            return;
        }
        self.gather_values(particles, motion, put_motion);
        if !past.force.is_empty() {
            self.gather_values(past, past_load, put_past_load);
        }
    }

    /// Brings the forces on all particles up to date on every rank. All ranks must call it.
    pub fn gather_forces(&mut self, particles: &mut Particles) {
        self.gather_values(particles, load, put_load);
    }

    fn gather_values<const N: usize, S>(
        &mut self,
        values: &mut S,
        get: impl Fn(&S, usize) -> [f64; N],
        put: impl Fn(&mut S, usize, [f64; N]),
    ) {
        let range = self.own();
        let ParticleSubdomain { exchange, first, own, all, .. } = self;
        own.clear();
        own.extend(range.clone().flat_map(|i| get(values, i)));
        let counts: Vec<usize> = first.windows(2).map(|first| N * (first[1] - first[0])).collect();
        all.resize(counts.iter().sum(), 0.0);
        exchange.gather(own, &counts, all);
        for (i, from) in all.as_chunks().0.iter().enumerate().filter(|(i, _)| !range.contains(i)) {
            put(values, i, *from);
        }
    }

    /// Gives every rank the values of all blocks of particles, once each has those of its own.
    ///
    /// - `size`: particles of a block, a power of two of at most 2048
    pub fn gather_blocks<const N: usize>(&self, size: usize, values: &mut [[f64; N]]) {
        let blocks = |first: usize| first.div_ceil(size);
        let counts: Vec<usize> = self.first.windows(2).map(|first| N * (blocks(first[1]) - blocks(first[0]))).collect();
        let Range { start, end } = self.own();
        let own: Vec<f64> = values[blocks(start)..blocks(end)].iter().flatten().copied().collect();
        let mut all = vec![0.0; N * values.len()];
        self.exchange.gather(&own, &counts, &mut all);
        values.iter_mut().zip(all.as_chunks().0).for_each(|(value, from)| *value = *from);
    }

    /// The same of what a step has done with each block, by [`Particles::kick_and_drift`].
    pub(super) fn gather_work(&self, partial: &mut [HalfSteps]) {
        let mut all: Vec<[f64; 4]> = partial.iter().map(HalfSteps::of_motion).collect();
        self.gather_blocks(BLOCK, &mut all);
        partial.iter_mut().zip(all).for_each(|(work, numbers)| work.set_motion(numbers));
    }
}

/// Adds the particles of pairs that two ranks have.
fn add_near(near: &mut Near, first: &[usize], me: usize, pairs: impl Iterator<Item = [u32; 2]>) {
    for pair in pairs {
        let ranks = pair.map(|i| rank_of(first, i as usize));
        for (own, other) in [(0, 1), (1, 0)] {
            if ranks[own] == me && ranks[other] != me {
                let [send, receive] = near.entry(ranks[other]).or_default();
                send.insert(pair[own]);
                receive.insert(pair[other]);
            }
        }
    }
}

fn swapped<'a>(all: impl IntoIterator<Item = &'a Near>, is_sent: impl Fn(u32) -> bool) -> Exchanged<u32> {
    let mut between = BTreeMap::<usize, [BTreeSet<u32>; 2]>::new();
    for (&rank, sets) in all.into_iter().flatten() {
        let gathered = between.entry(rank).or_default();
        (0..2).for_each(|k| gathered[k].extend(sets[k].iter().copied().filter(|&i| is_sent(i))));
    }
    Exchanged::of_sets(between)
}

fn motion(particles: &Particles, i: usize) -> [f64; MOTION] {
    let ([x, y, z], [u, v, w]) = (particles.position[i].into(), particles.velocity[i].into());
    let ([a, b, c, d], [p, q, r]) = (particles.orientation[i].coords.into(), particles.spin[i].into());
    [x, y, z, u, v, w, a, b, c, d, p, q, r]
}

fn put_motion(particles: &mut Particles, i: usize, [x, y, z, u, v, w, a, b, c, d, p, q, r]: [f64; MOTION]) {
    particles.position[i] = Vec3::new(x, y, z);
    particles.velocity[i] = Vec3::new(u, v, w);
    particles.orientation[i] = Rotation::new_unchecked(Quaternion::from_vector([a, b, c, d].into()));
    particles.spin[i] = Vec3::new(p, q, r);
}

fn load(particles: &Particles, i: usize) -> [f64; LOAD] {
    both(particles.force[i], particles.moment[i])
}

fn put_load(particles: &mut Particles, i: usize, [x, y, z, a, b, c]: [f64; LOAD]) {
    (particles.force[i], particles.moment[i]) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
}

fn past_load(past: &PastForces, i: usize) -> [f64; LOAD] {
    both(past.force[i], past.moment[i])
}

fn put_past_load(past: &mut PastForces, i: usize, [x, y, z, a, b, c]: [f64; LOAD]) {
    (past.force[i], past.moment[i]) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
}

fn both(force: Vec3, moment: Vec3) -> [f64; LOAD] {
    [force.x, force.y, force.z, moment.x, moment.y, moment.z]
}
