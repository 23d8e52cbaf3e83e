//! Conduction, per pair and step: `cargo bench -p fractum-heat`.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use divan::Bencher;
use divan::counter::ItemsCount;
use fractum_heat::{HeatField, HeatNetwork};
use fractum_math::Vec3;

fn main() {
    // One core.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first pool of the process");
    divan::main();
}

/// Points on a grid, each with its twelve nearest but faces of the grid: about six pairs per point, as a bonded body has.
fn packed(side: usize) -> HeatField {
    let at = |i: usize, j: usize, k: usize| (i + side * (j + side * k)) as u32;
    let (mut pairs, mut places) = (Vec::new(), Vec::new());
    for (k, j, i) in (0..side).flat_map(|k| (0..side).flat_map(move |j| (0..side).map(move |i| (k, j, i)))) {
        places.push(Vec3::new(i as f64, j as f64, k as f64));
        let ends = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1)];
        let ends = ends.map(|(a, b, c)| (i + a, j + b, k + c)).into_iter().filter(|p| p.0.max(p.1).max(p.2) < side);
        pairs.extend(ends.map(|(a, b, c)| [at(i, j, k), at(a, b, c)]));
    }
    let temperature = places.iter().map(|p: &Vec3| 300.0 + p.x).collect();
    let network = HeatNetwork::new(vec![1.0; places.len()], &pairs, &vec![1.0; pairs.len()]);
    HeatField::new(network, places, temperature, Vec::new())
}

#[divan::bench(args = [27, 100])]
fn explicit_step(bencher: Bencher, side: usize) {
    let mut field = packed(side);
    let dt = 0.8 * field.stable_step();
    let pairs = field.network().pairs().len();
    bencher.counter(ItemsCount::new(pairs)).bench_local(move || field.step(dt));
}
