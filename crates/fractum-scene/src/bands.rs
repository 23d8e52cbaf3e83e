//! Bodies of which the bands of a phase field leave no fragments.

use crate::error::StepError;
use crate::scene::Scene;
use fractum_fem::cracks;

/// Share of the volume of a body that its bands may take: with more it has no fragments left to speak of.
const MOSTLY_LOST: f64 = 0.5;

impl Scene {
    /// Fails where the cracks of a phase field have taken most of a body, instead of leaving its fragments.
    ///
    /// # Errors
    /// [`StepError::NoFragments`].
    pub fn refuse_bands_without_fragments(&self) -> Result<(), StepError> {
        let lost =
            |body| Some((body, cracks::lost_to_bands(&self.solid, body).filter(|(share, _)| *share > MOSTLY_LOST)?));
        let Some((body, (share, width))) = (0..self.solid.body_count()).find_map(lost) else { return Ok(()) };
        let (step, time, body) = (self.clock.step, self.clock.time, self.solid.body(body).name.clone());
        Err(StepError::NoFragments { step, time, body, share, width })
    }
}
