//! Natural vibrations as their user sees them.

use std::fs;

use crate::common::{BONDED_BAR, BREAKING_BAR, SNAP_BACK, Workplace, summary};

#[test]
fn the_command_finds_the_vibrations_of_any_case_with_solids() {
    let place = Workplace::new(SNAP_BACK);
    let ended = place.fractum(&["modes", "case.toml", "--count", "4", "-o", "out", "--threads", "1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("mode") && ended.stdout.lines().count() == 6, "{}", ended.stdout);
    let found = summary(&place, "out");
    let modes = &found["modes"];
    assert_eq!(modes["rigid_motions"], 0);
    let vibrations = modes["vibrations"].as_array().unwrap();
    let frequencies: Vec<f64> = vibrations.iter().map(|mode| mode["frequency"].as_f64().unwrap()).collect();
    assert!(frequencies.len() == 4 && frequencies.is_sorted() && frequencies[0] > 100.0, "{frequencies:?}");
    let table = fs::read_to_string(place.path("out/modes.csv")).unwrap();
    assert_eq!(table.lines().count(), 5, "{table}");
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("Natural vibrations") && !page.contains("load factor"));
    let frames = fs::read_dir(place.path("out/fields")).unwrap().count();
    assert_eq!(frames, 4);
    let movie = place.fractum(&["movie", "out", "--mode", "2"]);
    assert_eq!(movie.code, Some(0), "{}", movie.stderr);
    // With the run: one swing of the slowest.
    let asked = ["modes", "case.toml", "--count", "1", "-o", "swing", "--quiet", "--set", "output.movie=true"];
    assert_eq!(place.fractum(&asked).code, Some(0));
    let swing = fs::read(place.path("swing/movie.png")).unwrap();
    assert_eq!(swing.windows(4).filter(|bytes| bytes == b"fcTL").count(), 24);
    let none = place.fractum(&["movie", "out", "--mode", "5"]);
    assert_eq!(none.code, Some(1));
    assert!(none.stderr.contains("no mode 5"), "{}", none.stderr);
    // The others give the same.
    for solver in ["direct", "iterative", "faer"] {
        let chosen = format!("solver.linear_solver=\"{solver}\"");
        let out = format!("out-{solver}");
        let ended = place.fractum(&["modes", "case.toml", "--count", "4", "-o", &out, "--quiet", "--set", &chosen]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let other = summary(&place, &out);
        for (mode, frequency) in other["modes"]["vibrations"].as_array().unwrap().iter().zip(&frequencies) {
            let ratio = mode["frequency"].as_f64().unwrap() / frequency;
            assert!((ratio - 1.0).abs() < 1e-8, "{solver}: {ratio}");
        }
    }
}

#[test]
fn what_is_not_held_is_told_and_what_is_no_solid_is_refused() {
    let free = SNAP_BACK.lines().filter(|line| !line.starts_with("supports") && !line.starts_with("probes"));
    let place = Workplace::new(&free.collect::<Vec<_>>().join("\n"));
    let ended = place.fractum(&["modes", "case.toml", "--count", "2", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("6 rigid motions that nothing prevents"), "{}", ended.stderr);
    let codes = summary(&place, "out")["warnings"].to_string();
    assert!(codes.contains("rigid-motion") && !codes.contains("large-strain"), "{codes}");
    let place = Workplace::new(BREAKING_BAR);
    let ended = place.fractum(&["modes", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("body \"floor\"") && ended.stderr.contains("solid bodies"), "{}", ended.stderr);
}

#[test]
fn a_body_that_is_held_all_over_has_no_vibrations() {
    let held = SNAP_BACK.lines().filter(|line| !line.starts_with("probes")).map(|line| match line {
        line if line.starts_with("supports") => "supports = [{ group = \"body\", fix = \"xyz\" }]",
        line => line,
    });
    let place = Workplace::new(&held.collect::<Vec<_>>().join("\n"));
    let ended = place.fractum(&["modes", "case.toml", "--count", "2", "-o", "out"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("nothing vibrates - let them hold one side alone"), "{}", ended.stderr);
}

/// A free bar under a stress along it.
fn stressed(stress: &str) -> String {
    let free = SNAP_BACK.lines().filter(|line| !line.starts_with("supports") && !line.starts_with("probes"));
    let free: Vec<&str> = free.collect();
    let solver = format!(
        "in_situ = {{ stress = {{ xx = \"{stress}\" }}, groups = [\"x-\", \"x+\"] }}\nsolver = {{ kind = \"modes\", count = 3 }}"
    );
    free.join("\n").replace("solver = { kind = \"static\", end = \"1 s\" }", &solver)
}

#[test]
fn a_pulled_bar_swings_back_and_a_pressed_one_buckles_and_both_are_told() {
    let place = Workplace::new(&stressed("1 MPa"));
    let ended = place.fractum(&["run", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("4 rigid motions that nothing prevents"), "{}", ended.stderr);
    let place = Workplace::new(&stressed("-1 MPa"));
    let ended = place.fractum(&["run", "case.toml", "-o", "out"]);
    assert_ne!(ended.code, Some(0));
    for said in ["the solids buckle under the in-situ stress", "in_situ.stress", "[[supports]]"] {
        assert!(ended.stderr.contains(said), "{}", ended.stderr);
    }
    assert!(!ended.stderr.contains("NaN"), "{}", ended.stderr);
}

#[test]
fn springs_hold_a_bar_that_swings_on_them_and_dashpots_are_refused() {
    let on = |support: &str| {
        let supports = format!("supports = [{{ group = \"x-\", {support} }}]");
        let line = |line: &'static str| if line.starts_with("supports") { supports.clone() } else { line.to_owned() };
        let lines: Vec<String> = SNAP_BACK.lines().filter(|line| !line.starts_with("probes")).map(line).collect();
        let place = Workplace::new(&lines.join("\n"));
        let ended = place.fractum(&["modes", "case.toml", "--count", "1", "-o", "out"]);
        (place, ended)
    };
    let frequency = |stiffness: &str| {
        let (place, ended) = on(&format!("elastic = {{ normal = \"{stiffness}\", tangential = \"{stiffness}\" }}"));
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let found = summary(&place, "out");
        assert_eq!(found["modes"]["rigid_motions"], 0);
        found["modes"]["vibrations"][0]["frequency"].as_f64().unwrap()
    };
    // Soft springs: four times as stiff ones swing twice as fast.
    let ratio = frequency("4 MPa/m") / frequency("1 MPa/m");
    assert!((ratio - 2.0).abs() < 1e-3, "{ratio}");
    let (_, refused) = on("absorbing = true");
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("it damps, and natural vibrations go on"), "{}", refused.stderr);
}

#[test]
fn what_has_no_place_among_vibrations_is_refused() {
    let loads = "loads = [{ group = \"x+\", pressure = \"1 kPa\" }]\n";
    let with_loads = SNAP_BACK.replace("fractum = 1\n", &format!("fractum = 1\n{loads}"));
    let modes = |case: &str| case.replace("kind = \"static\", end = \"1 s\"", "kind = \"modes\"");
    let in_situ =
        "in_situ = { stress = { xx = \"1 MPa\" }, groups = [\"x-\", \"x+\"] }\nmesh = { file = \"bar.msh\" }\n";
    let bonded = BONDED_BAR.replace("fractum = 1\n", &format!("fractum = 1\n{in_situ}"));
    let solid = "[[bodies]]\nname = \"solid\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"glass\"\n";
    let wrong = [
        (modes(&with_loads), vec!["loads", "without [in_situ]"]),
        (modes(&bonded) + solid, vec!["[in_situ] and the bonded body \"bar\"", "solid bodies alone"]),
    ];
    for (case, said) in wrong {
        let place = Workplace::new(&case);
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        said.iter().for_each(|said| assert!(ended.stderr.contains(said), "{said}: {}", ended.stderr));
    }
}

#[test]
fn the_plan_of_motion_tells_what_damping_does_to_the_first_vibration() {
    let slow = SNAP_BACK.replace("kind = \"static\"", "kind = \"explicit\"");
    let line = |damping: &str| {
        let place = Workplace::new(&slow.replace("fractum = 1\n", &format!("fractum = 1\n{damping}")));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let line = ended.stdout.lines().find(|line| line.starts_with("damping ")).map(str::to_owned);
        line.unwrap_or_else(|| panic!("{}", ended.stdout))
    };
    let none = line("");
    assert!(none.contains("does not come to rest; mass = \""), "{none}");
    // With what it says the vibration is damped critically.
    let critical = none.split("mass = \"").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
    let damped = line(&format!("damping = {{ mass = \"{critical}\" }}\n"));
    assert!(damped.contains("has 100 % of its critical damping"), "{damped}");
    let both = line(&format!("damping = {{ mass = \"3*{critical}\", local = 0.2 }}\n"));
    assert!(both.contains("by mass") && both.contains("6.4 % by local") && both.contains("lags behind"), "{both}");
}
