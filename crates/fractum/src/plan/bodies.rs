//! Bodies in the plan of a run.

use fractum_calibrate::crushing::Crushing;
use fractum_calibrate::strength::Pulling;
use fractum_case::model::{
    BodyKind, Case, LooseSource, Material, Periodic, Rate, RigidBody, RigidShape, ServoForce, Sizes, SolidBody,
    SolverKind, Stream,
};
use fractum_dem::FractureCriterion as BondCriterion;
use fractum_dem::criterion::{CriterionParameter, Level};
use fractum_fem::{
    DamageLaw, Depth, EXCESS_OF_PEAK, ElementKind, Formulation, Kinematics, LengthReport, Plane, crack_scale, motion,
    neighbours,
};
use fractum_math::elementary::cbrt;
use fractum_output::number::quantity;
use fractum_prepare::{BondedReport, FoundStrengths, InterfaceReport, Joints, Origin};
use fractum_scene::Scene;

use super::{Plan, rows};

/// A box that repeats, and how it deforms.
fn box_in_words(periodic: &Periodic) -> String {
    const AXES: [char; 3] = ['x', 'y', 'z'];
    let list = |of: Vec<String>| of.join(", ");
    let axes = list((0..3).filter(|&k| periodic.axes[k]).map(|k| AXES[k].to_string()).collect());
    let [x, y, z] = [0, 1, 2].map(|k| quantity(periodic.size.value[k], "m"));
    let mut text = format!("periodic along {axes}, {x} by {y} by {z}");
    if !periodic.rates.is_empty() {
        let rates = periodic.rates.iter().map(|([i, j], _)| format!("{}{}", AXES[*i], AXES[*j])).collect();
        text += &format!(", deforms by {}", list(rates));
    }
    if let Some(servo) = &periodic.servo {
        let held = servo.stress.iter().map(|(axis, _)| format!("{0}{0}", AXES[*axis])).collect();
        text += &format!(", holds the stress {} by at most {}", list(held), quantity(servo.rate, "1/s"));
    }
    text
}

impl Plan {
    pub(super) fn describe_bodies(
        &mut self,
        case: &Case,
        scene: &Scene,
        bonded: &[BondedReport],
        reads: &[(String, String)],
    ) {
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
                        // Those that are to come in have negative radii.
                        let radius: Vec<f64> = all.radius[part.range.clone()].iter().map(|r| r.abs()).collect();
                        let mass = &scene.bonded.clumps().masses(all)[part.range.clone()];
                        let of =
                            |best: fn(f64, f64) -> f64| quantity(radius.iter().copied().fold(radius[0], best), "m");
                        let what = match (&loose.clump, &loose.thickness) {
                            (None, None) => format!("{} loose particles", radius.len()),
                            (None, Some(thickness)) => {
                                let discs = if radius.len() == 1 { "disc" } else { "discs" };
                                format!(
                                    "{} plane {discs} of thickness {}",
                                    radius.len(),
                                    quantity(thickness.value, "m")
                                )
                            }
                            (Some(clump), _) => {
                                let each = clump.value.shape.spheres().len();
                                let spheres = if each == 1 { "sphere" } else { "spheres" };
                                let clumps = if radius.len() == each { "clump" } else { "clumps" };
                                format!("{} {clumps} of {each} {spheres}, in all {}", radius.len() / each, radius.len())
                            }
                        };
                        let text = format!(
                            "{}: {what} of radius {} to {}, {}, mass {}",
                            part.name,
                            of(f64::min),
                            of(f64::max),
                            case.materials[loose.material].name.value,
                            quantity(mass.iter().sum(), "kg")
                        );
                        let energy = case.materials[loose.material].work_of_adhesion;
                        let text = match energy > 0.0 {
                            true => format!("{text}, work of adhesion {}", quantity(energy, "J/m^2")),
                            false => text,
                        };
                        let graded = match &loose.source {
                            LooseSource::Graded { .. } => radius.iter().any(|r| *r != radius[0]),
                            LooseSource::Inlet { stream, .. } => matches!(stream.sizes, Sizes::Graded(_)),
                            _ => false,
                        };
                        let power = if loose.thickness.is_some() { 2 } else { 3 };
                        self.add("body", if graded { text + &passing(&radius, power) } else { text });
                        if let LooseSource::Inlet { stream, .. } = &loose.source {
                            self.add("", stream_in_words(stream));
                        }
                    }
                }
                BodyKind::Rigid(rigid) => self.describe_rigid(case, scene, &body.name.value, rigid),
            }
            for (_, told) in reads.iter().filter(|(name, _)| *name == body.name.value) {
                self.add("", told.clone());
            }
        }
        if let Some(periodic) = &case.periodic {
            self.add("box", box_in_words(periodic));
        }
    }

    fn describe_rigid(&mut self, case: &Case, scene: &Scene, name: &str, rigid: &RigidBody) {
        let shape = match &rigid.shape {
            RigidShape::Plane { .. } => "plane".to_owned(),
            RigidShape::Box { .. } => "box".to_owned(),
            RigidShape::Cylinder { open: true, .. } => "cylinder without lids, felt from both sides".to_owned(),
            RigidShape::Cylinder { .. } => "cylinder".to_owned(),
            RigidShape::Sphere { .. } => "sphere".to_owned(),
            RigidShape::Group { .. } | RigidShape::Stl { .. } => {
                let rigid_body = scene.contacts.rigid_bodies().iter().find(|rigid_body| rigid_body.name == name);
                let facets = rigid_body.map_or(0, |rigid_body| rigid_body.facets());
                let side = match rigid_body.map_or(0, |rigid_body| rigid_body.open_edges()) {
                    0 => String::new(),
                    1 => ", open at 1 edge and felt from both sides".to_owned(),
                    count => format!(", open at {count} edges and felt from both sides"),
                };
                format!("mesh of {facets} facets{side}")
            }
        };
        let inside = if rigid.inside { ", around its particles" } else { "" };
        let servo = rigid.servo.as_ref().map(|servo| {
            let by = if matches!(servo.force, ServoForce::Force(_)) { "force" } else { "pressure" };
            format!(", held at a {by} by a servo, at most {}", quantity(servo.speed, "m/s"))
        });
        let motion = match (&rigid.mass, rigid.velocity.iter().chain(&rigid.spin).any(Option::is_some)) {
            (Some(mass), _) => format!("free, mass {}", quantity(*mass, "kg")),
            (None, true) => "driven".to_owned(),
            (None, false) if servo.is_some() => "driven".to_owned(),
            (None, false) => "at rest".to_owned(),
        };
        let servo = servo.unwrap_or_default();
        let made = rigid.material.map_or("rigid", |material| case.materials[material].name.value.as_str());
        let friction = rigid.contact.friction;
        let index = scene.contacts.rigid_bodies().iter().position(|rigid_body| rigid_body.name == name);
        let touches =
            scene.solid.body_count() > 0 && !matches!(case.solver.kind, SolverKind::Static | SolverKind::Modes);
        let touched = index.filter(|_| touches).map(|index| scene.holds_nodes(index));
        let how = match touched {
            Some(true) => ", holds nodes of solids",
            Some(false) => ", presses on solids by springs",
            None => "",
        };
        self.add("body", format!("{name}: {made} {shape}{inside}, {motion}{servo}, friction {friction}{how}"));
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
        let stiffer = match report.wall_stiffening {
            0.0 => String::new(),
            by => format!("; stiffer by {by} for each of their particles at a wall"),
        };
        let coordination = if report.walls.is_empty() {
            format!("coordination {:.2}, without walls", report.coordination_all)
        } else {
            let (inside, all) = (report.coordination_interior, report.coordination_all);
            format!("coordination {inside:.2} off the walls, {all:.2} of all (asked: {}){stiffer}", report.convention)
        };
        self.add("", format!("{} bonds, {coordination}", report.bonds));
        let sets = report.walls.iter().map(|(wall, n)| format!(", {}.{wall} {n}", report.name)).collect::<String>();
        let sets = format!("sets of particles: {} {}{sets}", report.name, report.particles);
        let (beams, beams_from) = match &report.joints {
            Joints::Beams(beams, from) => (beams, *from),
            Joints::Interfaces(interfaces) => {
                self.describe_interfaces(interfaces);
                self.add("", sets);
                return;
            }
        };
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
                from(beams_from, "calibrated now"),
                micro.radius_ratio,
                quantity(micro.young_modulus, "Pa"),
            ),
        );
        let breaking = match &report.fracture {
            Some(FoundStrengths { criterion, at_walls, origin, crushing, .. }) => {
                let tests = if crushing.is_some() { ", and three prisms in compression" } else { "" };
                let found = match origin {
                    Origin::Made => format!("found now by breaking three boxes in tension{tests}"),
                    Origin::Cached => "from the cache".to_owned(),
                    Origin::Given => "as given".to_owned(),
                };
                let where_read = if *at_walls { ", at walls the stress of the wall" } else { "" };
                format!("bonds break by {}{where_read}; strengths {found}", criterion_text(criterion))
            }
            None => "bonds hold: the material has no fracture".to_owned(),
        };
        self.add("", breaking);
        if let Some(text) = report.fracture.as_ref().and_then(strength_text) {
            self.add("", text);
        }
        self.add("", sets);
    }

    fn describe_interfaces(&mut self, report: &InterfaceReport) {
        let InterfaceReport { law, mean_share } = report;
        let share = format!("interfaces of {mean_share:.3} times the section of the smaller particle on average");
        self.add(
            "",
            format!("{share}, E = {}, Poisson's ratio {}", quantity(law.young_modulus, "Pa"), law.poisson_ratio),
        );
        if law.mean_strain.is_some() {
            self.add(
                "",
                "they resist what goes beyond the mean strain of particles, which follows Hooke's law".to_owned(),
            );
        }
        if !law.can_fail() {
            self.add("", "interfaces hold for ever: their strengths are unlimited".to_owned());
            return;
        }
        let strength = |value: f64| if value.is_finite() { quantity(value, "Pa") } else { "unlimited".to_owned() };
        self.add(
            "",
            format!(
                "interfaces fail at {} in tension, {} + {} times the pressure in shear; then friction {}",
                strength(law.tensile_strength),
                strength(law.shear_strength),
                law.internal_friction,
                law.friction
            ),
        );
    }

    fn describe_solid(&mut self, case: &Case, scene: &Scene, name: &str, solid: &SolidBody, index: usize) {
        let body = scene.solid.body(index);
        let material = &case.materials[solid.material];
        let formulation = match body.formulation {
            Formulation::Standard => "standard",
            Formulation::Smoothed => "smoothed",
        };
        let shape = match (body.shape, body.plane) {
            (ElementKind::T4, _) => "tetrahedra".to_owned(),
            (ElementKind::T3, Plane::Axisymmetric) => "axisymmetric triangles, turned about the y axis".to_owned(),
            (ElementKind::T3, plane) => {
                let plane = if plane == Plane::Stress { "plane stress" } else { "plane strain" };
                format!("triangles in {plane}, {} thick", quantity(body.thickness, "m"))
            }
        };
        let kinematics = match body.kinematics {
            Kinematics::Small => "small strains",
            Kinematics::Corotational => "corotational",
            Kinematics::Auto if matches!(case.solver.kind, SolverKind::Static | SolverKind::Modes) => "small strains",
            Kinematics::Auto => "small strains until it turns",
        };
        let closing = match body.damage.as_ref().map(|zone| &zone.law) {
            Some(law) if law.unilateral => ", cracks close under pressure".to_owned(),
            Some(DamageLaw { friction: Some(friction), .. }) => {
                format!(", cracks close under pressure and rub with a coefficient of {friction}")
            }
            _ => String::new(),
        };
        let (count, volume) = (neighbours::element_count(&scene.solid, index), neighbours::volume(&scene.solid, index));
        self.add(
            "body",
            format!(
                "{name}: {count} {formulation} {shape}, {kinematics}{closing}, {}, mass {}, mean size {}",
                material.name.value,
                quantity(volume * material.density, "kg"),
                quantity(mean_size(scene, index, volume), "m")
            ),
        );
        if let Some(beds) = &material.bedding {
            self.describe_beds(&beds.value, body);
        }
        if let Some(damage) = material.damage.as_ref().filter(|_| solid.damage) {
            let d = &damage.value;
            let zone = material.process_zone().unwrap_or(f64::INFINITY);
            let LengthReport { largest_ratio, size, .. } = scene.solid.length_report(index);
            let beside = if d.regularisation.is_some() {
                format!("length b of the phase field at {:.1} % of the longest possible", 100.0 * largest_ratio)
            } else {
                let extent = body.smallest_extent(&scene.solid.reference);
                let [excess, most] = EXCESS_OF_PEAK.map(|factor| 100.0 * factor * size / crack_scale(zone, extent));
                let late = match body.formulation {
                    Formulation::Smoothed => format!("cracks from notches run some {excess:.1} % late"),
                    Formulation::Standard => format!("loads of cracks from notches are off by {most:.1} % at most"),
                };
                format!(
                    "elements where cracks are expected {:.3} of it and {:.3} of the smallest extent of the body: {late}; longest element at {:.1} % of the snap-back length",
                    size / zone,
                    size / extent,
                    100.0 * largest_ratio
                )
            };
            self.add("", format!("process zone E Gf/ft\u{b2} = {}; {beside}", quantity(zone, "m")));
            if let Some([length, size]) = motion::phase_sizes(&scene.solid, index) {
                let depth = body.smallest_extent(&scene.solid.reference);
                self.add("", format!(
                    "phase field of length b = {}, {:.1} of the elements where cracks are expected ({}); b is {:.1} % of the smallest extent of the body, {}: in bending across it a peak without notch is about that much too high (0.9 to 1.2 times)",
                    quantity(length, "m"),
                    length / size,
                    quantity(size, "m"),
                    100.0 * length / depth,
                    quantity(depth, "m")
                ));
            }
            // A phase field does not follow rows.
            let in_rows = if d.regularisation.is_none() { rows::share(body, &scene.solid.reference) } else { 0.0 };
            if in_rows > rows::MANY {
                let (share, count) = (100.0 * in_rows, rows::directions(body.shape));
                self.add("", format!(
                    "rows: {share:.0} % of the edges that may be damaged lie within 5 deg of {count} directions, and cracks like to follow them; mesh by another algorithm (Gmsh: Mesh.Algorithm = 5), or set regularisation = \"phase-field\""
                ));
            }
        }
    }
}

fn mean_size(scene: &Scene, body: usize, volume: f64) -> f64 {
    let model = scene.solid.body(body);
    let each = volume / neighbours::element_count(&scene.solid, body) as f64;
    match model.shape {
        ElementKind::T4 => cbrt(6.0 * 2f64.sqrt() * each),
        ElementKind::T3 if model.is_axisymmetric() => {
            let volumes = (0..).zip(scene.solid.element_volumes(body));
            let depth = |element| Depth::Turn.at(&scene.solid.element_middle(body, element));
            let area: f64 = volumes.map(|(element, volume)| volume / depth(element)).sum();
            (4.0 * area / (model.elements.len() as f64 * 3f64.sqrt())).sqrt()
        }
        ElementKind::T3 => (4.0 * each / model.thickness / 3f64.sqrt()).sqrt(),
    }
}

/// What bodies of such bonds bear; nothing where the strengths are as given.
fn strength_text(found: &FoundStrengths) -> Option<String> {
    let (tension, Pulling { scatter, .. }) = found.pulling?;
    let mut text = format!("such bodies bear {} \u{b1} {:.1} % in tension", quantity(tension, "Pa"), 100.0 * scatter);
    let kind = found.criterion.kind();
    text += &match found.crushing {
        Some(Crushing { reached, scatter: crushed, friction_angle, .. }) => {
            let angle = friction_angle.map(|both| both.map(f64::to_degrees)).map_or_else(
                || "their friction angle is not measured at rest".to_owned(),
                |[angle, spread]| format!("their friction angle is {angle:.0} \u{b1} {spread:.0} deg"),
            );
            format!(
                " and {} \u{b1} {:.1} % in compression, {:.1} \u{b1} {:.1} times as much; {angle} (standard deviations of three packings)",
                quantity(reached, "Pa"),
                100.0 * crushed,
                reached / tension,
                reached / tension * (scatter * scatter + crushed * crushed).sqrt(),
            )
        }
        None if kind.slips => "; strength in compression is not calibrated, as no compressive_strength is given".into(),
        None => {
            let name = kind.name;
            format!(
                "; strength in compression is not calibrated with criterion = \"{name}\"; it is with \"mohr-coulomb\""
            )
        }
    };
    if let Some(Crushing { chains, .. }) = found.crushing.filter(|found| found.chains >= SPLITS) {
        text += &format!(
            "; tension of up to {chains:.2} of the compression across it is spared, so that splitting under compression is not calibrated"
        );
    }
    Some(text)
}

/// Share of a compression that is spared as the work of chains from which on the middle of a disc that splits is spared too.
const SPLITS: f64 = 0.3;

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

/// How particles come in.
fn stream_in_words(stream: &Stream) -> String {
    let rate = match stream.rate {
        Rate::Mass(rate) => quantity(rate, "kg/s"),
        Rate::Number(rate) => format!("{rate} particles per second"),
    };
    let end = stream.until.map_or_else(|| "all are in".to_owned(), |until| quantity(until, "s"));
    format!("come in through an inlet: {rate} from {} until {end}", quantity(stream.from, "s"))
}

/// Diameters below which shares of the mass of spheres lie.
///
/// - `power`: of the radius that the mass grows with
fn passing(radius: &[f64], power: i32) -> String {
    let mut sorted = radius.to_vec();
    sorted.sort_by(f64::total_cmp);
    let all: f64 = sorted.iter().map(|r| r.powi(power)).sum();
    let below = |share: f64| {
        let mut mass = 0.0;
        let found = sorted.iter().find(|r| {
            mass += r.powi(power);
            mass >= share * all
        });
        quantity(2.0 * found.copied().unwrap_or_default(), "m")
    };
    format!("; 10, 50 and 90 % of the mass below {}, {} and {}", below(0.1), below(0.5), below(0.9))
}
