//! Contact of crack faces, and of strangers of a broken body.

use std::ops::Range;

use fractum_contact::{Image, close_pairs_of, close_pairs_within};
use fractum_math::{Mat3, Vec3};

use super::faces::{Face, FaceWork};
use super::moving::Fracture;
use crate::bond::Bonds;
use crate::particles::{ParticleSubdomain, Particles, SHARED};

/// Gap up to which strangers are listed, over the smallest radius.
const SKIN: f64 = 0.5;

impl Fracture {
    /// Distance of two centres up to which particles of a body are looked at as strangers that may touch [m].
    pub fn reach(radii: &[f64]) -> f64 {
        let bounds = |(least, most): (f64, f64), r: &f64| (least.min(*r), most.max(*r));
        let (least, most) = radii.iter().fold((f64::INFINITY, 0.0), bounds);
        2.0 * most + SKIN * least
    }

    /// Adds the forces of crack faces and of strangers that touch; one call per step.
    ///
    /// - `part`: that of this process, where several share the body
    /// - `dt` [s]: the step that led here
    pub fn add_contact_forces(
        &mut self,
        particles: &mut Particles,
        part: Option<&ParticleSubdomain>,
        dt: f64,
    ) -> FaceWork {
        if let Some(through) = &mut self.through {
            through.sums = [Mat3::zeros(); 2];
        }
        if self.pairs.is_empty() {
            return FaceWork::default();
        }
        let own = part.map_or(0..particles.len(), ParticleSubdomain::own);
        let Fracture { pairs, works, through, .. } = self;
        works.fill(FaceWork::default());
        let mut of_others = FaceWork::default();
        for face in pairs.iter_mut() {
            let ends = face.pair.map(|i| i as usize);
            let [first, second] = ends.map(|i| own.contains(&i));
            if !first && !second {
                continue;
            }
            let work = if first { &mut works[ends[0] / SHARED] } else { &mut of_others };
            let cell = through.as_ref().map(|through| &through.cell);
            let Some([force, twist]) = face.force(particles, cell, dt, work) else { continue };
            if let Some(through) = through {
                let [by_edges, virial] = &mut through.sums;
                *by_edges += force * Vec3::from(face.image.map(f64::from)).transpose();
                *virial += force * face.apart(particles, Some(&through.cell)).transpose();
            }
            if first {
                particles.force[ends[0]] -= force;
                particles.moment[ends[0]] += twist;
            }
            if second {
                particles.force[ends[1]] += force;
                particles.moment[ends[1]] += twist;
            }
        }
        part.into_iter().for_each(|part| self.gather_works(part));
        self.works.iter().fold(FaceWork::default(), |mut sum, work| {
            sum.contact += work.contact;
            sum.kinks += work.kinks;
            sum
        })
    }

    /// Whether [`Fracture::find_new_pairs`] would look for any.
    pub fn may_have_new_pairs(&self) -> bool {
        !self.cracks.is_empty()
    }

    /// Pairs of particles that were never bonded and may touch.
    pub fn strangers(&self) -> impl Iterator<Item = [u32; 2]> {
        self.pairs.iter().filter(|face| face.stranger).map(|face| face.pair)
    }

    /// Pairs of particles that touch where no bond joins them.
    pub fn touching<'a>(&'a self, particles: &'a Particles) -> impl Iterator<Item = [u32; 2]> + 'a {
        let cell = self.through.as_ref().map(|through| &through.cell);
        self.pairs.iter().filter(move |face| face.is_loaded(particles, cell)).map(|face| face.pair)
    }

    /// Particles have left that touched nothing but each other: they keep no face against others.
    pub fn part_from_left(&mut self, particles: &Particles) {
        let left = |i: u32| particles.is_out(i as usize);
        self.pairs.retain(|face| left(face.pair[0]) == left(face.pair[1]));
    }

    /// Finds pairs of particles that were never bonded to each other and have come close, one of which has lost bonds: they
    /// are in contact from now on as crack faces are. A call every few steps is enough, but must come at the same steps in a run
    /// that goes on from a saved state.
    ///
    /// - `range`: the particles of the body
    pub fn find_new_pairs(&mut self, bonds: &Bonds, particles: &Particles, range: Range<usize>) {
        let Fracture { graph, pairs, cracks, through, .. } = self;
        let through = through.as_deref();
        let cell = through.map(|through| &through.cell);
        if cracks.is_empty() {
            return;
        }
        let (centres, radii) = (&particles.position[range.clone()], &particles.radius[range.clone()]);
        // Particles that have left have negative radii.
        let skin = SKIN * radii.iter().copied().filter(|radius| *radius > 0.0).fold(f64::INFINITY, f64::min);
        let mut lost = vec![false; range.len()];
        cracks.iter().flat_map(|crack| crack.pair).for_each(|i| lost[i as usize - range.start] = true);
        // Strangers that have parted again have nothing to remember.
        pairs.retain(|face| !face.stranger || face.gap(particles, cell) < skin);
        let mut known: Vec<[u32; 2]> = pairs.iter().filter(|face| face.stranger).map(|face| face.pair).collect();
        known.sort_unstable();
        let start = range.start as u32;
        let mut add = |[i, j]: [u32; 2], image: Image| {
            let pair = [i + start, j + start];
            // Particles that are bonded through one side may meet through another one.
            let were_bonded = match through {
                None => graph.were_bonded(pair),
                Some(through) => graph.bond_between(pair).is_some_and(|bond| through.images[bond as usize] == image),
            };
            if !were_bonded && known.binary_search(&pair).is_err() {
                let rest = radii[i as usize] + radii[j as usize];
                pairs.push(Face::new(bonds, particles, (pair, image), rest, self.faces, true));
            }
        };
        match cell {
            None => close_pairs_of(centres, radii, skin, &|i| lost[i]).into_iter().for_each(|pair| add(pair, [0; 3])),
            Some(cell) => {
                let near = close_pairs_within(cell, centres, radii, skin).into_iter();
                near.filter(|(pair, _)| pair.iter().any(|&i| lost[i as usize]))
                    .for_each(|(pair, image)| add(pair, image));
            }
        }
    }
}
