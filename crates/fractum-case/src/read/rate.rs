//! `damage.rate`: strength and fracture energy by the rate of strain.

use fractum_fem::{CriterionKind, RateCurves};
use fractum_math::elementary::{cbrt, exp, pow};

use crate::keys::RATE_PRESETS;
use crate::reader::vectors::expression;
use crate::reader::{Reader, Table};
use crate::tree::{Node, Value};
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned};

/// Rates [1/s] and factors.
type Curve = Vec<[f64; 2]>;

/// Rates at which an expression is looked at: from 1e-8 to 1e6 per second, this many in a decade.
const LOOKS: [f64; 2] = [-8.0, 6.0];
const LOOKS_PER_DECADE: usize = 20;

/// What a strength is: which curve of a standard it has.
#[derive(Clone, Copy)]
enum Strength {
    Tensile,
    Compressive,
}

/// Reads the table; the compressive strength has a curve where the criterion has that strength.
///
/// - `strength_ratio`: compressive over tensile strength at rest
/// - `switched`: whether `--set` has a part in the table that it belongs to
pub(super) fn read(
    table: Table<'_>,
    kind: CriterionKind,
    strength_ratio: Option<f64>,
    switched: bool,
) -> Option<Spanned<RateCurves>> {
    let place = table.place.clone();
    let strength = curve(&table, "strength", Some(Strength::Tensile)).required();
    let compressive = if kind.uses_compressive_strength() {
        curve(&table, "compressive_strength", Some(Strength::Compressive)).required().map(Some)
    } else {
        let why = "with this criterion, which has no strength in compression";
        if switched && !table.is_overridden() {
            table.set_aside("compressive_strength", why);
        } else {
            table.refuse("compressive_strength", why);
        }
        Some(None)
    };
    let energy = curve(&table, "fracture_energy", None).or_if_absent(Vec::new());
    table.finish("here");
    let (strength, compressive, energy) = (strength?, compressive?, energy?);
    let compression = match compressive {
        Some(curve) => Some((curve, strength_ratio?)),
        None => None,
    };
    Some(Spanned::new(RateCurves { strength, compression, energy }, place))
}

/// A curve: the name of a standard, an expression of the rate, or pairs of rate and factor.
fn curve<'t, 'a>(
    table: &'t Table<'a>,
    name: &'static str,
    strength: Option<Strength>,
) -> crate::reader::Reading<'t, 'a, Curve> {
    table.read(name, |node| match &node.value {
        Value::Array(pairs) => points(table, node, pairs),
        Value::Text(text) if RATE_PRESETS.contains(&text.as_str()) => match strength {
            Some(strength) => Some(preset(table.reader, text, strength)),
            None => {
                let note = Diagnostic::error(&node.place, node.found());
                let note = note.expected("pairs of rate and factor, or an expression of rate");
                table
                    .reader
                    .note(note.remedy("the standard gives strengths alone; without the key the energy stays as it is"));
                None
            }
        },
        Value::Text(text) if text.starts_with("fib") => {
            let note = Diagnostic::error(&node.place, node.found()).expected("the name of a standard");
            table.reader.note(table.reader.suggest(note, text, RATE_PRESETS.into_iter(), "standards"));
            None
        }
        _ => of_expression(table, node),
    })
}

/// Curves of the fib Model Code for Concrete Structures 2010, 5.1.11.2: a power law of the rate over that of a slow test and, beyond 10 per second in tension and 30
/// in compression, a steeper one with the exponent 1/3, up to 300 per second. Both meet where they are equal, within 4 % of those rates.
fn preset(reader: &Reader, name: &str, strength: Strength) -> Curve {
    let (slow, gentle, steep) = match strength {
        Strength::Tensile => (1e-6, 0.018, 0.0062),
        Strength::Compressive => (30e-6, 0.014, 0.012),
    };
    let unit = reader.scale.of(Dimension::RATE);
    let at = |relative: f64, factor: f64| [relative * slow * unit, factor];
    let last = 300.0 / slow;
    if name != RATE_PRESETS[0] {
        return vec![at(1.0, 1.0), at(last, pow(last, gentle))];
    }
    let meet = pow(1.0 / steep, 1.0 / (1.0 / 3.0 - gentle));
    vec![at(1.0, 1.0), at(meet, pow(meet, gentle)), at(last, steep * cbrt(last))]
}

fn of_expression(table: &Table<'_>, node: &Node) -> Option<Curve> {
    let reader = table.reader;
    let (field, kind) = expression(reader, node, Dimension::NONE, &[("rate", Dimension::RATE)])?;
    if !reader.check_dimension(node, kind, Dimension::NONE) {
        return None;
    }
    let decades = LOOKS[1] - LOOKS[0];
    let count = decades as usize * LOOKS_PER_DECADE;
    let mut curve = Vec::with_capacity(count + 1);
    for look in 0..=count {
        let rate = exp((LOOKS[0] + decades * look as f64 / count as f64) * std::f64::consts::LN_10);
        let rate = rate * reader.scale.of(Dimension::RATE);
        let factor = field.value(rate, fractum_math::Vec3::zeros());
        if !is_possible(factor) {
            let found = format!("{} gives {factor} at a rate of {rate:.3e} 1/s", node.found());
            reader.note(Diagnostic::error(&node.place, found).expected(POSSIBLE));
            return None;
        }
        curve.push([rate, factor]);
    }
    Some(match field.constant_value() {
        // A factor of 1 is none.
        Some(1.0) => Vec::new(),
        Some(_) => vec![curve[0]],
        None => curve,
    })
}

const POSSIBLE: &str = "a factor from 0.1 to 100";

fn is_possible(factor: f64) -> bool {
    (0.1..=100.0).contains(&factor)
}

fn points(table: &Table<'_>, node: &Node, pairs: &[Node]) -> Option<Curve> {
    let reader = table.reader;
    let wrong = |node: &Node, expected: &str| {
        reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
    };
    if pairs.is_empty() {
        wrong(node, "pairs of rate and factor");
        return None;
    }
    let read = |pair: &Node| match &pair.value {
        Value::Array(items) if items.len() == 2 => {
            let rate = reader.quantity(&items[0], Dimension::RATE);
            let factor = reader.quantity(&items[1], Dimension::NONE);
            let (rate, factor) = (rate?, factor?);
            if rate <= 0.0 {
                wrong(&items[0], "a rate above zero");
            }
            if !is_possible(factor) {
                wrong(&items[1], POSSIBLE);
            }
            (rate > 0.0 && is_possible(factor)).then_some([rate, factor])
        }
        _ => {
            wrong(pair, "a pair [rate, factor]");
            None
        }
    };
    let points: Vec<Option<[f64; 2]>> = pairs.iter().map(read).collect();
    let mut complete = true;
    for (pair, later) in points.windows(2).zip(&pairs[1..]) {
        if let (Some(before), Some(after)) = (pair[0], pair[1])
            && after[0] <= before[0]
        {
            wrong(later, "a rate above that of the pair before it");
            complete = false;
        }
    }
    points.into_iter().collect::<Option<_>>().filter(|_| complete)
}
