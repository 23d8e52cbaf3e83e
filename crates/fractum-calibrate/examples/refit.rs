//! p
use fractum_calibrate::laws::*;
use fractum_pack::Convention;
fn main() {
    let t = std::time::Instant::now();
    let points = survey(&Survey::default()).unwrap();
    println!("{} tests {:?}", points.len(), t.elapsed());
    let laws: Vec<Law> =
        [Convention::All, Convention::Interior].into_iter().map(|c| Law::fit(&points, c).unwrap()).collect();
    for l in &laws {
        println!("{:?} {:?}", l.poisson_residual, l.young_residual);
    }
    std::fs::write("crates/fractum-calibrate/laws/laws.csv", write(&laws)).unwrap();
    std::fs::write("crates/fractum-calibrate/laws/database.csv", write_database(&points)).unwrap();
}
