//! Mean strain of a set of points as a weighted sum of their displacements and rotations.

use fractum_math::{Mat3, Rotation, Sym3, Vec3};

use super::strain::{fit_moments, small_part_of_stretch};
use crate::cells::{Tessellation, corner_areas};

/// How the strain of a set of particles is defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StrainMeasure {
    /// The affine field closest to the displacements of all points (Cundall; Jebahi et al. 2015, eqs. 1.19–1.29).
    #[default]
    Cundall,
    /// Mean over the space cells between the centres, in which displacements are linear (Bagi; eqs. 1.14–1.18).
    Bagi,
    /// From relative displacements at the contact points, rotations of the particles included, over the faces of their Dirichlet
    /// cells (Satake; eqs. 1.30–1.34). Cells at the border of the set are open and left out: the volume of eq. 1.33 is then the
    /// tensor Σ l ⊗ d, which is V I for closed cells, so that uniform strain comes out as it is.
    Satake,
}

/// A set of points whose mean strain is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainGauge {
    points: Vec<GaugePoint>,
    /// Direction across all points where they lie in a plane: strains with it are not measured, and zero.
    pub normal: Option<Vec3>,
}

/// What a point adds to the mean displacement gradient: u ⊗ weight + (R − I) arm.
#[derive(Clone, Debug, PartialEq)]
struct GaugePoint {
    point: u32,
    weight: Vec3,
    arm: Mat3,
}

impl StrainGauge {
    /// None where the points do not span a volume, or for [`StrainMeasure::Cundall`] a plane.
    ///
    /// - `set`: the points, ascending
    /// - `position`: of any point without load [m]
    /// - `radius`: of any point [m], > 0; not read for [`StrainMeasure::Cundall`]
    pub fn new(
        measure: StrainMeasure,
        set: &[u32],
        position: impl Fn(usize) -> Vec3,
        radius: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let centre: Vec<Vec3> = set.iter().map(|&i| position(i as usize)).collect();
        let still = |(&point, weight): (&u32, Vec3)| GaugePoint { point, weight, arm: Mat3::zeros() };
        if measure == StrainMeasure::Cundall {
            let moments = fit_moments(centre.iter().copied());
            let (inverse, normal) = moments.inverse_in_plane()?;
            let points = set.iter().zip(centre.iter().map(|x| inverse * (x - moments.centre))).map(still);
            return Some(StrainGauge { points: points.collect(), normal });
        }
        let radius: Vec<f64> = set.iter().map(|&i| radius(i as usize)).collect();
        let cells = Tessellation::new(&centre, &radius, 0);
        if measure == StrainMeasure::Bagi {
            let weights = space_cells(&cells.tetrahedra, &centre)?;
            return Some(StrainGauge { points: set.iter().zip(weights).map(still).collect(), normal: None });
        }
        let mut points: Vec<GaugePoint> = set.iter().map(|point| still((point, Vec3::zeros()))).collect();
        let sum = |m: Mat3, ([i, j], area): &([u32; 2], Vec3)| {
            m + area * (centre[*j as usize] - centre[*i as usize]).transpose()
        };
        let inverse = cells.faces.iter().fold(Mat3::zeros(), sum).try_inverse()?;
        for ([i, j], area) in &cells.faces {
            let (i, j) = (*i as usize, *j as usize);
            let way = centre[j] - centre[i];
            let gap = way.norm() - radius[i] - radius[j];
            let to_contact = way.normalize() * (radius[i] + 0.5 * gap);
            let dual = inverse * area;
            points[j].weight += dual;
            points[i].weight -= dual;
            points[j].arm += (to_contact - way) * dual.transpose();
            points[i].arm -= to_contact * dual.transpose();
        }
        Some(StrainGauge { points, normal: None })
    }

    /// The points, ascending.
    pub fn points(&self) -> impl Iterator<Item = u32> + '_ {
        self.points.iter().map(|own| own.point)
    }

    /// Mean displacement gradient.
    ///
    /// - `displacement` of a point [m], `rotation` of a point since the start
    pub fn gradient(&self, displacement: impl Fn(usize) -> Vec3, rotation: impl Fn(usize) -> Rotation) -> Mat3 {
        let of = |own: &GaugePoint| {
            let moved = displacement(own.point as usize) * own.weight.transpose();
            if own.arm == Mat3::zeros() { moved } else { moved + turned(&rotation(own.point as usize), &own.arm) }
        };
        self.points.iter().fold(Mat3::zeros(), |sum, own| sum + of(own))
    }

    /// Mean strain; rotation of the whole gives none, however large it is.
    pub fn strain(&self, displacement: impl Fn(usize) -> Vec3, rotation: impl Fn(usize) -> Rotation) -> Sym3 {
        small_part_of_stretch(&self.gradient(displacement, rotation))
    }
}

/// (R − I) A.
fn turned(rotation: &Rotation, arm: &Mat3) -> Mat3 {
    rotation.to_rotation_matrix().into_inner() * arm - arm
}

/// Gradients of the mean over tetrahedra with respect to the displacements of their corners [1/m].
fn space_cells(tetrahedra: &[[u32; 4]], centre: &[Vec3]) -> Option<Vec<Vec3>> {
    let (mut weights, mut volume) = (vec![Vec3::zeros(); centre.len()], 0.0);
    for corners in tetrahedra {
        let (shares, own) = corner_areas(corners.map(|i| centre[i as usize]));
        corners.iter().zip(shares).for_each(|(&i, share)| weights[i as usize] += share);
        volume += own;
    }
    (volume > 0.0).then(|| weights.into_iter().map(|weight| weight / volume).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::rotation_by;

    const ALL: [StrainMeasure; 3] = [StrainMeasure::Cundall, StrainMeasure::Bagi, StrainMeasure::Satake];

    /// Spheres near the places of a grid, or on it.
    fn spheres(jitter: f64) -> (Vec<Vec3>, Vec<f64>) {
        let wave = |k: usize| fractum_math::elementary::sin(12.9898 * (k * k) as f64);
        let place = |i: usize| {
            let site = Vec3::new((i % 7) as f64, (i / 7 % 7) as f64, (i / 49) as f64);
            site + Vec3::new(wave(3 * i), wave(3 * i + 1), wave(3 * i + 2)) * jitter
        };
        ((0..343).map(place).collect(), (0..343).map(|i| 0.5 + 0.4 * jitter * wave(5 * i)).collect())
    }

    #[test]
    fn uniform_strain_comes_out_as_it_is_by_every_measure_on_any_arrangement() {
        let gradient = Mat3::new(1.0, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, 8.0, -9.0) * 1e-7;
        let set: Vec<u32> = (0..343).collect();
        for (measure, jitter) in ALL.into_iter().flat_map(|measure| [(measure, 0.0), (measure, 0.2)]) {
            let (place, radius) = spheres(jitter);
            let gauge = StrainGauge::new(measure, &set, |i| place[i], |i| radius[i]).unwrap();
            let moved = |i: usize| gradient * place[i] + Vec3::new(5e-7, 6e-7, 7e-7);
            let found = gauge.gradient(moved, |_| Rotation::identity());
            assert!((found - gradient).norm() < 1e-10 * gradient.norm(), "{measure:?} {jitter}: {found}");
        }
    }

    #[test]
    fn rotation_of_the_whole_is_no_strain_and_a_stretch_is_the_same_after_it() {
        let set: Vec<u32> = (0..343).collect();
        let (place, radius) = spheres(0.2);
        let turn = rotation_by(Vec3::new(0.7, -1.1, 0.4));
        let stretch = Mat3::new(1.002, 0.001, 0.0, 0.001, 0.999, 0.0, 0.0, 0.0, 1.001);
        for measure in ALL {
            let gauge = StrainGauge::new(measure, &set, |i| place[i], |i| radius[i]).unwrap();
            let turned = gauge.strain(|i| turn * place[i] - place[i], |_| turn);
            assert!(turned.to_matrix().norm() < 1e-12, "{measure:?}: {turned:?}");
            if measure != StrainMeasure::Satake {
                let strain = gauge.strain(|i| turn * (stretch * place[i]) - place[i], |_| turn);
                let expected = Sym3([0.002, -0.001, 0.001, 0.001, 0.0, 0.0]);
                assert!((strain - expected).to_matrix().norm() < 1e-12, "{measure:?}: {strain:?}");
            }
        }
    }

    #[test]
    fn spin_of_the_particles_is_rotation_to_satake_alone() {
        let set: Vec<u32> = (0..343).collect();
        let (place, radius) = spheres(0.0);
        let spin = rotation_by(Vec3::new(0.0, 0.0, 1e-6));
        for measure in ALL {
            let gauge = StrainGauge::new(measure, &set, |i| place[i], |i| radius[i]).unwrap();
            // A uniform spin is a rotation of the frame in which contacts slide: a skew gradient.
            let found = gauge.gradient(|_| Vec3::zeros(), |_| spin);
            let expected = if measure == StrainMeasure::Satake { 1e-6 } else { 0.0 };
            assert!((found[(0, 1)] - expected).abs() < 1e-12 && (found[(1, 0)] + expected).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn points_in_a_plane_have_the_strains_in_it_and_too_few_have_none() {
        let place = |i: usize| Vec3::new((i % 3) as f64, (i / 3) as f64, 4.0);
        let gauge = StrainGauge::new(StrainMeasure::Cundall, &[0, 1, 2, 3, 4, 5], place, |_| 0.0).unwrap();
        assert!(gauge.normal.unwrap().z.abs() > 1.0 - 1e-12);
        let strain = gauge.strain(|i| Vec3::new(1e-6 * place(i).x, -2e-6 * place(i).y, 0.0), |_| Rotation::identity());
        assert!((strain - Sym3([1e-6, -2e-6, 0.0, 0.0, 0.0, 0.0])).to_matrix().norm() < 1e-15, "{strain:?}");
        assert!(StrainGauge::new(StrainMeasure::Cundall, &[0, 1, 2], place, |_| 0.0).is_none());
        assert!(StrainGauge::new(StrainMeasure::Bagi, &[0, 1, 2, 3, 4, 5], place, |_| 0.5).is_none());
    }
}
