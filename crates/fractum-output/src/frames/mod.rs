//! Frames: what ParaView shows of one instant, a file per population, written beside the run and read again for pictures and movies.

mod contacts;
pub mod cracks;
mod frame;
mod frame_file;
mod gas_cells;
mod interfaces;
mod particles;
mod path_frames;
mod population;
mod read;
mod rigid_surface;
mod triangles;
mod writer;
mod xyz;

pub use frame::{BuiltGauges, Frame, FrameEntry, GAUGES, GridLayout};
pub use path_frames::PathFrames;
pub use population::Population;
pub use read::{read_arrays, read_collection};
pub use rigid_surface::drawn_surfaces;
pub use triangles::{Triangles, corners, extent};
pub use writer::{FrameWriter, WAITING};
