//! Bonded bodies at rest: the load rises from break to break, see [`fractum_dem::QuasiStatic`].

use fractum_dem::criterion::{BeamRankine, EndMoments, FractureCriterion};
use fractum_dem::{
    Batch, BondEnergy, Breaking, Crack, DemError, Dof6, Lattice, LatticeSupports, LoadStage, QuasiStatic,
    QuasiStaticState, StaticBody, Tolerance,
};
use fractum_math::{Vec3, rotation_by};
use serde::{Deserialize, Serialize};

use crate::bonded::{Bonded, BondedBody, Closest};
use crate::error::{SceneError, StepError};
use crate::ledger::EnergyKind;
use crate::measure::audit::TURNED;
use crate::scene::Scene;
use crate::watch::{Notice, Site};

/// How a bonded body is brought from break to break.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BondedStaticSettings {
    /// Time at which the supports have moved all their way [s]; before, they are in proportion.
    pub end: f64,
    /// Unbalanced force over the forces of the supports at which equilibrium is accepted.
    pub tolerance: f64,
    /// How many bonds break between two equilibria.
    pub batch: Batch,
    /// Equilibria after which the run ends in any case.
    pub most_steps: u64,
}

/// What the solver of a bonded body at rest remembers from break to break, for a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondedStaticState {
    run: QuasiStaticState,
    stage: LoadStage,
    push: [f64; 2],
    work: f64,
    sudden: f64,
}

/// Share of the largest load below which a body has lost its strength.
const STRENGTHLESS: f64 = 1e-3;
/// Compliance under loads over that of the intact body from which on it gives way: what would be found beyond is no small displacement.
const GIVES_WAY: f64 = 10.0;
/// Most iterations of one equilibrium.
const ITERATIONS: usize = 50_000;

/// The solver of a scene that holds one bonded body.
pub struct BondedStatics {
    run: QuasiStatic,
    settings: BondedStaticSettings,
    /// Particle, axis and displacement of what moves, at the end.
    prescribed: Vec<(u32, usize, f64)>,
    stage: LoadStage,
    /// Work at their full size of the constant loads on the intact body, and of those that grow where they alone drive it [J].
    intact: [Option<f64>; 2],
    /// What supports and loads do per load factor were nothing to break, at none and more with the factor [J].
    push: [f64; 2],
    /// Work of supports and loads so far [J].
    work: f64,
    /// Elastic energy that breaks have set free beyond that of the broken bonds [J].
    sudden: f64,
}

/// A criterion that nothing meets, for bodies without one.
const UNBREAKABLE: FractureCriterion =
    FractureCriterion::BeamRankine(BeamRankine { strength: f64::MAX, moments: EndMoments::Mean });

impl BondedStatics {
    /// Brings the body to its first equilibrium.
    ///
    /// - `stop`: whether to give up, asked in every iteration to equilibrium
    ///
    /// # Errors
    /// [`SceneError::NotProportional`] for supports that do not move in proportion to time, an equilibrium that is not
    /// found; a scene without a bonded body.
    pub fn new(scene: &Scene, settings: BondedStaticSettings, stop: fn() -> bool) -> Result<Self, SceneError> {
        let bonded = &scene.bonded;
        let [body] = bonded.bodies.as_slice() else { return Err(SceneError::OneBondedBody) };
        let all = &bonded.particles;
        let mean_radius = all.radius.iter().sum::<f64>() / all.len().max(1) as f64;
        let section = body.bonds.beam().ok_or(DemError::NoLattice)?;
        let shares: Vec<f64> = (0..body.bonds.len()).map(|bond| body.bonds.share(bond)).collect();
        let lattice = Lattice::with_shares(&bonded.reference, body.bonds.pairs(), &shares, section, mean_radius)?;
        let mut supports = LatticeSupports::none(all.len());
        for (i, held) in (0..).zip(&all.held) {
            (0..6).filter(|d| held >> d & 1 == 1).for_each(|d| supports.set(i, d, 0.0));
        }
        let prescribed = bonded.supports.proportional(&bonded.reference, settings.end)?;
        prescribed.iter().for_each(|&(particle, axis, value)| supports.set(particle, axis, value));
        let guess = vec![[0.0; 6]; all.len()];
        let plan = body.plan.as_ref();
        let what = Breaking {
            // Without a fracture nothing reaches this strength.
            criterion: plan.and_then(|plan| plan.criterion).unwrap_or(UNBREAKABLE),
            pairs: body.bonds.pairs(),
            radius: &all.radius,
            strength_factors: plan.map_or(&[][..], |plan| &plan.strength_factors),
            to_wall: plan.map_or(&[][..], |plan| &plan.to_wall),
            fraction: body.fraction,
            volume: plan.map_or(1.0, |plan| plan.volume),
            displacement: 1.0,
            batch: settings.batch,
            limit: 1.0,
            stop: STRENGTHLESS,
            tolerance: Tolerance { residual: settings.tolerance, iterations: ITERATIONS, stop },
        };
        let on_particles = |forces: Vec<Vec3>| -> Vec<[f64; 6]> {
            let loaded = forces.iter().any(|force| *force != Vec3::zeros());
            let all = forces.iter().map(|force| [force.x, force.y, force.z, 0.0, 0.0, 0.0]);
            all.filter(|_| loaded).collect()
        };
        let [constant, growing] = bonded.loads.proportional(bonded, &all.mass, settings.end)?.map(on_particles);
        let run = QuasiStatic::under_loads(lattice, supports, [&constant, &growing], &guess, &what)?;
        let driven = prescribed.iter().any(|(.., value)| *value != 0.0);
        let of_growing = (!growing.is_empty() && !driven).then(|| run.body().work_of_loads());
        let of_constant = run.constant().map(StaticBody::work_of_loads);
        let mut statics = BondedStatics {
            intact: [of_constant, of_growing],
            // Constant loads are put on slowly before the first step.
            work: 0.5 * of_constant.unwrap_or(0.0),
            run,
            settings,
            prescribed,
            stage: LoadStage::Failing,
            push: [0.0; 2],
            sudden: 0.0,
        };
        statics.push = statics.push();
        Ok(statics)
    }

    /// What it remembers, for a checkpoint.
    pub fn state(&self) -> BondedStaticState {
        let BondedStatics { run, stage, push, work, sudden, .. } = self;
        BondedStaticState { run: run.state(), stage: *stage, push: *push, work: *work, sudden: *sudden }
    }

    /// Goes on from what a solver of the same scene remembered.
    pub fn restore(&mut self, state: BondedStaticState) {
        self.run.restore(state.run);
        (self.stage, self.push, self.work, self.sudden) = (state.stage, state.push, state.work, state.sudden);
    }

    /// Breaks what fails, finds equilibrium again, and moves the supports on to the next failure.
    ///
    /// # Errors
    /// [`StepError::NoBondedEquilibrium`], [`StepError::Interrupted`].
    pub fn step(&mut self, scene: &mut Scene) -> Result<(), StepError> {
        if scene.clock.step > 0 && self.stage == LoadStage::Failing {
            self.break_and_rebalance(scene)?;
            if self.stage == LoadStage::Separated {
                return Ok(());
            }
        }
        self.load_to_next_failure(scene);
        Ok(())
    }

    /// Whether the body has come apart, holds at the end, or has used up its steps.
    pub fn is_finished(&self, scene: &Scene) -> bool {
        self.stage != LoadStage::Failing || scene.clock.step >= self.settings.most_steps
    }

    /// Whether the body has broken so far that it does not bear its loads.
    pub fn has_given_way(&self) -> bool {
        self.stage == LoadStage::Separated && self.is_loaded()
    }

    fn is_loaded(&self) -> bool {
        self.run.body().is_loaded() || self.run.constant().is_some()
    }

    /// Equilibria found, and iterations for all of them.
    pub fn effort(&self) -> (usize, usize) {
        self.run.effort()
    }

    fn push(&self) -> [f64; 2] {
        let growing = self.run.body();
        let of_supports = |body: &StaticBody| -> f64 {
            let moving = self.prescribed.iter().filter(|(.., value)| *value != 0.0);
            moving.map(|&(i, axis, value)| body.reaction(i)[axis] * value).sum()
        };
        let constant = self.run.constant().map_or(0.0, |body| of_supports(body) + body.work_of_loads_on(growing));
        [constant, of_supports(growing) + growing.work_of_loads()]
    }

    /// Moves the supports on to the next failure and brings the scene there.
    fn load_to_next_failure(&mut self, scene: &mut Scene) {
        let before = self.run.factor();
        let (point, stage) = self.run.load_to_next_failure(|_| false);
        self.stage = stage;
        let [constant, growing] = self.push;
        self.work +=
            constant * (self.run.factor() - before) + 0.5 * growing * (self.run.factor().powi(2) - before.powi(2));
        let time = point.displacement * self.settings.end;
        scene.clock.dt_before = time - scene.clock.time;
        scene.clock.dt_after = 0.0;
        scene.clock.time = time;
        scene.clock.step += 1;
        let Bonded { particles, reference, bodies, supports, still, energy, .. } = &mut scene.bonded;
        for (i, u) in self.run.displacements().iter().enumerate() {
            let (shift, turn) = (Vec3::new(u[0], u[1], u[2]), Vec3::new(u[3], u[4], u[5]));
            particles.position[i] = reference[i] + shift;
            particles.orientation[i] = rotation_by(turn);
        }
        supports.set_reactions(|particle, axis| self.run.reaction(particle)[axis]);
        for &(i, _) in &*still {
            // As in motion: what would turn the particle did nothing hold it.
            let [.., x, y, z] = self.run.reaction(i);
            particles.moment[i as usize] = -Vec3::new(x, y, z);
        }
        let body = &mut bodies[0];
        note_closest(body, &self.run, reference, time);
        let turned = angle_of_most(&self.run.displacements());
        // Parts of the energy as the beams show them; their sum is that of the equilibrium.
        let parts = body.bonds.energy(particles);
        let scale = if parts.total() > 0.0 { point.elastic / parts.total() } else { 0.0 };
        let [tension, bending, torsion] = [parts.tension, parts.bending, parts.torsion].map(|part| part * scale);
        *energy = BondEnergy { tension, bending, torsion };
        let broken: f64 = self.run.cracks().iter().map(|crack| crack.energy).sum();
        scene.ledger[EnergyKind::External] = self.work;
        scene.ledger[EnergyKind::Elastic] = point.elastic;
        scene.ledger[EnergyKind::BondTension] = tension;
        scene.ledger[EnergyKind::BondBending] = bending;
        scene.ledger[EnergyKind::BondTorsion] = torsion;
        scene.ledger[EnergyKind::Removed] = broken;
        scene.ledger[EnergyKind::Damping] = self.sudden;
        scene.ledger.update_maxima();
        if let Some((particle, angle)) = turned.filter(|(_, angle)| *angle > TURNED) {
            scene.note(Notice::Rotation, Site::Particle(particle), angle);
        }
    }

    /// Breaks what fails and finds equilibrium again.
    fn break_and_rebalance(&mut self, scene: &mut Scene) -> Result<(), StepError> {
        let before = self.run.cracks().len();
        let elastic = self.run.energy();
        let (step, time) = (scene.clock.step, scene.clock.time);
        let found = self.run.break_and_rebalance();
        let lost: f64 = self.run.cracks()[before..].iter().map(|crack| crack.energy).sum();
        match found {
            Ok(given) => {
                // Supports stand still; loads do work as the body gives way.
                self.work += given;
                self.sudden += elastic + given - self.run.energy() - lost;
                self.push = self.push();
            }
            Err(DemError::NotConverged { .. }) if self.is_loaded() => self.stage = LoadStage::Separated,
            Err(DemError::Interrupted) => return Err(StepError::Interrupted { step, time }),
            Err(error) => return Err(StepError::NoBondedEquilibrium { step, time, error }),
        }
        let works = [self.run.constant().map(StaticBody::work_of_loads), Some(self.run.body().work_of_loads())];
        if self
            .intact
            .iter()
            .zip(works)
            .any(|(intact, work)| intact.zip(work).is_some_and(|(intact, work)| work > GIVES_WAY * intact))
        {
            self.stage = LoadStage::Separated;
        }
        if self.stage == LoadStage::Separated {
            // What is left does not bear the loads: the scene stays as it was before, but for the bonds.
            scene.ledger[EnergyKind::Elastic] -= lost;
            scene.ledger[EnergyKind::Removed] += lost;
        }
        let end = self.settings.end;
        let BondedBody { fracture, bonds, .. } = &mut scene.bonded.bodies[0];
        if let Some(fracture) = fracture {
            let new = self.run.cracks()[before..].iter().copied();
            fracture.adopt(new.map(|crack| Crack { time: crack.time * end, ..crack }), bonds);
        }
        Ok(())
    }
}

/// The angle [rad] that half of all particles have turned by, and one that has turned by it: single ones may hang on a bond and turn far.
fn angle_of_most(displacements: &[Dof6]) -> Option<(u32, f64)> {
    let turned = (0..).zip(displacements).map(|(i, u)| (i, Vec3::new(u[3], u[4], u[5]).norm()));
    let mut turned: Vec<(u32, f64)> = turned.collect();
    let middle = turned.len() / 2;
    (!turned.is_empty())
        .then(|| *turned.select_nth_unstable_by(middle, |a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).1)
}

/// Keeps the largest ratio.
fn note_closest(body: &mut BondedBody, run: &QuasiStatic, reference: &[Vec3], time: f64) {
    let Some((fracture, site)) = body.fracture.as_ref().zip(run.closest()) else { return };
    if body.closest.is_none_or(|known| site.ratio > known.ratio) {
        body.closest = Some(Closest { ratio: site.ratio, place: fracture.position_of(&site, reference), time });
    }
}
