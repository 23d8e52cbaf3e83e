//! Colour maps.

/// Red, green and blue, 0 to 255.
pub type Rgb = [u8; 3];

/// What colour a value has, from the low end of its range to the high end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark violet, green, yellow: even to the eye and to the colour-blind. For any field.
    #[default]
    Viridis,
    /// Stone grey to deep red: sound and broken.
    Damage,
    /// Blue, white, red: below and above the middle of the range.
    Diverging,
}

impl ColourMap {
    /// The colour at `share` of the range, 0 to 1; what lies outside takes the end's colour, NaN a mid grey.
    pub fn colour(self, share: f64) -> Rgb {
        if share.is_nan() {
            return [150, 150, 150];
        }
        let stops = self.stops();
        let position = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let below = (position as usize).min(stops.len() - 2);
        let part = position - below as f64;
        let mix = |channel: usize| {
            let (low, high) = (f64::from(stops[below][channel]), f64::from(stops[below + 1][channel]));
            (low + part * (high - low)).round() as u8
        };
        [mix(0), mix(1), mix(2)]
    }

    /// Colours at equal distances, linear in between.
    pub fn stops(self) -> &'static [Rgb] {
        match self {
            Self::Viridis => &[
                [68, 1, 84],
                [71, 45, 123],
                [59, 82, 139],
                [44, 114, 142],
                [33, 145, 140],
                [40, 174, 128],
                [94, 201, 98],
                [173, 220, 48],
                [253, 231, 37],
            ],
            Self::Damage => &[[205, 203, 197], [219, 184, 152], [230, 160, 116], [208, 84, 62], [143, 17, 27]],
            Self::Diverging => &[
                [33, 82, 160],
                [104, 151, 205],
                [185, 209, 230],
                [243, 243, 240],
                [240, 196, 172],
                [214, 122, 98],
                [165, 30, 45],
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_are_the_stops_and_outside_is_clamped() {
        for map in [ColourMap::Viridis, ColourMap::Damage, ColourMap::Diverging] {
            let stops = map.stops();
            assert_eq!(map.colour(0.0), stops[0]);
            assert_eq!(map.colour(0.5), stops[stops.len() / 2]);
            assert_eq!(map.colour(1.0), stops[stops.len() - 1]);
            assert_eq!(map.colour(-3.0), stops[0]);
            assert_eq!(map.colour(f64::INFINITY), stops[stops.len() - 1]);
            assert_eq!(map.colour(f64::NAN), [150, 150, 150]);
        }
    }

    /// Printed in grey, a larger value must stay tellable from a smaller one.
    #[test]
    fn viridis_grows_lighter_and_damage_darker() {
        let lightness = |[r, g, b]: Rgb| 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
        for step in 0..25 {
            let (low, high) = (step as f64 / 25.0, (step + 1) as f64 / 25.0);
            assert!(lightness(ColourMap::Viridis.colour(high)) > lightness(ColourMap::Viridis.colour(low)));
            assert!(lightness(ColourMap::Damage.colour(high)) < lightness(ColourMap::Damage.colour(low)));
        }
    }
}
