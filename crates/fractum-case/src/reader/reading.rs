//! A value on its way from a table into the model, with its checks.

use fractum_output::warning::Code;

use super::Table;
use crate::key_kind::KeyKind;
use crate::tree::Node;
use crate::usual::Usual;
use crate::{Diagnostic, Spanned};

/// A value on its way out of a table: absent, wrong (and noted), or given.
pub(crate) struct Reading<'t, 'a, T> {
    pub(crate) table: &'t Table<'a>,
    pub(crate) name: &'static str,
    pub(crate) node: Option<&'a Node>,
    pub(crate) state: State<T>,
}

/// What was found of a value.
pub(crate) enum State<T> {
    Absent,
    Wrong,
    Given(T),
}

impl<'t, 'a, T> Reading<'t, 'a, T> {
    /// Holds a given value against a condition.
    pub(crate) fn check(mut self, holds: impl FnOnce(&T) -> bool, expected: &str) -> Self {
        if let (State::Given(value), Some(node)) = (&self.state, self.node)
            && !holds(value)
        {
            self.table.reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
            self.state = State::Wrong;
        }
        self
    }

    /// Another value from a given one.
    pub(crate) fn map<U>(self, f: impl FnOnce(T) -> U) -> Reading<'t, 'a, U> {
        let state = match self.state {
            State::Absent => State::Absent,
            State::Wrong => State::Wrong,
            State::Given(value) => State::Given(f(value)),
        };
        Reading { table: self.table, name: self.name, node: self.node, state }
    }

    /// Keeps the place of a given value.
    pub(crate) fn spanned(self) -> Reading<'t, 'a, Spanned<T>> {
        let place = self.node.map_or_else(|| self.table.place_of(self.name), |node| node.place.clone());
        self.map(|value| Spanned::new(value, place))
    }

    /// The value, which must be there.
    pub(crate) fn required(self) -> Option<T> {
        if matches!(self.state, State::Absent) {
            let expected = self.table.kind(self.name).map_or(String::new(), KeyKind::expected);
            self.table.reader.note_missing(&self.table.place_of(self.name), expected);
        }
        self.given()
    }

    /// The value where it is there and right.
    pub(crate) fn given(self) -> Option<T> {
        match self.state {
            State::Given(value) => Some(value),
            _ => None,
        }
    }

    /// The value where it is right, this where it is absent, nothing where it is wrong.
    pub(crate) fn or_if_absent(self, default: T) -> Option<T> {
        match self.state {
            State::Given(value) => Some(value),
            State::Absent => Some(default),
            State::Wrong => None,
        }
    }

    /// The value where it is there and right, else this.
    pub(crate) fn or(self, default: T) -> T {
        self.given().unwrap_or(default)
    }
}

impl Reading<'_, '_, f64> {
    /// Above zero.
    pub(crate) fn positive(self) -> Self {
        self.check(|value| *value > 0.0, "more than 0")
    }

    /// Above zero, and within the range in which squares and quotients of such numbers stay numbers.
    pub(crate) fn physical(self) -> Self {
        self.positive().check(|value| (1e-30..=1e30).contains(value), "from 1e-30 to 1e30 in SI units")
    }

    /// Warns of a value that no solid has, with the unit that was probably meant.
    pub(crate) fn usual(self, usual: &Usual) -> Self {
        if let (State::Given(value), Some(node)) = (&self.state, self.node)
            && let Some(doubt) = usual.doubt(node, *value, self.table.reader.place_of_parameter(node))
        {
            self.table.reader.note(doubt);
        }
        self
    }

    /// Warns of a coefficient of friction that is an angle in degrees.
    pub(crate) fn coefficient(self) -> Self {
        if let (State::Given(value), Some(node)) = (&self.state, self.node)
            && (5.0..90.0).contains(value)
        {
            let note = Diagnostic::warning(Code::UnusualValue, &node.place, node.found());
            let note = note.expected("a coefficient, the tangent of the angle of friction (steel on steel has 0.6)");
            self.table.reader.note(note.remedy(format!("did you mean \"tan({value} deg)\"?")));
        }
        self
    }

    /// At least zero.
    pub(crate) fn not_negative(self) -> Self {
        self.check(|value| *value >= 0.0, "at least 0")
    }

    /// Between limits, both excluded.
    pub(crate) fn between(self, low: f64, high: f64) -> Self {
        self.check(|value| *value > low && *value < high, &format!("between {low} and {high}"))
    }
}
