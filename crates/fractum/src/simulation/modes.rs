//! What a search for natural vibrations found beside them, as warnings.

use fractum_output::warning::{Code, Warning};
use fractum_scene::statics::modes_of;
use fractum_scene::{Mode, Modes};

use super::Simulation;
use crate::error::Failure;

impl Simulation {
    /// Warns of what is not one body that is held and stiff.
    pub(super) fn warn_of_modes(&mut self) -> Result<(), Failure> {
        let found = modes_of(&self.scene).map_or(Vec::new(), doubts);
        found.into_iter().try_for_each(|warning| self.warn_once(warning))
    }
}

/// What is doubtful about a body whose vibrations these are.
fn doubts(found: &Modes) -> Vec<Warning> {
    let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let is_of = |has: fn(&Mode) -> bool| found.modes.iter().any(has);
    let (is_bonded, is_solid) = (is_of(|mode| !mode.particles.is_empty()), is_of(|mode| !mode.shape.is_empty()));
    let mut warnings = Vec::new();
    if found.loose > 0 {
        let text = format!("{} without bonds, left out of the vibrations", counted(found.loose, "particle"));
        let remedy = "choose a higher coordination where they should hold on to the body";
        warnings.push(Warning::new(Code::InPieces, "", text).remedy(remedy));
    }
    if found.pieces > 1 {
        let (what, remedy) = match (is_solid, is_bonded) {
            (true, true) => ("bodies", "tie bonded bodies to solids with [[ties]]"),
            (false, _) => ("bonded bodies", "choose a higher coordination"),
            (true, false) => ("solids", "let them share their nodes: mesh them together, or join them with mesh.join"),
        };
        let text = format!("the {what} are {} pieces that vibrate each by itself", found.pieces);
        let remedy = format!("where they should be one, {remedy}");
        warnings.push(Warning::new(Code::InPieces, "", text).remedy(remedy));
    }
    if found.rigid_motions > 0 {
        let text = format!("{} that nothing prevents", counted(found.rigid_motions, "rigid motion"));
        let remedy = "they are not among the vibrations; where the body stands on something, add [[supports]]";
        warnings.push(Warning::new(Code::RigidMotion, "", text).remedy(remedy));
    }
    if found.mechanisms > 0 {
        let text = format!("{} without stiffness within the solids", counted(found.mechanisms, "motion"));
        let remedy = "parts that hang together by a node or an edge turn about it; join them over faces";
        warnings.push(Warning::new(Code::Mechanism, "", text).remedy(remedy));
    }
    if !found.converged {
        let worst = found.modes.iter().map(|mode| mode.residual).fold(0.0, f64::max);
        let text = format!("vibrations are balanced to {worst:.0e} only");
        let remedy = "choose solver.linear_solver = \"direct\" or \"faer\"";
        warnings.push(Warning::new(Code::Unsettled, "", text).remedy(remedy));
    }
    warnings
}
