//! The example of CONTRIBUTING, section "Change an equation": it compiles, the page quotes it word for word, and each lane has the bits of its run alone.

use crate::side_by_side::{Draw, together, with_lanes};
use cvtcycle_model::math::{Gather, Mask, Real, physics};

// begin of the example
/// Seal on a shaft.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct Seal<R: Real = f64> {
    /// Torque of the warm seal, Nm.
    pub warm_nm: R,
    /// True for a seal without grease; shared by the runs of a group.
    #[gather(same)]
    pub dry: bool,
}

#[physics]
impl<R: Real> Seal<R> {
    /// Drag torque, Nm.
    pub fn drag_nm(&self, speed_rad_s: R, oil_k: R) -> R {
        let mut drag_nm = self.warm_nm * (1.0 + 0.001 * speed_rad_s).clamp(0.0, 1.5);
        let cold = oil_k.lt(273.15);
        if !self.dry && cold.any() {
            let factor = ((273.15 - oil_k) * 0.1).max(0.0).exp();
            drag_nm = cold.select(factor * drag_nm, drag_nm);
        }
        speed_rad_s.gt(0.0).select(drag_nm, drag_nm.splat(0.0))
    }
}
// end of the example

#[test]
fn contributing_quotes_the_example() {
    let read = |path: &str| std::fs::read_to_string(path).unwrap().replace("\r\n", "\n");
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let source = read(&format!("{root}/tests/model/physics/change_an_equation.rs"));
    let (_, from) = source.split_once("// begin of the example\n").unwrap();
    let (example, _) = from.split_once("// end of the example\n").unwrap();
    let page = read(&format!("{root}/CONTRIBUTING.md"));
    assert!(
        page.contains(&format!("```rust\n{example}```\n")),
        "{example}"
    );
}

fn hold_lanes<R: Real>(like: R) {
    let mut draw = Draw(3);
    for dry in [false, true] {
        let seals: Vec<Seal> = (0..R::LANES)
            .map(|_| Seal {
                warm_nm: draw.between(0.1, 1.0),
                dry,
            })
            .collect();
        let points: Vec<[f64; 2]> = (0..R::LANES)
            .map(|_| [draw.between(-10.0, 900.0), draw.between(250.0, 300.0)])
            .collect();
        let [speed, oil_k] = [0, 1].map(|k| like.map_lanes(|lane| points[lane][k]));
        let all = together(like, &seals).drag_nm(speed, oil_k);
        for (lane, (seal, [speed, oil_k])) in seals.iter().zip(points).enumerate() {
            let alone = seal.drag_nm(speed, oil_k);
            assert_eq!(all.lane(lane).to_bits(), alone.to_bits(), "{seal:?}");
        }
    }
}

#[test]
fn each_lane_of_the_example_has_the_bits_of_its_run() {
    with_lanes!(like => hold_lanes(like));
}
