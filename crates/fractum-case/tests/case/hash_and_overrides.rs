//! `--set`, and the identity of a case.

use fractum_case::model::BodyKind;
use fractum_case::read_case;
use fractum_fem::{CriterionKind, Formulation};

use crate::{SMALL, every_key, folder, good, parse};

#[test]
fn overrides_set_parameters_and_keys() {
    let text = every_key();
    assert_eq!(good(&text, &[("E0", "30 GPa")]).materials[0].young_modulus, 30e9);
    assert_eq!(good(&text, &[("parameters.E0", "3e10")]).materials[0].young_modulus, 30e9);
    assert_eq!(good(&text, &[("solver.end", "5 ms")]).solver.end, 5e-3);
    assert_eq!(good(&text, &[("mesh.file", "fine.msh")]).mesh.unwrap().file.value, folder().join("fine.msh"));
    let standard = good(&text, &[("bodies[1].formulation", "standard")]);
    assert!(matches!(&standard.bodies[1].kind, BodyKind::Solid(solid) if solid.formulation == Formulation::Standard));
    let without_strength = text.replace("compressive_strength = \"30 MPa\"", "");
    let pure = good(&without_strength, &[("materials.concrete.damage.tension_cutoff", "false")]);
    assert_eq!(pure.materials[0].damage.as_ref().unwrap().value.law.criterion.kind(), CriterionKind::PureMohrCoulomb);
    assert_eq!(pure.warnings().len(), 2);

    for (name, value, expected) in [
        ("E", "1", "--set: E is not a parameter of this case; did you mean E0?"),
        ("solver.ende", "1", "--set: solver.ende is not a key; did you mean end?"),
        ("solver.end", "1 mm", "--set: solver.end = 1 mm, which is a length; expected a time such as \"0.2 ms\""),
        ("bodies[30].damage", "false", "--set: bodies[30].damage cannot be set; the case has 26 of these"),
        ("parameters.new", "1", "parameters here: size, E0, E1, nu"),
        ("nu", "0.6", "= \"nu\"; expected between -1 and 0.5"),
    ] {
        let errors = parse(&text, &[(name, value)]).expect_err(name);
        assert!(errors.0.iter().any(|error| error.to_string().ends_with(expected)), "{name}: {errors}");
    }
    let unused = SMALL.replace("[mesh]", "[parameters]\nidle = 1\n[mesh]");
    assert_eq!(good(&unused, &[]).warnings().len(), 1);
    assert!(parse(&unused, &[("idle", "2")]).unwrap_err().to_string().contains("idle is not used anywhere"));
}

#[test]
fn what_is_switched_off_may_keep_its_settings() {
    let text = every_key();
    let notices = |text: &str, overrides: &[(&str, &str)]| -> Vec<String> {
        good(text, overrides).warnings().iter().map(|warning| warning.to_string()).collect()
    };
    let found = notices(&text, &[("bodies[0].damage", "false")]);
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found.iter().all(|found| found.contains("warning: bodies[0].")
        && found.ends_with("has no effect while damage = false [no-effect]")));
    let elastic = text.replacen("\ndamage = true\n", "\ndamage = false\n", 1);
    assert_eq!(notices(&elastic, &[]).len(), 2, "the file itself may say so");
    let pure = notices(&text, &[("materials.concrete.damage.tension_cutoff", "false")]);
    assert_eq!(pure.len(), 3, "{pure:#?}");
    let rankine = notices(&text, &[("materials.concrete.damage.criterion", "rankine")]);
    assert_eq!(rankine.len(), 4, "{rankine:#?}");
    // What the command line itself says must have an effect.
    let set = [("materials.mortar.damage.friction_angle", "0.3")];
    assert!(
        parse(&text, &set)
            .unwrap_err()
            .to_string()
            .contains("friction_angle has no effect with this criterion; remove it")
    );
}

#[test]
fn the_hash_follows_the_content() {
    let text = every_key();
    let case = good(&text, &[]);
    let elsewhere = tempfile::tempdir().unwrap();
    let path = elsewhere.path().join("moved.toml");
    std::fs::write(&path, &text).unwrap();
    for file in ["motion.csv", "part.stl", "old.fpk", "settled.xyz"] {
        std::fs::copy(folder().join(file), elsewhere.path().join(file)).unwrap();
    }
    assert_eq!(read_case(&path, &[]).unwrap().hash(), case.hash(), "the path plays no part");
    std::fs::write(elsewhere.path().join("motion.csv"), "0 0\n1 2\n").unwrap();
    assert_ne!(read_case(&path, &[]).unwrap().hash(), case.hash(), "the tables do");
    assert_ne!(good(&text, &[("E0", "30 GPa")]).hash(), case.hash(), "so do the overrides");
    assert_ne!(good(&text.replace("# Every", "# every"), &[]).hash(), case.hash(), "and the text");
}
