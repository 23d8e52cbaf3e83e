//! Loads that hold from the start, beside what grows.

use fractum_math::{Sym3, Vec3};

use super::super::body::StaticBody;
use crate::fracture::LoadedBonds;
use crate::fracture::criterion::BondLoad;

/// The equilibrium under the constant loads alone, and the virials of both equilibria.
#[derive(Clone, Debug)]
pub(super) struct Constant {
    pub(super) body: StaticBody,
    of_constant: Vec<Sym3>,
    of_growing: Vec<Sym3>,
}

impl Constant {
    pub(super) fn new(body: StaticBody) -> Self {
        let count = body.lattice().len();
        Constant { body, of_constant: vec![Sym3::ZERO; count], of_growing: vec![Sym3::ZERO; count] }
    }

    /// Takes the virials of new equilibria, which are linear in the load factor from here on.
    pub(super) fn update(&mut self, growing: &StaticBody) {
        self.body.virials(&mut self.of_constant);
        growing.virials(&mut self.of_growing);
    }

    /// What bonds bear at a load factor.
    pub(super) fn with<'a>(&'a self, growing: &'a StaticBody, factor: f64) -> Together<'a> {
        Together { constant: self, growing, factor }
    }
}

/// Bonds under the constant loads and a share of what grows.
pub(super) struct Together<'a> {
    constant: &'a Constant,
    growing: &'a StaticBody,
    factor: f64,
}

impl LoadedBonds for Together<'_> {
    fn virials(&self, out: &mut [Sym3]) {
        let Constant { of_constant, of_growing, .. } = self.constant;
        for ((out, constant), growing) in out.iter_mut().zip(of_constant).zip(of_growing) {
            *out = *constant + *growing * self.factor;
        }
    }

    fn load(&self, bond: u32) -> BondLoad {
        let (constant, growing, factor) = (self.constant.body.load(bond), self.growing.load(bond), self.factor);
        BondLoad {
            normal: constant.normal + factor * growing.normal,
            bending: std::array::from_fn(|end| constant.bending[end] + growing.bending[end] * factor),
            torsion: constant.torsion + factor * growing.torsion,
            radius: constant.radius,
        }
    }

    fn axis(&self, bond: u32) -> Vec3 {
        self.growing.axis(bond)
    }
}
