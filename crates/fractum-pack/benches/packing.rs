//! Packing and bonding: time per packing on the threads given by `RAYON_NUM_THREADS`.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use fractum_pack::{Convention, Domain, PackSpec, bond, dense, pack};

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn pack_box_1000() -> usize {
    pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), 1_000, 1)).map_or(0, |p| p.len())
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn dense_cloud_10000_at_0_6() -> usize {
    // 10,000 spheres of a radius that makes 0.6 of a box that repeats.
    let radius = (0.6 / 10_000.0 * 0.75 / std::f64::consts::PI).cbrt();
    dense(&Domain::cuboid(1.0, 1.0, 1.0), [true; 3], &[radius; 10_000], 1).map_or(0, |centres| centres.len())
}

#[divan::bench(sample_count = 5)]
fn bond_10000_to_coordination_10(bencher: divan::Bencher) {
    let packing = pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000, 1)).ok();
    bencher.bench_local(|| packing.as_ref().and_then(|p| bond(p, 10.0, Convention::All).ok()).map(|n| n.pairs.len()));
}
