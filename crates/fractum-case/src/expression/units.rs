//! Products of units: `kg/m^3`, `m s^-1`, `J/(m^2 K)`, `1/s`.

use super::lexer::{Kind, Token, tokens};
use super::{ExpressionError, Names, NoNames};
use crate::unit::Unit;

/// Reads a unit that stands alone; `1` and `-` are the pure number.
pub(crate) fn parse_unit(text: &str) -> Result<Unit, ExpressionError> {
    let tokens = tokens(text)?;
    let mut at = 0;
    let unit = match (tokens[0].kind, tokens.get(1).map(|token| token.kind)) {
        (Kind::Number("1") | Kind::Symbol("-"), Some(Kind::End)) => return Ok(Unit::ONE),
        (Kind::Number("1"), Some(Kind::Symbol("/"))) => {
            at = 1;
            product(&tokens, &mut at, Unit::ONE, &NoNames)?
        }
        (Kind::Name(_), _) => unit_after_number(&tokens, &mut at, &NoNames)?,
        _ => Unit::ONE,
    };
    if at == 0 || tokens[at].kind != Kind::End {
        return Err(ExpressionError::new(tokens[at].offset, format!("\"{text}\" is not a unit")));
    }
    Ok(unit)
}

/// Reads the unit at `at`, just behind a number, and moves `at` past it; the pure number where there is none.
///
/// A name directly behind the number is a unit. So is one behind `*` or `/`, unless it is a variable of the expression;
/// a parameter or probe of that name is refused there, since it would change the quantity.
pub(super) fn unit_after_number(
    tokens: &[Token<'_>],
    at: &mut usize,
    names: &dyn Names,
) -> Result<Unit, ExpressionError> {
    match tokens[*at].kind {
        Kind::Name(_) => {
            let first = factor(tokens, at, Unit::ONE, 1.0)?;
            product(tokens, at, first, names)
        }
        Kind::Number("1") if divides_unit(tokens, *at + 1, names)? => {
            *at += 1;
            product(tokens, at, Unit::ONE, names)
        }
        _ => Ok(Unit::ONE),
    }
}

/// Continues a product of units for as long as it goes on.
fn product(tokens: &[Token<'_>], at: &mut usize, mut unit: Unit, names: &dyn Names) -> Result<Unit, ExpressionError> {
    loop {
        match tokens[*at].kind {
            Kind::Name(_) => unit = factor(tokens, at, unit, 1.0)?,
            Kind::Symbol(symbol @ ("*" | "/")) if is_unit(tokens, *at + 1, names)? => {
                *at += 1;
                unit = factor(tokens, at, unit, if symbol == "/" { -1.0 } else { 1.0 })?;
            }
            Kind::Symbol("/") => match bracket(tokens, *at + 1, names)? {
                Some((below, end)) => {
                    unit = times(unit, below, -1.0, tokens[*at].offset)?;
                    *at = end;
                }
                None => return Ok(unit),
            },
            _ => return Ok(unit),
        }
    }
}

/// A bracket of units alone, with the index behind it.
fn bracket(tokens: &[Token<'_>], at: usize, names: &dyn Names) -> Result<Option<(Unit, usize)>, ExpressionError> {
    let opens = tokens.get(at).is_some_and(|token| token.kind == Kind::Symbol("("));
    if !opens || !is_unit(tokens, at + 1, names)? {
        return Ok(None);
    }
    let mut end = at + 1;
    let inside = factor(tokens, &mut end, Unit::ONE, 1.0).and_then(|first| product(tokens, &mut end, first, names));
    let closes = tokens[end].kind == Kind::Symbol(")");
    Ok(inside.ok().filter(|_| closes).map(|unit| (unit, end + 1)))
}

/// Whether a division by a unit stands at `at`.
fn divides_unit(tokens: &[Token<'_>], at: usize, names: &dyn Names) -> Result<bool, ExpressionError> {
    let divides = tokens.get(at).is_some_and(|token| token.kind == Kind::Symbol("/"));
    Ok(divides && (is_unit(tokens, at + 1, names)? || bracket(tokens, at + 1, names)?.is_some()))
}

/// Whether the token at `at` is a unit and no variable or function.
///
/// # Errors
/// It is a name of the case as well.
fn is_unit(tokens: &[Token<'_>], at: usize, names: &dyn Names) -> Result<bool, ExpressionError> {
    let called = tokens.get(at + 1).is_some_and(|token| token.kind == Kind::Symbol("("));
    let Some(&Token { kind: Kind::Name(name), offset }) = tokens.get(at) else { return Ok(false) };
    if called || names.is_variable(name) || Unit::find(name).is_none() {
        return Ok(false);
    }
    if names.contains(name) {
        let error = ExpressionError::new(offset, format!("\"{name}\" is a unit and also a name of this case"));
        return Err(error.remedy(format!("rename the parameter or probe \"{name}\"")));
    }
    Ok(true)
}

/// Multiplies `unit` by the unit at `at` raised to `sign` times the exponent that follows it.
fn factor(tokens: &[Token<'_>], at: &mut usize, unit: Unit, sign: f64) -> Result<Unit, ExpressionError> {
    let Token { kind: Kind::Name(name), offset } = tokens[*at] else {
        return Err(ExpressionError::new(tokens[*at].offset, "expected a unit"));
    };
    let Some(found) = Unit::find(name) else {
        let error = ExpressionError::new(offset, format!("\"{name}\" is not a unit"));
        return Err(match Unit::nearest(name) {
            Some(near) => error.remedy(format!("did you mean \"{near}\"?")),
            None => error.remedy("units are SI with prefixes, and min, h, deg, %, t, L, bar, psi, in, ft"),
        });
    };
    *at += 1;
    let exponent = exponent(tokens, at)?;
    times(unit, found, sign * exponent, offset)
}

/// The exponent at `at`, 1 where there is none.
fn exponent(tokens: &[Token<'_>], at: &mut usize) -> Result<f64, ExpressionError> {
    if let Kind::Raised(exponent) = tokens[*at].kind {
        *at += 1;
        return Ok(f64::from(exponent));
    }
    if tokens[*at].kind != Kind::Symbol("^") {
        return Ok(1.0);
    }
    *at += 1;
    let bracketed = tokens[*at].kind == Kind::Symbol("(");
    *at += usize::from(bracketed);
    let negative = tokens[*at].kind == Kind::Symbol("-");
    *at += usize::from(negative);
    let Kind::Number(digits) = tokens[*at].kind else {
        return Err(ExpressionError::new(tokens[*at].offset, "the exponent of a unit must be a number"));
    };
    *at += 1;
    if bracketed {
        if tokens[*at].kind != Kind::Symbol(")") {
            return Err(ExpressionError::new(tokens[*at].offset, "expected \")\" behind the exponent of a unit"));
        }
        *at += 1;
    }
    let value = digits.parse().unwrap_or(f64::NAN);
    Ok(if negative { -value } else { value })
}

fn times(unit: Unit, other: Unit, exponent: f64, offset: usize) -> Result<Unit, ExpressionError> {
    unit.times(other, exponent)
        .ok_or_else(|| ExpressionError::new(offset, "the exponents of a unit must be small multiples of one half"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::Dimension;

    #[test]
    fn products_quotients_and_powers() {
        for (text, size, dimension) in [
            ("kg/m^3", 1.0, Dimension::DENSITY),
            ("g/cm^3", 1000.0, Dimension::DENSITY),
            ("J/m^2", 1.0, Dimension::FRACTURE_ENERGY),
            ("N/m", 1.0, Dimension::FRACTURE_ENERGY),
            ("N/mm", 1000.0, Dimension::FRACTURE_ENERGY),
            ("m s^-1", 1.0, Dimension::VELOCITY),
            ("m·s⁻²", 1.0, Dimension::ACCELERATION),
            ("m/s/s", 1.0, Dimension::ACCELERATION),
            ("kg m/(s^2 m^2)", 1.0, Dimension::PRESSURE),
            ("1/ms", 1000.0, Dimension::RATE),
            ("1", 1.0, Dimension::NONE),
            ("-", 1.0, Dimension::NONE),
            ("mm^2^1", f64::NAN, Dimension::AREA),
        ] {
            match parse_unit(text) {
                Ok(unit) => {
                    assert!((unit.size() / size - 1.0).abs() < 1e-15, "{text}: {}", unit.size());
                    assert_eq!(unit.dimension, dimension, "{text}");
                }
                Err(_) => assert!(size.is_nan(), "{text}"),
            }
        }
    }

    #[test]
    fn malformed_units_are_refused() {
        for text in ["", "kgg", "2 m", "m/", "m^", "m^x", "m^(2", "m^0.3", "m^99", "(m)", "1 m", "m)"] {
            assert!(parse_unit(text).is_err(), "{text}");
        }
        assert_eq!(parse_unit("gpa").unwrap_err().remedy, "did you mean \"GPa\"?");
    }
}
