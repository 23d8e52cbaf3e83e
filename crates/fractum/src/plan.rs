//! What a run will do: bodies, physics on and skipped, time step, size, time.

mod beds;
mod bodies;
mod contact_pairs;
mod cost;
mod estimate;
mod excavation;
mod gauges;
mod heat;
mod interfaces;
mod rows;
mod strength;
mod time_step;
mod wrap;

use std::fmt;
use std::path::Path;
use std::time::Instant;

use fractum_case::Diagnostic;
use fractum_case::build::{BuiltScene, TieReport};
use fractum_case::model::{
    Body, BodyKind, Case, GroupUse, Load, LoadKind, MeshSource, Selection, SolverKind, SurfaceSupport,
};
use fractum_fem::{Depth, ElementKind, Kinematics, depths_of, facet_area, is_axisymmetric};
use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_output::number::{instant_text, percent, quantity};
use fractum_prepare::Cache;
use fractum_scene::statics::{Control, LinearSolver, NoEquilibrium, StaticSettings};
use fractum_scene::{BondedBody, Domain, GasMeasure, Scene, liquid_of};

use self::cost::Cost;
pub use self::estimate::Estimate;
pub(crate) use self::estimate::estimate;
use crate::error::Failure;
use crate::input::{Input, load};
use crate::process::pool;

/// The plan of a case with what both solvers would cost and how long its run takes, and what is doubtful; some steps are taken for that.
///
/// # Errors
/// As [`load`].
pub fn checked(case: &Path, set: &[(String, String)], cache: &Cache) -> Result<(Plan, Vec<Diagnostic>), Failure> {
    pool(None)?.install(|| {
        let began = Instant::now();
        let mut input = load(case, set, cache)?;
        let set_up = began.elapsed().as_secs_f64();
        let mut plan = Plan::new(&input);
        plan.compare_solvers(&input.case, &mut input.built);
        if let Some(estimate) = estimate(&mut input, set_up) {
            plan.tell(&estimate);
        }
        Ok((plan, input.built.warnings))
    })
}

/// The plan of a run, as text.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    lines: Vec<(String, String)>,
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.wrapped(usize::MAX, str::to_owned))
    }
}

impl Plan {
    /// The plan in lines of at most `width` characters, with its topics in a tone of their own.
    pub fn wrapped(&self, width: usize, topic: impl Fn(&str) -> String) -> String {
        let mut text = String::new();
        for (name, about) in &self.lines {
            for (index, line) in wrap::lines(about, width).iter().enumerate() {
                let name = if index == 0 { format!("{name:<12}") } else { " ".repeat(12) };
                text += &format!("{}{} {line}", if text.is_empty() { "" } else { "\n" }, topic(&name));
            }
        }
        text
    }

    /// The plan of a case that was read.
    pub fn new(input: &Input) -> Self {
        let Input { case, mesh, built, later, bonded, reads, choice, .. } = input;
        let mut plan = Plan { lines: Vec::new() };
        let scene = &built.scene;
        if !case.source.title.is_empty() {
            plan.add("case", &case.source.title);
        }
        if let Some(scale) = case.source.verify.scale {
            let what = format!(
                "verify.scale: lengths and times are {scale} times those of the case, forces {scale}\u{b2} times"
            );
            plan.add("scale", format!("{what}; stresses, velocities and densities stay"));
        }
        if let Some(source) = &case.mesh {
            plan.describe_mesh(source, mesh);
        }
        plan.describe_bodies(case, scene, bonded, reads);
        plan.describe_contact_pairs(case);
        plan.describe_scatter(case, &built.weibull);
        plan.describe_rates(case, scene);
        plan.describe_ties(&built.ties);
        plan.describe_inner_faces(scene);
        if !case.source.stage.is_empty() {
            plan.add("stage", &case.source.stage);
        }
        plan.describe_conditions(case, mesh, built);
        if built.conducts_alone {
            plan.add("physics", "conduction of heat");
        } else {
            plan.describe_physics(case, scene);
        }
        if let Some(choice) = choice {
            plan.add("choice", choice);
        }
        plan.describe_solver(case, built, case.solver.end);
        if let Some(asked) = case.asked_accuracy() {
            plan.add(
                "accuracy",
                format!(
                    "up to {} runs on meshes that are refined where damage came, until the load is known to {} in 9 of 10 cases; this is the plan of the first",
                    asked.most_runs,
                    percent(asked.share.value)
                ),
            );
        }
        plan.describe_heat(case, scene);
        plan.describe_gauges(case, &built.gauges);
        let mut start = case.solver.end;
        for (case, built) in later {
            plan.add("stage", &case.source.stage);
            for told in excavation::told(case, &built.scene) {
                plan.add("excavation", told);
            }
            plan.describe_conditions(case, mesh, built);
            plan.describe_solver(case, built, case.solver.end - start);
            start = case.solver.end;
        }
        plan
    }

    /// - `span`: time from the end of the stage before to that of this one [s]
    fn describe_solver(&mut self, case: &Case, built: &BuiltScene, span: f64) {
        let scene = &built.scene;
        if let Some(end) = time_step::early_end(case) {
            self.add("ends early", end);
        }
        match &built.statics {
            Some(settings) => self.describe_statics(scene, settings),
            None if built.modes.is_some() => self.describe_modes(built),
            None if built.bonded_statics.is_some() => {
                let unknowns = 6 * scene.bonded.particles.len() - scene.bonded.held_count();
                let breaks = scene.bonded.can_break();
                let path = if breaks { "from break to break" } else { "in one solution, since no bond can break" };
                let end = instant_text(case.solver.end, true);
                self.add("equilibrium", format!("{unknowns} unknowns, {path}, to {end}"));
            }
            None if built.conducts_alone => self.describe_size(case, built, span),
            None => {
                self.describe_time(case, scene, span);
                self.describe_size(case, built, span);
            }
        }
    }

    fn add(&mut self, topic: &str, text: impl Into<String>) {
        self.lines.push((topic.to_owned(), text.into()));
    }

    fn describe_mesh(&mut self, source: &MeshSource, mesh: &Mesh) {
        let (low, high) = mesh.bounding_box();
        let size = high - low;
        let counts = [
            (mesh.nodes.len(), "nodes"),
            (mesh.tetrahedron_count(), "tetrahedra"),
            (mesh.triangles.len(), "triangles"),
        ];
        let counted = counts.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} {name}"));
        let lengths = if size.z > 0.0 { 3 } else { 2 };
        let lengths: Vec<String> = size.iter().take(lengths).map(|&length| quantity(length, "m")).collect();
        let (counted, lengths) = (counted.collect::<Vec<_>>().join(", "), lengths.join(" x "));
        self.add("mesh", format!("{}: {counted}, {lengths}", source.file.value.display()));
        if let Some((share, seed)) = source.scramble {
            let share = percent(share);
            self.add(
                "",
                format!(
                    "mesh.scramble: inner nodes moved at random by up to {share} of their shortest edge, seed {seed}"
                ),
            );
        }
        if source.halvings > 0 {
            let (times, each) = (1u64 << source.halvings, if mesh.tetrahedra.is_empty() { 4u64 } else { 8 });
            let parts = each.pow(source.halvings);
            self.add(
                "",
                format!("mesh.halvings: elements {times} times smaller than in the file, {parts} for each of it"),
            );
        }
        for notice in &mesh.notices {
            self.add("", notice.clone());
        }
    }

    fn describe_ties(&mut self, ties: &[TieReport]) {
        for TieReport { bonded, solid, particles, facets, within } in ties {
            let within = quantity(*within, "m");
            let text = format!("{bonded} to {solid}: {particles} particles to {facets} facets (gaps up to {within})");
            self.add("tie", text);
        }
    }

    fn describe_conditions(&mut self, case: &Case, mesh: &Mesh, built: &BuiltScene) {
        let scene = &built.scene;
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
            } else if let Some(surface) = &support.surface {
                match surface.value {
                    SurfaceSupport::Absorbing => "waves leave through its facets".to_owned(),
                    SurfaceSupport::Elastic { normal, tangential } => {
                        let [along, across] = [normal, tangential].map(|k| quantity(k, "Pa/m"));
                        format!("springs on its facets, {along} along the normal, {across} across it")
                    }
                }
            } else {
                match (&support.on.group, &support.on.within) {
                    (Some(_), None) => format!("{axes} of {} nodes", mesh.group_nodes(group).len()),
                    (Some(_), Some(_)) => format!("{axes} of its nodes where the condition holds"),
                    _ => format!("{axes} of nodes of the solids where the condition holds"),
                }
            };
            self.add("support", format!("{}: {what}", support.on.label()));
        }
        let depths = depths_of(&scene.solid);
        let depth =
            depths.map(|depths| move |line: [u32; 2]| depths.at(&line.map(|node| built.scene_node[node as usize])));
        if is_axisymmetric(&scene.solid) {
            let held = match scene.solid.reference.iter().filter(|place| place.x <= 0.0).count() {
                0 => String::new(),
                nodes => format!("; the {nodes} nodes on it are held along x"),
            };
            self.add("axis", format!("y, x is the radius: forces, areas and masses are those of the whole turn{held}"));
        }
        let delay = |load: &Load| match &load.kind {
            LoadKind::Pressure { pressure, .. } => pressure.value.delay(),
            _ => None,
        };
        let delays = case.loads.iter().filter_map(delay);
        let holes = delays.clone().count();
        if holes > 0 {
            let (first, last) = delays.fold((f64::INFINITY, 0.0), |(a, b), t| (t.min(a), t.max(b)));
            self.add(
                "load",
                format!("firing sequence of {holes} holes from {} to {}", quantity(first, "s"), quantity(last, "s")),
            );
        }
        let front = |load: &Load| match &load.kind {
            LoadKind::Pressure { detonation, .. } => detonation.map(|front| front.velocity),
            _ => None,
        };
        let fronts = case.loads.iter().filter_map(front);
        let (slowest, fastest) = fronts.fold((f64::INFINITY, 0.0f64), |(a, b), v| (v.min(a), v.max(b)));
        if fastest > 0.0 {
            let [slowest, fastest] = [slowest, fastest].map(|velocity| quantity(velocity, "m/s"));
            let range = if slowest == fastest { fastest } else { format!("{slowest} to {fastest}") };
            self.add("", format!("pressures begin behind fronts of detonation of {range}"));
        }
        for load in case.loads.iter().filter(|load| delay(load).is_none()) {
            let on = match load.kind.on() {
                Some((on, GroupUse::Facets)) if case.particle_group(on.group_name()).is_some() => {
                    format!("{}, by the part of the walls that each particle shows", on.label())
                }
                Some((on, GroupUse::Facets)) => facets_of(mesh, on, depth.as_ref()),
                Some((on, _)) => on.label().to_owned(),
                None => "everything".to_owned(),
            };
            let entered = matches!(load.kind, LoadKind::Pressure { in_cracks: Some(_), .. });
            let cracks = if entered { " and in the cracks open to it" } else { "" };
            self.add("load", format!("{} on {on}{cracks}", load.kind.name()));
        }
        if let Some(Domain { min, max }) = scene.domain() {
            let corner = |p: Vec3| format!("({}, {}, {})", quantity(p.x, "m"), quantity(p.y, "m"), quantity(p.z, "m"));
            self.add("domain", format!("free pieces outside {} to {} leave the run", corner(min), corner(max)));
        }
        let is_first = case.excavation.is_none() || !case.later.is_empty();
        if let Some(stress) = case.in_situ.as_ref().filter(|_| is_first) {
            self.add(
                "in situ",
                match (stress.is_as_written(), stress.settles) {
                    (true, true) => "settled at t = 0 from the stress that is written; displacements count from there",
                    (true, false) => "at rest at t = 0, every body with its stress as it is written",
                    _ => "at rest under the stress of the far field at t = 0; displacements count from there",
                },
            );
            built.settled.iter().for_each(|own| self.add("settled", format!("the stress of {own}")));
        }
        if let Some(gas) = scene.gas() {
            let of = |measure| gas.measure(&scene.solid, measure, None);
            let amount = quantity(of(GasMeasure::Mass), "kg") + ", " + &quantity(of(GasMeasure::Energy), "J");
            let faces = match gas.face_count() {
                0 => String::new(),
                faces => format!("; it may enter {faces} faces of interfaces"),
            };
            self.add("gas", format!("in {} holes: {amount} at the start{faces}", gas.hole_count()));
        }
        if let Some(liquid) = liquid_of(scene) {
            let own = case.flows.liquid.as_ref();
            let places = own.map_or(0, |liquid| liquid.injections.len());
            let words = if places == 1 { "injection" } else { "injections" };
            let beside = if scene.solid.is_plane() { "" } else { "; in space ten faces along a radius are too few" };
            let cells = liquid.cell_count();
            match places {
                0 if cells > 0 => self.add("liquid", format!("in {cells} cells of interfaces{beside}")),
                0 => {}
                _ => self.add("liquid", format!("{places} {words} into {cells} cells of interfaces{beside}")),
            }
            for (index, hole) in own.iter().flat_map(|liquid| &liquid.holes).enumerate() {
                let (volume, beside) = liquid.hole(index);
                let met = match beside {
                    0 => "no interface takes liquid from it".to_owned(),
                    1 => "interfaces meet it in one place".to_owned(),
                    places => format!("interfaces meet it in {places} places"),
                };
                self.add("liquid", format!("hole \"{}\" of {}: {met}", hole.on.label(), quantity(volume, "m^3")));
            }
        }
        if !matches!(case.solver.kind, SolverKind::Heat | SolverKind::Modes) {
            self.describe_what_moves(case, scene);
        }
    }

    /// What moves a scene without supports and loads.
    fn describe_what_moves(&mut self, case: &Case, scene: &Scene) {
        let pushed = !case.loads.is_empty() || scene.gas().is_some();
        if scene.supports().count() == 0 && scene.bonded.held_count() == 0 && !pushed {
            let driven = |body: &&Body| match &body.kind {
                BodyKind::Rigid(rigid) => rigid.functions().next().is_some(),
                _ => false,
            };
            let driven: Vec<&str> = case.bodies.iter().filter(driven).map(|body| body.name.value.as_str()).collect();
            self.add(
                "load",
                match driven.as_slice() {
                    [] if case.periodic.as_ref().is_some_and(|own| own.deforms()) => {
                        "none: the periodic box moves this scene".to_owned()
                    }
                    [] => "none: only initial velocities move this scene".to_owned(),
                    driven => format!("none: rigid bodies move this scene: {}", driven.join(", ")),
                },
            );
        }
    }

    fn describe_physics(&mut self, case: &Case, scene: &Scene) {
        let damage = (0..scene.solid.body_count()).any(|b| scene.solid.body(b).damage.is_some());
        let beams = |body: &BondedBody| body.bonds.beam().is_some();
        let bonded = || scene.bonded.bodies().iter().filter(|body| !body.bonds.is_empty());
        let breaks = scene.bonded.can_break();
        let touched =
            (!scene.shape_contacts.is_empty() || scene.contacts.has_node_contacts()) && scene.solid.body_count() > 0;
        let balls = !scene.contacts.is_empty() && (damage || !scene.bonded.particles.is_empty());
        let has_discs = scene.bonded.particles.thickness.is_some();
        let damping = case.damping;
        let viscous = damping.stiffness > 0.0 || damping.bulk_linear > 0.0 || damping.bulk_quadratic > 0.0;
        let on_nodes = damping.local > 0.0 || damping.mass > 0.0;
        let dissipation = damping.tchamwa_wielgosz.is_some();
        let turning = (0..scene.solid.body_count()).any(|b| scene.solid.body(b).kinematics == Kinematics::Corotational);
        let on = [
            (true, "elasticity"),
            (damage, "damage and removal of elements"),
            (damage, "discrete elements (from the first removal)"),
            (bonded().any(beams), "cohesive beams"),
            (bonded().any(|body| !beams(body)), "interfaces of the local law"),
            (touched, "contact of solids with other bodies"),
            (balls && !has_discs, "contact of particles by Hertz' law"),
            (has_discs, "contact of discs"),
            (breaks, "breaking of bonds"),
            (on_nodes, "damping on the nodes"),
            (viscous, "viscous stress"),
            (dissipation, "damping of the highest frequencies of particles"),
            (turning, "large rotations"),
            (!scene.ties.is_empty(), "ties of particles to facets"),
            (!scene.interfaces().is_empty(), "interfaces between elements"),
        ];
        let off = [
            (!damage, "damage"),
            (!damage, "discrete elements"),
            (!bonded().any(beams), "bonds"),
            (!(touched || balls), "contact"),
            (!(on_nodes || viscous || dissipation), "damping"),
            (!turning, "large rotations"),
        ];
        let [on, off] = [&on[..], &off[..]].map(names);
        self.add("physics", on);
        if !off.is_empty() {
            self.add("skipped", off);
        }
    }

    fn describe_modes(&mut self, built: &BuiltScene) {
        let (solid, Some(settings)) = (&built.scene.solid, built.modes) else { return };
        let axes = if solid.is_plane() { 2 } else { 3 };
        let of_solids = solid.reference.len() * axes - built.scene.supports().count();
        let bonded = &built.scene.bonded;
        let unknowns = of_solids + 6 * bonded.particles.len() - bonded.held_count();
        let how = match settings.linear {
            LinearSolver::Auto => "a factorisation or an iteration, by size",
            LinearSolver::Direct => "a factorisation",
            LinearSolver::Iterative => "an iteration",
            LinearSolver::Faer => "a factorisation by faer, whose bits depend on the processor",
        };
        let count = settings.count;
        self.add("modes", format!("the {count} slowest natural vibrations of {unknowns} unknowns, by {how}"));
    }

    fn describe_statics(&mut self, scene: &Scene, settings: &StaticSettings) {
        let plane = scene.solid.body(0).shape == ElementKind::T3;
        let unknowns = scene.solid.reference.len() * if plane { 2 } else { 3 } - scene.supports().count();
        let heats = scene.heat().is_some();
        let control = match &settings.control {
            Control::Time if heats => "by steps of time".to_owned(),
            Control::Time => "by steps of the load parameter".to_owned(),
            Control::TimeThenPath => "by steps of the load parameter; from the first one on that has no equilibrium along its path, by steps of interfaces that soften".to_owned(),
            Control::Path => format!("along the path of equilibrium, by steps of {}", softening(scene)),
            Control::Opening(opening) => {
                let (step, end) = (quantity(opening.step, "m"), quantity(opening.end, "m"));
                format!("along the path of equilibrium, a crack opening by {step} per step, to {end}")
            }
        };
        self.add("equilibrium", format!("{unknowns} unknowns, {control}, to {}", instant_text(settings.end, !heats)));
        if settings.linear == LinearSolver::Faer {
            self.add("", "linear systems by faer: results differ in their last digits from processor to processor");
        }
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
        if case.later.is_empty() {
            for (topic, text) in crate::solver::choice::compare(case, built) {
                self.add(topic, text);
            }
        }
    }

    /// Tells how long the run takes instead of what its counts say.
    fn tell(&mut self, estimate: &Estimate) {
        self.lines.retain(|(topic, _)| topic != TIME);
        let Estimate { set_up, steps, output } = *estimate;
        let [total, set_up, steps, output] =
            [estimate.total(), set_up, steps, output].map(|time| quantity(significant(time), "s"));
        let threads = threads();
        self.add(TIME, format!("about {total} on {threads}: {set_up} to set up, {steps} of steps, {output} of output"));
    }

    fn describe_size(&mut self, case: &Case, built: &BuiltScene, span: f64) {
        let scene = &built.scene;
        let cost = Cost::of(scene, span);
        // Heat alone has steps of its own, in which nothing else is computed.
        let steps = if built.conducts_alone { 0.0 } else { span / scene.clock.dt_after };
        let frames = (span / case.output.fields_every).ceil() + 1.0;
        let rows = (span / case.output.history_every).ceil();
        let threads = rayon::current_num_threads();
        self.add(
            "size",
            format!(
                "memory {}, {frames} frames of about {} each, {rows} rows of history",
                megabytes(cost.memory(frames)),
                megabytes(cost.frame)
            ),
        );
        let time = quantity(cost.time(steps, threads as f64), "s");
        self.add(TIME, format!("about {time} on {}, without output", self::threads()));
    }
}

/// Topic of the time on the clock.
const TIME: &str = "wall time";

/// The threads of the present pool in words.
fn threads() -> String {
    let threads = rayon::current_num_threads();
    format!("{threads} thread{}", if threads == 1 { "" } else { "s" })
}

/// What the steps of a path are measured by.
fn softening(scene: &Scene) -> &'static str {
    let interfaces = scene.interfaces().kinds().iter().any(|kind| kind.law.is_bonded());
    match (scene.solid.has_damage(), interfaces) {
        (_, false) => "damage",
        (true, true) => "damage and of interfaces that soften",
        (false, true) => "interfaces that soften",
    }
}

/// Two digits of a time.
fn significant(time: f64) -> f64 {
    fractum_output::number::significant(time, 2).parse().unwrap_or(time)
}

/// The names of what is so, as a list.
fn names(all: &[(bool, &str)]) -> String {
    let names: Vec<&str> = all.iter().filter(|(so, _)| *so).map(|(_, name)| *name).collect();
    names.join(", ")
}

/// The facets that a load acts on, with their area where a group alone tells them.
fn facets_of(mesh: &Mesh, on: &Selection, depth: Option<impl Fn([u32; 2]) -> Depth>) -> String {
    match &on.within {
        None => format!("{} ({})", on.label(), area_of(mesh, on.group_name(), depth)),
        Some(_) => format!("{} (facets where the condition holds)", on.label()),
    }
}

/// Area of the facets of a group; in the plane its lines times the depth there.
fn area_of(mesh: &Mesh, group: &str, depth: Option<impl Fn([u32; 2]) -> Depth>) -> String {
    let mut area = 0.0;
    for group in mesh.group(group) {
        if let Some(depth) = &depth {
            let areas = group.lines.iter().map(|&line| {
                let ends = mesh.lines[line as usize];
                let [a, b] = ends.map(|n| mesh.nodes[n as usize]);
                facet_area([a, b, b], Some(depth(ends))).norm()
            });
            area += areas.sum::<f64>();
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
