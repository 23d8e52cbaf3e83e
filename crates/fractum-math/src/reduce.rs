use rayon::prelude::*;

/// Length of the chunks over which reproducible reductions work.
pub const CHUNK: usize = 4096;

/// Sums `term(i)` for `i` below `count`, in parallel, with the same bits for any number of threads: fixed chunks are
/// summed in order, then their sums are added in order.
pub fn sum_chunks(count: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    let of_chunk = |chunk: usize| -> f64 { (chunk * CHUNK..((chunk + 1) * CHUNK).min(count)).map(&term).sum() };
    add_in_order(count.div_ceil(CHUNK), &of_chunk)
}

/// Apart from its callers, so that the parallel loop is compiled once and not for each term.
fn add_in_order(chunks: usize, of_chunk: &(dyn Fn(usize) -> f64 + Sync)) -> f64 {
    let partial: Vec<f64> = (0..chunks).into_par_iter().map(of_chunk).collect();
    partial.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sum_has_the_same_bits_for_any_number_of_threads() {
        let term = |i: usize| (i as f64 * 0.37).sin() * 1e3;
        let sum = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sum_chunks(100_003, term)).to_bits()
        };
        assert_eq!(sum(1), sum(2));
        assert_eq!(sum(1), sum(7));
    }
}
