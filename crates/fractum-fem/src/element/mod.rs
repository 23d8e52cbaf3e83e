//! Constant-gradient simplices.

pub(crate) mod four_turns;
pub(crate) mod polar;
pub(crate) mod reflection;

use fractum_math::Vec3;
use fractum_math::elementary::cbrt;
use serde::{Deserialize, Serialize};

use crate::body::ElementKind;

/// Damage above which a cell carries too little to be judged.
pub(crate) const CARRIES: f64 = 0.5;

/// An element that motion has turned inside out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InvertedElement {
    /// Body it belongs to.
    pub body: usize,
    /// Its number there.
    pub element: u32,
    /// Its present centre [m].
    pub centre: Vec3,
    /// Its present volume over that without load; negative inside out.
    pub volume_ratio: f64,
    /// Damage of the cell that was found, 0 to 1.
    pub damage: f64,
}

impl InvertedElement {
    /// Whether it had lost most of its stiffness before: what is left of it bears too little to keep its shape.
    pub fn is_crushed(&self) -> bool {
        self.damage > CARRIES
    }
}

/// The seven ways a plane cuts a tetrahedron, as sets of its local edges (01)(02)(03)(12)(13)(23).
pub const CUT_MODES: [&[usize]; 7] =
    [&[0, 1, 2], &[0, 3, 4], &[1, 3, 5], &[2, 4, 5], &[1, 2, 3, 4], &[0, 2, 3, 5], &[0, 1, 4, 5]];

/// The three ways a line cuts a triangle, as sets of its local edges (01)(12)(02).
const CUT_MODES_T3: [&[usize]; 3] = [&[0, 2], &[0, 1], &[1, 2]];

/// The ways a crack separates an element of this shape.
pub(crate) fn cut_modes(shape: ElementKind) -> &'static [&'static [usize]] {
    match shape {
        ElementKind::T4 => &CUT_MODES,
        ElementKind::T3 => &CUT_MODES_T3,
    }
}

/// Volume (T4) or area (T3) of an element, and the gradients of its shape functions [1/m].
pub(crate) fn measure_and_gradients(shape: ElementKind, x: &[Vec3; 4]) -> (f64, [Vec3; 4]) {
    match shape {
        ElementKind::T4 => {
            let (a, b, c) = (x[1] - x[0], x[2] - x[0], x[3] - x[0]);
            let det = a.dot(&b.cross(&c));
            let (g1, g2, g3) = (b.cross(&c) / det, c.cross(&a) / det, a.cross(&b) / det);
            (det / 6.0, [-(g1 + g2 + g3), g1, g2, g3])
        }
        ElementKind::T3 => {
            let (a, b) = (x[1] - x[0], x[2] - x[0]);
            let det = a.x * b.y - a.y * b.x;
            let g1 = Vec3::new(b.y, -b.x, 0.0) / det;
            let g2 = Vec3::new(-a.y, a.x, 0.0) / det;
            (det / 2.0, [-(g1 + g2), g1, g2, Vec3::zeros()])
        }
    }
}

/// Edge length of the regular simplex of this measure: (6√2 V)^(1/3) or √(4A/√3) [m].
pub(crate) fn regular_edge(shape: ElementKind, measure: f64) -> f64 {
    match shape {
        ElementKind::T4 => cbrt(6.0 * 2f64.sqrt() * measure),
        ElementKind::T3 => (4.0 * measure / 3f64.sqrt()).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_reproduce_a_linear_field() {
        let x =
            [Vec3::new(0.1, 0.2, 0.0), Vec3::new(1.1, 0.1, 0.3), Vec3::new(0.2, 1.3, 0.1), Vec3::new(0.0, 0.3, 0.9)];
        let slope = Vec3::new(2.0, -3.0, 0.5);
        let (volume, gradients) = measure_and_gradients(ElementKind::T4, &x);
        let sum: Vec3 = x.iter().zip(gradients).map(|(p, g)| g * slope.dot(p)).sum();
        assert!(volume > 0.0 && (sum - slope).norm() < 1e-14);
    }

    #[test]
    fn regular_tetrahedron_has_its_own_edge() {
        let a = 0.7f64;
        assert!((regular_edge(ElementKind::T4, a.powi(3) / (6.0 * 2f64.sqrt())) - a).abs() < 1e-14);
        assert!((regular_edge(ElementKind::T3, 3f64.sqrt() / 4.0 * a * a) - a).abs() < 1e-14);
    }
}
