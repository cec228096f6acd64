//! Figures of the belt.

use super::reference::{At, HIGH, LOW, RPM, Reference};
use super::{Line, LinePanel, axes, plot, sweep};
use cvtcycle::model::lubricant::{BandFriction, ZERO_DEGC_K};
use cvtcycle::model::transmission::cvt::variator::{
    Belt, BeltState, Formulation, Geometry, sliding_speed_m_s,
};

const TORQUE: &str = "Output torque at the secondary [Nm]";
const LOSS: &str = "Loss at the primary shaft [Nm]";
const LOW_AT: At = At {
    ratio: LOW,
    rpm: 2000.0,
    output_nm: 0.0,
    bar: 30.0,
};
const HIGH_AT: At = At {
    ratio: HIGH,
    rpm: 3000.0,
    output_nm: 0.0,
    bar: 11.0,
};

/// Figures by file name.
pub fn figures(r: &Reference) -> Vec<(&'static str, String)> {
    vec![
        ("belt_losses", losses(r)),
        ("geometry_curves", geometry(r)),
        ("tension_torque", tension(r)),
        ("bands_ratio", bands(r)),
        ("film_friction", film(r)),
        ("film_loss", film_loss(r)),
        ("slip_torque", slip(r)),
        ("deflection_pressure", deflection(r)),
        ("formulations_torque", formulations(r)),
    ]
}

/// Results of the belt over output torque.
fn over_torque(
    r: &Reference,
    belt: &Belt,
    name: &str,
    at: At,
    to: f64,
    part: impl Fn(&BeltState) -> f64,
) -> Line {
    sweep(name, 0.0, to, 160, |t| {
        part(&r.boundary(belt, At { output_nm: t, ..at }))
    })
}

fn losses(r: &Reference) -> String {
    let belt = r.belt(Formulation::Smooth);
    let panel = |heading: &str, at: At, to: f64| {
        let line =
            |name: &str, part: fn(&BeltState) -> f64| over_torque(r, &belt, name, at, to, part);
        let lines = vec![
            line("all of the belt", |s| s.losses.sum_nm()),
            line("bands", |s| s.losses.band_nm),
            line("slip", |s| s.losses.slip_nm),
            line("wedging", |s| s.losses.wedge_nm),
            line("penetration", |s| s.losses.penetration_nm),
        ];
        axes(heading, TORQUE, LOSS, lines)
    };
    plot(
        "Belt losses against torque",
        "formulation smooth, belt at 85 degC, boundary friction",
        "Loss torque of bands, slip, wedging and penetration and their sum against output torque in low and high ratio.",
        "",
        vec![
            panel("I = 2.417, 2000 rpm, 30 bar", LOW_AT, 200.0),
            panel("I = 0.5, 3000 rpm, 11 bar", HIGH_AT, 60.0),
        ],
    )
}

fn geometry(r: &Reference) -> String {
    let (x, l) = (r.cvt().belt.centre_distance_m, r.cvt().belt.length_m);
    let line = |name: &str, part: fn(&Geometry) -> f64| {
        let (from, to) = (r.cvt().ratio.high, r.cvt().ratio.low);
        sweep(name, from, to, 120, |i| part(&Geometry::new(i, x, l)))
    };
    let radii = vec![
        line("primary", |g| 1e3 * g.primary_radius_m),
        line("secondary", |g| 1e3 * g.secondary_radius_m),
    ];
    let wraps = vec![
        line("primary", |g| g.primary_wrap_rad.to_degrees()),
        line("secondary", |g| g.secondary_wrap_rad.to_degrees()),
    ];
    let ratio = "Belt ratio I [-]";
    plot(
        "Radii and wrap angles",
        "belt of the Rover, centre distance 155 mm, length 648.6 mm",
        "Running radii and wrap angles of both pulleys over the belt ratio.",
        "",
        vec![
            axes(
                "Running radius at the rocking edge",
                ratio,
                "Radius [mm]",
                radii,
            ),
            LinePanel {
                with_y: vec![],
                ..axes("Wrap angle", ratio, "Angle [deg]", wraps)
            },
        ],
    )
}

fn tension(r: &Reference) -> String {
    let belt = r.belt(Formulation::Smooth);
    let panel = |heading: &str, at: At, to: f64| {
        let at_ratio = Geometry::new(at.ratio, belt.centre_distance_m, belt.length_m);
        let lines = vec![
            over_torque(r, &belt, "segment compression", at, to, |s| {
                s.tension.compression_n
            }),
            over_torque(r, &belt, "tension step", at, to, |s| s.tension.step_n),
            over_torque(r, &belt, "mean band tension", at, to, |s| {
                s.tension.mean_tension_n(&at_ratio)
            }),
        ];
        axes(heading, TORQUE, "Force [N]", lines)
    };
    plot(
        "Forces in the belt against torque",
        "formulation smooth, band friction 0.13",
        "Segment compression, tension step and mean band tension against output torque; compression crosses zero in low ratio.",
        "",
        vec![
            panel("I = 2.417, 2000 rpm, 30 bar", LOW_AT, 200.0),
            panel("I = 0.5, 3000 rpm, 11 bar", HIGH_AT, 60.0),
        ],
    )
}

fn bands(r: &Reference) -> String {
    let (high, low) = (r.cvt().ratio.high, r.cvt().ratio.low);
    let line = |mm: f64| {
        let belt = Belt {
            band_offset_m: mm * 1e-3,
            ..r.belt(Formulation::Smooth)
        };
        let at = |ratio: f64| At {
            ratio,
            rpm: 2500.0,
            output_nm: 20.0,
            bar: 20.0,
        };
        sweep(&format!("offset {mm} mm"), high, low, 300, |i| {
            r.boundary(&belt, at(i)).losses.band_nm
        })
    };
    plot(
        "Band loss against ratio",
        "2500 rpm, 20 bar, 20 Nm at the secondary, boundary friction",
        "Loss torque of the bands against belt ratio for three band offsets; zero at ratio one.",
        "",
        vec![axes(
            "",
            "Belt ratio I [-]",
            LOSS,
            vec![line(3.0), line(2.0), line(1.0)],
        )],
    )
}

/// Speeds in the figures of the film, rpm.
const SPEEDS: [f64; 3] = [1000.0, 2000.0, 4000.0];

fn film_friction(r: &Reference, belt: &Belt, ratio: f64, rpm: f64, degc: f64) -> BandFriction {
    let k = degc + ZERO_DEGC_K;
    r.oil().friction.band(
        k,
        r.oil().dynamic_pa_s(k),
        sliding_speed_m_s(belt, ratio, rpm * RPM),
    )
}

fn film(r: &Reference) -> String {
    let belt = r.belt(Formulation::Smooth);
    let mu = |ratio: f64, rpm: f64| {
        sweep(&format!("{rpm:.0} rpm"), -20.0, 120.0, 140, |t| {
            let band = film_friction(r, &belt, ratio, rpm, t);
            band.mu * (1.0 - band.film_share[0])
        })
    };
    let panel = |heading: &str, ratio: f64| {
        axes(
            heading,
            "Belt temperature [degC]",
            "Coefficient of band friction [-]",
            SPEEDS.map(|n| mu(ratio, n)).to_vec(),
        )
    };
    plot(
        "Band friction with the oil film",
        "fluid of the Rover, LU-4 as shipped",
        "Coefficient of band friction against belt temperature at three speeds, in low and high ratio.",
        "",
        vec![panel("I = 2.417", LOW), panel("I = 0.5", HIGH)],
    )
}

fn film_loss(r: &Reference) -> String {
    let belt = r.belt(Formulation::Smooth);
    let loss = |ratio: f64, bar: f64, rpm: f64| {
        sweep(&format!("{rpm:.0} rpm"), -20.0, 120.0, 140, |t| {
            let band = film_friction(r, &belt, ratio, rpm, t);
            let s = r.with_friction(
                &belt,
                At {
                    ratio,
                    rpm,
                    output_nm: 0.0,
                    bar,
                },
                band,
            );
            s.losses.band_nm + s.losses.film_nm
        })
    };
    let panel = |heading: &str, ratio: f64, bar: f64| {
        axes(
            heading,
            "Belt temperature [degC]",
            LOSS,
            SPEEDS.map(|n| loss(ratio, bar, n)).to_vec(),
        )
    };
    plot(
        "Loss of bands and film",
        "no torque; LU-4 and FI-1 as shipped",
        "Sum of band and film loss against belt temperature at three speeds, in low ratio at 30 bar and in high ratio at 11 bar.",
        "",
        vec![
            panel("I = 2.417, 30 bar", LOW, 30.0),
            panel("I = 0.5, 11 bar", HIGH, 11.0),
        ],
    )
}

fn slip(r: &Reference) -> String {
    let belt = r.belt(Formulation::Smooth);
    let line = |ratio: f64, bar: f64, to: f64| {
        let at = At {
            ratio,
            rpm: 2000.0,
            output_nm: 0.0,
            bar,
        };
        let mut line = over_torque(r, &belt, &format!("{bar:.0} bar"), at, to, |s| {
            100.0 * s.losses.slip_total
        });
        // Values beyond capacity are clamped and not drawn.
        line.points.retain(|&(t, slip)| {
            slip < 6.0
                && !r
                    .boundary(&belt, At { output_nm: t, ..at })
                    .losses
                    .gross_slip
        });
        line
    };
    let low = [15.0, 20.0, 25.0, 30.0, 35.0]
        .map(|bar| line(LOW, bar, 250.0))
        .to_vec();
    let high = [10.0, 12.0].map(|bar| line(HIGH, bar, 90.0)).to_vec();
    let y = "Slip of both pulleys [%]";
    plot(
        "Slip against torque",
        "2000 rpm, band friction 0.13, segment friction 0.125; ends where slip is gross or above 6 %",
        "Total slip against output torque at several secondary pressures in low and high ratio.",
        "",
        vec![
            axes("I = 2.417", TORQUE, y, low),
            axes("I = 0.5", TORQUE, y, high),
        ],
    )
}

fn deflection(r: &Reference) -> String {
    let belt = r.belt(Formulation::Smooth);
    // Without an end stop within reach the primary deflects at low ratio as elsewhere.
    let free = Belt {
        stop_from_ratio: 9.0,
        stop_to_ratio: 10.0,
        ..belt.clone()
    };
    let line = |name: &str, belt: &Belt, ratio: f64, part: fn(&BeltState) -> f64| {
        let at = At {
            ratio,
            rpm: 2000.0,
            output_nm: 0.0,
            bar: 0.0,
        };
        sweep(name, 5.0, 40.0, 70, |bar| {
            part(&r.boundary(belt, At { bar, ..at }))
        })
    };
    let lines = |ratio: f64| {
        vec![
            line("wedging", &belt, ratio, |s| s.losses.wedge_nm),
            line("penetration", &belt, ratio, |s| s.losses.penetration_nm),
        ]
    };
    let mut low = lines(LOW);
    low.push(line("wedging without end stop", &free, LOW, |s| {
        s.losses.wedge_nm
    }));
    low.push(line("penetration without end stop", &free, LOW, |s| {
        s.losses.penetration_nm
    }));
    let x = "Secondary pressure [bar]";
    plot(
        "Losses of pulley deflection against pressure",
        "formulation smooth; independent of speed and torque",
        "Wedge and penetration loss of both pulleys against secondary pressure, in low ratio with and without the primary's end stop and in high ratio.",
        "",
        vec![
            axes("I = 2.417", x, LOSS, low),
            axes("I = 0.5", x, LOSS, lines(HIGH)),
        ],
    )
}

fn formulations(r: &Reference) -> String {
    let all = Formulation::NAMES.map(|(name, f)| (name, r.belt(f)));
    let smooth = r.belt(Formulation::Smooth);
    let lines = |at: At, to: f64, less: bool| -> Vec<Line> {
        let curve = |(name, belt): &(&'static str, Belt)| {
            sweep(name, 0.0, to, 160, |output_nm| {
                let at = At { output_nm, ..at };
                let loss_nm = |belt: &Belt| r.boundary(belt, at).losses.sum_nm();
                loss_nm(belt) - if less { loss_nm(&smooth) } else { 0.0 }
            })
        };
        all.iter().map(curve).collect()
    };
    let high = At {
        rpm: 4000.0,
        ..HIGH_AT
    };
    let (low_words, high_words) = ("I = 2.417, 2000 rpm, 30 bar", "I = 0.5, 4000 rpm, 11 bar");
    let less = "Loss less that of smooth [Nm]";
    plot(
        "Belt loss in the three readings",
        "under the rules of driving (TE-6, SL-8, real segment count), boundary friction",
        "Belt loss against output torque in the formulations smooth, appendix_c and chapter_8, in low and high ratio, and what each has more than smooth.",
        "",
        vec![
            axes(low_words, TORQUE, LOSS, lines(LOW_AT, 200.0, false)),
            axes(high_words, TORQUE, LOSS, lines(high, 60.0, false)),
            axes("", TORQUE, less, lines(LOW_AT, 200.0, true)),
            axes("", TORQUE, less, lines(high, 60.0, true)),
        ],
    )
}
