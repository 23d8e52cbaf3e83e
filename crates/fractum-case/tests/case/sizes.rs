//! Wrong sizes of loose particles.

use crate::mistakes::mistakes;

const GRADED: &str = r#"fractum = 1
[materials.glass]
density = 2500
young_modulus = 7e7
poisson_ratio = 0.2
[[bodies]]
name = "gravel"
kind = "particles"
material = "glass"
shape = "box"
size = [3, 1, 1]
sizes = { passing = [[0.1, 0], [0.2, "40 %"], [0.4, 1]] }
solid_fraction = 0.2
[solver]
end = 1e-3
"#;

#[test]
fn each_mistake_about_sizes_has_one_clear_message() {
    assert!(crate::parse(GRADED, &[]).is_ok());
    let cases: &[(&str, &str, &str)] = &[
        (
            "[0.1, 0]",
            "[0, 0]",
            "12:23: bodies[0].sizes.passing[0][0] = 0; expected a diameter above 0 and above that of the pair before it",
        ),
        (
            "[0.1, 0]",
            "[0.1, 0.1]",
            "12:28: bodies[0].sizes.passing[0][1] = 0.1; expected 0: nothing passes the smallest sieve",
        ),
        (
            "[0.2, \"40 %\"]",
            "[0.2, \"140 %\"]",
            "12:38: bodies[0].sizes.passing[1][1] = \"140 %\"; expected a share of the mass up to 1, not below that of the pair before it",
        ),
        (
            "[0.4, 1]",
            "[0.4, 0.9]",
            "12:21: bodies[0].sizes.passing = [[0.1, 0], [0.2, \"40 %\"], [0.4, 0.9]]; expected pairs that end with a share of 1: all passes the largest sieve",
        ),
        (
            "passing = [[0.1, 0], [0.2, \"40 %\"], [0.4, 1]]",
            "law = \"uniform\", smallest = 0.2, largest = 0.1",
            "12:54: bodies[0].sizes.largest is not above smallest; expected a diameter above smallest; without sizes all particles have one radius",
        ),
        (
            "[0.1, 0]",
            "[0.001, 0]",
            "12:9: bodies[0].sizes asks for diameters of which the largest is 400 times the smallest; expected at most 100 times; cut the fines off: they decide the number of particles and the time step",
        ),
        (
            "solid_fraction = 0.2",
            "solid_fraction = 0.95",
            "13:18: bodies[0].solid_fraction = 0.95; expected above 0 and at most 0.9",
        ),
        (
            "solid_fraction = 0.2",
            "particle_radius = 0.1",
            "13:1: bodies[0].particle_radius has no effect beside sizes; remove it",
        ),
    ];
    for (from, to, expected) in cases {
        let found = mistakes(&GRADED.replacen(from, to, 1));
        assert_eq!(found, [*expected], "{to}");
    }
}
