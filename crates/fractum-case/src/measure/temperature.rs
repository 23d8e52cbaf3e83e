//! Temperature of points [K].

use fractum_scene::{Population, Probe, ProbedScene, TemperatureTake};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection, selection};
use crate::unit::Dimension as D;

choice!(TemperatureTake { "mean" => Mean, "lowest" => Lowest, "highest" => Highest });

/// Temperature of points [K].
#[derive(Debug, Clone, PartialEq)]
pub struct Temperature {
    /// Of these nodes or particles.
    pub on: Selection,
    /// Which of them.
    pub take: TemperatureTake,
}

impl Measure for Temperature {
    const KEY: &'static str = "temperature";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].temperature", K::Table, "", "Temperature of a group's nodes or particles, in K"),
        key("probes[].temperature.group", K::Text, "", "Mesh group or set of particles; required without `where`"),
        key("probes[].temperature.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].temperature.take", K::Choice(names::<TemperatureTake>), "\"mean\"", "Mean, weighted by heat capacities, or an extreme"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let on = selection(&table);
        let take = table.choice("take").or_if_absent(TemperatureTake::Mean);
        table.finish("here");
        Some((Temperature { on: on?, take: take? }, D::TEMPERATURE))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let (population, points) = scene.points(&self.on);
        Some(Box::new(OfPoints { population, points, take: self.take }))
    }
}

/// Not a number without heat.
#[derive(Debug)]
struct OfPoints {
    population: Population,
    points: Vec<u32>,
    take: TemperatureTake,
}

impl Probe for OfPoints {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let of_particles = self.population == Population::Particles;
        probed.scene.heat().map_or(f64::NAN, |heat| heat.temperature_of(of_particles, &self.points, self.take))
    }
}
