//! A natural vibration: its frequency [1/s], or the share of the mass that it moves along an axis.

use fractum_scene::statics::modes_of;
use fractum_scene::{Probe, ProbedScene};

use super::Measure;
use super::scenery::Scenery;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;
use crate::{Place, Spanned};

/// What is measured of a vibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OfMode {
    /// Vibrations in a second.
    Frequency,
    /// Share of the mass that a motion of the ground along x sets in motion in it.
    MassX,
    /// The same along y.
    MassY,
    /// The same along z.
    MassZ,
}

choice!(OfMode { "frequency" => Frequency, "mass-x" => MassX, "mass-y" => MassY, "mass-z" => MassZ });

/// A natural vibration by its number.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeOf {
    /// Number, from 1.
    pub number: Spanned<usize>,
    /// What is measured of it.
    pub of: OfMode,
}

impl Measure for ModeOf {
    const KEY: &'static str = "mode";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].mode", K::Table, "", "A natural vibration, with solver.kind = \"modes\""),
        key("probes[].mode.number", K::Integer, "required", "Its number, from 1; rigid motions are not counted"),
        key("probes[].mode.of", K::Choice(names::<OfMode>), "\"frequency\"", "Its frequency, in 1/s; or the share of the free mass that a motion of the ground along an axis sets in motion in it"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let place = table.peek("number").map_or_else(|| table.place_of("number"), |node| node.place.clone());
        let number = table.integer("number").check(|&number| number > 0, "at least 1").required();
        let of = table.choice("of").or(OfMode::Frequency);
        table.finish("here");
        let dimension = if of == OfMode::Frequency { D::RATE } else { D::NONE };
        Some((ModeOf { number: Spanned { value: number? as usize, place }, of }, dimension))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let Spanned { value: number, place } = &self.number;
        let most = scene.names.vibrations();
        if *number > most {
            let expected = match most {
                0 => "solver.kind = \"modes\", which alone finds natural vibrations".to_owned(),
                most => format!("at most solver.count, which is {most}"),
            };
            note(scene, place, *number, &expected);
        }
        Some(Box::new(NaturalVibration { index: number.checked_sub(1)?, of: self.of }))
    }
}

fn note(scene: &mut Scenery<'_>, place: &Place, number: usize, expected: &str) {
    scene.names.error(place, format!("= {number}"), expected);
}

#[derive(Debug)]
struct NaturalVibration {
    index: usize,
    of: OfMode,
}

impl Probe for NaturalVibration {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let Some((modes, mode)) = modes_of(probed.scene).and_then(|all| Some((all, all.modes.get(self.index)?))) else {
            return f64::NAN;
        };
        match self.of {
            OfMode::Frequency => mode.frequency,
            OfMode::MassX => modes.mass_share(mode).x,
            OfMode::MassY => modes.mass_share(mode).y,
            OfMode::MassZ => modes.mass_share(mode).z,
        }
    }
}
