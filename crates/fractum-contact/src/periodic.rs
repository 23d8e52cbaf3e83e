//! A box that repeats in space: spheres meet the images of others through its sides.

use fractum_math::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

use crate::broad_phase::close_pairs_of;

/// A box that repeats along some axes, and how it deforms.
///
/// Spheres are not moved back into the box: each is one of its images, and a pair meets by the nearest images of both. An image that is
/// n edges away moves faster by n times the velocity of these edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeriodicCell {
    /// Corner that does not move [m].
    pub corner: Vec3,
    /// Edges as columns [m]; nothing stands below the diagonal.
    pub edges: Mat3,
    /// Velocity of the edges at the half step before [m/s].
    pub velocity: Mat3,
    /// Along which edges it repeats.
    pub repeats: [bool; 3],
}

/// Numbers of edges from a sphere to its image.
pub type Image = [i32; 3];

impl PeriodicCell {
    /// Offset of an image [m].
    pub fn offset(&self, image: &Image) -> Vec3 {
        self.edges * image_vector(image)
    }

    /// Velocity of an image against the sphere [m/s].
    pub fn velocity_of(&self, image: &Image) -> Vec3 {
        self.velocity * image_vector(image)
    }

    /// The image that is nearest to the origin, of what is `apart` from it [m].
    pub fn nearest_image(&self, apart: &Vec3) -> Image {
        let own = self.upright();
        nearest_of(&own, &self.upright_cell(&own), apart)
    }

    /// Σ f ⊗ n from Σ f ⊗ (H n), with the edges n from spheres to their images.
    pub fn by_edges(&self, by_offsets: &Mat3) -> Mat3 {
        solved_columns(&self.edges, &by_offsets.transpose()).transpose()
    }

    /// Volume of the box [m³].
    pub fn volume(&self) -> f64 {
        self.edges.diagonal().product()
    }

    /// Parts of the edges from the corner to a place.
    fn parts(&self, place: &Vec3) -> Vec3 {
        solved(&self.edges, &(place - self.corner))
    }

    /// The edges of the same lattice that are least oblique, in edges of this one.
    fn upright(&self) -> [Image; 3] {
        let mut own = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        for (column, against) in [(1, 0), (2, 1), (2, 0)] {
            if !(self.repeats[column] && self.repeats[against]) {
                continue;
            }
            let oblique = self.offset(&own[column])[against];
            let times = (oblique / self.edges[(against, against)]).round() as i32;
            let by: Image = own[against];
            (0..3).for_each(|k| own[column][k] -= times * by[k]);
        }
        own
    }

    /// This lattice by its least oblique edges.
    fn upright_cell(&self, own: &[Image; 3]) -> PeriodicCell {
        PeriodicCell { edges: Mat3::from_columns(&own.map(|image| self.offset(&image))), ..*self }
    }

    /// Least distance of two opposite sides through which spheres meet [m].
    pub fn narrowest(&self) -> f64 {
        let heights = self.upright_cell(&self.upright()).heights();
        (0..3).filter(|&k| self.repeats[k]).map(|k| heights[k]).fold(f64::INFINITY, f64::min)
    }

    fn heights(&self) -> Vec3 {
        let across = |k: usize| (0..3).map(|axis| solved(&self.edges, &Vec3::ith(axis, 1.0))[k].powi(2)).sum::<f64>();
        Vec3::from_fn(|k, _| 1.0 / across(k).sqrt())
    }

    /// The image of a place that lies in the box, whose edges are the least oblique ones: its offset and velocity against the place
    /// [m, m/s].
    pub fn into_box(&self, place: &Vec3) -> [Vec3; 2] {
        let own = self.upright();
        let parts = self.upright_cell(&own).parts(place);
        let away: Image = std::array::from_fn(|k| if self.repeats[k] { -parts[k].floor() as i32 } else { 0 });
        let image = image_vector(&in_edges(&own, &away));
        [self.edges * image, self.velocity * image]
    }

    /// Edges of the box that is least oblique, as columns [m].
    pub fn least_oblique(&self) -> Mat3 {
        self.upright_cell(&self.upright()).edges
    }

    /// Gradient of the velocity with which the box deforms [1/s].
    pub fn velocity_gradient(&self) -> Mat3 {
        self.velocity * solved_columns(&self.edges, &Mat3::identity())
    }

    /// Velocity of the edges half a step after now, under a gradient without anything below its diagonal: that of Crank and Nicolson,
    /// Ḣ = (1 - Δt L/2)⁻¹ L H, which is exact for simple shear [m/s].
    pub fn velocity_under(&self, gradient: &Mat3, dt: f64) -> Mat3 {
        solved_columns(&(Mat3::identity() - gradient * (0.5 * dt)), &(gradient * self.edges))
    }
}

/// The nearest image by the least oblique edges, in those of the box.
fn nearest_of(own: &[Image; 3], upright: &PeriodicCell, apart: &Vec3) -> Image {
    let parts = solved(&upright.edges, apart);
    in_edges(own, &std::array::from_fn(|k| if upright.repeats[k] { -parts[k].round() as i32 } else { 0 }))
}

/// Pairs of spheres as [`close_pairs`](crate::close_pairs) finds them, in a box that repeats: ascending, with the image of the second sphere
/// that is nearest to the first. Opposite sides must be apart by more than twice the distance at which two spheres are near.
pub fn close_pairs_within(cell: &PeriodicCell, centres: &[Vec3], radii: &[f64], skin: f64) -> Vec<([u32; 2], Image)> {
    let mut images = Images::new(*cell);
    let pairs = images.close_pairs(centres, radii, skin);
    images.note(pairs.iter().copied(), centres);
    pairs.into_iter().zip(images.of_pairs).collect()
}

fn image_vector(image: &Image) -> Vec3 {
    Vec3::from_fn(|k, _| f64::from(image[k]))
}

/// An image by other edges of the lattice, in those of the box.
fn in_edges(own: &[Image; 3], away: &Image) -> Image {
    std::array::from_fn(|k| (0..3).map(|column| own[column][k] * away[column]).sum())
}

/// x of A x = b for a matrix without anything below its diagonal.
fn solved(upper: &Mat3, b: &Vec3) -> Vec3 {
    let z = b.z / upper.m33;
    let y = (b.y - upper.m23 * z) / upper.m22;
    Vec3::new((b.x - upper.m12 * y - upper.m13 * z) / upper.m11, y, z)
}

/// X of A X = B for such a matrix.
fn solved_columns(upper: &Mat3, b: &Mat3) -> Mat3 {
    Mat3::from_columns(&[0, 1, 2].map(|k| solved(upper, &b.column(k).into_owned())))
}

/// The images in which near pairs meet.
#[derive(Clone, Debug)]
pub(crate) struct Images {
    pub(crate) cell: PeriodicCell,
    /// The same when the pairs were found.
    searched: PeriodicCell,
    /// Image of the second sphere that the first one meets, pair by pair.
    pub(crate) of_pairs: Vec<Image>,
}

impl Images {
    pub(crate) fn new(cell: PeriodicCell) -> Self {
        Images { cell, searched: cell, of_pairs: Vec::new() }
    }

    /// Offset and velocity of the second sphere's image of a pair against the sphere [m, m/s].
    #[inline]
    pub(crate) fn shift(&self, pair: usize) -> [Vec3; 2] {
        let image = &self.of_pairs[pair];
        [self.cell.offset(image), self.cell.velocity_of(image)]
    }

    /// Edges from the second sphere of a pair to its image.
    pub(crate) fn edges_between(&self, pair: usize) -> Vec3 {
        image_vector(&self.of_pairs[pair])
    }

    /// Half the way that spheres may have moved against the box since the search [m], and what takes places of the search to those that
    /// the box has brought them to.
    ///
    /// - `reach` [m]: distance at which two spheres touch at most; `skin` [m]: gap up to which they were found
    pub(crate) fn left(&self, reach: f64, skin: f64) -> (f64, Mat3) {
        let carry = self.cell.edges * solved_columns(&self.searched.edges, &Mat3::identity());
        let strain = (carry - Mat3::identity()).norm();
        (0.5 * (skin - strain * (reach + skin)), carry)
    }

    /// Pairs of spheres of which some images are near, ascending; the images follow with [`Images::note`].
    pub(crate) fn close_pairs(&mut self, position: &[Vec3], radius: &[f64], skin: f64) -> Vec<[u32; 2]> {
        self.searched = self.cell;
        let (own, count) = (self.cell.upright(), position.len());
        let upright = self.cell.upright_cell(&own);
        let widest = radius.iter().fold(0.0f64, |a, &b| a.max(b));
        let margin = upright.heights().map(|height| (2.0 * widest + skin) / height);
        let (mut centres, mut radii, mut owners) = (Vec::with_capacity(count), radius.to_vec(), Vec::new());
        let mut ghosts = Vec::new();
        for (place, owner) in position.iter().zip(0u32..) {
            let parts = upright.parts(place);
            let inside =
                Vec3::from_fn(|k, _| if self.cell.repeats[k] { parts[k] - parts[k].floor() } else { parts[k] });
            centres.push(self.cell.corner + upright.edges * inside);
            if radius[owner as usize] < 0.0 {
                continue;
            }
            let sides: [[f64; 2]; 3] = std::array::from_fn(|k| {
                let near = |is_near: bool, to: f64| if is_near && self.cell.repeats[k] { to } else { 0.0 };
                [near(inside[k] < margin[k], 1.0), near(inside[k] > 1.0 - margin[k], -1.0)]
            });
            let along = |k: usize| [0.0].into_iter().chain(sides[k].into_iter().filter(|to| *to != 0.0));
            for x in along(0) {
                for y in along(1) {
                    for z in along(2).filter(|z| [x, y, *z] != [0.0; 3]) {
                        ghosts.push(self.cell.corner + upright.edges * (inside + Vec3::new(x, y, z)));
                        owners.push(owner);
                    }
                }
            }
        }
        centres.append(&mut ghosts);
        radii.extend(owners.iter().map(|&owner| radius[owner as usize]));
        let owner = |i: u32| (i as usize).checked_sub(count).map_or(i, |ghost| owners[ghost]);
        let found = close_pairs_of(&centres, &radii, skin, &|i: usize| i < count);
        let mut pairs: Vec<[u32; 2]> = found
            .into_iter()
            .map(|pair| pair.map(owner))
            .filter(|[i, j]| i != j)
            .map(|[i, j]| [i.min(j), i.max(j)])
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Notes in which images the pairs meet: in the nearest ones.
    pub(crate) fn note(&mut self, pairs: impl Iterator<Item = [u32; 2]>, position: &[Vec3]) {
        let own = self.cell.upright();
        let upright = self.cell.upright_cell(&own);
        let image = |[i, j]: [u32; 2]| nearest_of(&own, &upright, &(position[j as usize] - position[i as usize]));
        self.of_pairs = pairs.map(image).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pairs_of_all_images_are_found_in_boxes_of_any_obliqueness(
            places in prop::collection::vec(prop::array::uniform3(-9f64..9.0), 2..40),
            oblique in prop::array::uniform3(-6f64..6.0),
            repeats in prop::array::uniform3(prop::bool::ANY),
        ) {
            let both = |i: usize, j: usize| if repeats[i] && repeats[j] { 1.0 } else { 0.0 };
            let edges = Mat3::new(
                3.0, oblique[0] * both(0, 1), oblique[1] * both(0, 2),
                0.0, 2.5, oblique[2] * both(1, 2),
                0.0, 0.0, 2.8,
            );
            let cell = PeriodicCell { corner: Vec3::new(0.3, -1.0, 0.1), edges, velocity: Mat3::zeros(), repeats };
            let (radius, skin) = (vec![0.4; places.len()], 0.1);
            prop_assume!(cell.narrowest() > 2.0 * (2.0 * 0.4 + skin));
            let position: Vec<Vec3> = places.iter().map(|x| Vec3::from(*x)).collect();
            let mut images = Images::new(cell);
            let found = images.close_pairs(&position, &radius, skin);
            images.note(found.iter().copied(), &position);
            let mut pairs = found.iter().zip(&images.of_pairs);
            let span = |k: usize| if repeats[k] { 24 } else { 0 };
            for i in 0..position.len() {
                for j in i + 1..position.len() {
                    // Images within reach along z, then along y, then along x.
                    let apart = position[j] - position[i];
                    let mut near: Vec<Image> = Vec::new();
                    for z in (-span(2)..=span(2)).filter(|z| (apart.z + 2.8 * f64::from(*z)).abs() < 0.9) {
                        for y in -span(1)..=span(1) {
                            if cell.offset(&[0, y, z]).y + apart.y < -0.9 || cell.offset(&[0, y, z]).y + apart.y > 0.9 {
                                continue;
                            }
                            near.extend((-3 * span(0)..=3 * span(0)).map(|x| [x, y, z]).filter(|image| {
                                (apart + cell.offset(image)).norm() < 0.9
                            }));
                        }
                    }
                    prop_assert!(near.len() < 2);
                    if let Some(image) = near.first() {
                        let next = pairs.next();
                        prop_assert_eq!(next, Some((&[i as u32, j as u32], image)));
                    }
                }
            }
            prop_assert!(pairs.next().is_none());
            for x in &position {
                let within = cell.upright_cell(&cell.upright()).parts(&(x + cell.into_box(x)[0]));
                prop_assert!((0..3).all(|k| !repeats[k] || (-1e-9..1.0 + 1e-9).contains(&within[k])));
            }
        }
    }
}
