//! Text and files of `optimum`.

use std::borrow::Cow;

use cvtcycle::analysis::optimum::LawBound;
use cvtcycle::config::Problem;
use cvtcycle::model::keys::rpm;
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::number::{fixed, plain, signed};
use cvtcycle::output::summary::StartWord;
use cvtcycle::output::table::{Column, TextTable, wrapped, write_csv};
use cvtcycle::output::{Row, columns};

use super::OptimumSummary;
use crate::print::colour::Paint;
use crate::print::sections;

/// Prints all results.
pub fn text(summary: &OptimumSummary, paint: Paint) -> String {
    let n = &summary.numbers;
    let head = format!(
        "{}  {} at {} degC\n{}",
        paint.heading(&summary.vehicle),
        summary.cycle,
        plain(n.ambient_degc),
        wrapped(&sentence(summary), "")
    );
    let parts = [
        ("Fuel by clamp law, L/100 km", bounds(summary)),
        ("Least fuel by least engine speed", speeds(summary)),
        ("What the limits cost", limits(summary)),
        ("How sure the bound is", certainty(summary)),
        ("Operating line", line(summary)),
        ("The line on other cycles, L/100 km", elsewhere(summary)),
    ];
    head + &sections(parts, paint)
}

/// One-sentence answer.
fn sentence(summary: &OptimumSummary) -> String {
    let own = &summary.answer.bounds[0];
    let least = own.bound_l_per_100km;
    let mut text = format!(
        "No controller of the ratio with the engine at {} rpm or more burns less than {} L/100 km with the clamp `{}`",
        plain(summary.numbers.least_rpm),
        fixed(least, 3),
        own.clamp
    );
    if let Some(free) = summary
        .answer
        .bounds
        .iter()
        .find(|bound| bound.clamp == "free")
    {
        let least = free.bound_l_per_100km;
        text += &format!(
            ", {} with any clamp of a safety factor of {} and {} % slip",
            fixed(least, 3),
            plain(summary.numbers.safety),
            plain(summary.numbers.max_slip_percent)
        );
    }
    let above = |litres: f64| signed(100.0 * (litres / least - 1.0), 2);
    let kept = |time_s: Option<f64>| match time_s {
        Some(time_s) if time_s > 0.0 => " (not always within these limits)",
        _ => "",
    };
    if let Some(litres) = own.own_l_per_100km {
        text += &format!(
            ". The car as it is burns {}: {} %{}",
            fixed(litres, 3),
            above(litres),
            kept(own.own_outside_s)
        );
    }
    if let Some(line) = &summary.answer.line {
        text += &format!(
            "; with its best line {}: {} %{}",
            fixed(line.l_per_100km, 3),
            signed(line.above_bound_percent, 2),
            match kept(own.line_outside_s) {
                "" => ", at most the worth of looking ahead",
                outside => outside,
            }
        );
    }
    text + "."
}

fn bounds(summary: &OptimumSummary) -> String {
    let mut table = TextTable::new("lrrrrrr");
    table.row(["clamp", "as it is", "%", "line", "%", "least", "tolerance"]);
    for bound in &summary.answer.bounds {
        let above = |litres: Option<f64>| {
            litres.map(|litres| 100.0 * (litres / bound.least_l_per_100km - 1.0))
        };
        table.row([
            name(bound),
            fixed(bound.own_l_per_100km, 3),
            signed(above(bound.own_l_per_100km), 2),
            fixed(bound.line_l_per_100km, 3),
            signed(above(bound.line_l_per_100km), 2),
            fixed(bound.least_l_per_100km, 3),
            fixed(bound.tolerance_l_per_100km, 3),
        ]);
    }
    table.text()
        + &weaker_laws_note(summary)
        + &idle_launch_note(summary)
        + &violations_note(summary)
        + &warm_start_note(summary)
}

/// Name of a bound: its clamp law, and its launch if it differs from the car's.
fn name(bound: &LawBound) -> String {
    let clamp = bound.clamp.replace('_', " ");
    match bound.launch {
        "idle" => clamp + ", idle launch",
        _ => clamp,
    }
}

/// Note that defines an idle launch.
fn idle_launch_note(summary: &OptimumSummary) -> String {
    match summary
        .answer
        .bounds
        .iter()
        .any(|bound| bound.launch == "idle")
    {
        true => wrapped(
            "`idle launch`: a clutch that carries any torque with the engine at idle speed (LC-7); that of the car needs its speed (LC-1).",
            "",
        ),
        false => String::new(),
    }
}

/// Note on the start of warm drives.
fn warm_start_note(summary: &OptimumSummary) -> String {
    match &summary.start {
        StartWord::Word(word) if word == "warm" => wrapped(
            "Each car begins as warm as its own drive from a soak leaves it, as with `run --start warm`, and so do the paths of the bounds.",
            "",
        ),
        _ => String::new(),
    }
}

/// Note on cars that violate the limits at times and may therefore burn less than the bound.
fn violations_note(summary: &OptimumSummary) -> String {
    let seconds = |b: &LawBound, what: &str, time_s: Option<f64>| {
        let time_s = time_s.filter(|time_s| *time_s > 0.0)?;
        Some(format!("{} {what} {} s", name(b), fixed(time_s, 1)))
    };
    let bounds = summary.answer.bounds.iter();
    let each = bounds.flat_map(|b| {
        [
            seconds(b, "as it is", b.own_outside_s),
            seconds(b, "with the line", b.line_outside_s),
        ]
    });
    let each: Vec<String> = each.flatten().collect();
    match each.is_empty() {
        true => String::new(),
        false => wrapped(
            &format!("Time outside these limits: {}.", each.join(", ")),
            "",
        ),
    }
}

/// Note on laws that burn less than a free clamp, because their safety is lower.
fn weaker_laws_note(summary: &OptimumSummary) -> String {
    let bounds = &summary.answer.bounds;
    let Some(free) = bounds.iter().find(|bound| bound.clamp == "free") else {
        return String::new();
    };
    let below = |bound: &&LawBound| {
        bound.launch == "law" && bound.bound_l_per_100km < free.bound_l_per_100km
    };
    let laws = bounds.iter().filter(below).map(|law| {
        let text = format!(
            "`{}` clamps with a safety factor down to {} and up to {} % slip: a free clamp must have {} and {} % (--safety, --max-slip).",
            name(law),
            fixed(law.least_safety, 2),
            fixed(law.most_slip_percent, 2),
            plain(summary.numbers.safety),
            plain(summary.numbers.max_slip_percent)
        );
        wrapped(&text, "")
    });
    laws.collect()
}

fn speeds(summary: &OptimumSummary) -> String {
    let mut table = TextTable::new("rrr");
    table.row(["rpm", "L/100 km", "%"]);
    let own = summary.answer.bounds[0].least_l_per_100km;
    for (least_rpm, litres) in &summary.answer.least_speeds {
        let change = litres.map(|litres| 100.0 * (litres / own - 1.0));
        let litres = litres.map_or("cannot be held".to_owned(), |litres| fixed(litres, 3));
        table.row([fixed(*least_rpm, 0), litres, signed(change, 2)]);
    }
    table.text() + &coupling_note(summary)
}

/// Note on minimum speeds set by the coupling instead of the limit.
fn coupling_note(summary: &OptimumSummary) -> String {
    let floor = summary
        .answer
        .lock_floor
        .filter(|floor| floor.above_s > 0.0);
    let Some(floor) = floor else {
        return String::new();
    };
    let text = format!(
        "The coupling stays locked from {} to {} rpm on, by the engine's idle speed (LC-5, TC-7): for {} s above --least-rpm, which decides nothing there.",
        fixed(floor.least_rpm, 0),
        fixed(floor.most_rpm, 0),
        fixed(floor.above_s, 0)
    );
    wrapped(&text, "")
}

fn limits(summary: &OptimumSummary) -> String {
    let mut table = TextTable::new("lr");
    if !summary.answer.limits.is_empty() {
        table.row(["", "% of the fuel"]);
    }
    for limit in &summary.answer.limits {
        table.row([limit.limit.replace('_', " "), fixed(limit.percent, 2)]);
    }
    table.text()
}

fn certainty(summary: &OptimumSummary) -> String {
    let own = &summary.answer.bounds[0];
    let mut table = TextTable::new("lr");
    table.row(["", "L/100 km"]);
    for (ratios, litres) in &own.grid {
        table.row([format!("{ratios} ratios"), fixed(*litres, 4)]);
    }
    let ratios = summary.numbers.ratios;
    table.row([format!("{ratios} ratios"), fixed(own.least_l_per_100km, 4)]);
    for (k, litres) in own.temperatures.iter().enumerate() {
        table.row([
            format!("temperatures {}, half the grid", k + 1),
            fixed(*litres, 4),
        ]);
    }
    table.row([
        "best path, driven".to_owned(),
        fixed(own.driven_l_per_100km, 4),
    ]);
    table.text()
}

fn line(summary: &OptimumSummary) -> String {
    let Some(line) = &summary.answer.line else {
        return String::new();
    };
    let mut table = TextTable::new("rrrr");
    table.row(["% of rated power", "rpm", "overrun at km/h", "rpm"]);
    let cells = |points: &[(f64, f64)], k: usize| match points.get(k) {
        Some((x, n)) => [plain(*x), plain(*n)],
        None => [String::new(), String::new()],
    };
    for k in 0..line.drive.len().max(line.overrun.len()) {
        let [a, b] = cells(&line.drive, k);
        let [c, d] = cells(&line.overrun, k);
        table.row([a, b, c, d]);
    }
    let again = line.again.join(", ");
    let again = match again.is_empty() {
        true => String::new(),
        false => wrapped(
            &format!("The vehicle file has all but {again}: give it again with the file."),
            "",
        ),
    };
    table.text() + &again
}

fn elsewhere(summary: &OptimumSummary) -> String {
    let cycles = summary.answer.line.iter().flat_map(|line| &line.elsewhere);
    let mut table = TextTable::new("lrrrr");
    let slow = cycles.clone().any(|other| other.line_below_s > 0.0);
    for (number, other) in cycles.enumerate() {
        if number == 0 {
            table.row(["", "as it is", "line", "%", "s below the least speed"]);
        }
        let (own, line) = (other.own_l_per_100km, other.line_l_per_100km);
        table.row([
            other.cycle.clone(),
            fixed(own, 3),
            fixed(line, 3),
            signed(100.0 * (line / own - 1.0), 2),
            fixed(other.line_below_s, 1),
        ]);
    }
    let note = "Below the least speed by more than 1 %, with a lower ratio left: the line was not searched on these cycles.";
    match slow {
        true => table.text() + &wrapped(note, ""),
        false => table.text(),
    }
}

fn bound_columns() -> Vec<Column<LawBound>> {
    let or_nan = |x: Option<f64>| x.unwrap_or(f64::NAN);
    columns! { LawBound;
        text "clamp", "", "clamp law, or free", b => Cow::Owned(b.clamp.clone());
        text "launch", "", "launch by the clutch's law, or at idle", b => Cow::Borrowed(b.launch);
        number "own_l_per_100km", "L/100 km", "fuel of the car with its own ratio control", b => or_nan(b.own_l_per_100km);
        number "own_outside_s", "s", "time outside the limits of speed and reserve", b => or_nan(b.own_outside_s);
        number "line_l_per_100km", "L/100 km", "fuel of the car with the operating line", b => or_nan(b.line_l_per_100km);
        number "line_outside_s", "s", "time outside the limits with the line", b => or_nan(b.line_outside_s);
        number "least_l_per_100km", "L/100 km", "least fuel", b => b.least_l_per_100km;
        number "tolerance_l_per_100km", "L/100 km", "tolerance of the least fuel", b => b.tolerance_l_per_100km;
        number "bound_l_per_100km", "L/100 km", "the bound: least fuel less its tolerance", b => b.bound_l_per_100km;
        number "least_safety", "-", "least safety factor on the best path, locked", b => b.least_safety;
        number "most_slip_percent", "%", "largest slip there", b => b.most_slip_percent;
        number "driven_l_per_100km", "L/100 km", "fuel of the best path as driven", b => b.driven_l_per_100km;
        number "gap_percent", "%", "that over the least fuel less its tolerance", b => b.gap_percent;
    }
}

fn speed_columns() -> Vec<Column<(f64, Option<f64>)>> {
    columns! { (f64, Option<f64>);
        number "least_rpm", "rpm", "least engine speed with the clutch locked", (n, _) => *n;
        number "least_l_per_100km", "L/100 km", "least fuel; missing where no ratio holds the limits", (_, l) => l.unwrap_or(f64::NAN);
    }
}

fn path_columns() -> Vec<Column<Row>> {
    columns! { Row;
        number "time_s", "s", "end of the step", r => r.time_s;
        number "speed_kmh", "km/h", "road speed", r => 3.6 * r.speed_m_s;
        number "wheel_power_w", "W", "power asked for at the wheels", r => r.wheel_power_w;
        number "belt_ratio", "-", "belt ratio", r => r.belt_ratio;
        number "engine_speed_rpm", "rpm", "engine speed", r => rpm(r.engine_speed_rad_s);
        number "secondary_pressure_bar", "bar", "secondary pressure", r => 1e-5 * r.secondary_pressure_pa;
        number "clamp_safety", "-", "torque capacity over torque", r => r.clamp_safety;
        number "slip_percent", "%", "belt slip", r => 100.0 * r.slip;
        number "fuel_g_s", "g/s", "fuel", r => 1e3 * r.fuel_kg_s;
        number "coolant_degc", "degC", "coolant", r => r.coolant_k - ZERO_DEGC_K;
        number "transmission_sump_degc", "degC", "transmission oil", r => r.sump_k - ZERO_DEGC_K;
    }
}

/// Writes tables and the vehicle file of the line.
///
/// # Errors
/// Problems of the directory.
pub fn write(dir: &mut OutputDir, summary: &OptimumSummary) -> Result<(), Problem> {
    let answer = &summary.answer;
    dir.write("bound.csv", |out| {
        write_csv(out, &bound_columns(), &answer.bounds, &[])
    })?;
    dir.write("least_speed.csv", |out| {
        write_csv(out, &speed_columns(), &answer.least_speeds, &[])
    })?;
    dir.write("path.csv", |out| {
        write_csv(out, &path_columns(), &answer.path, &[])
    })?;
    if let Some(line) = &answer.line {
        dir.put(&format!("{}_line.toml", summary.vehicle), &line.file)?;
    }
    Ok(())
}
