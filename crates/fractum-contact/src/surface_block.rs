//! A share of the spheres near a ground: their contacts of one step, and how they follow from those of the last.

use std::ops::Range;

use fractum_kernels::contact::{ContactLaw, PairMotion};
use fractum_math::{Vec3, Work};

use crate::foot::Foot;
use crate::hierarchy::DoubleHierarchy;
use crate::inside::{foot_from_inside, foot_of_corner};
use crate::surface::FacetMesh;
use crate::touch::{Spheres, Surface, Touch};

/// Cosine of the angle between the normals of two steps beyond which a contact is a new one.
const SAME_CONTACT: f64 = 0.5;

/// Unit normals out of both lines at each point that is a corner of a plane body; none of other spheres.
pub(crate) type Corners = [Option<[Vec3; 2]>];

/// Some spheres near the ground.
#[derive(Clone, Debug)]
pub(crate) struct Block<L: ContactLaw> {
    pub(crate) spheres: Vec<u32>,
    /// Start of the facets of each sphere, and one more.
    pub(crate) starts: Vec<u32>,
    pub(crate) facets: Vec<u32>,
    pub(crate) touches: Vec<Touch<L::Memory>>,
    before: Vec<Touch<L::Memory>>,
    hierarchy: DoubleHierarchy,
    feet: Vec<Foot>,
    /// Contact of the last step that each foot continues.
    origin: Vec<Option<usize>>,
    /// Whether each contact of the last step goes on.
    taken: Vec<bool>,
    /// Corners that the ground is as near to as its depth.
    pub(crate) close: Vec<u32>,
    pub(crate) ended: Work,
}

impl<L: ContactLaw> Block<L> {
    pub(crate) fn empty() -> Self {
        Block {
            spheres: Vec::new(),
            starts: vec![0],
            facets: Vec::new(),
            touches: Vec::new(),
            before: Vec::new(),
            hierarchy: DoubleHierarchy::default(),
            feet: Vec::new(),
            origin: Vec::new(),
            taken: Vec::new(),
            close: Vec::new(),
            ended: Work::default(),
        }
    }

    pub(crate) fn update(
        &mut self,
        ground: &Surface,
        spheres: &Spheres,
        (depth, corners): (Option<f64>, &Corners),
        reach: f64,
        law: &(impl Fn(u32, f64) -> L + Sync),
        dt: f64,
    ) {
        std::mem::swap(&mut self.touches, &mut self.before);
        self.touches.clear();
        self.close.clear();
        self.ended = Work::default();
        let mut next_old = 0;
        for k in 0..self.spheres.len() {
            let sphere = self.spheres[k];
            let (centre, radius) = (&spheres.position[sphere as usize], spheres.radius[sphere as usize]);
            let first_old = next_old;
            while self.before.get(next_old).is_some_and(|t| t.sphere == sphere) {
                next_old += 1;
            }
            let old = first_old..next_old;
            let facets = &self.facets[self.starts[k] as usize..self.starts[k + 1] as usize];
            let farthest = radius + reach;
            let corner = corner_of(corners, sphere, radius);
            if find_feet(ground, facets, centre, farthest, (depth, corner), &mut self.hierarchy, &mut self.feet) {
                self.close.push(sphere);
            }
            if reach > 0.0 {
                self.feet.retain(|foot| foot.distance < radius + law(sphere, foot.curvature).reach());
            }
            if self.feet.is_empty() && old.is_empty() {
                continue;
            }
            self.follow(ground, old.clone());
            // A sphere that was taken as it stood, deep within an edge, may leave on the other side: what gives no force is its own.
            let overlap_offset =
                self.before[old.clone()].iter().map(|t| L::overlap_offset(&t.memory)).fold(0.0, f64::max);
            let comes = corner.is_some() && old.is_empty();
            self.add_touches(ground, spheres, law, dt, (sphere, overlap_offset, comes));
            for touch in self.before[old.clone()].iter().zip(&self.taken).filter(|(_, taken)| !**taken).map(|(t, _)| t)
            {
                self.ended += ending(touch, law(sphere, 0.0), ground, spheres, (dt, corner.is_some()));
            }
        }
    }

    /// Finds which contact of the last step each foot continues: the one on the same feature; or else the one on the
    /// same part of the surface that points most nearly the same way and that nothing else continues. A contact that appears together
    /// with a pass continues, as that does, the one beside it: both cancel at first.
    fn follow(&mut self, ground: &Surface, old: Range<usize>) {
        let Block { feet, before, origin, taken, .. } = self;
        let before = &before[old.clone()];
        taken.clear();
        taken.resize(before.len(), false);
        origin.clear();
        let is_like = |foot: &Foot, touch: &Touch<L::Memory>| {
            !foot.elastic && !touch.elastic && (touch.weight > 0.0) == (foot.weight > 0.0)
        };
        for foot in feet.iter() {
            let same = before.iter().position(|t| t.feature == foot.feature && is_like(foot, t));
            if let Some(k) = same {
                taken[k] = true;
            }
            origin.push(same);
        }
        let nearest = |foot: &Foot, among: &dyn Fn(usize, &Touch<L::Memory>) -> bool| {
            let (mut best, mut from) = (SAME_CONTACT, None);
            for (k, touch) in before.iter().enumerate().filter(|(k, t)| among(*k, t)) {
                let likeness = touch.normal.dot(&foot.normal);
                if touch.part == ground.part(foot.facet) && likeness > best {
                    (best, from) = (likeness, Some(k));
                }
            }
            from
        };
        let mut new = [false; 2];
        for (foot, from) in feet.iter().zip(origin.iter_mut()).filter(|(foot, from)| !foot.elastic && from.is_none()) {
            *from = nearest(foot, &|k, touch| !taken[k] && is_like(foot, touch));
            match *from {
                Some(k) => taken[k] = true,
                None => new[usize::from(foot.weight > 0.0)] = true,
            }
        }
        if new == [true; 2] {
            for (foot, from) in feet.iter().zip(origin.iter_mut()).filter(|(f, from)| !f.elastic && from.is_none()) {
                *from = nearest(foot, &|_, touch| touch.is_contact());
            }
        }
        for from in origin.iter_mut().flatten() {
            *from += old.start;
        }
    }

    /// Forces of the feet of one sphere, with what contacts that continue none start with, and whether it is a corner that touched nothing here: one
    /// that came from beside the end of a line was within already, which gives no force.
    fn add_touches(
        &mut self,
        ground: &Surface,
        spheres: &Spheres,
        law: &(impl Fn(u32, f64) -> L + Sync),
        dt: f64,
        (sphere, overlap_offset, comes): (u32, f64, bool),
    ) {
        let i = sphere as usize;
        for (foot, origin) in self.feet.iter().zip(&self.origin) {
            let mut memory = origin.map_or_else(Default::default, |k| self.before[k].memory);
            let place = spheres.position[i] + foot.offset;
            let (ground_velocity, ground_spin) = ground.motion_at(foot.feature, &place);
            let overlap = spheres.radius[i] - foot.distance;
            let (velocity, spin) = if foot.elastic {
                (Vec3::zeros(), Vec3::zeros())
            } else {
                let velocity = ground_velocity - spheres.velocity[i] - spheres.spin[i].cross(&foot.offset);
                (velocity, ground_spin - spheres.spin[i])
            };
            if origin.is_none() {
                let within = if comes && dt > 0.0 { overlap + velocity.dot(&foot.normal) * dt } else { 0.0 };
                L::add_overlap_offset(&mut memory, overlap_offset.max(within));
            }
            let motion = PairMotion { normal: foot.normal, overlap, velocity, spin, dt };
            let force = law(sphere, foot.curvature).force(&motion, &mut memory);
            let moment = -foot.offset.cross(&force.on_second) - force.couple_on_second;
            self.touches.push(Touch {
                force: -force.on_second * foot.weight,
                moment: moment * foot.weight,
                couple: -force.couple_on_second * foot.weight,
                stored: force.stored * foot.energy,
                friction: force.friction * foot.energy,
                damping: force.damping * foot.energy,
                ..unloaded(ground, sphere, foot, overlap, memory)
            });
        }
    }
}

/// A contact at a foot that bears nothing.
fn unloaded<M>(ground: &Surface, sphere: u32, foot: &Foot, overlap: f64, memory: M) -> Touch<M> {
    Touch {
        sphere,
        feature: foot.feature,
        part: ground.part(foot.facet),
        offset: foot.offset,
        overlap,
        normal: foot.normal,
        weight: foot.weight,
        elastic: foot.elastic,
        memory,
        force: Vec3::zeros(),
        moment: Vec3::zeros(),
        couple: Vec3::zeros(),
        stored: 0.0,
        friction: 0.0,
        damping: 0.0,
    }
}

impl<L: ContactLaw> Block<L> {
    /// Takes the contacts of some spheres as they stand: those that are new give no force, and those that have become deeper
    /// since the last step because the sphere has grown give that of before.
    ///
    /// - `grown`: by how much a sphere has grown [m]; none of the others
    pub(crate) fn accept_initial_overlap(
        &mut self,
        ground: &Surface,
        spheres: &Spheres,
        (depth, corners): (Option<f64>, &Corners),
        grown: &impl Fn(u32) -> Option<f64>,
    ) {
        std::mem::swap(&mut self.touches, &mut self.before);
        self.touches.clear();
        let mut next_old = 0;
        for k in 0..self.spheres.len() {
            let sphere = self.spheres[k];
            let first = self.touches.len();
            while let Some(touch) = self.before.get(next_old).filter(|t| t.sphere == sphere) {
                self.touches.push(*touch);
                next_old += 1;
            }
            let Some(growth) = grown(sphere) else { continue };
            for touch in &mut self.touches[first..] {
                touch.overlap += growth;
                L::add_overlap_offset(&mut touch.memory, growth);
            }
            let (centre, radius) = (&spheres.position[sphere as usize], spheres.radius[sphere as usize]);
            let facets = &self.facets[self.starts[k] as usize..self.starts[k + 1] as usize];
            let corner = corner_of(corners, sphere, radius);
            find_feet(ground, facets, centre, radius, (depth, corner), &mut self.hierarchy, &mut self.feet);
            for foot in &self.feet {
                if foot.elastic || self.touches[first..].iter().any(|t| t.feature == foot.feature) {
                    continue;
                }
                let overlap = radius - foot.distance;
                let mut memory = L::Memory::default();
                L::add_overlap_offset(&mut memory, overlap);
                self.touches.push(unloaded(ground, sphere, foot, overlap, memory));
            }
        }
    }
}

/// The normals at a sphere that is a corner, as long as it has no size of its own.
fn corner_of(corners: &Corners, sphere: u32, radius: f64) -> Option<&[Vec3; 2]> {
    corners.get(sphere as usize).filter(|_| radius == 0.0)?.as_ref()
}

/// What is left of a contact that ended in the step to here: its springs relax, and its forces act once more over half of that step.
///
/// - `is_corner`: one that was deeper than it can leave in a step has slid off the end of a line; what its spring still held is lost as damping
fn ending<L: ContactLaw>(
    touch: &Touch<L::Memory>,
    law: L,
    ground: &Surface,
    spheres: &Spheres,
    (dt, is_corner): (f64, bool),
) -> Work {
    let (mut memory, i) = (touch.memory, touch.sphere as usize);
    let (ground_velocity, ground_spin) = ground.motion_at(touch.feature, &(spheres.position[i] + touch.offset));
    let velocity = ground_velocity - spheres.velocity[i] - spheres.spin[i].cross(&touch.offset);
    let spin = ground_spin - spheres.spin[i];
    let motion = PairMotion { normal: touch.normal, overlap: -law.reach(), velocity, spin, dt };
    let force = law.force(&motion, &mut memory);
    let overlap = touch.overlap - L::overlap_offset(&touch.memory);
    if is_corner && overlap > velocity.dot(&touch.normal).abs() * dt {
        let given = -0.5 * dt * touch.force.dot(&velocity);
        return Work::contact(0.0, force.friction, touch.stored - given - force.friction);
    }
    Work::contact(0.0, force.friction * touch.weight, force.damping * touch.weight)
}

/// Feet of a sphere, in space; whether it is a corner that the ground is close to.
fn find_feet(
    ground: &Surface,
    facets: &[u32],
    centre: &Vec3,
    radius: f64,
    (depth, corner): (Option<f64>, Option<&[Vec3; 2]>),
    hierarchy: &mut DoubleHierarchy,
    feet: &mut Vec<Foot>,
) -> bool {
    let mut is_close = false;
    let mut on_facets = |surface: &FacetMesh, points: &[Vec3], centre: &Vec3, feet: &mut Vec<Foot>| {
        let inside = match (depth, corner) {
            (Some(depth), Some(corner)) => {
                let (foot, close) = foot_of_corner(surface, points, facets, centre, depth, corner);
                is_close = close;
                foot
            }
            (Some(depth), None) => foot_from_inside(surface, points, facets, centre, depth),
            (None, _) => None,
        };
        match inside {
            Some(foot) => {
                feet.clear();
                feet.push(foot);
            }
            None => hierarchy.feet(surface, points, facets, centre, radius, feet),
        }
    };
    let frame = match ground {
        Surface::Deformable { surface, points, .. } => {
            on_facets(surface, points, centre, feet);
            return is_close;
        }
        Surface::Rigid { surface, points, frame } => {
            on_facets(surface, points, &frame.to_body(centre), feet);
            frame
        }
        Surface::Shape { shape, hollow, frame } => {
            shape.feet(*hollow, &frame.to_body(centre), radius, feet);
            frame
        }
    };
    for foot in feet {
        foot.offset = frame.to_space(&foot.offset);
        foot.normal = frame.to_space(&foot.normal);
    }
    false
}
