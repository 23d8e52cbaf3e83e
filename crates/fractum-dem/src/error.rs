use fractum_kernels::bond::BadLaw;
use thiserror::Error;

/// Why a discrete body could not be built or solved.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum DemError {
    /// Numbers that make no bond.
    #[error(transparent)]
    BadLaw(#[from] BadLaw),
    /// A bond that names a missing particle, or joins a particle with itself or with one at the same place.
    #[error("bond {bond} joins particles {first} and {second} of {count}: {reason}")]
    BadBond {
        /// Which bond.
        bond: usize,
        /// First particle.
        first: u32,
        /// Second particle.
        second: u32,
        /// Number of particles.
        count: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// Arrays of different lengths.
    #[error("{what}: {found} entries for {expected} particles")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Number of particles.
        expected: usize,
    },
    /// A mass or radius that is not positive.
    #[error("particle {particle} has {what} {value}; expected a positive, finite number")]
    BadParticle {
        /// Which particle.
        particle: usize,
        /// Which quantity.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// Spheres that make no rigid grain.
    #[error("{reason}")]
    BadClump {
        /// What is wrong, to be read after "the clump".
        reason: String,
    },
    /// A strength, angle or fraction of a criterion that is impossible.
    #[error("{what} {value}; expected {expected}")]
    BadCriterion {
        /// Which number.
        what: &'static str,
        /// The value.
        value: f64,
        /// The valid range.
        expected: &'static str,
    },
    /// Particles that span no space cell.
    #[error(
        "no four of the {particles} bonded particles that meet in a space cell enclose a volume, so that they have no mean strain; take bond = \"local\", or more particles across the body"
    )]
    NoCells {
        /// How many particles have bonds.
        particles: usize,
    },
    /// Space cells that are too large for the body of their particles.
    #[error(
        "the space cells of the particles inside fill {inside:.4e} m3 of {body:.4e} m3, which leaves no volume for its surface: particles are too large for its holes and notches; give it more of them"
    )]
    NoVolume {
        /// Volume of the cells of the particles inside [m³].
        inside: f64,
        /// Volume of the body [m³].
        body: f64,
    },
    /// A criterion on the stress of particles whose bonds sum none.
    #[error(
        "criterion {criterion} needs the virials of particles, which bonds beside the mean strain do not sum; let such bonds separate by their own strengths"
    )]
    NoVirials {
        /// Name of the criterion.
        criterion: &'static str,
    },
    /// Bonds at rest that are no beams.
    #[error("bodies at rest need bonds that are cohesive beams; these are of another law")]
    NoLattice,
    /// The static solve did not converge.
    #[error(
        "the lattice is not in equilibrium after {iterations} iterations: residual {residual:.2e} of the applied forces, asked {asked:.2e}; is a part held by nothing?"
    )]
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Relative residual reached.
        residual: f64,
        /// Relative residual asked.
        asked: f64,
    },
    /// [`Tolerance::stop`](crate::Tolerance::stop) asked for it.
    #[error("the search for equilibrium was interrupted")]
    Interrupted,
}
