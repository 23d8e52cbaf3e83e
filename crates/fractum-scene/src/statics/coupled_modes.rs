//! Natural vibrations of solids and bonded bodies together: three unknowns a node, three displacements and three rotations
//! a particle. A tied particle has no unknowns: its motion is that of the facet, and its mass is that of the nodes.

use std::collections::BTreeMap;

use fractum_math::{Mat3, Vec3};
use fractum_sparse::BlockMatrix;

use super::LinearSolver;
use super::bonded_modes::{beam, beams, transit_rate as rate_of_beams};
use super::rigid_motions::{RigidMotion, rigid_motions};
use super::settings::ModesSettings;
use super::slowest::{Counts, ModesError, Motion, Vibrating, size};
use super::solid_modes::{add_solids, held_axes, transit_rate};
use super::system::lay_out;
use crate::modes::Modes;
use crate::scene::Scene;

/// Block rows up to which a factorisation is cheaper than an iteration without a coarse space.
const DIRECT: usize = 40_000;

/// Displacement and rotation of a particle by a block row of unknowns.
type Follows = Vec<(u32, [Mat3; 2])>;

/// Finds the slowest vibrations.
pub(super) fn find(scene: &Scene, settings: ModesSettings, stop: fn() -> bool) -> Result<Modes, ModesError> {
    let (solid, bonded) = (&scene.solid, &scene.bonded);
    let (nodes, particles) = (solid.reference.len(), &bonded.particles);
    let beams = beams(bonded);
    let mut has_beam = vec![false; particles.len()];
    beams.iter().for_each(|&(i, j, _)| [i, j].iter().for_each(|&end| has_beam[end as usize] = true));
    let tied: BTreeMap<u32, Follows> = scene.ties.motions().map(|(particle, by)| (particle, by.to_vec())).collect();
    let moves_alone = |i: usize| has_beam[i] && !tied.contains_key(&(i as u32));
    let row = |particle: usize| nodes + 2 * particle;
    let follows = |particle: u32| -> Follows {
        let (first, none, one) = (row(particle as usize) as u32, Mat3::zeros(), Mat3::identity());
        tied.get(&particle).cloned().unwrap_or_else(|| vec![(first, [one, none]), (first + 1, [none, one])])
    };
    let ends: Vec<[Follows; 2]> = beams.iter().map(|&(i, j, _)| [i, j].map(follows)).collect();
    let cliques: Vec<Vec<u32>> = ends.iter().map(|ends| ends.iter().flatten().map(|(row, _)| *row).collect()).collect();
    let rows = row(particles.len());
    let (pattern, pairs) = lay_out(solid, rows, &cliques)?;
    let mut stiffness = BlockMatrix::<3>::zeros(pattern);
    add_solids(&mut stiffness, &pairs, scene);
    for (&(i, j, section), [first, second]) in beams.iter().zip(&ends) {
        let way = bonded.reference[j as usize] - bonded.reference[i as usize];
        let ([own, across], [opposite, back]) = (beam(way, section), beam(-way, section));
        add_between(&mut stiffness, (first, first), own);
        add_between(&mut stiffness, (first, second), across);
        add_between(&mut stiffness, (second, second), opposite);
        add_between(&mut stiffness, (second, first), back);
    }
    let held = |row: usize| match row.checked_sub(nodes) {
        None => held_axes(scene, row),
        Some(own) if moves_alone(own / 2) => particles.held[own / 2] >> (3 * (own % 2)) & 0b111,
        Some(_) => 0b111,
    };
    let held: Vec<u8> = (0..rows).map(held).collect();
    let weight = |row: usize| match row.checked_sub(nodes) {
        None if stiffness.pattern().row(row).len() > 1 => solid.mass[row],
        None => 0.0,
        Some(own) if own % 2 == 0 => particles.mass[own / 2],
        Some(own) => particles.inertia[own / 2],
    };
    let of = |row: usize| {
        let weight = weight(row);
        std::array::from_fn(|a| if held[row] >> a & 1 == 0 { weight } else { 0.0 })
    };
    let mass: Vec<[f64; 3]> = (0..rows).map(of).collect();
    let spare = stiffness.largest_diagonal();
    stiffness.hold(&held, spare);
    let (pieces, rigid) = rigid_motions(scene, beams.iter().map(|&(i, j, _)| [i, j]));
    let loose = (0..particles.len()).filter(|&i| !has_beam[i] && !tied.contains_key(&(i as u32))).count();
    let counts = Counts { pieces, loose, rigid_motions: rigid.len() };
    let of_rows = |motion: &RigidMotion| -> Vec<[f64; 3]> {
        let of_particle = |(i, v): (usize, &[f64; 6])| match moves_alone(i) {
            true => [[v[0], v[1], v[2]], [v[3], v[4], v[5]]],
            false => [[0.0; 3]; 2],
        };
        let of_nodes = motion.nodes.iter().map(|&v| v.into());
        of_nodes.chain(motion.particles.iter().enumerate().flat_map(of_particle)).collect()
    };
    let rigid = rigid.iter().map(of_rows).collect();
    let place = |row: usize| match row.checked_sub(nodes) {
        None => solid.reference[row].into(),
        Some(own) => bonded.reference[own / 2].into(),
    };
    let extent = size(solid.reference.iter().chain(&bonded.reference));
    let (of_solids, of_beams) =
        (transit_rate(solid) * size(solid.reference.iter()).powi(2), rate_of_beams(bonded, &beams));
    let vibrating = Vibrating {
        stiffness,
        mass,
        places: (0..rows).map(place).collect(),
        held: None,
        linear: match settings.linear {
            LinearSolver::Auto if rows <= DIRECT => LinearSolver::Direct,
            LinearSolver::Auto => LinearSolver::Iterative,
            chosen => chosen,
        },
        rate: of_solids.min(of_beams) / (extent * extent),
        stressed: false,
    };
    let found = vibrating.slowest(rigid, settings, stop)?;
    let motion = |rows: &[[f64; 3]]| -> Motion {
        let of_particle = |i: usize| {
            let sum = |which: usize| {
                follows(i as u32).iter().map(|(row, by)| by[which] * Vec3::from(rows[*row as usize])).sum()
            };
            [sum(0), sum(1)]
        };
        (rows[..nodes].iter().map(|&v| v.into()).collect(), (0..particles.len()).map(of_particle).collect())
    };
    let is_displacement = |row: usize| row < nodes || (row - nodes).is_multiple_of(2);
    Ok(vibrating.told(found, counts, is_displacement, motion))
}

/// Adds the stiffness between the ends of a beam, as the rows see it that these ends follow.
fn add_between(matrix: &mut BlockMatrix<3>, (end, other): (&Follows, &Follows), stiffness: [[f64; 6]; 6]) {
    let part = |p: usize, q: usize| Mat3::from_fn(|a, b| stiffness[3 * p + a][3 * q + b]);
    let parts = [[part(0, 0), part(0, 1)], [part(1, 0), part(1, 1)]];
    for (row, follows) in end {
        for (column, by) in other {
            let mut block = Mat3::zeros();
            for (own, parts) in follows.iter().zip(&parts) {
                block += own.transpose() * (parts[0] * by[0] + parts[1] * by[1]);
            }
            matrix.add(
                *row as usize,
                *column as usize,
                std::array::from_fn(|a| std::array::from_fn(|b| block[(a, b)])),
            );
        }
    }
}
