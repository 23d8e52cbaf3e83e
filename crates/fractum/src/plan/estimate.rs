//! How long a run will take: its first steps are taken, and the rest of them counted.

use std::f64::consts::LN_10;
use std::time::Instant;

use fractum_case::build::BuiltScene;
use fractum_case::model::{Case, Load, LoadKind, Probe as DescribedProbe};
use fractum_math::Vec3;
use fractum_math::elementary::{exp, ln};
use fractum_output::frames::Frame;
use fractum_scene::statics::{Control, Stiffness};
use fractum_scene::{GasMeasure, Probe, ProbedScene, Scene};
use fractum_vtk::Cut;

use super::cost::{Cost, slower_by_cracks, slowness};
use crate::input::Input;
use crate::output::record::frame_layout;
use crate::phases::Phases;
use crate::report;
use crate::solver::Solver;
use crate::solver::choice::{PATH_ITERATIONS, solution_time};

/// Seconds of a stage that are tried.
const TRIED: f64 = 0.15;
/// Steps before those that are timed: caches fill, and contacts that are there from the start are found.
const WARM_UP: u64 = 2;
/// Time of one solution on a common machine up to which it is tried [s].
const MOST_TRIED: f64 = 1.6;
/// Seconds per pixel of a picture, of the files of a run that are neither frames nor pictures, and of a row of the history beside its
/// probes, on the core that costs are measured on.
const PIXEL: f64 = 2.5e-8;
const FILES: f64 = 8e-3;
const ROW: f64 = 5e-6;

/// Pressure over tensile strength up to which a hole only cracks, and from which on all around it breaks.
const BREAKS: [f64; 2] = [3.0, 12.0];
/// Instants after its begin at which a pulse is looked at, in so many decades before the end.
const LOOKS: u32 = 600;
const DECADES: f64 = 6.0;

/// What a run takes on this machine [s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Until its first step.
    pub set_up: f64,
    /// For its steps.
    pub steps: f64,
    /// For what it writes.
    pub output: f64,
}

impl Estimate {
    /// All of it.
    pub fn total(&self) -> f64 {
        self.set_up + self.steps + self.output
    }
}

/// How long a run of the case takes on the threads of the present pool; none for bonded bodies at rest, whose first solution may be
/// nearly all of it. The scenes are those after some steps then.
///
/// - `set_up`: time that it took to make the input ready [s]
pub(crate) fn estimate(input: &mut Input, set_up: f64) -> Option<Estimate> {
    let pixels = report::pixels_at_end(&input.built.scene);
    let mut estimate = Estimate { set_up, steps: 0.0, output: 0.0 };
    let (mut start, mut output_frames) = (0.0, 0.0);
    let Input { case, built, later, .. } = input;
    let stages = std::iter::once((&*case, built)).chain(later.iter_mut().map(|(case, built)| (&*case, built)));
    for (case, built) in stages {
        if built.bonded_statics.is_some() {
            return None;
        }
        let stage = Stage { case, span: case.solver.end - start };
        let [frames, rows] = stage.counts(built);
        output_frames += frames;
        let written = stage.written(built, [frames, rows]);
        let began = Instant::now();
        let mut solver = Solver::new(&built.scene, built, &mut Phases::default()).ok()?;
        estimate.set_up += began.elapsed().as_secs_f64();
        let steps = stage.steps(built, &mut solver)?;
        estimate.steps += steps;
        // Frames are compressed beside the steps, on a core of their own.
        estimate.output += written.own + (written.beside - steps).max(0.0);
        start = case.solver.end;
    }
    let movie = if input.case.output.movie { report::pixels_of_movie(output_frames) } else { 0.0 };
    let pixels = pixels + report::pixels_over_time(output_frames) + movie;
    estimate.output += slowness() * (PIXEL * pixels + FILES);
    Some(estimate)
}

/// A stage of a run.
struct Stage<'a> {
    case: &'a Case,
    /// Time from the end of the stage before to that of this one [s].
    span: f64,
}

/// Time of what a stage writes [s].
struct Written {
    /// Between its steps.
    own: f64,
    /// Beside them.
    beside: f64,
}

impl Stage<'_> {
    /// Time of the steps [s].
    fn steps(&self, built: &mut BuiltScene, solver: &mut Solver) -> Option<f64> {
        if built.modes.is_some() {
            // The first step is the whole search.
            return None;
        }
        let breaks = built.scene.solid.has_damage();
        let Some(settings) = &built.statics else { return self.tried(&mut built.scene, solver, built.conducts_alone) };
        let increments = match settings.control {
            Control::Time | Control::TimeThenPath => (self.span / settings.step).ceil(),
            Control::Path | Control::Opening(_) => 1.0,
        };
        let (entries, direct) = Stiffness::new(&built.scene).ok()?.entries();
        let solution = solution_time(entries, direct);
        if solution > MOST_TRIED {
            let times = if breaks { PATH_ITERATIONS } else { increments };
            return Some(times * slowness() * solution);
        }
        let mut step = || {
            let (began, before) = (Instant::now(), solver.iterations());
            solver.step(&mut built.scene, true, &mut Phases::default()).ok()?;
            Some((began.elapsed().as_secs_f64(), (solver.iterations() - before).max(1) as f64))
        };
        let mut tried = step()?;
        // The first step also makes ready what all others use.
        if breaks && tried.0 < TRIED {
            tried = step()?;
        }
        let (seconds, iterations) = tried;
        Some(if breaks { PATH_ITERATIONS.max(increments) * seconds / iterations } else { increments * seconds })
    }

    /// From the first steps to all of them, by the time that they cover, longer where cracks are to come; a heap of loose particles costs at least what it will when it lies.
    fn tried(&self, scene: &mut Scene, solver: &mut Solver, conducts_alone: bool) -> Option<f64> {
        let threads = rayon::current_num_threads() as f64;
        let counted = Cost::of(scene, self.span).time_of_heap(self.span / scene.clock.dt_after, threads);
        let rows = self.case.output.history_every;
        let mut next_row = 0.0;
        let (mut from, mut began, mut taken) = (scene.clock.time, Instant::now(), 0);
        while !solver.is_finished(scene) && began.elapsed().as_secs_f64() < TRIED {
            let measure = !conducts_alone && scene.clock.time >= next_row;
            next_row += if measure { rows } else { 0.0 };
            solver.step(scene, measure, &mut Phases::default()).ok()?;
            taken += 1;
            if taken == WARM_UP && began.elapsed().as_secs_f64() < 0.1 * TRIED {
                (from, began) = (scene.clock.time, Instant::now());
            }
        }
        let share = (scene.clock.time - from) / self.span;
        let all = if share > 0.0 { began.elapsed().as_secs_f64() / share } else { 0.0 };
        Some((all * slower_by_cracks(scene, self.blast(scene))).max(counted))
    }

    /// How much of a blast the stage is: 0 where pulses and gas crack a hole or less, 1 where they break all around it; none without such loads.
    fn blast(&self, scene: &Scene) -> Option<f64> {
        if !self.case.is_blast() {
            return None;
        }
        let solids = (0..scene.solid.body_count()).map(|body| scene.solid.body(body));
        let strengths = solids.filter_map(|body| Some(body.damage.as_ref()?.law.tensile_strength));
        let strength = strengths.fold(f64::INFINITY, f64::min);
        let gas = scene.gas().map_or(0.0, |gas| gas.measure(&scene.solid, GasMeasure::Pressure, None));
        let peak = |load: &Load| match &load.kind {
            LoadKind::Pressure { pressure, .. } => {
                let begin = pressure.value.delay().unwrap_or(0.0);
                let after =
                    |look: u32| self.case.solver.end * exp(-DECADES * LN_10 * f64::from(look) / f64::from(LOOKS));
                let at = |look: u32| pressure.value.value(begin + after(look), Vec3::zeros());
                (0..=LOOKS).map(at).fold(0.0, f64::max)
            }
            _ => 0.0,
        };
        let ratio = self.case.loads.iter().map(peak).fold(gas, f64::max) / strength;
        let [few, many] = BREAKS;
        Some((ln(ratio.max(few) / few) / ln(many / few)).min(1.0))
    }

    /// Numbers of frames and of rows of the history; of a path of equilibria, which has a row for every step, those that its steps ask for.
    fn counts(&self, built: &BuiltScene) -> [f64; 2] {
        let output = &self.case.output;
        let fields = if built.statics.is_some() { output.fields_every_at_rest } else { output.fields_every };
        let [frames, rows] = [fields, output.history_every].map(|every| (self.span / every).ceil() + 1.0);
        match &built.statics {
            Some(settings) if matches!(settings.control, Control::Time | Control::TimeThenPath) => {
                let steps = (self.span / settings.step).ceil() + 1.0;
                [frames.min(steps), steps]
            }
            _ => [frames, rows],
        }
    }

    /// One frame is made, and every probe is read once.
    fn written(&self, built: &BuiltScene, [frames, rows]: [f64; 2]) -> Written {
        let scene = &built.scene;
        let probed = ProbedScene::new(scene);
        let measurements = |(probe, described): (&Option<Box<dyn Probe>>, &DescribedProbe)| {
            let began = Instant::now();
            std::hint::black_box(probe.as_ref()?.value(&probed));
            let count = described.every.map_or(rows, |every| rows.min((self.span / every).ceil() + 1.0));
            Some(count * began.elapsed().as_secs_f64())
        };
        let probes: f64 = built.probes.iter().zip(&self.case.probes).filter_map(measurements).sum();
        let layout = frame_layout(scene, &built.file_order, Vec::new(), self.case, Cut::WHOLE);
        let began = Instant::now();
        let frame = Frame::of(scene, &layout, 0.0);
        let gathered = began.elapsed().as_secs_f64();
        let began = Instant::now();
        let bytes: usize =
            frame.into_iter().flat_map(|frame| frame.files(0)).map(|entry| entry.file.bytes().len()).sum();
        std::hint::black_box(bytes);
        let compressed = began.elapsed().as_secs_f64();
        Written { own: rows * ROW + probes + frames * gathered, beside: frames * compressed }
    }
}
