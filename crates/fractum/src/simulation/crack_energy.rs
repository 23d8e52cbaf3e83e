//! Cracks that cost more or less than their fracture energy.

use fractum_case::build::is_notched;
use fractum_fem::Formulation;
use fractum_fem::cracks::{CrackCost, cost_of_cracks};
use fractum_fem::neighbours::is_divided;
use fractum_output::number::{percent, quantity};
use fractum_output::warning::{Code, Warning};
use fractum_scene::{EnergyKind, Scene};

use super::messages::at;

/// Energy beside cracks over that at them, above which they share an opening.
const BESIDE: f64 = 0.2;
/// Energy without that ahead of cracks over the fracture energy of their area, above which this is told, of smoothed and of plain elements: rough cracks
/// through plain ones have a mean plane of 0.8 of their area.
const TOO_MUCH: [f64; 2] = [1.12, 1.3];
/// Energy over the fracture energy of the area, its faces as flat as they may be, below which cracks are too cheap.
const TOO_LITTLE: f64 = 0.9;
/// Energy ahead of cracks over that at them, above which they have only begun.
const BEGUN: f64 = 0.5;
/// Energy over what the opening of edges takes, above which edges are crushed or sheared.
const OPENED: f64 = 1.4;
/// Energy at cracks over the fracture energy of their area, above which they show one face only, of smoothed and of plain elements.
const ONE_FACE: [f64; 2] = [1.3, 1.05];

/// Energy of interfaces over the most that their law takes, above which a step at rest went over a snap-back.
const JUMPED: f64 = 1.1;

/// Warns of a run at rest whose interfaces took more than their fracture energy: what the bodies set free in a jump is in it.
pub(super) fn jumped_snap_back(scene: &Scene) -> Option<Warning> {
    let (ledger, interfaces) = (scene.ledger(), scene.interfaces());
    if interfaces.is_empty() || ledger[EnergyKind::Removed] != 0.0 || ledger[EnergyKind::Left] != 0.0 {
        return None;
    }
    let (taken, most) = (ledger[EnergyKind::InterfaceFracture], interfaces.largest_fracture());
    if most == 0.0 || taken <= JUMPED * most {
        return None;
    }
    let text = format!(
        "interfaces took {}, {:.2} times the fracture energy of the area that has begun to break: a step went over a snap-back, and what the bodies \
         set free in it is counted there",
        quantity(taken, "J"),
        taken / most
    );
    let found = Warning::new(Code::CrackEnergy, "", text);
    Some(found.remedy(
        "follow the path of equilibrium with solver.control = \"path\", or the motion with no_equilibrium = \"motion\"",
    ))
}

/// Warns where damage took clearly more than the fracture energy of cracks that share an opening, or clearly less than that of cracks.
pub(super) fn crack_energy(scene: &Scene) -> Option<Warning> {
    let (ledger, solid) = (scene.ledger(), &scene.solid);
    let taken = ledger[EnergyKind::Damage] + ledger[EnergyKind::Removed];
    // No process has all edges of a mesh in parts.
    let cost = if is_divided(solid) { None } else { cost_of_cracks(solid) };
    let CrackCost { area, flat, at_cracks, beside, ahead, place } = cost?;
    let mut bodies = (0..solid.body_count()).map(|body| solid.body(body));
    let is_plain = bodies.any(|body| body.damage.is_some() && body.formulation == Formulation::Standard);
    if taken < TOO_LITTLE * flat {
        let text = format!(
            "damage took {}, {} of the fracture energy of the area that has separated",
            quantity(taken, "J"),
            percent(taken / flat)
        );
        let found = Warning::new(Code::CrackEnergy, "", text);
        return Some(found.remedy(if is_plain {
            "local damage on plain elements makes cracks cheap on uneven meshes: take formulation = \"smoothed\", or regularisation = \"phase-field\""
        } else {
            "elements parted faster than they could soften, or were too large: take smaller ones where cracks go, or regularisation = \"phase-field\""
        }));
    }
    let has_opened = taken < OPENED * (at_cracks + beside + ahead) && ledger[EnergyKind::Kinetic] < taken;
    if has_opened && at_cracks > ONE_FACE[usize::from(is_plain)] * area {
        let text = format!(
            "elements that have gone have spent {:.1} times the fracture energy of the area that has separated: along the surface, or along a body that \
             cannot break, a crack shows one face, and its area in probes and cracks.csv is half of what it is",
            at_cracks / area
        );
        let found = Warning::new(Code::CrackArea, "", text);
        return Some(found.remedy(
            "let the crack run within its body (strength_factor, damage_where), or count its area twice there",
        ));
    }
    let is_shared = has_opened
        && beside > BESIDE * at_cracks
        && taken - ahead > TOO_MUCH[usize::from(is_plain)] * area
        && ahead < BEGUN * at_cracks
        && !is_notched(solid);
    if !is_shared {
        return None;
    }
    let text = format!(
        "damage took {}, {:.2} times the fracture energy of the area that has separated: {} of it beside cracks, in elements that they have unloaded, as \
         cracks in a part that is equally weak share its opening",
        quantity(taken, "J"),
        taken / area,
        percent(beside / (at_cracks + beside + ahead))
    );
    let found = Warning::new(Code::CrackEnergy, at(place), text);
    Some(found.remedy(
        "take regularisation = \"phase-field\", or let one crack begin: a notch, or a strength_factor below 1 over two elements",
    ))
}
