use thiserror::Error;

/// What makes a solid impossible to build or to run.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SolidError {
    /// An element without volume.
    #[error("body {body}: element {element} has volume {volume:e} m³; expected a positive volume, repair the mesh")]
    DegenerateElement {
        /// Name of the body.
        body: String,
        /// Index of the element in the body.
        element: usize,
        /// Its volume [m³].
        volume: f64,
    },
    /// An element too large for its fracture energy.
    #[error(
        "body {body}: the edge at ({x:.4e}, {y:.4e}, {z:.4e}) m has the characteristic length {length:.4e} m; softening with this strength and fracture \
         energy needs less than {limit:.4e} m ({count} edges are too long): refine the mesh there, raise fracture_energy or lower tensile_strength, or set \
         reduce_strength_to_fit = true"
    )]
    ElementTooLarge {
        /// Name of the body.
        body: String,
        /// Position of the worst edge [m].
        x: f64,
        /// Position of the worst edge [m].
        y: f64,
        /// Position of the worst edge [m].
        z: f64,
        /// Its characteristic length [m].
        length: f64,
        /// The largest length possible [m].
        limit: f64,
        /// How many edges are too long.
        count: usize,
    },
    /// A phase field whose length is too long for the fracture energy.
    #[error(
        "body {body}: the phase field has the length b = {length:.4e} m; with the strength at ({x:.4e}, {y:.4e}, {z:.4e}) m it may be {limit:.4e} m at most: a \
         longer one lets damage spread through the body without load. b is twice the element size where cracks are expected, {size:.4e} m, unless it is given: \
         take elements below {:.4e} m there, bound the damage to where elements are small (damage_where), raise fracture_energy, take local damage \
         (regularisation = \"none\"), or set reduce_strength_to_fit = true",
        0.5 * limit
    )]
    LengthTooLong {
        /// Name of the body.
        body: String,
        /// Position of the strongest edge [m].
        x: f64,
        /// Position of the strongest edge [m].
        y: f64,
        /// Position of the strongest edge [m].
        z: f64,
        /// Length b of the body [m].
        length: f64,
        /// The largest length possible [m].
        limit: f64,
        /// Mean size of the elements where cracks go [m].
        size: f64,
    },
    /// Damage in a body with beds that cannot have it so.
    #[error("body {body}: damage with bedding knows no {found}; expected {expected}, or a material without bedding")]
    BeddedDamage {
        /// Name of the body.
        body: String,
        /// What does not go together.
        found: &'static str,
        /// What would do.
        expected: &'static str,
    },
    /// A phase field in a body that cannot have one.
    #[error("body {body}: no phase field with {reason}; expected {expected}, or no regularisation")]
    NotRegularised {
        /// Name of the body.
        body: String,
        /// What stands against it.
        reason: &'static str,
        /// What would do.
        expected: &'static str,
    },
    /// More blocks of cells than have a number.
    #[error(
        "the solids make {blocks} blocks of up to 2,048 cells, of which at most {most} have a number: some 7 billion smoothed or 8 billion standard \
         tetrahedra; mesh more coarsely where nothing breaks, or leave out what is far away"
    )]
    TooManyBlocks {
        /// How many there are.
        blocks: usize,
        /// How many there may be.
        most: usize,
    },
    /// What another rank has found that builds a share of the same solid.
    #[error("{0}")]
    OfRank(String),
    /// A node that belongs to no element and so has no mass.
    #[error("node {node} belongs to no element of any solid body: it has no mass")]
    MasslessNode {
        /// Index of the node.
        node: usize,
    },
}
