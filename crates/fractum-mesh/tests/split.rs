//! Meshes of hexahedra, prisms and pyramids become tetrahedra: nothing is lost, faces fit, groups stay on them, in every format.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use fractum_mesh::{Mesh, Vec3, quality, read_inp, read_mesh, topology};
use proptest::prelude::*;

/// Cells of a box, some as pyramids or prisms, with nodes numbered at random.
#[derive(Debug)]
struct Cells {
    size: Vec3,
    /// Tag and place.
    nodes: Vec<(usize, Vec3)>,
    /// Corners of each, in the order that all formats have.
    cells: Vec<Vec<usize>>,
    /// Quadrilaterals and triangles on the side x = 0.
    left: Vec<Vec<usize>>,
}

/// Numbers that follow from a seed.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// - `warp`: by how much of a cell inner nodes move; `kinds`: what cells become by their column in the xy-plane: 0 hexahedra, 1 pyramids, 2 prisms
fn cells(counts: [usize; 3], kinds: &[u8], warp: f64, mut seed: u64) -> Cells {
    let size = Vec3::new(2.0, 1.0, 0.7);
    let [nx, ny, nz] = counts;
    let centres = nx * ny * nz;
    let total = (nx + 1) * (ny + 1) * (nz + 1) + centres;
    let mut tags: Vec<usize> = (1..=total).map(|tag| 3 * tag).collect();
    for last in (1..total).rev() {
        tags.swap(last, (random(&mut seed) * (last + 1) as f64) as usize);
    }
    let step = Vec3::new(size.x / nx as f64, size.y / ny as f64, size.z / nz as f64);
    let at = |i: usize, j: usize, k: usize| (k * (ny + 1) + j) * (nx + 1) + i;
    let mut places = vec![Vec3::zeros(); total];
    for (k, j, i) in (0..=nz).flat_map(|k| (0..=ny).flat_map(move |j| (0..=nx).map(move |i| (k, j, i)))) {
        // Inner nodes move, so that faces are warped; those of the surface stay on it.
        let mut moved = |at: usize, count: usize, step: f64| {
            let inner = at > 0 && at < count;
            (at as f64 + if inner { warp * (random(&mut seed) - 0.5) } else { 0.0 }) * step
        };
        places[at(i, j, k)] = Vec3::new(moved(i, nx, step.x), moved(j, ny, step.y), moved(k, nz, step.z));
    }
    let (mut cells, mut left) = (Vec::new(), Vec::new());
    for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
        let n = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| at(i + a, j + b, k));
        let m = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| at(i + a, j + b, k + 1));
        let centre = (nx + 1) * (ny + 1) * (nz + 1) + (k * ny + j) * nx + i;
        places[centre] = n.iter().chain(&m).map(|&node| places[node]).sum::<Vec3>() / 8.0;
        if i == 0 {
            left.push(vec![n[0], n[3], m[3], m[0]]);
        }
        match kinds[j * nx + i] {
            1 => {
                let faces = [
                    [n[0], n[1], n[2], n[3]],
                    [m[3], m[2], m[1], m[0]],
                    [n[0], m[0], m[1], n[1]],
                    [n[1], m[1], m[2], n[2]],
                    [n[2], m[2], m[3], n[3]],
                    [n[3], m[3], m[0], n[0]],
                ];
                cells.extend(faces.map(|face| [&face[..], &[centre]].concat()));
            }
            2 => {
                cells.push(vec![n[0], n[1], n[2], m[0], m[1], m[2]]);
                cells.push(vec![n[0], n[2], n[3], m[0], m[2], m[3]]);
            }
            _ => cells.push([n, m].concat()),
        }
    }
    let tagged = |cells: Vec<Vec<usize>>| -> Vec<Vec<usize>> {
        cells.into_iter().map(|cell| cell.into_iter().map(|node| tags[node]).collect()).collect()
    };
    let nodes = tags.iter().copied().zip(places).collect();
    Cells { size, nodes, cells: tagged(cells), left: tagged(left) }
}

fn words(numbers: &[usize], between: &str) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(between)
}

impl Cells {
    fn msh(&self) -> String {
        let mut text = String::from(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"left\"\n3 2 \"part\"\n$EndPhysicalNames\n$Nodes\n",
        );
        let _ = writeln!(text, "{}", self.nodes.len());
        self.nodes.iter().for_each(|(tag, x)| writeln!(text, "{tag} {:?} {:?} {:?}", x.x, x.y, x.z).unwrap());
        let _ = writeln!(text, "$EndNodes\n$Elements\n{}", self.cells.len() + self.left.len());
        for (tag, cell) in (1..).zip(self.left.iter().chain(&self.cells)) {
            let (code, group) = BTreeMap::from([(4, (3, 1)), (5, (7, 2)), (6, (6, 2)), (8, (5, 2))])[&cell.len()];
            let _ = writeln!(text, "{tag} {code} 2 {group} 1 {}", words(cell, " "));
        }
        text + "$EndElements\n"
    }

    /// With a surface by the faces of the elements, and a set of the nodes on it.
    ///
    /// - `labels`: what those of elements have above their numbers
    fn inp(&self, part: &str, labels: usize) -> String {
        let mut text = String::from("*NODE\n");
        self.nodes.iter().for_each(|(tag, x)| writeln!(text, "{tag}, {:?}, {:?}, {:?}", x.x, x.y, x.z).unwrap());
        let mut surface = format!("*SURFACE, NAME={}\n", if labels > 0 { "other" } else { "left" });
        for (tag, cell) in (labels + 1..).zip(&self.cells) {
            let (name, faces): (&str, &[&[usize]]) = match cell.len() {
                5 => ("C3D5", &[&[0, 1, 2, 3], &[0, 4, 1], &[1, 4, 2], &[2, 4, 3], &[3, 4, 0]]),
                6 => ("C3D6", &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]]),
                _ => (
                    "C3D8R",
                    &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]],
                ),
            };
            let _ = writeln!(text, "*ELEMENT, TYPE={name}, ELSET={part}\n{tag}, {}", words(cell, ", "));
            let sets: Vec<BTreeSet<&usize>> = self.left.iter().map(|face| face.iter().collect()).collect();
            for (number, face) in (1..).zip(faces) {
                let nodes: BTreeSet<&usize> = face.iter().map(|&corner| &cell[corner]).collect();
                if nodes.len() == 4 && sets.contains(&nodes) {
                    let _ = writeln!(surface, "{tag}, S{number}");
                }
            }
        }
        text + &surface
    }

    fn vtu(&self) -> String {
        let index: BTreeMap<usize, usize> = self.nodes.iter().zip(0..).map(|((tag, _), index)| (*tag, index)).collect();
        let all = || self.left.iter().chain(&self.cells);
        let join = |numbers: Vec<usize>| words(&numbers, " ");
        let points: String = self.nodes.iter().map(|(_, x)| format!("{:?} {:?} {:?} ", x.x, x.y, x.z)).collect();
        let connectivity = join(all().flatten().map(|tag| index[tag]).collect());
        let mut end = 0;
        let offsets = join(
            all()
                .map(|cell| {
                    end += cell.len();
                    end
                })
                .collect(),
        );
        let types = join(all().map(|cell| BTreeMap::from([(4, 9), (5, 14), (6, 13), (8, 12)])[&cell.len()]).collect());
        let part = join(all().map(|cell| usize::from(cell.len() > 4)).collect());
        let left = join(all().map(|cell| usize::from(cell.len() == 4)).collect());
        let array = |kind: &str, name: &str, more: &str, data: &str| {
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" {more} format=\"ascii\">{data}</DataArray>\n")
        };
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" \
             NumberOfCells=\"{}\">\n<Points>\n{}</Points>\n<Cells>\n{}{}{}</Cells>\n<CellData>\n{}{}</CellData>\n</Piece>\n\
             </UnstructuredGrid>\n</VTKFile>\n",
            self.nodes.len(),
            all().count(),
            array("Float64", "Points", "NumberOfComponents=\"3\"", &points),
            array("Int64", "connectivity", "", &connectivity),
            array("Int64", "offsets", "", &offsets),
            array("UInt8", "types", "", &types),
            array("UInt8", "part", "", &part),
            array("UInt8", "left", "", &left)
        )
    }
}

/// Triangles of a group, each by the places of its corners.
fn places(mesh: &Mesh, group: &str) -> BTreeSet<Vec<[u64; 3]>> {
    let triangles = mesh.group(group)[0].triangles.iter();
    let corner = |node: u32| mesh.nodes[node as usize].data.0[0].map(f64::to_bits);
    let sorted = |&triangle: &u32| {
        let mut corners = mesh.triangles[triangle as usize].map(corner).to_vec();
        corners.sort_unstable();
        corners
    };
    triangles.map(sorted).collect()
}

fn volumes(mesh: &Mesh) -> impl Iterator<Item = f64> {
    mesh.tetrahedra.iter().map(|e| quality::signed_volume(e.map(|n| mesh.nodes[n as usize])))
}

fn check(mesh: &Mesh, cells: &Cells) {
    assert!(volumes(mesh).all(|volume| volume > 0.0));
    let (total, size) = (volumes(mesh).sum::<f64>(), cells.size.x * cells.size.y * cells.size.z);
    assert!((total - size).abs() < 1e-12 * size, "volume {total} of {size}");
    // Faces fit: the surface is that of the box, of facets that two elements do not share.
    let facets = topology::boundary_of_tetrahedra(&mesh.tetrahedra);
    let area = |nodes: [u32; 3]| quality::area_vector(nodes.map(|n| mesh.nodes[n as usize])).norm();
    let surface: f64 = facets.iter().map(|facet| area(facet.nodes)).sum();
    let whole = 2.0 * (cells.size.x * cells.size.y + cells.size.y * cells.size.z + cells.size.z * cells.size.x);
    assert!((surface - whole).abs() < 1e-12 * whole, "surface {surface} of {whole}");
    // The group is of facets of elements, two for each face, and covers the side.
    let sorted = |mut nodes: [u32; 3]| {
        nodes.sort_unstable();
        nodes
    };
    let of_elements: BTreeSet<[u32; 3]> = facets.iter().map(|facet| sorted(facet.nodes)).collect();
    let left = &mesh.group("left")[0].triangles;
    assert_eq!(left.len(), 2 * cells.left.len());
    assert!(left.iter().all(|&triangle| of_elements.contains(&sorted(mesh.triangles[triangle as usize]))));
    let side: f64 = left.iter().map(|&triangle| area(mesh.triangles[triangle as usize])).sum();
    assert!((side - cells.size.y * cells.size.z).abs() < 1e-12, "{side}");
    assert_eq!(mesh.group("part")[0].tetrahedra.len(), mesh.tetrahedra.len());
    assert!(mesh.notices.iter().any(|notice| notice.contains("split into")), "{:?}", mesh.notices);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_is_lost_and_faces_fit_in_every_format(
        counts in prop::array::uniform3(1usize..4), kinds in prop::collection::vec(0u8..3, 9), seed in any::<u64>()
    ) {
        let cells = cells(counts, &kinds, 0.25, seed);
        let meshes = [cells.msh(), cells.inp("part", 0), cells.vtu()].map(|text| read_mesh(text.as_bytes()).unwrap());
        for mesh in &meshes {
            check(mesh, &cells);
        }
        // The least tag decides, so that Gmsh and Abaqus files give the same elements; a grid of VTK counts anew.
        prop_assert_eq!(places(&meshes[0], "left"), places(&meshes[1], "left"));
        prop_assert_eq!(volumes(&meshes[0]).count(), volumes(&meshes[1]).count());
    }
}

#[test]
fn bodies_with_nodes_of_their_own_have_the_same_diagonals() {
    // The second box lies on the side x = 2 of the first, with other numbers.
    for seed in 0..10 {
        let (first, second) = (cells([2, 3, 3], &[0; 9], 0.0, seed), cells([1, 3, 3], &[0; 9], 0.0, seed + 100));
        let shift = 3 * first.nodes.len();
        let tags = |cells: Vec<Vec<usize>>| -> Vec<Vec<usize>> {
            cells.into_iter().map(|cell| cell.into_iter().map(|tag| tag + shift).collect()).collect()
        };
        let second = Cells {
            nodes: second.nodes.iter().map(|(tag, x)| (tag + shift, x + Vec3::new(2.0, 0.0, 0.0))).collect(),
            cells: tags(second.cells),
            left: tags(second.left),
            ..second
        };
        let texts =
            [(&first, "first", 0), (&second, "second", 1000)].map(|(cells, name, labels)| cells.inp(name, labels));
        let mesh = read_inp(texts.concat().as_bytes()).unwrap();
        let (_, joints) = fractum_mesh::joined_bodies(&mesh, &["first", "second"]);
        assert_eq!((joints.len(), joints[0].faces, joints[0].nodes, joints[0].apart), (1, 18, 16, None), "{seed}");
    }
}

#[test]
fn elements_of_second_order_leave_their_mid_nodes() {
    let nodes: String = (0..20)
        .map(|node| {
            let corner = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]];
            let edges =
                [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
            let [x, y, z] = if node < 8 {
                corner[node]
            } else {
                let [a, b] = edges[node - 8];
                [0, 1, 2].map(|axis| (corner[a][axis] + corner[b][axis]) / 2)
            };
            format!("{}, {x}, {y}, {z}\n", node + 1)
        })
        .collect();
    let all: Vec<usize> = (1..=20).collect();
    let text = format!(
        "*NODE\n{nodes}*ELEMENT, TYPE=C3D20R, ELSET=part\n1, {},\n{}\n*NSET, NSET=base\n1, 2, 3, 4, 9, 10, 11, 12\n*SURFACE, NAME=top\n1, S2\n",
        words(&all[..15], ", "),
        words(&all[15..], ", ")
    );
    let mesh = read_inp(text.as_bytes()).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.tetrahedra.len(), mesh.group_nodes("base").len()), (8, 6, 4));
    assert!((volumes(&mesh).sum::<f64>() - 8.0).abs() < 1e-12);
    assert_eq!(mesh.group("top")[0].triangles.len(), 2);
    for said in [
        "1 hexahedron of higher order read with corners only",
        "4 mid node(s) left out of sets",
        "12 node(s) that no element uses",
    ] {
        assert!(mesh.notices.iter().any(|notice| notice.contains(said)), "{said}: {:?}", mesh.notices);
    }
}

#[test]
fn plane_quadrilaterals_become_triangles_and_folded_ones_are_refused() {
    let text = |third: &str| {
        format!(
            "*NODE\n1, 0, 0\n2, 1, 0\n3, {third}\n4, 0, 1\n*ELEMENT, TYPE=CPS4, ELSET=plate\n7, 4, 3, 2, 1\n*SURFACE, NAME=top\n7, S1\n"
        )
    };
    let mesh = read_inp(text("1, 1").as_bytes()).unwrap();
    assert_eq!(
        (mesh.triangles.len(), mesh.group("plate")[0].triangles.len(), mesh.group("top")[0].lines.len()),
        (2, 2, 1)
    );
    // Both have the diagonal from the least node.
    assert!(mesh.triangles.iter().all(|triangle| triangle.contains(&0) && triangle.contains(&2)));
    let error = read_inp(text("0.2, 0.2").as_bytes());
    assert!(
        error.is_ok(),
        "a corner that points inwards is no harm where the diagonal starts there or at the opposite one"
    );
    let text = text("1, 1").replace("2, 1, 0\n", "2, 0.4, 0.6\n");
    let error = read_inp(text.as_bytes()).unwrap_err().to_string();
    assert!(
        error.starts_with("line 7: quadrilateral 7 (nodes [4, 3, 2, 1])")
            && error.ends_with("mesh again, or with triangles"),
        "{error}"
    );
}

/// Hexahedra that were turned around an axis, on which each has nodes of its own: prisms that share the axis.
#[test]
fn corners_in_one_place_are_one_node() {
    let [sectors, layers] = [5, 2];
    let (angle, height) = (0.3f64, 0.7);
    let (mut nodes, mut elements) = (String::from("*NODE\n"), String::from("*ELEMENT, TYPE=C3D8, ELSET=part\n"));
    let label = |layer: usize, ray: usize, is_rim: bool| 1 + 2 * (layer * (sectors + 1) + ray) + usize::from(is_rim);
    for (layer, ray) in (0..=layers).flat_map(|layer| (0..=sectors).map(move |ray| (layer, ray))) {
        let (sine, cosine) = (angle * ray as f64).sin_cos();
        let z = height * layer as f64;
        nodes +=
            &format!("{}, 0, 0, {z}\n{}, {cosine}, {sine}, {z}\n", label(layer, ray, false), label(layer, ray, true));
    }
    for (layer, ray) in (0..layers).flat_map(|layer| (0..sectors).map(move |ray| (layer, ray))) {
        let ring =
            |layer| [(ray, false), (ray, true), (ray + 1, true), (ray + 1, false)].map(|(r, rim)| label(layer, r, rim));
        let corners = words(&[ring(layer), ring(layer + 1)].concat(), ", ");
        elements += &format!("{}, {corners}\n", 1 + layer * sectors + ray);
    }
    let mesh = read_inp((nodes + &elements).as_bytes()).unwrap();
    let floor = 0.5 * sectors as f64 * angle.sin();
    let total = height * layers as f64;
    assert!((volumes(&mesh).sum::<f64>() - floor * total).abs() < 1e-12);
    let area = |nodes: [u32; 3]| quality::area_vector(nodes.map(|n| mesh.nodes[n as usize])).norm();
    let surface: f64 = topology::boundary_of_tetrahedra(&mesh.tetrahedra).iter().map(|facet| area(facet.nodes)).sum();
    let walls = total * (2.0 + 2.0 * sectors as f64 * (0.5 * angle).sin());
    assert!((surface - 2.0 * floor - walls).abs() < 1e-12, "{surface}");
    let joined = sectors * (layers + 1);
    assert!(mesh.notices.iter().any(|notice| notice.starts_with(&format!("{joined} corners"))), "{:?}", mesh.notices);
}
