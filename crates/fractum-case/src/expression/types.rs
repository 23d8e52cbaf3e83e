//! Types of expressions, and the names they may use.

use super::program::Op;
use crate::unit::Dimension;

/// Type of a part of an expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Type {
    /// A condition.
    Truth,
    /// A number with a dimension.
    Number {
        /// Its dimension.
        dimension: Dimension,
        /// Made of numbers without units alone: takes any dimension.
        bare: bool,
        /// Has a factor without unit, which may have been meant to carry one.
        loose: bool,
    },
}

impl Type {
    /// A number of known dimension.
    pub(crate) const fn number(dimension: Dimension) -> Self {
        Type::Number { dimension, bare: false, loose: false }
    }

    /// A number without unit.
    pub(crate) const BARE: Self = Type::Number { dimension: Dimension::NONE, bare: true, loose: true };

    /// SI unit; `1` for a condition.
    pub(crate) fn symbol(self) -> String {
        match self {
            Type::Truth => Dimension::NONE.symbol(),
            Type::Number { dimension, .. } => dimension.symbol(),
        }
    }

    /// `a length`, `a condition`.
    pub(crate) fn phrase(self) -> String {
        match self {
            Type::Truth => "a condition".to_string(),
            Type::Number { bare: true, .. } => "a number without a unit".to_string(),
            Type::Number { dimension, .. } => dimension.phrase(),
        }
    }

    /// Whether it can stand for a quantity of this dimension. `lenient`: a factor without unit may carry any dimension.
    pub(crate) fn fits(self, expected: Dimension, lenient: bool) -> bool {
        match self {
            Type::Truth => false,
            Type::Number { dimension, bare, loose } => dimension == expected || bare || (lenient && loose),
        }
    }

    /// Common type of two things added, compared or chosen between; `None` where there is none.
    pub(super) fn unify(self, other: Self, lenient: bool) -> Option<Self> {
        match (self, other) {
            (Type::Truth, Type::Truth) => Some(Type::Truth),
            (
                Type::Number { dimension: a, bare: a_bare, loose: a_loose },
                Type::Number { dimension: b, bare: b_bare, loose: b_loose },
            ) => {
                let loose = a_loose && b_loose;
                let dimension = match (a_bare, b_bare) {
                    (true, _) => b,
                    (_, true) => a,
                    _ if a == b => a,
                    _ if lenient && a_loose => b,
                    _ if lenient && b_loose => a,
                    _ => return None,
                };
                Some(Type::Number { dimension, bare: a_bare && b_bare, loose })
            }
            _ => None,
        }
    }
}

/// A name with a meaning: how to push it, and its type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Named {
    pub(crate) op: Op,
    pub(crate) kind: Type,
}

/// The names an expression may use besides functions and `pi`.
pub(crate) trait Names {
    /// Whether there is such a name.
    fn contains(&self, name: &str) -> bool;

    /// Whether the name is a variable, such as the time t; other names are those of the case.
    fn is_variable(&self, _name: &str) -> bool {
        false
    }

    /// Its meaning, for use; `None` where there is no such name.
    fn find(&mut self, name: &str) -> Option<Result<Named, String>>;

    /// By how much a number with a unit of this dimension is larger than written.
    fn scale_of(&self, _dimension: Dimension) -> f64 {
        1.0
    }

    /// All names, for suggestions.
    fn all(&self) -> Vec<String>;

    /// Whether `function` reduces the history of a name, as `max(load)` does.
    fn reduces(&self, _function: &str) -> bool {
        false
    }

    /// Whether that function has a time as its second argument, as `at(load, 1 ms)` does.
    fn needs_time(&self, _function: &str) -> bool {
        false
    }

    /// Meaning of such a reduction; `at` is the second argument, a time [s].
    fn reduce(&mut self, function: &str, _name: &str, _at: Option<f64>) -> Result<Named, String> {
        Err(format!("{function} has no meaning here"))
    }
}

/// No names at all.
#[derive(Debug)]
pub(crate) struct NoNames;

impl Names for NoNames {
    fn contains(&self, _: &str) -> bool {
        false
    }

    fn find(&mut self, _: &str) -> Option<Result<Named, String>> {
        None
    }

    fn all(&self) -> Vec<String> {
        Vec::new()
    }
}
