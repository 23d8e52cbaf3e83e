//! Helpers shared by the verification and validation tests.

use fractum_fem::{Body, DamageLaw, Elastic, ElementKind, LocalDamping, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box};
use fractum_mesh::topology::{boundary_of_tetrahedra, boundary_of_triangles};
use fractum_scene::statics::{Control, LinearSolver, NoEquilibrium, StaticSettings};
use fractum_scene::{SceneSettings, TimeStepSettings};

/// Concrete of the tests: E = 30 GPa, ν = 0.2, ρ = 2400 kg/m³.
pub const CONCRETE: Elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };

/// Softening of concrete: Rankine, f_t = 3 MPa, exponential.
///
/// - `fracture_energy` [J/m²]
pub fn softening(fracture_energy: f64) -> DamageLaw {
    DamageLaw::rankine(3e6, fracture_energy)
}

/// Undamped motion at 0.8 of the stable step to `end` [s].
///
/// - `balance_stop`: relative residual of the energy balance that stops it
pub fn settings(end: f64, balance_stop: f64) -> SceneSettings {
    SceneSettings {
        time_step: TimeStepSettings { safety: 0.8, element_bound: false, fixed: None, begin: 0.0, end },
        damping: LocalDamping::default(),
        stiffness_time: 0.0,
        balance_stop,
        joined_below: 0.95,
    }
}

/// Equilibria by steps of the load parameter to `end`, by factorisation, which stop where there is none.
pub fn statics(step: f64, end: f64) -> StaticSettings {
    StaticSettings {
        control: Control::Time,
        step,
        turns: Vec::new(),
        end,
        most_steps: 2000,
        tolerance: 1e-10,
        linear_tolerance: 1e-13,
        linear: LinearSolver::Direct,
        no_equilibrium: NoEquilibrium::Stop,
        damping: None,
    }
}

/// Outward facets of the first body of a solid, on holes too; edges in the plane repeat their second node.
pub fn surface(solid: &Solid) -> Vec<[u32; 3]> {
    let elements = &solid.body(0).elements;
    if solid.is_plane() {
        let triangles: Vec<[u32; 3]> = elements.iter().map(|e| [e[0], e[1], e[2]]).collect();
        boundary_of_triangles(&triangles).iter().map(|e| [e.nodes[0], e.nodes[1], e.nodes[1]]).collect()
    } else {
        boundary_of_tetrahedra(elements).iter().map(|facet| facet.nodes).collect()
    }
}

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
