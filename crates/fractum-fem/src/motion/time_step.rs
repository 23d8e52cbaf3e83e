//! The largest stable step of central differences, 2/ω_max.

use fractum_math::{Vec3, largest_eigenvalue, sum_chunks};
use nalgebra::{Matrix6, SMatrix};
use rayon::prelude::*;

use crate::body::elasticity::Elasticity;
use crate::cells::cell::Geometry;
use crate::solid::Solid;
use crate::solid::subcycling::forget_ahead;

/// Lanczos steps of the estimate.
const LANCZOS_STEPS: usize = 48;

/// The highest frequency of a solid and where it lives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableStep {
    /// Highest natural frequency ω_max [rad/s].
    pub frequency: f64,
    /// Body and element that govern it.
    pub governing: (usize, u32),
}

impl StableStep {
    /// Largest stable step without damping, 2/ω_max [s].
    pub fn dt(&self) -> f64 {
        2.0 / self.frequency
    }
}

impl Solid {
    /// ω_max of the undamaged stiffness of what is still there, by the Lanczos process on M⁻¹K.
    ///
    /// The process converges from below; the value carries a margin of 2 %. The governing element is the one with the
    /// highest frequency of its own.
    ///
    /// Where cells take steps of two sizes it is that of those with the longer ones. Ranks that share the cells must all call it.
    pub fn stable_step(&mut self) -> StableStep {
        let frequency = 1.02 * highest_eigenvalue(self, |solid, node| !solid.is_fine(node)).sqrt();
        StableStep { frequency, ..stable_step_bound(self) }
    }
}

/// Frequency of the present motion, √(v·K v / v·M v) [rad/s]: that of a vibration whose velocities these are, 0 where nothing
/// moves or all moves alike. Ranks that share the cells must all call it.
pub fn motion_frequency(solid: &mut Solid) -> f64 {
    let root: Vec<f64> = solid.inverse_mass.iter().map(|m| m.sqrt()).collect();
    let scaled: Vec<Vec3> =
        solid.velocity.iter().zip(&root).map(|(v, r)| if *r > 0.0 { v / *r } else { Vec3::zeros() }).collect();
    let energy = sum_chunks(scaled.len(), |node| scaled[node].norm_squared());
    if energy == 0.0 {
        return 0.0;
    }
    let stiff = scaled_stiffness(solid, &scaled, &root);
    (sum_chunks(scaled.len(), |node| scaled[node].dot(&stiff[node])) / energy).max(0.0).sqrt()
}

/// As [`Solid::stable_step`], of the cells with the shorter steps; none where all take the same.
pub fn fine_stable_step(solid: &mut Solid, by_elements: bool) -> Option<StableStep> {
    let fine = solid.subcycling.as_ref()?.fine_elements.clone();
    let worst = bound(solid, |body, element| fine[body][element as usize]);
    if by_elements {
        return Some(worst);
    }
    Some(StableStep { frequency: 1.02 * highest_eigenvalue(solid, Solid::is_fine).sqrt(), ..worst })
}

/// ω_max by the rigorous bound max over elements of their own highest frequency (holds for both formulations and
/// through removal). Processes of which none has all elements must all call it.
pub fn stable_step_bound(solid: &Solid) -> StableStep {
    match &solid.subcycling {
        Some(subcycling) => bound(solid, |body, element| !subcycling.fine_elements[body][element as usize]),
        None => bound(solid, |_, _| true),
    }
}

/// The bound over some elements: body, element.
fn bound(solid: &Solid, counts: impl Fn(usize, u32) -> bool) -> StableStep {
    let mut worst = StableStep { frequency: 0.0, governing: (0, 0) };
    let mut worst_trace = 0.0;
    for (body, model) in solid.bodies.iter().enumerate() {
        let geometry = Geometry { body: &model.body, nodes: &solid.reference };
        let corners = model.body.shape.node_count();
        let scale = corners as f64 / model.body.elastic.density;
        // The trace of the 6×6 dual bounds its largest eigenvalue: most elements need no eigenvalue.
        let elasticity = &model.elasticity;
        let trace = |element: usize| {
            let (_, gradients) = geometry.element(element);
            (elasticity.trace_sum(&gradients[..corners]) + elasticity.hoop_trace(geometry.hoop(element))) * scale
        };
        let meant = |&e: &u32| model.alive[e as usize] && counts(body, e) && solid.owns(body, e);
        let meant: Vec<u32> = (0..model.body.elements.len() as u32).filter(meant).collect();
        let mut order: Vec<(f64, u32)> = meant.into_par_iter().map(|e| (trace(e as usize), e)).collect();
        order.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (trace, element) in order {
            if trace <= worst.frequency * worst.frequency {
                break;
            }
            let frequency = element_frequency(&geometry, elasticity, element as usize);
            if frequency > worst.frequency {
                worst = StableStep { frequency, governing: (body, element) };
                worst_trace = trace;
            }
        }
    }
    let (frequency, governing) = solid.neighbours.worst((worst.frequency, worst.governing), worst_trace);
    StableStep { frequency, governing }
}

/// Largest eigenvalue of M⁻¹K, in the symmetric form M^-½ K M^-½, of nodes that no cell joins to others.
fn highest_eigenvalue(solid: &mut Solid, counts: impl Fn(&Solid, usize) -> bool) -> f64 {
    let root = |(node, m): (usize, &f64)| if counts(solid, node) { m.sqrt() } else { 0.0 };
    let root: Vec<f64> = solid.inverse_mass.iter().enumerate().map(root).collect();
    largest_eigenvalue(root.len(), LANCZOS_STEPS, &mut |q| scaled_stiffness(solid, q, &root))
}

/// M^-½ K M^-½ q.
fn scaled_stiffness(solid: &mut Solid, q: &[Vec3], root: &[f64]) -> Vec<Vec3> {
    forget_ahead(solid); // it shares the memory of forces
    let field: Vec<Vec3> = q.par_iter().zip(root).map(|(v, r)| v * *r).collect();
    solid.evaluate_own(|bodies, _, block| block.evaluate_elastic(&bodies[block.body], &field));
    let mut force = field;
    solid.sum_blocks(&mut force);
    solid.neighbours.gather_values(&mut force);
    force.par_iter_mut().zip(root).for_each(|(force, root)| *force *= -root);
    force
}

/// Highest frequency of an element by itself, with its share of the mass [rad/s].
pub(crate) fn element_frequency(geometry: &Geometry, elasticity: &Elasticity, element: usize) -> f64 {
    let corners = geometry.body.shape.node_count();
    let (_, gradients) = geometry.element(element);
    let scale = corners as f64 / geometry.body.elastic.density;
    (element_eigenvalue(&gradients[..corners], geometry.hoop(element), elasticity) * scale).sqrt()
}

/// Largest eigenvalue of D Σ b bᵀ, which times n/ρ is the squared frequency of an element with the mass ρV/n per node.
///
/// - `hoop`: inverse radius of an element around an axis, else 0 [1/m]
fn element_eigenvalue(gradients: &[Vec3], hoop: f64, elasticity: &Elasticity) -> f64 {
    let mut sum = Matrix6::zeros();
    for gradient in gradients {
        let (x, y, z) = (gradient.x, gradient.y, gradient.z);
        #[rustfmt::skip]
        let mut b = SMatrix::<f64, 6, 3>::new(
            x, 0.0, 0.0,
            0.0, y, 0.0,
            0.0, 0.0, z,
            y, x, 0.0,
            0.0, z, y,
            z, 0.0, x,
        );
        if hoop > 0.0 {
            b[(2, 0)] = hoop / gradients.len() as f64;
        }
        sum += b * b.transpose();
    }
    // Eigenvalues of D S are those of Lᵀ S L with D = L Lᵀ; volume cancels against the lumped mass.
    let Some(l) = elasticity.matrix().cholesky().map(|c| c.l()) else { return f64::INFINITY };
    (l.transpose() * sum * l).symmetric_eigenvalues().max()
}
