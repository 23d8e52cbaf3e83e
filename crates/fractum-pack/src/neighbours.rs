use fractum_math::Vec3;
use rayon::prelude::*;

use crate::period::Period;

/// Number of particles handled as one block by every parallel loop of the cooker.
pub(crate) const BLOCK: usize = 1024;

/// A cell grid over points: counting sort, so that the points of a cell are one slice in ascending order.
pub(crate) struct Grid {
    lower: Vec3,
    inverse: f64,
    size: [usize; 3],
    start: Vec<u32>,
    points: Vec<u32>,
}

impl Grid {
    /// Sorts points into cells at least `cell` wide.
    pub(crate) fn new(position: &[Vec3], cell: f64) -> Self {
        let first = position.first().copied().unwrap_or_default();
        let (lower, upper) = position.iter().fold((first, first), |(l, u), p| (l.inf(p), u.sup(p)));
        // No more cells than points: sparse sets get wider cells.
        let extent = upper - lower;
        let mut cell = cell;
        let count = |cell: f64| -> f64 { (0..3).map(|a| (extent[a] / cell).floor() + 1.0).product() };
        while count(cell) > 2.0 * position.len() as f64 + 64.0 {
            cell *= 1.26;
        }
        let size = [0, 1, 2].map(|a| (extent[a] / cell) as usize + 1);
        let mut grid = Grid {
            lower,
            inverse: 1.0 / cell,
            size,
            start: vec![0; size.iter().product::<usize>() + 1],
            points: vec![0; position.len()],
        };
        let cells: Vec<u32> = position.iter().map(|p| grid.cell(p) as u32).collect();
        for &c in &cells {
            grid.start[c as usize + 1] += 1;
        }
        for c in 1..grid.start.len() {
            grid.start[c] += grid.start[c - 1];
        }
        let mut next = grid.start.clone();
        for (i, &c) in cells.iter().enumerate() {
            grid.points[next[c as usize] as usize] = i as u32;
            next[c as usize] += 1;
        }
        grid
    }

    fn coordinates(&self, p: &Vec3) -> [usize; 3] {
        [0, 1, 2].map(|a| (((p[a] - self.lower[a]) * self.inverse).max(0.0) as usize).min(self.size[a] - 1))
    }

    fn cell(&self, p: &Vec3) -> usize {
        let [x, y, z] = self.coordinates(p);
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// Visits the points of the cells within `reach` of `p` (at most one cell away when `reach` is below the cell width).
    #[inline]
    pub(crate) fn around(&self, p: &Vec3, reach: f64, mut visit: impl FnMut(u32)) {
        let low = self.coordinates(&p.add_scalar(-reach));
        let high = self.coordinates(&p.add_scalar(reach));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let row = (z * self.size[1] + y) * self.size[0];
                for &i in &self.points[self.start[row + low[0]] as usize..self.start[row + high[0] + 1] as usize] {
                    visit(i);
                }
            }
        }
    }
}

/// For each particle, all others whose surfaces come within a gap, in ascending order: offsets and flat values.
#[derive(Default)]
pub(crate) struct Neighbours {
    offsets: Vec<u32>,
    values: Vec<u32>,
}

impl Neighbours {
    /// Pairs with |x_i − x_j| < factor (r_i + r_j) + gap, each listed on both sides; of the nearest images where space repeats.
    pub(crate) fn find(position: &[Vec3], radius: &[f64], factor: f64, gap: f64, period: Option<Period>) -> Self {
        let inside: Option<Vec<Vec3>> = period.map(|period| position.iter().map(|x| period.within(x)).collect());
        let position = inside.as_deref().unwrap_or(position);
        let octaves = octaves(position, radius, |largest| factor * 2.0 * largest + gap);
        let blocks: Vec<(Vec<u32>, Vec<u32>)> = (0..position.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let mut lengths = Vec::with_capacity(BLOCK);
                let mut values = Vec::with_capacity(16 * BLOCK);
                for i in block * BLOCK..((block + 1) * BLOCK).min(position.len()) {
                    let before = values.len();
                    let (x, r) = (position[i], radius[i]);
                    for Octave { largest, members, grid } in &octaves {
                        let reach = factor * (r + largest) + gap;
                        let mut look = |x: &Vec3| {
                            grid.around(x, reach, |member| {
                                let j = members[member as usize];
                                let touch = factor * (r + radius[j as usize]) + gap;
                                if j as usize != i && (position[j as usize] - x).norm_squared() < touch * touch {
                                    values.push(j);
                                }
                            });
                        };
                        match period {
                            None => look(&x),
                            Some(period) => period.images(x, reach).for_each(|image| look(&image)),
                        }
                    }
                    values[before..].sort_unstable();
                    lengths.push((values.len() - before) as u32);
                }
                (lengths, values)
            })
            .collect();
        let mut offsets = Vec::with_capacity(position.len() + 1);
        offsets.push(0u32);
        let mut values = Vec::new();
        for (lengths, chunk) in blocks {
            for length in lengths {
                offsets.push(offsets[offsets.len() - 1] + length);
            }
            values.extend_from_slice(&chunk);
        }
        Neighbours { offsets, values }
    }

    #[inline]
    pub(crate) fn of(&self, i: usize) -> &[u32] {
        &self.values[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }
}

/// Spheres of which none is more than twice as large as another: fines are not looked for in cells as wide as the largest.
struct Octave {
    /// Largest radius [m].
    largest: f64,
    /// Which of all spheres they are, ascending.
    members: Vec<u32>,
    grid: Grid,
}

/// Spheres by octaves of their sizes, the largest first.
///
/// - `cell`: width of the cells of an octave, by its largest radius [m]
fn octaves(position: &[Vec3], radius: &[f64], cell: impl Fn(f64) -> f64) -> Vec<Octave> {
    let mut left: Vec<u32> = (0..position.len() as u32).collect();
    let mut all = Vec::new();
    while !left.is_empty() {
        let largest = left.iter().map(|&i| radius[i as usize]).fold(0.0, f64::max);
        let (members, smaller) = left.into_iter().partition::<Vec<u32>, _>(|&i| 2.0 * radius[i as usize] >= largest);
        let places: Vec<Vec3> = members.iter().map(|&i| position[i as usize]).collect();
        all.push(Octave { largest, grid: Grid::new(&places, cell(largest)), members });
        left = smaller;
    }
    all
}

/// An order of points that follows a Morton curve, so that neighbours in space are neighbours in memory.
pub(crate) fn spatial_order(position: &[Vec3]) -> Vec<u32> {
    let first = position.first().copied().unwrap_or_default();
    let (lower, upper) = position.iter().fold((first, first), |(l, u), p| (l.inf(p), u.sup(p)));
    let scale = 1023.0 / (upper - lower).max().max(f64::MIN_POSITIVE);
    let spread = |v: u64| (0..10).fold(0u64, |key, bit| key | ((v >> bit & 1) << (3 * bit)));
    let key = |p: &Vec3| (0..3).fold(0u64, |key, a| key | spread(((p[a] - lower[a]) * scale) as u64) << a);
    let keys: Vec<u64> = position.iter().map(key).collect();
    let mut order: Vec<u32> = (0..position.len() as u32).collect();
    order.sort_by_key(|&i| (keys[i as usize], i));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_grid_finds_exactly_the_pairs_of_a_full_search(
            points in prop::collection::vec(prop::array::uniform3(-2.0f64..3.0), 1..120), gap in 0.0f64..0.4,
        ) {
            let position: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let radius: Vec<f64> = (0..position.len()).map(|i| 0.02 * 1.5f64.powi((i % 7) as i32)).collect();
            let found = Neighbours::find(&position, &radius, 1.1, gap, None);
            for i in 0..position.len() {
                let all: Vec<u32> = (0..position.len())
                    .filter(|&j| j != i && (position[i] - position[j]).norm() < 1.1 * (radius[i] + radius[j]) + gap)
                    .map(|j| j as u32)
                    .collect();
                prop_assert_eq!(found.of(i), &all[..]);
            }
        }

        #[test]
        fn images_are_neighbours_as_spheres_in_the_middle_are(
            points in prop::collection::vec(prop::array::uniform3(-2.0f64..3.0), 1..120), gap in 0.0f64..0.4,
        ) {
            let position: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let radius: Vec<f64> = (0..position.len()).map(|i| 0.1 + 0.02 * (i % 7) as f64).collect();
            let (lower, size) = (Vec3::new(0.3, -1.0, 0.0), Vec3::new(2.5, 2.0, 3.0));
            let period = Period::new(lower, lower + size);
            let found = Neighbours::find(&position, &radius, 1.1, gap, Some(period));
            for i in 0..position.len() {
                let near = |j: usize| {
                    let mut apart = position[i] - position[j];
                    (0..3).for_each(|axis| apart[axis] -= size[axis] * (apart[axis] / size[axis]).round());
                    apart.norm() < 1.1 * (radius[i] + radius[j]) + gap
                };
                let all: Vec<u32> = (0..position.len()).filter(|&j| j != i && near(j)).map(|j| j as u32).collect();
                prop_assert_eq!(found.of(i), &all[..]);
            }
        }
    }
}
