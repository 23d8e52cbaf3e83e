//! The frames of a results folder as pictures: movies, and the strip of the report.

use std::path::{Path, PathBuf};

use fractum_math::Vec3;
use fractum_math::elementary::sin;
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_output::frames::{Population, Triangles, corners, read_arrays, read_collection};
use fractum_output::{ReadError, atomic};
use fractum_vtk::{Arrays, Collection};

use crate::error::ReportError;
use crate::picture::{ColourMap, Image, View, animation, robust_range};
use crate::sight::{Balls, Colours, LOST_BONDS, Sight, magnification, shown_radius, view_of};

/// What the colours of frames stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    Damage,
    Stress,
    Temperature,
    BrokenBonds,
    Displacement,
}

impl Shown {
    /// The array with the values of a population; none where they are lengths of displacements, or it is grey.
    fn array(self, population: Population) -> Option<&'static str> {
        match (population, self) {
            (Population::Solid, Shown::Damage) => Some("damage"),
            (Population::Solid | Population::Bonded | Population::Loose, Shown::Temperature) => Some("temperature"),
            (Population::Solid, _) => Some("first_principal_stress"),
            (Population::Bonded, Shown::BrokenBonds) => Some("broken_bonds"),
            _ => None,
        }
    }
}

/// The frames of a run: the files that pictures show, instant by instant.
pub(crate) struct FrameIndex(Vec<Vec<(Population, PathBuf)>>);

impl FrameIndex {
    /// Reads the index of a results folder.
    ///
    /// # Errors
    /// [`ReportError::Input`] for a folder without frames.
    pub(crate) fn open(folder: &Path) -> Result<Self, ReportError> {
        let collection = read_collection(&folder.join("fields.pvd")).map_err(|error| refused(&error))?;
        let instants = instants(folder, &collection);
        if instants.is_empty() {
            return Err(ReportError::Input(format!("{}: no frames; set output.fields of the case", folder.display())));
        }
        Ok(FrameIndex(instants))
    }

    /// Number of instants.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Simulated time of an instant [s], which its place in the index need not be: that may be a step.
    pub(crate) fn time(&self, index: usize) -> f64 {
        let read = |(_, path): &(Population, PathBuf)| {
            read_arrays(path, &["TimeValue"]).ok()?.get("TimeValue").first().copied()
        };
        self.0[index].iter().find_map(read).unwrap_or(f64::NAN)
    }

    /// What shows most in the last frame.
    fn shown(&self) -> Result<Shown, ReportError> {
        let mut shown = Shown::Displacement;
        for (population, path) in self.0.last().into_iter().flatten() {
            let some = |field: &str| -> Result<bool, ReportError> {
                Ok(read(path, &[field])?.get(field).iter().any(|&value| value > 0.0))
            };
            match population {
                Population::Solid if some("damage")? => return Ok(Shown::Damage),
                Population::Solid if some("temperature")? => return Ok(Shown::Temperature),
                Population::Solid => return Ok(Shown::Stress),
                Population::Bonded if some("broken_bonds")? => shown = Shown::BrokenBonds,
                _ if shown == Shown::Displacement && some("temperature")? => shown = Shown::Temperature,
                _ => {}
            }
        }
        Ok(shown)
    }
}

/// Frames with one view and one range of colours for all of them.
pub(crate) struct Frames {
    index: FrameIndex,
    shown: Shown,
    /// Values at the ends of the colours.
    pub(crate) range: (f64, f64),
    /// How much larger displacements are drawn than they are.
    pub(crate) scale: f64,
    pub(crate) view: View,
}

fn refused(error: &ReadError) -> ReportError {
    ReportError::Input(format!("{error}; name the results folder of a run"))
}

fn read(path: &Path, wanted: &[&str]) -> Result<Arrays, ReportError> {
    read_arrays(path, wanted).map_err(|error| refused(&error))
}

fn lengths(vectors: &[[f64; 3]]) -> impl Iterator<Item = f64> + '_ {
    vectors.iter().map(|u| Vec3::from(*u).norm())
}

impl Frames {
    /// Looks through the frames that are to be drawn, for colours, magnification and view.
    ///
    /// # Errors
    /// [`ReportError::Input`] for damaged frames.
    pub(crate) fn survey(index: FrameIndex, wanted: &[usize]) -> Result<Self, ReportError> {
        let shown = index.shown()?;
        let mut start: Vec<Vec3> = Vec::new();
        for (_, path) in index.0[0].iter().filter(|(population, _)| population.is_body()) {
            start.extend(read(path, &["Points"])?.vectors("Points").into_iter().map(Vec3::from));
        }
        let (mut largest, mut ranges): (f64, Vec<f64>) = (0.0, Vec::new());
        let instants = wanted.iter().map(|&instant| &index.0[instant]);
        for (population, path) in instants.flatten().filter(|(population, _)| population.is_body()) {
            let measured = matches!(shown, Shown::Stress | Shown::Temperature);
            let field = if measured { shown.array(*population) } else { None };
            let arrays = read(path, &["displacement", "attached", field.unwrap_or_default()])?;
            let displacement = arrays.vectors("displacement");
            // Nodes that no element holds may fly far.
            let attached = arrays.get("attached");
            let held = |i: usize| attached.get(i).is_none_or(|&held| held > 0.0);
            let moved = lengths(&displacement).enumerate().filter(|(i, _)| held(*i)).map(|(_, length)| length);
            largest = moved.fold(largest, f64::max);
            let values: Vec<f64> = match (shown, field) {
                (_, Some(field)) => arrays.get(field).to_vec(),
                (Shown::Displacement, None) => lengths(&displacement).collect(),
                _ => Vec::new(),
            };
            if !values.is_empty() {
                let (low, high) = robust_range(&values);
                ranges.extend([low, high]);
            }
        }
        let [low, high] = corners(start.iter());
        let size = high - low;
        // Room for what moves.
        let room = 0.1 * size.norm() + largest.min(0.3 * size.norm());
        let room = room * Vec3::new(1.0, 1.0, if size.z > 0.0 { 1.0 } else { 0.0 });
        Ok(Frames {
            shown,
            range: match shown {
                Shown::Damage => (0.0, 1.0),
                Shown::BrokenBonds => (0.0, LOST_BONDS),
                _ => crate::picture::range(&ranges),
            },
            scale: magnification(size.norm(), largest, Vec::new()),
            view: View { frame: Some(((low - room).into(), (high + room).into())), ..view_of(size) },
            index,
        })
    }

    /// Name and SI unit of what the colours stand for.
    pub(crate) fn label(&self) -> (&'static str, &'static str) {
        match self.shown {
            Shown::Damage => ("damage", "1"),
            Shown::Stress => ("first principal stress", "Pa"),
            Shown::Temperature => ("temperature", "K"),
            Shown::BrokenBonds => ("broken bonds", "1"),
            Shown::Displacement => ("displacement", "m"),
        }
    }

    /// The colour map.
    pub(crate) fn map(&self) -> ColourMap {
        if matches!(self.shown, Shown::Damage | Shown::BrokenBonds) { ColourMap::Damage } else { ColourMap::Viridis }
    }

    /// What is to be seen of an instant, and the values of facets and particles.
    ///
    /// - `swing`: what displacements are multiplied with, beside their magnification
    fn load(&self, instant: usize, swing: f64) -> Result<(Sight, [Vec<f64>; 2]), ReportError> {
        let (mut sight, mut facets, mut balls) = (Sight::default(), Vec::new(), Vec::new());
        for (population, path) in &self.index.0[instant] {
            let field = self.shown.array(*population);
            let of_population: &[&str] = match population {
                Population::Solid => &["connectivity", "offsets"],
                Population::Rigid => &["connectivity", "offsets", "drawn"],
                _ => &["radius", "attached"],
            };
            let wanted = [&["Points", "displacement", field.unwrap_or_default()], of_population].concat();
            let arrays = read(path, &wanted)?;
            let displacement = arrays.vectors("displacement");
            let mut points = arrays.vectors("Points");
            let scale = swing * if population.is_body() { self.scale } else { 1.0 };
            for (x, u) in points.iter_mut().zip(&displacement) {
                (0..3).for_each(|a| x[a] += scale * u[a]);
            }
            match population {
                Population::Solid => {
                    let values = arrays.get(field.unwrap_or_default());
                    (sight.skin, facets) = skin(&arrays, points, values);
                    if self.shown == Shown::Temperature {
                        facets = sight.skin.means(values);
                    }
                }
                Population::Debris => {
                    let attached = arrays.get("attached");
                    let is_attached = |i: usize| attached.get(i).is_some_and(|&held| held > 0.0);
                    let radii = arrays.get("radius").iter().enumerate();
                    let radii = radii.map(|(i, &radius)| shown_radius(radius, is_attached(i))).collect();
                    sight.debris = Balls { centres: points, radii };
                }
                Population::Rigid => {
                    let drawn = arrays.get("drawn");
                    let triangles = arrays.cells::<3>().into_iter().enumerate();
                    let triangles = triangles.filter(|(i, _)| drawn.get(*i).is_none_or(|&drawn| drawn > 0.0));
                    sight.rigid = Triangles { points, triangles: triangles.map(|(_, nodes)| nodes).collect() };
                }
                _ => {
                    let mut values: Vec<f64> = match self.shown {
                        Shown::Displacement => lengths(&displacement).collect(),
                        _ => field.map_or(&[][..], |field| arrays.get(field)).to_vec(),
                    };
                    // Loose particles have no bonds that could break.
                    values.resize(points.len(), 0.0);
                    balls.extend(values);
                    sight.balls.centres.extend(points);
                    sight.balls.radii.extend(arrays.get("radius"));
                }
            }
        }
        Ok((sight, [facets, balls]))
    }

    /// Draws an instant.
    ///
    /// - `swing`: as in a vibration, 1 at its end
    ///
    /// # Errors
    /// [`ReportError::Input`] for a damaged frame or a size of picture that is out of range.
    pub(crate) fn draw(&self, instant: usize, swing: f64, width: usize, height: usize) -> Result<Image, ReportError> {
        let (sight, [mut facets, mut balls]) = self.load(instant, swing)?;
        if facets.len() != sight.skin.triangles.len() {
            facets.clear();
        }
        if matches!(self.shown, Shown::Damage | Shown::Stress) {
            balls.clear();
        }
        let colours = Colours { facets: &facets, balls: &balls, map: self.map(), range: self.range };
        Ok(sight.draw(colours, &View { width, height, ..self.view }, false)?.0)
    }
}

/// The surface of the elements, and the values of its facets.
fn skin(arrays: &Arrays, points: Vec<[f64; 3]>, values: &[f64]) -> (Triangles, Vec<f64>) {
    let tetrahedra = arrays.cells::<4>();
    if tetrahedra.is_empty() {
        return (Triangles { points, triangles: arrays.cells::<3>() }, values.to_vec());
    }
    let facets = boundary_of_tetrahedra(&tetrahedra);
    let of = |element: u32| values.get(element as usize).copied().unwrap_or(0.0);
    let values = facets.iter().map(|facet| of(facet.element)).collect();
    (Triangles { points, triangles: facets.into_iter().map(|facet| facet.nodes).collect() }, values)
}

/// Files that pictures show, by instants: those of one time that follow each other.
fn instants(folder: &Path, collection: &Collection) -> Vec<Vec<(Population, PathBuf)>> {
    let mut instants: Vec<(f64, Vec<(Population, PathBuf)>)> = Vec::new();
    for entry in &collection.entries {
        let Some(population) = Population::named(&entry.name).filter(|population| population.is_drawn()) else {
            continue;
        };
        let file = (population, folder.join(&entry.file));
        match instants.last_mut() {
            Some((time, files)) if *time == entry.time && files.iter().all(|(known, _)| *known != population) => {
                files.push(file);
            }
            _ => instants.push((entry.time, vec![file])),
        }
    }
    instants.into_iter().map(|(_, files)| files).collect()
}

/// How a movie is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MovieSettings {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Frames per second.
    pub rate: u16,
    /// Number of a natural vibration, which swings; none shows all frames.
    pub mode: Option<usize>,
}

impl Default for MovieSettings {
    /// All frames, ten a second.
    fn default() -> Self {
        MovieSettings { width: 800, height: 680, rate: 10, mode: None }
    }
}

/// Pictures of one swing of a natural vibration.
const SWING: usize = 24;

/// What a movie shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Movie {
    /// Number of frames.
    pub frames: usize,
    /// Name of the field that its colours stand for.
    pub label: &'static str,
    /// SI unit of the field.
    pub unit: &'static str,
    /// Values at the ends of the colours.
    pub range: (f64, f64),
}

/// Writes the frames of a results folder as an animated PNG, which browsers and picture viewers play.
///
/// # Errors
/// [`ReportError::Input`] for a folder without frames or a size out of range; [`ReportError::Write`].
pub fn movie(folder: &Path, output: &Path, settings: MovieSettings) -> Result<Movie, ReportError> {
    let (mode, has_modes) = (settings.mode, folder.join("modes.csv").is_file());
    if mode.is_some_and(|mode| !has_modes || mode == 0 || FrameIndex::open(folder).is_ok_and(|all| mode > all.len())) {
        let found = format!("{}: no mode {}", folder.display(), mode.unwrap_or(0));
        return Err(ReportError::Input(format!(
            "{found}; name a results folder of solver.kind = \"modes\", and one of its modes"
        )));
    }
    let (movie, bytes) = film(folder, settings)?;
    atomic::write(output, &bytes)?;
    Ok(movie)
}

/// Pixels of the movie that a run with that many frames ends with.
pub fn expected_pixels(frames: f64) -> f64 {
    let MovieSettings { width, height, .. } = MovieSettings::default();
    frames * (width * height) as f64
}

/// The frames of a results folder as an animated PNG: what it shows, and its bytes.
///
/// # Errors
/// [`ReportError::Input`] for a folder without frames or a size out of range.
pub fn film(folder: &Path, settings: MovieSettings) -> Result<(Movie, Vec<u8>), ReportError> {
    let MovieSettings { width, height, rate, mode } = settings;
    let index = FrameIndex::open(folder)?;
    let all: Vec<usize> = mode.map_or((0..index.len()).collect(), |mode| vec![mode - 1; SWING]);
    let frames = Frames::survey(index, &all[..if mode.is_some() { 1 } else { all.len() }])?;
    let draw = |picture: usize| {
        let phase = 2.0 * std::f64::consts::PI * picture as f64 / SWING as f64;
        let swing = if mode.is_some() { sin(phase) } else { 1.0 };
        frames.draw(all[picture], swing, width, height)
    };
    let bytes = animation([width, height], all.len(), rate, draw)?;
    let (label, unit) = frames.label();
    Ok((Movie { frames: all.len(), label, unit, range: frames.range }, bytes))
}
