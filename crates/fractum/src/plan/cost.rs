//! What a step costs, and how fast the machine is.

use std::hint::black_box;
use std::time::Instant;

use fractum_dem::AnyBondLaw;
use fractum_fem::{ElementKind, Formulation, Kinematics, neighbours};
use fractum_output::frames::WAITING;
use fractum_scene::{BondedBody, Scene};

// Nanoseconds are those of one core that needs `REFERENCE` for the loop of `slowness`.

/// Per element and step: standard, smoothed; the second of each with damage.
const ELEMENT: [[f64; 2]; 2] = [[20.0, 20.0], [45.0, 50.0]];
/// Times as much where elements turn with their bodies: standard, smoothed (tension-bar/gmsh-coarse with `kinematics`, sound and armed, by processor time).
const TURNING: [f64; 2] = [3.2, 1.8];
/// Per bond and step, with its share of particles: beams; interfaces that hold, that may fail, beside a mean strain.
const BOND: [f64; 4] = [60.0, 52.0, 150.0, 160.0];
/// Per loose particle and step, with its contacts in a heap.
const LOOSE_PARTICLE: f64 = 290.0;
/// Per pair that conducts heat and explicit step of the heat.
const HEAT_PAIR: f64 = 8.0;

/// Bytes per tetrahedron, in the order of [`ELEMENT`]: from 64,000 to 511,000 the largest resident memory of a run grows by so much.
const MEMORY_OF_TETRAHEDRON: [[f64; 2]; 2] = [[490.0, 890.0], [700.0, 800.0]];
/// The same per triangle, from 45,000 to 405,000.
const MEMORY_OF_TRIANGLE: [[f64; 2]; 2] = [[850.0, 1080.0], [1030.0, 1090.0]];
/// Bytes per bond, with its share of particles.
const MEMORY_OF_BOND: f64 = 400.0;
/// Bytes of the program itself.
const MEMORY_OF_PROGRAM: f64 = 35e6;
/// Bytes per node of solids that may turn into discrete elements, if all of them do.
const MEMORY_OF_DEBRIS: f64 = 800.0;
/// Bytes in a frame per element or particle, and per bond.
const FRAME: [f64; 2] = [60.0, 20.0];

/// Times the first, sound steps that those of a solid take which cracks: local damage, with a phase field, where compression is split from
/// tension (`unilateral`). Means of the gallery (`fractum verify`, `estimates.md`); a solid that stays sound takes one.
const CRACKING: [f64; 3] = [1.4, 2.0, 3.0];
/// Times as many steps as the first one lets expect where a blast makes many discrete elements, in the plane and in space: their contacts ask
/// for shorter steps, 0.45 and 0.3 of the first one (`dt_min` of granite-disc, gas-blast and shale-pulse; of granite-cylinder and charge), from
/// a third of the run on.
const MORE_STEPS: [f64; 2] = [1.8, 2.3];

/// How much longer the steps of a run become if all solids that may be damaged crack, times how many more there are.
///
/// - `blast`: how much of a blast it is, from 0 to 1; none where it is none at all
pub(super) fn slower_by_cracks(scene: &Scene, blast: Option<f64>) -> f64 {
    let (mut sum, mut elements, mut more) = (0.0, 0, 1.0);
    for body in (0..scene.solid.body_count()).map(|index| scene.solid.body(index)) {
        let factor = match &body.damage {
            None => 1.0,
            // Of a weak blast little is damaged.
            Some(zone) if zone.law.unilateral => CRACKING[0] + blast.unwrap_or(1.0) * (CRACKING[2] - CRACKING[0]),
            Some(zone) if zone.regularisation.is_some() => CRACKING[1],
            Some(_) => CRACKING[0],
        };
        if body.damage.is_some() {
            more = 1.0 + blast.unwrap_or(0.0) * (MORE_STEPS[usize::from(body.shape == ElementKind::T4)] - 1.0);
        }
        sum += factor * body.elements.len() as f64;
        elements += body.elements.len();
    }
    if elements > 0 { more * sum / elements as f64 } else { 1.0 }
}

/// What a run in motion needs.
pub(super) struct Cost {
    /// Time of a step on one core, without output [s].
    step: f64,
    /// The part of it of loose particles [s].
    loose: f64,
    /// Time to conduct heat over the span, on one core [s].
    heat: f64,
    /// Memory without frames [B].
    memory: f64,
    /// Size of a frame [B].
    pub(super) frame: f64,
}

impl Cost {
    /// - `span`: simulated time [s]
    pub(super) fn of(scene: &Scene, span: f64) -> Self {
        let particles = scene.bonded.particles.len() as f64;
        let mut cost =
            Cost { step: 0.0, loose: 0.0, heat: 0.0, memory: MEMORY_OF_PROGRAM, frame: FRAME[0] * particles };
        cost.add_elements(scene);
        for body in scene.bonded.bodies() {
            cost.add_bonds(body);
        }
        if scene.solid.has_damage() {
            cost.memory += MEMORY_OF_DEBRIS * scene.solid.reference.len() as f64;
        }
        if let Some(heat) = scene.heat().filter(|heat| !heat.is_implicit()) {
            let [_, pairs] = heat.counts();
            cost.heat = 1e-9 * HEAT_PAIR * pairs as f64 * (span / heat.step_size()).ceil();
        }
        cost
    }

    fn add_elements(&mut self, scene: &Scene) {
        for index in 0..scene.solid.body_count() {
            let body = scene.solid.body(index);
            let of = |table: &[[f64; 2]; 2]| {
                table[usize::from(body.formulation == Formulation::Smoothed)][usize::from(body.damage.is_some())]
            };
            let memory = match body.shape {
                ElementKind::T3 => &MEMORY_OF_TRIANGLE,
                ElementKind::T4 => &MEMORY_OF_TETRAHEDRON,
            };
            let turning = match body.kinematics {
                Kinematics::Corotational => TURNING[usize::from(body.formulation == Formulation::Smoothed)],
                Kinematics::Small | Kinematics::Auto => 1.0,
            };
            let elements = neighbours::element_count(&scene.solid, index) as f64;
            self.step += 1e-9 * of(&ELEMENT) * turning * elements;
            self.memory += of(memory) * elements;
            self.frame += FRAME[0] * elements;
        }
    }

    fn add_bonds(&mut self, body: &BondedBody) {
        if body.bonds.is_empty() {
            let loose = 1e-9 * LOOSE_PARTICLE * body.range.len() as f64;
            self.step += loose;
            self.loose += loose;
            return;
        }
        let kind = match body.bonds.law() {
            AnyBondLaw::Local(law) if law.mean_strain.is_some() => 3,
            AnyBondLaw::Local(law) if law.can_fail() => 2,
            AnyBondLaw::Local(_) => 1,
            // A law that nobody has timed is taken to cost as much as a beam.
            _ => 0,
        };
        let bonds = body.bonds.len() as f64;
        self.step += 1e-9 * BOND[kind] * bonds;
        self.memory += MEMORY_OF_BOND * bonds;
        self.frame += FRAME[1] * bonds;
    }

    /// Time of the steps and of the heat on this machine, without output [s].
    pub(super) fn time(&self, steps: f64, threads: f64) -> f64 {
        slowness() * (self.step * steps + self.heat) / threads
    }

    /// Time of loose particles over the steps, when they lie in a heap [s].
    pub(super) fn time_of_heap(&self, steps: f64, threads: f64) -> f64 {
        slowness() * self.loose * steps / threads
    }

    /// Memory with the frames that wait to be written, and the one that is being written [B].
    pub(super) fn memory(&self, frames: f64) -> f64 {
        self.memory + self.frame + (frames * self.frame).min(self.frame.max(WAITING as f64))
    }
}

/// Seconds of the loop of [`slowness`] on the core that the costs were measured on.
const REFERENCE: f64 = 11e-6;
/// Times that the loop is tried: the shortest was not interrupted.
const TRIALS: usize = 20;

/// How much slower than that core this one is: the time of a loop of additions, multiplications and divisions, a third of a
/// millisecond in all.
pub(super) fn slowness() -> f64 {
    let mut values = [1.0; 1024];
    let mut timed = || {
        let start = Instant::now();
        for _ in 0..16 {
            let values = black_box(&mut values);
            values.iter_mut().for_each(|value| *value = 0.5 * *value + 1.0 / (*value + 2.0));
        }
        start.elapsed().as_secs_f64()
    };
    (0..TRIALS).map(|_| timed()).fold(f64::INFINITY, f64::min) / REFERENCE
}
