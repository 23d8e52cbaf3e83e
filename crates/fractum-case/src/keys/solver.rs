//! Damping, solver, stages.

use fractum_dem::Batch;
use fractum_scene::statics::{LinearSolver, NoEquilibrium};

use super::{key, names};
use crate::key_kind::{KeyDoc, KeyKind as K};
use crate::model::{Control, InitialOverlap, SolverKind, TimeStep};
use crate::unit::Dimension as D;

#[rustfmt::skip] // a table reads best with one row per line
pub(super) static KEYS: &[KeyDoc] = &[
    key("damping", K::Table, "", "Damping of solids and particles"),
    key("damping.local", K::Quantity(D::NONE), "0", "Fraction a of the unbalanced force that opposes motion, from 0 to below 1; for quasi-static runs; divides the stable step by √(1 + a)"),
    key("damping.mass", K::Quantity(D::RATE), "\"0 1/s\"", "Mass-proportional damping, ≥ 0"),
    key("damping.stiffness", K::Quantity(D::TIME), "\"0 s\"", "Stiffness-proportional damping, ≥ 0"),
    key("damping.bulk_linear", K::Quantity(D::NONE), "0", "Linear bulk viscosity, ≥ 0; for shocks"),
    key("damping.bulk_quadratic", K::Quantity(D::NONE), "0", "Quadratic bulk viscosity, ≥ 0; for shocks"),
    key("damping.tchamwa_wielgosz", K::Quantity(D::NONE), "", "φ of the scheme of Tchamwa and Wielgosz on bodies of particles, between 1 and 2: damps their highest frequencies; 1.05 to 1.3 are usual"),
    key("stages[]", K::Tables, "", "Parts of a run, one after the other, instead of [solver]: static stages first, then explicit ones"),
    key("stages[].name", K::Text, "required", "Name, unique among stages"),
    key("stages[].excavate", K::Names, "none", "Solid bodies that leave as the stage begins, not in the first one. The forces that they bore stay on the nodes of the others and fade"),
    key("stages[].install", K::Names, "none", "Solid bodies that are not there before and come in as the stage begins, without stress at the displacements that their nodes have; not in the first one"),
    key("stages[].release", K::Quantity(D::TIME), "to the end of the stage", "Time over which the forces of excavated bodies fade, ≥ 0; at rest in proportion to time, in motion as a smooth step"),
    key("stages[].release_share", K::Quantity(D::NONE), "all of it", "Part of the forces of the bodies excavated in this stage that fades in it, above 0 and at most 1; the rest fades in the next stage"),
    key("stages[].solver", K::Table, "required", "As [solver]; end is the time at which the stage ends, on the one clock of the run"),
    key("solver", K::Table, "", "Time and its steps; required where there are no stages"),
    key("solver.kind", K::Choice(names::<SolverKind>), "\"explicit\"", "Kind of solver: motion over time, equilibrium under a load that grows slowly, whichever of both suits the scene and its loads, conduction of heat alone, or natural vibrations of solids"),
    key("solver.end", K::Quantity(D::TIME), "required", "End of the run, > 0; not with kind = \"modes\""),
    key("solver.safety", K::Quantity(D::NONE), "0.8", "Factor on the stable time step, > 0 and at most 2; above 1 is unstable"),
    key("solver.time_step", K::Choice(names::<TimeStep>), "\"power-iteration\"", "How the stable step is found: for the whole mesh or all bonds, or rigorously by the worst element or particle"),
    key("solver.step", K::Quantity(D::TIME), "", "Explicit: fixed time step, > 0, instead of safety times the stable one; static: largest step, by default 1/50 of the run (of the stage) where something may break or slide, heat flows, or a load or motion goes back before the end; else the whole of it. Steps end where a table has a kink, and begin small there"),
    key("solver.subcycling", K::Flag, "false", "Explicit: where a mesh of solids is graded, its fine elements take several steps while the others take one"),
    key("solver.initial_overlap", K::Choice(names::<InitialOverlap>), "\"push\"", "Explicit. push: initial overlaps repel from the first step. keep: the initial overlap is the force-free distance until the pair separates"),
    key("solver.domain", K::Table, "", "Explicit: box outside of which free pieces of solids and bonded bodies, discrete elements and loose particles leave the run"),
    key("solver.domain.min", K::Point(D::LENGTH), "required", "Its lower corner; z is ignored if all bodies are 2D"),
    key("solver.domain.max", K::Point(D::LENGTH), "required", "Its upper corner, above the lower one"),
    key("solver.control", K::Choice(names::<Control>), "\"path\" where a body may be damaged; \"time\" and then \"path\" where interfaces may break; else \"time\"", "Static only. time: given steps of time. path, opening: steps of damage and of interfaces that soften, or of a crack's opening, along the path of equilibrium through snap-back"),
    key("solver.opening", K::Table, "", "With control = \"opening\", required there: how far two groups have moved apart"),
    key("solver.opening.group", K::Text, "required", "Mesh group on one side"),
    key("solver.opening.against", K::Text, "required", "Mesh group on the other side"),
    key("solver.opening.along", K::Direction, "required", "Direction in which group moves away from against"),
    key("solver.opening.step", K::Quantity(D::LENGTH), "required", "Growth of the opening in a step, > 0"),
    key("solver.opening.end", K::Quantity(D::LENGTH), "required", "Opening at which the run ends, > 0"),
    key("solver.linear_solver", K::Choice(names::<LinearSolver>), "\"auto\"", "Static with a solid, or modes. direct: Cholesky factorisation; faer: the same by the library faer; iterative: conjugate gradients; auto: direct or iterative, by size and reuse"),
    key("solver.tolerance", K::Quantity(D::NONE), "1e-4", "Static only: unbalanced force over the internal forces at which a step is accepted, above 0, at most 0.05"),
    key("solver.batch", K::Choice(names::<Batch>), "\"site\"", "Static with a bonded body. site: all overloaded particles break their bonds before equilibrium is solved again. one: only the most overloaded particle does"),
    key("solver.no_equilibrium", K::Choice(names::<NoEquilibrium>), "\"stop\"", "Static only, for a step without equilibrium. stop: the run ends. motion: the scene moves until it has come to rest"),
    key("solver.max_steps", K::Integer, "10000", "Static only: states of equilibrium after which the run ends in any case"),
    key("solver.count", K::Integer, "10", "Modes only: number of natural vibrations, the slowest ones, ≥ 1"),
    key("solver.stop_when", K::Table, "", "Ends the run once a probe has fallen below a fraction of its largest value so far"),
    key("solver.stop_when.probe", K::Text, "required", "Name of the probe"),
    key("solver.stop_when.below", K::Quantity(D::NONE), "required", "Fraction of the largest value so far, within 0 and 1"),
    key("solver.stop_when.after", K::Quantity(D::TIME), "\"0 s\"", "Not before this time"),
    key("solver.stop_when.lasting", K::Quantity(D::TIME), "a quarter of the time to the largest value, or 0 s below half of it", "The run ends once the probe has stayed below for so long, so that a small drop before the peak ends no run; \"0 s\" ends it at the first drop"),
    key("solver.accuracy", K::Quantity(D::NONE), "one run", "How far from the load of a crack on an endlessly fine mesh the result may be, from 0.2 % to 50 %: several runs on meshes that are refined where damage came, whose peaks get error bars; 0 for one run"),
    key("solver.accuracy_runs", K::Integer, "12", "Runs with damage for it at most, 4 to 100; those along a line of the crack come beside"),
    key("solver.balance_warning", K::Quantity(D::NONE), "1e-3", "Energy imbalance over external work at which to warn, > 0"),
    key("solver.balance_stop", K::Quantity(D::NONE), "1e-2", "Energy imbalance over external work at which to stop, ≥ balance_warning"),
];
