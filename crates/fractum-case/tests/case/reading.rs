//! A case with every key, read into SI.

use fractum_case::measure::Crack;
use fractum_case::model::{
    BodyKind, BondLawKind, BondedShape, InterfaceArea, Interfaces, LoadKind, Motion, PackingSource, ParticleSize,
    ProbeKind, SurfaceSupport,
};
use fractum_case::{Severity, Spanned, TimeFunction, read_case};
use fractum_dem::{Crushing, InterfaceFailure, LocalBond};
use fractum_fem::{Criterion, CriterionKind, Formulation, Softening};
use fractum_math::{Sym3, Vec3};
use fractum_output::expectation::Bound;
use fractum_pack::Convention;
use fractum_scene::CrackMeasure;

use crate::{SMALL, folder, good, parse};

#[test]
fn a_case_with_every_key_is_read_into_si() {
    let case = read_case(&folder().join("every_key.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(case.warnings(), []);
    assert_eq!(case.source.title, "Every key");
    let mesh = case.mesh.as_ref().unwrap();
    assert_eq!(mesh.file.value, folder().join("meshes/block.msh"));
    assert_eq!(mesh.unit.length, 1e-3);
    assert_eq!(mesh.files(), ["meshes/block_1.msh", "meshes/block_2.msh"].map(|file| folder().join(file)));
    assert_eq!(case.source.parameters["E1"], (42e9, "Pa".to_owned()));

    let [concrete, mortar, cement, grout, ..] = &case.materials[..] else { panic!() };
    assert_eq!((concrete.density, concrete.young_modulus, concrete.poisson_ratio), (2400.0, 21e9, 0.2));
    let damage = &concrete.damage.as_ref().unwrap().value;
    let law = &damage.law;
    assert_eq!((law.tensile_strength, law.fracture_energy), (3e6, 100.0));
    let angle = 32.0 * (std::f64::consts::PI / 180.0);
    assert_eq!(law.criterion, Criterion::new(CriterionKind::MohrCoulomb, angle, 10.0, 0.2));
    assert_eq!(law.softening, Softening::Bilinear { stress: 0.25, opening: 2.0 * 0.15 / (0.25 + 0.15) });
    assert_eq!(mortar.damage.as_ref().unwrap().value.regularisation.and_then(|r| r.length), Some(0.02));
    let soft = &mortar.damage.as_ref().unwrap().value.law;
    assert_eq!((mortar.young_modulus, soft.tensile_strength), (14e9, 2e6));
    let angle = 35f64.to_radians();
    assert_eq!(soft.criterion, Criterion::new(soft.criterion.kind(), angle, 10.0, mortar.poisson_ratio));

    let interfaces = cement.interfaces.as_ref().unwrap().value;
    assert_eq!(interfaces.area, InterfaceArea::Porosity);
    let expected = LocalBond {
        tensile_strength: 4.8e6,
        shear_strength: 8.5e6,
        internal_friction: 0.3,
        friction: 0.4,
        softening: [0.5, 0.25],
        failure: InterfaceFailure::Coupled,
        crushing: Crushing { stress: [8.5e6, 9e6, 11e6], ratio: [3.0, 9.0, 24.0] },
        damping_ratio: 0.1,
        ..LocalBond::elastic(3.8e9, 0.2)
    };
    assert_eq!(interfaces.law, expected);
    let expected = Interfaces {
        area: InterfaceArea::Factor(1.0),
        law: LocalBond { friction: 0.5, ..LocalBond::elastic(3.8e9, 0.2) },
    };
    assert_eq!(grout.interfaces.as_ref().unwrap().value, expected);
    let laws = case.bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Bonded(own) => Some(own.law),
        _ => None,
    });
    assert_eq!(laws.filter(|law| *law == BondLawKind::Local).count(), 2);

    let BodyKind::Solid(block) = &case.bodies[0].kind else { panic!() };
    let here = Vec3::new(0.05, -0.07, 0.0);
    assert_eq!((block.formulation, block.material, block.damage), (Formulation::Standard, 0, true));
    assert_eq!(block.initial_velocity[1].as_ref().unwrap().value.at(here), 0.5);
    assert_eq!(block.initial_velocity[2].as_ref().unwrap().value.at(here), -0.5);
    let zone = &block.damage_where.as_ref().unwrap().value;
    assert!(zone.holds_at(here) && !zone.holds_at(Vec3::new(0.0, 0.09, 0.0)) && !zone.holds_at(-here));
    assert!((block.strength_factor.as_ref().unwrap().value.at(Vec3::new(0.025, 0.0, 0.0)) - 1.1).abs() < 1e-15);
    let BodyKind::Solid(joint) = &case.bodies[1].kind else { panic!() };
    assert_eq!((joint.formulation, joint.material), (Formulation::Smoothed, 1), "smoothed where there is damage");

    let value = |motion: &Option<_>, t: f64| match motion.as_ref().map(|m: &Spanned<Motion>| &m.value) {
        Some(Motion::Velocity(f) | Motion::Displacement(f)) => f.value(t, Vec3::zeros()),
        other => panic!("{other:?}"),
    };
    let [bottom, top, side, brick, outer, base] = &case.supports[..] else { panic!() };
    assert_eq!(bottom.motion[0].as_ref().unwrap().value, Motion::Fixed);
    assert_eq!((value(&bottom.motion[1], 0.1e-3), value(&bottom.motion[1], 1.0)), (-0.5e-3, -1e-3));
    assert!((value(&top.motion[0], 1e-3) - 1e-3 / std::f64::consts::E).abs() < 1e-18);
    assert_eq!((value(&top.motion[1], 0.5e-3), value(&top.motion[2], 0.5e-3)), (0.25e-3, 0.5));
    assert_eq!((value(&side.motion[0], 2e-3), value(&side.motion[2], 1.0)), (2e-3, 0.0));

    assert_eq!(brick.fix_rotation.as_ref().unwrap().value, 0b111);
    assert_eq!(outer.surface.as_ref().unwrap().value, SurfaceSupport::Absorbing);
    assert_eq!(base.surface.as_ref().unwrap().value, SurfaceSupport::Elastic { normal: 1e9, tangential: 0.4e9 });
    let stress = case.in_situ.as_ref().unwrap().of("brick").unwrap().at(Vec3::new(0.0, 16.0, 0.0));
    assert_eq!(stress, Sym3::new(-2e6, -0.1e6, -3e6, 0.0, 0.0, 1e3));

    let BodyKind::Bonded(brick) = &case.bodies[3].kind else { panic!() };
    let PackingSource::Shape { shape, size, dispersion, seed, .. } = &brick.packing else { panic!() };
    let (point, edges) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.01, 0.02, 0.01));
    assert_eq!(shape.value, BondedShape::Box { point, size: edges });
    assert_eq!((size.value, *dispersion, *seed), (ParticleSize::Count(500), 0.2, 3));
    assert_eq!((brick.coordination.as_ref().unwrap().value, brick.convention), (8.0, Convention::Interior));
    assert_eq!(concrete.bonds.as_ref().unwrap().value.beams.young_modulus, 300e9);
    let BodyKind::Bonded(rod) = &case.bodies[4].kind else { panic!() };
    assert_eq!((rod.coordination.as_ref().unwrap().value, rod.convention), (7.5, Convention::All));
    let BodyKind::Bonded(old) = &case.bodies[6].kind else { panic!() };
    assert!(matches!(&old.packing, PackingSource::File(file) if file.bytes.starts_with(b"stands")));
    assert_eq!(case.particle_group("rod.x+"), Some((4, Some("x+"))));
    assert_eq!(case.particle_group("rod"), Some((4, None)));
    assert_eq!(case.particle_group("block.x+"), None);

    let LoadKind::Pressure { pressure, .. } = &case.loads[2].kind else { panic!() };
    assert!((pressure.value.value(3e-6, Vec3::zeros()) / 100e6 - 1.0).abs() < 1e-12);
    let fired = |load: usize, t: f64| match &case.loads[load].kind {
        LoadKind::Pressure { on, pressure, .. } => (on.group_name(), pressure.value.value(t, Vec3::zeros())),
        other => panic!("{other:?}"),
    };
    // Delays scatter about 0 and 25 ms, by 0.2 and 0.32 ms.
    let delay = |load: usize| match &case.loads[load].kind {
        LoadKind::Pressure { pressure, .. } => pressure.value.delay().unwrap(),
        other => panic!("{other:?}"),
    };
    assert!((0.0..1e-3).contains(&delay(5)) && delay(6) != 25e-3 && (delay(6) - 25e-3).abs() < 1.6e-3);
    assert_eq!(fired(5, delay(5)), ("hole_1", 300e6));
    assert!((fired(6, delay(6) + 0.25e-3).1 / 50e6 - 1.0).abs() < 1e-9);
    assert_eq!(fired(6, delay(6) - 1e-4), ("hole_2", 0.0));
    let LoadKind::Pressure { detonation: Some(front), .. } = case.loads[6].kind else { panic!() };
    assert_eq!((front.velocity, front.along, front.primer), (4500.0, Some(-Vec3::z()), Some(Vec3::z())));
    let LoadKind::Gravity { acceleration } = &case.loads[4].kind else { panic!() };
    assert_eq!(acceleration[1].as_ref().unwrap().value, TimeFunction::Constant(-9.81));

    assert_eq!(case.damping.mass, 50.0);
    assert_eq!(case.solver.end, 2e-3);
    assert_eq!(case.probes[case.solver.stop_when.as_ref().unwrap().probe].name.value, "load");
    assert_eq!((case.output.history_every, case.output.checkpoint_every), (2e-6, 300.0));

    let units: Vec<_> = case.probes.iter().map(|probe| probe.unit.as_str()).collect();
    let expected = ["N", "m", "m/s", "1", "Pa", "J", "1", "kg m/s", "kg m^2/s", "m^2", "1", "Pa", "J/m^2", "N", "1"];
    let about_an_axis = ["N", "m", "m/s", "Pa"];
    let front_speed = ["m/s"];
    let push_and_gas = ["N", "Pa"];
    let pieces = ["N", "m^3", "m/s", "m"];
    let cracks = ["m^2", "m", "m/s", "1", "1", "m/s"];
    let mode_gauges_heat_moment_liquid_box_and_work = ["1", "1", "Pa", "K", "J", "1", "N m", "m", "Pa", "Pa", "J"];
    let all = [
        &expected[..],
        &about_an_axis,
        &front_speed,
        &push_and_gas,
        &pieces,
        &cracks,
        &mode_gauges_heat_moment_liquid_box_and_work,
    ];
    let all = all.concat();
    assert_eq!(units, all, "N/m is J/m^2");
    assert!(!case.probes[28].is_scalar(), "a slope is a history");
    let ProbeKind::Crack(Crack { measure, along, within, .. }) = &case.probes[10].kind else { panic!() };
    assert_eq!((*measure, *along), (CrackMeasure::Angle, Vec3::y()));
    let within = &within.as_ref().unwrap().value;
    assert!(within.holds_at(Vec3::zeros()) && !within.holds_at(Vec3::x()));
    let ProbeKind::Expression(strength) = &case.probes[11].kind else { panic!() };
    assert!((strength.value(&[314.159_265_358_979_3]) / 1e4 - 1.0).abs() < 1e-12);
    assert!(case.probes[11].is_scalar() && case.probes[13].is_scalar() && !case.probes[0].is_scalar());

    assert_eq!(case.expect[0].bound, Bound::Near { value: 1e4, tolerance: 500.0, relative: Some(0.05) });
    assert_eq!(case.expect[2].bound, Bound::Between { above: Some(1e-4), below: Some(2e-3) });
    assert_eq!(case.groups_used().len(), 4 + 5 + 6 + 1 + 8 + 2 + 3 + 1 + 3 + 5 + 1 + 2);
}

#[test]
fn a_parameter_may_have_the_name_of_a_reduction() {
    let probes = "[[probes]]\nname = \"tip\"\ndisplacement = { group = \"bar\", along = \"x\" }\n\
        [[probes]]\nname = \"rate\"\nexpression = \"slope*slope(tip, 1 us) + mean*mean(tip)/1 s\"\nunit = \"m/s\"\n";
    let case = good(&(format!("{SMALL}[parameters]\nslope = 3.0\nmean = 2.0\n") + probes), &[]);
    let ProbeKind::Expression(rate) = &case.probes[1].kind else { panic!() };
    assert_eq!(rate.value(&[5.0, 7.0]), 3.0 * 5.0 + 2.0 * 7.0);
}

#[test]
fn risky_settings_are_warned_of() {
    let warned = |text: &str| {
        let case = good(text, &[]);
        case.warnings()
            .iter()
            .map(|warning| {
                assert_eq!(warning.severity, Severity::Warning);
                warning.place.as_ref().unwrap().key.clone()
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(warned(SMALL), Vec::<String>::new());
    assert_eq!(warned(&SMALL.replace("1e-3", "1e-3\nsafety = 1.1")), ["solver.safety"]);
    assert_eq!(
        warned(&SMALL.replace("[mesh]", "[materials.idle]\ndensity=1e3\nyoung_modulus=1e9\npoisson_ratio=0\n[mesh]")),
        ["materials.idle"]
    );
    assert_eq!(warned(&format!("{SMALL}[output.fields]\nevery = 1\n")), ["output.fields.every"]);
    let gas = |ratio: f64, constant: &str, pressure: &str, temperature: &str| {
        warned(&format!(
            "{SMALL}[gas]\nheat_ratio = {ratio}\ngas_constant = \"{constant}\"\n[[gas.holes]]\ngroup = \"a\"\npressure = \"{pressure}\"\ntemperature = {temperature}\n"
        ))
    };
    assert_eq!(gas(1.25, "320 J/(kg K)", "80 MPa", "2500"), Vec::<String>::new());
    assert_eq!(gas(1.25, "320 J/(kg K)", "0 MPa", "2500"), Vec::<String>::new());
    let mistaken = ["gas.heat_ratio", "gas.gas_constant", "gas.holes[0].pressure", "gas.holes[0].temperature"];
    assert_eq!(gas(125.0, "8.314 J/(kg K)", "80 Pa", "20"), mistaken);
    let often = |every: &str| format!("{SMALL}[output.checkpoint]\nevery = \"{every}\"\n");
    assert_eq!(warned(&often("25 us")), ["output.checkpoint.every"]);
    let by_steps = parse(&format!("{SMALL}[output.checkpoint]\nsteps = 500\n"), &[]).unwrap();
    assert_eq!((by_steps.output.checkpoint_every, by_steps.output.checkpoint_steps), (600.0, Some(500)));
    assert_eq!(warned(&often("1 min")), Vec::<String>::new());
    let jump = format!("{SMALL}[[supports]]\ngroup = \"a\"\ndisplacement.x = \"1 mm\"\n");
    assert_eq!(warned(&jump), ["supports[0].displacement.x"]);
}

#[test]
fn a_larger_case_has_the_same_stresses_velocities_and_densities() {
    let text = SMALL.replace("poisson_ratio", "contact = { young_modulus = \"2*E\" }\npoisson_ratio")
        + r#"[parameters]
E = "105 GPa"
[[supports]]
group = "end"
displacement = { x = "2 mm*sin(t/1 ms)*x/5 cm", y = 3e-3 }
[[loads]]
group = "end"
force = { x = "if(t > 0.5 ms, 8 kN, 0)" }
[[probes]]
name = "pull"
reaction = { group = "end", along = "x" }
[[probes]]
name = "work"
expression = "max(pull)*1 mm"
[[expect]]
quantity = "work"
value = "5 J"
tolerance = "1 %"
source = "none"
"#;
    let (one, two) = (good(&text, &[]), good(&text, &[("verify.scale", "2.0")]));
    let of = |case: &fractum_case::Case| (case.materials[0].density, case.materials[0].contact_modulus);
    assert_eq!(of(&one), of(&two));
    assert_eq!((two.solver.end, two.mesh.as_ref().unwrap().unit.length), (2e-3, 2.0));
    let moved = |case: &fractum_case::Case, axis: usize, t: f64, x: f64| match &case.supports[0].motion[axis] {
        Some(Spanned { value: Motion::Displacement(function), .. }) => function.value(t, Vec3::new(x, 0.0, 0.0)),
        other => panic!("{other:?}"),
    };
    for axis in 0..2 {
        assert_eq!(moved(&two, axis, 1.4e-3, 0.06), 2.0 * moved(&one, axis, 0.7e-3, 0.03), "{axis}");
    }
    let LoadKind::Force { force, .. } = &two.loads[0].kind else { panic!() };
    assert_eq!(force[0].as_ref().unwrap().value.value(1.1e-3, Vec3::zeros()), 32e3);
    let bound = |case: &fractum_case::Case| case.expect[0].bound;
    let Bound::Near { value, relative, .. } = bound(&two) else { panic!() };
    assert_eq!((value, relative), (40.0, Some(0.01)));
    assert!(parse(&text, &[("verify.scale", "0")]).is_err() && parse(&text, &[("verify.scale", "two")]).is_err());
}

#[test]
fn neighbours_follow_from_the_case() {
    use fractum_case::model::Saying;
    let text = SMALL.replace("poisson_ratio = 0.3", "poisson_ratio = \"nu\"")
        + "[parameters]\nnu = 0.3\n[[expect]]\nquantity = \"counts.nodes\"\nabove = 1\nsource = \"none\"\n\
           [verify]\nholds_for = [\"mesh\", \"finer\"]\nexcepted = [\"poisson_ratio 0.4: too soft\"]\n\
           [[verify.neighbours]]\nname = \"finer\"\nset = [\"mesh.file=fine.msh\"]\n";
    let case = good(&text, &[]);
    let verify = &case.source.verify;
    let names: Vec<String> = verify.neighbours.iter().map(|neighbour| neighbour.name()).collect();
    let expected = [
        "poisson_ratio 0",
        "poisson_ratio 0.1",
        "poisson_ratio 0.4",
        "safety 0.6",
        "safety 0.9",
        "mesh",
        "half",
        "size 1/1024",
        "size 1024",
        "finer",
    ];
    assert_eq!(names, expected);
    assert_eq!(verify.neighbours[0].set, [("nu".to_owned(), "0".to_owned())]);
    let said: Vec<_> = verify.neighbours.iter().map(|neighbour| verify.says(&case.expect[0], neighbour)).collect();
    assert_eq!(
        (said[0], said[2], said[5], said[9]),
        (Saying::Nothing, Saying::Excepted("too soft"), Saying::Holds, Saying::Holds)
    );
    for neighbour in &verify.neighbours {
        let set: Vec<(&str, &str)> = neighbour.set.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        good(&text, &set);
    }
    let wrong = |from: &str, to: &str| parse(&text.replace(from, to), &[]).unwrap_err().to_string();
    assert!(wrong("\"mesh\", ", "\"mash\", ").contains("did you mean \"mesh\"?"));
    assert!(wrong(": too soft", "").contains("has no reason"));
    assert!(wrong("mesh.file=", "mesh.file ").contains("sets nothing"));
}
