//! Tables of particles: CSV, blanks, and YADE's text export.

use super::{Columns, Content, Wrong, lines};

pub(super) const EXPECTED: &str = "rows of x, y, z, radius";

/// Rows of x, y, z and radius, separated by commas, semicolons or blanks. A first row may name the columns, and so may YADE's
/// `#format`; then there may be more of them. Comments from `#` on are passed over.
pub(super) fn read(text: &str) -> Result<Content, Wrong> {
    let mut content = Content { format: "a table", ..Content::default() };
    let mut columns: Option<Columns> = None;
    for (number, line) in lines(text) {
        if let Some(names) = line.strip_prefix("#format ").filter(|_| content.rows.is_empty()) {
            // x_y_z_r_matId, and what the user has put behind.
            columns = named(names.trim().split('_'));
            content.format = "a text export of YADE";
            continue;
        }
        let line = line.split('#').next().unwrap_or_default();
        let words = words(line);
        if words.is_empty() {
            continue;
        }
        let is_head = content.rows.is_empty() && columns.is_none() && words.iter().all(|w| w.parse::<f64>().is_err());
        if is_head {
            // A unit may stand behind a name.
            let names = words.iter().map(|word| word.split_whitespace().next().unwrap_or_default());
            columns = Some(named(names).unwrap_or_else(plain));
            continue;
        }
        let wrong = || Wrong::at(number, format!("`{}`", line.trim()), EXPECTED);
        let columns = columns.get_or_insert_with(plain);
        if words.len() != columns.count {
            return Err(wrong());
        }
        let row = columns.row(&words, number).map_err(|_| wrong())?;
        if !(row.radius > 0.0 && row.radius.is_finite()) {
            return Err(wrong());
        }
        content.rows.push(row);
    }
    let empty = || Wrong { found: "holds no particle".to_owned(), expected: EXPECTED };
    if content.rows.is_empty() { Err(empty()) } else { Ok(content) }
}

fn plain() -> Columns {
    Columns::of(["x", "y", "z", "radius"])
}

/// The columns of these names, where they are those of particles.
fn named<'a>(names: impl Iterator<Item = &'a str>) -> Option<Columns> {
    let names: Vec<String> = names.map(str::to_lowercase).collect();
    Some(Columns::of(names.iter().map(String::as_str))).filter(|columns| columns.lacks().is_none())
}

fn words(line: &str) -> Vec<&str> {
    let by_marks = line.contains([',', ';']);
    let words: Vec<&str> = match by_marks {
        true => line.split([',', ';']).map(str::trim).collect(),
        false => line.split_whitespace().collect(),
    };
    // A line may end with a mark; blanks may separate beside marks.
    let split: Vec<&str> = words.iter().flat_map(|word| word.split_whitespace()).collect();
    let is_numbers = split.iter().all(|word| word.parse::<f64>().is_ok());
    if is_numbers { split } else { words.into_iter().filter(|word| !word.is_empty()).collect() }
}
