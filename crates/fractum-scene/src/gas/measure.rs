use fractum_fem::Solid;

use super::Gas;

/// What is measured on gas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GasMeasure {
    /// Pressure of a hole; of all cells the mean over their volume [Pa].
    Pressure,
    /// Temperature of a hole; of all cells the mean over their mass [K].
    Temperature,
    /// Mass [kg].
    Mass,
    /// Internal energy [J].
    Energy,
    /// Room for gas [m³].
    Volume,
    /// Area of the walls of a hole and of its cracks, without load [m²].
    WettedArea,
    /// Mass that has leaked to the outside from everywhere [kg].
    LeakedMass,
}

impl Gas {
    /// A number about the gas of a hole, or of everything.
    pub fn measure(&self, solid: &Solid, measure: GasMeasure, hole: Option<usize>) -> f64 {
        let chosen = || self.cells().enumerate().filter(|(index, _)| hole.is_none_or(|hole| hole == *index));
        let cells = || chosen().map(|(_, cell)| cell);
        let mass = || cells().map(|cell| cell.amount.mass).sum::<f64>();
        let volume = || cells().map(|cell| cell.volume).sum::<f64>();
        match measure {
            GasMeasure::Pressure => cells().map(|cell| cell.pressure * cell.volume).sum::<f64>() / volume(),
            GasMeasure::Temperature => cells().map(|cell| cell.temperature * cell.amount.mass).sum::<f64>() / mass(),
            GasMeasure::Mass => mass(),
            GasMeasure::Energy => cells().map(|cell| cell.amount.energy).sum(),
            GasMeasure::Volume => volume(),
            GasMeasure::WettedArea => self.wetted_area(solid, hole),
            GasMeasure::LeakedMass => self.leaked().mass,
        }
    }
}
