//! Materials by name, each number with its source.

/// A rock by its kind: what a compressive strength says about it.
pub(super) struct Rock {
    /// Unconfined compressive strength, from and to [Pa].
    pub compression: [f64; 2],
    /// Strength in the Brazilian test, from and to [Pa].
    pub splitting: [f64; 2],
    /// Young's modulus over the compressive strength, from and to.
    pub modulus_ratio: [f64; 2],
    /// Strength in direct tension over that in the Brazilian test.
    pub direct: f64,
    /// Poisson's ratio, from and to.
    pub poisson: [f64; 2],
    /// Density [kg/m³].
    pub density: f64,
}

/// A value with its range, in SI.
pub(super) struct Measured {
    pub value: f64,
    pub range: Option<[f64; 2]>,
    pub source: &'static str,
}

/// A material that was measured as it is.
pub(super) struct Specimen {
    pub density: Measured,
    pub young: Measured,
    pub poisson: Measured,
    pub tension: Measured,
    pub toughness: Measured,
    pub compression: Option<Measured>,
    /// Weibull modulus of its strength.
    pub weibull: Option<f64>,
}

pub(super) enum Kind {
    /// Concrete by the characteristic compressive strength of cylinders.
    Concrete,
    Rock(Rock),
    Specimen(&'static Specimen),
}

pub(super) struct Known {
    pub name: &'static str,
    pub what: &'static str,
    pub kind: Kind,
}

const fn rock(
    compression: [f64; 2],
    splitting: [f64; 2],
    modulus_ratio: [f64; 2],
    direct: f64,
    poisson: [f64; 2],
    density: f64,
) -> Kind {
    let [low, high] = compression;
    let [weak, strong] = splitting;
    Kind::Rock(Rock {
        compression: [1e6 * low, 1e6 * high],
        splitting: [1e6 * weak, 1e6 * strong],
        modulus_ratio,
        direct,
        poisson,
        density,
    })
}

const fn around(value: f64, deviation: f64, source: &'static str) -> Measured {
    Measured { value, range: Some([value - deviation, value + deviation]), source }
}

const fn exactly(value: f64, source: &'static str) -> Measured {
    Measured { value, range: None, source }
}

/// Igneous, metamorphic and sedimentary rocks: Perras & Diederichs (2014).
const IGNEOUS: f64 = 0.8;
const METAMORPHIC: f64 = 0.9;
const SEDIMENTARY: f64 = 0.7;

const LAC_DU_BONNET: &str = "Potyondy & Cundall (2004), Lac du Bonnet granite";
const ALUMINA: &str = "Munro (1997), J. Am. Ceram. Soc. 80, NIST SRD 150";
const CARBIDE: &str = "Munro (1997), J. Phys. Chem. Ref. Data 26, NIST SRD 150";
const FLOAT_GLASS: &str = "EN 572-1, characteristic bending strength";
const BOROSILICATE: &str = "EN 1748-1-1, characteristic bending strength";
const GLASS_TOUGHNESS: &str = "from the surface energies of Wiederhorn (1969), J. Am. Ceram. Soc. 52";

pub(super) const KNOWN: &[Known] = &[
    Known { name: "concrete", what: "by the compressive strength of cylinders, C12 to C120", kind: Kind::Concrete },
    Known {
        name: "granite",
        what: "coarse igneous rock",
        kind: rock([100.0, 250.0], [7.0, 25.0], [300.0, 550.0], IGNEOUS, [0.10, 0.33], 2650.0),
    },
    Known {
        name: "lac-du-bonnet",
        what: "granite of the Underground Research Laboratory in Manitoba",
        kind: Kind::Specimen(&Specimen {
            density: exactly(2630.0, LAC_DU_BONNET),
            young: around(69e9, 5.8e9, LAC_DU_BONNET),
            poisson: around(0.26, 0.04, LAC_DU_BONNET),
            tension: Measured {
                value: 7.4e6,
                range: Some([6.9e6, 9.3e6]),
                source: "0.8 of 9.3 MPa in the Brazilian test (Potyondy & Cundall 2004); 6.9 MPa in direct tension",
            },
            toughness: Measured { value: 1.35e6, range: None, source: "Brazilian strength over 6.88 (Zhang 2002)" },
            compression: Some(around(200e6, 22e6, LAC_DU_BONNET)),
            weibull: None,
        }),
    },
    Known {
        name: "basalt",
        what: "fine igneous rock",
        kind: rock([100.0, 300.0], [10.0, 30.0], [250.0, 450.0], IGNEOUS, [0.10, 0.35], 2800.0),
    },
    Known {
        name: "gneiss",
        what: "banded metamorphic rock",
        kind: rock([50.0, 200.0], [5.0, 20.0], [300.0, 750.0], METAMORPHIC, [0.10, 0.30], 2700.0),
    },
    Known {
        name: "quartzite",
        what: "metamorphic sandstone",
        kind: rock([150.0, 300.0], [10.0, 30.0], [300.0, 450.0], METAMORPHIC, [0.10, 0.33], 2650.0),
    },
    Known {
        name: "sandstone",
        what: "sedimentary rock of sand",
        kind: rock([20.0, 170.0], [4.0, 25.0], [200.0, 350.0], SEDIMENTARY, [0.05, 0.40], 2350.0),
    },
    Known {
        name: "limestone",
        what: "sedimentary rock of calcite",
        kind: rock([30.0, 250.0], [5.0, 25.0], [400.0, 1000.0], SEDIMENTARY, [0.10, 0.33], 2600.0),
    },
    Known {
        name: "shale",
        what: "sedimentary rock of clay, in beds",
        kind: rock([5.0, 100.0], [2.0, 10.0], [150.0, 250.0], SEDIMENTARY, [0.05, 0.32], 2400.0),
    },
    Known {
        name: "alumina",
        what: "sintered ceramic, 99.5 % Al2O3, grains of 5 um",
        kind: Kind::Specimen(&Specimen {
            density: around(3984.0, 2.0, ALUMINA),
            young: around(416e9, 30e9, ALUMINA),
            poisson: exactly(0.231, ALUMINA),
            tension: around(380e6, 50e6, "Munro (1997), bars in bending"),
            toughness: exactly(3.5e6, ALUMINA),
            compression: Some(around(3.0e9, 0.5e9, ALUMINA)),
            weibull: Some(11.0),
        }),
    },
    Known {
        name: "silicon-carbide",
        what: "sintered ceramic SiC, grains of 6 um",
        kind: Kind::Specimen(&Specimen {
            density: exactly(3160.0, CARBIDE),
            young: exactly(415e9, CARBIDE),
            poisson: exactly(0.16, CARBIDE),
            tension: exactly(359e6, "Munro (1997), bars in bending"),
            toughness: exactly(3.1e6, CARBIDE),
            compression: Some(exactly(3.9e9, CARBIDE)),
            weibull: Some(11.0),
        }),
    },
    Known {
        name: "soda-lime-glass",
        what: "float glass, annealed",
        kind: Kind::Specimen(&Specimen {
            density: exactly(2500.0, "EN 572-1"),
            young: exactly(70e9, "EN 572-1"),
            poisson: exactly(0.2, "EN 572-1"),
            tension: exactly(45e6, FLOAT_GLASS),
            toughness: exactly(0.75e6, GLASS_TOUGHNESS),
            compression: None,
            weibull: None,
        }),
    },
    Known {
        name: "borosilicate-glass",
        what: "glass of laboratories, annealed",
        kind: Kind::Specimen(&Specimen {
            density: Measured { value: 2250.0, range: Some([2200.0, 2500.0]), source: "EN 1748-1-1" },
            young: Measured { value: 63e9, range: Some([60e9, 70e9]), source: "EN 1748-1-1" },
            poisson: exactly(0.2, "EN 1748-1-1"),
            tension: exactly(25e6, BOROSILICATE),
            toughness: exactly(0.77e6, GLASS_TOUGHNESS),
            compression: None,
            weibull: None,
        }),
    },
];
