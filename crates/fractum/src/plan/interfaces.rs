//! Interfaces between elements in the plan.

use fractum_case::build::process_zone;
use fractum_output::number::{percent, quantity, significant};
use fractum_scene::{InterfaceKind, Scene};

use super::Plan;

impl Plan {
    /// Faces, strength and stiffness of each interface, and its process zone against its faces.
    pub(super) fn describe_inner_faces(&mut self, scene: &Scene) {
        let interfaces = scene.interfaces();
        for (kind, InterfaceKind { name, law, stiffness }) in (0u32..).zip(interfaces.kinds()) {
            let (faces, area) = interfaces.extent(kind);
            let strength = if law.is_bonded() {
                let [tension, shear] = [law.tensile_strength, law.cohesion].map(|stress| quantity(stress, "Pa"));
                format!("tensile strength {tension}, cohesion {shear}")
            } else {
                "never joined".to_owned()
            };
            let stiffness = match stiffness {
                None if law.is_bonded() => "stiff until its strength is met".to_owned(),
                None => "stiff under pressure".to_owned(),
                Some([normal, shear]) => {
                    let [normal, shear] = [*normal, *shear].map(|stiffness| quantity(stiffness, "Pa/m"));
                    format!("stiffness {normal} across and {shear} along it")
                }
            };
            let zone = process_zone(&scene.solid, interfaces, kind).map_or_else(String::new, |(zone, size)| {
                format!(", process zone some {} faces long", significant(zone / size, 3))
            });
            let area = quantity(area, "m^2");
            self.add("interface", format!("{name}: {faces} faces, {area}, {strength}, {stiffness}{zone}"));
        }
    }
}

/// How much shorter interfaces with a stiffness make the step; nothing where they do not.
pub(super) fn shortened(scene: &Scene) -> Option<String> {
    let own = scene.interfaces().frequency_square();
    let solids = scene.governing_element()?.frequency;
    let part = 1.0 - 1.0 / (1.0 + own / (solids * solids)).sqrt();
    (part > 1e-3).then(|| format!("{} shorter by the stiffness of interfaces", percent(part)))
}
