//! `record steps`: the largest stable step of every kind of scene, over the step that the program finds.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use fractum_output::{WriteError, atomic};
use fractum_scene::{Scene, StepError};
use serde::{Deserialize, Serialize};

use super::situations::{Situation, situations};
use super::{Settings, write_mesh};
use fractum::Failure;
use fractum::say;

/// Factors on the step that the program finds between which the limit is looked for.
const FACTORS: [f64; 2] = [0.5, 1.2];
/// Bisections: the limit is known to 0.7/2⁶ = 0.011.
const BISECTIONS: usize = 6;
/// Velocity over that of the start beyond which a run has blown up.
const BLOWN_UP: f64 = 1e3;
/// Steps between two looks at the state.
const STEPS_BETWEEN_LOOKS: u64 = 20;
/// The factor that runs take by default.
const PICKED: f64 = 0.8;
/// Folder of the scene under way, below that of the table.
const SCENE: &str = "scene";
/// A change of the limit that is told.
const CHANGE: f64 = 0.02;

/// One line of `steps.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Limit {
    /// What is special about the scene.
    pub(crate) scene: String,
    /// Largest factor on the step found by the program at which the scene was stable; 1.2 where it was stable throughout.
    pub(crate) stable_to: f64,
    /// What happened beyond it.
    pub(crate) beyond: String,
}

impl Limit {
    /// Whether the step that runs take by default is stable.
    pub(crate) fn holds(&self) -> bool {
        self.stable_to >= PICKED
    }
}

/// Measures the limit of every scene, and prints and writes the table, `steps.md` and `steps.json`; beside a baseline also what has changed.
///
/// # Errors
/// [`Failure::Write`] if a file cannot be written; [`Failure::Input`] where a scene or the baseline cannot be read.
pub(crate) fn steps(settings: &Settings, baseline: Option<&Path>) -> Result<Vec<Limit>, Failure> {
    let before = baseline.map(read_baseline).transpose()?;
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = settings.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool.build()?;
    atomic::create_folder(&settings.output)?;
    let mut limits = Vec::new();
    for situation in situations(settings.seed) {
        let limit = pool.install(|| limit(&situation, settings))?;
        say!("{:<52}{:>6}   {}", limit.scene, shown(limit.stable_to), limit.beyond);
        limits.push(limit);
        atomic::write(&settings.output.join("steps.json"), &serde_json::to_vec_pretty(&limits).unwrap_or_default())?;
        atomic::write(&settings.output.join("steps.md"), table(&limits).as_bytes())?;
    }
    // A folder that stays is no harm.
    let _ = fs::remove_dir_all(settings.output.join(SCENE));
    for change in before.iter().flat_map(|before| changes(before, &limits)) {
        say!("{change}");
    }
    let held = limits.iter().filter(|limit| limit.holds()).count();
    say!("{held} of {} scenes are stable at the step that runs take, {PICKED} of the one found", limits.len());
    say!("{}", settings.output.join("steps.md").display());
    Ok(limits)
}

fn read_baseline(path: &Path) -> Result<Vec<Limit>, Failure> {
    let text = fs::read_to_string(path).map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
    let remedy = "give a steps.json that record steps has written";
    serde_json::from_str(&text).map_err(|error| Failure::input(format!("{}: {error}; {remedy}", path.display())))
}

/// What differs between two tables.
fn changes(before: &[Limit], now: &[Limit]) -> Vec<String> {
    let mut lines = Vec::new();
    for limit in now {
        match before.iter().find(|old| old.scene == limit.scene) {
            None => lines.push(format!("new: {}", limit.scene)),
            Some(old) if (old.stable_to - limit.stable_to).abs() > CHANGE => {
                lines.push(format!(
                    "changed: {}: {} before, {} now",
                    limit.scene,
                    shown(old.stable_to),
                    shown(limit.stable_to)
                ));
            }
            Some(_) => {}
        }
    }
    let gone = before.iter().filter(|old| now.iter().all(|limit| limit.scene != old.scene));
    lines.extend(gone.map(|old| format!("gone: {}", old.scene)));
    lines
}

fn shown(factor: f64) -> String {
    if factor >= FACTORS[1] { format!("≥ {factor}") } else { format!("{factor:.2}") }
}

fn table(limits: &[Limit]) -> String {
    let mut text = String::from("| scene | stable to | beyond |\n|---|---|---|\n");
    for Limit { scene, stable_to, beyond } in limits {
        // Writing to a string does not fail.
        let _ = writeln!(text, "| {scene} | {} | {beyond} |", shown(*stable_to));
    }
    text
}

/// Finds the limit of a scene by bisection.
fn limit(situation: &Situation, settings: &Settings) -> Result<Limit, Failure> {
    let folder = settings.output.join(SCENE);
    // Nothing of the scene before.
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| WriteError::new(&folder, error))?;
    }
    atomic::create_folder(&folder)?;
    let case = folder.join("case.toml");
    atomic::write(&case, situation.case.as_bytes())?;
    if let Some(mesh) = &situation.mesh {
        write_mesh(mesh, &folder)?;
    }
    if let Some(beads) = &situation.beads {
        atomic::write(&folder.join("beads.csv"), beads.as_bytes())?;
    }
    let at = |factor: f64| -> Result<Option<String>, Failure> {
        let overrides = [("solver.safety".to_owned(), factor.to_string())];
        let mut scene = fractum::load(&case, &overrides, &settings.cache)?.built.scene;
        Ok(fails(&mut scene, situation))
    };
    let [mut stable, mut unstable] = FACTORS;
    let scene = situation.name.clone();
    let Some(mut beyond) = at(unstable)? else {
        return Ok(Limit { scene, stable_to: unstable, beyond: String::new() });
    };
    if let Some(reason) = at(stable)? {
        return Ok(Limit { scene, stable_to: 0.0, beyond: reason });
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (stable + unstable);
        match at(middle)? {
            None => stable = middle,
            Some(reason) => (unstable, beyond) = (middle, reason),
        }
    }
    Ok(Limit { scene, stable_to: stable, beyond })
}

/// Moves a scene; how it came to grief, if it did.
fn fails(scene: &mut Scene, situation: &Situation) -> Option<String> {
    for step in 0..situation.steps {
        let look = step % STEPS_BETWEEN_LOOKS == 0;
        if let Err(error) = scene.step(look) {
            return Some(reason(&error).to_owned());
        }
        if look {
            let mut velocities = scene.solid.velocity.iter().chain(&scene.bonded.particles.velocity);
            let most = BLOWN_UP * situation.speed;
            if velocities.any(|velocity| !velocity.norm().is_finite() || velocity.norm() > most) {
                return Some("velocities grow without end".to_owned());
            }
        }
    }
    None
}

fn reason(error: &StepError) -> &'static str {
    match error {
        StepError::Unstable { .. } => "more elastic energy than was put in",
        StepError::Unbalanced { .. } => "the balance is off by more than 1e-2",
        StepError::Inverted { .. } => "an element is inverted",
        StepError::NotFinite { .. } => "an energy is no number",
        _ => "the step fails",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit_of(scene: &str, stable_to: f64) -> Limit {
        Limit { scene: scene.to_owned(), stable_to, beyond: "an element is inverted".to_owned() }
    }

    #[test]
    fn scenes_are_stable_up_to_the_step_that_is_found_and_not_beyond() {
        let output = tempfile::tempdir().expect("a folder");
        let cache = fractum_prepare::Cache::new(None);
        let settings = Settings {
            scenes: 0,
            first: 0,
            blasts: false,
            seed: 1,
            output: output.path().to_owned(),
            threads: Some(1),
            cache,
        };
        // A scene before it has left what this one has not.
        let left = output.path().join(SCENE).join("beads.csv");
        atomic::create_folder(&output.path().join(SCENE)).expect("a folder");
        fs::write(&left, "0,0,0,1").expect("a file");
        for situation in situations(1) {
            if !["tetrahedra, smoothed, small, power-iteration", "elastic support"].contains(&situation.name.as_str()) {
                continue;
            }
            let found = limit(&situation, &settings).expect("a scene that runs");
            // The frequency is found within the 2 % that are added to it, and the limit within 0.011.
            assert!((0.97..1.04).contains(&found.stable_to) && found.holds(), "{found:?}");
            assert!(!left.exists(), "particles of another scene");
        }
    }

    #[test]
    fn what_has_changed_since_a_baseline_is_told() {
        let before = [limit_of("a", 1.0), limit_of("b", 1.0), limit_of("gone", 1.0)];
        let now = [limit_of("a", 1.01), limit_of("b", 0.9), limit_of("new", 1.2)];
        assert_eq!(changes(&before, &now), ["changed: b: 1.00 before, 0.90 now", "new: new", "gone: gone"]);
        assert!(table(&now).contains("| new | ≥ 1.2 |"));
    }
}
