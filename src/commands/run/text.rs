//! A run as tables for people.

use cvtcycle::config::cycle::Cycle;
use cvtcycle::output::Component;
use cvtcycle::output::summary::{Comparison, RunSummary, StartWord, Summary};

use crate::print::colour::Paint;
use crate::print::grid::{Grid, WIDTH};
use cvtcycle::output::number::{NONE, fixed, percent, plain, signed, tiny};

/// Widths of the two leading columns, so that the tables stand under each other.
const LEAD: [usize; 2] = [22, 8];

/// Everything that a person wants to see of a run.
pub fn tables(summary: &Summary, cycle: &Cycle, paint: Paint) -> String {
    let mut text = head(summary, cycle, paint);
    let tables = [
        ("Fuel", fuel(summary)),
        ("Transmission losses", losses(summary)),
        ("Where the fuel energy went", balance(summary)),
        ("End temperatures", ends(summary)),
        ("Time with", flags(summary)),
    ];
    for (title, body) in tables {
        text += &format!("\n{}\n{body}", paint.heading(title));
        if title == "Fuel" {
            text.extend(summary.comparison.iter().map(|c| compared(summary, c)));
        }
    }
    text += &notes(summary);
    text.extend(failures(summary).iter().map(|line| paint.bad(line) + "\n"));
    text
}

fn head(summary: &Summary, cycle: &Cycle, paint: Paint) -> String {
    let start = match &summary.start {
        StartWord::Word(word) if word == "warm" => {
            "start warm: the same cycle has just been driven from a soak".to_owned()
        }
        StartWord::Word(_) => "start soaked at ambient".to_owned(),
        StartWord::Degc(degc) => format!("start with everything at {} degC", plain(*degc)),
    };
    let mut text = format!("{}  {}\n", paint.heading(&summary.cycle), cycle.title);
    text += &format!("ambient {} degC, {start}\n", plain(summary.ambient_degc));
    let settings = &summary.settings;
    let steps = format!(
        "steps of {} s, belt model {}",
        plain(settings.dt_s),
        settings.formulation
    );
    text += &format!("{steps}\n");
    for (option, list) in [("--set", &settings.set), ("--set-all", &settings.set_all)] {
        text.extend(list.iter().map(|set| format!("{option} {set}\n")));
    }
    let mut grid = Grid::new("lll");
    for run in &summary.runs {
        grid.row([run.role.as_str(), &run.vehicle, &run.title]);
        grid.row([
            "",
            "",
            &format!("oils {}, {}", run.lubricant, run.engine_oil),
        ]);
    }
    text + "\n" + &grid.text()
}

fn grid(summary: &Summary) -> Grid {
    let mut grid = Grid::new(&("ll".to_owned() + &"r".repeat(summary.runs.len())));
    let names = summary.runs.iter().map(|run| run.vehicle.as_str());
    grid.row(["", ""].into_iter().chain(names));
    grid
}

/// A row of one number a car.
fn add(
    grid: &mut Grid,
    runs: &[RunSummary],
    name: &str,
    unit: &str,
    cell: impl Fn(&RunSummary) -> String,
) {
    grid.row(
        [name.to_owned(), unit.to_owned()]
            .into_iter()
            .chain(runs.iter().map(cell)),
    );
}

fn fuel(summary: &Summary) -> String {
    let runs = &summary.runs;
    let mut grid = grid(summary);
    let groups = runs.first().map_or(&[][..], |run| &run.phases);
    if groups.len() > 1 {
        for (k, group) in groups.iter().enumerate() {
            add(&mut grid, runs, &group.name, "L/100 km", |run| {
                fixed(run.phases.get(k).and_then(|p| p.fuel_l_per_100km), 2)
            });
        }
    }
    add(&mut grid, runs, "total", "L/100 km", |run| {
        fixed(run.fuel_l_per_100km, 2)
    });
    if runs
        .iter()
        .any(|run| run.weighted_fuel_l_per_100km.is_some())
    {
        add(&mut grid, runs, "weighted 0.43 / 0.57", "L/100 km", |run| {
            fixed(run.weighted_fuel_l_per_100km, 2)
        });
        add(&mut grid, runs, "", "CO2 g/km", |run| {
            fixed(run.weighted_co2_g_per_km, 1)
        });
    }
    add(&mut grid, runs, "", "mpg (UK)", |run| fixed(run.mpg_uk, 1));
    add(&mut grid, runs, "", "mpg (US)", |run| fixed(run.mpg_us, 1));
    add(&mut grid, runs, "CO2, total", "g/km", |run| {
        fixed(run.co2_g_per_km, 1)
    });
    add(&mut grid, runs, "driven distance", "km", |run| {
        fixed(run.distance_km, 3)
    });
    add(&mut grid, runs, "fuel at standstill", "% fuel", |run| {
        percent(run.standstill_fuel_g, run.fuel_kg * 1e3, 1)
    });
    grid.text_with_widths(&LEAD)
}

/// "CVT uses 5.2 % more than that one".
fn compared(summary: &Summary, comparison: &Comparison) -> String {
    let subject = summary.runs.first().map_or("", |run| &run.vehicle);
    let Some(difference) = comparison.fuel_percent else {
        return String::new();
    };
    let (size, word) = (
        fixed(difference.abs(), 1),
        if difference < 0.0 { "less" } else { "more" },
    );
    let mut line = format!(
        "{subject} uses {size} % {word} fuel than {}",
        comparison.baseline
    );
    let parts: Vec<String> = comparison
        .phases_percent
        .iter()
        .filter(|(_, x)| x.is_some())
        .map(|(name, x)| format!("{name} {} %", signed(x, 1)))
        .collect();
    if parts.len() > 1 {
        let detail = format!("({})", parts.join(", "));
        let fits = line.len() + detail.len() < usize::from(WIDTH);
        line += &format!("{}{detail}", if fits { " " } else { "\n  " });
    }
    line + "\n"
}

fn kj_and_share(kj: Option<f64>, run: &RunSummary) -> String {
    match kj {
        Some(_) => format!(
            "{:>7} {:>7}",
            fixed(kj, 1),
            percent(kj, run.fuel_energy_kj, 1)
        ),
        None => NONE.to_owned(),
    }
}

fn losses(summary: &Summary) -> String {
    let runs = &summary.runs;
    let mut grid = grid(summary);
    add(&mut grid, runs, "", "", |_| "kJ  % fuel".into());
    for component in Component::ALL {
        let name = component.name();
        let of = |run: &RunSummary| {
            run.loss_kj
                .0
                .iter()
                .find(|(other, _)| other == name)
                .map(|(_, kj)| *kj)
        };
        if runs.iter().any(|run| of(run).is_some()) {
            add(&mut grid, runs, &name.replace('_', " "), "", |run| {
                of(run).map_or_else(String::new, |kj| kj_and_share(kj, run))
            });
        }
    }
    add(&mut grid, runs, "transmission in all", "", |run| {
        kj_and_share(Some(run.transmission_loss_kj()), run)
    });
    for name in ["accessories", "brake"] {
        add(&mut grid, runs, name, "", |run| {
            kj_and_share(run.loss_kj.get(name), run)
        });
    }
    grid.text_with_widths(&[LEAD[0]])
}

/// Terms of the power ledger in words, in the order in which they are shown.
const WHERE: [(&str, &str); 7] = [
    ("wheels", "rolling and air (net)"),
    ("brake", "brakes"),
    ("losses", "transmission"),
    ("accessories", "accessories"),
    ("engine_heat", "heat to the engine"),
    ("exhaust", "exhaust"),
    ("kinetic", "rotating parts"),
];

fn balance(summary: &Summary) -> String {
    let runs = &summary.runs;
    let mut grid = grid(summary);
    for (term, words) in WHERE {
        let share = |run: &RunSummary| percent(run.ledger_kj.get(term), run.fuel_energy_kj, 1);
        // Nobody needs a row of zeros; what rounds to zero is in the JSON.
        if term != "kinetic" || runs.iter().any(|run| share(run) != "0.0") {
            add(&mut grid, runs, words, "% fuel", share);
        }
    }
    add(&mut grid, runs, "fuel energy", "kJ", |run| {
        fixed(run.fuel_energy_kj, 0)
    });
    grid.text_with_widths(&LEAD)
}

fn ends(summary: &Summary) -> String {
    let runs = &summary.runs;
    let mut grid = grid(summary);
    let names: Vec<&str> = runs
        .first()
        .map(|run| run.end_degc.iter().map(|(name, _)| name).collect())
        .unwrap_or_default();
    for name in names {
        if runs.iter().any(|run| run.end_degc.get(name).is_some()) {
            add(&mut grid, runs, &name.replace('_', " "), "degC", |run| {
                fixed(run.end_degc.get(name), 1)
            });
        }
    }
    grid.text_with_widths(&LEAD)
}

fn flags(summary: &Summary) -> String {
    let runs = &summary.runs;
    let mut grid = grid(summary);
    let names: Vec<&str> = runs
        .first()
        .map(|run| run.flags_s.iter().map(|(name, _)| name).collect())
        .unwrap_or_default();
    let seconds = |run: &RunSummary, name: &str| run.flags_s.get(name).filter(|s| *s > 0.0);
    for name in names {
        if runs.iter().any(|run| seconds(run, name).is_some()) {
            add(&mut grid, runs, name, "s", |run| {
                seconds(run, name).map_or_else(|| NONE.to_owned(), |s| fixed(s, 1))
            });
        }
    }
    grid.text_with_widths(&LEAD)
}

fn notes(summary: &Summary) -> String {
    let mut text = "\n".to_owned();
    for run in &summary.runs {
        if let Some(schedule) = &run.gear_schedule {
            text += &format!("{}: {schedule}\n", run.vehicle);
        }
        if let Some(safety) = run.min_clamp_safety {
            text += &format!(
                "{}: smallest clamp safety factor {}\n",
                run.vehicle,
                fixed(safety, 2)
            );
        }
    }
    let worst = |of: fn(&RunSummary) -> Option<f64>| {
        let all: Option<Vec<f64>> = summary.runs.iter().map(of).collect();
        tiny(all.and_then(|all| all.into_iter().reduce(|a, b| if b > a { b } else { a })))
    };
    let (row, whole) = (
        worst(|run| run.ledger_error),
        worst(|run| run.run_ledger_error),
    );
    text + &format!("energy ledgers close to {row} in the worst row, to {whole} over the run\n")
}

/// One line for every check that failed.
pub fn failures(summary: &Summary) -> Vec<String> {
    summary
        .runs
        .iter()
        .flat_map(|run| run.failed_checks.iter().map(|check| failure(run, check)))
        .collect()
}

fn failure(run: &RunSummary, check: &str) -> String {
    let seconds = fixed(run.flags_s.get(check), 1);
    let what = match check {
        "missed_trace" => {
            let worst = run.worst_deficit.as_ref().map(|d| {
                let torque = d
                    .wheel_torque_nm
                    .map(|nm| format!(" or {} Nm at the wheels", fixed(nm, 0)))
                    .unwrap_or_default();
                format!(
                    ", worst at {} s in {}: {} kW{torque} missing",
                    fixed(d.at_s, 1),
                    d.phase,
                    fixed(d.power_w / 1e3, 1)
                )
            });
            format!(
                "misses the trace for {seconds} s{}",
                worst.unwrap_or_default()
            )
        }
        "ledger_error" => {
            format!(
                "energy does not balance: worst row {}, run {}",
                tiny(run.ledger_error),
                tiny(run.run_ledger_error)
            )
        }
        flag => format!("{flag} for {seconds} s"),
    };
    format!("check failed: {} {what}", run.vehicle)
}
