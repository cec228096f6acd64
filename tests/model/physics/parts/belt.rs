//! The belt against an independent transcription of the printed program, its geometry, and its properties.

use crate::belt_properties::thesis_belt;
use cvtcycle_model::lubricant::BandFriction;
use cvtcycle_model::transmission::cvt::variator::{Geometry, *};

/// Outside truth: 200 ratios of an independent program, committed with the tests.
#[test]
fn val_golden_geometry() {
    let text = include_str!("../../../golden/belt_geometry.csv");
    let mut count = 0;
    for line in text.lines().skip(1) {
        let c: Vec<f64> = line
            .split(',')
            .map(|x| x.parse().expect("number"))
            .collect();
        let g = Geometry::new(c[0], 0.155, 0.6486);
        let got = [
            g.primary_radius_m,
            g.secondary_radius_m,
            g.primary_wrap_rad,
            g.secondary_wrap_rad,
            g.strut_m,
        ];
        for (got, want) in got.iter().zip(&c[1..6]) {
            assert!(
                (got - want).abs() <= 1e-9 * want.abs() + 1e-9,
                "I {}: {got} {want}",
                c[0]
            );
        }
        count += 1;
    }
    assert_eq!(count, 200);
}

#[test]
fn radius_slope_is_the_derivative() {
    for ratio in [0.42, 0.7, 1.0, 1.6, 2.4] {
        let r = |u: f64| Geometry::new(ratio * u.exp(), 0.155, 0.6486).secondary_radius_m;
        let numeric = (r(1e-5) - r(-1e-5)) / 2e-5;
        let slope = Geometry::new(ratio, 0.155, 0.6486).secondary_radius_slope_m();
        assert!(
            (slope / numeric - 1.0).abs() < 1e-6,
            "I {ratio}: {slope} {numeric}"
        );
    }
}

/// Dimension rescaling: all lengths twice as long give radii twice as large at the same angles.
#[test]
fn rescales_with_length() {
    let (a, b) = (
        Geometry::new(0.6, 0.155, 0.6486),
        Geometry::new(0.6, 0.31, 1.2972),
    );
    assert!((b.primary_radius_m / a.primary_radius_m - 2.0).abs() < 1e-12);
    assert!((b.primary_wrap_rad - a.primary_wrap_rad).abs() < 1e-12);
}

/// Property: a belt that has been at other ratios is at a new one as a belt that begins there, bit by bit.
#[test]
fn a_belt_forgets_its_ratios() {
    for (_, formulation) in Formulation::NAMES {
        let belt = thesis_belt(formulation);
        let mut moved = BeltAtRatio::new(&belt, 2.4);
        for ratio in [1.7, 1.0, 0.45, 0.9, 2.1] {
            moved.move_to(&belt, ratio);
            assert_eq!(moved, BeltAtRatio::new(&belt, ratio), "I {ratio}");
        }
    }
}

fn load(speed_rpm: f64, torque: f64, bar: f64, mu: f64) -> BeltLoad {
    BeltLoad {
        primary_speed_rad_s: speed_rpm * std::f64::consts::PI / 30.0,
        output_torque_nm: torque,
        secondary_clamp_n: bar * 1e5 * 0.97190e-2 + 750.0,
        band: BandFriction::dry(mu),
        film_n: [0.0; 2],
        segment_friction: 0.125,
        capacity_friction: 0.125,
        flank_friction: 0.13,
    }
}

/// One line of the golden table, by column name.
struct Golden<'a> {
    names: Vec<&'a str>,
    cells: Vec<&'a str>,
}

impl Golden<'_> {
    fn text(&self, name: &str) -> &str {
        self.cells[self.names.iter().position(|n| *n == name).expect("column")]
    }
    fn num(&self, name: &str) -> f64 {
        self.text(name).parse().expect("number")
    }
}

fn golden() -> Vec<Golden<'static>> {
    rows(include_str!("../../../golden/belt_points.csv"))
}

fn rows(text: &str) -> Vec<Golden<'_>> {
    let names: Vec<&str> = text.lines().next().expect("header").split(',').collect();
    text.lines()
        .skip(1)
        .map(|l| Golden {
            names: names.clone(),
            cells: l.split(',').collect(),
        })
        .collect()
}

fn belt_of(row: &Golden) -> Belt {
    let f = if row.text("formulation") == "appendix_c" {
        Formulation::AppendixC
    } else {
        Formulation::Chapter8
    };
    let th = row.num("pulley_half_angle_deg").to_radians();
    let stop = row.num("primary_on_stop") > 0.5;
    let mut belt = thesis_belt(f);
    belt.cos_wedge = th.cos();
    belt.tan_wedge = th.tan();
    belt.band_count = row.num("band_count");
    belt.band_offset_m = row.num("band_offset_mm") * 1e-3;
    belt.unity_width = 1e-9;
    if stop {
        belt.primary_compliance_per_n = 0.0;
    }
    if f == Formulation::Chapter8 {
        (belt.stop_from_ratio, belt.stop_to_ratio) = (9.0, 10.0);
    }
    belt
}

/// A point in driving has the numbers of the solver, bit by bit, and its columns add up to them.
#[test]
fn driving_points_are_belt_states() {
    for (_, formulation) in Formulation::NAMES {
        let belt = thesis_belt(formulation);
        for (ratio, torque, bar) in [
            (0.45, 10.0, 11.0),
            (1.0, -20.0, 20.0),
            (2.35, 60.0, 30.0),
            (0.8, 300.0, 15.0),
        ] {
            let at = BeltAtRatio::new(&belt, ratio);
            let load = BeltLoad {
                band: BandFriction {
                    film_share: [0.4, 0.1],
                    ..BandFriction::dry(0.12)
                },
                film_n: [300.0, 20.0],
                ..load(3000.0, torque, bar, 0.12)
            };
            let (p, s) = (
                driving_point(&belt, &at, &load),
                belt_state(&belt, &at, &load),
            );
            assert_eq!(p.loss_nm.to_bits(), s.losses.sum_nm().to_bits());
            assert_eq!(p.input_torque_nm.to_bits(), s.input_torque_nm.to_bits());
            assert_eq!(
                (p.tension, p.slip_total.to_bits(), p.capacity_nm.to_bits()),
                (
                    s.tension,
                    s.losses.slip_total.to_bits(),
                    s.losses.capacity_nm.to_bits()
                )
            );
            assert_eq!(
                p.status == point::PointStatus::GrossSlip,
                s.losses.gross_slip
            );
            for (pair, want) in [
                (p.band_loss_nm, s.losses.band_nm),
                (p.film_loss_nm, s.losses.film_nm),
                (p.slip_loss_nm, s.losses.slip_nm),
                (p.wedge_loss_nm, s.losses.wedge_nm),
                (p.penetration_loss_nm, s.losses.penetration_nm),
            ] {
                assert!(
                    (pair[0] + pair[1] - want).abs() <= 1e-12 * want,
                    "{pair:?} {want}"
                );
            }
            let loaded = if s.tension.compression_n > 0.0 {
                p.slip_m_s[0]
            } else {
                -p.slip_m_s[1]
            };
            // Away from C_x = 0 gap and idle slip are the loading pulley's slip, at its bound as well.
            if s.tension.compression_n.abs() > 1200.0 {
                assert!(
                    (p.gap_slip_m_s + p.idle_slip_m_s - loaded).abs() <= 1e-12,
                    "I {ratio}: {p:?}"
                );
            }
        }
    }
}

/// Dimension rescaling of the printed forms: lengths x 2, forces x 4, mass per length x 4, speed halved, contact areas x 4: the
/// parts that hold no fitted area scale with 8.
#[test]
fn printed_forms_rescale() {
    for formulation in [Formulation::AppendixC, Formulation::Chapter8] {
        let small = Belt {
            primary_compliance_per_n: 1e-7,
            ..thesis_belt(formulation)
        };
        let large = Belt {
            centre_distance_m: 2.0 * small.centre_distance_m,
            length_m: 2.0 * small.length_m,
            segment_thickness_m: 2.0 * small.segment_thickness_m,
            band_thickness_m: 2.0 * small.band_thickness_m,
            band_width_m: 2.0 * small.band_width_m,
            band_offset_m: 2.0 * small.band_offset_m,
            mass_kg_m: 4.0 * small.mass_kg_m,
            band_mass_kg_m: 4.0 * small.band_mass_kg_m,
            strut_area_m2: 4.0 * small.strut_area_m2,
            primary_compliance_per_n: small.primary_compliance_per_n / 4.0,
            secondary_compliance_per_n: small.secondary_compliance_per_n / 4.0,
            ..small.clone()
        };
        let at = |belt: &Belt| BeltAtRatio::new(belt, 1.7);
        let one = load(2000.0, 40.0, 20.0, 0.13);
        let two = BeltLoad {
            primary_speed_rad_s: one.primary_speed_rad_s / 2.0,
            output_torque_nm: 8.0 * one.output_torque_nm,
            secondary_clamp_n: 4.0 * one.secondary_clamp_n,
            ..one
        };
        let (a, b) = (
            belt_point(&small, &at(&small), &one),
            belt_point(&large, &at(&large), &two),
        );
        let parts = |p: &BeltPoint| {
            [
                p.band_loss_nm,
                p.wedge_loss_nm,
                p.penetration_loss_nm,
                [p.capacity_nm; 2],
            ]
        };
        for (x, y) in parts(&a).iter().flatten().zip(parts(&b).iter().flatten()) {
            assert!((y / x / 8.0 - 1.0).abs() < 1e-9, "{x} {y}");
        }
        assert!((b.band_travel_m[0] / a.band_travel_m[0] - 2.0).abs() < 1e-9);
        assert!((a.active_segments - b.active_segments).abs() <= 0.0);
    }
}

/// Away from the change of loading branch, slip and slip loss follow the printed segment count.
#[test]
fn val_golden_points_slip() {
    let (mut count, mut sum2) = (0.0, 0.0);
    for row in golden() {
        let mu = row.num("segment_friction");
        let plain = if row.text("formulation") == "appendix_c" {
            0.125
        } else {
            0.13
        };
        if row.text("status") != "ok"
            || row.num("segment_compression_n").abs() < 600.0
            || (mu - plain).abs() > 1e-9
        {
            continue;
        }
        let mut belt = belt_of(&row);
        belt.slip_bound = 1.0;
        let at = BeltAtRatio::new(&belt, row.num("ratio"));
        let l = load(
            row.num("input_speed_rpm"),
            row.num("output_torque_nm"),
            row.num("secondary_pressure_bar"),
            row.num("band_friction"),
        );
        let s = belt_state(&belt, &at, &l);
        let own = if s.tension.compression_n > 0.0 {
            at.geometry.primary_radius_m * at.geometry.primary_wrap_rad
        } else {
            at.geometry.secondary_radius_m * at.geometry.secondary_wrap_rad
        };
        // One segment more or less moves the idle arc by this share, and slip by as much.
        let idle = own / 1.46e-3 - row.num("active_segments");
        let tolerance = 2.0 / idle + 2.0 / row.num("active_segments") + 0.005;
        let want = row.num("slip_percent") / 100.0;
        // Gap and idle slip may nearly cancel: the tolerance belongs to the parts, not to their difference.
        let parts = (row.num("gap_slip_m_s").abs() + row.num("idle_slip_m_s").abs())
            / row.num("belt_speed_m_s");
        assert!(
            (s.losses.slip_total - want).abs() <= tolerance * (want.abs() + parts) + 5e-5,
            "case {} {}: slip {} instead of {want}",
            row.text("case"),
            row.text("formulation"),
            s.losses.slip_total
        );
        let want_loss = row.num("slip_loss_primary_nm") + row.num("slip_loss_secondary_nm");
        assert!(
            (s.losses.slip_nm - want_loss).abs() <= (tolerance + 0.02) * want_loss + 0.01,
            "case {}: loss {} instead of {want_loss}",
            row.text("case"),
            s.losses.slip_nm
        );
        sum2 += (s.losses.slip_total - want).powi(2);
        count += 1.0;
    }
    assert!(count > 500.0, "only {count} rows compared");
    let rms = (sum2 / count).sqrt();
    assert!(rms < 4e-4, "rms difference of slip {rms}");
}

/// Breakpoint C_x = 0 lies at T = R_s B in low ratio (closed form), 78.9 Nm at 30 bar and 2000 rpm.
#[test]
fn val_breakpoint() {
    let belt = thesis_belt(Formulation::Smooth);
    let at = BeltAtRatio::new(&belt, 2.416);
    let s = belt_state(&belt, &at, &load(2000.0, 78.9, 30.0, 0.13));
    assert!(
        s.tension.compression_n.abs() < 5.0,
        "{}",
        s.tension.compression_n
    );
}

/// Energy: input power minus output power is the sum of the losses, and no loss is negative, in drive and overrun, at every ratio.
#[test]
fn losses_are_positive_and_close() {
    let belt = thesis_belt(Formulation::Smooth);
    for i in 0..60 {
        let ratio = 0.4137 * (2.4169f64 / 0.4137).powf(f64::from(i) / 59.0);
        let at = BeltAtRatio::new(&belt, ratio);
        for j in -40..=40 {
            for rpm in [0.0, 100.0, 850.0, 3000.0, 6000.0] {
                let t = 5.0 * f64::from(j);
                let l = load(rpm, t, 20.0, 0.11);
                let s = belt_state(&belt, &at, &l);
                for x in [
                    s.losses.band_nm,
                    s.losses.film_nm,
                    s.losses.slip_nm,
                    s.losses.wedge_nm,
                    s.losses.penetration_nm,
                ] {
                    assert!(x >= 0.0 && x.is_finite(), "I {ratio} T {t}: {s:?}");
                }
                let w_in = l.primary_speed_rad_s;
                let w_out = w_in / ratio * (1.0 - s.losses.slip_total);
                let lost = s.input_torque_nm * w_in - t * w_out;
                assert!((lost - s.losses.sum_nm() * w_in).abs() < 1e-9 * (1.0 + lost.abs()));
            }
        }
    }
}

/// Continuity: the largest difference between neighbours nearly halves when the step is halved, across I = 1, C_x = 0, zero torque.
#[test]
fn continuous_in_ratio_and_torque() {
    let belt = thesis_belt(Formulation::Smooth);
    let at_ratio = |r: f64, t: f64| {
        let s = belt_state(
            &belt,
            &BeltAtRatio::new(&belt, r),
            &load(2000.0, t, 20.0, 0.13),
        );
        [
            s.losses.band_nm,
            s.losses.slip_nm,
            s.losses.wedge_nm,
            s.losses.penetration_nm,
            s.losses.slip_total,
        ]
    };
    let largest = |step: f64, from: f64, to: f64, f: &dyn Fn(f64) -> [f64; 5]| {
        let n = ((to - from) / step).round() as usize;
        let mut worst = [0.0f64; 5];
        let mut last = f(from);
        for i in 1..=n {
            let now = f(from + step * i as f64);
            for k in 0..5 {
                worst[k] = worst[k].max((now[k] - last[k]).abs());
            }
            last = now;
        }
        worst
    };
    for t in [-60.0, 0.0, 40.0] {
        let f = |r: f64| at_ratio(r, t);
        let (a, b) = (largest(1e-3, 0.42, 2.42, &f), largest(5e-4, 0.42, 2.42, &f));
        for k in 0..5 {
            assert!(
                b[k] <= 0.55 * a[k] + 1e-12,
                "ratio sweep at {t} Nm, part {k}: {} then {}",
                a[k],
                b[k]
            );
        }
    }
    for r in [0.45, 0.999, 1.0, 1.02, 2.4] {
        let f = |t: f64| at_ratio(r, t);
        let (a, b) = (
            largest(0.1, -300.0, 300.0, &f),
            largest(0.05, -300.0, 300.0, &f),
        );
        for k in 0..5 {
            assert!(
                b[k] <= 0.6 * a[k] + 1e-12,
                "torque sweep at {r}, part {k}: {} then {}",
                a[k],
                b[k]
            );
        }
    }
}

/// Dimension rescaling: forces x s2, lengths x s, stiffnesses unchanged in stress terms: torques scale with s3 at equal belt speed.
#[test]
fn band_loss_is_linear_in_friction_force_at_rest() {
    let belt = thesis_belt(Formulation::Smooth);
    let at = BeltAtRatio::new(&belt, 0.45);
    let a = belt_state(
        &belt,
        &at,
        &BeltLoad {
            secondary_clamp_n: 5000.0,
            ..load(0.0, 20.0, 1.0, 0.13)
        },
    );
    let b = belt_state(
        &belt,
        &at,
        &BeltLoad {
            secondary_clamp_n: 10000.0,
            ..load(0.0, 40.0, 1.0, 0.13)
        },
    );
    assert!(
        (b.losses.band_nm / a.losses.band_nm - 2.0).abs() < 1e-9,
        "{} {}",
        a.losses.band_nm,
        b.losses.band_nm
    );
}

/// Printed: no relative speed at I = 1 (8.3); loss grows with clamping force.
#[test]
fn val_no_band_loss_at_unity_and_monotone_in_clamp() {
    let belt = thesis_belt(Formulation::Smooth);
    let one = belt_state(
        &belt,
        &BeltAtRatio::new(&belt, 1.0),
        &load(2000.0, 30.0, 20.0, 0.13),
    );
    assert!(one.losses.band_nm.abs() < 1e-15);
    let mut last = 0.0;
    for bar in 5..40 {
        let s = belt_state(
            &belt,
            &BeltAtRatio::new(&belt, 0.45),
            &load(2000.0, 10.0, f64::from(bar), 0.13),
        );
        assert!(s.losses.sum_nm() > last);
        last = s.losses.sum_nm();
    }
}

/// The printed forms at every point of the tables that has a meaning: number of segments, tension, slip and each loss.
#[test]
fn val_golden_points_as_printed() {
    let mut all = golden();
    all.extend(rows(include_str!("../../../golden/belt_edge_points.csv")));
    let mut count = 0;
    for row in all.iter().filter(|row| row.text("status") == "ok") {
        let belt = Belt {
            stop_from_ratio: 9.0,
            stop_to_ratio: 10.0,
            ..belt_of(row)
        };
        let at = BeltAtRatio::new(&belt, row.num("ratio"));
        let load = BeltLoad {
            segment_friction: row.num("segment_friction"),
            ..load(
                row.num("input_speed_rpm"),
                row.num("output_torque_nm"),
                row.num("secondary_pressure_bar"),
                row.num("band_friction"),
            )
        };
        let got = belt_point(&belt, &at, &load);
        let [primary_slip, secondary_slip] = got.slip_m_s;
        for (name, number) in [
            ("segment_compression_n", got.tension.compression_n),
            ("band_tension_step_n", got.tension.step_n),
            ("active_segments", got.active_segments),
            ("gap_slip_m_s", got.gap_slip_m_s),
            ("idle_slip_m_s", got.idle_slip_m_s),
            ("primary_slip_m_s", primary_slip),
            ("secondary_slip_m_s", secondary_slip),
            ("band_loss_primary_nm", got.band_loss_nm[0]),
            ("band_loss_secondary_nm", got.band_loss_nm[1]),
            ("slip_loss_primary_nm", got.slip_loss_nm[0]),
            ("slip_loss_secondary_nm", got.slip_loss_nm[1]),
            ("wedge_loss_primary_nm", got.wedge_loss_nm[0]),
            ("wedge_loss_secondary_nm", got.wedge_loss_nm[1]),
            ("penetration_loss_primary_nm", got.penetration_loss_nm[0]),
            ("penetration_loss_secondary_nm", got.penetration_loss_nm[1]),
            ("belt_loss_nm", got.loss_nm),
        ] {
            let want = row.num(name);
            assert!(
                (number - want).abs() <= 1e-9 * (1.0 + want.abs()),
                "case {} {}: {name} is {number} instead of {want}",
                row.text("case"),
                row.text("formulation")
            );
            count += 1;
        }
    }
    assert_eq!(count, 16 * 1255);
}
