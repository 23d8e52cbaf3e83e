//! Laws of bonds, each in its file, behind one trait.

mod bad_law;
mod cohesive_beam;
mod local;

pub use bad_law::BadLaw;
pub use cohesive_beam::BeamSection;
pub use local::{Crushing, Interface, InterfaceFailure, InterfaceMemory, LocalBond, RecentStrains, Separation};

use core::fmt::Debug;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::lanes::{Lanes, Vector};
use crate::material::Hooke;
use crate::{Rotation, Sym3, Vec3};

/// How a bond pulls, bends and dissipates. A law sees one bond and what this remembers, never its neighbours.
///
/// The law itself holds what all bonds of a body share. Forces are written for `W` bonds side by side
/// ([`crate::lanes`]); a network is compiled for each law, so that what a law does not use costs nothing.
pub trait BondLaw: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// What a bond has of its own; `()` where the bonds of a body differ by length and direction only.
    type Parameters: Copy + Debug + Send + Sync;

    /// What a bond remembers from step to step, zero when it is made; `()` for an elastic one.
    type Memory: Copy + Debug + Default + PartialEq + Send + Sync + Serialize + DeserializeOwned;

    /// Part of the memory of `W` bonds that every step reads or writes, beside forces; the rest is only touched where something happens to
    /// a bond. `()` where the whole memory is read at every step.
    type Recent<const W: usize>: Copy + Debug + Default + Send + Sync;

    /// Refuses numbers that make no bond.
    ///
    /// # Errors
    /// Which number is wrong.
    fn check(&self) -> Result<(), BadLaw>;

    /// Parameters of a bond when it is made.
    ///
    /// - `length` l₀ [m]; `radius` of its particles [m]
    /// - `share`: factor on the area that the law gives the bond, 1 for the whole one
    fn parameters(&self, length: f64, radius: [f64; 2], share: f64) -> Self::Parameters;

    /// Forces and moments of `W` bonds side by side at their present state, which also carries memory on. A second call
    /// at the same state must give the same forces and leave memory as it is.
    fn forces<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        own: &[Self::Parameters; W],
        recent: &mut Self::Recent<W>,
        memory: &mut [Self::Memory; W],
    ) -> ForceLanes<W>;

    /// [`BondLaw::forces`] of one bond, whose memory it carries on.
    fn force(&self, pair: &BondedPair, own: &Self::Parameters, memory: &mut Self::Memory) -> BondForces {
        let (mut recent, mut lanes) = alone::<Self>(memory);
        let forces = self.forces(&pair.lanes(), &[*own], &mut recent, &mut lanes);
        *memory = Self::recall(&recent, &lanes, 0);
        forces.into()
    }

    /// The memory of one of `W` bonds with its recent part.
    fn recall<const W: usize>(_: &Self::Recent<W>, memory: &[Self::Memory; W], lane: usize) -> Self::Memory {
        memory[lane]
    }

    /// Puts the memory of one of `W` bonds back.
    fn remember<const W: usize>(
        saved: Self::Memory,
        lane: usize,
        _: &mut Self::Recent<W>,
        memory: &mut [Self::Memory; W],
    ) {
        memory[lane] = saved;
    }

    /// Which of `W` bonds have separated by the law, as bits; see [`BondLaw::separation`].
    fn separated<const W: usize>(_: &Self::Recent<W>) -> u32 {
        0
    }

    /// Energies that `W` bonds side by side would give back; their derivative at fixed memory is the force.
    fn energies<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        own: &[Self::Parameters; W],
        recent: &Self::Recent<W>,
        memory: &[Self::Memory; W],
    ) -> EnergyLanes<W>;

    /// [`BondLaw::energies`] of one bond [J]. It does not need the recent part of the memory.
    fn energy(&self, pair: &BondedPair, own: &Self::Parameters, memory: &Self::Memory) -> BondEnergy {
        let (recent, memory) = alone::<Self>(memory);
        self.energies(&pair.lanes(), &[*own], &recent, &memory).of_lane(0)
    }

    /// Energy that a bond has dissipated so far [J]; never decreases. It does not need the recent part of the memory.
    fn dissipated(&self, length: f64, own: &Self::Parameters, memory: &Self::Memory) -> f64;

    /// Stiffness of a bond without load, which no later state exceeds.
    fn stiffness(&self, length: f64, own: &Self::Parameters) -> BondStiffness;

    /// Normal and tangential stiffness of two crack faces that touch, as stiff as the bond was [N/m].
    ///
    /// - `rest` [m]: distance of the particles at which they touch
    fn face_stiffness(&self, rest: f64) -> [f64; 2];

    /// Radius of the section for stresses in the bond itself [m].
    fn section_radius(&self) -> f64;

    /// The beam that a bond is for small displacements, as the static lattice knows it; none of other laws.
    fn beam(&self) -> Option<BeamSection> {
        None
    }

    /// Factor on the stiffness of a bond's beam.
    fn share(_: &Self::Parameters) -> f64 {
        1.0
    }

    /// How a bond has separated by the law itself, which from then on is that of a contact.
    fn separation(_: &Self::Memory) -> Option<Separation> {
        None
    }

    /// Viscous resistance to the change of length [N s/m], with the reduced mass of the particles [kg].
    fn viscosity(&self, _length: f64, _own: &Self::Parameters, _mass: f64) -> f64 {
        0.0
    }

    /// Hooke's law of the mean strains of particles, where bonds resist only what goes beyond these.
    fn mean_elasticity(&self) -> Option<MeanElasticity> {
        None
    }

    /// [`BondLaw::forces`] of bonds under a law with [`BondLaw::mean_elasticity`].
    ///
    /// - `mean`: mean of the strains of both particles, in Voigt order, in the axes of the undeformed body
    fn deviating_forces<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        _mean: [Lanes<W>; 6],
        own: &[Self::Parameters; W],
        recent: &mut Self::Recent<W>,
        memory: &mut [Self::Memory; W],
    ) -> DeviatingForces<W> {
        let none = [Lanes::splat(0.0); 6];
        DeviatingForces { forces: self.forces(bonds, own, recent, memory), share: none, failing: 0 }
    }

    /// [`BondLaw::energies`] under a law with [`BondLaw::mean_elasticity`].
    fn deviating_energies<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        _mean: [Lanes<W>; 6],
        own: &[Self::Parameters; W],
        recent: &Self::Recent<W>,
        memory: &[Self::Memory; W],
    ) -> EnergyLanes<W> {
        self.energies(bonds, own, recent, memory)
    }

    /// [`BondLaw::deviating_energies`] of one bond [J].
    fn deviating_energy(
        &self,
        pair: &BondedPair,
        mean: Sym3,
        own: &Self::Parameters,
        memory: &Self::Memory,
    ) -> BondEnergy {
        let (recent, memory) = alone::<Self>(memory);
        self.deviating_energies(&pair.lanes(), mean.0.map(|e| Lanes([e])), &[*own], &recent, &memory).of_lane(0)
    }

    /// What a bond transmits that has not separated, with the stress of the mean strain; none where that is not known.
    fn traction(&self, _pair: &BondedPair, _mean: Sym3, _own: &Self::Parameters) -> Option<BondForces> {
        None
    }

    /// The memory of a bond that fails now.
    fn failed(&self, _pair: &BondedPair, _mean: Sym3, _own: &Self::Parameters) -> Self::Memory {
        Self::Memory::default()
    }

    /// A memory that has dissipated an energy more [J].
    fn with_dissipated(
        &self,
        memory: Self::Memory,
        _energy: f64,
        _length: f64,
        _own: &Self::Parameters,
    ) -> Self::Memory {
        memory
    }

    /// Whether the particles of a bond act on each other at a change of length over l₀.
    fn touches(&self, _strain: f64, _: &Self::Memory) -> bool {
        true
    }
}

/// The memory of a bond as that of the only one of its lanes.
#[inline]
fn alone<L: BondLaw>(memory: &L::Memory) -> (L::Recent<1>, [L::Memory; 1]) {
    let (mut recent, mut alone) = (L::Recent::default(), [L::Memory::default()]);
    L::remember(*memory, 0, &mut recent, &mut alone);
    (recent, alone)
}

/// `W` bonds side by side at their present state.
#[derive(Clone, Copy)]
pub struct BondLanes<const W: usize> {
    /// From the first to the second particle [m].
    pub gap: Vector<W>,
    /// Rotations of both particles since the bond was made.
    pub turns: [Turn<W>; 2],
    /// Unit vector from the first to the second particle when the bond was made.
    pub axis: Vector<W>,
    /// 1/l₀ [1/m].
    pub inverse: Lanes<W>,
    /// 1 for a bond, 0 for a broken one, which must give no force.
    pub live: Lanes<W>,
}

impl<const W: usize> BondLanes<W> {
    /// Bonds that are not broken, as bits.
    #[inline(always)]
    fn acting(&self) -> u32 {
        let mut bits = 0;
        for k in 0..W {
            bits |= u32::from(self.live.0[k] != 0.0) << k;
        }
        bits
    }
}

/// A rotation as a unit quaternion: scalar and vector part.
pub type Turn<const W: usize> = (Lanes<W>, Vector<W>);

/// Forces of `W` bonds side by side.
#[derive(Clone, Copy)]
pub struct ForceLanes<const W: usize> {
    /// Force on the second particles [N]; the first get the opposite.
    pub force: Vector<W>,
    /// Moments on the first and on the second particles [N m].
    pub moment: [Vector<W>; 2],
}

/// Energies of `W` bonds side by side, by parts as in [`BondEnergy`] [J].
#[derive(Clone, Copy)]
pub struct EnergyLanes<const W: usize> {
    /// Of changes of length.
    pub tension: Lanes<W>,
    /// Of bending and shear.
    pub bending: Lanes<W>,
    /// Of twist.
    pub torsion: Lanes<W>,
}

impl<const W: usize> EnergyLanes<W> {
    /// Energy of one of the bonds.
    #[inline(always)]
    pub fn of_lane(&self, lane: usize) -> BondEnergy {
        let EnergyLanes { tension, bending, torsion } = self;
        BondEnergy { tension: tension.0[lane], bending: bending.0[lane], torsion: torsion.0[lane] }
    }
}

/// Hooke's law of the mean strains of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanElasticity {
    /// The law.
    pub hooke: Hooke,
    /// Volume of the spheres over that of the body, > 0.
    pub fraction: f64,
}

/// What `W` bonds do that resist deviations from the mean strain of their particles.
#[derive(Clone, Copy)]
pub struct DeviatingForces<const W: usize> {
    /// Forces and moments.
    pub forces: ForceLanes<W>,
    /// Half of their stress times volume, in Voigt order [J]: the same for both particles.
    pub share: [Lanes<W>; 6],
    /// Bonds that fail, as bits.
    pub failing: u32,
}

/// What a bond does to its two particles.
#[derive(Clone, Copy, Debug)]
pub struct BondForces {
    /// Force on the second particle [N]; the first gets the opposite.
    pub force: Vec3,
    /// Moments on the first and the second particle [N m].
    pub moment: [Vec3; 2],
}

/// Energy of a bond [J] by the way it deforms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BondEnergy {
    /// Of its change of length.
    pub tension: f64,
    /// Of bending and shear.
    pub bending: f64,
    /// Of its twist.
    pub torsion: f64,
}

impl BondEnergy {
    /// Sum of the three.
    #[inline]
    pub fn total(&self) -> f64 {
        self.tension + self.bending + self.torsion
    }
}

impl core::ops::Add for BondEnergy {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        BondEnergy {
            tension: self.tension + other.tension,
            bending: self.bending + other.bending,
            torsion: self.torsion + other.torsion,
        }
    }
}

/// Stiffness of a bond. Shear follows, since moments balance it: a bond with shear stiffness k and no bending of its own has
/// `bending` and `carry_over` k l²/4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BondStiffness {
    /// Axial force per change of length [N/m]; E S/l of a beam.
    pub axial: f64,
    /// Moment at an end per rotation of that end across the axis [N m]; 4 E I/l of a beam.
    pub bending: f64,
    /// Moment at an end per rotation of the other end [N m]; 2 E I/l of a beam.
    pub carry_over: f64,
    /// Moment per relative rotation about the axis [N m]; G I₀/l of a beam.
    pub twist: f64,
}

impl BondStiffness {
    /// Transverse force per transverse displacement of an end [N/m]; 12 E I/l³ of a beam.
    #[inline]
    pub fn shear(&self, length: f64) -> f64 {
        2.0 * (self.bending + self.carry_over) / (length * length)
    }

    /// Transverse force per rotation of an end [N]; 6 E I/l² of a beam.
    #[inline]
    pub fn coupling(&self, length: f64) -> f64 {
        (self.bending + self.carry_over) / length
    }
}

/// The two particles of a bond.
#[derive(Clone, Copy, Debug)]
pub struct BondedPair {
    /// Centres [m].
    pub position: [Vec3; 2],
    /// Rotations since the bond was made.
    pub rotation: [Rotation; 2],
    /// Unit vector from the first to the second particle when the bond was made.
    pub axis: Vec3,
    /// Distance then [m].
    pub length: f64,
}

impl BondedPair {
    /// The pair as the only one of its lanes.
    #[inline]
    pub fn lanes(&self) -> BondLanes<1> {
        let vector = |v: Vec3| [Lanes([v.x]), Lanes([v.y]), Lanes([v.z])];
        let turn = |r: &Rotation| (Lanes([r.w]), [Lanes([r.i]), Lanes([r.j]), Lanes([r.k])]);
        BondLanes {
            gap: vector(self.position[1] - self.position[0]),
            turns: [turn(&self.rotation[0]), turn(&self.rotation[1])],
            axis: vector(self.axis),
            inverse: Lanes([1.0 / self.length]),
            live: Lanes([1.0]),
        }
    }
}

impl From<ForceLanes<1>> for BondForces {
    #[inline]
    fn from(lanes: ForceLanes<1>) -> Self {
        let vector = |v: Vector<1>| Vec3::new(v[0].0[0], v[1].0[0], v[2].0[0]);
        BondForces { force: vector(lanes.force), moment: lanes.moment.map(vector) }
    }
}
