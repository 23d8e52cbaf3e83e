//! Laws of cells: stress by strain. Wrappers see the strain beyond the thermal one, or beyond that at which a cell is free of stress.

use fractum_math::{FOUR, Sym3};

use crate::body::elasticity::Linear;
use crate::cells::thermal_strain::ThermalStrain;

/// Stress of a cell for its strain; owns the history of the cells of a block.
pub(crate) trait CellLaw {
    /// Whether the law is faster with four cells at a time.
    const BY_FOURS: bool = false;
    /// Whether stress has the axes of strain.
    const IS_COAXIAL: bool = true;
    /// Whether few bodies have the law, so that one loop for cells of any number of nodes does.
    const IS_RARE: bool = false;
    /// Stress [Pa] times the volume of cell `cell` [m³].
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3;
    /// The same of the four cells from `first` on.
    #[inline(always)]
    fn scaled_stresses(&mut self, first: usize, strains: &[Sym3; FOUR], volumes: &[f64; FOUR]) -> [Sym3; FOUR] {
        let mut stresses = [Sym3::ZERO; FOUR];
        for k in 0..FOUR {
            // All elements of a cell without volume have been removed.
            if volumes[k] > 0.0 {
                stresses[k] = self.scaled_stress(first + k, strains[k], volumes[k]);
            }
        }
        stresses
    }
    /// Part of the stiffness that is left, 1 - d.
    fn integrity(&self, cell: usize) -> f64;
}

/// An elastic block: sums its energy when asked to.
pub(crate) struct ElasticCells<L> {
    pub(crate) elasticity: L,
    pub(crate) energy: Option<f64>,
}

impl<L: Linear> CellLaw for ElasticCells<L> {
    const IS_COAXIAL: bool = L::IS_COAXIAL;

    #[inline(always)]
    fn scaled_stress(&mut self, _cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        let stress = self.elasticity.stress(strain) * volume;
        if let Some(energy) = &mut self.energy {
            *energy += 0.5 * stress.dot(strain);
        }
        stress
    }

    #[inline(always)]
    fn integrity(&self, _cell: usize) -> f64 {
        1.0
    }
}

/// The law of cells that expand: it sees the strain beyond the thermal one.
pub(crate) struct ExpandingCells<'a, L> {
    pub(crate) law: &'a mut L,
    pub(crate) thermal: &'a ThermalStrain,
    /// Work that the whole of the present change of temperatures does at these stresses [J].
    pub(crate) work: f64,
}

impl<L> ExpandingCells<'_, L> {
    #[inline(always)]
    fn book(&mut self, cell: usize, scaled_stress: Sym3) {
        self.work -= self.thermal.change[cell] * scaled_stress.dot(self.thermal.unit);
    }
}

impl<L: CellLaw> CellLaw for ExpandingCells<'_, L> {
    const BY_FOURS: bool = L::BY_FOURS;
    const IS_COAXIAL: bool = L::IS_COAXIAL;
    const IS_RARE: bool = L::IS_RARE;

    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        let stress = self.law.scaled_stress(cell, self.thermal.elastic(cell, strain), volume);
        self.book(cell, stress);
        stress
    }

    #[inline(always)]
    fn scaled_stresses(&mut self, first: usize, strains: &[Sym3; FOUR], volumes: &[f64; FOUR]) -> [Sym3; FOUR] {
        let mut elastic = *strains;
        for k in 0..FOUR {
            elastic[k] = self.thermal.elastic(first + k, strains[k]);
        }
        let stresses = self.law.scaled_stresses(first, &elastic, volumes);
        for k in 0..FOUR {
            self.book(first + k, stresses[k]);
        }
        stresses
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        self.law.integrity(cell)
    }
}

/// The law of cells that are free of stress at a strain of their own: it sees the strain beyond that.
pub(crate) struct BornCells<'a, L> {
    pub(crate) law: &'a mut L,
    /// That strain of each cell.
    pub(crate) born: &'a [Sym3],
}

impl<L: CellLaw> CellLaw for BornCells<'_, L> {
    const BY_FOURS: bool = L::BY_FOURS;
    // Stress has the axes of what the strain has changed by.
    const IS_COAXIAL: bool = false;
    const IS_RARE: bool = true;

    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        self.law.scaled_stress(cell, strain - self.born[cell], volume)
    }

    #[inline(always)]
    fn scaled_stresses(&mut self, first: usize, strains: &[Sym3; FOUR], volumes: &[f64; FOUR]) -> [Sym3; FOUR] {
        let since = std::array::from_fn(|k| self.born.get(first + k).map_or(strains[k], |born| strains[k] - *born));
        self.law.scaled_stresses(first, &since, volumes)
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        self.law.integrity(cell)
    }
}
