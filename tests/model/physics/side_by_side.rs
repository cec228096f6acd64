//! Equations over `Real` with several runs side by side: each lane has the bits of its run alone.
//!
//! Truth: the f64 instance of the same text. The lanes are 4 and 8, in the instructions of this processor and in those that every processor has.

use crate::belt_properties::{ALL, thesis_belt};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::lubricant::{BandFriction, Friction};
use cvtcycle_model::math::{Curve, Gather, Mask, Real, asin, ramp, tanh};
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltState, Chain, Formulation, belt_state,
};

/// Evaluates an expression with a zero of each width, of the best instructions that this processor has and of those that all have.
macro_rules! with_lanes {
    ($like:ident => $value:expr) => {
        for level in [
            cvtcycle_model::math::Level::new(),
            cvtcycle_model::math::Level::baseline(),
        ] {
            cvtcycle_model::math::dispatch!(level, simd => {
                let $like = cvtcycle_model::math::four(simd);
                $value
            });
            cvtcycle_model::math::dispatch!(level, simd => {
                let $like = cvtcycle_model::math::eight(simd);
                $value
            });
        }
    };
}
pub(crate) use with_lanes;

/// Numbers between bounds, the same ones in every run (a linear congruential generator).
pub struct Draw(pub u64);

impl Draw {
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1);
        low + (high - low) * ((self.0 >> 11) as f64 / 2f64.powi(53))
    }
}

/// Belt temperature, viscosity, ratio, speed, torque and clamping force of a point.
type State<R> = [R; 6];

/// The belt with its friction at a point, by one text.
fn solve<R: Real>(
    belt: &Belt<R>,
    friction: &Friction<R>,
    [belt_k, eta, ratio, w, torque, clamp]: State<R>,
) -> (BeltAtRatio<R>, BandFriction<R>, BeltLoad<R>, BeltState<R>) {
    let at = BeltAtRatio::new(belt, ratio);
    let sliding = belt.sliding_m_s(ratio, w);
    let band = friction.band(belt_k, eta, sliding);
    let load = BeltLoad {
        primary_speed_rad_s: w,
        output_torque_nm: torque,
        secondary_clamp_n: clamp,
        ..BeltLoad::unloaded(friction, band, at.prepared.film_area_m2, sliding)
    };
    let state = belt_state(belt, &at, &load);
    (at, band, load, state)
}

/// The numbers of a record as its `Debug` has them, in order. The shortest digits that give an f64 back are as good as its bits.
pub fn numbers(record: &impl std::fmt::Debug) -> Vec<String> {
    let text = format!("{record:?}");
    let part = |c: char| c.is_alphanumeric() || "._-".contains(c);
    let words = text.split(|c: char| !part(c));
    let is_value = |w: &&str| {
        w.parse::<f64>().is_ok() || matches!(*w, "true" | "false") // NaN and inf parse
    };
    words.filter(is_value).map(str::to_owned).collect()
}

/// The record of some runs in lanes.
pub fn together<R: Real, T: Gather>(like: R, own: &[T]) -> T::Together<R> {
    T::gather(like, &own.iter().collect::<Vec<_>>())
}

/// Holds that every number of a record of several runs is that of the record of its run alone.
pub fn assert_alone(
    lanes: usize,
    together: &impl std::fmt::Debug,
    alone: impl Fn(usize) -> Vec<String>,
    place: &impl std::fmt::Debug,
) {
    let together = numbers(together);
    let alone: Vec<_> = (0..lanes).map(alone).collect();
    assert_eq!(together.len(), lanes * alone[0].len());
    for (k, of_lanes) in together.chunks(lanes).enumerate() {
        for (lane, number) in of_lanes.iter().enumerate() {
            assert_eq!(
                *number, alone[lane][k],
                "number {k}, lane {lane}: {place:?}"
            );
        }
    }
}

/// Eight belts, their frictions and their points.
struct Drawn {
    belts: Vec<Belt>,
    frictions: Vec<Friction>,
    points: Vec<State<f64>>,
}

const MOST: usize = 8;

impl Drawn {
    fn alone(&self, i: usize) -> Vec<String> {
        numbers(&solve(&self.belts[i], &self.frictions[i], self.points[i]))
    }
}

fn oil_friction() -> Friction {
    let car = load("rover_216_cvt", &Options::default()).unwrap();
    car.car(298.15).oil.friction
}

fn drawn(formulation: Formulation, chained: bool, of: &Friction, draw: &mut Draw) -> Drawn {
    let mut near = |x: f64| x * draw.between(0.9, 1.1);
    let belt = |_| {
        let belt = thesis_belt(formulation);
        Belt {
            centre_distance_m: belt.centre_distance_m * (0.99 + 0.01 * near(1.0)),
            tan_wedge: near(belt.tan_wedge),
            youngs_pa: near(belt.youngs_pa),
            band_offset_m: near(belt.band_offset_m),
            unity_width: near(belt.unity_width),
            initial_gap_m: near(1e-4),
            shoulder_friction: near(1.0),
            chain: chained.then(|| Chain {
                joint_m: near(2e-5),
                pin_m: near(4e-4),
                slip: near(0.02),
                stiffness_n: near(5e6),
            }),
            ..belt
        }
    };
    let belts = (0..MOST).map(belt).collect();
    let friction = |_| Friction {
        band: near(of.band),
        half_n_m: near(of.half_n_m),
        film_exponent: near(of.film_exponent),
        ..*of
    };
    let frictions = (0..MOST).map(friction).collect();
    let point = |_| {
        [
            draw.between(233.0, 433.0),
            draw.between(0.002, 4.0),
            draw.between(0.42, 2.4),
            draw.between(0.0, 600.0),
            draw.between(-120.0, 200.0),
            draw.between(0.0, 40e3),
        ]
    };
    let points = (0..MOST).map(point).collect();
    Drawn {
        belts,
        frictions,
        points,
    }
}

/// Solves the belts side by side and one by one.
fn hold_belts<R: Real>(like: R, of: &Drawn) {
    let side_by_side = solve(
        &together(like, &of.belts),
        &together(like, &of.frictions),
        together(like, &of.points),
    );
    assert_alone(R::LANES, &side_by_side, |i| of.alone(i), &of.points);
}

#[test]
fn each_lane_has_the_bits_of_its_run_alone() {
    let (friction, mut draw) = (oil_friction(), Draw(22));
    for (formulation, chained) in ALL
        .map(|formulation| (formulation, false))
        .into_iter()
        .chain([(Formulation::Smooth, true)])
    {
        for _ in 0..500 {
            let drawn = drawn(formulation, chained, &friction, &mut draw);
            with_lanes!(like => hold_belts(like, &drawn));
        }
    }
}

/// Bounds of the belt: at rest, without clamping, at ratio 1, with NaN. A lane at one of them does not change the others.
#[test]
fn bounds_of_one_lane_leave_the_others_alone() {
    let point: [State<f64>; 4] = [
        [300.0, 0.05, 1.0, 0.0, 0.0, 0.0],
        [350.0, 0.01, 0.7, 200.0, 40.0, 20e3],
        [350.0, f64::NAN, 2.4, 200.0, -900.0, 20e3],
        [350.0, f64::INFINITY, 0.42, 600.0, 900.0, 1e3],
    ];
    let drawn = Drawn {
        belts: vec![thesis_belt(Formulation::Smooth); MOST],
        frictions: vec![oil_friction(); MOST],
        points: (0..MOST).map(|i| point[i % 4]).collect(),
    };
    with_lanes!(like => hold_belts(like, &drawn));
}

/// Numbers that a choice or a bound may treat in its own way.
const EDGES: [f64; MOST] = [-1.0, 0.25, 2.0, f64::NAN, -0.0, 0.0, f64::INFINITY, 1e-320];

/// Functions of one number, over any number type.
fn functions<R: Real>(x: R) -> [R; 10] {
    let square = x * x;
    [
        x.max(0.0),
        x.min(1.0),
        x.clamp(0.0, 1.0),
        Real::abs(x),
        x.exp(),
        square.ln(),
        square.sqrt(),
        ramp(x, x.splat(0.0), x.splat(1.0)),
        ramp(x, x.splat(1.0), x.splat(0.0)),
        ramp(x, x.splat(0.25), x.splat(0.25)),
    ]
}

fn alone(lane: usize) -> [f64; 10] {
    functions(EDGES[lane])
}

fn hold_choices<R: Real>(like: R) {
    let x = like.map_lanes(|lane| EDGES[lane]);
    for (k, y) in functions(x).into_iter().enumerate() {
        for lane in 0..R::LANES {
            let (y, alone) = (y.lane(lane), alone(lane)[k]);
            // The sign of what is no number is not defined.
            assert!(
                y.to_bits() == alone.to_bits() || y.is_nan() && alone.is_nan(),
                "{k} {lane}"
            );
        }
    }
    let positive = x.gt(0.0);
    assert!((!positive).any() && !(positive & x.splat(0.0).gt(x)).any());
    assert!((!positive | positive).all() && !positive.all());
    for (lane, edge) in EDGES.into_iter().enumerate().take(R::LANES) {
        assert_eq!(positive.lane(lane), edge > 0.0);
        let same = x.bits_eq(x.with_lane(lane, 7.0));
        assert!((0..R::LANES).all(|other| same.lane(other) == (other != lane)));
    }
}

#[test]
fn choices_and_bounds_are_those_of_f64() {
    with_lanes!(like => hold_choices(like));
}

/// One curve of all runs is looked up for the group, curves of their own one by one: both with the bits of each run.
fn hold_curves<R: Real>(like: R, points: &[Vec<(f64, f64)>], x: &[f64; MOST]) {
    let curve = |lane: usize| Curve::new(&points[lane % points.len()]).unwrap();
    let own: Vec<Curve> = (0..R::LANES).map(curve).collect();
    let y = like
        .map_lanes(|lane| x[lane])
        .interpolate(&together(like, &own));
    for (lane, own) in own.iter().enumerate() {
        let (y, alone) = (y.lane(lane), own.at(x[lane]));
        assert!(
            y.to_bits() == alone.to_bits() || y.is_nan() && alone.is_nan(),
            "{points:?} at {x:?}: {y} in lane {lane}, {alone}"
        );
    }
}

#[test]
fn curves_are_those_of_f64() {
    let bent: Vec<(f64, f64)> = (0..40)
        .map(|k| (f64::from(k * k), f64::from(k % 7)))
        .collect();
    let short = vec![(-1.0, 2.0), (0.5, -3.0), (2.0, -0.0)];
    let flat = vec![(3.0, 4.0)];
    let curves = [
        vec![bent.clone()],
        vec![short.clone()],
        vec![flat.clone()],
        vec![bent, short, flat],
    ];
    let mut draw = Draw(5);
    for points in &curves {
        let mut of = |low: f64, high: f64| std::array::from_fn(|_| draw.between(low, high));
        let at_points = std::array::from_fn(|lane| points[0][lane % points[0].len()].0);
        let numbers: [[f64; MOST]; 8] = [
            EDGES,
            at_points,
            [f64::INFINITY; MOST],
            [f64::NEG_INFINITY; MOST],
            of(-2.0, 3.0),
            of(-2.0, 1600.0),
            of(400.0, 410.0),
            of(1521.0, 1e9),
        ];
        for x in &numbers {
            with_lanes!(like => hold_curves(like, points, x));
        }
    }
}

/// Inner functions whose lanes are worked out together, and one by one where they lie far apart.
fn hold_angles<R: Real>(like: R, x: &[f64; MOST]) {
    let lanes = like.map_lanes(|lane| x[lane]);
    for lane in 0..R::LANES {
        for (y, alone) in [(lanes.asin(), asin(x[lane])), (lanes.tanh(), tanh(x[lane]))] {
            let y = y.lane(lane);
            assert!(
                y.to_bits() == alone.to_bits() || y.is_nan() && alone.is_nan(),
                "{x:?}: {y} in lane {lane}, {alone}"
            );
        }
    }
}

#[test]
fn arcsine_and_tanh_are_those_of_f64() {
    let mut draw = Draw(9);
    for size in [0.1, 0.499, 0.6, 1.0, 3.0, 40.0] {
        for _ in 0..50 {
            let x: [f64; MOST] = std::array::from_fn(|_| draw.between(-size, size));
            with_lanes!(like => hold_angles(like, &x));
        }
    }
    with_lanes!(like => hold_angles(like, &EDGES));
}
