//! Samples to pixels, and what the depths tell the eye: darker hollows, and a line where one thing ends before another.

use fractum_math::widest;
use rayon::prelude::*;

use super::raster::{Ball, Bands, Facet, Samples, Shown};
use super::{Picture, SUPERSAMPLING};

/// Reach of a hollow's shadow, as a share of the picture's smaller side.
const REACH: f64 = 0.035;
/// Step in depth that makes an outline, as a share of the picture's smaller side.
const STEP: f64 = 0.012;
/// Rows of pixels drawn together by one thread: few enough that their samples stay in its cache.
pub(super) const BAND: usize = 16;
/// Share of the picture's smaller side within which all depths are those of a plane seen straight on.
const FLAT: f64 = 1e-6;

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
/// - `reach`: of the farther ones [pixels]
fn hollow_pairs(reach: f64) -> Vec<Pair> {
    let pair = |[x, y]: [f64; 2], share: f64| {
        let place = |sign: f64| [x, y].map(|along| (sign * share * reach * along).round() as isize);
        Pair { one: place(1.0), other: place(-1.0), limit: (share * reach * SUPERSAMPLING as f64) as f32 }
    };
    DIRECTIONS.iter().flat_map(|&direction| [0.3, 1.0].map(|share| pair(direction, share))).collect()
}

/// Sums of the colours of the samples of a pixel that something is in, and the number of these samples.
type Sum = [u16; 4];

/// What is drawn, pixel by pixel.
pub(super) struct Drawing<'a> {
    pub(super) picture: &'a Picture<'a>,
    pub(super) facets: Bands<Facet>,
    pub(super) balls: Bands<Ball>,
    pub(super) shown: Shown,
    /// Samples of a metre.
    pub(super) scale: f64,
}

impl Drawing<'_> {
    /// Red, green, blue of each pixel of a picture of `width` by `height` pixels.
    pub(super) fn rgb(&self, [width, height]: [usize; 2]) -> Vec<u8> {
        let smaller = (width.min(height) * SUPERSAMPLING) as f64;
        let Shown { columns: [left, right], rows: [top, bottom], depths: [nearest, farthest] } = self.shown;
        let is_flat = farthest - nearest < FLAT * smaller;
        let reach = REACH * smaller / SUPERSAMPLING as f64;
        let (count, rows, margin) = (right - left, bottom - top, if is_flat { 0 } else { reach.ceil() as usize + 1 });
        let mut depths = Depths::new(count, rows, margin);
        let mut sums: Vec<Sum> = vec![[0; 4]; count * rows];
        let bands = sums.par_chunks_mut(BAND * count).zip(depths.bands()).enumerate();
        bands.for_each_init(Samples::default, |samples, (band, (sums, mut depths))| {
            draw_band(self, samples, band, sums, &mut depths, smaller);
        });
        let pairs = if is_flat { Vec::new() } else { hollow_pairs(reach) };
        let mut rgb = vec![255; 3 * width * height];
        let pixels = rgb.par_chunks_mut(3 * width).skip(top).zip(sums.par_chunks(count)).enumerate();
        pixels.for_each_init(Vec::new, |hollow, (row, (pixels, sums))| {
            hollow.resize(count, 0.0);
            colour_row(&depths, &pairs, row, hollow, sums, &mut pixels[3 * left..3 * right]);
        });
        rgb
    }

    /// Draws a band of rows: the sums of its pixels and their depths.
    ///
    /// - `smaller`: samples along the picture's smaller side
    #[inline(always)]
    fn band(&self, samples: &mut Samples, band: usize, sums: &mut [Sum], depths: &mut Rows, smaller: f64) {
        let Shown { columns: [left, right], rows: [top, _], depths: [nearest, _] } = self.shown;
        let (count, rows) = (right - left, sums.len() / (right - left));
        let first = [left, top + band * BAND].map(|pixel| (pixel * SUPERSAMPLING) as isize);
        // A row more above and below, for the outlines.
        samples.clear([first[0], first[1] - 1], count * SUPERSAMPLING, rows * SUPERSAMPLING + 2);
        // Closures would be compiled for any processor.
        for facet in self.facets.of(band) {
            samples.facet(facet, self.picture);
        }
        for ball in self.balls.of(band) {
            samples.ball(ball, self.picture.clip, self.scale);
        }
        darken_outlines(samples, STEP * smaller, smaller);
        depths.take(samples, nearest);
        reduce(samples, sums, count);
    }
}

widest! {
    fn draw_band(
        drawing: &Drawing,
        samples: &mut Samples,
        band: usize,
        sums: &mut [Sum],
        depths: &mut Rows,
        smaller: f64,
    ) = Drawing::band;
}

widest! {
    fn colour_row(
        depths: &Depths,
        pairs: &[Pair],
        row: usize,
        hollow: &mut [f32],
        sums: &[Sum],
        pixels: &mut [u8],
    ) = Depths::colour;
}

/// Colour of a pixel: what is there in its shadow, before white.
#[inline(always)]
fn mix(pixel: &mut [u8], [red, green, blue, count]: Sum, shadow: f32) {
    const SAMPLES: f32 = (SUPERSAMPLING * SUPERSAMPLING) as f32;
    if count == 0 {
        return;
    }
    let white = 255.0 * (SAMPLES - f32::from(count));
    for (channel, sum) in pixel.iter_mut().zip([red, green, blue]) {
        // To the nearest: what rounding makes of a flat face must not show as a pattern.
        *channel = ((shadow * f32::from(sum) + white) / SAMPLES + 0.5) as u8;
    }
}

/// Adds up the samples of each pixel.
#[inline(always)]
fn reduce(samples: &Samples, sums: &mut [Sum], columns: usize) {
    for (row, sums) in sums.chunks_exact_mut(columns).enumerate() {
        for sample_row in 0..SUPERSAMPLING {
            let start = (1 + row * SUPERSAMPLING + sample_row) * samples.stride + 1;
            let of_row = &samples.colour[start..start + columns * SUPERSAMPLING];
            for (sum, colours) in sums.iter_mut().zip(of_row.chunks_exact(SUPERSAMPLING)) {
                for colour in colours {
                    sum.iter_mut().zip(colour).for_each(|(sum, &added)| *sum += u16::from(added));
                }
            }
        }
    }
}

/// Darkens the samples at which one thing ends before another one that is farther by more than `step`.
///
/// - `size`: slopes beyond it do not count
#[inline(always)]
fn darken_outlines(samples: &mut Samples, step: f64, size: f64) {
    let Samples { stride, colour, depth, .. } = samples;
    let stride = *stride;
    // The slope is taken out: a steep face is not an edge.
    let ends = |own: f64, next: f64, before: f64| next - own > step + 4.0 * (own - before).abs().min(size);
    for row in 1..depth.len() / stride - 1 {
        let start = row * stride + 1;
        let range = |shift: isize| start.wrapping_add_signed(shift)..(start + stride - 2).wrapping_add_signed(shift);
        let along = stride as isize;
        let [own, left, right, above, below] = [0, -1, 1, -along, along].map(|shift| &depth[range(shift)]);
        for (index, colour) in colour[range(0)].iter_mut().enumerate() {
            let own = own[index];
            let [left, right, above, below] = [left[index], right[index], above[index], below[index]];
            let farthest = left.max(right).max(above).max(below);
            // Most samples lie among others of one face.
            if farthest - own > step
                && (ends(own, right, left)
                    || ends(own, left, right)
                    || ends(own, below, above)
                    || ends(own, above, below))
            {
                let [red, green, blue, is_there] = *colour;
                let [red, green, blue] = [red, green, blue].map(|channel| (OUTLINE * f32::from(channel) + 0.5) as u8);
                *colour = [red, green, blue, is_there];
            }
        }
    }
}

/// Brightness of an outline.
const OUTLINE: f32 = 0.45;

/// Depth of the nearest sample of every pixel, within a margin that nothing is in.
struct Depths {
    columns: usize,
    rows: usize,
    /// Pixels of a row, with the margins.
    stride: usize,
    margin: usize,
    /// From the nearest of all [samples], so that single precision is enough wherever the body is.
    depth: Vec<f32>,
}

/// Some rows of these.
struct Rows<'a> {
    columns: usize,
    stride: usize,
    margin: usize,
    depth: &'a mut [f32],
}

impl Depths {
    fn new(columns: usize, rows: usize, margin: usize) -> Self {
        let stride = columns + 2 * margin;
        Depths { columns, rows, stride, margin, depth: vec![f32::INFINITY; stride * (rows + 2 * margin)] }
    }

    /// Band by band.
    fn bands(&mut self) -> impl IndexedParallelIterator<Item = Rows<'_>> {
        let Depths { columns, rows, stride, margin, .. } = *self;
        let inner = &mut self.depth[margin * stride..(margin + rows) * stride];
        inner.par_chunks_mut(BAND * stride).map(move |depth| Rows { columns, stride, margin, depth })
    }

    /// Depths of the pixels of a row, seen from `shift` columns and rows away.
    fn row(&self, row: usize, [x, y]: [isize; 2]) -> &[f32] {
        let start = (self.margin + row).wrapping_add_signed(y) * self.stride;
        let start = (start + self.margin).wrapping_add_signed(x);
        &self.depth[start..start + self.columns]
    }

    /// Colours the pixels of a row.
    ///
    /// - `hollow`: overwritten
    #[inline(always)]
    fn colour(&self, pairs: &[Pair], row: usize, hollow: &mut [f32], sums: &[Sum], pixels: &mut [u8]) {
        self.feel(pairs, row, hollow);
        for ((pixel, sum), hollow) in pixels.chunks_exact_mut(3).zip(sums).zip(hollow.iter()) {
            mix(pixel, *sum, 1.0 - 0.6 * hollow.min(1.0));
        }
    }

    /// Darkness of the pixels of a row by the hollows that they lie in, 0 to 1.
    #[inline(always)]
    fn feel(&self, pairs: &[Pair], row: usize, hollow: &mut [f32]) {
        hollow.fill(0.0);
        if pairs.is_empty() {
            return;
        }
        let own = self.row(row, [0, 0]);
        for &Pair { one, other, limit } in pairs {
            let [one, other] = [one, other].map(|shift| self.row(row, shift));
            let weight = 1.0 / (limit * pairs.len() as f32);
            for (((hollow, own), one), other) in hollow.iter_mut().zip(own).zip(one).zip(other) {
                // On a plane, what one side is nearer the other is farther: only hollows count.
                let nearer = |depth: f32| (own - depth).max(-limit).min(limit);
                *hollow += (weight * (nearer(*one) + nearer(*other))).max(0.0);
            }
        }
    }
}

impl Rows<'_> {
    /// Takes the depths of samples over.
    ///
    /// - `nearest`: of the whole picture
    #[inline(always)]
    fn take(&mut self, samples: &Samples, nearest: f64) {
        for (row, pixels) in self.depth.chunks_exact_mut(self.stride).enumerate() {
            let pixels = &mut pixels[self.margin..self.margin + self.columns];
            for sample_row in 0..SUPERSAMPLING {
                let start = (1 + row * SUPERSAMPLING + sample_row) * samples.stride + 1;
                let of_row = samples.depth[start..start + samples.stride - 2].chunks_exact(SUPERSAMPLING);
                for (pixel, depths) in pixels.iter_mut().zip(of_row) {
                    let first = depths.iter().copied().fold(f64::INFINITY, f64::min);
                    *pixel = pixel.min((first - nearest) as f32);
                }
            }
        }
    }
}
