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
