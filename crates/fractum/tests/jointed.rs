//! Jointed rock under in-situ stress.

use fractum_math::Vec3;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::{Mesh, MshFormat};
use serde_json::Value;

use crate::common::{Workplace, mesh_bytes, resumed, run, summary};

/// A square of 2 m under -1 and -3 MPa and a shear stress, without supports, with two joints that cross.
const SQUARE: &str = r#"fractum = 1

[parameters]
angle = "40 deg"

[mesh]
file = "bar.msh"
[[mesh.joints]]
name = "joints"
table = [["0.4 m", "0.5 m", "1.6 m", "1.2 m"], ["1.1 m", "0.3 m", "0.8 m", "1.7 m"]]

[materials.rock]
density = "2600 kg/m^3"
young_modulus = "40 GPa"
poisson_ratio = 0.25

[[bodies]]
name = "rock"
kind = "solid"
group = "body"
material = "rock"

[[interfaces]]
name = "joints"
group = "joints"
bonded = false
residual_friction_angle = "angle"

[in_situ]
stress = { xx = "-1 MPa", yy = "-3 MPa", xy = "0.2 MPa" }
groups = ["x-", "x+", "y-", "y+"]

[solver]
end = "2 ms"

[[probes]]
name = "xx"
stress = { where = "x < 100 m", component = "xx" }

[output]
fields = { every = "1 ms" }
checkpoint = { steps = 150 }
"#;

/// What keeps a body in the plane, and one in space, from moving as a whole, and does not strain it.
const PINS: [&str; 2] = [
    "[[supports]]\nwhere = \"hypot(x, y) < 1 mm\"\nfix = \"xy\"\n[[supports]]\nwhere = \"hypot(x - 2 m, y) < 1 mm\"\nfix = \"y\"\n",
    "[[supports]]\nwhere = \"abs(x) + abs(y) + abs(z) < 1 mm\"\nfix = \"xyz\"\n[[supports]]\nwhere = \"abs(x - 2 m) + abs(y) + abs(z) < 1 mm\"\nfix = \"yz\"\n\
     [[supports]]\nwhere = \"abs(x) + abs(y - 2 m) + abs(z) < 1 mm\"\nfix = \"z\"\n",
];

fn square() -> Mesh {
    structured_rectangle([20, 20], [2.0, 2.0], None)
}

fn place(text: &str, mesh: &Mesh) -> Workplace {
    Workplace::with_mesh(text, &mesh_bytes(mesh, MshFormat::V4_1Binary))
}

fn energy(of: &Value, name: &str) -> f64 {
    of["energy"][name].as_f64().unwrap_or(0.0)
}

/// Joints that are stiff or give way, open or healed, in the plane and in space.
#[test]
fn jointed_rock_under_stress_stays_at_rest_and_has_the_stress_that_was_asked_for() {
    let compliant = ["angle\"\n", "angle\"\nnormal_stiffness = \"50 GPa/m\"\nshear_stiffness = \"20 GPa/m\"\n"];
    let healed = [
        "bonded = false",
        "tensile_strength = \"2 MPa\"\nfracture_energy = \"500 J/m^2\"\nfriction_angle = \"45 deg\"",
    ];
    let space = SQUARE
        .replace(
            "[\"0.4 m\", \"0.5 m\", \"1.6 m\", \"1.2 m\"], [\"1.1 m\", \"0.3 m\", \"0.8 m\", \"1.7 m\"]",
            "[\"1 m\", \"1 m\", \"1 m\", \"50 deg\", \"30 deg\", \"1.2 m\"]",
        )
        .replace("xy = \"0.2 MPa\"", "zz = \"-2 MPa\"")
        .replace("\"y+\"]", "\"y+\", \"z-\", \"z+\"]");
    let cube = structured_box([8, 8, 8], Vec3::repeat(2.0), None);
    for (text, mesh) in [(SQUARE.to_owned(), square()), (space, cube)] {
        for (gives_way, heals) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut text = text.clone();
            for (wanted, [from, to]) in [(gives_way, compliant), (heals, healed)] {
                text = if wanted { text.replace(from, to) } else { text };
            }
            for kind in ["explicit", "static"] {
                let name = format!("gives way: {gives_way}, healed: {heals}, {kind}\n{text}");
                let held =
                    if kind == "static" { if mesh.tetrahedra.is_empty() { PINS[0] } else { PINS[1] } } else { "" };
                let text = text.replace("[solver]", &format!("{held}[solver]\nkind = \"{kind}\""));
                let one = run(&place(&text, &mesh), "one", "1");
                let stored = energy(&one, "elastic") + energy(&one, "interfaces");
                assert!(energy(&one, "kinetic") < 1e-12 * stored, "{name} {}", one["energy"]);
                // At rest stiff ones are springs, too.
                if kind == "explicit" {
                    assert_eq!(energy(&one, "interfaces") > 1e-6 * stored, gives_way, "{name} {}", one["energy"]);
                }
                for spent in ["friction", "interface_fracture", "external"] {
                    assert!(energy(&one, spent).abs() < 1e-9 * stored, "{name} {}", one["energy"]);
                }
                let stress = one["probes"]["xx"]["final"].as_f64().unwrap();
                assert!((stress / -1e6 - 1.0).abs() < 1e-3, "{name} {stress}");
            }
        }
    }
}

/// A joint at 45 degrees to -1 and -3 MPa has a shear stress of half of its pressure: it holds from atan 0.5 = 26.57 degrees on.
#[test]
fn a_joint_that_cannot_bear_the_stress_is_refused_by_name() {
    let text = SQUARE
        .replace(", [\"1.1 m\", \"0.3 m\", \"0.8 m\", \"1.7 m\"]", "")
        .replace("\"0.4 m\", \"0.5 m\", \"1.6 m\", \"1.2 m\"", "\"0.5 m\", \"0.5 m\", \"1.5 m\", \"1.5 m\"")
        .replace(", xy = \"0.2 MPa\"", "");
    let place = place(&text, &square());
    for (angle, holds) in [("26.5 deg", false), ("26.6 deg", true)] {
        let set = format!("angle={angle}");
        let ended = place.fractum(&["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--set", &set]);
        assert_eq!(ended.code == Some(0), holds, "{angle}: {}", ended.stderr);
        if !holds {
            assert!(
                ended.stderr.contains("interface \"joints\"") && ended.stderr.contains("friction"),
                "{}",
                ended.stderr
            );
        }
    }
}

#[test]
fn jointed_rock_under_stress_has_the_same_bits_on_any_threads_and_after_a_resume() {
    let moving =
        SQUARE.replace("[solver]", "[[loads]]\ngroup = \"x+\"\npressure = \"0.3 MPa*sin(t/0.2 ms)\"\n[solver]");
    let place = place(&moving, &square());
    let one = run(&place, "one", "1");
    assert!(energy(&one, "kinetic") > 0.0 && energy(&one, "residual_max_relative") < 1e-3, "{}", one["energy"]);
    assert_eq!(one["state_hash"], run(&place, "two", "2")["state_hash"]);
    assert_eq!(one["state_hash"], resumed(&place, "two")["state_hash"]);
    assert_eq!(summary(&place, "two")["energy"], one["energy"]);
}

/// A flat joint 1.5 radii above the middle of a hole that is cut out of rock under an even stress p. The closed form of Lamé has a shear stress on it
/// of p (a/r)² sin 2θ under a pressure of p (1 + (a/r)² cos 2θ): their largest ratio is that of 20.1 degrees.
#[test]
fn a_joint_above_a_hole_slides_from_the_friction_angle_of_the_elastic_stress_on() {
    let text = include_str!("../../../cases/excavation/jointed.toml")
        .replace("../../meshes/excavation-plane/hole.msh", "bar.msh");
    let mesh = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/excavation-plane/hole.msh")).unwrap();
    let place = Workplace::with_mesh(&text, &mesh);
    for (angle, slides) in [("40 deg", false), ("21 deg", false), ("19 deg", true), ("15 deg", true)] {
        let set = format!("angle={angle}");
        let ended = place.fractum(&["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--set", &set]);
        assert_eq!(ended.code, Some(0), "{angle}: {}", ended.stderr);
        let one = summary(&place, "one");
        assert_eq!(energy(&one, "friction") > 1e-7, slides, "{angle}: {}", one["energy"]);
        assert!(
            energy(&one, "interface_fracture").abs() < 1e-9 + 1e-3 * energy(&one, "friction"),
            "{angle}: {}",
            one["energy"]
        );
    }
}

/// A lining comes in beside a joint that ends before it: the closed form of the case without a joint holds while nothing slides. Joints that cut the
/// lining are refused by name.
#[test]
fn a_lining_comes_in_beside_a_joint() {
    let case = include_str!("../../../cases/excavation/lining.toml")
        .replace("../../meshes/excavation-plane/lining.msh", "bar.msh")
        .replace("\"bar.msh\"\n", "\"bar.msh\"\njoints = [{ name = \"joint\", table = [[\"0 m\", \"HEIGHT\", \"30 m\", \"HEIGHT\"]] }]\n")
        .replace("[in_situ]", "[[interfaces]]\nname = \"joint\"\ngroup = \"joint\"\nbonded = false\nresidual_friction_angle = \"angle\"\n[in_situ]")
        .replace("share = 0.5\n", "share = 0.5\nangle = \"25 deg\"\n");
    let mesh = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/excavation-plane/lining.msh")).unwrap();
    let place = Workplace::with_mesh(&case.replace("HEIGHT", "7.5 m"), &mesh);
    for (angle, slides) in [("25 deg", false), ("15 deg", true)] {
        let set = format!("angle={angle}");
        let ended = place.fractum(&["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--set", &set]);
        assert_eq!(ended.code, Some(0), "{angle}: {}", ended.stderr);
        let one = summary(&place, "one");
        assert_eq!(energy(&one, "friction") > 1.0, slides, "{angle}: {}", one["energy"]);
        assert!(energy(&one, "residual_max_relative") < 1e-4, "{angle}: {}", one["energy"]);
        // That of the case.
        let [side, hoop] = ["side", "hoop"].map(|name| one["probes"][name]["final"].as_f64().unwrap());
        let near = (side / 2.719e-3 - 1.0).abs() < 0.02 && (hoop / -6.494e6 - 1.0).abs() < 0.02;
        assert!(near || slides, "{angle}: {side} {hoop}");
    }
    let ended = Workplace::with_mesh(&case.replace("HEIGHT", "2 m"), &mesh).fractum(&["check", "case.toml"]);
    let words = "interfaces[0]: it cuts body \"lining\", which comes in later, at (";
    assert!(ended.code == Some(1) && ended.stderr.contains(words), "{}", ended.stderr);
}

/// A joint that meets a side on which a support holds both of its sides askew, and crosses the border of what leaves, 0.5 radii from the middle of
/// the hole. Among elements of 1 to 20 mm it must not be led along that border. By Lamé it bears up to 30 degrees, at the wall.
#[test]
fn a_joint_through_a_support_and_a_hole_slides_under_little_friction_alone() {
    let case = include_str!("../../../cases/excavation/jointed.toml");
    let (begin, end) = (case.find("table = ").unwrap(), case.find("\n\n[materials").unwrap());
    let askew = format!("{}table = [[\"0 mm\", \"7 mm\", \"60 mm\", \"67 mm\"]]{}", &case[..begin], &case[end..]);
    let mesh = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/excavation-plane/hole.msh")).unwrap();
    let place = Workplace::with_mesh(&askew.replace("../../meshes/excavation-plane/hole.msh", "bar.msh"), &mesh);
    for (angle, slides) in [("60 deg", false), ("32 deg", false), ("20 deg", true)] {
        let set = format!("angle={angle}");
        let ended = place.fractum(&["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--set", &set]);
        assert_eq!(ended.code, Some(0), "{angle}: {}", ended.stderr);
        let one = summary(&place, "one");
        assert_eq!(energy(&one, "friction") > 1e-7, slides, "{angle}: {}", one["energy"]);
        // The way of the wall by Lamé, where nothing slides.
        let top = one["probes"]["top"]["final"].as_f64().unwrap();
        assert!(slides || (top / 1.875e-6 - 1.0).abs() < 0.01, "{angle}: {top}");
    }
}

/// A block of 1 m on another one, pushed by 1 mm, back as far to the other side, and home, under 1 MPa.
const SHEARED: &str = r#"fractum = 1
mesh = { file = "bar.msh", joints = [{ name = "joint", table = [[0, "0.5 m", "1 m", "0.5 m"]] }] }
materials = { rock = { density = "2600 kg/m^3", young_modulus = "20 GPa", poisson_ratio = 0 } }
bodies = [{ name = "rock", kind = "solid", group = "body", material = "rock" }]
solver = { kind = "static", end = "1 s" }
interfaces = [{ group = "joint", bonded = false, residual_friction_angle = "30 deg" }]
loads = [{ group = "y+", pressure = { ramp = [["0 s", 0], ["0.02 s", "1 MPa"]] } }]
probes = [
  { name = "shear", reaction = { where = "y > 0.6 m", along = "x" } },
  { name = "largest", expression = "max(shear)/(1 MPa*1 m*1 m)", unit = "1" },
]
[[supports]]
group = "y-"
fix = "xy"
[[supports]]
where = "y > 0.6 m"
displacement = { x = { ramp = [["0 s", 0], ["0.25 s", "1 mm"], ["0.75 s", "-1 mm"], ["1 s", 0]] } }
"#;

/// The state at the end is not all that counts: what slides has rubbed on its way, however its turns lie between steps.
#[test]
fn a_joint_that_is_sheared_and_brought_back_has_rubbed_without_a_step_being_asked_for() {
    let friction = 30f64.to_radians().tan();
    let begin = SHEARED.find("displacement =").unwrap();
    let ways = [
        SHEARED[begin..].trim_end(),
        r#"displacement = { x = { ramp = [["0 s", 0], ["0.03 s", 0], ["0.267 s", "1 mm"], ["0.751 s", "-1 mm"], ["1 s", 0]] } }"#,
        r#"displacement = { x = "1 mm*if(t < 0.25 s, 4*t/1 s, if(t < 0.75 s, 2 - 4*t/1 s, 4*t/1 s - 4))" }"#,
        r#"velocity = { x = { ramp = [["0 s", "4 mm/s"], ["0.25 s", "4 mm/s"], ["0.2501 s", "-4 mm/s"], ["0.75 s", "-4 mm/s"], ["0.7501 s", "4 mm/s"]] } }"#,
    ];
    for way in ways {
        let place = place(&format!("{}{way}\n", &SHEARED[..begin]), &structured_rectangle([4, 4], [1.0, 1.0], None));
        let one = run(&place, "one", "1");
        let largest = one["probes"]["largest"]["final"].as_f64().unwrap();
        assert!((largest / friction - 1.0).abs() < 0.01, "{way}: {largest}");
        // Four ways of 1 mm, less what is elastic as it turns, five times: 0.5 m of rock below and 0.25 m above under a shear of 10 GPa.
        let exact = friction * 1e6 * (4e-3 - 5.0 * friction * 1e6 * 0.75 / 10e9);
        let work = energy(&one, "friction") / exact;
        assert!((work - 1.0).abs() < 0.04, "{way}: {work}");
        let fine = place.fractum(&["run", "case.toml", "--quiet", "-o", "fine", "--set", "solver.step=4 ms"]);
        assert_eq!(fine.code, Some(0), "{}", fine.stderr);
        let work = energy(&one, "friction") / energy(&summary(&place, "fine"), "friction");
        assert!((work - 1.0).abs() < 0.01, "{way}: {work} of that of small steps");
    }
}

/// The same at other Poisson's ratios, where corners open as the motion turns: with a softer joint, which the message asks for where the stiffest one does not
/// come to rest.
#[test]
fn a_softer_joint_is_sheared_to_and_fro_at_any_poissons_ratio() {
    for ratio in ["0.1", "0.3", "0.45"] {
        let stiff = SHEARED.replace("poisson_ratio = 0 ", &format!("poisson_ratio = {ratio} "));
        let mesh = structured_rectangle([4, 4], [1.0, 1.0], None);
        let ended = place(&stiff, &mesh).fractum(&["run", "case.toml", "--quiet", "-o", "stiff"]);
        let said = ended.code == Some(0) || ended.stderr.contains("give them a normal_stiffness of a tenth");
        assert!(said, "{ratio}: {}", ended.stderr);
        let given = "= \"30 deg\", normal_stiffness = \"500 GPa/m\", shear_stiffness = \"200 GPa/m\" }]";
        let place = place(&stiff.replace("= \"30 deg\" }]", given), &mesh);
        let work = |folder: &str, step: &str| {
            let step = format!("solver.step={step}");
            let ended = place.fractum(&["run", "case.toml", "--quiet", "-o", folder, "--set", &step]);
            assert_eq!(ended.code, Some(0), "{ratio}: {}", ended.stderr);
            energy(&summary(&place, folder), "friction")
        };
        let [coarse, fine] = [work("coarse", "20 ms"), work("fine", "4 ms")];
        assert!((coarse / fine - 1.0).abs() < 0.01, "{ratio}: {coarse} J of {fine} J");
    }
}

#[test]
fn a_joint_that_would_wear_over_metres_is_told() {
    for (key, slip, told) in [("peak_slip", "2 mm", 0), ("peak_slip", "2 m", 1), ("dilation_slip", "0.3 m", 1)] {
        let rough =
            format!("= \"30 deg\", joint_roughness = 10, joint_wall_strength = \"100 MPa\", {key} = \"{slip}\" }}]");
        let smooth = format!("= \"30 deg\", dilation_angle = \"5 deg\", {key} = \"{slip}\" }}]");
        let law = if key == "peak_slip" { rough } else { smooth };
        let place = place(&SHEARED.replace("= \"30 deg\" }]", &law), &structured_rectangle([4, 4], [1.0, 1.0], None));
        let ended = place.fractum(&["check", "case.toml"]);
        let said = format!("{}{}", ended.stdout, ended.stderr);
        assert_eq!(said.matches("[unusual-value]").count(), told, "{said}");
        assert!(told == 0 || said.contains(&format!(".{key} = ")), "{said}");
    }
}

/// A joint of 0.4 m in a block of 2 m, with water in it.
const SLIT: &str = r#"fractum = 1
mesh = { file = "bar.msh", joints = [{ name = "slit", table = [["0.8 m", "1 m", "1.2 m", "1 m"]] }] }
materials = { rock = { density = "2600 kg/m^3", young_modulus = "20 GPa", poisson_ratio = 0.2 } }
bodies = [{ name = "rock", kind = "solid", group = "body", material = "rock" }]
solver = { kind = "static", end = "1 s" }
interfaces = [{ group = "slit", bonded = false, pressure = "1 MPa*t/1 s" }]
supports = [{ group = "y-", fix = "xy" }]
"#;

#[test]
fn a_crack_of_few_faces_is_told_with_the_size_that_it_asks_for() {
    let told = |cells: u32, formulation: &str| {
        let text = SLIT.replace("\"rock\" }]", &format!("\"rock\", formulation = \"{formulation}\" }}]"));
        let place = place(&text, &structured_rectangle([cells; 2], [2.0, 2.0], None));
        run(&place, "one", "1");
        summary(&place, "one")["warnings"].as_array().unwrap().clone()
    };
    let all = told(20, "standard");
    let [one] = all.as_slice() else { panic!("{all:?}") };
    assert!(one["code"] == "coarse-mesh" && one["where"] == "interface \"interface-1\"", "{one}");
    // Two faces of 0.1 m from the middle to the tip: 0.7/2 of the volume; a twentieth of it asks for fourteen.
    let [text, remedy] = ["text", "remedy"].map(|key| one[key].as_str().unwrap());
    assert!(text.contains("by some 35 % too little") && remedy.starts_with("faces of 14.29 mm"), "{one}");
    assert_eq!(told(20, "smoothed").len(), 1);
    assert_eq!(told(80, "smoothed").len(), 0);
}
