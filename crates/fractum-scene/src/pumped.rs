//! Scenes with liquid in their interfaces.

use crate::liquid::Liquid;
use crate::scene::Scene;

/// A scene with liquid in its interfaces, before its first step.
pub fn with_liquid(mut scene: Scene, liquid: Liquid) -> Scene {
    scene.optional.liquid = Some(Box::new(liquid));
    scene
}

/// The liquid in the interfaces of a scene.
pub fn liquid_of(scene: &Scene) -> Option<&Liquid> {
    scene.optional.liquid.as_deref()
}
