//! What several processes tell each other so that probes can be looked at.

use fractum_scene::{NeededPoints, Probe, ProbeNeeds, Scene, Watched, ranks};

/// Part of all points up to which those of a probe are followed by every process.
const WATCHED_PART: usize = 50;

/// What several processes tell each other before a probe is looked at.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fetch {
    /// Displacements and velocities of all nodes.
    pub(crate) nodes: bool,
    /// Motion of all particles.
    pub(crate) particles: bool,
    /// Damage of all edges.
    pub(crate) damage: bool,
    /// Contacts among all particles.
    pub(crate) contacts: bool,
    /// What these bonds (body, bond) remember.
    pub(crate) bonds: Vec<(u32, u32)>,
}

/// Points of probes that every process follows, since they are few or held by supports, and what is to be fetched for each probe.
pub(crate) fn points_of_probes(probes: &[Option<Box<dyn Probe>>], scene: &Scene) -> (Watched, Vec<Fetch>) {
    let mut watched = Watched::default();
    // Whether points must be fetched, since there are too many to be followed.
    let follow = |needed: NeededPoints, all: usize, of_supports: bool, watched: &mut Vec<u32>| match needed {
        NeededPoints::Some(points) if of_supports || points.len() <= all / WATCHED_PART => {
            watched.extend(points);
            false
        }
        _ => true,
    };
    let mut fetch = |probe: &dyn Probe| {
        let ProbeNeeds { nodes, particles, of_supports, damage, contacts, bonds } = probe.needs(scene);
        Fetch {
            nodes: follow(nodes, scene.solid.reference.len(), of_supports, &mut watched.nodes),
            particles: follow(particles, scene.bonded.particles.len(), of_supports, &mut watched.particles),
            damage,
            contacts,
            bonds,
        }
    };
    let fetches = probes.iter().map(|probe| probe.as_deref().map(&mut fetch).unwrap_or_default()).collect();
    (watched, fetches)
}

/// Has all processes tell each other what probes look at.
pub(crate) fn fetch_together<'a>(fetches: impl Iterator<Item = &'a Fetch> + Clone, scene: &mut Scene) {
    let any = |of: fn(&Fetch) -> bool| fetches.clone().any(of);
    if any(|fetch| fetch.damage) {
        ranks::gather_damage(scene);
    }
    if any(|fetch| fetch.nodes) {
        ranks::gather_nodes(scene);
    }
    if any(|fetch| fetch.particles) {
        ranks::gather_motion(scene);
    }
    if any(|fetch| fetch.contacts) {
        ranks::gather_contacts(scene);
    }
    let bonds: Vec<(u32, u32)> = fetches.flat_map(|fetch| &fetch.bonds).copied().collect();
    if !bonds.is_empty() {
        ranks::gather_bonds(scene, &bonds);
    }
}
