//! `fractum material`: what it proposes follows its sources, and stands in a case as it is.

use crate::common::Workplace;

/// The number behind a label of what the command says.
fn value(place: &Workplace, arguments: &[&str], label: &str) -> String {
    let ended = place.fractum(arguments);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""), "{arguments:?}");
    let line = ended.stdout.lines().find_map(|line| line.strip_prefix(label));
    let line = line.unwrap_or_else(|| panic!("{label} in {}", ended.stdout));
    line.trim().split("  ").next().unwrap_or_default().to_owned()
}

#[test]
fn concrete_follows_the_model_code() {
    let place = Workplace::new("");
    for (strength, tension, young, energy) in [
        ("20 MPa", "2.21 MPa", "30.3 GPa", "133 J/m^2"),
        ("40 MPa", "3.51 MPa", "36.3 GPa", "147 J/m^2"),
        ("90 MPa", "5.04 MPa", "46 GPa", "167 J/m^2"),
    ] {
        let told = |label| value(&place, &["material", "concrete", "--compressive-strength", strength], label);
        assert_eq!(told("tensile strength ft"), tension);
        assert_eq!(told("Young's modulus E"), young);
        assert_eq!(told("fracture energy Gf"), energy);
    }
}

#[test]
fn toughness_energy_and_lengths_become_each_other() {
    let place = Workplace::new("");
    let own = ["material", "own", "--young-modulus", "62 GPa", "--poisson-ratio", "0.2"];
    let with = |more: &[&str], label: &str| value(&place, &[&own, more].concat(), label);
    let glass = ["--toughness", "0.75e6 Pa*m^0.5", "--tensile-strength", "30 MPa"];
    assert_eq!(with(&glass, "fracture energy Gf"), "8.71 J/m^2");
    assert_eq!(with(&glass, "process zone E Gf/ft²"), "600 µm");
    let field = ["--fracture-energy", "8 J/m^2", "--length", "0.5 mm"];
    assert_eq!(with(&field, "tensile strength ft"), "10.2 MPa");
    assert_eq!(with(&[&field[..], &["--model", "at1"]].concat(), "tensile strength ft"), "19.3 MPa");
    assert_eq!(with(&field, "fracture toughness K_Ic"), "0.719 MPa*m^0.5");
    // A strength that is given is that of which a rock has its toughness, and takes the place of a specimen's.
    let granite =
        |option: &str, strength: &str, label: &str| value(&place, &["material", "granite", option, strength], label);
    assert_eq!(granite("--tensile-strength", "8 MPa", "fracture toughness K_Ic"), "1.45 MPa*m^0.5");
    assert_eq!(granite("--compressive-strength", "200 MPa", "compressive strength"), "200 MPa");
    let crushed = ["material", "alumina", "--compressive-strength", "2.2 GPa"];
    assert_eq!(value(&place, &crushed, "compressive strength"), "2.2 GPa");
    // The Brazilian strength of a granite over 6.88, and 0.8 of it in direct tension.
    assert_eq!(value(&place, &["material", "lac-du-bonnet"], "fracture toughness K_Ic"), "1.35 MPa*m^0.5");
}

#[test]
fn names_that_are_nearly_right_lead_on() {
    let place = Workplace::new("");
    assert_eq!(place.fractum(&["material", "Soda lime_glass"]).code, Some(0));
    for (name, says) in [
        ("granit", "did you mean granite? known: concrete"),
        ("Westerly granite", "did you mean granite or lac-du-bonnet?"),
        ("glass", "did you mean soda-lime-glass or borosilicate-glass?"),
        ("float-glass", "soda-lime-glass"),
        ("SiC", "did you mean silicon-carbide?"),
        ("Al2O3", "did you mean alumina?"),
        ("C30/37", "did you mean concrete --compressive-strength \"30 MPa\"?"),
        ("graphene", "no material \"graphene\"; known: concrete"),
    ] {
        let ended = place.fractum(&["material", name]);
        assert!(ended.code == Some(1) && ended.stderr.contains(says), "{name}: {}", ended.stderr);
    }
}

/// Numbers without their units made granite of 8 Pa, and a fracture energy of 3e-11 J/m², without a word.
#[test]
fn numbers_of_another_unit_are_refused() {
    let place = Workplace::new("");
    for (options, says) in [
        (["--tensile-strength", "8"], "which is 8 Pa; expected 1 kPa to 100 GPa"),
        (["--young-modulus", "50"], "did you mean \"50 GPa\"?"),
        (["--density", "2.65"], "did you mean \"2.65 g/cm^3\"?"),
        (["--toughness", "1.5"], "give each number with its unit"),
        (["--fracture-energy", "0.0005"], "make a process zone E Gf/ft² of"),
    ] {
        let ended = place.fractum(&[&["material", "granite"], &options[..]].concat());
        assert!(ended.code == Some(1) && ended.stderr.contains(says), "{options:?}: {}", ended.stderr);
    }
}

#[test]
fn every_material_is_listed_and_runs_in_a_template() {
    let place = Workplace::new("");
    let list = place.fractum(&["material"]).stdout;
    let names: Vec<&str> =
        list.lines().take_while(|line| !line.is_empty()).filter_map(|line| line.split(' ').next()).collect();
    assert!(names.len() > 12 && names.contains(&"granite"), "{names:?}");
    assert_eq!(place.fractum(&["new", "plate"]).code, Some(0));
    let template = std::fs::read_to_string(place.path("plate/case.toml")).unwrap();
    let begin = template.find("[materials.concrete]").unwrap();
    let end = begin + template[begin..].find("[[bodies]]").unwrap();
    for name in names.into_iter().filter(|name| *name != "own") {
        let said = place.fractum(&["material", name]).stdout;
        let tables = &said[said.find("[materials.").unwrap()..];
        // Elements of a ceramic are far too large on this plate: only its tables are of interest.
        let tables = tables
            .replace("[materials.", "[materials.new_")
            .replace("fracture_energy", "reduce_strength_to_fit = true\nfracture_energy");
        let case = format!("{}{tables}\n{}", &template[..begin], &template[end..]);
        let material = format!("new_{}", name.replace('-', "_"));
        std::fs::write(
            place.path("plate/case.toml"),
            case.replace("material = \"concrete\"", &format!("material = \"{material}\"")),
        )
        .unwrap();
        let checked = place.fractum(&["check", "plate/case.toml"]);
        assert_eq!(checked.code, Some(0), "{name}: {}", checked.stderr);
    }
}

#[test]
fn wrong_materials_are_told() {
    let place = Workplace::new("");
    let wrong = |arguments: &[&str], text: &str| {
        let ended = place.fractum(&[&["material"], arguments].concat());
        assert!(ended.code == Some(1) && ended.stderr.contains(text), "{arguments:?}: {}", ended.stderr);
    };
    wrong(&["granit"], "did you mean granite?");
    wrong(&["concrete", "--compressive-strength", "200 MPa"], "from 12 to 120 MPa");
    wrong(&["concrete", "--compressive-strength", "30 mm"], "--compressive-strength: ");
    wrong(&["granite", "--compressive-strength", "5 MPa"], "rocks of this kind have 100 MPa to 250 MPa");
    wrong(&["granite", "--young-modulus", "0 GPa"], "must be above 0");
    wrong(&["granite", "--poisson-ratio", "0.5"], "must be below 0.5");
    wrong(&["own", "--young-modulus", "3 GPa"], "needs --young-modulus and --poisson-ratio");
    wrong(&["own", "--young-modulus", "3 GPa", "--poisson-ratio", "0.2"], "needs --toughness or --fracture-energy");
    wrong(
        &["own", "--young-modulus", "3 GPa", "--poisson-ratio", "0.2", "--fracture-energy", "3 J/m^2"],
        "needs --tensile-strength",
    );
}
