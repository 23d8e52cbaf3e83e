//! Speed of a wave [m/s].

use fractum_fem::Wave;
use fractum_scene::{Probe, ProbedScene};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;

choice!(Wave { "compression" => Compression, "shear" => Shear, "rayleigh" => Rayleigh });

/// Speed of a wave in a solid body, which does not change [m/s].
#[derive(Debug, Clone, PartialEq)]
pub struct WaveSpeed {
    /// Name of a solid body.
    pub body: Spanned<String>,
    /// Which wave.
    pub wave: Wave,
}

impl Measure for WaveSpeed {
    const KEY: &'static str = "wave_speed";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].wave_speed", K::Table, "", "Speed of a wave, for comparison, in m/s; in plane stress that in a plate. Not in bodies with beds"),
        key("probes[].wave_speed.body", K::Text, "required", "Name of a solid body"),
        key("probes[].wave_speed.wave", K::Choice(names::<Wave>), "required", "Compression wave, shear wave, or Rayleigh's surface wave, which a crack in tension cannot outrun"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let body = table.text("body").spanned().required();
        let wave = table.choice("wave").required();
        table.finish("here");
        Some((WaveSpeed { body: body?, wave: wave? }, D::VELOCITY))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let (solid, name) = (scene.solid, &self.body.value);
        let body = (0..solid.body_count()).find(|&index| solid.body(index).name == *name);
        if body.is_none() {
            scene.names.error(&self.body.place, format!("= \"{name}\""), "the name of a solid body");
        }
        if let Some(body) = body.filter(|&body| solid.body(body).bedding.is_some()) {
            let found =
                format!("= \"{}\" has beds, through which waves have speeds by direction", solid.body(body).name);
            scene.names.error(&self.body.place, found, "a body without bedding");
        }
        Some(Box::new(InBody { body: body?, wave: self.wave }))
    }
}

#[derive(Debug)]
struct InBody {
    body: usize,
    wave: Wave,
}

impl Probe for InBody {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.solid.wave_speed(self.body, self.wave)
    }
}
