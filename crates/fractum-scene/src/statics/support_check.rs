//! Rigid motions that nothing prevents.

use fractum_fem::{ElementKind, Solid};
use fractum_math::Vec3;
use nalgebra::{Matrix6, Vector6};

use crate::error::SceneError;
use crate::fragment::parts;

/// Fails if some connected piece of the solid can move as a rigid body.
///
/// - `held`: bit a of a node is set where its axis a is prescribed; empty without supports
/// - `touched`: nodes that cannot move against a direction
///
/// # Errors
/// [`SceneError::FreeBody`] with the body and the motion.
pub fn check_supports(solid: &Solid, held: &[u8], touched: &[(u32, Vec3)]) -> Result<(), SceneError> {
    let plane = solid.body(0).shape == ElementKind::T3;
    for (body, nodes) in pieces(solid) {
        let holds = |&n: &u32| held.get(n as usize).copied().unwrap_or(0);
        let centre = nodes.iter().map(|&n| solid.reference[n as usize]).sum::<Vec3>() / nodes.len() as f64;
        let spread = |&n: &u32| (solid.reference[n as usize] - centre).norm();
        let size = nodes.iter().map(spread).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let mut gram = Matrix6::zeros();
        let mut hold = |node: u32, along: Vec3| {
            let x = (solid.reference[node as usize] - centre) / size;
            let turn = |about: Vec3| about.cross(&x).dot(&along);
            let row = Vector6::new(along.x, along.y, along.z, turn(Vec3::x()), turn(Vec3::y()), turn(Vec3::z()));
            gram += row * row.transpose();
        };
        for node in nodes.iter().filter(|n| holds(n) != 0) {
            (0..3).filter(|axis| holds(node) & (1 << axis) != 0).for_each(|axis| hold(*node, Vec3::ith(axis, 1.0)));
        }
        let mut members = nodes.clone();
        members.sort_unstable();
        touched.iter().filter(|(node, _)| members.binary_search(node).is_ok()).for_each(|&(n, along)| hold(n, along));
        if plane {
            // What leaves the plane is no motion of a plane body.
            for mode in [2, 3, 4] {
                gram.row_mut(mode).fill(0.0);
                gram.column_mut(mode).fill(0.0);
                gram[(mode, mode)] = 1.0;
            }
        }
        let eigen = gram.symmetric_eigen();
        let Some(free) = (0..6).find(|&m| eigen.eigenvalues[m] < 1e-9) else { continue };
        let motion = eigen.eigenvectors.column(free);
        let largest = (0..6).max_by(|&a, &b| motion[a].abs().total_cmp(&motion[b].abs())).unwrap_or(0);
        const NAMES: [&str; 6] = [
            "move along x",
            "move along y",
            "move along z",
            "turn about an axis along x",
            "turn about an axis along y",
            "turn about an axis along z",
        ];
        return Err(SceneError::FreeBody {
            body: solid.body(body).name.clone(),
            motion: NAMES[largest],
            x: centre.x,
            y: centre.y,
            z: centre.z,
        });
    }
    Ok(())
}

/// Connected pieces: the body of their first element, and their nodes.
fn pieces(solid: &Solid) -> Vec<(usize, Vec<u32>)> {
    let part = parts(solid);
    let mut body_of = vec![usize::MAX; part.len()];
    for body in 0..solid.body_count() {
        let model = solid.body(body);
        let corners = model.shape.node_count();
        for (element, _) in model.elements.iter().zip(solid.alive(body)).filter(|(_, alive)| **alive) {
            for &node in &element[..corners] {
                body_of[node as usize] = body_of[node as usize].min(body);
            }
        }
    }
    let mut members: Vec<(usize, Vec<u32>)> = vec![(usize::MAX, Vec::new()); part.len()];
    for (node, place) in (0..).zip(part).filter(|&(n, _)| body_of[n as usize] != usize::MAX) {
        let (body, nodes) = &mut members[place as usize];
        *body = (*body).min(body_of[node as usize]);
        nodes.push(node);
    }
    members.retain(|(_, nodes)| !nodes.is_empty());
    members
}
