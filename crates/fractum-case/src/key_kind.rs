//! What a key of the case file holds, and how that is told.

use super::Choice;
use super::unit::Dimension;

/// A key of the case file.
#[derive(Debug, Clone, Copy)]
pub struct KeyDoc {
    /// Dotted path; `NAME` stands for a name of the user's, `[]` for any of several, `TIME_FUNCTION` for the table form
    /// of any time function.
    pub path: &'static str,
    /// What it holds.
    pub kind: KeyKind,
    /// Its default as written in a case, `required`, or empty where absent means nothing.
    pub default: &'static str,
    /// What it means, in a line.
    pub doc: &'static str,
}

/// A row of the list of keys.
pub(super) const fn key(path: &'static str, kind: KeyKind, default: &'static str, doc: &'static str) -> KeyDoc {
    KeyDoc { path, kind, default, doc }
}

/// Names of a closed list.
pub(super) fn names<T: Choice>() -> Vec<&'static str> {
    T::NAMES.iter().map(|(name, _)| *name).collect()
}

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub enum KeyKind {
    /// A table of further keys.
    Table,
    /// Tables of further keys under names of the user's.
    NamedTables,
    /// Repeated tables `[[…]]`.
    Tables,
    /// Text.
    Text,
    /// `true` or `false`.
    Flag,
    /// A whole number.
    Integer,
    /// A quantity, or an expression of parameters.
    Quantity(Dimension),
    /// An angle, in radians where it has no unit.
    Angle,
    /// A quantity of any dimension.
    AnyQuantity,
    /// A unit of this dimension; of any where there is none.
    Unit(Option<Dimension>),
    /// One of these names.
    Choice(fn() -> Vec<&'static str>),
    /// A signed axis such as `-y`, or three numbers.
    Direction,
    /// A direction, or one of those about an axis.
    DirectionOrAbout,
    /// Three quantities.
    Point(Dimension),
    /// Three quantities, or two in the plane of discs.
    PointOrPlane(Dimension),
    /// A quantity, an expression of t, x, y, z, or one of the tables of `TIME_FUNCTION`.
    TimeFunction(Dimension),
    /// A quantity, or an expression of x, y, z.
    Field(Dimension),
    /// A condition on x, y, z.
    Condition,
    /// An expression of other probes.
    ProbeExpression,
    /// Pairs of time and value.
    Points,
    /// Several names.
    Names,
    /// All of something, or the names of some.
    AllOrNames,
    /// A factor as a function of the rate of strain.
    RateCurve,
    /// Rows of group, delay and pulse, or a file of them.
    Firing,
    /// Rows of joints, or a file of them.
    JointRows,
    /// Pairs of diameter and share of the mass.
    Sieves,
}

impl KeyKind {
    /// What to write, for messages: `a pressure such as "21 GPa"`.
    pub fn expected(self) -> String {
        match self {
            Self::Table | Self::NamedTables => "a table".to_string(),
            Self::Tables => "tables in double brackets".to_string(),
            Self::Text => "a text".to_string(),
            Self::Flag => "true or false".to_string(),
            Self::Integer => "a whole number".to_string(),
            Self::Quantity(dimension) => dimension.expected(),
            Self::Angle => "an angle such as \"35 deg\"".to_string(),
            Self::AnyQuantity => "a quantity such as \"21 GPa\"".to_string(),
            Self::Unit(Some(dimension)) => format!("a unit of {}, such as \"{dimension}\"", without_article(dimension)),
            Self::Unit(None) => "a unit such as \"Pa\"".to_string(),
            Self::Choice(names) => one_of(&names()),
            Self::DirectionOrAbout => {
                "an axis such as \"x\" or \"-y\", three numbers, \"radial\" or \"tangential\"".to_string()
            }
            Self::Direction => "an axis such as \"x\" or \"-y\", or three numbers".to_string(),
            Self::Point(dimension) => format!("three numbers, each {}", dimension.expected()),
            Self::PointOrPlane(dimension) => format!("three numbers, of discs two, each {}", dimension.expected()),
            Self::TimeFunction(dimension) => {
                format!("{}, an expression of t, x, y, z, or a table such as {{ ramp = [...] }}", dimension.expected())
            }
            Self::Field(dimension) => format!("{}, or an expression of x, y, z", dimension.expected()),
            Self::Condition => "a condition such as \"abs(y) < 8 cm\"".to_string(),
            Self::ProbeExpression => "an expression of probes such as \"2*max(load)\"".to_string(),
            Self::Names => "a list of names such as [\"rest\", \"release\"]".to_string(),
            Self::AllOrNames => "true for all, or a list of names such as [\"left\", \"right\"]".to_string(),
            Self::RateCurve => {
                "an expression of rate, pairs such as [[\"1e-6 1/s\", 1], [\"10 1/s\", 1.4]], or the name of a standard"
                    .to_string()
            }
            Self::JointRows => {
                "rows such as [[\"0 m\", \"0 m\", \"2 m\", \"1 m\"]], or a CSV file of such rows".to_string()
            }
            Self::Firing => {
                "rows such as [[\"hole-1\", \"25 ms\", \"contour\"]], or a CSV file of such rows".to_string()
            }
            Self::Sieves => "pairs such as [[\"1 mm\", 0], [\"2 mm\", \"40 %\"], [\"4 mm\", 1]]".to_string(),
            Self::Points => "pairs such as [[\"0 s\", \"0 m/s\"], [\"1 ms\", \"2 m/s\"]]".to_string(),
        }
    }

    /// What it holds in a few words, for the documentation.
    pub fn label(self) -> String {
        match self {
            Self::Table | Self::NamedTables | Self::Tables => "table".to_string(),
            Self::Text => "text".to_string(),
            Self::Flag => "true, false".to_string(),
            Self::Integer => "integer".to_string(),
            Self::Quantity(Dimension::NONE) => "number".to_string(),
            Self::Quantity(dimension) => format!("{} [{dimension}]", without_article(dimension)),
            Self::Angle => "angle [rad]".to_string(),
            Self::AnyQuantity => "quantity".to_string(),
            Self::Unit(_) => "unit".to_string(),
            Self::Choice(names) => names().join(", "),
            Self::Direction => "direction".to_string(),
            Self::DirectionOrAbout => "direction, radial, tangential".to_string(),
            Self::Point(dimension) => format!("three of [{dimension}]"),
            Self::PointOrPlane(dimension) => format!("three of [{dimension}], of discs two"),
            Self::TimeFunction(dimension) => format!("time function [{dimension}]"),
            Self::Field(Dimension::NONE) => "expression".to_string(),
            Self::Field(dimension) => format!("expression [{dimension}]"),
            Self::Condition => "condition".to_string(),
            Self::ProbeExpression => "probe expression".to_string(),
            Self::Points | Self::Sieves => "list of pairs".to_string(),
            Self::Names => "list of names".to_string(),
            Self::AllOrNames => "true, list of names".to_string(),
            Self::RateCurve => "function of rate".to_string(),
            Self::Firing | Self::JointRows => "list of rows, text".to_string(),
        }
    }
}

fn without_article(dimension: Dimension) -> String {
    let phrase = dimension.phrase();
    phrase.trim_start_matches("an ").trim_start_matches("a ").to_string()
}

/// `"a", "b" or "c"`, in quotes.
pub(super) fn one_of(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    match quoted.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        Some((last, _)) => last.clone(),
        None => String::new(),
    }
}
