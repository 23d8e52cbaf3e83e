//! Speeds of elastic waves.

#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Elastic waves of an isotropic body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wave {
    /// Compression wave.
    Compression,
    /// Shear wave.
    Shear,
    /// Surface wave, which a crack in tension cannot outrun.
    Rayleigh,
}

/// Speed of a Rayleigh wave [m/s]: with x = (c_R/c_S)² and k = (c_S/c_P)² the root of
/// x³ − 8 x² + 8 (3 − 2k) x − 16 (1 − k) = 0 between 0 and 1.
///
/// - `p`, `s`: speeds of compression and shear waves [m/s], s < p
///
/// Achenbach, *Wave Propagation in Elastic Solids* (1973), section 5.11.
pub fn rayleigh_wave_speed(p: f64, s: f64) -> f64 {
    let k = (s / p) * (s / p);
    let cubic = |x: f64| ((x - 8.0) * x + 8.0 * (3.0 - 2.0 * k)) * x - 16.0 * (1.0 - k);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if cubic(middle) < 0.0 { low = middle } else { high = middle }
    }
    s * (0.5 * (low + high)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Elastic;

    /// c_R/c_S is 0.9194 for ν = 1/4 (exactly √(2 − 2/√3)), 0.8740 for ν = 0, 0.9553 for ν = 1/2.
    #[test]
    fn rayleigh_waves_have_the_speed_of_the_textbooks() {
        for (poisson_ratio, ratio) in [(0.25, (2.0 - 2.0 / 3f64.sqrt()).sqrt()), (0.0, 0.874_032), (0.4999, 0.955_3)] {
            let rock = Elastic { density: 2660.0, young_modulus: 60e9, poisson_ratio };
            let found = rayleigh_wave_speed(rock.p_wave_speed(), rock.s_wave_speed()) / rock.s_wave_speed();
            assert!((found / ratio - 1.0).abs() < 1e-4, "{poisson_ratio}: {found}");
        }
    }
}
