//! Scenes made of numbers alone: energy, momentum, stability, fracture energy.
