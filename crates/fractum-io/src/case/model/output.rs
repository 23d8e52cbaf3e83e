//! What a run writes.

use super::{Gauges, Plot, Ppv};
use crate::case::key_kind::{KeyDoc, KeyKind};

/// The list of fields of solids that frames have where the case asks for them: variant, key in `[output.fields]`, its meaning.
macro_rules! output_fields {
    ($($variant:ident, $key:literal, $doc:literal;)+) => {
        /// A field of solids that frames have where the case asks for it.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum OutputField {
            $(#[doc = $doc] $variant,)+
        }

        impl OutputField {
            /// All, in the order in which frames have them.
            pub const ALL: &[OutputField] = &[$(OutputField::$variant),+];

            /// Its key in the table `output.fields`.
            pub fn key(self) -> &'static str {
                match self {
                    $(OutputField::$variant => $key,)+
                }
            }
        }

        /// Their keys.
        pub(crate) static FIELD_KEYS: &[KeyDoc] = &[$(KeyDoc {
            path: concat!("output.fields.", $key),
            kind: KeyKind::Flag,
            default: "false",
            doc: $doc,
        }),+];
    };
}

output_fields! {
    Principal, "principal", "Write the three principal stresses of elements, each with its direction";
    Strain, "strain", "Write the strain of elements, thermal strain included";
    Reaction, "reaction", "Write the forces of supports on nodes";
    Fragment, "fragment", "Write the number of the fragment that each node belongs to, as in fragments.csv; 0 for single nodes";
}

/// The fields that a case asks for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OutputFields {
    /// A bit for each, by its place in [`OutputField::ALL`].
    wanted: u64,
}

impl OutputFields {
    /// Those that fulfil a condition.
    pub(crate) fn of(is_wanted: impl Fn(OutputField) -> bool) -> Self {
        let bit = |field: &OutputField| if is_wanted(*field) { 1 << *field as u32 } else { 0 };
        OutputFields { wanted: OutputField::ALL.iter().map(bit).sum() }
    }

    /// Whether this one is wanted.
    pub fn has(self, field: OutputField) -> bool {
        self.wanted & (1 << field as u32) != 0
    }

    /// The wanted ones, in their order.
    pub fn iter(self) -> impl Iterator<Item = OutputField> {
        OutputField::ALL.iter().copied().filter(move |field| self.has(*field))
    }
}

/// What is written, and how often.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// What frames hold besides what they always do.
    pub fields: OutputFields,
    /// Time between fields [s].
    pub fields_every: f64,
    /// Files that solids and particles of a frame are cut into, from 1.
    pub frame_pieces: usize,
    /// Time between rows of the history [s].
    pub history_every: f64,
    /// Wall time between checkpoints [s].
    pub checkpoint_every: f64,
    /// Share of its strength that an edge may have lost and still join a fragment, above 0 up to 1.
    pub joined_below: f64,
    /// Peak particle velocity against distance.
    pub ppv: Vec<Ppv>,
    /// Grids of places with displacement and strain.
    pub gauges: Vec<Gauges>,
    /// Charts of the user's own in the report.
    pub plots: Vec<Plot>,
}
