//! Helpers shared by the verification and validation tests.

use fractum_fem::{Body, Elastic, ElementKind};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box};

/// Concrete of the tests: E = 30 GPa, ν = 0.2, ρ = 2400 kg/m³.
pub const CONCRETE: Elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };

/// Nodes and elastic body of a box of tetrahedra with jittered inner nodes.
pub fn jittered_box(cells: [u32; 3], size: Vec3) -> (Vec<Vec3>, Body) {
    let mesh = structured_box(cells, size, Some(Jitter { fraction: 0.15, seed: 7 }));
    (mesh.nodes, Body::new("box", ElementKind::T4, mesh.tetrahedra, CONCRETE))
}

/// A reproducible number in -0.5..0.5.
pub fn noise(index: usize) -> f64 {
    let x = (index as f64 * 12.9898 + 4.1414).sin() * 43758.5453;
    x - x.floor() - 0.5
}
