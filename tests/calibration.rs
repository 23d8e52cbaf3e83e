//! What the time of a bench is divided by: a loop of arithmetic and a stream through memory, the same in every bench program.
//!
//! Each of the programs includes this file, so that both are timed beside its own benches, within a minute on the same machine.

use divan::{Bencher, black_box};

/// A hundred passes over 1,000 values that stay in the nearest cache: ten products and sums and a quotient per value.
#[divan::bench]
fn arithmetic(bencher: Bencher) {
    let start: Vec<f64> = (0..1000).map(|i| 1e-3 * f64::from(i)).collect();
    bencher.bench_local(|| {
        let mut values = black_box(&start).clone();
        for _ in 0..100 {
            for x in &mut values {
                let square = *x * *x;
                let series = 1.0 + square * (0.5 + square * (0.2 + square * (0.1 + square * 0.05)));
                *x = (1.0 + *x) / (series + *x);
            }
        }
        values
    });
}

/// Two arrays of 32 MiB summed into a third.
#[divan::bench]
fn memory(bencher: Bencher) {
    const COUNT: usize = 4 << 20;
    let (left, right) = (vec![1.0; COUNT], vec![2.0; COUNT]);
    let mut sum = vec![0.0; COUNT];
    bencher.bench_local(|| {
        for ((sum, left), right) in sum.iter_mut().zip(black_box(&left)).zip(black_box(&right)) {
            *sum = left + 0.5 * right;
        }
        black_box(&sum)[COUNT / 2]
    });
}
