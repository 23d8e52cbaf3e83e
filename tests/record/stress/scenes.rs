//! Random scenes as case files: materials, loads and bodies over decades, on small structured meshes.

use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};

use super::draw::Draw;

/// What the table of results has a line for.
pub(crate) const KINDS: [&str; 14] = [
    "elastic solid",
    "damaged solid",
    "phase field",
    "unilateral",
    "solid at rest",
    "impact",
    "plane impact",
    "rigid body",
    "particles",
    "beads on solid",
    "bonded",
    "breaking bonded",
    "bonded at rest",
    "tied",
];

/// Kinds in the order in which they come: solids outnumber bodies that must be packed, which come last.
const CYCLE: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 5, 10, 11, 12, 13];

/// A case file and its mesh.
pub(crate) struct RandomScene {
    /// One of [`KINDS`].
    pub(crate) kind: &'static str,
    /// Text of the case; it names its mesh `mesh.msh`.
    pub(crate) case: String,
    /// Its mesh, where it has one.
    pub(crate) mesh: Option<Mesh>,
}

/// The scene of a seed and a number.
pub(crate) fn scene(seed: u64, number: usize) -> RandomScene {
    let mut draw = Draw::new(seed, number as u64);
    let kind = KINDS[CYCLE[number % CYCLE.len()]];
    match kind {
        "particles" => loose(&mut draw),
        "beads on solid" => beads_on_solid(&mut draw),
        "bonded" | "breaking bonded" | "bonded at rest" => bonded(&mut draw, kind),
        "tied" => tied(&mut draw),
        _ => solid(&mut draw, kind),
    }
}

/// A number as a case file reads it back.
pub(super) fn number(value: f64) -> String {
    format!("{value:e}")
}

pub(super) struct Elastic {
    pub(super) density: f64,
    pub(super) young_modulus: f64,
    pub(super) poisson_ratio: f64,
}

impl Elastic {
    fn draw(draw: &mut Draw) -> Self {
        Elastic {
            density: draw.decades(100.0, 1e4),
            young_modulus: draw.decades(1e6, 1e12),
            poisson_ratio: draw.between(0.0, 0.4),
        }
    }

    /// Speed of a wave in a bar [m/s].
    fn wave_speed(&self) -> f64 {
        (self.young_modulus / self.density).sqrt()
    }

    pub(super) fn text(&self) -> String {
        format!(
            "[materials.stuff]\ndensity = \"{} kg/m^3\"\nyoung_modulus = \"{} Pa\"\npoisson_ratio = {}\n",
            number(self.density),
            number(self.young_modulus),
            number(self.poisson_ratio)
        )
    }
}

/// Begin of a random scene.
pub(super) fn random_header(kind: &str, mesh: bool) -> String {
    header(&format!("Random scene: {kind}"), mesh)
}

/// Begin of a case, with a mesh or without.
pub(super) fn header(title: &str, mesh: bool) -> String {
    let mesh = if mesh { "[mesh]\nfile = \"mesh.msh\"\n\n" } else { "" };
    format!("fractum = 1\ntitle = \"{title}\"\n\n{mesh}")
}

pub(super) fn footer(kind: &str, end: f64, safety: f64) -> String {
    let end = number(end);
    format!(
        "\n[solver]\nkind = \"{kind}\"\nend = \"{end} s\"\n{}\n[output]\nfields = {{ every = \"{end} s\" }}\n\
         history = {{ every = \"{end} s/100\" }}\n",
        if kind == "static" { String::new() } else { format!("safety = {}\n", number(safety)) }
    )
}

/// A block of tetrahedra or triangles, held, pulled, hit, thrown or struck, with damage as the kind says.
fn solid(draw: &mut Draw, kind: &'static str) -> RandomScene {
    let material = Elastic::draw(draw);
    let size = draw.decades(1e-3, 10.0);
    let impact = kind == "impact" || kind == "plane impact";
    let plane = kind == "plane impact" || !impact && kind != "rigid body" && draw.chance(0.4);
    let jitter = draw.chance(0.6).then(|| Jitter { fraction: draw.between(0.02, 0.15), seed: draw.whole(1000) });
    let cells = 3 + draw.whole(if kind == "solid at rest" { 2 } else { 4 }) as u32;
    let mesh = if plane {
        structured_rectangle([2 * cells, cells], [2.0 * size, size], jitter)
    } else {
        structured_box([2 * cells, cells, cells], Vec3::new(2.0, 1.0, 1.0) * size, jitter)
    };
    let damaged = kind != "elastic solid" && (kind != "rigid body" || draw.chance(0.5));
    let strain = draw.decades(1e-6, 1e-3);
    let mut case = random_header(kind, true) + &material.text();
    if impact || kind == "rigid body" {
        let contact = [("friction", 0.0, 0.8), ("damping_ratio", 0.0, 0.5)]
            .map(|(key, low, high)| format!("{key} = {}", number(draw.between(low, high))));
        case += &format!("contact = {{ {} }}\n", contact.join(", "));
    }
    if damaged {
        case += &damage(draw, kind, &material, strain, size / f64::from(cells));
    }
    let regularised = kind == "phase field";
    let formulation = if regularised || damaged || draw.chance(0.5) { "smoothed" } else { "standard" };
    let formulation =
        if damaged && !regularised && kind != "unilateral" && draw.chance(0.3) { "standard" } else { formulation };
    let kinematics = if kind != "solid at rest" && draw.chance(0.4) { "corotational" } else { "small" };
    case += &format!(
        "\n[[bodies]]\nname = \"block\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stuff\"\n\
         formulation = \"{formulation}\"\nkinematics = \"{kinematics}\"\n"
    );
    // Amplitudes from far below to far above the strength.
    let amplitude = strain * draw.decades(0.1, 10.0);
    let speed = amplitude * material.wave_speed();
    let transit = 2.0 * size / material.wave_speed();
    if impact {
        case += &format!("initial_velocity = {{ x = \"{} m/s\" }}\n", number(-speed));
        case += "\n[[bodies]]\nname = \"wall\"\nkind = \"rigid\"\nshape = \"plane\"\npoint = [\"0 m\", \"0 m\", \"0 m\"]\n\
                 normal = \"x\"\ncontact = { friction = 0.3, damping_ratio = 0.1 }\n";
        return RandomScene { kind, case: case + &footer("explicit", 4.0 * transit, 0.8), mesh: Some(mesh) };
    }
    if kind == "rigid body" {
        let mass = material.density * size.powi(3) * draw.decades(0.1, 10.0);
        case += &format!(
            "\n[[bodies]]\nname = \"ball\"\nkind = \"rigid\"\nshape = \"sphere\"\nradius = \"{r} m\"\nfree = \"xyz\"\n\
             point = [\"{} m\", \"{} m\", \"{} m\"]\nmass = \"{} kg\"\ninitial_velocity = {{ z = \"{} m/s\" }}\n\
             contact = {{ friction = 0.3, damping_ratio = 0.1 }}\n",
            number(size),
            number(0.5 * size),
            number(1.401 * size),
            number(mass),
            number(-speed),
            r = number(0.4 * size),
        );
        case += "\n[[supports]]\ngroup = \"z-\"\nfix = \"xyz\"\n";
        return RandomScene { kind, case: case + &footer("explicit", 6.0 * transit, 0.8), mesh: Some(mesh) };
    }
    let fix = if plane { "xy" } else { "xyz" };
    case += &format!("\n[[supports]]\ngroup = \"x-\"\nfix = \"{fix}\"\n");
    if kind == "solid at rest" {
        let pull = number(2.0 * size * amplitude.min(5.0 * strain));
        case += &format!("\n[[supports]]\ngroup = \"x+\"\ndisplacement = {{ x = \"{pull} m*t/1 s\" }}\n");
        return RandomScene { kind, case: case + &footer("static", 1.0, 0.8), mesh: Some(mesh) };
    }
    let (speed, pressure, transit_text) = (number(speed), number(material.young_modulus * amplitude), number(transit));
    case += &match draw.whole(4) {
        0 => format!("\n[[supports]]\ngroup = \"x+\"\nvelocity = {{ x = \"{speed} m/s\" }}\n"),
        1 => format!(
            "\n[[supports]]\ngroup = \"x+\"\nvelocity = {{ x = {{ ramp = [[\"0 s\", \"0 m/s\"], [\"{transit_text} s\", \"{speed} m/s\"]] }} }}\n"
        ),
        2 => format!("\n[[loads]]\ngroup = \"x+\"\npressure = \"if(t < {transit_text} s, {pressure} Pa, 0)\"\n"),
        _ => format!("\n[[loads]]\ngroup = \"x+\"\ntraction = {{ y = \"{pressure} Pa\" }}\n"),
    };
    if draw.chance(0.3) {
        case += &format!("\n[damping]\nlocal = {}\n", number(draw.between(0.0, 0.5)));
    }
    RandomScene { kind, case: case + &footer("explicit", 6.0 * transit, 0.8), mesh: Some(mesh) }
}

/// `[materials.stuff.damage]`: strong enough for its elements, tough over decades.
fn damage(draw: &mut Draw, kind: &str, material: &Elastic, strain: f64, edge: f64) -> String {
    let strength = material.young_modulus * strain;
    // The length of a phase field is bounded, two elements by default.
    let least = if kind == "phase field" { 9.0 } else { 3.0 };
    let toughness = strength * strain * edge * draw.decades(least, 100.0);
    let softening = draw.one_of(&["exponential", "linear"]);
    let mut text = format!(
        "[materials.stuff.damage]\ncriterion = \"rankine\"\ntensile_strength = \"{} Pa\"\nfracture_energy = \"{} J/m^2\"\n\
         softening = \"{softening}\"\n",
        number(strength),
        number(toughness)
    );
    if kind == "phase field" {
        text += "regularisation = \"phase-field\"\n";
    }
    if kind == "unilateral" {
        text += "unilateral = true\n";
    }
    text
}

/// A cloud that falls into a box.
fn loose(draw: &mut Draw) -> RandomScene {
    let material = Elastic { young_modulus: draw.decades(1e5, 1e8), ..Elastic::draw(draw) };
    let radius = draw.decades(1e-4, 1e-2);
    let [side, friction, restitution] = [draw.between(8.0, 14.0), draw.between(0.0, 0.8), draw.between(0.2, 1.0)];
    let contact = format!("contact = {{ friction = {}, restitution = {} }}\n", number(friction), number(restitution));
    let length = |factor: f64| format!("\"{} m\"", number(factor * radius));
    let case = random_header("particles", false)
        + &material.text()
        + &contact
        + &format!(
            "\n[[bodies]]\nname = \"beads\"\nkind = \"particles\"\nmaterial = \"stuff\"\nshape = \"box\"\n\
             point = [{zero}, {zero}, {up}]\nsize = [{side}, {side}, {side}]\nparticle_radius = {r}\ndispersion = 0.2\n\
             initial_velocity = {{ z = \"{speed} m/s\" }}\n\
             \n[[bodies]]\nname = \"walls\"\nkind = \"rigid\"\nshape = \"box\"\ninside = true\npoint = [{zero}, {zero}, {zero}]\n\
             size = [{side}, {side}, {height}]\n{contact}\n[[loads]]\ngravity = {{ z = \"-9.81 m/s^2\" }}\n",
            zero = length(0.0),
            up = length(1.0),
            side = length(side),
            height = length(8.0 * side),
            r = length(1.0),
            speed = number(-draw.decades(0.01, 1.0) * (9.81 * radius * side).sqrt()),
        );
    let end = 2.0 * (2.0 * side * radius / 9.81).sqrt();
    RandomScene { kind: "particles", case: case + &footer("explicit", end, 0.8), mesh: None }
}

/// A cloud that falls onto an elastic block in a container.
fn beads_on_solid(draw: &mut Draw) -> RandomScene {
    let material = Elastic { young_modulus: draw.decades(1e6, 1e9), ..Elastic::draw(draw) };
    let radius = draw.decades(1e-4, 1e-2);
    let [side, friction, restitution] = [draw.between(6.0, 9.0), draw.between(0.0, 0.8), draw.between(0.3, 1.0)];
    let mesh = structured_box([4, 4, 3], Vec3::new(side, side, 0.5 * side) * radius, None);
    let contact = format!("contact = {{ friction = {}, restitution = {} }}\n", number(friction), number(restitution));
    let length = |factor: f64| format!("\"{} m\"", number(factor * radius));
    let case = random_header("beads on solid", true)
        + &material.text()
        + &contact
        + &format!(
            "\n[[bodies]]\nname = \"block\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stuff\"\n\
             formulation = \"{formulation}\"\n\n[[supports]]\ngroup = \"z-\"\nfix = \"xyz\"\n\
             \n[[bodies]]\nname = \"beads\"\nkind = \"particles\"\nmaterial = \"stuff\"\nshape = \"box\"\n\
             point = [{edge}, {edge}, {up}]\nsize = [{inner}, {inner}, {inner}]\nparticle_radius = {r}\n\
             initial_velocity = {{ z = \"{speed} m/s\" }}\n\n[[loads]]\ngravity = {{ z = \"-9.81 m/s^2\" }}\n",
            formulation = draw.one_of(&["smoothed", "standard"]),
            edge = length(0.1 * side),
            up = length(0.55 * side),
            inner = length(0.8 * side),
            r = length(1.0),
            speed = number(-draw.decades(0.01, 1.0) * (9.81 * radius * side).sqrt()),
        );
    let end = (side * radius / 9.81).sqrt();
    RandomScene { kind: "beads on solid", case: case + &footer("explicit", end, 0.8), mesh: Some(mesh) }
}

/// A packed box that is tied to the end of a block, and pulled away from it or pushed onto it.
fn tied(draw: &mut Draw) -> RandomScene {
    let material = Elastic { poisson_ratio: 0.2, ..Elastic::draw(draw) };
    let side = 1e-3;
    let mesh = structured_box([6, 3, 3], Vec3::new(2.0, 1.0, 1.0) * side, None);
    let speed = draw.decades(1e-6, 1e-3) * draw.between(-1.0, 1.0) * material.wave_speed();
    let kinematics = draw.one_of(&["small", "corotational"]);
    let length = |factor: f64| format!("\"{} m\"", number(factor * side));
    let case = random_header("tied", true)
        + &material.text()
        + &format!(
            "\n[[bodies]]\nname = \"block\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stuff\"\n\
             kinematics = \"{kinematics}\"\n\n[[bodies]]\nname = \"core\"\nkind = \"bonded\"\nmaterial = \"stuff\"\n\
             shape = \"box\"\npoint = [{end}, {zero}, {zero}]\nsize = [{s}, {s}, {s}]\nparticles = {PARTICLES}\n\
             coordination = 8\nseed = 1\n\n[[ties]]\nsolid = \"block\"\nbonded = \"core\"\nwithin = {within}\n\
             \n[[supports]]\ngroup = \"x-\"\nfix = \"xyz\"\n\
             \n[[supports]]\ngroup = \"core.x+\"\nvelocity = {{ x = \"{speed} m/s\" }}\n",
            end = length(2.0),
            zero = length(0.0),
            s = length(1.0),
            within = length(0.02),
            speed = number(speed),
        );
    let end = 4.0 * side / material.wave_speed();
    RandomScene { kind: "tied", case: case + &footer("explicit", end, 0.5), mesh: Some(mesh) }
}

/// Particles of a packed box.
const PARTICLES: usize = 200;

/// A packed box, pulled in motion or at rest; few different packings, so that they are made once.
fn bonded(draw: &mut Draw, kind: &'static str) -> RandomScene {
    let material = Elastic { poisson_ratio: 0.2, ..Elastic::draw(draw) };
    let side = 1e-3;
    let at_rest = kind == "bonded at rest";
    let breaking = kind == "breaking bonded" || at_rest && draw.chance(0.5);
    let strain = draw.decades(1e-5, 1e-3);
    let mut case = random_header(kind, false) + &material.text();
    if breaking {
        let strength = number(material.young_modulus * strain);
        case += &format!("[materials.stuff.fracture]\ntensile_strength = \"{strength} Pa\"\n");
    }
    let speed = strain * draw.decades(0.1, 2.0) * material.wave_speed();
    let size = format!("\"{} m\"", number(side));
    case += &format!(
        "\n[[bodies]]\nname = \"block\"\nkind = \"bonded\"\nmaterial = \"stuff\"\nshape = \"box\"\nsize = [{size}, {size}, {size}]\n\
         particles = {PARTICLES}\ncoordination = 8\nseed = {}\n\n[[supports]]\ngroup = \"block.x-\"\nfix = \"xyz\"\n\
         \n[[supports]]\ngroup = \"block.x+\"\n",
        1 + draw.whole(2),
    );
    if at_rest {
        let pull = number(side * strain * draw.between(0.2, 3.0));
        case += &format!("displacement = {{ x = \"{pull} m*t/1 s\" }}\n");
        return RandomScene { kind, case: case + &footer("static", 1.0, 0.5), mesh: None };
    }
    case += &format!("velocity = {{ x = \"{} m/s\" }}\n", number(speed));
    let end = if breaking { 2.0 } else { 4.0 } * side / material.wave_speed();
    RandomScene { kind, case: case + &footer("explicit", end, 0.5), mesh: None }
}
