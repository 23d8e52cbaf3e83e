//! Pairs of materials with coefficients of contact of their own.

use std::f64::consts::FRAC_1_SQRT_2;
use std::fs;

use serde_json::Value;

use crate::common::{Workplace, resumed, run};

/// Two beads of different materials on a floor of a third one, or on their way to something.
const BEADS: &str = r#"fractum = 1
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "MODULUS"
poisson_ratio = 0.3
contact = { friction = 0.15, rolling_friction = 2, damping_ratio = 0.3 }
[materials.wood]
density = "2500 kg/m^3"
young_modulus = "MODULUS"
poisson_ratio = 0.3
contact = { friction = 0.9, rolling_friction = 2, damping_ratio = 0.05 }
[materials.steel]
density = "7800 kg/m^3"
young_modulus = "MODULUS"
poisson_ratio = 0.3
contact = { friction = 0.15, rolling_friction = 2, damping_ratio = 0.3 }
PAIRS
[[bodies]]
name = "a"
kind = "particles"
material = "glass"
file = "a.csv"
unit = "mm"
initial_velocity = VELOCITY
[[bodies]]
name = "b"
kind = "particles"
material = "wood"
file = "b.csv"
unit = "mm"
[[bodies]]
name = "floor"
FLOOR
[[loads]]
gravity = { x = "9.81 m/s^2*TANGENT/sqrt(1 + TANGENT^2)", z = "-9.81 m/s^2/sqrt(1 + TANGENT^2)*HELD" }
[solver]
end = "END"
safety = SAFETY
initial_overlap = "keep"
[output]
checkpoint = { steps = 4000 }
[[probes]]
name = "speed_a"
velocity = { group = "a", along = "x" }
[[probes]]
name = "speed_b"
velocity = { group = "b", along = "x" }
[[probes]]
name = "up_a"
velocity = { group = "a", along = "z" }
[[probes]]
name = "up_b"
velocity = { group = "b", along = "z" }
[[probes]]
name = "a"
expression = "slope(speed_a, END/2)"
[[probes]]
name = "b"
expression = "slope(speed_b, END/2)"
"#;

const PLANE: &str = "kind = \"rigid\"\nmaterial = \"steel\"\nshape = \"plane\"\nnormal = \"z\"";
const PAIRS: &str = r#"
[[contact_pairs]]
between = ["glass", "steel"]
friction = 0.3
[[contact_pairs]]
between = ["steel", "wood"]
friction = 0.5
rolling_friction = 1
"#;

/// What differs between the cases.
#[derive(Clone)]
struct Beads<'a> {
    pairs: &'a str,
    floor: &'a str,
    modulus: &'a str,
    velocity: &'a str,
    tangent: f64,
    weight: f64,
    end: &'a str,
    safety: f64,
    /// Centres [mm].
    at: [[f64; 3]; 2],
}

impl Beads<'_> {
    const SLIDING: Beads<'static> = Beads {
        pairs: PAIRS,
        floor: PLANE,
        modulus: "5 MPa",
        velocity: "{ y = \"0 m/s\" }",
        tangent: 0.0,
        weight: 1.0,
        end: "40 ms",
        safety: 0.8,
        at: [[0.0, 0.0, 1.0], [0.0, 10.0, 1.0]],
    };

    fn place(&self) -> Workplace {
        let numbers = [("TANGENT", self.tangent), ("HELD", self.weight), ("SAFETY", self.safety)];
        let texts = [
            ("PAIRS", self.pairs),
            ("FLOOR", self.floor),
            ("MODULUS", self.modulus),
            ("VELOCITY", self.velocity),
            ("END", self.end),
        ];
        let case = numbers.iter().fold(BEADS.to_owned(), |case, (name, value)| case.replace(name, &value.to_string()));
        let place = Workplace::new(&texts.iter().fold(case, |case, (name, text)| case.replace(name, text)));
        for (name, [x, y, z]) in ["a.csv", "b.csv"].into_iter().zip(self.at) {
            fs::write(place.path(name), format!("{x},{y},{z},1\n")).unwrap();
        }
        place
    }

    fn run(&self) -> Value {
        run(&self.place(), "one", "1")
    }
}

fn last(summary: &Value, probe: &str) -> f64 {
    summary["probes"][probe]["final"].as_f64().unwrap()
}

/// Whether a bead stays on an incline, or slides down it with the acceleration that friction leaves.
fn slides_as(found: f64, tangent: f64, friction: f64, told: &str) {
    let right = 9.81 * (tangent - friction) / (1.0 + tangent * tangent).sqrt();
    let error = (found - right.max(0.0)).abs();
    assert!(error < 1e-5 * 9.81, "{told}: tan {tangent}: {found} m/s2 for {right}");
}

#[test]
fn beads_slide_on_an_incline_each_at_the_angle_of_its_pair() {
    for tangent in [0.298, 0.302, 0.497, 0.503] {
        for safety in [0.8, 0.4] {
            // Until the vibrations of what holds have died.
            let both = Beads { tangent, safety, end: "80 ms", ..Beads::SLIDING }.run();
            slides_as(last(&both, "a"), tangent, 0.3, "glass");
            slides_as(last(&both, "b"), tangent, 0.5, "wood");
        }
    }
    // Without pairs the smaller coefficient counts, 0.15 for both.
    let both = Beads { tangent: 0.2, pairs: "", ..Beads::SLIDING }.run();
    slides_as(last(&both, "a"), 0.2, 0.15, "glass alone");
    slides_as(last(&both, "b"), 0.2, 0.15, "wood alone");
}

#[test]
fn facets_boxes_and_cylinders_rub_as_a_plane_of_their_material() {
    let corner = |x: i32, y: i32| format!("vertex {x} {y} 0\n");
    let facet = |corners: [(i32, i32); 3]| {
        let ring = corners.map(|(x, y)| corner(x, y)).concat();
        format!("facet normal 0 0 1\nouter loop\n{ring}endloop\nendfacet\n")
    };
    let halves = [[(-1, -1), (1, -1), (1, 1)], [(-1, -1), (1, 1), (-1, 1)]].map(facet).concat();
    let steel = "kind = \"rigid\"\nmaterial = \"steel\"\n";
    for shape in [
        "shape = \"box\"\npoint = [-1, -1, -1]\nsize = [2, 2, 1]",
        "shape = \"cylinder\"\npoint = [-1, 0.005, -0.1]\naxis = \"x\"\nlength = 2\nradius = 0.1",
        "shape = \"stl\"\nfile = \"floor.stl\"",
    ] {
        // On the cylinder both lie beside its crest, and roll over its side a little.
        let (floor, aside) = (format!("{steel}{shape}"), if shape.contains("cylinder") { 0.3 } else { 0.0 });
        let at = [[0.0, 5.0 - aside, 1.0], [20.0, 5.0 + aside, 1.0]];
        let at = if aside > 0.0 { at.map(|[x, y, z]| [x, y, z - 1e-2 * aside]) } else { at };
        for tangent in [0.31, 0.51] {
            let place = Beads { floor: &floor, tangent, at, ..Beads::SLIDING }.place();
            fs::write(place.path("floor.stl"), format!("solid floor\n{halves}endsolid floor\n")).unwrap();
            let both = run(&place, "one", "1");
            let error = |bead: &str, friction: f64| {
                let right = 9.81 * (tangent - friction) / (1.0 + tangent * tangent).sqrt();
                (last(&both, bead) - right.max(0.0)).abs() / 9.81
            };
            let most = if aside > 0.0 { 2e-3 } else { 1e-5 };
            assert!(error("a", 0.3) < most && error("b", 0.5) < most, "{shape} {tangent}: {}", both["probes"]);
        }
    }
}

#[test]
fn beads_and_solids_rub_by_the_coefficients_of_their_pair() {
    // Beads on a block of tetrahedra that is held, and such a block on a rigid plane.
    let solid = r#"kind = "solid"
group = "body"
material = "steel"
[mesh]
file = "bar.msh"
[[supports]]
where = "x > -1 m"
fix = "xyz"
"#;
    for tangent in [0.29, 0.32] {
        let at = [[200.0, 55.0, 121.0], [200.0, 65.0, 121.0]];
        let both = Beads { floor: solid, tangent, at, end: "20 ms", ..Beads::SLIDING }.run();
        let right = 9.81 * (tangent - 0.3f64).max(0.0) / (1.0 + tangent * tangent).sqrt();
        assert!((last(&both, "a") - right).abs() < 1e-3 * 9.81, "{tangent}: {}", both["probes"]);
        assert!(last(&both, "b").abs() < 1e-3 * 9.81, "{tangent}: {}", both["probes"]);
    }
    let block = r#"fractum = 1
mesh = { file = "bar.msh" }
damping = { stiffness = "1 ms" }
loads = [{ gravity = { x = "9.81 m/s^2*TANGENT/sqrt(1 + TANGENT^2)", z = "-9.81 m/s^2/sqrt(1 + TANGENT^2)" } }]
solver = { end = "60 ms" }
probes = [
  { name = "speed", velocity = { group = "body", along = "x" } },
  { name = "acceleration", expression = "slope(speed, 20 ms)" },
]
contact_pairs = [{ between = ["steel", "rubber"], friction = 0.6 }]
[materials.rubber]
density = "1000 kg/m^3"
young_modulus = "10 MPa"
poisson_ratio = 0.3
contact = { friction = 0.2 }
[materials.steel]
density = "7800 kg/m^3"
young_modulus = "200 GPa"
poisson_ratio = 0.3
[[bodies]]
name = "block"
kind = "solid"
group = "body"
material = "rubber"
[[bodies]]
name = "floor"
kind = "rigid"
material = "steel"
shape = "plane"
normal = "z"
"#;
    for tangent in [0.58, 0.65] {
        let place = Workplace::new(&block.replace("TANGENT", &tangent.to_string()));
        let slid = last(&run(&place, "one", "1"), "acceleration");
        let right = 9.81 * (tangent - 0.6f64).max(0.0) / (1.0 + tangent * tangent).sqrt();
        assert!((slid - right).abs() < 1e-3, "{tangent}: {slid} m/s2 for {right}");
    }
}

#[test]
fn a_bead_rebounds_from_a_floor_by_the_restitution_of_the_pair() {
    for restitution in [0.9, 0.5, 0.2] {
        let pairs = format!("[[contact_pairs]]\nbetween = [\"steel\", \"glass\"]\nrestitution = {restitution}");
        let thrown = Beads {
            pairs: &pairs,
            velocity: "{ z = \"-0.1 m/s\" }",
            weight: 0.0,
            end: "6 ms",
            at: [[0.0, 0.0, 1.01], [0.0, 10.0, 3.0]],
            ..Beads::SLIDING
        };
        // The error falls with the step.
        for safety in [0.4, 0.2] {
            let found = last(&Beads { safety, ..thrown.clone() }.run(), "up_a") / 0.1;
            assert!((found - restitution).abs() < 5e-3 * safety, "{restitution}, safety {safety}: {found}");
        }
    }
}

#[test]
fn beads_of_two_materials_collide_by_the_coefficients_of_their_pair() {
    // One flies at one at rest, whose centre lies below its way at 45 degrees: the impulse along the line of centres has the restitution of the
    // pair, that across it its friction. The coefficients with the floor play no part.
    let (speed, friction, restitution) = (0.02, 0.1, 0.8);
    let between = r#"[[contact_pairs]]
between = ["wood", "glass"]
friction = 0.1
restitution = 0.8
rolling_friction = 0
"#;
    let reach = 2.0 * FRAC_1_SQRT_2;
    let beads = Beads {
        pairs: &format!("{PAIRS}{between}"),
        modulus: "5 GPa",
        velocity: &format!("{{ x = \"{speed} m/s\" }}"),
        weight: 0.0,
        end: "1 ms",
        at: [[0.0, 0.0, 5.0 + reach], [reach + 1e-3, 0.0, 5.0]],
        ..Beads::SLIDING
    };
    let hit = beads.run();
    // Equal masses: the reduced mass is half of one.
    let normal = 0.5 * (1.0 + restitution) * speed * FRAC_1_SQRT_2;
    let across = friction * normal;
    let right = [FRAC_1_SQRT_2 * (normal + across), FRAC_1_SQRT_2 * (across - normal)];
    for (probe, right) in ["speed_b", "up_b"].into_iter().zip(right) {
        let found = last(&hit, probe);
        assert!((found - right).abs() < 1e-3 * speed, "{probe}: {found} m/s for {right}");
    }
}

#[test]
fn the_order_of_names_and_pairs_and_those_that_say_nothing_new_change_no_bit() {
    let one = Beads { tangent: 0.4, ..Beads::SLIDING };
    let place = one.place();
    let first = run(&place, "one", "1");
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&first["state_hash"], &first["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["probes"]), (&first["state_hash"], &first["probes"]));
    let turned = r#"
[[contact_pairs]]
between = ["wood", "steel"]
rolling_friction = 1
friction = 0.5
[[contact_pairs]]
between = ["wood", "wood"]
friction = 0.9
[[contact_pairs]]
between = ["steel", "glass"]
friction = 0.3
"#;
    let turned = Beads { pairs: turned, ..one.clone() }.run();
    assert_eq!(turned["state_hash"], first["state_hash"]);
    // What follows from the materials anyway.
    let same = "[[contact_pairs]]\nbetween = [\"glass\", \"steel\"]\nfriction = 0.15\ndamping_ratio = 0.3";
    let [alone, same] = ["", same].map(|pairs| Beads { pairs, ..one.clone() }.run());
    assert_eq!(alone["state_hash"], same["state_hash"]);
    assert_ne!(alone["state_hash"], first["state_hash"]);
}

#[test]
fn what_a_rigid_body_says_itself_counts_before_the_pair_of_its_material() {
    let floor = format!("{PLANE}\ncontact = {{ friction = 0.1 }}");
    let beads = Beads { floor: &floor, tangent: 0.2, ..Beads::SLIDING };
    let both = beads.run();
    slides_as(last(&both, "a"), 0.2, 0.1, "glass");
    slides_as(last(&both, "b"), 0.2, 0.1, "wood");
    let told = beads.place().fractum(&["check", "case.toml"]);
    assert!(told.stdout.contains("glass and steel: friction 0.3; as the materials have it: "), "{}", told.stdout);
    assert!(told.stdout.contains("but floor has its own friction"), "{}", told.stdout);
    assert!(told.stdout.contains("its friction has no effect: the rigid bodies say their own"), "{}", told.stdout);
    // The rolling friction of the pair acts all the same.
    assert!(!told.stdout.contains("its rolling_friction has no effect"), "{}", told.stdout);
}

#[test]
fn beads_stick_by_the_work_of_adhesion_of_a_pair() {
    // A bead of 1 mm hangs from a plane by 2 pi W R, W of 10 mJ/m2, whose materials do not stick; the other one falls.
    let pairs = "[[contact_pairs]]\nbetween = [\"glass\", \"steel\"]\nwork_of_adhesion = \"WORK J/m^2\"";
    let roof = PLANE.replace("normal = \"z\"", "normal = \"-z\"");
    let weight = 2500.0 * 4.0 / 3.0 * 1e-6 * 9.81 / 2.0;
    for (share, hangs) in [(1.02, true), (0.98, false)] {
        let pairs = pairs.replace("WORK", &(share * weight).to_string());
        let at = [[0.0, 0.0, -1.0], [0.0, 10.0, -1.0]];
        let both = Beads { pairs: &pairs, floor: &roof, at, end: "50 ms", ..Beads::SLIDING }.run();
        assert_eq!(last(&both, "up_a").abs() < 1e-3, hangs, "{}", both["probes"]);
        assert!((last(&both, "up_b") / (-9.81 * 0.05) - 1.0).abs() < 1e-2, "{}", both["probes"]);
    }
}

#[test]
fn pairs_in_vain_are_told() {
    let vain = r#"
[[contact_pairs]]
between = ["steel", "steel"]
friction = 0.2
[[contact_pairs]]
between = ["glass", "granite"]
friction = 0.2
[materials.granite]
density = "2700 kg/m^3"
young_modulus = "60 GPa"
poisson_ratio = 0.3
"#;
    let told = Beads { pairs: vain, ..Beads::SLIDING }.place().fractum(&["check", "case.toml"]);
    assert_eq!(told.code, Some(0), "{}", told.stderr);
    let steel = "contact_pairs[0]: steel and steel never touch: rigid bodies do not touch each other";
    assert!(told.stdout.contains(steel), "{}", told.stdout);
    let granite = "contact_pairs[1]: glass and granite never touch: no body is made of granite";
    assert!(told.stdout.contains(granite), "{}", told.stdout);
}
