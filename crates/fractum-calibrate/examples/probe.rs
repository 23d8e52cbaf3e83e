//! p
use fractum_calibrate::*;
use fractum_pack::*;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let csv = std::fs::read_to_string("/work/shared/reference/nguyen2019_elastic.csv").unwrap();
    for seed in 1..=3 {
        let p = pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), n, seed)).unwrap();
        for line in csv.lines().filter(|l| l.starts_with("glass") || l.starts_with("alumina")) {
            let w: Vec<&str> = line.split(',').collect();
            let v: Vec<f64> = w[1..].iter().map(|s| s.parse().unwrap()).collect();
            let (e0, nu0) = if w[0] == "glass" { (72.0, 0.23) } else { (340.0, 0.24) };
            let mut s = Sample::new(p.clone(), v[0], Convention::All).unwrap();
            s.set_micro(Micro { radius_ratio: v[1], young_modulus: v[2] }).unwrap();
            let t = std::time::Instant::now();
            let (r, _) = lab::tension(&s, 0, None, fractum_dem::Tolerance::default()).unwrap();
            println!(
                "{seed} {} {} E {:.2} ({:+.2}%) nu {:.4} ({:+.2}%) gauge {:.2?} {:.4?} it {} {:?}",
                w[0],
                v[0],
                r.young_modulus,
                (r.young_modulus / e0 - 1.0) * 100.0,
                r.poisson_ratio,
                (r.poisson_ratio / nu0 - 1.0) * 100.0,
                r.gauge_young_modulus,
                r.gauge_poisson_ratio,
                r.iterations,
                t.elapsed()
            );
        }
    }
}
