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
    let mut sets = UnionFind::<u32>::new(count);
    for [a, b] in links {
        sets.union(a, b);
    }
    let mut labels = sets.into_labeling();
    let mut smallest = vec![u32::MAX; count];
    for (member, label) in (0..).zip(&mut labels) {
        let first = &mut smallest[*label as usize];
        *first = member.min(*first);
        *label = *first;
    }
    labels
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
