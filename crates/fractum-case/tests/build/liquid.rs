//! Holes for liquid: closed around a volume, or refused with the place and the remedy.

use std::path::Path;

use fractum_case::build::build_scene;
use fractum_case::parse_case;
use fractum_mesh::generate::{plane_mesh, structured_rectangle};

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
[liquid]
viscosity = "1 mPa s"
[liquid.symmetry]
SYMMETRY
[[liquid.holes]]
HOLE
[solver]
kind = "static"
end = "1 s"
step = "1 s"
[[supports]]
where = "x < 1 um"
fix = "x"
[[supports]]
where = "y < 1 um"
fix = "y"
[[probes]]
name = "in_hole"
liquid = "hole_pressure"
PROBE
"#;
/// The corner of the plate as a quarter of a hole.
const CORNER: &str = "where = \"x <= 50 mm && y <= 25 mm\"\nrate = \"1e-9 m^3/s\"";
const PLANES: &str = "x = 0\ny = 0";

/// What is wrong with a hole in a plate that lacks the cell in its corner.
fn build(hole: &str, symmetry: &str, probe: &str) -> Result<(), String> {
    let whole = structured_rectangle([4, 4], [0.2, 0.1], None);
    let in_corner = |node: &u32| whole.nodes[*node as usize].x <= 0.0501 && whole.nodes[*node as usize].y <= 0.0251;
    let triangles = whole.triangles.iter().filter(|t| !t.iter().all(in_corner)).copied().collect();
    let side = whole.groups.iter().find(|group| group.name == "x+").cloned();
    let mesh = plane_mesh(whole.nodes.clone(), whole.lines.clone(), triangles, side.into_iter().collect());
    let case = CASE.replace("HOLE", hole).replace("SYMMETRY", symmetry).replace("PROBE", probe);
    let case = parse_case(&case, Path::new("case.toml"), &[]).map_err(|error| error.to_string())?;
    build_scene(&case, &mesh, Vec::new(), Vec::new()).map(|_| ()).map_err(|error| error.to_string())
}

#[test]
fn a_hole_for_liquid_is_closed_and_fed() {
    assert_eq!(build(CORNER, PLANES, ""), Ok(()));
    for (hole, symmetry, probe, says) in [
        (CORNER, "x = 0", "", "is not closed, it ends at (5.0000e-2, 0.0000e0"),
        (CORNER, "x = 0", "", "liquid.symmetry"),
        (CORNER, PLANES, "hole = \"other\"", "the group of one of liquid.holes"),
        (CORNER, PLANES, "hole = \"where\"", "the group of one of liquid.holes"),
        ("group = \"x+\"\nrate = \"1e-9 m^3/s\"", PLANES, "", "\"x+\": is not closed"),
        ("where = \"x >= 0 m\"\nrate = \"1e-9 m^3/s\"", PLANES, "", "encloses the solid"),
        ("where = \"x > 5 m\"\nrate = \"1e-9 m^3/s\"", PLANES, "", "holds for no facet"),
        ("where = \"x <= 50 mm && y <= 25 mm\"", PLANES, "", "at least one [[liquid.injections]]"),
        ("rate = \"1e-9 m^3/s\"", PLANES, "", "group"),
        (&format!("{CORNER}\npressure = \"1 MPa\""), PLANES, "", "exactly one of rate, pressure"),
        (&format!("{CORNER}\nstemmed = true"), PLANES, "", "stemmed in the plane"),
        (&format!("{CORNER}\n[[liquid.holes]]\n{CORNER}"), PLANES, "", "shares facets with the hole before it"),
        (
            &format!("{CORNER}\n[[liquid.injections]]\ngroup = \"x+\"\nrate = \"1 m^3/s\""),
            PLANES,
            "",
            "none of its nodes is on an interface",
        ),
    ] {
        let error = build(hole, symmetry, probe).unwrap_err();
        assert!(error.contains("case.toml:") && error.contains(says), "{hole} {symmetry} {probe}: {error}");
    }
}
