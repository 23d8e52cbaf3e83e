//! The surface of a solid as ground for particles.

use fractum_contact::law::{ContactLaw, ElasticMaterial, Hertz, HertzMemory, MaterialPair, Surface};
use fractum_contact::{ContactWork, FacetMesh, Ground, GroundContacts, Spheres, SurfaceError, Touch};
use fractum_fem::Solid;
use fractum_math::Vec3;

use super::ContactMaterial;

/// Outward facets of one solid body, with the contacts of particles on them.
///
/// These are the facets of the start. One goes with its element; the nodes of that element are particles then, which
/// meet other particles of the solid only.
#[derive(Clone, Debug)]
pub struct SolidGround {
    body: usize,
    surface: Surface,
    elastic: ElasticMaterial,
    mesh: FacetMesh,
    /// Nodes of the solid that are points of the mesh.
    nodes: Vec<u32>,
    points: Vec<Vec3>,
    velocity: Vec<Vec3>,
    contacts: GroundContacts<Hertz>,
    /// Material of the body with that of each body of particles.
    pairs: Vec<MaterialPair>,
    frequency_square: f64,
}

impl SolidGround {
    /// The ground of the facets of one body.
    ///
    /// - `facets`: nodes of the solid, counter-clockwise from outside
    ///
    /// # Errors
    /// Facets that are no surface.
    pub fn new(solid: &Solid, body: usize, surface: Surface, facets: &[[u32; 3]]) -> Result<Self, SurfaceError> {
        let mut nodes: Vec<u32> = facets.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| nodes.binary_search(node).map_or(u32::MAX, |place| place as u32);
        let local: Vec<[u32; 3]> = facets.iter().map(|f| [place(&f[0]), place(&f[1]), place(&f[2])]).collect();
        let points: Vec<Vec3> = nodes.iter().map(|&n| solid.position(n as usize)).collect();
        let elastic = &solid.body(body).elastic;
        Ok(SolidGround {
            body,
            surface,
            elastic: ElasticMaterial { young_modulus: elastic.young_modulus, poisson_ratio: elastic.poisson_ratio },
            mesh: FacetMesh::new(&points, &local)?,
            velocity: vec![Vec3::zeros(); points.len()],
            nodes,
            points,
            contacts: GroundContacts::new(1.0),
            pairs: Vec::new(),
            frequency_square: 0.0,
        })
    }

    pub(super) fn prepared(mut self, skin: f64, materials: &[ContactMaterial]) -> Self {
        let pair = |m: &ContactMaterial| MaterialPair::new([m.elastic, self.elastic], m.surface.against(self.surface));
        self.pairs = materials.iter().map(pair).collect();
        self.contacts = GroundContacts::new(skin);
        self
    }

    /// Body of the solid.
    pub fn body(&self) -> usize {
        self.body
    }

    pub(super) fn contacts(&self) -> &GroundContacts<Hertz> {
        &self.contacts
    }

    pub(super) fn restore(&mut self, touches: Vec<Touch<HertzMemory>>) {
        self.contacts.restore(touches);
    }

    /// Largest squared frequency that the contacts of the last step give to a node [1/s²].
    pub(super) fn frequency_square(&self) -> f64 {
        self.frequency_square
    }

    /// Finds the contacts of the moment and adds their forces to the nodes, by the weights of the places.
    pub(super) fn add_forces(
        &mut self,
        solid: &mut Solid,
        spheres: &Spheres,
        body_of: &[u16],
        law: impl Fn(&MaterialPair, u32) -> Hertz + Sync,
        dt: f64,
    ) -> ContactWork {
        for (place, &node) in self.nodes.iter().enumerate() {
            self.points[place] = solid.position(node as usize);
            self.velocity[place] = solid.velocity[node as usize];
        }
        let SolidGround { mesh, nodes, points, velocity, contacts, pairs, .. } = self;
        let ground = Ground::Deformable { surface: mesh, points, velocity };
        let law_of = |i: u32| law(&pairs[body_of[i as usize] as usize], i);
        contacts.search(&ground, spheres);
        let work = contacts.update(&ground, spheres, |i, _| law_of(i), dt);
        let mut fastest: f64 = 0.0;
        for touch in contacts.touches() {
            let place = spheres.position[touch.sphere as usize] + touch.offset;
            let stiffness = law_of(touch.sphere).stiffness(touch.overlap).0;
            mesh.share(touch.feature, &place, points, |point, weight| {
                let node = nodes[point as usize] as usize;
                solid.force[node] -= touch.force * weight;
                fastest = fastest.max(stiffness * weight / solid.mass[node]);
            });
        }
        self.frequency_square = fastest;
        work
    }
}
