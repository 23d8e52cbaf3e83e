//! What a report shows that no other file of a results folder holds.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atomic::Group;

/// File in the results folder with what the report needs beside summary, history and fragments.
pub const NOTES: &str = "pictures/notes.json";

/// Pictures of the last instant, in the folder `pictures` of the results.
pub const PICTURES: [&str; 6] = [DAMAGE, CLOSER, STRESS, TEMPERATURE, PARTICLES, BROKEN_BONDS];
/// Damage of solids.
pub const DAMAGE: &str = "damage.png";
/// Cracks of solids that are small against them, closer.
pub const CLOSER: &str = "cracks.png";
/// First principal stress of solids.
pub const STRESS: &str = "stress.png";
/// Temperature.
pub const TEMPERATURE: &str = "temperature.png";
/// Displacement of particles.
pub const PARTICLES: &str = "particles.png";
/// Bonds that particles have lost.
pub const BROKEN_BONDS: &str = "broken_bonds.png";

/// The animated picture of all frames, in the results folder.
pub const MOVIE: &str = "movie.png";

/// How the names of the pictures over time begin.
pub const STRIP_FILE: &str = "strip-";

/// What the report shows that no other file of the folder holds.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Notes {
    /// The case, as the user calls it.
    pub case_file: String,
    /// The plan.
    pub plan: String,
    /// Pictures in the folder `pictures`.
    pub pictures: Vec<PictureNote>,
    /// Whether the run ended with a movie of its frames.
    #[serde(default)]
    pub movie: bool,
    /// Materials and settings: what and its value.
    #[serde(default)]
    pub inputs: Vec<(String, String)>,
    /// Plots of the user's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<PlotNote>,
}

/// A picture in the folder `pictures`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PictureNote {
    /// Name of the PNG file.
    pub file: String,
    /// What it shows, and when.
    pub title: String,
    /// Name of the field that its colours stand for.
    pub label: String,
    /// SI unit of the field.
    pub unit: String,
    /// Whether the colours are those of damage.
    pub damage: bool,
    /// Values at the ends of the colours.
    pub range: (f64, f64),
    /// Pixels of a metre; none where that is not known.
    #[serde(default)]
    pub pixels_per_metre: Option<f64>,
    /// Where the axes point in the picture: right and down.
    #[serde(default)]
    pub axes: [[f64; 2]; 3],
    /// Width and height [pixels].
    #[serde(default)]
    pub size: [usize; 2],
    /// Whether it is one of the strip over time.
    #[serde(default)]
    pub in_strip: bool,
    /// How displacements are drawn, where the title does not say it.
    #[serde(default)]
    pub magnified: String,
}

/// Keeps the notes of a run in its folder, where they are among the `files` that are written there.
pub fn keep(folder: &Path, notes: &Notes, files: &mut Group) {
    let text = serde_json::to_string_pretty(notes).unwrap_or_default();
    files.add(&folder.join(NOTES), text.as_bytes());
}

/// A plot as a results folder keeps it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlotNote {
    /// Title; empty for one made of the names.
    pub title: String,
    /// Probe or column of the abscissa.
    pub x: String,
    /// Probes and columns of the ordinates.
    pub y: Vec<String>,
    /// What the axes say; empty for the names.
    pub labels: [String; 2],
    /// Which axes are logarithmic.
    pub logarithmic: [bool; 2],
    /// Points to compare with, in SI, under their name.
    pub reference: Option<(String, Vec<[f64; 2]>)>,
}
