//! Bonded packings: one tension solve, and explicit steps, on the threads given by `RAYON_NUM_THREADS`.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use fractum_calibrate::{Micro, Sample, lab};
use fractum_dem::{Bonds, CentralDifference, ParticleDamping, Particles, Tolerance};
use fractum_pack::{Convention, Domain, PackSpec, pack};

fn main() {
    divan::main();
}

/// A box of glass at coordination 10.
fn sample(count: usize) -> Option<Sample> {
    let packing = pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), count, 1)).ok()?;
    let mut sample = Sample::new(packing, 10.0, Convention::All).ok()?;
    sample.set_micro(Micro { radius_ratio: 0.348, young_modulus: 677.94e9 }).ok()?;
    Some(sample)
}

#[divan::bench(sample_count = 20)]
fn tension_solve_10000(bencher: divan::Bencher) {
    let sample = sample(10_000);
    bencher
        .bench_local(|| sample.as_ref().and_then(|s| lab::tension(s, 0, None, Tolerance::default()).ok()).map(|t| t.0));
}

#[divan::bench(sample_count = 50)]
fn explicit_step_10000(bencher: divan::Bencher) {
    let Some(sample) = sample(10_000) else { return };
    let Sample { packing, network, lattice, .. } = sample;
    let Ok(mut particles) = Particles::at_rest(packing.position, packing.radius, 2500.0 * 8e-9) else { return };
    let Ok(mut bonds) = Bonds::new(&particles, &network.pairs, lattice.section()) else { return };
    let dt = bonds.stable_step(&particles, 0.7);
    let mut motion = CentralDifference::new(&particles, dt, ParticleDamping::default());
    particles.velocity.iter_mut().enumerate().for_each(|(i, v)| v.x = 1e-3 * (i as f64).sin());
    bencher.counter(divan::counter::ItemsCount::new(network.pairs.len())).bench_local(|| {
        motion.kick_and_drift(&mut particles);
        particles.clear_forces();
        bonds.add_forces(&mut particles);
    });
}
