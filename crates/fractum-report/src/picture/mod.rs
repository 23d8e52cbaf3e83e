//! Pictures of bodies and particles, drawn without window, graphics card or other tools.
//!
//! A parallel view of triangle surfaces, flat-shaded and coloured by a field, and of spheres. The same numbers give the
//! same bytes on any machine and any number of threads. Text is left to the page around the picture: the colour bar and
//! title are drawn by [`crate::report`].
//!
//! Left out: perspective, transparency, and filling of cuts (a [`Clip`] shows the inside of a hollow surface; give the
//! surface of the elements that are kept to see a solid cut).
//!
//! ```
//! use fractum_report::picture::{Paint, Picture, Surface, View};
//! let triangle = Surface {
//!     points: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
//!     triangles: &[[0, 1, 2]],
//!     paint: Paint::Nodes(&[0.0, 0.5, 1.0]),
//!     mesh_lines: true,
//! };
//! let picture = Picture { surfaces: &[triangle], ..Picture::default() };
//! let image = picture.render(&View { direction: [0.0, 0.0, -1.0], ..View::default() })?;
//! assert!(image.to_png()?.starts_with(b"\x89PNG"));
//! # Ok::<(), fractum_report::picture::PictureError>(())
//! ```

mod animation;
mod camera;
mod colour;
mod raster;
mod shade;
mod shares;

pub use animation::animation;
pub use colour::{ColourMap, Rgb};

/// Samples per pixel and direction.
const SUPERSAMPLING: usize = 2;
/// Largest picture in pixels per direction.
const LARGEST: usize = 8192;

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// No pixel, or too many.
    #[error("a picture of {width} by {height} pixels; expected 1 to {LARGEST} each")]
    Size {
        /// Asked for.
        width: usize,
        /// Asked for.
        height: usize,
    },
    /// The view has no direction.
    #[error("the view has no direction: {direction:?}")]
    NoDirection {
        /// Asked for.
        direction: [f64; 3],
    },
    /// An array has another length than what it describes.
    #[error("{what} has {found} values; expected {expected}")]
    WrongLength {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What it should be.
        expected: usize,
    },
    /// A triangle names a point that does not exist.
    #[error("a triangle names point {point}; there are {points}")]
    NoSuchPoint {
        /// The point named.
        point: u32,
        /// How many there are.
        points: usize,
    },
    /// The picture could not be stored as PNG.
    #[error("the picture cannot be stored as PNG: {0}")]
    Encoding(#[from] png::EncodingError),
}

/// What colour things have.
#[derive(Clone, Copy, Debug)]
pub enum Paint<'a> {
    /// All the same.
    Plain(Rgb),
    /// By a value at each point (or sphere), linear in between.
    Nodes(&'a [f64]),
    /// By a value on each triangle.
    Facets(&'a [f64]),
}

/// Triangles, drawn from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Positions, deformed as they are to be seen [m]. Points that are not finite hide their triangles.
    pub points: &'a [[f64; 3]],
    /// Corners; outward counter-clockwise, so that the inside can be drawn darker.
    pub triangles: &'a [[u32; 3]],
    /// Their colour.
    pub paint: Paint<'a>,
    /// Whether the edges of the triangles are drawn, where they are not too dense.
    pub mesh_lines: bool,
}

/// Spheres; in a plane problem they show as discs.
#[derive(Clone, Copy, Debug)]
pub struct Spheres<'a> {
    /// Centres [m].
    pub centres: &'a [[f64; 3]],
    /// Radii [m]; one per centre.
    pub radii: &'a [f64],
    /// Their colour: [`Paint::Plain`] or, one value per sphere, [`Paint::Nodes`].
    pub paint: Paint<'a>,
}

/// Takes away what lies on the side of the plane that `normal` points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// A point of the plane [m].
    pub point: [f64; 3],
    /// Its normal, of any length.
    pub normal: [f64; 3],
}

/// What is to be seen.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Bodies.
    pub surfaces: &'a [Surface<'a>],
    /// Particles.
    pub spheres: &'a [Spheres<'a>],
    /// Colours of the values.
    pub map: ColourMap,
    /// Values at the ends of the map; see [`range`].
    pub range: (f64, f64),
    /// What to cut away.
    pub clip: Option<Clip>,
}

impl Default for Picture<'_> {
    fn default() -> Self {
        Self { surfaces: &[], spheres: &[], map: ColourMap::Viridis, range: (0.0, 1.0), clip: None }
    }
}

/// How it is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the camera looks, of any length.
    pub direction: [f64; 3],
    /// What is up in the picture; any other up is taken if this one is along the direction.
    pub up: [f64; 3],
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Lowest and highest corner of the box to be in the picture [m]; without it, all that is drawn. A series of
    /// pictures, or debris that flies far, wants a fixed one.
    pub frame: Option<([f64; 3], [f64; 3])>,
}

impl Default for View {
    /// From the front, right and above; z is up.
    fn default() -> Self {
        Self { direction: [-0.5, 1.0, -0.4], up: [0.0, 0.0, 1.0], width: 960, height: 720, frame: None }
    }
}

/// Smallest and largest finite value; `(0, 1)` if there is none, and never empty.
pub fn range(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    match (low.is_finite(), low < high) {
        (false, _) => (0.0, 1.0),
        (true, true) => (low, high),
        (true, false) => (low, low + low.abs().max(1.0)),
    }
}

/// The range of all but the lowest and the highest hundredth of the finite values, so that a few odd ones do not rule
/// the colours.
pub fn robust_range(values: &[f64]) -> (f64, f64) {
    let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    finite.sort_unstable_by(f64::total_cmp);
    let odd = finite.len() / 100;
    range(&finite[odd..finite.len() - odd])
}

/// How large a picture shows things, and which way the axes point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scale {
    /// Pixels of a metre across the view.
    pub pixels_per_metre: f64,
    /// Where the axes x, y, z point: right and down, of length one where they lie across the view.
    pub axes: [[f64; 2]; 3],
}

impl Picture<'_> {
    /// The scale in which a view shows the picture; none without a direction.
    pub fn scale(&self, view: &View) -> Option<Scale> {
        let camera = camera::Camera::new(view, self)?;
        Some(Scale { pixels_per_metre: camera.scale / SUPERSAMPLING as f64, axes: camera.axes() })
    }

    /// Draws the picture on white.
    ///
    /// # Errors
    /// [`PictureError`] for a size or direction that makes no picture, and arrays that do not fit together.
    pub fn render(&self, view: &View) -> Result<Image, PictureError> {
        let View { width, height, direction, .. } = *view;
        if !(1..=LARGEST).contains(&width) || !(1..=LARGEST).contains(&height) {
            return Err(PictureError::Size { width, height });
        }
        self.check()?;
        let camera = camera::Camera::new(view, self).ok_or(PictureError::NoDirection { direction })?;
        let rgb = self.drawn(&camera, [width, height]);
        Ok(Image { width, height, rgb: rgb.unwrap_or_else(|| vec![255; 3 * width * height]) })
    }

    /// The pixels; none where nothing is in the picture.
    fn drawn(&self, camera: &camera::Camera, size: [usize; 2]) -> Option<Vec<u8>> {
        let (facets, balls) = (raster::facets(self, camera), raster::balls(self, camera));
        let shown = raster::Shown::of(&facets, &balls, size)?;
        let [top, bottom] = shown.rows;
        let bands = (bottom - top).div_ceil(shade::BAND);
        let drawing = shade::Drawing {
            picture: self,
            facets: raster::Bands::new(facets, top, shade::BAND, bands),
            balls: raster::Bands::new(balls, top, shade::BAND, bands),
            shown,
            scale: camera.scale,
        };
        Some(drawing.rgb(size))
    }

    fn check(&self) -> Result<(), PictureError> {
        let length = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(PictureError::WrongLength { what, found, expected }) }
        };
        for Surface { points, triangles, paint, .. } in self.surfaces {
            match paint {
                Paint::Plain(_) => {}
                Paint::Nodes(values) => length("colour of a surface's points", values.len(), points.len())?,
                Paint::Facets(values) => length("colour of a surface's triangles", values.len(), triangles.len())?,
            }
            if let Some(&point) = triangles.as_flattened().iter().find(|&&point| point as usize >= points.len()) {
                return Err(PictureError::NoSuchPoint { point, points: points.len() });
            }
        }
        for Spheres { centres, radii, paint } in self.spheres {
            length("radius of spheres", radii.len(), centres.len())?;
            match paint {
                Paint::Plain(_) => {}
                Paint::Nodes(values) | Paint::Facets(values) => {
                    length("colour of spheres", values.len(), centres.len())?;
                }
            }
        }
        Ok(())
    }
}

/// A finished picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Red, green, blue of each pixel, row by row from the top.
    pub rgb: Vec<u8>,
}

impl Image {
    /// The picture as a PNG file.
    ///
    /// # Errors
    /// [`PictureError::Encoding`] if `rgb` does not hold `width` by `height` pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, PictureError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRONT: View = View { direction: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], width: 60, height: 40, frame: None };
    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 2.0, 0.0], [0.0, 2.0, 0.0]];

    fn square(paint: Paint) -> Surface {
        Surface { points: &SQUARE, triangles: &[[0, 1, 2], [0, 2, 3]], paint, mesh_lines: false }
    }

    fn pixel(image: &Image, column: usize, row: usize) -> [u8; 3] {
        let at = 3 * (row * image.width + column);
        [image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]]
    }

    /// Red share of a pixel: independent of its shading.
    fn redness([r, g, b]: [u8; 3]) -> f64 {
        f64::from(r) / (f64::from(r) + f64::from(g) + f64::from(b))
    }

    #[test]
    fn the_body_fills_the_frame_on_white() {
        let surfaces = [square(Paint::Plain([200, 0, 0]))];
        let image = Picture { surfaces: &surfaces, ..Picture::default() }.render(&FRONT).unwrap();
        assert_eq!(pixel(&image, 0, 0), [255, 255, 255]);
        assert_eq!(pixel(&image, 59, 39), [255, 255, 255]);
        for (column, row) in [(30, 20), (5, 20), (54, 20), (30, 4), (30, 35)] {
            assert!(redness(pixel(&image, column, row)) > 0.99, "{column} {row}");
        }
    }

    #[test]
    fn up_is_up_and_left_is_left() {
        // Redder to the top, then redder to the right.
        for (values, redder, paler) in
            [([0.0, 0.0, 1.0, 1.0], (30, 6), (30, 33)), ([0.0, 1.0, 1.0, 0.0], (50, 20), (10, 20))]
        {
            let surfaces = [square(Paint::Nodes(&values))];
            let picture = Picture { surfaces: &surfaces, map: ColourMap::Damage, ..Picture::default() };
            let image = picture.render(&FRONT).unwrap();
            let at = |(column, row)| redness(pixel(&image, column, row));
            assert!(at(redder) > at(paler) + 0.2);
        }
    }

    #[test]
    fn what_is_nearer_hides_what_is_behind_in_any_order() {
        let near = SQUARE.map(|[x, y, _]| [x, y, 1.0]);
        let red = square(Paint::Plain([200, 0, 0]));
        let blue = Surface { points: &near, ..square(Paint::Plain([0, 0, 200])) };
        for surfaces in [[red, blue], [blue, red]] {
            let image = Picture { surfaces: &surfaces, ..Picture::default() }.render(&FRONT).unwrap();
            assert_eq!(redness(pixel(&image, 30, 20)), 0.0);
        }
    }

    #[test]
    fn a_sphere_is_round_and_comes_before_the_surface_it_sticks_out_of() {
        let surfaces = [square(Paint::Plain([0, 0, 200]))];
        let spheres = [Spheres { centres: &[[1.5, 1.0, 0.0]], radii: &[0.5], paint: Paint::Plain([200, 0, 0]) }];
        let picture = Picture { surfaces: &surfaces, spheres: &spheres, ..Picture::default() };
        let image = picture.render(&FRONT).unwrap();
        // 60 pixels less the margin for 3 m: the radius is some 9 pixels.
        assert!(redness(pixel(&image, 30, 20)) > 0.99 && redness(pixel(&image, 36, 20)) > 0.99);
        assert!(redness(pixel(&image, 37, 13)) < 0.01 && redness(pixel(&image, 41, 20)) < 0.01);
        // Seen from the side, the frame of a sphere alone is its own size.
        let alone = Picture { surfaces: &[], ..picture }.render(&FRONT).unwrap();
        assert!(redness(pixel(&alone, 30, 4)) > 0.99 && redness(pixel(&alone, 30, 35)) > 0.99);
    }

    #[test]
    fn a_clip_takes_away_one_side() {
        let surfaces = [square(Paint::Plain([200, 0, 0]))];
        let clip = Some(Clip { point: [1.5, 0.0, 0.0], normal: [1.0, 0.0, 0.0] });
        let image = Picture { surfaces: &surfaces, clip, ..Picture::default() }.render(&FRONT).unwrap();
        assert!(redness(pixel(&image, 20, 20)) > 0.99);
        assert_eq!(pixel(&image, 40, 20), [255, 255, 255]);
    }

    #[test]
    fn triangles_of_any_shape_cover_what_lies_inside_them() {
        // Slivers too, and such that reach out of the picture.
        let number = |k: usize| (0.6 + 12.9898 * k as f64).sin() * 43_758.545_3 % 1.0;
        let view = View { frame: Some(([0.0; 3], [3.0, 2.0, 0.0])), ..FRONT };
        let pixels = Picture::default().scale(&view).unwrap().pixels_per_metre;
        for trial in 0..400 {
            let thin = if trial % 2 == 0 { 1.0 } else { 1e-3 };
            let corner = |k: usize| [1.5 + 3.0 * number(6 * trial + k), 1.0 + 3.0 * number(6 * trial + k + 1), 0.0];
            let [a, b] = [corner(0), corner(2)];
            let points = [a, b, [a[0] + thin * number(6 * trial + 4), a[1] + thin * number(6 * trial + 5), 0.0]];
            let surface = Surface { points: &points, triangles: &[[0, 1, 2]], ..square(Paint::Plain([90, 0, 0])) };
            let image = Picture { surfaces: &[surface], ..Picture::default() }.render(&view).unwrap();
            let side = |p: [f64; 3], q: [f64; 3], x: [f64; 2]| {
                let cross = (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
                pixels * cross / (q[0] - p[0]).hypot(q[1] - p[1])
            };
            for (column, row) in (0..60).flat_map(|column| (0..40).map(move |row| (column, row))) {
                let x = [1.5 + (column as f64 - 29.5) / pixels, 1.0 + (19.5 - row as f64) / pixels];
                let sides = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| side(points[i], points[j], x));
                let depth = if sides[0] + sides[1] + sides[2] < 0.0 { sides.map(|d| -d) } else { sides };
                let depth = depth.into_iter().fold(f64::INFINITY, f64::min);
                let shown = pixel(&image, column, row) != [255; 3];
                assert!(depth.abs() < 0.8 || shown == (depth > 0.0), "{trial}: {column} {row}, {depth} inside");
            }
        }
    }

    #[test]
    fn points_that_are_not_finite_hide_their_triangles_only() {
        let mut points = SQUARE;
        points[1][0] = f64::NAN;
        let surfaces = [Surface { points: &points, ..square(Paint::Plain([200, 0, 0])) }];
        let image = Picture { surfaces: &surfaces, ..Picture::default() }.render(&FRONT).unwrap();
        assert_eq!(pixel(&image, 40, 33), [255, 255, 255]);
        assert!(redness(pixel(&image, 20, 8)) > 0.99);
    }

    #[test]
    fn nothing_to_see_is_a_white_picture() {
        for view in [FRONT, View { frame: Some(([0.0; 3], [0.0; 3])), ..FRONT }, View { up: [0.0, 0.0, 2.0], ..FRONT }]
        {
            let image = Picture::default().render(&view).unwrap();
            assert!(image.rgb.iter().all(|&channel| channel == 255));
        }
    }

    #[test]
    fn bytes_are_the_same_for_any_number_of_threads() {
        let centres: Vec<[f64; 3]> =
            (0..500).map(|i| [(i as f64 * 0.7).sin(), (i as f64 * 1.3).cos(), (i as f64 * 0.1).sin()]).collect();
        let spheres = [Spheres { centres: &centres, radii: &vec![0.05; 500], paint: Paint::Plain([80, 90, 100]) }];
        let surfaces = [Surface { mesh_lines: true, ..square(Paint::Plain([200, 0, 0])) }];
        let picture = Picture { surfaces: &surfaces, spheres: &spheres, ..Picture::default() };
        let png = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| picture.render(&View::default()).unwrap().to_png().unwrap())
        };
        assert!(png(1) == png(3));
    }

    #[test]
    fn what_makes_no_picture_is_refused() {
        let picture = Picture::default();
        let error = |view: View| picture.render(&view).unwrap_err();
        assert!(matches!(error(View { width: 0, ..FRONT }), PictureError::Size { .. }));
        assert!(matches!(error(View { height: LARGEST + 1, ..FRONT }), PictureError::Size { .. }));
        assert!(matches!(error(View { direction: [0.0; 3], ..FRONT }), PictureError::NoDirection { .. }));
        assert!(matches!(error(View { direction: [f64::NAN; 3], ..FRONT }), PictureError::NoDirection { .. }));
        let surfaces = [square(Paint::Nodes(&[1.0]))];
        let wrong = Picture { surfaces: &surfaces, ..picture }.render(&FRONT).unwrap_err();
        assert!(matches!(wrong, PictureError::WrongLength { found: 1, expected: 4, .. }));
        let surfaces = [Surface { triangles: &[[0, 1, 4]], ..square(Paint::Plain([0; 3])) }];
        let wrong = Picture { surfaces: &surfaces, ..picture }.render(&FRONT).unwrap_err();
        assert!(matches!(wrong, PictureError::NoSuchPoint { point: 4, points: 4 }));
    }

    #[test]
    fn one_odd_value_does_not_rule_the_colours() {
        let mut values: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
        values.push(1e9);
        let (low, high) = robust_range(&values);
        assert!(low < 0.02 && high > 0.98 && high <= 1.0, "{low} {high}");
        assert_eq!((robust_range(&[]), robust_range(&[3.0])), ((0.0, 1.0), (3.0, 6.0)));
    }

    #[test]
    fn the_scale_is_that_of_the_picture() {
        let surfaces = [square(Paint::Plain([200, 0, 0]))];
        let scale = Picture { surfaces: &surfaces, ..Picture::default() }.scale(&FRONT).unwrap();
        // 40 pixels less the border of 1.2 on both sides for 2 m.
        assert!((scale.pixels_per_metre - (40.0 - 2.4) / 2.0).abs() < 1e-9, "{scale:?}");
        let [x, y, z] = scale.axes;
        assert!(x[0] > 0.999 && y[1] < -0.999 && z[0].abs() + z[1].abs() < 1e-9, "{scale:?}");
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(range(&[2.0, f64::NAN, -1.0, f64::INFINITY]), (-1.0, 2.0));
        assert_eq!(range(&[]), (0.0, 1.0));
        assert_eq!(range(&[f64::NAN]), (0.0, 1.0));
        assert_eq!(range(&[5.0, 5.0]), (5.0, 10.0));
    }
}
