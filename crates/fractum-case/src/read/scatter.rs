//! `scatter`: strength by chance.

use crate::Diagnostic;
use crate::model::{Distribution, Reference, Scatter, Weibull};
use crate::reader::Table;

#[derive(Clone, Copy)]
enum Kind {
    Weibull,
    WeibullPerEdge,
    UniformPerEdge,
}

/// That of the edges of solids.
pub(super) fn of_edges(table: Table<'_>) -> Option<Scatter> {
    let names = [
        ("weibull", Kind::Weibull),
        ("weibull-per-edge", Kind::WeibullPerEdge),
        ("uniform-per-edge", Kind::UniformPerEdge),
    ];
    let kind = table.one_of("distribution", &names).required();
    let modulus = |table: &Table<'_>| table.quantity("modulus").positive().required();
    let without = |table: &Table<'_>, keys: &[&'static str]| {
        keys.iter().for_each(|key| table.refuse(key, "with this distribution"));
    };
    let of_volume = ["reference_volume", "reference_area", "correlation_length"];
    let distribution = match kind {
        Some(Kind::Weibull) => {
            without(&table, &["width"]);
            let missing = "set reference_volume, that of the specimens that gave the strength (or reference_area of glass); \
                           distribution = \"weibull-per-edge\" is the factor per edge without a volume, which depends on the mesh";
            weibull(&table, true, missing).map(Distribution::Weibull)
        }
        Some(Kind::WeibullPerEdge) => {
            without(&table, &["width"]);
            without(&table, &of_volume);
            modulus(&table).map(|modulus| Distribution::WeibullPerEdge { modulus })
        }
        Some(Kind::UniformPerEdge) => {
            without(&table, &["modulus"]);
            without(&table, &of_volume);
            let width = table.quantity("width").between(0.0, 1.0).required();
            width.map(|width| Distribution::UniformPerEdge { width })
        }
        None => {
            table.pass_over(&["modulus", "width"]);
            table.pass_over(&of_volume);
            None
        }
    };
    let seed = table.integer("seed").or(1);
    table.finish("here");
    Some(Scatter { distribution: distribution?, seed })
}

/// That of the particles of bonded bodies: Weibull's by volume.
pub(super) fn of_particles(table: Table<'_>) -> Option<Scatter> {
    let missing = "set reference_volume, that of the specimens that gave the strength";
    let weibull = weibull(&table, false, missing);
    let seed = table.integer("seed").or(1);
    table.finish("here");
    Some(Scatter { distribution: Distribution::Weibull(weibull?), seed })
}

/// - `missing`: remedy where no reference is given
fn weibull(table: &Table<'_>, has_area: bool, missing: &str) -> Option<Weibull> {
    let modulus = table.quantity("modulus").positive().required();
    let is_area = has_area && table.has("reference_area");
    let reference = if is_area {
        table.refuse("reference_volume", "beside reference_area: flaws lie in the volume or on the free surface");
        table.quantity("reference_area").positive().given().map(Reference::Area)
    } else if table.has("reference_volume") {
        table.quantity("reference_volume").positive().given().map(Reference::Volume)
    } else {
        let note = Diagnostic::error(&table.place, "has no reference volume")
            .expected("the volume that the strength belongs to: larger bodies are weaker");
        table.reader.note(note.remedy(missing));
        None
    };
    let correlation_length = table.quantity("correlation_length").positive().map(Some).or_if_absent(None);
    Some(Weibull { modulus: modulus?, reference: reference?, correlation_length: correlation_length? })
}
