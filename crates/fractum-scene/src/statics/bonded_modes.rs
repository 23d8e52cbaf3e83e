//! Natural vibrations of bonded bodies: six unknowns a particle, with the masses and moments of inertia of the spheres.

use std::sync::Arc;

use fractum_dem::{BeamSection, Bonds, Particles};
use fractum_math::{Mat3, Ragged, Vec3};
use fractum_sparse::{BlockMatrix, Pattern};

use super::LinearSolver;
use super::rigid_motions::rigid_motions;
use super::settings::ModesSettings;
use super::slowest::{Counts, ModesError, Vibrating, size};
use crate::bonded::Bonded;
use crate::modes::Modes;
use crate::scene::Scene;

/// Particles up to which a factorisation is cheaper than an iteration without a coarse space.
const DIRECT: usize = 20_000;

/// Finds the slowest vibrations of bodies of beams.
pub(super) fn find(scene: &Scene, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, ModesError> {
    let bonded = &scene.bonded;
    let particles = &bonded.particles;
    let beams = beams(bonded);
    let stiffness = stiffness(bonded, &beams);
    let is_loose = |i: usize| stiffness.pattern().row(i).len() == 1;
    let of = |i: usize| if is_loose(i) { [0.0; 6] } else { free_mass(particles, i) };
    let mass: Vec<[f64; 6]> = (0..particles.len()).map(of).collect();
    let loose = (0..particles.len()).filter(|&i| is_loose(i)).count();
    let (pieces, rigid) = rigid_motions(scene, beams.iter().map(|&(i, j, _)| [i, j]));
    let counts = Counts { pieces, loose, rigid_motions: rigid.len() };
    let vibrating = Vibrating {
        stiffness,
        mass,
        places: bonded.reference.iter().map(|&p| p.into()).collect(),
        held: None,
        linear: match settings.linear {
            LinearSolver::Auto if particles.len() <= DIRECT => LinearSolver::Direct,
            LinearSolver::Auto => LinearSolver::Iterative,
            chosen => chosen,
        },
        rate: transit_rate(bonded, &beams) / size(bonded.reference.iter()).powi(2),
        stressed: false,
    };
    let found = vibrating.slowest(rigid.into_iter().map(|motion| motion.particles).collect(), settings, stop)?;
    let vector = |of: &[f64; 6], first: usize| Vec3::new(of[first], of[first + 1], of[first + 2]);
    let motion = |rows: &[[f64; 6]]| (Vec::new(), rows.iter().map(|own| [vector(own, 0), vector(own, 3)]).collect());
    Ok(vibrating.told(found, counts, |_| true, motion))
}

/// Square of the speed of the slowest wave along a beam [m²/s²].
pub(super) fn transit_rate(bonded: &Bonded, beams: &[(u32, u32, BeamSection)]) -> f64 {
    let (mass, reference) = (&bonded.particles.mass, &bonded.reference);
    let of = |&(i, j, section): &(u32, u32, BeamSection)| {
        let distance = (reference[j as usize] - reference[i as usize]).norm();
        section.axial() * distance / mass[i as usize].max(mass[j as usize])
    };
    beams.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// The beams that hold, with the particles at their ends.
pub(super) fn beams(bonded: &Bonded) -> Vec<(u32, u32, BeamSection)> {
    let bodies = bonded.bodies.iter().filter_map(|body| Some((&body.bonds, body.bonds.beam()?)));
    let of = |(bonds, section): (&Bonds, BeamSection)| {
        let live = bonds.pairs().iter().enumerate().filter(|(bond, _)| bonds.is_live(*bond));
        // All of its stiffness goes with Young's modulus.
        let own = move |bond| BeamSection { young_modulus: bonds.share(bond) * section.young_modulus, ..section };
        live.map(|(bond, &[i, j])| (i, j, own(bond))).collect::<Vec<_>>()
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
pub(super) fn beam(way: Vec3, section: BeamSection) -> [[[f64; 6]; 6]; 2] {
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
