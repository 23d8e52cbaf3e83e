//! Pairs of materials with coefficients of contact of their own.

use fractum_case::model::{BodyKind, Case, ContactPair};
use fractum_output::number::{quantity, significant};
use fractum_scene::{ContactParameters, restitution_of_damping};

use super::Plan;

impl Plan {
    /// The coefficients that act between the materials of each pair: those of the pair, and those that follow from both.
    pub(super) fn describe_contact_pairs(&mut self, case: &Case) {
        for pair in &case.contact_pairs {
            let [first, second] = pair.materials.map(|index| &case.materials[index]);
            let rule = first.contact.against(second.contact);
            let (own, others): (Vec<_>, Vec<_>) = told(pair, rule).into_iter().partition(|(own, _)| *own);
            let list = |of: Vec<(bool, String)>| of.into_iter().map(|(_, text)| text).collect::<Vec<_>>().join(", ");
            let mut text = format!("{} and {}: {}", first.name.value, second.name.value, list(own));
            if !others.is_empty() {
                text += &format!("; as the materials have it: {}", list(others));
            }
            for body in &case.bodies {
                let BodyKind::Rigid(rigid) = &body.kind else { continue };
                let of_pair = rigid.material.is_some_and(|material| pair.materials.contains(&material));
                let both = pair.coefficients.named().into_iter().zip(rigid.own_contact.named());
                let both = both.filter(|((_, of_pair), (_, own))| of_pair.is_some() && own.is_some());
                let names: Vec<String> = both.map(|((name, _), _)| name.replace('_', " ")).collect();
                if of_pair && !names.is_empty() {
                    text += &format!("; but {} has its own {}", body.name.value, names.join(", "));
                }
            }
            self.add("contact", text);
        }
    }
}

/// Coefficients in words, and whether each is that of the pair.
///
/// - `rule`: what follows from the materials
fn told(pair: &ContactPair, rule: ContactParameters) -> Vec<(bool, String)> {
    let given = pair.coefficients;
    let ContactParameters { friction, rolling_friction, damping_ratio } = given.over(rule);
    let restitution = significant(restitution_of_damping(damping_ratio), 3);
    let mut told = vec![
        (given.friction.is_some(), format!("friction {friction}")),
        (given.damping_ratio.is_some(), format!("restitution {restitution}")),
    ];
    if rolling_friction > 0.0 || given.rolling_friction.is_some() {
        told.insert(1, (given.rolling_friction.is_some(), format!("rolling friction {rolling_friction}")));
    }
    told.extend(given.work_of_adhesion.map(|work| (true, format!("work of adhesion {}", quantity(work, "J/m^2")))));
    told
}
