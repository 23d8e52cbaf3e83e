use std::fmt;
use std::sync::Arc;

use fractum_math::{HalfSteps, Vec3};

use super::{DrivenPoints, Points};
use crate::error::SceneError;
use crate::time_function::TimeFunction;

/// How a support moves.
#[derive(Clone)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// By a velocity [m/s].
    Velocity(TimeFunction),
    /// By a displacement [m].
    Displacement(TimeFunction),
}

/// One axis of a set of points, prescribed.
#[derive(Clone)]
pub struct Support {
    /// The user's name for it.
    pub name: String,
    /// Nodes of solids, or particles.
    pub points: Vec<u32>,
    /// Axis 0, 1 or 2.
    pub axis: usize,
    /// How it moves.
    pub motion: Motion,
    /// Whether its points take short steps, where some do.
    pub is_fine: bool,
    /// Velocity of each point before the kick [m/s].
    before: Vec<f64>,
    /// Force of the support on each point at tⁿ [N].
    reaction: Vec<f64>,
}

impl Support {
    /// A support of `points` along `axis` (0, 1, 2).
    pub fn new(name: &str, points: Vec<u32>, axis: usize, motion: Motion) -> Self {
        let zeros = vec![0.0; points.len()];
        Support { name: name.to_owned(), points, axis, motion, is_fine: false, before: zeros.clone(), reaction: zeros }
    }
}

impl fmt::Debug for Support {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Support({} along {})", self.name, self.axis)
    }
}

/// The kick that prescribed motion takes the place of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kick {
    /// When it is [s].
    pub(crate) time: f64,
    /// Step before it [s].
    pub(crate) dt_before: f64,
    /// Step after it [s].
    pub(crate) dt_after: f64,
    /// Only the points with short steps, or those with long ones; none where all take the same.
    pub(crate) is_fine: Option<bool>,
    /// Whether it is at tⁿ, the instant of all results.
    pub(crate) is_first: bool,
    /// Whether nothing has moved before: what then jumps to its velocity takes an impulse, which is no force to report.
    pub(crate) begins: bool,
}

/// All supports of one population: the nodes of solids, or the particles.
#[derive(Clone, Debug, Default)]
pub struct Supports {
    sets: Vec<Support>,
    /// Bit a is set where axis a of a point is prescribed; empty without supports.
    held: Arc<[u8]>,
}

impl Supports {
    /// Collects supports; points that two fixed supports share are kept once.
    ///
    /// # Errors
    /// [`SceneError::ContradictorySupports`] if a degree of freedom is prescribed in two ways.
    pub fn new(mut sets: Vec<Support>, reference: &[Vec3]) -> Result<Self, SceneError> {
        let mut owner: Vec<[u32; 3]> = vec![[u32::MAX; 3]; if sets.is_empty() { 0 } else { reference.len() }];
        for index in 0..sets.len() {
            let axis = sets[index].axis;
            let mut kept = Vec::with_capacity(sets[index].points.len());
            for &point in &sets[index].points {
                let place = &mut owner[point as usize][axis];
                if *place == u32::MAX {
                    *place = index as u32;
                    kept.push(point);
                    continue;
                }
                let first = &sets[*place as usize];
                if !(matches!(first.motion, Motion::Fixed) && matches!(sets[index].motion, Motion::Fixed)) {
                    let p = reference[point as usize];
                    return Err(SceneError::ContradictorySupports {
                        first: first.name.clone(),
                        second: sets[index].name.clone(),
                        axis: ['x', 'y', 'z'][axis],
                        x: p.x,
                        y: p.y,
                        z: p.z,
                    });
                }
            }
            let set = &mut sets[index];
            *set = Support { is_fine: set.is_fine, ..Support::new(&set.name, kept, axis, set.motion.clone()) };
        }
        let bits = |axes: &[u32; 3]| (0..3).filter(|&a| axes[a] != u32::MAX).fold(0u8, |bits, a| bits | 1 << a);
        let held = owner.iter().map(bits).collect();
        Ok(Supports { sets, held })
    }

    /// Bit a of a point is set where its axis a is prescribed; empty without supports.
    pub fn held(&self) -> &[u8] {
        &self.held
    }

    /// Points that do not merely rest: the work of their supports is summed in every step.
    pub(crate) fn driven(&self) -> impl Iterator<Item = u32> + '_ {
        let driven = self.sets.iter().filter(|set| !matches!(set.motion, Motion::Fixed));
        driven.flat_map(|set| set.points.iter().copied())
    }

    /// Holds points that have left on all axes, of so many in all.
    pub(crate) fn hold(&mut self, points: &[u32], count: usize) {
        if points.is_empty() {
            return;
        }
        let mut held = self.held.to_vec();
        held.resize(count, 0);
        points.iter().for_each(|&point| held[point as usize] = 0b111);
        self.held = held.into();
    }

    pub(crate) fn shared_held(&self) -> Arc<[u8]> {
        self.held.clone()
    }

    /// Degrees of freedom that are prescribed.
    pub fn count(&self) -> usize {
        self.sets.iter().map(|s| s.points.len()).sum()
    }

    /// Places (set, entry, axis) of the prescribed degrees of freedom of these points, which are ascending.
    pub fn places(&self, points: &[u32]) -> Vec<(u32, u32, u32)> {
        let mut places = Vec::new();
        for (set, support) in self.sets.iter().enumerate() {
            for (entry, point) in support.points.iter().enumerate() {
                if points.binary_search(point).is_ok() {
                    places.push((set as u32, entry as u32, support.axis as u32));
                }
            }
        }
        places
    }

    /// The points of these places.
    pub(crate) fn points_at(&self, places: &[(u32, u32, u32)]) -> impl Iterator<Item = u32> {
        places.iter().map(|&(set, entry, _)| self.sets[set as usize].points[entry as usize])
    }

    /// Force of the supports on these places along `direction` at the last step [N].
    pub fn reaction(&self, places: &[(u32, u32, u32)], direction: &Vec3) -> f64 {
        places.iter().map(|&(s, e, a)| self.sets[s as usize].reaction[e as usize] * direction[a as usize]).sum()
    }

    /// Force of the supports on these places, each along the vector at its point, at the last step [N, times its unit].
    pub(crate) fn reaction_by(&self, places: &[(u32, u32, u32)], direction: impl Fn(usize) -> Vec3) -> f64 {
        let own = |&(s, e, a): &(u32, u32, u32)| {
            let set = &self.sets[s as usize];
            set.reaction[e as usize] * direction(set.points[e as usize] as usize)[a as usize]
        };
        places.iter().map(own).sum()
    }

    /// Writes the displacements prescribed at `time` into `displacement`; those of supports with a velocity go on from
    /// the present values at `present`.
    ///
    /// - `from`: displacements from which those of supports count, see [`Solid::initial_displacement`]
    ///
    /// [`Solid::initial_displacement`]: fractum_fem::Solid::initial_displacement
    pub(crate) fn prescribe(
        &self,
        displacement: &mut [Vec3],
        reference: &[Vec3],
        from: &[Vec3],
        [present, time]: [f64; 2],
    ) {
        for set in &self.sets {
            for &point in &set.points {
                let (value, place) = (&mut displacement[point as usize][set.axis], &reference[point as usize]);
                match &set.motion {
                    Motion::Fixed => {}
                    Motion::Displacement(u) => {
                        *value = u(time, place) + from.get(point as usize).map_or(0.0, |from| from[set.axis]);
                    }
                    Motion::Velocity(v) => *value += integral(|t| v(t, place), present, time),
                }
            }
        }
    }

    /// Point, axis and displacement at the time `end` of everything prescribed, which must move in proportion to time.
    ///
    /// # Errors
    /// [`SceneError::NotProportional`].
    pub(crate) fn proportional(&self, reference: &[Vec3], end: f64) -> Result<Vec<(u32, usize, f64)>, SceneError> {
        let mut found = Vec::new();
        for support in &self.sets {
            for &point in &support.points {
                let x = &reference[point as usize];
                let at = |share: f64| match &support.motion {
                    Motion::Fixed => 0.0,
                    // A velocity is proportional if it is constant.
                    Motion::Velocity(v) => v(share * end, x) * share * end,
                    Motion::Displacement(u) => u(share * end, x),
                };
                let whole = at(1.0);
                let proportional = |share: f64| (at(share) - share * whole).abs() <= 1e-9 * whole.abs();
                if ![0.0, 0.1, 0.25, 0.5, 0.7].into_iter().all(proportional) {
                    let name = support.name.clone();
                    return Err(SceneError::NotProportional { name, axis: ['x', 'y', 'z'][support.axis] });
                }
                found.push((point, support.axis, whole));
            }
        }
        Ok(found)
    }

    /// Forces of the supports on all points of the population at the last step [N].
    ///
    /// - `count`: number of these points
    pub fn reactions(&self, count: usize) -> Vec<Vec3> {
        let mut reactions = vec![Vec3::zeros(); count];
        for Support { points, axis, reaction, .. } in &self.sets {
            points.iter().zip(reaction).for_each(|(&point, &value)| reactions[point as usize][*axis] += value);
        }
        reactions
    }

    /// Takes the reactions of an equilibrium: force of the support on a point along an axis [N].
    pub(crate) fn set_reactions(&mut self, of: impl Fn(u32, usize) -> f64) {
        for Support { points, axis, reaction, .. } in &mut self.sets {
            for (&point, reaction) in points.iter().zip(reaction) {
                *reaction = of(point, *axis);
            }
        }
    }

    /// Takes the reactions from the sum of all other forces; a vector per point.
    pub(crate) fn take_reactions(&mut self, force: &[Vec3]) -> Vec<Vec3> {
        let mut reactions = vec![Vec3::zeros(); force.len()];
        self.set_reactions(|point, axis| -force[point as usize][axis]);
        for Support { points, axis, reaction, .. } in &self.sets {
            points.iter().zip(reaction).for_each(|(&point, &value)| reactions[point as usize][*axis] = value);
        }
        reactions
    }

    /// Keeps the velocities before the kick.
    ///
    /// - `is_fine`: as in [`Kick`]
    pub(crate) fn remember(&mut self, points: &impl Points, is_fine: Option<bool>) {
        for set in self.sets.iter_mut().filter(|set| is_fine.is_none_or(|is_fine| set.is_fine == is_fine)) {
            for (before, &point) in set.before.iter_mut().zip(&set.points) {
                *before = points.velocity(point as usize)[set.axis];
            }
        }
    }

    /// Gives the prescribed axes their motion, after the kick and drift, and finds the reactions.
    pub(crate) fn impose(&mut self, points: &mut impl DrivenPoints, kick: &Kick) -> HalfSteps {
        let Kick { time, dt_before, dt_after, is_fine, is_first, begins } = *kick;
        let mut work = HalfSteps::default();
        let dt_kick = 0.5 * (dt_before + dt_after);
        let counts = |set: &&mut Support| is_fine.is_none_or(|is_fine| set.is_fine == is_fine);
        for Support { points: set, axis, motion, before, reaction, .. } in self.sets.iter_mut().filter(counts) {
            for ((&point, &mut before), reaction) in set.iter().zip(before).zip(reaction) {
                let (i, axis) = (point as usize, *axis);
                let free = points.velocity(i)[axis];
                let place = points.reference(i);
                let velocity = match motion {
                    Motion::Fixed => 0.0,
                    Motion::Velocity(v) => v(time + 0.5 * dt_after, place),
                    Motion::Displacement(u) => {
                        let present = points.displacement(i)[axis] - free * dt_after;
                        (u(time + dt_after, place) - present) / dt_after
                    }
                };
                let change = velocity - free;
                // What changes the motion: the support, and the force that the kick has left out.
                let total = points.mass(i) * change / dt_kick;
                let force = total - points.force_left_out(i, axis);
                if is_first {
                    let jump = if begins { velocity - before } else { 0.0 };
                    *reaction = force - points.mass(i) * jump / dt_kick;
                }
                points.set_motion(i, axis, velocity, change * dt_after);
                work.before.external += 0.5 * force * before * dt_before;
                work.after.external += 0.5 * force * velocity * dt_after;
                work.before.kinetic += 0.5 * total * before * dt_before;
                // Of m v⁺ (v⁺ - Δt a), with the velocity and the acceleration that the kick gave, and as they are.
                let kinetic = |v: f64| v * (v - dt_after * (v - before) / dt_kick);
                work.after.kinetic += 0.5 * points.mass(i) * (kinetic(velocity) - kinetic(free));
            }
        }
        work
    }
}

/// Integral of a velocity by Gauss' rule of two points on 16 parts [m].
pub(crate) fn integral(velocity: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const PARTS: usize = 16;
    let width = (to - from) / PARTS as f64;
    let offset = 0.5 / 3f64.sqrt();
    let part = |k: usize| {
        let middle = from + (k as f64 + 0.5) * width;
        0.5 * width * (velocity(middle - offset * width) + velocity(middle + offset * width))
    };
    if width == 0.0 { 0.0 } else { (0..PARTS).map(part).sum() }
}
