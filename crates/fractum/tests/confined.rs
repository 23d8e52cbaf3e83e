//! Cracks that liquid opens in rock under in-situ stress.

use std::f64::consts::PI;

use fractum_math::Vec3;
use fractum_mesh::MshFormat;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use serde_json::Value;

use crate::common::{Workplace, history, mesh_bytes, resumed, run, summary};

/// A case of cases/liquid with its mesh.
fn of_gallery(case: &str) -> Workplace {
    let mesh = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/interfaces/liquid.msh")).unwrap();
    Workplace::with_mesh(&case.replace("../../meshes/interfaces/liquid.msh", "bar.msh"), &mesh)
}

const CONFINED: &str = include_str!("../../../cases/liquid/confined.toml");
const VISCOSITY: &str = include_str!("../../../cases/liquid/viscosity.toml");

/// Runs a place with parameters; its summary.
fn run_with(place: &Workplace, sets: &[&str]) -> Value {
    let mut arguments = vec!["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--threads", "1"];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    let ended = place.fractum(&arguments);
    assert_eq!(ended.code, Some(0), "{sets:?}: {}", ended.stderr);
    let one = summary(place, "one");
    assert!(energy(&one, "residual_max_relative") < 1e-5, "{sets:?}: {}", one["energy"]);
    one
}

fn probes<const N: usize>(of: &Value, names: [&str; N]) -> [f64; N] {
    names.map(|name| of["probes"][name]["final"].as_f64().unwrap())
}

fn energy(of: &Value, name: &str) -> f64 {
    of["energy"][name].as_f64().unwrap_or(0.0)
}

/// Elastic solids: what the stress adds is the pressure that it takes to open the crack against it. The loads of the far field give way by the stress across
/// the crack times its volume.
#[test]
fn a_crack_under_in_situ_stress_is_the_one_without_at_the_pressure_above_it() {
    let place = of_gallery(&CONFINED.replace("duration/60", "duration/20"));
    for nu in ["0.1", "0.2", "0.3", "0.4"] {
        let of = |sets: &[&str]| {
            let nu = format!("nu={nu}");
            let one = run_with(&place, &[&[nu.as_str()], sets].concat());
            (probes(&one, ["opening", "net", "area"]), energy(&one, "external"))
        };
        let (free, _) = of(&["stress=1 Pa", "along=1 Pa"]);
        for (stress, along) in [(1e6, 1e6), (10e6, 6e6), (50e6, 80e6)] {
            let sets = [&*format!("stress={stress} Pa"), &*format!("along={along} Pa")];
            let (found, external) = of(&sets);
            assert!((external / (-stress * 0.5e-6 * 320.0) - 1.0).abs() < 1e-3, "nu {nu}, {sets:?}: {external} J");
            for (found, free) in found.iter().zip(free) {
                assert!((found / free - 1.0).abs() < 1e-3, "nu {nu}, {sets:?}: {found} {free}");
            }
        }
    }
}

/// The stress of the solids, or the traction that makes it. A joint that gives way bears less of the traction than the solid beyond its end: this one hardly does.
#[test]
fn in_situ_stress_opposes_the_liquid_as_a_traction_does() {
    let stiff = "bonded = false\nnormal_stiffness = \"6e15 Pa/m\"\nshear_stiffness = \"6e15 Pa/m\"";
    let text = VISCOSITY.replace("duration/240", "duration/40").replace("bonded = false", stiff);
    let load = "[[loads]]\ngroup = \"top\"\ntraction = { y = \"-stress\" }\n";
    let before = "[in_situ]\nstress = { xx = \"-stress/3\", yy = \"-stress\" }\ngroups = [\"right\", \"top\"]\n";
    assert!(text.contains(load));
    let of = |text: &str| probes(&run_with(&of_gallery(text), &[]), ["opening", "net", "area"]);
    for (found, loaded) in of(&text.replace(load, before)).iter().zip(of(&text)) {
        assert!((found / loaded - 1.0).abs() < 1e-7, "{found} {loaded}");
    }
}

/// A thousandth of the size: the toughness pressure K/√(πl) stays with a thousandth of the fracture energy.
#[test]
fn a_crack_of_millimetres_under_in_situ_stress_has_the_same_pressure() {
    let text = CONFINED.replace("duration/60", "duration/20");
    let small = text
        .replace("unit = \"m\"", "unit = \"mm\"")
        .replace("x < 1 mm", "x < 1 um")
        .replace("\"32 J/m^2\"", "\"0.032 J/m^2\"")
        .replace("\"1e-6 m^2/s\"", "\"1e-12 m^2/s\"");
    let of = |text: &str| probes(&run_with(&of_gallery(text), &[]), ["opening", "net", "area"]);
    let [large, small] = [of(&text), of(&small)];
    for (index, scale) in [(0, 1e-3), (1, 1.0), (2, 1e-3)] {
        assert!((small[index] / large[index] / scale - 1.0).abs() < 1e-6, "{small:?} {large:?}");
    }
}

/// A joint at 45 degrees to -1 and -3 MPa, 0.8 m long in a square of 4 m: liquid everywhere in it, whose pressure grows.
const INCLINED: &str = r#"fractum = 1
[parameters]
p = "0.2 MPa"
nu = 0.25
[mesh]
file = "bar.msh"
[[mesh.joints]]
name = "joint"
table = [["1.7171573 m", "1.7171573 m", "2.2828427 m", "2.2828427 m"]]
[materials.rock]
density = "2600 kg/m^3"
young_modulus = "40 GPa"
poisson_ratio = "nu"
[[bodies]]
name = "rock"
kind = "solid"
group = "body"
material = "rock"
plane = "strain"
thickness = "1 m"
[[interfaces]]
name = "joint"
group = "joint"
bonded = false
residual_friction_angle = "30 deg"
[in_situ]
stress = { xx = "-1 MPa", yy = "-3 MPa" }
groups = ["x-", "x+", "y-", "y+"]
[liquid]
viscosity = "1 mPa s"
aperture = "0.1 mm"
[[liquid.injections]]
group = "joint"
pressure = "p*t/1 s"
[[supports]]
where = "hypot(x, y) < 1 mm"
fix = "xy"
[[supports]]
where = "hypot(x - 4 m, y) < 1 mm"
fix = "y"
[solver]
kind = "static"
control = "time"
end = "1 s"
step = "0.05 s"
[[probes]]
name = "rubbed"
energy = "friction"
"#;

/// It slides as (2 MPa - p) tan 30° falls below the shear stress of 1 MPa, at p = 0.268 MPa. Beyond, the closed form of a crack under the shear stress
/// s = 1 MPa - (2 MPa - p) tan 30° slides by the area 2π a² s/E', and friction takes ∫ (2 MPa - p) tan 30° dA.
#[test]
fn liquid_lets_an_inclined_joint_slide_as_its_effective_stress_falls() {
    let [coarse, fine] = [80, 160].map(|cells| {
        let mesh = structured_rectangle([cells, cells], [4.0, 4.0], None);
        Workplace::with_mesh(INCLINED, &mesh_bytes(&mesh, MshFormat::V4_1Binary))
    });
    let slope = f64::to_radians(30.0).tan();
    for nu in ["0.1", "0.4"] {
        let rubbed = |place: &Workplace, p: &str| {
            energy(&run_with(place, &[&format!("nu={nu}"), &format!("p={p}")]), "friction")
        };
        assert!(rubbed(&coarse, "0.25 MPa").abs() < 1e-6 && rubbed(&coarse, "0.29 MPa") > 0.1, "{nu}");
        let (p, modulus) = (1e6, 40e9 / (1.0 - nu.parse::<f64>().unwrap().powi(2)));
        let per_stress = 2.0 * PI * 0.4 * 0.4 / modulus;
        let [first, last] = [1e6, (2e6 - p) * slope];
        let exact = 0.5 * (first + last) * (first - last) * per_stress;
        // Elements at the tips make the joint too short, by some part of themselves; the sides, five of its lengths away, add some percent.
        let found = 2.0 * rubbed(&fine, "1 MPa") - rubbed(&coarse, "1 MPa");
        assert!((found / exact - 1.0).abs() < 0.06, "{nu}: {found} {exact}");
    }
}

/// In space: a disc in a cube, under the stress of the solids or the pressure that makes it, whatever presses along it.
#[test]
fn in_situ_stress_opposes_the_liquid_in_a_disc_too() {
    let mesh = structured_box([10, 10, 10], Vec3::repeat(4.0), None);
    let mesh = mesh_bytes(&mesh, MshFormat::V4_1Binary);
    let (first, last) = (INCLINED.find("[in_situ]").unwrap(), INCLINED.find("[solver]").unwrap());
    let cube = INCLINED
        .replace("[[\"1.7171573 m\", \"1.7171573 m\", \"2.2828427 m\", \"2.2828427 m\"]]", "[[\"2 m\", \"2 m\", \"2 m\", \"0 deg\", \"0 deg\", \"2.6 m\"]]")
        .replace("plane = \"strain\"\nthickness = \"1 m\"\n", "")
        .replace("residual_friction_angle = \"30 deg\"", "normal_stiffness = \"1e15 Pa/m\"\nshear_stiffness = \"1e15 Pa/m\"")
        .replace(&INCLINED[first..last], "STRESS[liquid]\nviscosity = \"0.01 Pa s\"\n[[liquid.injections]]\ngroup = \"joint\"\nwhere = \"hypot(x - 2 m, y - 2 m) < 0.1 m\"\nrate = \"1e-5 m^3/s\"\n\
            [[supports]]\nwhere = \"hypot(x, y) + z < 1 mm\"\nfix = \"xyz\"\n[[supports]]\nwhere = \"hypot(x - 4 m, y) + z < 1 mm\"\nfix = \"yz\"\n[[supports]]\nwhere = \"hypot(x, y - 4 m) + z < 1 mm\"\nfix = \"z\"\n")
        .replace("name = \"rubbed\"\nenergy = \"friction\"", "name = \"opening\"\nliquid = \"aperture\"\n[[probes]]\nname = \"pressure\"\nliquid = \"pressure\"\n[[probes]]\nname = \"area\"\nliquid = \"wetted_area\"");
    let before = |across: &str, along: &str| {
        format!(
            "[in_situ]\nstress = {{ xx = \"-{along}\", yy = \"-{along}\", zz = \"-{across}\" }}\ngroups = [\"x-\", \"x+\", \"y-\", \"y+\", \"z-\", \"z+\"]\n"
        )
    };
    let loaded = |group: &str, pressure: &str| format!("[[loads]]\ngroup = \"{group}\"\npressure = \"{pressure}\"\n");
    let loads: String =
        [("x-", "1 MPa"), ("x+", "1 MPa"), ("y-", "1 MPa"), ("y+", "1 MPa"), ("z-", "3 MPa"), ("z+", "3 MPa")]
            .map(|(group, pressure)| loaded(group, pressure))
            .concat();
    let of = |stress: &str| {
        probes(
            &run_with(&Workplace::with_mesh(&cube.replace("STRESS", stress), &mesh), &[]),
            ["opening", "pressure", "area"],
        )
    };
    let one = of(&before("3 MPa", "1 MPa"));
    assert!(one[1] > 3e6 && one[2] > 0.1, "{one:?}");
    for other in [of(&loads), of(&before("3 MPa", "9 MPa"))] {
        for (one, other) in one.iter().zip(other) {
            assert!((other / one - 1.0).abs() < 1e-5, "{one} {other}");
        }
    }
}

/// A pressure that is given in another interface opens that, with liquid beside it or not.
#[test]
fn liquid_leaves_the_pressure_in_other_interfaces() {
    let mesh = mesh_bytes(&structured_rectangle([24, 24], [4.0, 4.0], None), MshFormat::V4_1Binary);
    let other = "[[interfaces]]\nname = \"other\"\ngroup = \"other\"\nbonded = false\nresidual_friction_angle = \"30 deg\"\n\
                 pressure = \"10 MPa*t/1 s\"\n[in_situ]";
    let joint = "[[mesh.joints]]\nname = \"other\"\ntable = [[\"1 m\", \"3 m\", \"1.8 m\", \"3 m\"]]\n[materials.rock]";
    let look = "[[probes]]\nname = \"up\"\ndisplacement = { where = \"hypot(x - 1.4 m, y - 3.2 m) < 0.2 m\", along = \"y\" }\n";
    let wet = INCLINED
        .replace("[materials.rock]", joint)
        .replace("[in_situ]", other)
        .replace("[liquid]", "[liquid]\ninterfaces = [\"joint\"]")
        + look;
    let (first, last) = (wet.find("[liquid]").unwrap(), wet.find("[[supports]]").unwrap());
    let dry = format!("{}{}", &wet[..first], &wet[last..]);
    let up = |text: &str| probes(&run_with(&Workplace::with_mesh(text, &mesh), &[]), ["up"])[0];
    let [with, without] = [up(&wet), up(&dry)];
    assert!(without > 1e-5 && (with / without - 1.0).abs() < 1e-3, "{with} {without}");

    let broken = wet.replace("10 MPa*t/1 s\"", "10 MPa*t/1 s\"\npressure_in = \"broken\"");
    let ended = Workplace::with_mesh(&broken, &mesh).fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("beside [liquid]"), "{}", ended.stderr);
}

/// After shut-in walls take the liquid: the pressure falls to the stress across the crack, and is gone once the crack has closed.
#[test]
fn the_pressure_after_shut_in_falls_to_the_closing_stress() {
    let case = include_str!("../../../cases/liquid/shut-in.toml").replace("duration/60", "duration/20");
    let start = case.find("stop_when").unwrap();
    let end = start + case[start..].find('\n').unwrap();
    let place = of_gallery(&format!("{}{}", &case[..start], &case[end..]));
    for stress in [1e6, 10e6, 50e6] {
        let set = format!("stress={stress} Pa");
        let one = run_with(&place, &[&set, "leak_off=1e-6 m/s^0.5"]);
        let [pressure, volume, whole] = probes(&one, ["pressure", "volume", "whole"]);
        assert!(pressure == 0.0 && volume.abs() < 1e-12 && (whole - 1.0).abs() < 1e-9, "{set} {pressure} {volume}");
        let rows = history(&place, "one", &["time", "pressure", "opening"]);
        let largest = rows.iter().map(|row| row[2]).fold(0.0, f64::max);
        let closing: Vec<_> = rows.iter().filter(|row| row[0] > 320.0 && row[2] > 0.01 * largest).collect();
        assert!(closing.len() > 5 && closing.windows(2).all(|rows| rows[1][1] < rows[0][1] + 1.0), "{set}");
        let net = closing.last().unwrap()[1] - stress;
        assert!((0.0..0.1e6).contains(&net), "{set}: {net} Pa above the stress");
    }
}

#[test]
fn a_crack_under_in_situ_stress_has_the_same_bits_on_any_threads_and_after_a_resume() {
    let text = CONFINED.replace("duration/60", "duration/20");
    let place = of_gallery(&format!("{text}\n[output]\ncheckpoint = {{ steps = 12 }}\n"));
    let one = run(&place, "one", "1");
    for threads in ["2", "7"] {
        assert_eq!(one["state_hash"], run(&place, threads, threads)["state_hash"]);
    }
    assert_eq!(one["state_hash"], resumed(&place, "2")["state_hash"]);
    assert_eq!(summary(&place, "2")["energy"], one["energy"]);
}
