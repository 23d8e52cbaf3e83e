//! The linear law of a body: Hooke's, or that of bedded rock.

use fractum_kernels::material::{Hooke, Stiffness};
use fractum_math::{Sym3, Vec3};
use nalgebra::Matrix6;

use crate::body::{Body, ElementKind};

/// Part of the largest stiffness that components without stress get, where a matrix must have an inverse.
const NONE: f64 = 1e-9;

/// The linear law of a body.
#[derive(Clone, Debug)]
pub(crate) struct Elasticity {
    /// The law without beds, and within them.
    pub(crate) hooke: Hooke,
    /// The law with beds.
    pub(crate) bedded: Option<Box<Stiffness>>,
}

/// A law that gives the stress of a strain [Pa].
pub(crate) trait Linear: Copy {
    /// Whether stress has the axes of strain.
    const IS_COAXIAL: bool;
    fn stress(&self, strain: Sym3) -> Sym3;
}

impl Linear for Hooke {
    const IS_COAXIAL: bool = true;

    #[inline(always)]
    fn stress(&self, strain: Sym3) -> Sym3 {
        Hooke::stress(self, strain)
    }
}

impl Linear for &Stiffness {
    const IS_COAXIAL: bool = false;

    #[inline(always)]
    fn stress(&self, strain: Sym3) -> Sym3 {
        Stiffness::stress(self, strain)
    }
}

impl Elasticity {
    pub(crate) fn new(body: &Body) -> Self {
        Elasticity { hooke: body.hooke(), bedded: body.stiffness().map(Box::new) }
    }

    /// Stress of a strain [Pa].
    #[inline(always)]
    pub(crate) fn stress(&self, strain: Sym3) -> Sym3 {
        match &self.bedded {
            None => self.hooke.stress(strain),
            Some(stiffness) => stiffness.stress(strain),
        }
    }

    /// ρ c² of the fastest compression wave, whatever its direction [Pa].
    pub(crate) fn wave_modulus(&self, body: &Body) -> f64 {
        body.extreme_moduli().map_or(self.hooke.lambda + 2.0 * self.hooke.mu, |[fastest, _]| fastest)
    }

    /// Sum over gradients of ρ c² of the three waves along them, times the squares of their lengths [Pa].
    pub(crate) fn trace_sum(&self, gradients: &[Vec3]) -> f64 {
        let Some(stiffness) = &self.bedded else {
            let Hooke { lambda, mu, .. } = self.hooke;
            return gradients.iter().map(|g| g.norm_squared()).sum::<f64>() * (lambda + 2.0 * mu + 2.0 * mu);
        };
        let all = stiffness.sum_over_waves().to_matrix();
        gradients.iter().map(|g| g.dot(&(all * g))).sum()
    }

    /// What the hoop strains of the three nodes of an element around an axis add to [`Elasticity::trace_sum`].
    ///
    /// - `hoop`: its inverse radius, else 0 [1/m]
    pub(crate) fn hoop_trace(&self, hoop: f64) -> f64 {
        (self.hooke.lambda + 2.0 * self.hooke.mu) * hoop * hoop / 3.0
    }

    /// Sum of ρ c² of the three waves along the direction where it is largest [Pa].
    pub(crate) fn largest_trace(&self) -> f64 {
        match &self.bedded {
            None => self.hooke.lambda + 4.0 * self.hooke.mu,
            Some(stiffness) => stiffness.sum_over_waves().eigen().0[0],
        }
    }

    /// Stress per strain with engineering shears, which has an inverse [Pa].
    pub(crate) fn matrix(&self) -> Matrix6<f64> {
        let Some(stiffness) = &self.bedded else {
            let Hooke { lambda, mu, .. } = self.hooke;
            let normal = |i: usize, j: usize| lambda + if i == j { 2.0 * mu } else { 0.0 };
            let shear = |i: usize, j: usize| if i == j { mu } else { 0.0 };
            return Matrix6::from_fn(|i, j| if i < 3 && j < 3 { normal(i, j) } else { shear(i, j) });
        };
        let mut matrix = Matrix6::from_fn(|i, j| stiffness.rows()[i][j]);
        let least = NONE * matrix.diagonal().max();
        (0..6).for_each(|i| matrix[(i, i)] = matrix[(i, i)].max(least));
        matrix
    }
}

impl Body {
    /// Its law, where it has beds.
    pub fn stiffness(&self) -> Option<Stiffness> {
        self.bedding.map(|bedding| Stiffness::new(&self.elastic, &bedding, self.across()))
    }

    /// Speed of a compression wave in the bulk; with beds the slower of those along their normal and within them, about [m/s].
    pub fn bulk_wave_speed(&self) -> f64 {
        let within = self.elastic.p_wave_speed();
        self.bedding.map_or(within, |bedding| {
            let waves = Stiffness::new(&self.elastic, &bedding, None).of_waves(bedding.normal);
            (waves.eigen().0[0] / self.elastic.density).sqrt().min(within)
        })
    }

    /// ρ c² of the fastest and of the slowest wave over all directions of a body with beds [Pa].
    pub fn extreme_moduli(&self) -> Option<[f64; 2]> {
        let normal = self.bedding?.normal;
        let in_plane = self.shape == ElementKind::T3;
        // Around the normal all directions are the same.
        let within = normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize();
        let spanned = if in_plane { [Vec3::x(), Vec3::y()] } else { [normal, within] };
        Some(self.stiffness()?.extreme_moduli(spanned, in_plane))
    }
}
