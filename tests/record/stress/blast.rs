//! Random blasts: a hole in rock, or a face of a block, under a pulse from far below to far above what the rock bears.

use std::f64::consts::TAU;

use fractum_math::Vec3;
use fractum_math::elementary::{cos, exp, ln, sin};
use fractum_mesh::generate::{Jitter, plane_mesh, structured_box};
use fractum_mesh::{Group, Mesh};

use super::draw::Draw;
use super::scenes::{Elastic, RandomScene, footer, number, random_header};

/// Name of such scenes in the table.
pub(crate) const BLAST: &str = "blast";

/// Largest pulse [Pa].
const PULSES: [f64; 2] = [1e6, 1e10];

/// A blast: in the plane around a hole, or in space on a face.
pub(super) fn blast(draw: &mut Draw) -> RandomScene {
    let material = Elastic {
        density: draw.between(1500.0, 3000.0),
        young_modulus: draw.decades(1e9, 1e11),
        poisson_ratio: draw.between(0.05, 0.35),
    };
    let radius = draw.decades(0.01, 0.5);
    let plane = draw.chance(0.75);
    let outer = draw.between(5.0, 10.0) * radius;
    let (mesh, edge) = if plane {
        let around = 16 + 4 * draw.whole(4) as u32;
        (ring(around, [radius, outer], draw), TAU * outer / f64::from(around))
    } else {
        let jitter = draw.chance(0.5).then(|| Jitter { fraction: 0.1, seed: draw.whole(1000) });
        (structured_box([6, 4, 4], Vec3::new(1.5, 1.0, 1.0) * outer, jitter), outer / 4.0)
    };
    let [loaded, free] = if plane { ["hole", "rim"] } else { ["x-", "x+"] };
    let strength = draw.decades(1e6, 2e7);
    let toughness = strength * strength / material.young_modulus * edge * draw.decades(3.0, 100.0);
    let criterion = draw.one_of(&["rankine", "mohr-coulomb"]);
    let mut case = random_header(BLAST, true) + &material.text();
    case += &format!(
        "[materials.stuff.damage]\ncriterion = \"{criterion}\"\ntensile_strength = \"{} Pa\"\nfracture_energy = \"{} J/m^2\"\n\
         unilateral = {}\n",
        number(strength),
        number(toughness),
        draw.chance(0.5)
    );
    case += &format!(
        "\n[[bodies]]\nname = \"rock\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stuff\"\nkinematics = \"{}\"\n",
        draw.one_of(&["small", "corotational"])
    );
    let absorbing = draw.chance(0.6);
    if absorbing {
        case += &format!("\n[[supports]]\ngroup = \"{free}\"\nabsorbing = true\n");
    }
    if absorbing && plane && draw.chance(0.6) {
        let [xx, yy] = [(); 2].map(|()| number(-draw.between(0.1, 0.8) * strength));
        case += &format!("\n[in_situ]\nstress = {{ xx = \"{xx} Pa\", yy = \"{yy} Pa\" }}\n");
    }
    let speed = (material.young_modulus / material.density).sqrt();
    let [rise, decay] =
        [draw.decades(0.05, 1.0) * radius / speed, draw.decades(3.0, 30.0) * radius / speed].map(number);
    let peak = number(draw.decades(PULSES[0], PULSES[1]));
    let pulse = match draw.whole(3) {
        0 => format!("{{ pulse = \"triangle\", peak = \"{peak} Pa\", rise = \"{rise} s\", duration = \"{decay} s\" }}"),
        kind => format!(
            "{{ pulse = \"{}-exponential\", peak = \"{peak} Pa\", rise_time = \"{rise} s\", decay_time = \"{decay} s\" }}",
            if kind == 1 { "double" } else { "linear" }
        ),
    };
    case += &format!("\n[[loads]]\ngroup = \"{loaded}\"\npressure = {pulse}\nin_cracks = {}\n", draw.chance(0.3));
    if draw.chance(0.5) {
        case += "\n[damping]\nbulk_linear = 0.06\nbulk_quadratic = 1.2\n";
    }
    let safety = draw.between(0.3, 0.95);
    RandomScene { kind: BLAST, case: case + &footer("explicit", 4.0 * outer / speed, safety), mesh: Some(mesh) }
}

/// A ring of triangles between two radii [m], growing outwards, with groups `body`, `hole` and `rim`.
fn ring(around: u32, [inner, outer]: [f64; 2], draw: &mut Draw) -> Mesh {
    let growth = 1.0 + TAU / f64::from(around);
    let rings = (ln(outer / inner) / ln(growth)).ceil() as u32;
    let mut nodes = Vec::new();
    for ring in 0..=rings {
        let radius = inner * exp(ln(outer / inner) * f64::from(ring) / f64::from(rings));
        for place in 0..around {
            let within = ring > 0 && ring < rings;
            let shift = if within { draw.between(-0.15, 0.15) } else { 0.0 };
            let angle = TAU * (f64::from(place) + 0.5 * f64::from(ring % 2) + shift) / f64::from(around);
            nodes.push(Vec3::new(radius * cos(angle), radius * sin(angle), 0.0));
        }
    }
    let node = |ring: u32, place: u32| ring * around + place % around;
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for k in 0..around {
            let [a, b, c, d] = [node(ring, k), node(ring, k + 1), node(ring + 1, k), node(ring + 1, k + 1)];
            // Rings are turned by half a cell in turn.
            triangles.extend(if ring % 2 == 0 { [[a, c, b], [b, c, d]] } else { [[a, c, d], [a, d, b]] });
        }
    }
    let lines: Vec<[u32; 2]> =
        [0, rings].into_iter().flat_map(|ring| (0..around).map(move |k| [node(ring, k), node(ring, k + 1)])).collect();
    let side = |name: &str, tag, lines| Group { name: name.into(), dimension: 1, tag, lines, ..Group::default() };
    let sides = vec![side("hole", 1, (0..around).collect()), side("rim", 2, (around..2 * around).collect())];
    plane_mesh(nodes, lines, triangles, sides)
}
