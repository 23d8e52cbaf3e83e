//! Numbers about heat.

use super::Heat;

/// What a probe of heat shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatMeasure {
    /// Heat stored beyond that of the start [J].
    Stored,
    /// Heat brought through points of prescribed temperature [J].
    Held,
    /// Heat brought by flows and sources [J].
    Supplied,
    /// Heat brought by convection [J].
    Convection,
    /// What is missing in the balance of heat [J].
    Residual,
    /// Mechanical work of thermal expansion [J].
    ExpansionWork,
}

/// Which temperature of a set of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TemperatureTake {
    /// Mean, weighted by heat capacities.
    Mean,
    /// Lowest.
    Lowest,
    /// Highest.
    Highest,
}

impl Heat {
    /// A number about the heat of everything [J].
    pub fn measure(&self, measure: HeatMeasure) -> f64 {
        let ledger = self.ledger();
        match measure {
            HeatMeasure::Stored => ledger.stored,
            HeatMeasure::Held => ledger.held,
            HeatMeasure::Supplied => ledger.supplied,
            HeatMeasure::Convection => ledger.convection,
            HeatMeasure::Residual => ledger.residual(),
            HeatMeasure::ExpansionWork => self.expansion_work(),
        }
    }

    /// Temperature of points [K].
    ///
    /// - `of_particles`: whether they are particles, not nodes
    pub fn temperature_of(&self, of_particles: bool, points: &[u32], take: TemperatureTake) -> f64 {
        let first = if of_particles { self.nodes as u32 } else { 0 };
        let all = self.temperature();
        let own = points.iter().map(|&point| all[(first + point) as usize]);
        match take {
            TemperatureTake::Mean => self.mean(points.iter().map(|point| first + point)),
            TemperatureTake::Lowest => own.fold(f64::INFINITY, f64::min),
            TemperatureTake::Highest => own.fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Mean of the temperatures of points, weighted by their capacities [K].
    fn mean(&self, points: impl Iterator<Item = u32>) -> f64 {
        let (capacities, all) = (self.field.network().capacity(), self.temperature());
        let (mut sum, mut weight) = (0.0, 0.0);
        for point in points {
            sum += capacities[point as usize] * all[point as usize];
            weight += capacities[point as usize];
        }
        sum / weight
    }
}
