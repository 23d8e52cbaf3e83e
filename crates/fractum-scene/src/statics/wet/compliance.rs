//! The solids as interfaces see them: jumps under forces between pairs of nodes, with springs of a constant stiffness in all interfaces.

use fractum_math::{Mat3, Vec3};
use fractum_sparse::SparseError;

use crate::interfaces::joints::{Joint, JointPoint};
use crate::scene::Scene;
use crate::statics::contact::Spring;
use crate::statics::linear_system::LinearSystem;

/// Elastic solids whose interfaces are springs.
pub(super) struct Compliance {
    pub(super) joints: Vec<Joint>,
    /// Unknown components of a displacement.
    pub(super) axes: usize,
    springs: Vec<Spring>,
    /// Force of each spring where its pair has no jump [N].
    without_jump: Vec<Vec3>,
    prepared: bool,
    /// Jumps of all pairs under a unit force between the nodes of one, by pair and axis; none that nobody has asked for.
    columns: Vec<Option<Vec<Vec3>>>,
    /// What a pressure in each hole does.
    pub(super) holes: Vec<HoleColumn>,
    force: Vec<Vec3>,
    field: Vec<Vec3>,
}

/// What a pressure of 1 Pa in a hole does.
pub(super) struct HoleColumn {
    /// Jumps of all pairs [m/Pa]: by reciprocity also what a force between a pair adds to the volume of the hole [m³/N].
    pub(super) jumps: Vec<Vec3>,
    /// What it adds to the volumes of all holes [m³/Pa].
    pub(super) gains: Vec<f64>,
}

/// Stiffness of the spring of a point in space [N/m].
pub(super) fn spring_of(point: &JointPoint) -> Mat3 {
    let [normal, across] = point.interface.stiffness;
    point.frame.transpose() * Mat3::from_diagonal(&Vec3::new(normal, across, across)) * point.frame * point.area
}

impl Compliance {
    pub(super) fn new(scene: &Scene) -> Self {
        let joints = scene.interfaces().joints();
        let axes = if scene.solid.is_plane() { 2 } else { 3 };
        let spring = |joint: &Joint| Spring::between(joint.pair, joint.points.iter().map(spring_of).sum());
        let without_jump = |joint: &Joint| joint.points.iter().map(|own| spring_of(own) * own.unloaded).sum();
        let (springs, without_jump) = (joints.iter().map(spring).collect(), joints.iter().map(without_jump).collect());
        let columns = vec![None; axes * joints.len()];
        let zero = vec![Vec3::zeros(); scene.solid.reference.len()];
        let (force, field) = (zero.clone(), zero);
        Compliance { joints, axes, springs, without_jump, prepared: false, columns, holes: Vec::new(), force, field }
    }

    /// Factorises the stiffness and finds what pressures in holes do, once.
    pub(super) fn prepare(&mut self, scene: &Scene, system: &mut LinearSystem) -> Result<(), SparseError> {
        if self.prepared {
            return Ok(());
        }
        system.begin();
        system.prepare(scene, &scene.solid.cell_damage(), &self.springs)?;
        let holes = scene.optional.liquid.iter().flat_map(|liquid| &liquid.holes);
        for hole in holes.clone() {
            self.force.fill(Vec3::zeros());
            hole.push(1.0, &mut self.force);
            system.solve(&self.force, &mut self.field)?;
            let gains = holes.clone().map(|other| other.gain(&self.field)).collect();
            self.holes.push(HoleColumn { jumps: self.jumps(&self.field), gains });
        }
        self.prepared = true;
        Ok(())
    }

    /// Jumps of all pairs in a displacement field.
    pub(super) fn jumps(&self, field: &[Vec3]) -> Vec<Vec3> {
        self.joints.iter().map(|joint| field[joint.pair[1] as usize] - field[joint.pair[0] as usize]).collect()
    }

    /// Displacements under forces from outside, with forces between pairs.
    ///
    /// - `field`: has the prescribed displacements, and gets the others
    /// - `outer`: forces on the nodes; `between`: pairs and the forces on their second nodes [N]
    pub(super) fn displace(
        &mut self,
        scene: &Scene,
        system: &mut LinearSystem,
        field: &mut [Vec3],
        outer: &[Vec3],
        between: impl Iterator<Item = (u32, Vec3)>,
    ) -> Result<(), SparseError> {
        let Compliance { joints, springs, without_jump, force, field: change, .. } = self;
        scene.solid.secant_force(&scene.solid.cell_damage(), field, force);
        force.iter_mut().zip(outer).for_each(|(force, outer)| *force = outer - *force);
        for (spring, without_jump) in springs.iter().zip(without_jump) {
            spring.push(*without_jump - spring.stiffness * spring.of(field), force);
        }
        for (joint, pushed) in between {
            push(&joints[joint as usize], pushed, force);
        }
        system.solve(force, change)?;
        field.iter_mut().zip(change.iter()).for_each(|(field, change)| *field += change);
        Ok(())
    }

    /// Finds the jumps under unit forces between the nodes of some pairs.
    pub(super) fn find(&mut self, system: &mut LinearSystem, active: &[u32]) -> Result<(), SparseError> {
        for &joint in active {
            for axis in 0..self.axes {
                let place = joint as usize * self.axes + axis;
                if self.columns[place].is_some() {
                    continue;
                }
                self.force.fill(Vec3::zeros());
                push(
                    &self.joints[joint as usize],
                    Vec3::from_fn(|a, _| f64::from(u8::from(a == axis))),
                    &mut self.force,
                );
                system.solve(&self.force, &mut self.field)?;
                self.columns[place] = Some(self.jumps(&self.field));
            }
        }
        Ok(())
    }

    /// Jump of a pair per force between the nodes of another, for which [`Compliance::find`] has been asked [m/N].
    pub(super) fn between(&self, pair: u32, pushed: u32) -> Mat3 {
        let column = |axis: usize| match self.columns.get(pushed as usize * self.axes + axis) {
            Some(Some(column)) if axis < self.axes => column[pair as usize],
            _ => Vec3::zeros(),
        };
        Mat3::from_columns(&[0, 1, 2].map(column))
    }
}

fn push(joint: &Joint, pushed: Vec3, forces: &mut [Vec3]) {
    let [a, b] = joint.pair.map(|node| node as usize);
    forces[a] -= pushed;
    forces[b] += pushed;
}
