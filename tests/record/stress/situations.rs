//! Small scenes of every element, kinematics, law, criterion and damping, in motion over all their modes.

use fractum_math::Vec3;
use fractum_math::elementary::{cos, sin};
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_mesh::{Group, Mesh};

use super::scenes::header;

/// A scene in motion whose largest stable step is measured.
pub(super) struct Situation {
    /// What is special about it.
    pub(super) name: String,
    /// Text of the case; it names its mesh `mesh.msh` and its particles `beads.csv`.
    pub(super) case: String,
    /// Its mesh, where it has one.
    pub(super) mesh: Option<Mesh>,
    /// Its particles, where they are given: rows of x, y, z, radius.
    pub(super) beads: Option<String>,
    /// Speed of its parts [m/s], to tell a run that blows up.
    pub(super) speed: f64,
    /// Steps after which a run is stable.
    pub(super) steps: u64,
}

const TITLE: &str = "Stable step";
/// Steps of scenes without contact: a mode at 1.01 of the stable step has grown by e¹⁷⁰ then.
const STEPS: u64 = 600;
/// Steps of scenes with contact.
const STEPS_WITH_CONTACT: u64 = 2000;

/// Young's modulus, density and Poisson's ratio of all solids: waves of about 1 km/s.
const STUFF: &str = "[materials.stuff]\ndensity = \"1000 kg/m^3\"\nyoung_modulus = \"1 GPa\"\npoisson_ratio = 0.3\n";

/// All of them, in the order of the table.
///
/// - `seed`: of the velocities; 1 is the first
pub(super) fn situations(seed: u64) -> Vec<Situation> {
    let mut all = elastic();
    all.extend(shapes());
    all.extend(damping());
    all.extend(damage());
    all.extend(contact());
    all.extend(particles());
    for situation in all.iter_mut().filter(|_| seed > 1) {
        // Other phases at every node.
        situation.case = situation.case.replace("/1 m + ", &format!("/1 m + {} + ", seed - 1));
    }
    all
}

/// A block of 1 x 1 x 1 m, or a square of 1 x 1 m.
fn block(plane: bool, jitter: f64) -> Mesh {
    let jitter = (jitter > 0.0).then_some(Jitter { fraction: jitter, seed: 7 });
    if plane {
        structured_rectangle([8, 8], [1.0, 1.0], jitter)
    } else {
        structured_box([4, 4, 4], Vec3::new(1.0, 1.0, 1.0), jitter)
    }
}

/// Velocities that differ from node to node, and so excite all modes.
fn shaken(speed: f64, plane: bool) -> String {
    let axes: &[(&str, f64)] = if plane { &[("x", 0.1), ("y", 2.3)] } else { &[("x", 0.1), ("y", 2.3), ("z", 4.1)] };
    let across = if plane { "" } else { " + 6007*z" };
    let component =
        |(axis, phase): &(&str, f64)| format!("{axis} = \"{speed} m/s*sin((9871*x + 7919*y{across})/1 m + {phase})\"");
    let components: Vec<String> = axes.iter().map(component).collect();
    format!("initial_velocity = {{ {} }}\n", components.join(", "))
}

fn body(keys: &str) -> String {
    format!("\n[[bodies]]\nname = \"block\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stuff\"\n{keys}")
}

/// The table of the solver. Times are long against any step, so that the number of steps ends a run.
fn solver(keys: &str) -> String {
    format!("\n[solver]\nend = \"1000 s\"\n{keys}")
}

fn solid(name: &str, material: &str, keys: &str, rest: &str, mesh: Mesh, speed: f64) -> Situation {
    let shaken = shaken(speed, mesh.tetrahedra.is_empty());
    let case = header(TITLE, true) + STUFF + material + &body(&(shaken + keys)) + rest;
    let case = if rest.contains("[solver]") { case } else { case + &solver("") };
    Situation { name: name.to_owned(), case, mesh: Some(mesh), beads: None, speed, steps: STEPS }
}

/// Every element, formulation, kinematics, and both ways to find the step.
fn elastic() -> Vec<Situation> {
    let mut all = Vec::new();
    for (element, plane) in [("tetrahedra", false), ("triangles", true)] {
        for formulation in ["standard", "smoothed"] {
            for kinematics in ["small", "corotational"] {
                for bound in ["power-iteration", "element"] {
                    let name = format!("{element}, {formulation}, {kinematics}, {bound}");
                    let keys = format!("formulation = \"{formulation}\"\nkinematics = \"{kinematics}\"\n");
                    let solver = solver(&format!("time_step = \"{bound}\"\n"));
                    all.push(solid(&name, "", &keys, &solver, block(plane, 0.0), 1e-3));
                }
            }
        }
    }
    all
}

/// Bad elements, and materials that differ by a factor of a million.
fn shapes() -> Vec<Situation> {
    let keys = "formulation = \"smoothed\"\n";
    let needles = structured_box([3, 3, 3], Vec3::new(20.0, 1.0, 1.0), None);
    let flakes = structured_box([4, 4, 4], Vec3::new(1.0, 1.0, 0.02), None);
    let mut layered = block(false, 0.0);
    let upper = |element: &u32| {
        let nodes = layered.tetrahedra[*element as usize];
        nodes.iter().map(|&node| layered.nodes[node as usize].z).sum::<f64>() > 2.0
    };
    let (above, below): (Vec<u32>, Vec<u32>) = (0..layered.tetrahedra.len() as u32).partition(upper);
    layered.groups.retain(|group| group.name != "body");
    for (name, tag, tetrahedra) in [("body", 1, below), ("cover", 2, above)] {
        layered.groups.push(Group { name: name.to_owned(), dimension: 3, tag, tetrahedra, ..Group::default() });
    }
    let cover = format!(
        "\n[materials.soft]\ndensity = \"1000 kg/m^3\"\nyoung_modulus = \"1 kPa\"\npoisson_ratio = 0.3\n\
         \n[[bodies]]\nname = \"cover\"\nkind = \"solid\"\ngroup = \"cover\"\nmaterial = \"soft\"\n{}{keys}",
        shaken(1e-3, false)
    );
    vec![
        solid("irregular elements", "", keys, "", block(false, 0.15), 1e-3),
        solid("needles, 20 : 1", "", keys, "", needles, 1e-3),
        solid("flakes, 50 : 1", "", keys, "", flakes, 1e-3),
        solid("stiffness 1e6 : 1", "", keys, &cover, layered, 1e-3),
    ]
}

/// Every damping of solids, and boundaries with dashpots and springs.
fn damping() -> Vec<Situation> {
    let keys = "formulation = \"smoothed\"\n";
    let with = |name: &str, rest: &str, speed: f64| solid(name, "", keys, rest, block(false, 0.0), speed);
    vec![
        with("local damping 0.5", "\n[damping]\nlocal = 0.5\n", 1e-3),
        with("mass-proportional damping", "\n[damping]\nmass = \"2000 1/s\"\n", 1e-3),
        with("stiffness-proportional damping", "\n[damping]\nstiffness = \"0.1 ms\"\n", 1e-3),
        with("bulk viscosity, linear", "\n[damping]\nbulk_linear = 0.5\n", 1e-3),
        with("bulk viscosity, quadratic", "\n[damping]\nbulk_linear = 0.06\nbulk_quadratic = 1.2\n", 20.0),
        with("absorbing boundary", "\n[[supports]]\ngroup = \"x+\"\nabsorbing = true\n", 1e-3),
        with(
            "elastic support",
            "\n[[supports]]\ngroup = \"x+\"\nelastic = { normal = \"40 GPa/m\", tangential = \"40 GPa/m\" }\n",
            1e-3,
        ),
    ]
}

/// Every criterion, and every way to compute damage: bodies that are torn to pieces.
fn damage() -> Vec<Situation> {
    let table = |keys: &str| {
        format!("[materials.stuff.damage]\ntensile_strength = \"1 MPa\"\nfracture_energy = \"2 kJ/m^2\"\n{keys}")
    };
    let mut all = Vec::new();
    for criterion in ["rankine", "mohr-coulomb", "drucker-prager", "mazars", "modified-mohr-coulomb"] {
        let material = table(&format!("criterion = \"{criterion}\"\n"));
        all.push(solid(&format!("damage, {criterion}"), &material, "", "", block(false, 0.1), 5.0));
    }
    let flying = "kinematics = \"corotational\"\n";
    for (name, material, keys, plane) in [
        ("damage, standard elements", "", "formulation = \"standard\"\n", false),
        ("damage, unilateral", "unilateral = true\n", "", false),
        ("damage, phase field", "regularisation = \"phase-field\"\n", "", false),
        ("damage, linear softening", "softening = \"linear\"\n", "", false),
        ("damage, triangles", "", "", true),
        ("damage, corotational, pieces that fly", "", flying, false),
    ] {
        all.push(solid(name, &table(material), keys, "", block(plane, 0.1), 5.0));
    }
    for situation in &mut all {
        situation.steps = STEPS_WITH_CONTACT;
    }
    all
}

/// Solids that meet rigid bodies.
fn contact() -> Vec<Situation> {
    let wall = "\n[[bodies]]\nname = \"wall\"\nkind = \"rigid\"\nshape = \"plane\"\npoint = [\"0 m\", \"0 m\", \"0 m\"]\nnormal = \"x\"\n";
    let thrown = |name: &str, plane: bool, keys: &str, speed: f64| {
        let case = header(TITLE, true)
            + STUFF
            + &body(&format!("initial_velocity = {{ x = \"-{speed} m/s\" }}\n{keys}"))
            + wall
            + &solver("");
        Situation {
            name: name.to_owned(),
            case,
            mesh: Some(block(plane, 0.0)),
            beads: None,
            speed,
            steps: STEPS_WITH_CONTACT,
        }
    };
    vec![
        thrown("block on a rigid plane", false, "", 1.0),
        thrown(
            "block on a rigid plane, smoothed, corotational",
            false,
            "formulation = \"smoothed\"\nkinematics = \"corotational\"\n",
            1.0,
        ),
        thrown("square on a rigid line", true, "", 1.0),
    ]
}

/// Loose and bonded particles, their bonds and their damping.
fn particles() -> Vec<Situation> {
    let box_of = |radius: &str| {
        format!(
            "\n[[bodies]]\nname = \"walls\"\nkind = \"rigid\"\nshape = \"box\"\ninside = true\n\
             point = [\"0 m\", \"0 m\", \"0 m\"]\nsize = [\"1 m\", \"1 m\", \"1 m\"]\n\
             \n[[bodies]]\nname = \"beads\"\nkind = \"particles\"\nmaterial = \"stuff\"\n{radius}{}",
            shaken(1.0, false)
        )
    };
    let cloud = "shape = \"box\"\nsize = [\"1 m\", \"1 m\", \"1 m\"]\nparticle_radius = \"0.1 m\"\n";
    let loose = |name: &str, beads: Option<String>| {
        let bodies = box_of(if beads.is_some() { "file = \"beads.csv\"\n" } else { cloud });
        let case =
            header(TITLE, false) + STUFF + "contact = { friction = 0.5, restitution = 0.9 }\n" + &bodies + &solver("");
        Situation { name: name.to_owned(), case, mesh: None, beads, speed: 1.0, steps: STEPS_WITH_CONTACT }
    };
    let mut unequal = String::from("0.5,0.5,0.4,0.3\n");
    for number in 0..40 {
        let turn = 2.4 * f64::from(number);
        let (x, y) = (0.5 + 0.2 * cos(turn), 0.5 + 0.2 * sin(turn));
        unequal += &format!("{x},{y},{},0.003\n", 0.75 + 0.005 * f64::from(number));
    }
    let bonded = |name: &str, material: &str, keys: &str, rest: &str, speed: f64| {
        let case = header(TITLE, false)
            + STUFF
            + material
            + &format!(
                "\n[[bodies]]\nname = \"block\"\nkind = \"bonded\"\nmaterial = \"stuff\"\nshape = \"box\"\n\
                 size = [\"1 m\", \"1 m\", \"1 m\"]\nparticles = 200\ncoordination = 8\n{keys}{}",
                shaken(speed, false)
            )
            + rest;
        let case = if rest.contains("[solver]") { case } else { case + &solver("") };
        Situation { name: name.to_owned(), case, mesh: None, beads: None, speed, steps: STEPS }
    };
    let strong = "[materials.stuff.fracture]\ntensile_strength = \"1 MPa\"\n";
    let interface = "[materials.stuff.interface]\ntensile_strength = \"1 MPa\"\nshear_strength = \"2 MPa\"\n";
    vec![
        loose("beads by Hertz' law", None),
        loose("beads, radii 100 : 1", Some(unequal)),
        bonded("cohesive beams", "", "", "", 1e-3),
        bonded("cohesive beams, element", "", "", &solver("time_step = \"element\"\n"), 1e-3),
        bonded("cohesive beams, Tchamwa-Wielgosz 1.2", "", "", "\n[damping]\ntchamwa_wielgosz = 1.2\n", 1e-3),
        bonded("cohesive beams that break", strong, "", "", 5.0),
        bonded("local interfaces", "", "bond = \"local\"\n", "", 1e-3),
        bonded("local interfaces that break", interface, "bond = \"local\"\n", "", 5.0),
    ]
}
