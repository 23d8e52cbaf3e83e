use std::collections::BTreeMap;

use fractum_math::Vec3;

use super::cursor::Cursor;
use super::element_type::ElementType;
use super::error::Fault;

/// A mesh as the file tells it: tags instead of indices, nothing cross-checked, and where each record lies.
#[derive(Default)]
pub(crate) struct Raw {
    pub(crate) names: Vec<PhysicalName>,
    /// Physical tags of each entity, by dimension and entity tag; none where the file has no such section.
    pub(crate) entities: Option<BTreeMap<(u8, i32), Vec<i32>>>,
    pub(crate) node_tags: Vec<u64>,
    pub(crate) nodes: Vec<Vec3>,
    /// First node and records of each block of nodes.
    pub(crate) node_blocks: Vec<(usize, Records)>,
    pub(crate) element_tags: Vec<u64>,
    /// Node tags of the corners, element after element.
    pub(crate) corners: Vec<u64>,
    pub(crate) runs: Vec<Run>,
    pub(crate) notices: Vec<String>,
}

/// A line of `$PhysicalNames`.
pub(crate) struct PhysicalName {
    pub(crate) dimension: u8,
    pub(crate) tag: i32,
    pub(crate) name: String,
    pub(crate) at: usize,
}

/// Consecutive elements of one type and one membership.
pub(crate) struct Run {
    pub(crate) kind: ElementType,
    pub(crate) membership: Membership,
    pub(crate) count: usize,
    /// Index of the first element in [`Raw::element_tags`].
    pub(crate) first: usize,
    /// Index of its first corner in [`Raw::corners`].
    pub(crate) first_corner: usize,
    pub(crate) records: Records,
    /// For each element the record that it is a piece of; none where each has its own.
    pub(crate) pieces: Option<Vec<u32>>,
}

/// How a run tells its physical groups.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Membership {
    /// MSH 2.2: the physical tag itself without sign, 0 for none.
    Physical(i32),
    /// MSH 4.1: the entity that lists them.
    Entity(i32),
}

/// Where equal records lie: every `stride` bytes, or one to a line when the stride is 0.
#[derive(Clone, Copy)]
pub(crate) struct Records {
    pub(crate) at: usize,
    pub(crate) stride: usize,
}

impl Records {
    /// Offset of a record.
    pub(crate) fn locate(self, bytes: &[u8], index: usize) -> usize {
        if self.stride > 0 {
            return self.at + index * self.stride;
        }
        let mut cursor = Cursor { bytes, at: self.at };
        let mut at = self.at;
        for _ in 0..=index {
            at = cursor.line().map_or(bytes.len(), |(start, _)| start);
        }
        at
    }
}

impl Run {
    /// Offset of the record of an element, counted from the first of the run.
    pub(crate) fn locate(&self, bytes: &[u8], element: usize) -> usize {
        self.records.locate(bytes, self.pieces.as_ref().map_or(element, |pieces| pieces[element] as usize))
    }
}

impl Raw {
    /// Refuses more nodes or elements than indices can tell apart.
    pub(crate) fn limit_counts(&self, bytes: &[u8]) -> Result<(), Fault> {
        let (nodes, elements) = (self.nodes.len(), self.element_tags.len());
        if nodes >= u32::MAX as usize || elements >= u32::MAX as usize {
            let message = format!("{nodes} nodes and {elements} elements; fractum holds fewer than 4294967295 of each");
            return Err(Fault::unsupported(bytes.len(), message));
        }
        Ok(())
    }

    /// Physical tags of a run, without sign.
    pub(crate) fn physical_tags<'a>(&'a self, run: &'a Run) -> &'a [i32] {
        match &run.membership {
            Membership::Physical(0) => &[],
            Membership::Physical(tag) => std::slice::from_ref(tag),
            Membership::Entity(tag) => {
                let entities = self.entities.as_ref();
                entities.and_then(|map| map.get(&(run.kind.shape.dimension(), *tag))).map_or(&[], Vec::as_slice)
            }
        }
    }

    /// Appends to the last run where it continues, or starts a new one.
    pub(crate) fn extend_runs(&mut self, kind: ElementType, membership: Membership, records: Records) {
        if let Some(run) = self.runs.last_mut()
            && run.kind == kind
            && run.membership == membership
            && run.records.stride == 0
            && records.stride == 0
        {
            run.count += 1;
            return;
        }
        self.push_run(kind, membership, 1, records);
    }

    /// Starts a run whose elements are about to be appended.
    pub(crate) fn push_run(&mut self, kind: ElementType, membership: Membership, count: usize, records: Records) {
        let (first, first_corner) = (self.element_tags.len(), self.corners.len());
        self.runs.push(Run { kind, membership, count, first, first_corner, records, pieces: None });
    }
}
