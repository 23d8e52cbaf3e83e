//! The largest stable step of central differences, 2/ω_max.

use fractum_math::{CHUNK, Mat3, Vec3, sum_chunks};
use nalgebra::{DMatrix, Matrix6, SMatrix};
use rayon::prelude::*;

use crate::cell::Geometry;
use crate::kernel::Hooke;
use crate::solid::Solid;

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
    pub fn stable_step(&mut self) -> StableStep {
        StableStep { frequency: 1.02 * self.largest_eigenvalue().sqrt(), ..self.stable_step_bound() }
    }

    /// ω_max by the rigorous bound max over elements of their own highest frequency (holds for both formulations and
    /// through removal).
    pub fn stable_step_bound(&self) -> StableStep {
        let mut worst = StableStep { frequency: 0.0, governing: (0, 0) };
        for (body, model) in self.bodies.iter().enumerate() {
            let geometry = Geometry { body: &model.body, nodes: &self.reference };
            let corners = model.body.shape.node_count();
            let scale = corners as f64 / model.body.elastic.density;
            // The trace of the 6×6 dual bounds its largest eigenvalue: most elements need no eigenvalue.
            let hooke = &model.hooke;
            let trace_factor = hooke.lambda + 2.0 * hooke.mu + 2.0 * hooke.mu;
            let trace = |element: usize| {
                let (_, gradients) = geometry.element(element);
                gradients[..corners].iter().map(|g| g.norm_squared()).sum::<f64>() * trace_factor * scale
            };
            let traces: Vec<f64> = (0..model.body.elements.len()).into_par_iter().map(trace).collect();
            let mut order: Vec<u32> = (0..traces.len() as u32).filter(|&e| model.alive[e as usize]).collect();
            order.par_sort_unstable_by(|&a, &b| traces[b as usize].total_cmp(&traces[a as usize]).then(a.cmp(&b)));
            for element in order {
                if traces[element as usize] <= worst.frequency * worst.frequency {
                    break;
                }
                let (_, gradients) = geometry.element(element as usize);
                let frequency = (element_eigenvalue(&gradients[..corners], hooke) * scale).sqrt();
                if frequency > worst.frequency {
                    worst = StableStep { frequency, governing: (body, element) };
                }
            }
        }
        worst
    }

    /// Largest eigenvalue of M⁻¹K, in the symmetric form M^-½ K M^-½.
    fn largest_eigenvalue(&mut self) -> f64 {
        let count = self.reference.len();
        let root: Vec<f64> = self.inverse_mass.iter().map(|m| m.sqrt()).collect();
        let norm = |v: &[Vec3]| sum_chunks(v.len(), |i| v[i].norm_squared()).sqrt();
        let mut q: Vec<Vec3> = (0..count).map(|i| start_vector(i as u64)).collect();
        let start = norm(&q);
        q.iter_mut().for_each(|v| *v /= start);
        let mut before = vec![Vec3::zeros(); count];
        let (mut alphas, mut betas) = (Vec::new(), Vec::<f64>::new());
        for _ in 0..LANCZOS_STEPS.min(3 * count) {
            let mut w = self.scaled_stiffness(&q, &root);
            let alpha = sum_chunks(count, |i| w[i].dot(&q[i]));
            let beta = betas.last().copied().unwrap_or(0.0);
            w.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(i, w)| *w -= q[i] * alpha + before[i] * beta);
            alphas.push(alpha);
            let next = norm(&w);
            if next <= 1e-12 * alpha.abs() {
                break;
            }
            w.iter_mut().for_each(|v| *v /= next);
            betas.push(next);
            before = std::mem::replace(&mut q, w);
        }
        let size = alphas.len();
        let tridiagonal = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
            0 => alphas[i],
            1 => betas[i.min(j)],
            _ => 0.0,
        });
        tridiagonal.symmetric_eigenvalues().max()
    }

    /// M^-½ K M^-½ q.
    fn scaled_stiffness(&mut self, q: &[Vec3], root: &[f64]) -> Vec<Vec3> {
        let field: Vec<Vec3> = q.par_iter().zip(root).map(|(v, r)| v * *r).collect();
        let Solid { blocks, bodies, .. } = self;
        blocks.par_iter_mut().for_each(|block| block.evaluate_elastic(&bodies[block.body], &field));
        let Solid { slots, blocks, .. } = self;
        let force = |i: usize| slots.gather(i, |block| blocks[block].forces()) * -root[i];
        (0..q.len()).into_par_iter().map(force).collect()
    }
}

/// Largest eigenvalue of D Σ b bᵀ, which times n/ρ is the squared frequency of an element with the mass ρV/n per node.
fn element_eigenvalue(gradients: &[Vec3], hooke: &Hooke) -> f64 {
    let (lambda, g) = (hooke.lambda, hooke.mu);
    let mut d = Matrix6::zeros();
    d.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Mat3::repeat(lambda) + Mat3::identity() * (2.0 * g)));
    d.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Mat3::identity() * g));
    let mut sum = Matrix6::zeros();
    for gradient in gradients {
        let (x, y, z) = (gradient.x, gradient.y, gradient.z);
        #[rustfmt::skip]
        let b = SMatrix::<f64, 6, 3>::new(
            x, 0.0, 0.0,
            0.0, y, 0.0,
            0.0, 0.0, z,
            y, x, 0.0,
            0.0, z, y,
            z, 0.0, x,
        );
        sum += b * b.transpose();
    }
    // Eigenvalues of D S are those of Lᵀ S L with D = L Lᵀ; volume cancels against the lumped mass.
    let Some(l) = d.cholesky().map(|c| c.l()) else { return f64::INFINITY };
    (l.transpose() * sum * l).symmetric_eigenvalues().max()
}

/// A reproducible vector without symmetry.
fn start_vector(index: u64) -> Vec3 {
    let component = |axis: u64| {
        let mut x = (index * 3 + axis).wrapping_add(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    Vec3::new(component(0), component(1), component(2))
}
