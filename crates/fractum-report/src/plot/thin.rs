//! Fewer points for the same picture.

use super::Series;

/// Stretches of a series of which the extremes are kept.
const STRETCHES: usize = 700;

/// The points of `series`, or of a long one those that can be seen: of each stretch the first, the last and the
/// extremes in both directions. Gaps stay gaps.
pub(super) fn thinned(series: &Series) -> Vec<[f64; 2]> {
    let points: Vec<[f64; 2]> = series.x.iter().zip(&series.y).map(|(&x, &y)| [x, y]).collect();
    if points.len() <= 4 * STRETCHES {
        return points;
    }
    let mut kept = Vec::with_capacity(7 * STRETCHES);
    for stretch in points.chunks(points.len().div_ceil(STRETCHES)) {
        let mut indices = vec![0, stretch.len() - 1];
        for axis in 0..2 {
            let finite = || (0..stretch.len()).filter(|&index| stretch[index].iter().all(|value| value.is_finite()));
            indices.extend(finite().min_by(|&a, &b| stretch[a][axis].total_cmp(&stretch[b][axis])));
            indices.extend(finite().max_by(|&a, &b| stretch[a][axis].total_cmp(&stretch[b][axis])));
        }
        indices.extend((0..stretch.len()).find(|&index| stretch[index].iter().any(|value| !value.is_finite())));
        indices.sort_unstable();
        indices.dedup();
        kept.extend(indices.into_iter().map(|index| stretch[index]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::Style;
    use super::*;

    #[test]
    fn a_short_series_is_kept_and_a_long_one_keeps_its_peak_and_its_gap() {
        let series = |count: usize| {
            let x: Vec<f64> = (0..count).map(|i| i as f64).collect();
            let mut y = vec![0.0; count];
            y[count / 3] = 7.0;
            y[count / 2] = f64::NAN;
            Series::new("a", x, y, Style::Line)
        };
        assert_eq!(thinned(&series(500)).len(), 500);
        let points = thinned(&series(1_000_000));
        assert!(points.len() < 6000);
        assert!(points.contains(&[333_333.0, 7.0]));
        assert!(points.iter().any(|point| point[0] == 500_000.0 && point[1].is_nan()));
        assert_eq!((points[0][0], points[points.len() - 1][0]), (0.0, 999_999.0));
        assert!(points.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    }
}
