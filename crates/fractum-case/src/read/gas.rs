//! `[gas]`.

use fractum_scene::{Amount, Charge, EquationOfState, Explosive, Jwl, NobleAbel, PerfectGas, SlitFlow, Stemming};

use super::heat::doubt_kelvin;
use super::time_functions::time_function;
use crate::model::{Gas, GasHole, GasLaw, Preset, Solver, SolverKind};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::selection::selection;
use crate::usual::{DETONATION, GAS_CONSTANT, GAS_PRESSURE, HEAT_RATIO};
use crate::{Diagnostic, Spanned, TimeFunction};

/// Reads the gas, if there is any; nothing where it is wrong. It acts in stages of motion.
pub(super) fn read(root: &Table<'_>, solver: Option<&Solver>, staged: bool) -> Option<Option<Gas>> {
    let Some(table) = root.table("gas") else { return Some(None) };
    let place = table.place.clone();
    let explosive =
        optional(&table, "explosive", |key| table.choice::<Preset>(key).given())?.map(|Preset(preset)| preset);
    let usual = if explosive.is_some() { GasLaw::Jwl } else { GasLaw::PerfectGas };
    let kind = table.choice("law").or_if_absent(usual);
    let law = kind.and_then(|kind| law(&table, kind, explosive));
    let viscosity = table.quantity("viscosity").positive().or_if_absent(5e-5);
    let roughness = table.quantity("wall_roughness").not_negative().or_if_absent(0.0);
    let least_opening = table.quantity("least_opening").positive().or_if_absent(1e-5);
    let in_cracks = table.flag("in_cracks").or_if_absent(true);
    let outside_pressure = table.quantity("outside_pressure").not_negative().or_if_absent(101_325.0);
    let symmetry = symmetry(&table);
    let with_state = kind.is_some_and(|kind| kind != GasLaw::Jwl);
    let holes: Vec<Option<GasHole>> =
        table.tables("holes").into_iter().map(|hole_of| hole(hole_of, with_state, explosive)).collect();
    if holes.is_empty() {
        let note = Diagnostic::error(&table.place_of("holes"), "is missing").expected("at least one [[gas.holes]]");
        table.reader.note(note);
        return None;
    }
    table.finish("here");
    if let Some(solver) = solver.filter(|solver| !staged && solver.kind != SolverKind::Explicit) {
        let note = Diagnostic::error(&place, "flows in motion only").expected("solver.kind = \"explicit\"");
        root.reader.note(note.remedy(format!("solver.kind at line {} is another one", solver.place.line)));
        return None;
    }
    Some(Some(Gas {
        place,
        law: law?,
        slits: SlitFlow { viscosity: viscosity?, roughness: roughness? },
        least_opening: least_opening?,
        in_cracks: in_cracks?,
        outside_pressure: outside_pressure?,
        symmetry: symmetry?,
        holes: holes.into_iter().collect::<Option<_>>()?,
    }))
}

/// Planes of symmetry at which holes may end.
pub(super) fn symmetry(table: &Table<'_>) -> Option<[Option<Spanned<f64>>; 3]> {
    let Some(planes) = table.table("symmetry") else { return Some([None, None, None]) };
    let places = ["x", "y", "z"].map(|axis| optional(&planes, axis, |axis| planes.quantity(axis).spanned().required()));
    planes.finish("here");
    let [x, y, z] = places;
    Some([x?, y?, z?])
}

fn law(table: &Table<'_>, kind: GasLaw, explosive: Option<Explosive>) -> Option<EquationOfState> {
    if kind != GasLaw::Jwl {
        table.refuse("explosive", "with this law, only with jwl");
    }
    if kind == GasLaw::Jwl {
        for key in ["heat_ratio", "gas_constant", "covolume"] {
            table.refuse(key, "with law = \"jwl\"");
        }
        if let Some(explosive) = explosive {
            table.refuse("jwl", "beside explosive, whose constants are known");
            return Some(EquationOfState::Jwl(explosive.products));
        }
        let Some(inner) = table.table("jwl") else {
            let note = Diagnostic::error(&table.place_of("jwl"), "is missing")
                .expected("a table with a, b, r1, r2, omega, density, or explosive with a name");
            table.reader.note(note);
            return None;
        };
        let law = jwl(&inner);
        inner.finish("here");
        return law.map(EquationOfState::Jwl);
    }
    table.refuse("jwl", "with this law");
    let heat_ratio = table.quantity("heat_ratio").check(|ratio| *ratio > 1.0, "above 1").usual(&HEAT_RATIO).required();
    let gas_constant = table.quantity("gas_constant").positive().usual(&GAS_CONSTANT).required();
    if kind == GasLaw::PerfectGas {
        table.refuse("covolume", "with law = \"perfect-gas\"");
        return Some(EquationOfState::PerfectGas(PerfectGas { heat_ratio: heat_ratio?, gas_constant: gas_constant? }));
    }
    let covolume = table.quantity("covolume").positive().required()?;
    Some(EquationOfState::NobleAbel(NobleAbel { heat_ratio: heat_ratio?, gas_constant: gas_constant?, covolume }))
}

fn jwl(table: &Table<'_>) -> Option<Jwl> {
    let [a, b] = ["a", "b"].map(|key| table.quantity(key).required());
    let [r1, r2, omega] = ["r1", "r2", "omega"].map(|key| table.quantity(key).positive().required());
    let density = table.quantity("density").physical().required();
    let heat_capacity = table.quantity("heat_capacity").positive().or_if_absent(1500.0);
    Some(Jwl { a: a?, b: b?, r1: r1?, r2: r2?, omega: omega?, density: density?, heat_capacity: heat_capacity? })
}

/// - `with_state`: whether the law has a temperature for a pressure; `explosive`: that whose products the gas is, by name
fn hole(table: Table<'_>, with_state: bool, explosive: Option<Explosive>) -> Option<GasHole> {
    let on = selection(&table);
    let stemmed = table.flag("stemmed").or_if_absent(false);
    let (charge, stemming) = (charge(&table, with_state, explosive), stemming(&table));
    let burning = burning(&table, explosive);
    let burns = table.has("detonation");
    let source = if burns {
        for key in ["mass_rate", "energy_rate"] {
            table.refuse(key, "beside detonation, by which mass and energy come in");
        }
        charge.zip(burning.flatten()).and_then(|(charge, burning)| burning.sources(&table, charge)).map(Some)
    } else if table.has("mass_rate") || table.has("energy_rate") {
        let rates = ["mass_rate", "energy_rate"].map(|key| time_function(&table, key).spanned().required());
        let [mass, energy] = rates;
        mass.zip(energy).map(|(mass, energy)| Some([mass, energy]))
    } else {
        Some(None)
    };
    table.finish("here");
    let charge = if burns { Charge::Amount(Amount::default()) } else { charge? };
    Some(GasHole { on: on?, stemmed: stemmed?, charge, source: source?, stemming: stemming? })
}

fn charge(table: &Table<'_>, with_state: bool, explosive: Option<Explosive>) -> Option<Charge> {
    let by_state = table.has("pressure") || table.has("temperature");
    if !by_state && !table.has("mass") && !table.has("energy") {
        if !table.has("mass_rate") {
            let note = Diagnostic::error(&table.place, "holds no gas and gets none");
            table.reader.note(note.expected("pressure and temperature, mass and energy, or mass_rate and energy_rate"));
            return None;
        }
        return Some(Charge::Amount(Amount::default()));
    }
    if by_state {
        for key in ["mass", "energy"] {
            table.refuse(key, "beside pressure and temperature");
        }
        if !with_state {
            for key in ["pressure", "temperature"] {
                table.refuse(key, "with law = \"jwl\", which wants mass and energy");
            }
            return None;
        }
        let pressure = table.quantity("pressure").not_negative().usual(&GAS_PRESSURE).required();
        let temperature = table.quantity("temperature").positive().required();
        doubt_kelvin(table, "temperature");
        return Some(Charge::State { pressure: pressure?, temperature: temperature? });
    }
    let mass = table.quantity("mass").not_negative().required();
    let energy = table.quantity("energy").not_negative();
    let energy = match explosive {
        Some(explosive) => energy.or_if_absent(mass? * explosive.specific_energy()),
        None => energy.required(),
    };
    Some(Charge::Amount(Amount { mass: mass?, energy: energy? }))
}

/// A charge that burns along a hole.
#[derive(Clone, Copy)]
struct Burning {
    /// When it begins [s].
    delay: f64,
    /// How long it takes [s].
    duration: f64,
}

/// Part of the time of burning in which the rate rises, and falls: a step of the solids sees no jump.
const RISE: f64 = 0.05;

fn burning(table: &Table<'_>, explosive: Option<Explosive>) -> Option<Option<Burning>> {
    let Some(inner) = table.table("detonation") else { return Some(None) };
    let length = inner.quantity("length").positive().required();
    let delay = inner.quantity("delay").not_negative().or_if_absent(0.0);
    let velocity = inner.quantity("velocity").positive().usual(&DETONATION);
    let velocity = match explosive {
        Some(explosive) => velocity.or_if_absent(explosive.velocity),
        None => velocity.required(),
    };
    inner.finish("here");
    Some(Some(Burning { delay: delay?, duration: length? / velocity? }))
}

impl Burning {
    /// Mass [kg/s] and energy [W] that come in over time, for a charge that is told by these.
    fn sources(&self, table: &Table<'_>, charge: Charge) -> Option<[Spanned<TimeFunction>; 2]> {
        let place = table.place_of("detonation");
        let Charge::Amount(Amount { mass, energy }) = charge else {
            let note = Diagnostic::error(&place, "beside pressure and temperature");
            table.reader.note(note.expected("the mass of the charge, which burns"));
            return None;
        };
        let Burning { delay, duration } = *self;
        let ends = [0.0, RISE * duration, duration, (1.0 + RISE) * duration].map(|time| delay + time);
        Some([mass, energy].map(|amount| {
            let rate = amount / duration;
            let points = ends.into_iter().zip([0.0, rate, rate, 0.0]).collect();
            Spanned::new(TimeFunction::Ramp(points), place.clone())
        }))
    }
}

/// Stemming that is ejected; none where it stays.
fn stemming(table: &Table<'_>) -> Option<Option<Stemming>> {
    let Some(inner) = table.table("stemming") else { return Some(None) };
    let [diameter, length] = ["diameter", "length"].map(|key| inner.quantity(key).positive().required());
    let ejected_at = inner.quantity("ejected_at").not_negative().required();
    inner.finish("here");
    Some(Some(Stemming { diameter: diameter?, length: length?, ejected_at: ejected_at? }))
}
