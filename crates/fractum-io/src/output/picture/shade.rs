//! What the depths tell the eye: darker hollows, and a line where one thing ends before another.

use rayon::prelude::*;

use super::Rgb;
use super::raster::Canvas;

/// Reach of a hollow's shadow, as a share of the picture's smaller side.
const REACH: f64 = 0.035;
/// Step in depth that makes an outline, as a share of the picture's smaller side.
const STEP: f64 = 0.012;

/// Directions in which a hollow is felt, each with its opposite.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [0.924, 0.383],
    [0.707, 0.707],
    [0.383, 0.924],
    [0.0, 1.0],
    [-0.383, 0.924],
    [-0.707, 0.707],
    [-0.924, 0.383],
];

/// Two pixels on opposite sides, where a hollow is felt.
struct Pair {
    /// Columns and rows from the pixel in the middle.
    one: [isize; 2],
    other: [isize; 2],
    /// Distance in depth that counts at most.
    limit: f32,
}

/// Pixels that are felt around each one, at two distances.
///
/// - `reach`: of the farther ones [pixels]; `factor`: samples per pixel
fn hollow_pairs(reach: f64, factor: usize) -> Vec<Pair> {
    let pair = |[x, y]: [f64; 2], share: f64| {
        let place = |sign: f64| [x, y].map(|along| (sign * share * reach * along).round() as isize);
        Pair { one: place(1.0), other: place(-1.0), limit: (share * reach * factor as f64) as f32 }
    };
    DIRECTIONS.iter().flat_map(|&direction| [0.3, 1.0].map(|share| pair(direction, share))).collect()
}

/// Depth of the nearest sample of every pixel, behind a margin that nothing is in.
struct Nearest {
    /// Pixels of a row, with the margins.
    stride: usize,
    margin: usize,
    /// From the nearest of all [samples], so that single precision is enough wherever the body is.
    depth: Vec<f32>,
}

impl Nearest {
    fn of(canvas: &Canvas, factor: usize, margin: usize) -> Self {
        let (columns, rows) = (canvas.width / factor, canvas.height / factor);
        let first = canvas.depth.iter().copied().fold(f64::INFINITY, f64::min);
        let stride = columns + 2 * margin;
        let mut depth = vec![f32::INFINITY; stride * (rows + 2 * margin)];
        depth.par_chunks_mut(stride).skip(margin).take(rows).enumerate().for_each(|(row, pixels)| {
            let samples = &canvas.depth[row * factor * canvas.width..(row + 1) * factor * canvas.width];
            for of_row in samples.chunks_exact(canvas.width) {
                for (pixel, samples) in pixels[margin..].iter_mut().zip(of_row.chunks_exact(factor)) {
                    let nearest = samples.iter().copied().fold(f64::INFINITY, f64::min);
                    *pixel = pixel.min((nearest - first) as f32);
                }
            }
        });
        Self { stride, margin, depth }
    }

    /// Depths of `count` pixels from `column` of a row on, seen from `shift` columns and rows away.
    fn row(&self, column: usize, row: usize, [x, y]: [isize; 2], count: usize) -> &[f32] {
        let start = (self.margin + row).wrapping_add_signed(y) * self.stride;
        let start = (start + self.margin + column).wrapping_add_signed(x);
        &self.depth[start..start + count]
    }

    /// Darkness of the pixels of a row by the hollows that they lie in, 0 to 1: from `column` on, one for each in `hollow`.
    fn feel(&self, pairs: &[Pair], column: usize, row: usize, hollow: &mut [f32]) {
        let own = self.row(column, row, [0, 0], hollow.len());
        hollow.fill(0.0);
        for &Pair { one, other, limit } in pairs {
            let [one, other] = [one, other].map(|shift| self.row(column, row, shift, hollow.len()));
            let weight = 1.0 / (limit * pairs.len() as f32);
            for (((hollow, own), one), other) in hollow.iter_mut().zip(own).zip(one).zip(other) {
                // On a plane, what one side is nearer the other is farther: only hollows count.
                let nearer = |depth: f32| (own - depth).max(-limit).min(limit);
                *hollow += (weight * (nearer(*one) + nearer(*other))).max(0.0);
            }
        }
    }
}

/// Darkens hollows and draws outlines; a pixel has `factor` × `factor` samples.
pub(super) fn shade(canvas: &mut Canvas, factor: usize) {
    let size = canvas.width.min(canvas.height) as f64;
    let reach = REACH * size / factor as f64;
    // Hollows are smooth: they are felt once per pixel, for all its samples.
    let (pairs, nearest) = (hollow_pairs(reach, factor), Nearest::of(canvas, factor, reach.ceil() as usize + 1));
    let Canvas { width, ref depth, ref mut colour, .. } = *canvas;
    let columns = width / factor;
    let rows = colour.par_chunks_mut(factor * width).enumerate();
    rows.for_each_init(Vec::new, |hollow: &mut Vec<f32>, (pixel_row, colours)| {
        let own = nearest.row(0, pixel_row, [0, 0], columns);
        let Some(first) = own.iter().position(|depth| depth.is_finite()) else { return };
        let last = own.iter().rposition(|depth| depth.is_finite()).unwrap_or(first);
        hollow.resize(last + 1 - first, 0.0);
        nearest.feel(&pairs, first, pixel_row, hollow);
        for (row, colours) in (pixel_row * factor..).zip(colours.chunks_exact_mut(width)) {
            let samples = colours[first * factor..].chunks_exact_mut(factor).zip((first * factor..).step_by(factor));
            for ((samples, column), hollow) in samples.zip(hollow.iter()) {
                let shadow = 1.0 - 0.6 * hollow.min(1.0);
                for (colour, column) in samples.iter_mut().zip(column..) {
                    darken(colour, shadow, outline(depth, width, [column, row], STEP * size, size));
                }
            }
        }
    });
}

/// Darkens the colour of a sample; none of one where nothing is.
fn darken(colour: &mut Rgb, shadow: f32, outline: Option<bool>) {
    let Some(outline) = outline else { return };
    let dark = if outline { 0.45 * shadow } else { shadow };
    if dark < 1.0 {
        // To the nearest: what rounding makes of a flat face must not show as a pattern.
        *colour = colour.map(|channel| (f32::from(channel) * dark + 0.5) as u8);
    }
}

/// Whether one thing ends at a sample before another one that is farther by more than `step`; none where nothing is.
///
/// - `size`: slopes beyond it do not count
fn outline(depth: &[f64], width: usize, [column, row]: [usize; 2], step: f64, size: f64) -> Option<bool> {
    let at = row * width + column;
    let own = depth[at];
    if own.is_infinite() {
        return None;
    }
    let left = if column > 0 { depth[at - 1] } else { f64::INFINITY };
    let right = if column + 1 < width { depth[at + 1] } else { f64::INFINITY };
    let above = if row > 0 { depth[at - width] } else { f64::INFINITY };
    let below = depth.get(at + width).copied().unwrap_or(f64::INFINITY);
    // The slope is taken out: a steep face is not an edge.
    let ends = |next: f64, before: f64| next - own > step && next - own > step + 4.0 * (own - before).abs().min(size);
    Some(ends(right, left) || ends(left, right) || ends(below, above) || ends(above, below))
}

/// Averages `factor` × `factor` samples to a pixel.
pub(super) fn reduce(canvas: &Canvas, factor: usize) -> Vec<u8> {
    let (width, height) = (canvas.width / factor, canvas.height / factor);
    let mut rgb = vec![0; 3 * width * height];
    rgb.par_chunks_mut(3 * width).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.chunks_exact_mut(3).enumerate() {
            let mut sum = [0u32; 3];
            for dy in 0..factor {
                let start = (row * factor + dy) * canvas.width + column * factor;
                for sample in &canvas.colour[start..start + factor] {
                    (0..3).for_each(|k| sum[k] += u32::from(sample[k]));
                }
            }
            let samples = (factor * factor) as u32;
            (0..3).for_each(|k| pixel[k] = ((sum[k] + samples / 2) / samples) as u8);
        }
    });
    rgb
}
