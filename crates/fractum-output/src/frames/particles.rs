//! Fields of bonded bodies and loose particles for ParaView: particles as points, bonds as lines.
//!
//! Points are where particles were at the start; the field `displacement` moves them to the present, as it does the nodes of solids.

use fractum_dem::stress::particle_virials;
use fractum_math::{Sym3, Vec3, rotation_vector};
use fractum_scene::{BondedBody, Scene, into_periodic_box};
use fractum_vtk::{Compression, Cut, Field, PendingFile, PolyCells, PolyData, Values};

use crate::OutputError;
use crate::frames::cracks::lost_bonds;
use crate::frames::frame_file::FrameFile;

fn vectors<'a>(of: impl Iterator<Item = Vec3> + 'a) -> Vec<[f64; 3]> {
    of.map(Into::into).collect()
}

/// Particles with and without bonds, and the bonds that hold; none where there is none of a kind.
pub(crate) struct ParticleFiles {
    pub(crate) bonded: Option<FrameFile>,
    pub(crate) loose: Option<FrameFile>,
    pub(crate) bonds: Option<PendingFile>,
}

impl ParticleFiles {
    /// Those of the present instant.
    pub(crate) fn of(scene: &Scene, cut: Cut) -> Result<Self, OutputError> {
        let bodies = || (0..).zip(scene.bonded.bodies());
        let [bonded, loose] = [false, true].map(|is_loose| {
            bodies().filter(|(_, body): &(i32, &BondedBody)| body.bonds.is_empty() == is_loose).collect::<Vec<_>>()
        });
        let count = |bodies: &[(i32, &BondedBody)]| bodies.iter().map(|(_, body)| body.range.len()).sum::<usize>();
        let loose = if count(&loose) > 0 { Some(particles_file(scene, &loose, None, cut)?) } else { None };
        if count(&bonded) == 0 {
            return Ok(ParticleFiles { bonded: None, loose, bonds: None });
        }
        let live = live_bonds(scene, &bonded);
        let stress = stresses(scene, &bonded, &live);
        Ok(ParticleFiles {
            bonded: Some(particles_file(scene, &bonded, Some(&stress), cut)?),
            loose,
            bonds: Some(bonds_file(scene, &bonded, &live)?),
        })
    }
}

/// A bond that holds.
struct LiveBond {
    pair: [u32; 2],
    body: i32,
    /// From its first particle to the second, or to the image that it joins [m].
    gap: Vec3,
    /// Force on its second particle [N].
    force: Vec3,
    /// Elastic energy [J].
    energy: f64,
}

fn live_bonds(scene: &Scene, bodies: &[(i32, &BondedBody)]) -> Vec<LiveBond> {
    let all = &scene.bonded.particles;
    let of_body = |&(body, part): &(i32, &BondedBody)| {
        let live = |bond: usize| LiveBond {
            pair: part.bonds.pairs()[bond],
            body,
            gap: part.bonds.gap(bond, all),
            force: part.bonds.forces_of(bond, all).force,
            energy: part.bonds.energy_of(bond, all).total(),
        };
        // Nor are the bonds of what has left drawn.
        let shown = |bond: &usize| {
            let [first, _] = part.bonds.pairs()[*bond];
            part.bonds.is_live(*bond) && !all.is_out(first as usize)
        };
        (0..part.bonds.len()).filter(shown).map(live).collect::<Vec<_>>()
    };
    bodies.iter().flat_map(of_body).collect()
}

/// Stress of every particle by its bonds, over the part of the continuum that it stands for [Pa].
fn stresses(scene: &Scene, bodies: &[(i32, &BondedBody)], bonds: &[LiveBond]) -> Vec<[f32; 6]> {
    let all = &scene.bonded.particles;
    let virials: Vec<Sym3> = particle_virials(all.len(), |visit| {
        for bond in bonds {
            let [i, j] = bond.pair.map(|particle| particle as usize);
            visit(i, j, bond.gap, -bond.force);
        }
    });
    let of_body = |(_, body): &(i32, &BondedBody)| {
        let stress = |i: usize| (virials[i] * (body.density / all.mass[i])).0.map(|s| s as f32);
        body.range.clone().map(stress).collect::<Vec<_>>()
    };
    bodies.iter().flat_map(of_body).collect()
}

/// Particles of some bodies as vertices.
fn particles_file(
    scene: &Scene,
    bodies: &[(i32, &BondedBody)],
    stress: Option<&[[f32; 6]]>,
    cut: Cut,
) -> Result<FrameFile, OutputError> {
    let (bonded, all) = (&scene.bonded, &scene.bonded.particles);
    let shown = || bodies.iter().flat_map(|(_, body)| body.range.clone());
    let scalar = |of: &[f64]| shown().map(|i| of[i]).collect::<Vec<f64>>();
    // In a box that repeats the images within it are shown, which have come as far as the particles.
    let into_box: Vec<[Vec3; 2]> = shown().map(|i| into_periodic_box(scene, &all.position[i])).collect();
    let points = vectors(shown().zip(&into_box).map(|(i, [beyond, _])| bonded.reference()[i] + beyond));
    let displacement = vectors(shown().map(|i| all.position[i] - bonded.reference()[i]));
    let velocity = vectors(shown().zip(&into_box).map(|(i, [_, beyond])| all.velocity[i] + beyond));
    let spin = vectors(shown().map(|i| all.spin[i]));
    let rotation = vectors(shown().map(|i| rotation_vector(&all.orientation[i])));
    let body: Vec<i32> = bodies.iter().flat_map(|(index, body)| body.range.clone().map(|_| *index)).collect();
    // What has left is not drawn.
    let radius: Vec<f64> = shown().map(|i| all.radius[i].max(0.0)).collect();
    let mass = scalar(&bonded.clumps().masses(all));
    let mut point_data = vec![
        Field::scalar("radius", &radius),
        Field::scalar("mass", &mass),
        Field::vector("displacement", &displacement),
        Field::vector("rotation", &rotation),
        Field::vector("velocity", &velocity),
        Field::vector("spin", &spin),
        Field::integer("body", &body),
    ];
    let thickness = all.thickness.map(|thickness| vec![thickness; radius.len()]);
    point_data.extend(thickness.as_ref().map(|thickness| Field::scalar("thickness", thickness)));
    let clumps = bonded.clumps().of_particles(all.len());
    let clump: Vec<i32> = if clumps.is_empty() { Vec::new() } else { shown().map(|i| clumps[i] as i32).collect() };
    if !clump.is_empty() {
        // -1 for those of none.
        point_data.push(Field::integer("clump", &clump));
    }
    let of_bonds = stress.map(|stress| {
        let strains = bonded.strains();
        let strain: Vec<[f32; 6]> = shown().map(|i| strains[i].0.map(|e| e as f32)).collect();
        (strain, scalar(&lost_bonds(all.len(), bodies.iter().flat_map(|(_, body)| body.cracks()))), stress)
    });
    if let Some((strain, lost, stress)) = &of_bonds {
        point_data.extend([tensor("strain", strain), Field::scalar("broken_bonds", lost), tensor("stress", stress)]);
    }
    let temperature = scene.heat().map(|heat| scalar(heat.of_particles()));
    point_data.extend(temperature.as_ref().map(|temperature| Field::scalar("temperature", temperature)));
    let data = PolyData {
        points: &points,
        cells: PolyCells::Points,
        point_data: &point_data,
        cell_data: &[],
        time: Some(scene.clock.time),
    };
    FrameFile::of_points(&data, cut)
}

/// A symmetric tensor in single precision: xx yy zz xy yz zx.
pub(crate) fn tensor<'a>(name: &'a str, values: &'a [[f32; 6]]) -> Field<'a> {
    Field { name, components: 6, values: Values::F32(values.as_flattened()) }
}

/// Part of a bond that is rounding.
const ROUNDING: f64 = 1e-6;

/// Bonds that hold as lines between the centres of their particles, with their axial force and elastic energy. In a box that repeats those are
/// left out that go through its sides.
fn bonds_file(scene: &Scene, bodies: &[(i32, &BondedBody)], bonds: &[LiveBond]) -> Result<PendingFile, OutputError> {
    let (bonded, all) = (&scene.bonded, &scene.bonded.particles);
    let shown = || bodies.iter().flat_map(|(_, body)| body.range.clone());
    let mut place = vec![0; all.len()];
    (0..).zip(shown()).for_each(|(index, particle)| place[particle] = index);
    let into_box: Vec<Vec3> = shown().map(|i| into_periodic_box(scene, &all.position[i])[0]).collect();
    let points = vectors(shown().zip(&into_box).map(|(i, beyond)| bonded.reference()[i] + beyond));
    let displacement = vectors(shown().map(|i| all.position[i] - bonded.reference()[i]));
    let drawn = |bond: &&LiveBond| {
        let [first, second] = bond.pair.map(|i| all.position[i as usize] + into_box[place[i as usize] as usize]);
        (second - first - bond.gap).norm() < ROUNDING * bond.gap.norm()
    };
    let bonds: Vec<&LiveBond> = bonds.iter().filter(drawn).collect();
    let lines: Vec<[u32; 2]> = bonds.iter().map(|bond| bond.pair.map(|particle| place[particle as usize])).collect();
    // The force on the second particle draws it towards the first in tension.
    let axial = |bond: &&LiveBond| -bond.force.dot(&bond.gap.normalize());
    let force: Vec<f64> = bonds.iter().map(axial).collect();
    let energy: Vec<f64> = bonds.iter().map(|bond| bond.energy).collect();
    let body: Vec<i32> = bonds.iter().map(|bond| bond.body).collect();
    let data = PolyData {
        points: &points,
        cells: PolyCells::Lines(&lines),
        point_data: &[Field::vector("displacement", &displacement)],
        cell_data: &[
            Field::scalar("axial_force", &force),
            Field::scalar("elastic_energy", &energy),
            Field::integer("body", &body),
        ],
        time: Some(scene.clock.time),
    };
    data.pending(Compression::Fast).map_err(OutputError::from)
}
