//! How `fractum verify` takes a case: its neighbours, and what its references promise of them.

use super::Expect;

/// How `fractum verify` takes a case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Verify {
    /// Whether `--quick` runs this case.
    pub quick: bool,
    /// By how much the whole case is larger than written, where it is.
    pub scale: Option<f64>,
    /// What all references promise that do not say it themselves.
    pub promise: Promise,
    /// The cases beside this one, by kind.
    pub neighbours: Vec<Neighbour>,
}

/// For which neighbours a reference holds, and for which not.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Promise {
    /// Names or kinds of neighbours for which it holds; none where nothing is said.
    pub holds_for: Option<Vec<String>>,
    /// Names or kinds for which it does not hold, each with the reason.
    pub excepted: Vec<(String, String)>,
}

/// A case that differs from another in one thing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Neighbour {
    /// What differs: one of [`NEIGHBOURS`], or a name of the user's.
    pub kind: String,
    /// How; empty for a kind with one neighbour only.
    pub value: String,
    /// Keys and values, as `--set` takes them.
    pub set: Vec<(String, String)>,
}

/// Kinds of neighbours that the program makes itself.
pub const NEIGHBOURS: [&str; 7] = ["seed", "poisson_ratio", "safety", "mesh", "half", "coordination", "size"];

/// What a reference says of a neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saying<'a> {
    /// It holds there too.
    Holds,
    /// It does not, for this reason.
    Excepted(&'a str),
    /// Nothing.
    Nothing,
}

impl Neighbour {
    /// `poisson_ratio 0.3`, `mesh`.
    pub fn name(&self) -> String {
        if self.value.is_empty() { self.kind.clone() } else { format!("{} {}", self.kind, self.value) }
    }

    fn is_called(&self, name: &str) -> bool {
        name == self.kind || name == self.name()
    }
}

impl Verify {
    /// What a reference says of a neighbour: its own words stand above those of the case, an exception above a promise.
    pub fn says<'a>(&'a self, expect: &'a Expect, neighbour: &Neighbour) -> Saying<'a> {
        let exception = |promise: &'a Promise| {
            let found = promise.excepted.iter().find(|(name, _)| neighbour.is_called(name));
            found.map(|(_, why)| Saying::Excepted(why))
        };
        let holds = |promise: &Promise| {
            let named = promise.holds_for.iter().flatten().any(|name| neighbour.is_called(name));
            named.then_some(Saying::Holds)
        };
        let own = exception(&expect.promise).or_else(|| holds(&expect.promise)).or_else(|| exception(&self.promise));
        let of_case = || if expect.promise.holds_for.is_none() { holds(&self.promise) } else { None };
        own.or_else(of_case).unwrap_or(Saying::Nothing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Place, Spanned};
    use fractum_output::expectation::Bound;

    fn expect(holds_for: Option<&[&str]>, excepted: &[&str]) -> Expect {
        let place = Place { file: String::new(), line: 0, column: 0, key: String::new() };
        Expect {
            quantity: Spanned::new("peak".into(), place),
            unit: "N".into(),
            bound: Bound::Between { above: None, below: Some(1.0) },
            source: String::new(),
            note: String::new(),
            promise: promise(holds_for, excepted),
        }
    }

    fn promise(holds_for: Option<&[&str]>, excepted: &[&str]) -> Promise {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        Promise {
            holds_for: holds_for.map(owned),
            excepted: excepted.iter().map(|name| ((*name).to_owned(), "why".to_owned())).collect(),
        }
    }

    #[test]
    fn the_nearest_word_decides() {
        let verify = |holds_for: &[&str], excepted: &[&str]| Verify {
            promise: promise(Some(holds_for), excepted),
            ..Verify::default()
        };
        let nu = Neighbour { kind: "poisson_ratio".into(), value: "0.3".into(), set: Vec::new() };
        let no = Saying::Excepted("why");
        type Words<'a> = &'a [&'a str];
        type Row<'a> = ((Words<'a>, Words<'a>), (Option<Words<'a>>, Words<'a>), Saying<'a>);
        let rows: [Row; 11] = [
            ((&[], &[]), (None, &[]), Saying::Nothing),
            ((&["poisson_ratio"], &[]), (None, &[]), Saying::Holds),
            ((&["poisson_ratio 0.3"], &[]), (None, &[]), Saying::Holds),
            ((&["poisson_ratio 0.1"], &[]), (None, &[]), Saying::Nothing),
            ((&["poisson_ratio"], &["poisson_ratio 0.3"]), (None, &[]), no),
            ((&["poisson_ratio"], &[]), (None, &["poisson_ratio"]), no),
            ((&["poisson_ratio"], &[]), (Some(&["seed"]), &[]), Saying::Nothing),
            ((&[], &["poisson_ratio"]), (Some(&["poisson_ratio"]), &[]), Saying::Holds),
            ((&[], &[]), (Some(&["poisson_ratio 0.3"]), &["poisson_ratio"]), no),
            ((&["poisson_ratio"], &["poisson_ratio 0.3"]), (Some(&[]), &[]), no),
            ((&[], &[]), (Some(&["poisson_ratio"]), &["poisson_ratio 0.3"]), no),
        ];
        for (of_case, of_expect, said) in rows {
            let (case, line) = (verify(of_case.0, of_case.1), expect(of_expect.0, of_expect.1));
            assert_eq!(case.says(&line, &nu), said, "{of_case:?} {of_expect:?}");
        }
    }
}
