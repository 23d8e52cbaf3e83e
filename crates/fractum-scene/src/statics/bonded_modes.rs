//! Natural vibrations of bonded bodies: six unknowns a particle, with the masses and moments of inertia of the spheres.

use std::sync::Arc;

use fractum_dem::{BeamSection, Particles};
use fractum_math::{Mat3, Ragged, Vec3, connected};
use fractum_sparse::{
    BlockMatrix, Factor, Inverse, Pattern, Preconditioner, Search, SparseError, Vibration, lowest_pairs,
};

use super::LinearSolver;
use super::faer::FaerFactor;
use super::settings::ModesSettings;
use super::slowest::{Found, TOLERANCES, find_with_stiffness, frequency, size};
use super::support_check::Piece;
use crate::bonded::Bonded;
use crate::modes::{Mode, Modes};

/// Motion of a particle: displacement, then rotation.
type Shape = Vec<[f64; 6]>;

/// Particles up to which a factorisation is cheaper than an iteration without a coarse space.
const DIRECT: usize = 20_000;

/// Finds the slowest vibrations of bodies of beams.
///
/// # Errors
/// [`SparseError`] if the factor does not fit.
pub(super) fn find(bonded: &Bonded, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, SparseError> {
    let particles = &bonded.particles;
    let beams: Vec<(u32, u32, BeamSection)> = beams(bonded);
    let stiffness = stiffness(bonded, &beams);
    let is_loose = |i: usize| stiffness.pattern().row(i).len() == 1;
    let of = |i: usize| if is_loose(i) { [0.0; 6] } else { free_mass(particles, i) };
    let mass: Vec<[f64; 6]> = (0..particles.len()).map(of).collect();
    let (pieces, rigid) = rigid_motions(bonded, &beams);
    let rigid_motions = rigid.len();
    let direct = match settings.linear {
        LinearSolver::Auto => particles.len() <= DIRECT,
        linear => linear != LinearSolver::Iterative,
    };
    let fastest = |&(i, j, section): &(u32, u32, BeamSection)| {
        let distance = (bonded.reference[j as usize] - bonded.reference[i as usize]).norm();
        section.axial() * distance / particles.mass[i as usize].max(particles.mass[j as usize])
    };
    let rate = beams.iter().map(fastest).fold(f64::INFINITY, f64::min) / size(&bonded.reference).powi(2);
    let mut entries = None;
    let wanted = (settings.count, TOLERANCES[usize::from(!direct)], stop);
    let (found, mechanisms) = find_with_stiffness(rigid, rate, wanted, |rigid, shift, search| {
        let (found, factor) = lowest(bonded, (&stiffness, &mass), rigid, shift, (search, settings.linear, direct))?;
        entries = factor;
        Ok(found)
    })?;
    let total = |of: &dyn Fn(usize, usize) -> f64| Vec3::from_fn(|axis, _| (0..mass.len()).map(|i| of(i, axis)).sum());
    let vector = |of: &[f64; 6], first: usize| Vec3::new(of[first], of[first + 1], of[first + 2]);
    let modes = found.values.iter().zip(&found.shapes).zip(&found.residuals);
    let modes = modes.map(|((value, shape), residual)| Mode {
        frequency: frequency(*value),
        residual: *residual,
        participation: total(&|i, axis| mass[i][axis] * shape[i][axis]),
        shape: shape.iter().map(|own| vector(own, 0)).collect(),
        turns: shape.iter().map(|own| vector(own, 3)).collect(),
    });
    Ok(Modes {
        modes: modes.collect(),
        pieces,
        loose: (0..particles.len()).filter(|&i| is_loose(i)).count(),
        rigid_motions,
        mechanisms,
        free_mass: total(&|i, axis| mass[i][axis]),
        work: (found.extensions, entries),
        converged: found.converged,
    })
}

/// The beams that hold, with the particles at their ends.
fn beams(bonded: &Bonded) -> Vec<(u32, u32, BeamSection)> {
    let bodies = bonded.bodies.iter().filter_map(|body| Some((&body.bonds, body.bonds.beam()?)));
    let of = |(bonds, section)| {
        let bonds: &fractum_dem::Bonds = bonds;
        let live = bonds.pairs().iter().enumerate().filter(|(bond, _)| bonds.is_live(*bond));
        live.map(move |(_, &[i, j])| (i, j, section)).collect::<Vec<_>>()
    };
    bodies.flat_map(of).collect()
}

/// Mass and moment of inertia of a particle where it is free.
fn free_mass(particles: &Particles, i: usize) -> [f64; 6] {
    std::array::from_fn(|d| match particles.held[i] >> d & 1 {
        1 => 0.0,
        _ if d < 3 => particles.mass[i],
        _ => particles.inertia[i],
    })
}

/// The assembled stiffness of small motions, without what is held.
fn stiffness(bonded: &Bonded, beams: &[(u32, u32, BeamSection)]) -> BlockMatrix<6> {
    let cliques = Ragged::from_rows(beams.iter().map(|&(i, j, _)| [i, j]));
    let pattern = Arc::new(Pattern::from_cliques(bonded.particles.len(), &cliques));
    let mut matrix = BlockMatrix::<6>::zeros(pattern);
    for &(i, j, section) in beams {
        let way = bonded.reference[j as usize] - bonded.reference[i as usize];
        let (i, j) = (i as usize, j as usize);
        let [own, across] = beam(way, section);
        let [opposite, back] = beam(-way, section);
        matrix.add(i, i, own);
        matrix.add(i, j, across);
        matrix.add(j, j, opposite);
        matrix.add(j, i, back);
    }
    let spare = matrix.largest_diagonal();
    matrix.hold(&bonded.particles.held, spare);
    matrix
}

/// Stiffness of an Euler–Bernoulli beam at its first particle, against motion of this one and of the other.
///
/// f₁ = -(E S/l P + 12 E I/l³ Q) (u₂ - u₁) - 6 E I/l² n × (θ₁ + θ₂),
/// m₁ = 2 E I/l Q (2 θ₁ + θ₂) - G I₀/l P (θ₂ - θ₁) - 6 E I/l² n × (u₂ - u₁), with P = n nᵀ, Q = 1 - P
fn beam(way: Vec3, section: BeamSection) -> [[[f64; 6]; 6]; 2] {
    let l = way.norm();
    let n = way / l;
    let (along, bending) = (n * n.transpose(), section.bending());
    let across = Mat3::identity() - along;
    let shift = along * (section.axial() / l) + across * (12.0 * bending / l.powi(3));
    let turn = n.cross_matrix() * (6.0 * bending / (l * l));
    let (bend, twist) = (across * (2.0 * bending / l), along * (section.torsion() / l));
    let blocks = |uu: Mat3, ut: Mat3, tu: Mat3, tt: Mat3| {
        let of = |row: usize, column: usize| match (row < 3, column < 3) {
            (true, true) => uu[(row, column)],
            (true, false) => ut[(row, column - 3)],
            (false, true) => tu[(row - 3, column)],
            (false, false) => tt[(row - 3, column - 3)],
        };
        std::array::from_fn(|row| std::array::from_fn(|column| of(row, column)))
    };
    [blocks(shift, -turn, turn, bend * 2.0 + twist), blocks(-shift, -turn, -turn, bend - twist)]
}

/// Connected pieces of more than one particle, with their rigid motions that nothing prevents.
fn rigid_motions(bonded: &Bonded, beams: &[(u32, u32, BeamSection)]) -> (usize, Vec<Shape>) {
    let (particles, reference) = (&bonded.particles, &bonded.reference);
    let part = connected(particles.len(), beams.iter().map(|&(i, j, _)| [i, j]));
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); particles.len()];
    part.iter().enumerate().for_each(|(i, &part)| members[part as usize].push(i));
    members.retain(|members| members.len() > 1);
    let mut motions = Vec::new();
    for members in &members {
        let centre = members.iter().map(|&i| reference[i]).sum::<Vec3>() / members.len() as f64;
        let reach = |&i: &usize| (reference[i] - centre).norm() + particles.radius[i];
        let size = members.iter().map(reach).fold(f64::MIN_POSITIVE, f64::max);
        let mut piece = Piece::free(centre, size);
        for &i in members {
            let held = |d: &usize| particles.held[i] >> d & 1 == 1;
            (0..3).filter(held).for_each(|axis| piece.hold(reference[i], Vec3::ith(axis, 1.0)));
            (0..3).filter(|axis| held(&(axis + 3))).for_each(|axis| piece.hold_turn(axis));
        }
        for motion in piece.free_motions() {
            let mut shape = vec![[0.0; 6]; particles.len()];
            for &i in members {
                let (shift, turn) = (piece.velocity(&motion, reference[i]), piece.spin(&motion));
                shape[i] = [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z];
            }
            motions.push(shape);
        }
    }
    (members.len(), motions)
}

/// The lowest pairs beside known motions, and the entries of the factor.
fn lowest(
    bonded: &Bonded,
    (stiffness, mass): (&BlockMatrix<6>, &[[f64; 6]]),
    rigid: &[Shape],
    shift: f64,
    (search, linear, direct): (Search, LinearSolver, bool),
) -> Result<(Found<Shape>, Option<usize>), SparseError> {
    let mut shifted = stiffness.clone();
    shifted.add_diagonal(mass, shift);
    let places: Vec<[f64; 3]> = bonded.reference.iter().map(|&p| p.into()).collect();
    let mut entries = None;
    let mut inverse: Box<dyn Inverse<6>> = if linear == LinearSolver::Faer {
        let mut factor = FaerFactor::new::<6>(stiffness.pattern(), &places)?;
        entries = Some(factor.entries());
        factor.refactor(&shifted)?;
        Box::new(factor)
    } else if direct {
        let mut factor = Factor::new(stiffness.pattern(), &places, 6)?;
        entries = Some(factor.entries());
        factor.refactor(&shifted)?;
        Box::new(factor)
    } else {
        Box::new(Preconditioner::new(&shifted, None)?)
    };
    let pairs = lowest_pairs(Vibration { stiffness, mass, rigid }, &mut *inverse, search);
    let fractum_sparse::Pairs { values, vectors, residuals, extensions, converged } = pairs;
    Ok((Found { values, shapes: vectors, residuals, extensions, converged }, entries))
}
