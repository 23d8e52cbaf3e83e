//! Holes for gas: closed around a volume, or refused with the place where they end.

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
[gas]
heat_ratio = 1.3
gas_constant = "300 J/(kg K)"
[[gas.holes]]
HOLE
pressure = "10 MPa"
temperature = "1000 K"
[gas.symmetry]
SYMMETRY
[solver]
end = "1 us"
SUPPORTS
"#;
/// The corner of the plate as a quarter of a hole.
const CORNER: &str = "where = \"x <= 50 mm && y <= 25 mm\"";
const HELD: &str = "[[supports]]\nwhere = \"x < 1 um\"\nfix = \"x\"\n[[supports]]\nwhere = \"y < 1 um\"\nfix = \"y\"";

/// What is wrong with a hole in a plate that lacks the cell in its corner.
fn build(hole: &str, symmetry: &str, supports: &str) -> Result<(), String> {
    let whole = structured_rectangle([4, 4], [0.2, 0.1], None);
    let in_corner = |node: &u32| whole.nodes[*node as usize].x <= 0.0501 && whole.nodes[*node as usize].y <= 0.0251;
    let triangles = whole.triangles.iter().filter(|t| !t.iter().all(in_corner)).copied().collect();
    let side = whole.groups.iter().find(|group| group.name == "x+").cloned();
    let mesh = plane_mesh(whole.nodes.clone(), whole.lines.clone(), triangles, side.into_iter().collect());
    let case = CASE.replace("HOLE", hole).replace("SYMMETRY", symmetry).replace("SUPPORTS", supports);
    let case = parse_case(&case, Path::new("case.toml"), &[]).map_err(|error| error.to_string())?;
    build_scene(&case, &mesh, Vec::new(), Vec::new()).map(|_| ()).map_err(|error| error.to_string())
}

#[test]
fn a_hole_that_is_open_or_encloses_the_solid_is_refused() {
    let refusal = |hole: &str| build(hole, "", "").unwrap_err();
    let open = refusal("group = \"x+\"");
    assert!(open.contains("case.toml:17") && open.contains("\"x+\": is not closed, it ends at (2.0000e-1"), "{open}");
    let turned = refusal("where = \"x >= 0 m\"");
    assert!(turned.contains("encloses the solid"), "{turned}");
    let missing = refusal("group = \"hole\"");
    assert!(missing.contains("\"hole\""), "{missing}");
}

#[test]
fn a_hole_ends_at_planes_of_symmetry_where_the_solid_is_held() {
    assert_eq!(build(CORNER, "x = 0\ny = 0", HELD), Ok(()));
    let open = build(CORNER, "x = 0", HELD).unwrap_err();
    assert!(open.contains("is not closed, it ends at (5.0000e-2, 0.0000e0") && open.contains("gas.symmetry"), "{open}");
    let free = build(CORNER, "x = 0\ny = 0", "").unwrap_err();
    assert!(free.contains("gas.symmetry.x") && free.contains("fix = \"x\""), "{free}");
}

#[test]
fn crushed_rock_bears_pressure_in_blasts_but_for_rankine_or_where_the_case_says_otherwise() {
    let unilateral = |criterion: &str, load: &str, more: &str| {
        let damage = format!(
            "[materials.rock.damage]\ncriterion = \"{criterion}\"\ntensile_strength = 5e6\nfracture_energy = 100\n{more}\n"
        );
        let start = CASE.find("[gas]").unwrap();
        let case = format!("{}{load}[solver]\nend = \"1 us\"\n", &CASE[..start])
            .replace("[[bodies]]", &(damage + "[[bodies]]"));
        let mesh = structured_rectangle([4, 4], [0.2, 0.1], None);
        let case = parse_case(&case, Path::new("case.toml"), &[]).unwrap();
        let scene = build_scene(&case, &mesh, Vec::new(), Vec::new()).unwrap().scene;
        scene.solid.body(0).damage.as_ref().unwrap().law.unilateral
    };
    let pulse = "[[loads]]\ngroup = \"x-\"\npressure = { pulse = \"half-sine\", peak = 1e6, duration = 1e-3 }\n";
    assert!(unilateral("mohr-coulomb", pulse, ""));
    assert!(!unilateral("mohr-coulomb", pulse, "unilateral = false"));
    assert!(!unilateral("rankine", pulse, ""));
    assert!(!unilateral("mohr-coulomb", "[[loads]]\ngroup = \"x-\"\npressure = 1e6\n", ""));
    assert!(unilateral("rankine", "", "unilateral = true"));
}
