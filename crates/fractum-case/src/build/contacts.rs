//! Rigid bodies, the surfaces of solids, and what particles feel of both.

use fractum_fem as fem;
use fractum_math::{Mat3, Vec3, rotation_between};
use fractum_mesh::topology;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_scene::{
    ContactMaterial, ContactPairs, ContactParameters, Contacts, Drive, ElasticMaterial, FacetMesh, Form, Frame,
    Inertia, NodesOnShape, Overlap, OverlapWith, RigidBody, Scene, Servo, ServoArea, Shape, SolidSurface, pieces,
};

use super::bodies::{Numbering, Part};
use super::precheck::check_field;
use super::{Context, function, periodic};
use crate::model::{self, Body, BodyKind, InitialOverlap, LoadKind, RigidShape, ServoForce, SolverKind};
use crate::{Diagnostic, Spanned};

/// Depth of an overlap over the radius of the particle at the start that is reported.
const DEEP: f64 = 1e-6;

/// Cosines of the angles between planes that face each other, and those across, beyond which they are askew.
const OPPOSITE: f64 = -1.0 + 1e-9;
const ACROSS: f64 = 1e-6;

/// What becomes of overlaps that are taken as they stand.
const NO_FORCE: &str = "they give no force until they have parted";

/// Triangles of a rigid body, read outside.
#[derive(Clone, Debug)]
pub struct PreparedFacets {
    /// Points [m].
    pub points: Vec<Vec3>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// Outward facets of each solid body, in scene nodes; of plane bodies, where discs or other solids may touch them, the edges, which repeat
/// their second node.
pub(super) fn facets_of_parts(context: &Context<'_>, parts: &[Part], numbering: &Numbering) -> Vec<Vec<[u32; 3]>> {
    let scene = |n: u32| numbering.scene_node[n as usize];
    if let Some(division) = context.division {
        let of_body = |facets: &Vec<[u32; 3]>| facets.iter().map(|facet| facet.map(scene)).collect();
        return division.boundary.of_bodies.iter().map(of_body).collect();
    }
    let has_discs = context.case.has_discs();
    let of = |part: &Part| match part.shape {
        fem::ElementKind::T3 if part.body.is_axisymmetric() || !has_discs && parts.len() == 1 => Vec::new(),
        fem::ElementKind::T3 => {
            let triangles = super::bodies::element_nodes(context, part).into_iter().map(|[a, b, c, _]| [a, b, c]);
            let edges = topology::boundary_of_triangles(&triangles.collect::<Vec<_>>());
            edges.iter().map(|edge| [edge.nodes[0], edge.nodes[1], edge.nodes[1]].map(scene)).collect()
        }
        fem::ElementKind::T4 => {
            let facets = topology::boundary_of_tetrahedra(&super::bodies::element_nodes(context, part));
            facets.iter().map(|f| f.nodes.map(scene)).collect()
        }
    };
    parts.iter().map(of).collect()
}

/// The scene with the contacts of its particles.
pub(super) fn with_contacts(
    context: &mut Context<'_>,
    scene: Scene,
    parts: &[Part],
    facets: &[Vec<[u32; 3]>],
    surface: &[u32],
    rigid_bodies: Vec<RigidBody>,
    pairs: &ContactPairs,
    tied: &[u32],
    warnings: &mut Vec<Diagnostic>,
) -> Option<Scene> {
    let materials = contact_materials(context);
    let pieces = pieces(&scene.solid, &scene.interfaces().joined_bodies());
    let solids_meet = pieces.iter().any(|piece| *piece != pieces[0]);
    if materials.is_empty() {
        if scene.solid.is_plane() {
            refuse_facets(context, &rigid_bodies);
        }
        if rigid_bodies.is_empty() && !solids_meet {
            return Some(scene);
        }
    }
    let touched = if materials.is_empty() && !solids_meet { &[] } else { facets };
    let solids = solid_surfaces(context, &scene, parts, touched, tied, materials.is_empty().then_some(&mut *warnings));
    if !context.diagnostics.is_empty() {
        return None;
    }
    let contacts = Contacts::new(&scene.bonded, materials, rigid_bodies, solids, gravity(context));
    let mut contacts = contacts.with_pairs(pairs);
    let cell = periodic::cell(context.case);
    if let Some(cell) = cell {
        contacts = contacts.within(cell);
    }
    if !tied.is_empty() {
        // A bonded region fits its cavity within the tolerance of the packing.
        contacts.take_up_on_solids(&scene.solid, &scene.bonded.particles, |i| {
            let body = scene.bonded.bodies().iter().find(|body| body.range.contains(&(i as usize)));
            body.is_some_and(|body| tied.iter().any(|&t| body.range.contains(&(t as usize))))
        });
    }
    let deep = contacts.flatten(std::mem::take(&mut context.flat_faces), &scene.bonded.particles);
    warnings.extend(overlap_of_particles(context, &scene, &deep, NO_FORCE));
    warnings.extend(particle_overlaps(context, &scene, &mut contacts));
    let mut scene = scene.with_contacts(contacts, surface);
    if let Some(cell) = cell {
        scene = periodic::with_box(context, scene, cell);
        context.without_mistakes()?;
    }
    let nodes = deep_nodes(&scene, surface);
    warnings.extend(node_overlaps(context, &scene, &nodes));
    let told = nodes.iter().filter_map(|(_, _, other)| match other {
        OverlapWith::RigidBody(name) => Some(name.as_str()),
        _ => None,
    });
    let told: Vec<&str> = told.collect();
    warnings.extend(wall_doubts(context, &scene));
    warnings.extend(context.tool_overlaps(&scene.solid, &scene.bonded, scene.contacts.rigid_bodies(), &told));
    if context.case.solver.initial_overlap == InitialOverlap::Keep {
        scene.accept_initial_overlaps();
    }
    Some(scene)
}

/// Walls that nodes of solids pass through.
fn wall_doubts(context: &Context<'_>, scene: &Scene) -> Vec<Diagnostic> {
    let mut stages = std::iter::once(context.case).chain(&context.case.later);
    let moves = stages.any(|stage| stage.solver.kind == SolverKind::Explicit);
    if scene.solid.body_count() == 0 || scene.solid.is_plane() || !moves {
        return Vec::new();
    }
    let doubt = |tool: &RigidBody| {
        let name = &context.case.bodies.iter().find(|body| body.name.value == tool.name)?.name;
        let (found, remedy) = match &tool.form {
            Form::Shape { shape: Shape::Tube { .. }, .. } => (
                "solids pass through it: only particles and discrete elements feel a cylinder without lids".to_owned(),
                "give the wall as facets (group or stl), or keep solids away from it",
            ),
            Form::Mesh { mesh, points } => {
                let (edge, count) = mesh.turned_over()?;
                let at = tool.frame.origin + tool.frame.to_space(&points[mesh.edge(edge)[0] as usize]);
                let at = [at.x, at.y, at.z].map(|x| quantity(x, "m")).join(", ");
                let found = format!(
                    "its facets look to different sides at {count} edges, the first at ({at}): solids pass through it from behind"
                );
                (found, "turn its facets to the side on which the solids are")
            }
            Form::Shape { .. } => return None,
        };
        let found = format!("= \"{}\": {found}", name.value);
        Some(Diagnostic::warning(Code::NoContact, &name.place, found).remedy(remedy))
    };
    scene.contacts.rigid_bodies().iter().filter_map(doubt).collect()
}

/// What the bodies of particles are to contact, in their order.
fn contact_materials(context: &Context<'_>) -> Vec<ContactMaterial> {
    let materials = &context.case.materials;
    let material = |body: &Body| match &body.kind {
        BodyKind::Bonded(own) => Some((own.material, body.kind.surface(materials), false)),
        BodyKind::Particles(own) => Some((own.material, body.kind.surface(materials), true)),
        _ => None,
    };
    let contact = |(material, surface, sticks): (usize, ContactParameters, bool)| {
        let material = &materials[material];
        let modulus = material.contact_modulus.unwrap_or(material.young_modulus);
        let elastic = elastic(modulus, material.poisson_ratio);
        let work_of_adhesion = if sticks { material.work_of_adhesion } else { 0.0 };
        ContactMaterial { elastic, density: material.density, surface, work_of_adhesion }
    };
    context.case.bodies.iter().filter_map(material).map(contact).collect()
}

/// Surfaces of the solids that others touch.
///
/// - `tied`: particles that they do not touch; `doubts`: where a surface that cannot be touched is warned of, not refused
fn solid_surfaces(
    context: &mut Context<'_>,
    scene: &Scene,
    parts: &[Part],
    facets: &[Vec<[u32; 3]>],
    tied: &[u32],
    mut doubts: Option<&mut Vec<Diagnostic>>,
) -> Vec<SolidSurface> {
    let mut solids = Vec::new();
    for (index, (part, facets)) in parts.iter().zip(facets).enumerate().filter(|(_, (_, f))| !f.is_empty()) {
        let surface = part.body.surface(&context.case.materials);
        match (SolidSurface::new(&scene.solid, index, surface, facets), &mut doubts) {
            (Ok(surface), _) if tied.is_empty() => solids.push(surface),
            (Ok(surface), _) => solids.push(surface.without(tied.iter().copied(), &scene.bonded.particles.radius)),
            (Err(error), Some(doubts)) => {
                let found = format!(": other solids pass through it: {error}");
                doubts.push(Diagnostic::warning(Code::ContactSurface, &part.place, found));
            }
            (Err(error), None) => context.error(&part.place, format!(": particles cannot touch it: {error}"), ""),
        }
    }
    solids
}

/// Components of gravity by axis.
fn gravity(context: &Context<'_>) -> Vec<(usize, fractum_scene::TimeFunction)> {
    let mut gravity = Vec::new();
    for load in &context.case.loads {
        if let LoadKind::Gravity { acceleration } = &load.kind {
            let axes = acceleration.iter().enumerate();
            gravity.extend(axes.filter_map(|(axis, value)| Some((axis, function(&value.as_ref()?.value)))));
        }
    }
    gravity
}

/// Particles that are in other bodies at the start.
fn particle_overlaps(context: &Context<'_>, scene: &Scene, contacts: &mut Contacts) -> Option<Diagnostic> {
    let (mut solid, mut particles) = (scene.solid.clone(), scene.bonded.particles.clone());
    let mut overlaps = contacts.overlaps(&mut solid, &mut particles);
    overlaps.retain(|o| o.depth > DEEP * particles.radius[o.particle as usize]);
    overlap_of_particles(context, scene, &overlaps, overlap_remedy(context))
}

/// The warning of overlaps, if any, deepest first.
fn overlap_of_particles(
    context: &Context<'_>,
    scene: &Scene,
    overlaps: &[Overlap],
    remedy: &str,
) -> Option<Diagnostic> {
    let worst = overlaps.iter().reduce(|a, b| if b.depth > a.depth { b } else { a })?;
    let name = |particle: u32| {
        let body = scene.bonded.bodies().iter().find(|b| b.range.contains(&(particle as usize)));
        body.map_or_else(String::new, |b| format!("particle {} of {}", particle as usize - b.range.start, b.name))
    };
    let other = match &worst.other {
        OverlapWith::Particle(other) => name(*other),
        OverlapWith::RigidBody(rigid_body) => format!("rigid body {rigid_body}"),
        OverlapWith::Solid(body) => format!("solid {body}"),
    };
    let found = format!(
        "{} at the start, deepest {} and {other}, by {}",
        match overlaps.len() {
            1 => "1 contact overlaps".to_owned(),
            count => format!("{count} contacts overlap"),
        },
        name(worst.particle),
        quantity(worst.depth, "m")
    );
    Some(Diagnostic::warning(Code::InitialOverlap, &context.whole_case(), found).remedy(remedy))
}

/// Nodes of solids that are in other bodies at the start: for each of these the deepest.
///
/// - `nodes`: those with their depths [m], deepest first
fn node_overlaps(context: &Context<'_>, scene: &Scene, nodes: &[(u32, f64, OverlapWith)]) -> Vec<Diagnostic> {
    let mut others: Vec<&OverlapWith> = Vec::new();
    nodes.iter().map(|(.., other)| other).for_each(|other| {
        if !others.contains(&other) {
            others.push(other);
        }
    });
    let doubt = |other: &OverlapWith| {
        let mut within = nodes.iter().filter(|(.., found)| found == other);
        let count = within.clone().count();
        let (node, depth, _) = within.next()?;
        let other = match other {
            OverlapWith::Solid(name) => format!("solid {name}"),
            OverlapWith::RigidBody(name) => format!("rigid body {name}"),
            OverlapWith::Particle(particle) => format!("particle {particle}"),
        };
        let at = scene.solid.position(*node as usize);
        let found = format!(
            "{} within {other} at the start, deepest that at ({}), by {}",
            match count {
                1 => "1 node of a solid is".to_owned(),
                count => format!("{count} nodes of solids are"),
            },
            [at.x, at.y, at.z].map(|x| quantity(x, "m")).join(", "),
            quantity(*depth, "m")
        );
        Some(Diagnostic::warning(Code::InitialOverlap, &context.whole_case(), found).remedy(overlap_remedy(context)))
    };
    others.into_iter().filter_map(doubt).collect()
}

fn overlap_remedy(context: &Context<'_>) -> &'static str {
    match context.case.solver.initial_overlap {
        InitialOverlap::Push => {
            "they push apart at once; move one of them, make the cloud looser, or set solver.initial_overlap = \"keep\""
        }
        InitialOverlap::Keep => NO_FORCE,
    }
}

/// Facets of rigid bodies and containers act in space only.
fn refuse_facets(context: &mut Context<'_>, rigid_bodies: &[RigidBody]) {
    for rigid_body in rigid_bodies.iter().filter(|rigid_body| touches_solids(rigid_body).is_none()) {
        let body = context.case.bodies.iter().find(|body| body.name.value == rigid_body.name);
        if let Some(Body { name, .. }) = body {
            context.error(
                &name.place,
                "meets no particles; plane bodies feel planes, boxes, cylinders and spheres from outside only",
                "one of these shapes",
            );
        }
    }
}

/// Shapes of rigid bodies, as nodes of solids and their discrete elements feel them.
pub(super) fn shape_contacts(rigid_bodies: &[RigidBody]) -> Vec<NodesOnShape> {
    let shape =
        |(index, rigid_body)| Some(NodesOnShape::of_body(index, touches_solids(rigid_body)?, rigid_body.surface));
    rigid_bodies.iter().enumerate().filter_map(shape).collect()
}

/// The rigid bodies of the case.
pub(super) fn rigid_bodies(context: &mut Context<'_>, facets: Vec<PreparedFacets>) -> Vec<RigidBody> {
    let (case, mut facets) = (context.case, facets.into_iter());
    let mut rigid_bodies = Vec::new();
    for body in &case.bodies {
        if let BodyKind::Rigid(rigid) = &body.kind
            && let Some((form, frame)) = form(context, rigid, &mut facets)
        {
            let elastic = rigid.material.map_or(ElasticMaterial::RIGID, |material| {
                let model::Material { young_modulus, contact_modulus, poisson_ratio, .. } = case.materials[material];
                elastic(contact_modulus.unwrap_or(young_modulus), poisson_ratio)
            });
            let mut rigid_body =
                RigidBody::new(&body.name.value, form, frame, elastic, body.kind.surface(&context.case.materials));
            rigid_body.work_of_adhesion = rigid.work_of_adhesion;
            for field in rigid.initial_velocity.iter().flatten() {
                check_field(context, field, std::iter::once(rigid_body.frame.origin));
            }
            drive(&mut rigid_body, rigid);
            rigid_bodies.push(rigid_body);
        }
    }
    for body in &case.bodies {
        let BodyKind::Rigid(rigid) = &body.kind else { continue };
        if let Some(servo) = &rigid.servo {
            let scene_servo = scene_servo(context, servo, &rigid_bodies);
            let own = rigid_bodies.iter_mut().find(|own| own.name == body.name.value);
            if let (Some(scene_servo), Some(own)) = (scene_servo, own) {
                own.along[servo.axis] = Drive::Servo(scene_servo);
            }
        }
    }
    rigid_bodies
}

/// A servo as the scene takes it; an error where it names what is no pair of planes.
fn scene_servo(context: &mut Context<'_>, servo: &model::Servo, bodies: &[RigidBody]) -> Option<Servo> {
    let area = match &servo.force {
        ServoForce::Force(_) => None,
        ServoForce::Pressure { area: model::ServoArea::Given(area), .. } => Some(ServoArea::Given(*area)),
        ServoForce::Pressure { area: model::ServoArea::Between(names), .. } => {
            let plane = |name: &Spanned<String>| {
                let of = |body: &RigidBody| matches!(body.form, Form::Shape { shape: Shape::HalfSpace, .. });
                bodies.iter().position(|body| body.name == name.value && of(body))
            };
            let mut planes = [0; 4];
            for (place, name) in planes.iter_mut().zip(names.iter()) {
                let Some(found) = plane(name) else {
                    let found = format!("= \"{}\"", name.value);
                    context.error(&name.place, found, "a rigid body with shape = \"plane\"");
                    return None;
                };
                *place = found;
            }
            let normal = |plane: usize| bodies[plane].frame.to_space(&Vec3::z());
            let face = |pair: usize| normal(planes[2 * pair]).dot(&normal(planes[2 * pair + 1])) < OPPOSITE;
            let across = |pair: usize| normal(planes[2 * pair])[servo.axis].abs() < ACROSS;
            let crossed = normal(planes[0]).dot(&normal(planes[2])).abs() < ACROSS;
            if !(face(0) && face(1) && across(0) && across(1) && crossed) {
                let expected = "two pairs of planes that face each other, at right angles to one another and along the direction of servo";
                context.error(&names[0].place, "begins no list of such planes", expected);
                return None;
            }
            Some(ServoArea::Between { planes, now: 0.0 })
        }
    };
    let target = function(&servo.function().value);
    Some(Servo { sign: servo.sign, target, area, speed: servo.speed, reach: servo.slows_at })
}

fn form(
    context: &mut Context<'_>,
    rigid: &model::RigidBody,
    facets: &mut impl Iterator<Item = PreparedFacets>,
) -> Option<(Form, Frame)> {
    let shape = |shape| Form::Shape { shape, hollow: rigid.inside };
    let along_z = |axis: &Vec3| rotation_between(&Vec3::z(), axis);
    let turned = |at: Vec3, axis: &Vec3| {
        let rotation = along_z(axis);
        Frame { rotation, ..Frame::at(at) }
    };
    Some(match &rigid.shape {
        RigidShape::Plane { point, normal } => (shape(Shape::HalfSpace), turned(*point, normal)),
        RigidShape::Box { point, size } => (shape(Shape::Cuboid { half: size * 0.5 }), Frame::at(point + size * 0.5)),
        RigidShape::Cylinder { point, axis, length, radius, open } => {
            let (radius, half_length) = (*radius, 0.5 * length);
            let form = if *open {
                Form::Shape { shape: Shape::Tube { radius, half_length }, hollow: true }
            } else {
                shape(Shape::Cylinder { radius, half_length })
            };
            (form, turned(point + axis * half_length, axis))
        }
        RigidShape::Sphere { point, radius } => (shape(Shape::Ball { radius: *radius }), Frame::at(*point)),
        RigidShape::Group { group, point } => (group_facets_of_tool(context, group, point)?, Frame::at(*point)),
        RigidShape::Stl { file, point, .. } => {
            let PreparedFacets { mut points, triangles } = facets.next()?;
            points.iter_mut().for_each(|p| *p -= point);
            match FacetMesh::new(&points, &triangles) {
                Ok(mesh) => (Form::Mesh { mesh, points }, Frame::at(*point)),
                Err(error) => {
                    context.error(&file.name.place, format!("= \"{}\": {error}", file.name.value), "");
                    return None;
                }
            }
        }
    })
}

/// Triangles of a mesh group, or the surface of its tetrahedra.
fn group_facets_of_tool(context: &mut Context<'_>, group: &Spanned<String>, point: &Vec3) -> Option<Form> {
    let (mut tetrahedra, mut facets) = (Vec::new(), Vec::new());
    for part in context.mesh.group(&group.value) {
        tetrahedra.extend(part.tetrahedra.iter().map(|&e| context.mesh.tetrahedra[e as usize]));
        facets.extend(part.triangles.iter().map(|&e| context.mesh.triangles[e as usize]));
    }
    if !tetrahedra.is_empty() {
        facets = topology::boundary_of_tetrahedra(&tetrahedra).iter().map(|f| f.nodes).collect();
    }
    let mut used: Vec<u32> = facets.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let points: Vec<Vec3> = used.iter().map(|&n| context.mesh.nodes[n as usize] - point).collect();
    let place = |n: u32| used.binary_search(&n).map_or(u32::MAX, |place| place as u32);
    let facets: Vec<[u32; 3]> = facets.iter().map(|f| f.map(place)).collect();
    match FacetMesh::new(&points, &facets) {
        Ok(mesh) => Some(Form::Mesh { mesh, points }),
        Err(error) => {
            context.error(&group.place, format!("= \"{}\": {error}", group.value), "triangles, or tetrahedra");
            None
        }
    }
}

/// Nodes of solids that are within other bodies, with their depths [m], deepest first; no rounding of places.
///
/// - `surface`: nodes on the surface of solids
fn deep_nodes(scene: &Scene, surface: &[u32]) -> Vec<(u32, f64, OverlapWith)> {
    let infinite = Vec3::repeat(f64::INFINITY);
    let places = surface.iter().map(|&n| scene.solid.position(n as usize));
    let (low, high) = places.fold((infinite, -infinite), |(low, high), p| (low.inf(&p), high.sup(&p)));
    let mut nodes = scene.node_overlaps();
    nodes.retain(|(_, depth, _)| *depth > DEEP * (high - low).norm());
    nodes
}

/// The shape that solids feel of a rigid body.
fn touches_solids(rigid_body: &RigidBody) -> Option<Shape> {
    match rigid_body.form {
        Form::Shape { shape, hollow: false } => Some(shape),
        _ => None,
    }
}

fn elastic(young_modulus: f64, poisson_ratio: f64) -> ElasticMaterial {
    ElasticMaterial { young_modulus, poisson_ratio }
}

/// Sets how a rigid body moves.
fn drive(rigid_body: &mut RigidBody, rigid: &model::RigidBody) {
    for axis in 0..3 {
        rigid_body.along[axis] = match (&rigid.velocity[axis], rigid.free[axis], &rigid.force[axis]) {
            (Some(velocity), ..) => Drive::Velocity(function(&velocity.value)),
            (None, true, Some(force)) => Drive::Force(function(&force.value)),
            (None, true, None) => Drive::Free,
            _ => Drive::Fixed,
        };
        rigid_body.about[axis] = match &rigid.spin[axis] {
            Some(spin) => Drive::Velocity(function(&spin.value)),
            None if rigid.free_rotation => Drive::Free,
            None => Drive::Fixed,
        };
    }
    let start = rigid_body.frame.origin;
    rigid_body.frame.velocity =
        Vec3::from_fn(|axis, _| rigid.initial_velocity[axis].as_ref().map_or(0.0, |field| field.value.at(start)));
    rigid_body.inertia = rigid.mass.map(|mass| Inertia { mass, tensor: inertia_tensor(&rigid.shape, mass) });
}

/// Moments of inertia of a shape of uniform density, or a wall of uniform thickness, about its centre, in its axes [kg m²].
fn inertia_tensor(shape: &RigidShape, mass: f64) -> Mat3 {
    match shape {
        RigidShape::Box { size, .. } => {
            let s = size.component_mul(size);
            Mat3::from_diagonal(&(Vec3::new(s.y + s.z, s.z + s.x, s.x + s.y) * (mass / 12.0)))
        }
        RigidShape::Cylinder { length, radius, open: true, .. } => {
            let across = mass * (6.0 * radius * radius + length * length) / 12.0;
            Mat3::from_diagonal(&Vec3::new(across, across, mass * radius * radius))
        }
        RigidShape::Cylinder { length, radius, .. } => {
            let across = mass * (3.0 * radius * radius + length * length) / 12.0;
            Mat3::from_diagonal(&Vec3::new(across, across, 0.5 * mass * radius * radius))
        }
        RigidShape::Sphere { radius, .. } => Mat3::identity() * (0.4 * mass * radius * radius),
        // These do not turn freely.
        RigidShape::Plane { .. } | RigidShape::Group { .. } | RigidShape::Stl { .. } => Mat3::identity() * mass,
    }
}
