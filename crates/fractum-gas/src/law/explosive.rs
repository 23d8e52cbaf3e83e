use super::Jwl;

/// An explosive of the open literature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explosive {
    /// Law of its products.
    pub products: Jwl,
    /// Internal energy over the volume before it reacts [J/m³].
    pub energy: f64,
    /// Velocity of detonation of a wide charge [m/s].
    pub velocity: f64,
}

impl Explosive {
    /// From densities in g/cm³, velocities in km/s, and A, B and e in GPa.
    const fn new([density, velocity]: [f64; 2], [a, b, r1, r2, omega, energy]: [f64; 6]) -> Self {
        let products = Jwl { a: a * 1e9, b: b * 1e9, r1, r2, omega, density: density * 1e3, heat_capacity: 1500.0 };
        Explosive { products, energy: energy * 1e9, velocity: velocity * 1e3 }
    }

    /// Internal energy per mass [J/kg].
    pub fn specific_energy(&self) -> f64 {
        self.energy / self.products.density
    }

    /// PETN, pressed; the others by their density. Dobratz and Crawford, *LLNL Explosives Handbook*, UCRL-52997 (1985).
    pub const PETN_1770: Self = Self::new([1.77, 8.30], [617.0, 16.926, 4.4, 1.2, 0.25, 10.1]);
    /// PETN of 1.50 g/cm³.
    pub const PETN_1500: Self = Self::new([1.50, 7.45], [625.3, 23.29, 5.25, 1.6, 0.28, 8.56]);
    /// PETN of 1.26 g/cm³.
    pub const PETN_1260: Self = Self::new([1.26, 6.54], [573.1, 20.16, 6.0, 1.8, 0.28, 7.19]);
    /// PETN of 0.88 g/cm³.
    pub const PETN_880: Self = Self::new([0.88, 5.17], [348.62, 11.288, 7.0, 2.0, 0.24, 5.02]);
    /// TNT. Dobratz and Crawford (1985).
    pub const TNT: Self = Self::new([1.63, 6.93], [371.213, 3.2306, 4.15, 0.95, 0.30, 7.0]);
    /// ANFO in a wide copper cylinder. Davis and Hill, *Shock Compression of Condensed Matter* (2001) 165-168.
    pub const ANFO: Self = Self::new([0.931, 4.16], [49.46, 1.891, 3.907, 1.118, 0.33333, 2.484]);
    /// Emulsion of 1.31 g/cm³, as simulations of blasts have it.
    pub const EMULSION: Self = Self::new([1.31, 5.50], [214.4, 0.182, 4.2, 0.9, 0.15, 4.192]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Law;

    /// Velocity of the plane detonation of Chapman and Jouguet [m/s]: the least of all waves into the unreacted explosive.
    fn plane_velocity(explosive: &Explosive) -> f64 {
        let Jwl { density, .. } = explosive.products;
        let square = |v: f64| {
            // p on the line of Hugoniot, e = e₀ + ½ p (1 - v) per volume of the explosive; a mass of its density fills 1 m³.
            let line = explosive.products.pressure_line(density, v);
            let pressure = line.at(explosive.energy) / (1.0 - 0.5 * line.slope * (1.0 - v));
            pressure / (density * (1.0 - v))
        };
        (0..4000).map(|k| square(0.55 + 1e-4 * f64::from(k))).fold(f64::INFINITY, f64::min).sqrt()
    }

    #[test]
    fn constants_belong_to_the_velocities_of_detonation() {
        for explosive in [
            Explosive::PETN_1770,
            Explosive::PETN_1500,
            Explosive::PETN_1260,
            Explosive::PETN_880,
            Explosive::TNT,
            Explosive::ANFO,
            Explosive::EMULSION,
        ] {
            let ratio = plane_velocity(&explosive) / explosive.velocity;
            assert!((ratio - 1.0).abs() < 0.02, "{explosive:?}: {ratio}");
        }
    }
}
