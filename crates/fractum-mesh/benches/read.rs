//! Reading and writing per node and element, and what is derived from a mesh, on the threads given by
//! `RAYON_NUM_THREADS`.
//!
//! The mesh is a jittered box of 504,000 tetrahedra and 91,125 nodes; rates count nodes and elements.

#[path = "../../../tests/calibration.rs"]
mod calibration;

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

#[divan::bench(sample_count = 10)]
fn edges_scattered(bencher: Bencher) {
    let mesh = scattered();
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| topology::edges_of_tetrahedra(&mesh.tetrahedra));
}

#[divan::bench(sample_count = 10)]
fn edges_renumbered(bencher: Bencher) {
    let (mesh, _) = renumber::renumber_along_hilbert_curve(&mesh());
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| topology::edges_of_tetrahedra(&mesh.tetrahedra));
}

#[divan::bench(sample_count = 10)]
fn boundary(bencher: Bencher) {
    let mesh = mesh();
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| topology::boundary_of_tetrahedra(&mesh.tetrahedra));
}

#[divan::bench(sample_count = 10)]
fn facets(bencher: Bencher) {
    let mesh = mesh();
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| topology::facets_of_tetrahedra(&mesh.tetrahedra));
}

#[divan::bench(sample_count = 10)]
fn hilbert_order(bencher: Bencher) {
    let mesh = mesh();
    let count = ItemsCount::new(mesh.nodes.len());
    bencher.counter(count).bench(|| renumber::hilbert_order(&mesh.nodes));
}

#[divan::bench(sample_count = 10)]
fn renumber_mesh(bencher: Bencher) {
    let mesh = scattered();
    bencher.counter(items(&mesh)).bench(|| renumber::renumber_along_hilbert_curve(&mesh));
}

#[divan::bench(sample_count = 10)]
fn quality_summary(bencher: Bencher) {
    let mesh = mesh();
    let count = ItemsCount::new(mesh.tetrahedra.len());
    bencher.counter(count).bench(|| quality::summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra));
}
