//! Spheres of given sizes at random places that do not touch: random sequential insertion, the largest first.

use std::collections::BTreeMap;

use fractum_math::Vec3;

use crate::random::Random;

/// Places that are tried for a sphere before there is no room for it.
const TRIES: usize = 20_000;

/// Puts spheres into a region so that no two touch; stops at the first without room. Centres lie in the plane of a region without extent along an axis.
///
/// - `lower`, `upper` [m]: box around the region; `depth`: distance of a point from its wall [m], positive inside
/// - `radii` [m]: largest first
/// - returns the centres of as many as have room [m]
pub fn insert(lower: &Vec3, upper: &Vec3, depth: impl Fn(&Vec3) -> f64, radii: &[f64], seed: u64) -> Vec<Vec3> {
    let mut random = Random::new(seed);
    let mut layers = Layers::default();
    let mut centres = Vec::with_capacity(radii.len());
    for &radius in radii {
        let Some((inset, room)) = room_for(lower, upper, radius) else { break };
        let mut place = || lower + Vec3::from_fn(|axis, _| inset[axis] + room[axis] * random.uniform());
        let found =
            (0..TRIES).map(|_| place()).find(|x| depth(x) >= radius && layers.is_free(x, radius, &centres, radii));
        let Some(found) = found else { break };
        layers.add(&found, radius, centres.len());
        centres.push(found);
    }
    centres
}

/// How far within its lower corner a box has room for the centre of a ball, and how much [m]; none where it has none.
pub(crate) fn room_for(lower: &Vec3, upper: &Vec3, radius: f64) -> Option<(Vec3, Vec3)> {
    let inset = lower.zip_map(upper, |from, to| if from == to { 0.0 } else { radius });
    let room = upper - lower - inset * 2.0;
    (room.min() >= 0.0).then_some((inset, room))
}

/// Spheres by cells, one grid for each octave of sizes.
#[derive(Default)]
struct Layers {
    grids: Vec<Grid>,
}

struct Grid {
    /// Width of a cell: the diameter of the largest sphere here [m].
    cell: f64,
    cells: BTreeMap<[i64; 3], Vec<u32>>,
}

impl Layers {
    fn add(&mut self, place: &Vec3, radius: f64, index: usize) {
        if self.grids.last().is_none_or(|grid| 2.0 * radius < 0.5 * grid.cell) {
            self.grids.push(Grid { cell: 2.0 * radius, cells: BTreeMap::new() });
        }
        if let Some(grid) = self.grids.last_mut() {
            let key = [place.x, place.y, place.z].map(|x| (x / grid.cell).floor() as i64);
            grid.cells.entry(key).or_default().push(index as u32);
        }
    }

    fn is_free(&self, place: &Vec3, radius: f64, centres: &[Vec3], radii: &[f64]) -> bool {
        self.grids.iter().all(|grid| {
            let reach = radius + 0.5 * grid.cell;
            let range = |x: f64| ((x - reach) / grid.cell).floor() as i64..=((x + reach) / grid.cell).floor() as i64;
            range(place.x).all(|i| {
                range(place.y).all(|j| {
                    range(place.z).all(|k| {
                        grid.cells.get(&[i, j, k]).into_iter().flatten().all(|&other| {
                            let other = other as usize;
                            (place - centres[other]).norm() > radius + radii[other]
                        })
                    })
                })
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_touch_and_all_are_inside() {
        let (lower, upper) = (Vec3::zeros(), Vec3::new(1.0, 0.6, 0.8));
        let depth = |x: &Vec3| x.min().min((upper - x).min());
        let radii: Vec<f64> = (0..400).map(|k| 0.05 / (1.0 + f64::from(k) / 40.0)).collect();
        let centres = insert(&lower, &upper, depth, &radii, 3);
        assert_eq!(centres.len(), radii.len());
        for i in 0..centres.len() {
            assert!(depth(&centres[i]) >= radii[i]);
            for j in 0..i {
                assert!((centres[i] - centres[j]).norm() > radii[i] + radii[j], "{i} {j}");
            }
        }
        assert_eq!(insert(&lower, &upper, depth, &radii[..9], 3), centres[..9]);
        // Random sequential insertion of spheres of one size ends at 0.38 of the volume.
        let many = insert(&lower, &upper, depth, &[0.05; 2000], 1).len() as f64;
        let share = many * fractum_math::sphere_volume(0.05) / (0.9 * 0.5 * 0.7);
        assert!(share > 0.3 && share < 0.55, "{share}");
        // In a plane discs of one size end at 0.547 of the area.
        let upper = Vec3::new(1.0, 1.0, 0.0);
        let depth = |x: &Vec3| x.xy().min().min((upper - x).xy().min());
        let discs = insert(&Vec3::zeros(), &upper, depth, &[0.02; 900], 1);
        let share = discs.len() as f64 * std::f64::consts::PI * 4e-4 / (0.96 * 0.96);
        assert!(discs.iter().all(|x| x.z == 0.0) && share > 0.48 && share < 0.57, "{share}");
    }
}
