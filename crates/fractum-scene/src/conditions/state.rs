use fractum_fem::Solid;
use serde::{Deserialize, Serialize};

use super::load::LoadsState;
use super::{Loads, SurfaceSupports};

/// What boundary conditions have come to, for a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ConditionsState {
    loads: LoadsState,
    /// What absorbing boundaries have taken at each of their nodes [J].
    absorbed: Vec<f64>,
}

impl ConditionsState {
    pub(crate) fn of(loads: &Loads, supports: &SurfaceSupports) -> Self {
        ConditionsState { loads: loads.state(), absorbed: supports.taken().to_vec() }
    }

    /// Puts it back, once the solid has lost its elements again.
    pub(crate) fn put_back(self, solid: &Solid, loads: &mut Loads, supports: &mut SurfaceSupports) {
        loads.restore(solid, self.loads);
        supports.restore(self.absorbed);
    }
}
