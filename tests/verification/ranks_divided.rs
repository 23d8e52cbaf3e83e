//! Several ranks share bodies that none of them has whole: each has read some elements, and gets those around its cells.

use std::sync::Arc;

use fractum_fem::{
    Body, BodyShare, CrackEdge, CrackFacet, CrackSurface, DamageLaw, EdgeDamage, Formulation, Kinematics, KnownAround,
    LocalDamping, ReadBody, Regularisation, Replication, Solid, Viscosity, cracks, fields, motion, neighbours,
};
use fractum_math::Vec3;
use fractum_parallel::{Exchange, threads};
use fractum_scene::coupling::largest_radii;
use fractum_scene::{Counts, Gravity, Load, Pressure, Scene, Watched, ranks, solid_pieces};
use fractum_tests::{jittered_box, surface};

use crate::ranks::{RANKS, advance, ends, on_two_threads, scene, set_moving};

const SIZE: Vec3 = Vec3::new(0.4, 0.2, 0.2);

/// Two bodies side by side, of edges and of elements as cells.
fn bodies(kinematics: Kinematics) -> (Vec<Vec3>, Vec<Body>) {
    let (nodes, body) = jittered_box([20, 10, 10], SIZE);
    let is_left = |element: &[u32; 4]| element.iter().map(|&n| nodes[n as usize].x).sum::<f64>() < 2.0 * SIZE.x;
    let (left, right) = body.elements.iter().partition(|element| is_left(element));
    let of = |elements: Vec<[u32; 4]>, formulation| Body {
        elements: elements.into(),
        formulation,
        kinematics,
        ..body.clone()
    };
    let bodies = vec![of(left, Formulation::Smoothed), of(right, Formulation::Standard)];
    (nodes, bodies)
}

/// What a rank has of the bodies, if it has read every third run of elements or so.
fn dealt(exchange: &Arc<dyn Exchange>, nodes: &[Vec3], bodies: Vec<Body>) -> (Vec<Body>, Vec<BodyShare>) {
    let (rank, size) = (exchange.rank(), exchange.size());
    let read = |body: &Body| {
        let count = body.elements.len();
        // Unlike lengths, one of them nothing.
        let begin = |rank: usize| count * rank.saturating_sub(1).pow(2) / (size - 1).pow(2);
        body.elements[begin(rank)..begin(rank + 1)].to_vec()
    };
    let elements: Vec<Vec<[u32; 4]>> = bodies.iter().map(read).collect();
    let tags: Vec<Vec<u64>> = elements.iter().map(|of| vec![7; of.len()]).collect();
    let parts = bodies.iter().zip(elements.iter().zip(&tags));
    let parts: Vec<ReadBody> = parts
        .map(|(body, (elements, tags))| {
            let replication = match &body.damage {
                None => Replication::Part,
                Some(zone) if body.formulation == Formulation::Smoothed && zone.regularisation.is_none() => {
                    Replication::Elements
                }
                Some(_) => Replication::Whole,
            };
            ReadBody { formulation: body.formulation, elements, tags, replication, sound: &[] }
        })
        .collect();
    let shares = fractum_fem::deal(&**exchange, nodes, &parts, KnownAround::default());
    let boundary = fractum_fem::divided_boundary(&**exchange, &elements, nodes.len());
    let whole: Vec<[u32; 4]> = bodies.iter().flat_map(|body| &*body.elements).copied().collect();
    let outside = |elements: &[[u32; 4]]| -> Vec<[u32; 3]> {
        fractum_mesh::topology::boundary_of_tetrahedra(elements).iter().map(|facet| facet.nodes).collect()
    };
    assert_eq!(boundary.all, outside(&whole));
    assert!(bodies.iter().zip(&boundary.of_bodies).all(|(body, of)| *of == outside(&body.elements)));
    let with_elements = |(body, mut share): (Body, BodyShare)| {
        let elements = std::mem::take(&mut share.elements);
        (Body { elements: elements.into(), ..body }, share)
    };
    bodies.into_iter().zip(shares).map(with_elements).unzip()
}

/// The scene of a solid of these bodies: `damping`, and whether it is viscous.
fn loaded(mut solid: Solid, facets: Vec<[u32; 3]>, damping: LocalDamping, viscous: bool) -> Scene {
    if viscous {
        motion::set_viscosity(&mut solid, Viscosity { stiffness_time: 1e-8, bulk_linear: 0.06, bulk_quadratic: 1.2 });
    }
    set_moving(&mut solid);
    let value = Arc::new(|t: f64, _: &Vec3| 1e6 * (t / 1e-5).min(1.0));
    let pressure = Load::Pressure(Pressure { facets, value });
    let gravity = Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -9.81) });
    let supports = ends(&solid, 0.1);
    scene(solid, supports, vec![pressure, gravity], damping)
}

fn same_as_whole(kinematics: Kinematics, damping: LocalDamping, viscous: bool) {
    let (nodes, all) = bodies(kinematics);
    let whole = Solid::new(nodes.clone(), all.clone()).unwrap();
    let top = |facet: &[u32; 3]| facet.iter().all(|&n| nodes[n as usize].z > 0.199);
    let facets: Vec<[u32; 3]> = surface(&whole).into_iter().filter(top).collect();
    let mut single = loaded(whole, facets.clone(), damping, viscous);
    advance(&mut single, 40);
    let fields_of = |scene: &Scene, body| {
        let earlier = fields::displacements_before(&scene.solid, scene.clock.dt_before);
        [None, Some(&earlier[..])].map(|earlier| fields::element_fields(&scene.solid, body, earlier))
    };
    let fields = [0, 1].map(|body| fields_of(&single, body));
    let run = |exchange: Arc<dyn Exchange>| {
        on_two_threads(|| {
            let (bodies, shares) = dealt(&exchange, &nodes, all.clone());
            let numbers: Vec<Vec<u32>> = shares.iter().map(|share| share.numbers.clone()).collect();
            let solid = neighbours::divided_solid(nodes.clone(), bodies, &shares, Arc::clone(&exchange)).unwrap();
            assert!(
                neighbours::is_divided(&solid)
                    && (0..2).all(|body| neighbours::element_count(&solid, body) == all[body].elements.len())
            );
            let mut scene = loaded(solid, facets.clone(), damping, viscous);
            assert_eq!(scene.stable_dt(), single.stable_dt());
            ranks::distribute(&mut scene, exchange, &Watched::default());
            advance(&mut scene, 40);
            ranks::gather_all(&mut scene);
            (scene, numbers)
        })
    };
    for ranks in RANKS {
        let outcomes: Vec<(Scene, Vec<Vec<u32>>)> = std::thread::scope(|scope| {
            let started: Vec<_> = threads(ranks).into_iter().map(|exchange| scope.spawn(|| run(exchange))).collect();
            started.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        let mut told = [0; 2];
        for (rank, (scene, numbers)) in outcomes.iter().enumerate() {
            let what = format!("rank {rank} of {ranks}");
            assert!(scene.solid.mass == single.solid.mass, "{what}");
            assert!(scene.solid.displacement == single.solid.displacement, "{what}");
            assert!(scene.solid.velocity == single.solid.velocity, "{what}");
            assert_eq!(scene.ledger(), single.ledger(), "{what}");
            let count: usize = all.iter().map(|body| body.elements.len()).sum();
            let has: usize = numbers.iter().map(Vec::len).sum();
            assert!(4 * has < 3 * count, "{what}: {has} of {count} elements");
            for body in 0..2 {
                let own = fields_of(scene, body);
                for element in (0..own[0].len()).filter(|&e| scene.solid.owns(body, e as u32)) {
                    told[body] += 1;
                    for (own, whole) in own.iter().zip(&fields[body]) {
                        let whole = whole[numbers[body][element] as usize];
                        assert_eq!(own[element], whole, "{what}: {body} {element}");
                    }
                }
            }
        }
        assert_eq!(told, [all[0].elements.len(), all[1].elements.len()]);
    }
}

/// A bar of which the middle breaks, a body of its own between two that do not.
fn breaking(formulation: Formulation, regularisation: Option<Regularisation>) -> (Vec<Vec3>, Vec<Body>) {
    let (nodes, body) = jittered_box([24, 8, 8], SIZE);
    let place = |element: &[u32; 4]| element.iter().map(|&n| nodes[n as usize].x).sum::<f64>() / (4.0 * SIZE.x);
    let of = |[begin, end]: [f64; 2], formulation| {
        let elements = body.elements.iter().filter(|element| (begin..end).contains(&place(element)));
        Body { elements: Arc::new(elements.copied().collect()), formulation, ..body.clone() }
    };
    let mut middle = of([0.4, 0.6], formulation).with_damage(DamageLaw::rankine(3e6, 60.0));
    middle.damage.as_mut().unwrap().regularisation = regularisation;
    let bodies = vec![of([0.0, 0.4], Formulation::Smoothed), middle, of([0.6, 1.0], Formulation::Standard)];
    (nodes, bodies)
}

/// Whatever a rank knows of all that breaks.
#[derive(PartialEq)]
struct Broken {
    /// Without histories.
    state: serde_json::Value,
    /// Of the edges of all bodies.
    histories: Vec<EdgeDamage>,
    counts: Counts,
    radii: Vec<f64>,
    facets: Vec<CrackFacet>,
    pieces: Vec<Vec<u32>>,
    edges: Vec<CrackEdge>,
    damages: Vec<Vec<f64>>,
}

fn broken(scene: &Scene) -> Broken {
    let solid = &scene.solid;
    let mut histories = Vec::new();
    (0..solid.body_count())
        .for_each(|body| neighbours::each_history(solid, body, |_| (), |history| histories.push(*history)));
    let mut state = serde_json::to_value(scene.state()).unwrap();
    state["solid"]["bodies"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .for_each(|body| body["edges"] = Vec::<u8>::new().into());
    Broken {
        state,
        histories,
        counts: scene.counts(),
        radii: largest_radii(solid),
        facets: CrackSurface::of(solid).facets,
        pieces: solid_pieces(solid, 0.05).into_iter().map(|piece| piece.nodes).collect(),
        edges: cracks::crack_edges(solid),
        damages: (0..solid.body_count())
            .filter(|&b| solid.body(b).damage.is_some())
            .map(|b| fields::element_damages(solid, b))
            .collect(),
    }
}

fn breaks_as_whole((nodes, all): (Vec<Vec3>, Vec<Body>), what: &str) {
    let pulled = |solid: Solid| {
        let supports = ends(&solid, 10.0);
        scene(solid, supports, Vec::new(), LocalDamping::default())
    };
    let mut single = pulled(Solid::new(nodes.clone(), all.clone()).unwrap());
    advance(&mut single, 400);
    let counts = single.counts();
    assert!(counts.removed_elements > 10 && counts.particles > 10, "{what}: {counts:?}");
    let expected = broken(&single);
    let run = |exchange: Arc<dyn Exchange>| {
        on_two_threads(|| {
            let (bodies, shares) = dealt(&exchange, &nodes, all.clone());
            let solid = neighbours::divided_solid(nodes.clone(), bodies, &shares, Arc::clone(&exchange)).unwrap();
            assert!(neighbours::is_divided(&solid) && neighbours::connected_pieces(&solid, all.len() / 2).is_none());
            let mut scene = pulled(solid);
            ranks::distribute(&mut scene, exchange, &Watched::default());
            advance(&mut scene, 400);
            ranks::gather_all(&mut scene);
            // Radii are found together.
            broken(&scene)
        })
    };
    for ranks in RANKS {
        let run = &run;
        std::thread::scope(|scope| {
            let started: Vec<_> = threads(ranks).into_iter().map(|exchange| scope.spawn(|| run(exchange))).collect();
            for (rank, thread) in started.into_iter().enumerate() {
                assert!(thread.join().unwrap() == expected, "{what}: rank {rank} of {ranks}");
            }
        });
    }
}

#[test]
fn a_body_that_breaks_between_divided_ones_has_the_bits_of_one_process() {
    breaks_as_whole(breaking(Formulation::Smoothed, None), "smoothed");
    breaks_as_whole(breaking(Formulation::Standard, None), "standard");
    breaks_as_whole(breaking(Formulation::Smoothed, Some(Regularisation { length: None })), "phase field");
}

#[test]
fn a_body_that_breaks_all_over_has_the_bits_of_one_process() {
    let (nodes, body) = jittered_box([24, 8, 8], SIZE);
    let mut body = body.smoothed().with_damage(DamageLaw::rankine(3e6, 60.0));
    let factor = |p: &Vec3| if (p.x / SIZE.x - 0.5).abs() < 0.1 { 0.8 } else { 1.0 };
    body.damage.as_mut().unwrap().strength_factor = body.edge_midpoints(&nodes).iter().map(factor).collect();
    breaks_as_whole((nodes, vec![body]), "all of it");
}

#[test]
fn bodies_that_no_rank_has_whole_move_with_the_bits_of_one_process() {
    same_as_whole(Kinematics::Small, LocalDamping::default(), false);
    same_as_whole(Kinematics::Corotational, LocalDamping { local: 0.1, mass_rate: 20.0 }, true);
}
