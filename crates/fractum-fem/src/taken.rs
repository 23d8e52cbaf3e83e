//! The energy that damage takes in a step.

/// What a step takes of an edge whose damage grows [J], or of its volume [J/m³].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    /// Part that goes with the growth of damage.
    pub(crate) per_damage: f64,
    /// Where cracks close, what those take that close or open within the step.
    pub(crate) switched: Option<f64>,
}

impl Taken {
    /// Energy for this growth of damage. A crack that closes or opens may bring energy, never damage.
    pub(crate) fn by(self, growth: f64) -> f64 {
        let taken = self.per_damage * growth;
        match self.switched {
            Some(switched) if growth > 0.0 => (taken + switched).max(0.0),
            _ => taken,
        }
    }

    /// The same of a volume [m³].
    pub(crate) fn of(self, volume: f64) -> Self {
        Taken { per_damage: self.per_damage * volume, switched: self.switched.map(|switched| switched * volume) }
    }
}
