//! Rigid bodies that begin within solids, within each other, or around some of the particles.

use std::f64::consts::{PI, TAU};

use fractum_fem::{ElementKind, Solid};
use fractum_math::Vec3;
use fractum_math::elementary::{cos, sin};
use fractum_mesh::topology;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_pack::ClosedSurface;
use fractum_scene::{Bonded, Form, RigidBody, Shape};

use super::Context;
use crate::{Diagnostic, Place};

/// Depth of a tool within a solid over the mean size of its facets that is told: round holes are meshed by chords, which lie within their pins.
const DEEP: f64 = 0.1;
/// Points on an edge of a box, on a circle of a cylinder, along it, and on a sphere.
const ON_EDGE: usize = 9;
const ON_CIRCLE: usize = 24;
const ON_BALL: usize = 400;

impl Context<'_> {
    /// Doubts about where rigid bodies begin, beside those about nodes and particles that touch them.
    ///
    /// - `told`: rigid bodies that nodes of solids are told to be in
    pub(super) fn tool_overlaps(
        &self,
        solid: &Solid,
        bonded: &Bonded,
        rigid_bodies: &[RigidBody],
        told: &[&str],
    ) -> Vec<Diagnostic> {
        let mut doubts = Vec::new();
        if self.division.is_some() {
            return doubts;
        }
        let mut surfaces: Vec<Option<Option<SolidSide>>> = vec![None; solid.body_count()];
        for (index, tool) in rigid_bodies.iter().enumerate() {
            let Some(place) = self.place_of_tool(&tool.name) else { continue };
            let points = points_of(tool);
            for (body, surface) in surfaces.iter_mut().enumerate().filter(|_| !told.contains(&tool.name.as_str())) {
                if !near(&points, solid, body) {
                    continue;
                }
                let side = surface.get_or_insert_with(|| SolidSide::of(solid, body));
                if let Some((depth, at)) = side.as_ref().and_then(|side| side.deepest(&points)) {
                    let (name, depth) = (&solid.body(body).name, quantity(depth, "m"));
                    let found = format!(
                        "= \"{}\": it begins within \"{name}\", deepest at {}, by {depth}",
                        tool.name,
                        text(at)
                    );
                    let note = Diagnostic::warning(Code::InitialOverlap, &place, found);
                    doubts.push(
                        note.remedy("move it out; of a tool within a solid only the nodes that it covers feel it"),
                    );
                }
            }
            let others = rigid_bodies[..index].iter().chain(&rigid_bodies[index + 1..]);
            doubts.extend(within_another(tool, others, &place));
            doubts.extend(partly_filled(tool, bonded, &place));
        }
        doubts
    }

    fn place_of_tool(&self, name: &str) -> Option<Place> {
        let body = self.case.bodies.iter().find(|body| body.name.value == name)?;
        Some(body.name.place.clone())
    }
}

/// The surface of a solid.
#[derive(Clone, Debug)]
struct SolidSide {
    surface: ClosedSurface,
    is_plane: bool,
    /// Depth from which on a tool is in it [m].
    least: f64,
}

impl SolidSide {
    /// None of a solid whose surface encloses nothing, or touches itself.
    fn of(solid: &Solid, body: usize) -> Option<Self> {
        let model = solid.body(body);
        let at = |node: u32| solid.reference[node as usize];
        if model.shape == ElementKind::T4 {
            let facets: Vec<[u32; 3]> =
                topology::boundary_of_tetrahedra(&model.elements).iter().map(|facet| facet.nodes).collect();
            let (_, points, triangles) = compact(&facets, at);
            let surface = ClosedSurface::new(&points, &triangles).ok()?;
            let least = DEEP * (2.0 * surface.area() / triangles.len() as f64).sqrt();
            return Some(SolidSide { surface, is_plane: false, least });
        }
        // A prism that is longer than any way to its sides.
        let elements: Vec<[u32; 3]> = model.elements.iter().map(|&[a, b, c, _]| [a, b, c]).collect();
        let sides = topology::boundary_of_triangles(&elements);
        let length = |[a, b]: [u32; 2]| (at(b) - at(a)).norm();
        let around: f64 = sides.iter().map(|side| length(side.nodes)).sum();
        let (used, mut points, mut triangles) = compact(&elements, at);
        let count = points.len() as u32;
        let number = |node: u32| used.binary_search(&node).map_or(0, |found| found as u32);
        let below: Vec<[u32; 3]> = triangles.iter().map(|&[a, b, c]| [a + count, c + count, b + count]).collect();
        triangles.extend(below);
        for [a, b] in sides.iter().map(|side| side.nodes.map(number)) {
            triangles.extend([[a + count, b + count, b], [a + count, b, a]]);
        }
        let low: Vec<Vec3> = points.iter().map(|p| Vec3::new(p.x, p.y, -around)).collect();
        points.iter_mut().for_each(|p| p.z = around);
        points.extend(low);
        let surface = ClosedSurface::new(&points, &triangles).ok()?;
        Some(SolidSide { surface, is_plane: true, least: DEEP * around / sides.len() as f64 })
    }

    /// The point that is deepest in it, where one is.
    fn deepest(&self, points: &[Vec3]) -> Option<(f64, Vec3)> {
        let flat = |x: &Vec3| if self.is_plane { Vec3::new(x.x, x.y, 0.0) } else { *x };
        let (low, high) = self.surface.bounds();
        let inside = |x: &Vec3| (0..3).all(|axis| low[axis] < x[axis] && x[axis] < high[axis]);
        let depths = points.iter().map(flat).filter(inside).map(|x| (self.surface.depth(&x), x));
        depths.filter(|(depth, _)| *depth > self.least).reduce(|a, b| if b.0 > a.0 { b } else { a })
    }
}

/// Facets with nodes of their own: the nodes of the solid that they have, ascending, with their places, and the facets by places in this list.
fn compact(facets: &[[u32; 3]], at: impl Fn(u32) -> Vec3) -> (Vec<u32>, Vec<Vec3>, Vec<[u32; 3]>) {
    let mut used: Vec<u32> = facets.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number = |node: u32| used.binary_search(&node).map_or(0, |found| found as u32);
    let triangles = facets.iter().map(|facet| facet.map(number)).collect();
    let places = used.iter().map(|&node| at(node)).collect();
    (used, places, triangles)
}

/// Whether points come near a solid at all; of a plane one in its plane.
fn near(points: &[Vec3], solid: &Solid, body: usize) -> bool {
    let model = solid.body(body);
    let infinite = Vec3::repeat(f64::INFINITY);
    let bounds = |points: &mut dyn Iterator<Item = Vec3>| {
        points.fold((infinite, -infinite), |(low, high), x| (low.inf(&x), high.sup(&x)))
    };
    let (low, high) = bounds(&mut points.iter().copied());
    let nodes = model.elements.iter().flatten().map(|&node| solid.reference[node as usize]);
    let (from, to) = bounds(&mut { nodes });
    let axes = if model.shape == ElementKind::T3 { 2 } else { 3 };
    (0..axes).all(|axis| low[axis] < to[axis] && from[axis] < high[axis])
}

/// Points on the surface of a rigid body, in space; none of containers, of tubes, and of planes, which have no end.
fn points_of(tool: &RigidBody) -> Vec<Vec3> {
    let own = match &tool.form {
        Form::Shape { hollow: true, .. } | Form::Shape { shape: Shape::HalfSpace | Shape::Tube { .. }, .. } => {
            Vec::new()
        }
        Form::Shape { shape: Shape::Cuboid { half }, .. } => of_cuboid(half),
        Form::Shape { shape: Shape::Cylinder { radius, half_length }, .. } => of_cylinder(*radius, *half_length),
        Form::Shape { shape: Shape::Ball { radius }, .. } => of_ball(*radius),
        Form::Mesh { mesh, points } => {
            let middle = |facet: u32| {
                let corners = mesh.corners(facet);
                corners.iter().map(|&corner| points[corner as usize]).sum::<Vec3>() / corners.len() as f64
            };
            points.iter().copied().chain((0..mesh.len() as u32).map(middle)).collect()
        }
    };
    own.iter().map(|x| tool.frame.origin + tool.frame.to_space(x)).collect()
}

fn of_cuboid(half: &Vec3) -> Vec<Vec3> {
    let part = |index: usize| 2.0 * index as f64 / (ON_EDGE - 1) as f64 - 1.0;
    let mut points = Vec::new();
    for axis in 0..3 {
        for (first, second) in (0..ON_EDGE * ON_EDGE).map(|index| (index / ON_EDGE, index % ON_EDGE)) {
            for end in [-1.0, 1.0] {
                let mut point = Vec3::zeros();
                point[axis] = end;
                point[(axis + 1) % 3] = part(first);
                point[(axis + 2) % 3] = part(second);
                points.push(point.component_mul(half));
            }
        }
    }
    points
}

fn of_cylinder(radius: f64, half_length: f64) -> Vec<Vec3> {
    let mut points = vec![Vec3::new(0.0, 0.0, half_length), Vec3::new(0.0, 0.0, -half_length)];
    for ring in 0..ON_EDGE {
        let z = half_length * (2.0 * ring as f64 / (ON_EDGE - 1) as f64 - 1.0);
        let angles = (0..ON_CIRCLE).map(|index| TAU * index as f64 / ON_CIRCLE as f64);
        points.extend(angles.map(|angle| Vec3::new(radius * cos(angle), radius * sin(angle), z)));
    }
    points
}

/// Points on a spiral of equal areas, and those on the axes, which often meet a face.
fn of_ball(radius: f64) -> Vec<Vec3> {
    let turn = PI * (3.0 - 5f64.sqrt());
    let spiral = (0..ON_BALL).map(|index| {
        let z = 1.0 - (2.0 * index as f64 + 1.0) / ON_BALL as f64;
        let (across, angle) = ((1.0 - z * z).sqrt(), turn * index as f64);
        Vec3::new(across * cos(angle), across * sin(angle), z)
    });
    let axes = (0..3).flat_map(|axis| [Vec3::ith(axis, 1.0), Vec3::ith(axis, -1.0)]);
    spiral.chain(axes).map(|x| radius * x).collect()
}

/// A rigid body whose middle lies within another one, of which one moves: they do not feel each other.
fn within_another<'a>(
    tool: &RigidBody,
    others: impl Iterator<Item = &'a RigidBody>,
    place: &Place,
) -> Option<Diagnostic> {
    let middle = tool.middle()?;
    let mut others = others;
    let other = others.find(|other| (tool.moves() || other.moves()) && other.covers(&middle))?;
    let found = format!("= \"{}\": its middle {} lies within \"{}\"", tool.name, text(middle), other.name);
    let note = Diagnostic::warning(Code::InitialOverlap, place, found);
    Some(note.remedy("move one of them: rigid bodies do not feel each other"))
}

/// A closed surface that holds some particles of a body, and fewer than are outside: they cannot leave it.
fn partly_filled(tool: &RigidBody, bonded: &Bonded, place: &Place) -> Option<Diagnostic> {
    let Form::Mesh { mesh, points } = &tool.form else { return None };
    if bonded.particles.is_empty() {
        return None;
    }
    let triangles: Vec<[u32; 3]> =
        (0..mesh.len() as u32).filter_map(|facet| mesh.corners(facet).try_into().ok()).collect();
    let surface = ClosedSurface::new(points, &triangles).ok()?;
    let (low, high) = surface.bounds();
    for body in bonded.bodies() {
        let depth = |particle: usize| {
            let x = tool.frame.to_body(&bonded.particles.position[particle]);
            let inside = (0..3).all(|axis| low[axis] < x[axis] && x[axis] < high[axis]);
            if inside { surface.depth(&x) - bonded.particles.radius[particle] } else { -1.0 }
        };
        let held = body.range.clone().map(|particle| (depth(particle), particle)).filter(|(depth, _)| *depth > 0.0);
        let held: Vec<(f64, usize)> = held.collect();
        if held.is_empty() || 2 * held.len() > body.range.len() {
            continue;
        }
        let (_, deepest) = held.iter().copied().reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        let found = format!(
            "= \"{}\": it begins around {} of the {} particles of \"{}\", such as that at {}",
            tool.name,
            held.len(),
            body.range.len(),
            body.name,
            text(bonded.particles.position[deepest])
        );
        let note = Diagnostic::warning(Code::InitialOverlap, place, found);
        return Some(note.remedy("move it out: they cannot leave it"));
    }
    None
}

fn text(x: Vec3) -> String {
    format!("({})", [x.x, x.y, x.z].map(|x| quantity(x, "m")).join(", "))
}
