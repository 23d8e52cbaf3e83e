//! Bonded bodies that go on through the sides of a box that repeats.

use fractum_contact::{Image, PeriodicCell};
use fractum_dem::{Fracture, Particles};
use fractum_math::{Mat3, connected};

use super::{Bonded, BondedBody};

/// Takes the box as it is now.
pub(crate) fn set_cell(bonded: &mut Bonded, cell: &PeriodicCell) {
    for BondedBody { bonds, fracture, .. } in &mut bonded.bodies {
        bonds.set_cell(cell);
        fracture.iter_mut().for_each(|fracture| fracture.set_cell(cell));
    }
}

/// Takes the velocity of the edges of the half step that begins, while the edges are those of the forces.
pub(crate) fn set_cell_velocity(bonded: &mut Bonded, velocity: &Mat3) {
    for BondedBody { bonds, fracture, .. } in &mut bonded.bodies {
        let Some((cell, _)) = bonds.through_box() else { continue };
        let cell = PeriodicCell { velocity: *velocity, ..*cell };
        bonds.set_cell(&cell);
        fracture.iter_mut().for_each(|fracture| fracture.set_cell(&cell));
    }
}

/// Sums over bonds and crack faces, see [`fractum_dem::Bonds::sums_through_box`]; zero where there are none in such a box.
pub(crate) fn sums_through_box(bonded: &Bonded) -> [Mat3; 2] {
    let of_bonds = bonded.bodies.iter().filter_map(|body| body.bonds.sums_through_box());
    let of_faces = bonded.bodies.iter().filter_map(|body| body.fracture.as_ref()?.sums_through_box());
    of_bonds.chain(of_faces).fold([Mat3::zeros(); 2], |[a, b], [c, d]| [a + c, b + d])
}

/// Pairs of particles of bonded bodies that touch where no bond joins them.
pub(crate) fn touching_faces(bonded: &Bonded) -> usize {
    let of = |body: &BondedBody| body.fracture.as_ref().map_or(0, |own| own.touching(&bonded.particles).count());
    bonded.bodies.iter().map(of).sum()
}

/// Least distance of opposite sides of a box that repeats in which bonded particles meet one image of another only [m].
pub fn narrowest_box(bonded: &Bonded) -> f64 {
    let of = |body: &BondedBody| {
        let longest = (0..body.bonds.len()).map(|bond| body.bonds.length(bond)).fold(0.0, f64::max);
        let strangers =
            if body.can_break() { Fracture::reach(&bonded.particles.radius[body.range.clone()]) } else { 0.0 };
        2.0 * longest.max(strangers)
    };
    bonded.bodies.iter().filter(|body| !body.bonds.is_empty()).map(of).fold(0.0, f64::max)
}

/// The particles with the pieces put together that sides of a box that repeats divide; as they stand without such a box. A piece that
/// goes on through the box for ever stays where its first particle is.
pub(super) fn whole_pieces(bonded: &Bonded) -> Option<Particles> {
    let cell = bonded.bodies.iter().find_map(|body| body.bonds.through_box())?.0;
    let of_body = |body: &'_ BondedBody| {
        let images = body.bonds.through_box().map_or_else(Vec::new, |(_, images)| images.to_vec());
        let held = (0..body.bonds.len()).filter(|&bond| body.is_joined(bond));
        held.map(|bond| (body.bonds.pairs()[bond], images[bond])).collect::<Vec<_>>()
    };
    let bonds: Vec<([u32; 2], Image)> = bonded.bodies.iter().flat_map(of_body).collect();
    let within = bonds.iter().filter(|(_, image)| *image == [0; 3]).map(|(pair, _)| *pair);
    let part = connected(bonded.particles.len(), within);
    // Parts on both sides of a bond through a side, and the image of the second one.
    let mut beside: Vec<Vec<(usize, Image)>> = vec![Vec::new(); part.len()];
    for (pair, image) in bonds.iter().filter(|(_, image)| *image != [0; 3]) {
        let [first, second] = pair.map(|i| part[i as usize] as usize);
        beside[first].push((second, *image));
        beside[second].push((first, image.map(|edges| -edges)));
    }
    let mut image_of: Vec<Option<Image>> = vec![None; part.len()];
    for start in 0..part.len() {
        if part[start] as usize != start || image_of[start].is_some() {
            continue;
        }
        image_of[start] = Some([0; 3]);
        let mut next = vec![(start, [0; 3])];
        while let Some((from, known)) = next.pop() {
            for &(to, image) in &beside[from] {
                if image_of[to].is_none() {
                    let there: Image = std::array::from_fn(|k| known[k] + image[k]);
                    image_of[to] = Some(there);
                    next.push((to, there));
                }
            }
        }
    }
    let mut all = bonded.particles.clone();
    for (i, part) in part.iter().enumerate() {
        let image = image_of[*part as usize].unwrap_or_default();
        all.position[i] += cell.offset(&image);
        all.velocity[i] += cell.velocity_of(&image);
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use fractum_dem::{BeamSection, Clumps};
    use fractum_math::Vec3;

    use super::*;
    use crate::bonded::BondedPart;

    #[test]
    fn a_piece_that_a_side_divides_is_put_together_again() {
        // A row of five particles through the side at x = 0, bonded from the third on: 2, 3 and 4, 0 are two pieces, and 1 is alone.
        let size = 5.0;
        let edges = Mat3::identity() * size;
        let velocity = Mat3::new(0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let cell = PeriodicCell { corner: Vec3::zeros(), edges, velocity, repeats: [true; 3] };
        let position: Vec<Vec3> = (0..5).map(|i| Vec3::new(f64::from(i) + 0.5, 2.0, 2.0)).collect();
        let part = BondedPart {
            name: "row".into(),
            particles: Particles::at_rest(position, vec![0.5; 5], 5.0).unwrap(),
            pairs: vec![[2, 3], [0, 4]],
            law: BeamSection::new(1e9, 0.3).unwrap().into(),
            shares: Vec::new(),
            density: 1.0,
            fraction: 0.64,
            fracture: None,
            clumps: Clumps::default(),
        };
        let bonded = Bonded::within(vec![part], Some(&cell)).unwrap();
        let found = bonded.fragments();
        let members: Vec<&[u32]> = found.iter().map(|piece| &piece.nodes[..]).collect();
        assert_eq!(members, [&[0, 4][..], &[1], &[2, 3]]);
        // The second particle stands where the image is that the first one is bonded to, and moves with it.
        assert_eq!(found[0].bounds, [Vec3::new(-1.0, 1.5, 1.5), Vec3::new(1.0, 2.5, 2.5)]);
        assert_eq!((found[0].centroid, found[0].velocity), (Vec3::new(0.0, 2.0, 2.0), Vec3::new(-0.05, 0.0, 0.0)));
        assert_eq!(found[2].centroid, Vec3::new(3.0, 2.0, 2.0));
        assert_eq!(bonded.bodies()[0].bonds.length(0), 1.0);
        assert_eq!(narrowest_box(&bonded), 2.0);
    }
}
