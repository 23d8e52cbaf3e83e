//! What lets particles into a run as time goes on.

use std::ops::Range;
use std::sync::Arc;

use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

/// When the particles of a body are due, and where they may come in.
#[derive(Clone)]
pub struct Arrivals {
    /// When each particle of the body is due, ascending [s].
    pub due: Vec<f64>,
    /// Corners of the box around the inlet [m].
    pub bounds: [Vec3; 2],
    /// A place within the inlet for a ball of a radius [m], by the number of the place.
    pub place: Arc<dyn Fn(f64, u64) -> Vec3 + Send + Sync>,
}

impl std::fmt::Debug for Arrivals {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Arrivals").field("due", &self.due.len()).field("bounds", &self.bounds).finish()
    }
}

/// Velocity [m/s] and angular velocity [rad/s] of a particle that comes in at a place with a radius [m].
pub type EntryMotion = Arc<dyn Fn(&Vec3, f64) -> [Vec3; 2] + Send + Sync>;

/// What lets the particles of a body into the run.
#[derive(Clone)]
pub struct Inlet {
    /// The particles among those of the scene.
    pub(crate) range: Range<usize>,
    pub(crate) arrivals: Arrivals,
    pub(crate) motion: EntryMotion,
    /// Largest radius of its particles [m].
    pub(crate) largest: f64,
    pub(crate) state: InletState,
}

impl std::fmt::Debug for Inlet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Inlet { range, arrivals, state, .. } = self;
        f.debug_struct("Inlet").field("range", range).field("arrivals", arrivals).field("state", state).finish()
    }
}

/// What changes in an inlet during a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct InletState {
    /// Where its particles came in, in their order [m].
    pub(crate) places: Vec<Vec3>,
    /// Places that were tried so far.
    pub(crate) tried: u64,
    /// Whether particles found no free place at the last look.
    pub(crate) is_full: bool,
}

/// What has come into the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Entered {
    /// Particles.
    pub particles: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s].
    pub momentum: Vec3,
    /// Particles that were due at the last look and had no free place.
    pub waiting: usize,
    /// The most that have waited at a time.
    pub most_waiting: usize,
}

impl Inlet {
    /// An inlet through which nothing has come yet.
    ///
    /// - `first`: its first particle among those of the scene; `radii` of all of its particles [m]
    pub fn new(first: u32, arrivals: Arrivals, motion: EntryMotion, radii: &[f64]) -> Self {
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let range = first as usize..first as usize + radii.len();
        Inlet { range, arrivals, motion, largest, state: InletState::default() }
    }

    /// Particles that have not come in yet.
    pub(crate) fn outside(&self) -> Range<usize> {
        self.range.start + self.state.places.len()..self.range.end
    }

    /// Number of its particles that should have come in until `time` [s].
    pub(crate) fn due_until(&self, time: f64) -> usize {
        self.arrivals.due.partition_point(|due| *due <= time)
    }
}
