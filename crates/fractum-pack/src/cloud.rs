use fractum_math::Vec3;

use crate::random::Random;

/// Distance of the cells of a cloud over the largest diameter.
const SPACING: f64 = 1.1;

/// Spheres of uniformly scattered radii, loosely in a region: one in each cell of a cubic grid, anywhere in it, so that
/// no two touch. Layers go up along z.
///
/// - `lower`, `upper` [m]: box around the region; `depth`: distance of a point from its wall [m], positive inside
/// - `radius` [m]: mean radius; `dispersion`: (largest - smallest)/mean, 0 to 1
/// - `most`: at most so many; the lowest are kept
/// - returns centres [m] and radii [m]
pub fn cloud(
    lower: &Vec3,
    upper: &Vec3,
    depth: impl Fn(&Vec3) -> f64,
    radius: f64,
    dispersion: f64,
    most: usize,
    seed: u64,
) -> (Vec<Vec3>, Vec<f64>) {
    let mut random = Random::new(seed);
    let largest = radius * (1.0 + 0.5 * dispersion);
    let size = upper - lower;
    let cells = cloud_cells(&size, radius, dispersion);
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    if cells.min() < 1.0 {
        return (centres, radii);
    }
    let cell = size.component_div(&cells);
    let [nx, ny, nz] = [cells.x as u64, cells.y as u64, cells.z as u64];
    for index in 0..nx.saturating_mul(ny).saturating_mul(nz) {
        if centres.len() == most {
            break;
        }
        let place = Vec3::new((index % nx) as f64, (index / nx % ny) as f64, (index / nx / ny) as f64);
        let own = random.between(radius * (1.0 - 0.5 * dispersion), largest);
        let room = cell.map(|c| c - 2.0 * own);
        let shift = Vec3::from_fn(|axis, _| own + room[axis].max(0.0) * random.uniform());
        let centre = lower + place.component_mul(&cell) + shift;
        if depth(&centre) >= own {
            centres.push(centre);
            radii.push(own);
        }
    }
    (centres, radii)
}

/// Cells of a cloud along x, y, z, of which each has room for one sphere. They fill the box exactly, none smaller than
/// wanted.
///
/// - `size`, `radius` [m]; `dispersion`: as in [`cloud`]
pub fn cloud_cells(size: &Vec3, radius: f64, dispersion: f64) -> Vec3 {
    let diameter = 2.0 * radius * (1.0 + 0.5 * dispersion);
    size.map(|s| (s / (diameter * SPACING)).floor().max(if s >= diameter { 1.0 } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_touch_and_all_are_inside() {
        let (lower, upper) = (Vec3::zeros(), Vec3::new(1.0, 0.6, 0.8));
        let depth = |x: &Vec3| x.min().min((upper - x).min());
        let (centres, radii) = cloud(&lower, &upper, depth, 0.05, 0.4, 1000, 3);
        assert!(centres.len() > 100, "{}", centres.len());
        for i in 0..centres.len() {
            assert!(depth(&centres[i]) >= radii[i]);
            for j in 0..i {
                assert!((centres[i] - centres[j]).norm() >= radii[i] + radii[j]);
            }
        }
        let some = cloud(&lower, &upper, depth, 0.05, 0.4, 7, 3);
        assert_eq!(some.0[..], centres[..7]);
        assert!(cloud(&lower, &upper, depth, 0.5, 0.0, 9, 1).0.is_empty());
    }
}
