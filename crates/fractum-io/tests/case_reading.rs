//! Case files read through the public interface: the good ones, and the wrong ones.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use fractum_io::case::model::{BodyKind, Bound, Criterion, Formulation, LoadKind, Motion, ProbeKind, Softening};
use fractum_io::case::{Case, Diagnostics, KeyKind, Severity, TimeFunction, keys, parse_case, read_case};
use fractum_math::Vec3;
use proptest::prelude::*;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/case")
}

fn every_key() -> String {
    std::fs::read_to_string(folder().join("every_key.toml")).unwrap()
}

fn parse(text: &str, overrides: &[(&str, &str)]) -> Result<Case, Diagnostics> {
    let overrides: Vec<_> = overrides.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    parse_case(text, &folder().join("case.toml"), &overrides)
}

fn good(text: &str, overrides: &[(&str, &str)]) -> Case {
    parse(text, overrides).unwrap_or_else(|errors| panic!("{errors}"))
}

const SMALL: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[[bodies]]
name = "bar"
kind = "solid"
group = "bar"
material = "steel"
[solver]
end = 1e-3
"#;

/// Everything wrong with `text`, each without the name of the file.
fn mistakes(text: &str) -> Vec<String> {
    let errors = parse(text, &[]).expect_err(text);
    let file = format!("{}:", folder().join("case.toml").display());
    errors.0.iter().map(|error| error.to_string().replacen(&file, "", 1)).collect()
}

#[test]
fn a_case_with_every_key_is_read_into_si() {
    let case = read_case(&folder().join("every_key.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(case.warnings(), []);
    assert_eq!(case.title, "Every key");
    assert_eq!(case.mesh.file.value, folder().join("meshes/block.msh"));
    assert_eq!(case.mesh.unit, 1e-3);
    assert_eq!(case.parameters["E1"], 42e9);

    let [concrete, mortar] = &case.materials[..] else { panic!() };
    assert_eq!((concrete.density, concrete.young_modulus, concrete.poisson_ratio), (2400.0, 21e9, 0.2));
    let damage = &concrete.damage.as_ref().unwrap().value;
    assert_eq!(
        (damage.criterion, damage.tensile_strength, damage.fracture_energy),
        (Criterion::MohrCoulomb, 3e6, 100.0)
    );
    assert_eq!(damage.friction_angle, 32.0 * (std::f64::consts::PI / 180.0));
    assert_eq!(damage.softening, Softening::Bilinear { kink_stress: 0.25, kink_opening: 0.15 });
    let soft = &mortar.damage.as_ref().unwrap().value;
    assert_eq!((mortar.young_modulus, soft.compressive_strength), (14e9, 20e6));
    assert_eq!(soft.friction_angle, 35f64.to_radians());

    let BodyKind::Solid(block) = &case.bodies[0].kind else { panic!() };
    let here = Vec3::new(0.05, -0.07, 0.0);
    assert_eq!((block.formulation, block.material, block.damage), (Formulation::Standard, 0, true));
    assert_eq!(block.initial_velocity[1].as_ref().unwrap().at(here), 0.5);
    assert_eq!(block.initial_velocity[2].as_ref().unwrap().at(here), -0.5);
    let zone = &block.damage_where.as_ref().unwrap().value;
    assert!(zone.holds_at(here) && !zone.holds_at(Vec3::new(0.0, 0.09, 0.0)) && !zone.holds_at(-here));
    assert!((block.strength_factor.as_ref().unwrap().value.at(Vec3::new(0.025, 0.0, 0.0)) - 1.1).abs() < 1e-15);
    let BodyKind::Solid(joint) = &case.bodies[1].kind else { panic!() };
    assert_eq!((joint.formulation, joint.material), (Formulation::Smoothed, 1), "smoothed where there is damage");

    let value = |motion: &Option<_>, t: f64| match motion.as_ref().map(|m: &fractum_io::case::Spanned<Motion>| &m.value)
    {
        Some(Motion::Velocity(f) | Motion::Displacement(f)) => f.value(t, Vec3::zeros()),
        other => panic!("{other:?}"),
    };
    let [bottom, top, side] = &case.supports[..] else { panic!() };
    assert_eq!(bottom.motion[0].as_ref().unwrap().value, Motion::Fixed);
    assert_eq!((value(&bottom.motion[1], 0.1e-3), value(&bottom.motion[1], 1.0)), (-0.5e-3, -1e-3));
    assert!((value(&top.motion[0], 1e-3) - 1e-3 / std::f64::consts::E).abs() < 1e-18);
    assert_eq!((value(&top.motion[1], 0.5e-3), value(&top.motion[2], 0.5e-3)), (0.25e-3, 0.5));
    assert_eq!((value(&side.motion[0], 2e-3), value(&side.motion[2], 1.0)), (2e-3, 0.0));

    let LoadKind::Pressure { pressure, .. } = &case.loads[2].kind else { panic!() };
    assert!((pressure.value(3e-6, Vec3::zeros()) / 100e6 - 1.0).abs() < 1e-12);
    let LoadKind::Gravity { acceleration } = &case.loads[4].kind else { panic!() };
    assert_eq!(acceleration[1], Some(TimeFunction::Constant(-9.81)));

    assert_eq!(case.damping.mass, 50.0);
    assert_eq!((case.solver.end, case.solver.stop_when.as_ref().unwrap().probe), (2e-3, 0));
    assert_eq!((case.output.history_every, case.output.checkpoint_every), (2e-6, 300.0));

    let units: Vec<_> = case.probes.iter().map(|probe| probe.unit.as_str()).collect();
    assert_eq!(
        units,
        [
            "N",
            "m",
            "m/s",
            "Pa",
            "J",
            "1",
            "kg m/s",
            "kg m^2/s",
            "m^2",
            "Pa",
            "kg s^-2".to_string().replace("kg s^-2", "J/m^2").as_str(),
            "N"
        ]
    );
    let ProbeKind::Expression(strength) = &case.probes[9].kind else { panic!() };
    assert!((strength.value(&[314.159_265_358_979_3]) / 1e4 - 1.0).abs() < 1e-12);
    assert!(case.probes[9].is_scalar() && case.probes[11].is_scalar() && !case.probes[0].is_scalar());

    assert_eq!(case.expect[0].bound, Bound::Near { value: 1e4, tolerance: 500.0, relative: Some(0.05) });
    assert_eq!(case.expect[2].bound, Bound::Between { above: Some(1e-4), below: Some(2e-3) });
    assert_eq!(case.groups_used().len(), 2 + 3 + 4 + 4);
}

/// Paths of the keys in a document, as in the list of keys.
fn paths(value: &toml::Value, path: &str, found: &mut BTreeSet<String>) {
    let described = |path: &str| keys().iter().find(|key| key.path == path);
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let join = |name: &str| if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
                let candidates = [join(name), join(name) + "[]", join("NAME")];
                let key = candidates.iter().find_map(|path| described(path)).unwrap_or_else(|| panic!("{path}.{name}"));
                found.insert(key.path.to_string());
                let function = matches!(key.kind, KeyKind::TimeFunction(_)) && value.is_table();
                if function {
                    found.insert("TIME_FUNCTION".to_string());
                }
                paths(value, if function { "TIME_FUNCTION" } else { key.path }, found);
            }
        }
        toml::Value::Array(items) if path.ends_with("[]") => items.iter().for_each(|item| paths(item, path, found)),
        _ => {}
    }
}

#[test]
fn the_sample_holds_every_key_of_the_list() {
    let mut found = BTreeSet::new();
    paths(&toml::from_str(&every_key()).unwrap(), "", &mut found);
    let missing: Vec<_> = keys().iter().map(|key| key.path).filter(|path| !found.contains(*path)).collect();
    assert_eq!(missing, ["solver.step"], "a fixed step excludes the safety factor");
    good(&SMALL.replace("end = 1e-3", "end = 1e-3\nstep = 1e-6"), &[]);
}

/// Dotted paths of all values of a case, for `--set`.
fn leaves(value: &toml::Value, path: &str, found: &mut Vec<String>) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                leaves(value, &path, found);
            }
        }
        toml::Value::Array(items) if items.iter().all(toml::Value::is_table) => {
            items.iter().enumerate().for_each(|(i, item)| leaves(item, &format!("{path}[{i}]"), found));
        }
        _ if path.contains('.') => found.push(path.to_string()),
        _ => {}
    }
}

#[test]
fn no_value_goes_unread() {
    let text = every_key();
    let mut found = Vec::new();
    leaves(&toml::from_str(&text).unwrap(), "", &mut found);
    assert!(found.len() > 140, "{}", found.len());
    for path in found {
        let errors = parse(&text, &[(&path, "1979-05-27")]).expect_err(&path);
        let at_path =
            |error: &fractum_io::case::Diagnostic| error.place.as_ref().is_some_and(|place| place.key == path);
        assert!(errors.0.iter().any(at_path), "{path} = a date: {errors}");
    }
}

#[test]
fn documented_defaults_are_the_defaults() {
    let text = every_key();
    let same = |a: &Case, b: &Case| {
        let plain = |case: &Case| {
            let mut case = case.clone();
            case.source.overrides.clear();
            // places differ between what is written and what is not
            format!("{case:?}")
                .split("place: Place")
                .map(|part| part.split_once('}').map_or(part, |p| p.1))
                .collect::<String>()
        };
        plain(a) == plain(b)
    };
    let mut tried = 0;
    for key in keys().iter().filter(|key| !matches!(key.default, "" | "required")) {
        let Ok(toml::Value::Table(default)) =
            format!("v = {}", key.default).parse::<toml::Table>().map(toml::Value::Table)
        else {
            continue; // described in words
        };
        let paths =
            ["materials.mortar", "materials.steel"].map(|material| key.path.replace("materials.NAME", material));
        for (text, path) in [(text.as_str(), &paths[0]), (SMALL, &paths[1])] {
            let path = path.replace("bodies[]", "bodies[0]").replace("expect[]", "expect[0]");
            let path = path.replace("loads[]", "loads[0]").replace("TIME_FUNCTION", "loads[3].pressure");
            if !path.contains('.') || path.contains("softening.") {
                continue;
            }
            let value = default["v"].to_string();
            // Take the key out first, so that the document is silent about it.
            let Some(silent) = without(text, &path) else { continue };
            let (Ok(silent), Ok(written)) = (parse(&silent, &[]), parse(&silent, &[(&path, &value)])) else { continue };
            assert!(same(&silent, &written), "{path} = {value} is not the default");
            tried += 1;
        }
    }
    assert!(tried >= 25, "{tried}");
}

/// The document without the key at `path`; nothing where the path leads nowhere.
fn without(text: &str, path: &str) -> Option<String> {
    let mut root: toml::Value = toml::from_str(text).ok()?;
    let (parents, last) = path.rsplit_once('.')?;
    let mut at = &mut root;
    for part in parents.split('.') {
        let (name, index) = part.trim_end_matches(']').split_once('[').unwrap_or((part, ""));
        at = at.get_mut(name)?;
        if !index.is_empty() {
            at = at.get_mut(index.parse::<usize>().ok()?)?;
        }
    }
    at.as_table_mut()?.remove(last);
    toml::to_string(&root).ok()
}

#[test]
fn each_mistake_has_one_clear_message() {
    let cases: &[(&str, &str, &str)] = &[
        // what is replaced, by what, message
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.62",
            "7:17: materials.steel.poisson_ratio = 0.62; expected between -1 and 0.5",
        ),
        (
            "density = 7800",
            "densty = 7800",
            "4:1: materials.steel.density is missing; expected a density such as \"2400 kg/m^3\"",
        ),
        ("density = 7800", "density = -1", "5:11: materials.steel.density = -1; expected more than 0"),
        ("density = 7800", "density = inf", "5:11: materials.steel.density = inf; expected a finite number"),
        (
            "density = 7800",
            "density = true",
            "5:11: materials.steel.density = true; expected a density such as \"2400 kg/m^3\"",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"210 mm\"",
            "6:17: materials.steel.young_modulus = \"210 mm\", which is a length; expected a pressure such as \"21 GPa\"",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"210 Gpa\"",
            "6:22: materials.steel.young_modulus = \"210 Gpa\": \"Gpa\" is not a unit; did you mean \"GPa\"?",
        ),
        (
            "young_modulus = 210e9",
            "young_modulus = \"2*E1\"",
            "6:20: materials.steel.young_modulus = \"2*E1\": unknown name \"E1\"; names here: pi",
        ),
        ("end = 1e-3", "end = 1e-3\nsafty = 0.5", "15:1: solver.safty is not a key; did you mean safety?"),
        (
            "end = 1e-3",
            "end = 1e-3\nqqqqqq = 0.5",
            "15:1: solver.qqqqqq is not a key; keys here: kind, end, safety, time_step, step, stop_when, balance_warning, \
             balance_stop",
        ),
        (
            "kind = \"solid\"",
            "kind = \"sold\"",
            "10:8: bodies[0].kind = \"sold\"; expected \"solid\" or \"rigid\"; did you mean \"solid\"?",
        ),
        (
            "kind = \"solid\"",
            "kind = \"bonded\"",
            "10:8: bodies[0].kind = \"bonded\" is not available in this version; expected \"solid\" or \"rigid\"",
        ),
        (
            "material = \"steel\"",
            "material = \"stel\"",
            "12:12: bodies[0].material = \"stel\" is not a material of this case; did you mean \"steel\"?",
        ),
        ("fractum = 1", "fractum = 2", "1:11: fractum = 2; expected 1, the version this program reads"),
        ("fractum = 1", "", "fractum is missing; expected a whole number"),
        ("end = 1e-3", "", "13:1: solver.end is missing; expected a time such as \"0.2 ms\""),
        ("file = \"bar.msh\"", "file = \"\"", "3:8: mesh.file = \"\"; expected a text that is not empty"),
        (
            "end = 1e-3",
            "end = 1e-3\n[[suports]]\ngroup = \"a\"\nfix = \"x\"",
            "15:3: suports is not a key; did you mean supports?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nfix = \"xx\"",
            "17:7: supports[0].fix = \"xx\"; expected each of x, y, z at most once, such as \"xy\"",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nfix = \"xy\"\nvelocity = { y = 1 }",
            "18:18: supports[0].velocity.y moves an axis that this support already moves; name each axis once among fix, \
             velocity, displacement",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"",
            "15:1: supports[0] prescribes no motion; expected one of fix, velocity, displacement",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nfix = \"x\"\n[[supports]]\ngroup = \"a\"\nfix = \"xy\"",
            "20:7: supports[1].fix moves group \"a\" along x too; the support at line 17 already does",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nvelocity.x = { ramp = [[0, 0], [0, 1]] }",
            "17:32: supports[0].velocity.x.ramp[1] = [0, 1]; expected a time after 0 s, that of the pair before it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[supports]]\ngroup = \"a\"\nvelocity.x = { ramp = [[0, 0]], peak = 1 }",
            "17:33: supports[0].velocity.x.peak has no effect with ramp; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\npressure = 1\nforce.x = 1",
            "17:12: loads[0].pressure stands beside force; expected exactly one of force, traction, pressure, gravity",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\ngravity.x = 1",
            "16:9: loads[0].group has no effect with gravity, which acts on the whole scene; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\npressure = \"1 MPa + 2 N\"",
            "17:19: loads[0].pressure = \"1 MPa + 2 N\": a pressure and a force cannot be added or compared",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[loads]]\ngroup = \"a\"\npressure = \"1000*9.81*y\"",
            "17:12: loads[0].pressure = \"1000*9.81*y\", which is a length; expected a pressure such as \"21 GPa\"; in a product \
             a number without a unit is a pure number; give it its unit",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, friction_angle = 0.5 }",
            "8:56: materials.steel.damage.friction_angle has no effect with this criterion; remove it",
        ),
        (
            "poisson_ratio = 0.3",
            "poisson_ratio = 0.3\ndamage = { tensile_strength = 1, fracture_energy = 1, tension_cutoff = true }",
            "8:73: materials.steel.damage.tension_cutoff has no effect with this criterion, only with mohr-coulomb; remove it",
        ),
        (
            "material = \"steel\"",
            "material = \"steel\"\ndamage_where = \"x < 1\"",
            "13:16: bodies[0].damage_where has no effect without damage; remove it",
        ),
        (
            "material = \"steel\"",
            "material = \"steel\"\nshape = \"plane\"",
            "13:1: bodies[0].shape has no effect on a solid body; remove it",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[probes]]\nname = \"a\"\nexpression = \"b\"\n[[probes]]\nname = \"b\"\nexpression = \"a\"",
            "17:15: probes[0].expression = \"b\": probe \"b\" must be declared above this one",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[probes]]\nname = \"a\"\nenergy = \"kinetc\"",
            "17:10: probes[0].energy = \"kinetc\"; expected \"external\", \"kinetic\", \"elastic\", \"damage\", \"removed\", \
             \"contact\", \"friction\", \"damping\", \"absorbed\" or \"residual\"; did you mean \"kinetic\"?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[probes]]\nname = \"a b\"\ncrack_area = true",
            "16:8: probes[0].name is not a name an expression can use; begin with a letter and go on with letters, digits \
             and underscores",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[expect]]\nquantity = \"energy.resid_max_relative\"\nbelow = 1\nsource = \"s\"",
            "16:12: expect[0].quantity = \"energy.resid_max_relative\" is neither a probe nor a path of summary.json; did you \
             mean \"energy.residual_max_relative\"?",
        ),
        (
            "end = 1e-3",
            "end = 1e-3\n[[expect]]\nquantity = \"time.end\"\nvalue = \"1 mm\"\ntolerance = \"1 %\"\nsource = \"s\"",
            "17:9: expect[0].value = \"1 mm\", which is a length; expected a time such as \"0.2 ms\"",
        ),
        (
            "kind = \"solid\"",
            "kind = \"rigid\"\nshape = \"plane\"\nnormal = [0, 0, 0]",
            "12:10: bodies[0].normal = [0, 0, 0]; \
             expected an axis such as \"x\" or \"-y\", or three numbers that are not all zero",
        ),
    ];
    for (old, new, expected) in cases {
        assert!(SMALL.contains(old), "{old}");
        let found = mistakes(&SMALL.replacen(old, new, 1));
        let found: Vec<_> = found.iter().map(|message| message.trim_start_matches(' ').to_string()).collect();
        assert!(found.iter().any(|message| message == expected), "{new}\nexpected {expected}\nfound {found:#?}");
    }
}

#[test]
fn all_mistakes_are_reported_at_once_and_in_order() {
    let text = SMALL.replace("7800", "\"7800 kg\"").replace("0.3", "0.7").replace("1e-3", "0").replace("bar.msh", " ");
    let lines: Vec<_> =
        parse(&text, &[]).unwrap_err().0.iter().map(|error| error.place.as_ref().unwrap().line).collect();
    assert_eq!(lines, [3, 5, 7, 14]);
}

#[test]
fn files_that_are_no_cases_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("case.toml");
    let message = |path: &Path| read_case(path, &[]).unwrap_err().to_string();
    assert!(message(&path).contains("cannot be opened"));
    assert!(message(dir.path()).contains("cannot be"));
    std::fs::write(&path, b"fractum = 1\n\xff").unwrap();
    assert!(message(&path).contains("line 2 is not UTF-8 text"));
    std::fs::write(&path, "").unwrap();
    assert!(message(&path).contains("fractum is missing"));
    std::fs::write(&path, "fractum = = 1").unwrap();
    assert!(message(&path).contains("case.toml:1:"), "{}", message(&path));
}

#[test]
fn overrides_set_parameters_and_keys() {
    let text = every_key();
    assert_eq!(good(&text, &[("E0", "30 GPa")]).materials[0].young_modulus, 30e9);
    assert_eq!(good(&text, &[("parameters.E0", "3e10")]).materials[0].young_modulus, 30e9);
    assert_eq!(good(&text, &[("solver.end", "5 ms")]).solver.end, 5e-3);
    assert_eq!(good(&text, &[("mesh.file", "fine.msh")]).mesh.file.value, folder().join("fine.msh"));
    let standard = good(&text, &[("bodies[1].formulation", "standard")]);
    assert!(matches!(&standard.bodies[1].kind, BodyKind::Solid(solid) if solid.formulation == Formulation::Standard));
    let pure = good(&text, &[("materials.concrete.damage.tension_cutoff", "false")]);
    assert_eq!(pure.materials[0].damage.as_ref().unwrap().value.criterion, Criterion::MohrCoulombPure);
    assert_eq!(pure.warnings().len(), 1);

    for (name, value, expected) in [
        ("E", "1", "--set: E is not a parameter of this case; did you mean E0?"),
        ("solver.ende", "1", "--set: solver.ende is not a key; did you mean end?"),
        ("solver.end", "1 mm", "--set: solver.end = 1 mm, which is a length; expected a time such as \"0.2 ms\""),
        ("bodies[9].damage", "false", "--set: bodies[9].damage cannot be set; the case has 3 of these"),
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
fn the_hash_follows_the_content() {
    let text = every_key();
    let case = good(&text, &[]);
    let elsewhere = tempfile::tempdir().unwrap();
    let path = elsewhere.path().join("moved.toml");
    std::fs::write(&path, &text).unwrap();
    std::fs::copy(folder().join("motion.csv"), elsewhere.path().join("motion.csv")).unwrap();
    assert_eq!(read_case(&path, &[]).unwrap().hash(), case.hash(), "the path plays no part");
    std::fs::write(elsewhere.path().join("motion.csv"), "0 0\n1 2\n").unwrap();
    assert_ne!(read_case(&path, &[]).unwrap().hash(), case.hash(), "the tables do");
    assert_ne!(good(&text, &[("E0", "30 GPa")]).hash(), case.hash(), "so do the overrides");
    assert_ne!(good(&text.replace("# Every", "# every"), &[]).hash(), case.hash(), "and the text");
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
        warned(&SMALL.replace("[mesh]", "[materials.idle]\ndensity=1\nyoung_modulus=1\npoisson_ratio=0\n[mesh]")),
        ["materials.idle"]
    );
    assert_eq!(warned(&format!("{SMALL}[output.fields]\nevery = 1\n")), ["output.fields.every"]);
    let jump = format!("{SMALL}[[supports]]\ngroup = \"a\"\ndisplacement.x = \"1 mm\"\n");
    assert_eq!(warned(&jump), ["supports[0].displacement.x"]);
}

#[test]
fn the_document_describes_every_key() {
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/case-file.md");
    let document = std::fs::read_to_string(document).unwrap();
    for key in keys() {
        let row = format!("| `{}` | {} | {} | {} |", key.path, key.kind.label(), key.default, key.doc);
        assert!(document.contains(&row), "docs/case-file.md lacks the row\n{row}");
    }
}

#[test]
fn the_schema_describes_every_key() {
    let schema = fractum_io::case::schema();
    for key in keys().iter().filter(|key| key.path != "TIME_FUNCTION") {
        let mut at = &schema;
        for part in key.path.split('.') {
            at = match part {
                "TIME_FUNCTION" => &schema["$defs"]["time_function"],
                "NAME" => &at["additionalProperties"],
                _ if part.ends_with("[]") => &at["properties"][part.trim_end_matches("[]")]["items"],
                _ => {
                    let table = at.get("anyOf").map_or(at, |any| &any[1]);
                    &table["properties"][part]
                }
            };
        }
        assert!(at.is_object(), "{}", key.path);
    }
}

#[test]
fn keys_are_explained_by_pattern_and_by_path() {
    use fractum_io::case::explain;
    for path in
        ["materials.NAME.density", "materials.concrete.density", "bodies[].group", "bodies[2].group", "bodies.group"]
    {
        assert!(explain(path).is_ok(), "{path}");
    }
    assert_eq!(explain("solver.saftey").unwrap_err(), Some("solver.safety"));
    assert_eq!(explain("poisson_ratio").unwrap_err(), Some("materials.NAME.poisson_ratio"));
    assert_eq!(explain("").unwrap_err(), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn mutated_cases_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0usize..4, "[ -~é\n]{0,6}"), 1..6),
        name in "[a-z.\\[\\]0-9]{0,20}",
        value in "[ -~]{0,12}",
    ) {
        let mut text: Vec<char> = every_key().chars().collect();
        for (index, remove, insert) in edits {
            let at = index.index(text.len());
            let end = (at + remove).min(text.len());
            text.splice(at..end, insert.chars());
        }
        let text: String = text.into_iter().collect();
        let _ = parse(&text, &[]).map_err(|errors| errors.to_string());
        let _ = parse(&every_key(), &[(&name, &value)]).map_err(|errors| errors.to_string());
    }

    #[test]
    fn shuffled_lines_never_panic(order in Just((0..every_key().lines().count()).collect::<Vec<_>>()).prop_shuffle(), keep in 1usize..200) {
        let text = every_key();
        let lines: Vec<&str> = text.lines().collect();
        let text: Vec<&str> = order.iter().take(keep).map(|i| lines[*i]).collect();
        let _ = parse(&text.join("\n"), &[]).map_err(|errors| errors.to_string());
    }

    #[test]
    fn any_value_anywhere_never_panics(
        index in any::<prop::sample::Index>(),
        value in prop_oneof![
            Just("true"), Just("[]"), Just("{}"), Just("[[]]"), Just("\"\""), Just("nan"), Just("-inf"), Just("1e308"),
            Just("-1"), Just("0"), Just("\"1 m\""), Just("\"t\""), Just("\"1/0\""), Just("[[[1]]]"), Just("{ a = 1 }"),
            Just("99999999999999999999"), Just("07:32:00"), Just("\"x < 1\""), Just("\"max(load)\""), Just("\"%\""),
        ],
    ) {
        let text = every_key();
        let mut found = Vec::new();
        leaves(&toml::from_str(&text).unwrap(), "", &mut found);
        let _ = parse(&text, &[(found[index.index(found.len())].as_str(), value)]).map_err(|errors| errors.to_string());
    }
}
