//! What a stage takes out, in words.

use fractum_case::model::Case;
use fractum_output::number::{percent, quantity};
use fractum_scene::Scene;

/// The bodies that leave as a stage begins, and how their forces fade; none where nothing leaves.
///
/// - `scene`: of that stage
pub(super) fn told(case: &Case, scene: &Scene) -> Vec<String> {
    let Some(excavation) = &case.excavation else { return Vec::new() };
    let solid = &scene.solid;
    let leaves = |name: &str| {
        let body = (0..solid.body_count()).find(|&body| solid.body(body).name == name)?;
        let volume: f64 = solid.element_volumes(body).iter().sum();
        let mass = quantity(volume * solid.body(body).elastic.density, "kg");
        Some(format!("body \"{name}\" leaves: {} elements, {mass}", solid.body(body).elements.len()))
    };
    let mut lines: Vec<String> = excavation.bodies.iter().filter_map(|name| leaves(&name.value)).collect();
    if lines.is_empty() {
        return lines;
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
    lines
}
