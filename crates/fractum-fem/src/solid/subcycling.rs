//! What a solid keeps where its cells take steps of two sizes, see [`crate::motion::subcycled_solid`].

use std::ops::Range;

use fractum_math::Vec3;

use crate::solid::Solid;

/// What a solid keeps where its cells take steps of two sizes.
#[derive(Clone, Debug)]
pub(crate) struct Subcycling {
    /// Elements that ask for the short steps, body by body.
    pub(crate) fine_elements: Vec<Vec<bool>>,
    /// Whether a node takes the short steps.
    pub(crate) is_fine: Vec<bool>,
    /// Runs of nodes with long steps and of those with short ones in each chunk, without what is linked.
    pub(crate) runs: [Vec<Vec<Range<usize>>>; 2],
    /// Blocks with long steps that hold copies: their forces at the end of a long step are needed before the short ones are taken.
    pub(crate) near: Vec<usize>,
    /// The forces of these blocks are those of tⁿ already.
    pub(crate) is_ahead: bool,
    /// While they are: elastic energy and what damage and friction have taken at the last step of all cells [J].
    pub(crate) energies: [f64; 3],
    /// Short steps in the long ones before and after tⁿ.
    pub(crate) parts: [u32; 2],
    /// Internal forces at tⁿ, then what other forces there are; on nodes with short steps these act until tⁿ⁺¹ [N].
    pub(crate) outer: Vec<Vec3>,
    /// Whether there are any on nodes with short steps.
    pub(crate) has_outer: bool,
    /// Their power in each chunk of nodes [W].
    pub(crate) power: Vec<f64>,
    /// Accelerations of nodes and copies together at tⁿ [m/s²].
    pub(crate) accelerations: Vec<Vec3>,
    /// Velocities of the copies without the link at both ends of a long step [m/s].
    pub(crate) ends: Vec<[Vec3; 2]>,
}

impl Subcycling {
    /// Whether the forces of a block are those of tⁿ already.
    pub(crate) fn is_ahead(&self, block: usize) -> bool {
        self.is_ahead && self.near.binary_search(&block).is_ok()
    }

    /// Elastic energy and what damage and friction have taken at the last step of all cells, while some are ahead [J].
    pub(crate) fn energies(&self) -> Option<[f64; 3]> {
        self.is_ahead.then_some(self.energies)
    }

    /// Short steps in the long one before tⁿ.
    pub(crate) fn parts_before(&self) -> f64 {
        f64::from(self.parts[0])
    }
}

/// After cells have changed, no forces are known in advance.
pub(crate) fn forget_ahead(solid: &mut Solid) {
    solid.subcycling.iter_mut().for_each(|own| own.is_ahead = false);
}

/// Energy taken by the friction of closed cracks so far [J].
pub fn rubbed_energy(solid: &Solid) -> f64 {
    match solid.subcycling.as_ref().and_then(|own| own.energies()) {
        Some([.., rubbed]) => rubbed,
        None => solid.blocks.iter().map(|block| block.rubbed).sum(),
    }
}
