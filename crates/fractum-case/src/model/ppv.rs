//! Peak particle velocity against distance.

use fractum_math::Vec3;

use crate::Spanned;
use crate::choice::choice;

/// Stations at which the largest velocity is kept, by their distance from a hole.
#[derive(Debug, Clone, PartialEq)]
pub struct Ppv {
    /// Name in tables and figures.
    pub name: Spanned<String>,
    /// Mesh group of the wall of the hole.
    pub hole: Spanned<String>,
    /// Centre of the hole, or a point of its axis [m]; the mean place of the group's nodes if absent.
    pub centre: Option<Vec3>,
    /// Axis of the hole, a unit vector, from which distances count; from its centre if absent.
    pub axis: Option<Vec3>,
    /// Mass of the charge [kg], > 0.
    pub charge: Option<f64>,
    /// What distances are divided by, with a charge.
    pub scaling: Scaling,
    /// Stations on a straight line.
    pub line: Option<StationLine>,
    /// Mesh groups, each of which is a station.
    pub groups: Vec<Spanned<String>>,
}

/// How a charge scales a distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaling {
    /// R/√Q, for long charges.
    SquareRoot,
    /// R/∛Q, for concentrated ones.
    CubeRoot,
}

choice!(Scaling { "square-root" => SquareRoot, "cube-root" => CubeRoot });

/// Stations on a straight line, evenly apart.
#[derive(Debug, Clone, PartialEq)]
pub struct StationLine {
    /// The first [m].
    pub from: Vec3,
    /// The last [m].
    pub to: Vec3,
    /// Their number, ≥ 1.
    pub stations: u64,
}
