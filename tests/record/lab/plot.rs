//! The plot of `record convergence`: E and ν against the number of particles.

use fractum_math::elementary::ln;
use std::fmt::Write;

/// A series of the plot: number of particles, value, and its standard deviation.
pub(crate) struct Series {
    /// Name in the legend.
    pub(crate) name: String,
    /// Colour.
    pub(crate) colour: &'static str,
    /// Particles, value, scatter.
    pub(crate) points: Vec<[f64; 3]>,
}

/// One diagram under its title.
pub(crate) struct Diagram {
    /// Title with unit.
    pub(crate) title: &'static str,
    /// What it shows.
    pub(crate) series: Vec<Series>,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 260.0;
const LEFT: f64 = 70.0;
const MARGIN: f64 = 36.0;

/// Diagrams one above the other as SVG, with a logarithmic axis of particles and bars of one standard deviation.
pub(crate) fn svg(diagrams: &[Diagram]) -> String {
    let total = HEIGHT * diagrams.len() as f64;
    let mut text = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {total}" font-family="sans-serif" font-size="12">
<rect width="{WIDTH}" height="{total}" fill="white"/>
"#
    );
    for (k, diagram) in diagrams.iter().enumerate() {
        draw(&mut text, diagram, HEIGHT * k as f64);
    }
    text + "</svg>\n"
}

fn draw(text: &mut String, diagram: &Diagram, top: f64) {
    let all = || diagram.series.iter().flat_map(|s| &s.points);
    let range = |f: &dyn Fn(&[f64; 3]) -> [f64; 2]| {
        all().map(f).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], [a, b]| [l.min(a), h.max(b)])
    };
    let [x0, x1] = range(&|p| [ln(p[0]); 2]);
    let [y0, y1] = range(&|p| [p[1] - p[2], p[1] + p[2]]);
    if !(x1 > x0 && y1 > y0) {
        return;
    }
    let place_x = |n: f64| LEFT + (ln(n) - x0) / (x1 - x0) * (WIDTH - LEFT - MARGIN);
    let place_y = |v: f64| top + HEIGHT - MARGIN - (v - y0) / (y1 - y0) * (HEIGHT - 2.0 * MARGIN);
    let (bottom, right) = (top + HEIGHT - MARGIN, WIDTH - MARGIN);
    let _ = writeln!(text, r#"<text x="{LEFT}" y="{}">{}</text>"#, top + 20.0, diagram.title);
    let _ = writeln!(text, r##"<path d="M{LEFT} {} V{bottom} H{right}" fill="none" stroke="#444"/>"##, top + MARGIN);
    for step in 0..=4 {
        let v = y0 + (y1 - y0) * f64::from(step) / 4.0;
        let y = place_y(v);
        let _ = writeln!(
            text,
            r##"<path d="M{LEFT} {y:.1} H{right}" stroke="#ddd"/><text x="{}" y="{:.1}" text-anchor="end">{v:.4}</text>"##,
            LEFT - 6.0,
            y + 4.0
        );
    }
    let sizes: Vec<f64> = diagram.series.first().map_or_else(Vec::new, |s| s.points.iter().map(|p| p[0]).collect());
    for n in sizes {
        let _ = writeln!(text, r#"<text x="{:.1}" y="{}" text-anchor="middle">{n}</text>"#, place_x(n), bottom + 16.0);
    }
    for (k, series) in diagram.series.iter().enumerate() {
        let colour = series.colour;
        let line: Vec<String> =
            series.points.iter().map(|p| format!("{:.1},{:.1}", place_x(p[0]), place_y(p[1]))).collect();
        let _ = writeln!(
            text,
            r#"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="1.5"/>"#,
            line.join(" ")
        );
        for [n, v, s] in &series.points {
            let (x, low, high) = (place_x(*n), place_y(v - s), place_y(v + s));
            let _ = writeln!(
                text,
                r#"<path d="M{x:.1} {low:.1} V{high:.1}" stroke="{colour}" stroke-width="3" opacity="0.5"/>"#
            );
        }
        let _ = writeln!(
            text,
            r#"<text x="{}" y="{}" fill="{colour}" text-anchor="end">{}</text>"#,
            right,
            top + 20.0 + 15.0 * k as f64,
            series.name
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plot_holds_every_point_and_survives_empty_series() {
        let series = |points: Vec<[f64; 3]>| Series { name: "all".into(), colour: "#06c", points };
        let full = Diagram { title: "E", series: vec![series(vec![[200.0, 1.0, 0.1], [2000.0, 1.1, 0.05]])] };
        let text = svg(&[full]);
        assert_eq!(text.matches("stroke-width=\"3\"").count(), 2);
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n"));
        assert!(svg(&[Diagram { title: "empty", series: vec![series(vec![])] }]).contains("</svg>"));
    }
}
