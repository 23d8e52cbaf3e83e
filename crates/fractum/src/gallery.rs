//! Pictures of a scene: its surface with the particles, coloured by damage and by stress.

use std::path::Path;

use fractum_fem::ElementKind;
use fractum_io::number::quantity;
use fractum_io::picture::{ColourMap, Paint, Picture, Spheres, Surface, View, range};
use fractum_math::Vec3;
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_scene::{BondedBody, CountKind, Scene};

use crate::cracks::lost_bonds;
use crate::report::PictureNote;

/// The largest displacement in a picture, as a fraction of the size of the body.
const SHOWN_DISPLACEMENT: f64 = 0.04;

/// Shortest over next side of what is seen from its broad side.
const FLAT: f64 = 0.35;

/// What a picture shows but does not colour.
const GREY: [u8; 3] = [150, 150, 150];

/// What is seen from outside: facets with the damage and stress of their elements.
struct Skin {
    points: Vec<[f64; 3]>,
    facets: Vec<[u32; 3]>,
    damage: Vec<f64>,
    stress: Vec<f64>,
}

/// Draws the scene into the folder `pictures` of the results; a picture that cannot be drawn is left out.
pub(crate) fn draw(scene: &Scene, folder: &Path) -> Vec<PictureNote> {
    let solid = &scene.solid;
    let bonded = &scene.bonded;
    let all: Vec<Vec3> = solid.reference.iter().chain(bonded.reference()).copied().collect();
    let size = extent(&all).norm();
    let attached = scene.attached_nodes();
    let largest = (0..attached.len())
        .filter(|&n| attached[n])
        .map(|n| solid.displacement_from_start(n).norm())
        .fold(0.0, f64::max);
    let moved: Vec<Vec3> =
        bonded.particles.position.iter().zip(bonded.reference()).map(|(x, start)| x - start).collect();
    let largest = moved.iter().map(|u| u.norm()).fold(largest, f64::max);
    // Small displacements are magnified, large ones shown as they are.
    let scale = if largest > 0.0 { (SHOWN_DISPLACEMENT * size / largest).max(1.0) } else { 1.0 };
    let shown = |n: usize| -> [f64; 3] { (solid.reference[n] + solid.displacement_from_start(n) * scale).into() };
    let skin = skin(scene, &shown);
    let debris = scene.debris.state();
    let centres: Vec<[f64; 3]> = debris.nodes.iter().map(|&n| shown(n as usize)).collect();
    let radii: Vec<f64> = debris.nodes.iter().map(|&n| scene.debris.radius(n)).collect();
    let balls: Vec<[f64; 3]> =
        bonded.reference().iter().zip(&moved).map(|(start, u)| (start + u * scale).into()).collect();
    let ball_radii: Vec<f64> = bonded.particles.radius.iter().map(|radius| radius.max(0.0)).collect();
    let view = view(&all);
    let time = quantity(scene.clock.time, "s");
    let magnified = if scale > 1.0 { format!(", displacements x {scale:.0}") } else { String::new() };
    let mut notes = Vec::new();
    let mut add = |file: &str, title: &str, label: &str, unit: &str, values: &[f64], inner: &[f64], damage: bool| {
        let shown: Vec<f64> = values.iter().chain(inner).copied().collect();
        let range = if damage { (0.0, 1.0) } else { range(&shown) };
        let paint = if values.is_empty() { Paint::Plain(GREY) } else { Paint::Facets(values) };
        let surface = Surface { points: &skin.points, triangles: &skin.facets, paint, mesh_lines: true };
        let spheres = Spheres { centres: &centres, radii: &radii, paint: Paint::Plain([200, 120, 40]) };
        let picture = Picture {
            surfaces: &[surface],
            spheres: &[spheres, Spheres { centres: &balls, radii: &ball_radii, paint: inside(inner) }],
            map: if damage { ColourMap::Damage } else { ColourMap::Viridis },
            range,
            clip: None,
        };
        let drawn = picture.render(&view).and_then(|image| image.write(&folder.join("pictures").join(file)));
        if drawn.is_ok() {
            notes.push(PictureNote {
                file: file.to_owned(),
                title: format!("{title} at {time}{magnified}"),
                label: label.to_owned(),
                unit: unit.to_owned(),
                damage,
                range,
            });
        }
    };
    if skin.damage.iter().any(|&d| d > 0.0) {
        add("damage.png", "Damage and discrete elements", "damage", "1", &skin.damage, &[], true);
    }
    if !skin.stress.is_empty() {
        add("stress.png", "First principal stress", "first principal stress", "Pa", &skin.stress, &[], false);
    }
    if !moved.is_empty() {
        let length: Vec<f64> = moved.iter().map(|u| u.norm()).collect();
        add("particles.png", "Displacement of bonded particles", "displacement", "m", &[], &length, false);
    }
    if scene.count(CountKind::BrokenBonds) > 0 {
        notes.extend(broken_bonds(scene, &balls, &view, folder, &format!("{time}{magnified}")));
    }
    notes
}

/// Bonded bodies cut open in the middle of what broke, seen straight on and coloured by the bonds that particles have lost: along
/// their broad side where they are flat, upright elsewhere.
fn broken_bonds(scene: &Scene, balls: &[[f64; 3]], view: &View, folder: &Path, when: &str) -> Option<PictureNote> {
    let bonded = &scene.bonded;
    let lost = lost_bonds(balls.len(), bonded.bodies().iter().flat_map(BondedBody::cracks));
    let reference = bonded.reference();
    let size = extent(reference);
    let thin = size.imin();
    let flat = size[thin] < FLAT * size[(thin + 1) % 3].min(size[(thin + 2) % 3]);
    let axis = if flat { thin } else { 1 };
    let mut look = Vec3::zeros();
    look[axis] = if axis == 2 { -1.0 } else { 1.0 };
    let up = if axis == 2 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let view = View { direction: look.into(), up, ..*view };
    let depth = |i: usize| reference[i].dot(&look);
    let middle = (0..balls.len()).map(|i| lost[i] * depth(i)).sum::<f64>() / lost.iter().sum::<f64>();
    let drawn = |i: usize| depth(i) >= middle && !bonded.particles.has_left(i);
    let kept: Vec<usize> = (0..balls.len()).filter(|&i| drawn(i)).collect();
    let centres: Vec<[f64; 3]> = kept.iter().map(|&i| balls[i]).collect();
    let radii: Vec<f64> = kept.iter().map(|&i| bonded.particles.radius[i]).collect();
    let values: Vec<f64> = kept.iter().map(|&i| lost[i]).collect();
    let range = (0.0, 5.0);
    let spheres = Spheres { centres: &centres, radii: &radii, paint: Paint::Nodes(&values) };
    let picture = Picture { spheres: &[spheres], map: ColourMap::Damage, range, ..Picture::default() };
    let file = "broken_bonds.png".to_owned();
    picture.render(&view).and_then(|image| image.write(&folder.join("pictures").join(&file))).ok()?;
    Some(PictureNote {
        file,
        title: format!("Section through what broke: bonds that particles have lost at {when}"),
        label: "broken bonds".to_owned(),
        unit: "1".to_owned(),
        damage: true,
        range,
    })
}

/// Spheres in the colour of their values, or plain without.
fn inside(values: &[f64]) -> Paint<'_> {
    if values.is_empty() { Paint::Plain(GREY) } else { Paint::Nodes(values) }
}

fn skin(scene: &Scene, shown: &dyn Fn(usize) -> [f64; 3]) -> Skin {
    let solid = &scene.solid;
    let points = (0..solid.reference.len()).map(shown).collect();
    let mut skin = Skin { points, facets: Vec::new(), damage: Vec::new(), stress: Vec::new() };
    for body in 0..solid.body_count() {
        let model = solid.body(body);
        let fields = solid.element_fields(body);
        let alive: Vec<usize> = (0..model.elements.len()).filter(|&e| solid.alive(body)[e]).collect();
        let mut push = |nodes: [u32; 3], element: usize| {
            let (stress, damage) = fields[element];
            skin.facets.push(nodes);
            skin.damage.push(damage);
            skin.stress.push(stress.principal_values()[0]);
        };
        match model.shape {
            ElementKind::T4 => {
                let elements: Vec<[u32; 4]> = alive.iter().map(|&e| model.elements[e]).collect();
                for facet in boundary_of_tetrahedra(&elements) {
                    push(facet.nodes, alive[facet.element as usize]);
                }
            }
            ElementKind::T3 => {
                for &element in &alive {
                    let [a, b, c, _] = model.elements[element];
                    push([a, b, c], element);
                }
            }
        }
    }
    skin
}

fn extent(points: &[Vec3]) -> Vec3 {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    high - low
}

/// Plane bodies are seen straight on, flat ones from their broad side, others from the front, right and above with z up.
fn view(points: &[Vec3]) -> View {
    let size = extent(points);
    let camera = if size.z == 0.0 {
        View { direction: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], ..View::default() }
    } else if size.z < 0.75 * size.x.min(size.y) {
        View { direction: [-0.35, -0.25, -1.0], up: [0.0, 1.0, 0.0], ..View::default() }
    } else {
        View::default()
    };
    View { width: 900, height: 760, ..camera }
}
