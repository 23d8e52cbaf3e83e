//! fractum: fracture of solids from a gmsh mesh and one case file.

fn main() {}
