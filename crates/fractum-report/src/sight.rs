//! What pictures show of one instant, whether the scene itself or one of its frames says it.

use fractum_math::Vec3;
use fractum_output::frames::Triangles;
use fractum_output::number::significant;

use crate::picture::{ColourMap, Image, Paint, Picture, PictureError, Scale, Spheres, Surface, View};

/// The largest displacement in a picture, as a fraction of the size of the body.
const SHOWN_DISPLACEMENT: f64 = 0.04;

/// The largest change of length, or rotation, of facets in a picture: beyond it shapes are no longer those of the body.
const SHOWN_STRAIN: f64 = 0.2;

/// Share of the facets that keep within it: those at cracks open as far as they do.
const WITHIN: f64 = 0.98;

/// Width and largest height of the pictures of the report [pixels].
pub(crate) const WIDTH: usize = 900;
pub(crate) const HEIGHT: usize = 760;
/// Their least height.
const LEAST_HEIGHT: usize = 340;

/// What a picture shows but does not colour.
const GREY: [u8; 3] = [150, 150, 150];

/// Colour of discrete elements.
const PARTICLE: [u8; 3] = [200, 120, 40];

/// Radius in pictures of discrete elements that an element still holds, over their own: cracks show between them.
const ATTACHED: f64 = 0.3;

/// Colour of rigid bodies.
const STEEL: [u8; 3] = [176, 182, 190];

/// Broken bonds of a particle that show in full colour.
pub(crate) const LOST_BONDS: f64 = 5.0;

/// Balls in space.
#[derive(Clone, Debug, Default)]
pub(crate) struct Balls {
    /// Centres [m].
    pub(crate) centres: Vec<[f64; 3]>,
    /// Radii [m], one per centre.
    pub(crate) radii: Vec<f64>,
}

/// What is to be seen, with magnified displacements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sight {
    /// The surface of the solids.
    pub(crate) skin: Triangles,
    /// Discrete elements.
    pub(crate) debris: Balls,
    /// Bonded and loose particles.
    pub(crate) balls: Balls,
    /// Rigid bodies, where they are: what they act on moves little where its displacements are magnified.
    pub(crate) rigid: Triangles,
}

/// What the colours of a picture are.
#[derive(Clone, Copy)]
pub(crate) struct Colours<'a> {
    /// Values of the facets of the skin; none leaves them grey.
    pub(crate) facets: &'a [f64],
    /// Values of the bonded and loose particles; none leaves them grey.
    pub(crate) balls: &'a [f64],
    pub(crate) map: ColourMap,
    /// Values at the ends of the map.
    pub(crate) range: (f64, f64),
}

impl Sight {
    /// Draws it; the image with its scale.
    ///
    /// - `mesh_lines`: whether the edges of the skin are drawn
    ///
    /// # Errors
    /// [`PictureError`].
    pub(crate) fn draw(
        &self,
        colours: Colours,
        view: &View,
        mesh_lines: bool,
    ) -> Result<(Image, Option<Scale>), PictureError> {
        let Colours { facets, balls, map, range } = colours;
        let paint = if facets.is_empty() { Paint::Plain(GREY) } else { Paint::Facets(facets) };
        let inner = if balls.is_empty() { Paint::Plain(GREY) } else { Paint::Nodes(balls) };
        let picture = Picture {
            surfaces: &[Surface { paint, mesh_lines, ..steel(&self.skin) }, steel(&self.rigid)],
            spheres: &[spheres(&self.debris, Paint::Plain(PARTICLE)), spheres(&self.balls, inner)],
            map,
            range,
            clip: None,
        };
        Ok((picture.render(view)?, picture.scale(view)))
    }
}

fn steel(of: &Triangles) -> Surface<'_> {
    Surface { points: &of.points, triangles: &of.triangles, paint: Paint::Plain(STEEL), mesh_lines: false }
}

fn spheres<'a>(of: &'a Balls, paint: Paint<'a>) -> Spheres<'a> {
    Spheres { centres: &of.centres, radii: &of.radii, paint }
}

/// Radius in pictures of a discrete element.
///
/// - `attached`: whether an element still holds it
pub(crate) fn shown_radius(radius: f64, attached: bool) -> f64 {
    if attached { ATTACHED * radius } else { radius }
}

/// How much larger displacements are drawn than they are: small ones are magnified, large ones shown as they are.
///
/// - `size`: of the bodies [m]
/// - `largest`: displacement [m]
/// - `strains`: those of facets, by [`strain_of`]; none where they are not known
pub(crate) fn magnification(size: f64, largest: f64, mut strains: Vec<f64>) -> f64 {
    if largest <= 0.0 {
        return 1.0;
    }
    let wanted = SHOWN_DISPLACEMENT * size / largest;
    strains.sort_by(f64::total_cmp);
    let strain = strains.get((WITHIN * strains.len() as f64) as usize).copied().unwrap_or(0.0);
    let most = if strain > 0.0 { SHOWN_STRAIN / strain } else { f64::INFINITY };
    wanted.min(most).max(1.0)
}

/// How far the corners of a facet have moved against each other over its longest side.
pub(crate) fn strain_of(corners: [Vec3; 3], moved: [Vec3; 3]) -> f64 {
    let longest = |of: [Vec3; 3]| [0, 1, 2].map(|i| (of[(i + 1) % 3] - of[i]).norm()).into_iter().fold(0.0, f64::max);
    longest(moved) / longest(corners)
}

/// The magnification in words, after the instant.
pub(crate) fn magnified(scale: f64) -> String {
    if scale < 1.05 { String::new() } else { format!(", displacements ×\u{a0}{}", significant(scale, 2)) }
}

/// Plane bodies are seen straight on, flat ones from their broad side, others from the front, right and above with z up.
///
/// - `size`: along the axes [m]
pub(crate) fn view_of(size: Vec3) -> View {
    let camera = if size.z == 0.0 {
        View { direction: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], ..View::default() }
    } else if size.z < 0.75 * size.x.min(size.y) {
        View { direction: [-0.35, -0.25, -1.0], up: [0.0, 1.0, 0.0], ..View::default() }
    } else {
        View::default()
    };
    View { width: WIDTH, height: height_of(size), ..camera }
}

/// Height of a picture: plane bodies that are long along x need less, with room for the scale below them [pixels].
fn height_of(size: Vec3) -> usize {
    let drawn = WIDTH as f64 * size.y / size.x + 150.0;
    if size.z == 0.0 && drawn.is_finite() { (drawn as usize).clamp(LEAST_HEIGHT, HEIGHT) } else { HEIGHT }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnification_is_bounded_by_displacements_and_strains() {
        assert_eq!(magnification(1.0, 1e-3, Vec::new()), 40.0);
        assert_eq!(magnification(1.0, 1e-3, vec![1e-4; 100]), 40.0);
        assert_eq!(magnification(1.0, 1e-3, vec![2e-2; 100]), 10.0);
        // One facet at a crack does not count, and nothing is made smaller.
        let mut cracked = vec![1e-4; 100];
        cracked[7] = 1.0;
        assert_eq!(magnification(1.0, 1e-3, cracked), 40.0);
        assert_eq!(magnification(1.0, 0.5, vec![1.0; 9]), 1.0);
    }
}
