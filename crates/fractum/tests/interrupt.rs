//! Ctrl-C and SIGTERM end the program soon, whatever it is doing, and leave nothing half written.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::{BREAKING_BAR, Workplace, checkpoints, files_below, signal, wait_for_checkpoint};

/// What must end within a second has this long on a busy machine.
const SOON: Duration = Duration::from_secs(15);

/// A case whose packing takes minutes.
const LARGE: &str = r#"fractum = 1

[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = 0.23

[[bodies]]
name = "box"
kind = "bonded"
material = "glass"
shape = "box"
size = ["1 m", "1 m", "1 m"]
particles = 300_000

[solver]
end = "1 ms"
"#;

/// Waits for the end of a command; its exit code, none if it goes on.
fn end_of(run: &mut Child) -> Option<i32> {
    let start = Instant::now();
    while start.elapsed() < SOON {
        if let Some(status) = run.try_wait().unwrap() {
            return status.code();
        }
        sleep(Duration::from_millis(5));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    None
}

/// Starts a command, waits a while, and ends it by a signal.
fn ends_by(place: &Workplace, arguments: &[&str], name: &str) {
    let mut run = place.start(arguments);
    sleep(Duration::from_millis(700));
    assert!(run.try_wait().unwrap().is_none(), "{arguments:?} ended by itself");
    signal(&run, name);
    assert_eq!(end_of(&mut run), Some(130), "{arguments:?}, SIG{name}");
}

/// A pipe that nobody writes to or reads from: who opens it waits for ever.
fn make_pipe(path: &PathBuf) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn packing_ends_by_a_signal() {
    let place = Workplace::new(LARGE);
    for (arguments, name) in [
        (&["run", "case.toml", "-o", "out"][..], "INT"),
        (&["check", "case.toml"], "TERM"),
        (&["pack", "--box", "1 m, 1 m, 1 m", "--count", "300000", "-o", "packed"], "INT"),
        (&["calibrate", "--young", "72 GPa", "--poisson", "0.23", "--particles", "300000"], "TERM"),
    ] {
        ends_by(&place, arguments, name);
    }
    for name in ["out", "packed", "cache"] {
        assert_eq!(files_below(&place.path(name), ""), Vec::<PathBuf>::new(), "{name}");
    }
}

#[test]
fn the_search_for_a_strength_ends_by_a_signal() {
    let strength = "poisson_ratio = 0.23\n[materials.glass.fracture]\ntensile_strength = \"60 MPa\"";
    let case = LARGE.replace("poisson_ratio = 0.23", strength).replace("300_000", "600");
    ends_by(&Workplace::new(&case), &["check", "case.toml"], "INT");
}

#[test]
fn what_may_never_end_is_refused_at_once() {
    let place = Workplace::new(BREAKING_BAR);
    fs::remove_file(place.path("bar.msh")).unwrap();
    make_pipe(&place.path("bar.msh"));
    make_pipe(&place.path("pipe.toml"));
    fs::write(place.path("endless.toml"), BREAKING_BAR.replace("bar.msh", "/dev/zero")).unwrap();
    for arguments in [
        &["check", "case.toml"][..],
        &["mesh", "info", "bar.msh"],
        &["check", "pipe.toml"],
        &["run", "endless.toml", "-o", "out"],
        &["mesh", "info", "/dev/zero"],
        &["check", "/dev/urandom"],
        &["study", "pipe.toml"],
    ] {
        let ended = place.fractum(arguments);
        let right = ended.code == Some(1) && ended.stderr.contains("is a device or a pipe, which may never end");
        assert!(right, "{arguments:?}: {ended:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_program_whose_path_is_no_text_tells_how_to_go_on() {
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::process::CommandExt;
    let place = Workplace::new(BREAKING_BAR);
    let mut command = place.command(&["run", "case.toml", "-o", "out", "--set", "end=1000 s", "--quiet"]);
    command.arg0(std::ffi::OsStr::from_bytes(b"fract\xffum")).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut run = command.spawn().unwrap();
    wait_for_checkpoint(&mut run, &place.path("out"), 0);
    signal(&run, "INT");
    assert_eq!(end_of(&mut run), Some(130));
    let told = std::io::read_to_string(run.stderr.take().unwrap()).unwrap();
    assert!(told.contains("go on with: ") && told.contains(" run case.toml"), "{told}");
}

#[test]
fn a_second_signal_ends_a_run_that_cannot_finish() {
    let place = Workplace::new(BREAKING_BAR);
    let results = place.path("out");
    fs::create_dir(&results).unwrap();
    make_pipe(&results.join("summary.json.part"));
    let mut run = place.start(&["run", "case.toml", "-o", "out", "--set", "end=1000 s"]);
    wait_for_checkpoint(&mut run, &results, 0);
    signal(&run, "INT");
    // It saves its state and hangs in the summary.
    let start = Instant::now();
    let interrupted = |text: String| text.matches("state saved").count() > 1;
    while start.elapsed() < SOON && !fs::read_to_string(results.join("run.log")).is_ok_and(interrupted) {
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(300));
    assert!(run.try_wait().unwrap().is_none(), "it waits for the reader of the summary");
    signal(&run, "INT");
    assert_eq!(end_of(&mut run), Some(130));
    assert!(!checkpoints(&results).is_empty());
}
