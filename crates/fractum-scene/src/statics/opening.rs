use fractum_math::Vec3;

/// The opening of a crack that controls a path: how far two sets of nodes have moved apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// Nodes on one side.
    pub nodes: Vec<u32>,
    /// Nodes on the other side.
    pub against: Vec<u32>,
    /// Unit direction in which the first side moves away from the other.
    pub direction: Vec3,
    /// Growth of the opening in a step [m].
    pub step: f64,
    /// Opening at which the run ends [m].
    pub end: f64,
}

impl Opening {
    /// The opening under a displacement field [m].
    pub fn of(&self, field: &[Vec3]) -> f64 {
        let mean = |nodes: &[u32]| nodes.iter().map(|&n| field[n as usize]).sum::<Vec3>() / nodes.len().max(1) as f64;
        (mean(&self.nodes) - mean(&self.against)).dot(&self.direction)
    }

    /// The load parameter at which a + τ b has this opening; none where b does not open it.
    pub(super) fn find(&self, target: f64, start: &[Vec3], slope: &[Vec3]) -> Option<f64> {
        let tau = (target - self.of(start)) / self.of(slope);
        tau.is_finite().then_some(tau)
    }
}
