//! Heat on the parts of a body.

use std::path::Path;

use fractum_case::build::{build_scene, cut_mesh};
use fractum_case::parse_case;
use fractum_math::Vec3;
use fractum_mesh::Group;
use fractum_mesh::generate::structured_box;
use fractum_scene::HeatMeasure;
use fractum_scene::statics::Control;

use crate::build;

const HEATED: &str = r#"fractum = 1
[mesh]
file = "mesh.msh"
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[materials.steel.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"
[[bodies]]
name = "body"
kind = "solid"
group = "body"
material = "steel"
[heat]
initial_temperature = "300 K"
[solver]
kind = "heat"
end = "1 s"
"#;

/// Heat that a source of 1 MW/m³ has brought after a step, over the step [W], in a box of 0.4 m by 0.1 m by 0.1 m.
fn power(on: &str) -> f64 {
    let mut mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.1, 0.1), None);
    let middle = |nodes: &[u32; 4]| nodes.iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() / 4.0;
    let left = (0..).zip(&mesh.tetrahedra).filter(|(_, nodes)| middle(nodes) < 0.1).map(|(element, _)| element);
    let tetrahedra: Vec<u32> = left.collect();
    mesh.groups.push(Group { name: "left".into(), dimension: 3, tag: 2, tetrahedra, ..Group::default() });
    let case = format!("{HEATED}[[heat.conditions]]\n{on}\nsource = \"1 MW/m^3\"\n");
    let mut scene = build(&case, &mesh).scene;
    scene.conduct_alone().unwrap();
    let heat = scene.heat().unwrap();
    heat.measure(HeatMeasure::Supplied) / scene.clock.time
}

#[test]
fn a_source_heats_the_volume_of_its_elements_and_no_other() {
    for (on, volume) in [
        ("group = \"body\"", 0.4 * 0.1 * 0.1),
        ("group = \"left\"", 0.1 * 0.1 * 0.1),
        ("where = \"x < 100 mm\"", 0.1 * 0.1 * 0.1),
        ("group = \"left\"\nwhere = \"x < 50 mm\"", 0.05 * 0.1 * 0.1),
    ] {
        assert!((power(on) / (1e6 * volume) - 1.0).abs() < 1e-12, "{on}: {} W", power(on));
    }
}

const INTERFACE: &str = r#"
[[interfaces]]
between = ["left", "right"]
tensile_strength = "2 MPa"
fracture_energy = "50 J/m^2"
heat_transfer = "100 W/(m^2 K)"
[[supports]]
where = "x < 1 mm"
fix = "xyz"
"#;

/// Control of a bar in two parts that a bond joins, or what is wrong with it.
fn bar_of_two_parts(case: &str) -> Result<Option<Control>, String> {
    let mut mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.1, 0.1), None);
    let middle = |nodes: &[u32; 4]| nodes.iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() / 4.0;
    for (tag, name, is_left) in [(2, "left", true), (3, "right", false)] {
        let own = (0u32..).zip(&mesh.tetrahedra).filter(|(_, nodes)| (middle(nodes) < 0.1) == is_left);
        let tetrahedra = own.map(|(element, _)| element).collect();
        let group = Group { name: name.into(), dimension: 3, tag, tetrahedra, ..Group::default() };
        mesh.groups.push(group);
    }
    let case = parse_case(case, Path::new("case.toml"), &[]).map_err(|error| error.to_string())?;
    cut_mesh(&case, &mut mesh).unwrap();
    let built = build_scene(&case, &mesh, Vec::new(), Vec::new()).map_err(|error| error.to_string())?;
    Ok(built.statics.map(|statics| statics.control))
}

/// Heat does not flow back along a path.
#[test]
fn heat_beside_a_bond_flows_in_time() {
    let case = HEATED.replace("\"heat\"", "\"static\"") + INTERFACE;
    assert_eq!(bar_of_two_parts(&case), Ok(Some(Control::Time)));
    let cold = case.replace("[heat]\ninitial_temperature = \"300 K\"\n", "");
    let told = bar_of_two_parts(&cold).unwrap_err();
    assert!(told.contains("without [heat]") && told.contains("no heat_transfer"), "{told}");
    let cold = cold.replace("heat_transfer = \"100 W/(m^2 K)\"\n", "");
    assert_eq!(bar_of_two_parts(&cold), Ok(Some(Control::TimeThenPath)));
}

/// Heat that goes 3.6 mm deep in a second, on elements of 50 mm, was told to be taken up at a third of what it is, without a word.
#[test]
fn fronts_thinner_than_elements_and_few_long_steps_are_told() {
    let mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.1, 0.1), None);
    let told = |condition: &str, end: &str, heat: &str| {
        let case = HEATED.replace("\"1 s\"", end).replace("[solver]", &format!("{heat}\n[solver]"));
        let case = format!("{case}[[heat.conditions]]\n{condition}\n");
        build(&case, &mesh).warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    for condition in ["temperature = \"400 K\"", "flux = \"1 kW/m^2\"", "power = \"1 W\"", CONVECTION] {
        let on = format!("group = \"x-\"\n{condition}");
        let short = told(&on, "\"1 s\"", "");
        let [one] = short.as_slice() else { panic!("{condition}: {short:?}") };
        assert!(
            one.contains("3.581 mm deep") && one.contains("50 mm thick") && one.ends_with("[coarse-mesh]"),
            "{one}"
        );
        // It has gone 0.11 m deep then, through more than two elements.
        assert_eq!(told(&on, "\"1000 s\"", ""), [""; 0], "{condition}");
    }
    // What changes nothing has no front, nor has what heats a body as a whole.
    for quiet in [
        "group = \"x-\"\ntemperature = \"300 K\"",
        "group = \"x-\"\nflux = \"0 W/m^2\"",
        "group = \"body\"\npower = \"1 W\"",
        "group = \"body\"\ntemperature = \"400 K\"",
        "group = \"body\"\nsource = \"1 MW/m^3\"",
    ] {
        assert_eq!(told(quiet, "\"1 s\"", ""), [""; 0], "{quiet}");
    }
    let steps = |step: &str, end: &str| {
        let heat = format!("scheme = \"implicit\"\nstep = \"{step}\"");
        told("group = \"x-\"\nflux = \"1 kW/m^2\"", end, &heat)
    };
    let [few] = steps("250 s", "\"1000 s\"").try_into().unwrap();
    assert!(
        few.contains("4 steps in the run") && few.contains("at most 100 s") && few.ends_with("[time-step]"),
        "{few}"
    );
    assert_eq!(steps("100 s", "\"1000 s\""), [""; 0]);
    // Its end does not depend on how it came there.
    assert_eq!(steps("25000 s", "\"100000 s\""), [""; 0]);
}

const CONVECTION: &str = "convection = { coefficient = \"50 W/(m^2 K)\", ambient = \"400 K\" }";
