//! Pictures of a scene: its surface with the particles, coloured by damage and by stress.

use std::path::Path;

use fractum_fem::ElementKind;
use fractum_io::number::quantity;
use fractum_io::picture::{ColourMap, Paint, Picture, Spheres, Surface, View, robust_range};
use fractum_math::Vec3;
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_scene::{BondedBody, CountKind, Form, RigidBody, Scene, Shape};

use crate::cracks::lost_bonds;
use crate::report::PictureNote;
use crate::rigid_surface::{Triangles, outline};

/// The largest displacement in a picture, as a fraction of the size of the body.
pub(crate) const SHOWN_DISPLACEMENT: f64 = 0.04;

/// Rigid bodies larger than this many times the bodies they act on are not drawn.
const LARGEST_RIGID: f64 = 2.0;

/// Shortest over next side of what is seen from its broad side.
const FLAT: f64 = 0.35;

/// What a picture shows but does not colour.
pub(crate) const GREY: [u8; 3] = [150, 150, 150];

/// Colour of discrete elements.
pub(crate) const PARTICLE: [u8; 3] = [200, 120, 40];

/// Radius in pictures of discrete elements that an element still holds, over their own: cracks show between them.
pub(crate) const ATTACHED: f64 = 0.3;

/// Colour of rigid bodies.
const STEEL: [u8; 3] = [176, 182, 190];

/// What is seen from outside: facets with the damage and stress of their elements.
struct Skin {
    points: Vec<[f64; 3]>,
    facets: Vec<[u32; 3]>,
    damage: Vec<f64>,
    stress: Vec<f64>,
}

/// What all pictures of a scene have in common.
struct Studio<'a> {
    folder: &'a Path,
    skin: Skin,
    /// Centres and radii of the discrete elements.
    debris: (Vec<[f64; 3]>, Vec<f64>),
    /// Centres of the bonded and loose particles.
    balls: Vec<[f64; 3]>,
    ball_radii: &'a [f64],
    rigid: Vec<Triangles>,
    view: View,
    /// The instant, and how displacements are drawn.
    when: String,
}

/// What the colours of a picture are.
struct Colours<'a> {
    label: &'a str,
    unit: &'a str,
    /// Values of the facets of the skin; none leaves them grey.
    facets: &'a [f64],
    /// Values of the particles.
    balls: &'a [f64],
    damage: bool,
}

impl Studio<'_> {
    /// Draws a picture into its file; none where it cannot be drawn.
    fn draw(&self, file: &str, title: &str, colours: Colours) -> Option<PictureNote> {
        let Colours { label, unit, facets, balls, damage } = colours;
        let shown: Vec<f64> = facets.iter().chain(balls).copied().collect();
        let range = if damage { (0.0, 1.0) } else { robust_range(&shown) };
        let paint = if facets.is_empty() { Paint::Plain(GREY) } else { Paint::Facets(facets) };
        let skin = Surface { points: &self.skin.points, triangles: &self.skin.facets, paint, mesh_lines: true };
        let surfaces: Vec<Surface> = std::iter::once(skin).chain(self.rigid.iter().map(steel)).collect();
        let debris = Spheres { centres: &self.debris.0, radii: &self.debris.1, paint: Paint::Plain(PARTICLE) };
        let picture = Picture {
            surfaces: &surfaces,
            spheres: &[debris, Spheres { centres: &self.balls, radii: self.ball_radii, paint: inside(balls) }],
            map: if damage { ColourMap::Damage } else { ColourMap::Viridis },
            range,
            clip: None,
        };
        let image = picture.render(&self.view).ok()?;
        image.write(&self.folder.join("pictures").join(file)).ok()?;
        let scale = picture.scale(&self.view)?;
        Some(PictureNote {
            file: file.to_owned(),
            title: format!("{title} at {}", self.when),
            label: label.to_owned(),
            unit: unit.to_owned(),
            damage,
            range,
            pixels_per_metre: Some(scale.pixels_per_metre),
            axes: scale.axes,
            size: [self.view.width, self.view.height],
            in_strip: false,
        })
    }
}

fn steel(of: &Triangles) -> Surface<'_> {
    Surface { points: &of.points, triangles: &of.triangles, paint: Paint::Plain(STEEL), mesh_lines: false }
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
    let debris = scene.debris.state();
    let shrink = |attached: bool| if attached { ATTACHED } else { 1.0 };
    let radius = |(&n, &attached): (&u32, &bool)| shrink(attached) * scene.debris.radius(n);
    let time = quantity(scene.clock.time, "s");
    let magnified = if scale > 1.0 { format!(", displacements x {scale:.0}") } else { String::new() };
    let studio = Studio {
        folder,
        skin: skin(scene, &shown),
        debris: (
            debris.nodes.iter().map(|&n| shown(n as usize)).collect(),
            debris.nodes.iter().zip(&debris.attached).map(radius).collect(),
        ),
        balls: bonded.reference().iter().zip(&moved).map(|(start, u)| (start + u * scale).into()).collect(),
        ball_radii: &bonded.particles.radius,
        rigid: rigid_bodies(scene, &all),
        view: view_of(&all),
        when: format!("{time}{magnified}"),
    };
    let Skin { damage, stress, .. } = &studio.skin;
    let none = Colours { label: "damage", unit: "1", facets: &[], balls: &[], damage: false };
    let mut notes = Vec::new();
    if damage.iter().any(|&d| d > 0.0) {
        let colours = Colours { facets: damage, damage: true, ..none };
        notes.extend(studio.draw("damage.png", "Damage and discrete elements", colours));
    }
    if !stress.is_empty() {
        let colours = Colours { label: "first principal stress", unit: "Pa", facets: stress, ..none };
        notes.extend(studio.draw("stress.png", "First principal stress", colours));
    }
    if !moved.is_empty() {
        let length: Vec<f64> = moved.iter().map(|u| u.norm()).collect();
        let colours = Colours { label: "displacement", unit: "m", balls: &length, ..none };
        notes.extend(studio.draw("particles.png", "Displacement of particles", colours));
    }
    if scene.count(CountKind::BrokenBonds) > 0 {
        notes.extend(broken_bonds(scene, &studio.balls, &studio.view, folder, &studio.when));
    }
    notes
}

/// Rigid bodies that are not much larger than what they act on; containers would hide their content, planes have no end.
fn rigid_bodies(scene: &Scene, all: &[Vec3]) -> Vec<Triangles> {
    let size = extent(all).norm();
    let drawn = |body: &&RigidBody| match &body.form {
        Form::Shape { shape, hollow } => !hollow && *shape != Shape::HalfSpace,
        Form::Mesh { .. } => true,
    };
    let small = |of: &Triangles| {
        let points: Vec<Vec3> = of.points.iter().map(|x| Vec3::from(*x)).collect();
        extent(&points).norm() < LARGEST_RIGID * size
    };
    scene.contacts.rigid_bodies().iter().filter(drawn).map(|body| outline(body, scene)).filter(small).collect()
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
        pixels_per_metre: None,
        axes: [[0.0; 2]; 3],
        size: [view.width, view.height],
        in_strip: false,
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

pub(crate) fn extent(points: &[Vec3]) -> Vec3 {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    high - low
}

/// Plane bodies are seen straight on, flat ones from their broad side, others from the front, right and above with z up.
pub(crate) fn view_of(points: &[Vec3]) -> View {
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
