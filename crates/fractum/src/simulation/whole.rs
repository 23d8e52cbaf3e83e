//! A case from its start to its end.

use std::path::Path;

use fractum_math::Vec3;
use fractum_scene::Scene;

use super::{Damaged, Options, Outcome, Simulation};
use crate::error::Failure;
use crate::process::pool;
use crate::process::ranks::Ranks;

/// What a run took beside what its summary tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    /// Processor time of all its threads [s] where the system tells it.
    pub(crate) processor: Option<f64>,
    /// Mean length of the edges of all elements, else mean diameter of the particles [m].
    pub(crate) size: f64,
    /// Particles of bonded and loose bodies.
    pub(crate) particles: u64,
}

/// Runs the case at `path` on threads of its own, as one of several ranks; and what it took.
///
/// # Errors
/// As [`crate::run`].
pub(crate) fn run_whole(path: &Path, options: &Options, ranks: Ranks) -> Result<(Outcome, Measure), Failure> {
    let pool = pool(options.threads)?;
    // Inside the pool, parallel loops start without a hand-over between threads.
    let (outcome, size, particles) = pool.install(|| {
        let mut simulation = Simulation::open_shared(path, options, ranks)?;
        let (size, particles) = (size(simulation.scene()), simulation.scene().bonded.particles.len() as u64);
        while !simulation.is_over() {
            simulation.step()?;
            simulation.record()?;
        }
        if options.pass.is_some() {
            Damaged::of(simulation.scene(), simulation.case()).write(simulation.folder())?;
        }
        Ok::<_, Failure>((simulation.finish()?, size, particles))
    })?;
    let processor = pool.broadcast(|_| processor_time()).into_iter().sum();
    Ok((outcome, Measure { processor, size, particles }))
}

/// Mean length of the edges of all elements, else mean diameter of the particles [m].
fn size(scene: &Scene) -> f64 {
    let solid = &scene.solid;
    let (mut length, mut count) = (0.0, 0usize);
    for body in (0..solid.body_count()).map(|body| solid.body(body)) {
        body.each_edge(solid.reference.len(), |ends| {
            let [a, b]: [Vec3; 2] = ends.map(|node| solid.reference[node as usize]);
            length += (b - a).norm();
            count += 1;
        });
    }
    if count == 0 {
        let radius = &scene.bonded.particles.radius;
        // Those that have left have negative radii.
        (length, count) = (2.0 * radius.iter().map(|radius| radius.abs()).sum::<f64>(), radius.len());
    }
    length / count as f64
}

/// Processor time of this thread [s], as Linux tells it.
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}
