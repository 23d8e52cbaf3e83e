use super::expression::{Named, Names, NoNames, Op, Type, compile};
use super::{Dimension, Field};

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

/// Reads a condition on x, y, z written as in a case file, such as `abs(x) < 3 mm`.
///
/// # Errors
/// What is wrong, in one line.
pub fn parse_condition(text: &str) -> Result<Field, String> {
    let compiled = compile(text, &mut Position, false).map_err(|error| format!("\"{text}\": {}", error.message))?;
    match compiled.kind {
        Type::Truth => Ok(Field(compiled.program)),
        kind => Err(format!("\"{text}\" is {}; expected a condition such as \"abs(x) < 3 mm\"", kind.phrase())),
    }
}

/// Coordinates, the inputs of a field after the time.
struct Position;

impl Position {
    const AXES: [&str; 3] = ["x", "y", "z"];
}

impl Names for Position {
    fn contains(&self, name: &str) -> bool {
        Self::AXES.contains(&name)
    }

    fn is_variable(&self, name: &str) -> bool {
        self.contains(name)
    }

    fn find(&mut self, name: &str) -> Option<Result<Named, String>> {
        let axis = Self::AXES.iter().position(|axis| *axis == name)? as u16;
        Some(Ok(Named { op: Op::Input(axis + 1), kind: Type::number(Dimension::LENGTH) }))
    }

    fn all(&self) -> Vec<String> {
        Self::AXES.map(str::to_owned).to_vec()
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

    #[test]
    fn conditions_are_those_of_places() {
        let near = parse_condition("abs(x) < 3 mm && z > 1").unwrap();
        let holds = |x: f64, z: f64| near.holds_at(fractum_math::Vec3::new(x, 0.0, z));
        assert!(holds(-2e-3, 2.0) && !holds(4e-3, 2.0) && !holds(0.0, 0.0));
        assert!(parse_condition("x + 1 m").unwrap_err().contains("expected a condition"));
        assert!(parse_condition("t < 1 s").is_err() && parse_condition("x < 3 s").is_err());
    }
}
