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
    close_pairs_of(centres, radii, skin, &|_| true)
}

/// [`close_pairs`] of which one sphere at least is wanted: cheap where these are few and lie together.
pub fn close_pairs_of(
    centres: &[Vec3],
    radii: &[f64],
    skin: f64,
    is_wanted: &(dyn Fn(usize) -> bool + Sync),
) -> Vec<[u32; 2]> {
    let widest = radii.iter().fold(0.0f64, |a, &b| a.max(b));
    let width = 2.0 * widest + skin;
    let wanted = (0..centres.len()).filter(|&i| radii[i] >= 0.0 && is_wanted(i)).map(|i| centres[i]);
    let bounds = wanted.fold(None, |bounds: Option<(Vec3, Vec3)>, x| {
        Some(bounds.map_or((x, x), |(low, high)| (low.inf(&x), high.sup(&x))))
    });
    let Some((low, high)) = bounds.filter(|_| centres.len() > 1 && width > 0.0 && width.is_finite()) else {
        return Vec::new();
    };
    let (low, high) = (low.add_scalar(-width), high.add_scalar(width));
    // Those that are no number are outside.
    let is_near = |i: usize| radii[i] >= 0.0 && (0..3).all(|k| centres[i][k] >= low[k] && centres[i][k] <= high[k]);
    let near: Vec<u32> = (0..centres.len()).filter(|&i| is_near(i)).map(|i| i as u32).collect();
    let spheres = NearSpheres { centres, radii, skin, is_wanted };
    let mean = near.iter().map(|&i| radii[i as usize]).sum::<f64>() / near.len() as f64;
    if widest + 0.5 * skin > UNEVEN * (mean + 0.5 * skin) {
        return spheres.pairs_by_tree(&near);
    }
    spheres.pairs_by_grid(&near, width)
}

/// Spheres of which pairs are looked for.
struct NearSpheres<'a> {
    centres: &'a [Vec3],
    radii: &'a [f64],
    skin: f64,
    is_wanted: &'a (dyn Fn(usize) -> bool + Sync),
}

impl NearSpheres<'_> {
    /// A wanted sphere with another one, if they are near; each pair is found from one side.
    #[inline]
    fn pair(&self, i: u32, j: u32) -> Option<[u32; 2]> {
        let NearSpheres { centres, radii, skin, is_wanted } = self;
        let [a, b] = [i as usize, j as usize];
        let reach = radii[a] + radii[b] + skin;
        let is_near = (centres[b] - centres[a]).norm_squared() < reach * reach;
        (is_near && (i < j || (i > j && !is_wanted(b)))).then(|| [i.min(j), i.max(j)])
    }

    fn pairs_by_tree(&self, near: &[u32]) -> Vec<[u32; 2]> {
        let around = |&i: &u32| {
            let (x, half) = (self.centres[i as usize], self.radii[i as usize] + 0.5 * self.skin);
            Aabb::from_half_extents(Vector::new(x.x, x.y, x.z), Vector::new(half, half, half))
        };
        let boxes: Vec<Aabb> = near.iter().map(around).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let pairs_of = |(&i, own): (&u32, &Aabb)| {
            tree.intersect_aabb(own).filter_map(|j| self.pair(i, near[j as usize])).collect::<Vec<_>>()
        };
        let wanted = near.par_iter().zip(&boxes).filter(|(i, _)| (self.is_wanted)(**i as usize));
        sorted(wanted.flat_map_iter(pairs_of).collect())
    }

    fn pairs_by_grid(&self, near: &[u32], width: f64) -> Vec<[u32; 2]> {
        let cell_of = |p: &Vec3| p.map(|c| (c / width).floor() as i64);
        let in_cell = |&i: &u32| (cell_of(&self.centres[i as usize]).into(), i);
        let mut cells: Vec<([i64; 3], u32)> = near.par_iter().map(in_cell).collect();
        cells.par_sort_unstable();
        let pairs_of = |&(cell, i): &([i64; 3], u32)| {
            let mut found = Vec::new();
            for dx in -1..=1 {
                for dy in -1..=1 {
                    // The cells of one column lie side by side in the sorted list.
                    let first = [cell[0] + dx, cell[1] + dy, cell[2] - 1];
                    let last = [cell[0] + dx, cell[1] + dy, cell[2] + 1];
                    let start = cells.partition_point(|(c, _)| *c < first);
                    let column = cells[start..].iter().take_while(|(c, _)| *c <= last);
                    found.extend(column.filter_map(|&(_, j)| self.pair(i, j)));
                }
            }
            found
        };
        let wanted = cells.par_iter().filter(|(_, i)| (self.is_wanted)(*i as usize));
        sorted(wanted.flat_map_iter(pairs_of).collect())
    }
}

fn sorted(mut pairs: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
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
            prop_assert_eq!(&close_pairs(&centres, &radii, skin), &expected);
            let is_wanted = |i: usize| i % 3 == 1 && centres[i].x < 1.0;
            expected.retain(|pair| pair.iter().any(|&i| is_wanted(i as usize)));
            prop_assert_eq!(close_pairs_of(&centres, &radii, skin, &is_wanted), expected);
        }
    }
}
