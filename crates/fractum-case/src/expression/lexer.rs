//! Text to tokens.

use super::ExpressionError;

/// A token, with the byte offset at which it begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Token<'a> {
    pub(super) kind: Kind<'a>,
    pub(super) offset: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind<'a> {
    /// Digits as written.
    Number(&'a str),
    /// Name of a unit, variable or function.
    Name(&'a str),
    /// Operator or bracket.
    Symbol(&'static str),
    /// A small raised digit: an exponent.
    Raised(i8),
    End,
}

/// Longest first, so that `<=` is not read as `<`.
const SYMBOLS: &[&str] =
    &["<=", ">=", "==", "!=", "&&", "||", "**", "<", ">", "=", "!", "+", "-", "*", "/", "^", "(", ")", ","];

pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, ExpressionError> {
    let mut tokens = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        let offset = text.len() - rest.len();
        let Some(first) = rest.chars().next() else {
            tokens.push(Token { kind: Kind::End, offset });
            return Ok(tokens);
        };
        let (kind, length) = if first.is_ascii_digit() || first == '.' {
            let length = number_length(rest);
            (Kind::Number(&rest[..length]), length)
        } else if is_name_start(first) {
            let length = rest.find(|c: char| !(is_name_start(c) || c.is_ascii_digit())).unwrap_or(rest.len());
            (Kind::Name(&rest[..length]), length)
        } else if matches!(first, '%' | '°') {
            (Kind::Name(&rest[..first.len_utf8()]), first.len_utf8())
        } else if let Some((raised, length)) = raised(rest) {
            (Kind::Raised(raised), length)
        } else if first == '·' {
            (Kind::Symbol("*"), first.len_utf8())
        } else if let Some(symbol) = SYMBOLS.iter().find(|symbol| rest.starts_with(**symbol)) {
            (Kind::Symbol(symbol), symbol.len())
        } else {
            return Err(ExpressionError::new(offset, format!("unexpected \"{first}\"")));
        };
        if let Kind::Symbol(found @ ("=" | "**")) = kind {
            let meant = if found == "=" { "==" } else { "^" };
            return Err(ExpressionError::new(offset, format!("unexpected \"{found}\"; write \"{meant}\"")));
        }
        if let Kind::Number(digits) = kind
            && !digits.parse::<f64>().is_ok_and(f64::is_finite)
        {
            return Err(ExpressionError::new(offset, format!("\"{digits}\" is not a number")));
        }
        tokens.push(Token { kind, offset });
        rest = &rest[length..];
    }
}

fn is_name_start(c: char) -> bool {
    c.is_alphabetic() || c == '_' || c == 'µ' || c == 'μ'
}

/// A raised digit, perhaps with a raised minus, at the start of `text`, and its length.
fn raised(text: &str) -> Option<(i8, usize)> {
    let (sign, digits) = text.strip_prefix('⁻').map_or((1, text), |rest| (-1, rest));
    let digit = digits.chars().next()?;
    let value = ['⁰', '¹', '²', '³', '⁴'].iter().position(|&c| c == digit)?;
    Some((sign * value as i8, text.len() - digits.len() + digit.len_utf8()))
}

/// Length of digits, point, digits, exponent at the start of `text`; an `e` without digits after it is not an exponent.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    while bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1); // a second point is taken along, so that 1.2.3 is refused as a whole
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = bytes.get(end + 1 + sign..).map_or(0, |_| digits(end + 1 + sign));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<Kind<'_>> {
        tokens(text).unwrap().into_iter().map(|token| token.kind).collect()
    }

    #[test]
    fn numbers_end_where_units_begin() {
        use Kind::*;
        assert_eq!(kinds("21GPa"), [Number("21"), Name("GPa"), End]);
        assert_eq!(kinds("1e-3J"), [Number("1e-3"), Name("J"), End]);
        assert_eq!(kinds(".5e"), [Number(".5"), Name("e"), End]);
        assert_eq!(kinds("5e+"), [Number("5"), Name("e"), Symbol("+"), End]);
        assert_eq!(kinds("m²"), [Name("m"), Raised(2), End]);
        assert_eq!(kinds("s⁻²"), [Name("s"), Raised(-2), End]);
        assert_eq!(kinds("5 %"), [Number("5"), Name("%"), End]);
        assert_eq!(kinds("a<=b"), [Name("a"), Symbol("<="), Name("b"), End]);
    }

    #[test]
    fn nonsense_is_refused_with_its_place() {
        for (text, offset) in
            [("1 ; 2", 2), ("1.2.3", 0), (".", 0), ("a = b", 2), ("2**3", 1), ("1e999", 0), ("\u{0}", 0)]
        {
            assert_eq!(tokens(text).unwrap_err().offset, offset, "{text}");
        }
    }
}
