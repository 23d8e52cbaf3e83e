//! Numbers from the history of a probe: means, slopes, values in between.

/// Where the largest value is, the first of equals; none where no value is a number.
pub(crate) fn index_of_max(values: &[f64]) -> Option<usize> {
    (0..values.len()).filter(|&i| !values[i].is_nan()).reduce(|best, i| if values[i] > values[best] { i } else { best })
}

/// Mean over time by trapezoids.
pub(crate) fn time_mean(times: &[f64], values: &[f64]) -> f64 {
    let span = times.last().unwrap_or(&0.0) - times.first().unwrap_or(&0.0);
    if span <= 0.0 {
        return values.last().copied().unwrap_or(f64::NAN);
    }
    let trapezoid = |i: usize| 0.5 * (values[i] + values[i + 1]) * (times[i + 1] - times[i]);
    (0..values.len().saturating_sub(1)).map(trapezoid).sum::<f64>() / span
}

/// Least squares slope through the rows in which the value is another than in the row before, so that waiting before the
/// first change and after the last does not count; not a number where there are fewer than two such rows.
pub(crate) fn speed(times: &[f64], values: &[f64]) -> f64 {
    let changed = |&i: &usize| values[i].is_finite() && (i == 0 || values[i] != values[i - 1]);
    let rows: Vec<usize> = (0..values.len()).filter(changed).collect();
    slope(times, values, &rows)
}

/// Least squares slope over the rows that are at most `window` older than the last one; not a number before the values
/// have been finite for so long.
pub(crate) fn slope_of_window(times: &[f64], values: &[f64], window: f64) -> f64 {
    let Some(last) = times.last() else { return f64::NAN };
    let first = times.partition_point(|&time| time < last - window * (1.0 + 1e-12));
    let full = first > 0 || times.first().is_some_and(|start| last - start >= window * (1.0 - 1e-12));
    let rows: Vec<usize> = (first..values.len()).collect();
    if full && rows.iter().all(|&row| values[row].is_finite()) { slope(times, values, &rows) } else { f64::NAN }
}

/// Least squares slope over some rows; not a number where there are fewer than two.
fn slope(times: &[f64], values: &[f64], rows: &[usize]) -> f64 {
    let mean = |of: &[f64]| rows.iter().map(|&i| of[i]).sum::<f64>() / rows.len() as f64;
    let (t, x) = (mean(times), mean(values));
    let (mut slope, mut weight) = (0.0, 0.0);
    for &i in rows {
        slope += (times[i] - t) * (values[i] - x);
        weight += (times[i] - t).powi(2);
    }
    slope / weight
}

/// Value at a time, by a straight line between rows: where the time is first passed, since it also goes back along a path of equilibrium. Not a
/// number where the run has not come so far.
pub(crate) fn interpolate(times: &[f64], values: &[f64], time: f64) -> f64 {
    match times.iter().position(|&t| t > time) {
        Some(0) => values[0],
        Some(next) => {
            let [before, after] = [next - 1, next];
            let share = (time - times[before]) / (times[after] - times[before]);
            values[before] + (values[after] - values[before]) * share
        }
        None => {
            let last = times.iter().position(|&t| t >= time * (1.0 - 1e-9));
            last.map_or(f64::NAN, |row| values[row])
        }
    }
}

/// Whether output number `index` of those every `interval` is due at `time`.
pub(crate) fn is_due(time: f64, index: u64, interval: f64) -> bool {
    time >= interval * index as f64 * (1.0 - 1e-12)
}

/// The first output after `time`.
pub(crate) fn next_index(time: f64, interval: f64) -> u64 {
    (time / interval * (1.0 + 1e-12)).floor() as u64 + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_is_found_behind_rows_without_one() {
        assert_eq!(index_of_max(&[f64::NAN, 1.0, 3.0, f64::NAN, 3.0]), Some(2));
        assert_eq!(index_of_max(&[f64::NAN, f64::NAN]), None);
    }

    #[test]
    fn a_value_at_a_time_is_that_of_its_first_passage_and_none_beyond_the_run() {
        let (times, values) = ([0.0, 1.0, 2.0, 1.5, 1.0], [0.0, 10.0, 30.0, 5.0, 1.0]);
        assert_eq!([0.5, 1.5, 2.0].map(|time| interpolate(&times, &values, time)), [5.0, 20.0, 30.0]);
        assert!(interpolate(&times, &values, 2.1).is_nan() && interpolate(&[], &[], 0.0).is_nan());
    }

    #[test]
    fn the_slope_of_a_window_smooths_the_leaps_of_a_tip() {
        let times: Vec<f64> = (0..40).map(|row| 1e-6 * f64::from(row)).collect();
        // 1,000 m/s in leaps of 4 mm every fourth row.
        let tip: Vec<f64> = (0..40).map(|row| if row < 8 { f64::NAN } else { 4e-3 * f64::from(row / 4) }).collect();
        for end in 30..40 {
            let speed = slope_of_window(&times[..end], &tip[..end], 16e-6);
            assert!((speed / 1000.0 - 1.0).abs() < 0.07, "{speed}");
        }
        assert!(slope_of_window(&times[..20], &tip[..20], 16e-6).is_nan(), "no tip for so long");
        assert!(slope_of_window(&times[..3], &times[..3], 16e-6).is_nan(), "no run for so long");
        assert_eq!(slope_of_window(&times[..3], &[0.0, 1.0, 2.0], 2e-6), 1e6);
    }

    #[test]
    fn speed_is_the_slope_of_the_steps_of_a_front() {
        let nan = f64::NAN;
        let times: Vec<f64> = (0..12).map(f64::from).collect();
        // Waits for three rows, goes on by 5 every second row, and has arrived in row 9.
        let front = [nan, nan, nan, 10.0, 10.0, 15.0, 15.0, 20.0, 20.0, 25.0, 25.0, 25.0];
        assert!((speed(&times, &front) - 2.5).abs() < 1e-12);
        assert!(speed(&times, &[nan; 12]).is_nan());
        let late = [nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, 3.0];
        assert!(speed(&times, &late).is_nan(), "one place is no way");
    }
}
