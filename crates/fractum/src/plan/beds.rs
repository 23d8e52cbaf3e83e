//! Bedding of solids in the plan of a run.

use fractum_case::model::Beds;
use fractum_fem::{Body, ElementKind, Plane};
use fractum_output::number::{quantity, significant};

use super::Plan;

/// Sine of the angle from which beds count as askew to a plane.
const ASKEW: f64 = 1e-6;

impl Plan {
    pub(super) fn describe_beds(&mut self, beds: &Beds, body: &Body) {
        let (law, elastic) = (&beds.law, &body.elastic);
        let [x, y, z] = [0, 1, 2].map(|axis| significant(law.normal[axis], 4));
        let estimate = if beds.is_estimated { ", Saint-Venant's estimate" } else { "" };
        self.add(
            "",
            format!(
                "beds of normal ({x}, {y}, {z}): E = {} within and {} along it, Poisson's ratio {} and {}, shear modulus {} and {}{estimate}",
                quantity(elastic.young_modulus, "Pa"),
                quantity(law.young_modulus, "Pa"),
                elastic.poisson_ratio,
                law.poisson_ratio,
                quantity(elastic.shear_modulus(), "Pa"),
                quantity(law.shear_modulus, "Pa"),
            ),
        );
        if let Some(strength) = beds.strength.filter(|_| body.damage.is_some()) {
            self.add(
                "",
                format!(
                    "planes of the beds: tensile strength {}, cohesion {}, angle of friction {} deg, fracture energy {}",
                    quantity(strength.tensile_strength, "Pa"),
                    quantity(strength.cohesion, "Pa"),
                    significant(strength.friction_angle.to_degrees(), 4),
                    quantity(strength.fracture_energy, "J/m^2"),
                ),
            );
        }
        if let Some(moduli) = body.extreme_moduli() {
            let [fastest, slowest] = moduli.map(|modulus| quantity((modulus / elastic.density).sqrt(), "m/s"));
            self.add(
                "",
                format!(
                    "waves from {slowest} to {fastest} by direction; contact has E and Poisson's ratio within the beds"
                ),
            );
        }
        let off = law.normal.z.abs().min((1.0 - law.normal.z * law.normal.z).max(0.0).sqrt());
        if body.shape == ElementKind::T3 && body.plane == Plane::Strain && off > ASKEW {
            self.add("", "its beds strike askew to the plane: plane strain holds the motion across the plane that they would bring, and is too stiff".to_owned());
        }
    }
}
