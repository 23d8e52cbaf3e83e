//! What is looked at in a solid: stresses and damage of elements, and the largest values of a body.

pub(crate) mod element_fields;
pub(crate) mod extremes;
