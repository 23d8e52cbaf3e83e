//! What may be combined with what, and the type that comes of it.

use super::ExpressionError;
use super::program::{Binary, Unary};
use super::types::Type;
use crate::Choice;
use crate::unit::Dimension;

/// The rules of types.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    /// A factor without unit may carry any dimension.
    pub(super) lenient: bool,
}

type Result<T, E = ExpressionError> = std::result::Result<T, E>;

impl Rules {
    /// A type that must be that of a number.
    pub(super) fn number(self, kind: Type, what: &str, offset: usize) -> Result<Type> {
        match kind {
            Type::Truth => Err(ExpressionError::new(offset, format!("{what} needs a number, not a condition"))),
            Type::Number { .. } => Ok(kind),
        }
    }

    /// Common type of two things added, compared or chosen between.
    pub(super) fn common(self, a: Type, b: Type, offset: usize) -> Result<Type> {
        a.unify(b, self.lenient).ok_or_else(|| {
            let message = format!("{} and {} cannot be added or compared", a.phrase(), b.phrase());
            ExpressionError::new(offset, message)
        })
    }

    /// Type of an operator, or function of two arguments.
    pub(super) fn binary(self, operator: Binary, a: Type, b: Type, offset: usize) -> Result<Type> {
        use Binary::*;
        match operator {
            And | Or => {
                if a == Type::Truth && b == Type::Truth {
                    return Ok(Type::Truth);
                }
                let message = format!("\"{}\" needs conditions on both sides", operator.name());
                Err(ExpressionError::new(offset, message))
            }
            Multiply | Divide => self.product(operator, a, b, offset),
            Add | Subtract | Min | Max | Hypot => {
                let common = self.common(a, b, offset)?;
                self.number(common, "an operator", offset)
            }
            Less | LessEqual | Greater | GreaterEqual | Equal | NotEqual => {
                let common = self.common(a, b, offset)?;
                self.number(common, "a comparison", offset)?;
                Ok(Type::Truth)
            }
            Atan2 => {
                let common = self.common(a, b, offset)?;
                self.number(common, "atan2()", offset)?;
                Ok(Type::number(Dimension::NONE))
            }
            Power => Err(ExpressionError::new(offset, "unexpected \"^\"")),
        }
    }

    fn product(self, operator: Binary, a: Type, b: Type, offset: usize) -> Result<Type> {
        let (
            Type::Number { dimension: a_dimension, bare: a_bare, loose: a_loose },
            Type::Number { dimension: b_dimension, bare: b_bare, loose: b_loose },
        ) = (a, b)
        else {
            return Err(ExpressionError::new(offset, "a product needs numbers, not conditions"));
        };
        let dimension = match operator {
            Binary::Divide => a_dimension.over(b_dimension),
            _ => a_dimension.times(b_dimension),
        };
        let dimension = dimension.ok_or_else(|| too_high(offset))?;
        Ok(Type::Number { dimension, bare: a_bare && b_bare, loose: a_loose || b_loose })
    }

    /// Type of `base ^ exponent`; `value` is that of the exponent where it is constant.
    pub(super) fn power(self, base: Type, exponent: Type, value: Option<f64>, offset: usize) -> Result<Type> {
        if !exponent.fits(Dimension::NONE, self.lenient) {
            let message = format!("an exponent must be a pure number, not {}", exponent.phrase());
            return Err(ExpressionError::new(offset, message));
        }
        match base {
            Type::Truth => Err(ExpressionError::new(offset, "a power needs a number, not a condition")),
            Type::Number { dimension: Dimension::NONE, bare, loose } => {
                let bare = bare && matches!(exponent, Type::Number { bare: true, .. });
                Ok(Type::Number { dimension: Dimension::NONE, bare, loose })
            }
            Type::Number { dimension, loose, .. } => {
                let Some(value) = value else {
                    let message = format!("{} can be raised to a constant power only", dimension.phrase());
                    return Err(ExpressionError::new(offset, message));
                };
                let dimension = dimension.power(value).ok_or_else(|| too_high(offset))?;
                Ok(Type::Number { dimension, bare: false, loose })
            }
        }
    }

    /// Type of a function of one argument.
    pub(super) fn unary(self, function: Unary, a: Type, offset: usize) -> Result<Type> {
        let name = function.name();
        let Type::Number { dimension, bare, loose } = a else {
            return Err(ExpressionError::new(offset, format!("{name}() needs a number, not a condition")));
        };
        match function {
            Unary::Abs => Ok(a),
            Unary::Sign => Ok(Type::number(Dimension::NONE)),
            Unary::Sqrt => {
                let dimension = dimension.power(0.5).ok_or_else(|| too_high(offset))?;
                Ok(Type::Number { dimension, bare, loose })
            }
            _ if a.fits(Dimension::NONE, self.lenient) => Ok(Type::Number { dimension: Dimension::NONE, bare, loose }),
            _ => {
                let error = ExpressionError::new(offset, format!("{name}() of {}", a.phrase()));
                Err(error.remedy("divide by a quantity of that kind first"))
            }
        }
    }
}

fn too_high(offset: usize) -> ExpressionError {
    ExpressionError::new(offset, "the units of this have no meaning")
}
