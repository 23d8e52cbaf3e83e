//! `summary.json`: the results that scripts read. The names of the keys are a contract.
//!
//! Keys come in the order of the structs, maps in the order of their names, so that equal results are equal files. JSON
//! knows no NaN or infinity: such a number is written as `null`, and read back as NaN.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use fractum_scene::{EnergyKind, Ledger};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::accuracy::Accuracy;
use crate::attenuation::Attenuation;
use crate::error::ReadError;
use crate::expectation::Expectation;
use crate::number::or_null;
use crate::origin::Origin;
use crate::warning::Warning;

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// It reached its end time.
    #[default]
    Completed,
    /// It stopped itself: unstable, not a number, or the energy guard.
    Stopped,
    /// The user interrupted it; it can be resumed.
    Interrupted,
}

/// All of `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of the program.
    pub fractum: String,
    /// Title of the case.
    pub title: String,
    /// How the run ended.
    pub status: Status,
    /// Threads used.
    pub threads: usize,
    /// What tells this case and its end from others.
    #[serde(flatten)]
    pub hashes: Hashes,
    /// Case, overrides, input files, command and date.
    #[serde(default)]
    pub origin: Origin,
    /// The probes by name.
    pub probes: BTreeMap<String, Probe>,
    /// What the case expected, and what came out.
    pub expect: Vec<Expectation>,
    /// Runs on several meshes and what they say of peaks, where the case asked for an accuracy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// The energy ledger at the end.
    pub energy: Energy,
    /// What became of the bonds of each body whose bonds can break.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fracture: Vec<Fracture>,
    /// Sizes of the fragments, velocities of the ground, and the largest overlap.
    #[serde(flatten)]
    pub breakage: Breakage,
    /// Natural vibrations, of a run that looks for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<NaturalVibrations>,
    /// Sizes at the end.
    pub counts: Counts,
    /// What reading the mesh changed in it, as elements that were split.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<String>,
    /// What is doubtful in the case, and what the run found while it went.
    #[serde(default)]
    pub warnings: Vec<Warning>,
    /// Simulated time.
    pub time: Time,
    /// Time on the clock.
    pub wall: Wall,
}

/// Hashes of input and result, 32 hexadecimal digits each ([`hash_text`]).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hashes {
    /// Of the case: text, overrides, tables.
    pub case_hash: String,
    /// Of the final state.
    pub state_hash: String,
}

/// What a body breaks into, what the ground around feels, and how deeply particles are pressed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Breakage {
    /// Sizes of the fragments; none where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fragment_sizes: Option<FragmentSizes>,
    /// Largest velocities against scaled distance, and their power laws.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ppv: Vec<Attenuation>,
    /// The largest overlap of a particle that was found; none where particles touch nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_overlap: Option<LargestOverlap>,
}

/// The largest overlap of a particle with another one or with a body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LargestOverlap {
    /// Overlap over the smaller radius.
    pub share: f64,
    /// What overlaps, and where.
    #[serde(rename = "where")]
    pub place: String,
    /// When it was found [s].
    pub time: f64,
}

/// Natural vibrations of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NaturalVibrations {
    /// Connected pieces of the solids.
    pub pieces: u64,
    /// Rigid motions that nothing prevents.
    pub rigid_motions: u64,
    /// Motions without stiffness beside them.
    pub mechanisms: u64,
    /// Mass that is free to move along x, y and z [kg].
    pub free_mass: [f64; 3],
    /// The vibrations, the slowest first.
    pub vibrations: Vec<NaturalVibration>,
}

/// A natural vibration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NaturalVibration {
    /// Vibrations in a second [1/s].
    pub frequency: f64,
    /// Participation in a motion of the ground along x, y and z [√kg], for a modal mass of 1 kg.
    pub participation: [f64; 3],
    /// Share of the free mass that such a motion sets in motion in this vibration [-].
    pub mass_share: [f64; 3],
    /// What is missing to balance, over the square of the angular frequency [-].
    pub residual: f64,
}

/// A probe over the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Unit of the values.
    pub unit: String,
    /// Last value.
    #[serde(with = "or_null")]
    pub r#final: f64,
    /// Largest value.
    #[serde(with = "or_null")]
    pub max: f64,
    /// Smallest value.
    #[serde(with = "or_null")]
    pub min: f64,
    /// When the largest value came first [s].
    #[serde(with = "or_null")]
    pub time_of_max: f64,
}

/// Sizes below which a fifth, half and four fifths of the mass of all fragments lie: diameters of the spheres of their
/// volumes, in the plane of the circles of their areas [m].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FragmentSizes {
    /// P20 [m].
    #[serde(with = "or_null")]
    pub p20: f64,
    /// P50 [m].
    #[serde(with = "or_null")]
    pub p50: f64,
    /// P80 [m].
    #[serde(with = "or_null")]
    pub p80: f64,
}

/// What became of the bonds of a body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fracture {
    /// Name of the body.
    pub body: String,
    /// Bonds that broke.
    pub broken_bonds: u64,
    /// When the first one broke [s].
    #[serde(with = "or_null")]
    pub first_break: f64,
    /// Facets that the broken bonds stand for [m²].
    #[serde(with = "or_null")]
    pub crack_area: f64,
    /// Largest load over strength of any particle or bond at the rows of the history: how close it came.
    #[serde(with = "or_null")]
    pub largest_ratio: f64,
    /// Where that was, in the undeformed body [m].
    pub largest_at: Option<[f64; 3]>,
    /// When that was [s].
    #[serde(with = "or_null")]
    pub largest_time: f64,
}

/// The energy ledger: every entry under its name [J], and the largest imbalance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// The entries, in the order of [`EnergyKind::ALL`].
    pub entries: [f64; EnergyKind::COUNT],
    /// Largest |imbalance| of the ledger over the run, relative to the largest external work [-].
    pub residual_max_relative: f64,
}

const RESIDUAL: &str = "residual_max_relative";

impl From<&Ledger> for Energy {
    fn from(ledger: &Ledger) -> Self {
        let entries = EnergyKind::ALL.map(|kind| ledger[kind]);
        Self { entries, residual_max_relative: ledger.residual_max_relative }
    }
}

impl Serialize for Energy {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let names = EnergyKind::ALL.iter().map(|kind| kind.name()).chain([RESIDUAL]);
        let values = self.entries.iter().chain([&self.residual_max_relative]);
        serializer.collect_map(names.zip(values.map(|&value| value.is_finite().then_some(value))))
    }
}

impl<'de> Deserialize<'de> for Energy {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let found = BTreeMap::<String, Option<f64>>::deserialize(deserializer)?;
        // An entry that an older program did not have yet is zero.
        let value = |name: &str| found.get(name).map_or(0.0, |value| value.unwrap_or(f64::NAN));
        Ok(Self { entries: EnergyKind::ALL.map(|kind| value(kind.name())), residual_max_relative: value(RESIDUAL) })
    }
}

/// Sizes at the end of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Nodes of the mesh.
    pub nodes: u64,
    /// Elements of the mesh.
    pub elements: u64,
    /// Elements that were removed.
    pub removed_elements: u64,
    /// Those of them that were turned inside out after they had begun to break.
    #[serde(default)]
    pub crushed_elements: u64,
    /// Particles.
    pub particles: u64,
    /// Those that have come in through inlets.
    #[serde(default)]
    pub entered_particles: u64,
    /// Those that were due at the end and had no free place in their inlet.
    #[serde(default)]
    pub waiting_particles: u64,
    /// The most that have waited at a time.
    #[serde(default)]
    pub most_waiting_particles: u64,
    /// Free pieces that have left the domain.
    #[serde(default)]
    pub left_pieces: u64,
    /// Bonds at the start.
    pub bonds: u64,
    /// Bonds that broke.
    pub broken_bonds: u64,
    /// Edges that broke.
    pub broken_edges: u64,
    /// Edges with damage, broken ones included.
    pub damaged_edges: u64,
    /// Contacts that touch at the end.
    pub contacts: u64,
    /// Connected pieces.
    pub fragments: u64,
}

/// Simulated time [s].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Steps done.
    pub steps: u64,
    /// Last time step.
    #[serde(with = "or_null")]
    pub dt: f64,
    /// Smallest time step.
    #[serde(with = "or_null")]
    pub dt_min: f64,
    /// Time reached.
    #[serde(with = "or_null")]
    pub end: f64,
    /// Why the run ended.
    #[serde(default)]
    pub reason: String,
    /// Whether the scene was at rest then, so that `end` is a load factor rather than time.
    #[serde(default)]
    pub at_rest: bool,
}

/// Time on the clock [s].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// From the start of the run to its end, over all its resumptions.
    #[serde(with = "or_null")]
    pub total: f64,
    /// By part of the step: `solid`, `damage`, `bonds`, `contact`, `output`, ...
    pub phases: BTreeMap<String, f64>,
}

impl Summary {
    /// The file's text.
    pub fn to_json(&self) -> String {
        json(self)
    }

    /// The number under a dotted path, such as `energy.residual_max_relative`; NaN where there is none.
    pub fn number(&self, path: &str) -> f64 {
        let json = serde_json::to_value(self).unwrap_or_default();
        path.split('.')
            .try_fold(&json, |value, key| value.get(key))
            .and_then(serde_json::Value::as_f64)
            .unwrap_or(f64::NAN)
    }

    /// Reads a `summary.json`.
    ///
    /// # Errors
    /// [`ReadError`] with the line that is not as it should be.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let text =
            fs::read_to_string(path).map_err(|source| ReadError::Refused { path: path.to_path_buf(), source })?;
        serde_json::from_str(&text).map_err(|error| ReadError::Malformed {
            path: path.to_path_buf(),
            line: error.line(),
            found: error.to_string(),
            expected: "a summary of this version".into(),
        })
    }
}

/// A hash as it stands in the summary: 32 hexadecimal digits.
pub fn hash_text(hash: u128) -> String {
    format!("{hash:032x}")
}

pub(super) fn json<T: Serialize + ?Sized>(value: &T) -> String {
    // Cannot fail: the keys are strings and nothing but memory is written to.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expectation::Bound;
    use crate::warning::Code;

    fn example() -> Summary {
        let mut summary =
            Summary { fractum: "0.1.0".into(), title: "Brazilian".into(), threads: 2, ..Default::default() };
        let probe = Probe { unit: "N".into(), r#final: f64::NAN, max: 1.5, min: -0.1, time_of_max: 1e-3 };
        summary.probes.insert("load".into(), probe);
        let bound = Bound::Near { value: 10_000.0, tolerance: 500.0, relative: Some(0.05) };
        summary.expect.push(Expectation::hold("strength", "Pa", 10_200.0, bound, "a paper"));
        summary.warnings.push(Warning::new(Code::Unused, "case.toml:3:1", "is not used"));
        summary.hashes.case_hash = hash_text(0xff);
        summary.wall.phases.insert("solid".into(), 1.25);
        summary
    }

    /// Every key of the contract, in its order.
    #[test]
    fn keys_are_those_of_the_contract() {
        let text = example().to_json();
        let mut rest = text.as_str();
        for key in [
            "fractum",
            "title",
            "status",
            "threads",
            "case_hash",
            "state_hash",
            "probes",
            "load",
            "unit",
            "final",
            "max",
            "min",
            "time_of_max",
            "expect",
            "quantity",
            "unit",
            "value",
            "reference",
            "comparison",
            "error",
            "tolerance",
            "pass",
            "source",
            "energy",
            "residual_max_relative",
            "counts",
            "nodes",
            "elements",
            "removed_elements",
            "crushed_elements",
            "particles",
            "bonds",
            "broken_bonds",
            "fragments",
            "warnings",
            "code",
            "text",
            "where",
            "remedy",
            "time",
            "steps",
            "dt",
            "dt_min",
            "end",
            "wall",
            "total",
            "phases",
            "solid",
        ] {
            let key = format!("\"{key}\":");
            let at = rest.find(&key).unwrap_or_else(|| panic!("{key} is missing or out of order in\n{text}"));
            rest = &rest[at + key.len()..];
        }
        assert!(text.contains("\"status\": \"completed\"") && text.contains(&format!("\"{:0>32}\"", "ff")));
    }

    #[test]
    fn every_entry_of_the_ledger_has_its_key_and_comes_back() {
        let mut energy = Energy { residual_max_relative: f64::NAN, ..Energy::default() };
        energy.entries.iter_mut().zip(1u8..).for_each(|(entry, value)| *entry = value.into());
        let json = serde_json::to_value(energy).unwrap();
        let keys = json.as_object().unwrap();
        assert_eq!(keys.len(), EnergyKind::COUNT + 1);
        assert!(EnergyKind::ALL.iter().all(|&kind| keys[kind.name()] == energy.entries[kind as usize]), "{json}");
        for name in "external kinetic elastic damage removed contact friction damping absorbed".split(' ') {
            assert!(keys.contains_key(name), "the contract of summary.json: {name}");
        }
        let back: Energy = serde_json::from_value(json).unwrap();
        assert!(back.entries == energy.entries && back.residual_max_relative.is_nan());
    }

    #[test]
    fn not_a_number_is_null_and_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        let summary = example();
        fs::write(&path, summary.to_json()).unwrap();
        assert!(fs::read_to_string(&path).unwrap().contains("\"final\": null"));
        let back = Summary::read(&path).unwrap();
        assert!(back.probes["load"].r#final.is_nan());
        assert_eq!(back.to_json(), summary.to_json());
    }

    #[test]
    fn a_torn_summary_is_refused_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        let text = example().to_json();
        fs::write(&path, &text[..text.len() / 2]).unwrap();
        assert!(matches!(Summary::read(&path).unwrap_err(), ReadError::Malformed { line, .. } if line > 10));
    }
}
