//! The pieces of a PVTU or PVTP as one.

use std::collections::BTreeMap;

use super::Arrays;
use crate::file::tags;
use crate::pieces::NUMBERS;

/// What a PVTU or PVTP lists.
#[derive(Clone, Debug)]
pub struct PieceList {
    /// Files of the pieces, relative to that of the list.
    pub pieces: Vec<String>,
    /// Arrays over points, and the components of each.
    of_points: BTreeMap<String, usize>,
}

impl PieceList {
    /// The array that numbers the points of each piece: without it the pieces cannot be joined.
    pub const NUMBERS: &'static str = NUMBERS;

    /// Reads the text of such a list; none of one that these writers did not make.
    pub fn parse(text: &str) -> Option<Self> {
        let mut list = PieceList { pieces: Vec::new(), of_points: BTreeMap::new() };
        let mut of_points = false;
        for tag in tags(text)? {
            match tag.name {
                "PPoints" | "PPointData" => of_points = !tag.closes,
                "PDataArray" if of_points => {
                    let components = tag.count("NumberOfComponents").ok()?.max(1);
                    list.of_points.insert(tag.attribute("Name")?, components);
                }
                "Piece" => list.pieces.push(tag.attribute("Source")?),
                _ => {}
            }
        }
        (!list.pieces.is_empty()).then_some(list)
    }

    /// The whole that the pieces were cut from, with the arrays of these names.
    ///
    /// - `pieces`: arrays of each, in the order of the list
    ///
    /// # Errors
    /// The first piece whose arrays do not fit together.
    pub fn joined(&self, pieces: &[Arrays], wanted: &[&str]) -> Result<Arrays, usize> {
        // Every point is in some piece, so that there are no more than this.
        let most: usize = pieces.iter().map(|piece| piece.get(NUMBERS).len()).sum();
        let mut whole = BTreeMap::new();
        for (index, arrays) in pieces.iter().enumerate() {
            add(&mut whole, arrays, &self.of_points, most).ok_or(index)?;
        }
        whole.retain(|name, _| wanted.contains(&name.as_str()));
        Ok(Arrays(whole))
    }
}

/// Puts what a piece has where it is in the whole; none where its arrays do not fit together.
///
/// - `most`: bound of the number of points in the whole
fn add(
    whole: &mut BTreeMap<String, Vec<f64>>,
    piece: &Arrays,
    of_points: &BTreeMap<String, usize>,
    most: usize,
) -> Option<()> {
    let numbers: Vec<usize> = piece.get(NUMBERS).iter().map(|&number| number as usize).collect();
    let points = numbers.iter().map(|number| number + 1).max().unwrap_or(0);
    if points > most {
        return None;
    }
    let before = whole.get("offsets").and_then(|ends| ends.last().copied()).unwrap_or(0.0);
    for (name, values) in &piece.0 {
        let to = whole.entry(name.clone()).or_default();
        match (name.as_str(), of_points.get(name.as_str())) {
            (_, Some(&components)) if values.len() == components * numbers.len() => {
                to.resize(to.len().max(components * points), 0.0);
                for (row, &number) in values.chunks_exact(components).zip(&numbers) {
                    to[components * number..components * (number + 1)].copy_from_slice(row);
                }
            }
            (_, Some(_)) => return None,
            ("connectivity", _) => {
                for &local in values {
                    to.push(*numbers.get(local as usize)? as f64);
                }
            }
            ("offsets", _) => to.extend(values.iter().map(|end| before + end)),
            ("TimeValue", _) => to.clone_from(values),
            _ => to.extend(values),
        }
    }
    Some(())
}
