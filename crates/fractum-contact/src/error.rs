use thiserror::Error;

/// What makes a set of facets unfit for contact.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SurfaceError {
    /// There are no facets.
    #[error("the surface has no facets")]
    Empty,
    /// A facet names a point that does not exist.
    #[error("facet {facet} names point {point}; there are {points}")]
    MissingPoint {
        /// Facet.
        facet: usize,
        /// Point it names.
        point: u32,
        /// Number of points.
        points: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("point {point} has coordinates {at:?}; expected finite numbers")]
    NotFinite {
        /// Point.
        point: u32,
        /// Its coordinates [m].
        at: [f64; 3],
    },
    /// A facet has no area: fewer than three different corners, or all on one line.
    #[error("facet {facet} at ({:.4e}, {:.4e}, {:.4e}) m is degenerate: area {area:.3e} m² at a longest edge of {longest:.3e} m; \
             remesh, or merge its corners", at[0], at[1], at[2])]
    Degenerate {
        /// Facet.
        facet: usize,
        /// Its first corner [m].
        at: [f64; 3],
        /// Area [m²].
        area: f64,
        /// Longest edge [m].
        longest: f64,
    },
    /// A polygon is not flat.
    #[error("facet {facet} at ({:.4e}, {:.4e}, {:.4e}) m is not planar: a corner lies {off:.3e} m off; split it into triangles",
            at[0], at[1], at[2])]
    NotPlanar {
        /// Facet.
        facet: usize,
        /// Its first corner [m].
        at: [f64; 3],
        /// Distance from the plane of the facet [m].
        off: f64,
    },
    /// A polygon has a corner that points inward.
    #[error("facet {facet} at ({:.4e}, {:.4e}, {:.4e}) m is not convex; split it into triangles", at[0], at[1], at[2])]
    NotConvex {
        /// Facet.
        facet: usize,
        /// Its first corner [m].
        at: [f64; 3],
    },
    /// More than two facets share an edge.
    #[error("{facets} facets share the edge at ({:.4e}, {:.4e}, {:.4e}) m; a surface has two at most: remove what stands \
             on it, or give it as a body of its own", at[0], at[1], at[2])]
    NonManifold {
        /// Facets at the edge.
        facets: usize,
        /// One end of the edge [m].
        at: [f64; 3],
    },
    /// A surface that should enclose a volume has edges of one facet only.
    #[error("the surface is open: {open} edges belong to one facet only, the first at ({:.4e}, {:.4e}, {:.4e}) m; close it",
            at[0], at[1], at[2])]
    Open {
        /// Number of open edges.
        open: usize,
        /// One end of the first of them [m].
        at: [f64; 3],
    },
}
