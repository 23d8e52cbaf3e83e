//! Points in the plane, found by where they are.

use std::collections::BTreeMap;

/// Points by squares.
pub(crate) struct Squares {
    side: f64,
    squares: BTreeMap<[i64; 2], Vec<[f64; 2]>>,
}

impl Squares {
    pub(crate) fn new(points: &[[f64; 2]], side: f64) -> Self {
        let mut grid = Squares { side, squares: BTreeMap::new() };
        points.iter().for_each(|&at| grid.add(at));
        grid
    }

    pub(crate) fn add(&mut self, at: [f64; 2]) {
        self.squares.entry(at.map(|x| (x / self.side).floor() as i64)).or_default().push(at);
    }

    pub(crate) fn has_within(&self, at: [f64; 2], distance: f64) -> bool {
        let [low, high] = [-distance, distance].map(|by| at.map(|x| ((x + by) / self.side).floor() as i64));
        (low[1]..=high[1]).any(|row| {
            (low[0]..=high[0]).any(|column| {
                self.squares.get(&[column, row]).is_some_and(|points| {
                    let near = |p: &[f64; 2]| (p[0] - at[0]).powi(2) + (p[1] - at[1]).powi(2) < distance * distance;
                    points.iter().any(near)
                })
            })
        })
    }
}
