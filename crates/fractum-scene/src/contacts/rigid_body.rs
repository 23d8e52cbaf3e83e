//! Rigid bodies that particles meet: where they are, what drives them.

use fractum_contact::law::{ContactParameters, ElasticMaterial};
use fractum_contact::{FacetMesh, Frame, Shape, Surface};
use fractum_math::{HalfSteps, Mat3, Rotation, Vec3};
use serde::{Deserialize, Serialize};

use super::servo::{Servo, ServoArea, ServoStep};
use crate::clock::Clock;
use crate::time_function::TimeFunction;

/// What a rigid body looks like, in its own axes.
#[derive(Clone, Debug)]
pub enum Form {
    /// A shape, or the container of that shape.
    Shape {
        /// The shape.
        shape: Shape,
        /// Whether it is a container, with particles inside; true of tubes, which have no inside.
        hollow: bool,
    },
    /// Facets.
    Mesh {
        /// The facets.
        mesh: FacetMesh,
        /// Their points [m].
        points: Vec<Vec3>,
    },
}

impl Form {
    /// Distance of the farthest point from the reference point [m]; 0 of planes.
    fn reach(&self) -> f64 {
        match self {
            Form::Shape { shape, .. } => match *shape {
                Shape::HalfSpace => 0.0,
                Shape::Cuboid { half } => half.norm(),
                Shape::Cylinder { radius, half_length } | Shape::Tube { radius, half_length } => {
                    (radius * radius + half_length * half_length).sqrt()
                }
                Shape::Ball { radius } => radius,
            },
            Form::Mesh { points, .. } => points.iter().map(|point| point.norm()).fold(0.0, f64::max),
        }
    }
}

/// How a rigid body moves along or about one axis of space.
#[derive(Clone)]
pub enum Drive {
    /// At a velocity [m/s] or [rad/s] over time, whatever the forces.
    Velocity(TimeFunction),
    /// Freely, under contacts, gravity and a force [N] over time; for translations only.
    Force(TimeFunction),
    /// So that its contacts press with a given force; for translations only.
    Servo(Servo),
    /// Freely, under contacts and gravity.
    Free,
    /// Not at all.
    Fixed,
}

/// Mass of a rigid body that moves freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass [kg].
    pub mass: f64,
    /// Moments of inertia about the reference point, in the axes of the body [kg m²].
    pub tensor: Mat3,
}

/// A rigid body.
#[derive(Clone)]
pub struct RigidBody {
    /// The user's name for it.
    pub name: String,
    /// What it looks like.
    pub form: Form,
    /// Its elastic constants in contact; [`ElasticMaterial::RIGID`] leaves those of the particles alone.
    pub elastic: ElasticMaterial,
    /// Friction and damping.
    pub surface: ContactParameters,
    /// Work of adhesion between two such bodies [J/m²].
    pub work_of_adhesion: f64,
    /// Where it is, with its velocities at the half step before tⁿ.
    pub frame: Frame,
    /// Motion along x, y, z.
    pub along: [Drive; 3],
    /// Motion about x, y, z: all of them free, or none.
    pub about: [Drive; 3],
    /// Mass, where some axis is free.
    pub inertia: Option<Inertia>,
    start: Vec3,
    /// Distance of its farthest point from the reference point [m]; 0 of planes.
    reach: f64,
    /// Angular momentum at the half step [kg m²/s].
    angular_momentum: Vec3,
    force: Vec3,
    moment: Vec3,
    /// Mass of what touches it [kg].
    touched: f64,
    /// Work on what touches it up to tⁿ [J].
    work: f64,
    /// The same in the half step after tⁿ [J].
    work_after: f64,
}

impl std::fmt::Debug for RigidBody {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "RigidBody({} at {:?})", self.name, self.frame.origin.as_slice())
    }
}

/// What changes in a rigid body during a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RigidBodyState {
    frame: Frame,
    angular_momentum: Vec3,
    force: Vec3,
    moment: Vec3,
    work: f64,
    work_after: f64,
}

impl RigidBody {
    /// A rigid body at rest whose axes are fixed; its reference point is the origin of `frame`.
    pub fn new(name: &str, form: Form, frame: Frame, elastic: ElasticMaterial, surface: ContactParameters) -> Self {
        let reach = form.reach();
        RigidBody {
            name: name.to_owned(),
            form,
            reach,
            elastic,
            surface,
            work_of_adhesion: 0.0,
            start: frame.origin,
            frame,
            along: [Drive::Fixed, Drive::Fixed, Drive::Fixed],
            about: [Drive::Fixed, Drive::Fixed, Drive::Fixed],
            inertia: None,
            angular_momentum: Vec3::zeros(),
            force: Vec3::zeros(),
            moment: Vec3::zeros(),
            touched: 0.0,
            work: 0.0,
            work_after: 0.0,
        }
    }

    /// As contacts see it.
    pub(super) fn ground(&self) -> Surface<'_> {
        match &self.form {
            Form::Shape { shape, hollow } => Surface::Shape { shape: *shape, hollow: *hollow, frame: &self.frame },
            Form::Mesh { mesh, points } => Surface::Rigid { surface: mesh, points, frame: &self.frame },
        }
    }

    /// Number of its facets; none of a shape.
    pub fn facets(&self) -> usize {
        match &self.form {
            Form::Shape { .. } => 0,
            Form::Mesh { mesh, .. } => mesh.len(),
        }
    }

    /// Number of edges of its facets that belong to one of them only; none of a shape.
    pub fn open_edges(&self) -> usize {
        match &self.form {
            Form::Shape { .. } => 0,
            Form::Mesh { mesh, .. } => mesh.open_edges(),
        }
    }

    /// Mass that contacts move: infinite where no axis is free.
    pub(super) fn mass(&self) -> f64 {
        self.inertia.map_or(f64::INFINITY, |inertia| inertia.mass)
    }

    /// Force of the contacts on it at the last step [N].
    pub fn contact_force(&self) -> Vec3 {
        self.force
    }

    /// Moment of the contacts on it about its reference point at the last step [N m].
    pub fn contact_moment(&self) -> Vec3 {
        self.moment
    }

    /// Work that it has done on what touches it, by force and moment, since the start [J].
    pub fn work(&self) -> f64 {
        self.work
    }

    /// Adds work on what touches it at rest [J].
    pub(crate) fn add_work(&mut self, work: f64) {
        self.work += work;
    }

    /// Work per time on what touches it [W].
    fn power(&self) -> f64 {
        -self.force.dot(&self.frame.velocity) - self.moment.dot(&self.frame.spin)
    }

    /// Way of its reference point since the start [m].
    pub fn displacement(&self) -> Vec3 {
        self.frame.origin - self.start
    }

    /// Largest speed of its points [m/s], at most.
    pub(super) fn speed(&self) -> f64 {
        self.frame.velocity.norm() + self.frame.spin.norm() * self.reach
    }

    /// Whether something moves it, or could.
    pub fn moves(&self) -> bool {
        self.along.iter().chain(&self.about).any(|drive| !matches!(drive, Drive::Fixed))
    }

    /// Middle of the body [m]; planes and containers have none.
    pub fn middle(&self) -> Option<Vec3> {
        match &self.form {
            Form::Shape { hollow: true, .. } | Form::Shape { shape: Shape::HalfSpace, .. } => None,
            Form::Shape { .. } => Some(self.frame.origin),
            Form::Mesh { points, .. } => {
                let middle = points.iter().sum::<Vec3>() / points.len() as f64;
                Some(self.frame.origin + self.frame.to_space(&middle))
            }
        }
    }

    /// Whether a place lies within its shape; containers and facets have no inside.
    pub fn covers(&self, place: &Vec3) -> bool {
        match &self.form {
            Form::Shape { shape, hollow: false } => shape.outside(&self.frame.to_body(place)).distance < 0.0,
            _ => false,
        }
    }

    /// Whether its middle has come within another one since the start: rigid bodies do not touch each other.
    pub fn has_entered(&self, other: &RigidBody) -> bool {
        if !matches!(other.form, Form::Shape { hollow: false, .. }) {
            return false;
        }
        let Some(middle) = self.middle() else { return false };
        let at_start = middle - self.displacement() + other.displacement();
        other.covers(&middle) && !other.covers(&at_start)
    }

    /// Linear momentum at the half step; none without mass [kg m/s].
    pub(crate) fn momentum(&self) -> Vec3 {
        self.inertia.map_or_else(Vec3::zeros, |inertia| self.frame.velocity * inertia.mass)
    }

    /// Angular momentum about the origin at the half step, with its spin where contacts turn it; none without mass [kg m²/s].
    pub(crate) fn angular_momentum(&self) -> Vec3 {
        let spin = if self.turns_freely() { self.angular_momentum } else { Vec3::zeros() };
        self.frame.origin.cross(&self.momentum()) + spin
    }

    pub(crate) fn clear_forces(&mut self) {
        (self.force, self.moment, self.touched) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    }

    /// Takes the force and couple of a contact at a place in space.
    ///
    /// - `mass`: that of what touches it [kg]
    pub(crate) fn push(&mut self, force: &Vec3, couple: &Vec3, place: &Vec3, mass: f64) {
        self.force += force;
        self.touched += mass;
        self.moment += (place - self.frame.origin).cross(force) + couple;
    }

    fn turns_freely(&self) -> bool {
        matches!(self.about[0], Drive::Free)
    }

    /// Force from outside on a free axis: load and weight [N].
    fn applied(&self, axis: usize, time: f64, gravity: &Vec3) -> f64 {
        let weight = self.inertia.map_or(0.0, |inertia| inertia.mass * gravity[axis]);
        match &self.along[axis] {
            Drive::Force(force) => force(time, &self.start) + weight,
            _ => weight,
        }
    }

    /// Kinetic energy along the axes that no drive prescribes [J].
    pub(super) fn kinetic_energy(&self) -> f64 {
        let Some(inertia) = self.inertia else { return 0.0 };
        let free = |axis: &usize| matches!(self.along[*axis], Drive::Force(_) | Drive::Free);
        let moving: f64 = (0..3).filter(free).map(|axis| inertia.mass * self.frame.velocity[axis].powi(2)).sum();
        let spin = if self.turns_freely() { self.frame.spin } else { Vec3::zeros() };
        0.5 * (moving + spin.dot(&(inertia_in_space(&inertia, &self.frame.rotation) * spin)))
    }

    /// The velocities given at t = 0 become those of half a step before it.
    pub(super) fn start_half_a_step_early(&mut self, dt: f64, gravity: &Vec3) {
        for axis in 0..3 {
            let velocity = match (&self.along[axis], self.inertia) {
                (Drive::Force(_) | Drive::Free, Some(inertia)) => {
                    let pull = self.applied(axis, 0.0, gravity) + self.force[axis];
                    self.frame.velocity[axis] - 0.5 * dt * pull / inertia.mass
                }
                (Drive::Velocity(velocity), _) => velocity(0.0, &self.start),
                _ => 0.0,
            };
            self.frame.velocity[axis] = velocity;
            if let Drive::Velocity(spin) = &self.about[axis] {
                self.frame.spin[axis] = spin(0.0, &self.start);
            }
        }
        if let (true, Some(inertia)) = (self.turns_freely(), self.inertia) {
            self.angular_momentum = inertia_in_space(&inertia, &self.frame.rotation) * self.frame.spin;
            self.angular_momentum -= self.moment * (0.5 * dt);
        }
    }

    /// Whether forces change nothing of its motion.
    pub(super) fn is_driven(&self) -> bool {
        let free = |drive: &Drive| matches!(drive, Drive::Force(_) | Drive::Servo(_) | Drive::Free);
        !self.along.iter().chain(&self.about).any(free)
    }

    /// Where a driven body will be at the end of a step, with its velocities in the step.
    pub(super) fn driven_to(&self, time: f64, dt_after: f64) -> Frame {
        let middle = time + 0.5 * dt_after;
        let given = |drive: &Drive| if let Drive::Velocity(given) = drive { given(middle, &self.start) } else { 0.0 };
        let [velocity, spin] = [&self.along, &self.about].map(|drives| Vec3::from_fn(|axis, _| given(&drives[axis])));
        Frame { velocity, spin, ..self.frame }.moved(dt_after)
    }

    /// Force that is asked of its servo, and that with which it presses [N]; none without a servo.
    pub fn servo_forces(&self, time: f64) -> Option<[f64; 2]> {
        self.along.iter().zip(self.force.iter()).find_map(|(drive, force)| match drive {
            Drive::Servo(servo) => Some([servo.wanted(time, &self.start), -servo.sign * force]),
            _ => None,
        })
    }

    /// Finds the areas that the pressures of servos act on, where planes that move enclose them.
    pub(super) fn find_servo_areas(bodies: &mut [RigidBody]) {
        for body in 0..bodies.len() {
            for axis in 0..3 {
                if let Drive::Servo(Servo { area: Some(ServoArea::Between { planes, .. }), .. }) =
                    bodies[body].along[axis]
                {
                    let found = area_between(bodies, planes);
                    if let Drive::Servo(Servo { area: Some(ServoArea::Between { now, .. }), .. }) =
                        &mut bodies[body].along[axis]
                    {
                        *now = found;
                    }
                }
            }
        }
    }

    /// Advances velocities and place with the forces of tⁿ.
    pub(super) fn advance(&mut self, clock: &Clock, gravity: &Vec3) -> HalfSteps {
        let (time, dt_before, dt_after) = (clock.time, clock.dt_before, clock.dt_after);
        let mut work = HalfSteps::default();
        let before = if clock.begins_motion() { 0.0 } else { 0.5 * dt_before * self.power() };
        self.work += std::mem::take(&mut self.work_after) + before;
        let dt_kick = 0.5 * (dt_before + dt_after);
        for axis in 0..3 {
            let before = self.frame.velocity[axis];
            // What comes from outside: a load, or the drive that balances the contacts.
            let (after, outside) = match (&self.along[axis], self.inertia) {
                (Drive::Force(_) | Drive::Free, Some(inertia)) => {
                    let outside = self.applied(axis, time, gravity);
                    let change = (self.force[axis] + outside) / inertia.mass;
                    work.before.kinetic += 0.5 * inertia.mass * before * (before + dt_before * change);
                    let after = before + dt_kick * change;
                    work.after.kinetic += 0.5 * inertia.mass * after * (after - dt_after * change);
                    (after, outside)
                }
                (Drive::Velocity(velocity), _) => (velocity(time + 0.5 * dt_after, &self.start), -self.force[axis]),
                (Drive::Servo(servo), _) => {
                    let (force, touched) = (self.force[axis], self.touched);
                    let step = ServoStep { time, dt: dt_kick, velocity: before, force, touched };
                    (servo.velocity(&step, &self.start), -force)
                }
                _ => (0.0, 0.0),
            };
            self.frame.velocity[axis] = after;
            work.before.external += 0.5 * outside * before * dt_before;
            work.after.external += 0.5 * outside * after * dt_after;
        }
        self.turn(time, dt_before, dt_after, &mut work);
        self.work_after = 0.5 * dt_after * self.power();
        self.frame = self.frame.moved(dt_after);
        work
    }

    fn turn(&mut self, time: f64, dt_before: f64, dt_after: f64, work: &mut HalfSteps) {
        if let (true, Some(inertia)) = (self.turns_freely(), self.inertia) {
            let before = self.frame.spin;
            work.before.kinetic += 0.5 * before.dot(&(self.angular_momentum + self.moment * dt_before));
            self.angular_momentum += self.moment * (0.5 * (dt_before + dt_after));
            let in_space = inertia_in_space(&inertia, &self.frame.rotation);
            self.frame.spin = in_space.try_inverse().map_or(before, |inverse| inverse * self.angular_momentum);
            let after = self.frame.spin;
            work.after.kinetic += 0.5 * after.dot(&(self.angular_momentum - self.moment * dt_after));
            return;
        }
        for axis in 0..3 {
            let before = self.frame.spin[axis];
            let after = match &self.about[axis] {
                Drive::Velocity(spin) => spin(time + 0.5 * dt_after, &self.start),
                _ => 0.0,
            };
            self.frame.spin[axis] = after;
            work.before.external -= 0.5 * self.moment[axis] * before * dt_before;
            work.after.external -= 0.5 * self.moment[axis] * after * dt_after;
        }
    }

    pub(super) fn state(&self) -> RigidBodyState {
        let &RigidBody { frame, angular_momentum, force, moment, work, work_after, .. } = self;
        RigidBodyState { frame, angular_momentum, force, moment, work, work_after }
    }

    pub(super) fn restore(&mut self, state: RigidBodyState) {
        let RigidBodyState { frame, angular_momentum, force, moment, work, work_after } = state;
        (self.frame, self.angular_momentum, self.force, self.moment) = (frame, angular_momentum, force, moment);
        (self.work, self.work_after) = (work, work_after);
    }
}

fn inertia_in_space(inertia: &Inertia, rotation: &Rotation) -> Mat3 {
    let turn = rotation.to_rotation_matrix();
    turn.matrix() * inertia.tensor * turn.matrix().transpose()
}

/// Product of the distances of two pairs of planes [m²].
fn area_between(bodies: &[RigidBody], planes: [usize; 4]) -> f64 {
    let distance = |a: usize, b: usize| {
        let [first, second] = [a, b].map(|plane| &bodies[plane].frame);
        (second.origin - first.origin).dot(&first.to_space(&Vec3::z())).abs()
    };
    distance(planes[0], planes[1]) * distance(planes[2], planes[3])
}
