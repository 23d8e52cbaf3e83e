use fractum_math::{Ragged, Vec3};
use rayon::prelude::*;

use crate::domain::Domain;
use crate::neighbours::{BLOCK, Neighbours};
use crate::period::Period;

/// Spheres with soft linear repulsion (unit stiffness, unit mass) between walls, relaxed by FIRE.
///
/// With unit stiffness a force is an overlap [m] and time is counted in units of √(m/k).
pub(crate) struct Assembly<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) position: Vec<Vec3>,
    pub(crate) radius: Vec<f64>,
    /// Stiffness of the walls relative to that of the spheres.
    pub(crate) wall_stiffness: f64,
    /// How the box repeats in which the spheres are.
    pub(crate) period: Option<Period>,
    /// Overlap over the sum of the radii, of a wall over the radius, up to which spheres are no nearer than they may be.
    pub(crate) accepted: f64,
    /// Search skin in mean radii.
    pub(crate) skin: f64,
    /// Inverse of the mass of each.
    pub(crate) mobility: Vec<f64>,
    velocity: Vec<Vec3>,
    force: Vec<Vec3>,
    /// Centre and radius side by side: one cache line per neighbour in the force loop.
    sphere: Vec<[f64; 4]>,
    neighbours: Neighbours,
    near_walls: Ragged,
    at_search: Vec<Vec3>,
    searched: bool,
}

/// What a force evaluation saw.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    power: f64,
    unbalanced: f64,
    acceleration: f64,
    velocity: f64,
    overlap: f64,
    contacts: f64,
    too_near: f64,
}

/// How a relaxation ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relaxed {
    /// Iterations used.
    pub(crate) iterations: usize,
    /// Mean overlap of touching pairs [m].
    pub(crate) overlap: f64,
    /// Whether all are as far apart as they must be.
    pub(crate) is_free: bool,
}

// FIRE parameters (Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201), time in units of √(m/k).
const DT_START: f64 = 0.1;
const DT_MAX: f64 = 0.4;
const ALPHA_START: f64 = 0.1;
const PATIENCE: usize = 5;
/// Search skin in mean radii, where nothing else is said.
const SKIN: f64 = 0.15;

impl<'a> Assembly<'a> {
    pub(crate) fn new(domain: &'a Domain, position: Vec<Vec3>, radius: Vec<f64>) -> Self {
        let n = position.len();
        Assembly {
            domain,
            position,
            radius,
            wall_stiffness: 1.0,
            period: domain.period(),
            accepted: 0.0,
            skin: SKIN,
            mobility: vec![1.0; n],
            velocity: vec![Vec3::zeros(); n],
            force: vec![Vec3::zeros(); n],
            sphere: vec![[0.0; 4]; n],
            neighbours: Neighbours::default(),
            near_walls: Ragged::default(),
            at_search: vec![Vec3::zeros(); n],
            searched: false,
        }
    }

    /// Mean radius [m].
    pub(crate) fn mean_radius(&self) -> f64 {
        self.radius.iter().sum::<f64>() / self.radius.len() as f64
    }

    /// Changes all radii [m].
    pub(crate) fn set_radii(&mut self, radius: Vec<f64>) {
        self.radius = radius;
        self.searched = false;
    }

    /// Multiplies all radii.
    pub(crate) fn scale_radii(&mut self, factor: f64) {
        self.radius.iter_mut().for_each(|r| *r *= factor);
        self.searched = false;
    }

    fn search(&mut self) {
        let skin = self.skin * self.mean_radius();
        let period = self.period;
        if let Some(period) = period {
            self.position.iter_mut().for_each(|x| *x = period.within(x));
        }
        self.neighbours = Neighbours::find(&self.position, &self.radius, 1.0, skin, period);
        if let Domain::Surface(surface) = self.domain {
            let rows: Vec<Vec<u32>> = self
                .position
                .par_iter()
                .zip(&self.radius)
                .map(|(x, &r)| {
                    let mut found = Vec::new();
                    surface.near(x, r + skin, &mut found);
                    found
                })
                .collect();
            self.near_walls = Ragged::from_rows(rows);
        }
        self.at_search.copy_from_slice(&self.position);
        for ((sphere, x), &r) in self.sphere.iter_mut().zip(&self.position).zip(&self.radius) {
            *sphere = [x.x, x.y, x.z, r];
        }
        self.searched = true;
    }

    /// Moves until all are as far apart as they must be, or to static equilibrium: net forces (root mean square) below
    /// `tolerance` times the mean contact force, or overlaps below 1e-7 mean radii, or the iteration limit.
    pub(crate) fn relax(&mut self, tolerance: f64, limit: usize) -> Relaxed {
        let n = self.position.len();
        let mean_radius = self.mean_radius();
        let skin = self.skin * mean_radius;
        self.velocity.fill(Vec3::zeros());
        let (mut dt, mut alpha, mut uphill_free) = (DT_START, ALPHA_START, 0usize);
        for iteration in 0..limit {
            if !self.searched {
                self.search();
            }
            let sums = self.forces();
            let overlap = sums.overlap / sums.contacts.max(1.0);
            let unbalanced = (sums.unbalanced / n as f64).sqrt();
            let is_free = sums.too_near == 0.0;
            if is_free || unbalanced < (tolerance * overlap).max(1e-8 * mean_radius) {
                return Relaxed { iterations: iteration, overlap, is_free };
            }
            let mut stop = false;
            if sums.power > 0.0 {
                uphill_free += 1;
                if uphill_free > PATIENCE {
                    dt = f64::min(1.1 * dt, DT_MAX);
                    alpha *= 0.99;
                }
            } else if iteration > 0 {
                uphill_free = 0;
                dt = f64::max(0.5 * dt, 0.02);
                alpha = ALPHA_START;
                stop = true;
            }
            let steer = if sums.acceleration > 0.0 { alpha * (sums.velocity / sums.acceleration).sqrt() } else { 0.0 };
            let keep = if stop { 0.0 } else { 1.0 - alpha };
            let steer = if stop { 0.0 } else { steer };
            // No sphere travels further than a fraction of its radius in one step, however deep the first overlaps are.
            let longest = 0.1 * mean_radius;
            let moved: Vec<f64> = self
                .position
                .par_chunks_mut(BLOCK)
                .zip(self.velocity.par_chunks_mut(BLOCK))
                .zip(self.force.par_chunks(BLOCK))
                .zip(self.at_search.par_chunks(BLOCK))
                .zip(self.sphere.par_chunks_mut(BLOCK))
                .map(|((((position, velocity), force), start), sphere)| {
                    let mut largest: f64 = 0.0;
                    for k in 0..position.len() {
                        velocity[k] = velocity[k] * keep + force[k] * (steer + dt);
                        let mut step = velocity[k] * dt;
                        let length = step.norm_squared();
                        if length > longest * longest {
                            step *= longest / length.sqrt();
                        }
                        position[k] += step;
                        sphere[k][..3].copy_from_slice(position[k].as_slice());
                        largest = largest.max((position[k] - start[k]).norm_squared());
                    }
                    largest
                })
                .collect();
            let largest = moved.into_iter().fold(0.0, f64::max);
            if 4.0 * largest > skin * skin {
                self.searched = false;
            }
        }
        if !self.searched {
            self.search();
        }
        let sums = self.forces();
        let overlap = sums.overlap / sums.contacts.max(1.0);
        Relaxed { iterations: limit, overlap, is_free: sums.too_near == 0.0 }
    }

    /// Gathers the contact forces of every particle; sums in block order.
    fn forces(&mut self) -> Sums {
        let Assembly {
            domain,
            position,
            radius,
            velocity,
            force,
            sphere,
            neighbours,
            near_walls,
            wall_stiffness,
            period,
            accepted,
            mobility,
            ..
        } = self;
        let (period, accepted) = (*period, *accepted);
        let partial: Vec<Sums> = force
            .par_chunks_mut(BLOCK)
            .enumerate()
            .map(|(block, force)| {
                let mut sums = Sums::default();
                for (k, total) in force.iter_mut().enumerate() {
                    let i = block * BLOCK + k;
                    let (x, r) = (position[i], radius[i]);
                    let mut f = Vec3::zeros();
                    for &j in neighbours.of(i) {
                        let [px, py, pz, pr] = sphere[j as usize];
                        let mut d = Vec3::new(x.x - px, x.y - py, x.z - pz);
                        if let Some(period) = &period {
                            d = period.nearest(d);
                        }
                        let touch = r + pr;
                        let square = d.norm_squared();
                        if square < touch * touch {
                            let distance = square.sqrt();
                            let overlap = touch - distance;
                            // Coincident centres (never met after random insertion) would have no direction.
                            f += d * (overlap / distance.max(1e-12 * touch));
                            sums.overlap += overlap;
                            sums.contacts += 1.0;
                            sums.too_near += f64::from(u8::from(overlap > accepted * touch));
                        }
                    }
                    let candidates = if near_walls.is_empty() { &[][..] } else { near_walls.row(i) };
                    domain.contacts(&x, r, candidates, |c| {
                        f += c.inward * (*wall_stiffness * c.overlap);
                        sums.too_near += f64::from(u8::from(c.overlap > accepted * r));
                    });
                    sums.power += f.dot(&velocity[i]);
                    sums.unbalanced += f.norm_squared();
                    f *= mobility[i];
                    sums.acceleration += f.norm_squared();
                    sums.velocity += velocity[i].norm_squared();
                    *total = f;
                }
                sums
            })
            .collect();
        partial.into_iter().fold(Sums::default(), |a, b| Sums {
            power: a.power + b.power,
            unbalanced: a.unbalanced + b.unbalanced,
            acceleration: a.acceleration + b.acceleration,
            velocity: a.velocity + b.velocity,
            overlap: a.overlap + b.overlap,
            contacts: a.contacts + b.contacts,
            too_near: a.too_near + b.too_near,
        })
    }

    /// Scales the whole packing about the middle of the domain so that particles at the walls touch them on average:
    /// soft walls let the packing grow a little beyond its domain, and a similar packing is as free of stress.
    pub(crate) fn fit_walls(&mut self) {
        self.search();
        let (lower, upper) = self.domain.bounds();
        let centre = (lower + upper) * 0.5;
        let (mut beyond, mut reach) = (0.0, 0.0);
        for i in 0..self.position.len() {
            let candidates = if self.near_walls.is_empty() { &[][..] } else { self.near_walls.row(i) };
            let (x, r) = (self.position[i], self.radius[i]);
            self.domain.contacts(&x, r, candidates, |c| {
                beyond += c.overlap;
                reach += r - (x - centre).dot(&c.inward);
            });
        }
        if reach > 0.0 {
            let scale = 1.0 - beyond / reach;
            self.position.iter_mut().for_each(|x| *x = centre + (*x - centre) * scale);
            self.scale_radii(scale);
        }
    }

    /// For each particle: touching neighbours, and a bit for every wall it touches. Called after [`Assembly::relax`].
    pub(crate) fn touching(&mut self) -> (Vec<Vec<u32>>, Vec<u32>) {
        if !self.searched {
            self.search();
        }
        let period = self.period;
        let nearest = |apart: Vec3| period.map_or(apart, |period| period.nearest(apart));
        let contacts = (0..self.position.len())
            .into_par_iter()
            .map(|i| {
                let x = self.position[i];
                let touches = |&&j: &&u32| {
                    let touch = self.radius[i] + self.radius[j as usize];
                    nearest(x - self.position[j as usize]).norm_squared() < touch * touch
                };
                self.neighbours.of(i).iter().filter(touches).copied().collect()
            })
            .collect();
        let walls = (0..self.position.len())
            .map(|i| {
                let candidates = if self.near_walls.is_empty() { &[][..] } else { self.near_walls.row(i) };
                let mut bits = 0;
                self.domain.contacts(&self.position[i], self.radius[i], candidates, |c| bits |= 1 << c.wall);
                bits
            })
            .collect();
        (contacts, walls)
    }
}
