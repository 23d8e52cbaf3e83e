//! What is written reads back the same.

use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_mesh::{Mesh, MshFormat, Vec3, quality, read_msh, topology, write_msh};

const FORMATS: [MshFormat; 4] =
    [MshFormat::V2_2Ascii, MshFormat::V2_2Binary, MshFormat::V4_1Ascii, MshFormat::V4_1Binary];

fn written(mesh: &Mesh, format: MshFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_msh(mesh, format, &mut bytes).unwrap();
    bytes
}

#[test]
fn generated_meshes_survive_every_format() {
    let jitter = Some(Jitter { fraction: 0.15, seed: 7 });
    for mesh in
        [structured_box([3, 2, 4], Vec3::new(1.0, 0.7, 1.3), jitter), structured_rectangle([5, 3], [2.0, 1.1], jitter)]
    {
        for format in FORMATS {
            assert_eq!(read_msh(&written(&mesh, format)).unwrap(), mesh, "{format:?}");
        }
    }
}

#[test]
fn a_box_has_its_volume_its_closed_surface_and_its_edges() {
    let size = Vec3::new(1.0, 2.0, 0.5);
    let mesh = structured_box([4, 5, 3], size, Some(Jitter { fraction: 0.16, seed: 1 }));
    let volumes = mesh.tetrahedra.iter().map(|e| quality::signed_volume(e.map(|n| mesh.nodes[n as usize])));
    assert!(volumes.clone().all(|volume| volume > 0.0));
    assert!((volumes.sum::<f64>() - 1.0).abs() < 1e-12);

    let facets = topology::boundary_of_tetrahedra(&mesh.tetrahedra);
    assert_eq!(facets.len(), 4 * (4 * 5 + 5 * 3 + 4 * 3));
    let corners = |facet: &topology::Facet| facet.nodes.map(|node| mesh.nodes[node as usize]);
    // divergence theorem: the flux of x is three times the volume
    let flux: f64 = facets.iter().map(|f| quality::area_vector(corners(f)).dot(&corners(f)[0])).sum();
    assert!((flux - 3.0).abs() < 1e-12);

    // Euler: nodes − edges + facets − elements = 1, and every inner facet has two elements
    let edges = topology::edges_of_tetrahedra(&mesh.tetrahedra);
    let facet_count = (4 * mesh.tetrahedra.len() + facets.len()) / 2;
    assert_eq!(mesh.nodes.len() + facet_count, edges.nodes.len() + mesh.tetrahedra.len() + 1);
    for (element, of_element) in mesh.tetrahedra.iter().zip(&edges.of_element) {
        for (local, edge) in topology::TETRAHEDRON_EDGES.iter().zip(of_element) {
            let mut nodes = local.map(|i| element[i]);
            nodes.sort_unstable();
            assert_eq!(edges.nodes[*edge as usize], nodes);
        }
    }
    assert!(edges.nodes.is_sorted());
}
