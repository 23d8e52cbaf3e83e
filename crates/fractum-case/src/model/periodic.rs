//! A box through whose sides particles meet.

use fractum_math::Vec3;

use crate::{Place, Spanned, TimeFunction};

/// The periodic box of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// Where it is written.
    pub place: Place,
    /// Its corner with the smallest coordinates [m].
    pub point: Vec3,
    /// Its edges along x, y, z [m].
    pub size: Spanned<Vec3>,
    /// Along which axes it repeats.
    pub axes: [bool; 3],
    /// Rates of its deformation: components i, j of ∂v_i/∂x_j with i ≤ j [1/s].
    pub rates: Vec<([usize; 2], Spanned<TimeFunction>)>,
    /// How it holds stresses.
    pub servo: Option<BoxServo>,
}

/// Normal stresses that a periodic box holds.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxServo {
    /// Axes with their stresses, tension positive [Pa].
    pub stress: Vec<(usize, Spanned<TimeFunction>)>,
    /// Largest rate [1/s].
    pub rate: f64,
    /// Share of the stress that is missing where it begins to slow down.
    pub slows_at: f64,
}

/// Difference of two boxes over their smallest edge that is rounding.
const SAME: f64 = 1e-9;

impl Periodic {
    /// Whether a box goes from one side to the other along an axis.
    ///
    /// - `point`, `size` [m]: where it begins, and how long it is
    pub fn spans(&self, axis: usize, point: f64, size: f64) -> bool {
        let limit = SAME * self.size.value.min();
        (point - self.point[axis]).abs() <= limit && (size - self.size.value[axis]).abs() <= limit
    }

    /// Its functions of time.
    pub fn functions(&self) -> impl Iterator<Item = &Spanned<TimeFunction>> {
        let stresses = self.servo.iter().flat_map(|servo| servo.stress.iter().map(|(_, stress)| stress));
        self.rates.iter().map(|(_, rate)| rate).chain(stresses)
    }

    /// Whether it deforms.
    pub fn deforms(&self) -> bool {
        !self.rates.is_empty() || self.servo.is_some()
    }
}
