use fractum_fem::{CellDamage, Solid};
use fractum_math::Vec3;
use fractum_sparse::SparseError;

use super::contact::Spring;
use super::settings::{LinearSolver, StaticSettings};
use super::system::{LinearWork, System};
use crate::scene::Scene;

/// The linear system of plane or spatial bodies.
pub(super) enum LinearSystem {
    Plane(System<2>),
    Space(System<3>),
}

impl LinearSystem {
    pub(super) fn new(
        solid: &Solid,
        held: &[u8],
        linear: LinearSolver,
        reuse: usize,
        tolerance: f64,
        touching: &[[u32; 2]],
    ) -> Result<Self, SparseError> {
        Ok(if solid.is_plane() {
            LinearSystem::Plane(System::new(solid, held, linear, reuse, tolerance, touching)?)
        } else {
            LinearSystem::Space(System::new(solid, held, linear, reuse, tolerance, touching)?)
        })
    }

    pub(super) fn couples(&self, pair: [u32; 2]) -> bool {
        match self {
            LinearSystem::Plane(system) => system.couples(pair),
            LinearSystem::Space(system) => system.couples(pair),
        }
    }

    pub(super) fn anchors(&self) -> &[f64] {
        match self {
            LinearSystem::Plane(system) => system.anchors(),
            LinearSystem::Space(system) => system.anchors(),
        }
    }

    pub(super) fn work(&mut self) -> &mut LinearWork {
        match self {
            LinearSystem::Plane(system) => &mut system.work,
            LinearSystem::Space(system) => &mut system.work,
        }
    }

    pub(super) fn prepare(
        &mut self,
        scene: &Scene,
        damage: &CellDamage,
        springs: &[Spring],
    ) -> Result<(), SparseError> {
        let anchored = !scene.debris.is_empty();
        match self {
            LinearSystem::Plane(system) => system.prepare(&scene.solid, damage, springs, anchored),
            LinearSystem::Space(system) => system.prepare(&scene.solid, damage, springs, anchored),
        }
    }

    pub(super) fn solve(&mut self, right: &[Vec3], solution: &mut [Vec3]) -> Result<(), SparseError> {
        match self {
            LinearSystem::Plane(system) => system.solve(right, solution),
            LinearSystem::Space(system) => system.solve(right, solution),
        }
    }

    /// As [`System::begin`].
    pub(super) fn begin(&mut self) {
        match self {
            LinearSystem::Plane(system) => system.begin(),
            LinearSystem::Space(system) => system.begin(),
        }
    }

    /// As [`System::sharpen`].
    pub(super) fn sharpen(&mut self) -> Result<bool, SparseError> {
        match self {
            LinearSystem::Plane(system) => system.sharpen(),
            LinearSystem::Space(system) => system.sharpen(),
        }
    }

    pub(super) fn factor_entries(&self) -> Option<usize> {
        match self {
            LinearSystem::Plane(system) => system.factor_entries(),
            LinearSystem::Space(system) => system.factor_entries(),
        }
    }

    pub(super) fn done(&self) -> LinearWork {
        match self {
            LinearSystem::Plane(system) => system.work,
            LinearSystem::Space(system) => system.work,
        }
    }
}

impl StaticSettings {
    /// The linear system of a scene.
    ///
    /// - `touching`: nodes coupled beside those of cells
    pub(super) fn lay_out(&self, scene: &Scene, touching: &[[u32; 2]]) -> Result<LinearSystem, SparseError> {
        let elastic = !scene.solid.has_damage();
        let reuse = if elastic { (self.end / self.step).ceil() as usize } else { 2 };
        let held = scene.supports().held();
        LinearSystem::new(&scene.solid, held, self.linear, reuse, self.linear_tolerance, touching)
    }
}
