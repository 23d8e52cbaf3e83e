//! In-situ stress that bodies have as it is written: their elastic strain, and the body behind every facet on which it acts.

use std::collections::HashMap;
use std::fmt;

use fractum_fem::fields::element_fields;
use fractum_fem::{Body, ElementKind, Plane, Solid, Stiffness, motion};
use fractum_math::{Mat3, Sym3, Vec3};
use fractum_output::warning::Code;
use nalgebra::{Matrix6, Vector6};

use super::Context;
use super::conditions::sorted;
use crate::Diagnostic;
use crate::model::{Case, InSitu};

/// Across the plane.
const ZZ: usize = 2;
/// Mean change of stress in a body that settles, over the largest component that is written there, above which it is told.
const SETTLED: f64 = 0.05;

/// How far the stress of a body has changed as the solids settled: the largest component of the change, over the largest that is written in the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// Name of the body.
    pub body: String,
    /// Mean over its volume.
    pub mean: f64,
    /// In the element in which it is largest.
    pub largest: f64,
    /// Middle of that element [m].
    pub place: Vec3,
}

/// Numbers of the bodies that are there.
pub(super) fn bodies_there(case: &Case, solid: &Solid) -> Vec<usize> {
    let is_gone = |name: &String| case.excavation.as_ref().is_some_and(|own| own.gone.contains(name));
    (0..solid.body_count()).filter(|&body| !is_gone(&solid.body(body).name)).collect()
}

/// Largest component [Pa].
pub(super) fn largest_of(stress: Sym3) -> f64 {
    stress.0.iter().map(|c| c.abs()).fold(0.0, f64::max)
}

/// Every body that is there has a stress, and none that comes in later.
pub(super) fn check_layers(context: &mut Context<'_>, stress: &InSitu, solid: &Solid) {
    let there = bodies_there(context.case, solid);
    for name in stress.layers.iter().flat_map(|layer| &layer.bodies) {
        if !there.iter().any(|&body| solid.body(body).name == name.value) {
            let found = format!("= \"{}\" comes in in a later stage, without stress", name.value);
            context.error(&name.place, found, "bodies that are there from the start");
        }
    }
    let names = there.iter().map(|&body| &solid.body(body).name);
    let without: Vec<String> =
        names.filter(|name| stress.of(name).is_none()).map(|name| format!("\"{name}\"")).collect();
    if !without.is_empty() {
        let found = format!(".layers give no stress to {}", without.join(", "));
        context.error(&stress.place, found, "a layer for every solid body, or in_situ.stress for those in none");
    }
}

/// Gives the bodies their stress; the largest component of all [Pa]. None where the case has a far field.
pub(super) fn begin_as_written(case: &Case, solid: &mut Solid) -> Option<f64> {
    let stress = case.in_situ.as_ref().filter(|stress| stress.is_as_written())?;
    let mut largest = 0.0f64;
    for index in bodies_there(case, solid) {
        let body = solid.body(index).clone();
        let Some(field) = stress.of(&body.name) else { continue };
        let is_across = field.components[ZZ].is_some();
        let nodes = body.elements.iter().flatten().map(|&node| solid.reference[node as usize]);
        largest = nodes.map(|place| largest_of(field.at(place))).fold(largest, f64::max);
        let strain = |place: Vec3| Sym3::symmetric_part(&strain_of(&body, field.at(place), is_across));
        motion::begin_strained(solid, index, strain);
    }
    Some(largest)
}

/// How far the solids have settled from the stress that is written; nothing where they do not.
pub(super) fn settled(case: &Case, solid: &Solid) -> Vec<Settled> {
    let Some(stress) = case.in_situ.as_ref().filter(|stress| stress.settles) else { return Vec::new() };
    let of_body = |body: usize| {
        let name = &solid.body(body).name;
        let field = stress.of(name)?;
        let (mut volume, mut sum, mut written) = (0.0, 0.0, 0.0f64);
        let mut most = (0.0, Vec3::zeros());
        for (size, middle, own) in stresses(solid, body) {
            let asked = field.at(middle);
            let off = components(solid).map(|c| (own.0[c] - asked.0[c]).abs()).fold(0.0, f64::max);
            (volume, sum, written) = (volume + size, sum + off * size, written.max(largest_of(asked)));
            most = if off > most.0 { (off, middle) } else { most };
        }
        let (largest, place) = most;
        Some((Settled { body: name.clone(), mean: sum / volume, largest, place }, written))
    };
    let found: Vec<(Settled, f64)> = bodies_there(case, solid).into_iter().filter_map(of_body).collect();
    let most = found.iter().map(|own| own.1).fold(0.0, f64::max);
    let over_written = |(own, written): (Settled, f64)| {
        // A body that has none at first is measured by the others.
        let scale = if written > 0.0 { written } else { most.max(f64::MIN_POSITIVE) };
        Settled { mean: own.mean / scale, largest: own.largest / scale, ..own }
    };
    found.into_iter().map(over_written).collect()
}

/// Bodies whose stress has changed much as they settled.
pub(super) fn settled_far(case: &Case, settled: &[Settled]) -> Vec<Diagnostic> {
    let Some(stress) = &case.in_situ else { return Vec::new() };
    let tell = |own: &Settled| {
        let place = stress.of(&own.body).map_or(&stress.place, |field| &field.place);
        let found = format!(": as the solids settled, the stress of body {own}");
        Diagnostic::warning(Code::SharedStress, place, found).remedy(
            "a stress with the same traction on both sides of every boundary between layers, that goes with the weight and with the loads of t = 0, on outer \
             facets that supports or in_situ.groups hold, stays as it is written; around an opening it changes",
        )
    };
    settled.iter().filter(|own| own.mean > SETTLED).map(tell).collect()
}

impl fmt::Display for Settled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Settled { body, mean, largest, place } = self;
        let [mean, largest] = [mean, largest].map(|share| 100.0 * share);
        let [x, y, z] = (*place).into();
        write!(
            f,
            "\"{body}\" changed by {mean:.3} % in the mean and by {largest:.3} % at most, at ({x:.4e}, {y:.4e}, {z:.4e}) m, of the largest that is written there"
        )
    }
}

/// Components of stress that bodies balance: those in the plane of plane ones.
pub(super) fn components(solid: &Solid) -> impl Iterator<Item = usize> + use<> {
    let is_plane = solid.is_plane();
    (0..6).filter(move |component| !is_plane || [0, 1, 3].contains(component))
}

/// Size, middle [m] and stress [Pa] of the elements of a body; sizes are over the same of all.
pub(super) fn stresses(solid: &Solid, body: usize) -> impl Iterator<Item = (f64, Vec3, Sym3)> {
    let own = solid.body(body);
    own.elements.iter().zip(element_fields(solid, body, None)).map(|(element, (stress, _))| {
        let corners = element.map(|node| solid.reference[node as usize]);
        let [a, b, c] = [1, 2, 3].map(|k| corners[k] - corners[0]);
        let (size, middle) = match own.shape {
            ElementKind::T3 => (a.cross(&b).norm(), corners[..3].iter().sum::<Vec3>() / 3.0),
            ElementKind::T4 => (a.cross(&b).dot(&c).abs(), corners.iter().sum::<Vec3>() / 4.0),
        };
        (size, middle, stress)
    })
}

/// Elastic strain of a stress in a body.
///
/// - `is_across`: whether a body in plane strain has the component across its plane that is given; else that which follows from the others
pub(super) fn strain_of(body: &Body, stress: Sym3, is_across: bool) -> Mat3 {
    let plane = (body.shape == ElementKind::T3).then_some(body.plane);
    let is_across = is_across && plane != Some(Plane::Stress);
    if let Some(beds) = &body.stiffness() {
        return strain_of_beds(beds, stress, |i| plane.is_none() || [0, 1, 3].contains(&i) || i == ZZ && is_across);
    }
    let (e, nu) = (body.elastic.young_modulus, body.elastic.poisson_ratio);
    let mut sigma = stress.to_matrix();
    if let Some(plane) = plane {
        let zz = if is_across { sigma.m33 } else { nu * (sigma.m11 + sigma.m22) };
        sigma = Mat3::new(sigma.m11, sigma.m12, 0.0, sigma.m12, sigma.m22, 0.0, 0.0, 0.0, 0.0);
        sigma.m33 = if plane == Plane::Stress { 0.0 } else { zz };
    }
    let mut strain = (sigma * (1.0 + nu) - Mat3::identity() * (nu * sigma.trace())) / e;
    if plane == Some(Plane::Stress) {
        // Its law is one of strains in the plane.
        strain.m33 = 0.0;
    }
    strain
}

/// Strain of a stress in a body with beds, by the components that count.
fn strain_of_beds(beds: &Stiffness, stress: Sym3, counts: impl Fn(usize) -> bool) -> Mat3 {
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let rows = Matrix6::from_fn(|i, j| if counts(i) && counts(j) { beds.rows()[i][j] } else { unit(i, j) });
    let stress = Vector6::from_fn(|i, _| if counts(i) { stress.0[i] } else { 0.0 });
    let strain = rows.lu().solve(&stress).unwrap_or_default();
    // Shear strains of the rows are engineering ones.
    Sym3(std::array::from_fn(|i| if i < 3 { strain[i] } else { 0.5 * strain[i] })).to_matrix()
}

/// The body of every side of the elements of some bodies; of two that have a side one.
pub(super) fn bodies_of_sides(solid: &Solid, bodies: &[usize]) -> HashMap<[u32; 3], usize> {
    let mut found = HashMap::new();
    for &index in bodies {
        let body = solid.body(index);
        for &[a, b, c, d] in body.elements.iter() {
            let sides = match body.shape {
                ElementKind::T3 => vec![[a, b, b], [b, c, c], [c, a, a]],
                ElementKind::T4 => vec![[a, b, c], [a, b, d], [a, c, d], [b, c, d]],
            };
            found.extend(sides.into_iter().map(|side| (sorted(side), index)));
        }
    }
    found
}
