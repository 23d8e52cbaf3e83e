//! Triangles and spheres to samples, nearest in front.

use rayon::prelude::*;

use super::camera::{Camera, cross, dot, subtract, unit};
use super::{Clip, Paint, Picture, Rgb};

/// Rows drawn together by one thread.
const BAND: usize = 48;
/// Towards the light, in picture coordinates (right, down, away).
const LIGHT: [f64; 3] = [-0.45, -0.60, -0.66];

/// The picture before shading: colour and depth of each sample.
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) colour: Vec<Rgb>,
    /// Infinite where nothing is.
    pub(super) depth: Vec<f64>,
}

/// A triangle in the picture.
struct Facet {
    corners: [[f64; 3]; 3],
    /// Heights above the clip plane; what is above is not drawn.
    clip: [f64; 3],
    colour: FacetColour,
    light: f64,
    lines: f64,
}

enum FacetColour {
    Plain(Rgb),
    /// Shares of the colour map's range at the corners.
    Corners([f64; 3]),
}

struct Ball {
    centre: [f64; 3],
    radius: f64,
    colour: Rgb,
    /// Position of the centre in space, for the clip plane.
    place: [f64; 3],
}

/// Draws all of `picture`.
pub(super) fn draw(picture: &Picture, camera: &Camera, width: usize, height: usize) -> Canvas {
    let facets = facets(picture, camera);
    let balls = balls(picture, camera);
    let mut colour = vec![[255; 3]; width * height];
    let mut depth = vec![f64::INFINITY; width * height];
    let bands = colour.par_chunks_mut(BAND * width).zip(depth.par_chunks_mut(BAND * width)).enumerate();
    bands.for_each(|(band, (colour, depth))| {
        let mut band = Band { width, top: band * BAND, colour, depth };
        facets.iter().for_each(|facet| band.facet(facet, picture));
        balls.iter().for_each(|ball| band.ball(ball, picture.clip, camera.scale));
    });
    Canvas { width, height, colour, depth }
}

fn share(picture: &Picture, value: f64) -> f64 {
    let (low, high) = picture.range;
    (value - low) / (high - low)
}

fn facets(picture: &Picture, camera: &Camera) -> Vec<Facet> {
    let of_surface = |surface: &super::Surface| -> Vec<Facet> {
        let facet = |(index, nodes): (usize, &[u32; 3])| {
            let nodes = nodes.map(|node| node as usize);
            let points = nodes.map(|node| surface.points[node]);
            let corners = points.map(|point| camera.project(point));
            let normal = unit(cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0])))?;
            // Right, down, away is right-handed: a facet that faces the eye has a normal towards it, negative depth.
            let outside = normal[2] < 0.0;
            let normal = if outside { normal } else { normal.map(|x| -x) };
            let inside_tone = if outside { 1.0 } else { 0.72 };
            let colour = match surface.paint {
                Paint::Plain(colour) => FacetColour::Plain(colour),
                Paint::Nodes(values) => FacetColour::Corners(nodes.map(|node| share(picture, values[node]))),
                Paint::Facets(values) => FacetColour::Plain(picture.map.colour(share(picture, values[index]))),
            };
            let clip = match picture.clip {
                Some(Clip { point, normal }) => points.map(|corner| dot(subtract(corner, point), normal)),
                None => [-1.0; 3],
            };
            let lines = if surface.mesh_lines { line_strength(&corners) } else { 0.0 };
            Some(Facet { corners, clip, colour, light: inside_tone * brightness(normal), lines })
        };
        surface.triangles.par_iter().enumerate().filter_map(facet).collect()
    };
    picture.surfaces.iter().flat_map(of_surface).collect()
}

fn balls(picture: &Picture, camera: &Camera) -> Vec<Ball> {
    let of_set = |spheres: &super::Spheres| -> Vec<Ball> {
        let ball = |index: usize| {
            let place = spheres.centres[index];
            let centre = camera.project(place);
            let radius = camera.scale * spheres.radii[index];
            let colour = match spheres.paint {
                Paint::Plain(colour) => colour,
                Paint::Nodes(values) | Paint::Facets(values) => picture.map.colour(share(picture, values[index])),
            };
            let sane = centre.iter().all(|x| x.is_finite()) && radius.is_finite() && radius > 0.0;
            sane.then_some(Ball { centre, radius, colour, place })
        };
        (0..spheres.centres.len()).filter_map(ball).collect()
    };
    picture.spheres.iter().flat_map(of_set).collect()
}

/// Light on a face with that unit normal, in picture coordinates: some from everywhere, some from the eye, most from
/// the light.
fn brightness(normal: [f64; 3]) -> f64 {
    0.58 + 0.20 * (-normal[2]).max(0.0) + 0.32 * dot(normal, LIGHT).max(0.0)
}

/// How dark the edges are drawn: fading where the triangles are but a few samples wide.
fn line_strength(corners: &[[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners;
    let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let width = twice_area.abs().sqrt();
    0.30 * ((width - 6.0) / 24.0).clamp(0.0, 1.0)
}

fn lit(colour: Rgb, light: f64) -> Rgb {
    colour.map(|channel| (f64::from(channel) * light).min(255.0) as u8)
}

/// Share of a corner along a row of samples.
#[derive(Clone, Copy)]
struct Share {
    /// At the first column, over the scale.
    start: f64,
    /// From column to column, over the scale.
    slope: f64,
    scale: f64,
}

impl Share {
    /// Share of the corner opposite to the edge from `p` to `q`, at the height `y` of a row.
    ///
    /// - `scale`: one over twice the area of the triangle
    fn of_row(p: [f64; 3], q: [f64; 3], y: f64, scale: f64) -> Self {
        Share { start: (p[0] - 0.5) * (q[1] - y) - (p[1] - y) * (q[0] - 0.5), slope: p[1] - q[1], scale }
    }

    fn at(self, column: usize) -> f64 {
        // Scaled last: two triangles with a common edge agree to the last bit on which side of it a sample lies.
        self.scale * (self.start + self.slope * column as f64)
    }
}

/// Columns of a row between which no share is negative, or one more on either side.
fn span(shares: &[Share; 3], [left, right]: [usize; 2]) -> [usize; 2] {
    let (mut low, mut high) = (left as f64, right as f64);
    for share in shares.iter().filter(|share| share.slope != 0.0) {
        let zero = -share.start / share.slope;
        if share.slope * share.scale > 0.0 {
            low = low.max(zero - 1.0);
        } else {
            high = high.min(zero + 2.0);
        }
    }
    // What is not a number leaves the bounds as they are.
    [low as usize, (high.max(0.0) as usize).min(right)]
}

/// The colour of all samples of a facet, where it is one.
fn lit_evenly(facet: &Facet) -> Option<Rgb> {
    match facet.colour {
        FacetColour::Plain(colour) if facet.lines == 0.0 => Some(lit(colour, facet.light)),
        _ => None,
    }
}

impl Facet {
    /// Colour of a sample.
    ///
    /// - `heights`: samples from the edge opposite to a corner per share of it
    fn colour_at(&self, shares: [f64; 3], heights: [f64; 3], picture: &Picture) -> Rgb {
        let colour = match self.colour {
            FacetColour::Plain(colour) => colour,
            FacetColour::Corners(corners) => picture.map.colour(dot(shares, corners)),
        };
        let to_edge = (0..3).map(|k| shares[k] * heights[k]).fold(f64::INFINITY, f64::min);
        let line = 1.0 - self.lines * (1.3 - to_edge).clamp(0.0, 1.0);
        lit(colour, self.light * line)
    }
}

/// Some rows of the canvas.
struct Band<'a> {
    width: usize,
    top: usize,
    colour: &'a mut [Rgb],
    depth: &'a mut [f64],
}

impl Band<'_> {
    /// Columns and rows of the band within the given bounds; samples lie at the middle of their cells.
    fn window(&self, low: [f64; 2], high: [f64; 2]) -> Option<[usize; 4]> {
        let rows = self.depth.len() / self.width;
        let (top, bottom) = (self.top as f64, (self.top + rows) as f64);
        if high[1] < top || low[1] > bottom || high[0] < 0.0 || low[0] > self.width as f64 {
            return None;
        }
        let first = |low: f64, start: f64| (low - start - 0.5).ceil().max(0.0) as usize;
        let end =
            |high: f64, start: f64, size: usize| ((high - start - 0.5).floor() + 1.0).clamp(0.0, size as f64) as usize;
        Some([first(low[0], 0.0), end(high[0], 0.0, self.width), first(low[1], top), end(high[1], top, rows)])
    }

    fn facet(&mut self, facet: &Facet, picture: &Picture) {
        let [a, b, c] = facet.corners;
        let bound = |pick: fn(f64, f64) -> f64, axis: usize| pick(pick(a[axis], b[axis]), c[axis]);
        let low = [bound(f64::min, 0), bound(f64::min, 1)];
        let high = [bound(f64::max, 0), bound(f64::max, 1)];
        let Some([left, right, top, bottom]) = self.window(low, high) else { return };
        let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let scale = 1.0 / twice_area;
        if !scale.is_finite() {
            return;
        }
        // How many samples a sample is from the opposite edge per share of a corner.
        let height = |p: [f64; 3], q: [f64; 3]| {
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            twice_area.abs() / (dx * dx + dy * dy).sqrt()
        };
        let heights = [height(b, c), height(c, a), height(a, b)];
        let even = lit_evenly(facet);
        for row in top..bottom {
            let y = (self.top + row) as f64 + 0.5;
            let shares = [(b, c), (c, a), (a, b)].map(|(p, q)| Share::of_row(p, q, y, scale));
            let [left, right] = span(&shares, [left, right]);
            for column in left..right {
                let shares = shares.map(|share| share.at(column));
                if shares.iter().any(|&share| share < 0.0) {
                    continue;
                }
                let depth = dot(shares, [a[2], b[2], c[2]]);
                let at = row * self.width + column;
                if depth >= self.depth[at] || dot(shares, facet.clip) > 0.0 {
                    continue;
                }
                self.depth[at] = depth;
                self.colour[at] = even.unwrap_or_else(|| facet.colour_at(shares, heights, picture));
            }
        }
    }

    fn ball(&mut self, ball: &Ball, clip: Option<Clip>, scale: f64) {
        let Ball { centre, radius, colour, place } = *ball;
        let low = [centre[0] - radius, centre[1] - radius];
        let high = [centre[0] + radius, centre[1] + radius];
        let Some([left, right, top, bottom]) = self.window(low, high) else { return };
        // A ball is small beside the picture: it is kept or cut away as a whole.
        if clip.is_some_and(|Clip { point, normal }| scale * dot(subtract(place, point), normal) > 0.0) {
            return;
        }
        for row in top..bottom {
            let dy = (self.top + row) as f64 + 0.5 - centre[1];
            for column in left..right {
                let dx = column as f64 + 0.5 - centre[0];
                let inside = radius * radius - dx * dx - dy * dy;
                if inside < 0.0 {
                    continue;
                }
                let dz = inside.sqrt();
                let at = row * self.width + column;
                if centre[2] - dz < self.depth[at] {
                    self.depth[at] = centre[2] - dz;
                    self.colour[at] = lit(colour, brightness([dx / radius, dy / radius, -dz / radius]));
                }
            }
        }
    }
}
