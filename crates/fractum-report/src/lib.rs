//! What people look at after a run: pictures (PNG), plots (SVG), movies, and the report page.
//!
//! - Of a scene or its results folder: [`gallery`] (pictures of the last instant), [`strip`] (pictures over time), [`movie`],
//!   [`folder`] (`report.html` from the files of a folder)
//! - Of anything: [`picture`], [`plot`], [`report`] (the page), [`study`] (the page of a study, with the [`exhibits`] of its runs)
//!
//! The program builds without this crate too, and then says that it draws nothing.

mod error;
pub mod exhibits;
pub mod folder;
pub mod gallery;
mod markup;
pub mod movie;
pub mod picture;
pub mod plot;
pub mod report;
mod sight;
pub mod strip;
pub mod study;

pub use error::ReportError;
