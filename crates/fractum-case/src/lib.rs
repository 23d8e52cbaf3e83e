//! The case file: TOML with units in, a typed and checked [`Case`] out.
//!
//! [`read_case`] reads a file and reports every mistake at once, each with its line and column, what was expected and
//! the nearest valid name. All numbers of a [`Case`] are in SI. What only the mesh can tell, such as whether a named
//! group exists, is left to the user of the case, who finds the place of each name beside it.
//!
//! ```
//! use fractum_case::parse_case;
//! use std::path::Path;
//! let text = r#"
//!     fractum = 1
//!     [mesh]
//!     file = "bar.msh"
//!     [materials.steel]
//!     density = "7.8 g/cm^3"
//!     young_modulus = "210 GPa"
//!     poisson_ratio = 0.3
//!     [[bodies]]
//!     name = "bar"
//!     kind = "solid"
//!     group = "bar"
//!     material = "steel"
//!     [solver]
//!     end = "1 ms"
//! "#;
//! let case = parse_case(text, Path::new("bar.toml"), &[]).unwrap();
//! assert_eq!(case.materials[0].density, 7800.0);
//!
//! let wrong = parse_case(&text.replace("0.3", "0.7"), Path::new("bar.toml"), &[]).unwrap_err();
//! assert_eq!(
//!     wrong.to_string(),
//!     "bar.toml:8:21: materials.steel.poisson_ratio = 0.7; expected between -1 and 0.5"
//! );
//! ```

#![forbid(unsafe_code)]

pub mod build;
mod choice;
mod continued;
mod diagnostic;
mod expression;
mod hash;
mod key_kind;
mod keys;
pub mod measure;
pub mod model;
mod nearest;
mod place;
pub mod prepare;
mod quantity;
mod read;
mod reader;
mod scale;
mod schema;
mod selection;
pub mod study;
mod time_function;
mod tree;
mod unit;
mod usual;

pub use choice::Choice;
pub use diagnostic::{Diagnostic, Diagnostics, Severity, printable};
pub use key_kind::{KeyDoc, KeyKind};
pub use keys::{explain, keys};
pub use model::Case;
pub use nearest::nearest;
pub use place::{Place, Spanned};
pub use quantity::{parse_condition, parse_quantity};
pub use read::{parse_case, read_case, refuse_endless};
pub use schema::schema;
pub use time_function::{Field, TimeFunction};
pub(crate) use tree::place_of;
pub use unit::Dimension;
pub(crate) use usual::LONGEST_ZONE;
pub use usual::{PROCESS_ZONES, unusual};
