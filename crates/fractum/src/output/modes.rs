//! Natural vibrations in `modes.csv` and `summary.json`.

use fractum_output::number::push_shortest;
use fractum_output::summary::{NaturalVibration, NaturalVibrations};
use fractum_scene::{Mode, Modes};

/// As `summary.json` has them.
pub(crate) fn of_summary(found: &Modes) -> NaturalVibrations {
    let of = |mode: &Mode| NaturalVibration {
        frequency: mode.frequency,
        participation: mode.participation.into(),
        mass_share: found.mass_share(mode).into(),
        residual: mode.residual,
    };
    NaturalVibrations {
        pieces: found.pieces as u64,
        rigid_motions: found.rigid_motions as u64,
        mechanisms: found.mechanisms as u64,
        free_mass: found.free_mass.into(),
        vibrations: found.modes.iter().map(of).collect(),
    }
}

const HEAD: &str = "mode,frequency [1/s],period [s],participation x [sqrt(kg)],participation y [sqrt(kg)],\
                    participation z [sqrt(kg)],mass share x,mass share y,mass share z,residual\n";

/// The table of vibrations.
pub(crate) fn to_csv(found: &NaturalVibrations) -> String {
    let mut text = HEAD.to_owned();
    for (number, mode) in (1..).zip(&found.vibrations) {
        text += &format!("{number}");
        let values =
            [mode.frequency, 1.0 / mode.frequency].into_iter().chain(mode.participation).chain(mode.mass_share);
        for value in values.chain([mode.residual]) {
            text.push(',');
            push_shortest(&mut text, value);
        }
        text.push('\n');
    }
    text
}
