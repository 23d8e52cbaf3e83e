//! Spheres on spheres, through time.

use std::ops::Range;

use fractum_kernels::contact::{ContactLaw, PairMotion};
use fractum_math::{Mat3, Vec3, Work};
use rayon::prelude::*;

use crate::broad_phase::close_pairs;
use crate::periodic::{Images, PeriodicCell};
use crate::touch::Spheres;

/// Pairs handled as one piece of parallel work.
const BLOCK: usize = 1024;
/// Spheres whose contacts are summed before those of others, by the first spheres of the pairs.
pub const SUMMED_SPHERES: usize = 1024;

/// Contacts among the spheres of one population, with their memories.
///
/// The list of near pairs is renewed when a sphere has moved by half the skin. Forces are the same bits for any number
/// of threads: each sphere sums its pairs in their order.
#[derive(Clone, Debug)]
pub struct SphereContacts<L: ContactLaw> {
    skin: f64,
    /// Gap across which laws act at most [m].
    reach: f64,
    searched_at: Vec<Vec3>,
    /// Near pairs, ascending.
    pairs: Vec<[u32; 2]>,
    laws: Vec<L>,
    memories: Vec<L::Memory>,
    /// Whether each pair touched at the last step.
    touching: Vec<bool>,
    /// Forces of the pairs, where more than one thread finds them or someone asks for them.
    loads: Vec<PairLoad>,
    keeps_loads: bool,
    /// Pairs of each sphere, ascending: offsets and values.
    starts: Vec<u32>,
    pairs_of: Vec<u32>,
    /// Energies of the pairs by their first spheres, block by block.
    works: Vec<Work>,
    /// Pairs of which only the second sphere is in a range, where forces on that are wanted.
    cut: Option<(Range<usize>, Vec<u32>)>,
    /// Images in which pairs meet, in a box that repeats.
    images: Option<Box<Images>>,
}

/// Force of a pair and its energies.
#[derive(Clone, Copy, Debug, Default)]
struct PairLoad {
    /// Force on j [N].
    force: Vec3,
    /// Moments on i and on j [N m].
    moments: [Vec3; 2],
    work: Work,
}

impl<L: ContactLaw> SphereContacts<L> {
    /// No contacts yet.
    ///
    /// - `skin` [m] > 0: gap up to which a pair is near; a fraction of the smallest radius
    pub fn new(skin: f64) -> Self {
        SphereContacts {
            skin,
            reach: 0.0,
            searched_at: Vec::new(),
            pairs: Vec::new(),
            laws: Vec::new(),
            memories: Vec::new(),
            touching: Vec::new(),
            loads: Vec::new(),
            keeps_loads: false,
            starts: Vec::new(),
            pairs_of: Vec::new(),
            works: Vec::new(),
            cut: None,
            images: None,
        }
    }

    /// The same in a box that repeats. Its sides must be apart by more than twice the distance at which two spheres are near.
    pub fn within(self, cell: PeriodicCell) -> Self {
        SphereContacts { images: Some(Box::new(Images::new(cell))), keeps_loads: true, ..self }
    }

    /// Takes the box as it is now.
    pub fn set_cell(&mut self, cell: &PeriodicCell) {
        self.images.iter_mut().for_each(|images| images.cell = *cell);
    }

    /// The same for laws that act across gaps up to `reach` [m].
    pub fn with_reach(self, reach: f64) -> Self {
        SphereContacts { reach, ..self }
    }

    /// Renews the list of near pairs if the skin is used up; true if it did.
    ///
    /// - `law`: law of two spheres; `None` if they never touch (bonded ones)
    pub fn search(&mut self, spheres: &Spheres, law: impl Fn(u32, u32) -> Option<L> + Sync) -> bool {
        let is_due = self.is_used_up(spheres, 0..spheres.position.len());
        if is_due {
            self.renew(spheres, law);
        }
        is_due
    }

    /// Whether the skin is used up, by the way of some of the spheres.
    pub fn is_used_up(&self, spheres: &Spheres, range: Range<usize>) -> bool {
        if let Some(images) = &self.images {
            let widest = spheres.radius.iter().fold(0.0f64, |a, &b| a.max(b));
            let (left, carry) = images.left(2.0 * widest + self.reach, self.skin);
            let corner = images.cell.corner;
            let moved = |(x, at): (&Vec3, &Vec3)| (x - corner - carry * (at - corner)).norm_squared() > left * left;
            return left < 0.0
                || self.searched_at.len() != spheres.position.len()
                || spheres.position[range.clone()].iter().zip(&self.searched_at[range]).any(moved);
        }
        let limit = 0.25 * self.skin * self.skin;
        let moved = |(x, at): (&Vec3, &Vec3)| (x - at).norm_squared() > limit;
        self.searched_at.len() != spheres.position.len()
            || spheres.position[range.clone()].iter().zip(&self.searched_at[range]).any(moved)
    }

    /// Renews the list of near pairs.
    ///
    /// - `law`: as in [`SphereContacts::search`]
    pub fn renew(&mut self, spheres: &Spheres, law: impl Fn(u32, u32) -> Option<L> + Sync) {
        self.searched_at.clear();
        self.searched_at.extend_from_slice(spheres.position);
        let skin = self.skin + self.reach;
        let near = match &mut self.images {
            Some(images) => images.close_pairs(spheres.position, spheres.radius, skin),
            None => close_pairs(spheres.position, spheres.radius, skin),
        };
        let found: Vec<([u32; 2], L)> =
            near.into_par_iter().filter_map(|[i, j]| law(i, j).map(|law| ([i, j], law))).collect();
        let old = std::mem::take(&mut self.pairs);
        let (old_memories, old_touching) = (std::mem::take(&mut self.memories), std::mem::take(&mut self.touching));
        let mut place = 0;
        for (pair, _) in &found {
            while old.get(place).is_some_and(|p| p < pair) {
                place += 1;
            }
            let known = old.get(place) == Some(pair);
            self.memories.push(if known { old_memories[place] } else { L::Memory::default() });
            self.touching.push(known && old_touching[place]);
        }
        (self.pairs, self.laws) = found.into_iter().unzip();
        if let Some(images) = &mut self.images {
            images.note(self.pairs.iter().copied(), spheres.position);
        }
        self.index(spheres.position.len());
    }

    /// Has the next search renew the list of near pairs, since radii have changed.
    pub fn look_again(&mut self) {
        self.searched_at.clear();
    }

    /// Takes a sphere that was not there at a place to which no other is nearer than one and a half skins: no search is due for it.
    pub fn admit(&mut self, sphere: u32, place: &Vec3) {
        self.searched_at.get_mut(sphere as usize).into_iter().for_each(|at| *at = *place);
    }

    fn index(&mut self, spheres: usize) {
        self.starts.clear();
        self.starts.resize(spheres + 1, 0);
        for &i in self.pairs.iter().flatten() {
            self.starts[i as usize + 1] += 1;
        }
        for i in 0..spheres {
            self.starts[i + 1] += self.starts[i];
        }
        let mut next = self.starts.clone();
        self.pairs_of.clear();
        self.pairs_of.resize(2 * self.pairs.len(), 0);
        for (pair, ids) in self.pairs.iter().enumerate() {
            for &i in ids {
                self.pairs_of[next[i as usize] as usize] = pair as u32;
                next[i as usize] += 1;
            }
        }
        self.loads.clear();
        self.works.clear();
        self.works.resize(spheres.div_ceil(SUMMED_SPHERES), Work::default());
        self.cut = None;
    }

    /// Adds forces [N] and moments about the centres [N m] of all contacts.
    ///
    /// - `dt` [s]: the step that led here
    pub fn add_forces(&mut self, spheres: &Spheres, force: &mut [Vec3], moment: &mut [Vec3], dt: f64) -> Work {
        let alone = rayon::current_num_threads() == 1 || self.pairs.len() < 2 * BLOCK;
        if alone && !self.keeps_loads {
            return self.add_one_by_one(spheres, force, moment, dt);
        }
        self.add_forces_on(0..spheres.position.len(), spheres, force, moment, dt);
        self.work()
    }

    /// [`SphereContacts::add_forces`] on a range of spheres that begins and ends a block of [`SUMMED_SPHERES`], or ends with all; energies are those of
    /// the pairs whose first spheres are among them.
    pub fn add_forces_on(
        &mut self,
        range: Range<usize>,
        spheres: &Spheres,
        force: &mut [Vec3],
        moment: &mut [Vec3],
        dt: f64,
    ) {
        let own = self.pairs_from(range.start)..self.pairs_from(range.end);
        let SphereContacts { pairs, laws, memories, touching, loads, starts, pairs_of, works, cut, images, .. } = self;
        let images = images.as_deref();
        loads.resize(pairs.len(), PairLoad::default());
        let chunks = pairs[own.clone()].par_chunks(BLOCK).zip(laws[own.clone()].par_chunks(BLOCK));
        let memory = memories[own.clone()].par_chunks_mut(BLOCK).zip(touching[own.clone()].par_chunks_mut(BLOCK));
        chunks.zip(memory).zip(loads[own.clone()].par_chunks_mut(BLOCK)).enumerate().for_each(
            |(block, (((pairs, laws), (memories, touching)), loads))| {
                let first = own.start + block * BLOCK;
                for k in 0..pairs.len() {
                    let shift = images.map(|images| images.shift(first + k));
                    loads[k] = pair_load(pairs[k], &laws[k], &mut memories[k], &mut touching[k], spheres, shift, dt)
                        .unwrap_or_default();
                }
            },
        );
        if cut.as_ref().is_none_or(|(known, _)| *known != range) {
            // Their first sphere is before the range.
            let is_cut = |k: &u32| range.contains(&(pairs[*k as usize][1] as usize));
            *cut = Some((range.clone(), (0..own.start as u32).filter(is_cut).collect()));
        }
        for k in cut.iter().flat_map(|(_, pairs)| pairs).map(|&k| k as usize) {
            let shift = images.map(|images| images.shift(k));
            loads[k] = pair_load(pairs[k], &laws[k], &mut memories[k], &mut touching[k], spheres, shift, dt)
                .unwrap_or_default();
        }
        let (loads, pairs) = (&*loads, &*pairs);
        let (forces, moments) = (&mut force[range.clone()], &mut moment[range.clone()]);
        forces.par_iter_mut().zip(moments).zip(range.clone()).with_min_len(BLOCK).for_each(|((force, moment), i)| {
            for &pair in &pairs_of[starts[i] as usize..starts[i + 1] as usize] {
                let (load, second) = (&loads[pair as usize], pairs[pair as usize][1] == i as u32);
                *force += if second { load.force } else { -load.force };
                *moment += load.moments[usize::from(second)];
            }
        });
        works[range.start.div_ceil(SUMMED_SPHERES)..range.end.div_ceil(SUMMED_SPHERES)].fill(Work::default());
        pairs[own.clone()]
            .iter()
            .zip(&loads[own])
            .for_each(|(pair, load)| works[pair[0] as usize / SUMMED_SPHERES] += load.work);
    }

    /// First pair whose first sphere is at or behind one.
    fn pairs_from(&self, sphere: usize) -> usize {
        self.pairs.partition_point(|pair| (pair[0] as usize) < sphere)
    }

    /// Energies at the last step, of the pairs whose first spheres are in each block of [`SUMMED_SPHERES`].
    pub fn works(&mut self) -> &mut [Work] {
        &mut self.works
    }

    /// Energies of all contacts at the last step.
    pub fn work(&self) -> Work {
        self.works.iter().fold(Work::default(), |mut sum, work| {
            sum += *work;
            sum
        })
    }

    /// Near pairs, ascending.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Forces of near pairs at the last step, of those whose first spheres are in a range [N].
    pub fn forces(&self, range: Range<usize>) -> impl Iterator<Item = Vec3> {
        let own = self.pairs_from(range.start)..self.pairs_from(range.end);
        own.map(|k| self.loads.get(k).map_or_else(Vec3::zeros, |load| load.force))
    }

    /// Puts the forces of all near pairs, in their order.
    pub fn put_forces(&mut self, all: impl Iterator<Item = Vec3>) {
        self.loads.iter_mut().zip(all).for_each(|(load, force)| load.force = force);
    }

    /// Whether each near pair touches, and what it remembers; of the pairs whose first spheres are in a range.
    pub fn memories(&self, range: Range<usize>) -> Vec<(bool, L::Memory)> {
        let own = self.pairs_from(range.start)..self.pairs_from(range.end);
        own.map(|k| (self.touching[k], self.memories[k])).collect()
    }

    /// Puts what all near pairs remember, in their order.
    pub fn put_memories(&mut self, all: impl Iterator<Item = (bool, L::Memory)>) {
        for ((touching, own), (touches, memory)) in self.touching.iter_mut().zip(&mut self.memories).zip(all) {
            (*touching, *own) = (touches, memory);
        }
    }

    /// Has the forces of the pairs kept from step to step; of the same bits, and a little slower on one thread.
    pub fn keep_loads(&mut self) {
        self.keeps_loads = true;
    }

    /// Pairs with the force on the second sphere at the last step [N], zero where they do not touch; none unless they
    /// [are kept](SphereContacts::keep_loads).
    pub fn loads(&self) -> impl Iterator<Item = ([u32; 2], Vec3)> {
        self.pairs.iter().zip(&self.loads).map(|(pair, load)| (*pair, load.force))
    }

    fn add_one_by_one(&mut self, spheres: &Spheres, force: &mut [Vec3], moment: &mut [Vec3], dt: f64) -> Work {
        // A box that repeats keeps the loads.
        let SphereContacts { pairs, laws, memories, touching, works, .. } = self;
        works.fill(Work::default());
        for k in 0..pairs.len() {
            let load = pair_load(pairs[k], &laws[k], &mut memories[k], &mut touching[k], spheres, None, dt);
            if let Some(load) = load {
                let [i, j] = pairs[k].map(|id| id as usize);
                force[i] -= load.force;
                force[j] += load.force;
                moment[i] += load.moments[0];
                moment[j] += load.moments[1];
                works[i / SUMMED_SPHERES] += load.work;
            }
        }
        self.work()
    }

    /// Takes the pairs that overlap and for which `which` holds as they stand, without any force; they touch no nearer than
    /// now until they have parted. Asks for a [`search`](SphereContacts::search) before.
    pub fn accept_initial_overlap(&mut self, spheres: &Spheres, which: impl Fn(u32, u32) -> bool) {
        for k in 0..self.pairs.len() {
            let [i, j] = self.pairs[k];
            let overlap = self.overlap(k, spheres);
            if overlap > 0.0 && which(i, j) {
                self.memories[k] = L::Memory::default();
                L::add_overlap_offset(&mut self.memories[k], overlap);
                self.touching[k] = true;
            }
        }
    }

    /// Pairs that touched at the last step, with their laws.
    pub fn laws_touching(&self) -> impl Iterator<Item = ([u32; 2], &L)> {
        self.pairs
            .iter()
            .zip(&self.laws)
            .zip(&self.touching)
            .filter(|(_, touching)| **touching)
            .map(|(p, _)| (*p.0, p.1))
    }

    /// Pairs that touched at the last step, with what they remember and from the first centre to the second one, or to its image [m].
    pub fn memories_touching<'a>(
        &'a self,
        spheres: &'a Spheres,
    ) -> impl Iterator<Item = ([u32; 2], &'a L::Memory, Vec3)> {
        let touching = (0..self.pairs.len()).filter(|&k| self.touching[k]);
        touching.map(|k| (self.pairs[k], &self.memories[k], self.apart(k, spheres)))
    }

    /// Sums over the pairs of the last step, with forces f on the second spheres [N]: Σ f ⊗ n with the edges n of the box
    /// between a sphere and its image [N], and Σ f ⊗ r with the vectors r between the centres [N m]; none without such a box.
    pub fn sums_through_box(&self, spheres: &Spheres) -> Option<[Mat3; 2]> {
        let images = self.images.as_ref()?;
        let (mut through, mut virial) = (Mat3::zeros(), Mat3::zeros());
        for (k, load) in self.loads.iter().enumerate().filter(|(_, load)| load.force != Vec3::zeros()) {
            let force = load.force;
            virial += force * self.apart(k, spheres).transpose();
            if images.of_pairs[k] != [0; 3] {
                through += force * images.edges_between(k).transpose();
            }
        }
        Some([through, virial])
    }

    /// Pairs that touched at the last step.
    pub fn touching(&self) -> impl Iterator<Item = [u32; 2]> {
        self.pairs.iter().zip(&self.touching).filter(|(_, touching)| **touching).map(|(pair, _)| *pair)
    }

    /// Near pairs that overlap where the spheres are now, with their depths [m].
    pub fn overlaps<'a>(&'a self, spheres: &'a Spheres) -> impl Iterator<Item = ([u32; 2], f64)> + 'a {
        (0..self.pairs.len()).map(|k| (self.pairs[k], self.overlap(k, spheres))).filter(|(_, depth)| *depth > 0.0)
    }

    /// From the centre of the first sphere of a near pair to that of the second, or of its image [m].
    fn apart(&self, pair: usize, spheres: &Spheres) -> Vec3 {
        let [i, j] = self.pairs[pair].map(|id| id as usize);
        let apart = spheres.position[j] - spheres.position[i];
        self.images.as_ref().map_or(apart, |images| apart + images.shift(pair)[0])
    }

    fn overlap(&self, pair: usize, spheres: &Spheres) -> f64 {
        let [i, j] = self.pairs[pair].map(|id| id as usize);
        spheres.radius[i] + spheres.radius[j] - self.apart(pair, spheres).norm()
    }

    /// Pairs that touched at the last step, with the depth to which each is pressed together now [m]: its overlap beyond what
    /// was accepted at the start.
    pub fn pressed<'a>(&'a self, spheres: &'a Spheres) -> impl Iterator<Item = ([u32; 2], f64)> + 'a {
        let depth = |k: usize| self.overlap(k, spheres) - L::overlap_offset(&self.memories[k]);
        (0..self.pairs.len()).filter(|&k| self.touching[k]).map(move |k| (self.pairs[k], depth(k)))
    }

    /// Contacts that remember something, for a checkpoint.
    pub fn state(&self) -> Vec<([u32; 2], L::Memory)> {
        let known = (0..self.pairs.len()).filter(|&k| self.touching[k]);
        known.map(|k| (self.pairs[k], self.memories[k])).collect()
    }

    /// Puts saved contacts back; the next search renews the list of pairs.
    pub fn restore(&mut self, state: Vec<([u32; 2], L::Memory)>) {
        self.searched_at.clear();
        self.touching = vec![true; state.len()];
        (self.pairs, self.memories) = state.into_iter().unzip();
    }
}

/// Force of a pair; `None` if it neither touches nor did so at the last step.
#[inline]
fn pair_load<L: ContactLaw>(
    [i, j]: [u32; 2],
    law: &L,
    memory: &mut L::Memory,
    touching: &mut bool,
    spheres: &Spheres,
    shift: Option<[Vec3; 2]>,
    dt: f64,
) -> Option<PairLoad> {
    let (i, j) = (i as usize, j as usize);
    let mut apart = spheres.position[j] - spheres.position[i];
    if let Some([offset, _]) = shift {
        apart += offset;
    }
    let reach = spheres.radius[i] + spheres.radius[j];
    let square = apart.norm_squared();
    let felt = reach + law.reach();
    let touches = square < felt * felt;
    if !touches && !*touching {
        return None;
    }
    *touching = touches;
    let distance = square.sqrt();
    let normal = if distance > 0.0 { apart / distance } else { Vec3::x() };
    // The contact divides the distance in the ratio of the radii.
    let arm = distance / reach;
    let (arm_i, arm_j) = (arm * spheres.radius[i], arm * spheres.radius[j]);
    let turning = (spheres.spin[i] * arm_i + spheres.spin[j] * arm_j).cross(&normal);
    let mut velocity = spheres.velocity[j] - spheres.velocity[i] - turning;
    if let Some([_, of_image]) = shift {
        velocity += of_image;
    }
    let spin = spheres.spin[j] - spheres.spin[i];
    let motion = PairMotion { normal, overlap: reach - distance, velocity, spin, dt };
    let force = law.force(&motion, memory);
    let twist = normal.cross(&force.on_second);
    let couple = force.couple_on_second;
    Some(PairLoad {
        force: force.on_second,
        moments: [twist * -arm_i - couple, twist * -arm_j + couple],
        work: force.work(),
    })
}
