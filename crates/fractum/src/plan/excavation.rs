//! What a stage takes out and puts in, in words.

use fractum_case::model::Case;
use fractum_output::number::{percent, quantity};
use fractum_scene::Scene;

/// The bodies that leave as a stage begins, how their forces fade, and the bodies that come in; none where nothing changes.
///
/// - `scene`: of that stage
pub(super) fn told(case: &Case, scene: &Scene) -> Vec<String> {
    let Some(excavation) = &case.excavation else { return Vec::new() };
    let solid = &scene.solid;
    let said = |name: &str, what: &str| {
        let body = (0..solid.body_count()).find(|&body| solid.body(body).name == name)?;
        let volume: f64 = solid.element_volumes(body).iter().sum();
        let mass = quantity(volume * solid.body(body).elastic.density, "kg");
        Some(format!("body \"{name}\" {what}: {} elements, {mass}", solid.body(body).elements.len()))
    };
    let mut lines: Vec<String> = excavation.bodies.iter().filter_map(|name| said(&name.value, "leaves")).collect();
    let installed = excavation.installed.iter().filter_map(|name| said(&name.value, "comes in without stress"));
    if lines.is_empty() {
        return installed.collect();
    }
    let over = match &excavation.release {
        Some(release) if release.value == 0.0 => "at once".to_owned(),
        Some(release) => format!("over {}", quantity(release.value, "s")),
        None => "until the stage ends".to_owned(),
    };
    let part = if excavation.share < 1.0 {
        format!("{} of what they bore fades {over}, the rest in the next stage", percent(excavation.share))
    } else {
        format!("what they bore fades {over}")
    };
    lines.push(part);
    lines.extend(installed);
    lines
}
