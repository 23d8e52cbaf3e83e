//! Friction against rolling: balls come to rest on planes, on facets and on each other, and the books close.

use std::f64::consts::PI;

use fractum_contact::law::{ContactParameters, ElasticMaterial, Hertz, MaterialPair};
use fractum_contact::{FacetMesh, Frame, Shape, SphereContacts, Spheres, Surface, SurfaceContacts};
use fractum_math::Vec3;

const SURFACE: ContactParameters = ContactParameters { friction: 0.8, rolling_friction: 0.1, damping_ratio: 0.2 };

fn pair() -> MaterialPair {
    MaterialPair::new([ElasticMaterial { young_modulus: 1e7, poisson_ratio: 0.3 }; 2], SURFACE)
}

/// Balls that move freely.
struct Balls {
    position: Vec<Vec3>,
    velocity: Vec<Vec3>,
    spin: Vec<Vec3>,
    radius: Vec<f64>,
    /// Force that acts on each all the time [N].
    load: Vec<Vec3>,
}

impl Balls {
    fn mass(&self) -> f64 {
        2500.0 * 4.0 / 3.0 * PI * self.radius[0].powi(3)
    }

    fn spheres(&self) -> Spheres<'_> {
        let Balls { position, velocity, spin, radius, .. } = self;
        Spheres { position, velocity, spin, radius }
    }

    fn kinetic(&self) -> f64 {
        let (mass, inertia) = (self.mass(), 0.4 * self.mass() * self.radius[0].powi(2));
        let of = |(v, w): (&Vec3, &Vec3)| 0.5 * mass * v.norm_squared() + 0.5 * inertia * w.norm_squared();
        self.velocity.iter().zip(&self.spin).map(of).sum()
    }

    /// Advances them, and tells the work of their loads.
    fn advance(&mut self, force: &[Vec3], moment: &[Vec3], dt: f64) -> f64 {
        let (mass, inertia) = (self.mass(), 0.4 * self.mass() * self.radius[0].powi(2));
        let mut work = 0.0;
        for i in 0..self.position.len() {
            self.velocity[i] += (force[i] + self.load[i]) * (dt / mass);
            self.spin[i] += moment[i] * (dt / inertia);
            self.position[i] += self.velocity[i] * dt;
            work += self.load[i].dot(&self.velocity[i]) * dt;
        }
        work
    }
}

/// Runs to the end; what is left of the speed and of the spin, over those of the start, and the relative error of the balance.
fn run(
    mut balls: Balls,
    (dt, end): (f64, f64),
    mut contacts: impl FnMut(&Spheres, &mut [Vec3], &mut [Vec3]) -> fractum_math::Work,
) -> (f64, f64) {
    let start = balls.kinetic();
    let (mut loads, mut taken, mut stored) = (0.0, 0.0, 0.0);
    for _ in 0..(end / dt) as usize {
        let mut force = vec![Vec3::zeros(); balls.position.len()];
        let mut moment = force.clone();
        let work = contacts(&balls.spheres(), &mut force, &mut moment);
        taken += work.friction + work.damping;
        stored = work.stored;
        loads += balls.advance(&force, &moment, dt);
    }
    let left = balls.kinetic() / start;
    (left, (start + loads - taken - stored - balls.kinetic()).abs() / start)
}

#[test]
fn a_ball_that_rolls_on_a_plane_or_on_facets_comes_to_rest() {
    let frame = Frame::at_rest();
    let points: Vec<Vec3> =
        (0..4).map(|k| Vec3::new(f64::from(k % 2) * 2.0 - 0.9, f64::from(k / 2) * 2.0 - 1.1, 0.0)).collect();
    let mesh = FacetMesh::new(&points, &[[0, 1, 2], [1, 3, 2]]).unwrap();
    let plane = Surface::Shape { shape: Shape::HalfSpace, hollow: false, frame: &frame };
    let facets = Surface::Rigid { surface: &mesh, points: &points, frame: &frame };
    for ground in [plane, facets] {
        for radius in [0.002, 0.005, 0.02] {
            for share in [1.0, 0.5] {
                let mut balls = Balls {
                    position: vec![Vec3::new(0.0, 0.0, radius)],
                    velocity: vec![Vec3::x() * 0.3],
                    spin: vec![Vec3::y() * (0.3 / radius)],
                    radius: vec![radius],
                    load: Vec::new(),
                };
                let mass = balls.mass();
                balls.load.push(Vec3::z() * (-9.81 * mass));
                let law = Hertz::new(&pair(), radius, mass);
                let dt = share * 2e-3 * radius;
                let mut contacts = SurfaceContacts::new(0.2 * radius);
                let (left, error) = run(balls, (dt, 0.9), |spheres, force, moment| {
                    contacts.search(&ground, spheres);
                    let work = contacts.update(&ground, spheres, |_, _| law, dt);
                    contacts.add_to(force, moment);
                    work
                });
                assert!(left < 1e-12, "{radius} {share}: {left:e} of the energy is left");
                assert!(error < 2e-3 * share, "{radius} {share}: balance {error:e}");
            }
        }
    }
}

#[test]
fn two_balls_that_roll_on_each_other_come_to_rest() {
    for radius in [0.002, 0.005, 0.02] {
        for share in [1.0, 0.5] {
            let mut balls = Balls {
                position: vec![Vec3::zeros(), Vec3::x() * (2.0 * radius)],
                velocity: vec![Vec3::zeros(); 2],
                spin: vec![Vec3::y() * (0.2 / radius), Vec3::y() * (-0.2 / radius)],
                radius: vec![radius; 2],
                load: Vec::new(),
            };
            let press = 20.0 * balls.mass();
            balls.load = vec![Vec3::x() * press, Vec3::x() * -press];
            let law = Hertz::new(&pair(), 0.5 * radius, 0.5 * balls.mass());
            let dt = share * 2e-3 * radius;
            let mut contacts = SphereContacts::new(0.2 * radius);
            let (left, error) = run(balls, (dt, 0.9), |spheres, force, moment| {
                contacts.search(spheres, |_, _| Some(law));
                contacts.add_forces(spheres, force, moment, dt)
            });
            assert!(left < 1e-12, "{radius} {share}: {left:e} of the energy is left");
            assert!(error < 2e-3 * share, "{radius} {share}: balance {error:e}");
        }
    }
}
