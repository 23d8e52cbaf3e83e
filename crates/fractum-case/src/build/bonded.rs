//! Bonded bodies, and the supports, loads and probes on their particles.

use std::sync::Arc;

use fractum_dem::{Clumps, Particles};
use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_pack::Domain;
use fractum_prepare::PreparedBody;
use fractum_scene::coupling::Attachment;
use fractum_scene::{Bonded, BondedPart, EntryMotion, FlatFaces, Inlet, Support};

use super::conditions::{LoadedPoints, motion_of};
use super::precheck::check_field;
use super::{Context, periodic};
use crate::model::{
    BodyKind, BondedBody, Case, FileUnit, LooseBody, LooseSource, Material, PackingSource, Selection, TimeStep,
};
use crate::{Diagnostic, Field, Spanned};

/// Mean radius of the particles of a file from which on it is probably in millimetres [m].
const LARGE_RADIUS: f64 = 0.5;

/// A set of particles, ascending, with its name.
pub(super) type NamedSet = (String, Vec<u32>);

/// The sets of particles of a bonded body, in the numbering of the scene.
pub(super) struct ParticleSets {
    /// Index into `Case::bodies`.
    body: usize,
    /// Names and particles, ascending; the first is the whole body.
    sets: Vec<NamedSet>,
    /// The shape that it was packed into, with the number of its walls: the sets after the first.
    walls: Option<(Domain, usize)>,
}

impl Context<'_> {
    /// Joins the bonded bodies, and keeps the names of their sets.
    pub(super) fn bonded(&mut self, prepared: Vec<PreparedBody>) -> Option<Bonded> {
        let case = self.case;
        let bodies = case.bodies.iter().enumerate().filter_map(|(index, body)| match &body.kind {
            BodyKind::Bonded(own) => Some((index, body, own.material, &own.groups, &own.initial_velocity)),
            BodyKind::Particles(own) => Some((index, body, own.material, &own.groups, &own.initial_velocity)),
            _ => None,
        });
        let (mut parts, mut start) = (Vec::new(), 0u32);
        for ((index, body, material, groups, initial_velocity), mut made) in bodies.zip(prepared) {
            let count = made.particles.len() as u32;
            let motion = initial_motion(initial_velocity);
            if let Some(motion) = &motion {
                for field in initial_velocity.iter().flatten() {
                    check_field(self, field, seen(&made.particles));
                }
                set_motion(&mut made.particles, &mut made.clumps, motion);
                keep_in_plane(&mut made.particles);
            }
            if let Some(arrivals) = made.arrivals.take() {
                let motion: EntryMotion = match motion {
                    Some(motion) => Arc::new(motion),
                    None => Arc::new(|_, _| [Vec3::zeros(); 2]),
                };
                self.inlets.push(Inlet::new(start, arrivals, motion, &made.particles.radius));
            }
            self.scatter_particles(&body.name.value, &case.materials[material], &mut made);
            let domain = made.domain.take().map(|domain| (domain, made.walls.len()));
            let mut sets = vec![(String::new(), (start..start + count).collect::<Vec<u32>>())];
            sets.extend(made.walls.into_iter().map(|(name, set)| (name, set.iter().map(|i| i + start).collect())));
            for (name, condition) in groups {
                if sets.iter().any(|(known, _)| *known == name.value) {
                    self.error(&name.place, "is the name of a wall of the body", "another name");
                    continue;
                }
                let inside = |i: &u32| condition.holds_at(made.particles.position[*i as usize]);
                let set: Vec<u32> = (0..count).filter(inside).map(|i| i + start).collect();
                if set.is_empty() {
                    self.error(&name.place, "holds for no particle", "a condition that the centre of one fulfils");
                }
                sets.push((name.value.clone(), set));
            }
            self.particle_sets.push(ParticleSets { body: index, sets, walls: domain });
            self.flat_faces.push(flat_faces(&case.materials[material], [made.shift_to_walls, made.out_of_flat_walls]));
            parts.push(BondedPart {
                name: body.name.value.clone(),
                particles: made.particles,
                pairs: made.pairs,
                law: made.law,
                shares: made.shares,
                density: case.materials[material].density,
                fraction: made.fraction,
                fracture: made.fracture,
                clumps: made.clumps,
            });
            start += count;
        }
        let frequency_of_all = case.solver.time_step != TimeStep::Element;
        let cell = periodic::cell(case);
        let joined = Bonded::within(parts, cell.as_ref()).and_then(|mut bonded| {
            bonded.set_dissipation(case.damping.tchamwa_wielgosz.unwrap_or(1.0));
            if frequency_of_all {
                bonded.find_frequency()?;
            }
            Ok(bonded)
        });
        match joined {
            Ok(bonded) => Some(bonded),
            Err(error) => {
                let place = self.whole_case();
                self.error(&place, format!(": {error}"), "");
                None
            }
        }
    }

    /// Whether a name is that of a bonded body or of one of its sets.
    pub(super) fn names_particles(&self, on: &Selection) -> bool {
        self.case.particle_group(on.group_name()).is_some()
    }

    /// The shape that a body was packed into, and the particles at each of its walls.
    pub(super) fn walls_of(&self, body: usize) -> Option<(Domain, Vec<NamedSet>)> {
        let own = self.particle_sets.iter().find(|sets| sets.body == body)?;
        let (domain, count) = own.walls.as_ref()?;
        Some((domain.clone(), own.sets[1..=*count].to_vec()))
    }

    /// The particles that are meant, of the group that names them.
    pub(super) fn selected_particles(&mut self, on: &Selection, group: &Spanned<String>, bonded: &Bonded) -> Vec<u32> {
        let particles = self.particles(group);
        self.keep_within(on, particles, |i| bonded.particles.position[i as usize])
    }

    /// The particles that a name of the case means; an error if the body has no such set.
    pub(super) fn particles(&mut self, group: &Spanned<String>) -> Vec<u32> {
        let Some((body, set)) = self.case.particle_group(&group.value) else { return Vec::new() };
        let Some(own) = self.particle_sets.iter().find(|sets| sets.body == body) else { return Vec::new() };
        let wanted = set.unwrap_or_default();
        if let Some((_, particles)) = own.sets.iter().find(|(name, _)| name == wanted) {
            return particles.clone();
        }
        let known: Vec<String> = own.sets[1..].iter().map(|(name, _)| name.clone()).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        super::precheck::unknown_set(self, group, &self.case.bodies[body].name.value, wanted, &known);
        Vec::new()
    }

    /// Supports and loads on particles; those that are tied follow a solid, and no support.
    pub(super) fn condition_particles(
        &mut self,
        bonded: &mut Bonded,
        attachments: &[Attachment],
        warnings: &mut Vec<Diagnostic>,
    ) {
        let case = self.case;
        let mut tied: Vec<u32> = attachments.iter().map(|a| a.particle).collect();
        tied.sort_unstable();
        let (mut sets, mut turning) = (Vec::new(), Vec::new());
        for support in case.supports.iter().filter(|s| case.particle_group(s.on.group_name()).is_some()) {
            let Some(group) = &support.on.group else { continue };
            let mut particles = self.selected_particles(&support.on, group, bonded);
            let whole = particles.len();
            particles.retain(|i| tied.binary_search(i).is_err());
            if particles.is_empty() && whole > 0 {
                let found = format!("= \"{}\": all of its {whole} particles are tied to a solid", group.value);
                self.error(&group.place, found, "particles that are free; support the solid instead");
            } else if particles.len() < whole {
                let count = whole - particles.len();
                let found = format!("= \"{}\": {count} of its {whole} particles are tied to a solid", group.value);
                let warning = Diagnostic::warning(Code::SupportOnTie, &group.place, found);
                warnings.push(
                    warning.remedy("they follow it, and the support holds the others; support the solid as well"),
                );
            }
            for (axis, motion) in support.motion.iter().enumerate() {
                let Some(motion) = motion else { continue };
                sets.push(Support::new(support.label(), particles.clone(), axis, motion_of(&motion.value)));
            }
            if let Some(axes) = &support.fix_rotation {
                turning.extend(particles.iter().map(|&i| (i, axes.value)));
            }
        }
        if let Err(error) = bonded.set_supports(sets, &turning) {
            let place = self.place_of_support(&error);
            self.error(&place, format!(": {error}"), "");
        }
        let loads = self.loads(&LoadedPoints::Particles(bonded));
        bonded.set_loads(loads);
    }
}

/// Faces of a bonded body as rigid bodies feel them; none where its particles touch as spheres of the modulus given for them.
fn flat_faces(material: &Material, [shift, out]: [Vec<Vec3>; 2]) -> Option<FlatFaces> {
    let flat = material.contact_modulus.is_none() && !shift.is_empty();
    let (young_modulus, poisson_ratio) = (material.young_modulus, material.poisson_ratio);
    flat.then_some(FlatFaces { young_modulus, poisson_ratio, shift, out })
}

/// Velocity of a field at a place [m/s], and its rate of rotation over a radius there, half the curl [rad/s]; none where all is at rest.
fn initial_motion(
    field: &[Option<Spanned<Field>>; 3],
) -> Option<impl Fn(&Vec3, f64) -> [Vec3; 2] + Send + Sync + use<>> {
    if field.iter().all(Option::is_none) {
        return None;
    }
    let field = field.clone();
    let velocity = move |x: Vec3| Vec3::from_fn(|axis, _| field[axis].as_ref().map_or(0.0, |f| f.value.at(x)));
    Some(move |x: &Vec3, h: f64| {
        // Central differences over the particle itself: what it would see of the motion.
        let slope = |axis: usize| {
            let mut step = Vec3::zeros();
            step[axis] = h;
            (velocity(x + step) - velocity(x - step)) / (2.0 * h)
        };
        let [dx, dy, dz] = [slope(0), slope(1), slope(2)];
        [velocity(*x), Vec3::new(dy.z - dz.y, dz.x - dx.z, dx.y - dy.x) * 0.5]
    })
}

/// Particles of files that are as large as if their unit were another one.
pub(super) fn doubts_of_size(case: &Case, prepared: &[PreparedBody]) -> Vec<Diagnostic> {
    let file = |kind: &'_ BodyKind| match kind {
        BodyKind::Particles(LooseBody { source: LooseSource::File { file, unit, .. }, .. })
        | BodyKind::Bonded(BondedBody { packing: PackingSource::Particles { file, unit, .. }, .. }) => {
            Some(Some((file.name.clone(), *unit)))
        }
        BodyKind::Particles(_) | BodyKind::Bonded(_) => Some(None),
        _ => None,
    };
    let files = case.bodies.iter().filter_map(|body| file(&body.kind));
    let doubt = |(file, made): (Option<(Spanned<String>, FileUnit)>, &PreparedBody)| {
        let (name, unit) = file?;
        let radii = &made.particles.radius;
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        if unit.is_named || unit.length != 1.0 || mean < LARGE_RADIUS {
            return None;
        }
        let found = format!("= \"{}\": its particles have a mean radius of {}", name.value, quantity(mean, "m"));
        let note = Diagnostic::warning(Code::UnitOfLength, &name.place, found);
        let note = note.expected("lengths in metres, the unit where bodies[].unit names no other");
        Some(note.remedy("if they are in millimetres, set unit = \"mm\" on the body"))
    };
    files.zip(prepared).filter_map(doubt).collect()
}

/// Places at which particles look at a field of velocity, see [`initial_motion`].
fn seen(particles: &Particles) -> impl Iterator<Item = Vec3> {
    particles.position.iter().zip(&particles.radius).flat_map(|(&x, &h)| {
        let beside = move |axis: usize| {
            let mut step = Vec3::zeros();
            step[axis] = h;
            [x + step, x - step]
        };
        std::iter::once(x).chain((0..3).flat_map(beside))
    })
}

/// Takes out of the motion of discs what a field has across their plane.
fn keep_in_plane(particles: &mut Particles) {
    if particles.thickness.is_some() {
        particles.velocity.iter_mut().for_each(|velocity| velocity.z = 0.0);
        particles.spin.iter_mut().for_each(|spin| (spin.x, spin.y) = (0.0, 0.0));
    }
}

/// Gives particles the motion of their places, and clumps that of their centres of mass.
fn set_motion(particles: &mut Particles, clumps: &mut Clumps, motion: &impl Fn(&Vec3, f64) -> [Vec3; 2]) {
    for clump in 0..clumps.len() {
        let [velocity, spin] = motion(&clumps.motion.position[clump], clumps.radius(clump, particles));
        clumps.set_motion(clump, velocity, spin);
    }
    if !clumps.is_empty() {
        clumps.start(particles);
        return;
    }
    for i in 0..particles.len() {
        [particles.velocity[i], particles.spin[i]] = motion(&particles.position[i], particles.radius[i]);
    }
}
