//! Search and law of sphere contacts: `cargo bench -p fractum-contact`.

use divan::Bencher;
use divan::counter::ItemsCount;
use fractum_contact::close_pairs;
use fractum_contact::law::{ContactMemory, Linear, PairMotion, Surface};
use fractum_math::Vec3;

fn main() {
    divan::main();
}

/// Spheres of radius 1 on a grid that touches in every direction.
fn grid(side: usize) -> Vec<Vec3> {
    let place = |i: usize| Vec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64) * 1.99;
    (0..side.pow(3)).map(place).collect()
}

#[divan::bench(args = [21, 46])]
fn search(bencher: Bencher, side: usize) {
    let centres = grid(side);
    let radii = vec![1.0; centres.len()];
    bencher.counter(ItemsCount::new(centres.len())).bench_local(|| close_pairs(&centres, &radii, 0.2));
}

#[divan::bench]
fn linear_law(bencher: Bencher) {
    let law = Linear::between_spheres(30e9, 0.2, [0.01, 0.01], [0.01, 0.01], Surface::default());
    let motion = PairMotion {
        normal: Vec3::x(),
        overlap: 1e-6,
        velocity: Vec3::new(-0.1, 0.2, 0.0),
        spin: Vec3::zeros(),
        dt: 1e-7,
    };
    let mut memory = vec![ContactMemory::default(); 10_000];
    bencher
        .counter(ItemsCount::new(memory.len()))
        .bench_local(|| memory.iter_mut().map(|m| law.force(divan::black_box(&motion), m).stored).sum::<f64>());
}
