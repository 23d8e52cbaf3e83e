//! What gauges will be read.

use fractum_case::model::Case;
use fractum_output::frames::BuiltGauges;

use super::Plan;

impl Plan {
    pub(super) fn describe_gauges(&mut self, case: &Case, built: &[BuiltGauges]) {
        for (gauges, BuiltGauges { name, grid }) in case.output.gauges.iter().zip(built) {
            let Some([least, most]) = grid.points_of_places() else { continue };
            let [all, label] = [gauges.count.iter().product::<usize>().to_string(), gauges.on.label().to_owned()];
            let places = format!("{name}: {} of {all} places with {least} to {most} points of {label}", grid.len());
            self.add("gauges", format!("{places} around each"));
        }
    }
}
