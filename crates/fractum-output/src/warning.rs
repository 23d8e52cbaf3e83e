//! The one list of warnings: what is found before a run and what a run finds while it goes.
//!
//! Terminal, `run.log`, the head of `report.html` and `summary.json` show the same warnings. `docs/warnings.md` explains every
//! [`Code`].

use std::fmt;

use serde::{Deserialize, Serialize};

/// Defines [`Code`] with the names that users see, so that no list beside it has to be kept.
macro_rules! codes {
    ($($(#[$doc:meta])* $code:ident = $name:literal,)*) => {
        /// The kinds of warnings.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Code {
            $($(#[$doc])* #[serde(rename = $name)] $code,)*
        }

        impl Code {
            /// All codes, in the order of their page.
            pub const ALL: &[Code] = &[$(Code::$code),*];

            /// Name of the code, as users see it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Code::$code => $name,)*
                }
            }
        }
    };
}

codes! {
    /// A value that solids do not have.
    UnusualValue = "unusual-value",
    /// A parameter or a material that nothing uses.
    Unused = "unused",
    /// A key that has no effect in this case.
    NoEffect = "no-effect",
    /// A motion that starts with a jump.
    Jump = "jump",
    /// A time step at or above the limit of stability.
    TimeStep = "time-step",
    /// An interval of output or of checkpoints that does little good.
    OutputInterval = "output-interval",
    /// A tension cutoff that is left out.
    TensionCutoff = "tension-cutoff",
    /// A mesh that is as large or as small as if its unit were another one.
    UnitOfLength = "unit-of-length",
    /// A load that is as small or as large as if its unit were another one.
    UnitOfLoad = "unit-of-load",
    /// A motion that is as large as if its unit were another one.
    UnitOfMotion = "unit-of-motion",
    /// Elements that are in no body.
    LeftOut = "left-out",
    /// A group that reaches beyond the bodies.
    BeyondBodies = "beyond-bodies",
    /// Nodes of two bodies in the same places, which nothing joins.
    CoincidentNodes = "coincident-nodes",
    /// Plane bodies that could meet, and do not touch.
    NoContact = "no-contact",
    /// A body that is moved or loaded, and held nowhere.
    Unheld = "unheld",
    /// Too few elements through a thickness.
    ThinMesh = "thin-mesh",
    /// Plane bodies with common nodes that differ in thickness or plane state.
    UnequalPlates = "unequal-plates",
    /// A plane body without a thickness.
    Thickness = "thickness",
    /// A test that lasts few passages of a wave.
    FastLoading = "fast-loading",
    /// A load that the run does not see to its end.
    EndsEarly = "ends-early",
    /// A pulse whose front is shorter than the elements.
    ShortPulse = "short-pulse",
    /// A held side that sends back the wave of a pulse.
    Reflections = "reflections",
    /// A tool that meets nothing.
    Misses = "misses",
    /// A probe without a value.
    Undefined = "undefined",
    /// A reaction that is not that of one support.
    Reaction = "reaction",
    /// A Poisson's ratio at which elements lock.
    Locking = "locking",
    /// A criterion by which a plate in plane strain has another strength.
    PlaneStrain = "plane-strain",
    /// A pressure that pulls.
    Suction = "suction",
    /// Bodies of several materials that share the in-situ stress by their stiffness.
    SharedStress = "shared-stress",
    /// Coordinates too far from the origin for small displacements.
    FarFromOrigin = "far-from-origin",
    /// A place that is measured and leaves with a body.
    Excavated = "excavated",
    /// A body much smaller than its process zone.
    ProcessZone = "process-zone",
    /// An interface that rubs in motion without damping.
    UndampedSliding = "undamped-sliding",
    /// Elements close to the length at which softening snaps back.
    CoarseMesh = "coarse-mesh",
    /// Joints of a set that were not cut.
    JointsLeftOut = "joints-left-out",
    /// A length of the phase field below that of the elements.
    PhaseFieldLength = "phase-field-length",
    /// A strength that was lowered where elements are too long.
    StrengthLowered = "strength-lowered",
    /// Bodies that overlap at the start.
    InitialOverlap = "initial-overlap",
    /// A surface that nothing can touch.
    ContactSurface = "contact-surface",
    /// A support on particles that a tie moves.
    SupportOnTie = "support-on-tie",
    /// A tie to facets that are smaller than particles.
    TieFacets = "tie-facets",
    /// A packing that does not meet its certificate.
    Packing = "packing",
    /// A strength in compression that bonds cannot have beside their strength in tension.
    BondStrength = "bond-strength",
    /// A checkpoint that could not be read.
    Checkpoint = "checkpoint",
    /// An energy balance that is off.
    EnergyBalance = "energy-balance",
    /// A temperature below absolute zero.
    BelowZero = "below-zero",
    /// Damping that takes a visible share of the work.
    Damping = "damping",
    /// A body of small strains that turns.
    Rotation = "rotation",
    /// A strain that is not small.
    LargeStrain = "large-strain",
    /// Tension above the strength where elements are kept from damage.
    TensionOutside = "tension-outside",
    /// Compression that the criterion does not know.
    Compression = "compression",
    /// Solids that meet rigid bodies lose a visible share of the energy.
    ImpactLoss = "impact-loss",
    /// Springs of contact hold a visible share of the elastic energy.
    SoftContact = "soft-contact",
    /// Changes of the time step, or of strains, brought or took a visible share of the energy.
    ChangeOfStep = "change-of-step",
    /// Friction, damping or the fracture of interfaces gave energy.
    EnergyGained = "energy-gained",
    /// Sides of an interface slid by a visible part of a face.
    InterfaceSlip = "interface-slip",
    /// Liquid that is everywhere in its interfaces.
    LiquidAtEnd = "liquid-at-end",
    /// No interface meets a hole that holds liquid.
    LiquidHoleAlone = "liquid-hole-alone",
    /// More liquid was drawn than there was.
    LiquidOverdrawn = "liquid-overdrawn",
    /// A rate at which an inlet has no room for its particles.
    InletRate = "inlet-rate",
    /// Gravity in a box that repeats along all axes.
    FreeFall = "free-fall",
    /// Particles that are due, and find no free place in their inlet.
    InletBlocked = "inlet-blocked",
    /// An element that had begun to break was turned inside out, and taken out.
    Crushed = "crushed",
    /// Particles that are pressed deeply into each other.
    DeepOverlap = "deep-overlap",
    /// A bonded body at rest that does not bear its loads any more.
    GaveWay = "gave-way",
    /// A rigid body that does not press with the force that is asked of its servo.
    Servo = "servo",
    /// A body that came apart into single nodes.
    SingleNodes = "single-nodes",
    /// Solids that do not hang together, whose vibrations are those of their pieces.
    InPieces = "in-pieces",
    /// Rigid motions that nothing prevents.
    RigidMotion = "rigid-motion",
    /// Motions without stiffness within bodies.
    Mechanism = "mechanism",
    /// Natural vibrations that were not found as exactly as they should.
    Unsettled = "unsettled",
    /// Bands of a phase field that have become one.
    MergedBands = "merged-bands",
    /// Bands of a phase field that end at nodes shared with another body.
    CutBand = "cut-band",
    /// Cracks that cost more or less than their fracture energy.
    CrackEnergy = "crack-energy",
    /// Cracks that show one of their faces.
    CrackArea = "crack-area",
    /// Elements too large for the strength at their rate of strain.
    RateLimited = "rate-limited",
    /// An accuracy that was asked for and not reached.
    Accuracy = "accuracy",
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One warning, as all results show it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    /// What it is of.
    pub code: Code,
    /// What was found, as a sentence without its stop.
    pub text: String,
    /// Where: `case.toml:12:3`, or `element 5127, t = 1.2 ms`; may be empty.
    #[serde(rename = "where")]
    pub place: String,
    /// What to do; may be empty.
    pub remedy: String,
}

impl Warning {
    /// A warning without a remedy.
    pub fn new(code: Code, place: impl Into<String>, text: impl Into<String>) -> Self {
        Self { code, text: text.into(), place: place.into(), remedy: String::new() }
    }

    /// Adds what to do.
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = remedy.into();
        self
    }
}

/// `case.toml:12:3: warning: solver.safety = 0.99; 0.8 is usual [time-step]`, on one line.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "warning: {}", self.text)?;
        if !self.remedy.is_empty() {
            write!(f, "; {}", self.remedy)?;
        }
        write!(f, " [{}]", self.code)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn a_warning_is_one_line_with_its_code_last() {
        let warning = Warning::new(Code::EnergyBalance, "t = 1 ms", "the balance is off").remedy("take a smaller step");
        assert_eq!(warning.to_string(), "t = 1 ms: warning: the balance is off; take a smaller step [energy-balance]");
        assert_eq!(Warning::new(Code::Packing, "", "odd").to_string(), "warning: odd [packing]");
        let json = serde_json::to_value(&warning).unwrap();
        assert_eq!((&json["code"], &json["where"]), (&"energy-balance".into(), &"t = 1 ms".into()));
        assert_eq!(serde_json::from_value::<Warning>(json).unwrap(), warning);
    }

    #[test]
    fn every_code_has_a_name_of_its_own() {
        let names: HashSet<&str> = Code::ALL.iter().map(|code| code.name()).collect();
        assert_eq!(names.len(), Code::ALL.len());
        let plain = |name: &&str| name.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        assert!(names.iter().all(plain), "{names:?}");
    }
}
