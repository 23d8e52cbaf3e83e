//! `bodies[].sizes`: the sizes of loose particles by a sieve curve or a law.

use fractum_pack::Grading;

use crate::Diagnostic;
use crate::keys::SIZE_LAWS;
use crate::reader::Table;
use crate::reader::presence::exactly_one;
use crate::tree::{Node, Value};
use crate::unit::Dimension;

/// Largest diameter over the smallest one.
const WIDEST: f64 = 100.0;

#[derive(Clone, Copy, PartialEq)]
enum Law {
    Uniform,
    LogNormal,
}

/// Reads the distribution of diameters of a body that has one.
///
/// - `of_discs`: whether the particles are discs
pub(super) fn sizes(body: &Table<'_>, of_discs: bool) -> Option<Grading> {
    let table = body.table("sizes")?;
    let grading = match exactly_one(&table, &["passing", "law"]) {
        Some("passing") => {
            for key in ["smallest", "largest", "median", "deviation"] {
                table.refuse(key, "beside passing, whose sieves say it");
            }
            let spheres = table.read("passing", |node| passing(&table, node)).required();
            spheres.map(|grading| if of_discs { grading.of_discs() } else { grading })
        }
        Some(_) => law(&table, of_discs),
        None => {
            table.pass_over(&["passing", "law", "smallest", "largest", "median", "deviation"]);
            None
        }
    };
    let (reader, place) = (table.reader, table.place.clone());
    table.finish("here");
    let grading = grading?;
    let [smallest, largest] = grading.limits();
    if largest > WIDEST * smallest {
        let found = format!("asks for diameters of which the largest is {:.0} times the smallest", largest / smallest);
        let note = Diagnostic::error(&place, found).expected(format!("at most {WIDEST:.0} times"));
        reader.note(note.remedy("cut the fines off: they decide the number of particles and the time step"));
        return None;
    }
    Some(grading)
}

fn law(table: &Table<'_>, of_discs: bool) -> Option<Grading> {
    let laws = [(SIZE_LAWS[0], Law::Uniform), (SIZE_LAWS[1], Law::LogNormal)];
    let law = table.one_of("law", &laws).required();
    let length = |key: &'static str| table.quantity(key).positive().required();
    let (smallest, largest) = (length("smallest"), length("largest"));
    let shape = if law == Some(Law::LogNormal) {
        let deviation = table.quantity("deviation").check(|own| *own > 0.0 && *own <= 2.0, "above 0 and at most 2");
        length("median").zip(deviation.required()).map(Some)
    } else {
        for key in ["median", "deviation"] {
            table.refuse(key, "but with law = \"log-normal\"");
        }
        Some(None)
    };
    let (smallest, largest) = (smallest?, largest?);
    if largest <= smallest {
        let note = Diagnostic::error(&table.place_below("largest"), "is not above smallest");
        table.reader.note(note.expected("a diameter above smallest; without sizes all particles have one radius"));
        return None;
    }
    match (law?, shape?) {
        (Law::LogNormal, Some((median, _))) if median <= smallest || median >= largest => {
            let note = Diagnostic::error(&table.place_below("median"), "lies outside of the sizes");
            table.reader.note(note.expected("a diameter between smallest and largest"));
            None
        }
        (Law::LogNormal, Some((median, deviation))) => {
            let spheres = Grading::log_normal(median, deviation, smallest, largest);
            Some(if of_discs { spheres.of_discs() } else { spheres })
        }
        _ if of_discs => Some(Grading::uniform_discs(smallest, largest)),
        _ => Some(Grading::uniform(smallest, largest)),
    }
}

fn passing(table: &Table<'_>, node: &Node) -> Option<Grading> {
    let reader = table.reader;
    let wrong = |node: &Node, expected: &str| {
        reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
    };
    let Value::Array(pairs) = &node.value else {
        wrong(node, "pairs of diameter and share of the mass that passes");
        return None;
    };
    let mut points: Vec<[f64; 2]> = Vec::new();
    for pair in pairs {
        let items = match &pair.value {
            Value::Array(items) if items.len() == 2 => items,
            _ => {
                wrong(pair, "a pair [diameter, share of the mass that passes]");
                return None;
            }
        };
        let diameter = reader.quantity(&items[0], Dimension::LENGTH)?;
        let share = reader.quantity(&items[1], Dimension::NONE)?;
        let before = points.last().copied().unwrap_or([0.0, 0.0]);
        if diameter <= before[0] {
            wrong(&items[0], "a diameter above 0 and above that of the pair before it");
            return None;
        }
        if points.is_empty() && share != 0.0 {
            wrong(&items[1], "0: nothing passes the smallest sieve");
            return None;
        }
        if !(before[1]..=1.0).contains(&share) {
            wrong(&items[1], "a share of the mass up to 1, not below that of the pair before it");
            return None;
        }
        points.push([diameter, share]);
    }
    if points.last().is_none_or(|last| last[1] != 1.0) {
        wrong(node, "pairs that end with a share of 1: all passes the largest sieve");
        return None;
    }
    Some(Grading::sieves(points))
}
