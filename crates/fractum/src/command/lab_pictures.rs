//! Pictures of a test that breaks: its load curve, and the sample cut open.

use std::path::Path;

use fractum::Failure;
use fractum_calibrate::{Sample, lab};
use fractum_output::atomic;
use fractum_report::picture::{ColourMap, Paint, Picture, Spheres, View};
use fractum_report::plot::{Axis, Chart, Mark, Series, Style};

/// Nominal stress against nominal strain.
pub(super) fn load(path: &Path, broken: &lab::Broken) -> Result<(), Failure> {
    let (outcome, stress) = (&broken.outcome, broken.stress_per_load);
    let axis = |label: &str, unit: &str| Axis::new(label, unit);
    let chart = Chart {
        title: "Nominal stress against nominal strain".into(),
        x: axis("nominal strain", "-"),
        y: axis("nominal stress", "Pa"),
        series: vec![Series::new(
            "load",
            outcome.curve.iter().map(|p| p.displacement * broken.strain_per_displacement).collect(),
            outcome.curve.iter().map(|p| p.load * stress).collect(),
            Style::Line,
        )],
        levels: Vec::new(),
        marks: vec![Mark {
            label: "peak".into(),
            x: outcome.peak.displacement * broken.strain_per_displacement,
            y: broken.strength,
        }],
    };
    Ok(atomic::write(path, chart.to_svg().as_bytes())?)
}

/// The sample cut open along its middle plane, coloured by the bonds that particles lost.
pub(super) fn section(path: &Path, sample: &Sample, points: &[[f64; 3]], lost: &[f64]) -> Result<(), Failure> {
    let (lower, upper) = sample.packing.domain.bounds();
    let size = upper - lower;
    // Look along the shortest side; x is the axis of cylinders, y the loaded direction.
    let (direction, up) = if size.x < size.y.min(size.z) {
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    } else {
        ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0])
    };
    let half = |x: &[f64; 3]| {
        let middle = (lower + upper) * 0.5;
        (x[0] - middle.x) * direction[0] + (x[2] - middle.z) * direction[2] >= 0.0 || size.x > 3.0 * size.y
    };
    let kept: Vec<usize> = (0..points.len()).filter(|&i| half(&points[i])).collect();
    let centres: Vec<[f64; 3]> = kept.iter().map(|&i| points[i]).collect();
    let radii: Vec<f64> = kept.iter().map(|&i| sample.packing.radius[i]).collect();
    let values: Vec<f64> = kept.iter().map(|&i| lost[i]).collect();
    let spheres = Spheres { centres: &centres, radii: &radii, paint: Paint::Nodes(&values) };
    let picture = Picture { spheres: &[spheres], map: ColourMap::Damage, range: (0.0, 5.0), ..Picture::default() };
    let view = View { direction, up, ..View::default() };
    let png = picture.render(&view).and_then(|image| image.to_png());
    Ok(atomic::write(path, &png.map_err(|error| Failure::input(error.to_string()))?)?)
}
