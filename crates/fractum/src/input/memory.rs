//! What the bodies of a case need of memory, before any of them is made.

use std::f64::consts::PI;

use fractum_case::build::{Replication, replication};
use fractum_case::model::{
    BodyKind, BondedBody, BondedShape, Case, CloudShape, LooseBody, LooseSource, PackingSource, ParticleSize, Region,
    SolidBody,
};
use fractum_math::sphere_volume;
use fractum_mesh::Mesh;
use fractum_output::memory::{self, TooLarge};
use fractum_pack::cloud_cells;
use fractum_prepare::graded_count;

use crate::process::ranks::Processes;

/// Memory of the scene by its parts [bytes], what a run saves and draws left out.
const LOOSE_PARTICLE: f64 = 800.0;
const BONDED_PARTICLE: f64 = 1000.0;
/// Of a tetrahedron or triangle: standard, smoothed; the second of each where it may be damaged. Somewhat less than bodies of 400,000 to 511,000
/// keep while they are stepped.
const ELEMENT: [[f64; 2]; 2] = [[280.0, 550.0], [500.0, 600.0]];
/// Of a tetrahedron that may break, on each of several processes that share a mesh, beside those of which it has the cells.
const KNOWN: f64 = 35.0;
/// Of a node where several processes share a mesh.
const NODE: f64 = 300.0;
/// Part of the memory of solids that several processes share, rather than each having all of it: the cells.
const SHARED: f64 = 0.5;
/// Volume of the particles of a packing over that of its shape.
const FILLED: f64 = 0.6;

/// Makes sure that the bodies of a case fit into memory.
///
/// # Errors
/// [`TooLarge`], with the body that needs most.
pub(crate) fn check_memory(case: &Case, mesh: &Mesh, processes: Processes) -> Result<(), TooLarge> {
    let needs = case.bodies.iter().map(|body| {
        let (count, of, each) = match &body.kind {
            BodyKind::Solid(own) if mesh.whole.is_some() => {
                // This process has what it needs, and every process all nodes, and all elements of what may break.
                let own_each = ELEMENT[usize::from(own.is_smoothed())][usize::from(own.damage)];
                let own_each = match replication(case, own) {
                    Replication::Elements => KNOWN + own_each / processes.all as f64,
                    Replication::Part | Replication::Whole => own_each,
                };
                let nodes = mesh.group_nodes(&own.group.value).len() as f64 * NODE;
                let count =
                    mesh.group(&own.group.value).iter().map(|group| group.tetrahedra.len()).sum::<usize>() as f64;
                (count, "tetrahedra", own_each + nodes / count.max(1.0))
            }
            BodyKind::Solid(own) => {
                let (count, of, each) = solid(own, mesh);
                // In-situ stress is found by every process.
                let shared =
                    if own.needs_all_cells() || case.in_situ.is_some() || case.excavates() { 0.0 } else { SHARED };
                (count, of, each * (1.0 - shared + shared / processes.all as f64))
            }
            BodyKind::Bonded(own) => (bonded(own), "particles", BONDED_PARTICLE),
            BodyKind::Particles(own) => (loose(own, case.materials[own.material].density), "particles", LOOSE_PARTICLE),
            BodyKind::Rigid(_) => (0.0, "facets", 0.0),
        };
        (count * each, &body.name.value, count, of)
    });
    let needs: Vec<_> = needs.collect();
    let total = needs.iter().map(|need| need.0).sum::<f64>() * processes.here as f64;
    let Some((_, name, count, of)) = needs.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(()) };
    memory::require(total as u64, format!("body \"{name}\" of about {count:.2e} {of}"))
}

fn solid(body: &SolidBody, mesh: &Mesh) -> (f64, &'static str, f64) {
    let groups = mesh.group(&body.group.value);
    let tetrahedra: usize = groups.iter().map(|group| group.tetrahedra.len()).sum();
    let triangles: usize = groups.iter().map(|group| group.triangles.len()).sum();
    let (count, of) = if tetrahedra > 0 { (tetrahedra, "tetrahedra") } else { (triangles, "triangles") };
    (count as f64, of, ELEMENT[usize::from(body.is_smoothed())][usize::from(body.damage)])
}

/// Particles of a bonded body; none where only its surface or file tells.
fn bonded(body: &BondedBody) -> f64 {
    let PackingSource::Shape { shape, size, .. } = &body.packing else { return 0.0 };
    let radius = match size.value {
        ParticleSize::Count(count) => return count as f64,
        ParticleSize::Radius(radius) => radius,
    };
    let volume = match &shape.value {
        BondedShape::Box { size, .. } => size.product(),
        BondedShape::Cylinder { length, radius, .. } => PI * radius * radius * length,
        BondedShape::Sphere { radius, .. } => sphere_volume(*radius),
        BondedShape::Group(_) | BondedShape::Stl { .. } => 0.0,
    };
    FILLED * volume / sphere_volume(radius)
}

/// Spheres of a cloud, or of a stream of a density [kg/m³].
fn loose(body: &LooseBody, density: f64) -> f64 {
    let spheres = body.clump.as_ref().map_or(1, |clump| clump.value.shape.spheres().len());
    spheres as f64 * grains(body, density)
}

/// Particles of a cloud, or of a stream of a density [kg/m³].
fn grains(body: &LooseBody, density: f64) -> f64 {
    if let LooseSource::Inlet { stream, .. } = &body.source {
        return stream.count(density);
    }
    if let LooseSource::Graded { shape, grading, amount, .. } = &body.source {
        // Only their surface or file tells the volume of other shapes.
        let volume = if let CloudShape::Region(region) = &shape.value { region.volume() } else { 0.0 };
        return graded_count(volume, grading, amount.value);
    }
    let LooseSource::Cloud { region, radius, dispersion, count, .. } = &body.source else { return 0.0 };
    // Of the cells of the box around the region those within it.
    let (size, share) = match region.value {
        Region::Box { size, .. } => (size, 1.0),
        Region::Cylinder { axis, length, radius, .. } => {
            let size = axis.map(|a| a.abs() * length + 2.0 * radius * (1.0 - a * a).max(0.0).sqrt());
            (size, PI * radius * radius * length / size.product())
        }
        Region::Sphere { radius, .. } => (fractum_math::Vec3::repeat(2.0 * radius), PI / 6.0),
        // One layer of cells.
        Region::Rectangle { size, .. } => (size + fractum_math::Vec3::z() * (4.0 * radius), 1.0),
        Region::Circle { radius: wide, .. } => {
            (fractum_math::Vec3::new(2.0 * wide, 2.0 * wide, 4.0 * radius), PI / 4.0)
        }
    };
    let room = cloud_cells(&size, *radius, *dispersion).product() * share;
    count.as_ref().map_or(room, |count| count.value as f64)
}
