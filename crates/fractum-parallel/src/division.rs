//! How items are divided among ranks.

use std::ops::Range;

/// First item of each rank, and the end: runs of about the same weight.
pub fn runs_by_weight(weights: &[usize], ranks: usize) -> Vec<usize> {
    let total: usize = weights.iter().sum();
    let (mut first, mut sum) = (vec![0], 0);
    for (item, weight) in weights.iter().enumerate() {
        // An item belongs to the rank in whose share its middle lies.
        while first.len() < ranks && (2 * sum + weight) * ranks >= 2 * total * first.len() {
            first.push(item);
        }
        sum += weight;
    }
    first.resize(ranks, weights.len());
    first.push(weights.len());
    first
}

/// The rank of an item, by the first items of all.
pub fn rank_of(first: &[usize], item: usize) -> usize {
    first.partition_point(|&first| first <= item) - 1
}

/// The runs of what is true.
pub fn runs_of(flags: &[bool]) -> Vec<Range<usize>> {
    let mut begin = 0;
    let mut runs = Vec::new();
    for run in flags.chunk_by(|a, b| a == b) {
        let end = begin + run.len();
        if run[0] {
            runs.push(begin..end);
        }
        begin = end;
    }
    runs
}

/// Items of a round, where at most `limit` go in each.
#[cfg(any(feature = "mpi", test))]
pub(crate) fn piece(items: usize, round: usize, limit: usize) -> Range<usize> {
    (round * limit).min(items)..((round + 1) * limit).min(items)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_shared_by_weight_and_every_one_has_a_rank() {
        assert_eq!(runs_by_weight(&[1; 8], 4), [0, 2, 4, 6, 8]);
        assert_eq!(runs_by_weight(&[6, 1, 1, 1, 1, 2], 2), [0, 1, 6]);
        assert_eq!(runs_by_weight(&[5, 5], 4).len(), 5);
        for ranks in 1..9 {
            let first = runs_by_weight(&[3, 1, 4, 1, 5], ranks);
            assert!(first.is_sorted() && first[0] == 0 && first[ranks] == 5 && first.len() == ranks + 1);
            for rank in 0..ranks {
                assert!((first[rank]..first[rank + 1]).all(|item| rank_of(&first, item) == rank));
            }
        }
    }

    #[test]
    fn all_items_go_in_rounds_each_once() {
        for items in [0, 1, 6, 7, 20] {
            let rounds: Vec<usize> = (0..3).flat_map(|round| piece(items, round, 7)).collect();
            assert_eq!(rounds, (0..items).collect::<Vec<_>>());
        }
    }

    #[test]
    fn runs_are_those_of_what_is_true() {
        assert_eq!(runs_of(&[true, true, false, true]), [0..2, 3..4]);
        assert_eq!(runs_of(&[false]), []);
    }
}
