//! Closed lists of names that a case file chooses from.

/// An enum whose variants have a name in the case file.
pub trait Choice: Copy + PartialEq + 'static {
    /// Every name with its variant, in the order of the documentation.
    const NAMES: &'static [(&'static str, Self)];

    /// The name of this variant.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, variant)| *variant == self).map_or("", |(name, _)| name)
    }
}

/// Implements [`Choice`] from a list of `"name" => Variant`.
macro_rules! choice {
    ($type:ident { $($name:literal => $variant:ident),+ $(,)? }) => {
        impl $crate::Choice for $type {
            const NAMES: &'static [(&'static str, Self)] = &[$(($name, $type::$variant)),+];
        }
    };
}
pub(crate) use choice;
