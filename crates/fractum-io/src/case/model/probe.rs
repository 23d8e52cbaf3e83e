//! Probes: the numbers a run records.

use fractum_dem::StrainMeasure;
use fractum_dem::crack_shape::Axis;
use fractum_fem::Wave;
use fractum_math::Vec3;
use fractum_scene::{
    Along, CountKind, CrackMeasure, DamagedMeasure, EnergyProbe, FragmentMeasure, GasMeasure, HeatMeasure,
    RadialMeasure, SurfaceMeasure, TemperatureTake,
};

use super::Selection;
use crate::case::choice::choice;
use crate::case::expression::Program;
use crate::case::{Choice, Field, Spanned};

/// A named number recorded in the history, or computed from it at the end of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Name, unique among probes.
    pub name: Spanned<String>,
    /// SI unit of its values, as printed; `1` for a pure number.
    pub unit: String,
    /// What it measures.
    pub kind: ProbeKind,
    /// Time from one measurement to the next; rows between repeat the value [s]. Every row measures if absent.
    pub every: Option<f64>,
}

impl Probe {
    /// Whether it is one number at the end of the run, rather than a column of the history.
    pub fn is_scalar(&self) -> bool {
        matches!(&self.kind, ProbeKind::Expression(expression) if expression.scalar)
    }
}

/// Index and unit of the probe that measures the load: the first force with a column of its own, else the first moment.
pub fn load_of(probes: &[Probe]) -> Option<(usize, &'static str)> {
    let first = |unit| {
        let index = probes.iter().position(|probe| probe.unit == unit && !probe.is_scalar());
        index.map(|index| (index, unit))
    };
    ["N", "N m"].into_iter().find_map(first)
}

/// What a probe measures.
#[derive(Debug, Clone, PartialEq)]
pub enum ProbeKind {
    /// Sum of support reactions [N].
    Reaction {
        /// On these nodes or particles.
        on: Selection,
        /// Which component.
        along: Along,
    },
    /// Moment of support reactions about an axis [N m].
    Moment {
        /// On these nodes.
        on: Selection,
        /// The axis.
        about: Axis,
    },
    /// Mean displacement [m].
    Displacement {
        /// Of these nodes or particles.
        on: Selection,
        /// Which component.
        along: Along,
    },
    /// Mean velocity [m/s].
    Velocity {
        /// Of these nodes or particles.
        on: Selection,
        /// Which component.
        along: Along,
    },
    /// Rotation of a set of points as a whole about an axis through its centre, for small angles [rad].
    Rotation {
        /// Of these nodes or particles.
        on: Selection,
        /// Unit vector.
        along: Vec3,
    },
    /// Force of contact of one body on another [N].
    ContactForce {
        /// Name of the body that feels it.
        on: Spanned<String>,
        /// Name of the body that it comes from.
        from: Spanned<String>,
        /// Which component, at each place of contact.
        along: Along,
    },
    /// Volume mean of a stress component over elements, or virial stress of particles [Pa].
    Stress {
        /// Elements by their middles, or particles.
        on: Selection,
        /// Normal of the plane, and direction of the stress on it.
        between: [Along; 2],
    },
    /// Mean strain of nodes or particles [-].
    Strain {
        /// The points.
        on: Selection,
        /// How it is defined.
        measure: StrainMeasure,
        /// The two directions of the component.
        between: [Along; 2],
    },
    /// Elongation between two places over their distance [-].
    Extensometer {
        /// The points.
        on: Selection,
        /// Places of its feet without load [m].
        ends: [Vec3; 2],
        /// Diameter of its feet [m]; the nearest point if absent.
        foot: Option<f64>,
    },
    /// Sum of the loads on nodes [N].
    Load {
        /// On these nodes.
        on: Selection,
        /// Which component.
        along: Along,
    },
    /// Something about facets as they are at present.
    Surface {
        /// Facets by their group, by their nodes, or both.
        on: Selection,
        /// What about them.
        measure: SurfaceMeasure,
    },
    /// Something about the fragment that holds the first of some nodes.
    Fragment {
        /// The nodes.
        on: Selection,
        /// What about it.
        measure: FragmentMeasure,
        /// Unit vector of a velocity.
        along: Vec3,
    },
    /// Size below which this share of the mass of all fragments lies [m].
    FragmentSize(f64),
    /// An entry of the energy ledger, or its residual [J].
    Energy(EnergyProbe),
    /// A count [-].
    Count(CountKind),
    /// Linear momentum of the scene along a unit vector [kg m/s].
    Momentum {
        /// Unit vector.
        along: Vec3,
    },
    /// Angular momentum of the scene about the origin, along a unit vector [kg m²/s].
    AngularMomentum {
        /// Unit vector.
        along: Vec3,
    },
    /// Something about the gas.
    Gas {
        /// What about it.
        measure: GasMeasure,
        /// Group of the hole; everything if absent.
        group: Option<Spanned<String>>,
    },
    /// Temperature [K].
    Temperature {
        /// Of these nodes or particles.
        on: Selection,
        /// Which of them.
        take: TemperatureTake,
    },
    /// Something about the heat of everything [J].
    Heat(HeatMeasure),
    /// Area of the cracks [m²].
    CrackArea,
    /// How a crack lies, by its edges that have lost half of their strength and its broken bonds; or how much has separated.
    Crack {
        /// What about it.
        measure: CrackMeasure,
        /// Unit vector.
        along: Vec3,
        /// A point of the axis of a helix or cone [m].
        point: Vec3,
        /// Where edges and elements count, by the position of their middles; everywhere if absent.
        within: Option<Spanned<Field>>,
    },
    /// Cracks that run away from a hole.
    RadialCracks {
        /// What about them.
        measure: RadialMeasure,
        /// Axis of the hole.
        about: Axis,
        /// Radius of the circle on which they are counted [m].
        radius: f64,
        /// Where elements count, by the position of their middles; everywhere if absent.
        within: Option<Spanned<Field>>,
    },
    /// What is damaged.
    Damaged {
        /// What about it.
        measure: DamagedMeasure,
        /// Damage from which on an element counts [-].
        threshold: f64,
        /// Mesh group of elements; all elements that may be damaged if absent.
        group: Option<Spanned<String>>,
        /// Where elements count, by the position of their middles; everywhere if absent.
        within: Option<Spanned<Field>>,
    },
    /// Speed of a wave [m/s].
    WaveSpeed {
        /// Name of a solid body.
        body: Spanned<String>,
        /// Which wave.
        wave: Wave,
    },
    /// Expression of other probes, all declared before this one.
    Expression(ProbeExpression),
}

impl ProbeKind {
    /// The nodes, elements or particles that it measures; nothing for what only nodes or facets of solids have, or no points.
    pub fn on(&self) -> Option<&Selection> {
        match self {
            Self::Reaction { on, .. }
            | Self::Displacement { on, .. }
            | Self::Velocity { on, .. }
            | Self::Rotation { on, .. }
            | Self::Stress { on, .. }
            | Self::Strain { on, .. }
            | Self::Extensometer { on, .. }
            | Self::Temperature { on, .. } => Some(on),
            _ => None,
        }
    }
}

/// An expression of other probes.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeExpression {
    /// What the inputs of the program are.
    pub inputs: Vec<ProbeInput>,
    /// Whether it is one number at the end of the run: it reduces a history, or reads such a number.
    pub scalar: bool,
    pub(crate) program: Program,
}

impl ProbeExpression {
    /// Value for the given `inputs` (SI, in the order of `ProbeExpression::inputs`).
    pub fn value(&self, inputs: &[f64]) -> f64 {
        self.program.evaluate(inputs)
    }
}

/// An input of a probe expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProbeInput {
    /// The current time [s]; at the end of the run, its last.
    Time,
    /// Something about the probe of this index in `Case::probes`.
    Probe {
        /// Index into `Case::probes`.
        probe: usize,
        /// What about it.
        take: Take,
    },
}

/// What an expression takes from a probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Take {
    /// Its current value; at the end of the run, its last (or only) one.
    Current,
    /// Largest value of its history.
    Max,
    /// Smallest value of its history.
    Min,
    /// Largest absolute value of its history.
    AbsMax,
    /// Mean over time of its history.
    Mean,
    /// Last value of its history.
    Final,
    /// Time of the largest value [s].
    TimeOfMax,
    /// Least squares slope over the rows in which the value is another than in the row before.
    Speed,
    /// Value at this time [s], interpolated.
    At(f64),
    /// Least squares slope over the rows of the last time of this length [s].
    Slope(f64),
}

choice!(CrackMeasure {
    "angle" => Angle, "centre" => Centre, "front" => Front, "helix" => Helix, "cone" => Cone,
    "cone_share" => ConeShare, "area" => Area, "length" => Length, "count" => Count, "tip" => Tip,
});

choice!(StrainMeasure { "cundall" => Cundall, "bagi" => Bagi, "satake" => Satake });

choice!(RadialMeasure { "count" => Count, "longest" => Longest, "crushed_radius" => CrushedRadius });

choice!(DamagedMeasure { "volume" => Volume, "area" => Area, "share" => Share });

choice!(Wave { "compression" => Compression, "shear" => Shear, "rayleigh" => Rayleigh });

/// Components of the stress tensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StressComponent {
    /// σxx
    Xx,
    /// σyy
    Yy,
    /// σzz
    Zz,
    /// σxy
    Xy,
    /// σyz
    Yz,
    /// σzx
    Zx,
    /// Normal stress away from an axis.
    Radial,
    /// Normal stress around an axis.
    Tangential,
    /// Shear stress between both.
    RadialTangential,
}

choice!(StressComponent {
    "xx" => Xx, "yy" => Yy, "zz" => Zz, "xy" => Xy, "yz" => Yz, "zx" => Zx,
    "radial" => Radial, "tangential" => Tangential, "radial_tangential" => RadialTangential,
});

impl Choice for EnergyProbe {
    const NAMES: &'static [(&'static str, Self)] = &EnergyProbe::NAMES;
}

choice!(CountKind {
    "removed_elements" => RemovedElements, "broken_edges" => BrokenEdges, "damaged_edges" => DamagedEdges,
    "particles" => Particles, "fragments" => Fragments, "contacts" => Contacts,
    "bonds" => Bonds, "broken_bonds" => BrokenBonds,
});

choice!(SurfaceMeasure { "area" => Area, "volume" => Volume });

choice!(FragmentMeasure { "mass" => Mass, "volume" => Volume, "size" => Size, "velocity" => Velocity });
