//! Networks of gas against closed forms.

use fractum_gas::{Amount, EquationOfState, Jwl, Network, NobleAbel, Passage, PerfectGas, SlitFlow};

const AIR: PerfectGas = PerfectGas { heat_ratio: 1.4, gas_constant: 287.0 };
const SMOOTH: SlitFlow = SlitFlow { viscosity: 1.8e-5, roughness: 0.0 };

fn network(law: EquationOfState, slits: SlitFlow, outside: f64, cells: &[(f64, f64, f64)]) -> Network {
    let mut network = Network::new(law, slits, outside);
    for &(volume, pressure, temperature) in cells {
        let (mass, energy) = law.law().contents(volume, pressure, temperature).unwrap();
        network.push_cell(Amount { mass, energy });
    }
    network
}

/// Moves the walls of a cell as a body does that is pushed by the mean of the pressures at the ends of a step.
fn expand(network: &mut Network, before: f64, after: f64, pressure: f64) -> f64 {
    network.do_work(0, 0.5 * pressure * (after - before));
    network.push_walls(0, after, 0.5 * (after - before))
}

#[test]
fn a_closed_volume_keeps_its_adiabatic_invariant() {
    let dense = NobleAbel { heat_ratio: 1.25, gas_constant: 320.0, covolume: 1e-3 };
    for (law, covolume, heat_ratio) in
        [(EquationOfState::PerfectGas(AIR), 0.0, 1.4), (EquationOfState::NobleAbel(dense), 1e-3, 1.25)]
    {
        let mut network = network(law, SMOOTH, 1e5, &[(1e-3, 1e8, 2000.0)]);
        let mass = network.total().mass;
        let mut volume = 1e-3;
        let mut pressure = network.pressure(0, volume);
        let invariant = |p: f64, v: f64| p * (v - covolume * mass).powf(heat_ratio);
        let start = invariant(pressure, volume);
        // Out to three times the volume and back, with steps of at most 0.2 %.
        for step in 0..4000 {
            let phase = f64::from(step + 1) / 4000.0 * std::f64::consts::TAU;
            let next = 1e-3 * (2.0 - phase.cos());
            pressure = expand(&mut network, volume, next, pressure);
            volume = next;
            assert!((invariant(pressure, volume) / start - 1.0).abs() < 1e-6, "step {step}");
        }
        assert!((volume / 1e-3 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_vessel_blows_down_through_a_choked_slit() {
    let volume = 1e-3;
    let (p0, t0) = (5e6, 300.0);
    for opening in [2e-4, 2e-3] {
        let mut network = network(EquationOfState::PerfectGas(AIR), SMOOTH, 0.0, &[(volume, p0, t0)]);
        let slit = Passage { cells: [0, Passage::OUTSIDE], length: 1e-4, width: 0.05, opening };
        let sound = (1.4f64 * 287.0 * t0).sqrt();
        let (half, power) = (0.2, (2.0f64 / 2.4).powf(3.0));
        let area = slit.width * slit.opening;
        let dt = 0.005 * volume / (area * sound);
        for step in 1..=800 {
            network.flow(dt, &[volume], &[slit]);
            let t = f64::from(step) * dt;
            let exact = p0 * (1.0 + half * power * area * sound * t / volume).powf(-7.0);
            assert!((network.pressure(0, volume) / exact - 1.0).abs() < 0.01, "opening {opening} step {step}");
        }
    }
}

/// Two large vessels and a long slit of `count` cells between them, run until the flow is steady: the flow into the slit
/// and out of it [kg/s], and the pressures along it.
fn long_slit(count: u32, dt: f64, steps: u32) -> ([f64; 2], Vec<f64>) {
    let (w, b, length) = (5e-5, 0.1, 0.2);
    let part = length / f64::from(count);
    let mut cells = vec![(1.0, 2e5, 300.0)];
    cells.extend(vec![(w * b * part, 1.5e5, 300.0); count as usize]);
    cells.push((1.0, 1e5, 300.0));
    let mut network = network(EquationOfState::PerfectGas(AIR), SMOOTH, 0.0, &cells);
    let passages: Vec<Passage> = (0..=count)
        .map(|i| {
            let length = if i == 0 || i == count { 0.5 * part } else { part };
            Passage { cells: [i, i + 1], length, width: b, opening: w }
        })
        .collect();
    let volumes: Vec<f64> = cells.iter().map(|cell| cell.0).collect();
    let (mut ends, total) = ([0.0; 2], network.total());
    for step in 0..steps {
        let cells = &network.contents().cells;
        let before = [cells[0].mass, cells[count as usize + 1].mass];
        network.flow(dt, &volumes, &passages);
        if step + 100 >= steps {
            let cells = &network.contents().cells;
            ends[0] += before[0] - cells[0].mass;
            ends[1] += cells[count as usize + 1].mass - before[1];
        }
    }
    let now = network.total();
    let kept = [now.mass / total.mass - 1.0, now.energy / total.energy - 1.0];
    assert!(kept.iter().all(|error| error.abs() < 1e-12), "{kept:?}");
    let pressures = (0..count as usize + 2).map(|cell| network.pressure(cell, volumes[cell])).collect();
    (ends.map(|mass| mass / (100.0 * dt)), pressures)
}

#[test]
fn laminar_flow_through_a_long_slit_is_that_of_a_gas_at_constant_temperature() {
    let (w, b, length) = (5e-5f64, 0.1, 0.2);
    let exact = w.powi(3) * b * (4e10 - 1e10) / (24.0 * 1.8e-5 * 287.0 * 300.0 * length);
    // Explicit substeps, and steps so large that the pressures are implicit.
    for (dt, steps) in [(2e-5, 700), (1e-2, 200)] {
        let count = 100;
        let (ends, pressures) = long_slit(count, dt, steps);
        for flow in ends {
            assert!((flow / exact - 1.0).abs() < 0.01, "dt {dt}: {flow} {exact}");
        }
        for i in 1..=count as usize {
            let x = (i as f64 - 0.5) / f64::from(count);
            let square = 4e10 - 3e10 * x;
            assert!((pressures[i].powi(2) / square - 1.0).abs() < 0.01, "dt {dt} at {x}");
        }
    }
}

/// A vessel of detonation products, a rough crack of ever narrower cells that is empty at first, and a leak at its end.
fn burst(steps: u32, dt: f64) -> Network {
    let mut network = Network::new(EquationOfState::Jwl(Jwl::TNT), SlitFlow { viscosity: 5e-5, roughness: 2e-5 }, 1e5);
    let mut volumes = vec![1e-4];
    network.push_cell(Amount { mass: 0.05, energy: 0.05 * 4.3e6 });
    let mut passages = Vec::new();
    for i in 0..40u32 {
        let opening = 2e-4 / f64::from(i + 1);
        volumes.push(0.1 * 2e-3 * opening);
        network.push_cell(Amount::default());
        passages.push(Passage { cells: [i, i + 1], length: 2e-3, width: 0.1, opening });
    }
    passages.push(Passage { cells: [40, Passage::OUTSIDE], length: 1e-3, width: 0.1, opening: 1e-5 });
    for step in 0..steps {
        network.flow(dt, &volumes, &passages);
        for (cell, &volume) in volumes.iter().enumerate() {
            let p = network.pressure(cell, volume);
            assert!(p.is_finite() && p < 2e10, "step {step}: {p} Pa in cell {cell}");
        }
    }
    network
}

#[test]
fn mass_and_energy_are_kept_to_round_off_while_gas_runs_into_an_empty_crack() {
    for (steps, dt) in [(2000, 5e-8), (200, 1e-5), (5, 1e-2)] {
        let network = burst(steps, dt);
        let (held, contents) = (network.total(), network.contents());
        assert!(((held.mass + contents.leaked.mass) / contents.supplied.mass - 1.0).abs() < 1e-12);
        assert!(((held.energy + contents.leaked.energy) / contents.supplied.energy - 1.0).abs() < 1e-12);
        assert!(contents.cells.iter().all(|cell| cell.mass >= 0.0 && cell.energy >= 0.0));
        assert!(contents.leaked.mass >= 0.0);
    }
    assert!(burst(200, 1e-5).contents().leaked.mass > 0.0);
}

#[test]
fn saved_contents_go_on_with_the_same_bits() {
    let whole = burst(40, 1e-6);
    let mut second = burst(20, 1e-6);
    let saved = second.contents().clone();
    let fresh = burst(0, 1e-6);
    second = fresh;
    second.restore(saved);
    let again = burst(20, 1e-6);
    assert_eq!(second.contents(), again.contents());
    assert_eq!(whole.contents(), burst(40, 1e-6).contents());
}
