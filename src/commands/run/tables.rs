//! The summary of a run as tables.

use cvtcycle::analysis::words::between;
use cvtcycle::analysis::words::run::{DOUBT, sentences};
use cvtcycle::config::cycle::Cycle;
use cvtcycle::output::Component;
use cvtcycle::output::number::{NONE, fixed, percent, plain, signed, tiny};
use cvtcycle::output::summary::{Comparison, Over, PhaseSummary, RunSummary, StartWord, Summary};
use cvtcycle::output::table::{TextTable, paragraphs, wrapped};

use super::losses::{loss_words, priced_losses};
use crate::print::colour::Paint;
use crate::print::{bold, sections};

/// Widths of the two leading columns, which align the tables.
const LEAD: [usize; 2] = [22, 8];

/// Prints all results.
pub fn tables(summary: &Summary, cycle: &Cycle, paint: Paint) -> String {
    let comparisons = summary.comparison.iter().map(compared);
    let text = |title: &str, body: String| (title.to_owned(), body);
    let body = [
        text("Fuel", fuel(summary) + &comparisons.collect::<String>()),
        losses(summary),
        text("Where the fuel energy went", balance(summary)),
        text("End temperatures", ends(summary)),
        text("Time with", flags(summary)),
    ];
    answers(summary, paint)
        + &head(summary, cycle, paint)
        + &sections(body, paint)
        + &notes(summary)
}

fn head(summary: &Summary, cycle: &Cycle, paint: Paint) -> String {
    let start = match &summary.start {
        StartWord::Word(word) if word == "warm" => {
            "start warm, directly after the same cycle from a soak".to_owned()
        }
        StartWord::Word(_) => "start soaked at ambient".to_owned(),
        StartWord::Degc(degc) => format!("start with everything at {} degC", plain(*degc)),
        StartWord::Nodes(_) => format!(
            "start with {}",
            summary.start.nodes_in_words().unwrap_or_default()
        ),
    };
    let settings = &summary.settings;
    let (name, title) = (paint.heading(&summary.cycle), &cycle.title);
    let belt = &settings.formulation;
    let (ambient, dt) = (plain(summary.ambient_degc), plain(settings.dt_s));
    let mut text = format!(
        "{name}  {title}\nambient {ambient} degC, {start}\nsteps of {dt} s, belt model {belt}\n"
    );
    text.extend(
        cycle
            .read_as
            .iter()
            .map(|words| wrapped(words, "read as: ")),
    );
    for (option, list) in [("--set", &settings.set), ("--set-all", &settings.set_all)] {
        text.extend(list.iter().map(|set| format!("{option} {set}\n")));
    }
    let mut table = TextTable::new("lll");
    for run in &summary.runs {
        let oils = format!("oils {}, {}", run.lubricant, run.engine_oil);
        table.row([&run.role, &run.vehicle, &run.title]);
        table.row(["", "", &oils]);
    }
    text + "\n" + &table.text()
}

/// Sentences about the subject; the first is the answer.
fn answers(summary: &Summary, paint: Paint) -> String {
    let sentences = sentences(summary);
    let paragraphs = sentences.iter().enumerate().map(|(k, sentence)| match k {
        0 => bold(sentence, paint),
        _ => wrapped(sentence, ""),
    });
    let text: String = paragraphs.collect();
    match text.is_empty() {
        true => text,
        false => text + "\n",
    }
}

/// A table with one column for each vehicle.
struct ByVehicle<'a> {
    table: TextTable,
    runs: &'a [RunSummary],
}

impl<'a> ByVehicle<'a> {
    fn new(summary: &'a Summary) -> Self {
        let runs = &summary.runs;
        let mut table = TextTable::new(&("ll".to_owned() + &"r".repeat(runs.len())));
        let names = runs.iter().map(|run| run.vehicle.as_str());
        table.row(["", ""].into_iter().chain(names));
        ByVehicle { table, runs }
    }

    fn add(&mut self, name: &str, unit: &str, cell: impl Fn(&RunSummary) -> String) {
        let head = [name.to_owned(), unit.to_owned()].into_iter();
        self.table.row(head.chain(self.runs.iter().map(cell)));
    }

    /// Adds a row of numbers, unless no vehicle has one.
    fn number(
        &mut self,
        name: &str,
        unit: &str,
        decimals: usize,
        get: impl Fn(&RunSummary) -> Option<f64>,
    ) {
        if self.runs.iter().any(|run| get(run).is_some()) {
            self.add(name, unit, |run| fixed(get(run), decimals));
        }
    }

    fn text(self, widths: &[usize]) -> String {
        self.table.min_widths(widths).text()
    }
}

fn fuel(summary: &Summary) -> String {
    let mut table = ByVehicle::new(summary);
    let groups = summary.runs.first().map_or(&[][..], |run| &run.phases);
    let over = summary
        .runs
        .first()
        .map_or(Over::Distance, RunSummary::over);
    for (k, group) in groups.iter().enumerate().filter(|_| groups.len() > 1) {
        table.add(&group.name, over.unit(), |run| {
            let fuel = |phase: &PhaseSummary| match over {
                Over::Distance => phase.fuel_l_per_100km,
                Over::Time => phase.fuel_l_per_h,
            };
            fixed(run.phases.get(k).and_then(fuel), 2)
        });
    }
    if over == Over::Time {
        table.add("total", over.unit(), |run| fixed(run.litres_per_hour(), 2));
        let an_hour = |run: &RunSummary| run.fuel_kg * 3600.0 / run.duration_s;
        table.add("", "kg/h", |run| fixed(an_hour(run), 3));
        table.add("", "g", |run| fixed(run.fuel_kg * 1e3, 1));
        table.add("driven distance", "m", |run| {
            fixed(run.distance_km * 1e3, 1)
        });
        table.add("duration", "s", |run| fixed(run.duration_s, 0));
        table.add("fuel at standstill", "% fuel", |run| {
            percent(run.standstill_fuel_g, run.fuel_kg * 1e3, 1)
        });
        return table.text(&LEAD);
    }
    table.add("total", "L/100 km", |run| fixed(run.fuel_l_per_100km, 2));
    table.number("weighted 0.43 / 0.57", "L/100 km", 2, |run| {
        run.weighted_fuel_l_per_100km
    });
    table.number("", "CO2 g/km", 1, |run| run.weighted_co2_g_per_km);
    table.add("", "mpg (UK)", |run| fixed(run.mpg_uk, 1));
    table.add("", "mpg (US)", |run| fixed(run.mpg_us, 1));
    table.add("CO2, total", "g/km", |run| fixed(run.co2_g_per_km, 1));
    table.add("driven distance", "km", |run| fixed(run.distance_km, 3));
    table.add("fuel at standstill", "% fuel", |run| {
        percent(run.standstill_fuel_g, run.fuel_kg * 1e3, 1)
    });
    table.text(&LEAD)
}

/// Difference to a baseline by phase, and a note if the cars are not like for like.
fn compared(comparison: &Comparison) -> String {
    let Some(difference) = comparison.fuel_percent else {
        return String::new();
    };
    let phases = comparison
        .phases_percent
        .iter()
        .filter(|(_, x)| x.is_some());
    let with = |x: Option<f64>, range: Option<[f64; 2]>| match range {
        Some(ends) => format!("{} % ({})", signed(x, 1), between(ends, "%")),
        None => format!("{} %", signed(x, 1)),
    };
    let parts: Vec<String> = phases
        .map(|(name, x)| {
            let range = comparison.phases_fleet.get(name).copied();
            format!("{name} {}", with(x, range))
        })
        .collect();
    let range = comparison.fleet.as_ref().map(|range| range.ends);
    let whole = with(Some(difference), range);
    let mut line = match parts.len() {
        0 | 1 => whole,
        _ => format!("{}, whole cycle {whole}", parts.join(", ")),
    };
    if !comparison.likeness.is_empty() {
        line += &format!("; {}", comparison.likeness);
    }
    wrapped(&line, &format!("over {}: ", comparison.baseline))
}

/// Energy in kJ and in per cent of the fuel energy.
fn kj_and_share(kj: Option<f64>, run: &RunSummary) -> String {
    let share = percent(kj, run.fuel_energy_kj, 1);
    kj.map_or(NONE.to_owned(), |kj| {
        format!("{:>7} {share:>7}", fixed(kj, 1))
    })
}

fn losses(summary: &Summary) -> (String, String) {
    match summary.runs.iter().any(|run| run.price.is_none()) {
        true => ("Transmission losses".to_owned(), energies(summary)),
        false => priced_losses(summary),
    }
}

fn energies(summary: &Summary) -> String {
    let mut table = ByVehicle::new(summary);
    table.add("", "", |_| "kJ  % energy".into());
    for component in Component::ALL {
        let name = component.name();
        let has = |run: &RunSummary| run.loss_kj.iter().any(|(own, _)| own == name);
        if summary.runs.iter().any(has) {
            table.add(&loss_words(summary, name), "", |run| match has(run) {
                true => kj_and_share(run.loss_kj.get(name), run),
                false => String::new(),
            });
        }
    }
    table.add("transmission total", "", |run| {
        kj_and_share(Some(run.transmission_loss_kj()), run)
    });
    for name in ["accessories", "brake"] {
        table.add(name, "", |run| kj_and_share(run.loss_kj.get(name), run));
    }
    table.text(&LEAD[..1])
}

/// Terms of the power balance and their names in the table.
const BALANCE: [(&str, &str); 8] = [
    ("wheels", "rolling and air (net)"),
    ("brake", "brakes"),
    ("losses", "transmission"),
    ("accessories", "accessories"),
    ("engine_heat", "heat to the engine"),
    ("exhaust", "exhaust"),
    ("kinetic", "rotating parts"),
    ("electric", "battery and starter"),
];

fn balance(summary: &Summary) -> String {
    let mut table = ByVehicle::new(summary);
    for (term, name) in BALANCE {
        let share = |run: &RunSummary| percent(run.term_kj(term), run.fuel_energy_kj, 1);
        // Leaves out rows of zeros; the JSON has the unrounded values.
        let may_be_left_out = ["kinetic", "electric"].contains(&term);
        if !may_be_left_out
            || summary
                .runs
                .iter()
                .any(|run| !["0.0", "-0.0", "-"].contains(&&*share(run)))
        {
            table.add(name, "% fuel", share);
        }
    }
    table.add("fuel energy", "kJ", |run| fixed(run.fuel_energy_kj, 0));
    table.text(&LEAD)
}

fn ends(summary: &Summary) -> String {
    let mut table = ByVehicle::new(summary);
    for (name, _) in summary
        .runs
        .iter()
        .take(1)
        .flat_map(|run| run.end_degc.iter())
    {
        table.number(&name.replace('_', " "), "degC", 1, |run| {
            run.end_degc.get(name)
        });
    }
    table.text(&LEAD)
}

fn flags(summary: &Summary) -> String {
    let mut table = ByVehicle::new(summary);
    for (name, _) in summary
        .runs
        .iter()
        .take(1)
        .flat_map(|run| run.flags_s.iter())
    {
        table.number(name, "s", 1, |run| {
            run.flags_s.get(name).filter(|s| *s > 0.0)
        });
    }
    table.text(&LEAD)
}

fn notes(summary: &Summary) -> String {
    let mut text = "\n".to_owned();
    for run in &summary.runs {
        let name = &run.vehicle;
        if let Some(schedule) = &run.gear_schedule {
            text += &format!("{name}: {schedule}\n");
        }
        // Doubts are in the answer.
        let notes = run.notes.iter().filter(|note| !note.starts_with(DOUBT));
        text.extend(notes.map(|note| format!("{name}: {note}\n")));
        if let Some(safety) = run.min_clamp_safety {
            let safety = fixed(safety, 2);
            text += &format!("{name}: smallest clamp safety factor {safety}\n");
        }
    }
    if summary
        .comparison
        .iter()
        .any(|difference| difference.interval.is_none())
    {
        text += "a difference gets an interval of its own from --draws 256\n";
    }
    let worst = |value: fn(&RunSummary) -> Option<f64>| {
        let all: Option<Vec<f64>> = summary.runs.iter().map(value).collect();
        tiny(all.and_then(|all| all.into_iter().reduce(|a, b| if b > a { b } else { a })))
    };
    let step = worst(|run| run.ledger_error);
    let run = worst(|run| run.run_ledger_error);
    text += &format!(
        "relative error of the energy balances: {step} in the worst time step, {run} over the run\n"
    );
    paragraphs(&text)
}

/// One line for each failed check.
pub fn failures(summary: &Summary) -> Vec<String> {
    let failed_checks = |run: &RunSummary| {
        let line = |failure| {
            let text = run.failure_text(failure);
            format!("check failed: {} {text}", run.vehicle)
        };
        run.failures.iter().map(line).collect::<Vec<_>>()
    };
    let checks = summary.runs.iter().flat_map(failed_checks);
    checks.chain(failing_draws(summary)).collect()
}

/// Comparisons of which most draws fail: the numbers are not those of a car.
fn failing_draws(summary: &Summary) -> impl Iterator<Item = String> {
    let most = |of: &&Comparison| {
        let drawn = of.interval.as_ref();
        drawn.is_some_and(|drawn| drawn.failed_share() > 0.5)
    };
    let failing = summary.comparison.iter().filter(most);
    failing.filter_map(|of| {
        let words = of.interval.as_ref()?.failures_in_words()?;
        Some(format!("check failed: against {}, {words}", of.baseline))
    })
}
