//! No point of the box gives a number that means nothing, and none breaks energy.

use super::*;

/// Belts as different as the input file allows in what the smooth rules look at.
fn any_belt() -> impl Strategy<Value = Belt> {
    let gap = prop_oneof![Just(0.0), 0.0..1e-3f64];
    let smoothing = (1e-4..0.2f64, 1.0..2000.0f64, 0.01..0.5f64);
    (any_formulation(), gap, smoothing, 1..=40u8, 0.0..0.02f64).prop_map(
        |(f, gap, (unity, blend, bound), bands, offset)| Belt {
            initial_gap_m: gap,
            unity_width: unity,
            blend_n: blend,
            slip_bound: bound,
            band_count: f64::from(bands),
            band_offset_m: offset,
            ..thesis_belt(f)
        },
    )
}

fn losses(s: &BeltState) -> [f64; 5] {
    [
        s.losses.band_nm,
        s.losses.film_nm,
        s.losses.slip_nm,
        s.losses.wedge_nm,
        s.losses.penetration_nm,
    ]
}

/// Finite, losses not negative, slips within their bound, capacity and its flag true to VA-2.
fn check_numbers(belt: &Belt, p: &Point, s: &BeltState) -> Result<(), TestCaseError> {
    let t = &s.tension;
    let more = [
        t.primary_shoulder_n,
        t.secondary_shoulder_n,
        s.losses.capacity_nm,
        s.slip.active_segments,
        s.losses.sum_nm(),
    ];
    for (x, name) in values(s).iter().zip(NAMES).chain(
        more.iter()
            .zip(["Q_p", "Q_s", "capacity", "segments", "sum"]),
    ) {
        hold(x.is_finite(), || format!("{name} is {x}: {s:?}"))?;
    }
    for (x, name) in losses(s).iter().zip(NAMES) {
        hold(*x >= 0.0, || format!("{name} loss is {x}"))?;
    }
    let bound = belt.slip_bound * (1.0 + 1e-12);
    hold(
        s.slip.primary.abs() <= bound && s.slip.secondary.abs() <= bound,
        || {
            format!(
                "slip {} and {} over its bound {} (SL-9)",
                s.slip.primary, s.slip.secondary, belt.slip_bound
            )
        },
    )?;
    hold(s.losses.capacity_nm >= 0.0, || {
        format!("capacity {}", s.losses.capacity_nm)
    })?;
    hold(
        s.losses.gross_slip || p.torque_nm.abs() <= s.losses.capacity_nm,
        || "gross slip goes unflagged".into(),
    )?;
    hold(
        p.ratio != 1.0 || s.losses.band_nm == 0.0 && s.losses.film_nm == 0.0,
        || {
            format!(
                "bands slide at ratio 1: {} {}",
                s.losses.band_nm, s.losses.film_nm
            )
        },
    )
}

/// First law: T_in w_in - T_out w_out is the sum of the losses; w_out is the slipped speed. Second law: what the driven shaft gets is
/// never more than what the driving one gives, whichever drives.
fn check_energy(p: &Point, s: &BeltState) -> Result<(), TestCaseError> {
    let w_in = if p.rpm > 0.0 { p.rpm * RPM } else { 1.0 };
    let w_out = w_in / p.ratio * (1.0 - s.losses.slip_total);
    let (given, taken) = (s.input_torque_nm * w_in, p.torque_nm * w_out);
    let lost: f64 = losses(s).iter().map(|x| x * w_in).sum();
    let rounding = 1e-14 * (given.abs() + taken.abs() + lost) + f64::MIN_POSITIVE;
    hold((given - taken - lost).abs() <= 8.0 * rounding, || {
        format!("{given} W in, {taken} W out, {lost} W lost")
    })?;
    hold(given >= taken - 8.0 * rounding, || {
        format!("{given} W in, {taken} W out")
    })
}

proptest! {
    #![proptest_config(config(6000))]

    /// Ratio 0.35 to 3, 0 to 7000 rpm, -400 to 400 Nm, 0 to 50 kN, all frictions 0 to 0.2, with the corners oftener than by chance.
    #[test]
    fn any_point_gives_finite_numbers_and_keeps_energy(belt in any_belt(), p in any_point()) {
        let s = p.state(&belt);
        check_numbers(&belt, &p, &s)?;
        check_energy(&p, &s)?;
    }

    /// Losses do not know which way round the pulleys turn.
    #[test]
    fn losses_are_even_in_the_sense_of_rotation(f in any_formulation(), p in any_point()) {
        let belt = thesis_belt(f);
        prop_assert_eq!(values(&p.state(&belt)), values(&Point { rpm: -p.rpm, ..p }.state(&belt)));
    }

    /// Slip is defined at standstill: a creeping belt's answer goes over into the standing one's.
    #[test]
    fn standing_is_the_limit_of_creeping(p in any_point()) {
        let belt = thesis_belt(Formulation::Smooth);
        let (rests, creeps) = (values(&Point { rpm: 0.0, ..p }.state(&belt)), values(&Point { rpm: 1e-5, ..p }.state(&belt)));
        for ((a, b), name) in rests.iter().zip(&creeps).zip(NAMES) {
            hold((a - b).abs() <= 1e-6 * (a.abs() + b.abs()) + 1e-6, || format!("{name}: {a} standing, {b} creeping"))?;
        }
    }
}

/// The corners by name, in every combination.
#[test]
fn every_corner_is_finite() {
    let mut count = 0;
    for f in ALL {
        let belt = thesis_belt(f);
        for ratio in [0.35, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 2.30, 2.417, 3.0] {
            for rpm in [0.0, 1e-9, 7000.0] {
                for clamp_n in [0.0, f64::MIN_POSITIVE, 1e-9, 750.0, 50e3] {
                    for (mu_band, mu_segment) in [
                        (0.0, 0.0),
                        (0.0, 0.2),
                        (0.2, 0.0),
                        (0.2, 0.2),
                        (1e-300, 1e-300),
                    ] {
                        let p = Point {
                            rpm,
                            clamp_n,
                            mu_band,
                            mu_segment,
                            ..Point::plain(ratio)
                        };
                        let at_zero_cx = p.breakpoint_nm(&belt);
                        for torque_nm in [-400.0, -1e-12, 0.0, 1e-12, 400.0, at_zero_cx] {
                            let p = Point { torque_nm, ..p };
                            let s = p.state(&belt);
                            let result =
                                check_numbers(&belt, &p, &s).and_then(|()| check_energy(&p, &s));
                            assert!(result.is_ok(), "{f:?} {p:?}: {result:?}");
                            count += 1;
                        }
                    }
                }
            }
        }
    }
    assert_eq!(count, 3 * 7 * 3 * 5 * 5 * 6);
}

/// A stop without a ramp is a step: all of the deflection below it, none at it or above, and never NaN.
#[test]
fn a_stop_without_a_ramp_is_a_step() {
    let belt = Belt {
        stop_from_ratio: 2.4,
        stop_to_ratio: 2.4,
        ..thesis_belt(Formulation::Smooth)
    };
    let stop = |ratio: f64| BeltAtRatio::new(&belt, ratio).prepared.stop;
    assert_eq!([stop(2.3999), stop(2.4), stop(2.4001)], [1.0, 0.0, 0.0]);
}
