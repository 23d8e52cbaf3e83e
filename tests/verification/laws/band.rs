//! A crack in one element that is torn and held sideways: softening, lateral restraint and the balance of energy together.

use fractum_fem::{Body, DamageLaw, Elastic, ElementKind, Formulation, Plane, Softening, Solid, fields};
use fractum_math::{Mat3, Vec3};

use super::draw::{Draw, Held, hold};

/// Corners of a regular tetrahedron, the first three of a regular triangle.
const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.866, 0.0], [0.5, 0.289, 0.816]];

/// An element with damage, and what its crack depends on.
struct Cell {
    solid: Solid,
    /// The first is across the crack.
    axes: Mat3,
    /// Modulus of the opening E' [Pa].
    modulus: f64,
    /// Lateral strain over that across the crack where nothing holds it.
    free: f64,
    in_plane: bool,
    strength: f64,
    length: f64,
    fracture_energy: f64,
}

impl Cell {
    /// An element of any kind, size and shape whose characteristic length lies in the allowed range.
    fn draw(draw: &mut Draw, curve: Softening) -> Cell {
        let (shape, plane) = draw.one_of(&[
            (ElementKind::T4, Plane::Strain),
            (ElementKind::T3, Plane::Strain),
            (ElementKind::T3, Plane::Stress),
        ]);
        let formulation = draw.one_of(&[Formulation::Standard, Formulation::Smoothed]);
        let in_plane = shape == ElementKind::T3;
        let young_modulus = draw.over_decades(1e8, 1e12);
        let elastic = Elastic { density: 2400.0, young_modulus, poisson_ratio: draw.between(0.0, 0.49) };
        let nu = elastic.poisson_ratio;
        let strength = young_modulus * draw.over_decades(1e-6, 1e-3);
        let axes = if in_plane { draw.turn_in_plane() } else { draw.turn() };
        let size = draw.over_decades(1e-4, 10.0);
        let corner = |corner: &[f64; 3]| {
            let moved = Vec3::from(*corner) + 0.15 * draw.vector();
            size * if in_plane { Vec3::new(moved.x, moved.y, 0.0) } else { moved }
        };
        let nodes: Vec<Vec3> = CORNERS[..shape.node_count()].iter().map(corner).collect();
        let element = if in_plane { [0, 1, 2, 2] } else { [0, 1, 2, 3] };
        let solid = |fracture_energy: f64| {
            let law = DamageLaw { softening: curve, residual: 0.0, ..DamageLaw::rankine(strength, fracture_energy) };
            let body = Body::new("cell", shape, vec![element], elastic).with_damage(law);
            Solid::new(nodes.clone(), vec![Body { formulation, plane, ..body }]).unwrap()
        };
        let is_plane_strain = in_plane && plane == Plane::Strain;
        let modulus = if is_plane_strain { young_modulus / (1.0 - nu * nu) } else { young_modulus };
        // The largest length is in proportion to the fracture energy.
        let much = 1e6 * strength * strength / young_modulus * size;
        let length = solid(much).length_report(0).largest_ratio * curve.largest_length(modulus, strength, much);
        let share = draw.between(0.001, 0.95);
        let fracture_energy = much * length / (share * curve.largest_length(modulus, strength, much));
        Cell {
            solid: solid(fracture_energy),
            axes,
            modulus,
            free: if is_plane_strain { -nu / (1.0 - nu) } else { -nu },
            in_plane,
            strength,
            length,
            fracture_energy,
        }
    }

    /// Moves to a strain across the crack and one sideways; the work of the forces on the way [J].
    fn strain(&mut self, across: f64, sideways: f64) -> f64 {
        let thick = if self.in_plane { 0.0 } else { sideways };
        let slope = self.axes * Mat3::from_diagonal(&Vec3::new(across, sideways, thick)) * self.axes.transpose();
        let force = self.solid.force.clone();
        for node in 0..self.solid.reference.len() {
            let displacement = slope * self.solid.reference[node];
            self.solid.velocity[node] = displacement - self.solid.displacement[node];
            self.solid.displacement[node] = displacement;
        }
        self.solid.update_internal_forces(1.0, true);
        let mean = force.iter().zip(&self.solid.force).map(|(before, now)| -0.5 * (before + now));
        mean.zip(&self.solid.velocity).map(|(force, moved)| force.dot(moved)).sum()
    }

    /// By how much an opening counts less whose lateral strain falls by `side` per strain across the crack: the root of what is left of the work.
    fn obliquity(&self, side: f64) -> f64 {
        let (held, fallen) =
            if self.in_plane { (-self.free, side) } else { (-self.free / (1.0 + self.free), 2.0 * side) };
        let left = (1.0 - 2.0 * held * fallen + fallen * fallen) / (1.0 - held * fallen);
        left.min(1.0).sqrt()
    }

    /// Stress across the crack [Pa].
    fn stress(&self) -> f64 {
        let normal = self.axes.column(0);
        normal.dot(&(fields::element_fields(&self.solid, 0, None)[0].0.to_matrix() * normal))
    }
}

/// Whatever holds a crack sideways, at its onset and later: the stress across it is that of its opening, what it takes is what the forces
/// do not give back, none of it returns, and no force or couple is left over.
pub(super) fn torn_and_held(draw: &mut Draw, curve: Softening) -> Held {
    let mut cell = Cell::draw(draw, curve);
    let (free, strength, modulus) = (cell.free, cell.strength, cell.modulus);
    // Lateral strain at onset between free contraction and half of the strain across, and the share of later contraction that is held.
    let (at_onset, held) = (free + draw.between(0.0, 1.0) * (0.5 - free), draw.between(0.0, 1.0));
    let openings = draw.over_decades(0.1, 20.0);
    let words = format!("{curve:?}, {:?}, lateral {at_onset:.3}, held {held:.3}", cell.solid.body(0));

    let mut work = cell.strain(1e-3 * strength / modulus, 1e-3 * at_onset * strength / modulus);
    let onset = 1e-3 * strength / modulus * strength / cell.stress() * (1.0 + 1e-9);
    work += cell.strain(onset, at_onset * onset);
    let steps = 40;
    let mut taken = cell.solid.dissipated_energy();
    for step in 1..=steps {
        let opening = openings * f64::from(step) / f64::from(steps);
        let more = opening * strength / modulus;
        work += cell.strain(onset + more, at_onset * onset + (1.0 - held) * free * more);
        let counted = strength * (1.0 + opening * cell.obliquity((held - 1.0) * free));
        let expected = strength * curve.residual_ratio(counted, strength, cell.length, modulus, cell.fracture_energy);
        let across = cell.stress();
        hold((across - expected).abs() < 1e-6 * strength, || {
            format!("{words}: {} of the strength at {opening}, {}", across / strength, expected / strength)
        })?;
        let now = cell.solid.dissipated_energy();
        hold(now >= taken - 1e-12 * work, || format!("{words}: {now} J taken after {taken} J"))?;
        taken = now;
        let balance = work - taken - cell.solid.elastic_energy();
        hold(balance.abs() < 1e-8 * work, || format!("{words}: {balance} J of {work} J are missing at {opening}"))?;
        let force = &cell.solid.force;
        let (sum, size) = (force.iter().sum::<Vec3>(), force.iter().map(Vec3::norm).sum::<f64>());
        let couple = cell.solid.reference.iter().zip(force).map(|(place, force)| place.cross(force)).sum::<Vec3>();
        let span = cell.solid.reference.iter().map(Vec3::norm).fold(0.0, f64::max);
        hold(sum.norm() <= 1e-12 * size && couple.norm() <= 1e-12 * size * span, || {
            format!("{words}: {sum} {couple}")
        })?;
    }
    cell.strain(0.0, 0.0);
    let (elastic, now) = (cell.solid.elastic_energy(), cell.solid.dissipated_energy());
    hold(now == taken && elastic == 0.0, || format!("{words}: {taken} J become {now} J, {elastic} J are stored"))
}
