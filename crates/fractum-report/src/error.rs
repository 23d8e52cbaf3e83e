//! Why something could not be drawn.

use fractum_output::WriteError;

use crate::picture::PictureError;

/// Why a page, a picture or a movie could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The folder is not that of a run, or misses what is shown.
    #[error("{0}")]
    Input(String),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A picture could not be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
}
