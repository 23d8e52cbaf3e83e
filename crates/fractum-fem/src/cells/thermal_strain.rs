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
    /// α (T - T₀) of each cell where the present change of temperatures began.
    pub(crate) start: Vec<f64>,
    /// What the whole change adds to it.
    pub(crate) change: Vec<f64>,
    /// Parts of the change that had passed at the step before, and now.
    pub(crate) passed: [f64; 2],
}

impl ThermalStrain {
    /// Strain of a cell that stress belongs to.
    #[inline(always)]
    pub(crate) fn elastic(&self, cell: usize, strain: Sym3) -> Sym3 {
        self.beyond(cell, strain, self.passed[1])
    }

    /// The same at the step before.
    #[inline(always)]
    pub(crate) fn elastic_before(&self, cell: usize, strain: Sym3) -> Sym3 {
        self.beyond(cell, strain, self.passed[0])
    }

    /// α (T - T₀) of a cell now.
    pub(crate) fn now(&self, cell: usize) -> f64 {
        self.start[cell] + self.passed[1] * self.change[cell]
    }

    #[inline(always)]
    fn beyond(&self, cell: usize, strain: Sym3, passed: f64) -> Sym3 {
        strain - self.unit * (self.start[cell] + passed * self.change[cell])
    }
}
