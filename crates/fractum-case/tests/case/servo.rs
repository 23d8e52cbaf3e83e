//! Wrong keys of rigid bodies that press with a given force.

use crate::mistakes::mistakes;

const PRESSED: &str = r#"fractum = 1
[materials.glass]
density = 2500
young_modulus = 7e7
poisson_ratio = 0.2
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
shape = "box"
size = [3, 1, 1]
particle_radius = 0.1
[[bodies]]
name = "lid"
kind = "rigid"
shape = "plane"
normal = "-z"
[bodies.servo]
pressure = 100
area = 3
speed = 0.1
[solver]
end = 1e-3
"#;

#[test]
fn each_mistake_about_a_servo_has_one_clear_message() {
    assert!(crate::parse(PRESSED, &[]).is_ok());
    let cases: &[(&str, &str, &str)] = &[
        (
            "area = 3",
            "",
            "18:1: bodies[1].servo has neither area nor between; expected the area that the pressure acts on, or the planes that enclose it; boxes and cylinders along the direction have an area of their own",
        ),
        ("pressure = 100", "force = 100", "20:1: bodies[1].servo.area has no effect with a force; remove it"),
        ("speed = 0.1", "", "18:1: bodies[1].servo.speed is missing; expected a velocity such as \"5 mm/s\""),
        ("speed = 0.1", "speed = 0", "21:9: bodies[1].servo.speed = 0; expected more than 0"),
        (
            "speed = 0.1",
            "speed = 0.1\nslows_at = 1.5",
            "22:12: bodies[1].servo.slows_at = 1.5; expected above 0 and at most 1",
        ),
        (
            "normal = \"-z\"",
            "normal = [0, 1, 1]",
            "18:1: bodies[1].servo.along is not along an axis; expected x, y or z, or the opposite of one; turn the scene",
        ),
        (
            "normal = \"-z\"",
            "normal = \"-z\"\nfree = \"z\"\nmass = 1",
            "18:8: bodies[1].free is along the axis of servo; expected another axis, or no servo",
        ),
        (
            "area = 3",
            "between = [\"a\", \"b\"]",
            "20:11: bodies[1].servo.between is not four planes; expected four rigid planes, each before the one opposite to it",
        ),
    ];
    for (from, to, expected) in cases {
        let found = mistakes(&PRESSED.replacen(from, to, 1));
        assert_eq!(found, [*expected], "{to}");
    }
}
