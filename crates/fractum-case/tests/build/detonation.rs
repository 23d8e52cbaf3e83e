//! Holes that detonate: fronts along facets and the waves that leave them, charges that burn, stemming that is ejected.

use std::path::Path;

use fractum_case::build::{BuiltScene, build_scene};
use fractum_case::parse_case;
use fractum_math::Vec3;
use fractum_mesh::generate::{plane_mesh, structured_rectangle};
use fractum_scene::{EnergyKind, GasMeasure, Scene};

const BLOCK: &str = r#"fractum = 1
[mesh]
file = "block.msh"
[materials.rock]
density = 2600
young_modulus = "50 GPa"
poisson_ratio = NU
[[bodies]]
name = "block"
kind = "solid"
group = "body"
material = "rock"
formulation = "FORMULATION"
[[loads]]
group = "y-"
pressure = { pulse = "half-sine", peak = "100 MPa", duration = "60 us" }
detonation = { velocity = VELOCITY, along = "x" }
[[supports]]
where = "y > 0.99 m || x < 1 mm || x > 1.99 m"
absorbing = true
[solver]
end = "0.55 ms"
"#;

fn built(case: &str, mesh: &fractum_mesh::Mesh) -> BuiltScene {
    let case = parse_case(case, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    build_scene(&case, mesh, Vec::new(), Vec::new()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// When the speed of each of these places first reaches half of its largest value in the first wave, that is before `end` [s].
fn arrivals(scene: &mut Scene, places: &[Vec3]) -> Vec<f64> {
    let nearest = |place: &Vec3| {
        let away = |n: &usize| (scene.solid.reference[*n] - place).norm();
        (0..scene.solid.reference.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap()
    };
    let nodes: Vec<usize> = places.iter().map(nearest).collect();
    let mut speeds: Vec<Vec<(f64, f64)>> = vec![Vec::new(); nodes.len()];
    while !scene.is_finished() {
        scene.step(true).unwrap();
        for (speeds, &node) in speeds.iter_mut().zip(&nodes) {
            speeds.push((scene.clock.time, scene.solid.velocity[node].norm()));
        }
    }
    let first = |speeds: &Vec<(f64, f64)>| {
        // The first maximum that is a visible part of the largest one.
        let most = speeds.iter().map(|s| s.1).fold(0.0, f64::max);
        let peak = speeds.windows(3).find(|s| s[1].1 > 0.3 * most && s[1].1 >= s[0].1 && s[1].1 > s[2].1).unwrap()[1].1;
        let after = speeds.iter().position(|s| s.1 >= 0.5 * peak).unwrap();
        let [(t0, v0), (t1, v1)] = [speeds[after - 1], speeds[after]];
        t0 + (t1 - t0) * (0.5 * peak - v0) / (v1 - v0)
    };
    speeds.iter().map(first).collect()
}

#[test]
fn waves_leave_a_front_that_outruns_them_on_a_cone_of_mach() {
    let mesh = structured_rectangle([160, 80], [2.0, 1.0], None);
    for (formulation, nu, ratio) in
        [("standard", 0.25, 1.5), ("standard", 0.25, 3.0), ("smoothed", 0.0, 1.5), ("standard", 0.35, 2.0)]
    {
        let wave_speed = (50e9 * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * 2600.0f64)).sqrt();
        let velocity = ratio * wave_speed;
        let case = BLOCK.replace("NU", &nu.to_string()).replace("VELOCITY", &velocity.to_string());
        let mut scene = built(&case.replace("FORMULATION", formulation), &mesh).scene;
        let (along, out) = ([1.0, 1.5], [0.25, 0.5]);
        let places = [(along[0], 0.0), (along[1], 0.0), (along[1], out[0]), (along[1], out[1])];
        let t = arrivals(&mut scene, &places.map(|(x, y)| Vec3::new(x, y, 0.0)));
        let slowness = [(t[1] - t[0]) / (along[1] - along[0]), (t[3] - t[2]) / (out[1] - out[0])];
        let angle = (slowness[0] / slowness[1]).atan().to_degrees();
        let expected = (1.0 / ratio).asin().to_degrees();
        let ledger = scene.ledger();
        println!(
            "{formulation} {nu} {ratio}: front {:.4} of its velocity, angle {angle:.2} of {expected:.2} degrees, residual {:.1e}",
            1.0 / (slowness[0] * velocity),
            ledger.residual_max_relative
        );
        assert!((slowness[0] * velocity - 1.0).abs() < 0.005, "{} m/s of {velocity}", 1.0 / slowness[0]);
        assert!((angle / expected - 1.0).abs() < 0.03, "{angle} of {expected} degrees");
        assert!(ledger.residual_max_relative < 1e-3, "{ledger:?}");
    }
}

#[test]
fn a_facet_is_pushed_from_the_instant_on_at_which_the_front_is_there() {
    let mesh = structured_rectangle([40, 2], [2.0, 0.1], None);
    for (detonation, arrival) in [
        ("along = \"x\"", (|x: f64| x) as fn(f64) -> f64),
        ("along = \"-x\"", |x| 2.0 - x),
        ("along = \"x\", primer = [0.5, 7, 0]", |x| (x - 0.5).abs()),
        ("primer = [0.5, 0, 0]", |x| (x - 0.5).abs()),
        ("primer = [0.5, -0.3, 0]", |x| (x - 0.5).hypot(0.3)),
    ] {
        let (velocity, delay) = (1e5, 2e-6);
        let case = BLOCK.replace("NU", "0").replace("FORMULATION", "standard").replace("along = \"x\"", detonation);
        let case = case.replace("VELOCITY", &velocity.to_string());
        // A pressure that begins with its full value and stays, on a free block.
        let case = case.replace("group = \"y-\"\npressure", "firing = [[\"y-\", \"2 us\", \"step\"]]\n#");
        let (start, end) = (case.find("[[supports]]").unwrap(), case.find("[solver]").unwrap());
        let case =
            format!("{}[pulses]\nstep = \"1 MPa\"\n[solver]\nend = \"15 us\"\nstep = \"0.02 us\"\n", &case[..start]);
        assert!(end > start);
        let mut scene = built(&case, &mesh).scene;
        let begin = |k: u32| delay + arrival(0.05 * (f64::from(k) + 0.5)) / velocity;
        while !scene.is_finished() {
            scene.step(true).unwrap();
            // The force on a facet for the time since the front came by.
            let time = scene.clock.time;
            let impulse: f64 = (0..40).map(|k| 0.05 * 1e6 * (time - begin(k)).max(0.0)).sum();
            let found = scene.momentum_along(&Vec3::y());
            // A step for each of the facets.
            assert!(
                (found - impulse).abs() <= 40.0 * 0.05 * 1e6 * 0.02e-6,
                "{detonation}: {found} of {impulse} Ns at {time}"
            );
        }
        assert!(scene.momentum_along(&Vec3::y()) > 1.0, "{detonation}");
    }
}

const CHARGE: &str = r#"fractum = 1
[mesh]
file = "plate.msh"
[materials.rock]
density = 2600
young_modulus = 60e9
poisson_ratio = 0.25
[[bodies]]
name = "plate"
kind = "solid"
group = "body"
material = "rock"
thickness = "1 m"
[gas]
explosive = "EXPLOSIVE"
[[gas.holes]]
where = "x > 1 mm && x < 399 mm && y > 1 mm && y < 399 mm"
mass = "2 kg"
MORE
[solver]
end = "END"
"#;

#[test]
fn a_charge_burns_behind_its_front_and_stemming_lets_its_gas_out() {
    let whole = structured_rectangle([16, 16], [0.4, 0.4], None);
    let inner = |node: &u32| (whole.nodes[*node as usize] - Vec3::new(0.2, 0.2, 0.0)).amax() < 0.0501;
    let triangles = whole.triangles.iter().filter(|t| !t.iter().all(inner)).copied().collect();
    let mesh = plane_mesh(whole.nodes.clone(), whole.lines.clone(), triangles, Vec::new());
    let run = |explosive: &str, more: &str, end: &str| {
        let case = CHARGE.replace("EXPLOSIVE", explosive).replace("MORE", more).replace("END", end);
        let mut scene = built(&case, &mesh).scene;
        while !scene.is_finished() {
            scene.step(true).unwrap();
        }
        let of = |measure| scene.gas().unwrap().measure(&scene.solid, measure, None);
        let ledger = *scene.ledger();
        assert!(ledger.residual_max_relative < 1e-3, "{more}: {ledger:?}");
        ([GasMeasure::Mass, GasMeasure::LeakedMass].map(of), ledger[EnergyKind::GasSupplied])
    };
    for (explosive, density, energy) in
        [("anfo", 931.0, 2.484e9), ("emulsion", 1310.0, 4.192e9), ("petn-1.77", 1770.0, 10.1e9)]
    {
        let given = 2.0 * energy / density;
        let ([mass, leaked], supplied) = run(explosive, "", "20 us");
        assert!(
            (mass / 2.0 - 1.0).abs() < 1e-9 && leaked == 0.0 && (supplied / given - 1.0).abs() < 1e-9,
            "{explosive}"
        );
        // 1 m at 5 km/s: 200 us after the delay; a quarter of it has burnt at a quarter of the time, less half of the rise.
        let burning = "detonation = { length = \"1 m\", velocity = \"5 km/s\", delay = \"50 us\" }";
        let ([mass, _], supplied) = run(explosive, burning, "100 us");
        // The last step of the solids, 0.013 of the time of burning, is not in it yet.
        assert!((mass / 2.0 - (0.25 - 0.025)).abs() < 0.015, "{explosive}: {mass}");
        assert!((supplied / given - mass / 2.0).abs() < 1e-9, "{explosive}: {supplied}");
        let ([mass, _], supplied) = run(explosive, burning, "300 us");
        assert!((mass / 2.0 - 1.0).abs() < 5e-3 && (supplied / given - 1.0).abs() < 5e-3, "{explosive}: {mass}");
    }
    let stemming = |at: &str| format!("stemming = {{ diameter = \"50 mm\", length = \"1 m\", ejected_at = \"{at}\" }}");
    let ([mass, leaked], _) = run("anfo", &stemming("100 us"), "90 us");
    assert!((mass / 2.0 - 1.0).abs() < 1e-9 && leaked == 0.0);
    let ([mass, leaked], _) = run("anfo", &stemming("100 us"), "200 us");
    assert!(leaked > 0.01 && ((mass + leaked) / 2.0 - 1.0).abs() < 1e-9, "{mass} {leaked}");
    let ([_, later], _) = run("anfo", &stemming("150 us"), "200 us");
    assert!(later > 0.0 && later < leaked, "{later} {leaked}");
}
