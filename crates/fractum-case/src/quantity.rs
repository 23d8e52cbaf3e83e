use super::Dimension;
use super::expression::{NoNames, compile};

/// Reads a quantity written as in a case file, such as `72 GPa`, in SI.
///
/// # Errors
/// What is wrong, in one line: no number, an unknown unit, another dimension.
pub fn parse_quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    let compiled = compile(text, &mut NoNames, false).map_err(|error| format!("\"{text}\": {}", error.message))?;
    if !compiled.kind.fits(dimension, false) {
        return Err(format!("\"{text}\" is {}; expected {}", compiled.kind.phrase(), dimension.expected()));
    }
    match compiled.program.constant() {
        Some(value) if value.is_finite() => Ok(value),
        _ => Err(format!("\"{text}\" is no finite number")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_and_checked() {
        assert_eq!(parse_quantity("72 GPa", Dimension::PRESSURE), Ok(72e9));
        assert_eq!(parse_quantity("1e-3", Dimension::LENGTH), Ok(1e-3));
        assert!(parse_quantity("72 m", Dimension::PRESSURE).unwrap_err().contains("length"));
        assert!(parse_quantity("seven", Dimension::PRESSURE).is_err());
        assert!(parse_quantity("1/0 Pa", Dimension::PRESSURE).is_err());
    }
}
