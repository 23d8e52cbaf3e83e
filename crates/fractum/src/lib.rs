//! The program behind the command line: read a case, run it, leave results.
//!
//! - [`run`]: one case from file to results folder
//! - [`Simulation`]: the same, step by step
//! - [`output`]: what a run leaves behind
//! - [`plan`]: what a run will do, before it does it
//! - [`report`]: the page of a results folder
//! - [`study`]: many runs of a list, done here or one by one, and what they came to side by side
//! - [`template`]: cases to start from
//! - [`terminal`]: lines on stdout and stderr
//! - [`verify`]: the gallery against its references
//!
//! A bar of 0.4 m x 0.12 m x 0.12 m is stretched by 0.4 mm; with E = 1 GPa and no lateral strain its load is E A u / L:
//!
//! ```
//! use fractum::{Options, Simulation};
//! # use fractum_mesh::{MshFormat, generate::structured_box, write_msh};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("case.toml");
//! # let mesh = structured_box([4, 1, 1], fractum_math::Vec3::new(0.4, 0.12, 0.12), None);
//! # write_msh(&mesh, MshFormat::V4_1Ascii, &mut std::fs::File::create(folder.path().join("bar.msh"))?)?;
//! # let case = r#"fractum = 1
//! # mesh = { file = "bar.msh" }
//! # bodies = [{ name = "bar", kind = "solid", group = "body", material = "soft" }]
//! # supports = [{ group = "x-", fix = "xyz" }, { group = "x+", displacement = { x = "0.4 mm * t / 1 s" } }]
//! # solver = { kind = "static", end = "1 s" }
//! # probes = [{ name = "load", reaction = { group = "x+", along = "x" } }]
//! # [materials.soft]
//! # density = "1000 kg/m^3"
//! # young_modulus = "1 GPa"
//! # poisson_ratio = 0
//! # "#;
//! # std::fs::write(&path, case)?;
//! let options = Options { output: Some(folder.path().join("results")), quiet: true, ..Options::default() };
//! let mut simulation = Simulation::open(&path, &options)?;
//! while !simulation.is_over() {
//!     simulation.step()?;
//!     simulation.record()?;
//! }
//! assert!((simulation.time() - 1.0).abs() < 1e-12);
//! let (_, load) = simulation.probe("load").unwrap();
//! assert!((load.last().unwrap() / 14_400.0 - 1.0).abs() < 1e-6);
//! let outcome = simulation.finish()?;
//! assert!(outcome.folder.join("report.html").exists());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod accuracy;
mod error;
mod input;
mod kept;
mod output;
mod phases;
pub mod plan;
mod plots;
mod process;
pub mod report;
mod run;
mod simulation;
mod solver;
pub mod study;
pub mod template;
pub mod terminal;
pub mod verify;

pub use error::{ExitCode, Failure};
pub use input::{Input, cache_of_user, gather_mesh, load, mesh_of_case};
pub use process::interrupt::{clear_interrupt, interrupt, is_interrupted};
pub use process::ranks::Ranks;
#[cfg(feature = "report")]
pub use report::{Movie, MovieSettings, movie};
pub use run::{run, run_shared};
pub use simulation::{Options, Outcome, Simulation, for_shell};
