//! Strength by chance in the plan of a run.

use fractum_case::build::WeibullReport;
use fractum_case::model::{BodyKind, Case, Distribution, Reference};
use fractum_fem::{IN_RESERVE, RateCurves};
use fractum_output::number::quantity;
use fractum_scene::Scene;

use super::Plan;

impl Plan {
    /// How much stronger bodies may get by the rate of strain, and what their elements permit of it.
    pub(super) fn describe_rates(&mut self, case: &Case, scene: &Scene) {
        let solids = case.bodies.iter().filter_map(|body| match &body.kind {
            BodyKind::Solid(solid) => Some((&body.name.value, solid)),
            _ => None,
        });
        for (index, (name, solid)) in solids.enumerate() {
            let damage = case.materials[solid.material].damage.as_ref().filter(|_| solid.damage);
            let Some(rate) = damage.and_then(|damage| damage.value.rate.as_ref()) else { continue };
            let RateCurves { strength, compression, energy } = &rate.value;
            let range = |curve: &[[f64; 2]]| {
                if curve.is_empty() {
                    return "as it is".to_owned();
                }
                let factors = || curve.iter().map(|point| point[1]);
                let (least, most) = (factors().fold(f64::INFINITY, f64::min), factors().fold(0.0, f64::max));
                let [first, last] = [curve.first(), curve.last()].map(|point| point.map_or(0.0, |point| point[0]));
                let rates = [first, last].map(|rate| quantity(rate, "1/s"));
                format!("{least:.2} to {most:.2} times from {} to {}", rates[0], rates[1])
            };
            let mut text = format!("{name}: by the rate of strain {} in tension", range(strength));
            if let Some((curve, _)) = compression {
                text += &format!(", {} in compression", range(curve));
            }
            if !energy.is_empty() {
                text += &format!("; fracture energy {}", range(energy));
            }
            self.add("rate", text);
            // The largest length goes with one over the strength squared.
            let ratio = scene.solid.length_report(index).largest_ratio;
            let most = (ratio.max(IN_RESERVE) / ratio).sqrt();
            let grows = if energy.is_empty() { "" } else { ", more where the fracture energy grows" };
            self.add(
                "",
                format!(
                    "its largest elements permit {most:.2} times{grows}; what exceeds this is cut and told at the end"
                ),
            );
        }
    }

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
