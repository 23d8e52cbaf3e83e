use thiserror::Error;

/// What makes a scene impossible to set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// Two supports disagree about one degree of freedom.
    #[error(
        "supports {first} and {second} both prescribe {axis} of the node at ({x:.4e}, {y:.4e}, {z:.4e}) m in different ways; \
         let each group prescribe an axis only once"
    )]
    ContradictorySupports {
        /// Name of the support that came first.
        first: String,
        /// Name of the other one.
        second: String,
        /// Axis, x, y or z.
        axis: char,
        /// Position of the node [m].
        x: f64,
        /// Position of the node [m].
        y: f64,
        /// Position of the node [m].
        z: f64,
    },
    /// A body can move without resistance.
    #[error(
        "body {body} (centre {x:.4e}, {y:.4e}, {z:.4e} m) can {motion}: nothing holds it; a static solution needs supports against every rigid motion"
    )]
    FreeBody {
        /// Name of the body.
        body: String,
        /// The motion, in words.
        motion: &'static str,
        /// Centre of the piece [m].
        x: f64,
        /// Centre of the piece [m].
        y: f64,
        /// Centre of the piece [m].
        z: f64,
    },
    /// A support of a body at rest moves in another way than all others.
    #[error(
        "support {name} does not move along {axis} in proportion to time; between two breaks all supports move together: \
         give a constant velocity, or a displacement that is a number times t"
    )]
    NotProportional {
        /// Name of the support.
        name: String,
        /// Axis, x, y or z.
        axis: char,
    },
    /// A load that neither is constant nor grows in proportion to time.
    #[error(
        "a load along {axis} neither is constant nor grows in proportion to time, as it must on a bonded body at rest; give a number, or a number \
         times t"
    )]
    LoadNotProportional {
        /// Axis, x, y or z.
        axis: char,
    },
    /// A scene that cannot be solved from break to break.
    #[error("one bonded body and nothing else can be solved from break to break")]
    OneBondedBody,
    /// Loads at the start are out of balance.
    #[error(
        "the forces of t = 0 do not balance: a force of ({x:.4e}, {y:.4e}, {z:.4e}) N is left for nothing to carry; the in-situ stress must act \
         on every outer facet that no support holds, and a stress that changes from place to place needs the weight that goes with it. Under gravity \
         the rock around an opening is pushed up by the weight that is missing there: let [[supports]] with elastic or fix carry it"
    )]
    InSituUnbalanced {
        /// Sum of the forces [N].
        x: f64,
        /// Sum of the forces [N].
        y: f64,
        /// Sum of the forces [N].
        z: f64,
    },
    /// Loads at the start turn the solids.
    #[error(
        "the forces of t = 0 do not balance: they turn the solids, and nothing carries that; the in-situ stress must act on every outer facet that no \
         support holds, and its shear must be the same on facets across each other"
    )]
    InSituTurns,
    /// Stress that bodies have as it is written is not in equilibrium.
    #[error(
        "at ({x:.4e}, {y:.4e}, {z:.4e}) m, a node of {bodies}, the stress as it is written leaves a force of {force:.3e} N out of balance, {share:.1e} of what the largest stress \
         does there: on a side that two bodies share both must have the same traction, outer facets that no support holds need in_situ.groups or no traction, and loads of \
         t = 0 must belong to the stress. Take out openings in a later stage (excavate), or have the solids settle from that stress (in_situ.settle = true)"
    )]
    InSituUneven {
        /// Where [m].
        x: f64,
        /// Where [m].
        y: f64,
        /// Where [m].
        z: f64,
        /// Names of the bodies that have the node.
        bodies: String,
        /// Force that nothing carries [N].
        force: f64,
        /// The same over what the largest stress does on the areas of the node.
        share: f64,
    },
    /// The in-situ stress is more than the material bears.
    #[error(
        "body {body}: in the state of t = 0 an edge at ({x:.4e}, {y:.4e}, {z:.4e}) m is at {ratio:.3} times its strength; a run begins with intact \
         material: lower the stress, or leave out damage there with damage_where"
    )]
    InSituBreaks {
        /// Name of the body.
        body: String,
        /// Middle of the edge [m].
        x: f64,
        /// Middle of the edge [m].
        y: f64,
        /// Middle of the edge [m].
        z: f64,
        /// Equivalent stress over strength.
        ratio: f64,
    },
    /// The in-situ stress is more than an interface bears.
    #[error(
        "interface \"{name}\": in the state of t = 0 it has a traction of {normal:.4e} Pa along its normal (tension positive) and {shear:.4e} Pa across it \
         at ({x:.4e}, {y:.4e}, {z:.4e}) m, which is more than it bears; a run begins with sides that hold: raise its friction, cohesion or strength, turn or lower \
         the stress, or cut holes in a later stage"
    )]
    InSituParts {
        /// Name of the interface.
        name: String,
        /// Where [m].
        x: f64,
        /// Where [m].
        y: f64,
        /// Where [m].
        z: f64,
        /// Traction along the normal, tension positive [Pa].
        normal: f64,
        /// Traction across it [Pa].
        shear: f64,
    },
    /// The state of in-situ stress was not found.
    #[error("the equilibrium of t = 0 was not found: {reason}")]
    InSituUnsolved {
        /// Why.
        reason: String,
    },
    /// The conductivity of a packing was not found.
    #[error(
        "body {body}: the conductivity of its packing was not found: {reason}; take heat.packing = \"table\", or a body whose particles are all bonded"
    )]
    PackingConduction {
        /// Name of the body.
        body: String,
        /// Why.
        reason: String,
    },
    /// The solid cannot be built.
    #[error(transparent)]
    Solid(#[from] fractum_fem::SolidError),
    /// A bonded body cannot be built.
    #[error(transparent)]
    Bonded(#[from] fractum_dem::DemError),
}

/// Why a run stopped itself.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StepError {
    /// A displacement or an energy is not a number any more.
    #[error(
        "step {step}, t = {time:.6e} s: the solution is not finite near {culprit}; \u{394}t = {dt:.3e} s, stable limit {limit:.3e} s - lower \
         solver.safety or check the material there"
    )]
    NotFinite {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Step size [s].
        dt: f64,
        /// Estimated stable step [s].
        limit: f64,
        /// Body and element with the largest velocity.
        culprit: String,
    },
    /// No equilibrium was found however small the step.
    #[error(
        "step {step}, t = {time:.6e} s: no equilibrium found; {softer}the solid may have no static answer here - {path}let it move to the \
         next one with no_equilibrium = \"motion\", or end the run before with solver.stop_when"
    )]
    NoEquilibrium {
        /// Step number.
        step: u64,
        /// Load parameter [s].
        time: f64,
        /// What stiff faces that rub may need, with what parts it from the rest; else empty.
        softer: &'static str,
        /// That the run may follow its path, with what parts it from the rest; empty where it does, or cannot.
        path: &'static str,
    },
    /// No equilibrium of solids and liquid was found.
    #[error(
        "step {step}, t = {time:.6e} s: no equilibrium of solids and liquid found; a crack that opens far ahead of its liquid may have none: let more stress press \
         its sides together ([in_situ] or loads), or end the run before with solver.stop_when"
    )]
    NoWetEquilibrium {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
    },
    /// The equilibrium of a bonded body was not found.
    #[error(
        "step {step}, t = {time:.6e} s: no equilibrium of the bonds found: {error}; raise solver.tolerance, or run it with \
         kind = \"explicit\""
    )]
    NoBondedEquilibrium {
        /// Step number.
        step: u64,
        /// Time to which the load belongs [s].
        time: f64,
        /// Why.
        error: fractum_dem::DemError,
    },
    /// The user asked for the end of the run within a step at rest.
    #[error("step {step}, t = {time:.6e} s: interrupted before the next equilibrium was found")]
    Interrupted {
        /// Step number.
        step: u64,
        /// Load parameter of the last equilibrium [s].
        time: f64,
    },
    /// Temperatures were not found.
    #[error("step {step}, t = {time:.6e} s: conduction of heat failed: {reason}; lower heat.step or solver.safety")]
    Heat {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Why, in words.
        reason: String,
    },
    /// A piece is held by nothing any more.
    #[error(
        "step {step}, t = {time:.6e} s: the stiffness is singular near ({x:.4e}, {y:.4e}, {z:.4e}) m: {softer}a piece has come loose; end the run before with \
         solver.stop_when, or run it with kind = \"explicit\""
    )]
    ComeApart {
        /// Step number.
        step: u64,
        /// Load parameter [s].
        time: f64,
        /// Position of the node [m].
        x: f64,
        /// Position of the node [m].
        y: f64,
        /// Position of the node [m].
        z: f64,
        /// What stiff faces that rub may need, with what parts it from the rest; else empty.
        softer: &'static str,
    },
    /// A linear system was not solved.
    #[error("step {step}, t = {time:.6e} s: {reason} - choose the other solver.linear_solver")]
    NoSolution {
        /// Step number.
        step: u64,
        /// Load parameter [s].
        time: f64,
        /// Why, in words.
        reason: String,
    },
    /// Solids are not stable under the stress they start with.
    #[error(
        "the solids buckle under the in-situ stress: their fastest motion grows by e in {growth:.3e} s, and what grows does not vibrate - \
         lower the compression in in_situ.stress, or hold the solids with [[supports]]"
    )]
    Buckles {
        /// Time in which the fastest motion grows by e [s].
        growth: f64,
    },
    /// Nothing that has a mass is free to vibrate.
    #[error(
        "supports prescribe the motion of all nodes and particles: nothing vibrates - let them hold one side alone"
    )]
    NothingFree,
    /// The step is above the stable limit.
    #[error(
        "step {step}, t = {time:.6e} s: unstable: elements and bonds hold {ratio:.1} times the energy put in; fastest near {culprit}; \u{394}t = {dt:.3e} s, \
         stable limit {limit:.3e} s - lower solver.safety"
    )]
    Unstable {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Elastic energy over the largest energy put in.
        ratio: f64,
        /// Step size [s].
        dt: f64,
        /// Estimated stable step [s].
        limit: f64,
        /// Where the kinetic energy is largest.
        culprit: String,
    },
    /// An element of a corotational body is turned inside out while it carries load.
    #[error(
        "step {step}, t = {time:.6e} s: element {element} of body {body} at ({x:.4e}, {y:.4e}, {z:.4e}) m is inverted: its volume is {volume_ratio:.3} of \
         that without load; \u{394}t = {dt:.3e} s, stable limit {limit:.3e} s - lower solver.safety; if it still inverts, refine the mesh there, spread \
         the load, or let the body break (damage)"
    )]
    Inverted {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Index of the element in the body.
        element: u32,
        /// Present position of its centre [m].
        x: f64,
        /// Present position of its centre [m].
        y: f64,
        /// Present position of its centre [m].
        z: f64,
        /// Present volume over that without load.
        volume_ratio: f64,
        /// Step size [s].
        dt: f64,
        /// Estimated stable step [s].
        limit: f64,
    },
    /// The cracks of a phase field have taken most of a body.
    #[error(
        "step {step}, t = {time:.6e} s: body {body} has lost {:.0} % of its volume to cracks: they lie nearer to each other than the bands of its phase \
         field are wide ({width:.3e} m), and leave no fragments - take a smaller length on smaller elements, or regularisation = \"none\" (local damage)",
        100.0 * share
    )]
    NoFragments {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Of its volume, lost.
        share: f64,
        /// Width of a band [m].
        width: f64,
    },
    /// A box that repeats has become too narrow for its particles.
    #[error(
        "step {step}, t = {time:.6e} s: opposite sides of the periodic box are {narrowest:.4e} m apart, and its particles need {needed:.4e} m: they could touch \
         twice - end the run before with solver.stop_when, or begin with a larger box"
    )]
    BoxTooNarrow {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Least distance of opposite sides [m].
        narrowest: f64,
        /// What is needed [m].
        needed: f64,
    },
    /// The energy balance does not close.
    #[error(
        "step {step}, t = {time:.6e} s: the energy balance is off by {relative:.2e} of the energy put in (limit {allowed:.0e}); largest kinetic \
         energy at {culprit}; \u{394}t = {dt:.3e} s, stable limit {limit:.3e} s - lower solver.safety, or raise solver.balance_stop if this is expected"
    )]
    Unbalanced {
        /// Step number.
        step: u64,
        /// Time [s].
        time: f64,
        /// Residual over the energy put in.
        relative: f64,
        /// What was allowed.
        allowed: f64,
        /// Step size [s].
        dt: f64,
        /// Estimated stable step [s].
        limit: f64,
        /// Where the kinetic energy is largest.
        culprit: String,
    },
}
