//! Fields of bonded bodies for ParaView: particles as points, bonds as lines.

use std::path::Path;

use fractum_io::Compression;
use fractum_io::vtk::{Field, PendingFile, PolyCells, PolyData};
use fractum_math::{Vec3, rotation_vector};
use fractum_scene::{BondedBody, Scene};

use crate::cracks::lost_bonds;
use crate::error::Failure;

fn vectors<'a>(of: impl Iterator<Item = Vec3> + 'a) -> Vec<[f64; 3]> {
    of.map(Into::into).collect()
}

/// Particles of bonded bodies as vertices.
pub(crate) fn particles_file(scene: &Scene, path: &Path) -> Result<PendingFile, Failure> {
    let bonded = &scene.bonded;
    let all = &bonded.particles;
    let points = vectors(all.position.iter().copied());
    let displacement = vectors(all.position.iter().zip(bonded.reference()).map(|(x, start)| x - start));
    let velocity = vectors(all.velocity.iter().copied());
    let spin = vectors(all.spin.iter().copied());
    let rotation = vectors(all.orientation.iter().map(rotation_vector));
    let mut body = vec![0i32; all.len()];
    for (index, part) in (0..).zip(bonded.bodies()) {
        body[part.range.clone()].fill(index);
    }
    // What has left is not drawn.
    let radius: Vec<f64> = all.radius.iter().map(|radius| radius.max(0.0)).collect();
    let lost = lost_bonds(all.len(), bonded.bodies().iter().flat_map(BondedBody::cracks));
    let data = PolyData {
        points: &points,
        cells: PolyCells::Points,
        point_data: &[
            Field::scalar("radius", &radius),
            Field::scalar("mass", &all.mass),
            Field::vector("displacement", &displacement),
            Field::vector("rotation", &rotation),
            Field::vector("velocity", &velocity),
            Field::vector("spin", &spin),
            Field::integer("body", &body),
            Field::scalar("broken_bonds", &lost),
        ],
        cell_data: &[],
        time: Some(scene.clock.time),
    };
    data.pending(path, Compression::Fast).map_err(|e| Failure::Output(e.into()))
}

/// Bonds that hold as lines between the centres of their particles, with their axial force and elastic energy.
pub(crate) fn bonds_file(scene: &Scene, path: &Path) -> Result<PendingFile, Failure> {
    let bonded = &scene.bonded;
    let all = &bonded.particles;
    let points = vectors(all.position.iter().copied());
    let (mut lines, mut force, mut energy, mut body) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, part) in (0..).zip(bonded.bodies()) {
        for bond in (0..part.bonds.len()).filter(|&bond| part.bonds.is_live(bond)) {
            let pair = part.bonds.pairs()[bond];
            let [first, second] = pair.map(|i| all.position[i as usize]);
            // The force on the second particle draws it towards the first in tension.
            let pull = part.bonds.forces_of(bond, all).force;
            lines.push(pair);
            force.push(-pull.dot(&(second - first).normalize()));
            energy.push(part.bonds.energy_of(bond, all).total());
            body.push(index);
        }
    }
    let data = PolyData {
        points: &points,
        cells: PolyCells::Lines(&lines),
        point_data: &[],
        cell_data: &[
            Field::scalar("axial_force", &force),
            Field::scalar("elastic_energy", &energy),
            Field::integer("body", &body),
        ],
        time: Some(scene.clock.time),
    };
    data.pending(path, Compression::Fast).map_err(|e| Failure::Output(e.into()))
}
