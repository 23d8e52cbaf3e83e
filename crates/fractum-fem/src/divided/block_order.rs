//! Whose block is which, and how they are numbered: body by body, of each those that may be damaged before the others, and of either those of the
//! first rank before those of the next.

use std::ops::Range;

use fractum_parallel::{Exchange, gather};

use super::BodyShare;

/// The blocks of all ranks.
#[derive(Clone, Debug)]
pub(crate) struct BlockOrder {
    /// First block of every rank, and the end.
    pub(crate) first: Vec<usize>,
    /// Those of the bodies that every rank has whole.
    pub(crate) whole: Vec<Range<usize>>,
    /// Blocks of each class that each rank evaluates, two classes for a body; empty where every rank has all bodies whole.
    counts: Vec<Vec<usize>>,
}

/// Blocks of a body in its two classes: those that may be damaged, or all where no rank has no more cells than its own, and the others.
pub(crate) type Classes<T> = [Vec<T>; 2];

impl BlockOrder {
    /// That of ranks that have all bodies whole.
    ///
    /// - `first`: first block of every rank, and the end
    pub(crate) fn of_whole(first: Vec<usize>) -> Self {
        let whole = std::iter::once(0..first.last().copied().unwrap_or(0)).collect();
        BlockOrder { first, whole, counts: Vec::new() }
    }

    /// All ranks must call it.
    ///
    /// - `made`: cells of the blocks of each body, of those of this rank, or of all where it is whole
    pub(crate) fn new(exchange: &dyn Exchange, shares: &[BodyShare], made: &[Classes<usize>]) -> Self {
        let own: Vec<usize> = made.as_flattened().iter().map(Vec::len).collect();
        let of_ranks = gather(exchange, &own);
        let of_class = |(class, made): (usize, &Vec<usize>)| match &shares[class / 2] {
            share if share.is_whole() => dealt(&share.cells, made),
            _ => of_ranks.iter().map(|counts| counts[class]).collect(),
        };
        let counts: Vec<Vec<usize>> = made.as_flattened().iter().enumerate().map(of_class).collect();
        let of_rank = |rank: usize| counts.iter().map(|counts| counts[rank]).sum::<usize>();
        let mut first = vec![0];
        (0..exchange.size()).for_each(|rank| first.push(first[rank] + of_rank(rank)));
        let mut order = BlockOrder { first, whole: Vec::new(), counts };
        let whole = shares.iter().enumerate().filter(|(_, share)| share.is_whole());
        order.whole = whole.map(|(body, _)| order.begin(2 * body)..order.begin(2 * body + 2)).collect();
        order
    }

    /// First block of a class.
    fn begin(&self, class: usize) -> usize {
        self.counts[..class].iter().flatten().sum()
    }

    /// First block of each class of a body that a rank has: its own, or the first of all where it is whole.
    pub(crate) fn begin_of(&self, body: usize, rank: usize, share: &BodyShare) -> [usize; 2] {
        [2 * body, 2 * body + 1].map(|class| {
            let before = if share.is_whole() { 0 } else { self.counts[class][..rank].iter().sum() };
            self.begin(class) + before
        })
    }
}

/// How many of all blocks of a body go to each rank.
///
/// - `dealt`: cells that each rank was dealt; `blocks`: cells of each
fn dealt(dealt: &[usize], blocks: &[usize]) -> Vec<usize> {
    let mut counts = vec![0; dealt.len()];
    let (mut rank, mut end, mut before) = (0, dealt[0], 0);
    for cells in blocks {
        // A block belongs to the rank in whose share its middle lies.
        while 2 * before + cells >= 2 * end && rank + 1 < dealt.len() {
            rank += 1;
            end += dealt[rank];
        }
        counts[rank] += 1;
        before += cells;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::dealt;

    #[test]
    fn blocks_go_to_the_ranks_that_were_dealt_their_cells() {
        assert_eq!(dealt(&[4, 4], &[4, 4]), [1, 1]);
        assert_eq!(dealt(&[0, 5, 0, 3], &[2, 2, 2, 2]), [0, 2, 0, 2]);
        assert_eq!(dealt(&[1, 1, 1], &[3]), [0, 1, 0]);
        assert_eq!(dealt(&[0, 0], &[]), [0, 0]);
    }
}
