//! Scatter of strength.

use fractum_math::elementary::{gamma, pow};

/// Random scatter of the tensile strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// How strengths are distributed.
    pub distribution: Distribution,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Scatter {
    /// Weibull's strength with its seed, where a volume or an area belongs to it.
    pub fn weibull(&self) -> Option<(&Weibull, u64)> {
        match &self.distribution {
            Distribution::Weibull(weibull) => Some((weibull, self.seed)),
            Distribution::WeibullPerEdge { .. } | Distribution::UniformPerEdge { .. } => None,
        }
    }
}

/// How strengths are distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// By flaws, the same on any mesh.
    Weibull(Weibull),
    /// A factor that every edge draws for itself, by Weibull with this modulus m > 0 and scale 1: finer meshes are weaker.
    WeibullPerEdge {
        /// Weibull modulus [-], > 0.
        modulus: f64,
    },
    /// A factor that every edge draws for itself, uniform between 1 - width and 1 + width.
    UniformPerEdge {
        /// Half width [-], within 0..1.
        width: f64,
    },
}

/// Strength of the weakest of flaws: a volume V in tension σ survives with exp(-(V/V₀) (σ/f₀)^m) (Weibull 1939).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weibull {
    /// Modulus m [-], > 0.
    pub modulus: f64,
    /// Volume or area of the specimens of which 63 % are weaker than the strength given.
    pub reference: Reference,
    /// Diameter of the place that a flaw weakens [m], > 0; by the process zone if absent.
    pub correlation_length: Option<f64>,
}

/// What flaws are counted by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference {
    /// Volume V₀ [m³], > 0.
    Volume(f64),
    /// Free surface A₀ [m²], > 0.
    Area(f64),
}

impl Reference {
    /// Its volume [m³] or area [m²].
    pub fn measure(&self) -> f64 {
        let (Reference::Volume(measure) | Reference::Area(measure)) = *self;
        measure
    }
}

impl Weibull {
    /// Strength of a flaw over f₀, of which that many weaker ones are expected in the reference volume or area.
    pub fn factor(&self, level: f64) -> f64 {
        pow(level, 1.0 / self.modulus)
    }

    /// Mean strength of bodies of this volume [m³] or area [m²] under uniform tension, over f₀: (V₀/V)^(1/m) Γ(1 + 1/m).
    pub fn mean(&self, measure: f64) -> f64 {
        pow(self.reference.measure() / measure, 1.0 / self.modulus) * gamma(1.0 + 1.0 / self.modulus)
    }

    /// Standard deviation over mean of that strength: √(Γ(1 + 2/m)/Γ(1 + 1/m)² − 1).
    pub fn variation(&self) -> f64 {
        let mean = gamma(1.0 + 1.0 / self.modulus);
        (gamma(1.0 + 2.0 / self.modulus) / (mean * mean) - 1.0).max(0.0).sqrt()
    }
}
