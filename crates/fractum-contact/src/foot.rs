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
    /// Factor of its force: 1 of a contact, -1 of a pass between two, at which they count once from there on.
    pub weight: f64,
    /// Factor of its energy.
    pub energy: f64,
    /// Whether only the elastic force along the normal acts, without memory: places around a hollow.
    pub elastic: bool,
}

impl Foot {
    /// A contact.
    ///
    /// - `offset` [m]: vector from the centre; `normal`: unit vector into the ground; `distance` [m] along it
    pub(crate) fn contact(feature: u32, facet: u32, offset: Vec3, normal: Vec3, distance: f64) -> Self {
        Foot { feature, facet, offset, normal, distance, curvature: 0.0, weight: 1.0, energy: 1.0, elastic: false }
    }
}
