//! Interfaces between elements: faces along which the nodes of a solid are doubled, with a strength of their own.
//!
//! Every corner of a face joins two nodes in one place. Interfaces with a stiffness pull on both by the law of
//! [`SpringInterface`](fractum_kernels::interface::SpringInterface), one point per corner. Stiff ones leave them together until the traction between them, which is what it takes to move them as one, meets
//! the strength: then the cohesive law takes over. No stiffness stands in the step. Points of a stiff interface between the same two nodes are one, with
//! the area of all and their mean normal: the traction between two nodes is that of all faces around them.
//!
//! Jumps are small: corners stay opposite each other, and the frame of a face is that of its middle surface where bodies turn.

mod growth;
pub(crate) mod in_situ;
mod inside;
pub(crate) mod joints;
pub(crate) mod motion;
mod opened;
pub(crate) mod reading;
pub(crate) mod rest;

use fractum_fem::{Kinematics, Solid};
use fractum_kernels::interface::{InterfaceForce, InterfaceLaw, InterfaceState};
use fractum_math::{Mat3, Vec3, connected};

pub use inside::InsidePressure;
pub use opened::OpenedCrack;
pub use reading::{FaceReading, InterfacesState};

/// What the faces of an interface have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct InterfaceKind {
    /// Its name.
    pub name: String,
    /// What it bears.
    pub law: InterfaceLaw,
    /// K_n and K_s [Pa/m]; none where it is stiff until its strength is met.
    pub stiffness: Option<[f64; 2]>,
}

/// A face of an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InterfaceFace {
    /// Number of the interface.
    pub kind: u32,
    /// Corners on the first and on the second side, in the same places; edges of plane solids repeat the second one. The normal points to the second.
    pub sides: [[u32; 3]; 2],
    /// Bodies and elements on both sides.
    pub elements: [(u32, u32); 2],
}

impl InterfaceFace {
    /// Number of corners.
    pub fn corners(&self) -> usize {
        if self.sides[0][1] == self.sides[0][2] { 2 } else { 3 }
    }

    /// Length of its first edge without load [m].
    pub(crate) fn length(&self, solid: &Solid) -> f64 {
        let [a, b, _] = self.sides[0].map(|node| solid.reference[node as usize]);
        (b - a).norm()
    }

    /// Rows: normal, direction of the first edge, and across both; and twice the area, or the length of an edge.
    fn frame(&self, place: impl Fn(u32) -> Vec3) -> (Mat3, f64) {
        let middle = |corner: usize| (place(self.sides[0][corner]) + place(self.sides[1][corner])) * 0.5;
        let [a, b, c] = [0, 1, 2].map(middle);
        let along = b - a;
        let normal = if self.corners() == 2 { Vec3::new(along.y, -along.x, 0.0) } else { along.cross(&(c - a)) };
        let size = normal.norm();
        let (normal, along) = (normal / size, along.normalize());
        (rows(normal, along), size)
    }
}

fn rows(normal: Vec3, along: Vec3) -> Mat3 {
    let along = (along - normal * normal.dot(&along)).normalize();
    Mat3::from_rows(&[normal.transpose(), along.transpose(), normal.cross(&along).transpose()])
}

/// A point of an interface: two nodes in one place.
#[derive(Clone, Debug)]
struct Point {
    kind: u32,
    /// Nodes on the first and on the second side.
    pair: [u32; 2],
    /// Their places among the nodes of the cluster.
    local: [u16; 2],
    /// Faces it belongs to, with its share of their areas [m²]; negative where their first side is its second.
    faces: Vec<(u32, f64)>,
    /// Area that is left [m²].
    area: f64,
    /// Rows: normal, two directions across.
    frame: Mat3,
    /// Faces it belongs to that turn with their bodies, and what their turning so far has added to the jump when it was first looked at, along the rows
    /// of its frame [m].
    turned: u16,
    offset: Vec3,
    state: InterfaceState,
    /// What its state becomes, as far as it is known.
    tried: InterfaceState,
    /// Jump at the last look, in space [m].
    jump: Vec3,
    /// Force on its first node at the last look, in space [N].
    pull: Vec3,
    /// Place without load [m].
    place: Vec3,
    /// Force of the pressure inside on its second node at the last look, in space [N].
    thrust: Vec3,
    /// The same by its parts.
    force: InterfaceForce,
}

impl Point {
    /// A jump along the rows of its frame.
    fn local(&self, jump: Vec3) -> Vec3 {
        self.frame * jump - self.offset
    }
}

/// What a step has taken [J].
#[derive(Clone, Copy, Debug, Default)]
struct Taken {
    /// All work of the jumps against the interface.
    work: f64,
    /// Work of the pressure inside.
    external: f64,
    friction: f64,
    /// What stiff sides lose as they meet.
    impact: f64,
}

/// Nodes in one place with the points between them.
#[derive(Clone, Debug)]
struct Cluster {
    nodes: Vec<u32>,
    points: Vec<Point>,
    /// Forces on the nodes [N].
    forces: Vec<Vec3>,
    taken: Taken,
}

/// All interfaces of a scene.
#[derive(Clone, Debug, Default)]
pub struct Interfaces {
    kinds: Vec<InterfaceKind>,
    /// Pressure inside of each; empty where none has any.
    pressures: Vec<Option<InsidePressure>>,
    faces: Vec<InterfaceFace>,
    /// Area of each face [m²]; 0 once an element beside it has left.
    areas: Vec<f64>,
    clusters: Vec<Cluster>,
    /// Cluster and point of each corner of each face; none at a tip.
    points_of: Vec<[Option<(u32, u32)>; 3]>,
    /// Bodies, elements and the faces beside them, ascending.
    beside: Vec<(u32, u32, u32)>,
    /// Square of the frequency that their stiffness adds to that of the solids [1/s²].
    frequency_square: f64,
}

impl Interfaces {
    /// Interfaces of a solid in which the nodes are doubled already.
    pub fn new(solid: &Solid, kinds: Vec<InterfaceKind>, faces: Vec<InterfaceFace>) -> Self {
        let places = |node: u32| solid.reference[node as usize];
        let thickness = |(body, _): (u32, u32)| solid.body(body as usize).thickness;
        let frames: Vec<(Mat3, f64)> = faces.iter().map(|face| face.frame(places)).collect();
        let depth = |face: &InterfaceFace| {
            if face.corners() == 2 {
                face.elements.map(thickness).into_iter().fold(f64::INFINITY, f64::min)
            } else {
                0.5
            }
        };
        let areas: Vec<f64> = faces.iter().zip(&frames).map(|(face, (_, size))| size * depth(face)).collect();
        let corners = |face: &InterfaceFace| (0..face.corners()).map(|k| face.sides.map(|side| side[k])).collect();
        let pairs: Vec<Vec<[u32; 2]>> = faces.iter().map(corners).collect();
        let joined = pairs.iter().flatten().copied().filter(|[a, b]| a != b);
        let root = connected(solid.reference.len(), joined);
        // Corners by cluster, then by point: root, pair, number, face, corner.
        let mut rows: Vec<(u32, [u32; 2], u32, u32, usize, f64)> = Vec::new();
        for (number, (face, pairs)) in (0u32..).zip(faces.iter().zip(&pairs)) {
            let is_stiff = kinds[face.kind as usize].stiffness.is_none();
            for (corner, &[a, b]) in pairs.iter().enumerate().filter(|(_, [a, b])| a != b) {
                let (pair, sign) = if is_stiff && a > b { ([b, a], -1.0) } else { ([a, b], 1.0) };
                let key = if is_stiff { face.kind } else { kinds.len() as u32 + number };
                rows.push((root[a as usize], pair, key, number, corner, sign));
            }
        }
        rows.sort_by_key(|&(root, pair, key, number, corner, _)| (root, pair, key, number, corner));
        let mut clusters = Vec::new();
        let mut points_of = vec![[None; 3]; faces.len()];
        for cluster in rows.chunk_by(|a, b| a.0 == b.0) {
            let mut nodes: Vec<u32> = cluster.iter().flat_map(|row| row.1).collect();
            nodes.sort_unstable();
            nodes.dedup();
            let mut points = Vec::new();
            for corners in cluster.chunk_by(|a, b| (a.1, a.2) == (b.1, b.2)) {
                let (pair, kind) = (corners[0].1, faces[corners[0].3 as usize].kind);
                let local = pair.map(|node| nodes.partition_point(|&other| other < node) as u16);
                let share = |row: &(u32, [u32; 2], u32, u32, usize, f64)| {
                    let face = row.3 as usize;
                    (row.3, row.5 * areas[face] / faces[face].corners() as f64)
                };
                for row in corners {
                    points_of[row.3 as usize][row.4] = Some((clusters.len() as u32, points.len() as u32));
                }
                let InterfaceKind { law, stiffness, .. } = &kinds[kind as usize];
                let state = law.intact(stiffness.is_none());
                let of_faces: Vec<(u32, f64)> = corners.iter().map(share).collect();
                let area = of_faces.iter().map(|(_, share)| share.abs()).sum();
                let frame = mean_frame(&of_faces, |face| frames[face as usize].0);
                points.push(Point {
                    kind,
                    pair,
                    local,
                    faces: of_faces,
                    area,
                    frame,
                    turned: 0,
                    offset: Vec3::zeros(),
                    state,
                    tried: state,
                    jump: Vec3::zeros(),
                    pull: Vec3::zeros(),
                    place: solid.reference[pair[0] as usize],
                    thrust: Vec3::zeros(),
                    force: InterfaceForce::default(),
                });
            }
            let forces = vec![Vec3::zeros(); nodes.len()];
            clusters.push(Cluster { nodes, points, forces, taken: Taken::default() });
        }
        let sides =
            (0u32..).zip(&faces).flat_map(|(face, own)| own.elements.map(|(body, element)| (body, element, face)));
        let mut beside: Vec<(u32, u32, u32)> = sides.collect();
        beside.sort_unstable();
        let (pressures, frequency_square) = (Vec::new(), 0.0);
        let mut interfaces =
            Interfaces { kinds, pressures, faces, areas, clusters, points_of, beside, frequency_square };
        interfaces.frequency_square = interfaces.added_frequency_square(solid);
        interfaces
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Whether some were never joined: they bear pressure and friction alone.
    pub(crate) fn rub(&self) -> bool {
        self.kinds.iter().any(|kind| !kind.law.is_bonded())
    }

    /// Pairs of different bodies that they join.
    pub fn joined_bodies(&self) -> Vec<[u32; 2]> {
        let bodies = self.faces.iter().map(|face| face.elements.map(|(body, _)| body));
        let mut pairs: Vec<[u32; 2]> = bodies.filter(|[a, b]| a != b).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Square of the frequency that their stiffness adds to that of the solids [1/s²].
    pub fn frequency_square(&self) -> f64 {
        self.frequency_square
    }

    /// By the largest sum of a row of M⁻¹K over their stiffness alone.
    fn added_frequency_square(&self, solid: &Solid) -> f64 {
        let mut largest = 0.0f64;
        for cluster in &self.clusters {
            for (place, &node) in cluster.nodes.iter().enumerate() {
                let own = cluster.points.iter().filter(|point| point.local.contains(&(place as u16)));
                let stiffness = |point: &Point| {
                    let [normal, across] = self.kinds[point.kind as usize].stiffness.unwrap_or_default();
                    normal.max(across) * point.area
                };
                let sum: f64 = own.map(stiffness).sum();
                largest = largest.max(2.0 * sum / solid.mass[node as usize]);
            }
        }
        largest
    }

    /// Pairs of nodes in one place, which do not touch as discrete elements.
    pub(crate) fn doubled(&self) -> impl Iterator<Item = [u32; 2]> {
        self.clusters.iter().flat_map(|cluster| {
            let nodes = &cluster.nodes;
            let others = move |i: usize| nodes[i + 1..].iter().map(move |&other| [nodes[i], other]);
            (0..nodes.len()).flat_map(others)
        })
    }

    /// Takes the frames of middle surfaces where bodies turn.
    fn turn(&mut self, solid: &Solid) {
        let turns = |body: u32| solid.body(body as usize).kinematics == Kinematics::Corotational;
        let moves = |face: &InterfaceFace| face.elements.iter().any(|&(body, _)| turns(body));
        if !self.faces.iter().any(moves) {
            return;
        }
        let Interfaces { clusters, faces, .. } = self;
        for point in clusters.iter_mut().flat_map(|cluster| &mut cluster.points) {
            let frame = mean_frame(&point.faces, |face| {
                let face = &faces[face as usize];
                let place = |node: u32| {
                    if moves(face) { solid.position(node as usize) } else { solid.reference[node as usize] }
                };
                face.frame(place).0
            });
            let turned = point.faces.iter().filter(|(face, _)| moves(&faces[*face as usize])).count() as u16;
            if turned != point.turned {
                // A body that begins to turn leaves the jump as it was: what has slid on a face that stood askew has not opened it.
                let [a, b] = point.pair.map(|node| solid.displacement[node as usize]);
                point.offset += (frame - point.frame) * (b - a);
                point.turned = turned;
            }
            point.frame = frame;
        }
    }

    /// Gives up the faces beside elements that have left; the energy that was in them [J].
    pub(crate) fn lose(&mut self, solid: &Solid, removed: &[(usize, u32)]) -> f64 {
        let mut lost = 0.0;
        for &(body, element) in removed {
            let key = (body as u32, element);
            let first = self.beside.partition_point(|&(body, element, _)| (body, element) < key);
            let own = self.beside[first..].iter().take_while(|&&(body, element, _)| (body, element) == key);
            for &(.., face) in own {
                if std::mem::take(&mut self.areas[face as usize]) == 0.0 {
                    continue;
                }
                for (cluster, point) in self.points_of[face as usize].into_iter().flatten() {
                    let point = &mut self.clusters[cluster as usize].points[point as usize];
                    if point.area == 0.0 {
                        continue;
                    }
                    let share: f64 = point.faces.iter().filter(|own| own.0 == face).map(|own| own.1.abs()).sum();
                    let left = if point.faces.len() == 1 { 0.0 } else { (point.area - share).max(0.0) };
                    let ratio = left / point.area;
                    lost += point.force.stored * (point.area - left);
                    point.area = left;
                    point.pull *= ratio;
                    point.thrust *= ratio;
                    point.faces.retain(|own| own.0 != face || left == 0.0);
                }
                self.points_of[face as usize] = [None; 3];
            }
        }
        if lost > 0.0 {
            self.frequency_square = self.added_frequency_square(solid);
        }
        lost
    }
}

/// The frame of a point of several faces.
fn mean_frame(faces: &[(u32, f64)], frame: impl Fn(u32) -> Mat3) -> Mat3 {
    let first = frame(faces[0].0);
    if let [(_, share)] = faces
        && *share > 0.0
    {
        return first;
    }
    let normal = faces.iter().map(|&(face, share)| frame(face).row(0).transpose() * share).sum::<Vec3>();
    // Faces that fold back upon themselves have no mean.
    let own = first.row(0).transpose() * faces[0].1.signum();
    rows(normal.try_normalize(0.0).unwrap_or(own), first.row(1).transpose())
}
