//! Slabs in two halves that an interface joins along y = 0, with elements of any size along each axis.

use fractum_fem::{Body, Elastic, ElementKind, Formulation, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::{CutAlong, Group, Mesh};
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{Control, LinearSolver, NoEquilibrium, StaticSettings};
use fractum_scene::{
    ContactParameters, InterfaceFace, InterfaceKind, InterfaceLaw, InterfaceSoftening, Interfaces, Loads, MixedMode,
    Motion, Scene, Support, Supports,
};
use fractum_tests::settings;

/// A joint that was never bonded.
pub(crate) const OPEN: InterfaceLaw = InterfaceLaw {
    tensile_strength: 0.0,
    cohesion: 0.0,
    opening_energy: 1.0,
    sliding_energy: 1.0,
    friction: 0.0,
    residual_friction: 0.0,
    dilation: 0.0,
    dilation_slip: f64::INFINITY,
    mixed_mode: MixedMode::Power(1.0),
    softening: InterfaceSoftening::Linear,
    roughness: None,
};

/// A slab by the coordinates of its nodes along each axis [m]; without those along z it is plane, 1 m thick.
#[derive(Clone)]
pub(crate) struct Slab {
    pub(crate) places: [Vec<f64>; 3],
    pub(crate) elastic: Elastic,
    pub(crate) formulation: Formulation,
}

/// Coordinates from 0 to `end`: steps of one size up to `even`, then growing by a ratio.
pub(crate) fn graded(size: f64, even: f64, end: f64, ratio: f64) -> Vec<f64> {
    let mut places = vec![0.0];
    let mut step = size;
    while let Some(&last) = places.last().filter(|last| **last < end * (1.0 - 1e-9)) {
        if last > even * (1.0 - 1e-9) {
            step *= ratio;
        }
        places.push(if last + 1.5 * step > end { end } else { last + step });
    }
    places
}

/// The same on both sides of 0.
pub(crate) fn mirrored(places: &[f64]) -> Vec<f64> {
    places.iter().skip(1).rev().map(|place| -place).chain(places.iter().copied()).collect()
}

impl Slab {
    /// Whether it is plane.
    pub(crate) fn is_plane(&self) -> bool {
        self.places[2].is_empty()
    }

    /// Its mesh, cut along y = 0.
    pub(crate) fn mesh(&self) -> Mesh {
        self.mesh_with(|_| true, |_| true)
    }

    /// The mesh of the elements that are kept, cut along y = 0 between those that are.
    ///
    /// - `keep`, `cut`: by the middle of an element
    pub(crate) fn mesh_with(&self, keep: impl Fn(&Vec3) -> bool, cut: impl Fn(&Vec3) -> bool) -> Mesh {
        let [x, y, z] = self.places.each_ref().map(|places| places.len().saturating_sub(1));
        let [nx, ny, nz] = [x, y, z].map(|count| count as u32);
        let mut mesh = if self.is_plane() {
            structured_rectangle([nx, ny], [x as f64, y as f64], None)
        } else {
            structured_box([nx, ny, nz], Vec3::new(x as f64, y as f64, z as f64), None)
        };
        let axes = if self.is_plane() { 2 } else { 3 };
        for node in &mut mesh.nodes {
            for axis in 0..axes {
                node[axis] = self.places[axis][node[axis].round() as usize];
            }
        }
        let middle = |mesh: &Mesh, e: &[u32]| e.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / e.len() as f64;
        let kept = Mesh {
            triangles: mesh.triangles.iter().filter(|e| axes == 2 && keep(&middle(&mesh, &e[..]))).copied().collect(),
            tetrahedra: mesh.tetrahedra.iter().filter(|e| keep(&middle(&mesh, &e[..]))).copied().collect(),
            nodes: mesh.nodes.clone(),
            ..Mesh::default()
        };
        let (left, all) = if axes == 2 {
            (kept.triangles.len(), mesh.triangles.len())
        } else {
            (kept.tetrahedra.len(), mesh.tetrahedra.len())
        };
        if left < all {
            mesh = kept;
            drop_unused_nodes(&mut mesh);
        }
        let elements: Vec<Vec<u32>> = match self.is_plane() {
            true => mesh.triangles.iter().map(|e| e.to_vec()).collect(),
            false => mesh.tetrahedra.iter().map(|e| e.to_vec()).collect(),
        };
        for (tag, name, low) in [(90, "low", true), (91, "high", false)] {
            let is_own = |e: &[u32]| {
                let middle = middle(&mesh, e);
                (middle.y < 0.0) == low && cut(&middle)
            };
            let own = (0u32..).zip(&elements).filter(|(_, e)| is_own(e)).map(|(number, _)| number);
            let mut group = Group { name: name.to_owned(), dimension: axes as u8, tag, ..Group::default() };
            *(if self.is_plane() { &mut group.triangles } else { &mut group.tetrahedra }) = own.collect();
            mesh.groups.push(group);
        }
        mesh.cut(&[CutAlong::Between(&["low".to_owned(), "high".to_owned()])]).unwrap();
        mesh
    }

    /// The solid of a mesh of this slab and its interfaces, the kind of each face by its centre.
    pub(crate) fn solid(
        &self,
        mesh: &Mesh,
        kinds: Vec<InterfaceKind>,
        kind_of: impl Fn(&Vec3) -> u32,
    ) -> (Solid, Interfaces) {
        let (kind, elements): (_, Vec<[u32; 4]>) = match self.is_plane() {
            true => (ElementKind::T3, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect()),
            false => (ElementKind::T4, mesh.tetrahedra.clone()),
        };
        let body = Body::new("slab", kind, elements, self.elastic);
        let body = Body { thickness: 1.0, formulation: self.formulation, ..body };
        let solid = Solid::new(mesh.nodes.clone(), vec![body]).unwrap();
        let face = |face: &fractum_mesh::CutFace| {
            let corners = face.sides[0].map(|node| solid.reference[node as usize]);
            let centre =
                if self.is_plane() { (corners[0] + corners[1]) / 2.0 } else { corners.iter().sum::<Vec3>() / 3.0 };
            InterfaceFace { kind: kind_of(&centre), sides: face.sides, elements: face.elements.map(|e| (0, e)) }
        };
        let faces = mesh.cuts.iter().map(face).collect();
        let interfaces = Interfaces::new(&solid, kinds, faces);
        (solid, interfaces)
    }

    /// Nodes of a mesh at some places.
    pub(crate) fn at(mesh: &Mesh, keep: impl Fn(&Vec3) -> bool) -> Vec<u32> {
        (0..mesh.nodes.len() as u32).filter(|&n| keep(&mesh.nodes[n as usize])).collect()
    }

    /// The scene: supports from the mesh, loads from mesh and solid, the kind of each face by its centre.
    pub(crate) fn scene(
        &self,
        end: f64,
        (kinds, kind_of): (Vec<InterfaceKind>, impl Fn(&Vec3) -> u32),
        supports: impl FnOnce(&Mesh) -> Vec<Support>,
        loads: impl FnOnce(&Mesh, &Solid) -> Loads,
    ) -> (Scene, Mesh) {
        let mesh = self.mesh();
        let (solid, interfaces) = self.solid(&mesh, kinds, kind_of);
        let supports = Supports::new(supports(&mesh), &solid.reference).unwrap();
        let loads = loads(&mesh, &solid);
        let debris = Debris::new(&solid, vec![ContactParameters::default()]);
        let scene = Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(end, 1e-2));
        (scene.with_interfaces(interfaces), mesh)
    }
}

fn drop_unused_nodes(mesh: &mut Mesh) {
    let mut number = vec![u32::MAX; mesh.nodes.len()];
    let elements = mesh.triangles.iter().flatten().chain(mesh.tetrahedra.iter().flatten());
    elements.for_each(|&node| number[node as usize] = 0);
    let mut nodes = Vec::new();
    for (node, number) in mesh.nodes.iter().zip(&mut number).filter(|(_, number)| **number == 0) {
        *number = nodes.len() as u32;
        nodes.push(*node);
    }
    mesh.nodes = nodes;
    let elements = mesh.triangles.iter_mut().flatten().chain(mesh.tetrahedra.iter_mut().flatten());
    elements.for_each(|node| *node = number[*node as usize]);
    mesh.number();
}

/// A support that holds nodes along an axis.
pub(crate) fn fixed(nodes: Vec<u32>, axis: usize) -> Support {
    Support::new("fixed", nodes, axis, Motion::Fixed)
}

/// Steps of equilibrium in time.
pub(crate) fn at_rest(step: f64, end: f64) -> StaticSettings {
    StaticSettings {
        control: Control::Time,
        step,
        turns: Vec::new(),
        end,
        most_steps: 1_000_000,
        tolerance: 1e-9,
        linear_tolerance: 1e-12,
        linear: LinearSolver::Direct,
        no_equilibrium: NoEquilibrium::Stop,
        damping: None,
    }
}
