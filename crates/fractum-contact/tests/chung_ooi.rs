//! The elastic impacts of Chung and Ooi (2011), tests 1 to 4, against Hertz' closed forms and the impulse-momentum
//! relations of gross sliding.

use fractum_contact::law::{
    ContactLaw, ContactParameters, ElasticMaterial, Hertz, MaterialPair, damping_of_restitution,
};
use fractum_contact::{Frame, Shape, SphereContacts, Spheres, Surface, SurfaceContacts};
use fractum_math::Vec3;

fn surface(friction: f64, rolling_friction: f64, restitution: f64) -> ContactParameters {
    ContactParameters { friction, rolling_friction, damping_ratio: damping_of_restitution(restitution) }
}

struct Sphere {
    position: Vec3,
    velocity: Vec3,
    spin: Vec3,
    radius: f64,
    mass: f64,
}

/// What an impact did.
#[derive(Debug)]
struct Impact {
    overlap: f64,
    force: f64,
    duration: f64,
    velocity: Vec3,
    spin: Vec3,
    /// Kinetic energy before - after - what friction and damping took, over that before.
    lost: f64,
}

fn sphere(radius: f64, density: f64, position: Vec3, velocity: Vec3) -> Sphere {
    let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * density;
    Sphere { position, velocity, spin: Vec3::zeros(), radius, mass }
}

/// Moves spheres until they have parted; the last step's forces come from `forces` (force, moment of each, work).
fn bounce(
    spheres: &mut [Sphere],
    dt: f64,
    gap: impl Fn(&[Sphere]) -> f64,
    mut forces: impl FnMut(&Spheres) -> (Vec<Vec3>, Vec<Vec3>, fractum_math::Work),
) -> Impact {
    let energy = |s: &[Sphere]| -> f64 {
        s.iter()
            .map(|s| 0.5 * s.mass * (s.velocity.norm_squared() + 0.4 * s.radius.powi(2) * s.spin.norm_squared()))
            .sum()
    };
    let before = energy(spheres);
    let mut impact =
        Impact { overlap: 0.0, force: 0.0, duration: 0.0, velocity: Vec3::zeros(), spin: Vec3::zeros(), lost: 0.0 };
    let mut taken = 0.0;
    loop {
        let of = |f: fn(&Sphere) -> Vec3| spheres.iter().map(f).collect::<Vec<_>>();
        let (position, velocity, spin) = (of(|s| s.position), of(|s| s.velocity), of(|s| s.spin));
        let radius: Vec<f64> = spheres.iter().map(|s| s.radius).collect();
        let now = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radius };
        let (force, moment, work) = forces(&now);
        taken += work.friction + work.damping;
        let opening = gap(spheres);
        if opening < 0.0 {
            impact.duration += dt;
        }
        impact.overlap = impact.overlap.max(-opening);
        impact.force = impact.force.max(force[0].norm());
        if opening > 0.0 && impact.duration > 0.0 {
            break;
        }
        for (s, (f, m)) in spheres.iter_mut().zip(force.iter().zip(&moment)) {
            s.velocity += f * (dt / s.mass);
            s.spin += m * (dt / (0.4 * s.mass * s.radius * s.radius));
            s.position += s.velocity * dt;
        }
    }
    (impact.velocity, impact.spin) = (spheres[0].velocity, spheres[0].spin);
    impact.lost = (before - energy(spheres) - taken) / before;
    impact
}

fn elastic(young_modulus: f64, poisson_ratio: f64) -> ElasticMaterial {
    ElasticMaterial { young_modulus, poisson_ratio }
}

/// A sphere against a rigid plane z = 0, at a speed and an angle from the normal.
fn on_plane(material: ElasticMaterial, density: f64, radius: f64, speed: f64, angle: f64, e: f64, mu: f64) -> Impact {
    let velocity = Vec3::new(angle.sin(), 0.0, -angle.cos()) * speed;
    let mut spheres = [sphere(radius, density, Vec3::z() * radius, velocity)];
    let pair = MaterialPair::new([material, ElasticMaterial::RIGID], surface(mu, 0.0, e));
    let law = Hertz::new(&pair, radius, spheres[0].mass);
    let frame = Frame::at_rest();
    let ground = Surface::Shape { shape: Shape::HalfSpace, hollow: false, frame: &frame };
    let mut contacts = SurfaceContacts::new(0.1 * radius);
    // Some 3000 steps per impact.
    let time = 2.94 * (1.25 * spheres[0].mass / law.normal).powf(0.4) * (speed * angle.cos()).powf(-0.2);
    let dt = time / 3000.0;
    bounce(
        &mut spheres,
        dt,
        |s| s[0].position.z - s[0].radius,
        |now| {
            contacts.search(&ground, now);
            let work = contacts.update(&ground, now, |_, _| law, dt);
            let (mut force, mut moment) = (vec![Vec3::zeros()], vec![Vec3::zeros()]);
            contacts.add_to(&mut force, &mut moment);
            (force, moment, work)
        },
    )
}

fn within(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} against {expected}");
}

#[test]
fn test_1_two_equal_spheres_collide_as_hertz_says() {
    for (material, density, overlap, force, duration) in [
        (elastic(48e9, 0.20), 2800.0, 274.11e-6, 10.697e3, 40.34e-6),
        (elastic(20e9, 0.25), 2500.0, 368.30e-6, 7.108e3, 54.20e-6),
    ] {
        let radius = 0.01;
        let mut spheres = [
            sphere(radius, density, Vec3::x() * -radius, Vec3::x() * 10.0),
            sphere(radius, density, Vec3::x() * radius, Vec3::x() * -10.0),
        ];
        let pair = MaterialPair::new([material; 2], surface(0.35, 0.0, 1.0));
        let law = Hertz::new(&pair, 0.5 * radius, 0.5 * spheres[0].mass);
        let mut contacts = SphereContacts::new(0.1 * radius);
        let dt = duration / 4000.0;
        let gap = |s: &[Sphere]| (s[1].position - s[0].position).norm() - 2.0 * radius;
        let impact = bounce(&mut spheres, dt, gap, |now| {
            contacts.search(now, |_, _| Some(law));
            let (mut force, mut moment) = (vec![Vec3::zeros(); 2], vec![Vec3::zeros(); 2]);
            let work = contacts.add_forces(now, &mut force, &mut moment, dt);
            (force, moment, work)
        });
        within(impact.overlap, overlap, 1e-3, "overlap");
        within(impact.force, force, 1e-3, "force");
        within(impact.duration, duration, 2e-3, "duration");
        within(impact.velocity.x, -10.0, 1e-3, "velocity");
    }
}

#[test]
fn test_2_sphere_on_a_rigid_plane_collides_as_hertz_says() {
    for (material, density, overlap, force, duration) in [
        (elastic(70e9, 0.30), 2699.0, 49.717e-6, 11.370e3, 731.7e-6),
        (elastic(40e9, 0.35), 1800.0, 52.123e-6, 7.233e3, 767.1e-6),
    ] {
        let impact = on_plane(material, density, 0.1, 0.2, 0.0, 1.0, 0.0);
        within(impact.overlap, overlap, 1e-3, "overlap");
        within(impact.force, force, 1e-3, "force");
        within(impact.duration, duration, 2e-3, "duration");
    }
}

#[test]
fn test_3_the_restitution_that_goes_in_comes_out() {
    for (material, density, overlap, force) in
        [(elastic(380e9, 0.23), 4000.0, 8.089e-6, 0.6154e3), (elastic(100e9, 0.25), 7000.0, 17.189e-6, 0.5068e3)]
    {
        let impact = on_plane(material, density, 2.5e-3, 3.9, 0.0, 1.0, 0.0);
        within(impact.overlap, overlap, 1e-3, "overlap");
        within(impact.force, force, 1e-3, "force");
        for e in [0.2, 0.4, 0.6, 0.8, 1.0] {
            let impact = on_plane(material, density, 2.5e-3, 3.9, 0.0, e, 0.0);
            within(impact.velocity.z / 3.9, e, 1e-3, "restitution");
            assert!(impact.lost.abs() < 2e-3, "energy off by {} at {e}", impact.lost);
        }
    }
}

#[test]
fn test_4_oblique_impacts_slide_as_impulse_and_momentum_say() {
    let (e, mu, radius, speed) = (0.98, 0.092, 2.5e-3, 3.9);
    for (degrees, restitution, spin) in [
        (40.0f64, 0.7829, 544.2),
        (45.0, 0.8178, 502.4),
        (50.0, 0.8471, 456.7),
        (60.0, 0.8948, 355.2),
        (70.0, 0.9337, 243.0),
        (80.0, 0.9679, 123.4),
    ] {
        let angle = degrees.to_radians();
        let impact = on_plane(elastic(380e9, 0.23), 4000.0, radius, speed, angle, e, mu);
        within(impact.velocity.x / (speed * angle.sin()), restitution, 1e-2, "tangential restitution");
        within(impact.spin.y, spin, 1e-2, "spin");
        within(impact.velocity.z / (speed * angle.cos()), e, 1e-3, "normal restitution");
        assert!(impact.lost.abs() < 1e-3, "energy off by {} at {degrees} degrees", impact.lost);
    }
}

#[test]
fn below_gross_sliding_friction_takes_less_than_it_could_and_energy_closes() {
    for degrees in [5.0f64, 15.0, 25.0] {
        let impact = on_plane(elastic(380e9, 0.23), 4000.0, 2.5e-3, 3.9, degrees.to_radians(), 0.98, 0.092);
        assert!(impact.lost.abs() < 1e-3, "energy off by {} at {degrees} degrees", impact.lost);
        assert!(impact.velocity.z > 0.0);
    }
}

#[test]
fn stiffness_is_the_slope_of_the_force() {
    let pair = MaterialPair::new([elastic(70e9, 0.2); 2], surface(0.3, 0.0, 1.0));
    let law = Hertz::new(&pair, 0.01, 0.1);
    let normal = |overlap: f64| law.normal * overlap.powf(1.5);
    let slope = (normal(1.001e-5) - normal(0.999e-5)) / 2e-8;
    assert!((law.stiffness(1e-5).0 / slope - 1.0).abs() < 1e-6);
}
