use cvtcycle::run::*;
use cvtcycle::setup::*;
fn main() {
    let s = load("rover_216_cvt", "", &Options::default()).unwrap();
    let c = cvtcycle::cycle::embedded("ece15_eudc").unwrap();
    let n: usize = std::env::args().nth(1).map_or(500, |a| a.parse().unwrap());
    for keep in [false, true] {
        let t = std::time::Instant::now();
        let mut f = 0.0;
        for _ in 0..n {
            let o = drive(&s, &c, &Conditions { ambient_k: 263.15, start: Start::Soak, max_dt_s: 1.0, keep_rows: keep });
            f += o.totals.total().fuel_kg;
        }
        println!("keep {keep}: {:.0} ns/step ({f})", t.elapsed().as_nanos() as f64 / (n as f64 * 1180.0));
    }
}
