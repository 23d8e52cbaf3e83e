//! The fixed-point iteration of one step.

use fractum_fem::{DamagePoint, Seen, Solid};
use fractum_math::Vec3;
use fractum_sparse::SparseError;

use super::contact::{Also, Hold, Spring, bring_back, contact_springs, forget_brought_back, has_contacts};
use super::equilibrium::{Boundary, boundary_at, check_loose, come_apart, unbalance};
use super::{
    Control, Edges, GROWTH, ITERATIONS, MONOTONE_ITERATIONS, NO_FORCE, Response, StaticSolver, Touching, path, skew,
};
use crate::error::StepError;
use crate::scene::Scene;

/// Part of its softening over which no point of an interface goes in a step of the load parameter, unless it jumps.
const FAR: f64 = 0.5;
/// Share of an opening below which no extrapolation goes.
const LEAST_SHARE: f64 = 1e-3;
/// Part of the secant of friction that holds what slips: at first, and once that has not come to an end.
const SLIPPING: [f64; 2] = [0.01, 1.0];
/// Iterations with the first of them, where damage may fall from one to the next (all of them), and where it only grows.
const SLIPPING_FREELY: [usize; 2] = [ITERATIONS[0], 60];
/// Looks along a way for the place at which the forces do no work any more, and the part of their work that may be left.
const LOOKS: usize = 6;
const LEFT: f64 = 0.5;
/// How often a way at one load is halved that leaves more out of balance: faces that soften and unload by turns come to rest so.
const MOST_HALVES: usize = 4;
/// Unbalanced forces over those that drive a linear solution, below which they are rounding.
const ROUNDING: f64 = 1e-11;
/// Energy over that of the forces that drive a step on their way, below which it is rounding.
const NO_ENERGY: f64 = 1e-9;
/// Equilibria of a step at which what sticks is brought back: some four suffice, ten in stiff elements.
const MOST_BROUGHT_BACK: usize = 16;

impl StaticSolver {
    /// Whether the state found lies beyond states that are no equilibrium: some edge went further down its softening curve
    /// than any step of a path takes it, or some point of an interface [`FAR`] along its own where a path may take the place of such steps.
    pub(super) fn jumps(&self, scene: &Scene, points: &[DamagePoint], by_damage: bool) -> bool {
        if matches!(self.settings.control, Control::TimeThenPath | Control::Opening(_)) && !by_damage {
            let most = scene.interfaces().most_grown(|node| self.response.start[node as usize]);
            return most.is_some_and(|(_, growth)| growth > FAR);
        }
        let far = |(point, seen): (&DamagePoint, &Seen)| {
            !point.broken && seen.stress > path::limit(point, GROWTH[2]) * (1.0 + 1e-9)
        };
        self.settings.control == Control::Time && points.iter().zip(&self.edges.seen).any(far)
    }

    /// Iterates to equilibrium from the present state; the new load parameter, with the displacements in the response and
    /// the equivalent stresses that the edges have seen, or nothing if the iteration does not get there.
    ///
    /// - `by_damage`: go as far as `growth` allows, whatever the control
    /// - `monotone`: damage only grows from iterate to iterate. As no edge passes `growth` this always ends, with edges
    ///   that may have seen a little more than they bear in the end
    pub(super) fn iterate(
        &mut self,
        scene: &mut Scene,
        points: &[DamagePoint],
        longest: f64,
        growth: f64,
        by_damage: bool,
        monotone: bool,
    ) -> Result<Option<(f64, usize)>, StepError> {
        let present = scene.clock.time;
        self.system.begin();
        self.begin(scene, points, growth, by_damage && !monotone);
        self.lead.begin(growth, by_damage);
        let (mut tau, mut found_at) = (longest, present);
        forget_brought_back(scene);
        self.touching.stretch.reset();
        let most = if monotone { MONOTONE_ITERATIONS } else { ITERATIONS[0] };
        // What sticks has moved a little at each equilibrium but the last.
        let (mut iteration, mut brought_back, mut slowest) = (0, 0, 0);
        let mut unbalanced = Vec::new();
        let mut out_of_balance = f64::INFINITY;
        while iteration < most {
            iteration += 1;
            if (self.stop)() {
                return Err(StepError::Interrupted { step: scene.clock.step, time: present });
            }
            self.iterations += 1;
            let first = iteration == 1 && brought_back == 0;
            // Conjugate gradients need a definite matrix, and tell by no error that they had none.
            let freely = iteration <= SLIPPING_FREELY[usize::from(monotone)]
                && (scene.interfaces().is_empty() || self.system.factor_entries().is_some());
            let slipping = SLIPPING[usize::from(!freely)];
            self.find_contacts(scene, [present, found_at], longest, slipping, first)?;
            let ahead = if tau.abs() > 1e-9 * self.settings.end { tau } else { longest };
            let here = boundary_at(scene, present, present);
            let there = boundary_at(scene, present, present + ahead);
            self.respond(scene, &here, &there, ahead, present - found_at)?;
            let leads = self.lead.at;
            let Some(found) = self.step_of_load(scene, points, longest, growth, by_damage) else { return Ok(None) };
            if first && leads.is_some() && self.lead.at.is_none() && !points.is_empty() {
                // Where the load leads it does so from the start: the point was held where it would not have come to. Between elastic bodies it stays: there
                // the load may snap back as soon as the point goes on.
                iteration = 0;
                continue;
            }
            tau = found;
            self.advance(&scene.solid, points, tau, monotone);
            let exact = boundary_at(scene, present, present + tau);
            let since = present + tau - found_at;
            if has_contacts(scene) {
                self.touching.keep(&self.response.start, since);
            }
            let from = std::mem::take(&mut self.touching.place);
            let mut found = self.look(scene, &exact, [present, tau], longest);
            if !scene.interfaces().is_empty() {
                if since == 0.0 && points.is_empty() {
                    let start = (&from[..], &unbalanced[..]);
                    found = self.go_to_least_energy(scene, &exact, [present, tau], longest, start, found);
                }
                // Elastic bodies have gone to the least energy of their way before.
                let most = if points.is_empty() { 1 } else { MOST_HALVES };
                for _ in 0..most {
                    if since != 0.0 || found[0] <= out_of_balance {
                        break;
                    }
                    for (place, from) in self.response.start.iter_mut().zip(&from) {
                        *place = 0.5 * (*place + from);
                    }
                    if !points.is_empty() {
                        scene.solid.effective_stresses(&self.response.start, &mut self.response.start_stress);
                        self.advance(&scene.solid, points, 0.0, monotone);
                    }
                    found = self.look(scene, &exact, [present, tau], longest);
                }
                unbalanced.clone_from(&self.response.right);
            }
            let [missing, forces] = found;
            out_of_balance = missing;
            found_at = present + tau;
            // A body that is moved or heated without strain bears no forces that its rounding could be held against.
            let linear = points.is_empty() && !has_contacts(scene);
            let Response { given, driving, .. } = self.response;
            let is_rounding = !has_contacts(scene) && missing <= ROUNDING * driving;
            let least = NO_FORCE * self.largest_forces.max(given);
            let balanced = is_rounding || missing <= self.settings.tolerance * forces.max(least);
            if balanced && leads == self.lead.at {
                slowest = slowest.max(iteration);
                if bring_back(scene, &self.response.start, [present, present + tau], &mut self.touching.stretch) {
                    if brought_back == MOST_BROUGHT_BACK {
                        return Ok(None);
                    }
                    (iteration, brought_back) = (0, brought_back + 1);
                    continue;
                }
                self.largest_forces = self.largest_forces.max(forces).max(given);
                // Where no stress comes of it, energies are rounding that nothing is to be held against.
                let way = |(to, from): (&Vec3, &Vec3)| (to - from).norm();
                let farthest = self.response.start.iter().zip(&scene.solid.displacement).map(way).fold(0.0, f64::max);
                scene.ledger.scale = scene.ledger.scale.max(NO_ENERGY * driving * farthest);
                return Ok(Some((present + tau, slowest)));
            }
            // Of an elastic step nothing but the linear solution is left to improve.
            if linear && !self.system.sharpen().map_err(|error| come_apart(scene, error))? {
                return Ok(None);
            }
            let Edges { seen, loading, image } = &mut self.edges;
            image.clear();
            image.extend(points.iter().zip(&*seen).map(|(point, seen)| (seen.stress / point.kappa).max(1.0)));
            image.extend(seen.iter().map(|seen| seen.share));
            if !monotone {
                self.anderson.next(loading, image);
                let (ratios, shares) = loading.split_at_mut(points.len());
                ratios.iter_mut().for_each(|ratio| *ratio = ratio.max(1.0));
                shares.iter_mut().for_each(|share| *share = share.clamp(LEAST_SHARE, 1.0));
                self.set_trial(&scene.solid, points);
            } else if self.jumps(scene, points, by_damage) {
                return Ok(None);
            } else {
                self.edges.loading.copy_from_slice(&self.edges.image);
            }
        }
        Ok(None)
    }

    /// Starts from the damage of the last equilibrium, or from what the last step added to it, scaled to this one's growth.
    ///
    /// - `ahead`: whether to begin with the last step's trend
    fn begin(&mut self, scene: &Scene, points: &[DamagePoint], growth: f64, ahead: bool) {
        (self.response.given, self.response.driving) = (0.0, 0.0);
        self.trial.clone_from(&self.damage);
        self.anderson.reset();
        self.edges.loading.clear();
        self.edges.loading.resize(points.len(), 1.0);
        self.edges.loading.extend(points.iter().map(|point| point.share));
        if ahead && self.pace.trend.len() == points.len() {
            for ((ratio, trend), point) in self.edges.loading.iter_mut().zip(&self.pace.trend).zip(points) {
                *ratio = if point.damage > 0.0 { 1.0 + trend * growth } else { 1.0 };
            }
            self.edges.seen.resize(points.len(), Seen::NOTHING);
            self.set_trial(&scene.solid, points);
        }
        self.touching.place.clone_from(&scene.solid.displacement);
    }

    /// Takes the damage of the trial from the loading of the edges.
    fn set_trial(&mut self, solid: &Solid, points: &[DamagePoint]) {
        let Edges { seen, loading, .. } = &mut self.edges;
        let (ratios, shares) = loading.split_at(points.len());
        for (((seen, ratio), share), point) in seen.iter_mut().zip(ratios).zip(shares).zip(points) {
            (seen.stress, seen.share) = (ratio * point.kappa, *share);
        }
        solid.trial_damage(seen, &mut self.trial);
    }

    /// Finds what touches in the last iterate, and brings the matrix up to date.
    fn find_contacts(
        &mut self,
        scene: &mut Scene,
        times: [f64; 2],
        longest: f64,
        slipping: f64,
        near: bool,
    ) -> Result<(), StepError> {
        scene.debris.meet(&scene.solid, &self.touching.place);
        let also = if near { Also::Near } else { Also::Kept(&self.touching.kept) };
        let hold = Hold { share: slipping, led: self.lead.at.map(|at| (at, self.lead.growth)) };
        self.touching.springs = contact_springs(scene, &self.touching.place, times, longest, hold, also);
        self.couple(scene)?;
        let is_linear = scene.shape_contacts.is_empty() && scene.interfaces().is_empty();
        if self.elastic && self.prepared && is_linear {
            return Ok(());
        }
        let mut prepared = self.system.prepare(scene, &self.trial, &self.touching.springs);
        // Where what softens leaves no stable state near by, its secant still leads to one.
        if matches!(prepared, Err(SparseError::Indefinite { .. })) && !scene.interfaces().is_empty() && slipping < 1.0 {
            let also = if near { Also::Near } else { Also::Kept(&self.touching.kept) };
            let hold = Hold { share: 1.0, ..hold };
            self.touching.springs = contact_springs(scene, &self.touching.place, times, longest, hold, also);
            prepared = self.system.prepare(scene, &self.trial, &self.touching.springs);
        }
        prepared.map_err(|error| come_apart(scene, error))?;
        self.prepared = true;
        Ok(())
    }

    /// The step of the load parameter that the control asks for; none where there is no such step.
    fn step_of_load(
        &mut self,
        scene: &Scene,
        points: &[DamagePoint],
        longest: f64,
        growth: f64,
        by_damage: bool,
    ) -> Option<f64> {
        if !points.is_empty() {
            let Response { start, slope, start_stress, slope_stress, .. } = &mut self.response;
            scene.solid.effective_stresses(start, start_stress);
            scene.solid.effective_stress_changes(slope, slope_stress);
        }
        if by_damage {
            let (response, interfaces) = (&self.response, scene.interfaces());
            let place = &self.touching.place;
            let way = path::Way { solid: &scene.solid, points, interfaces, response, place, growth };
            // Below no load at all it has lost its way.
            return self.lead.step(&way, [-(scene.clock.time + longest), longest]);
        }
        let Control::Opening(opening) = &self.settings.control else { return Some(longest) };
        let target = opening.of(&scene.solid.displacement) + opening.step * self.pace.part;
        let found = opening.find(target.min(opening.end), &self.response.start, &self.response.slope)?;
        Some(found.min(self.settings.end - scene.clock.time))
    }

    /// Goes on by τ: displacements, what the edges see there, and the damage of that.
    fn advance(&mut self, solid: &Solid, points: &[DamagePoint], tau: f64, monotone: bool) {
        let Response { start, slope, start_stress, slope_stress, .. } = &mut self.response;
        for (u, b) in start.iter_mut().zip(&*slope) {
            *u += b * tau;
        }
        for (a, &b) in start_stress.iter_mut().zip(&*slope_stress) {
            *a += b * tau;
        }
        let Edges { seen, loading, .. } = &mut self.edges;
        solid.see(points, start_stress, |point| point.kappa, seen);
        if monotone {
            let (ratios, shares) = loading.split_at(points.len());
            for (((seen, ratio), share), point) in seen.iter_mut().zip(ratios).zip(shares).zip(points) {
                (seen.stress, seen.share) = (seen.stress.max(ratio * point.kappa), seen.share.min(*share));
            }
        }
        solid.trial_damage(seen, &mut self.trial);
    }

    /// What is out of balance at the displacements of the response, and all forces there [N]; the right-hand side gets the unbalanced forces.
    ///
    /// - `exact`: loads at the end of the step; `times`: the last equilibrium, and from it to there
    fn look(&mut self, scene: &mut Scene, exact: &Boundary, [present, tau]: [f64; 2], longest: f64) -> [f64; 2] {
        let Response { start, right, .. } = &mut self.response;
        let mut load = exact.force.clone();
        self.touching.place.clone_from(start);
        if has_contacts(scene) {
            scene.debris.meet(&scene.solid, start);
            for spring in contact_springs(scene, start, [present, present + tau], longest, Hold::SECANT, Also::Nothing)
            {
                spring.push(spring.force, &mut load);
            }
        }
        unbalance(scene, &self.trial, start, &load, right)
    }

    /// Goes that part of the way to the displacements of the response on which the forces do no work any more: faces that open and close by turns
    /// come to rest so (Crisfield 1991, 9.2).
    ///
    /// - `from`: the displacements before, and the unbalanced forces there [N]
    /// - `found`: what is out of balance at the end of the way, and the forces there
    fn go_to_least_energy(
        &mut self,
        scene: &mut Scene,
        exact: &Boundary,
        times: [f64; 2],
        longest: f64,
        (from, unbalanced): (&[Vec3], &[Vec3]),
        mut found: [f64; 2],
    ) -> [f64; 2] {
        let way: Vec<Vec3> = self.response.start.iter().zip(from).map(|(to, from)| to - from).collect();
        let work = |forces: &[Vec3]| -> f64 { forces.iter().zip(&way).map(|(force, way)| force.dot(way)).sum() };
        let (at_start, at_end) = (work(unbalanced), work(&self.response.right));
        let (mut low, mut high, mut here) = ((0.0, at_start), (1.0, at_end), at_end);
        for _ in 0..LOOKS {
            if here.abs() <= LEFT * at_start || at_start <= 0.0 || at_end >= 0.0 {
                break;
            }
            let root = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let part = root.clamp(low.0 + 0.1 * (high.0 - low.0), high.0 - 0.1 * (high.0 - low.0));
            for ((place, from), way) in self.response.start.iter_mut().zip(from).zip(&way) {
                *place = from + way * part;
            }
            found = self.look(scene, exact, times, longest);
            here = work(&self.response.right);
            *(if here > 0.0 { &mut low } else { &mut high }) = (part, here);
        }
        found
    }

    /// Gives the system places for all pairs of nodes that touch.
    fn couple(&mut self, scene: &Scene) -> Result<(), StepError> {
        let missing = |pair: &[u32; 2]| !self.system.couples(*pair) && !self.touching.pairs.contains(pair);
        let found: Vec<[u32; 2]> = self.touching.springs.iter().filter_map(Spring::pair).filter(missing).collect();
        self.touching.pairs.extend(found);
        if self.touching.pairs.len() > self.touching.coupled {
            let work = *self.system.work();
            self.system = self.settings.lay_out(scene, &self.touching.pairs).map_err(|e| come_apart(scene, e))?;
            *self.system.work() = work;
            (self.touching.coupled, self.prepared) = (self.touching.pairs.len(), false);
        }
        Ok(())
    }

    /// Displacements at the present load parameter and their slope, for the damage of the trial.
    ///
    /// - `since`: from the iterate at which the springs were found to the present load parameter [s]
    fn respond(
        &mut self,
        scene: &Scene,
        here: &Boundary,
        there: &Boundary,
        ahead: f64,
        since: f64,
    ) -> Result<(), StepError> {
        let solid = &scene.solid;
        let mut field = here.displacement.clone();
        solid.secant_force(&self.trial, &field, &mut self.response.right);
        for (right, force) in self.response.right.iter_mut().zip(&here.force) {
            *right = force - *right;
        }
        for spring in &self.touching.springs {
            let moved = spring.of(&field) - spring.of(&self.touching.place);
            spring.push(spring.force + spring.rate * since - spring.whole() * moved, &mut self.response.right);
        }
        for (i, anchor) in self.system.anchors().iter().enumerate() {
            self.response.right[i] += (self.touching.place[i] - field[i]) * *anchor;
        }
        let given = norm(&self.response.right);
        skew::solve(&mut self.system, &self.touching.springs, &self.response.right, &mut self.response.start)
            .map_err(|e| come_apart(scene, e))?;
        check_loose(scene, &self.response.start, 1.0)?;
        for (u, p) in self.response.start.iter_mut().zip(&field) {
            *u += p;
        }
        let held = scene.supports().held();
        for (i, p) in field.iter_mut().enumerate() {
            let bits = held.get(i).copied().unwrap_or(0);
            let change = (there.displacement[i] - here.displacement[i]) / ahead;
            *p = Vec3::from_fn(|a, _| if bits & (1 << a) == 0 { 0.0 } else { change[a] });
        }
        solid.secant_change(&self.trial, &field, &mut self.response.right);
        for (i, right) in self.response.right.iter_mut().enumerate() {
            *right = (there.force[i] - here.force[i]) / ahead - *right;
        }
        for spring in &self.touching.springs {
            spring.push(spring.rate - spring.whole() * spring.of(&field), &mut self.response.right);
        }
        // Temperatures that have changed are out of balance from the start.
        self.response.given = self.response.given.max(given);
        self.response.driving = self.response.driving.max(given + ahead.abs() * norm(&self.response.right));
        skew::solve(&mut self.system, &self.touching.springs, &self.response.right, &mut self.response.slope)
            .map_err(|e| come_apart(scene, e))?;
        check_loose(scene, &self.response.slope, ahead)?;
        for (u, p) in self.response.slope.iter_mut().zip(&field) {
            *u += p;
        }
        Ok(())
    }
}

fn norm(forces: &[Vec3]) -> f64 {
    forces.iter().map(Vec3::norm_squared).sum::<f64>().sqrt()
}

impl Touching {
    /// Notes which springs of shapes press at the end of a linear solution.
    ///
    /// - `field`: the displacements there; `since`: from the last iterate to there [s]
    fn keep(&mut self, field: &[Vec3], since: f64) {
        let Touching { springs, place, kept, .. } = self;
        kept.clear();
        kept.extend(springs.iter().filter_map(|spring| spring.pressed(spring.of(field) - spring.of(place), since)));
    }
}
