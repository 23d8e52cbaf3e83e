//! The surface of a solid as ground for particles.

use std::ops::Range;

use fractum_contact::law::{
    ContactLaw, ContactMemory, ContactParameters, ElasticMaterial, Hertz, HertzMemory, MaterialPair,
};
use fractum_contact::{FacetMesh, Spheres, Surface, SurfaceContacts, SurfaceError, Touch};
use fractum_fem::Solid;
use fractum_math::{Vec3, Work};

use super::ContactMaterial;
use super::nodes_on_surface::{NodesOnSurface, frequency_square};
use crate::coupling::Debris;

/// Outward facets of one solid body, with the contacts of particles, and of nodes of other solids, on them.
///
/// These are the facets of the start. One goes with its element; the nodes of that element are discrete elements then, which
/// meet everything but the facets of their own solid.
#[derive(Clone, Debug)]
pub struct SolidSurface {
    body: usize,
    surface: ContactParameters,
    elastic: ElasticMaterial,
    /// Of a plane body [m]; 0 in space.
    thickness: f64,
    /// Smallest mass of its nodes [kg], once nodes of other plane bodies are expected.
    lightest: f64,
    mesh: FacetMesh,
    /// Nodes of the solid that are points of the mesh.
    nodes: Vec<u32>,
    points: Vec<Vec3>,
    velocity: Vec<Vec3>,
    contacts: SurfaceContacts<Hertz>,
    /// Material of the body with that of each body of particles.
    pairs: Vec<MaterialPair>,
    frequency_square: f64,
    /// Facets by their nodes, ascending.
    by_nodes: Vec<([u32; 3], u32)>,
    /// Nodes of solids that this one shares no node with.
    visitors: Option<NodesOnSurface>,
    /// Radii of the particles as this body feels them, where some count as points: those that are tied to it. Else empty.
    felt: Vec<f64>,
}

impl SolidSurface {
    /// The ground of the facets of one body.
    ///
    /// - `facets`: nodes of the solid, counter-clockwise from outside; edges of plane bodies repeat their second node
    ///
    /// # Errors
    /// Facets that are no surface.
    pub fn new(
        solid: &Solid,
        body: usize,
        surface: ContactParameters,
        facets: &[[u32; 3]],
    ) -> Result<Self, SurfaceError> {
        let mut nodes: Vec<u32> = facets.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| nodes.binary_search(node).map_or(u32::MAX, |place| place as u32);
        let local = |facet: &[u32; 3]| facet[..corners(facet)].iter().map(place).collect();
        let local: Vec<Vec<u32>> = facets.iter().map(local).collect();
        let points: Vec<Vec3> = nodes.iter().map(|&n| solid.position(n as usize)).collect();
        let elastic = &solid.body(body).elastic;
        Ok(SolidSurface {
            body,
            surface,
            elastic: ElasticMaterial { young_modulus: elastic.young_modulus, poisson_ratio: elastic.poisson_ratio },
            thickness: solid.body(body).depth().map_or(0.0, |depth| depth.at(&points[0])),
            lightest: f64::INFINITY,
            mesh: FacetMesh::new(&points, &local)?,
            velocity: vec![Vec3::zeros(); points.len()],
            nodes,
            points,
            contacts: SurfaceContacts::new(1.0),
            pairs: Vec::new(),
            frequency_square: 0.0,
            by_nodes: {
                let mut by_nodes: Vec<_> = facets.iter().map(|&f| sorted(f)).zip(0..).collect();
                by_nodes.sort_unstable();
                by_nodes
            },
            visitors: None,
            felt: Vec::new(),
        })
    }

    /// The same without contact of some particles, which are tied to it; `radii` of all particles [m].
    pub fn without(mut self, particles: impl Iterator<Item = u32>, radii: &[f64]) -> Self {
        self.felt = radii.to_vec();
        particles.for_each(|i| self.felt[i as usize] = 0.0);
        self
    }

    /// The same with contact of nodes of other solids.
    ///
    /// - `surface`: nodes on the surfaces of all solids, ascending; `bodies`: whose nodes may touch this one
    pub(crate) fn has_node_contacts(&mut self, surface: &[u32], bodies: Vec<bool>, debris: &Debris) {
        self.visitors = Some(NodesOnSurface::new(surface, bodies, debris));
    }

    /// Takes into account how nodes that visit it are corners of plane bodies.
    ///
    /// - `beside`: nodes before and after a node, counter-clockwise around its body
    pub(super) fn has_corners(&mut self, beside: impl Fn(u32) -> Option<[u32; 2]>) {
        self.visitors = self.visitors.take().map(|visitors| visitors.on_lines(beside));
    }

    /// Ends of its lines, in scene nodes; nothing in space.
    pub(super) fn lines(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.mesh.len() as u32).filter_map(|facet| match self.mesh.corners(facet) {
            &[a, b] => Some([a, b].map(|point| self.nodes[point as usize])),
            _ => None,
        })
    }

    pub(super) fn prepared(mut self, skin: f64, materials: &[ContactMaterial], thickness: Option<f64>) -> Self {
        let pair = |m: &ContactMaterial| {
            MaterialPair::new([m.elastic, self.elastic], m.surface.against(self.surface)).of_thickness(thickness)
        };
        self.pairs = materials.iter().map(pair).collect();
        self.contacts = SurfaceContacts::new(skin);
        self
    }

    /// Visits its pairs with the bodies of particles.
    pub(super) fn each_pair(&mut self, mut visit: impl FnMut(usize, &mut MaterialPair)) {
        self.pairs.iter_mut().enumerate().for_each(|(body, pair)| visit(body, pair));
    }

    /// Body of the solid.
    pub fn body(&self) -> usize {
        self.body
    }

    pub(super) fn contacts(&self) -> &SurfaceContacts<Hertz> {
        &self.contacts
    }

    /// Takes a particle that was not there at a place away from it.
    ///
    /// - `radius`: of the particle [m]
    pub(super) fn admit_particle(&mut self, particle: u32, place: &Vec3, radius: f64) {
        let SolidSurface { mesh, points, velocity, contacts, felt, .. } = self;
        felt.get_mut(particle as usize).into_iter().for_each(|felt| *felt = radius);
        contacts.admit(&Surface::Deformable { surface: mesh, points, velocity }, particle, place);
    }

    /// Its facets, where they were when forces were last found.
    pub(super) fn ground(&self) -> Surface<'_> {
        Surface::Deformable { surface: &self.mesh, points: &self.points, velocity: &self.velocity }
    }

    pub(super) fn mesh(&self) -> &FacetMesh {
        &self.mesh
    }

    /// A point of the mesh [m].
    pub(super) fn point(&self, point: u32) -> Vec3 {
        self.points[point as usize]
    }

    pub(super) fn elastic(&self) -> &ElasticMaterial {
        &self.elastic
    }

    /// Its body, with friction and damping of its surface.
    pub(super) fn body_and_surface(&self) -> (usize, ContactParameters) {
        (self.body, self.surface)
    }

    /// Whether the nodes of a solid body may touch it.
    pub(super) fn meets(&self, body: usize) -> bool {
        self.visitors.as_ref().is_some_and(|visitors| visitors.meets(body))
    }

    /// Nodes of its facets.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    pub(super) fn visitors(&self) -> Option<&NodesOnSurface> {
        self.visitors.as_ref()
    }

    pub(super) fn visitors_mut(&mut self) -> &mut Option<NodesOnSurface> {
        &mut self.visitors
    }

    /// Has the next search look up all particles.
    ///
    /// - `radii`: of the particles; negative ones of those that have left [m]
    pub(super) fn look_again(&mut self, radii: &[f64]) {
        let changed = self.felt.iter_mut().zip(radii).filter(|(felt, radius)| **felt < 0.0 || **radius < 0.0);
        changed.for_each(|(felt, radius)| *felt = *radius);
        self.contacts.look_again();
    }

    /// Visits the nodes of facets that something touched at the last step, and the nodes that touched them.
    ///
    /// - `particles`: positions of the particles [m]
    pub(super) fn each_touching_node(&self, particles: &[Vec3], mut visit: impl FnMut(u32)) {
        let of_particles = self.contacts.touches().map(|t| (t.feature, particles[t.sphere as usize] + t.offset));
        let visitors = || self.visitors.iter().flat_map(NodesOnSurface::touches);
        visitors().for_each(|(_, _, node)| visit(node));
        for (feature, place) in of_particles.chain(visitors().map(|(touch, place, _)| (touch.feature, place))) {
            self.mesh.share(feature, &place, &self.points, |point, _| visit(self.nodes[point as usize]));
        }
    }

    pub(super) fn state(&self) -> SolidSurfaceState {
        (self.contacts.state(), self.visitors.as_ref().map_or_else(Vec::new, |nodes| nodes.contacts().state()))
    }

    pub(super) fn restore(&mut self, solid: &Solid, debris: &Debris, (touches, nodes): SolidSurfaceState) {
        let dead = (0u32..).zip(solid.alive(self.body)).filter(|(_, alive)| !**alive);
        let dead: Vec<(usize, u32)> = dead.map(|(element, _)| (self.body, element)).collect();
        self.remove_facets(solid, &dead);
        self.contacts.restore(touches);
        if let Some(visitors) = &mut self.visitors {
            visitors.restore(debris, nodes);
        }
    }

    /// Takes out the facets of removed elements.
    pub(super) fn remove_facets(&mut self, solid: &Solid, removed: &[(usize, u32)]) {
        let mut some = false;
        for &(_, element) in removed.iter().filter(|(body, _)| *body == self.body) {
            let [a, b, c, d] = solid.body(self.body).elements[element as usize];
            // Triangles repeat their last node.
            for facet in [[a, b, c], if c == d { [a, b, b] } else { [a, b, d] }, [a, c, d], [b, c, d]] {
                if let Ok(place) = self.by_nodes.binary_search_by_key(&sorted(facet), |(nodes, _)| *nodes) {
                    self.mesh.remove(self.by_nodes[place].1);
                    some = true;
                }
            }
        }
        if some {
            self.contacts.look_again();
            self.visitors.iter_mut().for_each(NodesOnSurface::look_again);
        }
    }

    /// Takes nodes of new discrete elements as they stand.
    pub(super) fn admit(&mut self, born: &[u32], solid: &Solid, debris: &Debris) {
        self.locate(solid);
        let SolidSurface { mesh, points, velocity, visitors, .. } = self;
        if let Some(visitors) = visitors {
            visitors.admit(born, &Surface::Deformable { surface: mesh, points, velocity }, solid, debris);
        }
    }

    /// Takes the contacts of nodes of other solids as they stand.
    pub(super) fn accept_node_overlaps(&mut self, solid: &Solid) {
        self.locate(solid);
        let SolidSurface { mesh, points, velocity, visitors, .. } = self;
        if let Some(visitors) = visitors {
            visitors.accept_initial_overlap(&Surface::Deformable { surface: mesh, points, velocity }, solid);
        }
    }

    /// Takes the contacts of particles as they stand.
    pub(super) fn accept_initial_overlap(
        &mut self,
        solid: &Solid,
        spheres: &Spheres,
        which: impl Fn(u32) -> bool + Sync,
    ) {
        self.locate(solid);
        let SolidSurface { mesh, points, velocity, contacts, felt, .. } = self;
        let ground = Surface::Deformable { surface: mesh, points, velocity };
        let spheres = Spheres { radius: if felt.is_empty() { spheres.radius } else { felt }, ..*spheres };
        contacts.search(&ground, &spheres);
        contacts.accept_initial_overlap(&ground, &spheres, |i| which(i).then_some(0.0));
    }

    /// Adds the forces of nodes of other solids to both.
    pub(super) fn add_node_forces(&mut self, solid: &mut Solid, debris: &mut Debris, dt: f64) -> Work {
        let SolidSurface {
            body, mesh, nodes, points, velocity, visitors, elastic, surface, thickness, lightest, ..
        } = self;
        let Some(visitors) = visitors else { return Work::default() };
        let ground = Surface::Deformable { surface: mesh, points, velocity };
        let law = |solid: &Solid, debris: &Debris, node: u32| {
            debris.facet_law(node, solid.mass[node as usize], (elastic, *thickness), (*body, *surface))
        };
        let work = visitors.add_forces(&ground, solid, debris, law, dt);
        let mut fastest: f64 = 0.0;
        for (touch, place, node) in visitors.touches() {
            let mut mobility = 1.0 / solid.mass[node as usize];
            mesh.share(touch.feature, &place, points, |point, weight| {
                let own = nodes[point as usize] as usize;
                solid.force[own] -= touch.force * weight;
                mobility += weight * weight / solid.mass[own];
            });
            fastest = fastest.max(frequency_square(&law(solid, debris, node), mobility));
        }
        // A step that changes as bodies hit each other costs energy: it is short before.
        for node in visitors.close() {
            let mobility = 1.0 / solid.mass[node as usize] + 1.0 / *lightest;
            fastest = fastest.max(frequency_square(&law(solid, debris, node), mobility));
        }
        self.frequency_square = self.frequency_square.max(fastest);
        work
    }

    /// Has the step be short from the start where nodes of other plane solids are close to it.
    pub(super) fn expect_nodes(&mut self, solid: &Solid, debris: &Debris) {
        self.locate(solid);
        let lightest = self.nodes.iter().map(|&n| solid.mass[n as usize]).fold(f64::INFINITY, f64::min);
        self.lightest = lightest;
        let SolidSurface { body, mesh, points, velocity, visitors, elastic, surface, thickness, .. } = self;
        let ground = Surface::Deformable { surface: mesh, points, velocity };
        let near = visitors.iter_mut().flat_map(|visitors| visitors.near(&ground, solid));
        let asked = near.map(|node| {
            let mass = solid.mass[node as usize];
            let law = debris.facet_law(node, mass, (elastic, *thickness), (*body, *surface));
            frequency_square(&law, 1.0 / mass + 1.0 / lightest)
        });
        self.frequency_square = asked.fold(self.frequency_square, f64::max);
    }

    fn locate(&mut self, solid: &Solid) {
        for (place, &node) in self.nodes.iter().enumerate() {
            self.points[place] = solid.position(node as usize);
            self.velocity[place] = solid.velocity[node as usize];
        }
    }

    /// Largest squared frequency that the contacts of the last step give to a node [1/s²].
    pub(super) fn frequency_square(&self) -> f64 {
        self.frequency_square
    }

    /// Whether the skin is used up, by the way of some of the particles and that of the nodes.
    pub(super) fn is_used_up(&mut self, solid: &Solid, spheres: &Spheres, range: Range<usize>) -> bool {
        self.locate(solid);
        let SolidSurface { mesh, points, velocity, contacts, .. } = self;
        contacts.is_used_up(&Surface::Deformable { surface: mesh, points, velocity }, spheres, range)
    }

    /// Looks up which particles are near.
    pub(super) fn renew(&mut self, solid: &Solid, spheres: &Spheres) {
        self.locate(solid);
        let SolidSurface { mesh, points, velocity, contacts, felt, .. } = self;
        let spheres = Spheres { radius: if felt.is_empty() { spheres.radius } else { felt }, ..*spheres };
        contacts.renew(&Surface::Deformable { surface: mesh, points, velocity }, &spheres);
    }

    /// Finds the contacts of the moment and adds their forces to the nodes, by the weights of the places.
    ///
    /// - `searches`: whether to look up which particles are near, where that is due; `dt` [s]: the step that led here
    pub(super) fn add_forces(
        &mut self,
        solid: &mut Solid,
        spheres: &Spheres,
        body_of: &[u16],
        law: impl Fn(&MaterialPair, u32) -> Hertz + Sync,
        searches: bool,
        dt: f64,
    ) -> Work {
        self.locate(solid);
        let SolidSurface { mesh, nodes, points, velocity, contacts, pairs, felt, .. } = self;
        let spheres = &Spheres { radius: if felt.is_empty() { spheres.radius } else { felt }, ..*spheres };
        let ground = Surface::Deformable { surface: mesh, points, velocity };
        let law_of = |i: u32| law(&pairs[body_of[i as usize] as usize], i);
        if searches {
            contacts.search(&ground, spheres);
        }
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

/// Contacts of particles, and of nodes of other solids.
pub(super) type SolidSurfaceState = (Vec<Touch<HertzMemory>>, Vec<Touch<ContactMemory>>);

/// Corners of a facet: those of an edge repeat the second.
fn corners(facet: &[u32; 3]) -> usize {
    if facet[1] == facet[2] { 2 } else { 3 }
}

/// The nodes of a facet ascending, of an edge with the last one twice.
fn sorted(mut nodes: [u32; 3]) -> [u32; 3] {
    let count = corners(&nodes);
    nodes[..count].sort_unstable();
    nodes[2] = nodes[2].max(nodes[1]);
    nodes
}
