//! `[verify]`: the neighbours of a case, and what its references promise of them.

use fractum_pack::Arrangement;

use super::{names, parameters};
use crate::model::{
    Body, BodyKind, Clump, Expect, JointSource, LooseSource, Material, MeshSource, NEIGHBOURS, Neighbour,
    PackingSource, Promise, Solver, SolverKind, Turn, Verify,
};
use crate::reader::Table;
use crate::tree::{Node, Value};
use crate::{Diagnostic, Spanned, nearest};

/// Poisson's ratios of neighbours.
const POISSON_RATIOS: [f64; 4] = [0.0, 0.1, 0.3, 0.4];

/// Safeties of the time step of neighbours.
const SAFETIES: [f64; 2] = [0.6, 0.9];

/// Coordinations of neighbours where the case leaves it open.
const COORDINATIONS: [f64; 2] = [8.0, 11.0];

/// Sizes of neighbours: powers of two, which change no digit, near those of mm and km.
const SIZES: [(&str, f64); 2] = [("1/1024", 1.0 / 1024.0), ("1024", 1024.0)];

/// Largest move of a node of another mesh over its shortest edge.
const SCRAMBLED: f64 = 0.25;

/// What neighbours are made from.
pub(super) struct Around<'a> {
    pub(super) root: &'a Node,
    pub(super) materials: &'a [(String, Option<Material>)],
    pub(super) bodies: Option<&'a [Body]>,
    pub(super) solver: Option<&'a Solver>,
    pub(super) mesh: Option<&'a MeshSource>,
    pub(super) staged: bool,
}

/// By how much the whole case is larger than written; 1 where that is not said, or wrong.
pub(super) fn scale(root: &Node) -> f64 {
    let scale = match at(root, &["verify", "scale"]).map(|node| &node.value) {
        Some(Value::Number(value)) => *value,
        _ => 1.0,
    };
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}

fn at<'a>(root: &'a Node, path: &[&str]) -> Option<&'a Node> {
    path.iter().try_fold(root, |node, name| match &node.value {
        Value::Table(entries) => entries.iter().find(|entry| entry.name == *name).map(|entry| &entry.node),
        _ => None,
    })
}

pub(super) fn read(root: &Table<'_>, around: &Around<'_>, expect: Option<&[Expect]>) -> Verify {
    let table = root.table_or_empty("verify");
    let quick = table.flag("quick").or(false);
    // Read before everything else, by `scale`.
    let scale = table.read("scale", |node| match node.value {
        Value::Number(value) => Some(value),
        _ => {
            table.reader.note(Diagnostic::error(&node.place, node.found()).expected("a number such as 0.001"));
            None
        }
    });
    let scale = scale.check(|scale| (1e-9..=1e9).contains(scale), "from 1e-9 to 1e9").given();
    let scale = scale.filter(|scale| *scale != 1.0);
    let mut neighbours = around.neighbours();
    for own in table.tables("neighbours") {
        neighbours.extend(own_neighbour(&own));
        own.finish("here");
    }
    let promise = promise(&table);
    let place = table.place.clone();
    table.finish("here");
    let known: Vec<String> = neighbours.iter().map(Neighbour::name).collect();
    let known = || NEIGHBOURS.into_iter().chain(known.iter().map(String::as_str));
    let kind = |name: &str| name.split_once(' ').map_or(name.to_owned(), |(kind, _)| kind.to_owned());
    let of_expect = expect.into_iter().flatten().map(|expect| (&expect.promise, &expect.quantity.place));
    for (promise, place) in of_expect.chain([(&promise, &place)]) {
        let named = promise.holds_for.iter().flatten().chain(promise.excepted.iter().map(|(name, _)| name));
        // A kind that this case has not may be promised: it may have it with another solver.
        for name in
            named.filter(|name| !known().any(|known| known == *name) && !NEIGHBOURS.contains(&kind(name).as_str()))
        {
            let note = Diagnostic::error(place, format!("names \"{name}\", which is no neighbour of this case"));
            root.reader.note(match nearest(name, known()) {
                Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
                None => note.expected(format!("one of {}", known().collect::<Vec<_>>().join(", "))),
            });
        }
    }
    Verify { quick, scale, promise, neighbours }
}

/// `holds_for` and `excepted` of a table.
pub(super) fn promise(table: &Table<'_>) -> Promise {
    let texts = |key: &str| names::read(table, key, "neighbours").unwrap_or_default();
    let holds_for = table.has("holds_for").then(|| texts("holds_for").into_iter().map(|name| name.value).collect());
    let exception = |Spanned { value, place }: Spanned<String>| match value.split_once(": ") {
        Some((name, why)) if !why.trim().is_empty() => Some((name.trim().to_owned(), why.trim().to_owned())),
        _ => {
            let note = Diagnostic::error(&place, format!("= \"{value}\" has no reason"));
            table.reader.note(note.expected("a neighbour with the reason, such as \"seed: one small packing\""));
            None
        }
    };
    Promise { holds_for, excepted: texts("excepted").into_iter().filter_map(exception).collect() }
}

fn own_neighbour(table: &Table<'_>) -> Option<Neighbour> {
    let name = table.text("name").required();
    let set = names::read(table, "set", "keys with values");
    if !table.has("set") {
        table.reader.note_missing(&table.place_of("set"), "what differs, such as [\"mesh.file=fine.msh\"]");
    }
    let pair = |Spanned { value, place }: Spanned<String>| {
        let pair = value.split_once('=').map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()));
        if pair.is_none() {
            let note = Diagnostic::error(&place, format!("= \"{value}\" sets nothing"));
            table.reader.note(note.expected("a key with its value, such as \"mesh.file=fine.msh\""));
        }
        pair
    };
    let set = set?.into_iter().map(pair).collect::<Option<Vec<_>>>()?;
    Some(Neighbour { kind: name?, value: String::new(), set })
}

impl Around<'_> {
    /// Those that the program makes of this case.
    fn neighbours(&self) -> Vec<Neighbour> {
        let mut all = Vec::new();
        let mut add = |kind: &str, value: &str, set: Vec<(String, String)>| {
            if !set.is_empty() {
                all.push(Neighbour { kind: kind.to_owned(), value: value.to_owned(), set });
            }
        };
        for (value, more) in [("+1", 1), ("+2", 2)] {
            add("seed", value, self.seeds(more));
        }
        for ratio in POISSON_RATIOS {
            add("poisson_ratio", &ratio.to_string(), self.poisson_ratio(ratio));
        }
        if let Some(solver) = self.solver.filter(|solver| solver.kind == SolverKind::Explicit && solver.step.is_none())
        {
            for safety in SAFETIES.into_iter().filter(|safety| *safety != solver.safety) {
                let key = if self.staged { "stages[*].solver.safety" } else { "solver.safety" };
                add("safety", &safety.to_string(), vec![(key.to_owned(), safety.to_string())]);
            }
        }
        if self.bodies.into_iter().flatten().any(|body| matches!(body.kind, BodyKind::Solid(_))) {
            add("mesh", "", vec![("mesh.scramble.share".to_owned(), SCRAMBLED.to_string())]);
            add("half", "", vec![("mesh.halvings".to_owned(), "1".to_owned())]);
        }
        for index in 0..COORDINATIONS.len() {
            let (value, set) = self.coordination(index);
            add("coordination", &value, set);
        }
        for (value, size) in SIZES {
            add("size", value, vec![("verify.scale".to_owned(), format!("{size:?}"))]);
        }
        all
    }

    fn seeds(&self, more: u64) -> Vec<(String, String)> {
        let mut set = Vec::new();
        for (index, body) in self.bodies.into_iter().flatten().enumerate() {
            let seed = match &body.kind {
                BodyKind::Bonded(bonded) => match bonded.packing {
                    PackingSource::Shape { seed, arrangement: Arrangement::Random, .. } => Some(seed),
                    _ => None,
                },
                BodyKind::Particles(loose) => match loose.source {
                    LooseSource::Cloud { seed, .. } | LooseSource::Graded { seed, .. } => Some(seed),
                    LooseSource::Inlet { ref stream, .. } => Some(stream.seed),
                    LooseSource::File { .. } | LooseSource::Single { .. } => match &loose.clump {
                        Some(Spanned { value: Clump { turn: Turn::ByChance(seed), .. }, .. }) => Some(*seed),
                        _ => None,
                    },
                },
                BodyKind::Solid(_) | BodyKind::Rigid(_) => None,
            };
            set.extend(seed.map(|seed| (format!("bodies[{index}].seed"), (seed + more).to_string())));
        }
        for (index, zone) in self.mesh.into_iter().flat_map(|mesh| &mesh.refine).enumerate() {
            set.extend(zone.seed.map(|seed| (format!("mesh.refine[{index}].seed"), (seed + more).to_string())));
        }
        if let Some(network) = self.mesh.map(|mesh| &mesh.network) {
            for (index, joints) in network.joints.iter().enumerate() {
                if let JointSource::Set(known) = &joints.source {
                    set.push((format!("mesh.joints[{index}].seed"), (known.seed + more).to_string()));
                }
            }
            set.extend(
                network.grains.iter().map(|own| ("mesh.grains.seed".to_owned(), (own.grains.seed + more).to_string())),
            );
        }
        for material in self.materials.iter().filter_map(|(_, material)| material.as_ref()) {
            let scatter = material.damage.as_ref().and_then(|damage| damage.value.scatter.as_ref());
            let key = format!("materials.{}.damage.scatter.seed", material.name.value);
            set.extend(scatter.map(|scatter| (key, (scatter.seed + more).to_string())));
        }
        set
    }

    /// Poisson's ratio of all solids and bonded bodies; by its parameter where it is one, so that references may be functions of it.
    fn poisson_ratio(&self, ratio: f64) -> Vec<(String, String)> {
        let of_body = |body: &Body| match &body.kind {
            BodyKind::Solid(solid) => Some(solid.material),
            BodyKind::Bonded(bonded) => Some(bonded.material),
            BodyKind::Particles(_) | BodyKind::Rigid(_) => None,
        };
        let used: Vec<usize> = self.bodies.into_iter().flatten().filter_map(of_body).collect();
        let materials = self.materials.iter().enumerate().filter(|(index, _)| used.contains(index));
        let materials: Vec<&Material> = materials.filter_map(|(_, (_, material))| material.as_ref()).collect();
        if materials.iter().all(|material| material.poisson_ratio == ratio) {
            return Vec::new();
        }
        let declared = parameters::declared(self.root);
        let mut set: Vec<(String, String)> = Vec::new();
        for material in materials {
            let name = &material.name.value;
            let written = match at(self.root, &["materials", name, "poisson_ratio"]).map(|node| &node.value) {
                Some(Value::Text(text)) if declared.iter().any(|known| known == text.trim()) => text.trim().to_owned(),
                _ => format!("materials.{name}.poisson_ratio"),
            };
            if !set.iter().any(|(key, _)| *key == written) {
                set.push((written, ratio.to_string()));
            }
        }
        set
    }

    /// One more bond to a particle, or less, than the case asks for.
    fn coordination(&self, index: usize) -> (String, Vec<(String, String)>) {
        let (mut shown, mut set) = (String::new(), Vec::new());
        for (number, body) in self.bodies.into_iter().flatten().enumerate() {
            let BodyKind::Bonded(bonded) = &body.kind else { continue };
            let given = self.materials.get(bonded.material).and_then(|(_, material)| material.as_ref());
            let has_bonds = given.is_none_or(|material| material.bonds.is_some() || material.interfaces.is_some());
            if has_bonds || !matches!(bonded.packing, PackingSource::Shape { .. }) {
                continue;
            }
            let value =
                bonded.coordination.as_ref().map_or(COORDINATIONS[index], |asked| asked.value + [-1.0, 1.0][index]);
            shown = value.to_string();
            set.push((format!("bodies[{number}].coordination"), shown.clone()));
        }
        (shown, set)
    }
}
