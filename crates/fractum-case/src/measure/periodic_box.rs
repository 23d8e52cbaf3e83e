//! Something about the periodic box.

use fractum_scene::{BoxMeasure, NeededPoints, Probe, ProbeNeeds, ProbedScene, Scene, measure_periodic_box};

use super::Measure;
use super::scenery::Scenery;
use crate::Choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;

impl Choice for BoxMeasure {
    #[rustfmt::skip] // six components of each tensor
    const NAMES: &'static [(&'static str, Self)] = &[
        ("stress_xx", BoxMeasure::Stress([0, 0])), ("stress_yy", BoxMeasure::Stress([1, 1])),
        ("stress_zz", BoxMeasure::Stress([2, 2])), ("stress_xy", BoxMeasure::Stress([0, 1])),
        ("stress_yz", BoxMeasure::Stress([1, 2])), ("stress_xz", BoxMeasure::Stress([0, 2])),
        ("kinetic_stress_xx", BoxMeasure::KineticStress([0, 0])),
        ("kinetic_stress_yy", BoxMeasure::KineticStress([1, 1])),
        ("kinetic_stress_zz", BoxMeasure::KineticStress([2, 2])),
        ("kinetic_stress_xy", BoxMeasure::KineticStress([0, 1])),
        ("kinetic_stress_yz", BoxMeasure::KineticStress([1, 2])),
        ("kinetic_stress_xz", BoxMeasure::KineticStress([0, 2])), ("pressure", BoxMeasure::Pressure),
        ("solid_fraction", BoxMeasure::SolidFraction), ("coordination", BoxMeasure::Coordination),
        ("volume", BoxMeasure::Volume), ("strain_xx", BoxMeasure::Strain([0, 0])),
        ("strain_yy", BoxMeasure::Strain([1, 1])), ("strain_zz", BoxMeasure::Strain([2, 2])),
        ("strain_xy", BoxMeasure::Strain([0, 1])), ("strain_yz", BoxMeasure::Strain([1, 2])),
        ("strain_xz", BoxMeasure::Strain([0, 2])),
    ];
}

/// Something about the periodic box.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicBox {
    /// What about it.
    pub measure: BoxMeasure,
}

impl Measure for PeriodicBox {
    const KEY: &'static str = "periodic_box";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].periodic_box", K::Choice(names::<BoxMeasure>), "", "A number about the periodic box. stress_: stress of the contacts, the bonds and the motion against the mean flow over its volume, tension positive; kinetic_stress_: the part of the motion alone; pressure: -(xx + yy + zz)/3; solid_fraction: volume of the particles over that of the box; coordination: contacts and bonds per particle, twice their number over particles; volume; strain_: change of length since the start over the length, or shear, in strain_xy the way along x over the height along y"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let measure = probe.choice(Self::KEY).required()?;
        let dimension = match measure {
            BoxMeasure::Stress(_) | BoxMeasure::KineticStress(_) | BoxMeasure::Pressure => D::PRESSURE,
            BoxMeasure::SolidFraction | BoxMeasure::Coordination | BoxMeasure::Strain(_) => D::NONE,
            BoxMeasure::Volume => D::VOLUME,
        };
        Some((PeriodicBox { measure }, dimension))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(OfBox(self.measure)))
    }
}

#[derive(Debug)]
struct OfBox(BoxMeasure);

impl Probe for OfBox {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        measure_periodic_box(probed.scene, self.0)
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { particles: NeededPoints::Any, ..ProbeNeeds::default() }
    }
}
