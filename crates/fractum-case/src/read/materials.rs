//! `[materials.NAME]`.

use fractum_fem::{Criterion, CriterionKind, DamageLaw, Regularisation, Softening};
use fractum_output::warning::Code;
use fractum_scene::{ContactParameters, damping_of_restitution};

use super::fracture::{FRICTION_ANGLE, read_friction_angle};
use crate::model::{ContactCoefficients, Damage, Material};
use crate::reader::presence::optional;
use crate::reader::{Reader, Table};
use crate::usual::{DENSITY, FRACTURE_ENERGY, STRENGTH, YOUNG_MODULUS};
use crate::{Diagnostic, Spanned};

/// Reads all materials: each with its name, and itself where nothing is wrong with it.
pub(super) fn read(root: &Table<'_>) -> Vec<(String, Option<Material>)> {
    let Some(table) = root.table("materials") else { return Vec::new() };
    let materials = table.entries().map(|entry| {
        let name = Spanned::new(entry.name.clone(), entry.key_place.clone());
        (entry.name.clone(), material(Table::new(root.reader, &entry.node, "materials.NAME"), name))
    });
    let materials = materials.collect();
    table.finish("here");
    materials
}

/// The index of the material with a name; noted where there is none.
pub(super) fn named(
    reader: &Reader,
    name: &Spanned<String>,
    materials: &[(String, Option<Material>)],
) -> Option<usize> {
    let found = materials.iter().position(|(known, _)| *known == name.value);
    if found.is_none() {
        let known = materials.iter().map(|(name, _)| name.as_str());
        let note = Diagnostic::error(&name.place, format!("= \"{}\" is not a material of this case", name.value));
        reader.note(match materials {
            [] => note.remedy("it has no [materials.NAME]"),
            _ => reader.suggest(note, &name.value, known, "materials here"),
        });
    }
    found
}

fn material(table: Table<'_>, name: Spanned<String>) -> Option<Material> {
    let density = table.quantity("density").physical().usual(&DENSITY).required();
    let young_modulus = table.quantity("young_modulus").physical().usual(&YOUNG_MODULUS).required();
    let poisson_ratio = table.quantity("poisson_ratio").between(-1.0, 0.5).required();
    let bedding = table.table("bedding").map(|table| {
        let place = table.place.clone();
        super::bedding::bedding(table, density.zip(young_modulus).zip(poisson_ratio))
            .map(|beds| Spanned::new(beds, place))
    });
    let mut damage = table.table("damage").map(|table| {
        let place = table.place.clone();
        damage(table, poisson_ratio).map(|damage| Spanned::new(damage, place))
    });
    // A damage that is wrong itself says nothing about beds.
    if let (Some(Some(beds)), None | Some(Some(_))) = (&bedding, &damage) {
        super::bedding::settle(&table, beds, damage.as_mut().and_then(Option::as_mut));
    }
    let bonds = table.table("bonds").map(|table| {
        let place = table.place.clone();
        super::bonded::bonds(table).map(|bonds| Spanned::new(bonds, place))
    });
    let interfaces = table.table("interface").map(|table| {
        let place = table.place.clone();
        let elasticity = young_modulus.zip(poisson_ratio);
        super::interface::interface(table, elasticity).map(|interfaces| Spanned::new(interfaces, place))
    });
    let fracture = table.table("fracture").map(|table| {
        let place = table.place.clone();
        super::fracture::fracture(table).map(|failure| Spanned::new(failure, place))
    });
    super::ratios::doubt(
        &table,
        density,
        young_modulus,
        damage.as_ref().and_then(Option::as_ref),
        fracture.as_ref().and_then(Option::as_ref),
    );
    let thermal = super::heat::thermal(&table);
    let contact_modulus = contact_modulus(&table);
    let contact = contact(&table, &["young_modulus"]);
    table.finish("here");
    Some(Material {
        name,
        density: density?,
        young_modulus: young_modulus?,
        poisson_ratio: poisson_ratio?,
        bedding: bedding.map_or(Some(None), |bedding| bedding.map(Some))?,
        damage: damage.map_or(Some(None), |damage| damage.map(Some))?,
        bonds: bonds.map_or(Some(None), |bonds| bonds.map(Some))?,
        interfaces: interfaces.map_or(Some(None), |interfaces| interfaces.map(Some))?,
        fracture: fracture.map_or(Some(None), |fracture| fracture.map(Some))?,
        thermal: thermal?,
        contact: contact.over(ContactParameters::default()),
        contact_modulus: contact_modulus?,
        work_of_adhesion: contact.work_of_adhesion.unwrap_or(0.0),
    })
}

fn damage(table: Table<'_>, poisson_ratio: Option<f64>) -> Option<Damage> {
    let criterion = table.choice("criterion").or(CriterionKind::Rankine);
    let criterion = match criterion {
        CriterionKind::MohrCoulomb if !table.flag("tension_cutoff").or(true) => CriterionKind::PureMohrCoulomb,
        CriterionKind::MohrCoulomb => CriterionKind::MohrCoulomb,
        _ => {
            table.refuse("tension_cutoff", "with this criterion, only with mohr-coulomb");
            criterion
        }
    };
    if criterion == CriterionKind::PureMohrCoulomb
        && let Some(node) = table.node("tension_cutoff")
    {
        let note = Diagnostic::warning(Code::TensionCutoff, &node.place, node.found());
        table.reader.note(note.remedy("pure Mohr-Coulomb loses about a fifth of the strength in Brazilian tests"));
    }
    let tensile_strength = table.quantity("tensile_strength").physical().usual(&STRENGTH).required();
    let fracture_energy = table.quantity("fracture_energy").physical().usual(&FRACTURE_ENERGY).required();
    let friction_angle = if criterion.uses_friction_angle() {
        read_friction_angle(&table)
    } else {
        table.refuse("friction_angle", "with this criterion");
        FRICTION_ANGLE.to_radians()
    };
    let compressive_strength = compressive_strength(&table, criterion, friction_angle, tensile_strength);
    let softening = softening(&table);
    let residual = table.quantity("residual").between(0.0, 1.0).or(0.02);
    let scatter = table.table("scatter").map(super::scatter::of_edges);
    let reduce_strength_to_fit = table.flag("reduce_strength_to_fit").or(false);
    let regularisation = regularisation(&table);
    let friction = optional(&table, "friction", |key| friction(&table, key));
    if friction.is_some_and(|friction| friction.is_some()) {
        table.refuse("unilateral", "with friction, whose cracks close");
    }
    let unilateral = optional(&table, "unilateral", |key| table.flag(key).given());
    let rate_time = table.quantity("rate_time").not_negative().or(0.0);
    let strength_ratio = compressive_strength.zip(tensile_strength).map(|(compressive, tensile)| compressive / tensile);
    let rate =
        table.table("rate").map(|rate| super::rate::read(rate, criterion, strength_ratio, table.is_overridden()));
    table.finish("here");
    let is_spread = matches!(regularisation, Some(Some(_)));
    let tensile_strength = tensile_strength?;
    let strength_ratio = compressive_strength? / tensile_strength;
    Some(Damage {
        law: DamageLaw {
            criterion: Criterion::new(criterion, friction_angle, strength_ratio, poisson_ratio?),
            tensile_strength,
            fracture_energy: fracture_energy?,
            softening: softening?,
            residual,
            unilateral: false,
            friction: friction?.filter(|_| !is_spread),
            rate_time,
            beds: None,
        },
        unilateral: unilateral?,
        scatter: scatter.map_or(Some(None), |scatter| scatter.map(Some))?,
        reduce_strength_to_fit,
        regularisation: regularisation?,
        rate: rate.map_or(Some(None), |rate| rate.map(Some))?,
    })
}

/// Coefficient of friction of closed cracks.
fn friction(damage: &Table<'_>, key: &'static str) -> Option<f64> {
    damage
        .quantity(key)
        .not_negative()
        .check(|friction| *friction < 1.0, "below 1, beyond which nothing slides")
        .given()
}

/// Compressive over tensile strength where it is not given.
pub(super) const STRENGTH_RATIO: f64 = 10.0;

/// The compressive strength, high enough for the criterion to give the tensile strength in tension.
fn compressive_strength(
    table: &Table<'_>,
    criterion: CriterionKind,
    friction_angle: f64,
    tensile_strength: Option<f64>,
) -> Option<f64> {
    if !criterion.uses_compressive_strength() {
        table.refuse("compressive_strength", "with this criterion");
        return tensile_strength.map(|strength| STRENGTH_RATIO * strength);
    }
    let given = table.quantity("compressive_strength").physical().usual(&STRENGTH);
    let tensile_strength = tensile_strength?;
    let given = given.check(|strength| *strength > tensile_strength, "more than the tensile strength");
    let strength = given.or_if_absent(STRENGTH_RATIO * tensile_strength)?;
    let least = tensile_strength * criterion.least_strength_ratio(friction_angle);
    if strength < least {
        let place = table.peek("compressive_strength").map_or_else(|| table.place.clone(), |node| node.place.clone());
        let found = format!("is {strength} Pa as compressive strength, too low for its friction angle");
        let note = Diagnostic::error(&place, found).expected(format!("at least {least} Pa"));
        table.reader.note(note.remedy("raise compressive_strength or lower friction_angle"));
        return None;
    }
    Some(strength)
}

/// The curves by name; the bilinear one is that of Petersson (1981).
static SOFTENINGS: &[(&str, Softening)] = &[
    ("exponential", Softening::Exponential),
    ("linear", Softening::Linear),
    ("bilinear", bilinear(1.0 / 3.0, 2.0 / 9.0)),
];

/// The bilinear curve from the opening at the kink as a fraction of the last one, 2 Gf/(ft (stress + fraction)).
const fn bilinear(stress: f64, fraction: f64) -> Softening {
    Softening::Bilinear { stress, opening: 2.0 * fraction / (stress + fraction) }
}

/// The phase field with its length; `Some(None)` where there is none.
fn regularisation(damage: &Table<'_>) -> Option<Option<Regularisation>> {
    let on = damage.one_of("regularisation", &[("none", false), ("phase-field", true)]).or_if_absent(false)?;
    if !on {
        damage.refuse("length", "without regularisation");
        return Some(None);
    }
    damage.refuse("rate_time", "with a phase field, whose energy it would raise");
    damage.refuse("friction", "with a phase field: cracks of local damage alone rub");
    damage.refuse("rate", "with a phase field, whose edges have no strength of their own");
    let length = damage.quantity("length").positive().map(Some).or_if_absent(None)?;
    Some(Some(Regularisation { length }))
}

/// By name, or as a table with parameters.
fn softening(damage: &Table<'_>) -> Option<Softening> {
    if !damage.holds_table("softening") {
        return damage.one_of("softening", SOFTENINGS).or_if_absent(Softening::Exponential);
    }
    let table = damage.table("softening")?;
    let softening = table.one_of("kind", SOFTENINGS).required();
    let softening = match softening {
        Some(Softening::Bilinear { .. }) => Some(bilinear(
            table.quantity("kink_stress").between(0.0, 1.0).or(1.0 / 3.0),
            table.quantity("kink_opening").between(0.0, 1.0).or(2.0 / 9.0),
        )),
        _ => {
            table.refuse("kink_stress", "with this softening, only with bilinear");
            table.refuse("kink_opening", "with this softening, only with bilinear");
            softening
        }
    };
    table.finish("here");
    softening
}

/// Young's modulus of contacts; `Some(None)` where nothing is said.
fn contact_modulus(parent: &Table<'_>) -> Option<Option<f64>> {
    let contact = parent.table_or_empty("contact");
    contact.quantity("young_modulus").physical().usual(&YOUNG_MODULUS).map(Some).or_if_absent(None)
}

/// The `contact` table of a material or rigid body, as far as it gives coefficients.
///
/// - `apart`: keys that are read by themselves
pub(super) fn contact(parent: &Table<'_>, apart: &[&'static str]) -> ContactCoefficients {
    let table = parent.table_or_empty("contact");
    for key in apart {
        table.node(key);
    }
    let coefficients = coefficients(&table);
    table.finish("here");
    coefficients
}

/// Coefficients of contact in a table.
pub(super) fn coefficients(table: &Table<'_>) -> ContactCoefficients {
    let damping_ratio = if table.has("restitution") {
        table.refuse("damping_ratio", "beside restitution, from which it follows");
        let restitution = table.quantity("restitution").check(|e| *e > 0.0 && *e <= 1.0, "above 0, at most 1");
        restitution.map(damping_of_restitution).given()
    } else {
        table.quantity("damping_ratio").check(|ratio| (0.0..=1.0).contains(ratio), "from 0 to 1").given()
    };
    ContactCoefficients {
        friction: table.quantity("friction").not_negative().coefficient().given(),
        rolling_friction: table.quantity("rolling_friction").not_negative().given(),
        damping_ratio,
        work_of_adhesion: table.quantity("work_of_adhesion").not_negative().given(),
    }
}
