//! Spheres on meshes: one contact on a smooth surface, all in a corner, forces without jumps, friction that crosses edges.

use std::f64::consts::PI;

use fractum_contact::law::{
    ContactLaw, ContactParameters, ElasticMaterial, Hertz, Linear, MaterialPair, damping_of_restitution,
};
use fractum_contact::{DoubleHierarchy, FacetMesh, Foot, Frame, Shape, Spheres, Surface, SurfaceContacts};
use fractum_math::Vec3;

fn surface(friction: f64, rolling_friction: f64, restitution: f64) -> ContactParameters {
    ContactParameters { friction, rolling_friction, damping_ratio: damping_of_restitution(restitution) }
}

struct Mesh {
    points: Vec<Vec3>,
    facets: Vec<Vec<u32>>,
    surface: FacetMesh,
}

impl Mesh {
    fn new(points: Vec<Vec3>, facets: Vec<Vec<u32>>) -> Self {
        let surface = FacetMesh::new(&points, &facets).unwrap();
        Mesh { points, facets, surface }
    }

    fn feet(&self, centre: &Vec3, radius: f64) -> Vec<Foot> {
        let mut feet = Vec::new();
        let all: Vec<u32> = (0..self.facets.len() as u32).collect();
        DoubleHierarchy::default().feet(&self.surface, &self.points, &all, centre, radius, &mut feet);
        feet
    }

    /// Force on a sphere with a spring of 1 N/m at each foot.
    fn force(&self, centre: &Vec3, radius: f64) -> Vec3 {
        self.feet(centre, radius).iter().map(|f| f.normal * (-(radius - f.distance) * f.weight)).sum()
    }
}

impl Mesh {
    /// Energy of the springs of [`Mesh::force`].
    fn energy(&self, centre: &Vec3, radius: f64) -> f64 {
        self.feet(centre, radius).iter().map(|f| 0.5 * (radius - f.distance).powi(2) * f.energy).sum()
    }
}

/// Random numbers in 0..1, always the same.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// A sheet bent by `profile` (height over x), of n × n random triangles or quads within ±1.
fn sheet(n: usize, seed: u64, quads: bool, profile: impl Fn(f64) -> f64, knots: &[f64]) -> Mesh {
    // Columns at the knots, where the profile bends, and between them; random across.
    let mut seed = seed;
    let mut columns: Vec<f64> = knots.to_vec();
    while columns.len() < n + 1 {
        let x = -1.0 + 2.0 * random(&mut seed);
        if columns.iter().all(|c| (c - x).abs() > 0.2 / n as f64) {
            columns.push(x);
        }
    }
    columns.sort_by(f64::total_cmp);
    let columns_count = columns.len();
    let mut points = Vec::new();
    for row in 0..=n {
        for (c, &x) in columns.iter().enumerate() {
            let bend = knots.contains(&x);
            let inner = row > 0 && row < n && c > 0 && c + 1 < columns_count;
            let y = -1.0 + 2.0 * row as f64 / n as f64;
            let room = 0.3 / n as f64 * f64::from(u8::from(inner && !quads));
            let (dx, dy) = (room * (random(&mut seed) - 0.5) * 0.3, room * (random(&mut seed) - 0.5));
            let x = if bend { x } else { x + dx };
            points.push(Vec3::new(x, y + dy, profile(x)));
        }
    }
    let mut facets = Vec::new();
    for row in 0..n {
        for c in 0..columns_count - 1 {
            let a = (row * columns_count + c) as u32;
            let (b, d) = (a + 1, a + columns_count as u32);
            if quads {
                facets.push(vec![a, b, d + 1, d]);
            } else if random(&mut seed) < 0.5 {
                facets.extend([vec![a, b, d + 1], vec![a, d + 1, d]]);
            } else {
                facets.extend([vec![a, b, d], vec![b, d + 1, d]]);
            }
        }
    }
    Mesh::new(points, facets)
}

#[test]
fn a_flat_mesh_gives_one_contact_and_the_force_of_a_plane_however_it_is_cut() {
    for (n, seed) in [(1, 1), (2, 2), (3, 5), (5, 3), (8, 4)] {
        for quads in [false, true] {
            let mesh = sheet(n, seed, quads, |_| 0.0, &[-1.0, 1.0]);
            let mut seed = 99;
            // Random places, and places exactly over points and edges.
            let mut places: Vec<Vec3> = (0..500)
                .map(|_| Vec3::new(random(&mut seed) * 1.4 - 0.7, random(&mut seed) * 1.4 - 0.7, 0.0))
                .collect();
            let inner = |p: &&Vec3| p.x.abs() < 0.99 && p.y.abs() < 0.99;
            places.extend(mesh.points.iter().filter(inner));
            for facet in &mesh.facets {
                let (a, b) = (mesh.points[facet[0] as usize], mesh.points[facet[1] as usize]);
                places.push(a * 0.3 + b * 0.7);
            }
            for place in places.iter().filter(|p| p.x.abs() < 0.999 && p.y.abs() < 0.999) {
                let centre = place + Vec3::z() * 0.49;
                let feet = mesh.feet(&centre, 0.5);
                assert_eq!(feet.len(), 1, "{n} {quads} {place:?} {feet:?}");
                let force = mesh.force(&centre, 0.5);
                assert!((force - Vec3::z() * 0.01).norm() < 1e-9 * 0.01, "{force:?}");
            }
        }
    }
}

/// Largest change of the force over a tiny step on a path, over the largest force on it; the step itself changes the
/// force by some 1e-13 of it.
fn largest_jump(mesh: &Mesh, path: impl Fn(f64) -> Vec3, radius: f64) -> f64 {
    let (mut jump, mut most): (f64, f64) = (0.0, 0.0);
    let steps = 400;
    for k in 0..steps {
        let (mut low, mut high) = (k as f64 / steps as f64, (k + 1) as f64 / steps as f64);
        let force = |s: f64| mesh.force(&path(s), radius);
        most = most.max(force(low).norm());
        // A jump is what is left of the difference when the step is halved again and again, on the larger side.
        for _ in 0..38 {
            let middle = 0.5 * (low + high);
            if (force(middle) - force(low)).norm() > (force(high) - force(middle)).norm() {
                high = middle;
            } else {
                low = middle;
            }
        }
        jump = jump.max((force(high) - force(low)).norm());
    }
    jump / most
}

#[test]
fn no_jump_across_edges_points_and_fans_of_flat_convex_and_concave_meshes() {
    let radius = 0.5;
    for (name, angle) in [("flat", 0.0), ("convex", -0.3), ("concave", 0.004), ("concave", 0.03), ("concave", 0.3)] {
        for n in [1, 2, 4] {
            let slope = f64::tan(angle);
            let mesh = sheet(n.max(2), 7 + n as u64, false, |x: f64| slope * x.max(0.0), &[-1.0, 0.0, 1.0]);
            // At an overlap of 1 % over the lower side, and oblique to the edge.
            let path = |s: f64| {
                let x = -0.5 + s;
                Vec3::new(x, 0.3 * x + 0.017, 0.99 * radius + slope * x.max(0.0) * if angle < 0.0 { 0.5 } else { 1.0 })
            };
            let jump = largest_jump(&mesh, path, radius);
            assert!(jump < 1e-10, "{name} {angle} with {n}: relative jump {jump:e}");
        }
    }
}

#[test]
fn fans_of_2_to_64_facets_have_no_jump_and_a_flat_fan_is_a_plane() {
    let radius = 0.3;
    for count in [2usize, 3, 5, 8, 16, 64] {
        for height in [-0.25, 0.0, 0.002, 0.05] {
            // An apex in the middle, lower or higher than the rim: a cone, a plane, shallow and steep funnels.
            let mut points = vec![Vec3::zeros()];
            let at = |k: usize| 2.0 * PI * k as f64 / count as f64;
            points.extend((0..count).map(|k| Vec3::new(at(k).cos(), at(k).sin(), height)));
            let facets = if count == 2 {
                points.push(Vec3::new(0.0, -1.0, height));
                points.push(Vec3::new(0.0, 1.0, height));
                vec![vec![0, 1, 4], vec![0, 4, 2], vec![0, 2, 3], vec![0, 3, 1]]
            } else {
                (0..count as u32).map(|k| vec![0, 1 + k, 1 + (k + 1) % count as u32]).collect()
            };
            let mesh = Mesh::new(points, facets);
            let path = |s: f64| Vec3::new(-0.2 + 0.4 * s, 0.013 - 0.02 * s, 0.99 * radius);
            let jump = largest_jump(&mesh, path, radius);
            assert!(jump < 1e-10, "{count} facets, height {height}: relative jump {jump:e}");
            if height == 0.0 {
                for k in 0..100 {
                    let force = mesh.force(&path(0.01 * k as f64), radius);
                    assert!((force - Vec3::z() * 0.01 * radius).norm() < 1e-9 * 0.01 * radius);
                }
            }
        }
    }
}

#[test]
fn the_force_does_not_depend_on_the_cut_of_a_bent_surface() {
    let radius = 0.5;
    for angle in [-0.6, -0.01, 0.003, 0.02, 0.5, 1.2] {
        let slope = f64::tan(angle);
        let cut = |n, seed, quads| sheet(n, seed, quads, |x: f64| slope * x.max(0.0), &[-1.0, 0.0, 1.0]);
        let coarse = cut(2, 1, true);
        for other in [cut(2, 2, false), cut(4, 3, false), cut(7, 4, false), cut(5, 6, true)] {
            let mut seed = 5;
            for _ in 0..2000 {
                let (x, y) = (random(&mut seed) - 0.5, random(&mut seed) - 0.5);
                let centre = Vec3::new(
                    0.6 * x,
                    0.6 * y,
                    radius * (0.93 + 0.1 * random(&mut seed)) + slope.max(0.0) * x.max(0.0),
                );
                let difference = coarse.force(&centre, radius) - other.force(&centre, radius);
                assert!(difference.norm() < 1e-9 * 0.01 * radius, "{angle}: {difference:?} at {centre:?}");
            }
        }
    }
}

/// An apex at the origin and a rim of `count` points at height `at` their angles and at radius 1.
fn fan(count: usize, at: impl Fn(f64) -> f64) -> Mesh {
    let mut points = vec![Vec3::zeros()];
    let angle = |k: usize| 2.0 * PI * k as f64 / count as f64;
    points.extend((0..count).map(|k| Vec3::new(angle(k).cos(), angle(k).sin(), at(angle(k)))));
    Mesh::new(points, (0..count as u32).map(|k| vec![0, 1 + k, 1 + (k + 1) % count as u32]).collect())
}

#[test]
fn the_force_is_the_derivative_of_one_energy() {
    let trough = |degrees: f64| {
        let slope = f64::tan((0.5 * (180.0 - degrees)).to_radians());
        sheet(3, 4, false, move |x: f64| slope * x.abs(), &[-1.0, 0.0, 1.0])
    };
    let mut meshes: Vec<(String, Mesh)> =
        [90.0, 120.0, 150.0, 160.0, 170.0, 175.0, 180.0, 200.0].map(|a| (format!("{a} degrees"), trough(a))).into();
    for count in [3, 4, 7, 16] {
        meshes.push((format!("funnel of {count}"), fan(count, |_| 0.08)));
        meshes.push((format!("cone of {count}"), fan(count, |_| -0.1)));
        if count > 3 {
            meshes.push((format!("saddle of {count}"), fan(count, |a| 0.15 * (2.0 * a).cos())));
        }
    }
    meshes.push(("wide hill".into(), sheet(9, 3, false, |x: f64| 0.15 * (4.0 * x).cos(), &[-1.0, 1.0])));
    let radius = 0.4;
    for (name, mesh) in &meshes {
        let mut seed = 11;
        let (mut several, mut tested) = (0, 0);
        while tested < 300 {
            let place = Vec3::new(
                0.5 * random(&mut seed) - 0.25,
                0.5 * random(&mut seed) - 0.25,
                0.2 + 0.5 * random(&mut seed),
            );
            let feet = mesh.feet(&place, radius);
            let Some(nearest) = feet.first().map(|f| f.distance).filter(|d| *d > 0.85 * radius) else { continue };
            tested += 1;
            several += usize::from(feet.len() > 1);
            let h = 1e-6;
            let slope = Vec3::from_fn(|k, _| {
                let step = Vec3::ith(k, h);
                (mesh.energy(&(place + step), radius) - mesh.energy(&(place - step), radius)) / (2.0 * h)
            });
            let force = mesh.force(&place, radius);
            assert!(
                (force + slope).norm() < 3e-6 * radius,
                "{name}: {force:?} against {slope:?} at {place:?}, {feet:#?}"
            );
            // Near the bottom of a funnel of many facets it is that of the bottom.
            assert!(mesh.energy(&place, radius) > 0.8 * 0.5 * (radius - nearest).powi(2), "{name} {feet:#?}");
        }
        assert!(
            several > 0 || name.starts_with("cone") || name.starts_with("180") || name.starts_with("200"),
            "{name}: {several}"
        );
    }
}

/// Largest error of the energy of a bead that bounces in a trough, over that of its fall: kinetic, of its height and of the contact.
fn energy_error(degrees: f64, radius: f64, law: impl ContactLaw, mass: f64, dt: f64, time: f64) -> f64 {
    let slope = f64::tan((0.5 * (180.0 - degrees)).to_radians());
    let mesh = sheet(2, 1, false, |x: f64| slope * x.abs(), &[-1.0, 0.0, 1.0]);
    let frame = Frame::at_rest();
    let ground = Surface::Rigid { surface: &mesh.surface, points: &mesh.points, frame: &frame };
    let mut contacts = SurfaceContacts::new(0.1 * radius);
    let (gravity, clear) = (9.81, radius / (0.5 * degrees.to_radians()).sin());
    let (mut position, mut velocity) = ([Vec3::new(0.03 * radius, 0.01, 1.3 * clear)], [Vec3::new(0.02, 0.05, 0.0)]);
    let (radii, spin) = ([radius], [Vec3::zeros()]);
    let fall = mass * gravity * 0.3 * clear;
    let (mut start, mut worst): (Option<f64>, f64) = (None, 0.0);
    for _ in 0..(time / dt) as usize {
        let spheres = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radii };
        contacts.search(&ground, &spheres);
        let stored = contacts.update(&ground, &spheres, |_, _| law, dt).stored;
        let (mut force, mut moment) = ([Vec3::z() * (-mass * gravity)], [Vec3::zeros()]);
        contacts.add_to(&mut force, &mut moment);
        // Velocity at the time of the position.
        let now = velocity[0] + force[0] * (0.5 * dt / mass);
        let energy = 0.5 * mass * now.norm_squared() + mass * gravity * position[0].z + stored;
        worst = worst.max((energy - *start.get_or_insert(energy)).abs() / fall);
        velocity[0] += force[0] * (dt / mass);
        position[0] += velocity[0] * dt;
    }
    worst
}

#[test]
fn a_bead_in_a_trough_of_any_angle_keeps_its_energy_to_the_square_of_the_step() {
    for degrees in [90.0, 120.0, 150.0, 160.0, 170.0, 175.0, 180.0] {
        for (radius, modulus) in [(0.02, 5e6), (0.008, 5e6), (0.02, 5e7)] {
            let mass = 2500.0 * 4.0 / 3.0 * PI * f64::powi(radius, 3);
            let material = ElasticMaterial { young_modulus: modulus, poisson_ratio: 0.3 };
            let free = surface(0.0, 0.0, 1.0);
            let hertz = Hertz::new(&MaterialPair::new([material; 2], free), radius, mass);
            let linear = Linear::on_wall(0.01 * modulus, 0.3, radius, mass, free);
            let dt = 0.02 * (mass / linear.normal_stiffness).sqrt();
            let time = 0.4 * (radius / 0.02).sqrt();
            let of_hertz = [dt, 0.5 * dt].map(|dt| energy_error(degrees, radius, hertz, mass, dt, time));
            let of_linear = [dt, 0.5 * dt].map(|dt| energy_error(degrees, radius, linear, mass, dt, time));
            for [whole, half] in [of_hertz, of_linear] {
                let found = format!("{degrees} degrees, {radius} m, {modulus:e} Pa: {whole:e} and {half:e}");
                assert!(whole < 2e-3 && half < 0.4 * whole, "{found}");
            }
        }
    }
}

/// Drops a bead of 8 mm into a cone of 24 facets with an outlet of this radius [m]: its last height [m] and speed [m/s], the most contacts
/// at a time, and the largest error of the balance over the work of its weight.
fn dropped_into_hopper(outlet: f64) -> (f64, f64, usize, f64) {
    let count = 24;
    let ring = |radius: f64, z: f64| {
        (0..count).map(move |k| {
            let angle = 2.0 * PI * k as f64 / count as f64;
            Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
    };
    let points: Vec<Vec3> = ring(0.05, 0.05).chain(ring(outlet, 0.01)).collect();
    let next = |k: u32| (k + 1) % count as u32;
    let facets = (0..count as u32)
        .flat_map(|k| [vec![k, next(k), count as u32 + k], vec![next(k), count as u32 + next(k), count as u32 + k]]);
    let mesh = Mesh::new(points, facets.collect());
    let frame = Frame::at_rest();
    let ground = Surface::Rigid { surface: &mesh.surface, points: &mesh.points, frame: &frame };
    let (radius, dt) = (0.008, 4e-5);
    let mass = 2500.0 * 4.0 / 3.0 * PI * f64::powi(radius, 3);
    let inertia = 0.4 * mass * radius * radius;
    let material = ElasticMaterial { young_modulus: 5e6, poisson_ratio: 0.3 };
    let law = Hertz::new(&MaterialPair::new([material, ElasticMaterial::RIGID], surface(0.3, 0.05, 0.8)), radius, mass);
    let mut contacts = SurfaceContacts::new(0.2 * radius);
    let (mut x, mut v, mut spin) = ([Vec3::new(0.02, 0.0, 0.06)], [Vec3::zeros()], [Vec3::zeros()]);
    let (start, mut taken, mut touched, mut worst) = (x[0].z, 0.0, 0, 0.0f64);
    for _ in 0..30_000 {
        let spheres = Spheres { position: &x, velocity: &v, spin: &spin, radius: &[radius] };
        contacts.search(&ground, &spheres);
        let work = contacts.update(&ground, &spheres, |_, _| law, dt);
        let (mut force, mut moment) = ([Vec3::z() * (-9.81 * mass)], [Vec3::zeros()]);
        contacts.add_to(&mut force, &mut moment);
        taken += work.friction + work.damping;
        touched = touched.max(contacts.touches().filter(|t| t.is_contact()).count());
        let (now, turning) = (v[0] + force[0] * (0.5 * dt / mass), spin[0] + moment[0] * (0.5 * dt / inertia));
        let kinetic = 0.5 * mass * now.norm_squared() + 0.5 * inertia * turning.norm_squared();
        let balance = kinetic + work.stored + taken - 9.81 * mass * (start - x[0].z);
        worst = worst.max(balance.abs() / (9.81 * mass * 0.05));
        v[0] += force[0] * (dt / mass);
        spin[0] += moment[0] * (dt / inertia);
        x[0] += v[0] * dt;
        if x[0].z < 0.0 {
            break;
        }
    }
    (x[0].z, v[0].norm(), touched, worst)
}

#[test]
fn a_bead_runs_through_a_cone_hopper_or_rests_in_its_outlet() {
    let (height, _, touched, worst) = dropped_into_hopper(0.012);
    assert!(height < 0.0 && touched > 1 && worst < 2e-3, "wide: {height} m, {touched} contacts, balance {worst:e}");
    let (height, speed, touched, worst) = dropped_into_hopper(0.006);
    let held = height > 0.01 && speed < 1e-3 && touched > 2;
    assert!(held && worst < 2e-3, "narrow: {height} m, {speed} m/s, {touched} contacts, balance {worst:e}");
}

#[test]
fn a_corner_of_three_walls_gives_three_whole_contacts() {
    let points = (0..8).map(|i| Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64)).collect();
    let facets = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = facets.iter().flat_map(|q| [vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]]).collect();
    let mesh = Mesh::new(points, triangles);
    mesh.surface.require_closed(&mesh.points).unwrap();
    for (centre, walls) in [([0.1, 0.1, 0.1], 3), ([0.1, 0.5, 0.1], 2), ([0.5, 0.5, 0.1], 1), ([0.9, 0.9, 0.9], 3)] {
        let feet = mesh.feet(&Vec3::from(centre), 0.105);
        assert_eq!(feet.len(), walls);
        assert!(feet.iter().all(|f| f.weight == 1.0 && (f.distance - 0.1).abs() < 1e-12), "{feet:?}");
    }
    // Outside, over an edge and over a corner: one.
    for centre in [[-0.05, -0.05, 0.5], [-0.05, -0.05, -0.05], [1.05, 1.05, 0.3]] {
        assert_eq!(mesh.feet(&Vec3::from(centre), 0.1).len(), 1);
    }
}

#[test]
fn on_ridge_and_apex_nothing_pushes_sideways_to_the_last_bit() {
    let points = vec![
        Vec3::new(0.0, -0.7, 0.0),
        Vec3::new(0.0, 1.3, 0.0),
        Vec3::new(-1.0, 0.1, -0.4),
        Vec3::new(1.0, -0.1, -0.3),
    ];
    let ridge = Mesh::new(points, vec![vec![0, 1, 2], vec![0, 3, 1]]);
    let force = ridge.force(&Vec3::new(0.0, 0.123456789, 0.0987), 0.1);
    assert!(force.x == 0.0 && force.y == 0.0 && force.z > 0.0, "{force:?}");
    let mut points = vec![Vec3::new(0.3, 0.7, 0.0)];
    points.extend([[1.0, 0.0], [0.2, 1.1], [-1.0, 0.3], [0.1, -1.4]].map(|[x, y]| Vec3::new(x, y, -1.0)));
    let apex = Mesh::new(points, (0..4).map(|k| vec![0, 1 + k, 1 + (k + 1) % 4]).collect());
    let force = apex.force(&Vec3::new(0.3, 0.7, 0.0987), 0.1);
    assert!(force.x == 0.0 && force.y == 0.0 && force.z > 0.0, "{force:?}");
}

/// Work of friction and final force of a sphere pulled over a ground at constant height and speed.
fn pulled(ground: &Surface, steps: usize) -> (f64, Vec3) {
    let radius = 0.2;
    let material = ElasticMaterial { young_modulus: 1e7, poisson_ratio: 0.3 };
    let law = Hertz::new(&MaterialPair::new([material; 2], surface(0.4, 0.0, 1.0)), radius, 1.0);
    let mut contacts = SurfaceContacts::new(0.1 * radius);
    let (mut friction, mut force) = (0.0, Vec3::zeros());
    let (dt, velocity) = (1e-3, Vec3::new(0.6, 0.35, 0.0));
    for step in 0..steps {
        let position = [Vec3::new(-0.6, -0.4, 0.199) + velocity * (dt * step as f64)];
        let (velocity, spin, radius) = ([velocity], [Vec3::new(0.1, 0.3, -0.2)], [radius]);
        let spheres = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radius };
        contacts.search(ground, &spheres);
        friction += contacts.update(ground, &spheres, |_, _| law, dt).friction;
        let (mut total, mut moment) = (vec![Vec3::zeros()], vec![Vec3::zeros()]);
        contacts.add_to(&mut total, &mut moment);
        force = total[0];
    }
    (friction, force)
}

#[test]
fn friction_over_many_facets_is_that_on_one_plane() {
    let frame = Frame::at_rest();
    let plane = Surface::Shape { shape: Shape::HalfSpace, hollow: false, frame: &frame };
    let (work, force) = pulled(&plane, 2000);
    assert!(work > 0.0);
    for (n, seed) in [(2, 1), (6, 2), (12, 3)] {
        let mesh = sheet(n, seed, false, |_| 0.0, &[-1.0, 1.0]);
        let ground = Surface::Rigid { surface: &mesh.surface, points: &mesh.points, frame: &frame };
        let (same_work, same_force) = pulled(&ground, 2000);
        assert!((same_work / work - 1.0).abs() < 1e-6, "{same_work} against {work}");
        assert!((same_force - force).norm() < 1e-9 * force.norm());
    }
}

#[test]
fn a_spring_that_sticks_keeps_its_stretch_across_an_edge() {
    // Rolling without slip over the edges of a mesh, with a steady small drag inside the friction cone: the tangential
    // force is that on the plane, where histories that restart at each facet would lose it.
    let frame = Frame::at_rest();
    let mesh = sheet(10, 4, false, |_| 0.0, &[-1.0, 1.0]);
    let shape_contacts = [
        Surface::Shape { shape: Shape::HalfSpace, hollow: false, frame: &frame },
        Surface::Rigid { surface: &mesh.surface, points: &mesh.points, frame: &frame },
    ];
    let forces = shape_contacts.map(|ground| {
        let radius = 0.2;
        let material = ElasticMaterial { young_modulus: 1e7, poisson_ratio: 0.3 };
        let law = Hertz::new(&MaterialPair::new([material; 2], surface(0.9, 0.0, 1.0)), radius, 1.0);
        let mut contacts = SurfaceContacts::new(0.1 * radius);
        let dt = 1e-3;
        let mut force = Vec3::zeros();
        for step in 0..1000 {
            let t = dt * step as f64;
            let position = [Vec3::new(-0.6 + 1.2 * t, 0.3 * t, 0.1995)];
            let (velocity, spin) = ([Vec3::new(1.2, 0.3, 0.0)], [Vec3::new(-0.3, 1.2 - 1e-4, 0.0) / 0.1995]);
            let radius = [radius];
            let spheres = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radius };
            contacts.search(&ground, &spheres);
            contacts.update(&ground, &spheres, |_, _| law, dt);
            let (mut total, mut moment) = (vec![Vec3::zeros()], vec![Vec3::zeros()]);
            contacts.add_to(&mut total, &mut moment);
            force = total[0];
        }
        force
    });
    assert!(forces[0].x.abs() > 1.0, "{forces:?}");
    assert!((forces[0] - forces[1]).norm() < 1e-9 * forces[0].norm(), "{forces:?}");
}

#[test]
fn forces_on_the_points_of_facets_balance_force_and_moment() {
    let mesh = sheet(5, 11, false, |x: f64| 0.05 * x.abs(), &[-1.0, 0.0, 1.0]);
    let velocity = vec![Vec3::new(0.1, -0.2, 0.3); mesh.points.len()];
    let ground = Surface::Deformable { surface: &mesh.surface, points: &mesh.points, velocity: &velocity };
    let mut seed = 3;
    let count = 50;
    let position: Vec<Vec3> = (0..count)
        .map(|_| Vec3::new(random(&mut seed) - 0.5, random(&mut seed) - 0.5, 0.19 + 0.02 * random(&mut seed)))
        .collect();
    let (still, radius) = (vec![Vec3::zeros(); count], vec![0.2; count]);
    let spheres = Spheres { position: &position, velocity: &still, spin: &still, radius: &radius };
    let material = ElasticMaterial { young_modulus: 1e7, poisson_ratio: 0.3 };
    let law = Hertz::new(&MaterialPair::new([material; 2], surface(0.4, 0.0, 0.5)), 0.2, 1.0);
    let mut contacts = SurfaceContacts::new(0.02);
    contacts.search(&ground, &spheres);
    contacts.update(&ground, &spheres, |_, _| law, 1e-4);
    let (mut force, mut moment) = (still.clone(), still.clone());
    contacts.add_to(&mut force, &mut moment);
    let mut sum: Vec3 = force.iter().sum();
    let mut turning: Vec3 = (0..count).map(|i| position[i].cross(&force[i]) + moment[i]).sum();
    let size: f64 = force.iter().map(|f| f.norm()).sum();
    assert!(size > 1.0);
    for touch in contacts.touches() {
        let place = position[touch.sphere as usize] + touch.offset;
        mesh.surface.share(touch.feature, &place, &mesh.points, |point, weight| {
            sum -= touch.force * weight;
            turning -= mesh.points[point as usize].cross(&(touch.force * weight));
        });
    }
    assert!(sum.norm() < 1e-13 * size && turning.norm() < 1e-12 * size, "{sum:?} {turning:?} of {size}");
}

#[test]
fn one_and_three_threads_give_the_same_bits_and_so_does_a_later_search() {
    let mesh = sheet(12, 8, false, |x: f64| 0.1 * x * x, &[-1.0, 1.0]);
    let run = |threads: usize, skin: f64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let frame = Frame::at_rest();
            let ground = Surface::Rigid { surface: &mesh.surface, points: &mesh.points, frame: &frame };
            let mut seed = 17;
            let count = 700;
            let mut position: Vec<Vec3> = (0..count)
                .map(|_| Vec3::new(random(&mut seed) - 0.5, random(&mut seed) - 0.5, 0.06 + 0.1 * random(&mut seed)))
                .collect();
            let mut velocity: Vec<Vec3> = (0..count).map(|_| Vec3::new(0.1, 0.2, -1.0)).collect();
            let (spin, radius) = (vec![Vec3::zeros(); count], vec![0.06; count]);
            let material = ElasticMaterial { young_modulus: 1e6, poisson_ratio: 0.3 };
            let law = Hertz::new(&MaterialPair::new([material; 2], surface(0.4, 0.1, 0.5)), 0.06, 1.0);
            let mut contacts = SurfaceContacts::new(skin);
            for _ in 0..100 {
                let spheres = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radius };
                contacts.search(&ground, &spheres);
                contacts.update(&ground, &spheres, |_, _| law, 1e-3);
                let (mut force, mut moment) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
                contacts.add_to(&mut force, &mut moment);
                for i in 0..count {
                    velocity[i] += force[i] * 1e-3;
                    position[i] += velocity[i] * 1e-3;
                }
            }
            position
        })
    };
    let one = run(1, 0.01);
    assert!(one.iter().any(|p| p.z > 0.1));
    assert!(one == run(3, 0.01) && one == run(2, 0.03));
}
