//! What a quasi-static run needs, and what it cannot do.

use fractum_fem::{NotSecant, Solid};
use fractum_scene::Supports;
use fractum_scene::statics::{self, StaticSettings, check_supports};

use super::Context;
use crate::case::Place;
use crate::case::model::{BodyKind, Control, LinearSolver};

/// Relative residual of iterative linear solutions.
const LINEAR_TOLERANCE: f64 = 1e-8;
/// Steps of the load parameter where something may break.
const STEPS: f64 = 50.0;

impl Context<'_> {
    /// Settings of the static solver; none for other solvers, or with errors noted.
    pub(super) fn statics(&mut self, solid: &Solid, supports: &Supports) -> Option<StaticSettings> {
        let solver = &self.case.solver;
        let options = solver.statics?;
        let place = self.place_of_solver();
        if let Some((body, why)) = solid.not_secant() {
            let found = match why {
                NotSecant::Corotational => "kinematics = \"corotational\"",
                NotSecant::Unilateral => "damage.unilateral = true",
                NotSecant::Rate => "damage.rate_time",
            };
            let found = format!(" = \"static\" with {found} in body \"{}\"", solid.body(body).name);
            self.error(&place, found, "small strains, open cracks and damage without delay; or kind = \"explicit\"");
        }
        if let Some(body) = self.case.bodies.iter().find(|body| !matches!(body.kind, BodyKind::Solid(_))) {
            let found = format!(" = \"static\" with body \"{}\"", body.name.value);
            self.error(&place, found, "solid bodies only; or kind = \"explicit\"");
            return None;
        }
        if let Err(error) = check_supports(solid, supports.held()) {
            let remedy = if supports.count() == 0 { "at least one [[supports]]" } else { "" };
            self.error(&place, format!(" = \"static\": {error}"), remedy);
        }
        let damage = solid.has_damage();
        let whole = if damage { solver.end / STEPS } else { solver.end };
        Some(StaticSettings {
            control: match options.control {
                Some(Control::Time) => statics::Control::Time,
                Some(Control::Path) => statics::Control::Path,
                None if damage => statics::Control::Path,
                None => statics::Control::Time,
            },
            step: solver.step.as_ref().map_or(whole, |step| step.value.min(solver.end)),
            end: solver.end,
            most_steps: options.most_steps,
            tolerance: options.tolerance,
            linear_tolerance: LINEAR_TOLERANCE,
            linear: match options.linear_solver {
                LinearSolver::Auto => statics::LinearSolver::Auto,
                LinearSolver::Direct => statics::LinearSolver::Direct,
                LinearSolver::Iterative => statics::LinearSolver::Iterative,
            },
        })
    }

    fn place_of_solver(&self) -> Place {
        Place { key: "solver.kind".to_owned(), ..self.whole_case() }
    }
}
