//! Grids of places with displacement and strain.

use fractum_fem::Solid;
use fractum_output::frames::BuiltGauges;
use fractum_scene::{Bonded, GaugeGrid, Population};

use super::Context;
use super::bodies::Numbering;
use crate::model::Gauges;

impl Context<'_> {
    /// The grids of the case.
    pub(super) fn gauges(&mut self, numbering: &Numbering, solid: &Solid, bonded: &Bonded) -> Vec<BuiltGauges> {
        let case = self.case;
        case.output.gauges.iter().filter_map(|gauges| self.gauge_grid(gauges, numbering, solid, bonded)).collect()
    }

    fn gauge_grid(
        &mut self,
        gauges: &Gauges,
        numbering: &Numbering,
        solid: &Solid,
        bonded: &Bonded,
    ) -> Option<BuiltGauges> {
        let (population, set) = match gauges.on.group.as_ref().filter(|_| self.names_particles(&gauges.on)) {
            Some(group) => (Population::Particles, self.selected_particles(&gauges.on, group, bonded)),
            None => (Population::Nodes, self.selected_nodes(&gauges.on, numbering)),
        };
        let places = gauges.places();
        let grid = GaugeGrid::new((bonded, solid), population, &set, &places, gauges.length.value);
        if grid.is_empty() && !set.is_empty() {
            let found = format!(
                ": none of {} places has points of \"{}\" within half of it that span a plane",
                places.len(),
                gauges.on.label()
            );
            self.error(&gauges.length.place, found, "several times the distance of the points, and a grid on the body");
        }
        (!grid.is_empty()).then(|| BuiltGauges { name: gauges.name.value.clone(), grid })
    }
}
