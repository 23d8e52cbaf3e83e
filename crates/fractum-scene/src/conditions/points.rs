use fractum_fem::{Depth, Solid, facet_depth, neighbours};
use fractum_math::{CHUNK, Vec3};
use rayon::prelude::*;

/// The points that a set is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Population {
    /// Nodes of solids.
    Nodes,
    /// Particles of bonded bodies and loose ones.
    Particles,
}

/// What has a place that moves: nodes of solids, particles.
pub(crate) trait Points {
    /// Place without load [m].
    fn reference(&self, point: usize) -> &Vec3;

    /// Present place [m].
    fn position(&self, point: usize) -> Vec3;

    /// Present displacement, counted from the start [m].
    fn displacement(&self, point: usize) -> Vec3;

    /// Displacement a time `dt` [s] earlier, at the present velocity [m].
    fn displacement_before(&self, point: usize, dt: f64) -> Vec3;

    /// Velocity at the half step [m/s].
    fn velocity(&self, point: usize) -> &Vec3;

    /// Moment that would turn a point did nothing hold it [N m]; points of solids do not turn.
    fn moment(&self, _point: usize) -> Vec3 {
        Vec3::zeros()
    }

    /// Depth of a facet that is an edge in the plane; none in space.
    fn depth(&self, _facet: &[u32; 3]) -> Option<Depth> {
        None
    }
}

/// Points that supports move and loads push.
pub(crate) trait DrivenPoints: Points {
    /// Mass [kg].
    fn mass(&self, point: usize) -> f64;

    /// Forces of tⁿ [N].
    fn forces(&mut self) -> &mut [Vec3];

    /// Gives a degree of freedom another velocity and moves it on.
    ///
    /// - `path`: way to add [m]
    fn set_motion(&mut self, point: usize, axis: usize, velocity: f64, path: f64);

    /// Part of the force on a prescribed degree of freedom that the kick has left out [N].
    fn force_left_out(&self, point: usize, axis: usize) -> f64;

    /// Adds the weight of every point under an acceleration [m/s²].
    fn add_weight(&mut self, gravity: &Vec3);

    /// Momentum of all points that have weight [kg m/s].
    ///
    /// - `partial`: scratch, an entry for every [`CHUNK`] points
    fn momentum(&self, partial: &mut [Vec3]) -> Vec3;
}

impl Points for Solid {
    fn reference(&self, point: usize) -> &Vec3 {
        &self.reference[self.original(point)]
    }

    fn position(&self, point: usize) -> Vec3 {
        self.reference[self.original(point)] + self.displacement[point]
    }

    fn displacement(&self, point: usize) -> Vec3 {
        self.displacement_from_start(point)
    }

    fn displacement_before(&self, point: usize, dt: f64) -> Vec3 {
        self.displacement_from_start(point) - self.velocity[point] * dt
    }

    fn velocity(&self, point: usize) -> &Vec3 {
        &self.velocity[point]
    }

    fn depth(&self, facet: &[u32; 3]) -> Option<Depth> {
        facet_depth(self, facet)
    }
}

impl DrivenPoints for Solid {
    fn mass(&self, point: usize) -> f64 {
        self.mass[point]
    }

    fn forces(&mut self) -> &mut [Vec3] {
        &mut self.force
    }

    fn set_motion(&mut self, point: usize, axis: usize, velocity: f64, path: f64) {
        self.velocity[point][axis] = velocity;
        self.displacement[point][axis] += path;
    }

    /// Prescribed nodes are kicked as all others.
    fn force_left_out(&self, _: usize, _: usize) -> f64 {
        0.0
    }

    fn add_weight(&mut self, gravity: &Vec3) {
        let forces = self.force.par_iter_mut().zip(&self.mass).with_min_len(CHUNK);
        forces.for_each(|(force, &mass)| *force += gravity * mass);
    }

    fn momentum(&self, partial: &mut [Vec3]) -> Vec3 {
        let momentum = |v: &[Vec3], m: &[f64]| v.iter().zip(m).map(|(v, m)| v * *m).sum::<Vec3>();
        let chunks = self.velocity.par_chunks(CHUNK).zip(self.mass.par_chunks(CHUNK));
        partial.par_iter_mut().zip(chunks).for_each(|(sum, (v, m))| *sum = momentum(v, m));
        neighbours::exchange_sums(self, partial);
        partial.iter().sum()
    }
}
