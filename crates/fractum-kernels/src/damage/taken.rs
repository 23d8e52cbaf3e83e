/// What a step takes of an edge or element whose damage grows [J], or of its volume [J/m³].
#[derive(Clone, Copy, Debug, Default)]
pub struct Taken {
    /// Part that goes with the growth of damage.
    pub per_damage: f64,
    /// Where cracks close, what those take that close or open within the step.
    pub switched: f64,
}

impl Taken {
    /// What damage takes where the stress goes on a straight way: ½ s¹ : ε⁰, with the effective stress after a step and the strain before it.
    #[inline]
    pub fn straight(per_damage: f64) -> Self {
        Taken { per_damage, switched: 0.0 }
    }

    /// Energy for this growth of damage, which is above zero.
    ///
    /// A step that turns compression into tension beyond the strength, or a crack that closes or opens within it, may bring energy. Damage never does.
    #[inline]
    pub fn by(self, growth: f64) -> f64 {
        (self.per_damage * growth + self.switched).max(0.0)
    }

    /// The same of a volume [m³].
    #[inline]
    pub fn of(self, volume: f64) -> Self {
        Taken { per_damage: self.per_damage * volume, switched: self.switched * volume }
    }
}
