//! What is looked at in a solid: stresses and damage of elements, and the largest values of a body.

pub(crate) mod element_fields;
pub(crate) mod extremes;

pub use element_fields::{
    damaged_elements, displacements_before, element_damages, element_field, element_fields, owned_elements,
    owned_fields, owned_strains,
};
pub use extremes::{Extreme, Extremes, extremes};
