//! A case whose crack runs along a line of the mesh: an interface with the strength of its material, in bodies that are elastic beside it.

use fractum_fem::{CriterionKind, DamageLaw, Formulation, Softening};
use fractum_scene::{InterfaceLaw, InterfaceSoftening, MixedMode};

use super::{BodyKind, Case, Control, Interface, InterfaceFaces, ProbeKind, SolidBody, SolverKind, StopWhen, load_of};
use crate::{Place, Spanned};

/// Mesh group of the line.
pub const CRACK_LINE: &str = "line of the crack";

/// Steps up to the largest load.
const STEPS: f64 = 60.0;

/// What is left of the load at the end.
const BELOW: f64 = 0.95;

impl Case {
    /// What a line bears along which the crack of this case runs; none where it would not be the same crack: where others than plane solids at rest take part,
    /// where strengths differ from place to place, and where interfaces are given.
    pub fn line_law(&self) -> Option<InterfaceLaw> {
        let others = !self.later.is_empty() || !self.interfaces.is_empty() || !self.ties.is_empty();
        let flows = &self.flows;
        let others = others || flows.gas.is_some() || flows.heat.is_some() || flows.liquid.is_some();
        if others || self.in_situ.is_some() || self.excavation.is_some() || self.solver.kind != SolverKind::Static {
            return None;
        }
        let mut cracked = None;
        for body in &self.bodies {
            match &body.kind {
                BodyKind::Solid(solid) if solid.damage && cracked.is_some() => return None,
                BodyKind::Solid(solid) if solid.damage => cracked = Some(solid),
                BodyKind::Solid(_) => {}
                _ => return None,
            }
        }
        let (load, _) = load_of(&self.probes)?;
        let of_damage =
            |kind: &ProbeKind| matches!(kind, ProbeKind::Damaged(_) | ProbeKind::Crack(_) | ProbeKind::CrackArea(_));
        if self.probes[..=load].iter().any(|probe| of_damage(&probe.kind)) {
            return None;
        }
        self.law_in(cracked?)
    }

    fn law_in(&self, solid: &SolidBody) -> Option<InterfaceLaw> {
        let material = &self.materials[solid.material];
        let damage = &material.damage.as_ref()?.value;
        let is_uniform = damage.scatter.is_none() && solid.strength_factor.is_none() && material.bedding.is_none();
        let DamageLaw { tensile_strength, fracture_energy, .. } = damage.law;
        let is_plain = damage.regularisation.is_none() && damage.rate.is_none() && damage.law.rate_time == 0.0;
        let is_rankine = damage.law.criterion.kind() == CriterionKind::Rankine;
        if !is_uniform || !is_plain || !is_rankine || solid.formulation != Formulation::Smoothed {
            return None;
        }
        let softening = match damage.law.softening {
            Softening::Exponential => InterfaceSoftening::Exponential,
            Softening::Linear => InterfaceSoftening::Linear,
            Softening::Bilinear { .. } => return None,
        };
        Some(InterfaceLaw {
            tensile_strength,
            cohesion: tensile_strength,
            opening_energy: fracture_energy,
            sliding_energy: fracture_energy,
            friction: 0.0,
            residual_friction: 0.0,
            dilation: 0.0,
            dilation_slip: f64::INFINITY,
            mixed_mode: MixedMode::Power(1.0),
            softening,
            roughness: None,
        })
    }

    /// Makes the crack run along the lines of the group [`CRACK_LINE`], and measures the load alone.
    ///
    /// - `peak`: about when the load is largest [s]
    /// - returns false where the case has no [`Case::line_law`]; it is then as it was
    pub fn run_along_line(&mut self, peak: f64) -> bool {
        let Some((law, (load, _))) = self.line_law().zip(load_of(&self.probes)) else { return false };
        let place: Place = self.solver.place.clone();
        self.materials.iter_mut().for_each(|material| material.damage = None);
        for body in &mut self.bodies {
            if let BodyKind::Solid(solid) = &mut body.kind {
                (solid.damage, solid.damage_where) = (false, None);
            }
        }
        self.interfaces.push(Interface {
            name: CRACK_LINE.to_owned(),
            place: place.clone(),
            along: InterfaceFaces::Group(Spanned::new(CRACK_LINE.to_owned(), place.clone())),
            law,
            stiffness: None,
            pressure: None,
            heat_transfer: None,
        });
        // Expressions read earlier probes only.
        self.probes.truncate(load + 1);
        (self.expect, self.output.plots) = (Vec::new(), Vec::new());
        self.solver.step = Some(Spanned::new(peak / STEPS, place));
        self.solver.stop_when = Some(StopWhen { probe: load, below: BELOW, after: 0.0, lasting: Some(0.0) });
        if let Some(statics) = &mut self.solver.statics {
            (statics.control, statics.opening) = (Some(Control::Time), None);
        }
        true
    }
}
