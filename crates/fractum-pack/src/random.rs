use rand_pcg::Pcg64Mcg;

/// The named generator of a packing: PCG XSL 128/64 (MCG), so that a seed gives the same packing on every machine.
///
/// Uniform numbers are made from the 53 high bits here, independent of any library's choice of distribution.
pub(crate) struct Random(Pcg64Mcg);

impl Random {
    /// Name and version of the stream, stored with every packing.
    pub(crate) const NAME: &str = "pcg64mcg/53bit/1";

    pub(crate) fn new(seed: u64) -> Self {
        // An odd multiplier spreads neighbouring seeds over the state; the stream starts after a few warming draws.
        let state =
            (u128::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15_F39C_C060_5CED_C835)) ^ (u128::from(seed) << 64);
        let mut random = Random(Pcg64Mcg::new(state));
        for _ in 0..8 {
            random.uniform();
        }
        random
    }

    /// A number in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        use rand_pcg::rand_core::Rng;
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// A number in [lower, upper).
    pub(crate) fn between(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * self.uniform()
    }
}
