/// From node tags to indices: a table where the tags are dense, a sorted list where they are sparse.
pub(super) enum NodeIndex {
    Dense(Vec<u32>),
    Sparse(Vec<(u64, u32)>),
}

/// A table of this many entries per tag (and some) is taken as small.
const SPREAD: usize = 4;

fn table_length(highest: u64, count: usize) -> Option<usize> {
    usize::try_from(highest).ok().and_then(|highest| highest.checked_add(1)).filter(|&length| length / SPREAD <= count)
}

impl NodeIndex {
    const NONE: u32 = u32::MAX;

    /// Indexes the tags.
    ///
    /// # Errors
    /// The index of the second node of a repeated tag.
    pub(super) fn new(tags: &[u64]) -> Result<Self, usize> {
        let highest = tags.iter().copied().max().unwrap_or(0);
        if let Some(length) = table_length(highest, tags.len()) {
            let mut table = vec![Self::NONE; length];
            for (index, &tag) in tags.iter().enumerate() {
                let entry = &mut table[tag as usize];
                if *entry != Self::NONE {
                    return Err(index);
                }
                *entry = index as u32;
            }
            return Ok(NodeIndex::Dense(table));
        }
        let mut pairs: Vec<(u64, u32)> = tags.iter().zip(0..).map(|(&tag, index)| (tag, index)).collect();
        pairs.sort_unstable();
        match pairs.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1).min() {
            Some(second) => Err(second as usize),
            None => Ok(NodeIndex::Sparse(pairs)),
        }
    }

    #[inline]
    pub(super) fn find(&self, tag: u64) -> Option<u32> {
        match self {
            NodeIndex::Dense(table) => {
                table.get(usize::try_from(tag).ok()?).copied().filter(|&index| index != Self::NONE)
            }
            NodeIndex::Sparse(pairs) => {
                pairs.binary_search_by_key(&tag, |pair| pair.0).ok().map(|position| pairs[position].1)
            }
        }
    }
}

/// The first index, in file order, whose tag some lower index of `kept` has too.
pub(super) fn repeated_tag(tags: &[u64], kept: [&[u32]; 5]) -> Option<usize> {
    let count: usize = kept.iter().map(|indices| indices.len()).sum();
    let indices = || kept.into_iter().flatten().map(|&index| index as usize);
    let highest = indices().map(|index| tags[index]).max()?;
    if let Some(length) = table_length(highest, count) {
        let mut seen = vec![u32::MAX; length];
        let mut repeated: Option<usize> = None;
        for index in indices() {
            let entry = &mut seen[tags[index] as usize];
            if *entry != u32::MAX {
                let later = index.max(*entry as usize);
                repeated = Some(repeated.map_or(later, |other| other.min(later)));
            }
            *entry = (*entry).min(index as u32);
        }
        return repeated;
    }
    let mut pairs: Vec<(u64, usize)> = indices().map(|index| (tags[index], index)).collect();
    pairs.sort_unstable();
    pairs.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_and_sparse_tags_are_found_and_others_are_not() {
        for tags in [vec![3, 1, 2], vec![u64::MAX, 0, 1 << 40]] {
            let index = NodeIndex::new(&tags).unwrap();
            for (position, &tag) in tags.iter().enumerate() {
                assert_eq!(index.find(tag), Some(position as u32));
            }
            assert_eq!(index.find(77), None);
        }
    }

    #[test]
    fn the_first_repetition_in_file_order_is_reported() {
        assert_eq!(NodeIndex::new(&[5, 6, 5, 6]).err(), Some(2));
        assert_eq!(NodeIndex::new(&[1 << 50, 6, 7, 1 << 50]).err(), Some(3));
        assert_eq!(repeated_tag(&[4, 5, 4, 5], [&[1, 3], &[], &[0, 2], &[], &[]]), Some(2));
        assert_eq!(repeated_tag(&[1 << 50, 5, 1 << 50], [&[0], &[], &[2], &[1], &[]]), Some(2));
        assert_eq!(repeated_tag(&[4, 5, 4], [&[0, 1], &[], &[], &[], &[]]), None);
    }
}
