//! One simulation: its state, the step that advances it, and the coupling of solids with the discrete elements that
//! they turn into. Bonded bodies, with particles of their own, stand beside the solids.
//!
//! [`Scene`] holds everything; [`Scene::step`] reads like the equations. What changes during a run is a
//! [`SceneState`], one value that can be saved and put back bit for bit.

#![forbid(unsafe_code)]

mod advance;
mod balance;
mod bands;
mod bonded;
mod clock;
mod conditions;
mod conduct;
mod contact_pairs;
mod contacts;
pub mod coupling;
mod domain;
mod enter;
mod error;
mod excavation;
mod facet;
mod fragment;
mod gas;
mod heat;
mod inlet;
mod interfaces;
mod leave;
mod ledger;
mod liquid;
mod measure;
mod modes;
mod periodic;
mod pumped;
pub mod ranks;
mod repeat;
mod saved;
mod scene;
mod setup;
mod stable_step;
mod stage;
pub mod statics;
mod step;
mod subcycling;
mod time_function;
mod watch;

pub use bonded::{BondFracture, Bonded, BondedBody, BondedPart, BondedState, Closest, narrowest_box};
pub use clock::{Clock, Phase, TimeStepSettings};
pub use conditions::*;
pub use contact_pairs::{ContactBody, ContactPairs, PairContact};
pub use contacts::{
    ContactMaterial, ContactProbe, Contacts, Drive, FlatFaces, Form, Inertia, NodesOnShape, Overlap, OverlapWith,
    ParticleContact, RigidBody, Servo, ServoArea, SolidSurface, pieces,
};
pub use domain::{Domain, Left};
pub use enter::{entered_of, inlets_of, with_inlets};
pub use error::{SceneError, StepError};
pub use excavation::Excavation;
pub use fractum_contact::law::{ContactParameters, ElasticMaterial, damping_of_restitution, restitution_of_damping};
pub use fractum_contact::{FacetMesh, Frame, PeriodicCell, Shape, SurfaceError};
pub use fractum_gas::{Amount, EquationOfState, Explosive, Jwl, NobleAbel, PerfectGas, SlitFlow};
pub use fractum_heat::HeatCondition;
pub use fractum_kernels::interface::{InterfaceLaw, InterfaceSoftening, MixedMode, Roughness, SpringInterface};
pub use fractum_kernels::liquid::CubicLaw;
pub use fragment::{Fragment, solid_pieces};
pub use gas::{
    Charge, Gas, GasCell, GasHole, GasMeasure, GasRoom, GasSettings, GasSource, HoleEnds, Stemming, SymmetryPlanes,
};
pub use heat::{
    Heat, HeatMeasure, HeatSettings, HeatState, PackingConduction, PackingReport, TemperatureTake, ThermalMaterial,
};
pub use inlet::{Arrivals, Entered, EntryMotion, Inlet};
pub use interfaces::{
    FaceReading, InsidePressure, InterfaceFace, InterfaceKind, Interfaces, InterfacesState, OpenedCrack,
};
pub use ledger::{EnergyKind, EnergyProbe, EnergyRole, Ledger};
pub use liquid::{
    Injection, InjectionDrive, InjectionPlace, Liquid, LiquidHole, LiquidMeasure, LiquidReading, LiquidSettings,
    LiquidState,
};
pub use measure::counts::{CountKind, Counts};
pub use measure::crack_extent::CrackProbe;
pub use measure::crack_measure::{CrackMeasure, InsideCracks};
pub use measure::damaged::{DamagedMeasure, DamagedPart};
pub use measure::gauges::{Extensometer, GaugeGrid, GaugeReading};
pub use measure::indentation::{Indentation, coarsest_indentation};
pub use measure::piece_probe::{
    FragmentMeasure, FragmentProbe, SurfaceMeasure, SurfaceProbe, equivalent_diameter, fragment_size, passing_size,
};
pub use measure::points::{PointProbe, ProbeOfPoints};
pub use measure::probe::{NeededPoints, Probe, ProbeNeeds, ProbedScene};
pub use measure::radial_cracks::{RadialCracks, RadialMeasure};
pub use measure::region_probe::{RegionStrain, RegionStress};
pub use measure::velocity_station::{PeakVelocity, StationPlace, VelocityStation};
pub use modes::{Mode, Modes};
pub use periodic::{BoxServo, BoxStrain, PeriodicBox, PeriodicState, periodic_cell};
pub use pumped::{liquid_of, with_liquid};
pub use ranks::Watched;
pub use repeat::{
    BoxMeasure, into_periodic_box, measure_periodic_box, periodic_cell_of, periodic_state, restore_periodic,
    with_periodic_box,
};
pub use saved::{SceneState, restore_watch, watch_of};
pub use scene::{Scene, SceneSettings};
pub use stage::{released_forces, with_excavation};
pub use statics::{BondedStaticSettings, BondedStaticState, BondedStatics};
pub use step::StepReport;
pub use subcycling::SubcyclingState;
pub use time_function::TimeFunction;
pub use watch::{Notice, Noticed, Site, Watch};
