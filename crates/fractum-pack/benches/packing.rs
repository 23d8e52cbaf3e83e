//! Packing and bonding: time per packing on the threads given by `RAYON_NUM_THREADS`.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use fractum_pack::{Convention, Domain, PackSpec, bond, pack};

fn main() {
    divan::main();
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn pack_box_1000() -> usize {
    pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), 1_000, 1)).map_or(0, |p| p.len())
}

#[divan::bench(sample_count = 5)]
fn bond_10000_to_coordination_10(bencher: divan::Bencher) {
    let packing = pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000, 1)).ok();
    bencher.bench_local(|| packing.as_ref().and_then(|p| bond(p, 10.0, Convention::All).ok()).map(|n| n.pairs.len()));
}
