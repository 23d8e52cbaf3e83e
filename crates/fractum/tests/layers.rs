//! Layers that begin with a stress of their own.

use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_mesh::{Group, Mesh, MshFormat};
use serde_json::Value;

use crate::common::{Workplace, history, mesh_bytes, resumed, run, summary};

/// Two layers of unlike stiffness and density at rest under their weight, each with its own ratio of horizontal to vertical stress; a block leaves the lower one.
const GROUND: &str = r#"fractum = 1
[parameters]
nu = 0.2
ratio = 1                       # how much stiffer the lower layer is
size = "12 m"                   # edge of the square or cube
fall = "10 m/s^2"
[mesh]
file = "bar.msh"
[materials.clay]
density = "1800 kg/m^3"
young_modulus = "200 MPa"
poisson_ratio = "nu"
[materials.sand]
density = "2000 kg/m^3"
young_modulus = "200 MPa*ratio"
poisson_ratio = "nu"
[[bodies]]
name = "upper"
kind = "solid"
group = "upper"
material = "clay"
[[bodies]]
name = "lower"
kind = "solid"
group = "lower"
material = "sand"
[[bodies]]
name = "core"
kind = "solid"
group = "core"
material = "sand"
[in_situ]
groups = ["x+"]
[[in_situ.layers]]
bodies = ["upper"]
stress = { yy = "-1800 kg/m^3*fall*(size - y)", xx = "-0.8*1800 kg/m^3*fall*(size - y)" }
[[in_situ.layers]]
bodies = ["lower", "core"]
stress = { yy = "-fall*(900 kg/m^3*size + 2000 kg/m^3*(size/2 - y))", xx = "-0.4*fall*(900 kg/m^3*size + 2000 kg/m^3*(size/2 - y))", zz = "-100 kPa" }
[[loads]]
gravity = { y = "-fall" }
[[supports]]
group = "y-"
fix = "y"
[[supports]]
group = "x-"
fix = "x"
[[stages]]
name = "before"
solver = { kind = "static", end = "1 s", step = "1 s" }
[[stages]]
name = "hole"
excavate = ["core"]
solver = { kind = "static", end = "2 s", step = "0.5 s" }
[[probes]]
name = "xx_upper"
stress = { group = "upper", component = "xx" }
[[probes]]
name = "yy_upper"
stress = { group = "upper", component = "yy" }
[[probes]]
name = "xx_lower"
stress = { group = "lower", component = "xx" }
[[probes]]
name = "zz_core"
stress = { group = "core", component = "zz" }
[[probes]]
name = "top"
displacement = { group = "y+", along = "y" }
[[probes]]
name = "base"
reaction = { group = "y-", along = "y" }
[[probes]]
name = "side"
reaction = { group = "x-", along = "x" }
"#;

/// In space the far faces along z bear their stress too.
const IN_SPACE: [&str; 2] = [
    "[[supports]]\ngroup = \"x-\"\nfix = \"x\"\n",
    "[[supports]]\ngroup = \"x-\"\nfix = \"x\"\n[[supports]]\ngroup = \"z-\"\nfix = \"z\"\n[[supports]]\ngroup = \"z+\"\nfix = \"z\"\n",
];

/// A square or a cube of layers, with nodes where these meet.
fn ground(in_space: bool, cells: u32, size: f64) -> Mesh {
    let jitter = Some(Jitter { fraction: 0.12, seed: 5 });
    let mut mesh = if in_space {
        structured_box([cells; 3], Vec3::repeat(size), jitter)
    } else {
        structured_rectangle([cells; 2], [size; 2], jitter)
    };
    let cell = size / f64::from(cells);
    for node in mesh.nodes.iter_mut().filter(|node| (node.y - 0.5 * size).abs() < 0.4 * cell) {
        node.y = 0.5 * size;
    }
    let middles: Vec<Vec3> = if in_space {
        mesh.tetrahedra.iter().map(|e| e.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / 4.0).collect()
    } else {
        mesh.triangles.iter().map(|e| e.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / 3.0).collect()
    };
    mesh.groups.retain(|group| group.name != "body");
    let of = |middle: &Vec3| match *middle / size {
        at if at.y > 0.5 => "upper",
        at if (at.x - 0.6).abs() < 0.2 && at.y > 0.15 && at.y < 0.35 => "core",
        _ => "lower",
    };
    for (tag, name) in (101..).zip(["upper", "lower", "core"]) {
        let own = (0..).zip(&middles).filter(|(_, middle)| of(middle) == name).map(|(element, _)| element).collect();
        let group = Group { name: name.into(), dimension: 2, tag, ..Group::default() };
        mesh.groups.push(match in_space {
            true => Group { dimension: 3, tetrahedra: own, ..group },
            false => Group { triangles: own, ..group },
        });
    }
    mesh
}

fn place(text: &str, mesh: &Mesh) -> Workplace {
    Workplace::with_mesh(text, &mesh_bytes(mesh, MshFormat::V4_1Binary))
}

/// The ground in the plane or in space, of a formulation.
fn written(in_space: bool, formulation: &str) -> String {
    let [flat, deep] = IN_SPACE;
    let text = if in_space { GROUND.replace(flat, deep) } else { GROUND.to_owned() };
    let depth = if in_space { "" } else { "thickness = \"2 m\"\n" };
    text.replace("material = \"", &format!("formulation = \"{formulation}\"\n{depth}material = \""))
}

fn energy(of: &Value, name: &str) -> f64 {
    of["energy"][name].as_f64().unwrap_or(0.0)
}

fn last(of: &Value, name: &str) -> f64 {
    of["probes"][name]["final"].as_f64().unwrap()
}

/// Nothing has moved, at rest and in motion, and stress and reactions are those of the layers, on irregular meshes and of any size.
#[test]
fn layers_begin_with_the_stress_that_is_written_and_nothing_moves() {
    let cases = [
        (false, "smoothed", "0.45", "10", 12.0),
        (false, "standard", "0", "0.1", 12.0),
        (false, "standard", "0.2", "10", 0.012),
        (true, "smoothed", "0.2", "0.1", 0.012),
        (true, "standard", "0.45", "10", 12.0),
    ];
    for (in_space, formulation, nu, ratio, size) in cases {
        let mesh = ground(in_space, if in_space { 4 } else { 10 }, size);
        for moving in [false, true] {
            let name = format!("in space: {in_space}, {formulation}, {nu}, {ratio}, {size}, {moving}");
            let text = written(in_space, formulation);
            let (first, last_one) = (text.find("[[stages]]").unwrap(), text.find("[[probes]]").unwrap());
            // Some passages of a wave.
            let alone = format!("[solver]\nend = \"{} s\"\n", 0.01 * size / 12.0);
            let text = if moving { format!("{}{alone}{}", &text[..first], &text[last_one..]) } else { text };
            let place = place(&text, &mesh);
            let sets = [format!("nu={nu}"), format!("ratio={ratio}"), format!("size={size} m")];
            let mut arguments = vec!["run", "case.toml", "--quiet", "-o", "one", "--threads", "1"];
            sets.iter().for_each(|set| arguments.extend(["--set", set]));
            let ended = place.fractum(&arguments);
            assert_eq!(ended.code, Some(0), "{name}: {}", ended.stderr);
            let one = summary(&place, "one");
            assert!(energy(&one, "residual_max_relative") < 1e-6, "{name}: {}", one["energy"]);
            let rows = history(
                &place,
                "one",
                &["time", "xx_upper", "yy_upper", "zz_core", "top", "base", "side", "elastic", "kinetic"],
            );
            let depth = if in_space { size } else { 2.0 };
            let strain = 1800.0 * 10.0 * size / 200e6;
            let weight = (1800.0 + 2000.0) * 5.0 * size * size * depth;
            let yy = -18000.0 * size / 4.0;
            let before: Vec<_> = rows.iter().filter(|row| moving || row[0] <= 1.0).collect();
            assert!(before.len() > 1, "{name}");
            for row in &before {
                let near = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-9;
                assert!(row[4].abs() < 1e-9 * strain * size && row[8] < 1e-14 * row[7], "{name}: {row:?}");
                // The mean over a layer is that at its middle.
                assert!(near(row[2], yy) && near(row[1], 0.8 * yy), "{name}: {row:?}");
                assert!(near(row[3], -100e3), "{name}: {row:?}");
            }
            let held = before.last().unwrap();
            assert!((held[5] / weight - 1.0).abs() < 1e-9, "{name}: {held:?}, {weight}");
            // 0.8 times the mean in the upper layer, 0.4 times that in the lower one.
            let push = (0.8 * 4500.0 + 0.4 * (9000.0 + 5000.0)) * size * 0.5 * size * depth;
            assert!((held[6] / push - 1.0).abs() < 1e-9, "{name}: {held:?}, {push}");
            if !moving {
                let end = rows.last().unwrap();
                let lost = 2000.0 * 10.0 * volume(&mesh, "core") * if in_space { 1.0 } else { depth };
                assert!((end[5] / (weight - lost) - 1.0).abs() < 1e-8, "{name}: {end:?} {lost}");
                assert!(end[4].abs() > 1e-4 * strain * size, "{name}: {end:?}");
            }
        }
    }
}

/// Area or volume of a group.
fn volume(mesh: &Mesh, name: &str) -> f64 {
    let group = mesh.group(name)[0];
    let at = |node: u32| mesh.nodes[node as usize];
    let of_triangle = |&[a, b, c]: &[u32; 3]| 0.5 * (at(b) - at(a)).cross(&(at(c) - at(a))).norm();
    let of_tetrahedron =
        |&[a, b, c, d]: &[u32; 4]| (at(b) - at(a)).cross(&(at(c) - at(a))).dot(&(at(d) - at(a))).abs() / 6.0;
    let flat: f64 = group.triangles.iter().map(|&e| of_triangle(&mesh.triangles[e as usize])).sum();
    flat + group.tetrahedra.iter().map(|&e| of_tetrahedron(&mesh.tetrahedra[e as usize])).sum::<f64>()
}

/// A case of cases with its mesh, and with the stress of the far field as that of layers.
fn both(case: &str, mesh: &str, bodies: &str, stress: &str) -> [Workplace; 2] {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let text = std::fs::read_to_string(format!("{root}/cases/{case}.toml")).unwrap();
    let text = text.replace(&format!("../../meshes/{mesh}"), "bar.msh");
    let mesh = std::fs::read(format!("{root}/meshes/{mesh}")).unwrap();
    let layers = text.replace(
        &format!("stress = {stress}\n"),
        &format!("layers = [{{ bodies = [{bodies}], stress = {stress} }}]\n"),
    );
    assert_ne!(text, layers);
    [text, layers].map(|text| Workplace::with_mesh(&text, &mesh))
}

/// In one material layers with one stress are the far field: closed forms hold as they do for that.
#[test]
fn a_tunnel_in_layers_of_one_stress_is_that_in_the_far_field() {
    let bodies = "\"rock\", \"heading\", \"bench\", \"invert\"";
    let [far, layers] =
        both("excavation/tunnel", "excavation-plane/tunnel.msh", bodies, "{ xx = \"sxx\", yy = \"syy\" }")
            .map(|place| run(&place, "one", "1"));
    for probe in ["crown", "side", "bottom"] {
        let [far, layers] = [last(&far, probe), last(&layers, probe)];
        assert!((layers / far - 1.0).abs() < 1e-9, "{probe}: {layers} {far}");
    }
    for part in ["elastic", "left"] {
        let [far, layers] = [energy(&far, part), energy(&layers, part)];
        assert!((layers / far - 1.0).abs() < 1e-9, "{part}: {layers} {far}");
    }
}

/// The hole that the mesh has from the start: in one material layers that settle are the far field.
#[test]
fn a_hole_in_layers_that_settle_is_that_in_the_far_field() {
    let stress = "{ xx = \"sxx\", yy = \"syy\" }";
    let both = both("kirsch-in-situ/pressurised", "kirsch-plane/medium.msh", "\"rock\"", stress);
    let mesh = std::fs::read(both[0].path("bar.msh")).unwrap();
    for formulation in ["smoothed", "standard"] {
        let [far, layers] = both.each_ref().map(|place| {
            let text = std::fs::read_to_string(place.path("case.toml")).unwrap();
            let text = text
                .replace("end = \"0.1 ms\"", "end = \"4 us\"")
                // The area on which a pressure acts depends on the displacement.
                .replace("p = \"1 MPa\"", "p = \"1 Pa\"")
                .replace(
                    "formulation = \"smoothed\"",
                    &format!("formulation = \"{formulation}\"\nkinematics = \"small\""),
                )
                .replace("layers = [{", "settle = true\nlayers = [{");
            run(&Workplace::with_mesh(&text, &mesh), "one", "1")
        });
        let [far_crown, crown] = [&far, &layers].map(|one| last(one, "crown"));
        assert!((crown / far_crown - 1.0).abs() < 1e-9, "{formulation}: {crown} {far_crown}");
        assert!(last(&layers, "creep").abs() < 1e-12 && energy(&layers, "residual_max_relative") < 1e-6);
        let [far, layers] = [&far, &layers].map(|one| energy(one, "elastic"));
        assert!((layers / far - 1.0).abs() < 1e-9, "{formulation}: {layers} {far}");
    }
}

/// Layers of 1:10 between rollers all around, pressed unlike across their boundary: both settle to (σ₁/M₁ + σ₂/M₂)/(1/M₁ + 1/M₂) across it, and along it by
/// ν/(1 - ν) of what changes.
#[test]
fn layers_that_push_unlike_settle_to_one_push() {
    let (first, end) = (GROUND.find("[in_situ]").unwrap(), GROUND.find("[[stages]]").unwrap());
    let sides = ["y-", "y+", "x-", "x+"].map(|side| (side, &side[..1]));
    let cases = [
        (false, "smoothed", "strain", 0.45, 10.0, 12.0),
        (false, "standard", "stress", 0.2, 10.0, 12.0),
        (true, "smoothed", "strain", 0.2, 0.1, 0.012),
        (true, "standard", "strain", 0.0, 10.0, 12.0),
    ];
    for (in_space, formulation, plane, nu, ratio, size) in cases {
        let mesh = ground(in_space, if in_space { 4 } else { 10 }, size);
        let mut held = "[in_situ]\nsettle = true\nstress = { yy = \"-2 MPa\", xx = \"-1 MPa\", zz = \"-100 kPa\" }\n\
                        layers = [{ bodies = [\"upper\"], stress = { yy = \"-5 MPa\", xx = \"-3 MPa\" } }]\n"
            .to_owned();
        let deep = in_space.then_some([("z-", "z"), ("z+", "z")]);
        for (side, axis) in sides.into_iter().chain(deep.into_iter().flatten()) {
            held += &format!("[[supports]]\ngroup = \"{side}\"\nfix = \"{axis}\"\n");
        }
        let plane_of = if in_space { String::new() } else { format!("thickness = \"2 m\"\nplane = \"{plane}\"\n") };
        let text = format!("{}{held}{}", &GROUND[..first], &GROUND[end..])
            .replace("fall = ", "# ")
            .replace("material = \"", &format!("formulation = \"{formulation}\"\n{plane_of}material = \""))
            .replace("nu = 0.2", &format!("nu = {nu}"))
            .replace("ratio = 1 ", &format!("ratio = {ratio} "))
            .replace("size = \"12 m\"", "");
        let (stages, probes) = (text.find("[[stages]]").unwrap(), text.find("[[probes]]").unwrap());
        let alone = format!("[solver]\nend = \"{} s\"\n", 0.01 * size / 12.0);
        for moving in [false, true] {
            let name = format!("in space: {in_space}, {formulation}, {plane}, {nu}, {ratio}, {size}, {moving}");
            let text = if moving { format!("{}{alone}{}", &text[..stages], &text[probes..]) } else { text.clone() };
            let place = place(&text, &mesh);
            let one = run(&place, "one", "1");
            let push = -(5e6 * ratio + 2e6) / (ratio + 1.0);
            let along = if plane == "stress" { nu } else { nu / (1.0 - nu) };
            let depth = if in_space { size } else { 2.0 };
            let names = ["time", "yy_upper", "xx_upper", "xx_lower", "base", "zz_core", "kinetic", "elastic"];
            let rows = history(&place, "one", &names);
            let before: Vec<_> = rows.iter().filter(|row| moving || row[0] <= 1.0).collect();
            assert!(before.len() > 1, "{name}");
            let base = before.last().unwrap()[4];
            assert!((base / (-push * size * depth) - 1.0).abs() < 1e-9, "{name}: {base}");
            for row in before {
                let near = |found: f64, exact: f64| (found - exact).abs() < 5e-3;
                assert!(near(row[1], push) && near(row[2], -3e6 + along * (push + 5e6)), "{name}: {row:?}");
                assert!(near(row[3], -1e6 + along * (push + 2e6)), "{name}: {row:?}");
                assert!(row[6] < 1e-14 * row[7], "{name}: {row:?}");
                assert!(plane == "stress" || near(row[5], -1e5 + along * (push + 2e6)), "{name}: {row:?}");
            }
            // The change is in yy.
            let told = one["warnings"].to_string();
            let share = 100.0 * (push + 5e6) / 5e6;
            assert!(share < 5.0 || told.contains(&format!("{share:.3} % in the mean")), "{name}: {share} {told}");
            let share = 100.0 * (push + 2e6).abs() / 2e6;
            assert!(share < 5.0 || told.contains(&format!("{share:.3} % in the mean")), "{name}: {share} {told}");
            assert!(energy(&one, "residual_max_relative") < 1e-5, "{name}: {}", one["energy"]);
            let last = rows.last().unwrap();
            assert!(moving || (last[4] + push * size * depth).abs() > 1e-4 * push.abs() * size * depth, "{name}");
        }
    }
}

/// Layers of 1:10 whose boundary dips by 1 in 4. A jump along it alone stays; else the traction becomes the same on both of its sides.
#[test]
fn layers_that_dip_settle_to_one_traction() {
    let off = [16, 32].map(|cells| ["standard", "smoothed"].map(|formulation| jump_across_a_dip(cells, formulation)));
    for [coarse, fine] in [0, 1].map(|formulation| off.map(|off| off[formulation])) {
        assert!(fine < 0.06 && fine < 0.6 * coarse, "{off:?}");
    }
}

/// Jump of the traction between the rows of elements beside the boundary, over that which is written.
fn jump_across_a_dip(cells: u32, formulation: &str) -> f64 {
    let (size, slope) = (12.0, 0.25);
    let mut mesh = ground(false, cells, size);
    let middle = 0.5 * size;
    for node in &mut mesh.nodes {
        node.y += slope * (node.x - middle) * (1.0 - (node.y - middle).abs() / middle);
    }
    let beside = |element: &[u32; 3]| {
        let at = element.iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / 3.0;
        let over = at.y - middle - slope * (at.x - middle);
        ((at.x - middle).abs() < 0.25 * size && over.abs() < size / f64::from(cells)).then_some(over > 0.0)
    };
    for (tag, name) in [(201, "above"), (202, "below")] {
        let is_own = |element: &&(u32, &[u32; 3])| beside(element.1) == Some(name == "above");
        let triangles = (0..).zip(&mesh.triangles).filter(|own| is_own(&own)).map(|(index, _)| index).collect();
        mesh.groups.push(Group { name: name.into(), dimension: 2, tag, triangles, ..Group::default() });
    }
    let probes = ["above", "below"].map(|group| {
        ["xx", "yy", "xy"].map(|component| {
            format!("[[probes]]\nname = \"{component}_{group}\"\nstress = {{ group = \"{group}\", component = \"{component}\" }}\n")
        })
    });
    let probes = probes.concat().concat();
    // Along the boundary alone: t ⊗ t.
    let [xx, yy, xy] = [1.0, slope * slope, slope].map(|share| -4.0 * share / (1.0 + slope * slope));
    let even = format!("xx = \"{} MPa\", yy = \"{} MPa\", xy = \"{xy} MPa\"", xx - 1.0, yy - 2.0);
    let with = |lower: &str, settles: bool| {
        let held = format!(
            "[in_situ]\nsettle = {settles}\ngroups = [\"x-\", \"x+\", \"y+\"]\nstress = {{ {lower} }}\n\
             layers = [{{ bodies = [\"upper\"], stress = {{ xx = \"-1 MPa\", yy = \"-2 MPa\" }} }}]\n\
             [[supports]]\ngroup = \"y-\"\nfix = \"xy\"\n[solver]\nend = \"2 ms\"\n"
        );
        let text = GROUND
            .replace("fall = ", "# ")
            .replace("size = \"12 m\"", "")
            .replace("200 MPa", "200 GPa")
            .replace("ratio = 1 ", "ratio = 10 ")
            .replace("material = \"", &format!("formulation = \"{formulation}\"\nmaterial = \""));
        let (first, end) = (text.find("[in_situ]").unwrap(), text.find("[[probes]]").unwrap());
        place(&format!("{}{held}{}{probes}", &text[..first], &text[end..]), &mesh)
    };
    let [fixed, settled] = [false, true].map(|settles| run(&with(&even, settles), "one", "1"));
    let [fixed_energy, settled_energy] = [&fixed, &settled].map(|one| energy(one, "elastic"));
    assert!((settled_energy / fixed_energy - 1.0).abs() < 1e-9, "{fixed_energy} {settled_energy}");
    assert!(!settled["warnings"].to_string().contains("shared-stress"), "{}", settled["warnings"]);
    let place = with("xx = \"-5 MPa\", yy = \"-2 MPa\"", true);
    let one = run(&place, "one", "1");
    assert!(energy(&one, "external").abs() < 1e-12 * energy(&one, "elastic"), "{}", one["energy"]);
    let row = history(&place, "one", &["kinetic", "elastic"]).pop().unwrap();
    assert!(row[0] < 1e-14 * row[1], "{row:?}");
    let traction = |group: &str| {
        let [xx, yy, xy] = ["xx", "yy", "xy"].map(|component| last(&one, &format!("{component}_{group}")));
        [xy - slope * xx, yy - slope * xy]
    };
    let [above, below] = ["above", "below"].map(traction);
    f64::hypot(above[0] - below[0], above[1] - below[1]) / (4e6 * slope)
}

#[test]
fn a_strut_with_a_stress_as_written_vibrates_as_one_that_is_pressed() {
    let [far, layers] = both("modes/strut", "modes/strut.msh", "\"strut\"", "{ xx = \"ratio*euler\" }")
        .map(|place| run(&place, "one", "1"));
    for probe in ["f1", "f2", "f3"] {
        let [far, layers] = [last(&far, probe), last(&layers, probe)];
        assert!((layers / far - 1.0).abs() < 1e-6, "{probe}: {layers} {far}");
    }
}

/// Two layers of 1:10 under -5 MPa along both: as rock that was pressed as a whole they share it, as layers both have it. What a hole adds is the same,
/// with elements that turn and without.
#[test]
fn layers_of_unlike_stiffness_have_one_stress_where_it_is_written() {
    let mesh = ground(false, 10, 12.0);
    let (first, end) = (GROUND.find("[in_situ]").unwrap(), GROUND.find("[[supports]]").unwrap());
    let with = |stress: &str| {
        let stress = format!("[in_situ]\n{stress}\ngroups = [\"x+\"]\n");
        place(&format!("{}{stress}{}", &GROUND[..first], &GROUND[end..]).replace("ratio = 1 ", "ratio = 10 "), &mesh)
    };
    let warned = |one: &Value| one["warnings"].to_string().contains("shared-stress");
    let shared = run(&with("stress = { xx = \"-5 MPa\" }"), "one", "1");
    assert!(warned(&shared) && shared["warnings"].to_string().contains("in_situ.layers"), "{}", shared["warnings"]);
    // A layer for some, and the stress of all others.
    let own = with("stress = { xx = \"-5 MPa\" }\nlayers = [{ bodies = [\"upper\"], stress = { xx = \"-5 MPa\" } }]");
    let one = run(&own, "one", "1");
    assert!(!warned(&one), "{}", one["warnings"]);
    for row in history(&own, "one", &["time", "xx_upper", "xx_lower", "top"]).iter().filter(|row| row[0] <= 1.0) {
        assert!(row[1..3].iter().all(|xx| (xx / -5e6 - 1.0).abs() < 1e-9) && row[3].abs() < 1e-12, "{row:?}");
    }
    let moving = |kinematics: &str| {
        let text = std::fs::read_to_string(own.path("case.toml")).unwrap();
        let text = text
            .replace("kind = \"static\", end = \"1 s\", step = \"1 s\"", "kind = \"explicit\", end = \"1 ms\"")
            .replace("kind = \"static\", end = \"2 s\", step = \"0.5 s\"", "kind = \"explicit\", end = \"100 ms\"")
            .replace("excavate", "release = \"50 ms\"\nexcavate")
            .replace("material = \"", &format!("kinematics = \"{kinematics}\"\nmaterial = \""));
        run(&place(&text, &mesh), "one", "1")
    };
    let [small, turning] = ["small", "corotational"].map(moving);
    let [small_top, top] = [&small, &turning].map(|one| last(one, "top"));
    assert!(top.abs() > 1e-4 && (top / small_top - 1.0).abs() < 0.1, "{small_top} {top}");
    for one in [small, turning] {
        assert!(energy(&one, "residual_max_relative") < 1e-5, "{}", one["energy"]);
    }
}

#[test]
fn layers_have_the_same_bits_on_any_threads_and_after_a_resume() {
    let text = written(false, "smoothed")
        .replace("kind = \"static\", end = \"2 s\", step = \"0.5 s\"", "kind = \"explicit\", end = \"1.05 s\"");
    let settling = text.replace("[in_situ]", "[in_situ]\nsettle = true").replacen("-1800 kg", "-2000 kg", 1);
    for (text, threads) in [(text, "7"), (settling, "2")] {
        let place = place(&format!("{text}[output]\ncheckpoint = {{ steps = 8 }}\n"), &ground(false, 10, 12.0));
        let one = run(&place, "one", "1");
        assert!(energy(&one, "kinetic") > 0.0 && energy(&one, "residual_max_relative") < 1e-6, "{}", one["energy"]);
        assert_eq!(one["state_hash"], run(&place, threads, threads)["state_hash"]);
        assert_eq!(one["state_hash"], resumed(&place, threads)["state_hash"]);
        assert_eq!(summary(&place, threads)["energy"], one["energy"]);
    }
}

/// Strength is judged by the stress that is written, of all formulations, and heat adds its own.
#[test]
fn layers_break_and_expand_as_other_solids_do() {
    let mesh = ground(false, 8, 12.0);
    let (first, end) = (GROUND.find("[in_situ]").unwrap(), GROUND.find("[[stages]]").unwrap());
    let held = "[in_situ]\nlayers = [{ bodies = [\"upper\"], stress = { xx = \"1 MPa\" } }, { bodies = [\"lower\", \"core\"], stress = { xx = \"-2 MPa\" } }]\n\
                [[supports]]\ngroup = \"x-\"\nfix = \"x\"\n[[supports]]\ngroup = \"x+\"\nfix = \"x\"\n[[supports]]\ngroup = \"y-\"\nfix = \"y\"\n";
    let stages = GROUND.find("[[probes]]").unwrap();
    let solver = "[solver]\nkind = \"static\"\nend = \"1 s\"\nstep = \"1 s\"\n";
    let text = format!("{}{held}{solver}{}", &GROUND[..first], &GROUND[stages..]);
    assert!(end < stages);
    for (formulation, more) in
        [("smoothed", ""), ("standard", ""), ("standard", "regularisation = \"phase-field\"\nlength = \"3 m\"\n")]
    {
        for (strength, holds) in [("1.01 MPa", true), ("0.99 MPa", false)] {
            let damage = format!(
                "[materials.clay.damage]\ntensile_strength = \"{strength}\"\nfracture_energy = \"100 kJ/m^2\"\n{more}[materials.sand]"
            );
            let text = text
                .replace("[materials.sand]", &damage)
                .replace("material = \"", &format!("formulation = \"{formulation}\"\nmaterial = \""));
            let ended = place(&text, &mesh).fractum(&["run", "case.toml", "--quiet", "-o", "one", "--threads", "1"]);
            assert_eq!(ended.code == Some(0), holds, "{formulation} {more} {strength}: {}", ended.stderr);
            assert!(holds || ended.stderr.contains("1.010 times its strength"), "{}", ended.stderr);
        }
    }
    // Between sides that do not give way along x alone: E α ΔT/(1 - ν) with no strain across the plane.
    let heat = "[heat]\ninitial_temperature = \"300 K\"\n[[heat.conditions]]\nwhere = \"y > -1 m\"\n\
                temperature = { ramp = [[\"0 s\", \"300 K\"], [\"1 s\", \"310 K\"]] }\n[solver]";
    let hot = text.replace("[solver]", heat).replace(
        "poisson_ratio = \"nu\"\n",
        "poisson_ratio = \"nu\"\nthermal = { conductivity = \"2 W/(m K)\", heat_capacity = \"800 J/(kg K)\", expansion = \"1e-5 1/K\" }\n",
    );
    let one = run(&place(&hot, &mesh), "one", "1");
    let added = -200e6 * 1e-5 * 10.0 / (1.0 - 0.2);
    let [upper, lower] = [last(&one, "xx_upper"), last(&one, "xx_lower")];
    assert!((upper - 1e6 - added).abs() < 1.0 && (lower + 2e6 - added).abs() < 1.0, "{upper} {lower} {added}");
}

/// A joint between the layers, at first pressed by the weight above it.
#[test]
fn a_joint_between_layers_bears_what_they_bear() {
    let joint = "[[interfaces]]\nname = \"joint\"\nbetween = [\"upper\", \"lower\"]\nbonded = false\nresidual_friction_angle = \"30 deg\"\n[in_situ]";
    let place = place(&GROUND.replace("[in_situ]", joint), &ground(false, 10, 12.0));
    let one = run(&place, "one", "1");
    let rows = history(&place, "one", &["time", "xx_upper", "yy_upper", "top", "base"]);
    let row = rows.iter().rfind(|row| row[0] <= 1.0).unwrap();
    let near = |found: f64, exact: f64| (found / exact - 1.0).abs() < 1e-3;
    assert!(near(row[1], -0.8 * 54e3) && near(row[2], -54e3) && near(row[4], 2.736e6), "{row:?}");
    assert!(row[3].abs() < 1e-9, "{row:?}");
    assert!(energy(&one, "residual_max_relative") < 1e-5, "{}", one["energy"]);
}

#[test]
fn stress_that_is_out_of_balance_is_told_with_its_place() {
    let mesh = ground(false, 8, 12.0);
    let layer = "bodies = [\"lower\", \"core\"]";
    for (from, to, words) in [
        ("groups = [\"x+\"]", "groups = []", "have the solids settle from that stress (in_situ.settle = true)"),
        ("groups = [\"x+\"]", "groups = []", "a node of \"lower\", the stress as it is written leaves a force of"),
        (
            "(size - y)\", xx",
            "(1.1*size - y)\", xx",
            "on a side that two bodies share both must have the same traction",
        ),
        (
            "gravity = { y = \"-fall\" }",
            "gravity = { y = \"-0.9*fall\" }",
            "expected a stress of this body that grows with its weight, and gravity among the loads; or in_situ.settle = true",
        ),
        (layer, "bodies = [\"lower\"]", "in_situ.layers give no stress to \"core\""),
        (layer, "bodies = [\"lower\", \"cor\"]", "= \"cor\" is no solid body; did you mean \"core\"?"),
        (layer, "bodies = [\"lower\", \"core\", \"core\"]", "= \"core\" is named twice"),
        (layer, "", "in_situ.layers[1].bodies is missing"),
        (
            "yy = \"-1800 kg/m^3*fall*(size - y)\"",
            "yy = \"-1500 Pa*(y/1 m)^2\"",
            "in_situ.layers[0].stress is not linear",
        ),
        ("stress = { yy = \"-1800 kg", "strain = { yy = \"-1800 kg", "in_situ.layers[0].stress is missing"),
    ] {
        let ended = place(&GROUND.replacen(from, to, 1), &mesh).fractum(&["check", "case.toml"]);
        assert!(ended.code == Some(1) && ended.stderr.contains(words), "{to}: {words}: {}", ended.stderr);
    }
    // What comes in later has no stress.
    let fill = "[[bodies]]\nname = \"fill\"\nkind = \"solid\"\ngroup = \"core\"\nmaterial = \"clay\"\n[in_situ]";
    let stage =
        "[[stages]]\nname = \"fill\"\ninstall = [\"fill\"]\nsolver = { kind = \"static\", end = \"3 s\" }\n[[probes]]";
    let filled = GROUND.replace("[in_situ]", fill).replacen("[[probes]]", stage, 1);
    run(&place(&filled, &mesh), "one", "1");
    let ended = place(&filled.replace(layer, "bodies = [\"lower\", \"core\", \"fill\"]"), &mesh)
        .fractum(&["check", "case.toml"]);
    assert!(ended.stderr.contains("= \"fill\" comes in in a later stage, without stress"), "{}", ended.stderr);
}
