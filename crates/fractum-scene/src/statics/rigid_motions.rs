//! Connected pieces of a scene, and their rigid motions that nothing prevents.

use fractum_math::{Vec3, connected};

use super::support_check::{Piece, impossible, pieces};
use crate::scene::Scene;

/// Velocities in a rigid motion: of nodes, and of particles, displacement and then rotation.
pub(super) struct RigidMotion {
    pub(super) nodes: Vec<Vec3>,
    pub(super) particles: Vec<[f64; 6]>,
}

/// Pieces of solids and bonded bodies, those that are tied as one, and their rigid motions that no support prevents. A node
/// or particle by itself is no piece.
///
/// - `bonds`: pairs of particles that hold together
pub(super) fn rigid_motions(scene: &Scene, bonds: impl Iterator<Item = [u32; 2]>) -> (usize, Vec<RigidMotion>) {
    let (solid, bonded) = (&scene.solid, &scene.bonded);
    let (particles, nodes) = (&bonded.particles, solid.reference.len());
    let of_solids = pieces(solid, &[]);
    let within = of_solids.iter().flat_map(|(_, own)| own.windows(2).map(|pair| [pair[0], pair[1]]));
    let point = |particle: u32| nodes as u32 + particle;
    let ties = scene.ties.links().map(|(particle, node)| [point(particle), node]);
    let links = within.chain(bonds.map(|pair| pair.map(point))).chain(ties);
    let part = connected(nodes + particles.len(), links);
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); part.len()];
    part.iter().enumerate().for_each(|(point, &part)| members[part as usize].push(point));
    members.retain(|members| members.len() > 1);
    let mut is_tied = vec![false; particles.len()];
    scene.ties.links().for_each(|(particle, _)| is_tied[particle as usize] = true);
    let place = |point: usize| if point < nodes { solid.reference[point] } else { bonded.reference[point - nodes] };
    let mut motions = Vec::new();
    for members in &members {
        let centre = members.iter().map(|&point| place(point)).sum::<Vec3>() / members.len() as f64;
        let radius = |point: usize| if point < nodes { 0.0 } else { particles.radius[point - nodes] };
        let reach = |&point: &usize| (place(point) - centre).norm() + radius(point);
        let size = members.iter().map(reach).fold(f64::MIN_POSITIVE, f64::max);
        let none = if members[0] < nodes { impossible(solid) } else { &[] };
        let mut piece = Piece::free(centre, size, none);
        for &point in members {
            let held = match point.checked_sub(nodes) {
                None => scene.supports.held().get(point).copied().unwrap_or(0),
                Some(particle) if is_tied[particle] => 0,
                Some(particle) => particles.held[particle],
            };
            let is_held = |d: &usize| held >> d & 1 == 1;
            (0..3).filter(is_held).for_each(|axis| piece.hold(place(point), Vec3::ith(axis, 1.0)));
            (0..3).filter(|axis| is_held(&(axis + 3))).for_each(|axis| piece.hold_turn(axis));
        }
        for (node, stiffness) in scene.optional.surface_supports.springs() {
            if members.binary_search(&(node as usize)).is_ok() {
                let springs = stiffness.symmetric_eigen();
                let stiff = (0..3).filter(|&k| springs.eigenvalues[k] > 0.0);
                stiff.for_each(|k| piece.hold(place(node as usize), springs.eigenvectors.column(k).into_owned()));
            }
        }
        for motion in piece.free_motions() {
            let mut own = RigidMotion { nodes: vec![Vec3::zeros(); nodes], particles: vec![[0.0; 6]; particles.len()] };
            for &point in members {
                let (shift, turn) = (piece.velocity(&motion, place(point)), piece.spin(&motion));
                match point.checked_sub(nodes) {
                    None => own.nodes[point] = shift,
                    Some(particle) => own.particles[particle] = [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z],
                }
            }
            motions.push(own);
        }
    }
    (members.len(), motions)
}
