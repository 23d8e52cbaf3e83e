//! Where the cells of a body are kept.

use crate::divided::{ALONE, ELSEWHERE};

/// Block and cell of each cell of a body (element, or edge if smoothed); for what this rank does not have [`ELSEWHERE`] and a place among the
/// values of others, or [`ALONE`] and its own number.
#[derive(Clone, Debug)]
pub(crate) enum Places {
    /// Of every cell.
    All(Vec<(u32, u32)>),
    /// Of the cells of this rank, ascending; it finds the values of all others by itself.
    Own(Vec<(u32, (u32, u32))>),
}

impl Places {
    /// Those of cells of which none is kept yet.
    ///
    /// - `own`: cells of this rank, ascending, where it knows no others; `count`: of all
    pub(crate) fn new(own: Option<Vec<u32>>, count: usize) -> Self {
        let nowhere = (ELSEWHERE, 0);
        match own {
            Some(own) => Places::Own(own.into_iter().map(|cell| (cell, nowhere)).collect()),
            None => Places::All(vec![nowhere; count]),
        }
    }

    pub(crate) fn of(&self, cell: u32) -> (u32, u32) {
        match self {
            Places::All(all) => all[cell as usize],
            Places::Own(own) => own.binary_search_by_key(&cell, |(own, _)| *own).map_or((ALONE, cell), |at| own[at].1),
        }
    }

    /// The same where this rank has it, or another block of which it knows.
    pub(crate) fn kept(&self, cell: u32) -> Option<(u32, u32)> {
        Some(self.of(cell)).filter(|at| at.0 < ALONE)
    }

    /// Whether those of all cells are kept or received here; else this process finds the values of others by itself.
    pub(crate) fn keeps_all(&self) -> bool {
        matches!(self, Places::All(_))
    }

    /// Those of this rank, where it knows no others.
    pub(crate) fn own(&self) -> &[(u32, (u32, u32))] {
        if let Places::Own(own) = self { own } else { &[] }
    }

    pub(crate) fn put(&mut self, cell: u32, at: (u32, u32)) {
        match self {
            Places::All(all) => all[cell as usize] = at,
            Places::Own(own) => {
                let place = own.binary_search_by_key(&cell, |(own, _)| *own).expect("a cell of this rank");
                own[place].1 = at;
            }
        }
    }

    /// Of every cell; none where this rank knows those of its own alone.
    pub(crate) fn all(&self) -> &[(u32, u32)] {
        if let Places::All(all) = self { all } else { &[] }
    }

    /// Gives blocks the numbers that they have among those of all.
    pub(crate) fn move_blocks(&mut self, number: impl Fn(u32) -> u32) {
        let renumber = |(block, _): &mut (u32, u32)| {
            if *block < ALONE {
                *block = number(*block);
            }
        };
        match self {
            Places::All(all) => all.iter_mut().for_each(renumber),
            Places::Own(own) => own.iter_mut().map(|(_, at)| at).for_each(renumber),
        }
    }
}
