use fractum_math::Vec3;
use rayon::prelude::*;

/// Pairs of spheres whose surfaces are nearer than `skin`, as ascending pairs in ascending order.
///
/// - `centres` [m], `radii` [m] ≥ 0, of the same length
/// - `skin` [m] ≥ 0
///
/// A grid of cells as wide as the largest sphere with its skin; spheres are sorted by cell, so that the search walks
/// through memory. The work is proportional to the number of near pairs, for radii of one order of magnitude.
pub fn close_pairs(centres: &[Vec3], radii: &[f64], skin: f64) -> Vec<[u32; 2]> {
    let widest = radii.iter().fold(0.0f64, |a, &b| a.max(b));
    let width = 2.0 * widest + skin;
    if centres.len() < 2 || width <= 0.0 || !width.is_finite() {
        return Vec::new();
    }
    let cell_of = |p: &Vec3| p.map(|c| (c / width).floor() as i64);
    let key = |cell: [i64; 3]| cell;
    let mut sorted: Vec<([i64; 3], u32)> =
        centres.par_iter().enumerate().map(|(i, p)| (key(cell_of(p).into()), i as u32)).collect();
    sorted.par_sort_unstable();
    let pairs_of = |&(cell, i): &([i64; 3], u32)| {
        let mut found = Vec::new();
        for dx in -1..=1 {
            for dy in -1..=1 {
                // The cells of one column lie side by side in the sorted list.
                let first = [cell[0] + dx, cell[1] + dy, cell[2] - 1];
                let last = [cell[0] + dx, cell[1] + dy, cell[2] + 1];
                let start = sorted.partition_point(|(c, _)| *c < first);
                for &(_, j) in sorted[start..].iter().take_while(|(c, _)| *c <= last) {
                    let reach = radii[i as usize] + radii[j as usize] + skin;
                    let apart = centres[j as usize] - centres[i as usize];
                    if i < j && apart.norm_squared() < reach * reach {
                        found.push([i, j]);
                    }
                }
            }
        }
        found
    };
    let mut pairs: Vec<[u32; 2]> = sorted.par_iter().flat_map_iter(pairs_of).collect();
    pairs.par_sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn grid_finds_the_pairs_of_a_full_search(
            spheres in prop::collection::vec((prop::array::uniform3(-3f64..3.0), 0.05f64..0.8), 0..60),
            skin in 0f64..0.3,
        ) {
            let centres: Vec<Vec3> = spheres.iter().map(|s| Vec3::from(s.0)).collect();
            let radii: Vec<f64> = spheres.iter().map(|s| s.1).collect();
            let mut expected = Vec::new();
            for i in 0..centres.len() {
                for j in i + 1..centres.len() {
                    if (centres[i] - centres[j]).norm() < radii[i] + radii[j] + skin {
                        expected.push([i as u32, j as u32]);
                    }
                }
            }
            prop_assert_eq!(close_pairs(&centres, &radii, skin), expected);
        }
    }
}
