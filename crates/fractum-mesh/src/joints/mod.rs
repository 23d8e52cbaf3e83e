//! Joints, networks of them and grains, cut into meshes.

mod assemble;
mod grains;
mod pattern;
mod refill;
mod sets;
mod sheet;
mod space;
mod tidy;

use std::collections::{BTreeMap, BTreeSet};

use assemble::{with_faces, with_grains, with_joints};
use fractum_math::elementary::cbrt;
pub use grains::Grains;
use grains::grain_at;
pub use pattern::Fate;
use pattern::Pattern;
use refill::{Refilled, refill};
pub use sets::{JointSet, Orientation, mean_dip, mean_direction, normal_of};
use sheet::Sheet;
use space::Block;
pub use space::Disc;
use tidy::tidy;

use crate::{Mesh, Vec3};

/// Patterns of grains that are tried one after the other.
const MOST_TRIES: u64 = 4;

/// A straight joint of a plane body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Where it begins and ends.
    pub ends: [[f64; 2]; 2],
    /// The group of its lines, by its number.
    pub group: u32,
}

/// A group of joints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointGroup {
    /// Name of the group of lines or triangles; several may have the same.
    pub name: String,
    /// Whether its joints may lie in each element; everywhere where it is empty.
    pub elements: Vec<bool>,
}

/// Why joints cannot be cut into a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetworkError {
    /// A mesh of neither triangles in the xy-plane nor tetrahedra.
    #[error("the mesh is neither of triangles in the xy-plane nor of tetrahedra")]
    Kind,
    /// Elements that overlap.
    #[error("more than two elements share a face")]
    Overlap,
    /// A group that the mesh has already.
    #[error("the mesh has a group \"{0}\" already")]
    Taken(String),
    /// A place that no triangles fill.
    #[error("no triangles fill the mesh around ({:.4e}, {:.4e})", at[0], at[1])]
    Unfilled {
        /// The place.
        at: [f64; 2],
    },
}

/// Grains as they are in a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrainsMade {
    /// How many there are.
    pub count: usize,
    /// Area or volume of each, in no order.
    pub sizes: Vec<f64>,
    /// Length or area of their boundaries.
    pub boundary: f64,
    /// Largest distance by which a corner has moved.
    pub shift: f64,
}

/// What became of joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cutting {
    /// Of each joint.
    pub fates: Vec<Fate>,
    /// Largest angle by which a part of one is turned [rad].
    pub turn: f64,
    /// Largest distance by which an end or a crossing has moved.
    pub shift: f64,
}

impl Mesh {
    /// Whether joints are lines of it: triangles in the xy-plane, and no tetrahedra.
    pub fn is_plane(&self) -> bool {
        self.tetrahedra.is_empty()
            && !self.triangles.is_empty()
            && self.nodes.iter().all(|node| node.z == self.nodes[0].z)
    }

    /// Cuts straight joints into a plane mesh: the triangles near by are made anew, so that the joints are lines of the mesh, in these groups.
    ///
    /// - `least`: the least angle at which two may meet [rad]; a joint that meets those before it at less is left out
    ///
    /// # Errors
    /// [`NetworkError`]; the mesh stays as it was.
    pub fn cut_traces(&mut self, traces: &[Trace], groups: &[JointGroup], least: f64) -> Result<Cutting, NetworkError> {
        if !self.is_plane() {
            return Err(NetworkError::Kind);
        }
        self.refuse_taken(groups.iter().map(|group| (&group.name, 1)))?;
        let sheet = Sheet::new(self, &elements(groups)).ok_or(NetworkError::Overlap)?;
        let around = around(&sheet);
        // Joints around which no triangles fit are left out one by one.
        let mut left: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        let (pattern, fates, filled) = loop {
            let mut pattern = Pattern::new(&sheet, true);
            let add = |(number, trace): (usize, &Trace)| match left.get(&number) {
                Some(&at) => pattern.none(Fate::Unfilled(at)),
                None => pattern.add(trace, around, least),
            };
            let fates: Vec<Fate> = traces.iter().enumerate().map(add).collect();
            tidy(&mut pattern);
            if pattern.segments.iter().all(|segment| segment.joint.is_none()) {
                break (pattern, fates, None);
            }
            match refill(&pattern, 1) {
                Ok(filled) => break (pattern, fates, Some(filled)),
                Err(at) => {
                    let cut = (0..traces.len()).filter(|&joint| matches!(fates[joint], Fate::Cut(_)));
                    let far = |joint: usize| pattern::foot(at, traces[joint].ends).0;
                    match cut.min_by(|&a, &b| far(a).total_cmp(&far(b))) {
                        Some(nearest) => left.insert(nearest, at),
                        None => return Err(NetworkError::Unfilled { at }),
                    };
                }
            }
        };
        let cutting = Cutting { fates, turn: pattern.turn(), shift: pattern.shift };
        if let Some(filled) = filled {
            let labels = sheet.labels;
            let group = |joint: u32| traces[joint as usize].group;
            with_joints(self, filled, &labels, &group, &names(groups));
        }
        Ok(cutting)
    }

    /// Cuts discs into a mesh of tetrahedra: nodes near their planes move onto them, and edges that cross them are divided. The faces of a disc lie in its plane;
    /// its rim follows the elements.
    ///
    /// # Errors
    /// As [`Mesh::cut_traces`], with the names of groups of triangles.
    pub fn cut_discs(&mut self, discs: &[Disc], groups: &[JointGroup], least: f64) -> Result<Cutting, NetworkError> {
        if self.tetrahedra.is_empty() {
            return Err(NetworkError::Kind);
        }
        self.refuse_taken(groups.iter().map(|group| (&group.name, 2)))?;
        let mut block = Block::new(self, &elements(groups)).ok_or(NetworkError::Overlap)?;
        let mut fates = Vec::new();
        for (joint, disc) in (0u32..).zip(discs) {
            let fate = block.add(joint, disc, &discs[..joint as usize], &fates, least);
            fates.push(fate);
        }
        block.improve();
        let cutting = Cutting { fates, turn: 0.0, shift: block.shift };
        if block.skin.iter().any(|facet| facet.joint.is_some()) {
            with_faces(self, block, discs, &names(groups));
        }
        Ok(cutting)
    }

    /// Divides a body into grains, with a group of their boundaries. In a plane the mesh is made anew along them; in space every element belongs to the grain in which its middle
    /// is, so that boundaries follow the elements.
    ///
    /// - `elements`: whether each element is divided; all where it is empty
    ///
    /// # Errors
    /// [`NetworkError`]; the mesh stays as it was.
    pub fn divide_into_grains(&mut self, grains: &Grains, elements: &[bool]) -> Result<GrainsMade, NetworkError> {
        let dimension = if self.tetrahedra.is_empty() { 2 } else { 3 };
        let phases = grains.phases.iter().map(|(name, _)| (name, dimension)).chain([(&grains.matrix, dimension)]);
        let names = phases.chain([(&grains.boundary, dimension - 1)]);
        self.refuse_taken(names)?;
        if dimension == 3 {
            return grains_in_space(self, grains, elements);
        }
        if !self.is_plane() {
            return Err(NetworkError::Kind);
        }
        let sheet = Sheet::new(self, &[elements]).ok_or(NetworkError::Overlap)?;
        let [low, high] = sheet.extent();
        // Once in some fifty bodies lines come together so that no triangles fill them; other grains of the same kind do.
        let mut tried = 0;
        let (seeds, shift, filled) = loop {
            let seed = grains.seed.wrapping_add(tried << 32);
            let seeds = Grains { seed, ..grains.clone() }.seeds([low, high]);
            let mut pattern = Pattern::new(&sheet, false);
            let around = around(&sheet);
            for line in grains.lines(&seeds, [low, high]) {
                if let Some(line) = pattern::clipped(line, around) {
                    pattern.lead(line, 0);
                }
            }
            tidy(&mut pattern);
            match refill(&pattern, grains.seed) {
                Ok(filled) => break (seeds, pattern.shift, filled),
                Err(at) if tried == MOST_TRIES => return Err(NetworkError::Unfilled { at }),
                Err(_) => tried += 1,
            }
        };
        let lines: BTreeSet<[u32; 2]> = filled.joints.iter().map(|([a, b], _)| [*a.min(b), *a.max(b)]).collect();
        let inside: Vec<bool> = filled.triangles.iter().map(|(t, _)| is_divided(&sheet, &filled, t)).collect();
        let owner = owners(&filled, &lines, grains, &seeds);
        let owner: Vec<Option<usize>> =
            owner.into_iter().zip(&inside).map(|(owner, inside)| owner.filter(|_| *inside)).collect();
        let filled = Refilled { joints: Vec::new(), ..filled };
        let labels = sheet.labels;
        with_joints(self, filled, &labels, &|_| 0, &[]);
        let mut made = with_grains(self, grains, &owner, &inside);
        made.shift = shift;
        Ok(made)
    }
}

impl Mesh {
    fn refuse_taken<'a>(&self, names: impl Iterator<Item = (&'a String, u8)>) -> Result<(), NetworkError> {
        for (name, dimension) in names {
            if self.group(name).iter().any(|group| group.dimension == dimension) {
                return Err(NetworkError::Taken(name.clone()));
            }
        }
        Ok(())
    }
}

fn elements(groups: &[JointGroup]) -> Vec<&[bool]> {
    groups.iter().map(|group| group.elements.as_slice()).collect()
}

fn names(groups: &[JointGroup]) -> Vec<String> {
    groups.iter().map(|group| group.name.clone()).collect()
}

/// Whether a new triangle is one of those that are divided.
fn is_divided(sheet: &Sheet, filled: &Refilled, triangle: &[u32; 3]) -> bool {
    let corners = triangle.map(|node| filled.at[node as usize]);
    sheet.is_allowed(0, [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0))
}

/// A rectangle around all that is allowed, with room for ends beyond its sides.
fn around(sheet: &Sheet) -> [[f64; 2]; 2] {
    let [low, high] = sheet.extent();
    let room = 1.5 * sheet.size.iter().copied().fold(0.0, f64::max);
    [low.map(|x| x - room), high.map(|x| x + room)]
}

/// The grain of each triangle: that of the most area of all triangles that no boundary parts from it.
fn owners(filled: &Refilled, lines: &BTreeSet<[u32; 2]>, grains: &Grains, seeds: &[[f64; 2]]) -> Vec<Option<usize>> {
    let corners = |t: usize| filled.triangles[t].0.map(|n| filled.at[n as usize]);
    let mut beside: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (number, (t, _)) in filled.triangles.iter().enumerate() {
        for k in 0..3 {
            let [a, b] = [t[k], t[(k + 1) % 3]];
            let side = [a.min(b), a.max(b)];
            if !lines.contains(&side) {
                beside.entry(side).or_default().push(number);
            }
        }
    }
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); filled.triangles.len()];
    for pair in beside.values().filter(|pair| pair.len() == 2) {
        if filled.triangles[pair[0]].1 == filled.triangles[pair[1]].1 {
            next[pair[0]].push(pair[1]);
            next[pair[1]].push(pair[0]);
        }
    }
    let mut owner: Vec<Option<usize>> = vec![None; filled.triangles.len()];
    let mut seen = vec![false; filled.triangles.len()];
    for start in 0..filled.triangles.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut cell, mut at) = (vec![start], 0);
        let mut votes: BTreeMap<Option<usize>, f64> = BTreeMap::new();
        while at < cell.len() {
            let t = cell[at];
            at += 1;
            let [a, b, c] = corners(t);
            let middle = [0, 1].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
            *votes.entry(grain_at(seeds, middle, grains.share.sqrt())).or_default() += sheet::cross(a, b, c);
            for &other in &next[t] {
                if !std::mem::replace(&mut seen[other], true) {
                    cell.push(other);
                }
            }
        }
        let most = votes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(grain, _)| grain);
        cell.into_iter().for_each(|t| owner[t] = most);
    }
    owner
}

/// Grains of tetrahedra.
fn grains_in_space(mesh: &mut Mesh, grains: &Grains, elements: &[bool]) -> Result<GrainsMade, NetworkError> {
    let block = Block::new(mesh, &[elements]).ok_or(NetworkError::Overlap)?;
    let inside: Vec<bool> = (0..mesh.tetrahedra.len() as u32).map(|element| block.is_allowed(0, element)).collect();
    let seeds = grains.seeds_in_space(mesh.bounding_box().into());
    let seeds: Vec<[f64; 3]> = seeds.into_iter().map(Into::into).collect();
    let middle = |t: &[u32; 4]| t.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / 4.0;
    let scale = cbrt(grains.share);
    let own = |(t, inside): (&[u32; 4], &bool)| {
        if *inside { grain_at(&seeds, middle(t).into(), scale) } else { None }
    };
    let owner: Vec<Option<usize>> = mesh.tetrahedra.iter().zip(&inside).map(own).collect();
    Ok(with_grains(mesh, grains, &owner, &inside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Jitter, structured_rectangle};
    use crate::quality::{area_vector, triangle};

    fn plate(cells: u32, seed: u64) -> Mesh {
        structured_rectangle([2 * cells, cells], [2.0, 1.0], Some(Jitter { fraction: 0.15, seed }))
    }

    fn everywhere() -> JointGroup {
        JointGroup { name: "joints".to_owned(), elements: Vec::new() }
    }

    fn area(mesh: &Mesh, triangles: impl Iterator<Item = u32>) -> f64 {
        let corners = |t: u32| mesh.triangles[t as usize].map(|n| mesh.nodes[n as usize]);
        triangles.map(|t| area_vector(corners(t)).z).sum()
    }

    fn worst(mesh: &Mesh) -> f64 {
        let ratio = |t: &[u32; 3]| triangle(t.map(|n| mesh.nodes[n as usize])).radius_ratio;
        mesh.triangles.iter().map(ratio).fold(1.0, f64::min)
    }

    #[test]
    fn straight_joints_become_lines_of_good_triangles() {
        let trace = |ends| Trace { ends, group: 0 };
        let traces =
            [trace([[0.3, 0.2], [1.6, 0.8]]), trace([[0.5, 0.9], [1.0, 0.1]]), trace([[1.2, -0.5], [1.3, 1.5]])];
        for seed in 1..4 {
            let mut mesh = plate(20, seed);
            let cutting = mesh.cut_traces(&traces, &[everywhere()], 0.25).unwrap();
            assert!(cutting.fates.iter().all(|fate| matches!(fate, Fate::Cut(_))), "{cutting:?}");
            assert!((area(&mesh, 0..mesh.triangles.len() as u32) - 2.0).abs() < 1e-12);
            let joints = mesh.group("joints")[0].clone();
            let length = |line: &u32| {
                let [a, b] = mesh.lines[*line as usize].map(|n| mesh.nodes[n as usize]);
                (a - b).norm()
            };
            let sum: f64 = joints.lines.iter().map(length).sum();
            let wanted = 1.3f64.hypot(0.6) + 0.5f64.hypot(0.8) + 1.0f64.hypot(0.05);
            assert!((sum / wanted - 1.0).abs() < 0.02, "{sum} of {wanted}");
            assert!(worst(&mesh) > 0.3, "radius ratio {}", worst(&mesh));
            assert!(cutting.turn < 1e-9, "{}", cutting.turn);
            let names = ["x-", "x+", "y-", "y+"];
            let sides: f64 = names.iter().flat_map(|name| mesh.group(name)[0].lines.clone()).map(|l| length(&l)).sum();
            assert!((sides - 6.0).abs() < 1e-12);
            mesh.cut(&[crate::CutAlong::Group("joints")]).unwrap();
        }
    }

    #[test]
    fn a_disc_becomes_flat_faces_of_tetrahedra() {
        use crate::generate::structured_box;
        use crate::quality::{signed_volume, tetrahedron};
        for seed in 1..4 {
            let jitter = Some(Jitter { fraction: 0.15, seed });
            let mut mesh = structured_box([10, 10, 10], Vec3::new(1.0, 1.0, 1.0), jitter);
            let disc = |dip: f64, direction: f64, centre, radius| Disc {
                centre,
                normal: normal_of(dip, direction),
                radius,
                group: 0,
            };
            let discs = [
                disc(0.6, 1.0, Vec3::new(0.5, 0.5, 0.5), 0.35),
                disc(1.3, 4.0, Vec3::new(0.5, 0.45, 0.5), 2.0),
                disc(0.6, 1.05, Vec3::new(0.5, 0.5, 0.52), 0.3),
            ];
            let cutting = mesh.cut_discs(&discs, &[everywhere()], 0.25).unwrap();
            let [Fate::Cut(small), Fate::Cut(large), Fate::Sharp { other: Some(0), .. }] = cutting.fates[..] else {
                panic!("{cutting:?}")
            };
            assert!((small / (std::f64::consts::PI * 0.35 * 0.35) - 1.0).abs() < 0.1, "{small}");
            assert!(large > 0.95, "{large}");
            let volumes: Vec<f64> =
                mesh.tetrahedra.iter().map(|t| signed_volume(t.map(|n| mesh.nodes[n as usize]))).collect();
            assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-12 && volumes.iter().all(|v| *v > 0.0));
            let ratio = |t: &[u32; 4]| tetrahedron(t.map(|n| mesh.nodes[n as usize])).radius_ratio;
            let worst = mesh.tetrahedra.iter().map(ratio).fold(1.0, f64::min);
            assert!(worst > 0.1, "radius ratio {worst}");
            let group = mesh.group("joints")[0].clone();
            let off = |t: &u32| {
                let [a, b, c] = mesh.triangles[*t as usize].map(|n| mesh.nodes[n as usize]);
                let normal = (b - a).cross(&(c - a)).normalize();
                let apart = |disc: &Disc| 1.0 - normal.dot(&disc.normal).abs();
                discs.iter().map(apart).fold(f64::INFINITY, f64::min)
            };
            let worst_off = group.triangles.iter().map(off).fold(0.0, f64::max);
            assert!(worst_off < 0.02, "{worst_off}");
            let sides = ["x-", "x+", "y-", "y+", "z-", "z+"];
            let area = |t: &u32| area_vector(mesh.triangles[*t as usize].map(|n| mesh.nodes[n as usize])).norm();
            let skin: f64 = sides.iter().flat_map(|name| mesh.group(name)[0].triangles.clone()).map(|t| area(&t)).sum();
            assert!((skin - 6.0).abs() < 1e-9, "{skin}");
            mesh.cut(&[crate::CutAlong::Group("joints")]).unwrap();
        }
    }

    #[test]
    fn grains_fill_a_plate_with_straight_boundaries() {
        for seed in 1..4 {
            for share in [1.0, 0.5] {
                let mut mesh = plate(60, seed);
                let phases = vec![("quartz".to_owned(), 0.3), ("feldspar".to_owned(), 0.7)];
                let grains = Grains {
                    size: 0.12,
                    rounds: 2,
                    share,
                    phases,
                    matrix: "mortar".to_owned(),
                    boundary: "boundary".to_owned(),
                    seed,
                };
                let made = mesh.divide_into_grains(&grains, &[]).unwrap();
                let in_group = |name: &str| {
                    area(
                        &mesh,
                        mesh.group(name).iter().flat_map(|g| g.triangles.clone()).collect::<Vec<_>>().into_iter(),
                    )
                };
                let [quartz, feldspar, mortar] = ["quartz", "feldspar", "mortar"].map(in_group);
                assert!((quartz + feldspar + mortar - 2.0).abs() < 1e-9);
                assert!((quartz + feldspar - 2.0 * share).abs() < 0.1, "{quartz} {feldspar} {mortar}");
                assert!((0.15..0.45).contains(&(quartz / (quartz + feldspar))), "{quartz} {feldspar}");
                assert!(worst(&mesh) > 0.15, "{}", worst(&mesh));
                let expected = 2.0 / (0.25 * std::f64::consts::PI * 0.12 * 0.12);
                assert!((made.count as f64 / expected - 1.0).abs() < 0.25, "{} {expected}", made.count);
                mesh.cut(&[crate::CutAlong::Group("boundary")]).unwrap();
            }
        }
    }

    #[test]
    fn sets_have_the_orientation_and_density_asked_for() {
        for seed in 1..4 {
            let set = JointSet {
                group: 0,
                orientation: Orientation::Angle(1.0),
                scatter: 0.1,
                spacing: 0.5,
                spacing_scatter: 0.3,
                length: Some(2.0),
                length_scatter: 0.3,
                persistence: 0.6,
                seed,
            };
            let bounds = [[0.0; 2], [40.0, 30.0]];
            let traces = set.traces(bounds);
            let inside = traces.iter().filter_map(|trace| pattern::clipped(trace.ends, bounds));
            let length: f64 = inside.clone().map(|[a, b]| sheet::distance(a, b)).sum();
            assert!((length / 1200.0 / (0.6 / 0.5) - 1.0).abs() < 0.08, "P21 {}", length / 1200.0);
            let (mean, scatter) = mean_direction(inside);
            assert!((mean - 1.0).abs() < 0.01 && (scatter - 0.1).abs() < 0.015, "{mean} {scatter}");
            let set = JointSet { orientation: Orientation::Dip([0.7, 2.0]), persistence: 0.3, ..set };
            let discs = set.discs([Vec3::zeros(), Vec3::new(20.0, 20.0, 20.0)]);
            let (dip, scatter) = mean_dip(discs.iter().copied());
            assert!((dip[0] - 0.7).abs() < 0.02 && (dip[1] - 2.0).abs() < 0.03, "{dip:?}");
            assert!((scatter - 0.1).abs() < 0.01, "{scatter}");
        }
    }

    #[test]
    fn joints_may_begin_where_others_end() {
        let trace = |ends| Trace { ends, group: 0 };
        for turn in [1.57f64, 1.05, 0.785] {
            for seed in 1..5 {
                let mut mesh = plate(20, seed);
                let (y, x) = fractum_math::elementary::sin_cos(turn);
                let traces = [
                    trace([[-0.5, 0.5], [1.0, 0.5]]),
                    trace([[1.0, 0.5], [2.5, 0.5]]),
                    trace([[1.0, 0.5], [1.0 + 2.0 * x, 0.5 + 2.0 * y]]),
                ];
                let cutting = mesh.cut_traces(&traces, &[everywhere()], 0.25).unwrap();
                assert!(cutting.fates.iter().all(|fate| matches!(fate, Fate::Cut(_))), "{cutting:?}");
                assert!(worst(&mesh) > 0.25, "radius ratio {}", worst(&mesh));
                assert!(cutting.turn < 0.02, "{}", cutting.turn);
            }
        }
    }
}
