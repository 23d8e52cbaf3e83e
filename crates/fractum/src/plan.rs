//! What a run will do: bodies, physics on and skipped, time step, size, time.

use fractum_math::elementary::cbrt;
use std::fmt;

use fractum_dem::FractureCriterion as BondCriterion;
use fractum_dem::criterion::{CriterionParameter, Level};
use fractum_fem::{Formulation, Kinematics, Plane, Shape};
use fractum_io::build::{BuiltScene, TieReport};
use fractum_io::case::model::{
    BodyKind, Case, LoadKind, Material, MeshSource, RigidBody, RigidShape, Selection, SolidBody,
};
use fractum_io::number::quantity;
use fractum_mesh::Mesh;
use fractum_scene::statics::{Control, NoEquilibrium, StaticSettings};
use fractum_scene::{BondedBody, Scene};

use crate::input::Input;
use fractum_prepare::{BondedReport, Origin};

/// Nanoseconds per element and step on one core of a common machine: standard, smoothed, smoothed with damage.
const COST: [f64; 3] = [20.0, 45.0, 50.0];
/// Bytes per element: standard, smoothed, smoothed with damage.
const MEMORY: [f64; 3] = [250.0, 450.0, 550.0];

/// Elements that a further thread needs to be of use.
const ELEMENTS_PER_THREAD: usize = 5_000;

/// The same for a bond with its share of particles.
const COST_OF_BOND: f64 = 60.0;
const MEMORY_OF_BOND: f64 = 400.0;

/// The plan of a run, as text.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    lines: Vec<(String, String)>,
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (topic, text)) in self.lines.iter().enumerate() {
            let end = if index + 1 == self.lines.len() { "" } else { "\n" };
            write!(f, "{topic:<12} {text}{end}")?;
        }
        Ok(())
    }
}

impl Plan {
    /// The plan of a case that was read.
    pub fn new(input: &Input) -> Self {
        let Input { case, mesh, built, bonded, choice, .. } = input;
        let mut plan = Plan { lines: Vec::new() };
        let scene = &built.scene;
        if !case.title.is_empty() {
            plan.add("case", &case.title);
        }
        if let Some(source) = &case.mesh {
            plan.describe_mesh(source, mesh);
        }
        plan.describe_bodies(case, scene, bonded);
        plan.describe_ties(&built.ties);
        plan.describe_conditions(case, mesh, scene);
        plan.describe_physics(case, scene);
        if let Some(choice) = choice {
            plan.add("choice", choice);
        }
        match &built.statics {
            Some(settings) => plan.describe_statics(scene, settings),
            None if built.bonded_statics.is_some() => {
                let unknowns = 6 * scene.bonded.particles.len() - scene.bonded.held_count();
                let breaks = scene.bonded.bodies().iter().any(BondedBody::can_break);
                let path = if breaks { "from break to break" } else { "in one solution, since no bond can break" };
                let end = quantity(case.solver.end, "s");
                plan.add("equilibrium", format!("{unknowns} unknowns, {path}, to t = {end}"));
            }
            None => {
                plan.describe_time(case, scene);
                plan.describe_size(case, scene);
            }
        }
        plan
    }

    fn add(&mut self, topic: &str, text: impl Into<String>) {
        self.lines.push((topic.to_owned(), text.into()));
    }

    fn describe_mesh(&mut self, source: &MeshSource, mesh: &Mesh) {
        let (low, high) = mesh.bounding_box();
        let size = high - low;
        self.add(
            "mesh",
            format!(
                "{}: {} nodes, {} tetrahedra, {} triangles, {} x {} x {}",
                source.file.value.display(),
                mesh.nodes.len(),
                mesh.tetrahedra.len(),
                mesh.triangles.len(),
                quantity(size.x, "m"),
                quantity(size.y, "m"),
                quantity(size.z, "m")
            ),
        );
        for notice in &mesh.notices {
            self.add("", notice.clone());
        }
    }

    fn describe_bodies(&mut self, case: &Case, scene: &Scene, bonded: &[BondedReport]) {
        let (mut index, mut reports) = (0, bonded.iter());
        for body in &case.bodies {
            match &body.kind {
                BodyKind::Solid(solid) => {
                    self.describe_solid(case, scene, &body.name.value, solid, index);
                    index += 1;
                }
                BodyKind::Bonded(body) => {
                    if let Some(report) = reports.next() {
                        self.describe_bonded(&case.materials[body.material], report);
                    }
                }
                BodyKind::Particles(loose) => {
                    let found = scene.bonded.bodies().iter().find(|part| part.name == body.name.value);
                    if let Some(part) = found {
                        let all = &scene.bonded.particles;
                        let (radius, mass) = (&all.radius[part.range.clone()], &all.mass[part.range.clone()]);
                        let of =
                            |best: fn(f64, f64) -> f64| quantity(radius.iter().copied().fold(radius[0], best), "m");
                        let text = format!(
                            "{}: {} loose particles of radius {} to {}, {}, mass {}",
                            part.name,
                            radius.len(),
                            of(f64::min),
                            of(f64::max),
                            case.materials[loose.material].name.value,
                            quantity(mass.iter().sum(), "kg")
                        );
                        self.add("body", text);
                    }
                }
                BodyKind::Rigid(rigid) => self.describe_rigid(case, scene, &body.name.value, rigid),
            }
        }
    }

    fn describe_rigid(&mut self, case: &Case, scene: &Scene, name: &str, rigid: &RigidBody) {
        let shape = match &rigid.shape {
            RigidShape::Plane { .. } => "plane".to_owned(),
            RigidShape::Box { .. } => "box".to_owned(),
            RigidShape::Cylinder { .. } => "cylinder".to_owned(),
            RigidShape::Sphere { .. } => "sphere".to_owned(),
            RigidShape::Group { .. } | RigidShape::Stl { .. } => {
                let rigid_body = scene.contacts.rigid_bodies().iter().find(|rigid_body| rigid_body.name == name);
                let facets = rigid_body.map_or(0, |rigid_body| rigid_body.facets());
                format!("mesh of {facets} facets")
            }
        };
        let inside = if rigid.inside { ", around its particles" } else { "" };
        let motion = match (&rigid.mass, rigid.velocity.iter().chain(&rigid.spin).any(Option::is_some)) {
            (Some(mass), _) => format!("free, mass {}", quantity(*mass, "kg")),
            (None, true) => "driven".to_owned(),
            (None, false) => "at rest".to_owned(),
        };
        let made = rigid.material.map_or("rigid", |material| case.materials[material].name.value.as_str());
        let friction = rigid.contact.friction;
        self.add("body", format!("{name}: {made} {shape}{inside}, {motion}, friction {friction}"));
    }

    fn describe_bonded(&mut self, material: &Material, report: &BondedReport) {
        let from = |origin, made: &str| match origin {
            Origin::Made => made.to_owned(),
            Origin::Cached => "from the cache".to_owned(),
            Origin::Given => "as given".to_owned(),
        };
        self.add(
            "body",
            format!(
                "{}: {} bonded particles of mean radius {}, {}, mass {}; packing {}",
                report.name,
                report.particles,
                quantity(report.mean_radius, "m"),
                material.name.value,
                quantity(report.mass, "kg"),
                from(report.packing, "made now")
            ),
        );
        self.add(
            "",
            format!(
                "{} bonds, coordination {:.2} off the walls, {:.2} of all (asked: {})",
                report.bonds, report.coordination_interior, report.coordination_all, report.convention
            ),
        );
        let beams = &report.beams;
        let micro = beams.micro;
        let reached = match beams.reached {
            Some((young, poisson)) => format!(
                ": E = {} and Poisson's ratio {poisson:.4}, E along the axes within {:.2} %, {}",
                quantity(young, "Pa"),
                100.0 * beams.anisotropy,
                if beams.own_packing { "on this packing" } else { "on a box of the same kind" }
            ),
            None => ", not calibrated".to_owned(),
        };
        self.add(
            "",
            format!(
                "beams {}: radius {:.4} mean radii, modulus {}{reached}",
                from(report.beams_from, "calibrated now"),
                micro.radius_ratio,
                quantity(micro.young_modulus, "Pa"),
            ),
        );
        let breaking = match &report.fracture {
            Some((criterion, origin)) => {
                let found = match origin {
                    Origin::Made => "found now by breaking two boxes in tension",
                    Origin::Cached => "from the cache",
                    Origin::Given => "as given",
                };
                format!("bonds break by {}; strengths {found}", criterion_text(criterion))
            }
            None => "bonds hold: the material has no fracture".to_owned(),
        };
        self.add("", breaking);
        let sets: Vec<String> = report.walls.iter().map(|(wall, n)| format!("{}.{wall} {n}", report.name)).collect();
        self.add("", format!("sets of particles: {} {}, {}", report.name, report.particles, sets.join(", ")));
    }

    fn describe_solid(&mut self, case: &Case, scene: &Scene, name: &str, solid: &SolidBody, index: usize) {
        let body = scene.solid.body(index);
        let material = &case.materials[solid.material];
        let formulation = match body.formulation {
            Formulation::Standard => "standard",
            Formulation::Smoothed => "smoothed",
        };
        let shape = match (body.shape, body.plane) {
            (Shape::T4, _) => "tetrahedra".to_owned(),
            (Shape::T3, plane) => {
                let plane = if plane == Plane::Stress { "plane stress" } else { "plane strain" };
                format!("triangles in {plane}, {} thick", quantity(body.thickness, "m"))
            }
        };
        let kinematics = match body.kinematics {
            Kinematics::Small => "small strains",
            Kinematics::Corotational => "corotational",
        };
        let count = body.elements.len();
        let volume: f64 = (0..count as u32).map(|e| scene.solid.element_volume(index, e)).sum();
        self.add(
            "body",
            format!(
                "{name}: {count} {formulation} {shape}, {kinematics}, {}, mass {}, mean size {}",
                material.name.value,
                quantity(volume * material.density, "kg"),
                quantity(mean_size(scene, index, volume), "m")
            ),
        );
        if let Some(damage) = material.damage.as_ref().filter(|_| solid.damage) {
            let d = &damage.value;
            let law = &d.law;
            let zone = material.young_modulus * law.fracture_energy / (law.tensile_strength * law.tensile_strength);
            let (_, ratio) = scene.solid.length_report(index);
            self.add(
                "",
                format!(
                    "process zone E Gf/ft\u{b2} = {}; longest element at {:.1} % of the snap-back length",
                    quantity(zone, "m"),
                    100.0 * ratio
                ),
            );
            if d.crack_plane_gate {
                let tried = if body.shape == Shape::T3 { "" } else { "; in space tried on a tension bar only" };
                self.add("", format!("crack-plane gate: for few, separate, straight cracks{tried}"));
            }
        }
    }

    fn describe_ties(&mut self, ties: &[TieReport]) {
        for TieReport { bonded, solid, particles, facets, within } in ties {
            let within = quantity(*within, "m");
            let text = format!("{bonded} to {solid}: {particles} particles to {facets} facets (gaps up to {within})");
            self.add("tie", text);
        }
    }

    fn describe_conditions(&mut self, case: &Case, mesh: &Mesh, scene: &Scene) {
        for support in &case.supports {
            let letters = |on: &dyn Fn(usize) -> bool| -> String {
                (0..3).filter(|&a| on(a)).map(|a| ['x', 'y', 'z'][a]).collect()
            };
            let axes = letters(&|a| support.motion[a].is_some());
            let turning = support.fix_rotation.as_ref().map_or(0, |bits| bits.value);
            let group = support.on.group_name();
            let what = if case.particle_group(group).is_some() {
                let held = letters(&|a| turning >> a & 1 == 1);
                let held = if turning > 0 { format!(", no turning about {held}") } else { String::new() };
                format!("{axes} of its particles{held}")
            } else {
                match (&support.on.group, &support.on.within) {
                    (Some(_), None) => format!("{axes} of {} nodes", mesh.group_nodes(group).len()),
                    (Some(_), Some(_)) => format!("{axes} of its nodes where the condition holds"),
                    _ => format!("{axes} of nodes of the solids where the condition holds"),
                }
            };
            self.add("support", format!("{}: {what}", support.on.label()));
        }
        let thickness = plane_thickness(scene);
        for load in &case.loads {
            let text = match &load.kind {
                LoadKind::Force { on, .. } => format!("force on {}", on.label()),
                LoadKind::Traction { on, .. } => format!("traction on {}", facets_of(mesh, on, thickness)),
                LoadKind::Pressure { on, .. } => format!("pressure on {}", facets_of(mesh, on, thickness)),
                LoadKind::Gravity { .. } => "gravity on everything".to_owned(),
            };
            self.add("load", text);
        }
        if scene.supports().count() == 0 && scene.bonded.held_count() == 0 && case.loads.is_empty() {
            self.add("load", "none: only initial velocities move this scene");
        }
    }

    fn describe_physics(&mut self, case: &Case, scene: &Scene) {
        let (mut on, mut off) = (vec!["elasticity"], Vec::new());
        let mut choose = |active: bool, name: &'static str, reason: &'static str| {
            if active { on.push(name) } else { off.push(format!("{name} ({reason})")) }
        };
        let damage = (0..scene.solid.body_count()).any(|b| scene.solid.body(b).damage.is_some());
        choose(damage, "damage and removal of elements", "no body can be damaged");
        choose(damage, "discrete elements (from the first removal)", "nothing turns into them");
        choose(scene.bonded.bond_counts().0 > 0, "cohesive beams", "no bonded body");
        let touched =
            (!scene.shape_contacts.is_empty() || scene.contacts.has_node_contacts()) && scene.solid.body_count() > 0;
        choose(touched, "contact of solids with other bodies", "nothing that a solid could meet");
        let balls = !scene.contacts.is_empty() && (damage || !scene.bonded.particles.is_empty());
        choose(balls, "contact of particles by Hertz' law", "no particles that could meet anything");
        let breaks = scene.bonded.bodies().iter().any(BondedBody::can_break);
        choose(breaks, "breaking of bonds", "no material of bonded bodies has a fracture");
        let damping = case.damping;
        choose(damping.local > 0.0 || damping.mass > 0.0, "damping on the nodes", "not asked for");
        let viscous = damping.stiffness > 0.0 || damping.bulk_linear > 0.0 || damping.bulk_quadratic > 0.0;
        choose(viscous, "viscous stress", "not asked for");
        let dissipation = damping.tchamwa_wielgosz.is_some();
        choose(dissipation, "damping of the highest frequencies of particles", "not asked for");
        let turning = (0..scene.solid.body_count()).any(|b| scene.solid.body(b).kinematics == Kinematics::Corotational);
        choose(turning, "large rotations", "all bodies have small strains");
        if !scene.ties.is_empty() {
            on.push("ties of particles to facets");
        }
        self.add("physics", on.join(", "));
        self.add("skipped", off.join(", "));
    }

    fn describe_time(&mut self, case: &Case, scene: &Scene) {
        let governing = match scene.governing_element() {
            Some(stable) => {
                let (body, element) = stable.governing;
                format!("element {element} of {}", scene.solid.body(body).name)
            }
            None if scene.contacts_govern() => "the contacts (Rayleigh's time)".to_owned(),
            None => "the bonds".to_owned(),
        };
        self.add(
            "time step",
            format!(
                "{} ({} of the stable {}), governed by {governing}",
                quantity(scene.clock.dt_after, "s"),
                case.solver.step.as_ref().map_or_else(|| format!("{}", case.solver.safety), |_| "fixed; ".to_owned()),
                quantity(scene.stable_dt(), "s")
            ),
        );
        let steps = (case.solver.end / scene.clock.dt_after).ceil();
        self.add("steps", format!("{steps} to t = {}", quantity(case.solver.end, "s")));
    }

    fn describe_statics(&mut self, scene: &Scene, settings: &StaticSettings) {
        let plane = scene.solid.body(0).shape == Shape::T3;
        let unknowns = scene.solid.reference.len() * if plane { 2 } else { 3 } - scene.supports().count();
        let control = match &settings.control {
            Control::Time => "by steps of the load parameter".to_owned(),
            Control::Path => "along the path of equilibrium, by steps of damage".to_owned(),
            Control::Opening(opening) => {
                let (step, end) = (quantity(opening.step, "m"), quantity(opening.end, "m"));
                format!("along the path of equilibrium, a crack opening by {step} per step, to {end}")
            }
        };
        self.add("equilibrium", format!("{unknowns} unknowns, {control}, to t = {}", quantity(settings.end, "s")));
        if scene.solid.has_damage() {
            self.add("contact", "crack faces that close press on each other, without friction");
        }
        if settings.no_equilibrium == NoEquilibrium::Motion {
            let damping = match settings.damping {
                Some(_) => "the damping of the case",
                None => "twice the critical damping of the first period",
            };
            self.add("motion", format!("where there is no equilibrium, with {damping}"));
        }
    }

    /// Adds what motion and equilibrium would cost.
    pub fn compare_solvers(&mut self, case: &Case, built: &mut BuiltScene) {
        let (nanoseconds, _, elements) = elements_cost(&built.scene);
        // Few elements keep one thread busy only.
        let threads = rayon::current_num_threads().min(1 + elements / ELEMENTS_PER_THREAD);
        let seconds = 1e-9 * nanoseconds / threads as f64;
        for (topic, text) in fractum_prepare::compare(case, built, seconds) {
            self.add(topic, text);
        }
    }

    fn describe_size(&mut self, case: &Case, scene: &Scene) {
        let (mut nanoseconds, mut bytes, elements) = elements_cost(scene);
        let bonds = scene.counts().bonds as f64;
        nanoseconds += COST_OF_BOND * bonds;
        bytes += MEMORY_OF_BOND * bonds;
        let output = 60.0 * elements as f64 + 60.0 * scene.bonded.particles.len() as f64 + 20.0 * bonds;
        let steps = case.solver.end / scene.clock.dt_after;
        let frames = (case.solver.end / case.output.fields_every).ceil() + 1.0;
        let rows = (case.solver.end / case.output.history_every).ceil();
        let threads = rayon::current_num_threads() as f64;
        self.add(
            "size",
            format!(
                "memory {}, {frames} frames of about {} each, {rows} rows of history",
                megabytes(bytes),
                megabytes(output)
            ),
        );
        self.add(
            "wall time",
            format!(
                "about {} on {threads} threads, without output",
                quantity(1e-9 * nanoseconds * steps / threads, "s")
            ),
        );
    }
}

/// Time of the elements in a step [ns], their memory [B], and their number.
fn elements_cost(scene: &Scene) -> (f64, f64, usize) {
    let (mut nanoseconds, mut bytes, mut elements) = (0.0, 0.0, 0);
    for index in 0..scene.solid.body_count() {
        let body = scene.solid.body(index);
        let kind = match (body.formulation, &body.damage) {
            (Formulation::Standard, _) => 0,
            (Formulation::Smoothed, None) => 1,
            (Formulation::Smoothed, Some(_)) => 2,
        };
        let turning = if body.kinematics == Kinematics::Corotational { 10.0 } else { 1.0 };
        nanoseconds += COST[kind] * turning * body.elements.len() as f64;
        bytes += MEMORY[kind] * body.elements.len() as f64;
        elements += body.elements.len();
    }
    (nanoseconds, bytes, elements)
}

fn mean_size(scene: &Scene, body: usize, volume: f64) -> f64 {
    let model = scene.solid.body(body);
    let each = volume / model.elements.len() as f64;
    match model.shape {
        Shape::T4 => cbrt(6.0 * 2f64.sqrt() * each),
        Shape::T3 => (4.0 * each / model.thickness / 3f64.sqrt()).sqrt(),
    }
}

/// Thickness of the first plane body [m], 0 in space.
fn plane_thickness(scene: &Scene) -> f64 {
    let mut bodies = (0..scene.solid.body_count()).map(|index| scene.solid.body(index));
    bodies.find(|body| body.shape == Shape::T3).map_or(0.0, |body| body.thickness)
}

/// The facets that a load acts on, with their area where a group alone tells them.
fn facets_of(mesh: &Mesh, on: &Selection, thickness: f64) -> String {
    match &on.within {
        None => format!("{} ({})", on.label(), area_of(mesh, on.group_name(), thickness)),
        Some(_) => format!("{} (facets where the condition holds)", on.label()),
    }
}

/// Area of the facets of a group; in the plane its lines times the thickness.
fn area_of(mesh: &Mesh, group: &str, thickness: f64) -> String {
    let mut area = 0.0;
    for group in mesh.group(group) {
        if thickness > 0.0 {
            let lengths = group.lines.iter().map(|&line| {
                let [a, b] = mesh.lines[line as usize].map(|n| mesh.nodes[n as usize]);
                (b - a).norm()
            });
            area += thickness * lengths.sum::<f64>();
            continue;
        }
        for &triangle in &group.triangles {
            let [a, b, c] = mesh.triangles[triangle as usize].map(|n| mesh.nodes[n as usize]);
            area += 0.5 * (b - a).cross(&(c - a)).norm();
        }
    }
    quantity(area, "m^2")
}

fn megabytes(bytes: f64) -> String {
    format!("{} MB", (bytes / 1e6).ceil())
}

/// A criterion for bonds in words, with its own strengths.
fn criterion_text(criterion: &BondCriterion) -> String {
    let (kind, numbers) = (criterion.kind(), criterion.numbers());
    let level = match numbers.level {
        _ if !kind.takes(CriterionParameter::Level) => "",
        Level::Own => " of each particle",
        Level::Neighbours => " of each particle and its neighbours",
        Level::Second => " of each particle and two rings of neighbours",
    };
    let mut text = format!("{}{level}: {}", kind.words, quantity(numbers.tensile_strength, "Pa"));
    if kind.takes(CriterionParameter::CompressiveStrength) {
        text += " in tension";
    }
    if let Some(compression) = numbers.compressive_strength {
        text += &format!(", {} in compression", quantity(compression, "Pa"));
    }
    if kind.takes(CriterionParameter::FrictionAngle) {
        text += &format!(", friction angle {:.1} deg", numbers.friction_angle.to_degrees());
    }
    text
}
