//! Where the mesh of a pass is fine.

use std::collections::HashMap;

use fractum_math::Vec3;

use crate::simulation::Damaged;

/// How far around damaged elements the next mesh is fine, in their sizes.
const AROUND: f64 = 3.0;

/// Places near damaged elements.
pub(super) struct Zone {
    /// Balls by the cell of a grid in which their middle is.
    cells: HashMap<[i64; 3], Vec<[f64; 4]>>,
    /// Size of a cell, the largest radius [m].
    cell: f64,
}

impl Zone {
    /// Around the damaged elements of some runs.
    pub(super) fn around<'a>(runs: impl Iterator<Item = &'a Damaged>) -> Self {
        let balls: Vec<[f64; 4]> =
            runs.flat_map(|run| &run.elements).map(|&[x, y, z, size, _]| [x, y, z, AROUND * size]).collect();
        let cell = balls.iter().map(|ball| ball[3]).fold(f64::MIN_POSITIVE, f64::max);
        let mut zone = Zone { cells: HashMap::new(), cell };
        for ball in balls {
            zone.cells.entry(zone.cell_of(Vec3::new(ball[0], ball[1], ball[2]))).or_default().push(ball);
        }
        zone
    }

    fn cell_of(&self, at: Vec3) -> [i64; 3] {
        [at.x, at.y, at.z].map(|x| (x / self.cell).floor() as i64)
    }

    pub(super) fn contains(&self, at: Vec3) -> bool {
        let middle = self.cell_of(at);
        (0..27).any(|index| {
            let cell = [middle[0] + index % 3 - 1, middle[1] + index / 3 % 3 - 1, middle[2] + index / 9 - 1];
            let near = |ball: &[f64; 4]| (Vec3::new(ball[0], ball[1], ball[2]) - at).norm() <= ball[3];
            self.cells.get(&cell).is_some_and(|balls| balls.iter().any(near))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zone_is_made_of_balls_of_three_sizes() {
        let run = Damaged { length: 1.0, elements: vec![[0.0, 0.0, 0.0, 0.1, 1.0], [1.0, 0.0, 0.0, 0.01, 1.0]] };
        let zone = Zone::around([&run].into_iter());
        let is_in = |x: f64, y: f64| zone.contains(Vec3::new(x, y, 0.0));
        assert!(is_in(0.29, 0.0) && is_in(-0.2, -0.2) && is_in(1.02, -0.02));
        assert!(!is_in(0.31, 0.0) && !is_in(0.25, 0.25) && !is_in(1.04, 0.0));
        assert!((run.size() - 0.055).abs() < 1e-15);
    }
}
