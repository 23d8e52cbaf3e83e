//! Supports and loads on the groups of the mesh.

use std::collections::HashMap;
use std::sync::Arc;

use fractum_fem::{Depth, Depths, Solid, depths_of, facet_area};
use fractum_math::Vec3;
use fractum_mesh::quality::{area_vector, signed_volume};
use fractum_scene::{Bonded, CrackPressure, Gravity, Load, Motion, NodalForce, Pressure, Support};

use super::bodies::Numbering;
use super::{Context, function, use_in_words};
use crate::model::{self, Components, Detonation, GroupUse, InCracks, LoadKind, Selection};
use crate::{Spanned, TimeFunction};

impl Context<'_> {
    pub(super) fn supports(&mut self, numbering: &Numbering) -> Vec<Support> {
        let case = self.case;
        let mut supports = Vec::new();
        for support in &case.supports {
            if self.names_particles(&support.on) {
                continue;
            }
            if let Some(axes) = &support.fix_rotation {
                self.error(&axes.place, ": nodes have no rotation", "a set of particles; remove the key");
            }
            let nodes = self.selected_nodes(&support.on, numbering);
            for (axis, motion) in support.motion.iter().enumerate() {
                let Some(motion) = motion else { continue };
                supports.push(Support::new(support.label(), nodes.clone(), axis, motion_of(&motion.value)));
            }
        }
        supports
    }

    /// The loads on nodes, or on particles.
    pub(super) fn loads(&mut self, points: &LoadedPoints) -> Vec<Load> {
        let (case, of_particles) = (self.case, matches!(points, LoadedPoints::Particles(_)));
        let mut loads = Vec::new();
        for load in &case.loads {
            if load.kind.on().is_some_and(|(on, _)| self.names_particles(on) != of_particles) {
                continue;
            }
            match (&load.kind, points) {
                (LoadKind::Force { on, force }, _) => push_nodal(&mut loads, &self.shares(on, points), force),
                (LoadKind::Gravity { acceleration }, _) => {
                    for (axis, value) in acceleration.iter().enumerate() {
                        let Some(value) = value else { continue };
                        loads.push(Load::Gravity(Gravity { axis, value: function(&value.value) }));
                    }
                }
                (LoadKind::Traction { on, traction }, LoadedPoints::Nodes(numbering, surface)) => {
                    let facets = self.selected_facets(on, numbering, surface);
                    push_nodal(&mut loads, &surface.areas(&facets), traction);
                }
                (
                    LoadKind::Pressure { on, pressure, in_cracks, detonation },
                    LoadedPoints::Nodes(numbering, surface),
                ) => {
                    let facets = self.selected_facets(on, numbering, surface);
                    let value = match detonation {
                        None => function(&pressure.value),
                        Some(front) => behind_front(&pressure.value, *front, facets.iter().flatten(), numbering),
                    };
                    loads.push(match in_cracks {
                        None => Load::Pressure(Pressure { facets, value }),
                        Some(InCracks { front_speed }) => {
                            self.refuse_partial_mouth(on, &facets, &loads);
                            Load::CrackPressure(CrackPressure::new(facets, value, *front_speed))
                        }
                    });
                }
                (LoadKind::Traction { on, traction }, LoadedPoints::Particles(bonded)) => {
                    let shown = self.shown_areas(on, bonded);
                    let shares: Vec<(u32, f64)> = shown.iter().map(|own| (own.particle, own.size)).collect();
                    push_nodal(&mut loads, &shares, traction);
                }
                (LoadKind::Pressure { on, pressure, .. }, LoadedPoints::Particles(bonded)) => {
                    let shown = self.shown_areas(on, bonded);
                    for axis in 0..3 {
                        let points = shown.iter().map(|own| (own.particle, -own.vector[axis])).collect();
                        loads.push(Load::Nodal(NodalForce { points, axis, value: function(&pressure.value) }));
                    }
                }
            }
        }
        loads
    }

    /// Cracks are entered from groups of facets that are the same or have no facet in common.
    fn refuse_partial_mouth(&mut self, on: &Selection, facets: &[[u32; 3]], loads: &[Load]) {
        let others = loads.iter().filter_map(|load| match load {
            Load::CrackPressure(load) if load.facets != facets => Some(&load.facets),
            _ => None,
        });
        let shared = others.flatten().find(|facet| facets.contains(facet));
        if let (Some(_), Some(place)) = (shared, on.place()) {
            let found = format!("= \"{}\": shares facets with another load that enters cracks", on.label());
            self.error(&place.clone(), found, "the same facets, or none in common");
        }
    }

    /// Shares of a total force: by area where facets or particles are meant, by what belongs to each node where elements or lines within are, else equal.
    pub(super) fn shares(&mut self, on: &Selection, points: &LoadedPoints) -> Vec<(u32, f64)> {
        let areas = match (points, &on.group) {
            (LoadedPoints::Nodes(numbering, surface), _) => surface.areas(&self.facets(on, numbering, surface)),
            (LoadedPoints::Particles(bonded), Some(group)) => {
                let particles = self.selected_particles(on, group, bonded);
                particles.into_iter().map(|i| (i, bonded.particles.radius[i as usize].powi(2))).collect()
            }
            (LoadedPoints::Particles(_), None) => Vec::new(),
        };
        let total: f64 = areas.iter().map(|(_, area)| area).sum();
        match points {
            LoadedPoints::Nodes(numbering, surface) if total <= 0.0 => {
                let nodes = self.selected_nodes(on, numbering);
                self.refuse_divided_volume(on);
                let measures =
                    on.group.as_ref().map_or_else(HashMap::new, |group| self.measures(group, numbering, surface));
                let measure = |node: &u32| measures.get(node).copied().unwrap_or_default();
                let total: f64 = nodes.iter().map(measure).sum();
                let equal = 1.0 / nodes.len().max(1) as f64;
                let share = |node| if total > 0.0 { measure(&node) / total } else { equal };
                nodes.into_iter().map(|node| (node, share(node))).collect()
            }
            _ => areas.into_iter().map(|(point, area)| (point, area / total)).collect(),
        }
    }

    /// Each process of a mesh in parts knows a part of the volume of a group.
    fn refuse_divided_volume(&mut self, on: &Selection) {
        let Some(group) = on.group.as_ref().filter(|_| self.division.is_some()) else { return };
        if self.mesh.group_tetrahedra(&group.value) > 0 {
            let found = format!(
                "= \"{}\": elements share a total by their volume, which no process of a divided mesh knows",
                group.value
            );
            self.error(&group.place, found, "a group of facets, or gravity");
        }
    }

    /// What belongs to each node of a group in the file: volume of elements, or area of facets, or length of lines in space; none of points.
    fn measures(&self, group: &Spanned<String>, numbering: &Numbering, surface: &Surface) -> HashMap<u32, f64> {
        let (mesh, groups) = (self.mesh, self.mesh.group(&group.value));
        let mut measures = Measures { numbering, depths: surface.depths.as_ref(), of_nodes: HashMap::new() };
        let places = |node: u32| mesh.nodes[node as usize];
        for corners in groups.iter().flat_map(|group| &group.tetrahedra).map(|&t| mesh.tetrahedra[t as usize]) {
            measures.give(corners, corners.map(places), signed_volume(corners.map(places)).abs());
        }
        if measures.of_nodes.is_empty() {
            for corners in groups.iter().flat_map(|group| &group.triangles).map(|&t| mesh.triangles[t as usize]) {
                measures.give(corners, corners.map(places), area_vector(corners.map(places)).norm());
            }
        }
        if measures.of_nodes.is_empty() {
            for ends in groups.iter().flat_map(|group| &group.lines).map(|&line| mesh.lines[line as usize]) {
                let [a, b] = ends.map(places);
                measures.give(ends, [a, b], (b - a).norm());
            }
        }
        measures.of_nodes
    }

    /// Outward facets that are meant; an error if there are none on the surface.
    pub(super) fn selected_facets(
        &mut self,
        on: &Selection,
        numbering: &Numbering,
        surface: &Surface,
    ) -> Vec<[u32; 3]> {
        let facets = self.facets(on, numbering, surface);
        if let (true, Some(place)) = (facets.is_empty(), on.place()) {
            let found = on.group.as_ref().map_or_else(|| "holds for no facet".into(), |g| format!("= \"{}\"", g.value));
            self.error(&place.clone(), found, use_in_words(GroupUse::Facets));
        }
        facets
    }

    /// Outward facets of a group, or all without one, of which all nodes fulfil the condition.
    pub(super) fn facets(&self, on: &Selection, numbering: &Numbering, surface: &Surface) -> Vec<[u32; 3]> {
        let mut facets = match &on.group {
            Some(group) => self.facets_in_file(group, numbering, surface),
            None => surface.facets.to_vec(),
        };
        if let Some(within) = &on.within {
            let inside = |&n: &u32| within.value.holds_at(numbering.positions[n as usize]);
            facets.retain(|facet| facet.iter().all(inside));
        }
        facets
    }

    fn facets_in_file(&self, group: &Spanned<String>, numbering: &Numbering, surface: &Surface) -> Vec<[u32; 3]> {
        let scene = |n: u32| numbering.scene_node[n as usize];
        let mut facets = Vec::new();
        for group in self.mesh.group(&group.value) {
            if surface.depths.is_some() {
                let lines = group.lines.iter().map(|&l| self.mesh.lines[l as usize].map(scene));
                facets.extend(lines.filter_map(|[a, b]| surface.outward([a, b, b])));
            } else {
                let triangles = group.triangles.iter().map(|&t| self.mesh.triangles[t as usize].map(scene));
                facets.extend(triangles.filter_map(|t| surface.outward(t)));
            }
        }
        facets
    }
}

/// How a support moves, as the scene takes it.
pub(super) fn motion_of(motion: &model::Motion) -> Motion {
    match motion {
        model::Motion::Fixed => Motion::Fixed,
        model::Motion::Velocity(v) => Motion::Velocity(function(v)),
        model::Motion::Displacement(u) => Motion::Displacement(function(u)),
    }
}

fn push_nodal(loads: &mut Vec<Load>, points: &[(u32, f64)], components: &Components) {
    for (axis, value) in components.iter().enumerate() {
        if let Some(value) = value {
            loads.push(Load::Nodal(NodalForce { points: points.to_vec(), axis, value: function(&value.value) }));
        }
    }
}

/// The points that loads act on.
pub(super) enum LoadedPoints<'a> {
    /// Nodes of solids, with their surface.
    Nodes(&'a Numbering, &'a Surface<'a>),
    /// Particles.
    Particles(&'a Bonded),
}

/// What belongs to the nodes of a group.
struct Measures<'a> {
    numbering: &'a Numbering,
    depths: Option<&'a Depths>,
    of_nodes: HashMap<u32, f64>,
}

impl Measures<'_> {
    /// Gives the corners of an element their shares of its measure.
    fn give<const N: usize>(&mut self, corners: [u32; N], places: [Vec3; N], measure: f64) {
        let nodes = corners.map(|node| self.numbering.scene_node[node as usize]);
        let depth = self.depths.map_or(Depth::Thickness(1.0), |depths| depths.at(&nodes));
        let middle = places.iter().sum::<Vec3>() / N as f64;
        for (node, share) in nodes.into_iter().zip(depth.shares(places.each_ref())) {
            *self.of_nodes.entry(node).or_default() += measure * depth.at(&middle) * share;
        }
    }
}

/// The surface of the solids, searchable by the nodes of a facet.
pub(super) struct Surface<'a> {
    pub(super) facets: &'a [[u32; 3]],
    by_nodes: HashMap<[u32; 3], [u32; 3]>,
    /// Depths of plane bodies; none in space.
    depths: Option<Depths>,
    positions: &'a [Vec3],
}

impl<'a> Surface<'a> {
    pub(super) fn new(boundary: &'a [[u32; 3]], solid: &Solid, positions: &'a [Vec3]) -> Self {
        let by_nodes = boundary.iter().map(|&facet| (sorted(facet), facet)).collect();
        Surface { facets: boundary, by_nodes, depths: depths_of(solid).cloned(), positions }
    }

    /// Outward normal of a facet without load, as long as its area [m²]: around an axis that of the whole turn.
    pub(super) fn area_vector(&self, facet: &[u32; 3]) -> Vec3 {
        let corners = facet.map(|n| self.positions[n as usize]);
        facet_area(corners, self.depth_of(facet))
    }

    /// Depth behind a facet of the surface; none in space.
    fn depth_of(&self, &[a, b, _]: &[u32; 3]) -> Option<Depth> {
        self.depths.as_ref().map(|depths| depths.at(&[a, b]))
    }

    /// Middle of a facet without load [m].
    pub(super) fn middle(&self, facet: &[u32; 3]) -> Vec3 {
        let corners = self.corners(facet);
        corners.iter().map(|&n| self.positions[n as usize]).sum::<Vec3>() / corners.len() as f64
    }

    /// Nodes of a facet, each once.
    pub(super) fn corners<'f>(&self, facet: &'f [u32; 3]) -> &'f [u32] {
        &facet[..if self.depths.is_some() { 2 } else { 3 }]
    }

    /// The facet with these nodes, oriented outwards.
    pub(super) fn outward(&self, nodes: [u32; 3]) -> Option<[u32; 3]> {
        self.by_nodes.get(&sorted(nodes)).copied()
    }

    /// Area that belongs to each node of the facets [m²], ascending by node.
    pub(super) fn areas(&self, facets: &[[u32; 3]]) -> Vec<(u32, f64)> {
        let mut shares: Vec<(u32, f64)> = Vec::new();
        for facet in facets {
            let (corners, area) = (self.corners(facet), self.area_vector(facet).norm());
            if self.depth_of(facet) == Some(Depth::Turn) {
                let ends = [0, 1].map(|end| &self.positions[facet[end] as usize]);
                shares.extend(corners.iter().zip(Depth::Turn.shares(ends)).map(|(&node, share)| (node, share * area)));
                continue;
            }
            let share = area / corners.len() as f64;
            shares.extend(corners.iter().map(|&node| (node, share)));
        }
        shares.sort_by_key(|s| s.0);
        let mut merged: Vec<(u32, f64)> = Vec::new();
        for (node, area) in shares {
            match merged.last_mut() {
                Some(last) if last.0 == node => last.1 += area,
                _ => merged.push((node, area)),
            }
        }
        merged
    }
}

/// A pressure behind a front; ahead of it there is none.
fn behind_front<'a>(
    pressure: &TimeFunction,
    front: Detonation,
    nodes: impl Iterator<Item = &'a u32>,
    numbering: &Numbering,
) -> fractum_scene::TimeFunction {
    let first = front.first(nodes.map(|&node| numbering.positions[node as usize]));
    let (pressure, begin) = (pressure.clone(), pressure.delay().unwrap_or(0.0));
    Arc::new(move |time, place: &Vec3| {
        let after = time - front.arrival(place, first);
        if after < begin { 0.0 } else { pressure.value(after, *place) }
    })
}

/// The nodes of a facet whatever its direction; an edge, in whatever order, repeats its higher node.
pub(super) fn sorted(mut nodes: [u32; 3]) -> [u32; 3] {
    let edge = nodes[1] == nodes[2];
    nodes.sort_unstable();
    if edge { [nodes[0], nodes[2], nodes[2]] } else { nodes }
}
