//! Spheres sorted into cells one by one, as they come and move.

use fractum_math::Vec3;

/// No sphere.
const NONE: u32 = u32::MAX;
/// Level of a sphere that is not in the grid.
const ABSENT: u8 = u8::MAX;
/// Levels of cells, each twice as wide as the one before.
const LEVELS: usize = 48;

/// Spheres in cells of their size, for neighbours of a few spheres at a time: to put one in, to move it and to look around it costs as
/// much as there are spheres around it, whatever their number is.
///
/// Spheres are numbered by the caller. Cells are kept in a table by a hash of their place, so that space has no borders. The widths
/// of cells double from level to level, and a sphere lies on the first level whose cells are as wide as it is: radii may differ by any
/// ratio.
#[derive(Clone, Debug, Default)]
pub struct SphereGrid {
    /// Width of the finest cells [m].
    finest: f64,
    /// All spheres lie in the plane z = 0.
    planar: bool,
    /// First sphere of each entry of the table.
    heads: Vec<u32>,
    /// Next and previous sphere of the same entry, by sphere.
    next: Vec<u32>,
    previous: Vec<u32>,
    /// Hash of the cell of each sphere; its entry is that modulo the size of the table.
    hash: Vec<u32>,
    /// Level of each sphere, or [`ABSENT`].
    level: Vec<u8>,
    /// Spheres on each level.
    on_level: Vec<u32>,
    count: usize,
}

impl SphereGrid {
    /// A grid without spheres.
    ///
    /// - `spheres`: largest number that a sphere may have, and one more
    /// - `smallest` [m] > 0: smallest radius that a sphere may have; `planar`: all lie in the plane z = 0
    pub fn new(spheres: usize, smallest: f64, planar: bool) -> Self {
        SphereGrid {
            finest: 2.0 * smallest,
            planar,
            heads: vec![NONE; 64],
            next: vec![NONE; spheres],
            previous: vec![NONE; spheres],
            hash: vec![0; spheres],
            level: vec![ABSENT; spheres],
            on_level: vec![0; LEVELS],
            count: 0,
        }
    }

    /// Puts a sphere in, or to another place.
    pub fn put(&mut self, sphere: u32, centre: &Vec3, radius: f64) {
        self.take(sphere);
        if self.count == self.heads.len() {
            self.widen();
        }
        let level = self.level_of(radius);
        self.hash[sphere as usize] = hash(cell_of(centre, self.width(level)), level);
        self.level[sphere as usize] = level as u8;
        self.on_level[level] += 1;
        self.count += 1;
        self.link(sphere);
    }

    /// Takes a sphere out, if it is there.
    pub fn take(&mut self, sphere: u32) {
        let i = sphere as usize;
        if self.level[i] == ABSENT {
            return;
        }
        let (next, previous) = (self.next[i], self.previous[i]);
        match previous {
            NONE => {
                let entry = self.entry(self.hash[i]);
                self.heads[entry] = next;
            }
            other => self.next[other as usize] = next,
        }
        if next != NONE {
            self.previous[next as usize] = previous;
        }
        self.on_level[self.level[i] as usize] -= 1;
        self.level[i] = ABSENT;
        self.count -= 1;
    }

    /// Visits every sphere that may touch a sphere of this place and radius, itself included; some are visited that do not, and some
    /// twice.
    pub fn around(&self, centre: &Vec3, radius: f64, mut visit: impl FnMut(u32)) {
        for level in 0..LEVELS {
            if self.on_level[level] == 0 {
                continue;
            }
            let width = self.width(level);
            let reach = radius + 0.5 * width;
            let reach = Vec3::new(reach, reach, if self.planar { 0.0 } else { reach });
            let (low, mut high) = (cell_of(&(centre - reach), width), cell_of(&(centre + reach), width));
            if self.planar {
                high[2] = low[2];
            }
            let cells = (0..3).map(|axis| high[axis] as f64 - low[axis] as f64 + 1.0).product::<f64>();
            if cells > 27.0 && cells > f64::from(self.on_level[level]) {
                let there = (0..).zip(&self.level).filter(|(_, own)| **own as usize == level);
                there.for_each(|(sphere, _)| visit(sphere));
                continue;
            }
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        let mut sphere = self.heads[self.entry(hash([x, y, z], level))];
                        while sphere != NONE {
                            visit(sphere);
                            sphere = self.next[sphere as usize];
                        }
                    }
                }
            }
        }
    }

    fn width(&self, level: usize) -> f64 {
        self.finest * (1u64 << level) as f64
    }

    fn level_of(&self, radius: f64) -> usize {
        (0..LEVELS - 1).find(|&level| self.width(level) >= 2.0 * radius).unwrap_or(LEVELS - 1)
    }

    fn entry(&self, hash: u32) -> usize {
        hash as usize & (self.heads.len() - 1)
    }

    fn link(&mut self, sphere: u32) {
        let i = sphere as usize;
        let entry = self.entry(self.hash[i]);
        let first = std::mem::replace(&mut self.heads[entry], sphere);
        if first != NONE {
            self.previous[first as usize] = sphere;
        }
        (self.next[i], self.previous[i]) = (first, NONE);
    }

    fn widen(&mut self) {
        let size = 2 * self.heads.len();
        self.heads.clear();
        self.heads.resize(size, NONE);
        for sphere in 0..self.level.len() {
            if self.level[sphere] != ABSENT {
                self.link(sphere as u32);
            }
        }
    }
}

fn hash(cell: [i64; 3], level: usize) -> u32 {
    let mut hash = level as u64;
    for c in cell {
        hash = (hash ^ c as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash ^= hash >> 32;
    }
    hash as u32
}

fn cell_of(place: &Vec3, width: f64) -> [i64; 3] {
    place.map(|c| (c / width).floor() as i64).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whatever_touches_is_visited_after_any_moves(
            spheres in prop::collection::vec((prop::array::uniform3(-3f64..3.0), 0.01f64..0.8), 1..200),
            moves in prop::collection::vec((0usize..200, prop::array::uniform3(-90f64..90.0)), 0..60),
            power in 1i32..4,
            planar in prop::bool::ANY,
        ) {
            let radius: Vec<f64> = spheres.iter().map(|s| s.1.powi(power)).collect();
            let flat = |p: [f64; 3]| Vec3::new(p[0], p[1], if planar { 0.0 } else { p[2] });
            let mut centre: Vec<Vec3> = spheres.iter().map(|s| flat(s.0)).collect();
            let mut grid = SphereGrid::new(radius.len(), 0.01f64.powi(power), planar);
            (0..radius.len()).for_each(|i| grid.put(i as u32, &centre[i], radius[i]));
            for (which, to) in moves {
                let i = which % radius.len();
                centre[i] = flat(to) * 0.1;
                grid.put(i as u32, &centre[i], radius[i]);
            }
            grid.take(0);
            for i in 0..radius.len() {
                let mut met = vec![false; radius.len()];
                grid.around(&centre[i], radius[i], |j| met[j as usize] = true);
                for j in 0..radius.len() {
                    let touches = (centre[i] - centre[j]).norm() < radius[i] + radius[j];
                    prop_assert!(met[j] || !touches || j == 0, "{} and {}", i, j);
                }
                prop_assert!(!met[0]);
            }
        }
    }
}
