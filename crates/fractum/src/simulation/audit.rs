//! What a run finds while it goes, as warnings.

use std::f64::consts::PI;

use fractum_case::Case;
use fractum_case::model::{BodyKind, Probe, ProbeInput, ProbeKind};
use fractum_fem::{RateReport, cracks, motion, neighbours, rate_report};
use fractum_output::number::{at_instant, percent, quantity};
use fractum_output::summary::LargestOverlap;
use fractum_output::warning::{Code, Warning};
use fractum_scene::{Notice, Noticed, Scene, Site};

use super::coarse::{coarse_crack, coarse_indentation};
use super::crack_energy::{crack_energy, jumped_snap_back};
use super::messages::at;
use super::{End, Simulation};
use crate::error::Failure;
use crate::output::record::Recorder;
use crate::output::summary::probes;

/// Steps of motion between two looks at the state, of a short run and of a long one: a look costs about two steps.
const STEPS_BETWEEN_LOOKS: [f64; 2] = [128.0, 256.0];
/// Looks that a run of medium length has.
const LOOKS: f64 = 50.0;
/// The same at overlaps of particles alone, which costs a small part of a step: an impact lasts some fifty steps.
const STEPS_BETWEEN_LOOKS_AT_OVERLAPS: u64 = 20;
/// Share of the force of a servo by which it may be missed at the end of a run.
const SERVO_MISSES: f64 = 0.1;

impl Simulation {
    /// Looks at the state: of motion and of heat now and then, at rest after every equilibrium.
    pub(super) fn audit_now_and_then(&mut self) -> Result<(), Failure> {
        let step = self.scene.clock.step;
        if !self.solver.rests() && step.is_multiple_of(STEPS_BETWEEN_LOOKS_AT_OVERLAPS) {
            self.scene.look_at_overlaps();
            self.keep_overlap();
        }
        if self.solver.rests() || step.is_multiple_of(self.steps_between_looks()) { self.audit() } else { Ok(()) }
    }

    fn steps_between_looks(&self) -> u64 {
        let [least, most] = STEPS_BETWEEN_LOOKS;
        // Twice as often for twice the step, and so the same on all processes and after a resume.
        let steps = self.case.solver.end / self.scene.clock.dt_after;
        1 << ((steps / LOOKS).clamp(least, most) as u64).ilog2()
    }

    /// Looks at the state, and warns of what is noticed.
    pub(super) fn audit(&mut self) -> Result<(), Failure> {
        if self.solver.shows_modes() {
            // The size of a shape means nothing.
            return self.warn_of_modes();
        }
        self.scene.audit();
        self.keep_overlap();
        self.recorder.join_overlaps(&self.ranks);
        self.warn_of_rigid_bodies()?;
        let at_rest = self.solver.rests();
        let found: Vec<Warning> = self.scene.noticed().map(|found| warning(&self.scene, found, at_rest)).collect();
        // Each process looks at what it computes, and all of them decide alike.
        self.ranks.gather(found).into_iter().flatten().try_for_each(|found| self.warn_once(found))
    }

    /// Keeps the largest overlap for the summary.
    fn keep_overlap(&mut self) {
        let before = self.recorder.largest_overlap().map_or(0.0, |before| before.share);
        if let Some(found) = self.scene.deepest_overlap().filter(|found| found.value > before) {
            let place = place(&self.scene, found.site);
            self.recorder.set_largest_overlap(LargestOverlap { share: found.value, place, time: found.time });
        }
    }

    /// Warns of a rigid body that has moved into another one: they do not touch each other.
    fn warn_of_rigid_bodies(&mut self) -> Result<(), Failure> {
        let all = self.scene.contacts.rigid_bodies();
        let moving = all.iter().flat_map(|body| all.iter().map(move |other| (body, other)));
        let mut moving = moving.filter(|(body, other)| body.moves() || other.moves());
        let Some((body, other)) = moving.find(|(body, other)| body.has_entered(other)) else { return Ok(()) };
        let text = format!("\"{}\" has moved into \"{}\": rigid bodies do not touch each other", body.name, other.name);
        let found = Warning::new(Code::NoContact, self.instant(self.time()), text);
        self.warn_once(found.remedy("make one of them a solid, or drive them so that they do not meet"))
    }

    /// Warns of an energy balance that is off, once in a run.
    pub(super) fn audit_balance(&mut self) -> Result<(), Failure> {
        let relative = self.scene.ledger().relative_residual();
        if relative <= self.case.solver.balance_warning {
            return Ok(());
        }
        let text = format!("the energy balance is off by {relative:.1e} of the energy put in");
        let found = Warning::new(Code::EnergyBalance, self.instant(self.time()), text);
        let takes_steps = self.solver.moves() || self.scene.solid.body_count() > 0;
        let by_step = !self.solver.moves() || self.case.solver.step.is_some();
        let step = match (takes_steps, by_step) {
            // Bonded bodies at rest go from break to break.
            (false, _) => "",
            (true, true) => "take a smaller solver.step, and ",
            (true, false) => "take a smaller solver.safety, and ",
        };
        self.warn_once(found.remedy(format!("{step}look where the energy goes (probes[].energy)")))
    }

    /// Looks at the balance of the end, which is judged as every other, and at what cracks have made of the bodies. A strict run
    /// that would have finished has another end where it meets a warning.
    pub(super) fn audit_end(&mut self, end: End) -> Result<End, Failure> {
        self.audit_balance()?;
        self.warn_of_single_nodes()?;
        self.warn_of_short_lengths()?;
        self.warn_of_merged_bands()?;
        self.warn_of_cut_bands()?;
        crack_energy(&self.scene).into_iter().try_for_each(|found| self.warn(found))?;
        if self.solver.rests() {
            jumped_snap_back(&self.scene).into_iter().try_for_each(|found| self.warn(found))?;
        }
        coarse_crack(&self.scene).into_iter().try_for_each(|found| self.warn(found))?;
        coarse_indentation(&self.scene).into_iter().try_for_each(|found| self.warn(found))?;
        self.tell_rates()?;
        self.warn_of_idle_stop()?;
        self.warn_of_giving_way()?;
        used_up_steps(self).into_iter().try_for_each(|found| self.warn(found))?;
        if matches!(end, End::Finished(_)) {
            self.warn_of_servos()?;
            self.warn_of_idle_probes()?;
            undefined_probes(&self.case, &self.recorder).into_iter().try_for_each(|found| self.warn(found))?;
        }
        Ok(match (end, self.end.take()) {
            (End::Finished(_), Some(strict)) => strict,
            (end, _) => end,
        })
    }

    /// Warns of stations whose velocity was still growing as the run ended: their largest one is no peak.
    ///
    /// - `end`: when that was [s]
    pub(super) fn warn_of_late_stations(&mut self, end: f64) -> Result<(), Failure> {
        for of in self.recorder.attenuations(end) {
            let late = of.stations.iter().filter(|station| station.is_late(end)).count();
            if late > 0 {
                let text = format!(
                    "{late} of the {} stations \"{}\" have their largest velocity as the run ends: the wave has not passed them, and they are no part of the power law",
                    of.stations.len(),
                    of.name
                );
                let found = Warning::new(Code::EndsEarly, "output.ppv", text);
                self.warn(found.remedy("choose a later end, or nearer stations"))?;
            }
        }
        Ok(())
    }

    /// Warns of bodies at rest that do not bear their loads.
    fn warn_of_giving_way(&mut self) -> Result<(), Failure> {
        if !self.solver.has_given_way(&self.scene) {
            return Ok(());
        }
        let Some(body) = self.scene.bonded.bodies().first() else {
            let text = "the loads that hold from the start are more than what has been left bears: the path of equilibrium has come to a load \
                        factor below zero, and the run ends there";
            let found = Warning::new(Code::GaveWay, self.instant(self.time()), text);
            return self.warn(found.remedy("let loads grow from none, or move a support"));
        };
        let name = body.name.clone();
        let factor = self.time() / self.case.solver.end;
        let text = format!("it gave way under its loads at {} of them, and bears no more", percent(factor));
        let found = Warning::new(Code::GaveWay, format!("body \"{name}\""), text);
        self.warn(
            found
                .remedy("its strength is the peak; to see what follows, move a support, or choose kind = \"explicit\""),
        )
    }

    /// Warns of rigid bodies that do not press at the end as their servos should.
    fn warn_of_servos(&mut self) -> Result<(), Failure> {
        let time = self.time();
        let bodies = self.scene.contacts.rigid_bodies().iter();
        let missed = bodies.filter_map(|body| {
            let [wanted, pressed] = body.servo_forces(time)?;
            if (pressed - wanted).abs() <= SERVO_MISSES * wanted {
                return None;
            }
            let [wanted, pressed] = [wanted, pressed].map(|force| quantity(force, "N"));
            let text = format!("it presses with {pressed} at the end, and {wanted} are asked for");
            let found = Warning::new(Code::Servo, format!("body \"{}\"", body.name), text);
            Some(
                found
                    .remedy("let it act longer, raise servo.speed, or look for what stands in its way or is not there"),
            )
        });
        let missed: Vec<Warning> = missed.collect();
        missed.into_iter().try_for_each(|found| self.warn(found))
    }

    /// Warns of bodies that came apart into single nodes.
    fn warn_of_single_nodes(&mut self) -> Result<(), Failure> {
        let reads_velocity = self.case.probes.iter().any(|probe| matches!(probe.kind, ProbeKind::Velocity(_)));
        let (least, what) = if reads_velocity {
            (VISIBLY_SINGLE, "which have velocities of their own, and are no fragments")
        } else {
            (MOSTLY_SINGLE, "which are no fragments")
        };
        let shares = self.scene.single_share().into_iter().enumerate();
        for (body, share) in shares.filter(|(_, share)| *share > least) {
            let (name, percent) = (&self.scene.solid.body(body).name, 100.0 * share);
            let text = format!("{percent:.0} % of its mass is in single nodes, {what}");
            let found = Warning::new(Code::SingleNodes, format!("body \"{name}\""), text);
            self.warn(found.remedy("a finer mesh resolves them"))?;
        }
        Ok(())
    }

    /// Warns of phase fields whose length is short for the elements that cracks went through.
    fn warn_of_short_lengths(&mut self) -> Result<(), Failure> {
        let solid = &self.scene.solid;
        let found = (0..solid.body_count()).filter_map(|body| {
            let ([length, _], size) = motion::phase_sizes(solid, body).zip(cracks::size_along_cracks(solid, body))?;
            if length >= LEAST_SIZES * size {
                return None;
            }
            let sizes = length / size;
            let [length, size] = [length, size].map(|length| quantity(length, "m"));
            let text = format!(
                "its cracks ran through elements of {size}, and the length of its phase field, {length}, is {sizes:.1} of them: a band needs {LEAST_SIZES} at least"
            );
            let place = format!("body \"{}\"", solid.body(body).name);
            let found = Warning::new(Code::PhaseFieldLength, place, text);
            Some(found.remedy("refine the mesh where the cracks went, or set a longer length"))
        });
        let found: Vec<Warning> = found.collect();
        found.into_iter().try_for_each(|found| self.warn(found))
    }

    /// Warns of phase fields whose bands are sheared or pressed, as those of two cracks are that have become one.
    fn warn_of_merged_bands(&mut self) -> Result<(), Failure> {
        let solid = &self.scene.solid;
        let bodies = (0..solid.body_count()).filter_map(|body| {
            let [length, _] = motion::phase_sizes(solid, body)?;
            Some((&solid.body(body).name, cracks::cost_of_bands(solid, body)?, length))
        });
        let sheared = bodies.filter(|(_, cost, _)| *cost > SHEARED);
        let found = sheared.map(|(name, cost, length)| {
            let width = quantity(PI * length, "m");
            let text = format!(
                "damage took {cost:.1} times the fracture energy of its area of crack: the bands of its phase field, {width} wide, are sheared, or pressed along the crack"
            );
            Warning::new(Code::MergedBands, format!("body \"{name}\""), text)
                .remedy("where two cracks are nearer to each other than that, take a smaller length on a finer mesh")
        });
        let found: Vec<Warning> = found.collect();
        found.into_iter().try_for_each(|found| self.warn(found))
    }

    /// Warns of cracks of a phase field along the border of its body.
    fn warn_of_cut_bands(&mut self) -> Result<(), Failure> {
        let solid = &self.scene.solid;
        let bodies = (0..solid.body_count()).filter_map(|body| {
            let share = cracks::share_at_borders(solid, body).filter(|share| *share > AT_BORDERS)?;
            Some((&solid.body(body).name, share))
        });
        let found = bodies.map(|(name, share)| {
            let text = format!(
                "{} of its damage lies at nodes that it shares with another body, where its phase field ends: a crack along them takes down to half of its \
                 fracture energy",
                percent(share)
            );
            Warning::new(Code::CutBand, format!("body \"{name}\""), text)
                .remedy("make one body of both where they are one material; else put [[interfaces]] between them, or take regularisation = \"none\"")
        });
        let found: Vec<Warning> = found.collect();
        found.into_iter().try_for_each(|found| self.warn(found))
    }

    /// Tells at which rates of strain edges began to break, where strength grows with them, and warns of elements too large for it.
    fn tell_rates(&mut self) -> Result<(), Failure> {
        let solid = &self.scene.solid;
        let reports =
            (0..solid.body_count()).filter_map(|body| Some((&solid.body(body).name, rate_report(solid, body)?)));
        let reports: Vec<(String, RateReport)> =
            reports.filter(|(_, report)| report.count > 0).map(|(name, report)| (name.clone(), report)).collect();
        for (name, RateReport { count, limited, rates }) in reports {
            let [least, mean, most] = rates.map(|rate| quantity(rate, "1/s"));
            self.messages.tell(&format!(
                "body \"{name}\": {count} edges began to break, at rates of strain from {least} to {most} (geometric mean {mean})"
            ))?;
            if limited > 0 {
                let text = format!(
                    "{limited} of {count} edges broke below the strength of their rate of strain: their elements are too large for it"
                );
                let found = Warning::new(Code::RateLimited, format!("body \"{name}\""), text);
                self.warn(found.remedy("refine the mesh where cracks go"))?;
            }
        }
        Ok(())
    }

    /// Warns of an early end by a probe that was never above zero, so that it had no largest value to fall from.
    fn warn_of_idle_stop(&mut self) -> Result<(), Failure> {
        let Some(stop) = &self.case.solver.stop_when else { return Ok(()) };
        let values = &self.recorder.state().series[stop.probe];
        if values.iter().any(|value| *value > 0.0) || !values.iter().any(|value| *value < 0.0) {
            return Ok(());
        }
        let name = &self.case.probes[stop.probe].name.value;
        let text = format!("\"{name}\" was never above zero, and has not fallen from a largest value");
        let found = Warning::new(Code::NoEffect, "solver.stop_when", text);
        self.warn(found.remedy("measure it in the other direction, such as along = \"-y\""))
    }

    /// Warns where all that is measured of motion and forces was zero throughout, or all that is measured of contact.
    fn warn_of_idle_probes(&mut self) -> Result<(), Failure> {
        use ProbeKind::{ContactForce, Displacement, Moment, Reaction, Strain, Stress, Velocity};
        if self.solver.shows_modes() {
            return Ok(());
        }
        let series = &self.recorder.state().series;
        let names_of = |is_one: &dyn Fn(&ProbeKind) -> bool| {
            let probes = self.case.probes.iter().zip(series).filter(|(probe, _)| is_one(&probe.kind));
            let (names, zero): (Vec<&str>, Vec<bool>) = probes
                .map(|(probe, values)| (probe.name.value.as_str(), values.iter().all(|value| *value == 0.0)))
                .unzip();
            let idle = !names.is_empty() && zero.into_iter().all(|zero| zero);
            idle.then(|| names.join(", "))
        };
        let of_motion = |kind: &ProbeKind| {
            matches!(kind, Displacement(_) | Velocity(_) | Reaction(_) | Moment(_) | Stress(_) | Strain(_))
        };
        let is_rigid = |name: &str| {
            let mut bodies = self.case.bodies.iter();
            bodies.any(|body| body.name.value == name && matches!(body.kind, BodyKind::Rigid(_)))
        };
        let is_contact = |kind: &ProbeKind| match kind {
            ContactForce(_) => true,
            Reaction(own) => is_rigid(own.on.group_name()),
            _ => false,
        };
        let found = if let Some(names) = names_of(&is_contact) {
            let text = format!("no force of contact was found at any instant that was recorded ({names})");
            Warning::new(Code::Misses, "probes", text)
                .remedy("check what should meet: its place, its direction, and the end of the run; record a short touch more often")
        } else if let Some(names) = names_of(&of_motion) {
            let text = format!("nothing has moved, and there is no force: all was zero throughout ({names})");
            Warning::new(Code::NoEffect, "probes", text)
                .remedy("check which groups loads and supports act on, and their axes")
        } else {
            return Ok(());
        };
        self.warn(found)
    }

    /// Warns of the first of a kind.
    pub(super) fn warn_once(&mut self, warning: Warning) -> Result<(), Failure> {
        let told = self.messages.warnings().iter().any(|before| before.code == warning.code);
        if told { Ok(()) } else { self.warn(warning) }
    }

    /// Warns; of a strict run it is the end.
    fn warn(&mut self, warning: Warning) -> Result<(), Failure> {
        if self.messages.strict && !self.is_over() {
            self.end = Some(End::Strict(warning.clone()));
        }
        self.messages.warn(warning)
    }
}

/// Elements that the length of a phase field must span.
const LEAST_SIZES: f64 = 1.5;
/// Energy of damage over the fracture energy of the cracks above which bands do more than open: where they open it is at most 1.1.
const SHEARED: f64 = 1.3;
/// Share of the damage of a phase field at the nodes of other bodies above which its cracks run along them.
const AT_BORDERS: f64 = 0.2;
/// Share of a body's mass in single nodes above which its fragments tell little, and above which a mean velocity does.
const MOSTLY_SINGLE: f64 = 0.5;
const VISIBLY_SINGLE: f64 = 0.05;

/// A run at rest that ends before its end, since it has taken as many steps as it may.
fn used_up_steps(run: &Simulation) -> Option<Warning> {
    let time = run.time();
    if !run.solver.has_used_up_its_steps() || time >= run.case.solver.end * (1.0 - 1e-9) {
        return None;
    }
    let text = format!("the run ends at {}, as it has taken as many steps as it may", run.instant(time));
    let found = Warning::new(Code::EndsEarly, "solver.max_steps", text);
    Some(found.remedy("allow more steps, or look where they became small (column dt of the history)"))
}

/// Probes that had no value at any instant, or were infinite: of expressions those for which all that they take had good ones.
fn undefined_probes(case: &Case, recorder: &Recorder) -> Vec<Warning> {
    let summaries = probes(case, recorder);
    let is_good =
        |probe: &Probe| summaries.get(&probe.name.value).is_none_or(|of| of.min.is_finite() && of.max.is_finite());
    let is_undefined = |probe: &&Probe| match &probe.kind {
        _ if is_good(probe) => false,
        ProbeKind::Expression(expression) => expression.inputs.iter().all(|input| match input {
            ProbeInput::Probe { probe, .. } => is_good(&case.probes[*probe]),
            ProbeInput::Time => true,
        }),
        _ => true,
    };
    let told = |probe: &Probe| {
        let name = &probe.name.value;
        let is_expression = matches!(probe.kind, ProbeKind::Expression(_));
        let text = match (is_expression, summaries[name].max.is_nan()) {
            (false, _) => {
                "it had no value at any instant: what it looks at was never there, such as a crack of enough bonds"
            }
            (true, true) => {
                "it had no value at any instant, as 0/0, the root of a negative number, a slope over too few instants, or at() a time after the end"
            }
            (true, false) => "it is infinite at an instant: something is divided by zero",
        };
        let remedy = match is_expression {
            true => "look at the values that its expression takes (history.csv)",
            false => "look at what the run came to (pictures, counts in summary.json)",
        };
        Warning::new(Code::Undefined, format!("probe \"{name}\""), text).remedy(remedy)
    };
    case.probes.iter().filter(is_undefined).map(told).collect()
}

/// What the scene noticed, in words.
///
/// - `at_rest`: whether the scene is in equilibrium; instants then are load factors, unless heat goes on with time
fn warning(scene: &Scene, Noticed { what, site, time, value }: &Noticed, at_rest: bool) -> Warning {
    let when = at_instant(*time, at_rest && scene.heat().is_none());
    let place = match place(scene, *site) {
        place if place.is_empty() => when,
        place => format!("{place}, {when}"),
    };
    let (code, text, remedy) = match what {
        Notice::BelowZero => (
            Code::BelowZero,
            format!("the temperature is {}, below absolute zero", quantity(*value, "K")),
            "temperatures are absolute: check what cools ([[heat.conditions]]), its sign and its unit",
        ),
        Notice::Damping => (
            Code::Damping,
            format!("damping has taken {} of the work in the second half of the run", percent(*value)),
            "what moves slowly is braked by it: take less damping ([damping]), or load more slowly",
        ),
        Notice::Rotation => (
            Code::Rotation,
            format!("it has turned by {:.0} degrees, and small strains know no rotation", value.to_degrees()),
            if at_rest {
                "an equilibrium knows small strains alone: load less, or in motion (solver.kind = \"explicit\")"
            } else {
                "leave out kinematics on the body, which then is corotational where it turns"
            },
        ),
        Notice::Strain => (
            Code::LargeStrain,
            format!("the strain is {}, which is not small", percent(*value)),
            "check loads and units; stresses are those of small strains",
        ),
        Notice::TensionOutside => (
            Code::TensionOutside,
            format!("the tension is {value:.2} times the strength, where damage_where keeps elements from damage"),
            "widen damage_where: cracks start here, or end at its border",
        ),
        Notice::Compression => (
            Code::Compression,
            format!(
                "the compression is {value:.0} times the tensile strength, and criterion = \"rankine\" knows tension alone"
            ),
            "take a criterion with a compressive strength: mohr-coulomb, drucker-prager or mazars",
        ),
        Notice::Stopped => (
            Code::ImpactLoss,
            format!("rigid bodies have taken {} of the energy from solids that met them", percent(*value)),
            "a row of nodes stops at once where it meets a rigid body: the loss halves with the elements",
        ),
        Notice::Crushed => (
            Code::Crushed,
            "the element was turned inside out after it had lost more than half of its stiffness, and was taken out"
                .to_owned(),
            "rock that is crushed still bears pressure, and this does not: try unilateral = true or smaller elements; counts.crushed_elements \
             tells how many they were",
        ),
        Notice::Springs => (
            Code::SoftContact,
            format!(
                "springs of contact hold {} of the elastic energy: solids give way there as half an element does",
                percent(*value)
            ),
            "forces under a given motion lack that share: take smaller elements, or a rigid shape that is driven instead of a solid that is thrown",
        ),
        Notice::ChangeOfStep => (
            Code::ChangeOfStep,
            format!(
                "changes of the time step, a load that began at once, or a body that changed to corotational strains have brought or taken {} of the energy",
                percent(*value)
            ),
            "let loads begin by a ramp, set kinematics = \"corotational\" on bodies that turn, or take a smaller solver.safety",
        ),
        Notice::Gained => (
            Code::EnergyGained,
            format!(
                "friction, damping or interfaces have given {} of the energy, which they can only take",
                percent(*value)
            ),
            "do not trust this run: take a smaller solver.safety or more damping, and supports that hold one side of an interface alone",
        ),
        Notice::InterfaceSlip => (
            Code::InterfaceSlip,
            format!(
                "the sides of the interface beside it have slid by {} of a face, and are not opposite each other any more",
                percent(*value)
            ),
            "they still press on where they were, and meet nothing else: end the run before, or take larger elements along it",
        ),
        Notice::LiquidAtEnd => (
            Code::LiquidAtEnd,
            format!(
                "liquid is everywhere in its interfaces, {}, whose ends let nothing through",
                quantity(*value, "m^2")
            ),
            "a crack would go on: end the run before, or let the interface go farther",
        ),
        Notice::Overdrawn => (
            Code::LiquidOverdrawn,
            format!("an injection has drawn {} more than there was", quantity(*value, "m^3")),
            "end its negative rate before, or give a pressure, which draws no more than there is",
        ),
        Notice::InletBlocked => (
            Code::InletBlocked,
            format!("it waits with {} more: its inlet has no free place", value - 1.0),
            "the rate is not kept: take a lower one, a larger or deeper inlet or a faster initial_velocity; the columns waiting_particles and \
             entered_mass of the history tell how it goes on",
        ),
        Notice::Overlap => (
            Code::DeepOverlap,
            format!(
                "the overlap is {} of the smaller radius, and the law of contact is for small ones",
                percent(*value)
            ),
            "particles may pass through each other: press or hit them less, or make them stiffer (contact.young_modulus of their material)",
        ),
    };
    Warning::new(code, place, text).remedy(remedy)
}

/// A place of the scene in words; nothing of the scene as a whole.
fn place(scene: &Scene, site: Site) -> String {
    let name = |particle: u32| {
        let body = scene.bonded.bodies().iter().find(|body| body.range.contains(&(particle as usize)));
        body.map_or_else(String::new, |body| {
            format!("particle {} of body \"{}\"", particle as usize - body.range.start, body.name)
        })
    };
    match site {
        Site::Scene => String::new(),
        Site::Element { body, element } => {
            let (number, middle) =
                (neighbours::element_number(&scene.solid, body, element), scene.solid.element_middle(body, element));
            format!("element {number} of body \"{}\" at {}", scene.solid.body(body).name, at(middle))
        }
        Site::Node(node) => format!("node at {}", at(scene.solid.reference[node as usize])),
        Site::Particle(particle) => {
            format!("{} at {}", name(particle), at(scene.bonded.particles.position[particle as usize]))
        }
        Site::Particles([first, second]) => {
            let place = at(scene.bonded.particles.position[first as usize]);
            format!("{} and {} at {place}", name(first), name(second))
        }
    }
}
