//! The list of pairs of nodes that may touch: a row for each node with the partners of higher number, ascending.

/// Room of a row that gets its first entry.
const FIRST_ROOM: u32 = 4;

/// A pair of discrete elements that may touch, in the row of the node of lower number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Distance of the centres at which the pair touches [m].
    pub(super) closing: f64,
    /// Distance at which something about the pair changes [m]: its closing distance, or that it is near at all.
    pub(super) parting: f64,
    /// The other node.
    pub(super) partner: u32,
    /// Nodes of one mesh edge, all of whose elements have been removed: they touch at their undeformed distance, until
    /// they have parted by more than that.
    pub(super) neighbours: bool,
    /// Among the contacts of the last step.
    pub(super) touches: bool,
}

/// Rows with room to grow in one array: an entry more moves a few others of its row, and now and then the row.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    headers: Vec<Header>,
    entries: Vec<Entry>,
    /// Entries in rows.
    used: usize,
    /// Places that rows have left behind.
    left: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Header {
    start: u32,
    length: u32,
    room: u32,
}

impl Rows {
    pub(super) fn new(nodes: usize) -> Self {
        Rows { headers: vec![Header::default(); nodes], ..Rows::default() }
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.headers.len()
    }

    pub(super) fn row(&self, node: u32) -> &[Entry] {
        let Header { start, length, .. } = self.headers[node as usize];
        &self.entries[start as usize..(start + length) as usize]
    }

    pub(super) fn row_mut(&mut self, node: u32) -> &mut [Entry] {
        let Header { start, length, .. } = self.headers[node as usize];
        &mut self.entries[start as usize..(start + length) as usize]
    }

    /// The entry of a pair of nodes, ascending.
    pub(super) fn find(&self, [node, partner]: [u32; 2]) -> Option<usize> {
        self.row(node).iter().position(|entry| entry.partner == partner)
    }

    /// Adds an entry to the row of a node, which must not have it.
    pub(super) fn add(&mut self, node: u32, entry: Entry) {
        let header = self.headers[node as usize];
        if header.length == header.room {
            self.move_row(node, (2 * header.room).max(FIRST_ROOM));
        }
        let header = &mut self.headers[node as usize];
        let (start, end) = (header.start as usize, (header.start + header.length) as usize);
        header.length += 1;
        self.used += 1;
        let place = start + self.entries[start..end].partition_point(|other| other.partner < entry.partner);
        self.entries.copy_within(place..end, place + 1);
        self.entries[place] = entry;
    }

    /// Takes the entry of a pair away, if it is there.
    pub(super) fn remove(&mut self, nodes: [u32; 2]) {
        let Some(index) = self.find(nodes) else { return };
        let header = &mut self.headers[nodes[0] as usize];
        let (place, end) = (header.start as usize + index, (header.start + header.length) as usize);
        header.length -= 1;
        self.used -= 1;
        self.entries.copy_within(place + 1..end, place);
    }

    /// Gives a row more room, at the end of all.
    fn move_row(&mut self, node: u32, room: u32) {
        if self.left > self.used + self.headers.len() {
            self.pack();
        }
        let Header { start, length, room: before } = self.headers[node as usize];
        let begin = self.entries.len();
        self.entries.extend_from_within(start as usize..(start + length) as usize);
        let unused = Entry { closing: 0.0, parting: 0.0, partner: 0, neighbours: false, touches: false };
        self.entries.resize(begin + room as usize, unused);
        self.headers[node as usize] = Header { start: begin as u32, length, room };
        self.left += before as usize;
    }

    /// Puts all rows side by side.
    fn pack(&mut self) {
        let mut packed = Vec::with_capacity(self.entries.len() - self.left);
        for header in &mut self.headers {
            let start = header.start as usize;
            header.start = packed.len() as u32;
            packed.extend_from_slice(&self.entries[start..start + header.room as usize]);
        }
        (self.entries, self.left) = (packed, 0);
    }
}
