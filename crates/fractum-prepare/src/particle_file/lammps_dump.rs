//! Text dumps of LAMMPS and LIGGGHTS.

use super::{Columns, Content, Wrong, cut_short, lines};

/// Whether a text is one.
pub(super) fn is_one(text: &str) -> bool {
    text.lines().find(|line| !line.trim().is_empty()).is_some_and(|line| line.starts_with("ITEM:"))
}

/// Reads a frame: that of a number from 0 on, or the last one.
pub(super) fn read(text: &str, frame: Option<u64>) -> Result<Content, Wrong> {
    let starts: Vec<usize> =
        lines(text).filter(|(_, line)| line.starts_with("ITEM: TIMESTEP")).map(|(number, _)| number).collect();
    let Some(last) = starts.len().checked_sub(1) else {
        return Err(cut_short(text, "ITEM: TIMESTEP"));
    };
    let asked = frame.map_or(last, |frame| usize::try_from(frame).unwrap_or(usize::MAX));
    let Some(start) = starts.get(asked) else {
        let found = format!("has {} frames, no frame {asked}", starts.len());
        return Err(Wrong { found, expected: "a frame of the file, from 0 on" });
    };
    let mut content = Content { format: "a LAMMPS dump", ..Content::default() };
    let mut rest = lines(text).skip(start - 1);
    let (mut bounds, mut count, mut has_atoms) = (None, None, false);
    while let Some((number, line)) = rest.next() {
        let mut next = |expected: &'static str| rest.next().ok_or_else(|| cut_short(text, expected));
        let Some(item) = line.strip_prefix("ITEM:").map(str::trim) else { continue };
        if item == "TIMESTEP" {
            if number != *start {
                break;
            }
            let step = next("a time step")?.1.trim().to_owned();
            content.notes.push(format!("frame {asked} of {}, step {step}", starts.len()));
        } else if item == "NUMBER OF ATOMS" {
            let (number, line) = next("the number of atoms")?;
            let found = line.trim().parse::<usize>();
            count = Some(found.map_err(|_| Wrong::at(number, format!("`{line}`"), "the number of atoms"))?);
        } else if item.starts_with("BOX BOUNDS") {
            let mut box_of = [[0.0; 2]; 3];
            for axis in &mut box_of {
                let (number, line) = next("bounds of the box")?;
                let values: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
                let [low, high, ..] = values[..] else {
                    return Err(Wrong::at(number, format!("`{line}`"), "two bounds of the box"));
                };
                *axis = [low, high];
            }
            bounds = Some((box_of, item.contains("xy xz yz")));
        } else if let Some(names) = item.strip_prefix("ATOMS") {
            has_atoms = true;
            let columns = columns(names, bounds, number)?;
            for _ in 0..count.unwrap_or(0) {
                let (number, line) = next("as many atoms as the frame tells")?;
                let words: Vec<&str> = line.split_whitespace().collect();
                content.rows.push(columns.row(&words, number)?);
            }
        }
    }
    if has_atoms { Ok(content) } else { Err(cut_short(text, "ITEM: ATOMS")) }
}

fn columns(names: &str, bounds: Option<([[f64; 2]; 3], bool)>, line: usize) -> Result<Columns, Wrong> {
    let names: Vec<&str> = names.split_whitespace().collect();
    let mut columns = Columns::of(names.iter().copied());
    let scaled = [["xs", "ys", "zs"], ["xsu", "ysu", "zsu"]].into_iter().find(|list| names.contains(&list[0]));
    if let (Some(list), true) = (scaled, columns.position[0].is_none()) {
        columns.position = list.map(|name| names.iter().position(|own| *own == name));
        let (bounds, oblique) =
            bounds.ok_or_else(|| Wrong::at(line, "shares of a box", "ITEM: BOX BOUNDS before them"))?;
        if oblique {
            return Err(Wrong::at(line, "shares of an oblique box", "coordinates x, y, z or xu, yu, zu"));
        }
        columns.scaled = Some(bounds);
    }
    match columns.lacks() {
        Some("radius") => Err(Wrong::at(line, "has no column radius or diameter", "dump ... id type x y z radius")),
        Some(axis) => Err(Wrong::at(line, format!("has no column {axis}"), "dump ... id type x y z radius")),
        None => Ok(columns),
    }
}
