//! Natural vibrations that a scene has found.

use fractum_math::Vec3;

/// A natural vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Vibrations in a second [1/s].
    pub frequency: f64,
    /// What is missing to balance, M⁻¹ᐟ² (K φ − ω² M φ) over ω² [-].
    pub residual: f64,
    /// Participation in a motion of the ground along each axis, φᵀ M e [√kg].
    pub participation: Vec3,
    /// Motion of the nodes of solids, of modal mass 1 [1/√kg]; the largest component of all unknowns is positive.
    pub shape: Vec<Vec3>,
    /// Displacement [1/√kg] and rotation [1/(m √kg)] of the particles of bonded bodies.
    pub particles: Vec<[Vec3; 2]>,
}

impl Mode {
    /// Mass that a motion of the ground along each axis sets in motion in this vibration [kg].
    pub fn effective_mass(&self) -> Vec3 {
        self.participation.component_mul(&self.participation)
    }
}

/// Natural vibrations of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modes {
    /// The vibrations, the slowest first.
    pub modes: Vec<Mode>,
    /// Connected pieces; a particle without bonds is none.
    pub pieces: usize,
    /// Particles without bonds, which do not vibrate.
    pub loose: usize,
    /// Rigid motions that nothing prevents.
    pub rigid_motions: usize,
    /// Motions without stiffness beside them.
    pub mechanisms: usize,
    /// Mass that is free to move along each axis [kg].
    pub free_mass: Vec3,
    /// Extensions of the basis, and entries of the factor; no entries where the solution is iterative.
    pub work: (usize, Option<usize>),
    /// Whether all residuals are small enough.
    pub converged: bool,
}

impl Modes {
    /// Shares of the free mass that a motion of the ground along each axis sets in motion in a vibration [-]; 0 where none is free.
    pub fn mass_share(&self, mode: &Mode) -> Vec3 {
        mode.effective_mass().zip_map(&self.free_mass, |own, all| if all > 0.0 { own / all } else { 0.0 })
    }
}
