//! What is drawn over a picture in the page: a scale bar, and the axes.

use fractum_math::elementary::{hypot, log10, pow};
use fractum_output::number::quantity;

use crate::picture::Scale;

/// Longest scale bar over the width of the picture.
const LONGEST: f64 = 0.25;
/// Length of an axis across the view [pixels].
const AXIS: f64 = 46.0;
/// An axis shorter than this part of its length points at the eye, and is left out.
const SHORT: f64 = 0.2;

/// The scale bar below on the left and the axes below on the right, as an SVG element of the size of the picture.
pub(super) fn to_svg(scale: &Scale, [width, height]: [usize; 2]) -> String {
    let (w, h) = (width as f64, height as f64);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" aria-hidden=\"true\" \
         font-family=\"system-ui, sans-serif\" font-size=\"18\" fill=\"#222\" stroke=\"#222\" stroke-width=\"2\">"
    );
    let label = "stroke=\"#fff\" stroke-width=\"4\" paint-order=\"stroke\"";
    if let Some(length) = round_below(LONGEST * w / scale.pixels_per_metre) {
        let (y, end) = (h - 16.0, 16.0 + length * scale.pixels_per_metre);
        svg += &format!(
            "{}<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" {label}>{}</text>",
            line(&format!("M16 {:.1}v8M16 {y:.1}H{end:.1}M{end:.1} {:.1}v8", y - 4.0, y - 4.0)),
            0.5 * (16.0 + end),
            y - 9.0,
            quantity(length, "m")
        );
    }
    let (x, y) = (w - AXIS - 34.0, h - AXIS - 30.0);
    for (name, [right, down]) in ["x", "y", "z"].iter().zip(scale.axes) {
        if hypot(right, down) < SHORT {
            continue;
        }
        let (dx, dy) = (AXIS * right, AXIS * down);
        svg += &format!(
            "{}<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" {label}>{name}</text>",
            line(&format!("M{x:.1} {y:.1}l{dx:.1} {dy:.1}")),
            x + 1.3 * dx,
            y + 1.3 * dy + 6.0
        );
    }
    svg + "</svg>"
}

/// A dark line with a light border, to be seen on what is dark and on what is light.
fn line(path: &str) -> String {
    format!("<path d=\"{path}\" fill=\"none\" stroke=\"#fff\" stroke-width=\"5\"/><path d=\"{path}\" fill=\"none\"/>")
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a length; none of what has no size.
fn round_below(length: f64) -> Option<f64> {
    if !(length.is_finite() && length > 0.0) {
        return None;
    }
    let power = pow(10.0, log10(length).floor());
    [5.0, 2.0, 1.0].map(|factor| factor * power).into_iter().find(|round| *round <= length * 1.000_001)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_is_round_and_as_long_as_it_says() {
        let scale = Scale { pixels_per_metre: 4000.0, axes: [[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]] };
        let svg = to_svg(&scale, [900, 760]);
        // A quarter of the width is 56 mm.
        assert!(svg.contains(">50 mm</text>") && svg.contains("H216.0"), "{svg}");
        assert!(svg.contains(">x</text>") && svg.contains(">y</text>") && !svg.contains(">z</text>"), "{svg}");
    }

    #[test]
    fn no_size_makes_no_bar() {
        assert_eq!((round_below(0.0), round_below(f64::NAN), round_below(f64::INFINITY)), (None, None, None));
        assert!(
            [0.7, 3.0, 21.0]
                .map(round_below)
                .iter()
                .zip([0.5, 2.0, 20.0])
                .all(|(found, round)| (found.unwrap() - round).abs() < 1e-12)
        );
    }
}
