//! Looks at the state of a scene: is the theory still valid?

use fractum_fem::{Extreme, Extremes, fields};

use crate::ledger::EnergyKind;
use crate::scene::Scene;
use crate::watch::{Notice, Noticed, Site};

/// Share of the elastic energy of contact and solids, over the run so far, that the springs of contact may hold: a force lacks it.
const SOFT: f64 = 0.05;
/// Rotation of a body of small strains [rad], 10 degrees: it adds a strain of 1.5 %.
pub(crate) const TURNED: f64 = std::f64::consts::PI / 18.0;
/// Strain beyond which the law of small stretches is off by as much.
const STRAINED: f64 = 0.05;
/// One of so many bonds is strained in a body that is strained itself.
const STRAINED_BONDS: usize = 10;
/// Stress over the strength that is told where nothing can break.
const OVERLOADED: f64 = 1.1;
/// Compression over the tensile strength that no brittle material bears.
const PRESSED: f64 = 20.0;
/// Overlap over the radius beyond which Hertz' law of small contacts is off by some ten percent.
const DEEP: f64 = 0.1;

/// Slip over the size of a face beyond which its sides are not opposite each other any more.
const SLID: f64 = 0.5;

impl Scene {
    /// Looks whether the present state is still one that the models of the scene know. Nothing of the state changes.
    pub fn audit(&mut self) {
        look_at_temperatures(self);
        look_at_springs(self);
        look_at_solids(self);
        look_at_bonds(self);
        look_at_interfaces(self);
        look_at_liquid(self);
        self.look_at_overlaps();
    }

    /// Looks at the overlaps of particles alone, which an impact has for some tens of steps only.
    pub fn look_at_overlaps(&mut self) {
        if self.contacts.is_empty() {
            return;
        }
        let before = self.deepest_overlap().map_or(0.0, |before| before.value);
        let deepest = self.contacts.deepest(&self.bonded.particles);
        if let Some((site, value)) = deepest.filter(|(_, share)| *share > before) {
            let found = Noticed { what: Notice::Overlap, site, time: self.clock.time, value };
            self.optional.watch.deepest = Some(found);
            if value > DEEP {
                self.note(Notice::Overlap, site, value);
            }
        }
    }

    /// The largest overlap of a particle that was found so far, over the smaller radius.
    pub fn deepest_overlap(&self) -> Option<&Noticed> {
        self.optional.watch.deepest.as_ref()
    }

    /// Keeps what was noticed; of each kind the first counts. Nothing is allocated.
    pub fn note(&mut self, what: Notice, site: Site, value: f64) {
        let noticed = Noticed { what, site, time: self.clock.time, value };
        self.optional.watch.first[what as usize].get_or_insert(noticed);
    }

    /// What was noticed so far, a kind each.
    pub fn noticed(&self) -> impl Iterator<Item = &Noticed> {
        self.optional.watch.first.iter().flatten()
    }
}

/// Whether something of this kind has been noticed before, so that nobody needs to look again.
fn has_noticed(scene: &Scene, what: Notice) -> bool {
    scene.optional.watch.first[what as usize].is_some()
}

/// Looks at what the springs of contact hold beside the solids, as long as nothing else touches.
fn look_at_springs(scene: &mut Scene) {
    let alone = scene.debris.is_empty() && scene.bonded.particles.is_empty() && scene.solid.body_count() > 0;
    if !alone || has_noticed(scene, Notice::Springs) {
        return;
    }
    let [springs, solids] = &mut scene.books.pressed;
    *springs += scene.ledger[EnergyKind::Contact];
    *solids += scene.ledger[EnergyKind::Elastic];
    let share = *springs / (*springs + *solids);
    // An impact is over in the first half of the run.
    if scene.settings.time_step.is_late(scene.clock.time) && *springs > 0.0 && share > SOFT {
        scene.note(Notice::Springs, Site::Scene, share);
    }
}

fn look_at_solids(scene: &mut Scene) {
    use Notice::{Compression, Rotation, Strain, TensionOutside};
    let all = [Rotation, Strain, TensionOutside, Compression];
    if scene.solid.body_count() == 0 || all.into_iter().all(|what| has_noticed(scene, what)) {
        return;
    }
    let Extremes { rotation, strain, tension, compression } = fields::extremes(&scene.solid);
    let found = [rotation, strain, tension, compression];
    for ((what, extreme), limit) in all.into_iter().zip(found).zip([TURNED, STRAINED, OVERLOADED, PRESSED]) {
        if let Some(Extreme { body, element, value }) = extreme.filter(|extreme| extreme.value > limit) {
            scene.note(what, Site::Element { body, element }, value);
        }
    }
}

/// Looks at the stretch of the bonds that hold: where a tenth of those of a body is strained, the body is.
fn look_at_bonds(scene: &mut Scene) {
    if scene.bonded.bodies.is_empty() || has_noticed(scene, Notice::Strain) {
        return;
    }
    let (particles, reference) = (&scene.bonded.particles, &scene.bonded.reference);
    let mut found = None;
    for body in &scene.bonded.bodies {
        let pairs = body.bonds.pairs().iter().enumerate().filter(|(bond, _)| body.is_joined(*bond));
        let (mut joined, mut beyond, mut most) = (0usize, 0usize, (0.0, 0u32));
        for (bond, &[i, _]) in pairs {
            let [from, to] = body.bonds.ends(bond, reference);
            let before = (to - from).norm();
            let strain = ((body.bonds.gap(bond, particles).norm() - before) / before).abs();
            joined += 1;
            beyond += usize::from(strain > STRAINED);
            if strain > most.0 {
                most = (strain, i);
            }
        }
        if STRAINED_BONDS * beyond > joined {
            found = Some(most);
            break;
        }
    }
    if let Some((strain, particle)) = found {
        scene.note(Notice::Strain, Site::Particle(particle), strain);
    }
}

fn look_at_interfaces(scene: &mut Scene) {
    if scene.interfaces().is_empty() || has_noticed(scene, Notice::InterfaceSlip) {
        return;
    }
    if let Some(((body, element), slip)) =
        scene.interfaces().farthest_slip(&scene.solid).filter(|(_, slip)| *slip > SLID)
    {
        scene.note(Notice::InterfaceSlip, Site::Element { body: body as usize, element }, slip);
    }
}

fn look_at_liquid(scene: &mut Scene) {
    let Some(liquid) = scene.optional.liquid.as_deref() else { return };
    let (full, overdrawn) = (liquid.area_if_all_wet(scene.interfaces()), liquid.overdrawn());
    for (what, found) in [(Notice::LiquidAtEnd, full), (Notice::Overdrawn, overdrawn)] {
        if let Some(value) = found {
            scene.note(what, Site::Scene, value);
        }
    }
}

fn look_at_temperatures(scene: &mut Scene) {
    let Some(heat) = scene.heat().filter(|_| !has_noticed(scene, Notice::BelowZero)) else { return };
    let coldest = |temperatures: &[f64]| {
        let all = temperatures.iter().copied().enumerate().filter(|(_, t)| *t < 0.0);
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let node = coldest(heat.of_nodes()).map(|(node, t)| (Site::Node(node as u32), t));
    let found = node.or_else(|| coldest(heat.of_particles()).map(|(i, t)| (Site::Particle(i as u32), t)));
    if let Some((site, temperature)) = found {
        scene.note(Notice::BelowZero, site, temperature);
    }
}
