//! Charts of the user's own in the report.

use crate::Spanned;
use crate::choice::choice;

/// A chart of columns of the history.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Title; empty for one made of the names.
    pub title: String,
    /// Column of the abscissa.
    pub x: Spanned<String>,
    /// Columns of the ordinates, of one dimension, and probes that are one number, which are levels.
    pub y: Vec<Spanned<String>>,
    /// What the axes say; empty for the names of the columns.
    pub labels: [String; 2],
    /// Kinds of the axes.
    pub scale: PlotScale,
    /// Points to compare with.
    pub reference: Option<PlotReference>,
}

/// Points from elsewhere, such as a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotReference {
    /// Name in the legend.
    pub name: String,
    /// Abscissa and ordinate of each, in SI; at least one.
    pub points: Vec<[f64; 2]>,
}

/// Kinds of the axes of a chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlotScale {
    /// Both linear.
    Linear,
    /// The abscissa logarithmic.
    LogX,
    /// The ordinate logarithmic.
    LogY,
    /// Both logarithmic.
    LogLog,
}

choice!(PlotScale { "linear" => Linear, "log-x" => LogX, "log-y" => LogY, "log-log" => LogLog });

impl PlotScale {
    /// Whether abscissa and ordinate are logarithmic.
    pub fn logarithmic(self) -> [bool; 2] {
        [matches!(self, Self::LogX | Self::LogLog), matches!(self, Self::LogY | Self::LogLog)]
    }
}
