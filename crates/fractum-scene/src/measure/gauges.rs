//! Gauges of experiments: displacement and strain on a grid of places, as image correlation finds them, and the elongation
//! between two places, as an extensometer finds it.

use fractum_dem::{StrainGauge, StrainMeasure};
use fractum_fem::Solid;
use fractum_math::{Rotation, Vec3};

use crate::bonded::Bonded;
use crate::conditions::{Points, Population, mean};
use crate::leave::is_out;
use crate::measure::probe::{Probe, ProbeNeeds, ProbedScene};
use crate::scene::Scene;

/// Smallest part of a direction across a plane of points with which a strain is not measured.
const ACROSS: f64 = 1e-6;

/// Displacement and strain on a grid of places.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeGrid {
    population: Population,
    gauges: Vec<Gauge>,
}

/// A place with the points around it.
#[derive(Clone, Debug, PartialEq)]
struct Gauge {
    place: Vec3,
    /// Mean place of the points without load [m].
    centre: Vec3,
    points: Vec<u32>,
    fit: StrainGauge,
}

/// What is found at a place of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeReading {
    /// Place without load [m].
    pub place: Vec3,
    /// Points that the affine field was fitted to.
    pub points: usize,
    /// Displacement of the field at the place [m].
    pub displacement: Vec3,
    /// Strain of the field, xx yy zz xy yz zx [-]; rotation is none. Not a number across a plane that holds all points.
    pub strain: [f64; 6],
}

impl GaugeGrid {
    /// Fits are made to all points within half a gauge length; places whose points span no plane are left out.
    ///
    /// - `set`: points, ascending; `places` without load [m]; `length`: gauge length [m], > 0
    pub fn new(
        (bonded, solid): (&Bonded, &Solid),
        population: Population,
        set: &[u32],
        places: &[Vec3],
        length: f64,
    ) -> Self {
        let all = points_of(bonded, solid, population);
        let mut along_x: Vec<(f64, u32)> = set.iter().map(|&i| (all.reference(i as usize).x, i)).collect();
        along_x.sort_by(|a, b| a.0.total_cmp(&b.0));
        let gauge = |place: &Vec3| {
            let first = along_x.partition_point(|(x, _)| *x < place.x - 0.5 * length);
            let near = along_x[first..].iter().take_while(|(x, _)| *x <= place.x + 0.5 * length).map(|&(_, i)| i);
            let inside = |i: &u32| (all.reference(*i as usize) - place).norm() <= 0.5 * length;
            let mut points: Vec<u32> = near.filter(inside).collect();
            points.sort_unstable();
            let fit = StrainGauge::new(StrainMeasure::Cundall, &points, |i| *all.reference(i), |_| 0.0)?;
            let centre = mean(&points, |i| *all.reference(i));
            Some(Gauge { place: *place, centre, points, fit })
        };
        GaugeGrid { population, gauges: places.iter().filter_map(gauge).collect() }
    }

    /// Places with a reading.
    pub fn len(&self) -> usize {
        self.gauges.len()
    }

    /// Whether no place has a reading.
    pub fn is_empty(&self) -> bool {
        self.gauges.is_empty()
    }

    /// Smallest and largest number of points of a place; none without places.
    pub fn points_of_places(&self) -> Option<[usize; 2]> {
        let counts = || self.gauges.iter().map(|gauge| gauge.points.len());
        Some([counts().min()?, counts().max()?])
    }

    /// The readings of the present instant, in the order of the places. Those with a point that has left the run have no numbers.
    pub fn readings(&self, scene: &Scene) -> Vec<GaugeReading> {
        let all = points_of(&scene.bonded, &scene.solid, self.population);
        let is_out = is_out(scene, self.population);
        let reading = |gauge: &Gauge| {
            let reading = gauge.reading(|i| all.displacement(i));
            if gauge.points.iter().any(|&i| is_out(i)) {
                return GaugeReading { displacement: Vec3::repeat(f64::NAN), strain: [f64::NAN; 6], ..reading };
            }
            reading
        };
        self.gauges.iter().map(reading).collect()
    }
}

impl Gauge {
    fn reading(&self, displacement: impl Fn(usize) -> Vec3) -> GaugeReading {
        let gradient = self.fit.gradient(&displacement, |_| Rotation::identity());
        let at_centre = mean(&self.points, &displacement);
        let mut strain = self.fit.strain(&displacement, |_| Rotation::identity()).0;
        if let Some(normal) = self.fit.normal {
            let axes = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];
            let across = |pair: [usize; 2]| pair.iter().any(|&axis| normal[axis].abs() >= ACROSS);
            strain.iter_mut().zip(axes).filter(|(_, pair)| across(*pair)).for_each(|(strain, _)| *strain = f64::NAN);
        }
        let displacement = at_centre + gradient * (self.place - self.centre);
        GaugeReading { place: self.place, points: self.points.len(), displacement, strain }
    }
}

/// Elongation between two feet on a body over the distance between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Extensometer {
    population: Population,
    feet: [Vec<u32>; 2],
    /// Way from one foot to the other without load [m].
    span: Vec3,
}

impl Extensometer {
    /// None where both feet have one place.
    ///
    /// - `set`: points, ascending, not empty; `ends`: the places of the feet without load [m]
    /// - `foot`: diameter of the feet [m], which are the nearest point where it is absent or no point lies within
    pub fn new(
        (bonded, solid): (&Bonded, &Solid),
        population: Population,
        set: &[u32],
        ends: [Vec3; 2],
        foot: Option<f64>,
    ) -> Option<Self> {
        let all = points_of(bonded, solid, population);
        let away = |i: u32, end: &Vec3| (all.reference(i as usize) - end).norm();
        let feet = ends.map(|end| {
            let within = |i: &u32| foot.is_some_and(|foot| away(*i, &end) <= 0.5 * foot);
            let points: Vec<u32> = set.iter().copied().filter(within).collect();
            if points.is_empty() {
                let nearest = set.iter().copied().min_by(|&a, &b| away(a, &end).total_cmp(&away(b, &end)));
                return nearest.into_iter().collect();
            }
            points
        });
        let [first, second] = [0, 1].map(|foot| mean(&feet[foot], |i| *all.reference(i)));
        let span = second - first;
        (span.norm() > 0.0).then_some(Extensometer { population, feet, span })
    }
}

impl Probe for Extensometer {
    /// Elongation over the distance without load [-], at the instant of the last step; rotation of the whole is none. Not a number once a
    /// point of a foot has left the run.
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let scene = probed.scene;
        let is_out = is_out(scene, self.population);
        if self.feet.iter().flatten().any(|&i| is_out(i)) {
            return f64::NAN;
        }
        let (all, dt) = (points_of(&scene.bonded, &scene.solid, self.population), scene.clock.dt_before);
        let [first, second] = [0, 1].map(|foot| mean(&self.feet[foot], |i| all.displacement_before(i, dt)));
        elongation(&self.span, &(second - first))
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_all(false)
    }
}

/// Elongation of a way by a difference of displacements, over its length, without the loss of digits.
fn elongation(span: &Vec3, moved: &Vec3) -> f64 {
    (2.0 * span + moved).dot(moved) / ((span + moved).norm() + span.norm()) / span.norm()
}

fn points_of<'a>(bonded: &'a Bonded, solid: &'a Solid, population: Population) -> &'a dyn Points {
    match population {
        Population::Nodes => solid,
        Population::Particles => bonded,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::{Mat3, rotation_by};

    /// A gauge on points near the places of a grid of `size`.
    fn gauge(size: [usize; 3]) -> (Gauge, Vec<Vec3>) {
        let wave = |k: usize| fractum_math::elementary::sin(12.9898 * (k * k) as f64);
        let flat = |axis: usize| if size[axis] > 1 { 0.2 } else { 0.0 };
        let place = |i: usize| {
            let site = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])];
            Vec3::from_fn(|axis, _| site[axis] as f64 + flat(axis) * wave(3 * i + axis))
        };
        let places: Vec<Vec3> = (0..size[0] * size[1] * size[2]).map(place).collect();
        let points: Vec<u32> = (0..places.len() as u32).collect();
        let fit = StrainGauge::new(StrainMeasure::Cundall, &points, |i| places[i], |_| 0.0).unwrap();
        let centre = mean(&points, |i| places[i]);
        (Gauge { place: Vec3::new(0.3, 1.7, 0.0), centre, points, fit }, places)
    }

    #[test]
    fn an_affine_displacement_has_its_strain_and_its_displacement_at_the_place() {
        let (gauge, places) = gauge([4, 4, 3]);
        let stretch = Mat3::new(1.002, 0.001, 0.0, 0.001, 0.999, -4e-4, 0.0, -4e-4, 1.001);
        let turn = rotation_by(Vec3::new(0.7, -1.1, 0.4));
        let moved = |x: &Vec3| turn * (stretch * x) - x + Vec3::new(5.0, 6.0, 7.0);
        let reading = gauge.reading(|i| moved(&places[i]));
        let expected = [0.002, -0.001, 0.001, 0.001, -4e-4, 0.0];
        for (strain, expected) in reading.strain.into_iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-10 * 0.002, "{:?}", reading.strain);
        }
        assert!((reading.displacement - moved(&gauge.place)).norm() < 1e-10, "{}", reading.displacement);
        assert_eq!(reading.points, 48);
    }

    #[test]
    fn points_on_a_surface_have_no_strain_across_it() {
        let (gauge, places) = gauge([4, 4, 1]);
        let reading = gauge.reading(|i| Vec3::new(2e-6 * places[i].x, -1e-6 * places[i].y, 0.0));
        let [xx, yy, zz, xy, yz, zx] = reading.strain;
        assert!((xx - 2e-6).abs() < 1e-16 && (yy + 1e-6).abs() < 1e-16 && xy.abs() < 1e-16, "{reading:?}");
        assert!([zz, yz, zx].iter().all(|strain| strain.is_nan()), "{reading:?}");
    }

    #[test]
    fn an_extensometer_finds_the_elongation_along_its_span_whatever_the_rotation() {
        let span = Vec3::new(0.03, 0.04, 0.0);
        let strain = 1e-7;
        assert!((elongation(&span, &(span * strain)) / strain - 1.0).abs() < 1e-12);
        let turned = rotation_by(Vec3::new(0.2, 0.1, -0.5)) * (span * (1.0 + 1e-3)) - span;
        assert!((elongation(&span, &turned) - 1e-3).abs() < 1e-13, "{}", elongation(&span, &turned));
        assert_eq!(elongation(&span, &Vec3::zeros()), 0.0);
    }
}
