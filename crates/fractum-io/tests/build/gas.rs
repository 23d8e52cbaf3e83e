//! Holes for gas: closed around a volume, or refused with the place where they end.

use std::path::Path;

use fractum_io::build::build_scene;
use fractum_io::case::parse_case;
use fractum_mesh::generate::structured_rectangle;

const CASE: &str = r#"fractum = 1
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
[gas]
heat_ratio = 1.3
gas_constant = "300 J/(kg K)"
[[gas.holes]]
HOLE
pressure = "10 MPa"
temperature = "1000 K"
[solver]
end = "1 us"
"#;

/// What is wrong with a hole in a plate without any.
fn refusal(hole: &str) -> String {
    let mesh = structured_rectangle([4, 4], [0.2, 0.1], None);
    let case = parse_case(&CASE.replace("HOLE", hole), Path::new("case.toml"), &[]).unwrap();
    build_scene(&case, &mesh, Vec::new(), Vec::new()).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_hole_that_is_open_or_encloses_the_solid_is_refused() {
    let open = refusal("group = \"x-\"");
    assert!(open.contains("case.toml:17") && open.contains("\"x-\": is not closed, it ends at (0.0000e0"), "{open}");
    let turned = refusal("where = \"x >= 0 m\"");
    assert!(turned.contains("encloses the solid"), "{turned}");
    let missing = refusal("group = \"hole\"");
    assert!(missing.contains("\"hole\""), "{missing}");
}
