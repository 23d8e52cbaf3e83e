//! Grids of places with displacement and strain, and extensometers.

use fractum_fem::Solid;
use fractum_math::Vec3;
use fractum_scene::{Bonded, Extensometer, GaugeGrid, Population, Probe};

use super::Context;
use super::bodies::Numbering;
use crate::case::model::{Gauges, Selection};

/// A grid of places with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltGauges {
    /// Name of its files.
    pub name: String,
    /// The grid, with a place at least.
    pub grid: GaugeGrid,
}

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

    /// An extensometer on nodes or particles; an error where both feet have one place.
    pub(super) fn extensometer(
        &mut self,
        scene: (&Bonded, &Solid),
        (population, points): (Population, &[u32]),
        on: &Selection,
        (ends, foot): ([Vec3; 2], Option<f64>),
    ) -> Option<Probe> {
        if points.is_empty() {
            return None; // told where they were chosen
        }
        let probe = Extensometer::new(scene, population, points, ends, foot);
        if probe.is_none() {
            let place = on.place().cloned().unwrap_or_else(|| self.whole_case());
            let found = format!("= \"{}\": both feet are on the same of its {} points", on.label(), points.len());
            self.error(&place, found, "places with points of their own");
        }
        probe.map(Probe::Extensometer)
    }
}
