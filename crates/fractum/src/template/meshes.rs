//! The meshes of the templates, as `part.geo` describes them for Gmsh.

use std::f64::consts::{FRAC_PI_4, PI};

use fractum_math::Vec3;
use fractum_math::elementary::{asin, sin_cos};
use fractum_mesh::generate::{Outline, Piece, fill, mirrored_cells};
use fractum_mesh::{Group, Mesh, joined, joined_bodies, scrambled};

/// The outline of a rectangle, counter-clockwise from its lowest corner, with the groups of its sides.
fn rectangle([left, low]: [f64; 2], [right, high]: [f64; 2], [bottom, east, top, west]: [&'static str; 4]) -> Outline {
    let corners = [[right, low], [right, high], [left, high], [left, low]];
    let pieces = corners.into_iter().zip([bottom, east, top, west]).map(|(to, lines)| Piece::line(to, lines)).collect();
    Outline { start: [left, low], pieces }
}

fn hole(centre: [f64; 2], radius: f64, lines: &'static str) -> Outline {
    Outline { start: [centre[0] + radius, centre[1]], pieces: vec![Piece::arc(centre, -2.0 * PI, lines)] }
}

/// A size that goes from one value to another between two distances.
fn graded(distance: f64, [near, far]: [f64; 2], [from, to]: [f64; 2]) -> f64 {
    near + (far - near) * ((distance - from) / (to - from)).clamp(0.0, 1.0)
}

pub(super) fn plate() -> Mesh {
    let plate = rectangle([0.0, 0.0], [200.0, 100.0], ["", "right", "", "left"]);
    let holes = [hole([70.0, 40.0], 12.0, ""), hole([130.0, 60.0], 12.0, "")];
    let [first, second] = holes;
    fill(&[plate, first, second], "plate", &|[x, _]| graded((x - 100.0).abs(), [3.2, 7.2], [50.0, 70.0]), 1)
}

pub(super) fn brazilian() -> Mesh {
    let strip = asin(0.08);
    let (sin, cos) = sin_cos(strip);
    let arc = |angle, lines| Piece::arc([0.0, 0.0], angle, lines);
    let [strip, side] = [2.0 * strip, PI - 2.0 * strip];
    let pieces = vec![arc(strip, "top"), arc(side, ""), arc(strip, "bottom"), arc(side, "")];
    let disc = Outline { start: [50.0 * sin, 50.0 * cos], pieces };
    fill(&[disc], "disc", &|[x, _]| graded(x.abs(), [1.4, 2.2], [10.0, 50.0]), 1)
}

pub(super) fn beam() -> Mesh {
    let point = |to, end| Piece { end, ..Piece::line(to, "") };
    let pieces = vec![
        point([-150.0, 0.0], "left"),
        point([-2.0, 0.0], ""),
        point([-2.0, 30.0], ""),
        point([2.0, 30.0], ""),
        point([2.0, 0.0], ""),
        point([150.0, 0.0], "right"),
        point([200.0, 0.0], ""),
        point([200.0, 100.0], ""),
        point([4.0, 100.0], ""),
        Piece::line([-4.0, 100.0], "nose"),
        point([-200.0, 100.0], ""),
        point([-200.0, 0.0], ""),
    ];
    let beam = Outline { start: [-200.0, 0.0], pieces };
    fill(&[beam], "beam", &|[x, _]| graded(x.abs(), [2.7, 9.5], [6.0, 150.0]), 1)
}

pub(super) fn blast() -> Mesh {
    let rock = rectangle([-2.0, -2.0], [2.0, 1.0], ["far", "far", "", "far"]);
    let size = |[x, y]: [f64; 2]| 0.012 + 0.0225 * (x * x + y * y).sqrt();
    fill(&[rock, hole([0.0, 0.0], 0.05, "hole")], "rock", &size, 1)
}

/// A round tunnel, and a blast hole beside it.
pub(super) fn tunnel() -> Mesh {
    let rock = rectangle([-20.0, -20.0], [20.0, 20.0], ["far"; 4]);
    let size = |[x, y]: [f64; 2]| {
        let from_tunnel = (x * x + y * y).sqrt() - 2.0;
        let from_hole = ((x - 5.0) * (x - 5.0) + y * y).sqrt() - 0.1;
        let around_hole = 0.02 + 0.0225 * from_hole.min(1.5) + 0.15 * (from_hole - 1.5).max(0.0);
        (0.15 + 0.15 * from_tunnel).min(around_hole).min(1.5)
    };
    fill(&[rock, hole([0.0, 0.0], 2.0, "wall"), hole([5.0, 0.0], 0.1, "hole")], "rock", &size, 1)
}

pub(super) fn study() -> Mesh {
    fill(&[rectangle([-50.0, -10.0], [50.0, 10.0], ["", "right", "", "left"])], "bar", &|_| 2.5, 1)
}

/// Two bars and a specimen between them, whose nodes are its own.
pub(super) fn split_bar() -> Mesh {
    let size = |[x, _]: [f64; 2]| graded(x.abs(), [0.7, 5.0], [12.0, 40.0]);
    let specimen = fill(&[rectangle([-10.0, -8.0], [10.0, 8.0], [""; 4])], "specimen", &size, 1);
    // The end of a bar has points where the specimen ends.
    let bar = |from: f64, to: f64, end, name| {
        let corners = [[to, -10.0], [to, -8.0], [to, 8.0], [to, 10.0], [from, 10.0]];
        let mut pieces: Vec<Piece> = corners.into_iter().map(|to| Piece::line(to, "")).collect();
        pieces.push(Piece::line([from, -10.0], end));
        fill(&[Outline { start: [from, -10.0], pieces }], name, &size, 1)
    };
    let incident = bar(-510.0, -10.0, "struck", "incident");
    let mut transmission = bar(-410.0, -10.0, "", "transmission");
    // The other bar is a mirror of such a one.
    transmission.nodes.iter_mut().for_each(|node| node.x = -node.x);
    transmission.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    side_by_side(&mut [incident, specimen, transmission])
}

/// A cone with a wall above it, without a lid.
pub(super) fn hopper() -> Mesh {
    let [outlet, radius, height] = [30.0, 80.0, 150.0];
    let rim = Outline { start: [radius + height, 0.0], pieces: vec![Piece::arc([0.0; 2], 2.0 * PI, "")] };
    let mut mesh = fill(&[rim, hole([0.0; 2], outlet, "")], "hopper", &|[x, y]| 0.3 * (x * x + y * y).sqrt(), 1);
    for node in &mut mesh.nodes {
        let along = (node.x * node.x + node.y * node.y).sqrt();
        let share = along.min(radius) / along;
        *node = Vec3::new(share * node.x, share * node.y, along - outlet);
    }
    mesh
}

pub(super) fn quench() -> Mesh {
    let strip = rectangle([0.0, 0.0], [6.0, 4.0], ["middle", "", "cooled", "left"]);
    fill(&[strip], "plate", &|_| 0.07, 1)
}

/// Middles and radii of grains.
const GRAINS: [([f64; 2], f64); 13] = [
    ([-27.0, 9.0], 5.0),
    ([-13.0, 9.0], 6.0),
    ([13.0, 9.0], 5.5),
    ([26.0, 9.0], 4.5),
    ([-22.0, 25.0], 5.5),
    ([-6.0, 23.5], 4.5),
    ([6.5, 25.0], 4.0),
    ([20.0, 23.0], 5.5),
    ([-28.0, 41.0], 4.5),
    ([-13.0, 40.0], 5.0),
    ([1.0, 38.0], 5.5),
    ([15.0, 40.0], 5.0),
    ([29.0, 38.0], 4.5),
];

/// A notched beam and the grains in it.
pub(super) fn aggregate() -> Mesh {
    let size = |[x, _]: [f64; 2]| graded(x.abs(), [1.3, 10.0], [36.0, 80.0]);
    let point = |to, end| Piece { end, ..Piece::line(to, "") };
    let pieces = vec![
        point([-80.0, 0.0], "left"),
        point([-1.5, 0.0], ""),
        point([-1.5, 15.0], ""),
        point([1.5, 15.0], ""),
        point([1.5, 0.0], ""),
        point([80.0, 0.0], "right"),
        point([100.0, 0.0], ""),
        point([100.0, 50.0], ""),
        point([2.0, 50.0], ""),
        Piece::line([-2.0, 50.0], "nose"),
        point([-100.0, 50.0], ""),
        point([-100.0, 0.0], ""),
    ];
    let beam = Outline { start: [-100.0, 0.0], pieces };
    let holes = GRAINS.iter().map(|&(centre, radius)| hole(centre, radius, ""));
    let mortar = fill(&std::iter::once(beam).chain(holes).collect::<Vec<_>>(), "mortar", &size, 1);
    let grain = |&([x, y], radius): &([f64; 2], f64)| {
        let outline = Outline { start: [x + radius, y], pieces: vec![Piece::arc([x, y], 2.0 * PI, "")] };
        fill(&[outline], "aggregate", &size, 1)
    };
    let mut bodies: Vec<Mesh> = std::iter::once(mortar).chain(GRAINS.iter().map(grain)).collect();
    joined_bodies(&side_by_side(&mut bodies), &["mortar", "aggregate"]).0
}

/// Two halves with nodes of their own where they meet.
pub(super) fn shear() -> Mesh {
    let half = |low: f64, sides, name| fill(&[rectangle([0.0, low], [100.0, low + 25.0], sides)], name, &|_| 4.0, 1);
    side_by_side(&mut [half(0.0, ["bottom", "", "", ""], "lower"), half(25.0, ["", "", "top", ""], "upper")])
}

/// One mesh of plane bodies, with nodes of their own where they meet. Groups of one name become one.
fn side_by_side(bodies: &mut [Mesh]) -> Mesh {
    let [mut nodes, mut elements] = [0; 2];
    let mut names: Vec<String> = Vec::new();
    for body in bodies.iter_mut() {
        body.node_tags.iter_mut().for_each(|tag| *tag += nodes);
        body.point_tags
            .iter_mut()
            .chain(&mut body.line_tags)
            .chain(&mut body.triangle_tags)
            .for_each(|tag| *tag += elements);
        for group in &mut body.groups {
            let known = names.iter().position(|name| *name == group.name);
            group.tag = 1 + known.unwrap_or(names.len()) as i32;
            if known.is_none() {
                names.push(group.name.clone());
            }
        }
        nodes += body.nodes.len() as u64;
        elements += (body.points.len() + body.lines.len() + body.triangles.len()) as u64;
    }
    joined(bodies).expect("the bodies have numbers of their own")
}

pub(super) fn bracket() -> Mesh {
    let mut cells = mirrored_cells([20, 20, 7], Vec3::new(60.0, 60.0, 20.0), |[i, j, _]| i < 4 || j < 4);
    cells.nodes.iter_mut().for_each(|node| *node = round_corner(*node));
    with_groups(&scrambled(&cells, 0.3, 1), "bracket", &[("y+", "top"), ("x+", "end")])
}

/// Where a point of an angle whose legs are 12 mm thick goes as its inner corner becomes an arc of 6 mm.
fn round_corner(place: Vec3) -> Vec3 {
    let (leg, radius) = (12.0, 6.0);
    // Of points on the inner side of a leg, by their distance from the corner: along the leg and across it.
    let moved = |distance: f64| {
        let angle = FRAC_PI_4 * (1.0 - distance / radius).clamp(0.0, 1.0);
        let (sine, cosine) = sin_cos(angle);
        let [along, across] = [radius * (1.0 - sine), radius * (1.0 - cosine)];
        if distance < radius { [along - distance, across] } else { [0.0; 2] }
    };
    let [x, y] = [place.x / leg, place.y / leg];
    let by = if x <= 1.0 && y <= 1.0 {
        let [corner, _] = moved(0.0);
        [corner * x * y; 2]
    } else if x <= 1.0 {
        let [along, across] = moved(place.y - leg);
        [across * x, along * x]
    } else {
        let [along, across] = moved(place.x - leg);
        [along * y, across * y]
    };
    place + Vec3::new(by[0], by[1], 0.0)
}

pub(super) fn impact() -> Mesh {
    let mut cells = mirrored_cells([22, 22, 3], Vec3::new(200.0, 200.0, 30.0), |_| true);
    cells.nodes.iter_mut().for_each(|node| *node -= Vec3::new(100.0, 100.0, 0.0));
    let rim = ["x-", "x+", "y-", "y+"].map(|side| (side, "rim"));
    with_groups(&scrambled(&cells, 0.3, 1), "slab", &rim)
}

pub(super) fn tile() -> Mesh {
    let mut cells = mirrored_cells([24, 24, 4], Vec3::new(200.0, 200.0, 30.0), |_| true);
    cells.nodes.iter_mut().for_each(|node| *node -= Vec3::new(100.0, 100.0, 0.0));
    with_groups(&scrambled(&cells, 0.3, 1), "tile", &[])
}

/// The mesh with other names: of all tetrahedra, and of some sides; the others have no triangles.
fn with_groups(mesh: &Mesh, body: &str, sides: &[(&str, &str)]) -> Mesh {
    let mut groups: Vec<Group> = Vec::new();
    let mut triangles = Vec::new();
    for (side, name) in sides {
        let group = match groups.iter_mut().find(|group| group.name == *name) {
            Some(group) => group,
            None => {
                let tag = groups.len() as i32 + 1;
                groups.push(Group { name: (*name).to_owned(), dimension: 2, tag, ..Group::default() });
                &mut groups[tag as usize - 1]
            }
        };
        for of_side in mesh.group(side) {
            group.triangles.extend((triangles.len() as u32..).take(of_side.triangles.len()));
            triangles.extend(of_side.triangles.iter().map(|&triangle| mesh.triangles[triangle as usize]));
        }
    }
    let all = (0..mesh.tetrahedra.len() as u32).collect();
    groups.push(Group { name: body.to_owned(), dimension: 3, tag: 1, tetrahedra: all, ..Group::default() });
    let (nodes, tetrahedra) = (mesh.nodes.clone(), mesh.tetrahedra.clone());
    let mut named = Mesh { nodes, triangles, tetrahedra, groups, ..Mesh::default() };
    named.number();
    named
}
