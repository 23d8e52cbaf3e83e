//! Fields of solids that frames have where the case asks for them.

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

            /// That key from the top of a case.
            pub fn path(self) -> &'static str {
                match self {
                    $(OutputField::$variant => concat!("output.fields.", $key),)+
                }
            }

            /// What it means, in a line.
            pub fn doc(self) -> &'static str {
                match self {
                    $(OutputField::$variant => $doc,)+
                }
            }
        }
    };
}

output_fields! {
    Principal, "principal", "Write the three principal stresses of elements, each with its direction";
    Strain, "strain", "Write the strain of elements, thermal strain included";
    Reaction, "reaction", "Write the forces of supports on nodes";
    Fragment, "fragment", "Write the number of the fragment that each node belongs to, as in fragments.csv; 0 for single nodes";
    Xyz, "xyz", "Write the particles of bonded and loose bodies as extended xyz too, at their present positions, for OVITO: particles/particles-00000.xyz";
    Contacts, "contacts", "Write the contacts of bonded and loose particles with each other, rigid bodies and solids as lines, with their forces: contacts/contacts-00000.vtp";
}

/// The fields that a case asks for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OutputFields {
    /// A bit for each, by its place in [`OutputField::ALL`].
    wanted: u64,
}

impl OutputFields {
    /// Those that fulfil a condition.
    pub fn of(is_wanted: impl Fn(OutputField) -> bool) -> Self {
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
