//! Heat in the plan.

use fractum_case::model::{Case, HeatKind};
use fractum_output::number::quantity;
use fractum_scene::{PackingReport, Scene};

use super::Plan;

impl Plan {
    /// What conducts, what heats, and the steps.
    pub(super) fn describe_heat(&mut self, case: &Case, scene: &Scene) {
        let (Some(own), Some(heat)) = (&case.flows.heat, scene.heat()) else { return };
        let [points, pairs] = heat.counts();
        self.add("heat", format!("{points} points, {pairs} pairs that conduct"));
        for PackingReport { name, conductivity, capacity, corrected } in heat.packings() {
            let end = if *corrected { "; both corrected to those of the material" } else { "" };
            let share = match conductivity.is_nan() {
                true => "conductivity not found".to_owned(),
                false => format!("{conductivity:.3} of the conductivity"),
            };
            let text = format!("{name}: by the table {share}, {capacity:.3} of the heat capacity");
            self.add("", text + end);
        }
        for condition in &own.conditions {
            let what = match &condition.kind {
                HeatKind::Temperature(_) => "prescribed temperature".to_owned(),
                HeatKind::Flux(_) => "heat flux".to_owned(),
                HeatKind::Power(_) => "heating power".to_owned(),
                HeatKind::Source(_) => "heat source".to_owned(),
                HeatKind::Convection { coefficient, .. } => {
                    format!("convection, {}", quantity(*coefficient, "W/(m^2 K)"))
                }
            };
            self.add("", format!("{}: {what}", condition.on.label()));
        }
        let scheme = if heat.is_implicit() { "implicit" } else { "explicit" };
        let (step, stable) = (heat.step_size().min(case.solver.end), heat.stable_step());
        let count = (case.solver.end / step).ceil();
        let (step, stable) = (quantity(step, "s"), quantity(stable, "s"));
        let end = quantity(case.solver.end, "s");
        self.add(
            "",
            format!(
                "{scheme} steps of up to {step} (explicit ones are stable up to {stable}), about {count} to t = {end}"
            ),
        );
    }
}
