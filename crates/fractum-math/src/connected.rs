use petgraph::unionfind::UnionFind;

/// Connected parts of `0..count` under links: for each member, the smallest member of its part.
///
/// ```
/// assert_eq!(fractum_math::connected(5, [[3, 1], [4, 3]]), [0, 1, 2, 1, 1]);
/// ```
///
/// # Panics
/// If a link names something that is not below `count`.
pub fn connected(count: usize, links: impl IntoIterator<Item = [u32; 2]>) -> Vec<u32> {
    let mut parts = Connected::new(count);
    links.into_iter().for_each(|link| parts.join(link));
    parts.smallest()
}

/// Parts that grow link by link.
pub struct Connected(UnionFind<u32>);

impl Connected {
    /// Each of `0..count` by itself.
    pub fn new(count: usize) -> Self {
        Connected(UnionFind::new(count))
    }

    /// Makes one part of those of two members.
    ///
    /// # Panics
    /// If one is not below the count.
    pub fn join(&mut self, [a, b]: [u32; 2]) {
        self.0.union(a, b);
    }

    /// For each member the smallest member of its part.
    pub fn smallest(self) -> Vec<u32> {
        let mut labels = self.0.into_labeling();
        let mut smallest = vec![u32::MAX; labels.len()];
        for (member, label) in (0..).zip(&mut labels) {
            let first = &mut smallest[*label as usize];
            *first = member.min(*first);
            *label = *first;
        }
        labels
    }
}

/// The same with the parts numbered in the order of their first members: the part of each member, and their number.
///
/// ```
/// assert_eq!(fractum_math::numbered_parts(5, [[3, 1], [4, 3]]), (vec![0, 1, 2, 1, 1], 3));
/// ```
///
/// # Panics
/// As [`connected`].
pub fn numbered_parts(count: usize, links: impl IntoIterator<Item = [u32; 2]>) -> (Vec<u32>, u32) {
    let mut part = connected(count, links);
    let mut parts = 0;
    for member in 0..count {
        let first = part[member] as usize;
        // The first member of a part has its number by the time the others ask for it.
        part[member] = if first == member { parts } else { part[first] };
        parts += u32::from(first == member);
    }
    (part, parts)
}
