//! The frames of a results folder as pictures: movies, and the strip of the report.

use std::path::{Path, PathBuf};

use fractum_io::picture::{ColourMap, Image, Paint, Picture, Spheres, Surface, View, animation, robust_range};
use fractum_io::vtk::{Arrays, Collection, read_collection};
use fractum_io::{ReadError, atomic};
use fractum_math::Vec3;
use fractum_mesh::topology::boundary_of_tetrahedra;

use crate::error::Failure;
use crate::gallery::{ATTACHED, GREY, PARTICLE, SHOWN_DISPLACEMENT, extent, view_of};

/// Broken bonds of a particle that show in full colour.
const LOST_BONDS: f64 = 5.0;

/// What the colours of frames stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    Damage,
    Stress,
    BrokenBonds,
    Displacement,
}

/// What is to be seen of one instant.
#[derive(Default)]
struct Frame {
    points: Vec<[f64; 3]>,
    facets: Vec<[u32; 3]>,
    values: Vec<f64>,
    /// Particles, with whether elements hold them.
    particles: (Vec<[f64; 3]>, Vec<f64>),
    bonded: (Vec<[f64; 3]>, Vec<f64>),
    bonded_values: Vec<f64>,
    rigid: (Vec<[f64; 3]>, Vec<[u32; 3]>),
}

/// The frames of a run, with one view and one range of colours for all of them.
pub(crate) struct Frames {
    folder: PathBuf,
    /// Files of each instant: name of the part, path.
    instants: Vec<Vec<(String, PathBuf)>>,
    /// Simulated time of each instant [s].
    pub(crate) times: Vec<f64>,
    shown: Shown,
    /// Values at the ends of the colours.
    pub(crate) range: (f64, f64),
    scale: f64,
    corners: ([f64; 3], [f64; 3]),
    view: View,
}

fn refused(error: &ReadError) -> Failure {
    Failure::input(format!("{error}; name the results folder of a run"))
}

impl Frames {
    /// Looks through the frames of a folder.
    ///
    /// # Errors
    /// [`Failure::Input`] for a folder without frames, or with damaged ones.
    pub(crate) fn open(folder: &Path) -> Result<Self, Failure> {
        let collection = read_collection(&folder.join("fields.pvd")).map_err(|error| refused(&error))?;
        let instants = instants(folder, &collection);
        let Some(last) = instants.last() else {
            return Err(Failure::input(format!("{}: no frames; set output.fields of the case", folder.display())));
        };
        let mut frames = Frames {
            folder: folder.to_owned(),
            shown: shown(last)?,
            instants,
            times: Vec::new(),
            range: (0.0, 1.0),
            scale: 1.0,
            corners: ([0.0; 3], [0.0; 3]),
            view: View::default(),
        };
        frames.survey()?;
        Ok(frames)
    }

    /// Folder of the results.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Number of instants.
    pub(crate) fn len(&self) -> usize {
        self.instants.len()
    }

    /// Name and SI unit of what the colours stand for.
    pub(crate) fn label(&self) -> (&'static str, &'static str) {
        match self.shown {
            Shown::Damage => ("damage", "1"),
            Shown::Stress => ("first principal stress", "Pa"),
            Shown::BrokenBonds => ("broken bonds", "1"),
            Shown::Displacement => ("displacement", "m"),
        }
    }

    /// The colour map.
    pub(crate) fn map(&self) -> ColourMap {
        if matches!(self.shown, Shown::Damage | Shown::BrokenBonds) { ColourMap::Damage } else { ColourMap::Viridis }
    }

    /// How much larger displacements are drawn than they are.
    pub(crate) fn magnification(&self) -> f64 {
        self.scale
    }

    /// Times, colours, magnification and view, from all frames.
    fn survey(&mut self) -> Result<(), Failure> {
        let mut largest: f64 = 0.0;
        let mut ranges: Vec<f64> = Vec::new();
        // What is at its present place only cannot be magnified with the rest.
        let mut magnified = true;
        let mut all: Vec<Vec3> = Vec::new();
        for (index, files) in self.instants.iter().enumerate() {
            let mut time = f64::NAN;
            for (name, path) in files {
                let arrays = Arrays::read(path).map_err(|error| refused(&error))?;
                time = arrays.get("TimeValue").first().copied().unwrap_or(time);
                let displacement = arrays.vectors("displacement");
                let points = arrays.vectors("Points");
                let is_body =
                    ["solid", "discrete elements", "bonded particles", "loose particles"].contains(&name.as_str());
                magnified &= !is_body || displacement.len() == points.len();
                let length = |u: &[f64; 3]| Vec3::from(*u).norm();
                // Nodes that no element holds may fly far.
                let attached = arrays.get("attached");
                let held = |i: usize| attached.get(i).is_none_or(|&held| held > 0.0);
                let moved = displacement.iter().enumerate().filter(|(i, _)| held(*i)).map(|(_, u)| length(u));
                largest = moved.fold(largest, f64::max);
                if index == 0 && is_body {
                    all.extend(points.iter().map(|x| Vec3::from(*x)));
                }
                let values: Vec<f64> = match (self.shown, name.as_str()) {
                    (Shown::Stress, "solid") => arrays.get("first_principal_stress").to_vec(),
                    (Shown::Displacement, "bonded particles" | "loose particles") => {
                        displacement.iter().map(length).collect()
                    }
                    _ => Vec::new(),
                };
                if !values.is_empty() {
                    let (low, high) = robust_range(&values);
                    ranges.extend([low, high]);
                }
            }
            self.times.push(time);
        }
        let size = extent(&all).norm();
        if magnified && largest > 0.0 {
            self.scale = (SHOWN_DISPLACEMENT * size / largest).max(1.0);
        }
        self.range = match self.shown {
            Shown::Damage => (0.0, 1.0),
            Shown::BrokenBonds => (0.0, LOST_BONDS),
            _ => fractum_io::picture::range(&ranges),
        };
        self.view = view_of(&all);
        let (low, high) = all
            .iter()
            .fold((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)), |(l, h), x| (l.inf(x), h.sup(x)));
        // Room for what moves.
        let room = (0.1 * size + largest.min(0.3 * size)) * Vec3::new(1.0, 1.0, if high.z > low.z { 1.0 } else { 0.0 });
        self.corners = ((low - room).into(), (high + room).into());
        Ok(())
    }

    fn load(&self, index: usize) -> Result<Frame, Failure> {
        let mut frame = Frame::default();
        for (name, path) in &self.instants[index] {
            let arrays = Arrays::read(path).map_err(|error| refused(&error))?;
            let displacement = arrays.vectors("displacement");
            let mut points = arrays.vectors("Points");
            for (x, u) in points.iter_mut().zip(&displacement) {
                (0..3).for_each(|a| x[a] += self.scale * u[a]);
            }
            match name.as_str() {
                "solid" => self.add_solid(&mut frame, &arrays, points),
                "discrete elements" => {
                    let attached = arrays.get("attached");
                    let shrink =
                        |i: usize| if attached.get(i).is_some_and(|&held| held > 0.0) { ATTACHED } else { 1.0 };
                    let radii = arrays.get("radius").iter().enumerate().map(|(i, r)| r * shrink(i)).collect();
                    frame.particles = (points, radii);
                }
                "bonded particles" | "loose particles" => {
                    let mut values: Vec<f64> = match self.shown {
                        Shown::BrokenBonds => arrays.get("broken_bonds").to_vec(),
                        _ => displacement.iter().map(|u| Vec3::from(*u).norm()).collect(),
                    };
                    // Loose particles have no bonds that could break.
                    values.resize(points.len(), 0.0);
                    frame.bonded_values.extend(values);
                    frame.bonded.0.extend(points);
                    frame.bonded.1.extend(arrays.get("radius"));
                }
                name if name.contains("rigid") => frame.rigid = (points, arrays.cells::<3>()),
                _ => {}
            }
        }
        Ok(frame)
    }

    fn add_solid(&self, frame: &mut Frame, arrays: &Arrays, points: Vec<[f64; 3]>) {
        let field = if self.shown == Shown::Damage { "damage" } else { "first_principal_stress" };
        let values = arrays.get(field);
        let tetrahedra = arrays.cells::<4>();
        if tetrahedra.is_empty() {
            (frame.facets, frame.values) = (arrays.cells::<3>(), values.to_vec());
        } else {
            for facet in boundary_of_tetrahedra(&tetrahedra) {
                frame.facets.push(facet.nodes);
                frame.values.push(values.get(facet.element as usize).copied().unwrap_or(0.0));
            }
        }
        frame.points = points;
    }

    /// Draws an instant.
    ///
    /// # Errors
    /// [`Failure::Input`] for a damaged frame or a size of picture that is out of range.
    pub(crate) fn draw(&self, index: usize, width: usize, height: usize) -> Result<Image, Failure> {
        let frame = self.load(index)?;
        let fits = frame.values.len() == frame.facets.len() && !frame.values.is_empty();
        let paint = if fits { Paint::Facets(&frame.values) } else { Paint::Plain(GREY) };
        let solid = Surface { points: &frame.points, triangles: &frame.facets, paint, mesh_lines: false };
        let rigid =
            Surface { points: &frame.rigid.0, triangles: &frame.rigid.1, paint: Paint::Plain(GREY), mesh_lines: false };
        let coloured = matches!(self.shown, Shown::BrokenBonds | Shown::Displacement);
        let inner = if coloured && !frame.bonded_values.is_empty() {
            Paint::Nodes(&frame.bonded_values)
        } else {
            Paint::Plain(GREY)
        };
        let picture = Picture {
            surfaces: &[solid, rigid],
            spheres: &[
                Spheres { centres: &frame.particles.0, radii: &frame.particles.1, paint: Paint::Plain(PARTICLE) },
                Spheres { centres: &frame.bonded.0, radii: &frame.bonded.1, paint: inner },
            ],
            map: self.map(),
            range: self.range,
            clip: None,
        };
        let view = View { width, height, frame: Some(self.corners), ..self.view };
        Ok(picture.render(&view)?)
    }
}

/// Files by instants: those of one time that follow each other.
fn instants(folder: &Path, collection: &Collection) -> Vec<Vec<(String, PathBuf)>> {
    let mut instants: Vec<(f64, Vec<(String, PathBuf)>)> = Vec::new();
    for entry in &collection.entries {
        let file = (entry.name.clone(), folder.join(&entry.file));
        match instants.last_mut() {
            Some((time, files)) if *time == entry.time && files.iter().all(|(name, _)| *name != file.0) => {
                files.push(file);
            }
            _ => instants.push((entry.time, vec![file])),
        }
    }
    instants.into_iter().map(|(_, files)| files).collect()
}

/// What shows most in the last frame.
fn shown(files: &[(String, PathBuf)]) -> Result<Shown, Failure> {
    let mut shown = Shown::Displacement;
    for (name, path) in files {
        let arrays = Arrays::read(path).map_err(|error| refused(&error))?;
        let some = |field: &str| arrays.get(field).iter().any(|&value| value > 0.0);
        match name.as_str() {
            "solid" => return Ok(if some("damage") { Shown::Damage } else { Shown::Stress }),
            "bonded particles" if some("broken_bonds") => shown = Shown::BrokenBonds,
            _ => {}
        }
    }
    Ok(shown)
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
}

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
/// [`Failure::Input`] for a folder without frames or a size out of range; [`Failure::Write`].
pub fn movie(folder: &Path, output: &Path, settings: MovieSettings) -> Result<Movie, Failure> {
    let MovieSettings { width, height, rate } = settings;
    let frames = Frames::open(folder)?;
    let draw = |index: usize| frames.draw(index, width, height);
    atomic::write(output, &animation([width, height], frames.len(), rate, draw)?)?;
    let (label, unit) = frames.label();
    Ok(Movie { frames: frames.len(), label, unit, range: frames.range })
}
