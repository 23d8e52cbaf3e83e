//! Triangles and spheres to samples, nearest in front.

use rayon::prelude::*;

use super::camera::{Camera, cross, dot, subtract, unit};
use super::shares::{RowShare, Share, reaching, span};
use super::{Clip, Paint, Picture, Rgb, SUPERSAMPLING};

/// Towards the light, in picture coordinates (right, down, away).
const LIGHT: [f64; 3] = [-0.45, -0.60, -0.66];

/// A triangle in the picture.
pub(super) struct Facet {
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

pub(super) struct Ball {
    centre: [f64; 3],
    radius: f64,
    colour: Rgb,
    /// Position of the centre in space, for the clip plane.
    place: [f64; 3],
}

/// Where something may be in the picture [samples], in depth too.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
}

impl Extent {
    /// Of nothing.
    pub(super) const NONE: Extent = Extent { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    fn including(self, other: Extent) -> Extent {
        let pick = |a: [f64; 3], b: [f64; 3], best: fn(f64, f64) -> f64| std::array::from_fn(|k| best(a[k], b[k]));
        Extent { low: pick(self.low, other.low, f64::min), high: pick(self.high, other.high, f64::max) }
    }
}

/// What has a place in the picture.
pub(super) trait Item {
    fn extent(&self) -> Extent;
}

impl Item for Facet {
    fn extent(&self) -> Extent {
        let points = self.corners.iter().map(|&corner| Extent { low: corner, high: corner });
        points.fold(Extent::NONE, Extent::including)
    }
}

impl Item for Ball {
    fn extent(&self) -> Extent {
        Extent { low: self.centre.map(|x| x - self.radius), high: self.centre.map(|x| x + self.radius) }
    }
}

fn share(picture: &Picture, value: f64) -> f64 {
    let (low, high) = picture.range;
    (value - low) / (high - low)
}

/// The triangles of all surfaces; those without an area or a place are left out.
pub(super) fn facets(picture: &Picture, camera: &Camera) -> Vec<Facet> {
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

/// The spheres that have a place and a size.
pub(super) fn balls(picture: &Picture, camera: &Camera) -> Vec<Ball> {
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

/// Red, green and blue of a sample and whether something is there, 0 or 1.
pub(super) type Sample = [u8; 4];

fn sample([red, green, blue]: Rgb) -> Sample {
    [red, green, blue, 1]
}

/// Some rows of samples, with a border of one sample that nothing is in on the left and on the right.
#[derive(Default)]
pub(super) struct Samples {
    /// Samples of a row, with the border.
    pub(super) stride: usize,
    /// Column and row of the first one in the picture.
    pub(super) origin: [isize; 2],
    pub(super) colour: Vec<Sample>,
    /// Infinite where nothing is.
    pub(super) depth: Vec<f64>,
}

impl Samples {
    /// Clears them, for `columns` samples and their border in each of `rows`.
    ///
    /// - `first`: column and row in the picture of the first sample within the border
    pub(super) fn clear(&mut self, first: [isize; 2], columns: usize, rows: usize) {
        self.stride = columns + 2;
        self.origin = [first[0] - 1, first[1]];
        self.colour.clear();
        self.colour.resize(self.stride * rows, [0; 4]);
        self.depth.clear();
        self.depth.resize(self.stride * rows, f64::INFINITY);
    }

    /// Columns and rows within the bounds of something; samples lie at the middle of their cells.
    fn window(&self, Extent { low, high }: Extent) -> Option<[usize; 4]> {
        let inner = self.stride - 2;
        let [x, y] = [self.origin[0] as f64, self.origin[1] as f64];
        let first = |low: f64, start: f64, least: f64| (low - start - 0.5).ceil().max(least) as usize;
        let end =
            |high: f64, start: f64, size: usize| ((high - start - 0.5).floor() + 1.0).clamp(0.0, size as f64) as usize;
        let rows = self.depth.len() / self.stride;
        let columns = [first(low[0], x, 1.0), end(high[0], x, 1 + inner)];
        let rows = [first(low[1], y, 0.0), end(high[1], y, rows)];
        (columns[0] < columns[1] && rows[0] < rows[1]).then_some([columns[0], columns[1], rows[0], rows[1]])
    }

    /// Whether what is there already hides all that is no nearer than that.
    #[inline(always)]
    fn hides(&self, [left, right, top, bottom]: [usize; 4], nearest: f64) -> bool {
        let all_nearer = |depths: &[f64]| depths.iter().fold(true, |all, &depth| all & (depth <= nearest));
        (top..bottom).map(|row| row * self.stride).all(|at| all_nearer(&self.depth[at + left..at + right]))
    }

    #[inline(always)]
    pub(super) fn facet(&mut self, facet: &Facet, picture: &Picture) {
        let extent = facet.extent();
        let Some(window) = self.window(extent).filter(|&window| !self.hides(window, extent.low[2])) else { return };
        let [left, right, top, bottom] = window;
        // In the coordinates of these samples.
        let shift = self.origin.map(|along| along as f64);
        let [a, b, c] = facet.corners.map(|[x, y, z]| [x - shift[0], y - shift[1], z]);
        let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let scale = 1.0 / twice_area;
        if !scale.is_finite() {
            return;
        }
        let painted = Painted::of(facet, [a, b, c], twice_area.abs(), picture);
        let shares = [(b, c), (c, a), (a, b)].map(|(p, q)| Share::of_corner(p, q, scale));
        let corners = [a[2], b[2], c[2]];
        let slope = scale * dot(shares.map(|share| share.per_column), corners);
        for row in top..bottom {
            let shares = shares.map(|share| share.in_row(row));
            let [left, right] = span(&shares, [left, right]);
            let [first, last] = painted.even_span(&shares, [left, right]);
            let at = row * self.stride;
            let start = dot(shares.map(|share| share.at(left)), corners);
            let depth_at = |column: usize| start + slope * (column - left) as f64;
            for column in (left..first).chain(last..right) {
                let (depth, nearest) = (depth_at(column), &mut self.depth[at + column]);
                if depth < *nearest && painted.is_there(&shares, column) {
                    *nearest = depth;
                    self.colour[at + column] = sample(painted.colour(&shares, column));
                }
            }
            let even = painted.even.map_or([0; 4], sample);
            let start = depth_at(first);
            let inner = at + first..at + last;
            let samples = self.depth[inner.clone()].iter_mut().zip(&mut self.colour[inner]);
            for (column, (nearest, colour)) in (0_i32..).zip(samples) {
                let depth = start + slope * f64::from(column);
                let is_nearer = depth < *nearest;
                *nearest = if is_nearer { depth } else { *nearest };
                *colour = if is_nearer { even } else { *colour };
            }
        }
    }

    #[inline(always)]
    pub(super) fn ball(&mut self, ball: &Ball, clip: Option<Clip>, scale: f64) {
        let Ball { centre, radius, colour, place } = *ball;
        let extent = ball.extent();
        let Some(window) = self.window(extent).filter(|&window| !self.hides(window, extent.low[2])) else { return };
        let [left, right, top, bottom] = window;
        // A ball is small beside the picture: it is kept or cut away as a whole.
        if clip.is_some_and(|Clip { point, normal }| scale * dot(subtract(place, point), normal) > 0.0) {
            return;
        }
        let [x, y] = [centre[0] - self.origin[0] as f64, centre[1] - self.origin[1] as f64];
        for row in top..bottom {
            let dy = row as f64 + 0.5 - y;
            let half = (radius * radius - dy * dy).max(0.0).sqrt();
            let first = ((x - half - 0.5).floor().max(0.0) as usize).clamp(left, right);
            let end = ((x + half + 1.5).max(0.0) as usize).clamp(first, right);
            for column in first..end {
                let dx = column as f64 + 0.5 - x;
                let inside = radius * radius - dx * dx - dy * dy;
                if inside < 0.0 {
                    continue;
                }
                let dz = inside.sqrt();
                let at = row * self.stride + column;
                if centre[2] - dz < self.depth[at] {
                    self.depth[at] = centre[2] - dz;
                    self.colour[at] = sample(lit(colour, brightness([dx / radius, dy / radius, -dz / radius])));
                }
            }
        }
    }
}

/// Samples from an edge within which its line darkens a facet.
const LINE: f64 = 1.3;

/// The colours of a facet at its samples.
struct Painted<'a> {
    facet: &'a Facet,
    picture: &'a Picture<'a>,
    /// The colour off the edges, where it is one.
    even: Option<Rgb>,
    /// Samples from the edge opposite to a corner per share of it.
    heights: [f64; 3],
}

impl<'a> Painted<'a> {
    fn of(facet: &'a Facet, [a, b, c]: [[f64; 3]; 3], twice_area: f64, picture: &'a Picture<'a>) -> Self {
        let height = |p: [f64; 3], q: [f64; 3]| {
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            twice_area / (dx * dx + dy * dy).sqrt()
        };
        let even = match facet.colour {
            FacetColour::Plain(colour) => Some(lit(colour, facet.light)),
            FacetColour::Corners(_) => None,
        };
        Painted { facet, picture, even, heights: [height(b, c), height(c, a), height(a, b)] }
    }

    /// Whether the clip plane leaves the facet there.
    #[inline(always)]
    fn is_there(&self, shares: &[RowShare; 3], column: usize) -> bool {
        self.picture.clip.is_none() || dot(shares.map(|share| share.at(column)), self.facet.clip) <= 0.0
    }

    /// Columns of a row at which the facet is not cut and has its colour off the edges, for sure.
    #[inline(always)]
    fn even_span(&self, shares: &[RowShare; 3], within: [usize; 2]) -> [usize; 2] {
        if self.even.is_none() || self.picture.clip.is_some() {
            [within[0]; 2]
        } else if self.facet.lines == 0.0 {
            within
        } else {
            reaching(shares, self.heights.map(|height| LINE / height), within, -1.0)
        }
    }

    /// Colour of a sample.
    #[inline(always)]
    fn colour(&self, shares: &[RowShare; 3], column: usize) -> Rgb {
        let Facet { light, lines, ref colour, .. } = *self.facet;
        if let (Some(even), true) = (self.even, lines == 0.0) {
            return even;
        }
        let shares = shares.map(|share| share.at(column));
        let to_edge = (0..3).map(|k| shares[k] * self.heights[k]).fold(f64::INFINITY, f64::min);
        let line = 1.0 - lines * (LINE - to_edge).clamp(0.0, 1.0);
        match (self.even, colour) {
            (Some(even), _) if to_edge >= LINE => even,
            (_, FacetColour::Plain(colour)) => lit(*colour, light * line),
            (_, FacetColour::Corners(corners)) => lit(self.picture.map.colour(dot(shares, *corners)), light * line),
        }
    }
}

/// What is drawn, sorted by the bands of rows of samples that it may be seen in.
pub(super) struct Bands<T> {
    items: Vec<T>,
    /// Indices of the items of each band, the nearest first: what lies behind them needs no colour.
    of_bands: Vec<Vec<u32>>,
}

impl<T: Item> Bands<T> {
    /// - `rows`: of pixels in a band; `bands`: how many
    pub(super) fn new(items: Vec<T>, top: usize, rows: usize, bands: usize) -> Self {
        let height = (rows * SUPERSAMPLING) as f64;
        let mut of_bands = vec![Vec::new(); bands];
        let mut order: Vec<(f64, u32)> = (0..).zip(&items).map(|(index, item)| (item.extent().low[2], index)).collect();
        order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, index) in order {
            let Extent { low, high } = items[index as usize].extent();
            // A sample more on either side, for the outlines.
            let from_top = |y: f64| (y - (top * SUPERSAMPLING) as f64) / height;
            let first = from_top(low[1] - 1.0).max(0.0) as usize;
            let last = from_top(high[1] + 1.0);
            if last >= 0.0 && first < bands {
                of_bands[first..=(last as usize).min(bands - 1).max(first)]
                    .iter_mut()
                    .for_each(|band| band.push(index));
            }
        }
        Bands { items, of_bands }
    }

    pub(super) fn of(&self, band: usize) -> impl Iterator<Item = &T> {
        self.of_bands[band].iter().map(|&index| &self.items[index as usize])
    }
}

/// Where a picture has something: columns from and to, and rows from and to [pixels]; and the depths there [samples].
pub(super) struct Shown {
    pub(super) columns: [usize; 2],
    pub(super) rows: [usize; 2],
    pub(super) depths: [f64; 2],
}

impl Shown {
    /// None where nothing is in the picture.
    pub(super) fn of(facets: &[Facet], balls: &[Ball], [width, height]: [usize; 2]) -> Option<Self> {
        let size = [width, height].map(|pixels| (pixels * SUPERSAMPLING) as f64);
        let inside = |extent: &Extent| {
            let Extent { low, high } = extent;
            low.iter().chain(high).all(|x| x.is_finite()) && (0..2).all(|k| high[k] > 0.0 && low[k] < size[k])
        };
        let all = facets.iter().map(Item::extent).chain(balls.iter().map(Item::extent));
        let Extent { low, high } = all.filter(inside).fold(Extent::NONE, Extent::including);
        let pixels = |axis: usize, count: usize| {
            let first = (low[axis] / SUPERSAMPLING as f64).floor().max(0.0) as usize;
            [first, ((high[axis] / SUPERSAMPLING as f64).ceil() as usize).min(count)]
        };
        (low[0] < high[0]).then(|| Shown {
            columns: pixels(0, width),
            rows: pixels(1, height),
            depths: [low[2], high[2]],
        })
    }
}
