//! Nodes doubled along faces inside of a mesh.

use std::collections::BTreeSet;

use fractum_math::Vec3;

use crate::mesh::{CutFace, Mesh};
use crate::topology::{
    NO_ELEMENT, TETRAHEDRON_FACETS, TRIANGLE_SIDES, elements_of_nodes, facets_of_tetrahedra, sides_of_triangles,
};

/// What to cut.
#[derive(Clone, Debug, PartialEq)]
pub enum CutAlong<'a> {
    /// The faces of a physical group: triangles between tetrahedra, or lines between triangles.
    Group(&'a str),
    /// The faces that two of these groups of elements have in common.
    Between(&'a [String]),
}

/// Why a mesh cannot be cut.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CutError {
    /// Nothing to cut.
    #[error("there are no {faces} in it")]
    NoFaces {
        /// Triangles or lines.
        faces: &'static str,
    },
    /// A face without elements on both sides.
    #[error("{count} of its {all} {faces} have no elements on both sides, such as that at ({:.4e}, {:.4e}, {:.4e}) m", at.x, at.y, at.z)]
    NotInside {
        /// How many such faces there are.
        count: usize,
        /// Of how many.
        all: usize,
        /// Triangles or lines.
        faces: &'static str,
        /// The middle of one.
        at: Vec3,
    },
    /// Groups that have no face in common.
    #[error("no two of these groups have {faces} in common")]
    NothingBetween {
        /// Triangles or lines.
        faces: &'static str,
    },
    /// A face that two cuts name.
    #[error("the face at ({:.4e}, {:.4e}, {:.4e}) m belongs to the cut before it too", at.x, at.y, at.z)]
    Twice {
        /// Its middle.
        at: Vec3,
    },
    /// Elements that overlap.
    #[error("more than two elements share a face")]
    Overlap,
}

impl Mesh {
    /// Doubles nodes along faces: every piece of elements around a node that the faces leave apart gets a node of its own, so that the tip of a cut
    /// keeps one node, its way has two, and a crossing of two cuts four. Groups go with the elements behind their faces, and a group of points or of
    /// edges in space has all copies.
    ///
    /// # Errors
    /// The number of the cut that is wrong, and why.
    pub fn cut(&mut self, cuts: &[CutAlong]) -> Result<(), (usize, CutError)> {
        if self.tetrahedra.is_empty() {
            let (triangles, lines) = (std::mem::take(&mut self.triangles), std::mem::take(&mut self.lines));
            let found = sides_of_triangles(&triangles).map_err(|_| (0, CutError::Overlap));
            let done = found.and_then(|sides| {
                let topology = Topology { facets: &sides.nodes, sides: &sides.elements, of: &sides.of_element };
                cut(self, cuts, triangles.clone(), lines.clone(), &topology, TRIANGLE_SIDES)
            });
            (self.triangles, self.lines) = (triangles, lines);
            let done = done?;
            (self.triangles, self.lines) = (done.elements, done.faces);
            add_copies(self, &done.copies, &[]);
        } else {
            let (tetrahedra, triangles) = (std::mem::take(&mut self.tetrahedra), std::mem::take(&mut self.triangles));
            let found = facets_of_tetrahedra(&tetrahedra).map_err(|_| (0, CutError::Overlap));
            let done = found.and_then(|facets| {
                let topology = Topology { facets: &facets.nodes, sides: &facets.elements, of: &facets.of_element };
                cut(self, cuts, tetrahedra.clone(), triangles.clone(), &topology, TETRAHEDRON_FACETS)
            });
            (self.tetrahedra, self.triangles) = (tetrahedra, triangles);
            let done = done?;
            let before = std::mem::replace(&mut self.tetrahedra, done.elements);
            self.triangles = done.faces;
            add_copies(self, &done.copies, &before);
        }
        Ok(())
    }
}

/// Of each facet, the cut that it belongs to and its first element.
type Marks = Vec<Option<(u32, u32)>>;

/// Facets of elements with N nodes, which have S.
struct Topology<'a, const N: usize, const S: usize> {
    facets: &'a [[u32; S]],
    sides: &'a [[u32; 2]],
    of: &'a [[u32; N]],
}

/// Elements and faces with their new nodes, and the copies of each doubled node.
struct Done<const N: usize, const S: usize> {
    elements: Vec<[u32; N]>,
    faces: Vec<[u32; S]>,
    copies: Vec<(u32, Vec<u32>)>,
}

impl<const N: usize, const S: usize> Topology<'_, N, S> {
    fn find(&self, mut nodes: [u32; S]) -> Option<usize> {
        nodes.sort_unstable();
        self.facets.binary_search(&nodes).ok()
    }

    /// Which cut each facet belongs to, and its first element.
    fn marked(&self, mesh: &Mesh, cuts: &[CutAlong], faces: &[[u32; S]]) -> Result<Marks, (usize, CutError)> {
        let words = if S == 3 { "triangles" } else { "lines" };
        let middle = |nodes: &[u32; S]| nodes.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / S as f64;
        let mut marked = vec![None; self.facets.len()];
        for (number, along) in cuts.iter().enumerate() {
            let fail = |error| Err((number, error));
            let found: Vec<(usize, u32)> = match along {
                CutAlong::Group(name) => {
                    let groups = mesh.groups.iter().filter(|group| group.name == *name);
                    let members = groups.flat_map(|group| if S == 3 { &group.triangles } else { &group.lines });
                    let members: BTreeSet<u32> = members.copied().collect();
                    if members.is_empty() {
                        return fail(CutError::NoFaces { faces: words });
                    }
                    let inner = |&face: &u32| {
                        let facet = self.find(faces[face as usize])?;
                        (self.sides[facet][1] != NO_ELEMENT).then(|| (facet, self.sides[facet][0]))
                    };
                    let outside: Vec<u32> = members.iter().copied().filter(|face| inner(face).is_none()).collect();
                    if let Some(&first) = outside.first() {
                        let (count, all, at) = (outside.len(), members.len(), middle(&faces[first as usize]));
                        return fail(CutError::NotInside { count, all, faces: words, at });
                    }
                    members.iter().filter_map(inner).collect()
                }
                CutAlong::Between(names) => {
                    let owner = self.owners(mesh, names);
                    let between = |facet: usize| {
                        let [a, b] = self.sides[facet];
                        let [first, second] = [owner[a as usize], *owner.get(b as usize)?];
                        let first_side = if first < second { a } else { b };
                        (first != second && first.max(second) != u32::MAX).then_some((facet, first_side))
                    };
                    let found: Vec<(usize, u32)> = (0..self.facets.len()).filter_map(between).collect();
                    if found.is_empty() {
                        return fail(CutError::NothingBetween { faces: words });
                    }
                    found
                }
            };
            for (facet, first) in found {
                if marked[facet].replace((number as u32, first)).is_some() {
                    return fail(CutError::Twice { at: middle(&self.facets[facet]) });
                }
            }
        }
        Ok(marked)
    }

    /// Which of some groups every element belongs to.
    fn owners(&self, mesh: &Mesh, names: &[String]) -> Vec<u32> {
        let mut owner = vec![u32::MAX; self.of.len()];
        for (number, name) in (0..).zip(names) {
            let groups = mesh.groups.iter().filter(|group| group.name == *name);
            let members = groups.flat_map(|group| if S == 3 { &group.tetrahedra } else { &group.triangles });
            members.for_each(|&element| owner[element as usize] = number);
        }
        owner
    }
}

fn cut<const N: usize, const S: usize>(
    mesh: &mut Mesh,
    cuts: &[CutAlong],
    mut elements: Vec<[u32; N]>,
    mut faces: Vec<[u32; S]>,
    topology: &Topology<N, S>,
    local: [[usize; S]; N],
) -> Result<Done<N, S>, (usize, CutError)> {
    let marked = topology.marked(mesh, cuts, &faces)?;
    let old = elements.clone();
    let of_nodes = elements_of_nodes(mesh.nodes.len(), &old);
    let mut on_cut: Vec<u32> =
        (0..marked.len()).filter(|&facet| marked[facet].is_some()).flat_map(|facet| topology.facets[facet]).collect();
    on_cut.sort_unstable();
    on_cut.dedup();
    let mut copies = Vec::new();
    let mut next_tag = mesh.node_tags.iter().max().map_or(1, |tag| tag + 1);
    for node in on_cut {
        let around = of_nodes.row(node as usize);
        let pieces = pieces(node, around, &old, topology, &marked);
        let count = pieces.iter().max().map_or(1, |last| last + 1);
        if count == 1 {
            continue;
        }
        let first = mesh.nodes.len() as u32;
        for _ in 1..count {
            mesh.nodes.push(mesh.nodes[node as usize]);
            mesh.node_tags.push(next_tag);
            next_tag += 1;
        }
        for (&element, &piece) in around.iter().zip(&pieces).filter(|(_, piece)| **piece > 0) {
            let corner = old[element as usize].iter().position(|&n| n == node).unwrap_or(0);
            elements[element as usize][corner] = first + piece as u32 - 1;
        }
        copies.push((node, (first..first + count as u32 - 1).collect()));
    }
    // Corners of a facet as an element has them now.
    let renumbered = |nodes: [u32; S], element: u32| {
        let of = old[element as usize];
        nodes.map(|node| of.iter().position(|&n| n == node).map_or(node, |corner| elements[element as usize][corner]))
    };
    for face in &mut faces {
        if let Some(facet) = topology.find(*face) {
            let element = marked[facet].map_or(topology.sides[facet][0], |(_, first)| first);
            *face = renumbered(*face, element);
        }
    }
    for (facet, mark) in marked.iter().enumerate() {
        let Some((cut, first)) = *mark else { continue };
        let [a, b] = topology.sides[facet];
        let second = if first == a { b } else { a };
        let side = topology.of[first as usize].iter().position(|&own| own as usize == facet).unwrap_or(0);
        let outward = local[side].map(|corner| old[first as usize][corner]);
        let repeated = |nodes: [u32; S]| [nodes[0], nodes[1], nodes[S - 1]];
        let sides = [first, second].map(|element| repeated(renumbered(outward, element)));
        mesh.cuts.push(CutFace { cut, sides, elements: [first, second] });
    }
    Ok(Done { elements, faces, copies })
}

/// The piece that each element around a node belongs to: pieces hang together by facets at the node that are not cut. Those that no cut touches stay
/// with the first.
fn pieces<const N: usize, const S: usize>(
    node: u32,
    around: &[u32],
    elements: &[[u32; N]],
    topology: &Topology<N, S>,
    marked: &[Option<(u32, u32)>],
) -> Vec<usize> {
    let mut piece: Vec<usize> = (0..around.len()).collect();
    fn root(piece: &[usize], mut at: usize) -> usize {
        while piece[at] != at {
            at = piece[at];
        }
        at
    }
    let mut touched = vec![false; around.len()];
    for (at, &element) in around.iter().enumerate() {
        for (opposite, &facet) in topology.of[element as usize].iter().enumerate() {
            if elements[element as usize][opposite] == node {
                continue;
            }
            if marked[facet as usize].is_some() {
                touched[at] = true;
                continue;
            }
            let [a, b] = topology.sides[facet as usize];
            let other = if a == element { b } else { a };
            if let Ok(other) = around.binary_search(&other) {
                let [low, high] = [root(&piece, at), root(&piece, other)];
                piece[low.max(high)] = low.min(high);
            }
        }
    }
    let roots: Vec<usize> = (0..around.len()).map(|at| root(&piece, at)).collect();
    let is_cut = |of: usize| roots.iter().zip(&touched).any(|(&root, &touched)| root == of && touched);
    let mut numbers: Vec<usize> = Vec::new();
    let first = roots.iter().copied().find(|&of| is_cut(of)).unwrap_or(0);
    numbers.push(first);
    roots
        .iter()
        .map(|&of| {
            if !is_cut(of) {
                return 0;
            }
            numbers.iter().position(|&known| known == of).unwrap_or_else(|| {
                numbers.push(of);
                numbers.len() - 1
            })
        })
        .collect()
}

/// Gives groups of points, and of edges in space, the copies of their nodes.
///
/// - `before`: tetrahedra with the nodes that they had
fn add_copies(mesh: &mut Mesh, copies: &[(u32, Vec<u32>)], before: &[[u32; 4]]) {
    let of = |node: u32| copies.binary_search_by_key(&node, |(node, _)| *node).ok().map(|at| &copies[at].1);
    let mut added: Vec<(u32, u32)> = Vec::new();
    for point in 0..mesh.points.len() {
        for &copy in of(mesh.points[point][0]).into_iter().flatten() {
            added.push((point as u32, mesh.points.len() as u32));
            mesh.points.push([copy]);
            mesh.point_tags.push(mesh.point_tags.iter().max().map_or(1, |tag| tag + 1));
        }
    }
    for group in &mut mesh.groups {
        let own = added.iter().filter(|(point, _)| group.points.binary_search(point).is_ok());
        let own: Vec<u32> = own.map(|(_, copy)| *copy).collect();
        group.points.extend(own);
    }
    if before.is_empty() || mesh.lines.is_empty() {
        return;
    }
    let of_nodes = elements_of_nodes(mesh.nodes.len(), before);
    let mut added: Vec<(u32, u32)> = Vec::new();
    for line in 0..mesh.lines.len() {
        let ends = mesh.lines[line];
        if ends.iter().all(|&end| of(end).is_none()) {
            continue;
        }
        let corner = |element: u32, node: u32| before[element as usize].iter().position(|&n| n == node);
        let pairs = of_nodes.row(ends[0] as usize).iter().filter_map(|&element| {
            let now = mesh.tetrahedra[element as usize];
            Some([now[corner(element, ends[0])?], now[corner(element, ends[1])?]])
        });
        let mut pairs: Vec<[u32; 2]> = pairs.collect::<BTreeSet<_>>().into_iter().collect();
        if pairs.is_empty() {
            continue;
        }
        mesh.lines[line] = pairs.remove(0);
        for pair in pairs {
            added.push((line as u32, mesh.lines.len() as u32));
            mesh.lines.push(pair);
            mesh.line_tags.push(mesh.line_tags.iter().max().map_or(1, |tag| tag + 1));
        }
    }
    for group in &mut mesh.groups {
        let own = added.iter().filter(|(line, _)| group.lines.binary_search(line).is_ok());
        let own: Vec<u32> = own.map(|(_, copy)| *copy).collect();
        group.lines.extend(own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Group;
    use crate::generate::{structured_box, structured_rectangle};

    /// A square of `n` cells with lines along some of its inner edges, as groups.
    fn square(n: u32, groups: &[&dyn Fn(Vec3) -> bool]) -> Mesh {
        let mut mesh = structured_rectangle([n, n], [1.0, 1.0], None);
        for (number, on) in groups.iter().enumerate() {
            let sides = sides_of_triangles(&mesh.triangles).unwrap();
            let first = mesh.lines.len() as u32;
            let own = |side: &&[u32; 2]| side.iter().all(|&n| on(mesh.nodes[n as usize]));
            let lines: Vec<[u32; 2]> = sides.nodes.iter().filter(own).copied().collect();
            let name = format!("joint{number}");
            let lines_of = (first..first + lines.len() as u32).collect();
            mesh.lines.extend(&lines);
            mesh.line_tags.extend((0..lines.len() as u64).map(|tag| 1000 + 100 * number as u64 + tag));
            mesh.groups.push(Group {
                name,
                dimension: 1,
                tag: 50 + number as i32,
                lines: lines_of,
                ..Group::default()
            });
        }
        mesh
    }

    fn copies_at(mesh: &Mesh, place: [f64; 2]) -> usize {
        mesh.nodes.iter().filter(|node| (**node - Vec3::new(place[0], place[1], 0.0)).norm() < 1e-9).count()
    }

    #[test]
    fn tips_have_one_node_ways_two_and_crossings_four() {
        let mut mesh = square(4, &[&|p| p.y == 0.5 && p.x <= 0.75, &|p| p.x == 0.5]);
        let boundary = crate::topology::boundary_of_triangles(&mesh.triangles).len();
        mesh.cut(&[CutAlong::Group("joint0"), CutAlong::Group("joint1")]).unwrap();
        assert_eq!(copies_at(&mesh, [0.75, 0.5]), 1, "the tip");
        assert_eq!(copies_at(&mesh, [0.25, 0.5]), 2);
        assert_eq!(copies_at(&mesh, [0.0, 0.5]), 2, "a free end");
        assert_eq!(copies_at(&mesh, [0.5, 0.5]), 4, "the crossing");
        assert_eq!(mesh.cuts.len(), 3 + 4);
        assert_eq!(crate::topology::boundary_of_triangles(&mesh.triangles).len(), boundary + 2 * 7);
        for face in &mesh.cuts {
            let [first, second] = face.sides.map(|side| side.map(|n| mesh.nodes[n as usize]));
            assert_eq!(first, second, "both sides lie in the same places");
            let [a, b] = face
                .elements
                .map(|e| mesh.triangles[e as usize].iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / 3.0);
            let normal = Vec3::new(first[1].y - first[0].y, first[0].x - first[1].x, 0.0);
            assert!(normal.dot(&(b - a)) > 0.0, "the normal points to the second side");
            for (side, element) in face.sides.iter().zip(face.elements) {
                assert!(side.iter().all(|n| mesh.triangles[element as usize].contains(n)));
            }
        }
        let mut tags = mesh.node_tags.clone();
        tags.sort_unstable();
        tags.dedup();
        assert_eq!(tags.len(), mesh.nodes.len());
        assert_eq!(mesh.group_nodes("x-").len(), 6, "both copies at the end belong to the side");
    }

    #[test]
    fn a_closed_cut_in_space_lets_a_piece_go() {
        let mut mesh = structured_box([3, 3, 3], Vec3::new(3.0, 3.0, 3.0), None);
        let inside = |p: Vec3| p.iter().all(|x| (1.0..=2.0).contains(x));
        let of = |e: &[u32; 4]| inside(e.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / 4.0);
        let (mut grain, mut rest) = (Vec::new(), Vec::new());
        for (number, element) in (0u32..).zip(&mesh.tetrahedra) {
            if of(element) { grain.push(number) } else { rest.push(number) }
        }
        let group = |name: &str, tag, tetrahedra| Group {
            name: name.into(),
            dimension: 3,
            tag,
            tetrahedra,
            ..Group::default()
        };
        mesh.groups.extend([group("grain", 90, grain), group("rest", 91, rest)]);
        let names = ["grain".to_owned(), "rest".to_owned()];
        mesh.cut(&[CutAlong::Between(&names)]).unwrap();
        assert_eq!((mesh.nodes.len(), mesh.cuts.len()), (64 + 8, 12));
        let common = mesh.group_nodes("grain").into_iter().filter(|n| mesh.group_nodes("rest").contains(n)).count();
        assert_eq!(common, 0);
        assert_eq!(mesh.cuts[0].sides[0].iter().filter(|n| mesh.group_nodes("grain").contains(n)).count(), 3);
    }

    #[test]
    fn what_is_no_inner_surface_is_refused() {
        let mut mesh = square(4, &[&|p| p.y == 0.5]);
        let before = mesh.clone();
        assert!(matches!(mesh.cut(&[CutAlong::Group("x-")]), Err((0, CutError::NotInside { count: 4, all: 4, .. }))));
        assert!(matches!(mesh.cut(&[CutAlong::Group("none")]), Err((0, CutError::NoFaces { faces: "lines" }))));
        let twice = [CutAlong::Group("joint0"), CutAlong::Group("joint0")];
        assert!(matches!(mesh.cut(&twice), Err((1, CutError::Twice { .. }))));
        let names = ["body".to_owned(), "other".to_owned()];
        assert!(matches!(mesh.cut(&[CutAlong::Between(&names)]), Err((0, CutError::NothingBetween { .. }))));
        assert_eq!(mesh, before);
    }
}
