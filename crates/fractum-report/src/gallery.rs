//! Pictures of a scene: its surface with the particles, coloured by damage, stress and temperature.

use std::path::Path;

use fractum_fem::{fields, neighbours};
use fractum_math::Vec3;
use fractum_output::atomic::Group;
use fractum_output::frames::cracks::lost_bonds;
use fractum_output::frames::{Triangles, corners, drawn_surfaces, extent};
use fractum_output::notes::{BROKEN_BONDS, CLOSER, DAMAGE, PARTICLES, PictureNote, STRESS, TEMPERATURE};
use fractum_scene::{BondedBody, CountKind, Scene, into_periodic_box};
use serde::{Deserialize, Serialize};

use crate::picture::{ColourMap, View, robust_range};
use crate::sight::{Balls, Colours, LOST_BONDS, Sight, magnification, magnified, shown_radius, strain_of, view_of};

/// Damage of an element that counts as cracked.
const CRACKED: f64 = 0.5;

/// Extent of all cracks over that of the bodies below which they have a picture of their own.
const SMALL: f64 = 0.15;

/// Shortest over next side of what is seen from its broad side.
const FLAT: f64 = 0.35;

/// What is seen of the solids from outside: facets, with damage and first principal stress [Pa] of the elements behind them.
#[derive(Default, Serialize, Deserialize)]
pub struct Skin {
    facets: Vec<[u32; 3]>,
    damage: Vec<f64>,
    stress: Vec<f64>,
}

impl Skin {
    /// That of a scene; of one of several processes that share a mesh its part of it.
    pub fn of(scene: &Scene) -> Self {
        let solid = &scene.solid;
        let mut skin = Skin::default();
        for body in 0..solid.body_count() {
            let facets = neighbours::skin(solid, body);
            // Elements share edges: where most of them are seen, the values of all edges are found once.
            let most = (6 * facets.len() > solid.alive(body).len()).then(|| fields::element_fields(solid, body, None));
            for (nodes, element) in facets {
                let of_element = |all: &Vec<_>| all[element as usize];
                let (stress, damage) =
                    most.as_ref().map_or_else(|| fields::element_field(solid, body, element, None), of_element);
                skin.facets.push(nodes);
                skin.damage.push(damage);
                skin.stress.push(stress.principal_values()[0]);
            }
        }
        skin
    }

    /// One of several parts.
    pub fn joined(parts: Vec<Skin>) -> Self {
        let add = |mut all: Skin, part: Skin| {
            all.facets.extend(part.facets);
            all.damage.extend(part.damage);
            all.stress.extend(part.stress);
            all
        };
        parts.into_iter().reduce(add).unwrap_or_default()
    }
}

/// What all pictures of a scene have in common.
#[derive(Clone)]
struct Studio<'a> {
    folder: &'a Path,
    sight: Sight,
    view: View,
    /// The instant, and how displacements are drawn.
    when: String,
}

/// What the colours of a picture are.
struct Field<'a> {
    label: &'a str,
    unit: &'a str,
    /// Values of the facets of the skin; none leaves them grey.
    facets: &'a [f64],
    /// Values of the particles.
    balls: &'a [f64],
    damage: bool,
}

impl Studio<'_> {
    /// What cracks in solids are seen from, where they are small against the bodies.
    ///
    /// - `size`: of the bodies [m]
    fn near(&self, skin: &Skin, size: f64) -> Option<View> {
        let cracked = skin.facets.iter().zip(&skin.damage).filter(|(_, damage)| **damage >= CRACKED);
        let points: Vec<Vec3> = cracked
            .flat_map(|(facet, _)| facet.map(|node| Vec3::from(self.sight.skin.points[node as usize])))
            .chain(self.sight.debris.centres.iter().map(|centre| Vec3::from(*centre)))
            .collect();
        let [low, high] = corners(points.iter());
        let extent = (high - low).norm();
        if points.is_empty() || extent > SMALL * size {
            return None;
        }
        let around = Vec3::repeat(0.25 * extent + 0.02 * size);
        Some(View { frame: Some(((low - around).into(), (high + around).into())), ..self.view })
    }

    /// Draws a picture into its file; none where it cannot be drawn.
    fn draw(&self, files: &mut Group, file: &str, title: &str, field: Field) -> Option<PictureNote> {
        let Field { label, unit, facets, balls, damage } = field;
        let shown: Vec<f64> = facets.iter().chain(balls).copied().collect();
        let range = if damage { (0.0, 1.0) } else { robust_range(&shown) };
        let map = if damage { ColourMap::Damage } else { ColourMap::Viridis };
        let (image, scale) = self.sight.draw(Colours { facets, balls, map, range }, &self.view, true).ok()?;
        let scale = scale?;
        files.add(&self.folder.join("pictures").join(file), &image.to_png().ok()?);
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
            ..PictureNote::default()
        })
    }
}

/// Draws the scene for the folder `pictures` of the results; a picture that cannot be drawn is left out.
///
/// - `skin`: that of its solids
/// - `instant`: the instant in words
/// - `files`: takes the pictures
pub fn draw(scene: &Scene, skin: Skin, folder: &Path, instant: &str, files: &mut Group) -> Vec<PictureNote> {
    let (solid, bonded) = (&scene.solid, &scene.bonded);
    let size = extent(solid.reference.iter().chain(bonded.reference()));
    let attached = scene.attached_nodes();
    let of_nodes = (0..attached.len()).filter(|&n| attached[n]).map(|n| solid.displacement_from_start(n).norm());
    let places = bonded.particles.position.iter().map(|x| x + into_periodic_box(scene, x)[0]);
    let moved: Vec<Vec3> = places.zip(bonded.reference()).map(|(x, start)| x - start).collect();
    let largest = of_nodes.chain(moved.iter().map(|u| u.norm())).fold(0.0, f64::max);
    let Skin { facets, damage, stress } = &skin;
    let strain = |facet: &[u32; 3]| {
        let corners = facet.map(|node| solid.reference[node as usize]);
        strain_of(corners, facet.map(|node| solid.displacement_from_start(node as usize)))
    };
    let strains = facets.iter().zip(damage).filter(|(_, damage)| **damage < CRACKED).map(|(facet, _)| strain(facet));
    let scale = magnification(size.norm(), largest, strains.collect());
    let shown = |n: usize| -> [f64; 3] { (solid.reference[n] + solid.displacement_from_start(n) * scale).into() };
    let debris = scene.debris.state();
    let radius = |(&n, &attached): (&u32, &bool)| shown_radius(scene.debris.radius(n), attached);
    let points = (0..solid.reference.len()).map(shown).collect();
    let studio = Studio {
        folder,
        sight: Sight {
            skin: Triangles { points, triangles: facets.clone() },
            debris: Balls {
                centres: debris.nodes.iter().map(|&n| shown(n as usize)).collect(),
                radii: debris.nodes.iter().zip(&debris.attached).map(radius).collect(),
            },
            balls: Balls {
                centres: bonded.reference().iter().zip(&moved).map(|(start, u)| (start + u * scale).into()).collect(),
                radii: bonded.particles.radius.clone(),
            },
            rigid: drawn_surfaces(scene),
        },
        view: view_of(size),
        when: format!("{instant}{}", magnified(scale)),
    };
    let none = Field { label: "damage", unit: "1", facets: &[], balls: &[], damage: false };
    let mut notes = Vec::new();
    if damage.iter().any(|&d| d > 0.0) {
        let field = Field { facets: damage, damage: true, ..none };
        notes.extend(studio.draw(files, DAMAGE, "Damage and discrete elements", field));
        if let Some(view) = studio.near(&skin, size.norm()) {
            let field = Field { facets: damage, damage: true, ..none };
            let title = "The cracks of this picture, closer,";
            notes.extend(Studio { view, ..studio.clone() }.draw(files, CLOSER, title, field));
        }
    }
    // Heat alone leaves bodies as they are.
    let acts = |values: &[f64]| !values.is_empty() && (scene.heat().is_none() || values.iter().any(|&x| x != 0.0));
    if acts(stress) {
        let field = Field { label: "first principal stress", unit: "Pa", facets: stress, ..none };
        notes.extend(studio.draw(files, STRESS, "First principal stress", field));
    }
    if let Some(heat) = scene.heat() {
        let facets = studio.sight.skin.means(heat.of_nodes());
        let field = Field { label: "temperature", unit: "K", facets: &facets, balls: heat.of_particles(), ..none };
        notes.extend(studio.draw(files, TEMPERATURE, "Temperature", field));
    }
    let length: Vec<f64> = moved.iter().map(|u| u.norm()).collect();
    if acts(&length) {
        let field = Field { label: "displacement", unit: "m", balls: &length, ..none };
        notes.extend(studio.draw(files, PARTICLES, "Displacement of particles", field));
    }
    if scene.count(CountKind::BrokenBonds) > 0 {
        notes.extend(broken_bonds(scene, &studio, files));
    }
    notes
}

/// Pixels of the pictures that a scene is expected to have at its end.
pub fn expected_pixels(scene: &Scene) -> f64 {
    let View { width, height, .. } = view_of(Vec3::zeros());
    let has_solids = scene.solid.body_count() > 0;
    let pictures = [has_solids, scene.solid.has_damage(), scene.heat().is_some(), !scene.bonded.is_empty()];
    let count = pictures.into_iter().chain([scene.bonded.can_break()]).filter(|&is_there| is_there).count();
    (count * width * height) as f64
}

/// Bonded bodies cut open in the middle of what broke, seen straight on and coloured by the bonds that particles have lost: along
/// their broad side where they are flat, upright elsewhere.
fn broken_bonds(scene: &Scene, studio: &Studio, files: &mut Group) -> Option<PictureNote> {
    let (bonded, balls) = (&scene.bonded, &studio.sight.balls.centres);
    let lost = lost_bonds(balls.len(), bonded.bodies().iter().flat_map(BondedBody::cracks));
    let reference = bonded.reference();
    let size = extent(reference.iter());
    let thin = size.imin();
    let flat = size[thin] < FLAT * size[(thin + 1) % 3].min(size[(thin + 2) % 3]);
    let axis = if flat { thin } else { 1 };
    let mut look = Vec3::zeros();
    look[axis] = if axis == 2 { -1.0 } else { 1.0 };
    let up = if axis == 2 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let view = View { direction: look.into(), up, ..studio.view };
    let depth = |i: usize| reference[i].dot(&look);
    let middle = (0..balls.len()).map(|i| lost[i] * depth(i)).sum::<f64>() / lost.iter().sum::<f64>();
    let drawn = |i: usize| depth(i) >= middle && !bonded.particles.is_out(i);
    let kept: Vec<usize> = (0..balls.len()).filter(|&i| drawn(i)).collect();
    let centres: Vec<[f64; 3]> = kept.iter().map(|&i| balls[i]).collect();
    let radii: Vec<f64> = kept.iter().map(|&i| bonded.particles.radius[i]).collect();
    let values: Vec<f64> = kept.iter().map(|&i| lost[i]).collect();
    let colours = Colours { facets: &[], balls: &values, map: ColourMap::Damage, range: (0.0, LOST_BONDS) };
    let section = Sight { balls: Balls { centres, radii }, ..Sight::default() };
    let file = BROKEN_BONDS.to_owned();
    let image = section.draw(colours, &view, false).ok()?.0;
    files.add(&studio.folder.join("pictures").join(&file), &image.to_png().ok()?);
    Some(PictureNote {
        file,
        title: format!("Section through what broke: bonds that particles have lost at {}", studio.when),
        label: "broken bonds".to_owned(),
        unit: "1".to_owned(),
        damage: true,
        range: colours.range,
        size: [view.width, view.height],
        ..PictureNote::default()
    })
}
