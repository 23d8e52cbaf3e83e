//! One simulation: its state, the step that advances it, and the coupling of solids with the discrete elements that
//! they turn into. Bonded bodies, with particles of their own, stand beside the solids.
//!
//! [`Scene`] holds everything; [`Scene::step`] reads like the equations. What changes during a run is a
//! [`SceneState`], one value that can be saved and put back bit for bit.

#![forbid(unsafe_code)]

mod advance;
mod audit;
mod bands;
mod bonded;
mod clock;
mod conditions;
mod conduct;
mod contacts;
pub mod coupling;
mod crack_extent;
mod crack_measure;
mod damaged;
mod domain;
mod error;
mod facet;
mod fragment;
mod gas;
mod gauges;
mod heat;
mod leave;
mod ledger;
mod piece_probe;
mod probe;
mod radial_cracks;
mod ranks;
mod region_probe;
mod scene;
mod stable_step;
pub mod statics;
mod step;
mod subcycling;
mod time_function;
mod velocity_station;
mod watch;

pub use bonded::{BondFracture, Bonded, BondedBody, BondedPart, BondedState, Closest};
pub use clock::{Clock, TimeStepSettings};
pub use conditions::*;
pub use contacts::{
    ContactBody, ContactMaterial, ContactProbe, Contacts, Drive, FlatFaces, Form, Inertia, NodesOnShape, Overlap,
    OverlapWith, RigidBody, SolidSurface, pieces,
};
pub use crack_measure::{CrackMeasure, InsideCracks};
pub use damaged::{DamagedMeasure, DamagedPart};
pub use domain::{Domain, Left};
pub use error::{SceneError, StepError};
pub use fractum_contact::law::{ContactParameters, ElasticMaterial, damping_of_restitution};
pub use fractum_contact::{FacetMesh, Frame, Shape, SurfaceError};
pub use fractum_gas::{Amount, EquationOfState, Jwl, NobleAbel, PerfectGas, SlitFlow};
pub use fractum_heat::HeatCondition;
pub use fragment::{Fragment, solid_pieces};
pub use gas::{Charge, Gas, GasCell, GasHole, GasMeasure, GasSettings, GasSource, HoleEnds, SymmetryPlanes};
pub use gauges::{Extensometer, GaugeGrid, GaugeReading};
pub use heat::{
    Heat, HeatMeasure, HeatSettings, HeatState, PackingConduction, PackingReport, TemperatureTake, ThermalMaterial,
};
pub use ledger::{EnergyKind, EnergyProbe, EnergyRole, Ledger};
pub use piece_probe::{FragmentMeasure, SurfaceMeasure, equivalent_diameter, fragment_size, passing_size};
pub use probe::{NeededPoints, Probe, ProbeNeeds, ProbedScene};
pub use radial_cracks::{RadialCracks, RadialMeasure};
pub use ranks::Watched;
pub use region_probe::{RegionStrain, RegionStress};
pub use scene::{CountKind, Counts, Scene, SceneSettings, SceneState};
pub use statics::{BondedStaticSettings, BondedStaticState, BondedStatics};
pub use step::{Phase, StepReport};
pub use subcycling::SubcyclingState;
pub use time_function::TimeFunction;
pub use velocity_station::{PeakVelocity, StationPlace, VelocityStation};
pub use watch::{Notice, Noticed, Site};
