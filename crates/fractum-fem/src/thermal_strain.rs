use fractum_math::Sym3;

/// Thermal strains of the cells of a block: their stress belongs to the strain beyond α (T - T₀).
#[derive(Clone, Debug)]
pub(crate) struct ThermalStrain {
    /// Coefficient of linear expansion α [1/K].
    pub(crate) coefficient: f64,
    /// Thermal strain per α (T - T₀): the unit tensor, in plane stress that of the plane.
    pub(crate) unit: Sym3,
    /// Parts of the local nodes of each cell in its temperature, in the order of the local nodes of the cells.
    pub(crate) weights: Vec<f64>,
    /// α (T - T₀) of each cell.
    pub(crate) now: Vec<f64>,
    /// The same at the step before.
    pub(crate) before: Vec<f64>,
    /// Work that the last change of temperatures does in half a step [J].
    pub(crate) work: f64,
}

impl ThermalStrain {
    /// Strain of a cell that stress belongs to.
    #[inline(always)]
    pub(crate) fn elastic(&self, cell: usize, strain: Sym3) -> Sym3 {
        strain - self.unit * self.now[cell]
    }

    /// The same at the step before.
    #[inline(always)]
    pub(crate) fn elastic_before(&self, cell: usize, strain: Sym3) -> Sym3 {
        strain - self.unit * self.before[cell]
    }
}
