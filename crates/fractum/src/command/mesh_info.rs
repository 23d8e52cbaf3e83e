//! What a mesh holds, how good it is, and what a material needs of it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use fractum_case::{Case, printable};
use fractum_fem::EXCESS_OF_PEAK;
use fractum_mesh::bodies::{SolidElements, bodies};
use fractum_mesh::quality::{Lengths, Summary};
use fractum_mesh::{Group, Mesh};
use fractum_output::number::{grouped, quantity, significant};
use serde_json::{Value, json};

/// Part of the process zone that edges must not exceed for loads of cracks within 5 %.
const ACCURATE: f64 = 0.05 / EXCESS_OF_PEAK[0];

/// What a case asks of its mesh.
pub(super) struct Demand {
    /// Length of the unit of the mesh [m].
    unit: f64,
    /// Materials that crack.
    zones: Vec<Zone>,
}

/// What a material that cracks asks for.
struct Zone {
    material: String,
    /// Process zone E G_f/f_t² [m].
    length: f64,
    /// Characteristic length of an element that its softening allows [m].
    most: f64,
}

impl Demand {
    pub(super) fn of(case: &Case) -> Self {
        let zone = |material: &fractum_case::model::Material| {
            let law = &material.damage.as_ref()?.value.law;
            let (modulus, name) = (material.young_modulus, material.name.value.clone());
            let most = law.softening.largest_length(modulus, law.tensile_strength, law.fracture_energy);
            Some(Zone { material: name, length: material.process_zone()?, most })
        };
        Demand {
            unit: case.mesh.as_ref().map_or(1.0, |mesh| mesh.unit.length),
            zones: case.materials.iter().filter_map(zone).collect(),
        }
    }
}

/// The elements that solids are made of: tetrahedra, or where there are none triangles.
struct Solids {
    what: &'static str,
    lengths: Lengths,
    summary: Summary,
}

impl Solids {
    fn of(elements: &SolidElements, mesh: &Mesh) -> Option<Self> {
        let (lengths, summary) = elements.quality(&mesh.nodes)?;
        Some(Solids { what: elements.what(), lengths, summary })
    }

    /// As JSON values of edges and quality.
    fn json(&self, unit: f64) -> [Value; 2] {
        let Solids { lengths, summary, .. } = self;
        let [shortest, mean, longest] = [lengths.shortest, lengths.mean, lengths.longest].map(|length| unit * length);
        let quality = json!({
            "mean_radius_ratio": summary.mean_radius_ratio,
            "worst_radius_ratio": summary.worst_radius_ratio.value,
            "smallest_angle": summary.smallest_angle.value,
            "largest_angle": summary.largest_angle.value,
            "shortest_altitude": unit * summary.shortest_altitude.value,
        });
        [json!({ "shortest": shortest, "mean": mean, "longest": longest }), quality]
    }
}

/// Kinds of elements with their numbers.
fn element_counts(mesh: &Mesh) -> [(&'static str, usize); 4] {
    [
        ("points", mesh.points.len()),
        ("lines", mesh.lines.len()),
        ("triangles", mesh.triangles.len()),
        ("tetrahedra", mesh.tetrahedra.len()),
    ]
}

/// All of it as one JSON value.
pub(super) fn json(file: &Path, mesh: &Mesh, demand: Option<&Demand>) -> Value {
    let unit = demand.map_or(1.0, |demand| demand.unit);
    let (low, high) = mesh.bounding_box();
    let group = |group: &Group| json!({ "name": group.name, "dimension": group.dimension, "tag": group.tag, "elements": group.element_count() });
    let mut value = json!({
        "file": file.display().to_string(),
        "nodes": mesh.nodes.len(),
        "elements": BTreeMap::from(element_counts(mesh)),
        "lower": (low * unit).as_slice(),
        "upper": (high * unit).as_slice(),
        "groups": mesh.groups.iter().map(group).collect::<Vec<_>>(),
        "notices": mesh.notices,
        "hints": fractum_mesh::hints(mesh),
    });
    if let Some(solids) = Solids::of(&SolidElements::of_mesh(mesh), mesh) {
        [value["edges"], value["quality"]] = solids.json(unit);
    }
    let body = |(group, elements): &(&Group, SolidElements)| {
        let [edges, quality] = Solids::of(elements, mesh)?.json(unit);
        Some(json!({ "name": group.name, "elements": elements.count(), "edges": edges, "quality": quality }))
    };
    value["bodies"] = bodies(mesh).iter().filter_map(body).collect();
    if let Some(demand) = demand {
        let zone = |zone: &Zone| (zone.material.clone(), json!(zone.length));
        value["process_zones"] = Value::Object(demand.zones.iter().map(zone).collect());
    }
    value
}

/// All of it in lines. Names of groups come from the mesh: no terminal must obey them.
pub(super) fn text(file: &Path, mesh: &Mesh, demand: Option<&Demand>) -> String {
    let count = |count: usize| grouped(&count.to_string());
    let mut text = format!("{}: {} nodes", printable(&file.display().to_string()), count(mesh.nodes.len()));
    for (name, number) in element_counts(mesh).into_iter().filter(|(_, count)| *count > 0) {
        let _ = write!(text, "\n  {:>9} {name}", count(number));
    }
    // A mesh has no unit of its own.
    let unit = demand.map(|demand| demand.unit);
    let length = |value: f64| unit.map_or_else(|| significant(value, 4), |unit| quantity(unit * value, "m"));
    let (low, high) = mesh.bounding_box();
    let extent = |axis: usize| format!("{} to {}", length(low[axis]), length(high[axis]));
    let _ = write!(text, "\n  x {}, y {}, z {}", extent(0), extent(1), extent(2));
    for group in &mesh.groups {
        let (name, dimension, tag) = (printable(&group.name), group.dimension, group.tag);
        let elements = count(group.element_count());
        let _ = write!(text, "\n  group \"{name}\" (dimension {dimension}, tag {tag}): {elements} elements");
    }
    let all = SolidElements::of_mesh(mesh);
    if let Some(solids) = Solids::of(&all, mesh) {
        text += &quality_lines(&solids, &length);
        for (group, elements) in bodies(mesh).iter().filter(|(_, elements)| elements.count() < all.count()) {
            let own = Solids::of(elements, mesh).map_or_else(String::new, |own| body_line(&group.name, &own, &length));
            text += &own;
        }
        demand.iter().for_each(|demand| text += &zone_lines(&solids, demand));
    }
    for notice in &mesh.notices {
        let _ = write!(text, "\n  {}", printable(notice));
    }
    for hint in fractum_mesh::hints(mesh) {
        let _ = write!(text, "\n  hint: {}", printable(&hint));
    }
    text
}

fn quality_lines(solids: &Solids, length: &dyn Fn(f64) -> String) -> String {
    let Solids { what, lengths, summary } = solids;
    let degrees = |angle: f64| significant(angle.to_degrees(), 2);
    format!(
        "\n  edges of {what}: {} to {}, mean {}\
         \n  quality: radius ratio {} on average, {} at worst (1 is equilateral, 0 flat); angles {} to {} deg\
         \n  shortest altitude {}, which limits the time step",
        length(lengths.shortest),
        length(lengths.longest),
        length(lengths.mean),
        significant(summary.mean_radius_ratio, 2),
        significant(summary.worst_radius_ratio.value, 2),
        degrees(summary.smallest_angle.value),
        degrees(summary.largest_angle.value),
        length(summary.shortest_altitude.value),
    )
}

/// What a body has for itself.
fn body_line(name: &str, Solids { what, lengths, summary }: &Solids, length: &dyn Fn(f64) -> String) -> String {
    format!(
        "\n  group \"{}\": edges of {what} {} to {}, mean {}; radius ratio {} on average, {} at worst; shortest altitude {}",
        printable(name),
        length(lengths.shortest),
        length(lengths.longest),
        length(lengths.mean),
        significant(summary.mean_radius_ratio, 2),
        significant(summary.worst_radius_ratio.value, 2),
        length(summary.shortest_altitude.value),
    )
}

/// Edges beside what each material needs.
fn zone_lines(solids: &Solids, demand: &Demand) -> String {
    let [shortest, longest] = [solids.lengths.shortest, solids.lengths.longest].map(|length| demand.unit * length);
    let line = |&Zone { ref material, length, most }: &Zone| {
        let accurate = ACCURATE * length;
        let verdict = match (shortest, longest) {
            (_, longest) if longest <= accurate => "fine everywhere",
            (shortest, longest) if shortest <= accurate && longest <= most => {
                "fine where edges are short, coarse elsewhere"
            }
            (shortest, _) if shortest <= accurate => {
                "fine where edges are short; long ones cannot crack (damage_where)"
            }
            (shortest, _) if shortest <= most => "coarse: the peak load will be too high; refine where cracks go",
            _ => "too coarse to crack: refine where cracks go",
        };
        let [zone, most, accurate] = [length, most, accurate].map(|length| quantity(length, "m"));
        format!(
            "\n  {}: process zone E Gf/ft\u{b2} = {zone}; where cracks go, edges below {most}, for loads within 5 % below \
             {accurate}: {verdict}",
            printable(material)
        )
    };
    demand.zones.iter().map(line).collect()
}
