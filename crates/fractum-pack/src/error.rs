use thiserror::Error;

/// Why a packing or a bond network could not be made.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum PackError {
    /// A dimension of the domain is no length of a body.
    #[error("the domain's {what} is {value} m; expected between 1e-15 m and 1e15 m")]
    BadDimension {
        /// Which dimension.
        what: &'static str,
        /// The value found [m].
        value: f64,
    },
    /// Positions in the domain would be rounded.
    #[error(
        "the domain reaches {distance:.3e} m from the origin and is {extent:.3e} m wide; move it to the origin, where \
         floating point numbers are fine enough"
    )]
    TooFar {
        /// Farthest coordinate [m].
        distance: f64,
        /// Narrowest extent [m].
        extent: f64,
    },
    /// The bounding box is mostly empty.
    #[error("the domain fills {0:.3e} of its bounding box; expected a more compact shape")]
    Sparse(f64),
    /// The size distribution is outside what the cooker packs well.
    #[error(
        "dispersion kappa = {0}; expected between 0 and 1 (0.25 is the usual choice; below 0.15 packings tend to order)"
    )]
    Dispersion(f64),
    /// Too few particles to call it a packing, or a domain thinner than a few particles.
    #[error(
        "the domain is too small for {count} particles: its narrowest extent {extent:.3e} m holds {across:.2} mean diameters \
         (at least {needed} are needed); ask for more and smaller particles"
    )]
    TooSmall {
        /// Number of particles.
        count: usize,
        /// Narrowest extent of the domain [m].
        extent: f64,
        /// Mean diameters across that extent.
        across: f64,
        /// Mean diameters needed.
        needed: f64,
    },
    /// A count outside the supported range.
    #[error("{0} particles asked; expected between 20 and 20 million")]
    Count(usize),
    /// The surface has edges that do not join exactly two triangles in opposite directions.
    #[error(
        "the surface is not closed: {open} edges do not join exactly two consistently oriented triangles (first near {near:?}); repair it in the mesher"
    )]
    OpenSurface {
        /// Number of bad edges.
        open: usize,
        /// A point of the first bad edge [m].
        near: [f64; 3],
    },
    /// The surface encloses nothing, or names missing points.
    #[error("the surface is unusable: {0}")]
    BadSurface(String),
    /// An STL file that cannot be read.
    #[error("STL: {0}")]
    Stl(String),
    /// The compaction ended short of its own targets.
    #[error("the packing misses its target: {target}; reached {reached}; {remedy}")]
    Refused {
        /// What was asked.
        target: String,
        /// What was reached.
        reached: String,
        /// What to do.
        remedy: &'static str,
    },
    /// No search radius gives the asked coordination.
    #[error(
        "coordination {asked} is out of reach: this packing gives {lowest:.2} to {highest:.2} (search radius 1 to {reach} times the touching distance)"
    )]
    Coordination {
        /// The asked value.
        asked: f64,
        /// Lowest reachable value.
        lowest: f64,
        /// Highest reachable value.
        highest: f64,
        /// Largest search factor tried.
        reach: f64,
    },
    /// A sphere that has no room in its shape, empty as it is.
    #[error("the shape has no room for a particle of radius {radius:.3e} m")]
    NoRoom {
        /// Radius of the sphere [m].
        radius: f64,
    },
    /// Spheres of given sizes that do not fit at random places.
    #[error(
        "a solid fraction of {asked:.4} is out of reach: with these sizes and this seed random places end at {reached:.4} in this shape"
    )]
    Dense {
        /// Fraction that was asked for.
        asked: f64,
        /// Largest one that was reached.
        reached: f64,
    },
    /// More spheres than any random packing has.
    #[error("a solid fraction of {0:.3} is more than any random packing has: those of one size end at 0.64")]
    TooDense(f64),
    /// A stored packing that cannot be read.
    #[error("packing file: {0}; make it again with `fractum pack`")]
    File(String),
}
