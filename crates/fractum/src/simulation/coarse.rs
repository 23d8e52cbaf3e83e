//! Results that few elements decide: cracks that open along few faces, balls that press on few nodes.

use fractum_fem::Formulation;
use fractum_fem::neighbours::is_divided;
use fractum_output::number::{percent, quantity};
use fractum_output::warning::{Code, Warning};
use fractum_scene::{Scene, coarsest_indentation};

/// Part of its volume by which a crack along an interface may open too little before it is told, and that to which the remedy brings it.
const OPENS_TOO_LITTLE: f64 = 0.1;
const AS_IT_SHOULD: f64 = 0.05;

/// A crack that a pressure has opened along an interface within solids, with few faces from its middle to its edge.
pub(super) fn coarse_crack(scene: &Scene) -> Option<Warning> {
    let interfaces = scene.interfaces();
    let crack = interfaces.coarsest_crack(&scene.solid).filter(|crack| crack.is_missing() > OPENS_TOO_LITTLE)?;
    let [plain, smoothed] = crack.missing.map(|part| quantity(AS_IT_SHOULD / part * crack.size, "m"));
    let text = format!(
        "it has opened over {} with faces of {} at the edge of that within solids: linear elements are stiff there, and open such a crack by some {} too little",
        quantity(crack.area, "m^2"),
        quantity(crack.size, "m"),
        percent(crack.is_missing())
    );
    let left = percent(AS_IT_SHOULD);
    let remedy = if crack.is_smoothed {
        format!("faces of {smoothed} there leave {left} of it")
    } else {
        format!(
            "faces of {plain} there leave {left} of it, or of {smoothed} where the bodies beside have formulation = \"smoothed\""
        )
    };
    let place = format!("interface \"{}\"", interfaces.kinds()[crack.kind as usize].name);
    Some(Warning::new(Code::CoarseMesh, place, text).remedy(remedy))
}

/// A ball that presses on few nodes of a solid at the end.
pub(super) fn coarse_indentation(scene: &Scene) -> Option<Warning> {
    if is_divided(&scene.solid) {
        return None;
    }
    let found = coarsest_indentation(scene)?;
    let (solid, nodes) = (scene.solid.body(found.body), if found.nodes == 1 { "node" } else { "nodes" });
    let ball = scene.contacts.rigid_bodies().get(found.rigid_body)?;
    let text = format!(
        "\"{}\" presses on {} {nodes} of \"{}\" at the end, where the area of Hertz' theory has a radius of {}; expected {} nodes at least: force and depth are those of the mesh, by up to several times",
        ball.name,
        found.nodes,
        solid.name,
        quantity(found.radius, "m"),
        found.wanted
    );
    let smoothed = match solid.formulation {
        Formulation::Standard => ", or formulation = \"smoothed\" and some twice of that",
        Formulation::Smoothed => "",
    };
    let remedy = format!("take elements of {} there{smoothed}", quantity(found.size, "m"));
    Some(Warning::new(Code::CoarseMesh, format!("body \"{}\"", solid.name), text).remedy(remedy))
}
