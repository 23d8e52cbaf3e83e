//! Search and laws of sphere contacts: `cargo bench -p fractum-contact`.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use divan::Bencher;
use divan::counter::ItemsCount;
use fractum_contact::law::{
    ContactMemory, ContactParameters, ElasticMaterial, Hertz, Linear, MaterialPair, PairMotion,
};
use fractum_contact::{FacetMesh, Frame, SphereContacts, Spheres, Surface, SurfaceContacts, close_pairs};
use fractum_math::Vec3;

fn main() {
    // One core.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("first pool of the process");
    divan::main();
}

/// Spheres of radius 1 on a grid that touches in every direction.
fn grid(side: usize) -> Vec<Vec3> {
    let place = |i: usize| Vec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64) * 1.99;
    (0..side.pow(3)).map(place).collect()
}

fn glass() -> MaterialPair {
    MaterialPair::new([ElasticMaterial { young_modulus: 70e9, poisson_ratio: 0.22 }; 2], ContactParameters::default())
}

#[divan::bench(args = [21, 46])]
fn search(bencher: Bencher, side: usize) {
    let centres = grid(side);
    let radii = vec![1.0; centres.len()];
    bencher.counter(ItemsCount::new(centres.len())).bench_local(|| close_pairs(&centres, &radii, 0.2));
}

/// One sphere a thousand times as large as the 10,000 on it.
#[divan::bench]
fn search_thousand_to_one(bencher: Bencher) {
    let mut centres: Vec<Vec3> =
        (0..10_000).map(|i| Vec3::new((i % 100) as f64, (i / 100) as f64, 0.0) * 2.0).collect();
    let mut radii = vec![1.0; centres.len()];
    centres.push(Vec3::new(100.0, 100.0, -1001.0));
    radii.push(1000.0);
    bencher.counter(ItemsCount::new(centres.len())).bench_local(|| close_pairs(&centres, &radii, 0.2));
}

#[divan::bench]
fn linear_law(bencher: Bencher) {
    let law = Linear::between_spheres(30e9, 0.2, [0.01, 0.01], [0.01, 0.01], ContactParameters::default());
    let motion = PairMotion {
        normal: Vec3::x(),
        overlap: 1e-6,
        velocity: Vec3::new(-0.1, 0.2, 0.0),
        spin: Vec3::zeros(),
        dt: 1e-7,
    };
    let mut memory = vec![ContactMemory::default(); 10_000];
    bencher
        .counter(ItemsCount::new(memory.len()))
        .bench_local(|| memory.iter_mut().map(|m| law.force(divan::black_box(&motion), m).stored).sum::<f64>());
}

/// A step of 10,648 spheres in a dense cubic heap, three contacts each (six neighbours), per sphere.
#[divan::bench]
fn hertz_spheres(bencher: Bencher) {
    let position = grid(22);
    let count = position.len();
    let velocity: Vec<Vec3> = position.iter().map(|p| Vec3::new(p.y, -p.x, 0.3 * p.z) * 1e-3).collect();
    let (spin, radius) = (vec![Vec3::new(1e-3, 2e-3, 0.0); count], vec![1.0; count]);
    let spheres = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radius };
    let law = Hertz::new(&glass(), 0.5, 1e3);
    let mut contacts = SphereContacts::new(0.1);
    contacts.search(&spheres, |_, _| Some(law));
    let (mut force, mut moment) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        contacts.search(&spheres, |_, _| Some(law));
        contacts.add_forces(&spheres, &mut force, &mut moment, 1e-6).stored
    });
}

/// A step of 10,000 spheres that rest on 20,000 triangles, one contact each, per contact.
#[divan::bench(args = [0.3, 0.5, 1.0])]
fn hertz_facets(bencher: Bencher, radius: f64) {
    let side = 100u32;
    let node = |x: u32, y: u32| x + (side + 1) * y;
    let points: Vec<Vec3> =
        (0..(side + 1).pow(2)).map(|i| Vec3::new(f64::from(i % (side + 1)), f64::from(i / (side + 1)), 0.0)).collect();
    let mut facets = Vec::new();
    for y in 0..side {
        for x in 0..side {
            facets.push([node(x, y), node(x + 1, y), node(x + 1, y + 1)]);
            facets.push([node(x, y), node(x + 1, y + 1), node(x, y + 1)]);
        }
    }
    let surface = FacetMesh::new(&points, &facets).expect("a sheet");
    let position: Vec<Vec3> = (0..side * side)
        .map(|i| {
            // Anywhere over the triangles.
            let (x, y) = (f64::from(i % side), f64::from(i / side));
            Vec3::new(x + (0.37 * y).fract(), y + (0.61 * x).fract(), 0.999 * radius)
        })
        .collect();
    let count = position.len();
    let (velocity, spin) = (vec![Vec3::new(1e-3, 0.0, 0.0); count], vec![Vec3::zeros(); count]);
    let radius = vec![radius; count];
    let spheres = Spheres { position: &position, velocity: &velocity, spin: &spin, radius: &radius };
    let frame = Frame::at_rest();
    let ground = Surface::Rigid { surface: &surface, points: &points, frame: &frame };
    let pair = glass();
    let mut contacts = SurfaceContacts::new(0.1 * radius[0]);
    contacts.search(&ground, &spheres);
    let (mut force, mut moment) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        contacts.search(&ground, &spheres);
        let law = |i: u32, _| Hertz::new(&pair, spheres.radius[i as usize], 1e3);
        let work = contacts.update(&ground, &spheres, law, 1e-6);
        contacts.add_to(&mut force, &mut moment);
        work.stored
    });
    assert_eq!(contacts.touches().count(), count);
}
