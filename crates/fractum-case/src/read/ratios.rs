//! Ratios of the values of a material that tell a wrong unit where each value alone is possible.

use fractum_fem::DamageLaw;
use fractum_output::number::{quantity, significant};
use fractum_output::warning::Code;

use crate::model::{BondFailure, Damage};
use crate::reader::Table;
use crate::usual::{DENSITY, PROCESS_ZONES, STRENGTH, YOUNG_MODULUS, energy_meant};
use crate::{Diagnostic, Spanned};

/// Tensile strength over Young's modulus [-]: theory gives a tenth at most; the weakest soil has 1e-6.
const STRAIN: std::ops::RangeInclusive<f64> = 1e-7..=0.2;

/// Speed of waves in the stiffest solids [m/s]: diamond has 18 km/s.
const WAVE: f64 = 2e4;

/// Warns of a density that makes waves faster than any solid has them.
fn doubt_wave(material: &Table<'_>, density: f64, young: f64) {
    let wave = (young / density).sqrt();
    let Some(node) = material.node_below("density").filter(|_| wave > WAVE) else { return };
    let found = format!(
        "is {}, which with young_modulus, {}, gives waves of {}",
        quantity(density, "kg/m^3"),
        quantity(young, "Pa"),
        quantity(wave, "m/s")
    );
    let note = Diagnostic::warning(Code::UnusualValue, &node.place, found).expected("at most 20 km/s (steel has 5)");
    let meant = DENSITY.meant(node, density).filter(|_| (young / (1e3 * density)).sqrt() <= WAVE);
    material.reader.note(match meant {
        Some(meant) => note.remedy(format!("did you mean \"{meant}\"?")),
        None => note.remedy("check the units of both"),
    });
}

/// Warns of a density and of a strength that do not suit the modulus, and of a fracture energy that does not suit both.
pub(super) fn doubt(
    material: &Table<'_>,
    density: Option<f64>,
    young_modulus: Option<f64>,
    damage: Option<&Spanned<Damage>>,
    fracture: Option<&Spanned<BondFailure>>,
) {
    // What is doubted by itself makes every ratio wrong.
    let Some(young) = young_modulus.filter(|young| YOUNG_MODULUS.is_usual(*young)) else { return };
    if let Some(density) = density.filter(|density| DENSITY.is_usual(*density)) {
        doubt_wave(material, density, young);
    }
    let of_damage = damage.map(|damage| ("damage", damage.value.law.tensile_strength));
    let of_bonds = fracture.and_then(|failure| Some(("fracture", failure.value.strength.tensile_strength?)));
    let mut doubted = false;
    for (table, strength) in of_damage.into_iter().chain(of_bonds) {
        if !STRENGTH.is_usual(strength) {
            doubted = true;
        } else if !STRAIN.contains(&(strength / young)) {
            doubted = true;
            let place = material.place_below(&format!("{table}.tensile_strength"));
            let ratio = significant(strength / young, 2);
            let [strength, young] = [strength, young].map(|stress| quantity(stress, "Pa"));
            let found = format!("is {strength}, {ratio} of young_modulus, which is {young}");
            let note = Diagnostic::warning(Code::UnusualValue, &place, found)
                .expected("1e-7 to 0.2 of it (concrete has 1e-4)");
            material.reader.note(note.remedy("check the units of both"));
        }
    }
    let Some(law) = damage.map(|damage| &damage.value.law).filter(|_| !doubted) else { return };
    let zone = law.process_zone(young);
    if PROCESS_ZONES.contains(&zone) {
        return;
    }
    let place = material.place_below("damage.fracture_energy");
    let found = format!(
        "is {}, so that the process zone E Gf/ft^2 is {} long",
        quantity(law.fracture_energy, "J/m^2"),
        quantity(zone, "m")
    );
    let note = Diagnostic::warning(Code::UnusualValue, &place, found)
        .expected("1 um to 100 m (ceramics have 0.1 mm, concrete 0.3 m)");
    let meant = material.node_below("damage.fracture_energy");
    let suits = |fracture_energy: f64| {
        PROCESS_ZONES.contains(&DamageLaw { fracture_energy, ..law.clone() }.process_zone(young))
    };
    let meant = meant.and_then(|node| energy_meant(node, suits));
    material.reader.note(match meant {
        Some(meant) => note.remedy(format!("did you mean \"{meant}\"?")),
        None => note.remedy("check the units of young_modulus, tensile_strength and fracture_energy"),
    });
}
