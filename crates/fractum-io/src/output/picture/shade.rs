//! What the depths tell the eye: darker hollows, and a line where one thing ends before another.

use rayon::prelude::*;

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

/// Two samples on opposite sides, where a hollow is felt.
struct Pair {
    /// Columns and rows from the sample in the middle.
    one: [isize; 2],
    other: [isize; 2],
    /// Distance in depth that counts at most.
    limit: f64,
}

/// Samples that are felt around each one, at two distances.
fn hollow_pairs(reach: f64) -> Vec<Pair> {
    let pair = |[x, y]: [f64; 2], share: f64| {
        let limit = share * reach;
        let place = |sign: f64| [x, y].map(|along| (sign * limit * along).floor() as isize);
        Pair { one: place(1.0), other: place(-1.0), limit }
    };
    DIRECTIONS.iter().flat_map(|&direction| [0.3, 1.0].map(|share| pair(direction, share))).collect()
}

/// Darkens hollows and draws outlines; a pixel has `factor` × `factor` samples.
pub(super) fn shade(canvas: &mut Canvas, factor: usize) {
    let Canvas { width, height, ref depth, .. } = *canvas;
    let size = width.min(height) as f64;
    let reach = REACH * size;
    let at = |column: isize, row: isize| -> f64 {
        let inside = column >= 0 && row >= 0 && column < width as isize && row < height as isize;
        if inside { depth[row as usize * width + column as usize] } else { f64::INFINITY }
    };
    let pairs = hollow_pairs(reach);
    // On a plane, what one side is nearer the other is farther: only hollows count.
    let hollow = |column: isize, row: isize, own: f64| -> f64 {
        let feel = |&Pair { one: [x, y], other: [u, v], limit }: &Pair| {
            let nearer = |depth: f64| (own - depth).clamp(-limit, limit);
            ((nearer(at(column + x, row + y)) + nearer(at(column + u, row + v))) / limit).max(0.0)
        };
        pairs.iter().map(feel).sum::<f64>() / pairs.len() as f64
    };
    let outline = |column: isize, row: isize, own: f64| -> bool {
        let steps = [(1, 0), (-1, 0), (0, 1), (0, -1)];
        // The slope is taken out: a steep face is not an edge.
        steps.iter().any(|(x, y)| {
            let (next, before) = (at(column + x, row + y), at(column - x, row - y));
            next - own > STEP * size + 4.0 * (own - before).abs().min(size)
        })
    };
    // Hollows are smooth: they are felt once per pixel, for all its samples.
    canvas.colour.par_chunks_mut(factor * width).enumerate().for_each(|(pixel_row, colours)| {
        for first in (0..width).step_by(factor) {
            let samples = || (0..factor).flat_map(|dy| (first..first + factor).map(move |column| (dy, column)));
            let nearest = samples()
                .map(|(dy, column)| depth[(pixel_row * factor + dy) * width + column])
                .fold(f64::INFINITY, f64::min);
            if nearest.is_infinite() {
                continue;
            }
            let middle = [first + factor / 2, pixel_row * factor + factor / 2].map(|place| place as isize);
            let shadow = 1.0 - 0.6 * hollow(middle[0], middle[1], nearest).min(1.0);
            for (dy, column) in samples() {
                let row = pixel_row * factor + dy;
                let own = depth[row * width + column];
                if own.is_finite() {
                    let dark = if outline(column as isize, row as isize, own) { 0.45 * shadow } else { shadow };
                    let colour = &mut colours[dy * width + column];
                    *colour = colour.map(|channel| (f64::from(channel) * dark) as u8);
                }
            }
        }
    });
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
