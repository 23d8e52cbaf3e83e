//! A folder with a small mesh and a case, and the program as its user starts it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use fractum_math::Vec3;
use fractum_mesh::generate::structured_box;
use fractum_mesh::{Mesh, MshFormat, write_msh};
use serde_json::Value;

/// A bar with a weak slab in its middle, pulled apart while it falls on a rigid plane: damage, removed elements,
/// discrete elements, contacts between them and with the plane.
pub(crate) const BREAKING_BAR: &str = r#"fractum = 1
title = "A bar that breaks above a floor"

[parameters]
end = "1 ms"

[mesh]
file = "bar.msh"

[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
criterion = "rankine"
tensile_strength = "3 MPa"
fracture_energy = "100 J/m^2"
[materials.concrete.damage.scatter]
distribution = "uniform-per-edge"
width = 0.1
seed = 3
[materials.concrete.contact]
friction = 0.4
damping_ratio = 0.05

[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "concrete"
kinematics = "corotational"
strength_factor = "if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)"
initial_velocity = { y = "-0.1 m/s" }

[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
point = ["0 m", "-0.005 mm", "0 m"]
normal = "y"
contact = { friction = 0.3, damping_ratio = 0.05 }

[[supports]]
group = "x-"
velocity = { x = { ramp = [["0 s", "0 m/s"], ["0.2 ms", "-0.2 m/s"]] } }

[[supports]]
group = "x+"
velocity = { x = { ramp = [["0 s", "0 m/s"], ["0.2 ms", "0.2 m/s"]] } }

[[loads]]
gravity = { y = "-9.81 m/s^2" }

[solver]
kind = "explicit"
end = "end"

[[probes]]
name = "load"
reaction = { group = "x+", along = "x" }

[[probes]]
name = "largest_load"
expression = "max(load)"

[[probes]]
name = "cracked"
crack = { measure = "area" }

[[probes]]
name = "tip"
crack = { measure = "tip", along = "y" }

[[probes]]
name = "tip_speed"
expression = "slope(tip, 50 us)"

[[probes]]
name = "harmed"
damaged = { measure = "share", threshold = 0.9 }
every = "35 us"

[output]
fields = { every = "0.1 ms" }
history = { every = "10 us" }
checkpoint = { every = "5 ms" }

[[output.ppv]]
name = "from the end"
hole = "x-"
line = { from = ["5 cm", "1 cm", "1 cm"], to = ["40 cm", "1 cm", "1 cm"], stations = 5 }
groups = ["x+"]

[[output.gauges]]
name = "whole"
group = "body"
from = [0, 0, 0]
to = ["40 cm", "12 cm", "0 cm"]
spacing = "5 cm"
length = "12 cm"
"#;

/// A solid bar and, above it, a bonded one. One of them flies out of the domain.
pub(crate) const FLYING: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
solver = { end = "2 ms", domain = { min = [-1, -1, -1], max = ["0.6 m", 1, 1] } }
output = { history = { every = "20 us" } }
probes = [
  { name = "solid_strain", strain = { group = "body", component = "xx" } },
  { name = "solid_clip", extensometer = { group = "body", from = [0, 0, 0], to = ["40 cm", 0, 0] } },
  { name = "solid_way", displacement = { group = "body", along = "x" } },
  { name = "solid_speed", velocity = { group = "body", along = "x" } },
  { name = "bonded_way", displacement = { group = "bonded", along = "x" } },
  { name = "bonded_speed", velocity = { group = "bonded", along = "x" } },
  { name = "bonded_turn", rotation = { group = "bonded", along = "x" } },
  { name = "bonded_stress", stress = { group = "bonded", component = "xx" } },
  { name = "bonded_strain", strain = { group = "bonded", component = "xx" } },
  { name = "bonded_satake", strain = { group = "bonded", measure = "satake", component = "xx" } },
  { name = "bonded_clip", extensometer = { group = "bonded", from = [0, 0, "50 cm"], to = ["40 cm", 0, "50 cm"] } },
]
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = 0.23
[[bodies]]
name = "solid"
kind = "solid"
group = "body"
material = "glass"
initial_velocity = { x = "0 m/s" }
[[bodies]]
name = "bonded"
kind = "bonded"
material = "glass"
shape = "box"
point = [0, 0, "50 cm"]
size = ["40 cm", "12 cm", "12 cm"]
particles = 300
coordination = 8
initial_velocity = { x = "0 m/s" }
"#;

/// A brittle bar whose load factor runs back while its weak slab comes apart.
pub(crate) const SNAP_BACK: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
supports = [{ group = "x-", fix = "xyz" }, { group = "x+", displacement = { x = "0.06 mm*t/1 s" } }]
solver = { kind = "static", end = "1 s" }
probes = [{ name = "load", reaction = { group = "x+", along = "x" } }]
[materials.brittle]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
damage = { tensile_strength = "3 MPa", fracture_energy = "15 J/m^2" }
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "brittle"
strength_factor = "if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)"
"#;

/// A bonded bar that is pulled apart from break to break.
pub(crate) const BONDED_BAR: &str = r#"fractum = 1
supports = [{ group = "bar.x-", fix = "x" }, { group = "bar.x+", displacement = { x = "6 um*t/1 s" } }]
solver = { kind = "static", end = "1 s" }
probes = [{ name = "load", reaction = { group = "bar.x+", along = "x" } }]
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = 0.23
fracture = { criterion_strength = "60 MPa" }
[[bodies]]
name = "bar"
kind = "bonded"
material = "glass"
shape = "box"
size = ["2 mm", "1 mm", "1 mm"]
particles = 600
coordination = 8
"#;

/// A folder of one test, gone at its end.
pub(crate) struct Workplace {
    folder: tempfile::TempDir,
}

/// How a command ended.
#[derive(Debug)]
pub(crate) struct Ended {
    /// Exit code; none if a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Workplace {
    /// A folder that holds `case.toml` and `bar.msh`.
    pub(crate) fn new(case: &str) -> Self {
        Self::with_mesh(case, &mesh_bytes(&bar(), MshFormat::V4_1Binary))
    }

    pub(crate) fn with_mesh(case: &str, mesh: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("bar.msh"), mesh).unwrap();
        fs::write(folder.path().join("case.toml"), case).unwrap();
        Workplace { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `fractum ARGUMENTS` in the folder, not yet started.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fractum"));
        command.args(arguments).current_dir(self.folder.path()).stdin(Stdio::null());
        command.env("FRACTUM_CACHE", self.path("cache"));
        command
    }

    /// `fractum ARGUMENTS`, to its end.
    pub(crate) fn fractum(&self, arguments: &[&str]) -> Ended {
        let output = self.command(arguments).output().unwrap();
        Ended {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// `fractum ARGUMENTS`, left running with its output thrown away.
    pub(crate) fn start(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    }
}

/// The bar: 0.4 m × 0.12 m × 0.12 m, 432 tetrahedra.
pub(crate) fn bar() -> Mesh {
    structured_box([8, 3, 3], Vec3::new(0.4, 0.12, 0.12), None)
}

pub(crate) fn mesh_bytes(mesh: &Mesh, format: MshFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_msh(mesh, format, &mut bytes).unwrap();
    bytes
}

/// Names of the files below `folder` whose name ends with `suffix`, sorted.
pub(crate) fn files_below(folder: &Path, suffix: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(folder) else { return found };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files_below(&path, suffix));
        } else if path.to_string_lossy().ends_with(suffix) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Runs `case.toml` with a number of threads into a folder; its summary.
pub(crate) fn run(place: &Workplace, folder: &str, threads: &str) -> Value {
    let ended = place.fractum(&["run", "case.toml", "-o", folder, "--threads", threads]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    summary(place, folder)
}

/// Resumes a run from its middle with one thread, as if its last state had been lost; its summary.
///
/// The case saves its state after some `output.checkpoint.steps`: that before the last is then the same on any machine.
pub(crate) fn resumed(place: &Workplace, folder: &str) -> Value {
    let results = place.path(folder);
    let (steps, files) = (checkpoints(&results), files_below(&results.join("checkpoint"), ".fck"));
    assert!(steps.len() > 1 && steps[0] > 0, "the state before the last is to be one in mid-run: {steps:?}");
    fs::remove_file(files.last().unwrap()).unwrap();
    // The summary that is read must be the one that the resumed run writes.
    fs::remove_file(results.join("summary.json")).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", folder, "--threads", "1", "--resume", "--quiet"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    summary(place, folder)
}

/// The summary in a results folder.
pub(crate) fn summary(place: &Workplace, folder: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(place.path(folder).join("summary.json")).unwrap()).unwrap()
}

/// Steps of the checkpoints in a results folder, ascending.
pub(crate) fn checkpoints(results: &Path) -> Vec<u64> {
    let step = |path: PathBuf| path.file_stem()?.to_str()?.strip_prefix("state-")?.parse().ok();
    files_below(&results.join("checkpoint"), ".fck").into_iter().filter_map(step).collect()
}

/// Waits until the run has saved a step after `step`, or has ended.
pub(crate) fn wait_for_checkpoint(run: &mut Child, results: &Path, step: u64) {
    while checkpoints(results).last().is_none_or(|&saved| saved <= step) && run.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(1));
    }
}

/// Sends a signal such as `INT`.
pub(crate) fn signal(run: &Child, name: &str) {
    let sent = Command::new("sh").args(["-c", &format!("kill -{name} {}", run.id())]).status().unwrap();
    assert!(sent.success());
}

/// Columns of the history.
pub(crate) fn history(place: &Workplace, folder: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').map(|name| name.split(' ').next().unwrap()).collect();
    let places: Vec<usize> = names.iter().map(|name| header.iter().position(|h| h == name).unwrap()).collect();
    let row = |line: &str| {
        let values: Vec<&str> = line.split(',').collect();
        places.iter().map(|&place| values[place].parse().unwrap()).collect()
    };
    lines.map(row).collect()
}
