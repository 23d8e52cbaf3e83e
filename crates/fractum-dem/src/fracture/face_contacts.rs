//! Contact of crack faces, and of strangers of a broken body.

use std::ops::Range;

use fractum_contact::close_pairs_of;

use super::faces::{Face, FaceWork};
use super::moving::Fracture;
use crate::bond::Bonds;
use crate::particles::{ParticleSubdomain, Particles, SHARED};

/// Gap up to which strangers are listed, over the smallest radius.
const SKIN: f64 = 0.5;

impl Fracture {
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
        if self.pairs.is_empty() {
            return FaceWork::default();
        }
        let own = part.map_or(0..particles.len(), ParticleSubdomain::own);
        let Fracture { pairs, works, .. } = self;
        works.fill(FaceWork::default());
        let mut of_others = FaceWork::default();
        for face in pairs.iter_mut() {
            let ends = face.pair.map(|i| i as usize);
            let [first, second] = ends.map(|i| own.contains(&i));
            if !first && !second {
                continue;
            }
            let work = if first { &mut works[ends[0] / SHARED] } else { &mut of_others };
            let Some([force, twist]) = face.force(particles, dt, work) else { continue };
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
        self.pairs.iter().filter(|face| face.is_loaded(particles)).map(|face| face.pair)
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
        let Fracture { graph, pairs, cracks, .. } = self;
        if cracks.is_empty() {
            return;
        }
        let (centres, radii) = (&particles.position[range.clone()], &particles.radius[range.clone()]);
        // Particles that have left have negative radii.
        let skin = SKIN * radii.iter().copied().filter(|radius| *radius > 0.0).fold(f64::INFINITY, f64::min);
        let mut lost = vec![false; range.len()];
        cracks.iter().flat_map(|crack| crack.pair).for_each(|i| lost[i as usize - range.start] = true);
        // Strangers that have parted again have nothing to remember.
        pairs.retain(|face| !face.stranger || face.gap(particles) < skin);
        let mut known: Vec<[u32; 2]> = pairs.iter().filter(|face| face.stranger).map(|face| face.pair).collect();
        known.sort_unstable();
        let start = range.start as u32;
        for [i, j] in close_pairs_of(centres, radii, skin, &|i| lost[i]) {
            let pair = [i + start, j + start];
            if !graph.were_bonded(pair) && known.binary_search(&pair).is_err() {
                let rest = radii[i as usize] + radii[j as usize];
                pairs.push(Face::new(bonds, particles, pair, rest, self.faces, true));
            }
        }
    }
}
