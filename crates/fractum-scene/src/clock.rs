use fractum_fem::{Solid, StableStep, motion};
use serde::{Deserialize, Serialize};

/// How the time step is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeStepSettings {
    /// Fraction of the stable step that is taken, 0.8.
    pub safety: f64,
    /// Use the rigorous element bound instead of the frequency of the whole solid.
    pub element_bound: bool,
    /// A step asked for by the user [s]; replaces `safety` times the stable step.
    pub fixed: Option<f64>,
    /// Begin of the stage [s]; 0 in a run of one.
    pub begin: f64,
    /// End of the stage [s].
    pub end: f64,
}

impl TimeStepSettings {
    /// Whether the second half of the stage has begun: in the first half little energy may be in play yet.
    pub(crate) fn is_late(&self, time: f64) -> bool {
        time > 0.5 * (self.begin + self.end)
    }
}

/// Time, and the steps on both sides of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Present time tⁿ [s].
    pub time: f64,
    /// Steps done, n.
    pub step: u64,
    /// Step that led to tⁿ [s].
    pub dt_before: f64,
    /// Step that follows [s].
    pub dt_after: f64,
    /// Smallest step of the run so far [s].
    pub dt_min: f64,
    /// Steps done when motion began, from rest or from the given velocities: 0 but after a hand-over from equilibrium.
    pub motion_since: u64,
}

impl Clock {
    /// A clock at zero.
    pub fn new(dt: f64) -> Self {
        Clock { time: 0.0, step: 0, dt_before: dt, dt_after: dt, dt_min: dt, motion_since: 0 }
    }

    /// Whether the step that follows is the first one of motion: nothing has moved before it.
    pub(crate) fn begins_motion(&self) -> bool {
        self.step == self.motion_since
    }

    /// Passes to the next step, which will be followed by one of size `dt`.
    pub(crate) fn advance(&mut self, dt: f64) {
        self.time += self.dt_after;
        self.step += 1;
        self.dt_before = self.dt_after;
        self.dt_after = dt;
        self.dt_min = self.dt_min.min(dt);
    }
}

/// What limits the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frequencies {
    /// Of the solids by themselves.
    pub(crate) stable: StableStep,
    /// Of the cells with short steps, where others take long ones.
    pub(crate) fine: Option<StableStep>,
    /// Of the given velocities, where they meet what may be damaged; 0 where they ask for nothing.
    pub(crate) motion: f64,
    /// Square of that of nodes on rigid shapes [1/s²].
    pub(crate) walls_square: f64,
    /// Square of that of discrete elements in contact, rounded up; the step is for it [1/s²].
    pub(crate) contact_square: f64,
    /// Largest one since it was rounded up anew [1/s²].
    pub(crate) contact_peak: f64,
}

impl Frequencies {
    /// Those of solids before their first step.
    ///
    /// - `bound`: whether the rigorous bound of the elements is taken
    pub(crate) fn of_solid(solid: &mut Solid, bound: bool) -> Self {
        let stable = if bound { motion::stable_step_bound(solid) } else { solid.stable_step() };
        let motion = if solid.has_damage() { motion::motion_frequency(solid) } else { 0.0 };
        Frequencies { motion, ..Self::of(stable, motion::fine_stable_step(solid, bound)) }
    }

    /// Those of solids without contact.
    pub(crate) fn of(stable: StableStep, fine: Option<StableStep>) -> Self {
        Frequencies { stable, fine, motion: 0.0, walls_square: 0.0, contact_square: 0.0, contact_peak: 0.0 }
    }
}

/// The step around tⁿ that is being done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ThisStep {
    /// Whether motion begins with it.
    pub(crate) is_first: bool,
    /// Whether the ledger of tⁿ is wanted.
    pub(crate) measure: bool,
    /// Whether the steps before and after tⁿ differ.
    pub(crate) changes: bool,
    /// tⁿ [s].
    pub(crate) time: f64,
    /// Time since the forces of before; zero where nothing has moved [s].
    pub(crate) elapsed: f64,
    /// Step to tⁿ [s].
    pub(crate) dt_before: f64,
    /// Step from tⁿ [s].
    pub(crate) dt_after: f64,
}

/// A part of the step, for those who time it. A step passes those alone that its scene has work for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Internal forces, damage included.
    Solid,
    /// Motion and internal forces in short steps, of the cells that need them.
    Subcycling,
    /// Temperatures, and the strains that follow them.
    Heat,
    /// Forces of the bonds, and the loads on their particles.
    Bonds,
    /// Search for overloaded bonds, and their breaking.
    Fracture,
    /// Contact of particles and rigid bodies, search included.
    Contact,
    /// Forces that tied particles hand to solids.
    Ties,
    /// Gas in holes and cracks.
    Gas,
    /// Loads, supports and the motion of the nodes.
    Motion,
    /// Removal of elements and birth of particles.
    Transition,
}
