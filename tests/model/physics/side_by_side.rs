//! Equations over `Real` with several runs side by side: each lane has the bits of its run alone.
//!
//! Truth: the f64 instance of the same text. The numbers here are plain arrays; what is tested is the text, in which no lane may see another one.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::belt_properties::{ALL, thesis_belt};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::fluid::{BandFriction, Friction};
use cvtcycle_model::math::{Left, Mask, Operand, Real, ramp};
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltState, Formulation, belt_state,
};

const N: usize = 4;

/// Four numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lanes([f64; N]);

/// Four answers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Answers([bool; N]);

fn each<T>(f: impl Fn(usize) -> T) -> [T; N] {
    std::array::from_fn(f)
}

macro_rules! operators {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl $trait for Lanes {
            type Output = Lanes;
            fn $method(self, other: Lanes) -> Lanes {
                Lanes(each(|i| self.0[i] $op other.0[i]))
            }
        }
        impl $trait<f64> for Lanes {
            type Output = Lanes;
            fn $method(self, other: f64) -> Lanes {
                Lanes(self.0.map(|x| x $op other))
            }
        }
        impl $trait<Lanes> for f64 {
            type Output = Lanes;
            fn $method(self, other: Lanes) -> Lanes {
                Lanes(other.0.map(|x| self $op x))
            }
        }
    )*};
}

operators!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for Lanes {
    type Output = Lanes;
    fn neg(self) -> Lanes {
        Lanes(self.0.map(|x| -x))
    }
}

impl BitAnd for Answers {
    type Output = Answers;
    fn bitand(self, other: Answers) -> Answers {
        Answers(each(|i| self.0[i] & other.0[i]))
    }
}

impl BitOr for Answers {
    type Output = Answers;
    fn bitor(self, other: Answers) -> Answers {
        Answers(each(|i| self.0[i] | other.0[i]))
    }
}

impl Not for Answers {
    type Output = Answers;
    fn not(self) -> Answers {
        Answers(self.0.map(|x| !x))
    }
}

impl Mask for Answers {
    fn any(self) -> bool {
        self.0.contains(&true)
    }
}

impl Operand<Lanes> for f64 {
    fn lifted(self, _: Lanes) -> Lanes {
        Lanes([self; N])
    }
}

impl Real for Lanes {
    type Mask = Answers;

    fn filled(self, number: f64) -> Lanes {
        Lanes([number; N])
    }

    fn each(self, f: impl Fn(f64) -> f64) -> Lanes {
        Lanes(self.0.map(f))
    }

    fn above(self, other: impl Operand<Lanes>) -> Answers {
        let other = other.lifted(self);
        Answers(each(|i| self.0[i] > other.0[i]))
    }

    fn reaches(self, other: impl Operand<Lanes>) -> Answers {
        let other = other.lifted(self);
        Answers(each(|i| self.0[i] >= other.0[i]))
    }

    fn pick(mask: Answers, yes: Lanes, no: Lanes) -> Lanes {
        Lanes(each(|i| if mask.0[i] { yes.0[i] } else { no.0[i] }))
    }

    fn abs(self) -> Lanes {
        Lanes(self.0.map(f64::abs))
    }

    fn sqrt(self) -> Lanes {
        Lanes(self.0.map(f64::sqrt))
    }

    fn within<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }
}

/// Numbers between bounds, the same ones in every run (a linear congruential generator).
struct Draw(u64);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1);
        low + (high - low) * ((self.0 >> 11) as f64 / 2f64.powi(53))
    }
}

/// A number of four runs.
fn of(f: impl Fn(usize) -> f64) -> Lanes {
    Lanes(each(f))
}

fn belts(own: &[Belt; N]) -> Belt<Lanes> {
    Belt {
        centre_distance_m: of(|i| own[i].centre_distance_m),
        length_m: of(|i| own[i].length_m),
        segment_thickness_m: of(|i| own[i].segment_thickness_m),
        cos_wedge: of(|i| own[i].cos_wedge),
        tan_wedge: of(|i| own[i].tan_wedge),
        band_count: of(|i| own[i].band_count),
        band_thickness_m: of(|i| own[i].band_thickness_m),
        band_width_m: of(|i| own[i].band_width_m),
        band_offset_m: of(|i| own[i].band_offset_m),
        shoulder_friction: of(|i| own[i].shoulder_friction),
        mass_kg_m: of(|i| own[i].mass_kg_m),
        band_mass_kg_m: of(|i| own[i].band_mass_kg_m),
        youngs_pa: of(|i| own[i].youngs_pa),
        strut_area_m2: of(|i| own[i].strut_area_m2),
        initial_gap_m: of(|i| own[i].initial_gap_m),
        primary_compliance_per_n: of(|i| own[i].primary_compliance_per_n),
        secondary_compliance_per_n: of(|i| own[i].secondary_compliance_per_n),
        stop_from_ratio: of(|i| own[i].stop_from_ratio),
        stop_to_ratio: of(|i| own[i].stop_to_ratio),
        unity_width: of(|i| own[i].unity_width),
        blend_n: of(|i| own[i].blend_n),
        slip_bound: of(|i| own[i].slip_bound),
        thrust_ratio: own[0].thrust_ratio.clone(),
        formulation: own[0].formulation,
    }
}

fn frictions(own: &[Friction; N]) -> Friction<Lanes> {
    Friction {
        band: of(|i| own[i].band),
        band_rise_per_k: of(|i| own[i].band_rise_per_k),
        segment: of(|i| own[i].segment),
        capacity: of(|i| own[i].capacity),
        flank: of(|i| own[i].flank),
        film: own[0].film,
        half_n_m: of(|i| own[i].half_n_m),
        film_exponent: of(|i| own[i].film_exponent),
        half_thickness_m: of(|i| own[i].half_thickness_m),
        film_heating_w: of(|i| own[i].film_heating_w),
    }
}

/// Belt temperature, viscosity, ratio, speed, torque and clamping force of a point.
type State<R> = [R; 6];

/// The belt with its friction at a point, by one text.
fn solve<R: Real>(
    belt: &Belt<R>,
    friction: &Friction<R>,
    [belt_k, eta, ratio, w, torque, clamp]: State<R>,
) -> (BeltAtRatio<R>, BandFriction<R>, BeltLoad<R>, BeltState<R>)
where
    f64: Left<R>,
{
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
fn numbers(record: &impl std::fmt::Debug) -> Vec<String> {
    let text = format!("{record:?}");
    let part = |c: char| c.is_alphanumeric() || "._-".contains(c);
    let words = text.split(|c: char| !part(c));
    let is_value = |w: &&str| {
        w.parse::<f64>().is_ok() || matches!(*w, "true" | "false") // NaN and inf parse
    };
    words.filter(is_value).map(str::to_owned).collect()
}

#[test]
fn each_lane_has_the_bits_of_its_run_alone() {
    let car = load("rover_216_cvt", &Options::default())
        .unwrap()
        .car(298.15);
    let mut draw = Draw(22);
    for formulation in ALL {
        for _ in 0..3_000 {
            let mut near = |x: f64| x * draw.between(0.9, 1.1);
            let plain = thesis_belt(formulation);
            let own = each(|_| plain.clone()).map(|belt| Belt {
                centre_distance_m: belt.centre_distance_m * (0.99 + 0.01 * near(1.0)),
                tan_wedge: near(belt.tan_wedge),
                youngs_pa: near(belt.youngs_pa),
                band_offset_m: near(belt.band_offset_m),
                unity_width: near(belt.unity_width),
                initial_gap_m: near(1e-4),
                shoulder_friction: near(1.0),
                ..belt
            });
            let friction = each(|_| ()).map(|()| Friction {
                band: near(car.oil.friction.band),
                half_n_m: near(car.oil.friction.half_n_m),
                film_exponent: near(car.oil.friction.film_exponent),
                ..car.oil.friction
            });
            let point = each(|_| ()).map(|()| -> State<f64> {
                [
                    draw.between(233.0, 433.0),
                    draw.between(0.002, 4.0),
                    draw.between(0.42, 2.4),
                    draw.between(0.0, 600.0),
                    draw.between(-120.0, 200.0),
                    draw.between(0.0, 40e3),
                ]
            });
            let points: State<Lanes> = std::array::from_fn(|k| of(|i| point[i][k]));
            let together = numbers(&solve(&belts(&own), &frictions(&friction), points));
            let alone = each(|i| numbers(&solve(&own[i], &friction[i], point[i])));
            assert_eq!(together.len(), N * alone[0].len());
            for (k, lanes) in together.chunks(N).enumerate() {
                assert_eq!(
                    lanes,
                    each(|i| alone[i][k].clone()),
                    "{formulation:?} {k} {point:?}"
                );
            }
        }
    }
}

/// What the belt meets at its bounds: at rest, without clamping, at ratio 1, with NaN; one lane's does not spread.
#[test]
fn bounds_of_one_lane_leave_the_others_alone() {
    let oil = load("rover_216_cvt", &Options::default())
        .unwrap()
        .car(298.15)
        .oil;
    let belt = thesis_belt(Formulation::Smooth);
    let point: [State<f64>; N] = [
        [300.0, 0.05, 1.0, 0.0, 0.0, 0.0],
        [350.0, 0.01, 0.7, 200.0, 40.0, 20e3],
        [350.0, f64::NAN, 2.4, 200.0, -900.0, 20e3],
        [350.0, f64::INFINITY, 0.42, 600.0, 900.0, 1e3],
    ];
    let points: State<Lanes> = std::array::from_fn(|k| of(|i| point[i][k]));
    let same = [(); N].map(|()| belt.clone());
    let together = numbers(&solve(
        &belts(&same),
        &frictions(&[oil.friction; N]),
        points,
    ));
    for i in 0..N {
        let alone = numbers(&solve(&belt, &oil.friction, point[i]));
        let lane: Vec<String> = together.chunks(N).map(|lanes| lanes[i].clone()).collect();
        assert_eq!(lane, alone, "lane {i}");
    }
}

#[test]
fn choices_and_bounds_are_those_of_f64() {
    let x = Lanes([-1.0, 0.25, 2.0, f64::NAN]);
    let bits = |x: Lanes| x.0.map(f64::to_bits);
    let alone = |f: &dyn Fn(f64) -> f64| x.0.map(|x| f(x).to_bits());
    assert_eq!(bits(x.most(0.0)), alone(&|x| x.most(0.0)));
    assert_eq!(bits(x.least(1.0)), alone(&|x| x.least(1.0)));
    assert_eq!(bits(x.held(0.0, 1.0)), alone(&|x| x.held(0.0, 1.0)));
    for (from, to) in [(0.0, 1.0), (1.0, 0.0), (0.25, 0.25)] {
        let together = ramp(x, x.filled(from), x.filled(to));
        assert_eq!(bits(together), alone(&|x| ramp(x, from, to)));
    }
    assert!((!x.above(0.0)).any() && !(x.above(0.0) & x.filled(0.0).above(x)).any());
}
