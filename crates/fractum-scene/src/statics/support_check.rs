//! Rigid motions that nothing prevents.

use fractum_fem::{Solid, is_axisymmetric};
use fractum_math::Vec3;
use nalgebra::{Matrix6, Vector6};

use crate::error::SceneError;
use crate::fragment::parts;

/// Eigenvalue of the supports of a piece, over its size, below which a rigid motion counts as free.
const FREE: f64 = 1e-9;

/// Fails if some connected piece of the solid can move as a rigid body.
///
/// - `held`: bit a of a node is set where its axis a is prescribed; empty without supports
/// - `touched`: nodes that cannot move against a direction
/// - `links`: pairs of nodes of pieces that hold together
///
/// # Errors
/// [`SceneError::FreeBody`] with the body and the motion.
pub fn check_supports(
    solid: &Solid,
    held: &[u8],
    touched: &[(u32, Vec3)],
    links: &[[u32; 2]],
) -> Result<(), SceneError> {
    for (body, nodes) in pieces(solid, links) {
        let mut piece = Piece::new(solid, &nodes, held);
        let mut members = nodes.clone();
        members.sort_unstable();
        let own = touched.iter().filter(|(node, _)| members.binary_search(node).is_ok());
        own.for_each(|&(node, along)| piece.hold(solid.reference[node as usize], along));
        let Some(motion) = piece.free_motion() else { continue };
        let largest = (0..6).max_by(|&a, &b| motion[a].abs().total_cmp(&motion[b].abs())).unwrap_or(0);
        const NAMES: [&str; 6] = [
            "move along x",
            "move along y",
            "move along z",
            "turn about an axis along x",
            "turn about an axis along y",
            "turn about an axis along z",
        ];
        let (name, [x, y, z]) = (solid.body(body).name.clone(), piece.centre.into());
        return Err(SceneError::FreeBody { body: name, motion: NAMES[largest], x, y, z });
    }
    Ok(())
}

/// The degrees of freedom that are prescribed, with as few more as keep every piece from moving as a rigid body.
///
/// - `held`: bit a of a node is set where its axis a is prescribed; empty without supports
/// - `links`: pairs of nodes of pieces that hold together
pub(super) fn pins(solid: &Solid, held: &[u8], links: &[[u32; 2]]) -> Vec<u8> {
    let mut pinned = if held.is_empty() { vec![0; solid.reference.len()] } else { held.to_vec() };
    for (_, nodes) in pieces(solid, links) {
        let mut piece = Piece::new(solid, &nodes, held);
        while let Some(motion) = piece.free_motion() {
            let of = |&node: &u32| {
                let v = piece.velocity(&motion, solid.reference[node as usize]);
                (0..3).map(move |axis| (node, axis, v[axis].abs()))
            };
            let fastest = nodes.iter().flat_map(of).max_by(|a, b| a.2.total_cmp(&b.2));
            let Some((node, axis, _)) = fastest else { break };
            pinned[node as usize] |= 1 << axis;
            piece.hold(solid.reference[node as usize], Vec3::ith(axis, 1.0));
        }
    }
    pinned
}

/// The supports of a connected piece as a quadratic form over its six rigid motions.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    centre: Vec3,
    size: f64,
    gram: Matrix6<f64>,
    /// Rigid motions that it has not.
    none: &'static [usize],
}

/// The rigid motions that a solid has not: what leaves its plane, and around an axis all but motion along it.
pub(super) fn impossible(solid: &Solid) -> &'static [usize] {
    match (solid.is_plane(), is_axisymmetric(solid)) {
        (_, true) => &[0, 2, 3, 4, 5],
        (true, _) => &[2, 3, 4],
        _ => &[],
    }
}

impl Piece {
    /// A piece that nothing holds.
    ///
    /// - `size`: distance by which rotations are measured [m], > 0
    /// - `none`: rigid motions that it has not, see [`impossible`]
    pub(super) fn free(centre: Vec3, size: f64, none: &'static [usize]) -> Self {
        Piece { centre, size, gram: Matrix6::zeros(), none }
    }

    fn new(solid: &Solid, nodes: &[u32], held: &[u8]) -> Self {
        let centre = nodes.iter().map(|&n| solid.reference[n as usize]).sum::<Vec3>() / nodes.len() as f64;
        let spread = |&n: &u32| (solid.reference[n as usize] - centre).norm();
        let size = nodes.iter().map(spread).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let mut piece = Piece::free(centre, size, impossible(solid));
        for &node in nodes {
            let bits = held.get(node as usize).copied().unwrap_or(0);
            let axes = (0..3).filter(|axis| bits & (1 << axis) != 0);
            axes.for_each(|axis| piece.hold(solid.reference[node as usize], Vec3::ith(axis, 1.0)));
        }
        piece
    }

    /// Prevents motion of a place along a direction.
    pub(super) fn hold(&mut self, place: Vec3, along: Vec3) {
        let x = (place - self.centre) / self.size;
        let turn = |about: Vec3| about.cross(&x).dot(&along);
        let row = Vector6::new(along.x, along.y, along.z, turn(Vec3::x()), turn(Vec3::y()), turn(Vec3::z()));
        self.gram += row * row.transpose();
    }

    /// Prevents rotation about an axis.
    pub(super) fn hold_turn(&mut self, axis: usize) {
        self.gram[(3 + axis, 3 + axis)] += 1.0;
    }

    /// All rigid motions that nothing prevents, at right angles to each other.
    pub(super) fn free_motions(mut self) -> Vec<Vector6<f64>> {
        let mut found = Vec::new();
        while let Some(motion) = self.free_motion() {
            self.gram += motion * motion.transpose();
            found.push(motion);
        }
        found
    }

    /// A rigid motion that nothing prevents: translation, and rotation times the size of the piece.
    fn free_motion(&self) -> Option<Vector6<f64>> {
        let mut gram = self.gram;
        for &mode in self.none {
            gram.row_mut(mode).fill(0.0);
            gram.column_mut(mode).fill(0.0);
            gram[(mode, mode)] = 1.0;
        }
        let eigen = gram.symmetric_eigen();
        let free = (0..6).find(|&m| eigen.eigenvalues[m] < FREE)?;
        Some(eigen.eigenvectors.column(free).into_owned())
    }

    /// Velocity of a place in a rigid motion.
    pub(super) fn velocity(&self, motion: &Vector6<f64>, place: Vec3) -> Vec3 {
        let turn = Vec3::new(motion[3], motion[4], motion[5]);
        Vec3::new(motion[0], motion[1], motion[2]) + turn.cross(&((place - self.centre) / self.size))
    }

    /// Angular velocity in a rigid motion.
    pub(super) fn spin(&self, motion: &Vector6<f64>) -> Vec3 {
        Vec3::new(motion[3], motion[4], motion[5]) / self.size
    }
}

/// Connected pieces: the body of their first element, and their nodes.
pub(super) fn pieces(solid: &Solid, links: &[[u32; 2]]) -> Vec<(usize, Vec<u32>)> {
    let part = parts(solid, links);
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
