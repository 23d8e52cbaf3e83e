//! Strength by chance in the plan of a run.

use fractum_case::build::WeibullReport;
use fractum_case::model::{BodyKind, Case, Distribution, Reference};
use fractum_output::number::quantity;

use super::Plan;

impl Plan {
    pub(super) fn describe_scatter(&mut self, case: &Case, weibull: &[WeibullReport]) {
        for report in weibull {
            let WeibullReport { body, measure, correlation_length, grows, sizes, mean, variation, reference, weakest } =
                report;
            let (what, unit) = match reference {
                Reference::Volume(_) => ("volume", "m^3"),
                Reference::Area(_) => ("free surface", "m^2"),
            };
            let mean = quantity(*mean, "Pa");
            self.add("strength", format!(
                "{body}: {mean} on average under uniform tension, coefficient of variation {:.1} %, by its {what} of {} (reference {})",
                100.0 * variation,
                quantity(*measure, unit),
                quantity(reference.measure(), unit)
            ));
            let spot = quantity(*correlation_length, "m");
            let grows =
                if *grows { "at the strength given, and weaker flaws larger ones" } else { "whatever its strength" };
            self.add(
                "",
                format!("a flaw weakens a place {spot} across ({sizes:.1} times the mean element or particle) {grows}"),
            );
            if let Some((strength, place)) = weakest {
                let [x, y, z] = [place.x, place.y, place.z].map(|x| quantity(x, "m"));
                let strength = quantity(*strength, "Pa");
                self.add("", format!("with this seed the weakest flaw bears {strength}, at ({x}, {y}, {z})"));
            }
        }
        for body in &case.bodies {
            let BodyKind::Solid(solid) = &body.kind else { continue };
            let damage = case.materials[solid.material].damage.as_ref().filter(|_| solid.damage);
            let own = damage.and_then(|damage| damage.value.scatter).is_some_and(|scatter| {
                matches!(
                    scatter.distribution,
                    Distribution::WeibullPerEdge { .. } | Distribution::UniformPerEdge { .. }
                )
            });
            if own {
                self.add("strength", format!(
                    "{}: every edge draws its own factor, so that finer meshes are weaker and scatter less; distribution = \"weibull\" with a reference_volume is the same on any mesh",
                    body.name.value
                ));
            }
        }
    }
}
