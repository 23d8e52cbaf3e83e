//! Charts as SVG: lines, areas and steps over linear or logarithmic axes whose units take the prefix that suits.
//!
//! The text of a chart depends on its numbers alone. Long series are thinned to what can be seen, keeping every peak.
//!
//! ```
//! use fractum_report::plot::{Axis, Chart, Series, Style};
//! let chart = Chart {
//!     title: "Load".into(),
//!     x: Axis::new("time", "s"),
//!     y: Axis::new("force", "N").from_zero(),
//!     series: vec![Series::new("top", vec![0.0, 1e-4, 2e-4], vec![0.0, 3100.0, 200.0], Style::Line)],
//!     ..Chart::default()
//! };
//! assert!(chart.to_svg().contains("force [kN]"));
//! ```

mod axis;
mod thin;

use std::fmt::Write;

pub use axis::Axis;
use axis::Scale;
pub(crate) use axis::linear_ticks;
use fractum_vtk::text::escape;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 340.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 18.0;
const BOTTOM: f64 = 46.0;
/// Colours of the series, tellable with most kinds of colour blindness.
const COLOURS: [&str; 8] = ["#2166a5", "#d6761c", "#2e8b57", "#b2303c", "#7b5aa6", "#2a98a8", "#8a6d3b", "#6b7280"];

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Points joined by lines.
    #[default]
    Line,
    /// A value holds until the next.
    Step,
    /// The area down to zero is filled.
    Area,
    /// A thick dark line, to stand before areas.
    Outline,
    /// Points without a line.
    Points,
}

/// Points of one quantity. Points that are not finite interrupt the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Abscissae, in the SI unit of the axis.
    pub x: Vec<f64>,
    /// Ordinates; where the lengths differ, the longer rest is left out.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub style: Style,
    /// Its colour, as `#2166a5`; one of its own by its number if there is none.
    pub colour: Option<&'static str>,
}

impl Series {
    /// A series.
    pub fn new(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>, style: Style) -> Self {
        Self { name: name.into(), x, y, style, colour: None }
    }
}

/// A horizontal line to compare with, as a reference value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// What it says.
    pub label: String,
    /// Where it is, in the SI unit of the axis.
    pub value: f64,
}

/// A point that is pointed out, as a peak.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mark {
    /// What it says.
    pub label: String,
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: f64,
}

/// A chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Drawn one over the other; areas want the largest first.
    pub series: Vec<Series>,
    /// Lines to compare with.
    pub levels: Vec<Level>,
    /// Points to point out.
    pub marks: Vec<Mark>,
}

/// Areas one on top of the other, in the order in which they are to be drawn: the top of all first.
pub fn stacked(x: &[f64], parts: &[(&str, &[f64])]) -> Vec<Series> {
    let mut top = vec![0.0; x.len()];
    let mut series: Vec<Series> = Vec::new();
    for (name, values) in parts {
        for (top, value) in top.iter_mut().zip(*values) {
            *top += value;
        }
        series.push(Series::new(*name, x.to_vec(), top.clone(), Style::Area));
    }
    series.reverse();
    series
}

impl Chart {
    /// The chart as an SVG element of its own.
    pub fn to_svg(&self) -> String {
        let series: Vec<Vec<[f64; 2]>> = self.series.iter().map(thin::thinned).collect();
        let (legend, legend_height) = self.legend();
        let top = 36.0 + legend_height;
        let shown = |point: &&[f64; 2]| self.x.shows(point[0]) && self.y.shows(point[1]);
        let points = || series.iter().flatten().filter(shown);
        let levels = self.levels.iter().map(|level| level.value);
        let x = Scale::new(&self.x, points().map(|p| p[0]), [LEFT, WIDTH - RIGHT], 6, 0.0);
        let y = Scale::new(&self.y, points().map(|p| p[1]).chain(levels), [HEIGHT - BOTTOM, top], 5, 0.06);

        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
             aria-label=\"{title}\" font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"#333\">\n\
             <text x=\"{LEFT}\" y=\"18\" font-size=\"14\" font-weight=\"600\" fill=\"#111\">{title}</text>\n{legend}",
            title = escape(&self.title)
        );
        self.grid(&mut svg, &x, &y, top);
        if points().next().is_none() {
            let (x, y) = (0.5 * (LEFT + WIDTH - RIGHT), 0.5 * (top + HEIGHT - BOTTOM));
            svg += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" fill=\"#888\">no data</text>\n");
        }
        for (index, points) in series.iter().enumerate() {
            self.curve(&mut svg, index, points, &x, &y);
        }
        self.annotations(&mut svg, &x, &y);
        svg.push_str("</svg>\n");
        svg
    }

    /// Colour of a series: one after the other, of areas from the lowest up, which is the last.
    fn colour(&self, index: usize) -> &'static str {
        if let Some(colour) = self.series[index].colour {
            return colour;
        }
        let areas = |series: &[Series]| series.iter().filter(|series| series.style == Style::Area).count();
        match self.series[index].style {
            Style::Outline => "#111",
            Style::Area => COLOURS[areas(&self.series[index + 1..]) % COLOURS.len()],
            Style::Line | Style::Step | Style::Points => COLOURS[index % COLOURS.len()],
        }
    }

    /// Dashes of a line by its number, where the colours begin anew.
    fn dashes(&self, index: usize) -> &'static str {
        let rounds = if self.series[index].colour.is_some() { 0 } else { index / COLOURS.len() };
        ["", " stroke-dasharray=\"7 4\"", " stroke-dasharray=\"2 4\""][rounds.min(2)]
    }

    /// Swatches and names in rows above the chart, and their height; nothing for a single series.
    fn legend(&self) -> (String, f64) {
        let mut svg = String::new();
        if self.series.len() < 2 {
            return (svg, 0.0);
        }
        let (mut x, mut y) = (LEFT, 36.0);
        // Areas are drawn from the top down but read from the bottom up.
        let upside_down = self.series.iter().filter(|series| series.style == Style::Area).count() > 1;
        let mut order: Vec<usize> = (0..self.series.len()).collect();
        if upside_down {
            order.reverse();
        }
        for index in order {
            let name = &self.series[index].name;
            // No font is at hand to measure: the average width of letters at this size.
            let width = 24.0 + 6.6 * name.chars().count() as f64;
            if x + width > WIDTH - RIGHT && x > LEFT {
                (x, y) = (LEFT, y + 17.0);
            }
            let colour = self.colour(index);
            let swatch = match self.series[index].style {
                Style::Points => {
                    format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.5\" fill=\"{colour}\"/>", x + 7.0, y - 4.0)
                }
                Style::Area => format!(
                    "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"14\" height=\"9\" fill=\"{colour}\" opacity=\"0.75\"/>",
                    y - 8.5
                ),
                Style::Line | Style::Step | Style::Outline => format!(
                    "<path d=\"M{x:.1} {:.1}h14\" stroke=\"{colour}\" stroke-width=\"3\"{}/>",
                    y - 4.0,
                    self.dashes(index)
                ),
            };
            let _ = writeln!(svg, "{swatch}<text x=\"{:.1}\" y=\"{y:.1}\">{}</text>", x + 19.0, escape(name));
            x += width + 8.0;
        }
        (svg, y - 36.0 + 20.0)
    }

    fn grid(&self, svg: &mut String, x: &Scale, y: &Scale, top: f64) {
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        let title = |axis: &Axis, scale: &Scale| {
            let unit = &scale.prefix.unit;
            escape(&if unit.is_empty() { axis.label.clone() } else { format!("{} [{unit}]", axis.label) })
        };
        for tick in &y.ticks {
            let at = y.place(tick.value);
            let colour = if tick.value == 0.0 { "#999" } else { "#e4e4e4" };
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"{colour}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                LEFT - 7.0,
                at + 4.0,
                tick.label
            );
        }
        for tick in &x.ticks {
            let at = x.place(tick.value);
            let _ = writeln!(
                svg,
                "<path d=\"M{at:.1} {top:.1}V{bottom}\" stroke=\"#efefef\"/><path d=\"M{at:.1} {bottom}v4\" \
                 stroke=\"#999\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 17.0,
                tick.label
            );
        }
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {top:.1}V{bottom}H{right}\" fill=\"none\" stroke=\"#999\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
             <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (LEFT + right),
            HEIGHT - 8.0,
            title(&self.x, x),
            0.5 * (top + bottom),
            title(&self.y, y)
        );
    }

    fn curve(&self, svg: &mut String, index: usize, points: &[[f64; 2]], x: &Scale, y: &Scale) {
        let style = self.series[index].style;
        if style == Style::Points {
            return self.dots(svg, index, points, x, y);
        }
        let mut path = String::new();
        let mut run: Vec<[f64; 2]> = Vec::new();
        let mut finish = |run: &mut Vec<[f64; 2]>| {
            let Some((&first, &last)) = run.first().zip(run.last()) else { return };
            let _ = write!(path, "M{:.1} {:.1}", first[0], first[1]);
            let mut before = first;
            for point in &run[1..] {
                if style == Style::Step {
                    let _ = write!(path, "H{:.1}", point[0]);
                }
                let _ = write!(path, "L{:.1} {:.1}", point[0], point[1]);
                before = *point;
            }
            if style == Style::Area {
                let zero = y.place(0.0);
                let _ = write!(path, "L{:.1} {zero:.1}L{:.1} {zero:.1}Z", last[0], first[0]);
            } else if before == first {
                // A lone point shows as a dot, by its round ends.
                let _ = write!(path, "h0");
            }
            run.clear();
        };
        for &[px, py] in points {
            if self.x.shows(px) && self.y.shows(py) {
                run.push([x.place(px), y.place(py)]);
            } else {
                finish(&mut run);
            }
        }
        finish(&mut run);
        if path.is_empty() {
            return;
        }
        let colour = self.colour(index);
        let looks = match style {
            Style::Area => format!("fill=\"{colour}\" fill-opacity=\"0.75\" stroke=\"#fff\" stroke-width=\"0.5\""),
            Style::Outline => format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" stroke-linejoin=\"round\""),
            Style::Line | Style::Step | Style::Points => {
                format!(
                    "fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-linejoin=\"round\" \
                     stroke-linecap=\"round\"{}",
                    self.dashes(index)
                )
            }
        };
        // An area drawn over another must hide it, else the colours mix.
        if style == Style::Area {
            let _ = writeln!(svg, "<path d=\"{path}\" fill=\"#fff\"/>");
        }
        let _ = writeln!(svg, "<path d=\"{path}\" {looks}/>");
    }

    fn dots(&self, svg: &mut String, index: usize, points: &[[f64; 2]], x: &Scale, y: &Scale) {
        let colour = self.colour(index);
        for [px, py] in points.iter().filter(|[px, py]| self.x.shows(*px) && self.y.shows(*py)) {
            let (px, py) = (x.place(*px), y.place(*py));
            let _ = writeln!(svg, "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"3.5\" fill=\"{colour}\"/>");
        }
    }

    fn annotations(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let right = WIDTH - RIGHT;
        for Level { label, value } in self.levels.iter().filter(|level| y.contains(level.value)) {
            let at = y.place(*value);
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#555\" stroke-dasharray=\"5 4\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#555\">{}</text>",
                right - 4.0,
                at - 5.0,
                escape(label)
            );
        }
        for Mark { label, x: px, y: py } in self.marks.iter().filter(|mark| x.contains(mark.x) && y.contains(mark.y)) {
            let (at_x, at_y) = (x.place(*px), y.place(*py));
            // The label goes to the side that has room.
            let (shift, anchor) = if at_x < 0.6 * WIDTH { (8.0, "start") } else { (-8.0, "end") };
            let _ = writeln!(
                svg,
                "<circle cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"3.5\" fill=\"#fff\" stroke=\"#111\" \
                 stroke-width=\"1.5\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" font-weight=\"600\" \
                 stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
                at_x + shift,
                at_y + 4.0,
                escape(label)
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(series: Vec<Series>) -> Chart {
        Chart {
            title: "T <1>".into(),
            x: Axis::new("time", "s"),
            y: Axis::new("load", "N"),
            series,
            ..Chart::default()
        }
    }

    #[test]
    fn a_line_goes_through_its_points_from_edge_to_edge() {
        let svg = chart(vec![Series::new("a", vec![0.0, 1e-3], vec![0.0, 2000.0], Style::Line)]).to_svg();
        // From the lower left corner to the right edge, below the top by the padding.
        assert!(svg.contains(&format!("M{LEFT:.1} {:.1}L{:.1} ", HEIGHT - BOTTOM, WIDTH - RIGHT)), "{svg}");
        assert!(svg.contains("time [ms]") && svg.contains("load [kN]") && svg.contains("T &lt;1&gt;"));
    }

    #[test]
    fn points_that_are_not_finite_interrupt_the_line() {
        let y = vec![0.0, 1.0, f64::NAN, 2.0, 3.0];
        let svg = chart(vec![Series::new("a", vec![0.0, 1.0, 2.0, 3.0, 4.0], y, Style::Line)]).to_svg();
        let path = svg.split("<path d=\"").find(|path| path.contains("stroke-width=\"1.8\"")).unwrap();
        assert_eq!(path.matches('M').count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn empty_and_unusable_data_say_so() {
        for series in [vec![], vec![Series::new("a", vec![f64::NAN], vec![1.0], Style::Area)]] {
            let svg = chart(series).to_svg();
            assert!(svg.contains("no data") && svg.ends_with("</svg>\n"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }

    #[test]
    fn stacked_parts_add_up_and_the_whole_is_drawn_first() {
        let x = [0.0, 1.0];
        let series = stacked(&x, &[("kinetic", &[1.0, 2.0]), ("elastic", &[10.0, 20.0])]);
        assert_eq!(series[0].name, "elastic");
        assert_eq!(series[0].y, [11.0, 22.0]);
        assert_eq!(series[1].y, [1.0, 2.0]);
    }

    #[test]
    fn levels_and_marks_carry_their_labels() {
        let mut chart = chart(vec![Series::new("a", vec![0.0, 1.0], vec![0.0, 2.0], Style::Step)]);
        chart.levels.push(Level { label: "reference".into(), value: 3.0 });
        chart.marks.push(Mark { label: "peak 2 N".into(), x: 1.0, y: 2.0 });
        chart.marks.push(Mark { label: "elsewhere".into(), x: 5.0, y: 2.0 });
        let svg = chart.to_svg();
        assert!(svg.contains(">reference</text>") && svg.contains(">peak 2 N</text>") && !svg.contains("elsewhere"));
    }

    #[test]
    fn points_are_dots_without_a_line() {
        let svg = chart(vec![Series::new("a", vec![0.0, 1.0, 2.0], vec![1.0, f64::NAN, 2.0], Style::Points)]).to_svg();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(!svg.contains("stroke-linejoin"));
    }

    #[test]
    fn a_long_history_makes_a_small_file() {
        let x: Vec<f64> = (0..1_000_000).map(|i| i as f64 * 1e-7).collect();
        let y: Vec<f64> = x.iter().map(|t| (t * 1e5).sin()).collect();
        let svg = chart(vec![Series::new("a", x, y, Style::Line)]).to_svg();
        assert!(svg.len() < 120_000, "{}", svg.len());
    }
}
