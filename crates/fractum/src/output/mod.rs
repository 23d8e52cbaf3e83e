//! What a run leaves behind: rows of its history, frames, and the numbers of its summary.

pub(crate) mod columns;
pub(crate) mod fetch;
pub(crate) mod modes;
pub(crate) mod record;
pub(crate) mod series;
pub(crate) mod summary;
