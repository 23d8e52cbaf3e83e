//! What people look at after a run: the report, pictures and movies of `fractum-report`. A program that is built without them
//! says so.

#[cfg(feature = "report")]
mod drawn;
#[cfg(not(feature = "report"))]
mod none;

#[cfg(feature = "report")]
pub use drawn::write;
#[cfg(feature = "report")]
pub(crate) use drawn::{
    STUDY_FILES, Skin, add, add_movie, draw, pixels_at_end, pixels_of_movie, pixels_over_time, strip, write_study,
};
#[cfg(feature = "report")]
pub use fractum_report::movie::{Movie, MovieSettings};
#[cfg(not(feature = "report"))]
pub(crate) use none::{
    STUDY_FILES, Skin, add, add_movie, draw, pixels_at_end, pixels_of_movie, pixels_over_time, strip, write_study,
};
#[cfg(not(feature = "report"))]
pub use none::{no_report, write};

#[cfg(feature = "report")]
pub use drawn::movie;
