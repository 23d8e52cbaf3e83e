//! One table of laws, each held against its properties with numbers drawn from the whole range that a case may give.
//!
//! A new law is a new row. A failure names the row and the draw, which is the same on every machine.

mod bedding;
mod beds;
mod bond;
mod contact;
mod damage;
mod draw;
mod interface;
mod liquid;
mod material;
mod rate;

use fractum_kernels::bond::InterfaceFailure;
use fractum_kernels::material::{CriterionKind, Plane, Softening};

use draw::{Row, bilinear, try_all};

const LAWS: &[Row] = &[
    Row { law: "elasticity in space", holds: |draw| material::elasticity(draw, None) },
    Row { law: "elasticity, plane strain", holds: |draw| material::elasticity(draw, Some(Plane::Strain)) },
    Row { law: "elasticity, plane stress", holds: |draw| material::elasticity(draw, Some(Plane::Stress)) },
    Row { law: "negative part", holds: material::negative_part },
    Row { law: "softening, exponential", holds: |draw| material::softening(draw, Softening::Exponential) },
    Row { law: "softening, linear", holds: |draw| material::softening(draw, Softening::Linear) },
    Row {
        law: "softening, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            material::softening(draw, curve)
        },
    },
    Row { law: "degradation, exponential", holds: |draw| material::degradation(draw, Softening::Exponential) },
    Row { law: "degradation, linear", holds: |draw| material::degradation(draw, Softening::Linear) },
    Row {
        law: "degradation, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            material::degradation(draw, curve)
        },
    },
    Row { law: "criterion, Rankine", holds: |draw| material::criterion(draw, CriterionKind::Rankine) },
    Row {
        law: "criterion, Mohr-Coulomb with a tension cut-off",
        holds: |draw| material::criterion(draw, CriterionKind::MohrCoulomb),
    },
    Row { law: "criterion, Mohr-Coulomb", holds: |draw| material::criterion(draw, CriterionKind::PureMohrCoulomb) },
    Row { law: "criterion, Drucker-Prager", holds: |draw| material::criterion(draw, CriterionKind::DruckerPrager) },
    Row { law: "criterion, Mazars", holds: |draw| material::criterion(draw, CriterionKind::Mazars) },
    Row {
        law: "criterion, modified Mohr-Coulomb",
        holds: |draw| material::criterion(draw, CriterionKind::ModifiedMohrCoulomb),
    },
    Row {
        law: "contact, linear, spheres",
        holds: |draw| {
            let law = contact::linear_spheres(draw);
            contact::contact(draw, law, false)
        },
    },
    Row {
        law: "contact, linear, discs",
        holds: |draw| {
            let law = contact::linear_discs(draw);
            contact::contact(draw, law, false)
        },
    },
    Row {
        law: "contact, Hertz and Mindlin",
        holds: |draw| {
            let law = contact::hertz(draw);
            contact::contact(draw, law, true)
        },
    },
    Row {
        law: "contact, flat",
        holds: |draw| {
            let law = contact::hertz_flat(draw);
            contact::contact(draw, law, true)
        },
    },
    Row {
        law: "contact, discs",
        holds: |draw| {
            let law = contact::discs(draw);
            contact::contact(draw, law, true)
        },
    },
    Row { law: "contact, discs, restitution", holds: contact::rebound_of_discs },
    Row { law: "contact, adhesion", holds: contact::adhesion },
    Row { law: "restitution", holds: contact::restitution },
    Row { law: "edge, exponential", holds: |draw| damage::way(draw, Softening::Exponential, false) },
    Row { law: "edge, linear", holds: |draw| damage::way(draw, Softening::Linear, false) },
    Row {
        law: "edge, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            damage::way(draw, curve, false)
        },
    },
    Row { law: "edge whose crack closes, exponential", holds: |draw| damage::way(draw, Softening::Exponential, true) },
    Row { law: "edge whose crack closes, linear", holds: |draw| damage::way(draw, Softening::Linear, true) },
    Row {
        law: "edge whose crack closes, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            damage::way(draw, curve, true)
        },
    },
    Row {
        law: "bond, cohesive beam",
        holds: |draw| {
            let law = bond::beam(draw);
            bond::bond(draw, law)
        },
    },
    Row {
        law: "bond, interface",
        holds: |draw| {
            let law = bond::interface(draw, InterfaceFailure::Uncoupled);
            bond::bond(draw, law)
        },
    },
    Row {
        law: "bond, interface, tension and shear coupled",
        holds: |draw| {
            let law = bond::interface(draw, InterfaceFailure::Coupled);
            bond::bond(draw, law)
        },
    },
    Row { law: "interface with a stiffness, one mode to the end", holds: interface::spring_proportional },
    Row { law: "interface with a stiffness, tangent", holds: interface::spring_tangent },
    Row { law: "interface with a stiffness, led down its curve", holds: interface::spring_led },
    Row { law: "interface with a stiffness, as one without", holds: interface::spring_as_stiff },
    Row { law: "interface with a stiffness, any way", holds: interface::spring_any_way },
    Row { law: "interface with a stiffness, sliding under pressure", holds: interface::spring_sliding },
    Row { law: "stiff interface, one mode to the end", holds: interface::stiff_proportional },
    Row { law: "stiff interface, any way", holds: interface::stiff_any_way },
    Row { law: "stiff interface, sliding under pressure", holds: interface::stiff_sliding },
    Row { law: "bedding in space", holds: |draw| bedding::bedding(draw, None) },
    Row { law: "bedding, plane strain", holds: |draw| bedding::bedding(draw, Some(Plane::Strain)) },
    Row { law: "bedding, plane stress", holds: |draw| bedding::bedding(draw, Some(Plane::Stress)) },
    Row { law: "rate of strain", holds: rate::onset },
    Row { law: "liquid between walls", holds: liquid::flow },
    Row { law: "leak-off", holds: liquid::leak },
    Row { law: "edge whose closed crack rubs", holds: damage::rubbing },
    Row { law: "strength of beds, by angle", holds: beds::by_angle },
    Row { law: "strength of beds, any way", holds: beds::way },
    Row { law: "rough interface, sliding under pressure", holds: interface::rough_sliding },
];

#[test]
fn every_law_has_its_properties_over_its_whole_range() {
    try_all(LAWS);
}
