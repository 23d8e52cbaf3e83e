//! The list of keys against the reader, the documentation and the schema.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use fractum_case::{Case, Diagnostic, KeyKind, explain, keys, schema};

use crate::{SMALL, every_key, good, leaves, parse};

#[test]
fn the_sample_holds_every_key_of_the_list() {
    let mut found = BTreeSet::new();
    paths(&toml::from_str(&every_key()).unwrap(), "", &mut found);
    let missing: Vec<_> = keys().iter().map(|key| key.path).filter(|path| !found.contains(*path)).collect();
    // A fixed step excludes the safety factor, and a solver the keys of the other.
    let statics = |path: &str| {
        let of = ["control", "linear_solver", "tolerance", "batch", "no_equilibrium", "max_steps", "count"];
        path.strip_prefix("solver.").is_some_and(|key| of.contains(&key) || key.starts_with("opening"))
    };
    let staged = |path: &str| path.contains("stages");
    let burns = ["gas.jwl", "gas.explosive", "gas.holes[].detonation"];
    let products = |path: &str| burns.iter().any(|key| path.starts_with(key));
    let left: Vec<&str> =
        missing.into_iter().filter(|path| !statics(path) && !staged(path) && !products(path)).collect();
    // Nor is an accuracy for every body.
    assert_eq!(left, ["solver.step", "solver.accuracy", "solver.accuracy_runs"]);
    good(&accurate(), &[]);
    good(&SMALL.replace("end = 1e-3", "end = 1e-3\nstep = 1e-6"), &[]);
    good(&SMALL.replace("end = 1e-3", STATIC), &[]);
    good(BONDED_AT_REST, &[]);
    good(&SMALL.replace("end = 1e-3", "kind = \"modes\"\ncount = 3\nlinear_solver = \"faer\""), &[]);
    good(&[SMALL, PRODUCTS].concat(), &[]);
    good(&[SMALL, EXPLOSIVE].concat(), &[]);
    good(&SMALL.replace("[solver]\nend = 1e-3", STAGES), &[]);
    good(&SMALL.replace("[solver]\nend = 1e-3", EXCAVATION), &[]);
}

/// A static solver with all of its keys, in place of the end of a run.
const STATIC: &str = "end = 1e-3\nkind = \"static\"\ncontrol = \"opening\"\n\
                      opening = { group = \"top\", against = \"bottom\", along = \"y\", step = 1e-6, end = 1e-4 }\nlinear_solver = \"direct\"\n\
                      tolerance = 1e-5\nmax_steps = 100\nno_equilibrium = \"motion\"";

/// A bar that may crack, whose load is asked for within 3 %.
fn accurate() -> String {
    let damage = "poisson_ratio = 0.3\ndamage = { tensile_strength = 3e6, fracture_energy = 1e4 }";
    let load = "[[supports]]\ngroup = \"end\"\nfix = \"x\"\n[[probes]]\nname = \"load\"\nreaction = { group = \"end\", along = \"x\" }\n";
    let asked = SMALL.replace("end = 1e-3", "end = 1e-3\naccuracy = 0.03\naccuracy_runs = 20");
    asked.replace("poisson_ratio = 0.3", damage) + load
}

/// Stages in place of the solver.
const STAGES: &str = "[[supports]]\ngroup = \"bar\"\nfix = \"x\"\nstages = [\"all\"]\n\
                      [[loads]]\ngravity = { x = 1 }\nstages = [\"all\"]\n\
                      [[stages]]\nname = \"all\"\nsolver = { end = 1e-3 }";

/// Stages of which one takes a body out and puts another in, in place of the solver.
const EXCAVATION: &str = "[[bodies]]\nname = \"core\"\nkind = \"solid\"\ngroup = \"core\"\nmaterial = \"steel\"\n\
                          [[bodies]]\nname = \"lining\"\nkind = \"solid\"\ngroup = \"core\"\nmaterial = \"steel\"\n\
                          [[stages]]\nname = \"before\"\nsolver = { kind = \"static\", end = 1e-3 }\n\
                          [[stages]]\nname = \"after\"\nexcavate = [\"core\"]\ninstall = [\"lining\"]\nrelease = 1e-4\nrelease_share = 0.5\n\
                          solver = { end = 2e-3 }";

/// A gas after another law, with all of its keys.
const PRODUCTS: &str = r#"[gas]
law = "jwl"
[gas.jwl]
a = "371 GPa"
b = "3.2 GPa"
r1 = 4.15
r2 = 0.95
omega = 0.3
density = "1630 kg/m^3"
heat_capacity = "1400 J/(kg K)"
[[gas.holes]]
group = "hole"
mass = "1 g"
energy = "4 kJ"
"#;

/// A charge that burns, with all of its keys.
const EXPLOSIVE: &str = r#"[gas]
explosive = "anfo"
[[gas.holes]]
group = "hole"
mass = "1 g"
[gas.holes.detonation]
length = "5 cm"
velocity = "4 km/s"
delay = "1 us"
"#;

/// A bonded body at rest, with the key of the static solver that only such bodies have.
const BONDED_AT_REST: &str = r#"fractum = 1
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[[bodies]]
name = "box"
kind = "bonded"
shape = "box"
size = [1e-3, 1e-3, 1e-3]
particles = 1000
material = "steel"
[solver]
end = 1e-3
kind = "static"
batch = "one"
"#;

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
fn no_value_goes_unread() {
    let text = every_key();
    let mut found = Vec::new();
    leaves(&toml::from_str(&text).unwrap(), "", &mut found);
    assert!(found.len() > 140, "{}", found.len());
    for path in found {
        let errors = parse(&text, &[(&path, "1979-05-27")]).expect_err(&path);
        let at_path = |error: &Diagnostic| error.place.as_ref().is_some_and(|place| place.key == path);
        assert!(errors.0.iter().any(at_path), "{path} = a date: {errors}");
    }
}

#[test]
fn documented_defaults_are_the_defaults() {
    let text = every_key();
    let plain = |mut case: Case| {
        case.source.overrides.clear();
        // Places, the hash of what is written, and whether a unit is named differ between what is written and what is not.
        let text = format!("{case:?}").replace("is_named: true", "is_named: false");
        let (before, after) = text.split_once("hash_but_end: ").expect("the hash of the source");
        let text = before.to_owned() + after.trim_start_matches(|c: char| c.is_ascii_digit());
        text.split("place: Place").map(|part| part.split_once('}').map_or(part, |p| p.1)).collect::<String>()
    };
    // Most keys are in few of the samples: their silent text is that of the sample, which is read once.
    let mut read: HashMap<String, Option<String>> = HashMap::new();
    // Where a key may stand in the two samples.
    let at_rest = SMALL.replace("end = 1e-3", STATIC);
    let breaking = SMALL.replace("[[bodies]]", "[materials.steel.fracture]\ntensile_strength = 1e9\n[[bodies]]");
    let vibrating = SMALL.replace("end = 1e-3", "kind = \"modes\"");
    let accurate = accurate();
    let products = [SMALL, PRODUCTS].concat();
    let explosive = [SMALL, EXPLOSIVE].concat();
    let perfect = text.replace("covolume = \"8e-4 m^3/kg\"\n", "").replace("noble-abel", "perfect-gas");
    let samples = [
        (products.as_str(), "steel", "bodies[0]", ""),
        (perfect.as_str(), "concrete", "bodies[0]", ""),
        (explosive.as_str(), "steel", "bodies[0]", ""),
        (at_rest.as_str(), "steel", "bodies[0]", ""),
        (text.as_str(), "concrete", "bodies[0]", "loads[3].pressure"),
        (text.as_str(), "mortar", "bodies[2]", "supports[1].displacement.y"),
        (text.as_str(), "mortar", "bodies[3]", ""),
        (text.as_str(), "mortar", "bodies[5]", ""),
        (text.as_str(), "mortar", "bodies[7]", ""),
        (text.as_str(), "mortar", "bodies[8]", ""),
        (text.as_str(), "cement", "bodies[10]", ""),
        (text.as_str(), "grout", "bodies[11]", ""),
        (text.as_str(), "shale", "bodies[12]", ""),
        (text.as_str(), "mortar", "bodies[14]", ""),
        (SMALL, "steel", "bodies[0]", ""),
        (BONDED_AT_REST, "steel", "bodies[0]", ""),
        (breaking.as_str(), "steel", "bodies[0]", ""),
        (vibrating.as_str(), "steel", "bodies[0]", ""),
        (accurate.as_str(), "steel", "bodies[0]", ""),
    ];
    let mut untried = Vec::new();
    for key in keys() {
        let Ok(default) = format!("v = {}", key.default).parse::<toml::Table>() else {
            continue; // none, or described in words
        };
        let mut tried = false;
        for (text, material, body, function) in samples {
            // A table of interfaces is something else than none.
            if key.path.contains(".interface.") && !["cement", "grout"].contains(&material) {
                continue;
            }
            let path = key
                .path
                .replace("NAME", material)
                .replace("bodies[]", body)
                .replace("loads[].in_cracks", "loads[2].in_cracks")
                .replace("loads[].scatter", "loads[5].scatter")
                .replace("gas.holes[]", "gas.holes[0]")
                .replace("liquid.holes[]", "liquid.holes[0]")
                .replace("interfaces[].residual", "interfaces[1].residual")
                .replace("interfaces[].dilation_angle", "interfaces[1].dilation_angle")
                .replace("interfaces[]", "interfaces[0]")
                .replace("mesh.joints[]", "mesh.joints[0]")
                .replace("mesh.refine[]", "mesh.refine[0]")
                .replace("probes[].reaction.about", "probes[15].reaction.about")
                .replace("probes[].moment", "probes[38].moment")
                .replace("probes[].displacement.about", "probes[16].displacement.about")
                .replace("probes[].velocity.about", "probes[17].velocity.about")
                .replace("probes[].contact_force.about", "probes[20].contact_force.about")
                .replace("probes[].stress.about", "probes[18].stress.about")
                .replace("probes[].strain", "probes[33].strain")
                .replace("probes[].temperature", "probes[35].temperature")
                .replace("probes[].load.about", "probes[22].load.about")
                .replace("probes[].mode", "probes[32].mode")
                .replace("probes[].radial_cracks", "probes[29].radial_cracks")
                .replace("probes[].damaged", "probes[30].damaged")
                .replace("output.ppv[]", "output.ppv[0]")
                .replace("plots[]", "plots[0]")
                .replace("probes[]", "probes[14]")
                .replace("supports[].elastic", "supports[5].elastic")
                .replace("TIME_FUNCTION", function);
            let value = default["v"].to_string();
            // Take the key out first, so that the document is silent about it.
            let silent = without(text, &path).unwrap_or(text.to_string());
            let absent_is_cheaper = matches!(key.kind, KeyKind::Field(_) | KeyKind::TimeFunction(_));
            let kept_for_the_mesh = ["bodies[].plane", "bodies[].thickness"].contains(&key.path);
            if absent_is_cheaper || kept_for_the_mesh {
                continue;
            }
            let Ok(written) = parse(&silent, &[(&path, &value)]) else { continue };
            let without = read.entry(silent.clone()).or_insert_with(|| parse(&silent, &[]).ok().map(plain));
            if let Some(without) = without {
                assert!(*without == plain(written), "{path} = {value} is not the default");
                tried = true;
            }
        }
        if !tried {
            untried.push(key.path);
        }
    }
    // In these, absent is `None` in the model: no function at all, or left to the number of dimensions.
    let optional = |path: &&&str| ["loads[].", "bodies[].", "in_situ."].iter().any(|table| path.starts_with(table));
    assert_eq!(untried.iter().filter(|path| !optional(path)).count(), 0, "{untried:?}");
    assert_eq!(untried.len(), 9 + 3 + 1 + 2 + 3 + 6 + 6 + 2, "{untried:?}");
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
fn the_document_describes_every_key() {
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/case-file.md");
    let document = std::fs::read_to_string(document).unwrap();
    for key in keys() {
        let row = format!("| `{}` | {} | {} | {} |", key.path, key.kind.label(), key.default, key.doc);
        assert!(document.contains(&row), "docs/case-file.md lacks the row\n{row}");
    }
    let example = document.split("```").nth(1).and_then(|block| block.strip_prefix("toml")).unwrap();
    assert_eq!(good(example, &[]).warnings(), []);
}

#[test]
fn the_schema_describes_every_key() {
    let schema = schema();
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
    for path in
        ["materials.NAME.density", "materials.concrete.density", "bodies[].group", "bodies[2].group", "bodies.group"]
    {
        assert!(explain(path).is_ok(), "{path}");
    }
    assert_eq!(explain("supports[0].velocity.y.ramp").unwrap().path, "TIME_FUNCTION.ramp");
    assert_eq!(explain("solver.saftey").unwrap_err(), Some("solver.safety"));
    assert_eq!(explain("poisson_ratio").unwrap_err(), Some("materials.NAME.poisson_ratio"));
    assert_eq!(explain("").unwrap_err(), None);
}
