//! A rod about an axis that breaks in motion on a rigid floor: the state does not depend on threads, processes and a resume.

use fractum_math::Vec3;
use fractum_mesh::MshFormat;
use fractum_mesh::generate::{Jitter, structured_rectangle};

use crate::common::{Workplace, mesh_bytes, resumed, run};
use crate::ranks::{on_ranks, options};

const ROD: &str = r#"fractum = 1
[mesh]
file = "bar.msh"

[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
tensile_strength = "3 MPa"
fracture_energy = "20 J/m^2"
[materials.concrete.contact]
friction = 0.4
damping_ratio = 0.05

[[bodies]]
name = "rod"
kind = "solid"
group = "body"
material = "concrete"
plane = "axisymmetric"
strength_factor = "if(abs(y - 10 cm) < 3 cm, 0.5, 1.0)"

[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
point = ["0 m", "-0.005 mm", "0 m"]
normal = "y"
contact = { friction = 0.3 }

[[supports]]
group = "y+"
velocity = { y = { ramp = [["0 s", "0 m/s"], ["0.1 ms", "0.4 m/s"]] } }

[[supports]]
where = "y < 5 mm && x > 3 cm"
fix = "y"

[[loads]]
gravity = { y = "-9.81 m/s^2" }

[damping]
bulk_linear = 0.06

[solver]
end = "0.4 ms"

[[probes]]
name = "load"
reaction = { group = "y+", along = "y" }

[output]
fields = { every = "0.1 ms" }
history = { every = "10 us" }
checkpoint = { steps = 1200 }
"#;

fn place() -> Workplace {
    let jitter = Some(Jitter { fraction: 0.15, seed: 4 });
    let mesh = structured_rectangle([14, 60], [0.05, 0.2], jitter);
    assert!(mesh.nodes.contains(&Vec3::zeros()));
    Workplace::with_mesh(ROD, &mesh_bytes(&mesh, MshFormat::V4_1Binary))
}

#[test]
fn an_axisymmetric_run_has_one_state() {
    let place = place();
    let summary = run(&place, "alone", "1");
    let hash = |summary: &serde_json::Value| summary["state_hash"].as_str().unwrap().to_owned();
    assert!(summary["counts"]["removed_elements"].as_u64().unwrap() > 0, "{summary}");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{summary}");
    assert_eq!(hash(&run(&place, "two", "2")), hash(&summary));
    for of_rank in on_ranks(&place, 2, &options(&place, "ranks")) {
        assert_eq!(of_rank.unwrap(), hash(&summary));
    }
    assert_eq!(hash(&resumed(&place, "two")), hash(&summary));
}
