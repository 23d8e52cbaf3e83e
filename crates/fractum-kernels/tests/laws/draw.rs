//! Rows of laws, and the numbers that they are tried with.

use std::f64::consts::PI;

use fractum_kernels::material::Softening;
use fractum_kernels::{Mat3, Vec3};
use nalgebra::Rotation3;

/// What is wrong with a law, in words.
pub(crate) type Held = Result<(), String>;

/// A law with the properties that it must have.
pub(crate) struct Row {
    pub(crate) law: &'static str,
    pub(crate) holds: fn(&mut Draw) -> Held,
}

/// How often every row draws.
pub(crate) const DRAWS: u64 = 300;

/// Fails unless every law has its properties in all draws; names the row and the first draw that it fails. `FRACTUM_LAWS_SEED` (a number) draws others.
pub(crate) fn try_all(laws: &[Row]) {
    let seed: u64 = std::env::var("FRACTUM_LAWS_SEED").map_or(0, |seed| seed.parse().expect("a number"));
    // Rows cost more or less, and so do draws: threads take those of each row by turns.
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get() as u64);
    let failed_of = |first: u64| -> Vec<(usize, u64, String)> {
        let tried =
            (0..laws.len()).flat_map(|row| (first..DRAWS).step_by(threads as usize).map(move |draw| (row, draw)));
        let fails = |row: usize, draw| (laws[row].holds)(&mut Draw::new(row as u64 + 1000 * seed, draw)).err();
        tried.filter_map(|(row, draw)| Some((row, draw, fails(row, draw)?))).collect()
    };
    let mut failed: Vec<(usize, u64, String)> = std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|first| scope.spawn(move || failed_of(first))).collect();
        running.into_iter().flat_map(|thread| thread.join().expect("laws panic nowhere")).collect()
    });
    failed.sort_unstable();
    let of_rows = failed.chunk_by(|one, next| one.0 == next.0);
    let wrong: Vec<String> = of_rows
        .map(|of| {
            let (row, draw, what) = &of[0];
            format!("{}: {} of {DRAWS} draws, the first is {draw}: {what}", laws[*row].law, of.len())
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Random numbers of one draw (SplitMix64).
pub(crate) struct Draw(u64);

impl Draw {
    pub(crate) fn new(row: u64, draw: u64) -> Self {
        Draw(row.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ draw.wrapping_mul(0xd1b5_4a32_d192_ed03))
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Between two positive numbers, evenly over decades.
    pub(crate) fn over_decades(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(crate) fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.bits() % all.len() as u64) as usize]
    }

    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    pub(crate) fn turn(&mut self) -> Mat3 {
        Rotation3::new(self.vector() * PI).into_inner()
    }

    pub(crate) fn turn_in_plane(&mut self) -> Mat3 {
        Rotation3::new(Vec3::z() * self.between(-PI, PI)).into_inner()
    }
}

/// An error unless a condition holds.
pub(crate) fn hold(holds: bool, what: impl FnOnce() -> String) -> Held {
    if holds { Ok(()) } else { Err(what()) }
}

/// A bilinear curve as a case gives it: stress of the kink over the strength, its opening over the last one.
pub(crate) fn bilinear(draw: &mut Draw) -> Softening {
    let (stress, share) = (draw.between(0.02, 0.98), draw.between(0.02, 0.98));
    Softening::Bilinear { stress, opening: 2.0 * share / (stress + share) }
}
