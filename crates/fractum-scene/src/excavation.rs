//! Bodies that leave and come in.

/// Bodies of solids that leave and come in when a stage begins.
///
/// What they did to the nodes that stay, by their stress and weight, is kept as forces that fade: the state is in equilibrium at first, and
/// free of them in the end. Bodies that come in have no stress at the displacements that their nodes have, and the velocities of these.
#[derive(Clone, Debug, PartialEq)]
pub struct Excavation {
    /// Numbers of the bodies; none in a stage in which only forces of earlier ones fade.
    pub bodies: Vec<usize>,
    /// Numbers of the bodies that come in, once those others have left.
    pub installed: Vec<usize>,
    /// Time over which the forces fade [s]; to the end of the stage where none is given.
    pub over: Option<f64>,
    /// Part of the forces that fades in this stage, 0 to 1; the rest goes in the next one.
    pub share: f64,
    /// Whether they fade as a smooth step, which excites few waves, and not in proportion to time.
    pub is_smooth: bool,
}
