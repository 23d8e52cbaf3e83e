//! What a run leaves behind: rows of its history, frames, and the numbers of its summary.

pub(crate) mod columns;
pub mod cracks;
pub(crate) mod fetch;
pub(crate) mod frame_file;
pub(crate) mod frames;
pub(crate) mod gas_cells;
pub(crate) mod path_frames;
pub(crate) mod population;
pub(crate) mod record;
pub(crate) mod record_bonded;
pub(crate) mod rigid_surface;
pub(crate) mod series;
pub(crate) mod sight;
pub(crate) mod summary;
