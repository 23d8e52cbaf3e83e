use serde::{Deserialize, Serialize};

/// A table whose rows differ in length (elements of a node, neighbours of a particle): one flat array and the offsets
/// of its rows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ragged {
    offsets: Vec<u32>,
    values: Vec<u32>,
}

impl Ragged {
    /// Inverts a table: row `r` of the result lists, in ascending order, the rows of `rows` that name `r`.
    ///
    /// - `rows`: for each owner, the ids that it names, all below `row_count`
    ///
    /// # Panics
    /// If an id is not below `row_count`, or if the table would hold 2³² entries or more.
    pub fn inverse<'a>(row_count: usize, rows: impl Iterator<Item = &'a [u32]> + Clone) -> Self {
        let mut offsets = vec![0u32; row_count + 1];
        let mut total = 0usize;
        for row in rows.clone() {
            total += row.len();
            for &id in row {
                offsets[id as usize + 1] += 1;
            }
        }
        assert!(total < u32::MAX as usize, "ragged table of {total} entries exceeds 32 bit offsets");
        for row in 0..row_count {
            offsets[row + 1] += offsets[row];
        }
        let mut next = offsets.clone();
        let mut values = vec![0u32; total];
        for (owner, row) in rows.enumerate() {
            for &id in row {
                values[next[id as usize] as usize] = owner as u32;
                next[id as usize] += 1;
            }
        }
        Ragged { offsets, values }
    }

    /// Builds a table from its rows.
    pub fn from_rows<R: AsRef<[u32]>>(rows: impl IntoIterator<Item = R>) -> Self {
        let mut table = Ragged { offsets: vec![0], values: Vec::new() };
        for row in rows {
            table.values.extend_from_slice(row.as_ref());
            table.offsets.push(u32::try_from(table.values.len()).expect("ragged table exceeds 32 bit offsets"));
        }
        table
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether the table has no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of one row.
    #[inline]
    pub fn row(&self, index: usize) -> &[u32] {
        &self.values[self.offsets[index] as usize..self.offsets[index + 1] as usize]
    }

    /// Where row `index` starts in [`Ragged::values`].
    #[inline]
    pub fn offset(&self, index: usize) -> usize {
        self.offsets[index] as usize
    }

    /// All values, row after row.
    pub fn values(&self) -> &[u32] {
        &self.values
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|row| self.row(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_lists_owners_in_ascending_order() {
        let triangles = [[0u32, 1, 2], [2, 1, 3]];
        let table = Ragged::inverse(5, triangles.iter().map(|t| t.as_slice()));
        assert_eq!(table.row(1), [0, 1]);
        assert_eq!(table.row(3), [1]);
        assert!(table.row(4).is_empty());
        assert_eq!(table, Ragged::from_rows(table.rows().map(<[u32]>::to_vec)));
    }
}
