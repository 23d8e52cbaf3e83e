//! Pictures inside the page, with the bar that tells what the colours mean.

use fractum_output::number::prefixed;
use fractum_vtk::text::escape;

use crate::picture::ColourMap;
use crate::plot::linear_ticks;

/// Ticks of a colour bar, about.
const TICKS: usize = 6;

/// What the colours of a picture mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColourBar {
    /// Name of the field.
    pub label: String,
    /// Its SI unit, `-` for a pure number.
    pub unit: String,
    /// The colour map.
    pub map: ColourMap,
    /// Values at its ends.
    pub range: (f64, f64),
}

impl ColourBar {
    /// The bar with round values as an SVG element.
    pub fn to_svg(&self) -> String {
        let (low, high) = self.range;
        let prefix = prefixed(low.abs().max(high.abs()), &self.unit);
        let label =
            if prefix.unit.is_empty() { self.label.clone() } else { format!("{} [{}]", self.label, prefix.unit) };
        let label = escape(&label);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 420 46\" role=\"img\" aria-label=\"{label}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"#333\"><g shape-rendering=\"crispEdges\">"
        );
        // A gradient needs a name that is unique in the page; bands of one colour each need none.
        let bands = 128;
        for band in 0..bands {
            let [r, g, b] = self.map.colour((band as f64 + 0.5) / f64::from(bands));
            let x = 20.0 + 380.0 * f64::from(band) / f64::from(bands);
            svg += &format!("<rect x=\"{x:.2}\" y=\"0\" width=\"3.2\" height=\"12\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>");
        }
        svg.push_str("</g>");
        for (value, text) in linear_ticks(low / prefix.factor, high / prefix.factor, TICKS) {
            let x = 20.0 + 380.0 * (value * prefix.factor - low) / (high - low);
            svg += &format!(
                "<path d=\"M{x:.1} 12v3\" stroke=\"#555\"/><text x=\"{x:.1}\" y=\"27\" text-anchor=\"middle\">{text}</text>"
            );
        }
        svg + &format!("<text x=\"210\" y=\"43\" text-anchor=\"middle\">{label}</text></svg>\n")
    }
}

/// `bytes` of a PNG as the address of an image inside the page.
pub(super) fn data_address(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(png))
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letters = |[a, b, c]: [u8; 3]| {
        let bits = u32::from(a) << 16 | u32::from(b) << 8 | u32::from(c);
        [18, 12, 6, 0].map(|shift| LETTERS[(bits >> shift & 63) as usize].into())
    };
    let (groups, rest) = bytes.as_chunks::<3>();
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    groups.iter().for_each(|&group| text.extend::<[char; 4]>(letters(group)));
    if !rest.is_empty() {
        let group = [0, 1, 2].map(|index| rest.get(index).copied().unwrap_or(0));
        text.extend(&letters(group)[..=rest.len()]);
        text.extend(std::iter::repeat_n('=', 3 - rest.len()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("fooba", "Zm9vYmE=")];
        for (plain, encoded) in cases {
            assert_eq!(base64(plain.as_bytes()), encoded);
        }
        assert_eq!(base64(&[0xff, 0xef, 0xbe]), "/+++");
    }

    #[test]
    fn a_colour_bar_tells_its_ends_in_the_prefixed_unit() {
        let bar =
            ColourBar { label: "stress xx".into(), unit: "Pa".into(), map: ColourMap::Viridis, range: (-2e3, 1e4) };
        let svg = bar.to_svg();
        assert!(svg.contains(">-2</text>") && svg.contains(">10</text>") && svg.contains(">stress xx [kPa]</text>"));
    }
}
