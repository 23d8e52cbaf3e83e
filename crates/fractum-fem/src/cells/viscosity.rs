//! Viscous stress: proportional to stiffness, and the bulk viscosity of von Neumann and Richtmyer, *J. Appl. Phys.* 21
//! (1950) 232-237, with the linear term of Landshoff (1955): a pressure ρ l (b₁ c + b₂² l |ε̇_v|) |ε̇_v| in compression, which
//! spreads a shock over a few elements.

use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use crate::body::elasticity::Elasticity;
use crate::body::{Body, Depth, ElementKind, Formulation};
use crate::cells::block::Cells;
use crate::element::regular_edge;

/// Viscous stress: β D ε̇, and a bulk viscosity for shocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Viscosity {
    /// Stiffness-proportional time β [s].
    pub stiffness_time: f64,
    /// Coefficient of the linear bulk viscosity, about 0.06.
    pub bulk_linear: f64,
    /// Coefficient of the quadratic bulk viscosity, about 1.2.
    pub bulk_quadratic: f64,
}

impl Viscosity {
    /// Whether there is nothing to do.
    pub fn is_off(&self) -> bool {
        self.stiffness_time == 0.0 && !self.has_bulk()
    }

    pub(crate) fn has_bulk(&self) -> bool {
        self.bulk_linear > 0.0 || self.bulk_quadratic > 0.0
    }
}

/// [`Viscosity`] with the density, wave speed and mesh of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyViscosity {
    pub(crate) constants: Viscosity,
    pub(crate) density: f64,
    pub(crate) wave_speed: f64,
    /// Largest ω l/c of the elements: highest frequency by length over wave speed.
    pub(crate) shape_factor: f64,
}

/// Viscous stress of the cells of a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct ViscousCells {
    /// Stress times volume at the last step [J].
    pub(crate) stress: Vec<Sym3>,
    /// Size of the elements of each cell [m].
    length: Vec<f64>,
    /// Largest b₂² l |ε̇_v|/c of the last step, what the quadratic viscosity adds to the linear coefficient.
    pub(crate) shock: f64,
}

impl ViscousCells {
    /// Cells of a body.
    pub(crate) fn new(body: &Body, Cells { volume, hoop, .. }: &Cells) -> Self {
        // An edge has a share of every element around it: two triangles give a third each, some five tetrahedra a sixth.
        let share = match (body.formulation, body.shape) {
            (Formulation::Standard, _) => 1.0,
            (Formulation::Smoothed, ElementKind::T3) => 2.0 / 3.0,
            (Formulation::Smoothed, ElementKind::T4) => 5.0 / 6.0,
        };
        let depth = |cell: usize| match (body.depth(), hoop) {
            (None, _) => 1.0,
            (Some(Depth::Thickness(thickness)), _) => thickness,
            (Some(Depth::Turn), hoop) => hoop.as_ref().map_or(1.0, |hoop| 2.0 * std::f64::consts::PI / hoop[cell]),
        };
        let length = |(cell, v): (usize, &f64)| regular_edge(body.shape, v / (share * depth(cell)));
        ViscousCells {
            stress: vec![Sym3::ZERO; volume.len()],
            length: volume.iter().enumerate().map(length).collect(),
            shock: 0.0,
        }
    }

    /// Lets go of what only those need who evaluate the cells.
    pub(crate) fn forget(&mut self) {
        (self.stress, self.length) = Default::default();
    }

    pub(crate) fn begin_step(&mut self) {
        self.shock = 0.0;
    }

    /// Viscous stress times volume of a cell, and the mean of those at both ends of the step [J].
    pub(crate) fn update(
        &mut self,
        viscosity: &BodyViscosity,
        elasticity: &Elasticity,
        cell: usize,
        rate: Sym3,
        [integrity, volume]: [f64; 2],
    ) -> [Sym3; 2] {
        let BodyViscosity { constants, density, wave_speed, .. } = *viscosity;
        let mut stress = elasticity.stress(rate) * (constants.stiffness_time * integrity);
        let volumetric = rate.trace();
        if volumetric < 0.0 {
            let length = self.length[cell];
            let shock = constants.bulk_quadratic * constants.bulk_quadratic * length * -volumetric / wave_speed;
            self.shock = self.shock.max(shock);
            let pressure = density * length * wave_speed * (constants.bulk_linear + shock) * -volumetric;
            stress += Sym3::isotropic(-pressure);
        }
        let now = stress * volume;
        [now, (now + std::mem::replace(&mut self.stress[cell], now)) * 0.5]
    }
}
