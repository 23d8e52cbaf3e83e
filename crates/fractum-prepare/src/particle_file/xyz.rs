//! Extended xyz, as this program, OVITO and ASE write it.

use super::{Columns, Content, Wrong, cut_short, lines};

const EXPECTED: &str = "Properties=species:S:1:pos:R:3:radius:R:1, with further ones";

/// Whether a text is one, or plain xyz: it begins with a number that stands alone.
pub(super) fn is_one(text: &str) -> bool {
    let mut lines = text.lines();
    let count = lines.next().is_some_and(|line| line.trim().parse::<u64>().is_ok());
    count && lines.next().is_some()
}

/// Reads a frame: that of a number from 0 on, or the last one.
pub(super) fn read(text: &str, frame: Option<u64>) -> Result<Content, Wrong> {
    // Line, number of particles, and comment of each frame.
    let mut frames: Vec<(usize, usize, &str)> = Vec::new();
    let mut all = lines(text);
    while let Some((number, line)) = all.next() {
        if line.trim().is_empty() {
            continue;
        }
        let wrong = |_| Wrong::at(number, format!("`{}`", line.trim()), "the number of particles of a frame");
        let count: usize = line.trim().parse().map_err(wrong)?;
        let (_, comment) = all.next().ok_or_else(|| cut_short(text, EXPECTED))?;
        frames.push((number, count, comment));
        if count > 0 && all.nth(count - 1).is_none() {
            return Err(cut_short(text, "as many particles as the frame tells"));
        }
    }
    let last = frames.len().saturating_sub(1);
    let asked = frame.map_or(last, |frame| usize::try_from(frame).unwrap_or(usize::MAX));
    let Some(&(start, count, comment)) = frames.get(asked) else {
        let found = format!("has {} frames, no frame {asked}", frames.len());
        return Err(Wrong { found, expected: "a frame of the file, from 0 on" });
    };
    let columns = columns(comment, start + 1)?;
    let mut content = Content { format: "an extended xyz file", ..Content::default() };
    content.notes.push(format!("frame {asked} of {}", frames.len()));
    for (number, line) in lines(text).skip(start + 1).take(count) {
        let words: Vec<&str> = line.split_whitespace().collect();
        content.rows.push(columns.row(&words, number)?);
    }
    Ok(content)
}

/// Columns by the list of properties: name, kind and number of each.
fn columns(comment: &str, line: usize) -> Result<Columns, Wrong> {
    let list = comment.split_whitespace().find_map(|word| word.strip_prefix("Properties="));
    let list = list.ok_or_else(|| Wrong::at(line, "names no properties, and so no radius", EXPECTED))?;
    let words: Vec<&str> = list.trim_matches('"').split(':').collect();
    let mut names = Vec::new();
    for property in words.chunks(3) {
        let wrong = || Wrong::at(line, format!("`{}`", property.join(":")), "name, kind and number of a property");
        let &[name, _, count] = property else { return Err(wrong()) };
        let count: usize = count.parse().map_err(|_| wrong())?;
        let axes = match (name.to_lowercase().as_str(), count) {
            ("pos" | "position", 3) => ["x", "y", "z"],
            ("velo" | "vel" | "velocity" | "velocities", 3) => ["vx", "vy", "vz"],
            ("angular_velocity", 3) => ["omegax", "omegay", "omegaz"],
            _ => ["", "", ""],
        };
        match count {
            3 => names.extend(axes.map(str::to_owned)),
            1 => names.push(name.to_lowercase()),
            _ => names.extend(std::iter::repeat_n(String::new(), count.min(1000))),
        }
    }
    let columns = Columns::of(names.iter().map(String::as_str));
    match columns.lacks() {
        Some(missing) => Err(Wrong::at(line, format!("has no {missing} among its properties"), EXPECTED)),
        None => Ok(columns),
    }
}
