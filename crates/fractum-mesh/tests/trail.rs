//! Lines of cracks: the ridge of damage, and meshes whose edges follow it.

use fractum_mesh::generate::structured_rectangle;
use fractum_mesh::topology::sides_of_triangles;
use fractum_mesh::{Mesh, RefineOptions, RidgeError, Spot, Vec3, refined, ridge};

/// A plate of 2 x 1 with elements of about 0.04 in no rows.
fn plate() -> Mesh {
    let mesh = structured_rectangle([40, 20], [2.0, 1.0], None);
    let options = RefineOptions { seed: &|_| Some(3), ..RefineOptions::default() };
    refined(&mesh, &|_| 0.06, options).unwrap().mesh
}

fn corners(mesh: &Mesh, triangle: &[u32; 3]) -> [[f64; 2]; 3] {
    triangle.map(|node| [mesh.nodes[node as usize].x, mesh.nodes[node as usize].y])
}

fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
}

/// Elements around a curve y(x) that is damaged up to an x.
fn damaged(mesh: &Mesh, curve: &dyn Fn(f64) -> f64, to: f64) -> Vec<Spot> {
    let spot = |triangle: &[u32; 3]| {
        let corners = corners(mesh, triangle);
        let at = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
        let size = (area(corners) * 4.0 / 3f64.sqrt()).sqrt();
        let off = (at[1] - curve(at[0])).abs() / size;
        (at[0] < to && off < 1.0).then_some(Spot { at, size, damage: 1.0 - 0.6 * off })
    };
    mesh.triangles.iter().filter_map(spot).collect()
}

#[test]
fn the_ridge_of_damage_is_the_curve_of_the_crack_and_goes_straight_ahead() {
    let mesh = plate();
    let curves: [&dyn Fn(f64) -> f64; 3] =
        [&|_| 0.5, &|x| 0.4 + 0.15 * x, &|x| 0.4 + (1.0 - (x - 1.0) * (x - 1.0)).sqrt() * 0.2];
    for (number, curve) in curves.into_iter().enumerate() {
        let found = ridge(&mesh, &damaged(&mesh, curve, 1.2)).unwrap();
        let (first, last) = (found.line[0], found.line[found.line.len() - 1]);
        assert!(first[0].abs() < 1e-12 && (last[0] - 2.0).abs() < 1e-12, "{number}: {first:?} to {last:?}");
        assert!((found.seen - 1.2).abs() < 0.15, "{number}: {}", found.seen);
        for at in found.line.iter().filter(|at| at[0] > 0.1 && at[0] < 1.1) {
            assert!((at[1] - curve(at[0])).abs() < 0.5 * found.size, "{number}: {at:?}, {}", curve(at[0]));
        }
    }
    let found = ridge(&mesh, &damaged(&mesh, curves[1], 1.2)).unwrap();
    let end = found.line[found.line.len() - 1];
    assert!((end[1] - 0.7).abs() < 2.0 * found.size, "{end:?}");
    // A crack that has come to the far side ends there, and may begin at either side.
    let whole = ridge(&mesh, &damaged(&mesh, curves[1], 2.1)).unwrap();
    let mut ends = [whole.line[0], whole.line[whole.line.len() - 1]];
    ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (end, exact) in ends.into_iter().zip([[0.0, 0.4], [2.0, 0.7]]) {
        assert!((end[0] - exact[0]).abs() < 1e-12 && (end[1] - exact[1]).abs() < 0.5 * whole.size, "{end:?}");
    }
}

#[test]
fn a_crack_from_a_notch_begins_at_its_root() {
    // A slit up to x = 0.5, whose sides are two rows of nodes.
    let mut mesh = structured_rectangle([40, 20], [2.0, 1.0], None);
    let twins: Vec<u32> = (0..mesh.nodes.len() as u32)
        .filter(|&node| {
            let at = mesh.nodes[node as usize];
            (at.y - 0.5).abs() < 1e-9 && at.x < 0.49
        })
        .collect();
    let first = mesh.nodes.len() as u32;
    for &twin in &twins {
        mesh.nodes.push(mesh.nodes[twin as usize]);
    }
    for triangle in 0..mesh.triangles.len() {
        let corners = corners(&mesh, &mesh.triangles[triangle]);
        if corners.iter().map(|corner| corner[1]).sum::<f64>() < 1.5 {
            mesh.triangles[triangle] = mesh.triangles[triangle]
                .map(|node| twins.iter().position(|&twin| twin == node).map_or(node, |at| first + at as u32));
        }
    }
    mesh.number();
    let spots: Vec<Spot> =
        damaged(&mesh, &|x| 0.5 + 0.1 * (x - 0.5), 1.4).into_iter().filter(|s| s.at[0] > 0.42).collect();
    let found = ridge(&mesh, &spots).unwrap();
    assert_eq!(found.line[0], [0.5, 0.5]);
    assert!((found.line[found.line.len() - 1][1] - 0.65).abs() < 0.08, "{:?}", found.line);
}

#[test]
fn edges_follow_a_line_and_every_triangle_stays_a_triangle() {
    let line = [[0.0, 0.37], [0.7, 0.45], [1.3, 0.66], [2.0, 0.61]];
    let mut mesh = plate();
    let (triangles, nodes) = (mesh.triangles.clone(), mesh.nodes.len());
    let whole: f64 = triangles.iter().map(|own| area(corners(&mesh, own))).sum();
    let count = mesh.follow(&line, "crack").unwrap();
    assert_eq!((mesh.triangles.len(), mesh.nodes.len()), (triangles.len(), nodes));
    let group = mesh.group("crack")[0].clone();
    assert_eq!(group.lines.len(), count);
    let at = |node: u32| mesh.nodes[node as usize];
    let off = |p: Vec3| {
        let on = |pair: &[[f64; 2]]| {
            let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            let share = (((p.x - pair[0][0]) * dx + (p.y - pair[0][1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
            (p.x - pair[0][0] - share * dx).hypot(p.y - pair[0][1] - share * dy)
        };
        line.windows(2).map(on).fold(f64::INFINITY, f64::min)
    };
    let mut long = 0.0;
    for &own in &group.lines {
        let [a, b] = mesh.lines[own as usize].map(at);
        assert!(off(a) < 1e-12 && off(b) < 1e-12, "{a} {b}");
        long += (b - a).norm();
    }
    // Corners of the line are cut by less than an element.
    let exact: f64 = line.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
    assert!((long - exact).abs() < 0.002, "{long} {exact}");
    let areas: Vec<f64> = mesh.triangles.iter().map(|own| area(corners(&mesh, own))).collect();
    let smallest = areas.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(smallest > 1e-4 && (areas.iter().sum::<f64>() - whole).abs() < 1e-12, "{smallest}");
    // The lines are inside.
    let sides = sides_of_triangles(&mesh.triangles).unwrap();
    for &own in &group.lines {
        let [a, b] = mesh.lines[own as usize];
        let side = sides.nodes.binary_search(&[a.min(b), a.max(b)]).unwrap();
        assert!(sides.elements[side].iter().all(|&element| element != u32::MAX));
    }
}

#[test]
fn what_is_no_single_crack_has_no_line() {
    let mesh = plate();
    assert_eq!(ridge(&mesh, &[]), Err(RidgeError::Nothing));
    let two = [damaged(&mesh, &|_| 0.25, 0.8), damaged(&mesh, &|_| 0.75, 0.8)].concat();
    assert_eq!(ridge(&mesh, &two), Err(RidgeError::Several(2)));
    let inside: Vec<Spot> = damaged(&mesh, &|_| 0.5, 1.5).into_iter().filter(|spot| spot.at[0] > 0.5).collect();
    assert_eq!(ridge(&mesh, &inside), Err(RidgeError::Inside));
    assert_eq!(ridge(&mesh, &damaged(&mesh, &|_| 0.5, 0.05)), Err(RidgeError::Short));
}
