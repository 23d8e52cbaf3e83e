//! What probes measure: a file for each, with its keys, how it is read, what it is in a scene, and its value.
//!
//! A further one is its file and its line in the list `measures!`.

mod angular_momentum;
mod contact_force;
mod count;
mod crack;
mod crack_area;
mod damaged;
mod displacement;
mod energy;
mod expression;
mod extensometer;
mod fragment;
mod fragment_size;
mod gas;
mod heat;
mod liquid;
mod load;
mod mode;
mod moment;
mod momentum;
mod periodic_box;
mod radial_cracks;
mod reaction;
mod rotation;
mod scenery;
mod strain;
mod stress;
mod surface;
mod tables;
mod temperature;
mod velocity;
mod wave_speed;
mod work;

use fractum_scene::Probe;

use super::Spanned;
use super::key_kind::KeyDoc;
use super::reader::Table;
use super::selection::{GroupUse, Selection};
use super::unit::Dimension;
pub use expression::{ProbeExpression, ProbeInput, Take};
pub(crate) use scenery::{Names, Scenery};

/// Something that probes measure.
pub(crate) trait Measure: Sized {
    /// Its key in `[[probes]]`.
    const KEY: &'static str;
    /// Its rows of the list of keys.
    const KEYS: &'static [KeyDoc];
    /// Unit of its values where the dimension does not say it.
    const UNIT: Option<&'static str> = None;

    /// Reads it from the table of the probe, with the dimension of its values.
    fn read(probe: &Table<'_>) -> Option<(Self, Dimension)>;

    /// The mesh group that it names.
    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        None
    }

    /// The selection of which it is, where that may be one of particles.
    fn may_be_particles(&self) -> Option<&Selection> {
        None
    }

    /// What to take instead in space, where only plane solids have it.
    fn instead_in_space(&self) -> Option<&'static str> {
        None
    }

    /// What it is in a scene; notes what is wrong, and then gives nothing.
    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>>;
}

/// The list of what probes measure, in the order of the documentation: file and type.
macro_rules! measures {
    ($($file:ident::$Kind:ident,)+) => {
        $(pub use $file::$Kind;)+

        /// What a probe measures, or the expression that it is.
        #[derive(Debug, Clone, PartialEq)]
        #[allow(missing_docs)] // the types say it
        pub enum ProbeKind {
            $($Kind($Kind),)+
            /// Expression of other probes, all declared before this one.
            Expression(ProbeExpression),
        }

        /// Keys of what probes measure.
        pub(crate) const NAMES: &[&str] = &[$($Kind::KEY),+];

        /// Rows of the list of keys.
        pub(crate) fn keys() -> Vec<KeyDoc> {
            [$($Kind::KEYS),+].concat()
        }

        /// Reads what a probe measures, with its dimension and the unit that this does not say.
        pub(crate) fn read(probe: &Table<'_>, key: &str) -> Option<(ProbeKind, Dimension, Option<&'static str>)> {
            $(if key == $Kind::KEY {
                return $Kind::read(probe).map(|(measure, dimension)| (ProbeKind::$Kind(measure), dimension, $Kind::UNIT));
            })+
            None
        }

        impl ProbeKind {
            /// The mesh group that it names.
            pub(crate) fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
                match self {
                    $(ProbeKind::$Kind(measure) => measure.group(),)+
                    ProbeKind::Expression(_) => None,
                }
            }

            /// The selection of which it is, where that may be one of particles.
            pub(crate) fn may_be_particles(&self) -> Option<&Selection> {
                match self {
                    $(ProbeKind::$Kind(measure) => measure.may_be_particles(),)+
                    ProbeKind::Expression(_) => None,
                }
            }

            /// What to take instead in space, where only plane solids have it.
            pub(crate) fn instead_in_space(&self) -> Option<&'static str> {
                match self {
                    $(ProbeKind::$Kind(measure) => measure.instead_in_space(),)+
                    ProbeKind::Expression(_) => None,
                }
            }

            /// What it is in a scene; none for expressions, and where something is wrong, which is noted.
            pub(crate) fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
                match self {
                    $(ProbeKind::$Kind(measure) => measure.resolve(scene),)+
                    ProbeKind::Expression(_) => None,
                }
            }
        }
    };
}

measures! {
    reaction::Reaction,
    moment::Moment,
    displacement::Displacement,
    velocity::Velocity,
    rotation::Rotation,
    contact_force::ContactForce,
    stress::Stress,
    strain::Strain,
    extensometer::ExtensometerBetween,
    load::LoadOn,
    surface::Surface,
    fragment::FragmentOf,
    fragment_size::FragmentSize,
    energy::Energy,
    count::Count,
    momentum::Momentum,
    angular_momentum::AngularMomentum,
    temperature::Temperature,
    heat::HeatOfAll,
    gas::GasIn,
    liquid::LiquidIn,
    periodic_box::PeriodicBox,
    crack_area::CrackArea,
    crack::Crack,
    radial_cracks::RadialCracksAbout,
    damaged::Damaged,
    wave_speed::WaveSpeed,
    work::WorkOf,
    mode::ModeOf,
}
