//! Bodies that have small strains until they turn.

use fractum_math::{Mat3, Vec3};
use rayon::prelude::*;

use crate::body::{Body, Kinematics};
use crate::cells::kernel::total_strain;
use crate::damage::edges_in_step::Advance;
use crate::element::CARRIES;
use crate::motion::subcycled_solid::own_step;
use crate::solid::Solid;
use crate::solid::body_model::BodyModel;
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::subcycling::forget_ahead;

/// Steps between two looks, and the number of looks in which every cell is seen once.
const STEPS_BETWEEN_LOOKS: u64 = 16;
const LOOKS: u64 = 8;
/// Rotation [rad] from which a body counts as turning, of elastic bodies and of those that can be damaged: small strains then are off by 2e-6 and
/// 8e-6. The false strain has been relaxed when the body begins to turn, and comes back as energy that nothing put in: at 0.01 rad that was 5 %
/// of a glass bar that fell on another at 2 m/s. It grows with the fourth power of the angle.
const TURNED: [f64; 2] = [0.002, 0.004];
/// Part of the strength to which the false strain of a rotation may load a body that can be damaged.
const FALSE_LOAD: f64 = 0.1;

impl Body {
    /// Rotation [rad] beyond which [`Kinematics::Auto`] turns: the false strain ½ θ² of small strains is at most 2e-6, or, where the body may be
    /// damaged, 8e-6 and a tenth of the strain at the tensile strength.
    pub(crate) fn least_turn(&self) -> f64 {
        let [elastic, damaged] = TURNED;
        self.damage.as_ref().map_or(elastic, |zone| {
            damaged.min((2.0 * FALSE_LOAD * zone.law.tensile_strength / self.elastic.young_modulus).sqrt())
        })
    }
}

/// Sine of the angle by which a displacement gradient turns, for angles that are not large.
#[inline(always)]
pub(crate) fn turn(h: &Mat3) -> f64 {
    let turn = Vec3::new(h[(2, 1)] - h[(1, 2)], h[(0, 2)] - h[(2, 0)], h[(1, 0)] - h[(0, 1)]);
    0.5 * turn.norm()
}

/// Has those bodies of [`Kinematics::Auto`] that have begun to turn be corotational from now on. All ranks must call it after each step.
///
/// - `step`: number of the step; cells are looked at now and then, an eighth of them at a time
/// - `dt`: time since the forces were last computed, in which the nodes moved with their present velocities [s]
/// - `turning`: gets the bodies that turn from now on
/// - returns the elastic energy that small strains had found in them beyond that of corotational ones [J]
pub fn let_turn(solid: &mut Solid, step: u64, dt: f64, turning: &mut Vec<u32>) -> f64 {
    let is_auto = |model: &BodyModel| model.body.kinematics == Kinematics::Auto;
    if !step.is_multiple_of(STEPS_BETWEEN_LOOKS) || !solid.bodies.iter().any(is_auto) {
        return 0.0;
    }
    let first = (step / STEPS_BETWEEN_LOOKS % LOOKS) as usize;
    let own = &solid.blocks[solid.own_blocks()];
    let turns = |block: &&Block| turns(solid, block, first, STEPS_BETWEEN_LOOKS as f64 * dt);
    // Nothing is allocated while no body turns.
    let mut found = Vec::new();
    if own.par_iter().any(|block| turns(&block)) {
        found = own.par_iter().filter(turns).map(|block| block.body as u32).collect();
        found.dedup();
    }
    become_corotational(solid, found, dt, turning)
}

/// Has those bodies of [`Kinematics::Auto`] that spin when motion begins be corotational at once: their small strains would relax a false strain
/// until they turn, and give it back as energy. All ranks must call it after the first step.
///
/// - `time`: duration of the run, in which a block of cells that goes on as on the mean turns by more than small strains stand [s]
/// - `dt`, `turning`, returns: as in [`let_turn`]
pub fn let_spin(solid: &mut Solid, time: f64, dt: f64, turning: &mut Vec<u32>) -> f64 {
    let own = &solid.blocks[solid.own_blocks()];
    let mut spinning: Vec<u32> =
        own.par_iter().filter(|block| spins(solid, block, time)).map(|block| block.body as u32).collect();
    spinning.dedup();
    become_corotational(solid, spinning, dt, turning)
}

/// Whether the cells of a block turn on the mean, by more than small strains stand in a time [s].
fn spins(solid: &Solid, block: &Block, time: f64) -> bool {
    let body = &solid.bodies[block.body].body;
    if body.kinematics != Kinematics::Auto {
        return false;
    }
    let (mut sum, mut volume) = (Mat3::zeros(), 0.0);
    for cell in 0..block.cells.len() {
        sum += block.cells.gradient(cell, |node| solid.velocity[node]) * block.cells.volume[cell];
        volume += block.cells.volume[cell];
    }
    volume > 0.0 && turn(&sum) * time > body.least_turn() * volume
}

/// Has bodies that were found by one rank or another be corotational from now on.
fn become_corotational(solid: &mut Solid, found: Vec<u32>, dt: f64, turning: &mut Vec<u32>) -> f64 {
    let mut found = solid.neighbours.gather_names(found);
    if found.is_empty() {
        return 0.0;
    }
    found.sort_unstable();
    found.dedup();
    let before = energy_in_step(solid, &found, dt);
    forget_ahead(solid);
    for &body in &found {
        solid.bodies[body as usize].body.kinematics = Kinematics::Corotational;
        turn_births(solid, body as usize);
    }
    see_strains_before(solid, &found, dt);
    solid.neighbours.expect_events();
    let after = energy_in_step(solid, &found, dt);
    turning.extend(found);
    before - after
}

/// Has the strains at which the cells of a body are free of stress be those of corotational strains: what they had turned by then is no stress.
fn turn_births(solid: &mut Solid, body: usize) {
    let Solid { blocks, displacement, .. } = solid;
    for Block { cells, .. } in blocks.iter_mut().filter(|block| block.body == body) {
        let Some(mut born) = cells.born.take() else { continue };
        for (cell, born) in born.iter_mut().enumerate() {
            let strain = |kinematics| total_strain(cells, cell, displacement, kinematics);
            *born += strain(Kinematics::Corotational) - strain(Kinematics::Small);
        }
        cells.born = Some(born);
    }
}

/// Whether a cell of a block, one of eight, will have turned after a time [s] if its nodes go on as they do.
fn turns(solid: &Solid, block: &Block, first: usize, ahead: f64) -> bool {
    let body = &solid.bodies[block.body].body;
    if body.kinematics != Kinematics::Auto {
        return false;
    }
    let least = body.least_turn();
    let then = |node: usize| solid.displacement[node] + solid.velocity[node] * ahead;
    (first..block.cells.len()).step_by(LOOKS as usize).any(|cell| {
        let carries = block.cells.volume[cell] > 0.0 && block.damage_of(cell) <= CARRIES;
        carries && turn(&block.cells.gradient(cell, then)) > least
    })
}

/// Keeps the strains of the step before, from which damage finds what it dissipates, as the present kinematics see them.
fn see_strains_before(solid: &mut Solid, bodies: &[u32], dt: f64) {
    let own = solid.own_blocks();
    let steps: Vec<f64> = solid.blocks.iter().map(|block| own_step(solid, block, dt)).collect();
    let Solid { blocks, bodies: models, displacement, velocity, .. } = solid;
    let (displacement, velocity) = (&displacement[..], &velocity[..]);
    let blocks = blocks[own.clone()].par_iter_mut().zip(&steps[own]);
    blocks.filter(|(block, _)| bodies.contains(&(block.body as u32))).for_each(|(block, &dt)| {
        let model = &models[block.body];
        let step = Advance { displacement, velocity, dt, kinematics: model.body.kinematics };
        let Block { cells, law, .. } = block;
        match law {
            // Cracks that rub keep no strain.
            BlockLaw::Edges(field) if field.softens.friction.is_none() => {
                let damaged = field.state.iter_mut().enumerate().filter(|(_, edge)| edge.damage > 0.0);
                damaged.for_each(|(cell, edge)| edge.strain = step.strain_before(cells, cell));
            }
            BlockLaw::Standard(law) => {
                (0..cells.len())
                    .for_each(|cell| law.stress[cell] = model.elasticity.stress(step.strain_before(cells, cell)));
            }
            _ => {}
        }
    });
}

/// Elastic energy of bodies as a step measures it, ½ σ : ε⁰ with the strain of the step before [J]; the same for all processes.
fn energy_in_step(solid: &Solid, bodies: &[u32], dt: f64) -> f64 {
    let of = |block: &Block| -> f64 {
        let model = &solid.bodies[block.body];
        let (displacement, velocity, dt) = (&solid.displacement, &solid.velocity, own_step(solid, block, dt));
        let step = Advance { displacement, velocity, dt, kinematics: model.body.kinematics };
        let cells = (0..block.cells.len()).filter(|&cell| block.cells.volume[cell] > 0.0);
        let energy = cells.map(|cell| {
            let strains = [step.strain_before(&block.cells, cell), step.strain_now(&block.cells, cell)];
            block.energy_between(cell, &model.elasticity, strains)
        });
        energy.sum()
    };
    let own = solid.blocks[solid.own_blocks()].par_iter();
    let own: Vec<f64> = own.filter(|block| bodies.contains(&(block.body as u32))).map(of).collect();
    // In the order of the blocks, whoever has them.
    solid.neighbours.gather_blocks(own).into_iter().sum()
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::Elastic;

    use super::*;
    use crate::body::ElementKind;
    use crate::removal::{put_in_body, take_out_body};

    /// A square that comes in where its nodes have turned has no stress, before it turns and after; strained then, it has the energy of that strain.
    #[test]
    fn what_a_body_had_turned_as_it_came_in_is_no_stress() {
        for (angle, poisson_ratio, size) in [(0.3f64, 0.0, 1e-3), (-0.1, 0.45, 1.0), (1.0, 0.2, 1e3)] {
            let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio };
            let nodes = [[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]].map(|[x, y]| Vec3::new(x, y, 0.0));
            for smoothed in [false, true] {
                let body = Body::new("square", ElementKind::T3, vec![[0, 1, 2, 2], [0, 2, 3, 3]], elastic);
                let body = if smoothed { body.smoothed() } else { body };
                let body = Body { kinematics: Kinematics::Auto, ..body };
                let mut solid = Solid::new(nodes.to_vec(), vec![body]).unwrap();
                take_out_body(&mut solid, 0.0, 0);
                let (sine, cosine) = angle.sin_cos();
                let turn = Mat3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
                let place = |solid: &mut Solid, stretch: f64| {
                    for (displacement, at) in solid.displacement.iter_mut().zip(&nodes) {
                        *displacement = turn * Vec3::new(at.x * (1.0 + stretch), at.y, 0.0) - at;
                    }
                };
                place(&mut solid, 0.0);
                put_in_body(&mut solid, 0);
                let mut turning = Vec::new();
                let booked = let_turn(&mut solid, 0, 0.0, &mut turning);
                assert_eq!(turning, [0]);
                solid.update_internal_forces(0.0, true);
                let scale = 30e9 * size * size;
                let found = [booked, solid.elastic_energy()];
                assert!(found.iter().all(|energy| energy.abs() < 1e-20 * scale), "{angle} {smoothed}: {found:?}");
                let stretch = 1e-3;
                place(&mut solid, stretch);
                solid.update_internal_forces(0.0, true);
                let lame = poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio));
                let exact = 0.5 * (lame + 1.0 / (1.0 + poisson_ratio)) * stretch * stretch * scale;
                let found = solid.elastic_energy();
                assert!((found - exact).abs() < 1e-9 * exact, "{angle} {smoothed}: {found} J of {exact} J");
            }
        }
    }
}
