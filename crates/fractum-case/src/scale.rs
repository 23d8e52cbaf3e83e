//! `verify.scale`: by how much quantities are larger than written.

use super::expression::Type;
use super::unit::Dimension;

/// A factor of all lengths and times; stresses and densities stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale(pub(super) f64);

impl Scale {
    /// By how much a quantity of this dimension is larger than written: kg^a m^b s^c by the power 3 a + b + c of the factor.
    pub(super) fn of(self, dimension: Dimension) -> f64 {
        if self.0 == 1.0 {
            return 1.0;
        }
        let halves = dimension.halves_of_length();
        let whole = self.0.powi(halves.div_euclid(2));
        if halves.rem_euclid(2) == 0 { whole } else { whole * self.0.sqrt() }
    }

    /// The same of a value of an expression: a number without unit takes the scale of what it stands for.
    pub(super) fn of_bare(self, kind: Type, dimension: Dimension) -> f64 {
        if matches!(kind, Type::Number { bare: true, .. }) { self.of(dimension) } else { 1.0 }
    }
}
