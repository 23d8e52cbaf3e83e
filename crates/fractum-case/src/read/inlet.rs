//! `bodies[].inlet`: loose particles that come into the run as time goes on.

use crate::model::{LooseSource, Rate, Region, Sizes, Stream};
use crate::reader::Table;
use crate::reader::presence::{exactly_one, optional};
use crate::{Diagnostic, Place, Spanned};

/// When particles come, and how many.
pub(super) struct Inlet {
    rate: Rate,
    place: Place,
    from: f64,
    until: Option<f64>,
}

/// Reads how particles of a body come in.
///
/// - `is_counted`: whether the body has a number of particles, which ends the stream
pub(super) fn inlet(body: &Table<'_>, is_counted: bool) -> Option<Inlet> {
    let table = body.table("inlet")?;
    let rate = match exactly_one(&table, &["mass_rate", "number_rate"]) {
        Some("mass_rate") => table.quantity("mass_rate").positive().map(Rate::Mass).spanned().required(),
        Some(_) => table.quantity("number_rate").positive().map(Rate::Number).spanned().required(),
        None => {
            table.pass_over(&["mass_rate", "number_rate"]);
            None
        }
    };
    let from = table.quantity("from").check(|from| *from >= 0.0, "0 or more").or_if_absent(0.0);
    let until = optional(&table, "until", |name| table.quantity(name).positive().given());
    if !table.has("until") && !is_counted {
        let note = Diagnostic::error(&table.place, "has no until, and the body no particles");
        table.reader.note(note.expected("the time until which particles come, or their number (bodies[].particles)"));
    }
    if let (Some(from), Some(Some(until))) = (from, until)
        && until <= from
    {
        let note = Diagnostic::error(&table.place_below("until"), "is not after from");
        table.reader.note(note.expected("a time after from, at which particles begin to come"));
        table.finish("here");
        return None;
    }
    table.finish("here");
    let Spanned { value: rate, place } = rate?;
    let (from, until) = (from?, until?);
    (until.is_some() || is_counted).then_some(Inlet { rate, place, from, until })
}

impl Inlet {
    /// The particles that come in through a region.
    pub(super) fn source(
        self,
        region: Spanned<Region>,
        sizes: Sizes,
        most: Option<u64>,
        seed: u64,
    ) -> Option<LooseSource> {
        let Inlet { rate, place, from, until } = self;
        let stream = Stream { region: region.value, sizes, rate, from, until, most, seed };
        Some(LooseSource::Inlet { stream, region: region.place, rate: place })
    }
}
