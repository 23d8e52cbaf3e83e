//! Spheres on a ground of facets or a rigid shape, through time.

use std::ops::Range;

use fractum_kernels::contact::ContactLaw;
use fractum_math::{Vec3, Work};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;

use crate::surface::FacetMesh;
use crate::surface_block::Block;
use crate::touch::{Spheres, Surface, Touch};

/// Spheres handled as one piece of parallel work.
const BLOCK: usize = 256;

/// Contacts of a population of spheres with one ground, with their memories.
///
/// Contacts are found anew at every step; their memory follows them from facet to facet. Which facets may be near is
/// looked up only when something has moved by the skin. What is found does not depend on when that was.
#[derive(Clone, Debug)]
pub struct SurfaceContacts<L: ContactLaw> {
    skin: f64,
    /// Gap across which laws act at most [m].
    reach: f64,
    blocks: Vec<Block<L>>,
    /// Centres at the last search, in the axes of the ground [m].
    searched_at: Vec<Vec3>,
    /// Points of a deformable ground at the last search [m].
    points_at: Vec<Vec3>,
    /// Tree of the facets of a rigid ground, which stays.
    tree: Option<Bvh>,
    /// How far within the ground a centre still counts [m]; none where a surface has no inside.
    depth: Option<f64>,
    /// Normals at points that are corners of plane bodies; empty where there are none.
    corners: Vec<Option<[Vec3; 2]>>,
}

impl<L: ContactLaw> SurfaceContacts<L> {
    /// No contacts yet.
    ///
    /// - `skin` [m] > 0: what may move before facets are looked up again; a fraction of the smallest radius
    pub fn new(skin: f64) -> Self {
        SurfaceContacts {
            skin,
            reach: 0.0,
            blocks: Vec::new(),
            searched_at: Vec::new(),
            points_at: Vec::new(),
            tree: None,
            depth: None,
            corners: Vec::new(),
        }
    }

    /// The same for laws that act across gaps up to `reach` [m].
    pub fn with_reach(self, reach: f64) -> Self {
        SurfaceContacts { reach, ..self }
    }

    /// The same on facets that look outward: centres that are up to `depth` [m] behind them are within the ground, which
    /// pushes them out. So may spheres be points.
    ///
    /// A sphere whose closest place lies on an open edge counts as outside.
    pub fn on_solid_ground(self, depth: f64) -> Self {
        SurfaceContacts { depth: Some(depth), ..self }
    }

    /// Looks up the facets near each sphere if the skin is used up; true if it did.
    pub fn search(&mut self, ground: &Surface, spheres: &Spheres) -> bool {
        let is_due = self.is_used_up(ground, spheres, 0..spheres.position.len());
        if is_due {
            self.renew(ground, spheres);
        }
        is_due
    }

    /// Says how the points near the ground are corners of plane bodies, which meet lines that they face; after a
    /// [`search`](SurfaceContacts::search).
    ///
    /// - `count`: number of spheres
    /// - `normals`: unit normals out of the lines before and after a point, counter-clockwise around its body; none of other spheres
    pub fn set_corners(&mut self, count: usize, normals: impl Fn(u32) -> Option<[Vec3; 2]>) {
        self.corners.resize(count, None);
        for &point in self.blocks.iter().flat_map(|block| &block.spheres) {
            self.corners[point as usize] = normals(point);
        }
    }

    /// Whether the skin is used up, by the way of some of the spheres and that of the ground.
    pub fn is_used_up(&self, ground: &Surface, spheres: &Spheres, range: Range<usize>) -> bool {
        if spheres.position.is_empty() {
            return false;
        }
        if self.searched_at.len() != spheres.position.len() {
            return true;
        }
        let most = |moved: &mut dyn Iterator<Item = f64>| moved.fold(0.0, f64::max).sqrt();
        let sphere = |(x, at): (&Vec3, &Vec3)| (to_ground(ground, x) - at).norm_squared();
        let mut used = most(&mut spheres.position[range.clone()].iter().zip(&self.searched_at[range]).map(sphere));
        if let Surface::Deformable { points, .. } = ground {
            used += most(&mut points.iter().zip(&self.points_at).map(|(p, at)| (p - at).norm_squared()));
        }
        used > self.skin
    }

    /// Looks up the facets near each sphere.
    pub fn renew(&mut self, ground: &Surface, spheres: &Spheres) {
        self.searched_at.clear();
        self.searched_at.extend(spheres.position.iter().map(|x| to_ground(ground, x)));
        if let Surface::Deformable { points, .. } = ground {
            self.points_at.clear();
            self.points_at.extend_from_slice(points);
        }
        let touches = self.state();
        self.find_near(ground, spheres.radius);
        self.hand_out(touches);
    }

    fn find_near(&mut self, ground: &Surface, radii: &[f64]) {
        let (centres, skin, depth) = (&self.searched_at, self.skin + self.reach, self.depth.unwrap_or(0.0));
        let spheres: Vec<u32> = (0..centres.len() as u32).filter(|&i| radii[i as usize] >= 0.0).collect();
        let near: Vec<Vec<(u32, Vec<u32>)>> = match ground {
            Surface::Shape { shape, hollow, .. } => spheres
                .par_chunks(BLOCK)
                .map(|chunk| {
                    let mut feet = Vec::new();
                    let mut close = |i: u32| {
                        shape.feet(*hollow, &centres[i as usize], radii[i as usize] + skin, &mut feet);
                        !feet.is_empty()
                    };
                    chunk.iter().filter(|&&i| close(i)).map(|&i| (i, Vec::new())).collect()
                })
                .collect(),
            Surface::Rigid { surface, points, .. } | Surface::Deformable { surface, points, .. } => {
                let keep = matches!(ground, Surface::Rigid { .. });
                let tree = self.tree.take().filter(|_| keep).unwrap_or_else(|| tree_of(surface, points));
                let near_sphere = |i: u32| {
                    let (x, reach) = (centres[i as usize], radii[i as usize].max(depth) + skin);
                    let half = Vector::new(reach, reach, reach);
                    let around = Aabb::from_half_extents(Vector::new(x.x, x.y, x.z), half);
                    let close = |&f: &u32| {
                        !surface.is_gone(f) && surface.closest(f, points, &x).1.norm_squared() < reach * reach
                    };
                    let mut facets: Vec<u32> = tree.intersect_aabb(&around).filter(close).collect();
                    facets.sort_unstable();
                    facets
                };
                let rows = spheres
                    .par_chunks(BLOCK)
                    .map(|chunk| {
                        let rows = chunk.iter().map(|&i| (i, near_sphere(i)));
                        rows.filter(|(_, facets)| !facets.is_empty()).collect()
                    })
                    .collect();
                self.tree = Some(tree).filter(|_| keep);
                rows
            }
        };
        let mut near = near.into_iter().flatten().peekable();
        self.blocks.clear();
        while near.peek().is_some() {
            let mut block = Block::empty();
            for (sphere, facets) in near.by_ref().take(BLOCK) {
                block.spheres.push(sphere);
                block.facets.extend(facets);
                block.starts.push(block.facets.len() as u32);
            }
            self.blocks.push(block);
        }
    }

    /// Finds the contacts of the moment and their forces.
    ///
    /// - `law`: law of a sphere on this ground, where its mean curvature is the second argument [1/m]
    /// - `dt` [s]: the step that led here
    pub fn update(&mut self, ground: &Surface, spheres: &Spheres, law: impl Fn(u32, f64) -> L + Sync, dt: f64) -> Work {
        let (depth, reach) = ((self.depth, self.corners.as_slice()), self.reach);
        self.blocks.par_iter_mut().for_each(|block| block.update(ground, spheres, depth, reach, &law, dt));
        let mut work = Work::default();
        for block in &self.blocks {
            work += block.ended;
            for touch in &block.touches {
                work += Work::contact(touch.stored, touch.friction, touch.damping);
            }
        }
        work
    }

    /// Takes the contacts of some spheres as they stand, without any force; they touch no nearer than now until they have
    /// parted. Asks for a [`search`](SurfaceContacts::search) before.
    ///
    /// - `grown`: by how much a sphere has grown since the last update [m], whose contacts then keep their force; none for
    ///   spheres that are left alone
    pub fn accept_initial_overlap(
        &mut self,
        ground: &Surface,
        spheres: &Spheres,
        grown: impl Fn(u32) -> Option<f64> + Sync,
    ) {
        let depth = (self.depth, self.corners.as_slice());
        self.blocks.par_iter_mut().for_each(|block| block.accept_initial_overlap(ground, spheres, depth, &grown));
    }

    /// Has the next search look up everything, since radii or facets have changed.
    pub fn look_again(&mut self) {
        self.searched_at.clear();
    }

    /// Takes a sphere that was not there at a place to which the ground is not nearer than two skins: no search is due for it.
    pub fn admit(&mut self, ground: &Surface, sphere: u32, place: &Vec3) {
        self.searched_at.get_mut(sphere as usize).into_iter().for_each(|at| *at = to_ground(ground, place));
    }

    /// Spheres near the ground, ascending: all that can touch before the next search.
    pub fn near(&self) -> impl Iterator<Item = u32> {
        self.blocks.iter().flat_map(|block| block.spheres.iter().copied())
    }

    /// Corners that the ground was as near to at the last update as its depth, on either side.
    pub fn close_corners(&self) -> impl Iterator<Item = u32> {
        self.blocks.iter().flat_map(|block| block.close.iter().copied())
    }

    /// Contacts of the last update, in the order of the spheres.
    pub fn touches(&self) -> impl Iterator<Item = &Touch<L::Memory>> {
        self.blocks.iter().flat_map(|block| &block.touches)
    }

    /// Spheres that press on the ground, with the overlaps that bear [m]: those beyond what was accepted at the start.
    pub fn pressed(&self) -> impl Iterator<Item = (u32, f64)> {
        let contacts = self.touches().filter(|touch| touch.is_contact() && touch.force != Vec3::zeros());
        contacts.map(|touch| (touch.sphere, touch.overlap - L::overlap_offset(&touch.memory)))
    }

    /// Adds forces and moments to the spheres.
    pub fn add_to(&self, force: &mut [Vec3], moment: &mut [Vec3]) {
        for touch in self.touches() {
            force[touch.sphere as usize] += touch.force;
            moment[touch.sphere as usize] += touch.moment;
        }
    }

    /// Contacts for a checkpoint.
    pub fn state(&self) -> Vec<Touch<L::Memory>> {
        self.touches().copied().collect()
    }

    /// Puts saved contacts back; the next search looks up everything.
    pub fn restore(&mut self, touches: Vec<Touch<L::Memory>>) {
        self.searched_at.clear();
        let mut block = Block::empty();
        block.touches = touches;
        self.blocks = vec![block];
    }

    /// Gives each block the contacts of its spheres; both ascend.
    fn hand_out(&mut self, touches: Vec<Touch<L::Memory>>) {
        let mut touches = touches.into_iter().peekable();
        for block in &mut self.blocks {
            for &sphere in &block.spheres {
                while let Some(touch) = touches.next_if(|t| t.sphere <= sphere) {
                    block.touches.extend(Some(touch).filter(|t| t.sphere == sphere));
                }
            }
        }
    }
}

/// A place in the axes of the ground.
fn to_ground(ground: &Surface, x: &Vec3) -> Vec3 {
    match ground {
        Surface::Rigid { frame, .. } | Surface::Shape { frame, .. } => frame.to_body(x),
        Surface::Deformable { .. } => *x,
    }
}

pub(crate) fn tree_of(surface: &FacetMesh, points: &[Vec3]) -> Bvh {
    let bounds = |facet: u32| {
        let corner = |&c: &u32| points[c as usize];
        let corners = surface.corners(facet);
        let first = corner(&corners[0]);
        let grow = |(low, high): (Vec3, Vec3), p: Vec3| (low.inf(&p), high.sup(&p));
        let (low, high) = corners[1..].iter().map(corner).fold((first, first), grow);
        Aabb::new(Vector::new(low.x, low.y, low.z), Vector::new(high.x, high.y, high.z))
    };
    let boxes: Vec<Aabb> = (0..surface.len() as u32).map(bounds).collect();
    Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
}
