//! The time step in the plan.

use fractum_case::model::{Case, StopWhen};
use fractum_output::number::{percent, quantity};
use fractum_scene::Scene;

use super::{Plan, interfaces};

impl Plan {
    /// The step, what asks for it, and how many there are.
    pub(super) fn describe_time(&mut self, case: &Case, scene: &Scene, span: f64) {
        let governing = match scene.governing_element() {
            _ if scene.given_velocities_govern() => "given velocities, which change from node to node".to_owned(),
            Some(stable) => {
                let (body, element) = stable.governing;
                format!("element {element} of {}", scene.solid.body(body).name)
            }
            None if scene.contacts_govern() && scene.bonded.is_empty() => "the contacts of solids".to_owned(),
            None if scene.contacts_govern() => "the contacts of particles".to_owned(),
            None => "the bonds".to_owned(),
        };
        let shorter = interfaces::shortened(scene).map_or_else(String::new, |shorter| format!("; {shorter}"));
        self.add(
            "time step",
            format!(
                "{} ({} the stable {}), governed by {governing}{shorter}",
                quantity(scene.clock.dt_after, "s"),
                if case.solver.step.is_some() {
                    "fixed, below".to_owned()
                } else {
                    format!("{} of", case.solver.safety)
                },
                quantity(scene.stable_dt(), "s")
            ),
        );
        if case.solver.subcycling.is_some() {
            self.add("subcycling", subcycling(scene));
        }
        let steps = (span / scene.clock.dt_after).ceil();
        self.add("steps", format!("{steps} to t = {}", quantity(case.solver.end, "s")));
    }
}

/// When a run ends before its time.
pub(super) fn early_end(case: &Case) -> Option<String> {
    let stop = case.solver.stop_when.as_ref()?;
    let (name, part) = (&case.probes[stop.probe].name.value, percent(stop.below));
    let [deep, share] = [StopWhen::DEEP, StopWhen::SHARE].map(percent);
    let lasting = match stop.lasting {
        Some(0.0) => String::new(),
        Some(lasting) => format!(" for {}", quantity(lasting, "s")),
        None if stop.below <= StopWhen::DEEP => String::new(),
        None => format!(" for {share} of the time that the peak took, or below {deep} of it"),
    };
    let after =
        if stop.after > 0.0 { format!(", not before t = {}", quantity(stop.after, "s")) } else { String::new() };
    Some(format!("once {name} is below {part} of its peak{lasting}{after}"))
}

/// How cells share the steps.
fn subcycling(scene: &Scene) -> String {
    match scene.subcycling() {
        None => "none: the elements are too much alike for it".to_owned(),
        Some((1, ..)) => "none: contacts ask for short steps everywhere".to_owned(),
        Some((parts, share, linked)) => {
            let cost = (1.0 + f64::from(parts - 1) * share) / f64::from(parts);
            format!(
                "{:.1} % of the cells take {parts} short steps in one of the others, {linked} nodes are linked; about {:.1} times less work",
                100.0 * share,
                1.0 / cost
            )
        }
    }
}
