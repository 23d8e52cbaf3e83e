//! Elements that lie on the same side of a facet: a mesh that is folded.

use crate::topology::{Side, TETRAHEDRON_FACETS, TRIANGLE_SIDES, by_sides};

/// Two elements on the same side of a facet that both have: they overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// The first such pair, by the nodes of its facet.
    pub elements: [u32; 2],
    /// Number of facets with such a pair.
    pub count: usize,
}

/// Whether tetrahedra of positive volume are folded. Elements on both sides of a facet see its nodes in opposite senses.
pub fn fold_of_tetrahedra(elements: &[[u32; 4]]) -> Option<Fold> {
    fold(elements, TETRAHEDRON_FACETS)
}

/// Whether counter-clockwise triangles are folded.
pub fn fold_of_triangles(elements: &[[u32; 3]]) -> Option<Fold> {
    fold(elements, TRIANGLE_SIDES)
}

fn fold<const N: usize, const S: usize>(elements: &[[u32; N]], local: [[usize; S]; N]) -> Option<Fold> {
    let is_even = |&(_, element, side): &Side<S>| {
        let nodes = local[side].map(|corner| elements[element as usize][corner]);
        let later = |i: usize| nodes[i + 1..].iter().filter(|&&node| node < nodes[i]).count();
        (0..S).map(later).sum::<usize>() % 2 == 0
    };
    let same_side = |equal: &[Side<S>]| {
        let [even, odd]: [Vec<u32>; 2] =
            [true, false].map(|even| equal.iter().filter(|side| is_even(side) == even).map(|side| side.1).collect());
        [even, odd].into_iter().find_map(|beside| beside.get(..2).map(|pair| [pair[0], pair[1]]))
    };
    let tasks = by_sides(elements, local, |sides| {
        let shared = sides.chunk_by(|a, b| a.0 == b.0).filter(|equal| equal.len() > 1);
        let mut pairs = shared.filter_map(same_side);
        pairs.next().map(|elements| Fold { elements, count: 1 + pairs.count() })
    });
    tasks.into_iter().flatten().reduce(|all, more| Fold { count: all.count + more.count, ..all })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::generate::{structured_box, structured_rectangle};

    #[test]
    fn a_mesh_without_folds_has_none() {
        assert_eq!(fold_of_tetrahedra(&structured_box([3, 4, 2], Vec3::repeat(1.0), None).tetrahedra), None);
        assert_eq!(fold_of_triangles(&structured_rectangle([5, 4], [1.0, 1.0], None).triangles), None);
        assert_eq!(fold_of_triangles(&[]), None);
    }

    #[test]
    fn triangles_on_one_side_of_a_side_are_told() {
        // Two on one side of (0, 1), and one on the other.
        let triangles = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert_eq!(fold_of_triangles(&triangles), Some(Fold { elements: [0, 2], count: 1 }));
        assert_eq!(fold_of_triangles(&triangles[..2]), None);
    }

    #[test]
    fn tetrahedra_on_one_side_of_a_facet_are_told() {
        let tetrahedra = [[0, 1, 2, 3], [0, 2, 1, 4], [0, 1, 2, 5]];
        assert_eq!(fold_of_tetrahedra(&tetrahedra), Some(Fold { elements: [0, 2], count: 1 }));
        assert_eq!(fold_of_tetrahedra(&tetrahedra[..2]), None);
    }
}
