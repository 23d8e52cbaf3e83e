//! Data files of LAMMPS: the section `Atoms` of the styles that have diameters, and `Velocities`.

use std::collections::HashMap;

use super::{Columns, Content, Wrong, lines};

const STYLES: &str = "a style of atoms with diameters: sphere or bpm/sphere";

/// Whether a text is one: its head says how many atoms there are.
pub(super) fn is_one(text: &str) -> bool {
    atoms(text).is_some()
}

/// Number of atoms that the head tells.
fn atoms(text: &str) -> Option<usize> {
    let head = text.lines().take(100).find_map(|line| {
        let mut words = line.split('#').next()?.split_whitespace();
        let count = words.next()?.parse().ok()?;
        (words.next()? == "atoms" && words.next().is_none()).then_some(count)
    });
    head.filter(|_| text.lines().any(|line| line.trim_start().starts_with("Atoms")))
}

/// Columns of a row of `Atoms`, by the style that the comment behind its name tells, or by their number.
fn columns(style: Option<&str>, count: usize, line: usize) -> Result<Columns, Wrong> {
    const SPHERE: &[&str] = &["id", "type", "diameter", "density", "x", "y", "z"];
    const BPM: &[&str] = &["id", "molecule", "type", "diameter", "density", "x", "y", "z"];
    let names = match style {
        Some("sphere" | "granular") => SPHERE,
        Some("bpm/sphere") => BPM,
        Some(other) => return Err(Wrong::at(line, format!("atoms of the style {other}"), STYLES)),
        None => match count {
            7 | 10 => SPHERE,
            8 | 11 => BPM,
            _ => return Err(Wrong::at(line, format!("atoms of {count} columns, without a style"), STYLES)),
        },
    };
    // Three numbers of periodic images may follow.
    if count != names.len() && count != names.len() + 3 {
        let found = format!("an atom of {count} columns, where the style has {}", names.len());
        return Err(Wrong::at(line, found, STYLES));
    }
    Ok(Columns::of(names.iter().copied()))
}

pub(super) fn read(text: &str) -> Result<Content, Wrong> {
    let mut content = Content { format: "the section Atoms of a LAMMPS data file", ..Content::default() };
    let (mut section, mut style) = ("", None);
    let mut motions: HashMap<i64, ([f64; 3], Option<[f64; 3]>)> = HashMap::new();
    // The first line is a title.
    for (number, line) in lines(text).skip(1) {
        let (plain, comment) = line.split_once('#').map_or((line, None), |(plain, comment)| (plain, Some(comment)));
        let words: Vec<&str> = plain.split_whitespace().collect();
        let Some(first) = words.first() else { continue };
        if first.starts_with(|c: char| c.is_ascii_alphabetic()) {
            section = first;
            if section == "Atoms" {
                style = comment.map(str::trim).filter(|style| !style.is_empty());
            }
            continue;
        }
        match section {
            "Atoms" => {
                let row = columns(style, words.len(), number)?.row(&words, number)?;
                if row.radius <= 0.0 {
                    return Err(Wrong::at(number, "an atom without a diameter", "a diameter above 0"));
                }
                content.rows.push(row);
            }
            "Velocities" => {
                let expected = "number of an atom, vx, vy, vz, and wx, wy, wz";
                let wrong = || Wrong::at(number, format!("`{}`", line.trim()), expected);
                let id = first.parse().map_err(|_| wrong())?;
                let values: Result<Vec<f64>, _> = words[1..].iter().map(|word| word.parse()).collect();
                match values.map_err(|_| wrong())?[..] {
                    [x, y, z] => motions.insert(id, ([x, y, z], None)),
                    [x, y, z, a, b, c] => motions.insert(id, ([x, y, z], Some([a, b, c]))),
                    _ => return Err(wrong()),
                };
            }
            "Bonds" => {
                let ends = [2, 3].map(|place| words.get(place).and_then(|word| word.parse::<i64>().ok()));
                let [Some(first), Some(second)] = ends else {
                    let expected = "number and type of a bond, and the numbers of two atoms";
                    return Err(Wrong::at(number, format!("`{}`", line.trim()), expected));
                };
                content.bonds.push((number, [first, second]));
            }
            _ => {}
        }
    }
    for row in &mut content.rows {
        if let Some((velocity, spin)) = row.id.and_then(|id| motions.get(&id)) {
            (row.velocity, row.spin) = (Some(*velocity), *spin);
        }
    }
    if let Some(count) = atoms(text).filter(|count| *count != content.rows.len()) {
        let found = format!("the file ends after {} of {count} atoms", content.rows.len());
        return Err(Wrong { found, expected: "all atoms that its head tells" });
    }
    if style.is_none() {
        content.notes.push("no style beside Atoms: by the number of columns".to_owned());
    }
    Ok(content)
}
