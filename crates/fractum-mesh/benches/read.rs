//! Reading and writing per node and element, and what is derived from a mesh, on one core unless said otherwise.
//!
//! The mesh is a jittered box of 504,000 tetrahedra and 91,125 nodes; rates count nodes and elements.

use divan::{Bencher, black_box, counter::ItemsCount};
use fractum_mesh::generate::{Jitter, structured_box};
use fractum_mesh::{Mesh, MshFormat, Vec3, quality, read_msh, renumber, topology, write_msh};

fn main() {
    divan::main();
}

fn mesh() -> Mesh {
    structured_box([42, 40, 50], Vec3::new(1.0, 0.95, 1.2), Some(Jitter { fraction: 0.1, seed: 1 }))
}

/// The same mesh with nodes in an order without any locality.
fn scattered() -> Mesh {
    let mesh = mesh();
    let count = mesh.nodes.len() as u64;
    let step = (count / 3..).find(|step| gcd(*step, count) == 1).expect("some step is coprime");
    let renumbering = renumber::Renumbering {
        nodes: (0..count).map(|k| (k * step % count) as u32).collect(),
        triangles: (0..mesh.triangles.len() as u32).collect(),
        tetrahedra: (0..mesh.tetrahedra.len() as u32).collect(),
        ..renumber::Renumbering::default()
    };
    renumbering.apply(&mesh)
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn items(mesh: &Mesh) -> ItemsCount {
    ItemsCount::new(mesh.nodes.len() + mesh.element_count())
}

fn written(mesh: &Mesh, format: MshFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_msh(mesh, format, &mut bytes).expect("writing to memory");
    bytes
}

const FORMATS: [MshFormat; 4] =
    [MshFormat::V4_1Binary, MshFormat::V2_2Binary, MshFormat::V4_1Ascii, MshFormat::V2_2Ascii];

#[divan::bench(args = FORMATS, sample_count = 10)]
fn read(bencher: Bencher, format: MshFormat) {
    let mesh = mesh();
    let bytes = written(&mesh, format);
    bencher.counter(items(&mesh)).bench(|| read_msh(black_box(&bytes)).expect("a valid mesh"));
}

#[divan::bench(args = FORMATS, sample_count = 10)]
fn write(bencher: Bencher, format: MshFormat) {
    let mesh = mesh();
    bencher.counter(items(&mesh)).bench(|| written(black_box(&mesh), format));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn edges_scattered(bencher: Bencher, threads: usize) {
    let (mesh, pool) = (scattered(), pool(threads));
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| pool.install(|| topology::edges_of_tetrahedra(&mesh.tetrahedra)));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn edges_renumbered(bencher: Bencher, threads: usize) {
    let ((mesh, _), pool) = (renumber::renumber_along_hilbert_curve(&mesh()), pool(threads));
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| pool.install(|| topology::edges_of_tetrahedra(&mesh.tetrahedra)));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn boundary(bencher: Bencher, threads: usize) {
    let (mesh, pool) = (mesh(), pool(threads));
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| pool.install(|| topology::boundary_of_tetrahedra(&mesh.tetrahedra)));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn facets(bencher: Bencher, threads: usize) {
    let (mesh, pool) = (mesh(), pool(threads));
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| pool.install(|| topology::facets_of_tetrahedra(&mesh.tetrahedra)));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn hilbert_order(bencher: Bencher, threads: usize) {
    let (mesh, pool) = (mesh(), pool(threads));
    let count = ItemsCount::new(mesh.nodes.len());
    bencher.counter(count).bench(|| pool.install(|| renumber::hilbert_order(&mesh.nodes)));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn renumber_mesh(bencher: Bencher, threads: usize) {
    let (mesh, pool) = (scattered(), pool(threads));
    bencher.counter(items(&mesh)).bench(|| pool.install(|| renumber::renumber_along_hilbert_curve(&mesh)));
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn quality_summary(bencher: Bencher, threads: usize) {
    let (mesh, pool) = (mesh(), pool(threads));
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| pool.install(|| quality::summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra)));
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool")
}
