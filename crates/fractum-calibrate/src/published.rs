//! Numbers of Nguyen, André and Huger (2019): calibrated micro-parameters and the strength law.

/// A row of their Tables 5 and 6: micro-parameters for a material, convention `all`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Young's modulus of the material [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio of the material.
    pub poisson_ratio: f64,
    /// Coordination.
    pub coordination: f64,
    /// Beam radius over the mean radius.
    pub radius_ratio: f64,
    /// Young's modulus of the beams [Pa].
    pub beam_modulus: f64,
}

/// The sixteen rows for soda-lime glass (72 GPa, 0.23) and alumina (340 GPa, 0.24).
pub fn anchors() -> Vec<Anchor> {
    let text = include_str!("../reference/nguyen2019_elastic.csv");
    let row = |line: &str| {
        let words: Vec<&str> = line.split(',').collect();
        let (young_modulus, poisson_ratio) = match *words.first()? {
            "glass" => (72e9, 0.23),
            "alumina" => (340e9, 0.24),
            _ => return None,
        };
        let number = |k: usize| words.get(k)?.parse::<f64>().ok();
        let beam_modulus = number(3)? * 1e9;
        Some(Anchor { young_modulus, poisson_ratio, coordination: number(1)?, radius_ratio: number(2)?, beam_modulus })
    };
    text.lines().filter_map(row).collect()
}

/// k = σ_M/σ_m, tensile strength of the material over the strength of the virial criterion (eq. 22), for r_m 0.2 to 1
/// and coordination 6 to 13, convention `all`.
pub fn strength_ratio(radius_ratio: f64, coordination: f64) -> f64 {
    let (r, c) = (radius_ratio, coordination);
    (-0.56467 + 0.20824 * c - 0.00760 * c * c)
        + r * (0.67697 + 0.09328 * c - 0.02298 * c * c + 0.00095 * c.powi(3))
        + r * r * (-0.73898 + 0.08438 * c - 0.00240 * c * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equation_22_reproduces_tables_9_and_10() {
        // glass cn 6: 50/78.08, glass 10: 50/60.08, alumina 13: 380/435.00
        for (r, c, k) in [(0.506, 6.0, 50.0 / 78.08), (0.348, 10.0, 50.0 / 60.08), (0.189, 13.0, 380.0 / 435.0)] {
            assert!((strength_ratio(r, c) / k - 1.0).abs() < 6e-4, "{} {k}", strength_ratio(r, c));
        }
    }

    #[test]
    fn all_sixteen_anchors_are_read() {
        assert_eq!(anchors().len(), 16);
        assert_eq!(anchors()[15].radius_ratio, 0.189);
    }
}
