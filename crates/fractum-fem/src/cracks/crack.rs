//! Where cracks are, and how they lie.

use fractum_math::elementary::asin;
use fractum_math::{Sym3, Vec3};

use crate::body::edges::BodyEdges;
use crate::cells::cell::Geometry;
use crate::damage::edge::EdgeField;
use crate::fields::element_fields::cells_with;
use crate::motion::phase_damage::element_phase;
use crate::solid::Solid;

/// Damage of an edge beyond which an element that is gone was cut or crushed.
const CUT: f64 = 0.5;

/// How far the damage of a solid has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fracture {
    /// Edges with damage.
    pub damaged_edges: usize,
    /// Edges whose residual stress ratio has reached its limit.
    pub broken_edges: usize,
    /// Elements removed.
    pub removed_elements: usize,
}

/// An edge that a crack runs through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackEdge {
    /// Body it belongs to.
    pub body: usize,
    /// Its number there.
    pub edge: u32,
    /// Its middle without load [m].
    pub middle: Vec3,
    /// Its share of the crack, V/l with the volume V of the reference mesh and the characteristic length l [m²]; under a phase field 2 V (2 - d)/(π b).
    pub area: f64,
    /// What it adds to the area of crack [m²]: all of a crack through a bar counts as its cross-section. Area times the strength that is lost, which is the
    /// share of the fracture energy that is spent (exactly so under linear softening), since stiffness goes long before; under a phase field, whose band is
    /// wider, 2 V (2d - d²)/(π b).
    pub cracked: f64,
    /// Damage, 0 to 1.
    pub damage: f64,
    /// Part of the strength that is lost, 0 to 1; behind damage at first, as stiffness goes before strength. Under a phase field that which its own
    /// opening would take from a crack, so that the middle of the band stands out.
    pub softened: f64,
}

/// Centre and normal of the plane nearest to a crack; in the plane the line nearest to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackPlane {
    /// Centre of the crack [m].
    pub centre: Vec3,
    /// Unit normal, of either sign.
    pub normal: Vec3,
}

impl CrackPlane {
    /// The plane with the least sum of squared distances to weighted points; none if they are no plane, or no line in
    /// the plane.
    ///
    /// - `points`: place [m] and weight of each
    /// - `plane`: whether they lie in the xy-plane, where the normal lies too
    pub fn through(points: &[(Vec3, f64)], plane: bool) -> Option<CrackPlane> {
        let weight: f64 = points.iter().map(|p| p.1).sum();
        if weight.is_nan() || weight <= 0.0 {
            return None;
        }
        let centre = points.iter().map(|&(p, w)| p * w).sum::<Vec3>() / weight;
        let mut spread = Sym3::ZERO;
        for &(p, w) in points {
            let r = p - centre;
            spread += Sym3::symmetric_part(&(r * r.transpose())) * (w / weight);
        }
        if plane {
            // Never the least spread: the normal lies in the plane.
            spread.0[2] = 2.0 * spread.trace();
        }
        let (values, directions) = spread.eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let [least, next, most] = order.map(|i| values[i]);
        let flat = most > 0.0 && least < 0.5 * next;
        flat.then(|| CrackPlane { centre, normal: directions.column(order[0]).into() })
    }

    /// Angle between a unit direction and the plane [rad], 0 to π/2.
    pub fn angle_to(&self, direction: &Vec3) -> f64 {
        asin(self.normal.dot(direction).abs().min(1.0))
    }
}

/// Counts damaged and broken edges and removed elements.
pub fn fracture(solid: &Solid) -> Fracture {
    let mut count = Fracture::default();
    for edge in solid.damaged_fields().flat_map(|(_, field)| &field.state) {
        count.damaged_edges += usize::from(edge.damage > 0.0);
        count.broken_edges += usize::from(edge.broken);
    }
    count.removed_elements = removed_count(solid);
    count
}

/// Number of elements that have been removed so far.
pub fn removed_count(solid: &Solid) -> usize {
    solid.bodies.iter().map(|body| body.alive.iter().filter(|alive| !**alive).count()).sum()
}

/// All damaged edges, body by body in the order of their edges.
pub fn crack_edges(solid: &Solid) -> Vec<CrackEdge> {
    let fields: Vec<(usize, &EdgeField)> = solid.damaged_fields().collect();
    let mut found = Vec::new();
    for (body, model) in solid.bodies.iter().enumerate() {
        // Field and place of each edge; walking through them costs less than sorting those of the blocks.
        let count = model.edges.as_ref().map_or(0, BodyEdges::len);
        let mut places: Vec<Option<(u32, u32)>> = vec![None; count];
        for (index, (_, field)) in (0..).zip(&fields).filter(|(_, (of, _))| *of == body) {
            let damaged = (0..).zip(&field.state).filter(|(_, state)| state.damage > 0.0);
            damaged.for_each(|(at, _)| places[field.edges[at as usize] as usize] = Some((index, at)));
        }
        let edge = |(field, at): (u32, u32)| crack_edge(solid, body, fields[field as usize].1, at as usize);
        found.extend(places.into_iter().flatten().map(edge));
    }
    found
}

fn crack_edge(solid: &Solid, body: usize, field: &EdgeField, at: usize) -> CrackEdge {
    let (model, edge, state) = (&solid.bodies[body], field.edges[at], &field.state[at]);
    let volume = volume_of_edge(solid, body, edge);
    let (area, cracked, left) = match &model.phase {
        None => {
            let (area, left) = (volume / field.length[at], (1.0 - state.damage) * state.kappa / field.strength[at]);
            (area, area * (1.0 - left), left)
        }
        Some(phase) => {
            let cracked = volume * phase.area_density(edge as usize);
            (
                cracked / state.damage,
                cracked,
                field.softens.residual_ratio(state.kappa, field.strength[at], field.length[at]),
            )
        }
    };
    let ends = model.edges.iter().flat_map(|edges| edges.nodes(edge));
    CrackEdge {
        body,
        edge,
        middle: ends.map(|node| solid.reference[node as usize]).sum::<Vec3>() * 0.5,
        area,
        cracked,
        damage: state.damage,
        softened: 1.0 - left,
    }
}

/// Share of an edge in the volume of the elements around it, whether they are still there or not [m³].
pub(crate) fn volume_of_edge(solid: &Solid, body: usize, edge: u32) -> f64 {
    let model = &solid.bodies[body];
    let Some(edges) = &model.edges else { return 0.0 };
    let elements = edges.around(edge);
    // The cell of an edge that has lost no element knows its volume.
    if model.standard.is_none() && elements.iter().all(|&e| model.alive[e as usize]) {
        return match model.location.kept(edge) {
            Some(at) => {
                let (cells, cell) = cells_with(solid, at);
                cells.volume[cell]
            }
            None => model.cells(&solid.reference, &[edge]).volume[0],
        };
    }
    let share = 1.0 / model.body.shape.edge_count() as f64;
    elements.iter().map(|&e| share * solid.element_volume(body, e)).sum()
}

/// Energy that damage has taken in a body with a phase field over the fracture energy of its area of crack; none without one, or without a crack.
///
/// About 1 where cracks have opened, less before. The field is driven by the equivalent stress, so that a band that is sheared takes up to 2 (1 + ν) times the
/// fracture energy under Rankine's criterion.
pub fn cost_of_bands(solid: &Solid, body: usize) -> Option<f64> {
    let model = &solid.bodies[body];
    let (zone, _) = model.body.damage.as_ref().zip(model.phase.as_ref())?;
    let area = |edge: &CrackEdge| if edge.body == body { edge.cracked } else { 0.0 };
    let needed = zone.law.fracture_energy * crack_edges(solid).iter().map(area).sum::<f64>();
    let taken: f64 = solid.blocks.iter().filter(|block| block.body == body).map(|block| block.dissipated).sum();
    (needed > 0.0).then(|| taken / needed)
}

/// Share of the cracks of a body with a phase field that lies at nodes of other bodies, where its field ends; none without one, or without a crack.
pub fn share_at_borders(solid: &Solid, body: usize) -> Option<f64> {
    let model = &solid.bodies[body];
    let edges = model.edges.as_ref().filter(|_| model.phase.is_some())?;
    let mut shared = vec![false; solid.reference.len()];
    for (_, other) in solid.bodies.iter().enumerate().filter(|(index, _)| *index != body) {
        let corners = other.body.shape.node_count();
        other.body.elements.iter().flat_map(|nodes| &nodes[..corners]).for_each(|&node| shared[node as usize] = true);
    }
    let [mut whole, mut there] = [0.0; 2];
    for edge in crack_edges(solid).iter().filter(|edge| edge.body == body) {
        whole += edge.cracked;
        if edges.nodes(edge.edge).iter().any(|&node| shared[node as usize]) {
            there += edge.cracked;
        }
    }
    (whole > 0.0).then(|| there / whole)
}

/// Mean size of the elements along the cracks of a body with a phase field [m]; none without one, or without a crack.
pub fn size_along_cracks(solid: &Solid, body: usize) -> Option<f64> {
    let model = &solid.bodies[body];
    let cracked = element_phase(solid, body)?;
    let geometry = Geometry { body: &model.body, nodes: &solid.reference };
    let sizes = (0..).zip(solid.element_volumes(body)).zip(cracked).filter(|(_, phase)| *phase > 0.5);
    let sizes = sizes.map(|((element, &volume), _)| geometry.size(element, volume));
    let (sum, count) = sizes.fold((0.0, 0.0), |(sum, count), size| (sum + size, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Share of its volume that a body with a phase field has lost to its cracks, and the width π b of a band [m]; none without a phase field. Elements that were
/// taken out whole are no cracks.
pub fn lost_to_bands(solid: &Solid, body: usize) -> Option<(f64, f64)> {
    let model = &solid.bodies[body];
    let field = model.phase.as_ref()?;
    let edges = model.edges.as_ref()?;
    let is_damaged = |edge: &u32| solid.edge(body, *edge).is_some_and(|(field, at)| field.history(at).damage > CUT);
    let is_cut = |element| edges.of_element(element)[..model.body.shape.edge_count()].iter().any(is_damaged);
    let (mut whole, mut lost) = (0.0, 0.0);
    for ((element, volume), alive) in (0..).zip(solid.element_volumes(body)).zip(&model.alive) {
        whole += volume;
        lost += if *alive || !is_cut(element) { 0.0 } else { *volume };
    }
    Some((lost / whole, std::f64::consts::PI * field.law.length))
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic, Plane};
    use fractum_mesh::generate::structured_rectangle;

    use super::*;
    use crate::body::{Body, ElementKind, Regularisation};
    use crate::removal::take_out_body;

    fn at(x: f64, y: f64, z: f64) -> (Vec3, f64) {
        (Vec3::new(x, y, z), 1.0)
    }

    #[test]
    fn a_band_of_points_lies_at_the_angle_of_its_middle_line() {
        let (sin, cos) = 20f64.to_radians().sin_cos();
        let points: Vec<_> = (0..40)
            .map(|i| {
                let (along, across) = (0.05 * f64::from(i), 0.05 * f64::from(i % 3 - 1));
                at(1.0 + along * cos - across * sin, 2.0 + along * sin + across * cos, 0.0)
            })
            .collect();
        let line = CrackPlane::through(&points, true).unwrap();
        assert!((line.angle_to(&Vec3::x()).to_degrees() - 20.0).abs() < 0.5);
        assert!((line.angle_to(&Vec3::y()).to_degrees() - 70.0).abs() < 0.5);
        assert_eq!(line.normal.z, 0.0);
    }

    /// Energy over that of the area of a band across a plate, whose faces part by this vector as they reach ten times the strength.
    fn cost_of_a_band(part: Vec3) -> f64 {
        let mesh = structured_rectangle([6, 21], [0.06, 0.21], None);
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let law = DamageLaw::rankine(3e6, 100.0);
        let mut body = Body::new("plate", ElementKind::T3, elements, elastic).smoothed().with_damage(law);
        body.plane = Plane::Stress;
        body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
        let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
        let (dt, steps) = (1e-6, 200);
        for (v, p) in solid.velocity.iter_mut().zip(&solid.reference) {
            *v = if p.y > 0.105 { part * (10.0 * 3e6 * 0.01 / 30e9 / (f64::from(steps) * dt)) } else { Vec3::zeros() };
        }
        for _ in 0..steps {
            for (u, v) in solid.displacement.iter_mut().zip(&solid.velocity) {
                *u += v * dt;
            }
            solid.update_internal_forces(dt, false);
        }
        cost_of_bands(&solid, 0).unwrap()
    }

    /// Without lateral contraction both bands see the same equivalent stress, and store ½ τ²/G and ½ σ²/E under it.
    #[test]
    fn a_sheared_band_costs_more_than_one_that_opens() {
        let open = cost_of_a_band(Vec3::y());
        let sheared = cost_of_a_band(Vec3::x() * 2.0);
        assert!((sheared / open - 2.0).abs() < 1e-6, "{sheared} {open}");
        assert!(open > 0.5 && open < 1.15, "{open}");
    }

    #[test]
    fn a_body_that_is_taken_out_has_lost_nothing_to_cracks() {
        let mesh = structured_rectangle([3, 3], [0.03, 0.03], None);
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let law = DamageLaw::rankine(3e6, 100.0);
        let mut body = Body::new("core", ElementKind::T3, elements, elastic).smoothed().with_damage(law);
        body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
        let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
        take_out_body(&mut solid, 0.0, 0);
        assert_eq!(lost_to_bands(&solid, 0).unwrap().0, 0.0);
    }

    #[test]
    fn points_of_a_plane_in_space_give_its_normal() {
        let points: Vec<_> =
            (0..25).map(|i| (f64::from(i % 5), f64::from(i / 5))).map(|(x, y)| at(x, y, 0.5 * x)).collect();
        let plane = CrackPlane::through(&points, false).unwrap();
        assert!((plane.angle_to(&Vec3::z()) - 2f64.atan()).abs() < 1e-9);
        assert!(plane.angle_to(&Vec3::y()) < 1e-9);
    }

    #[test]
    fn points_without_direction_give_none() {
        let square = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(1.0, 1.0, 0.0)];
        assert_eq!(CrackPlane::through(&square, true), None);
        assert_eq!(CrackPlane::through(&square[..1], true), None);
        assert_eq!(CrackPlane::through(&[], true), None);
    }
}
