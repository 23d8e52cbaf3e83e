use fractum_calibrate::{Micro, Sample, lab, published};
use fractum_dem::criterion::*;
use fractum_dem::{Criterion, Batch};
use fractum_pack::{Convention, Domain, PackSpec, pack};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: usize = a[1].parse().unwrap();
    let test = &a[2];
    for cn in a[3].split(',').map(|c| c.parse::<f64>().unwrap()) {
    let anchor = published::anchors().into_iter().find(|x| x.coordination == cn && x.young_modulus == 72e9).unwrap();
    let (d, f) = match test.as_str() {
        "tension" => (Domain::cuboid(2e-3, 2e-3, 2e-3), lab::Failure::Tension),
        "compression" => (Domain::cuboid(2e-3, 2e-3, 2e-3), lab::Failure::Compression),
        "bending" => (Domain::cuboid(5e-3, 1e-3, 1e-3), lab::Failure::Bending),
        "torsion" => (Domain::cylinder(100e-3, 2e-3), lab::Failure::Torsion),
        _ => (Domain::cylinder(10e-3, 25e-3), lab::Failure::Brazilian),
    };
    let seed: u64 = a[5].parse().unwrap();
    let packing = pack(&PackSpec::new(d, n, seed)).unwrap();
    let mut sample = Sample::new(packing, cn, Convention::All).unwrap();
    sample.set_micro(Micro { radius_ratio: anchor.radius_ratio, young_modulus: anchor.beam_modulus }).unwrap();
    let k = published::strength_ratio(anchor.radius_ratio, cn);
    let sm = 50e6 / k;
    for level in a[4].split(',') {
        let level = Level::from_number(level.parse().unwrap()).unwrap();
        let c = Criterion::Principal(Principal { tensile_strength: sm, compressive_strength: if test=="compression" {Some(10.0*sm)} else {None}, level });
        for batch in [Batch::PerSite, Batch::One].into_iter().take(a.get(6).map_or(1, |s| s.parse().unwrap())) {
        for tol in a.get(7).map_or("1e-4", |s| s).split(',') {
        let mut o = lab::FailureOptions::new(c);
        o.batch = batch; o.tolerance.residual = tol.parse().unwrap();
        let t = std::time::Instant::now();
        let b = lab::break_sample(&sample, f, &o).unwrap();
        println!("cn {cn} fv {:.4} {level:?} {batch:?} tol {tol}: first {:.2} MPa peak {:.2} MPa at {} broken; cracks {} events {} effort {:?} peak {:?} sep {} {:.1} s", sample.fraction, b.first_break.unwrap()/1e6, b.strength/1e6, b.outcome.peak.broken, b.outcome.cracks.len(), b.outcome.curve.len(), b.outcome.effort, b.outcome.effort_to_peak, b.outcome.separated, t.elapsed().as_secs_f64());
        let last = b.outcome.curve.last().unwrap();
        println!("   work {:.3e} elastic {:.3e} cracks' energy {:.3e}", last.work, last.elastic, b.outcome.cracks.iter().map(|c| c.energy).sum::<f64>());
        }}
    }}
}
