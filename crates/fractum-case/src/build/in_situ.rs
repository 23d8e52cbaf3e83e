//! Stress of the solids before the run: tractions of the far field, and what must fit to them.

use std::collections::HashMap;
use std::sync::Arc;

use fractum_fem::{Body, Solid};
use fractum_math::{Sym3, Vec3};
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_scene::{Load, NodalForce};
use nalgebra::{Matrix6, Vector6};

use super::Context;
use super::bodies::Numbering;
use super::body_doubts::named;
use super::conditions::{Surface, sorted};
use super::in_situ_layers::{bodies_of_sides, bodies_there, check_layers, components, largest_of, strain_of, stresses};
use crate::Diagnostic;
use crate::model::{Case, InSitu, LoadKind, Selection, StressField};

/// How far a stress may be from linear, over its largest component; and forces from balance, over the largest.
const LINEAR: f64 = 1e-9;
const BALANCE: f64 = 1e-6;
/// How far supports may be from following the far field, over its displacement across the body.
const FOLLOWS: f64 = 1e-6;
/// How far the mean stress of a body may be from the one asked for, over its largest component.
const SHARED: f64 = 0.05;
/// How far the area of a side may be from that of the box, over it.
const WHOLE: f64 = 1e-6;

/// A stress σ(x) = σ⁰ + Σ x_k ∂σ/∂x_k about a point.
struct FarField {
    centre: Vec3,
    size: Vec3,
    stress: Sym3,
    slope: [Sym3; 3],
    largest: f64,
}

/// Tractions of the in-situ stress on facets; none where the case has no such stress, or where it does not fit.
///
/// - `on`: facets of supports that answer to motion; those of the groups of the stress are added
pub(super) fn in_situ_loads(
    context: &mut Context<'_>,
    numbering: &Numbering,
    surface: &Surface,
    solid: &Solid,
    mut on: Vec<[u32; 3]>,
) -> Vec<Load> {
    let Some(stress) = &context.case.in_situ else { return Vec::new() };
    for group in &stress.groups {
        let on_group = Selection::of_group(group.clone());
        on.extend(match context.case.is_first_stage() {
            true => context.selected_facets(&on_group, numbering, surface),
            // All facets of the group may have left.
            false => context.facets(&on_group, numbering, surface),
        });
    }
    on.sort_unstable();
    on.dedup();
    let Some(fields) = Fields::of(context, stress, solid, &numbering.positions) else { return Vec::new() };
    let is_held = context.case.supports.iter().any(|support| support.motion.iter().any(Option::is_some));
    if context.case.is_first_stage() && on.is_empty() && !is_held && context.diagnostics.is_empty() {
        context.error(&stress.place, ": it acts on no facet", "absorbing or elastic supports, or groups of facets");
    }
    if context.case.is_first_stage() && !stress.settles {
        check_weight(context, stress, &fields, solid);
    }
    if let (true, true, Some(field)) = (context.diagnostics.is_empty(), context.case.is_first_stage(), fields.far()) {
        context.held_by_far_field = check_in_situ_supports(context, field, (surface, &on), solid, numbering);
    }
    if context.diagnostics.is_empty() { tractions(&fields, &on, surface, solid) } else { Vec::new() }
}

/// A body among bodies of other materials whose mean stress at the start is not the one asked for.
pub(super) fn shared(case: &Case, solid: &Solid) -> Option<Diagnostic> {
    let stress = case.in_situ.as_ref().filter(|stress| !stress.is_as_written())?.stress.as_ref()?;
    let there = bodies_there(case, solid);
    let &first = there.first()?;
    if there.iter().all(|&body| is_alike(solid.body(first), solid.body(body))) {
        return None;
    }
    let mut largest = 0.0f64;
    let mut worst: Option<(f64, usize, usize, [f64; 2])> = None;
    for body in there {
        let (mut volume, mut found, mut asked) = (0.0, Sym3::ZERO, Sym3::ZERO);
        for (size, middle, own) in stresses(solid, body) {
            let far = stress.at(middle);
            largest = largest.max(largest_of(far));
            (volume, found, asked) = (volume + size, found + own * size, asked + far * size);
        }
        for component in components(solid) {
            let [found, asked] = [found, asked].map(|sum| sum.0[component] / volume);
            if worst.is_none_or(|(off, ..)| (found - asked).abs() > off) {
                worst = Some(((found - asked).abs(), body, component, [found, asked]));
            }
        }
    }
    let (_, body, component, values) = worst.filter(|(off, ..)| *off > SHARED * largest)?;
    let [found, asked] = values.map(|stress| quantity(stress, "Pa"));
    let found = format!(
        ": body \"{}\" begins with a mean {} of {found}, and {asked} is asked: joined bodies of unlike stiffness share the stress",
        solid.body(body).name,
        ["xx", "yy", "zz", "xy", "yz", "zx"][component],
    );
    let note = Diagnostic::warning(Code::SharedStress, &stress.place, found);
    Some(note.remedy(
        "that is right for rock that was pressed as a whole; give layers that came to rest one after the other their own stress by in_situ.layers",
    ))
}

/// Whether two bodies have one elasticity.
fn is_alike(a: &Body, b: &Body) -> bool {
    let moduli = |body: &Body| (body.elastic.young_modulus, body.elastic.poisson_ratio);
    moduli(a) == moduli(b) && a.bedding == b.bedding
}

/// The stress of every body.
struct Fields {
    /// Those that the case writes.
    all: Vec<FarField>,
    /// Which of them a body has; none of one that is not there.
    of_body: Vec<Option<usize>>,
    is_as_written: bool,
}

impl Fields {
    fn of(context: &mut Context<'_>, stress: &InSitu, solid: &Solid, positions: &[Vec3]) -> Option<Fields> {
        let is_as_written = stress.is_as_written();
        if !is_as_written {
            let far = linear(context, stress.stress.as_ref()?, positions)?;
            return Some(Fields { all: vec![far], of_body: vec![Some(0); solid.body_count()], is_as_written });
        }
        if context.case.is_first_stage() {
            check_layers(context, stress, solid);
        }
        let (mut all, mut of_body) = (Vec::new(), vec![None; solid.body_count()]);
        for field in stress.fields() {
            let has = |body: &usize| stress.is_of(&solid.body(*body).name, field);
            let bodies: Vec<usize> = bodies_there(context.case, solid).into_iter().filter(has).collect();
            let nodes = bodies.iter().flat_map(|&body| solid.body(body).elements.iter().flatten());
            let places: Vec<Vec3> = nodes.map(|&node| positions[node as usize]).collect();
            if places.is_empty() {
                continue; // all its bodies have left
            }
            bodies.into_iter().for_each(|body| of_body[body] = Some(all.len()));
            all.push(linear(context, field, &places)?);
        }
        Some(Fields { all, of_body, is_as_written })
    }

    /// That of elastic bodies that share it.
    fn far(&self) -> Option<&FarField> {
        self.all.first().filter(|_| !self.is_as_written)
    }
}

/// The stress as a linear function of the place.
///
/// - `positions`: places where it acts [m]
fn linear(context: &mut Context<'_>, stress: &StressField, positions: &[Vec3]) -> Option<FarField> {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    positions.iter().for_each(|p| (low, high) = (low.inf(p), high.sup(p)));
    let (centre, size) = ((low + high) * 0.5, high - low);
    let slope = [0, 1, 2].map(|k| {
        let half = Vec3::ith(k, 0.5 * size[k]);
        let difference = stress.at(centre + half) - stress.at(centre - half);
        if size[k] > 0.0 { difference * (1.0 / size[k]) } else { Sym3::ZERO }
    });
    let largest = positions.iter().map(|&p| largest_of(stress.at(p))).fold(0.0, f64::max);
    let field = FarField { centre, size, stress: stress.at(centre), slope, largest };
    let bent = |p: &&Vec3| {
        let off = stress.at(**p) - field.at(**p);
        off.0.iter().any(|c| c.is_nan()) || largest_of(off) > LINEAR * field.largest
    };
    if let Some(p) = positions.iter().find(bent) {
        let found = format!("is not linear in x, y, z near ({:.4e}, {:.4e}, {:.4e}) m", p.x, p.y, p.z);
        context.error(&stress.place, found, "finite components that grow in proportion to depth or not at all");
        return None;
    }
    Some(field)
}

/// div σ + ρ g = 0, or nothing can be at rest.
fn check_weight(context: &mut Context<'_>, stress: &InSitu, fields: &Fields, solid: &Solid) {
    let mut gravity = Vec3::zeros();
    for load in &context.case.loads {
        if let LoadKind::Gravity { acceleration } = &load.kind {
            for (axis, value) in acceleration.iter().enumerate() {
                gravity[axis] += value.as_ref().map_or(0.0, |value| value.value.value(0.0, Vec3::zeros()));
            }
        }
    }
    let axes = if solid.is_plane() { 2 } else { 3 };
    let there = bodies_there(context.case, solid);
    for &body in &there {
        let Some(field) = fields.of_body[body].map(|own| &fields.all[own]) else { continue };
        let divergence = Vec3::from_fn(|a, _| (0..axes).map(|k| field.slope[k].to_matrix()[(a, k)]).sum::<f64>());
        let density = solid.body(body).elastic.density;
        let weight = gravity * density;
        let scale = field.largest / field.size.max() * BALANCE + BALANCE * weight.norm();
        let Some(axis) = (0..axes).find(|&a| (divergence[a] + weight[a]).abs() > scale) else { continue };
        let name = ["x", "y", "z"][axis];
        let found = format!(
            ": the divergence of the stress along {name} is {}, and the weight of body \"{}\" is {}",
            quantity(divergence[axis], "Pa/m"),
            solid.body(body).name,
            quantity(weight[axis], "Pa/m")
        );
        let fitting = quantity(-divergence[axis] / density, "m/s^2");
        let is_one = there.iter().all(|&other| (solid.body(other).elastic.density / density - 1.0).abs() < BALANCE);
        let expected = if is_one {
            format!("gravity {name} = \"{fitting}\" among the loads, or a stress that goes with it")
        } else if fields.is_as_written {
            "a stress of this body that grows with its weight, and gravity among the loads; or in_situ.settle = true"
                .to_owned()
        } else {
            "bodies of one density, since the stress is linear; or a stress of each body that goes with its weight, by in_situ.layers"
                .to_owned()
        };
        let own = stress.of(&solid.body(body).name);
        context.error(own.map_or(&stress.place, |own| &own.place), found, expected);
        return;
    }
}

/// What supports hold under the far field: an axis of a place.
struct Held {
    /// Number of the support.
    support: usize,
    node: u32,
    place: Vec3,
    axis: usize,
}

/// Supports must be able to follow the displacements of the far field, or hold what it asks of whole sides of a box of one material: their
/// nodes then begin where the far field has them, which is returned.
///
/// - `on`: facets with its tractions
fn check_in_situ_supports(
    context: &mut Context<'_>,
    field: &FarField,
    (surface, on): (&Surface, &[[u32; 3]]),
    solid: &Solid,
    numbering: &Numbering,
) -> Option<Vec<Vec3>> {
    let there = bodies_there(context.case, solid);
    let &first = there.first()?;
    let is_one = there.iter().all(|&body| is_alike(solid.body(first), solid.body(body)));
    let mut held: Vec<Held> = Vec::new();
    for (index, support) in context.case.supports.iter().enumerate() {
        if context.names_particles(&support.on) || support.motion.iter().all(Option::is_none) {
            continue;
        }
        for node in context.selected_nodes(&support.on, numbering) {
            let place = numbering.positions[node as usize];
            let axes = (0..3).filter(|&axis| support.motion[axis].is_some());
            held.extend(axes.map(|axis| Held { support: index, node, place, axis }));
        }
    }
    if is_one {
        let (row, off) = not_following(&held.iter().collect::<Vec<_>>(), field, solid.body(first))?;
        if let Some(sides) = WholeSides::of(surface, &numbering.positions)
            && held.iter().all(|one| sides.have(&one.place))
            && are_borne(&held, field, (surface, on))
        {
            return Some(numbering.positions.iter().copied().map(field.displacements(solid.body(first))).collect());
        }
        contradicts(
            context,
            row,
            off,
            "supports on planes of symmetry, without shear stress, or on whole sides of a box, whose shear they bear; or none, with absorbing or elastic ones",
        );
        return None;
    }
    // Bodies of several materials have no common far field, but what holds one of them must let it follow its own.
    for body in there {
        let mut nodes: Vec<u32> = solid.body(body).elements.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let own: Vec<&Held> = held.iter().filter(|one| nodes.binary_search(&one.node).is_ok()).collect();
        if let Some((row, off)) = not_following(&own, field, solid.body(body)) {
            contradicts(
                context,
                row,
                off,
                "bodies of one material, or the stress (in_situ.groups) instead of a support on one of two sides that face each other",
            );
            break;
        }
    }
    None
}

/// Whether supports hold facets along every axis along which the stress pulls them, as far as its tractions do not act there: a roller bears
/// no shear.
fn are_borne(held: &[Held], field: &FarField, (surface, on): (&Surface, &[[u32; 3]])) -> bool {
    let mut bits: HashMap<u32, u8> = HashMap::new();
    held.iter().for_each(|one| *bits.entry(one.node).or_default() |= 1 << one.axis);
    let mut pulled: Vec<[u32; 3]> = on.to_vec();
    pulled.iter_mut().for_each(|facet| facet.sort_unstable());
    pulled.sort_unstable();
    surface.facets.iter().all(|facet| {
        let corners: Vec<u8> = surface.corners(facet).iter().map(|node| bits.get(node).copied().unwrap_or(0)).collect();
        let mut nodes = *facet;
        nodes.sort_unstable();
        if corners.contains(&0) || pulled.binary_search(&nodes).is_ok() {
            return true;
        }
        let traction = field.at(surface.middle(facet)).to_matrix() * surface.area_vector(facet).normalize();
        let is_borne = |axis: usize| corners.iter().all(|bits| bits & (1 << axis) != 0);
        let axes = if corners.len() == 2 { 2 } else { 3 };
        (0..axes).all(|axis| traction[axis].abs() < BALANCE * field.largest || is_borne(axis))
    })
}

/// The place that supports keep farthest from its displacement in the far field, and by how much [m], where they do not let the body follow it.
fn not_following<'h>(held: &[&'h Held], field: &FarField, body: &Body) -> Option<(&'h Held, f64)> {
    let displacement = field.displacements(body);
    let rows = held.iter().map(|one| (rigid(one.place, field, one.axis), displacement(one.place)[one.axis]));
    let (mut gram, mut right) = (Matrix6::<f64>::zeros(), Vector6::<f64>::zeros());
    for (row, u) in rows.clone() {
        gram += row * row.transpose();
        right -= row * u;
    }
    let motion = gram.pseudo_inverse(1e-9 * gram.trace().max(f64::MIN_POSITIVE)).ok().map(|inverse| inverse * right)?;
    let strain = field.largest / body.elastic.young_modulus;
    let off = rows.map(|(row, u)| (row.dot(&motion) + u).abs());
    let (row, off) = off.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (off > FOLLOWS * strain * field.size.norm()).then(|| (held[row], off))
}

fn contradicts(context: &mut Context<'_>, &Held { support, place, axis, .. }: &Held, off: f64, expected: &str) {
    let support = &context.case.supports[support];
    let found = format!(
        "{} contradicts the in-situ stress: it holds {} at ({:.4e}, {:.4e}, {:.4e}) m, which the stress moves by {}",
        named(&support.on),
        ["x", "y", "z"][axis],
        place.x,
        place.y,
        place.z,
        quantity(off, "m")
    );
    let at = support.on.place().cloned().unwrap_or_else(|| context.whole_case());
    context.error(&at, found.trim_start(), expected);
}

/// Sides of the box around the solids that these have as a whole, without a hole or a cut corner.
struct WholeSides {
    /// Axis across each side, and its coordinate [m].
    sides: Vec<(usize, f64)>,
    /// Distance from a side within which a place is on it [m].
    within: f64,
}

impl WholeSides {
    /// None where there is none.
    fn of(surface: &Surface, positions: &[Vec3]) -> Option<WholeSides> {
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        positions.iter().for_each(|p| (low, high) = (low.inf(p), high.sup(p)));
        let size = high - low;
        let axes = if size.z > 0.0 { 0..3 } else { 0..2 };
        let within = 1e-6 * size.norm();
        let whole = |axis: usize, at: f64| {
            let asked: f64 = axes.clone().filter(|&other| other != axis).map(|other| size[other]).product();
            let on_side = |facet: &&[u32; 3]| {
                surface.corners(facet).iter().all(|&node| (positions[node as usize][axis] - at).abs() < within)
            };
            let measure = |facet: &[u32; 3]| match *surface.corners(facet) {
                [a, b] => (positions[b as usize] - positions[a as usize]).norm(),
                _ => surface.area_vector(facet).norm(),
            };
            let there: f64 = surface.facets.iter().filter(on_side).map(measure).sum();
            (there / asked - 1.0).abs() < WHOLE
        };
        let both = axes.clone().flat_map(|axis| [(axis, low[axis]), (axis, high[axis])]);
        let sides: Vec<(usize, f64)> = both.filter(|&(axis, at)| whole(axis, at)).collect();
        (!sides.is_empty()).then_some(WholeSides { sides, within })
    }

    fn have(&self, place: &Vec3) -> bool {
        self.sides.iter().any(|&(axis, at)| (place[axis] - at).abs() < self.within)
    }
}

/// A rigid motion of a place along an axis: translations, and rotations times the size of the body.
fn rigid(place: Vec3, field: &FarField, axis: usize) -> Vector6<f64> {
    let x = (place - field.centre) / field.size.norm();
    let turn = |about: Vec3| about.cross(&x)[axis];
    let along = Vec3::ith(axis, 1.0);
    Vector6::new(along.x, along.y, along.z, turn(Vec3::x()), turn(Vec3::y()), turn(Vec3::z()))
}

impl FarField {
    fn at(&self, place: Vec3) -> Sym3 {
        let x = place - self.centre;
        self.stress + self.slope[0] * x.x + self.slope[1] * x.y + self.slope[2] * x.z
    }

    /// Displacements u_i = ε⁰_ij x_j + ½ (ε_ij,k + ε_ik,j − ε_jk,i) x_j x_k of the linear strain that goes with the stress.
    ///
    /// - `body`: one of the bodies, which are all of one material
    fn displacements(&self, body: &Body) -> impl Fn(Vec3) -> Vec3 + use<> {
        let strain = |stress: Sym3| strain_of(body, stress, false);
        let (constant, slope, centre) = (strain(self.stress), self.slope.map(strain), self.centre);
        move |place| {
            let x = place - centre;
            let quadratic = |i: usize| -> f64 {
                let term = |j: usize, k: usize| slope[k][(i, j)] + slope[j][(i, k)] - slope[i][(j, k)];
                (0..9).map(|jk| 0.5 * term(jk / 3, jk % 3) * x[jk / 3] * x[jk % 3]).sum()
            };
            constant * x + Vec3::from_fn(|i, _| quadratic(i))
        }
    }
}

/// Tractions σ n as forces on nodes: on every corner the integral of its share of a traction that is linear.
fn tractions(fields: &Fields, facets: &[[u32; 3]], surface: &Surface, solid: &Solid) -> Vec<Load> {
    let with_a_stress: Vec<usize> = (0..fields.of_body.len()).filter(|&body| fields.of_body[body].is_some()).collect();
    let behind = if fields.is_as_written { bodies_of_sides(solid, &with_a_stress) } else { HashMap::new() };
    let positions = &solid.reference;
    let mut forces: Vec<(u32, Vec3)> = Vec::new();
    for facet in facets {
        let own = behind.get(&sorted(*facet)).and_then(|&body| fields.of_body[body]);
        // What comes in has no stress.
        let Some(field) = fields.far().or(own.map(|own| &fields.all[own])) else { continue };
        let (area, corners) = (surface.area_vector(facet), surface.corners(facet));
        let count = corners.len() as f64;
        let at = |node: u32| field.at(positions[node as usize]).to_matrix() * area;
        let sum: Vec3 = corners.iter().map(|&node| at(node)).sum();
        forces.extend(corners.iter().map(|&node| (node, (sum + at(node)) / (count * (count + 1.0)))));
    }
    let load = |axis: usize| {
        let points = forces.iter().map(|(node, force)| (*node, force[axis])).collect();
        Load::Nodal(NodalForce { points, axis, value: Arc::new(|_, _| 1.0) })
    };
    [0, 1, 2].map(load).into()
}
