//! The motion of a block of particles, four side by side.

use fractum_kernels::lanes::{Lanes, Vector, add, cross, dot, scale, side_by_side, sub};
use fractum_math::elementary::{cos, sin};
use fractum_math::{HalfSteps, Rotation, Vec3, widest};

use super::step::{ParticleDamping, TimeStep};

/// Particles side by side.
const W: usize = 4;

/// Particles of a block: what moves, and what moves it.
pub(super) struct Moving<'a> {
    pub(super) position: &'a mut [Vec3],
    pub(super) orientation: &'a mut [Rotation],
    pub(super) velocity: &'a mut [Vec3],
    pub(super) spin: &'a mut [Vec3],
    pub(super) force: &'a [Vec3],
    pub(super) moment: &'a [Vec3],
    pub(super) mass: &'a [f64],
    pub(super) inertia: &'a [f64],
    pub(super) held: &'a [u8],
    /// Forces and moments of the step before, where damping looks at them.
    pub(super) past: Option<[&'a [Vec3]; 2]>,
}

widest! {
    /// Kicks and drifts the particles of a block; what damping takes, and their kinetic energy, where either is there.
    pub(super) fn advance(particles: Moving<'_>, step: &TimeStep) -> HalfSteps = advance_by_fours;
}

#[inline(always)]
fn advance_by_fours(particles: Moving<'_>, step: &TimeStep) -> HalfSteps {
    let Moving { position, orientation, velocity, spin, force, moment, mass, inertia, held, past } = particles;
    let mut work = HalfSteps::default();
    let whole = position.len() / W;
    for four in 0..whole {
        let own = W * four..W * (four + 1);
        let past = past.map(|[force, moment]| [fixed(&force[own.clone()]), fixed(&moment[own.clone()])]);
        let loads = Loads {
            force: fixed(&force[own.clone()]),
            moment: fixed(&moment[own.clone()]),
            mass: fixed(&mass[own.clone()]),
            inertia: fixed(&inertia[own.clone()]),
            held: fixed(&held[own.clone()]),
            past,
        };
        let rates = [fixed_mut(&mut velocity[own.clone()]), fixed_mut(&mut spin[own.clone()])];
        let places = (fixed_mut(&mut position[own.clone()]), fixed_mut(&mut orientation[own]));
        advance_four(places, rates, &loads, step, &mut work);
    }
    let rest = W * whole..position.len();
    if !rest.is_empty() {
        let past = past.map(|[force, moment]| [padded(&force[rest.clone()]), padded(&moment[rest.clone()])]);
        let (mut some, mut turned) = (padded(&position[rest.clone()]), [Rotation::identity(); W]);
        turned[..rest.len()].copy_from_slice(&orientation[rest.clone()]);
        let mut rates = [padded(&velocity[rest.clone()]), padded(&spin[rest.clone()])];
        let [velocities, spins] = &mut rates;
        let (mut weights, mut fixed) = ([[1.0; W]; 2], [0; W]);
        weights[0][..rest.len()].copy_from_slice(&mass[rest.clone()]);
        weights[1][..rest.len()].copy_from_slice(&inertia[rest.clone()]);
        fixed[..rest.len()].copy_from_slice(&held[rest.clone()]);
        let loads = Loads {
            force: &padded(&force[rest.clone()]),
            moment: &padded(&moment[rest.clone()]),
            mass: &weights[0],
            inertia: &weights[1],
            held: &fixed,
            past: past.as_ref().map(|[force, moment]| [force, moment]),
        };
        advance_four((&mut some, &mut turned), [velocities, spins], &loads, step, &mut work);
        position[rest.clone()].copy_from_slice(&some[..rest.len()]);
        orientation[rest.clone()].copy_from_slice(&turned[..rest.len()]);
        velocity[rest.clone()].copy_from_slice(&rates[0][..rest.len()]);
        spin[rest.clone()].copy_from_slice(&rates[1][..rest.len()]);
    }
    work
}

/// What moves four particles.
struct Loads<'a> {
    force: &'a [Vec3; W],
    moment: &'a [Vec3; W],
    mass: &'a [f64; W],
    inertia: &'a [f64; W],
    held: &'a [u8; W],
    past: Option<[&'a [Vec3; W]; 2]>,
}

#[inline(always)]
fn fixed<T>(slice: &[T]) -> &[T; W] {
    slice.first_chunk().expect("four of them")
}

#[inline(always)]
fn fixed_mut<T>(slice: &mut [T]) -> &mut [T; W] {
    slice.first_chunk_mut().expect("four of them")
}

/// Up to four vectors, and zeros.
fn padded(slice: &[Vec3]) -> [Vec3; W] {
    let mut all = [Vec3::zeros(); W];
    all[..slice.len()].copy_from_slice(slice);
    all
}

/// Kicks and drifts four particles.
#[inline(always)]
fn advance_four(
    (position, orientation): (&mut [Vec3; W], &mut [Rotation; W]),
    [velocities, spins]: [&mut [Vec3; W]; 2],
    loads: &Loads<'_>,
    step: &TimeStep,
    work: &mut HalfSteps,
) {
    let TimeStep { dt_before, dt_after, damping, measure } = *step;
    let half = 0.5 * (dt_before + dt_after);
    let (mass, inertia, held) = (Lanes(*loads.mass), Lanes(*loads.inertia), loads.held);
    let mut force = free(vectors(loads.force), held, 0);
    let mut moment = free(vectors(loads.moment), held, 3);
    let (velocity, spin) = (vectors(velocities), vectors(spins));
    let (kick, twist) = (over(half, mass), over(half, inertia));
    let is_plain = damping.is_off() && !measure;
    if !is_plain {
        let (v, w) = (free(velocity, held, 0), free(spin, held, 3));
        let (mut resist, mut brake) =
            (damping_force(&damping, force, v, mass), damping_force(&damping, moment, w, inertia));
        if let Some([past_force, past_moment]) = loads.past {
            let dissipation = Lanes::splat(damping.dissipation);
            resist = add(resist, scale(sub(force, vectors(past_force)), dissipation));
            brake = add(brake, scale(sub(moment, vectors(past_moment)), dissipation));
        }
        force = add(force, resist);
        moment = add(moment, brake);
        let after = (add(v, scale(force, kick)), add(w, scale(moment, twist)));
        let taken = Lanes::splat(0.5 * dt_before) * (dot(resist, v) + dot(brake, w));
        let taken_after = Lanes::splat(0.5 * dt_after) * (dot(resist, after.0) + dot(brake, after.1));
        let moving = kinetic_before(mass, velocity, force, dt_before);
        let turning = kinetic_before(inertia, spin, moment, dt_before);
        side_by_side(&[taken, taken_after, moving, turning]);
        for k in 0..W {
            work.before.damping -= taken.0[k];
            work.after.damping -= taken_after.0[k];
            work.before.kinetic += moving.0[k];
            work.before.kinetic += turning.0[k];
        }
    }
    let (velocity, spin) = (add(velocity, scale(force, kick)), add(spin, scale(moment, twist)));
    if !is_plain {
        let moving = kinetic_after(mass, velocity, force, dt_after);
        let turning = kinetic_after(inertia, spin, moment, dt_after);
        side_by_side(&[moving, turning]);
        for k in 0..W {
            work.after.kinetic += moving.0[k];
            work.after.kinetic += turning.0[k];
        }
    }
    let dt = Lanes::splat(dt_after);
    let places = add(vectors(position), scale(velocity, dt));
    side_by_side(&[velocity, spin, places]);
    store(velocity, velocities);
    store(spin, spins);
    store(places, position);
    turn(orientation, scale(spin, dt));
}

/// ½ m v · (v + Δt a) of the velocities that a step finds.
#[inline(always)]
fn kinetic_before(weight: Lanes<W>, velocity: Vector<W>, load: Vector<W>, dt: f64) -> Lanes<W> {
    Lanes::splat(0.5) * weight * dot(velocity, add(velocity, scale(load, over(dt, weight))))
}

/// ½ v · (m v - Δt F) of the velocities that a step leaves.
#[inline(always)]
fn kinetic_after(weight: Lanes<W>, velocity: Vector<W>, load: Vector<W>, dt: f64) -> Lanes<W> {
    Lanes::splat(0.5) * dot(velocity, sub(scale(velocity, weight), scale(load, Lanes::splat(dt))))
}

/// 1 - h/a (1 - h/b (1 - h/c (1 - h/d))).
#[inline(always)]
fn series(h: Lanes<W>, by: [f64; 4]) -> Lanes<W> {
    let mut sum = [1.0; W];
    for i in (0..4).rev() {
        for k in 0..W {
            sum[k] = 1.0 - h.0[k] / by[i] * sum[k];
        }
    }
    Lanes(sum)
}

/// exp(θ) q, renormalised.
pub(crate) fn turned(q: &Rotation, theta: Vec3) -> Rotation {
    let mut turned = [*q; W];
    turn(&mut turned, vectors(&[theta; W]));
    turned[0]
}

/// Turns orientations by exp(θ), and renormalises them.
#[inline(always)]
fn turn(orientation: &mut [Rotation; W], theta: Vector<W>) {
    let square = dot(theta, theta);
    // cos(θ/2) and sin(θ/2)/θ; the series are exact to round-off below 0.2 rad.
    let h = Lanes::splat(0.25) * square;
    let (mut c, mut s) = (series(h, [2.0, 12.0, 30.0, 56.0]), Lanes::splat(0.5) * series(h, [6.0, 20.0, 42.0, 72.0]));
    side_by_side(&[square, c, s]);
    for k in 0..W {
        if square.0[k] >= 0.04 {
            let angle = square.0[k].sqrt();
            (c.0[k], s.0[k]) = (cos(0.5 * angle), sin(0.5 * angle) / angle);
        }
    }
    let mut quaternion = [[0.0; W]; 4];
    for (k, orientation) in orientation.iter().enumerate() {
        for i in 0..4 {
            quaternion[i][k] = orientation.coords[i];
        }
    }
    let [x, y, z, w] = quaternion;
    let [x, y, z, w] = [Lanes(x), Lanes(y), Lanes(z), Lanes(w)];
    let (u, v) = ([x, y, z], scale(theta, s));
    let vector = add(add(scale(u, c), scale(v, w)), cross(v, u));
    let scalar = c * w - dot(v, u);
    // One Newton step of 1/√: round-off only drifts by parts in 1e16.
    let keep = Lanes::splat(1.5) - Lanes::splat(0.5) * (scalar * scalar + dot(vector, vector));
    let (vector, scalar) = (scale(vector, keep), scalar * keep);
    side_by_side(&(vector, scalar));
    for (k, orientation) in orientation.iter_mut().enumerate() {
        let turned = nalgebra::Quaternion::new(scalar.0[k], vector[0].0[k], vector[1].0[k], vector[2].0[k]);
        *orientation = Rotation::new_unchecked(turned);
    }
}

/// -a |F| v/|v| - α m v, zero at rest; with moment, spin and moment of inertia for a rotation.
#[inline(always)]
fn damping_force(damping: &ParticleDamping, force: Vector<W>, velocity: Vector<W>, mass: Lanes<W>) -> Vector<W> {
    let (speed, size) = (dot(velocity, velocity).sqrt(), dot(force, force).sqrt());
    let local = Lanes::of(|k| if speed.0[k] > 0.0 { -damping.local * size.0[k] / speed.0[k] } else { 0.0 });
    sub(scale(velocity, local), scale(velocity, Lanes::splat(damping.mass_rate) * mass))
}

#[inline(always)]
fn over(number: f64, by: Lanes<W>) -> Lanes<W> {
    Lanes::of(|k| number / by.0[k])
}

#[inline(always)]
fn vectors(of: &[Vec3; W]) -> Vector<W> {
    let mut lanes = [[0.0; W]; 3];
    for (k, vector) in of.iter().enumerate() {
        (lanes[0][k], lanes[1][k], lanes[2][k]) = (vector.x, vector.y, vector.z);
    }
    [Lanes(lanes[0]), Lanes(lanes[1]), Lanes(lanes[2])]
}

#[inline(always)]
fn store(vectors: Vector<W>, to: &mut [Vec3; W]) {
    for (k, to) in to.iter_mut().enumerate() {
        *to = Vec3::new(vectors[0].0[k], vectors[1].0[k], vectors[2].0[k]);
    }
}

/// Without the components that are held: bits `first` to `first + 2`.
#[inline(always)]
fn free(mut vectors: Vector<W>, held: &[u8; W], first: usize) -> Vector<W> {
    if *held == [0; W] {
        return vectors;
    }
    for (k, held) in held.iter().enumerate() {
        for (d, component) in vectors.iter_mut().enumerate() {
            if held >> (first + d) & 1 == 1 {
                component.0[k] = 0.0;
            }
        }
    }
    vectors
}
