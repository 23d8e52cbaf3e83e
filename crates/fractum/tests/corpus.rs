//! A corpus of wrong inputs: `fractum check` names the line at fault and the remedy.

use std::fs;
use std::path::Path;

use crate::common::{Workplace, mesh_bytes};
use fractum_mesh::MshFormat;

const CASE: &str = include_str!("wrong/case.toml");
const INPUTS: &str = include_str!("wrong/inputs.toml");

/// Lines of mistakes, with that which counts the others.
const MOST_LINES: usize = 21;

struct Input {
    old: String,
    new: String,
    line: String,
    says: String,
}

fn inputs() -> Vec<Input> {
    let table: toml::Table = INPUTS.parse().unwrap();
    let text = |input: &toml::Value, key: &str| input[key].as_str().unwrap().to_owned();
    let all = table["input"].as_array().unwrap().iter();
    all.map(|input| {
        let of = |key| text(input, key);
        Input { old: of("old"), new: of("new"), line: of("line"), says: of("says") }
    })
    .collect()
}

#[test]
fn wrong_inputs_are_answered_on_their_line_with_the_remedy() {
    let inputs = inputs();
    let mut missed = Vec::new();
    let workplace = Workplace::new(CASE);
    let right = workplace.fractum(&["check", "case.toml"]);
    // It is short, and is told so; nothing else.
    let doubts: Vec<&str> = right.stdout.lines().filter(|line| line.contains("warning: ")).collect();
    let short = |line: &&str| line.ends_with("[fast-loading]");
    assert!(
        right.code == Some(0) && doubts.len() == 1 && doubts.iter().all(short),
        "the case that is spoilt: {right:?}"
    );
    for Input { old, new, line, says } in &inputs {
        assert_eq!(CASE.matches(old.as_str()).count(), 1, "{old}");
        let case = CASE.replace(old.as_str(), new);
        let (before, _) = case.split_once(line.as_str()).unwrap_or_else(|| panic!("{line} is not in {case}"));
        let start = format!("case.toml:{}:", before.matches('\n').count() + 1);
        fs::write(workplace.path("case.toml"), &case).unwrap();
        let ended = workplace.fractum(&["check", "case.toml"]);
        let mut said = ended.stderr.lines().chain(ended.stdout.lines());
        let is_error = ended.code == Some(1);
        assert!(is_error || ended.code == Some(0), "{new}: {ended:?}");
        assert!(ended.stderr.lines().count() <= MOST_LINES, "{new}: {}", ended.stderr);
        if !said.any(|text| text.starts_with(&start) && text.contains(says.as_str())) {
            missed.push(format!("{new}\n  wanted {start} ... {says}\n  {}", ended.stderr));
        }
    }
    assert!(inputs.len() >= 60, "{} inputs", inputs.len());
    assert!(missed.is_empty(), "{} of {} inputs missed:\n{}", missed.len(), inputs.len(), missed.join("\n"));
}

#[test]
fn what_is_no_case_says_what_it_is() {
    let workplace = Workplace::new(CASE);
    fs::write(workplace.path("text.msh"), mesh_bytes(&crate::common::bar(), MshFormat::V4_1Ascii)).unwrap();
    let files = [("bar.msh", "is a Gmsh mesh"), ("text.msh", "is a Gmsh mesh"), (".", "is a folder")];
    for (file, says) in files {
        let ended = workplace.fractum(&["check", file]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(1), 1), "{ended:?}");
        assert!(ended.stderr.contains(says) && ended.stderr.contains("expected a case file"), "{}", ended.stderr);
    }
}

#[test]
fn twenty_mistakes_are_listed_and_the_others_counted() {
    // Of the reader, and of the mesh, which only building the scene shows.
    let keys: String = (0..50).map(|i| format!("wrong_{i} = 1\n")).collect();
    let groups: String = (0..50).map(|i| format!("[[supports]]\ngroup = \"no {i}\"\nfix = \"x\"\n")).collect();
    for case in [CASE.replace("[solver]\n", &format!("[solver]\n{keys}")), format!("{CASE}{groups}")] {
        let ended = Workplace::new(&case).fractum(&["check", "case.toml"]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(1), MOST_LINES), "{}", ended.stderr);
        let last = ended.stderr.lines().last().unwrap();
        assert!(last.ends_with("30 further messages are not listed"), "{last}");
    }
}

#[test]
fn a_driven_rigid_body_moves_a_scene() {
    let case = CASE.replace("[[loads]]\ngroup = \"y+\"\npressure = \"1 kPa\"\n", "");
    let from = case.find("[[supports]]").unwrap();
    let to = case.find("[solver]").unwrap();
    let body = "[[bodies]]\nname = \"punch\"\nkind = \"rigid\"\nshape = \"sphere\"\nradius = \"1 cm\"\n\
                point = [\"20 cm\", \"14 cm\", \"6 cm\"]\nvelocity = { y = \"-1 m/s\" }\n";
    let mut case = format!("{}{body}{}", &case[..from], &case[to..]);
    case.truncate(case.find("[[probes]]").unwrap());
    let case = case.replace("[parameters]\npull = \"1 mm/s\"\n", "");
    let ended = Workplace::new(&case).fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("rigid bodies move this scene: punch"), "{}", ended.stdout);
    let resting = Workplace::new(&case.replace("velocity = { y = \"-1 m/s\" }\n", "")).fractum(&["check", "case.toml"]);
    assert!(resting.stdout.contains("only initial velocities"), "{}", resting.stdout);
}

/// The word after `kind = ` in a line of the plan.
fn chosen(plan: &str) -> String {
    let line = plan.lines().find(|line| line.starts_with("choice")).unwrap_or_else(|| panic!("{plan}"));
    line.split("kind = \"")
        .nth(1)
        .and_then(|rest| rest.split('"').next())
        .unwrap_or_else(|| panic!("{line}"))
        .to_owned()
}

#[test]
fn the_advice_is_what_an_open_choice_takes() {
    // A slow pull, a quick one, and a pulse.
    let slow = CASE.replace("velocity = { x = \"pull\" }", "displacement = { x = \"20 um * t / 1 s\" }");
    let slow = slow.replace("\"20 us\"", "\"1 s\"").replace("[parameters]\npull = \"1 mm/s\"\n", "");
    let slow = slow.replace("\"10 us\"", "\"0.5 s\"").replace("\"1 us\"", "\"0.1 s\"");
    let pulse = slow.replace(
        "\"1 kPa\"\n\n[solver]",
        "{ pulse = \"triangle\", peak = \"1 MPa\", duration = \"2 us\" }\n\n[solver]",
    );
    let firing = slow.replace("group = \"y+\"\npressure = \"1 kPa\"", "firing = [[\"y+\", \"0.1 s\", \"slow\"]]");
    let pulses = "[pulses]\nslow = { pulse = \"linear-exponential\", peak = \"1 MPa\", rise_time = \"0.2 s\", decay_time = \"0.2 s\" }\n";
    let firing = format!("{firing}{pulses}");
    let mut taken = Vec::new();
    for case in [slow.as_str(), CASE, pulse.as_str(), firing.as_str()] {
        let plan = |case: &str| {
            let ended = Workplace::new(case).fractum(&["check", "case.toml"]);
            assert_eq!(ended.code, Some(0), "{}", ended.stderr);
            ended.stdout
        };
        let advice = plan(case);
        let open = chosen(&plan(&case.replace("kind = \"explicit\"", "kind = \"auto\"")));
        assert_eq!(chosen(&advice), open, "{advice}");
        let ends_early = advice.lines().any(|line| line.starts_with("end ") && line.contains("end = \""));
        assert_eq!(ends_early, case == CASE, "an end is proposed where the run is too short: {advice}");
        taken.push(open);
    }
    assert_eq!(taken, ["static", "explicit", "explicit", "explicit"]);
}

#[test]
fn no_case_is_advised_to_take_a_solver_that_refuses_it() {
    // With gas, and with a support that lets waves leave.
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let workplace = Workplace::new(CASE);
    for case in ["gas-blast/dry.toml", "kirsch-in-situ/pressurised.toml"] {
        let path = cases.join(case);
        let path = path.to_str().unwrap();
        let ended = workplace.fractum(&["check", path]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(chosen(&ended.stdout), "explicit", "{case}");
        let refused = workplace.fractum(&["check", path, "--set", "solver.kind=static"]);
        assert_eq!(refused.code, Some(1), "{}", refused.stdout);
    }
}
