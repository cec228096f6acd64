//! Continuity across every change of regime, each swept on purpose.
//!
//! A jump keeps its size however short the step; a slope does not. So every pair of neighbours of a sweep is halved towards its larger
//! difference, up to 44 times for each value: what is left of it must be nothing. That finds also jumps that are small against the sweep's
//! largest difference. The largest difference itself must nearly halve with the step, as in tests/model/sweeps/continuity.rs.

use super::*;

const COUNT: usize = NAMES.len();
const HALVINGS: u32 = 44;

/// A jump: value, place, size.
#[derive(Debug)]
struct Jump {
    name: &'static str,
    x: f64,
    size: f64,
}

/// Follows the larger difference of one value; its size at last and where it lies.
fn descend(
    f: &dyn Fn(f64) -> [f64; COUNT],
    k: usize,
    mut a: (f64, f64),
    mut b: (f64, f64),
    done: f64,
) -> (f64, f64) {
    for _ in 0..HALVINGS {
        if (b.1 - a.1).abs() <= done {
            break;
        }
        let x = 0.5 * (a.0 + b.0);
        let middle = (x, f(x)[k]);
        if (middle.1 - a.1).abs() > (b.1 - middle.1).abs() {
            b = middle;
        } else {
            a = middle;
        }
    }
    ((b.1 - a.1).abs(), b.0)
}

/// All jumps of a sweep, and the largest difference of each value at this step.
fn jumps(f: &dyn Fn(f64) -> [f64; COUNT], from: f64, to: f64, n: u32) -> (Vec<Jump>, [f64; COUNT]) {
    let x = |i: u32| from + (to - from) * f64::from(i) / f64::from(n);
    let points: Vec<[f64; COUNT]> = (0..=n).map(|i| f(x(i))).collect();
    let (mut found, mut largest) = (Vec::new(), [0.0f64; COUNT]);
    for k in 0..COUNT {
        let scale = points.iter().fold(0.0f64, |s, v| s.max(v[k].abs()));
        let done = 1e-6 * scale + 1e-8;
        for i in 1..=n {
            let (a, b) = (points[i as usize - 1][k], points[i as usize][k]);
            largest[k] = largest[k].max((b - a).abs());
            let (size, place) = descend(f, k, (x(i - 1), a), (x(i), b), done);
            if size > done || !size.is_finite() {
                found.push(Jump {
                    name: NAMES[k],
                    x: place,
                    size,
                });
            }
        }
    }
    (found, largest)
}

/// A sweep in which a regime must change: `side` is true on one side of the change.
struct Sweep<'a> {
    name: String,
    belt: &'a Belt,
    point: &'a dyn Fn(f64) -> Point,
    range: (f64, f64),
    side: &'a dyn Fn(&BeltState, &Point) -> bool,
}

impl Sweep<'_> {
    fn check(&self) {
        let (from, to) = self.range;
        let n = 400;
        let state = |x: f64| (self.point)(x).state(self.belt);
        let on_side = (0..=n).filter(|i| {
            let x = from + (to - from) * f64::from(*i) / f64::from(n);
            (self.side)(&state(x), &(self.point)(x))
        });
        let on_side = on_side.count();
        assert!(
            0 < on_side && on_side < n as usize + 1,
            "{}: the sweep does not cross the change of regime ({on_side})",
            self.name
        );
        let f = |x: f64| values(&state(x));
        let (found, coarse) = jumps(&f, from, to, n);
        assert!(found.is_empty(), "{}: {found:?}", self.name);
        self.shrinks(&f, coarse, n);
    }

    /// Narrow stretches (unity, gross slip) are steep at first: each value's largest difference shrinks when they are resolved. What
    /// the branch weighs that SL-8 leaves out beyond 9 C0, 2e-8, is no jump.
    fn shrinks(&self, f: &dyn Fn(f64) -> [f64; COUNT], coarse: [f64; COUNT], n: u32) {
        let (mut last, mut smooth) = (coarse, [false; COUNT]);
        // The loss of slip is slip times torque (SL-11), and so is what SL-8 leaves out of it.
        let p = (self.point)(self.range.1);
        let per_slip_nm = (p.torque_nm / p.ratio).abs();
        let size = |k: usize| {
            coarse[k].max(if NAMES[k] == "slip loss" {
                per_slip_nm
            } else {
                0.0
            })
        };
        for k in 1..=9 {
            let now = largest(f, self.range.0, self.range.1, n << k);
            for k in 0..COUNT {
                smooth[k] |= now[k] <= 0.6 * last[k] + 1e-8 * size(k).max(1.0);
            }
            if smooth.iter().all(|s| *s) {
                return;
            }
            last = now;
        }
        panic!(
            "{}: of {NAMES:?} only {smooth:?} shrink with the step, last {last:?}",
            self.name
        );
    }
}

fn largest(f: &dyn Fn(f64) -> [f64; COUNT], from: f64, to: f64, n: u32) -> [f64; COUNT] {
    let (mut worst, mut last) = ([0.0f64; COUNT], f(from));
    for i in 1..=n {
        let now = f(from + (to - from) * f64::from(i) / f64::from(n));
        for k in 0..COUNT {
            worst[k] = worst[k].max((now[k] - last[k]).abs());
        }
        last = now;
    }
    worst
}

/// Torque, clamp and speed of the sweeps: coasting, no load, part load, near and beyond the capacity of a weak clamp.
const LOADS: [(f64, f64, f64); 6] = [
    (-60.0, 10e3, 2000.0),
    (0.0, 10e3, 0.0),
    (0.0, 20e3, 4000.0),
    (40.0, 20e3, 2000.0),
    (150.0, 35e3, 6500.0),
    (120.0, 6e3, 2500.0),
];
/// Ratios: both ends, unity and its neighbours, the stop's ramp.
const RATIOS: [f64; 9] = [0.4137, 0.5, 0.9, 0.999, 1.0, 1.004, 1.5, 2.35, 2.4169];

#[test]
fn across_unity_and_the_end_stop() {
    let belt = thesis_belt(Formulation::Smooth);
    for (torque_nm, clamp_n, rpm) in LOADS {
        for (at, (from, to)) in [
            (1.0, (0.9, 1.1)),
            (2.30, (2.25, 2.35)),
            (2.417, (2.38, 2.46)),
            (1.2, (0.35, 3.0)),
        ] {
            let point = |ratio: f64| Point {
                torque_nm,
                clamp_n,
                rpm,
                ..Point::plain(ratio)
            };
            let name = format!("ratio across {at} at {torque_nm} Nm, {clamp_n} N, {rpm} rpm");
            Sweep {
                name,
                belt: &belt,
                point: &point,
                range: (from, to),
                side: &|_, p| p.ratio < at,
            }
            .check();
        }
    }
}

/// Segment compression changes struts; also by clamping and by ratio, and together with the other changes.
#[test]
fn across_the_breakpoint() {
    let belt = thesis_belt(Formulation::Smooth);
    for ratio in RATIOS {
        for (_, clamp_n, rpm) in LOADS {
            let plain = Point {
                clamp_n,
                rpm,
                ..Point::plain(ratio)
            };
            let middle = plain.breakpoint_nm(&belt);
            let point = |t: f64| Point {
                torque_nm: middle + t,
                ..plain
            };
            let name = format!("torque across C_x = 0 at ratio {ratio}, {clamp_n} N, {rpm} rpm");
            Sweep {
                name,
                belt: &belt,
                point: &point,
                range: (-31.0, 30.0),
                side: &|s, _| s.tension.compression_n < 0.0,
            }
            .check();
        }
    }
    let by_clamp = |clamp_n: f64| Point {
        clamp_n,
        torque_nm: 60.0,
        ..Point::plain(2.2)
    };
    let below = |s: &BeltState, _: &Point| s.tension.compression_n < 0.0;
    Sweep {
        name: "clamp across C_x = 0".into(),
        belt: &belt,
        point: &by_clamp,
        range: (10e3, 50e3),
        side: &below,
    }
    .check();
    let by_friction = |mu_band: f64| Point {
        mu_band,
        torque_nm: 60.0,
        ..Point::plain(2.2)
    };
    Sweep {
        name: "band friction across C_x = 0".into(),
        belt: &belt,
        point: &by_friction,
        range: (0.0, 0.2),
        side: &below,
    }
    .check();
}

#[test]
fn across_zero_torque_from_overrun_to_drive() {
    let belt = thesis_belt(Formulation::Smooth);
    for ratio in RATIOS {
        for (_, clamp_n, rpm) in LOADS {
            let point = |torque_nm: f64| Point {
                torque_nm,
                clamp_n,
                rpm,
                ..Point::plain(ratio)
            };
            let side = |_: &BeltState, p: &Point| p.torque_nm < 0.0;
            let name = format!("torque across zero at ratio {ratio}, {clamp_n} N, {rpm} rpm");
            Sweep {
                name,
                belt: &belt,
                point: &point,
                range: (-40.0, 41.0),
                side: &side,
            }
            .check();
        }
    }
}

#[test]
fn across_standstill() {
    let belt = thesis_belt(Formulation::Smooth);
    for ratio in [0.4137, 0.999, 1.0, 2.35, 2.4169] {
        for (torque_nm, clamp_n, _) in LOADS {
            let point = |rpm: f64| Point {
                torque_nm,
                clamp_n,
                rpm,
                ..Point::plain(ratio)
            };
            for range in [(-10.0, 11.0), (-1000.0, 7000.0)] {
                let name = format!(
                    "speed across standstill at ratio {ratio}, {torque_nm} Nm, {clamp_n} N"
                );
                Sweep {
                    name,
                    belt: &belt,
                    point: &point,
                    range,
                    side: &|_, p| p.rpm < 0.0,
                }
                .check();
            }
        }
    }
}

/// Torque over the capacity and the bound of slip, in both directions; clamping from nothing; segment friction.
#[test]
fn into_gross_slip() {
    let belt = thesis_belt(Formulation::Smooth);
    let slips = |s: &BeltState, _: &Point| s.losses.gross_slip;
    let held = |s: &BeltState, _: &Point| s.slip.held;
    for ratio in RATIOS {
        for (clamp_n, rpm) in [(750.0, 0.0), (6e3, 2000.0), (20e3, 6000.0)] {
            let point = |torque_nm: f64| Point {
                torque_nm,
                clamp_n,
                rpm,
                ..Point::plain(ratio)
            };
            let capacity = point(0.0).state(&belt).losses.capacity_nm;
            for (name, reach, side) in [
                (
                    "over capacity",
                    1.2 * capacity,
                    &slips as &dyn Fn(&BeltState, &Point) -> bool,
                ),
                ("over the bound of slip", 3.0 * capacity + 300.0, &held),
            ] {
                let name = format!("torque {name} at ratio {ratio}, {clamp_n} N, {rpm} rpm");
                Sweep {
                    name,
                    belt: &belt,
                    point: &point,
                    range: (-reach, reach),
                    side,
                }
                .check();
            }
        }
        for torque_nm in [-50.0, 100.0] {
            let point = |clamp_n: f64| Point {
                torque_nm,
                clamp_n,
                ..Point::plain(ratio)
            };
            let name = format!("clamp from nothing at ratio {ratio}, {torque_nm} Nm");
            Sweep {
                name,
                belt: &belt,
                point: &point,
                range: (0.0, 50e3),
                side: &held,
            }
            .check();
            let point = |mu_segment: f64| Point {
                torque_nm,
                clamp_n: 8e3,
                mu_segment,
                ..Point::plain(ratio)
            };
            let name = format!("segment friction from nothing at ratio {ratio}, {torque_nm} Nm");
            Sweep {
                name,
                belt: &belt,
                point: &point,
                range: (0.0, 0.2),
                side: &held,
            }
            .check();
        }
    }
}

/// The contact area of segments is held beyond its maximum at 4492 N (SL-3), with a clamp that does not slip there.
#[test]
fn across_the_held_contact_area() {
    let belt = thesis_belt(Formulation::Smooth);
    for ratio in [0.4137, 0.7, 1.0, 1.5, 2.4169] {
        for sign in [1.0, -1.0] {
            let radius = BeltAtRatio::new(&belt, ratio).geometry.secondary_radius_m;
            let plain = Point {
                clamp_n: 45e3,
                ..Point::plain(ratio)
            };
            let middle = plain.breakpoint_nm(&belt);
            let point = |cx: f64| Point {
                torque_nm: middle + sign * cx * radius,
                ..plain
            };
            let side = |s: &BeltState, _: &Point| s.tension.compression_n.abs() < 4492.0;
            let name = format!("C_x across 4492 N at ratio {ratio}, sign {sign}");
            Sweep {
                name,
                belt: &belt,
                point: &point,
                range: (2000.0, 9000.0),
                side: &side,
            }
            .check();
        }
    }
}

/// The thesis's two readings lift |C_x| below 30 N (a row of their table, so it stays in `run`): slip jumps there, and nothing else
/// jumps and nowhere else. AppendixC lifts to +30 N, so it jumps at -30 N; Chapter8 keeps the sign, so it jumps at zero.
#[test]
fn thesis_readings_jump_only_at_their_printed_limit_of_compression() {
    for (f, place_n) in [
        (Formulation::AppendixC, -30.0),
        (Formulation::Chapter8, 0.0),
    ] {
        let belt = thesis_belt(f);
        let mut seen = 0;
        for ratio in RATIOS {
            for (torque_nm, clamp_n, rpm) in LOADS {
                let by_torque = |torque_nm: f64| Point {
                    torque_nm,
                    clamp_n,
                    rpm,
                    ..Point::plain(ratio)
                };
                let by_ratio = |r: f64| Point {
                    torque_nm,
                    clamp_n,
                    rpm,
                    ..Point::plain(r)
                };
                let by_clamp = |clamp_n: f64| Point {
                    torque_nm,
                    clamp_n,
                    rpm,
                    ..Point::plain(ratio)
                };
                let sweeps = [
                    (&by_torque as &dyn Fn(f64) -> Point, -300.0, 301.0),
                    (&by_ratio, 0.35, 3.0),
                    (&by_clamp, 0.0, 50e3),
                ];
                for (point, from, to) in sweeps {
                    for jump in jumps(&|x| values(&point(x).state(&belt)), from, to, 150).0 {
                        let p = point(jump.x);
                        let cx = p.state(&belt).tension.compression_n;
                        assert!(
                            (cx - place_n).abs() < 0.1,
                            "{f:?} {} jumps by {} at C_x = {cx}: {p:?}",
                            jump.name,
                            jump.size
                        );
                        assert!(
                            [
                                "slip loss",
                                "slip",
                                "primary slip",
                                "secondary slip",
                                "input torque"
                            ]
                            .contains(&jump.name),
                            "{jump:?}"
                        );
                        seen += 1;
                    }
                }
            }
        }
        assert!(
            seen > 20,
            "{f:?}: the limit of compression shows {seen} times"
        );
    }
}
