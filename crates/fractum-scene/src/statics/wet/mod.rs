//! Solids and the liquid in their interfaces from instant to instant, both in one system of equations.
//!
//! The solids are elastic, so that the jumps δ of the interfaces are those under the loads alone plus what forces between their sides add,
//! δ = δ₀ + D f(δ, p), with the compliance D of the solids and of springs in all interfaces. f is what the law and the liquid push more than these springs. D is
//! found column by column, for pairs that are more than springs: those that break, rub, open or are wet. Their jumps and the pressures of wet cells are the
//! unknowns of Newton's method; the balance of each cell is implicit in time (backward Euler), and either the cell is full or it has no pressure. A hole is a
//! cell whose pressure has a column too; the cells on its wall have its pressure from the moment at which liquid may enter them.

mod compliance;
mod dense;
mod newton;
mod trial;

use fractum_math::Vec3;

use super::StaticSolver;
use super::equilibrium::{accept_equilibrium, boundary_at, come_apart};
use crate::error::StepError;
use crate::liquid::LiquidState;
use crate::liquid::network::WetPoint;
use crate::scene::Scene;
use crate::step::StepReport;
use compliance::Compliance;
use newton::Newton;
use trial::Trial;

/// Times that a step is halved at most.
const SMALLEST_PART: f64 = 1.0 / 1024.0;
/// Iterations of a step below which the next one may be longer.
const EASY: usize = 40;
/// Looks at what else breaks or gets wet within a step.
const ROUNDS: usize = 200;
/// Force over the largest between any pair above which a pair is more than a spring.
const MORE: f64 = 1e-10;

/// The solution of solids and liquid together.
pub(super) struct Wet {
    compliance: Compliance,
    newton: Newton,
}

/// A step from the last instant.
struct WetStep {
    /// Its end [s].
    time: f64,
    /// Its length [s]; 0 of the equilibrium before any injection.
    dt: f64,
    /// Jumps under the loads at its end, with springs in all interfaces.
    loaded: Vec<Vec3>,
    /// Volumes of holes likewise, without pressure [m³].
    volumes: Vec<f64>,
}

impl Wet {
    pub(super) fn new(scene: &Scene) -> Self {
        Wet { compliance: Compliance::new(scene), newton: Newton::default() }
    }
}

/// Pairs of nodes that interfaces join.
pub(super) fn pairs(scene: &Scene) -> Vec<[u32; 2]> {
    scene.interfaces().joints().into_iter().map(|joint| joint.pair).collect()
}

impl StaticSolver {
    /// Finds solids and liquid at the next instant.
    pub(super) fn step_wet(&mut self, scene: &mut Scene) -> Result<StepReport, StepError> {
        let mut wet = self.wet.take().unwrap_or_else(|| Box::new(Wet::new(scene)));
        let result = self.step_with(&mut wet, scene);
        self.wet = Some(wet);
        result
    }

    fn step_with(&mut self, wet: &mut Wet, scene: &mut Scene) -> Result<StepReport, StepError> {
        wet.compliance.prepare(scene, &mut self.system).map_err(|error| come_apart(scene, error))?;
        loop {
            let present = scene.clock.time;
            let begins = !scene.optional.liquid.as_ref().is_some_and(|liquid| liquid.state.has_begun);
            let longest = self.settings.longest(present, self.pace.part);
            let dt = if begins { 0.0 } else { longest };
            if let Some((field, state, iterations)) = self.wet_step(wet, scene, present + dt, dt)? {
                if iterations <= EASY {
                    self.pace.part = (2.0 * self.pace.part).min(1.0);
                }
                return self.accept_wet(scene, &field, state, present + dt);
            }
            if begins || self.pace.part <= SMALLEST_PART {
                return Err(StepError::NoWetEquilibrium { step: scene.clock.step, time: scene.clock.time });
            }
            self.pace.part *= 0.5;
        }
    }

    /// Displacements and liquid at the end of a step, with the iterations that it took; none where these come to no end.
    fn wet_step(
        &mut self,
        wet: &mut Wet,
        scene: &mut Scene,
        time: f64,
        dt: f64,
    ) -> Result<Option<(Vec<Vec3>, LiquidState, usize)>, StepError> {
        let Wet { compliance, newton } = wet;
        let apart = |scene: &Scene, error| come_apart(scene, error);
        let mut boundary = boundary_at(scene, scene.clock.time, time);
        scene.interfaces().push_apart(time, &mut boundary.force);
        let mut field = boundary.displacement.clone();
        compliance
            .displace(scene, &mut self.system, &mut field, &boundary.force, std::iter::empty())
            .map_err(|error| apart(scene, error))?;
        let holes = scene.optional.liquid.iter().flat_map(|liquid| &liquid.holes);
        let volumes = holes.map(|hole| hole.volume_in(&field)).collect();
        let step = WetStep { time, dt, loaded: compliance.jumps(&field), volumes };
        let mut trial = Trial::begin(scene, compliance, &step);
        let mut iterations = 0;
        for _ in 0..ROUNDS {
            compliance.find(&mut self.system, &trial.active).map_err(|error| apart(scene, error))?;
            let stop = self.stop;
            let Some(took) = newton.solve(scene, compliance, &step, &mut trial, stop)? else {
                return Ok(None);
            };
            iterations += took;
            self.iterations += took;
            if trial.grow(scene, compliance, &step) {
                continue;
            }
            let mut field = boundary.displacement;
            let pushed = trial.forces(scene, compliance);
            trial.push_walls(scene, &mut boundary.force);
            compliance
                .displace(scene, &mut self.system, &mut field, &boundary.force, pushed.into_iter())
                .map_err(|error| apart(scene, error))?;
            return Ok(Some((field, trial.into_state(scene, compliance, &step), iterations)));
        }
        Ok(None)
    }

    fn accept_wet(
        &mut self,
        scene: &mut Scene,
        field: &[Vec3],
        state: LiquidState,
        time: f64,
    ) -> Result<StepReport, StepError> {
        let optional = &mut scene.optional;
        if let Some(liquid) = &mut optional.liquid {
            liquid.state = state;
            for &WetPoint { at, cell, .. } in &liquid.network.points {
                optional.interfaces.press(at, liquid.state.pressure[cell as usize]);
            }
        }
        self.steps += 1;
        accept_equilibrium(scene, field, time, &mut self.applied)
    }
}
