//! `$Entities` and `$PartitionedEntities` of MSH 4.1, read for their physical tags alone.

use std::collections::BTreeMap;

use super::binary::Layout;
use crate::tagged::cursor::{Cursor, Record, What};
use crate::tagged::error::Fault;

/// Physical tags by dimension and entity tag.
pub(super) type Entities = BTreeMap<(u8, i32), Vec<i32>>;

/// Reads `$Entities`: after four counts, each entity has its tag, a box (a position for points), its physical tags
/// and, above dimension 0, its signed boundary.
pub(super) fn read(cursor: &mut Cursor, layout: Option<Layout>, entities: &mut Entities) -> Result<(), Fault> {
    let mut source = Source::new(cursor, layout, "the counts of the entities")?;
    let counts = source.counts()?;
    read_all(cursor, layout, counts, false, entities)
}

/// Reads `$PartitionedEntities`: as `$Entities`, after the ghost entities, with parent and partitions before the box.
pub(super) fn read_partitioned(
    cursor: &mut Cursor,
    layout: Option<Layout>,
    entities: &mut Entities,
) -> Result<(), Fault> {
    Source::new(cursor, layout, "the number of partitions")?.unsigned("the count")?;
    let ghosts = Source::new(cursor, layout, "the number of ghost entities")?.unsigned("the count")?;
    for _ in 0..ghosts {
        let mut source = Source::new(cursor, layout, "a ghost entity")?;
        source.integer("the tag")?;
        source.integer("the partition")?;
    }
    let counts = Source::new(cursor, layout, "the counts of the partitioned entities")?.counts()?;
    read_all(cursor, layout, counts, true, entities)
}

fn read_all(
    cursor: &mut Cursor,
    layout: Option<Layout>,
    counts: [u64; 4],
    partitioned: bool,
    entities: &mut Entities,
) -> Result<(), Fault> {
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let at = cursor.at;
            let mut source = Source::new(cursor, layout, "an entity")?;
            let tag = source.integer("the tag")?;
            if partitioned {
                source.integer("the dimension of the parent")?;
                source.integer("the tag of the parent")?;
                source.skip_integers("the number of partitions")?;
            }
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                source.real("a coordinate")?;
            }
            let mut physical = source.integers("the number of physical tags")?;
            if dimension > 0 {
                source.skip_integers("the number of bounding entities")?;
            }
            source.end()?;
            // a negative tag says that the group sees the entity reversed
            physical.iter_mut().for_each(|tag| *tag = tag.saturating_abs());
            physical.sort_unstable();
            physical.dedup();
            if entities.insert((dimension as u8, tag), physical).is_some() {
                return Err(Fault::inconsistent(at, format!("entity {tag} of dimension {dimension} is listed twice")));
            }
        }
    }
    Ok(())
}

/// The fields of one entity: those of a line, or bytes as they come.
enum Source<'c, 'a> {
    Text(Record<'a>),
    Bytes(&'c mut Cursor<'a>, Layout),
}

impl<'c, 'a> Source<'c, 'a> {
    fn new(cursor: &'c mut Cursor<'a>, layout: Option<Layout>, noun: &'static str) -> Result<Self, Fault> {
        match layout {
            None => cursor.record(What::one(noun)).map(Source::Text),
            Some(layout) => Ok(Source::Bytes(cursor, layout)),
        }
    }

    fn integer(&mut self, expected: &'static str) -> Result<i32, Fault> {
        match self {
            Source::Text(record) => record.integer32(expected),
            Source::Bytes(cursor, layout) => layout.take_i32(cursor, expected),
        }
    }

    fn unsigned(&mut self, expected: &'static str) -> Result<u64, Fault> {
        match self {
            Source::Text(record) => record.unsigned(expected),
            Source::Bytes(cursor, layout) => layout.take_word(cursor, expected),
        }
    }

    fn real(&mut self, expected: &'static str) -> Result<(), Fault> {
        match self {
            Source::Text(record) => record.real(expected).map(drop),
            Source::Bytes(cursor, _) => cursor.take(8, What::one(expected)).map(drop),
        }
    }

    fn counts(&mut self) -> Result<[u64; 4], Fault> {
        Ok([
            self.unsigned("the number of points")?,
            self.unsigned("the number of curves")?,
            self.unsigned("the number of surfaces")?,
            self.unsigned("the number of volumes")?,
        ])
    }

    /// A count and that many integers. Grows as they come, so that a wrong count meets the end of the file first.
    fn integers(&mut self, expected: &'static str) -> Result<Vec<i32>, Fault> {
        let count = self.unsigned(expected)?;
        let mut values = Vec::new();
        for _ in 0..count {
            values.push(self.integer("a tag")?);
        }
        Ok(values)
    }

    fn skip_integers(&mut self, expected: &'static str) -> Result<(), Fault> {
        for _ in 0..self.unsigned(expected)? {
            self.integer("a tag")?;
        }
        Ok(())
    }

    fn end(self) -> Result<(), Fault> {
        match self {
            Source::Text(record) => record.end(),
            Source::Bytes(..) => Ok(()),
        }
    }
}
