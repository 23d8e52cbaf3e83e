//! Bonds through the sides of a box that repeats.

use fractum_contact::{Image, PeriodicCell};
use fractum_kernels::bond::BondLaw;
use fractum_math::{Mat3, Vec3};

use super::network::BondNetwork;
use crate::particles::Particles;

/// Takes the box as it is now; without effect on bonds that are in none.
pub(super) fn set_cell<L: BondLaw>(network: &mut BondNetwork<L>, cell: &PeriodicCell) {
    let BondNetwork { through: Some(through), blocks, .. } = network else { return };
    let moves = through.cell.edges != cell.edges;
    through.cell = *cell;
    for block in blocks.iter_mut().filter(|_| moves) {
        let (first, count) = (block.first_bond as usize, block.bonds);
        block.through.iter_mut().for_each(|own| own.place(through, first, count));
    }
}

/// The box in which bonds repeat, with the images of the second particles that they join the first ones to.
pub(super) fn through_box<L: BondLaw>(network: &BondNetwork<L>) -> Option<(&PeriodicCell, &[Image])> {
    network.through.as_ref().map(|through| (&through.cell, &through.images[..]))
}

/// From the first particle of a bond to the second, or to the image that it is bonded to [m].
pub(super) fn gap<L: BondLaw>(network: &BondNetwork<L>, bond: usize, particles: &Particles) -> Vec3 {
    let [first, second] = network.pair(bond, particles).position;
    second - first
}

/// The ends of a bond by places in the undeformed body, the second one where the image is that it joins [m].
pub(super) fn ends<L: BondLaw>(network: &BondNetwork<L>, bond: usize, reference: &[Vec3]) -> [Vec3; 2] {
    let [first, mut second] = network.pairs[bond].map(|i| reference[i as usize]);
    if let Some(through) = &network.through {
        second += through.start.offset(&through.images[bond]);
    }
    [first, second]
}

/// Sums over the bonds at the last pass, with forces f on the second particles [N]: Σ f ⊗ n with the edges n of the box between a
/// particle and its image [N], and Σ f ⊗ r with the gaps r [N m]; none without such a box.
pub(super) fn sums<L: BondLaw>(network: &BondNetwork<L>) -> Option<[Mat3; 2]> {
    let through = network.through.as_ref()?;
    let of_blocks = network.blocks.iter().filter_map(|block| block.through.as_ref());
    let none = [Mat3::zeros(); 2];
    let [by_offsets, virial] = of_blocks.fold(none, |[offsets, gaps], block| {
        let [own_offsets, own_gaps] = block.sums();
        [offsets + own_offsets, gaps + own_gaps]
    });
    Some([through.cell.by_edges(&by_offsets), virial])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bond::{BeamSection, Bonds};
    use fractum_math::{Mat3, Rotation};

    /// Particles along an edge of the box, and their distance [m].
    const COUNT: usize = 4;
    const APART: f64 = 2.0;

    /// A cubic lattice of beams in a box of [`COUNT`]³ particles, each of which stands in some image of the box.
    fn lattice(section: BeamSection) -> (Particles, Bonds, PeriodicCell) {
        let size = APART * COUNT as f64;
        let edges = Mat3::identity() * size;
        let cell = PeriodicCell { corner: Vec3::zeros(), edges, velocity: Mat3::zeros(), repeats: [true; 3] };
        let at = |i: usize| [i % COUNT, i / COUNT % COUNT, i / COUNT / COUNT];
        let number = |at: [usize; 3]| (at[0] + COUNT * (at[1] + COUNT * at[2])) as u32;
        let place = |i: usize| {
            let image = Vec3::from_fn(|k, _| ((i * (k + 2)) % 5) as f64 - 2.0);
            Vec3::from(at(i).map(|k| k as f64 * APART)) + image * size
        };
        let position: Vec<Vec3> = (0..COUNT.pow(3)).map(place).collect();
        let next = |i: usize, axis: usize| {
            let mut other = at(i);
            other[axis] = (other[axis] + 1) % COUNT;
            [i as u32, number(other)]
        };
        let pairs: Vec<[u32; 2]> = (0..position.len()).flat_map(|i| [0, 1, 2].map(|axis| next(i, axis))).collect();
        let mass = position.len() as f64;
        let particles = Particles::at_rest(position, vec![0.5 * APART; COUNT.pow(3)], mass).unwrap();
        let bonds = Bonds::within(&particles, &pairs, &[], section, Some(&cell)).unwrap();
        (particles, bonds, cell)
    }

    /// The lattice after a small uniform gradient of displacement, whose particles turn with its rotation; stress over the box [Pa], and energy
    /// over its volume [Pa].
    fn strained(section: BeamSection, gradient: Mat3) -> (Mat3, f64) {
        let (mut particles, mut bonds, mut cell) = lattice(section);
        let move_by = Mat3::identity() + gradient;
        particles.position.iter_mut().for_each(|x| *x = move_by * *x);
        let spin =
            Vec3::new(gradient.m32 - gradient.m23, gradient.m13 - gradient.m31, gradient.m21 - gradient.m12) * 0.5;
        particles.orientation.fill(Rotation::from_scaled_axis(spin));
        cell.edges = move_by * cell.edges;
        bonds.set_cell(&cell);
        particles.clear_forces();
        bonds.add_forces(&mut particles);
        let [through, virial] = bonds.sums_through_box().unwrap();
        let volume = cell.volume();
        // Nothing of a uniform lattice is out of balance, and it is the sides that bear it.
        let size = virial.norm() / APART;
        assert!(particles.force.iter().all(|force| force.norm() < 1e-9 * size));
        // Places of some boxes round such small strains off by 1e-8.
        assert!((through * cell.edges.transpose() - virial).norm() < 1e-6 * virial.norm());
        (-virial / volume, bonds.energy(&particles).total() / volume)
    }

    #[test]
    fn a_cubic_lattice_has_the_stress_and_the_energy_of_its_beams() {
        let section = BeamSection::new(3e9, 0.6).unwrap();
        let strain = 1e-6;
        // Along the edges EA/a²; in shear both rows of beams bend by half the angle, with 12 EI/a³ each.
        let along = section.axial() / APART.powi(2);
        let across = 6.0 * section.bending() / APART.powi(4);
        for axis in 0..3 {
            let mut gradient = Mat3::zeros();
            gradient[(axis, axis)] = strain;
            let (stress, energy) = strained(section, gradient);
            assert!((stress - gradient * along).norm() < 1e-5 * along * strain, "{stress}");
            assert!((energy / (0.5 * along * strain * strain) - 1.0).abs() < 1e-5);
        }
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            let mut gradient = Mat3::zeros();
            gradient[(row, column)] = strain;
            let (stress, energy) = strained(section, gradient);
            let expected = (gradient + gradient.transpose()) * across;
            assert!((stress - expected).norm() < 1e-5 * across * strain, "{stress} {expected}");
            assert!((energy / (0.5 * across * strain * strain) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn bonds_join_the_nearest_images_wherever_their_particles_stand() {
        let (mut particles, mut bonds, cell) = lattice(BeamSection::new(3e9, 0.6).unwrap());
        assert!((0..bonds.len()).all(|bond| (bonds.length(bond) - APART).abs() < 1e-12));
        let way = Vec3::new(17.3, -40.1, 8.9);
        particles.position.iter_mut().for_each(|x| *x += way);
        bonds.set_cell(&cell);
        particles.clear_forces();
        bonds.add_forces(&mut particles);
        let rounding = 3e9 * APART * 1e-14;
        assert!(particles.force.iter().chain(&particles.moment).all(|force| force.norm() < 100.0 * rounding));
        let narrow = bonds.gap(0, &particles);
        assert!((narrow.norm() - APART).abs() < 1e-12);
    }
}
