//! What is measured on a set of points.

use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;

use crate::conditions::{Along, Points, Population, Supports, mean};
use crate::leave::is_out;
use crate::measure::probe::{NeededPoints, Probe, ProbeNeeds, ProbedScene};
use crate::scene::Scene;

/// What is measured on a set of points, ascending: nodes of solids, or particles.
#[derive(Clone, Debug, PartialEq)]
pub enum PointProbe {
    /// Force of the supports [N]; directions about an axis are those of the places without load.
    Reaction {
        /// Prescribed degrees of freedom; see [`Supports::places`].
        places: Vec<(u32, u32, u32)>,
        /// Which component.
        along: Along,
    },
    /// Moment of the forces of the supports about an axis [N m], levers are those without load, and of what keeps particles from turning.
    Moment {
        /// Prescribed degrees of freedom; see [`Supports::places`].
        places: Vec<(u32, u32, u32)>,
        /// Particles that supports keep from turning, and the axes (bits) about which they do; see [`Bonded::still`](crate::Bonded::still).
        still: Vec<(u32, u8)>,
        /// The axis.
        about: Axis,
    },
    /// Mean displacement at the instant of the last step, as its reactions are [m], of the points that have not left the run;
    /// directions about an axis are those of the places without load.
    Displacement {
        /// The points.
        points: Vec<u32>,
        /// Which component.
        along: Along,
    },
    /// Mean velocity [m/s] of the points that have not left the run; directions about an axis are those of the present places.
    Velocity {
        /// The points.
        points: Vec<u32>,
        /// Which component.
        along: Along,
    },
    /// Rotation of the set as a whole about an axis through its centre, for small angles [rad]; not a number once a point has
    /// left the run.
    Rotation {
        /// The points.
        points: Vec<u32>,
        /// Unit direction of the axis.
        axis: Vec3,
    },
}

impl PointProbe {
    /// The points that it looks at.
    fn points(&self, supports: &Supports) -> Vec<u32> {
        match self {
            PointProbe::Reaction { places, .. } => supports.points_at(places).collect(),
            PointProbe::Moment { places, still, .. } => {
                let mut points: Vec<u32> = supports.points_at(places).chain(still.iter().map(|own| own.0)).collect();
                points.sort_unstable();
                points.dedup();
                points
            }
            PointProbe::Displacement { points, .. }
            | PointProbe::Velocity { points, .. }
            | PointProbe::Rotation { points, .. } => points.clone(),
        }
    }

    /// Whether it looks at what supports have done.
    fn is_of_supports(&self) -> bool {
        matches!(self, PointProbe::Reaction { .. } | PointProbe::Moment { .. })
    }

    /// Value at the last step; `dt` is the step that followed it [s]. Not a number once all points have left the run.
    fn value(&self, population: &impl Points, supports: &Supports, dt: f64, is_out: impl Fn(u32) -> bool) -> f64 {
        let present = |point: &u32| !is_out(*point);
        let displacement = |i: usize| population.displacement_before(i, dt);
        match self {
            PointProbe::Reaction { places, along: Along::Direction(direction) } => supports.reaction(places, direction),
            PointProbe::Reaction { places, along } => {
                supports.reaction_by(places, |point| along.at(population.reference(point)))
            }
            PointProbe::Moment { places, still, about } => {
                let lever = |point| population.reference(point) - about.point;
                let turning = still.iter().map(|&(point, axes)| {
                    let moment = population.moment(point as usize);
                    let along =
                        |axis: usize| if axes >> axis & 1 == 1 { moment[axis] * about.direction[axis] } else { 0.0 };
                    -(along(0) + along(1) + along(2))
                });
                supports.reaction_by(places, |point| about.direction.cross(&lever(point))) + turning.sum::<f64>()
            }
            PointProbe::Displacement { points, along } => component(
                points.iter().filter(|point| present(point)),
                along,
                |i| *population.reference(i),
                displacement,
            ),
            PointProbe::Velocity { points, along } => component(
                points.iter().filter(|point| present(point)),
                along,
                |i| population.position(i),
                |i| *population.velocity(i),
            ),
            PointProbe::Rotation { points, .. } if points.iter().any(|&point| is_out(point)) => f64::NAN,
            PointProbe::Rotation { points, axis } => {
                let centre = mean(points, |i| *population.reference(i));
                let shift = mean(points, displacement);
                let (mut moment, mut weight) = (0.0, 0.0);
                for &i in points {
                    let path = axis.cross(&(population.reference(i as usize) - centre));
                    moment += path.dot(&(displacement(i as usize) - shift));
                    weight += path.norm_squared();
                }
                moment / weight
            }
        }
    }
}

/// Mean component of a vector over points at these places; not a number of no points.
fn component<'a>(
    points: impl Iterator<Item = &'a u32>,
    along: &Along,
    place: impl Fn(usize) -> Vec3,
    of: impl Fn(usize) -> Vec3,
) -> f64 {
    if let Along::Direction(direction) = along {
        return mean(points, of).dot(direction);
    }
    let (mut sum, mut count) = (0.0, 0);
    for &point in points {
        sum += of(point as usize).dot(&along.at(&place(point as usize)));
        count += 1;
    }
    sum / f64::from(count)
}

/// A probe of nodes of solids, or of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeOfPoints {
    /// Whose points.
    pub population: Population,
    /// What is measured on them.
    pub probe: PointProbe,
}

impl ProbeOfPoints {
    /// As one of several kinds of probes.
    pub fn boxed(population: Population, probe: PointProbe) -> Box<dyn Probe> {
        Box::new(ProbeOfPoints { population, probe })
    }
}

impl Probe for ProbeOfPoints {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let scene = probed.scene;
        let (dt, is_out) = (scene.clock.dt_before, is_out(scene, self.population));
        match self.population {
            Population::Nodes => self.probe.value(&scene.solid, scene.supports(), dt, is_out),
            Population::Particles => self.probe.value(&scene.bonded, scene.bonded.supports(), dt, is_out),
        }
    }

    fn needs(&self, scene: &Scene) -> ProbeNeeds {
        let (probe, of_supports) = (&self.probe, self.probe.is_of_supports());
        match self.population {
            Population::Nodes => {
                let nodes = NeededPoints::Some(probe.points(scene.supports()));
                ProbeNeeds { nodes, of_supports, ..ProbeNeeds::default() }
            }
            Population::Particles => {
                let particles = NeededPoints::Some(probe.points(scene.bonded.supports()));
                ProbeNeeds { particles, of_supports, ..ProbeNeeds::default() }
            }
        }
    }
}

impl Scene {
    /// Sum of the loads on nodes of solids along a component [N]; directions about an axis are those of the places without load.
    pub fn load_on(&self, nodes: &[u32], along: &Along) -> f64 {
        self.loads.resultant(nodes, |node| along.at(&self.solid.reference[node]))
    }
}
