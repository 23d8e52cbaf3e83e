use fractum_math::Vec3;

/// A place where a sphere touches a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Feature that it lies on, see [`FacetMesh::feature`]; of a shape without facets, the number of its face.
    pub feature: u32,
    /// Facet that was found first there.
    pub facet: u32,
    /// Vector from the centre of the sphere [m].
    pub offset: Vec3,
    /// Unit vector into the ground.
    pub normal: Vec3,
    /// Distance of the ground from the centre along the normal [m], below the radius; negative if the centre is within
    /// a shape.
    pub distance: f64,
    /// Mean curvature of the ground there [1/m], positive where it bulges towards the sphere.
    pub curvature: f64,
    /// Share of its force that acts, 0 to 1: below 1 where a concave edge is so shallow that two contacts are
    /// almost one.
    pub weight: f64,
    /// The other contact that it is most nearly one with, by its place among the feet.
    pub twin: Option<u32>,
}
