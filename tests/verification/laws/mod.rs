//! Laws outside of `fractum-kernels`, held against their properties with numbers drawn from the whole range that a case may give; the table of the
//! laws in it, and what tries both, is `crates/fractum-kernels/tests/laws`.
//!
//! A new law is a new row.

use fractum_fem::Softening;
use fractum_gas::{EquationOfState, Jwl, NobleAbel, PerfectGas};
use fractum_heat::PackedSphere;

mod band;
#[path = "../../../crates/fractum-kernels/tests/laws/draw.rs"]
mod draw;

use draw::{Draw, Held, Row, bilinear, hold, try_all};

const LAWS: &[Row] = &[
    Row { law: "crack in a band, exponential", holds: |draw| band::torn_and_held(draw, Softening::Exponential) },
    Row { law: "crack in a band, linear", holds: |draw| band::torn_and_held(draw, Softening::Linear) },
    Row {
        law: "crack in a band, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            band::torn_and_held(draw, curve)
        },
    },
    Row { law: "gas, perfect", holds: |draw| gas(perfect(draw)) },
    Row { law: "gas, Noble and Abel", holds: |draw| gas(noble_abel(draw)) },
    Row { law: "gas, Jones-Wilkins-Lee", holds: |draw| gas(jwl(draw)) },
    Row { law: "heat between packed spheres", holds: conductance },
];

#[test]
fn every_law_has_its_properties_over_its_whole_range() {
    try_all(LAWS);
}

/// Densities [kg/m³] and internal energies per mass [J/kg] of a gas.
fn perfect(draw: &mut Draw) -> (EquationOfState, f64, f64) {
    let law = PerfectGas { heat_ratio: draw.between(1.02, 3.0), gas_constant: draw.over_decades(50.0, 5000.0) };
    (EquationOfState::PerfectGas(law), draw.over_decades(1e-3, 3e3), draw.over_decades(1e3, 1e7))
}

fn noble_abel(draw: &mut Draw) -> (EquationOfState, f64, f64) {
    let covolume = draw.over_decades(1e-5, 3e-3);
    let law =
        NobleAbel { heat_ratio: draw.between(1.02, 3.0), gas_constant: draw.over_decades(50.0, 5000.0), covolume };
    (EquationOfState::NobleAbel(law), draw.over_decades(1e-3, 0.95 / covolume), draw.over_decades(1e3, 1e7))
}

fn jwl(draw: &mut Draw) -> (EquationOfState, f64, f64) {
    let density = draw.between(900.0, 1900.0);
    let law = Jwl {
        a: draw.over_decades(5e10, 9e11),
        b: draw.over_decades(5e8, 3e10),
        r1: draw.between(3.5, 6.5),
        r2: draw.between(0.8, 2.0),
        omega: draw.between(0.2, 0.5),
        density,
        heat_capacity: draw.between(800.0, 2000.0),
    };
    (EquationOfState::Jwl(law), draw.over_decades(1e-2, density), draw.over_decades(1e6, 1e7))
}

/// Pressure is positive and a matter of density and energy alone; sound travels with the slope of the isentrope; mass and energy at
/// a pressure and temperature have these.
fn gas((state, density, energy): (EquationOfState, f64, f64)) -> Held {
    let law = state.law();
    let pressure = |density: f64, energy: f64| law.pressure_line(density, 1.0).at(energy * density);
    let p = pressure(density, energy);
    let at = format!("{state:?} at {density} kg/m^3, {energy} J/kg");
    hold(p > 0.0 && p.is_finite(), || format!("{at}: {p} Pa"))?;
    let little = law.pressure_line(density * 3e-6, 3e-6).at(energy * density * 3e-6);
    hold((little / p - 1.0).abs() < 1e-9, || format!("{at}: {little} Pa in a small volume, {p} Pa"))?;
    // Along an isentrope du = p dρ/ρ².
    let d = 1e-5 * density;
    let path = |d: f64| pressure(density + d, energy + p * d / (density * density));
    let (slope, square) = ((path(d) - path(-d)) / (2.0 * d), law.sound_speed_squared(density, energy));
    hold((slope / square - 1.0).abs() < 1e-4, || {
        format!("{at}: slope {slope}, square of the speed of sound {square}")
    })?;
    let temperature = law.temperature(density, energy);
    hold(temperature >= 0.0 && temperature.is_finite(), || format!("{at}: {temperature} K"))?;
    if let Some((mass, inner)) = law.contents(0.3, p, temperature) {
        let again = law.pressure_line(mass, 0.3).at(inner);
        hold((again / p - 1.0).abs() < 1e-9, || format!("{at}: {again} Pa of these contents"))?;
        hold((mass / (0.3 * density) - 1.0).abs() < 1e-9, || format!("{at}: {mass} kg in 0.3 m^3"))?;
    }
    Ok(())
}

/// Conductance is positive, the same both ways, and grows with conductivity and size.
fn conductance(draw: &mut Draw) -> Held {
    let spheres = [0; 2].map(|_| PackedSphere::of(draw.between(1.0, 30.0) as usize));
    let radius = draw.over_decades(1e-5, 1.0);
    let radii = [radius, radius * draw.over_decades(0.05, 20.0)];
    let length = radii[0] + radii[1];
    let conductivity = draw.over_decades(1e-3, 1e3);
    let one = PackedSphere::conductance(spheres, radii, length, conductivity);
    let words = format!("{spheres:?} {radii:?}");
    hold(one > 0.0 && one.is_finite(), || format!("{words}: {one} W/K"))?;
    let other = PackedSphere::conductance([spheres[1], spheres[0]], [radii[1], radii[0]], length, conductivity);
    hold((other / one - 1.0).abs() < 1e-12, || format!("{words}: {one} and {other} W/K"))?;
    let doubled = PackedSphere::conductance(spheres, radii.map(|r| 2.0 * r), 2.0 * length, 3.0 * conductivity);
    hold((doubled / one - 6.0).abs() < 1e-9, || format!("{words}: {doubled} after {one} W/K"))?;
    let fraction = spheres.map(|sphere| sphere.fraction);
    hold(fraction.iter().all(|share| (0.0..=1.0).contains(share)), || format!("{words}: {fraction:?}"))
}
