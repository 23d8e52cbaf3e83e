use fractum_math::Vec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;

/// Ratio of the largest to the mean radius beyond which a tree is searched instead of a grid, whose cells would hold too
/// many small spheres.
const UNEVEN: f64 = 3.0;

/// Pairs of spheres whose surfaces are nearer than `skin`, as ascending pairs in ascending order.
///
/// - `centres` [m], `radii` [m], of the same length; spheres with a negative radius are left out
/// - `skin` [m] ≥ 0
///
/// The work is proportional to the number of near pairs: spheres of similar size are sorted into a grid of cells as wide
/// as the largest of them with its skin, so that the search walks through memory; for radii that differ by more, up to
/// any ratio, it walks down a tree of boxes.
pub fn close_pairs(centres: &[Vec3], radii: &[f64], skin: f64) -> Vec<[u32; 2]> {
    let widest = radii.iter().fold(0.0f64, |a, &b| a.max(b));
    let width = 2.0 * widest + skin;
    if centres.len() < 2 || width <= 0.0 || !width.is_finite() {
        return Vec::new();
    }
    let mean = radii.iter().map(|radius| radius.max(0.0)).sum::<f64>() / radii.len() as f64;
    if widest + 0.5 * skin > UNEVEN * (mean + 0.5 * skin) {
        return pairs_by_tree(centres, radii, skin);
    }
    pairs_by_grid(centres, radii, skin, width)
}

fn pairs_by_tree(centres: &[Vec3], radii: &[f64], skin: f64) -> Vec<[u32; 2]> {
    let around = |i: usize| {
        let (x, half) = (centres[i], radii[i].max(0.0) + 0.5 * skin);
        Aabb::from_half_extents(Vector::new(x.x, x.y, x.z), Vector::new(half, half, half))
    };
    let boxes: Vec<Aabb> = (0..centres.len()).map(around).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let pairs_of = |(i, own): (usize, &Aabb)| {
        let near = |&j: &u32| {
            let reach = radii[i] + radii[j as usize] + skin;
            let there = radii[i].min(radii[j as usize]) >= 0.0;
            there && i < j as usize && (centres[j as usize] - centres[i]).norm_squared() < reach * reach
        };
        let mut found: Vec<[u32; 2]> = tree.intersect_aabb(own).filter(near).map(|j| [i as u32, j]).collect();
        found.sort_unstable();
        found
    };
    boxes.par_iter().enumerate().flat_map_iter(pairs_of).collect()
}

fn pairs_by_grid(centres: &[Vec3], radii: &[f64], skin: f64, width: f64) -> Vec<[u32; 2]> {
    let cell_of = |p: &Vec3| p.map(|c| (c / width).floor() as i64);
    let there = centres.par_iter().enumerate().filter(|(i, _)| radii[*i] >= 0.0);
    let mut sorted: Vec<([i64; 3], u32)> = there.map(|(i, p)| (cell_of(p).into(), i as u32)).collect();
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
        fn the_pairs_of_a_full_search_are_found(
            spheres in prop::collection::vec((prop::array::uniform3(-3f64..3.0), 0.05f64..0.8), 0..60),
            skin in 0f64..0.3,
            power in 0usize..3,
        ) {
            let centres: Vec<Vec3> = spheres.iter().map(|s| Vec3::from(s.0)).collect();
            // Radii within a factor of 16, of 256, and of 4096.
            let radii: Vec<f64> = spheres.iter().map(|s| s.1.powi(power as i32 + 1)).collect();
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
