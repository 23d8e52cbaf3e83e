//! Refinement: elements that conform, as small as asked for, no worse than half as good, and all groups as they were.

use fractum_mesh::generate::{Jitter, mirrored_cells, structured_box, structured_rectangle};
use fractum_mesh::quality::{area_vector, signed_volume};
use fractum_mesh::topology::{
    boundary_of_tetrahedra, boundary_of_triangles, edges_of_tetrahedra, edges_of_triangles, facets_of_tetrahedra,
    sides_of_triangles,
};
use fractum_mesh::{Mesh, RefineError, RefineOptions, Refined, Vec3, longest_edge, refined};
use proptest::prelude::*;

const INFINITY: f64 = f64::INFINITY;

fn refine(mesh: &Mesh, size: &(dyn Fn(Vec3) -> f64 + Sync), seed: Option<u64>) -> Refined {
    let seed = move |_: Vec3| seed;
    let made = refined(mesh, size, RefineOptions { seed: &seed, ..RefineOptions::default() });
    let made = made.unwrap_or_else(|error| panic!("{error}"));
    check(mesh, &made.mesh);
    made
}

fn at<const N: usize>(mesh: &Mesh, element: [u32; N]) -> [Vec3; N] {
    element.map(|node| mesh.nodes[node as usize])
}

/// Length, area and volume of a group.
fn extent(mesh: &Mesh, group: &fractum_mesh::Group) -> [f64; 3] {
    let line = |&line: &u32| {
        let [a, b] = at(mesh, mesh.lines[line as usize]);
        (b - a).norm()
    };
    let triangle = |&index: &u32| area_vector(at(mesh, mesh.triangles[index as usize])).norm();
    let tetrahedron = |&index: &u32| signed_volume(at(mesh, mesh.tetrahedra[index as usize]));
    [
        group.lines.iter().map(line).sum(),
        group.triangles.iter().map(triangle).sum(),
        group.tetrahedra.iter().map(tetrahedron).sum(),
    ]
}

/// What every refined mesh is: conforming, turned as before, with groups of the same extent in the same places.
fn check(whole: &Mesh, fine: &Mesh) {
    for (before, after) in whole.groups.iter().zip(&fine.groups) {
        assert_eq!((&before.name, before.tag, before.dimension), (&after.name, after.tag, after.dimension));
        let (known, found) = (extent(whole, before), extent(fine, after));
        assert!(known.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-12), "{} {known:?} {found:?}", before.name);
        assert!(after.lines.is_sorted() && after.triangles.is_sorted() && after.tetrahedra.is_sorted());
        assert_eq!(before.points, after.points);
    }
    if whole.tetrahedra.is_empty() {
        let area = |mesh: &Mesh| mesh.triangles.iter().map(|&t| area_vector(at(mesh, t)).z).sum::<f64>();
        assert!(fine.triangles.iter().all(|&t| area_vector(at(fine, t)).z > 0.0));
        assert!((area(whole) - area(fine)).abs() < 1e-12);
        sides_of_triangles(&fine.triangles).expect("two at a side");
        let length = |mesh: &Mesh| {
            let sides = boundary_of_triangles(&mesh.triangles);
            sides.iter().map(|side| at(mesh, side.nodes)).map(|[a, b]| (b - a).norm()).sum::<f64>()
        };
        assert!((length(whole) - length(fine)).abs() < 1e-12, "hanging nodes");
    } else {
        assert!(fine.tetrahedra.iter().all(|&t| signed_volume(at(fine, t)) > 0.0));
        facets_of_tetrahedra(&fine.tetrahedra).expect("two at a facet");
        let surface = |mesh: &Mesh| {
            let facets = boundary_of_tetrahedra(&mesh.tetrahedra);
            facets.iter().map(|facet| area_vector(at(mesh, facet.nodes)).norm()).sum::<f64>()
        };
        assert!((surface(whole) - surface(fine)).abs() < 1e-12, "hanging nodes");
        let key = |mut nodes: [u32; 3]| {
            nodes.sort_unstable();
            nodes
        };
        let mut facets: Vec<[u32; 3]> =
            boundary_of_tetrahedra(&fine.tetrahedra).into_iter().map(|facet| key(facet.nodes)).collect();
        facets.sort_unstable();
        assert!(fine.triangles.iter().all(|&t| facets.binary_search(&key(t)).is_ok()), "sides are those of elements");
    }
    assert_eq!(fine.node_tags.len(), fine.nodes.len());
}

fn ball(centre: [f64; 3], radius: f64, size: f64) -> impl Fn(Vec3) -> f64 + Sync {
    move |at| if (at - Vec3::from(centre)).norm() < radius { size } else { INFINITY }
}

fn degrees(made: &Refined) -> [f64; 2] {
    made.quality.map(|quality| quality.smallest_angle.value.to_degrees())
}

/// Rows of equilateral triangles.
fn equilateral(cells: u32) -> Mesh {
    let mut mesh = structured_rectangle([cells, cells], [1.0, 1.0], None);
    for node in &mut mesh.nodes {
        *node = Vec3::new(node.x - 0.5 * node.y, 0.75f64.sqrt() * node.y, 0.0);
    }
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn triangles_keep_half_of_their_smallest_angle(
        cells in (2u32..9, 2u32..9), fraction in 0.0..0.16, seed in 0u64..1000, x in 0.0..1.0, y in 0.0..1.0, levels in 1i32..6,
    ) {
        let mesh = structured_rectangle([cells.0, cells.1], [1.0, 1.0], Some(Jitter { fraction, seed }));
        let size = 0.5 * 0.5f64.powi(levels);
        let asked = ball([x, y, 0.0], 0.3, size);
        let made = refine(&mesh, &asked, None);
        let [before, after] = degrees(&made);
        prop_assert!(after >= 0.5 * before - 1e-9, "{before} {after}");
        prop_assert!(longest_edge(&made.mesh, &|at| asked(at) < INFINITY).unwrap() <= size * (1.0 + 1e-9));
        let broken = refine(&mesh, &asked, Some(seed));
        prop_assert!(degrees(&broken)[1] >= after.min(22.0) - 1e-9);
    }

    #[test]
    fn tetrahedra_keep_half_of_their_smallest_angle(
        cells in (2u32..5, 2u32..5, 2u32..5), fraction in 0.0..0.16, seed in 0u64..1000, x in 0.0..1.0, levels in 1i32..4,
    ) {
        let mesh = structured_box([cells.0, cells.1, cells.2], Vec3::new(1.0, 1.0, 1.0), Some(Jitter { fraction, seed }));
        let size = 0.5 * 0.5f64.powi(levels);
        let asked = ball([x, 0.4, 0.6], 0.25, size);
        let made = refine(&mesh, &asked, None);
        let [before, after] = degrees(&made);
        prop_assert!(after >= 0.5 * before, "{before} {after}");
        prop_assert!(longest_edge(&made.mesh, &|at| asked(at) < INFINITY).unwrap() <= size * (1.0 + 1e-9));
        let broken = refine(&mesh, &asked, Some(seed));
        prop_assert!(degrees(&broken)[1] >= after.min(20.0) - 1e-9);
    }
}

#[test]
fn cells_of_boxes_come_back_smaller() {
    // Three cuts make eight of a tetrahedron of a cube, each of its own shape (Maubach, SIAM J. Sci. Comput. 16 (1995)).
    let size = Vec3::new(1.0, 1.0, 1.0);
    for mesh in [structured_box([2, 2, 2], size, None), mirrored_cells([2, 2, 2], size, |_| true)] {
        let made = refine(&mesh, &|_| 0.5 * 0.75f64.sqrt() + 1e-6, None);
        assert_eq!(made.elements, [48, 8 * 48]);
        let [before, after] = made.quality;
        assert!((before.worst_radius_ratio.value - after.worst_radius_ratio.value).abs() < 1e-12);
        assert!(
            (made.longest[0] - 0.75f64.sqrt()).abs() < 1e-12 && (made.longest[1] - 0.5 * 0.75f64.sqrt()).abs() < 1e-12
        );
    }
}

#[test]
fn rows_are_broken_and_kept_on_request() {
    let mesh = equilateral(12);
    let asked = ball([0.25, 0.4, 0.0], 0.25, 0.04);
    let kept = refine(&mesh, &asked, None);
    let broken = refine(&mesh, &asked, Some(1));
    assert_eq!((kept.moved, kept.elements), (0, broken.elements));
    assert!(broken.moved > 100 && kept.mesh.nodes[..169] == mesh.nodes[..]);
    // Edges within 3 degrees of the rows, where both ends are in the zone.
    let rows = |mesh: &Mesh| {
        let edges = edges_of_triangles(&mesh.triangles).nodes;
        let within =
            edges.iter().map(|&edge| at(mesh, edge)).filter(|ends| ends.iter().all(|at| asked(*at) < INFINITY));
        let directions: Vec<Vec3> = within.map(|[a, b]| (b - a).normalize()).collect();
        let along = |d: &&Vec3| {
            (0..6).any(|k| {
                let angle = std::f64::consts::FRAC_PI_6 * f64::from(k);
                d.dot(&Vec3::new(angle.cos(), angle.sin(), 0.0)).abs() > 3f64.to_radians().cos()
            })
        };
        directions.iter().filter(along).count() as f64 / directions.len() as f64
    };
    assert!(rows(&kept.mesh) > 0.99 && rows(&broken.mesh) < 0.4, "{} {}", rows(&kept.mesh), rows(&broken.mesh));
    assert_ne!(broken.mesh, refine(&mesh, &asked, Some(2)).mesh);
    // A power of two changes no bit, and neither do other threads.
    let mut large = mesh.clone();
    large.nodes.iter_mut().for_each(|node| *node *= 1024.0);
    let of_large = refined(
        &large,
        &|at| 1024.0 * asked(at / 1024.0),
        RefineOptions { seed: &|_| Some(1), ..RefineOptions::default() },
    );
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let of_threads = pool.install(|| refine(&mesh, &asked, Some(1)));
    assert_eq!(of_threads.mesh, broken.mesh);
    assert!(of_large.unwrap().mesh.nodes.iter().zip(&broken.mesh.nodes).all(|(a, b)| *a == *b * 1024.0));
}

/// Two blocks beside each other with nodes of their own, all sides and bodies as groups of both.
fn doubled() -> Mesh {
    let block = structured_box([3, 3, 3], Vec3::new(1.0, 1.0, 1.0), Some(Jitter { fraction: 0.15, seed: 5 }));
    let mut both = block.clone();
    let [nodes, triangles, tetrahedra] =
        [block.nodes.len(), block.triangles.len(), block.tetrahedra.len()].map(|count| count as u32);
    // The mirror image, so that faces conform, a little off as files are.
    both.nodes.extend(block.nodes.iter().map(|at| Vec3::new(2.0 - at.x + 1e-7, at.y, at.z - 1e-7)));
    both.triangles.extend(block.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|node| node + nodes)));
    both.tetrahedra.extend(block.tetrahedra.iter().map(|&[a, b, c, d]| [a, c, b, d].map(|node| node + nodes)));
    both.groups.extend(block.groups.iter().map(|group| fractum_mesh::Group {
        name: format!("mirror {}", group.name),
        tag: group.tag + 10,
        triangles: group.triangles.iter().map(|index| index + triangles).collect(),
        tetrahedra: group.tetrahedra.iter().map(|index| index + tetrahedra).collect(),
        ..group.clone()
    }));
    both.number();
    both
}

#[test]
fn both_sides_of_a_doubled_face_are_cut_alike() {
    let mesh = doubled();
    for seed in [None, Some(3)] {
        // Asked for on one side alone.
        let made = refine(&mesh, &|at| if at.x < 0.999 && at.y < 0.4 { 0.1 } else { INFINITY }, seed);
        let places = |group: &str| {
            let nodes = made.mesh.group_nodes(group);
            let mut places: Vec<[i64; 2]> = nodes
                .iter()
                .map(|&node| made.mesh.nodes[node as usize])
                .map(|at| [at.y, at.z].map(|x| (x * 1e5).round() as i64))
                .collect();
            places.sort_unstable();
            places
        };
        let (one, other) = (places("x+"), places("mirror x+"));
        assert!(one.len() > 60 && one == other, "{} {}", one.len(), other.len());
        let shared = made.mesh.group_nodes("x+").iter().any(|node| made.mesh.group_nodes("mirror x+").contains(node));
        assert!(!shared, "each body keeps nodes of its own");
    }
}

#[test]
fn a_narrow_zone_is_found_between_nodes() {
    let mesh = structured_rectangle([4, 4], [1.0, 1.0], None);
    let band = |at: Vec3| if (at.y - 0.41).abs() < 0.02 { 0.02 } else { INFINITY };
    let made = refine(&mesh, &band, None);
    assert!(made.longest[0] > 0.25 && made.longest[1] <= 0.02 * (1.0 + 1e-9), "{:?}", made.longest);
    // All along the band, and coarse again beside it.
    let edges = edges_of_triangles(&made.mesh.triangles).nodes;
    let in_band =
        edges.iter().map(|&edge| at(&made.mesh, edge)).filter(|ends| ends.iter().all(|at| band(*at) < INFINITY));
    let count = in_band.count();
    assert!(count > 300, "{count}");
    assert!(made.elements[1] < 20_000, "{:?}", made.elements);
}

#[test]
fn what_is_fine_already_stays_as_it_is() {
    let mesh = structured_box([3, 3, 3], Vec3::new(1.0, 1.0, 1.0), None);
    let made = refine(&mesh, &|_| 1.0, None);
    assert_eq!(made.mesh, mesh);
    assert_eq!(
        edges_of_tetrahedra(&made.mesh.tetrahedra).nodes.len(),
        edges_of_tetrahedra(&mesh.tetrahedra).nodes.len()
    );
}

#[test]
fn what_cannot_be_refined_is_refused() {
    let mesh = structured_rectangle([4, 4], [1.0, 1.0], None);
    let error = |mesh: &Mesh, size: &(dyn Fn(Vec3) -> f64 + Sync), most: usize| {
        refined(mesh, size, RefineOptions { most, ..RefineOptions::default() }).unwrap_err()
    };
    assert_eq!(error(&Mesh::default(), &|_| 1.0, 100), RefineError::Empty);
    assert_eq!(error(&mesh, &|_| 0.0, 100), RefineError::Size(0.0));
    assert!(matches!(error(&mesh, &|_| f64::NAN, 100), RefineError::Size(_)));
    assert_eq!(error(&mesh, &ball([5.0; 3], 0.1, 0.1), 100), RefineError::Nowhere);
    // Before they are made, and while they are.
    assert_eq!(error(&mesh, &|_| 1e-6, 1_000_000), RefineError::TooMany(1_000_000));
    assert_eq!(error(&mesh, &|_| 0.1, 200), RefineError::TooMany(200));
}
