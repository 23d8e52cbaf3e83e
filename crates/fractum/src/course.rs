//! How a run proceeds: along time, or along a path.

use fractum_io::build::BuiltScene;
use fractum_scene::statics::Control;

/// How a run proceeds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Course {
    /// Whether a part of it is a path of equilibria.
    pub(crate) rests: bool,
    /// Whether the load factor may run back: rows and frames are then ordered by steps.
    pub(crate) turns_back: bool,
}

impl Course {
    /// That of the stages of a run.
    pub(crate) fn of<'a>(stages: impl Iterator<Item = &'a BuiltScene>) -> Self {
        stages.fold(Course::default(), |course, stage| Course {
            rests: course.rests || stage.statics.is_some() || stage.bonded_statics.is_some(),
            turns_back: course.turns_back
                || stage.bonded_statics.is_some()
                || stage.statics.as_ref().is_some_and(|statics| statics.control != Control::Time),
        })
    }
}
