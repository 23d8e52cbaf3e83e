//! The choice of a bond law: the only place that names every law, matched once per batch of bonds.

use std::ops::Range;

use fractum_contact::{Image, PeriodicCell};
use fractum_kernels::bond::{BeamSection, BondEnergy, BondForces, BondLaw, LocalBond, Separation};
use fractum_math::{Mat3, Sym3, Vec3};
use serde::{Deserialize, Serialize};

use super::graph::BondGraph;
use super::loads::{LoadLanes, LoadSizes};
use super::network::BondNetwork;
use super::through_box;
use crate::DemError;
use crate::particles::{ParticleSubdomain, Particles};

macro_rules! laws {
    ($($(#[$doc:meta])* $name:ident($law:ty),)*) => {
        /// A law for the bonds of a body.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyBondLaw {
            $($(#[$doc])* $name($law),)*
        }

        $(impl From<$law> for AnyBondLaw {
            fn from(law: $law) -> Self {
                AnyBondLaw::$name(law)
            }
        })*

        /// The bonds of a body under the law that was chosen for them.
        #[derive(Clone, Debug)]
        pub enum Bonds {
            $($(#[$doc])* $name(BondNetwork<$law>),)*
        }

        /// What the bonds of a body remember, for a checkpoint.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub enum BondMemory {
            $($(#[$doc])* $name(Vec<<$law as BondLaw>::Memory>),)*
        }

        /// The network of any law, under a name, with an expression for it.
        macro_rules! each {
            ($bonds:expr, $network:ident => $result:expr) => {
                match $bonds {
                    $(Bonds::$name($network) => $result,)*
                }
            };
        }

        impl Bonds {
            /// Bonds particles at their present distances; their orientations count from now on.
            ///
            /// - `pairs`: the particles of each bond
            ///
            /// # Errors
            /// Numbers of the law that make no bond; a bond that joins nothing.
            pub fn new(
                particles: &Particles,
                pairs: &[[u32; 2]],
                law: impl Into<AnyBondLaw>,
            ) -> Result<Self, DemError> {
                Self::with_shares(particles, pairs, &[], law)
            }

            /// See [`BondNetwork::with_shares`].
            ///
            /// # Errors
            /// As [`Bonds::new`]; another number of factors than of bonds.
            pub fn with_shares(
                particles: &Particles,
                pairs: &[[u32; 2]],
                shares: &[f64],
                law: impl Into<AnyBondLaw>,
            ) -> Result<Self, DemError> {
                Self::within(particles, pairs, shares, law, None)
            }

            /// See [`BondNetwork::within`].
            ///
            /// # Errors
            /// As [`Bonds::with_shares`].
            pub fn within(
                particles: &Particles,
                pairs: &[[u32; 2]],
                shares: &[f64],
                law: impl Into<AnyBondLaw>,
                cell: Option<&PeriodicCell>,
            ) -> Result<Self, DemError> {
                Ok(match law.into() {
                    $(AnyBondLaw::$name(law) => {
                        Bonds::$name(BondNetwork::within(particles, pairs, shares, law, cell)?)
                    })*
                })
            }

            /// The law of the bonds.
            pub fn law(&self) -> AnyBondLaw {
                match self {
                    $(Bonds::$name(network) => AnyBondLaw::$name(*network.law()),)*
                }
            }

            /// What the bonds remember.
            pub fn memory(&self) -> BondMemory {
                match self {
                    $(Bonds::$name(network) => BondMemory::$name(network.memory()),)*
                }
            }

            /// Puts a saved memory back into bonds made from the same case; one of another law is left out.
            pub fn restore_memory(&mut self, saved: &BondMemory) {
                match (self, saved) {
                    $((Bonds::$name(network), BondMemory::$name(saved)) => network.restore_memory(saved),)*
                    #[allow(unreachable_patterns)]
                    _ => {}
                }
            }
        }
    };
}

laws! {
    /// Cohesive beams.
    CohesiveBeam(BeamSection),
    /// Interfaces of the local constitutive law.
    Local(LocalBond),
}

impl Bonds {
    /// Number of bonds, broken ones included.
    pub fn len(&self) -> usize {
        self.pairs().len()
    }

    /// Whether there are no bonds.
    pub fn is_empty(&self) -> bool {
        self.pairs().is_empty()
    }

    /// The particles of each bond, first < second, ascending.
    pub fn pairs(&self) -> &[[u32; 2]] {
        each!(self, network => network.pairs())
    }

    /// Whether a bond still holds.
    pub fn is_live(&self, bond: usize) -> bool {
        each!(self, network => network.is_live(bond))
    }

    /// Takes the box as it is now; without effect on bonds that are in none.
    pub fn set_cell(&mut self, cell: &PeriodicCell) {
        each!(self, network => through_box::set_cell(network, cell));
    }

    /// The box in which the bonds repeat, with the images of the second particles that they join the first ones to.
    pub fn through_box(&self) -> Option<(&PeriodicCell, &[Image])> {
        each!(self, network => through_box::through_box(network))
    }

    /// From the first particle of a bond to the second, or to the image that it is bonded to [m].
    pub fn gap(&self, bond: usize, particles: &Particles) -> Vec3 {
        each!(self, network => through_box::gap(network, bond, particles))
    }

    /// The ends of a bond by places in the undeformed body, the second one where the image is that it joins [m].
    pub fn ends(&self, bond: usize, reference: &[Vec3]) -> [Vec3; 2] {
        each!(self, network => through_box::ends(network, bond, reference))
    }

    /// Sums over the bonds at the last pass, with forces f on the second particles [N]: Σ f ⊗ n with the edges n of the box between a
    /// particle and its image [N], and Σ f ⊗ r with the gaps r [N m]; none without such a box.
    pub fn sums_through_box(&self) -> Option<[Mat3; 2]> {
        each!(self, network => through_box::sums(network))
    }

    /// Distance of the particles of a bond without load [m].
    pub fn length(&self, bond: usize) -> f64 {
        each!(self, network => network.length(bond))
    }

    /// See [`BondNetwork::set_length`].
    pub fn set_length(&mut self, bond: usize, length: f64) {
        each!(self, network => network.set_length(bond, length));
    }

    /// See [`BondNetwork::take_separated`].
    pub fn take_separated(&mut self, out: &mut Vec<(u32, Separation)>) {
        each!(self, network => network.take_separated(out));
    }

    /// See [`BondNetwork::distribute`].
    pub fn distribute(&mut self, part: &ParticleSubdomain) {
        each!(self, network => network.distribute(part));
    }

    /// See [`BondNetwork::can_be_shared`].
    pub fn can_be_shared(&self) -> bool {
        each!(self, network => network.can_be_shared())
    }

    /// See [`BondNetwork::has_memory`].
    pub fn has_memory(&self) -> bool {
        each!(self, network => network.has_memory())
    }

    /// See [`BondNetwork::gather_memory`].
    pub fn gather_memory(&mut self, bonds: impl Iterator<Item = u32>) {
        each!(self, network => network.gather_memory(bonds));
    }

    /// Bonds that this process computes; all where there is one.
    pub(crate) fn own_bonds(&self) -> Range<usize> {
        each!(self, network => network.own_bonds())
    }

    /// See [`BondNetwork::viscous_time`].
    pub fn viscous_time(&self, particles: &Particles) -> f64 {
        each!(self, network => network.viscous_time(particles))
    }

    /// See [`BondNetwork::add_viscous_forces`].
    pub fn add_viscous_forces(&self, particles: &Particles, graph: &BondGraph, out: &mut [Vec3]) {
        each!(self, network => network.add_viscous_forces(particles, graph, out));
    }

    /// Breaks a bond for ever.
    pub fn break_bond(&mut self, bond: usize) {
        each!(self, network => network.break_bond(bond));
    }

    /// See [`BondNetwork::add_forces`].
    pub fn add_forces(&mut self, particles: &mut Particles) {
        each!(self, network => network.add_forces(particles));
    }

    /// See [`BondNetwork::add_forces_and_virials`].
    pub fn add_forces_and_virials(&mut self, particles: &mut Particles) {
        each!(self, network => network.add_forces_and_virials(particles));
    }

    /// See [`BondNetwork::add_forces_and_virial_bounds`].
    pub fn add_forces_and_virial_bounds(&mut self, particles: &mut Particles) {
        each!(self, network => network.add_forces_and_virial_bounds(particles));
    }

    /// See [`BondNetwork::add_forces_and_loads`].
    pub fn add_forces_and_loads(&mut self, particles: &mut Particles) {
        each!(self, network => network.add_forces_and_loads(particles));
    }

    /// See [`BondNetwork::list_by_loads`].
    pub fn list_by_loads(&self, meet: &(dyn Fn(&LoadLanes, f64) -> bool + Sync), list: &mut Vec<u32>) {
        each!(self, network => network.list_by_loads(meet, list));
    }

    /// See [`BondNetwork::load_sizes`].
    pub fn load_sizes(&self, bond: usize) -> Option<LoadSizes> {
        each!(self, network => network.load_sizes(bond))
    }

    /// See [`BondNetwork::find_virials`].
    pub fn find_virials(&mut self, particles: &Particles) {
        each!(self, network => network.find_virials(particles));
    }

    /// See [`BondNetwork::book_last_work`].
    pub fn book_last_work(&mut self, particles: &Particles, dt: f64) {
        each!(self, network => network.book_last_work(particles, dt));
    }

    /// Whether forces come with virials, which those of bonds beside the mean strain of particles do not.
    pub fn has_virials(&self) -> bool {
        each!(self, network => network.law().mean_elasticity().is_none())
    }

    /// See [`BondNetwork::virial_bounds`].
    pub fn virial_bounds(&self, out: &mut [[f64; 2]]) {
        each!(self, network => network.virial_bounds(out));
    }

    /// See [`BondNetwork::virials`].
    pub fn virials(&self, out: &mut [Sym3]) {
        each!(self, network => network.virials(out));
    }

    /// Force of a live bond on its second particle and the moments on both.
    pub fn forces_of(&self, bond: usize, particles: &Particles) -> BondForces {
        each!(self, network => network.forces_of(bond, particles))
    }

    /// Energy that a bond, live or not, would give back, by parts [J].
    pub fn energy_of(&self, bond: usize, particles: &Particles) -> BondEnergy {
        each!(self, network => network.energy_of(bond, particles))
    }

    /// Energy that all live bonds would give back, by parts [J].
    pub fn energy(&self, particles: &Particles) -> BondEnergy {
        each!(self, network => network.energy(particles))
    }

    /// Energy that all bonds have dissipated so far, broken ones included [J].
    pub fn dissipated(&self) -> f64 {
        each!(self, network => network.dissipated())
    }

    /// See [`BondNetwork::stable_step`].
    pub fn stable_step(&self, particles: &Particles, safety: f64) -> f64 {
        each!(self, network => network.stable_step(particles, safety))
    }

    /// Normal and tangential stiffness of crack faces that touch at a distance [m] of their particles [N/m].
    pub fn face_stiffness(&self, rest: f64) -> [f64; 2] {
        each!(self, network => network.law().face_stiffness(rest))
    }

    /// Radius of the section for stresses in the bond itself [m].
    pub fn section_radius(&self) -> f64 {
        each!(self, network => network.law().section_radius())
    }

    /// See [`BondLaw::beam`].
    pub fn beam(&self) -> Option<BeamSection> {
        each!(self, network => network.law().beam())
    }

    /// See [`BondLaw::share`].
    pub fn share(&self, bond: usize) -> f64 {
        each!(self, network => network.share(bond))
    }
}
